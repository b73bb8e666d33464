/*
 * From the groups' accumulators to the ping's sums: suffix sums of the water, totals, spread.
 */
#include "ping_types.h"
#include "real.h"

/* A ray crosses every bin before its last one: turns "rays that end in bin n" into "rays that
 * cross bin n". One work-item per group and beam. */
__kernel void suffix(__global const dev_ping *ping, __global long *accumulator) {
    uint id = (uint)(get_global_id(0));
    uint group = id / ping->beams, beam = id - group * ping->beams;
    if (group >= ping->groups) {
        return;
    }
    size_t plane = (size_t)(ping->bins) * ping->beams;
    __global long *cell =
        accumulator + (group * (size_t)(DEV_DEPOSIT_COUNT) + DEV_DEPOSIT_VOLUME) * plane + beam;
    long sum = 0;
    for (uint bin = ping->bins; bin-- > 0u;) {
        sum += cell[(size_t)(bin)*ping->beams];
        cell[(size_t)(bin)*ping->beams] = sum;
    }
}

/* Relative standard error of the mean of COUNT groups' totals: groups g, g + COUNT, ... pooled. */
static float spread(const float *totals, uint groups, uint count) {
    float mean = 0.0f, square = 0.0f;
    for (uint g = 0; g < groups; g++) {
        mean += totals[g];
    }
    if (mean <= 0.0f) {
        return 0.0f;
    }
    mean /= (float)(count);
    for (uint r = 0; r < count; r++) {
        float pooled = 0.0f;
        for (uint g = r; g < groups; g += count) {
            pooled += totals[g];
        }
        float d = pooled / mean - 1.0f;
        square += d * d;
    }
    return sqrt(square / ((float)(count) * (float)(count - 1u)));
}

/*
 * One work-item per (bin, beam): sums over groups for every component, and the relative standard
 * error of the total from groups pooled to 16, 8, 4 and 2 (SPREADS, 4 per cell; 0 where there are
 * fewer groups). VOLUME_RATIO[bin] turns water quanta into units of the bin's TL d^2.
 */
__kernel void reduce(__global const dev_ping *ping, __global const long *accumulator,
                     __global const float *volume_ratio, __global long *sums,
                     __global float *spreads) {
    size_t cell = get_global_id(0);
    size_t plane = (size_t)(ping->bins) * ping->beams;
    if (cell >= plane) {
        return;
    }
    float totals[DEV_MAX_GROUPS];
    for (uint g = 0; g < ping->groups; g++) {
        totals[g] = 0.0f;
    }
    for (uint c = 0; c < DEV_DEPOSIT_COUNT; c++) {
        float unit = 1.0f / ping->deposit_scale[c];
        if (c == DEV_DEPOSIT_VOLUME) {
            unit *= volume_ratio[cell / ping->beams];
        }
        long sum = 0;
        for (uint g = 0; g < ping->groups; g++) {
            long quanta = accumulator[(g * (size_t)(DEV_DEPOSIT_COUNT) + c) * plane + cell];
            sum += quanta;
            totals[g] += convert_float(quanta) * unit;
        }
        sums[c * plane + cell] = sum;
    }
    for (uint level = 0; level < 4u; level++) {
        uint count = 16u >> level;
        spreads[cell * 4u + level] =
            count <= ping->groups ? spread(totals, ping->groups, count) : 0.0f;
    }
}
