/*
 * Where a ping's rays lie in memory, and which group (replicate) each belongs to.
 *
 * Ray i of a ping belongs to group i mod groups. The groups are interleaved, equally good subsets, and their
 * spread tells the error. A batch holds rays with neighbouring i, stored so that rays of similar directions
 * lie together: packets trace them together, and they share triangles.
 *
 * The samplers' lattices step through azimuth by the golden section and slowly through elevation. Among F
 * neighbours, F a Fibonacci number and F' the one before it, ray r is the (r F' mod F)-th by azimuth. Blocks
 * of F rays are therefore stored by azimuth: the j-th is ray j I mod F with I F' = 1 modulo F. Rays that
 * fill no whole block at the end of a batch keep their order. Any other order would give the same bytes.
 */
#ifndef ASDIC_KERNEL_ORDER_H
#define ASDIC_KERNEL_ORDER_H

#include "ping_types.h"
#include "real.h"

/* A lane without a ray. */
#define NO_RAY 0xffffffffu

/* Slots of a batch, a multiple of the vectors' width. */
static inline uint batch_slots(__global const dev_ping *ping) {
    return ping->batch.groups * ping->batch.per_group;
}

/* The rays in SLOT and the slots that follow it, a lane each, counted from the first of the batch. */
static inline natural rays_in(__global const dev_ping *ping, uint slot) {
    const uint block = ping->batch.order_block;
    natural lane, image, first = (natural)(slot / block * block);
#if ASDIC_WIDTH == 1
    lane = image = 0u;
#else
    for (uint k = 0; k < ASDIC_WIDTH; k++) {
        ((uint *)&lane)[k] = k;
    }
    image = ASDIC_JOIN(vload, ASDIC_WIDTH)(0, ping->batch.order_lanes);
#endif
    natural at = slot - first + lane;
    image += (slot - first) * ping->batch.order_inverse % block;
    image = choose_natural(image >= block, image - block, image);
    natural next = choose_natural(at >= block, (natural)(block), (natural)(0u));
    at -= next;
    first += next;
    return first + choose_natural(first + block <= batch_slots(ping), image, at);
}

/* The ray in SLOT. */
static inline uint ray_in(__global const dev_ping *ping, uint slot) {
    uint first = slot / ping->batch.order_block * ping->batch.order_block, at = slot - first;
    bool whole = first + ping->batch.order_block <= batch_slots(ping);
    return first + (whole ? at * ping->batch.order_inverse % ping->batch.order_block : at);
}

/* A batch begins with a ray of group 0; the number of groups is a power of two. */
static inline uint group_of(__global const dev_ping *ping, uint ray) {
    return ray & (ping->batch.groups - 1u);
}

/* The position of a ray when the batch is counted group by group. */
static inline uint position_of(__global const dev_ping *ping, uint ray) {
    return group_of(ping, ray) * ping->batch.per_group + (ray >> popcount(ping->batch.groups - 1u));
}

#endif
