/*
 * Pings of few rays go to a device several at a time. A launch of a kernel then has two dimensions: each
 * ping has a row of work-groups, which works on that ping's part of every buffer and nothing else.
 */
#ifndef ASDIC_KERNEL_PING_BATCH_H
#define ASDIC_KERNEL_PING_BATCH_H

#include "order.h"

/* The ping of this row. */
static inline __global const dev_ping *row_ping(__global const dev_ping *pings) {
    __global const char *bytes = (__global const char *)pings;
    return (__global const dev_ping *)(bytes + get_group_id(1) * (size_t)(pings->stride));
}

/* Slots of the rows before this one. */
static inline size_t row_slots(__global const dev_ping *ping) {
    return get_group_id(1) * (size_t)(batch_slots(ping));
}

/* Its accumulator. */
static inline __global long *row_cells(__global const dev_ping *ping, __global long *accumulator) {
    return accumulator + get_group_id(1) * (size_t)(ping->sums.blocks) * ping->sums.group_cells;
}

/* Where its groups' totals begin. */
static inline size_t row_first_total(__global const dev_ping *ping) {
    return get_group_id(1) * (size_t)(ping->batch.groups) * ping->sums.total_cells;
}

/* Two tables by bins, one behind the other: the inverse of the water's integral, and what turns water
 * quanta into units of the bin's TL d^2. */
static inline __global const float *row_water(__global const dev_ping *ping,
                                              __global const float *water) {
    return water + get_group_id(1) * (size_t)(2u * ping->bins);
}

#endif
