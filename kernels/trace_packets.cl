/*
 * Nearest triangle along each ray, rays in packets: see trace.cl, whose bytes it gives. A program of its own,
 * compiled where there are rays enough for it to pay.
 */
#include "types.h"
#include "trace_hybrid.h"

/* A work-item takes PACKET rays, 16 or 64, neighbours in direction. An argument, since two kernels would compile
 * nearly all of this twice. */
__kernel void trace_packets(__global const dev_node8 *nodes, __global const dev_block4 *blocks,
                            __global const dev_ray *rays, __global dev_hit *hits, uint count,
                            uint root, float extent_m, uint packet) {
    uint first = packet * (uint)get_global_id(0);
    if (first < count && packet == 16) {
        trace_sixteen_new(nodes, blocks, rays, hits, first, count, root, extent_m);
    } else if (first < count) {
        trace_sixty_four(nodes, blocks, rays, hits, first, count, root, extent_m);
    }
}
