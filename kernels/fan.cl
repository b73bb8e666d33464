/*
 * From a fan's azimuth cells to its beams: O[bin][beam] = sum H[bin][level, cell] P[level, cell][beam].
 *
 * A sinc^2 pattern of aperture L is band-limited, so that cells of 1 / (3 L) lose nothing; linear
 * splitting rounds its peak by h^2 f'' / 12, which the table takes back.
 */
#include "receive.h"

/* One-way pattern in azimuth at level M, without the vertical factor. */
static float fan_pattern(float length_wl, float m, float psi, float rear) {
    float a = sinc(length_wl * m * sin(psi));
    return a * a * (cos(psi) > 0.0f ? 1.0f : rear);
}

/* fan_table: P for receivers at BEARINGS_RAD in the fan's frame, one work-item per (level, cell, beam);
 * STRIDE beams a row, padded with zeros. */
__kernel void fan_table(__global const dev_ping *ping, __global const float *bearings_rad,
                        __global float *table, uint stride) {
    __global const dev_beam *beams = beams_of(ping);
    uint id = (uint)(get_global_id(0));
    uint beam = id % stride, column = id / stride;
    if (column >= ping->columns) {
        return;
    }
    float value = 0.0f;
    if (beam < ping->beams) {
        float step = 1.0f / ping->fan_cells_per_rad, length = beams[1].length_h_wl;
        float m = fan_level_m((int)(column / ping->fan_cells));
        float psi =
            ping->fan_begin_rad + step * (float)(column % ping->fan_cells) - bearings_rad[beam];
        float f0 = fan_pattern(length, m, psi, ping->rear_lin);
        float f1 = fan_pattern(length, m, psi - step, ping->rear_lin);
        float f2 = fan_pattern(length, m, psi + step, ping->rear_lin);
        value = f0 - (f1 - 2.0f * f0 + f2) * (1.0f / 12.0f);
    }
    table[id] = value;
}

/* What a column of a row holds; a row, that is a (component, bin), as a list of such. */
typedef struct fan_entry {
    uint column;
    float quanta;
} fan_entry;

typedef struct fan_list {
    uint first, count;
} fan_list;

/* What a chunk of a row's columns holds, from COLUMN on, to ENTRIES, or only counted; cleared where
 * it is taken. */
static uint take_chunk(__global long *row, uint column, uint columns, __global fan_entry *entries) {
    uint count = 0u, end = min(column + DEV_FAN_CHUNK, columns);
    for (uint k = column; k < end; k++) {
        long quanta = row[k];
        if (quanta != 0) {
            if (entries) {
                fan_entry entry = {k, convert_float(quanta)};
                entries[count] = entry;
                row[k] = 0;
            }
            count++;
        }
    }
    return count;
}

/* fan_pack: a row as a list of its filled columns; a ping of many short bins fills few. Lists lie
 * close together, in any order: who projects them reads little. Clears what it read, for the next
 * ping. One work-item per row. */
__kernel void fan_pack(__global const dev_ping *ping, __global long *accumulator,
                       __global fan_entry *entries, __global fan_list *lists) {
    uint id = (uint)(get_global_id(0)), rows = ping->components * ping->bins;
    if (id >= rows) {
        return;
    }
    __global uchar *all_flags = fan_flags(ping, accumulator);
    __global uint *made = (__global uint *)(all_flags + (size_t)(rows)*ping->fan_flags);
    __global uchar *flags = all_flags + (size_t)(id)*ping->fan_flags;
    __global long *row = accumulator + (size_t)(id)*ping->columns;
    fan_list list = {0u, 0u};
    for (uint pass = 0u; pass < 2u; pass++) {
        __global fan_entry *to = 0;
        if (pass == 1u) {
            list.first = atomic_add(made, list.count);
            to = entries + list.first;
        }
        for (uint f = 0; f < ping->fan_flags; f += 8u) {
            uchar8 eight = vload8(0, flags + f);
            if (any(eight != (uchar8)(0u))) {
                for (uint k = f; k < f + 8u; k++) {
                    if (flags[k] == 0u) {
                        continue;
                    }
                    uint count = take_chunk(row, k * DEV_FAN_CHUNK, ping->columns, to);
                    if (pass == 0u) {
                        list.count += count;
                    } else {
                        to += count;
                    }
                }
                if (pass == 1u) {
                    vstore8((uchar8)(0u), 0, flags + f);
                }
            }
        }
    }
    lists[id] = list;
}

#define TILE DEV_FAN_TILE       /* beams of a work-item */
#define RUN ((uint)(ASDIC_RUN)) /* bins of a work-item */

#if defined(FP_FAST_FMAF) || defined(__FMA__)
#define MULTIPLY_ADD(a, b, c) fma((a), (b), (c))
#else
#define MULTIPLY_ADD(a, b, c) ((a) * (b) + (c))
#endif

/* One row's sums for TILE beams, to TO; TABLE from the first of them on. */
static void project_row(__global const fan_entry *entry, uint count, __global const float *table,
                        uint stride, float *to) {
    float16 sum0 = (float16)(0.0f), sum1 = sum0, sum2 = sum0, sum3 = sum0;
    float16 sum4 = sum0, sum5 = sum0, sum6 = sum0, sum7 = sum0;
    for (uint k = 0; k < count; k++) {
        __global const float *pattern = table + (size_t)(entry[k].column) * stride;
        float16 quanta = (float16)(entry[k].quanta);
        sum0 = MULTIPLY_ADD(quanta, vload16(0, pattern), sum0);
        sum1 = MULTIPLY_ADD(quanta, vload16(1, pattern), sum1);
        sum2 = MULTIPLY_ADD(quanta, vload16(2, pattern), sum2);
        sum3 = MULTIPLY_ADD(quanta, vload16(3, pattern), sum3);
        sum4 = MULTIPLY_ADD(quanta, vload16(4, pattern), sum4);
        sum5 = MULTIPLY_ADD(quanta, vload16(5, pattern), sum5);
        sum6 = MULTIPLY_ADD(quanta, vload16(6, pattern), sum6);
        sum7 = MULTIPLY_ADD(quanta, vload16(7, pattern), sum7);
    }
    vstore16(sum0, 0, to);
    vstore16(sum1, 1, to);
    vstore16(sum2, 2, to);
    vstore16(sum3, 3, to);
    vstore16(sum4, 4, to);
    vstore16(sum5, 5, to);
    vstore16(sum6, 6, to);
    vstore16(sum7, 7, to);
}

/* A row of V's i-th beam becomes the i-th row: four times, halves of two rows are put between each
 * other. */
static void transpose(float16 *v) {
    for (uint round = 0; round < 4u; round++) {
        float16 w[16];
        for (uint i = 0; i < 8u; i++) {
            w[2u * i].even = v[i].lo;
            w[2u * i].odd = v[i + 8u].lo;
            w[2u * i + 1u].even = v[i].hi;
            w[2u * i + 1u].odd = v[i + 8u].hi;
        }
        for (uint i = 0; i < 16u; i++) {
            v[i] = w[i];
        }
    }
}

/* SUMS of BINS rows to the beams' own rows, STRIDE floats from each other, from TO on. */
static void store_beams(float (*sums)[TILE], uint bins, uint beams, __global float *to,
                        size_t stride) {
#if ASDIC_RUN == 16
    if (bins == RUN) {
        for (uint b = 0; b < beams; b += 16u) {
            float16 v[16];
            for (uint r = 0; r < RUN; r++) {
                v[r] = max(vload16(0, sums[r] + b), (float16)(0.0f));
            }
            transpose(v);
            for (uint k = 0; k < min(beams - b, 16u); k++) {
                vstore16(v[k], 0, to + (b + k) * stride);
            }
        }
        return;
    }
#endif
    for (uint b = 0; b < beams; b++) {
        for (uint r = 0; r < bins; r++) {
            to[b * stride + r] = max(sums[r][b], 0.0f);
        }
    }
}

/* fan_project: the TILE beams of tile number TILE_AT; one work-item per component and RUN bins.
 * RESULTS holds floats, [beam][component][bin], and the number of deposits that had to be cut. */
__kernel void fan_project(__global const dev_ping *ping, __global const fan_entry *entries,
                          __global const fan_list *lists, __global const float *table,
                          __global long *accumulator, __global uint *saturated,
                          __global float *results, uint stride, uint tile_at) {
    uint runs = (ping->bins + RUN - 1u) / RUN, rows = ping->components * ping->bins;
    uint id = (uint)(get_global_id(0)), component = id / runs;
    if (component >= ping->components) {
        return;
    }
    uint first_beam = tile_at * TILE, beams = min(ping->beams - first_beam, (uint)(TILE));
    if (id == 0u && first_beam + TILE >= ping->beams) {
        ((__global uint *)results)[(size_t)(rows)*ping->beams] = *saturated;
        *saturated = 0u;
        *(__global uint *)(fan_flags(ping, accumulator) + (size_t)(rows)*ping->fan_flags) = 0u;
    }
    uint bin = (id - component * runs) * RUN, bins = min(ping->bins - bin, RUN);
    float sums[ASDIC_RUN][TILE];
    for (uint r = 0; r < bins; r++) {
        fan_list list = lists[component * ping->bins + bin + r];
        project_row(entries + list.first, list.count, table + first_beam, stride, sums[r]);
    }
    __global float *to = results + (size_t)(first_beam)*rows + component * ping->bins + bin;
    store_beams(sums, bins, beams, to, rows);
}
