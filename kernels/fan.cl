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

/* fan_rows: quanta to floats; FILLED tells whether a level of a (component, bin) holds anything; both
 * begin as zeros. Clears what it read, for the next ping. One work-item per (component, bin, level). */
__kernel void fan_rows(__global const dev_ping *ping, __global long *accumulator,
                       __global float *rows, __global uint *filled) {
    uint id = (uint)(get_global_id(0));
    if (id >= ping->components * ping->bins * DEV_FAN_LEVELS) {
        return;
    }
    size_t first = (size_t)(id)*ping->fan_cells;
    uint any = 0u;
    for (uint k = 0; k < ping->fan_cells; k++) {
        any |= (uint)(accumulator[first + k] != 0);
    }
    if ((any | filled[id]) != 0u) { /* else the row is zero already */
        for (uint k = 0; k < ping->fan_cells; k++) {
            rows[first + k] = convert_float(accumulator[first + k]);
            accumulator[first + k] = 0;
        }
    }
    filled[id] = any;
}

#define TILE 16 /* beams of a work-item */
#define BLOCK 8 /* bins it sums at a time */

#if defined(FP_FAST_FMAF) || defined(__FMA__)
#define MULTIPLY_ADD(a, b, c) fma((a), (b), (c))
#else
#define MULTIPLY_ADD(a, b, c) ((a) * (b) + (c))
#endif

/* fan_project: one work-item per (block of rows, tile of beams); a row is a (component, bin). RESULTS
 * begins as in reduce.cl. */
__kernel void fan_project(__global const dev_ping *ping, __global const float *rows,
                          __global const uint *filled, __global const float *table,
                          __global uint *saturated, __global long *results, uint stride) {
    /* Neighbouring work-items share a tile: its part of the table stays in the cache. */
    uint count = ping->components * ping->bins, blocks = (count + BLOCK - 1u) / BLOCK;
    uint id = (uint)(get_global_id(0)), tile = id / blocks, first = id % blocks * BLOCK;
    if (tile * TILE >= stride) {
        return;
    }
    if (id == 0u) {
        results[(size_t)(count)*ping->beams] = (long)(*saturated);
        *saturated = 0u;
    }
    uint have = min((uint)(BLOCK), count - first);
    float16 sum[BLOCK];
    for (uint r = 0; r < BLOCK; r++) {
        sum[r] = (float16)(0.0f);
    }
    for (uint level = 0; level < DEV_FAN_LEVELS; level++) {
        uint any = 0u;
        for (uint r = 0; r < have; r++) {
            any |= filled[(first + r) * DEV_FAN_LEVELS + level];
        }
        if (any == 0u) {
            continue;
        }
        __global const float *p = table + (size_t)(level)*ping->fan_cells * stride + tile * TILE;
        __global const float *h[BLOCK];
        for (uint r = 0; r < BLOCK; r++) {
            uint row = first + min(r, have - 1u);
            h[r] = rows + ((size_t)(row)*DEV_FAN_LEVELS + level) * ping->fan_cells;
        }
        for (uint k = 0; k < ping->fan_cells; k++) {
            float16 pattern = vload16(0, p + (size_t)(k)*stride);
            sum[0] = MULTIPLY_ADD((float16)(h[0][k]), pattern, sum[0]);
            sum[1] = MULTIPLY_ADD((float16)(h[1][k]), pattern, sum[1]);
            sum[2] = MULTIPLY_ADD((float16)(h[2][k]), pattern, sum[2]);
            sum[3] = MULTIPLY_ADD((float16)(h[3][k]), pattern, sum[3]);
            sum[4] = MULTIPLY_ADD((float16)(h[4][k]), pattern, sum[4]);
            sum[5] = MULTIPLY_ADD((float16)(h[5][k]), pattern, sum[5]);
            sum[6] = MULTIPLY_ADD((float16)(h[6][k]), pattern, sum[6]);
            sum[7] = MULTIPLY_ADD((float16)(h[7][k]), pattern, sum[7]);
        }
    }
    for (uint b = 0; b < TILE && tile * TILE + b < ping->beams; b++) {
        for (uint r = 0; r < have; r++) {
            uint component = (first + r) / ping->bins, bin = (first + r) % ping->bins;
            float value = ((float *)&sum[r])[b];
            results[((size_t)(component)*ping->beams + tile * TILE + b) * ping->bins + bin] =
                convert_long_rte(max(value, 0.0f));
        }
    }
}
