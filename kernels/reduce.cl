/*
 * From the groups' accumulators to the ping's sums: totals and their spread over groups.
 */
#include "deposit.h"

/* Water that ends in a bin to water that crosses it; ACCUMULATOR is [group][component][bin][beam]. One
 * work-item per group and beam. Work-items that own their group have done it in shade. */
__kernel void suffix(__global const dev_ping *ping, __global long *accumulator) {
    uint id = (uint)(get_global_id(0));
    uint group = id / ping->beams, beam = id - group * ping->beams;
    if (group >= ping->groups) {
        return;
    }
    size_t plane = (size_t)(ping->bins) * ping->beams;
    deposit_sum_crossings(
        accumulator + (group * (size_t)(ping->components) + DEV_DEPOSIT_VOLUME) * plane + beam,
        ping->bins, ping->beams);
}

/* Relative standard error of the sum of the groups' totals. */
static float spread(const float *totals, uint groups) {
    float mean = 0.0f, square = 0.0f;
    for (uint g = 0; g < groups; g++) {
        mean += totals[g];
    }
    if (mean <= 0.0f) {
        return 0.0f;
    }
    mean /= (float)(groups);
    for (uint g = 0; g < groups; g++) {
        float d = totals[g] / mean - 1.0f;
        square += d * d;
    }
    return sqrt(square / ((float)(groups) * (float)(groups - 1u)));
}

/*
 * One work-item per (bin, beam): sums over groups for every component, then the relative standard
 * error of the total. RESULTS holds a plane [beam][bin] of sums per component, the number of deposits that
 * had to be cut, and a plane of floats. VOLUME_RATIO[bin] turns water quanta into units of the
 * bin's TL d^2. Clears what it read, for the next ping.
 */
__kernel void reduce(__global const dev_ping *ping, __global long *accumulator,
                     __global const float *volume_ratio, __global uint *saturated,
                     __global long *results) {
    size_t cell = get_global_id(0);
    size_t plane = (size_t)(ping->bins) * ping->beams;
    if (cell >= plane) {
        return;
    }
    size_t at = cell % ping->beams * ping->bins + cell / ping->beams;
    float totals[DEV_MAX_GROUPS];
    for (uint g = 0; g < ping->groups; g++) {
        totals[g] = 0.0f;
    }
    for (uint c = 0; c < ping->components; c++) {
        float unit = 1.0f / ping->deposit_scale[c];
        if (c == DEV_DEPOSIT_VOLUME) {
            unit *= volume_ratio[cell / ping->beams];
        }
        long sum = 0;
        for (uint g = 0; g < ping->groups; g++) {
            __global long *from = accumulator + (g * (size_t)(ping->components) + c) * plane + cell;
            long quanta = *from;
            *from = 0;
            sum += quanta;
            totals[g] += convert_float(quanta) * unit;
        }
        results[c * plane + at] = sum;
    }
    __global float *spreads = (__global float *)(results + ping->components * plane + 1u);
    spreads[at] = spread(totals, ping->groups);
    if (cell == 0) {
        results[ping->components * plane] = (long)(*saturated);
        *saturated = 0u;
    }
}
