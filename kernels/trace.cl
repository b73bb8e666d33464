/*
 * Nearest triangle along each ray. All forms give the same bytes; they differ in speed only.
 *
 * EXTENT_M is the largest coordinate, by magnitude, of the scene's triangles. ROOT is a child
 * word: node 0, a leaf for a scene of one block, or DEV_EMPTY.
 */
#include "types.h"
#include "trace_wide8.h"

/* Sixty-four rays a work-item, each by itself. */
__kernel void trace_wide8(__global const dev_node8 *nodes, __global const dev_block4 *blocks,
                          __global const dev_ray *rays, __global dev_hit *hits, uint count,
                          uint root, float extent_m) {
    uint first = TURNS_RAYS * (uint)get_global_id(0);
    if (first < count) {
        trace_in_turns(nodes, blocks, rays, hits, first, count, root, extent_m);
    }
}
