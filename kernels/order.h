/*
 * Where a ping's rays lie in memory, and which replicate each belongs to.
 *
 * Ray i of a ping belongs to group i mod groups: interleaved, equally good subsets, whose spread
 * tells the error. A batch holds neighbouring i, but not in their order: rays that fly together
 * should lie together, for the packets that trace them and for the triangles that they share.
 * The samplers' lattices step through azimuth by the golden section and slowly through elevation:
 * among F neighbours, F a Fibonacci number, ray r is the (r F' mod F)-th by azimuth, F' being the
 * Fibonacci number before F. So blocks of F rays are stored by azimuth; what is left at the end of a
 * batch stays as it is. Any other order would give the same bytes.
 */
#ifndef ASDIC_KERNEL_ORDER_H
#define ASDIC_KERNEL_ORDER_H

#include "ping_types.h"

/* A lane without a ray; what it sends is 0. */
#define NO_SLOT 0xffffffffu

/* Slots of a batch, a multiple of the vectors' width. */
static inline uint batch_slots(__global const dev_ping *ping) {
    return ping->groups * ping->per_group;
}

static inline uint permuted(__global const dev_ping *ping, uint at, uint step) {
    uint first = at / ping->order_block * ping->order_block;
    bool whole = first + ping->order_block <= batch_slots(ping);
    return whole ? first + (at - first) * step % ping->order_block : at;
}

/* The ray in SLOT, counted from the first of the batch. */
static inline uint ray_in(__global const dev_ping *ping, uint slot) {
    return permuted(ping, slot, ping->order_inverse);
}

/* The slot of a ray, counted from the first of the batch. */
static inline uint slot_of(__global const dev_ping *ping, uint ray) {
    return permuted(ping, ray, ping->order_step);
}

/* A batch begins with a ray of group 0. */
static inline uint group_in(__global const dev_ping *ping, uint slot) {
    return ray_in(ping, slot) % ping->groups;
}

#endif
