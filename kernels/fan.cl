/*
 * Many receivers: every arrival is weighed by every receiver's own pattern.
 *
 * shade.cl and multipath.cl leave arrivals, one direction each, in the order of their rays (receive.h).
 * fan_count, fan_place and fan_scatter sort them by range: a list of entries for every bin. fan_project
 * sums each list for all receivers, which are the lanes of its vectors. A sort that keeps the order of
 * rays makes every sum a sum in the order of rays, so that its bytes do not depend on work-groups.
 */
#include "fan_sums.h"

/* fan_count: COUNTS of one block of rays each work-item. */
__kernel void fan_count(__global const dev_ping *ping, __global const dev_arrival *arrivals,
                        __global uint *counts, __global uint *made, uint blocks) {
    uint block = (uint)(get_global_id(0));
    if (block >= blocks) {
        return;
    }
    if (block == 0u) {
        *made = 0u;
    }
    for (uint bin = 0; bin < ping->bins; bin++) {
        counts[(size_t)(bin)*blocks + block] = 0u;
    }
    fan_sort sort = {ping, counts, 0, blocks, block};
    sort_block(&sort, arrivals);
}

/* fan_place: room for the list of one bin each work-item, the blocks' parts one behind the other. Which
 * list comes first in memory is of no account. */
__kernel void fan_place(__global const dev_ping *ping, __global uint *counts,
                        __global fan_list *lists, __global uint *made, uint blocks) {
    uint bin = (uint)(get_global_id(0)), total = 0u;
    if (bin >= ping->bins) {
        return;
    }
    __global uint *own = counts + (size_t)(bin)*blocks;
    for (uint block = 0; block < blocks; block++) {
        total += own[block];
    }
    fan_list list = {atomic_add(made, total), total};
    lists[bin] = list;
    for (uint block = 0, next = list.first; block < blocks; block++) {
        uint count = own[block];
        own[block] = next;
        next += count;
    }
}

/* fan_scatter: the entries of one block of rays each work-item to their lists. */
__kernel void fan_scatter(__global const dev_ping *ping, __global const dev_arrival *arrivals,
                          __global uint *counts, __global fan_entry *entries, uint blocks) {
    uint block = (uint)(get_global_id(0));
    if (block < blocks) {
        fan_sort sort = {ping, counts, entries, blocks, block};
        sort_block(&sort, arrivals);
    }
}

/* fan_runs: of the list of one bin each work-item. */
__kernel void fan_runs(__global const dev_ping *ping, __global fan_entry *entries,
                       __global const fan_list *lists) {
    uint bin = (uint)(get_global_id(0));
    if (bin < ping->bins) {
        __global fan_entry *entry = entries + lists[bin].first;
        for (__global fan_entry *end = entry + lists[bin].count; entry < end;) {
            entry = make_run(ping, entry, end);
        }
    }
}

/* fan_project: tile TILE_AT of receivers. RESULTS: quanta as floats, rows [receiver][sum]; ADD: to
 * those of the batches before. One work-item per BINS bins and RECEIVERS receivers. */
__kernel void fan_project(__global const dev_ping *ping, __global const fan_entry *entries,
                          __global const fan_list *lists, __global float *results, uint tile_at,
                          uint add, __global const dev_truth_row *rows, __global float *cells) {
    const uint parts = (uint)(DEV_FAN_TILE) / RECEIVERS, id = (uint)(get_global_id(0));
    uint receiver = tile_at * (uint)(DEV_FAN_TILE) + id % parts * RECEIVERS;
    uint bin = id / parts * BINS;
    if (receiver < ping->beams && bin < ping->bins) {
#if ASDIC_TRUTH
        size_t before = tile_at * (size_t)(ping->sums.truth_cells) * ping->sums.truth_columns;
        fan_truth truth = {ping->sums.truth_rows != 0u ? rows : 0, cells + before, 0u, 0u, 0u};
#endif
        project(ping, entries, lists, results + (size_t)(receiver)*SUMS * DEV_FAN_ROW(ping->bins) + bin,
                receiver, bin, add TRUTH_ARGUMENT);
    }
}
