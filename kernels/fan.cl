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

/* fan_table: P, one work-item per (level, cell, beam); STRIDE beams a row, padded with zeros. */
__kernel void fan_table(__global const dev_ping *ping, __global float *table, uint stride) {
    __global const dev_beam *beams = beams_of(ping);
    uint id = (uint)(get_global_id(0));
    uint beam = id % stride, column = id / stride;
    if (column >= ping->columns) {
        return;
    }
    float value = 0.0f;
    if (beam < ping->beams) {
        __global const float *x = beams[1u + beam].rows, *f = ping->fan_rows;
        float yaw =
            atan2(x[0] * f[3] + x[1] * f[4] + x[2] * f[5], x[0] * f[0] + x[1] * f[1] + x[2] * f[2]);
        float step = 1.0f / ping->fan_cells_per_rad, length = beams[1].length_h_wl;
        float m = fan_level_m((int)(column / ping->fan_cells));
        float psi = ping->fan_begin_rad + step * (float)(column % ping->fan_cells) - yaw;
        float f0 = fan_pattern(length, m, psi, ping->rear_lin);
        float f1 = fan_pattern(length, m, psi - step, ping->rear_lin);
        float f2 = fan_pattern(length, m, psi + step, ping->rear_lin);
        value = f0 - (f1 - 2.0f * f0 + f2) * (1.0f / 12.0f);
    }
    table[id] = value;
}

/* What a cell holds. */
typedef struct fan_entry {
    uint cell;
    float quanta;
} fan_entry;

/* fan_pack: what a level of a (component, bin) holds, as a list of its filled cells, COUNTS long;
 * a ping of many short bins fills few. Clears what it read, for the next ping. One work-item per
 * (component, bin, level). */
__kernel void fan_pack(__global const dev_ping *ping, __global long *accumulator,
                       __global fan_entry *entries, __global uint *counts) {
    uint id = (uint)(get_global_id(0));
    if (id >= ping->components * ping->bins * DEV_FAN_LEVELS) {
        return;
    }
    __global uint *touched = fan_touched(ping, accumulator) + id;
    size_t first = (size_t)(id)*ping->fan_cells;
    uint count = 0u;
    if (*touched != 0u) {
        *touched = 0u;
        for (uint k = 0; k < ping->fan_cells; k++) {
            long quanta = accumulator[first + k];
            if (quanta != 0) {
                accumulator[first + k] = 0;
                fan_entry entry = {k, convert_float(quanta)};
                entries[first + count++] = entry;
            }
        }
    }
    counts[id] = count;
}

#define TILE 128 /* beams of a work-item */

#if defined(FP_FAST_FMAF) || defined(__FMA__)
#define MULTIPLY_ADD(a, b, c) fma((a), (b), (c))
#else
#define MULTIPLY_ADD(a, b, c) ((a) * (b) + (c))
#endif

/* fan_project: one work-item per (component, bin) and tile of beams. RESULTS holds floats,
 * [component][beam][bin], and the number of deposits that had to be cut. */
__kernel void fan_project(__global const dev_ping *ping, __global const fan_entry *entries,
                          __global const uint *counts, __global const float *table,
                          __global uint *saturated, __global float *results, uint stride) {
    /* Neighbouring work-items share a tile: its part of the table stays in the cache. */
    uint rows = ping->components * ping->bins;
    uint id = (uint)(get_global_id(0)), tile = id / rows, row = id - tile * rows;
    if (tile * TILE >= stride) {
        return;
    }
    if (id == 0u) {
        ((__global uint *)results)[(size_t)(rows)*ping->beams] = *saturated;
        *saturated = 0u;
    }
    float16 sum0 = (float16)(0.0f), sum1 = sum0, sum2 = sum0, sum3 = sum0;
    float16 sum4 = sum0, sum5 = sum0, sum6 = sum0, sum7 = sum0;
    for (uint level = 0; level < DEV_FAN_LEVELS; level++) {
        uint list = row * DEV_FAN_LEVELS + level, count = counts[list];
        __global const fan_entry *entry = entries + (size_t)(list)*ping->fan_cells;
        __global const float *p = table + (size_t)(level)*ping->fan_cells * stride + tile * TILE;
        for (uint k = 0; k < count; k++) {
            __global const float *pattern = p + (size_t)(entry[k].cell) * stride;
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
    }
    float16 sums[TILE / 16] = {sum0, sum1, sum2, sum3, sum4, sum5, sum6, sum7};
    uint component = row / ping->bins, bin = row - component * ping->bins;
    for (uint b = 0; b < TILE && tile * TILE + b < ping->beams; b++) {
        results[((size_t)(component)*ping->beams + tile * TILE + b) * ping->bins + bin] =
            max(((float *)sums)[b], 0.0f);
    }
}
