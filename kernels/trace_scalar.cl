/*
 * Nearest triangle along each ray, one ray a work-item: see trace.cl, whose bytes it gives. A
 * program of its own, so that no GPU compiles the wide forms.
 */
#include "trace_scalar.h"
#include "types.h"

__kernel void trace_scalar(__global const dev_node8 *nodes, __global const dev_block4 *blocks,
                           __global const dev_ray *rays, __global dev_hit *hits, uint count,
                           uint root, float extent_m) {
    uint i = (uint)get_global_id(0);
    if (i >= count) {
        return;
    }
    dev_ray ray = rays[i];
    dev_hit hit = {ray.t_max, ~0u};
    if (ray.t_max > 0.0f && root != DEV_EMPTY) {
        ray1 r = ray1_prepare(ray, extent_m);
        walk1(nodes, blocks, &r, root, &hit);
    }
    hit.t_m = hit.triangle == ~0u ? INFINITY : hit.t_m;
    hits[i] = hit;
}
