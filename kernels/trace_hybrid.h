/*
 * Which way packets of rays go. Rays from one point: as a frustum of 64, then of 16 (trace_frustum.h);
 * where that gives up they are too far apart for company and go in turns (trace_wide8.h). Rays from
 * several points: trace_packet.h.
 */
#ifndef ASDIC_KERNEL_TRACE_HYBRID_H
#define ASDIC_KERNEL_TRACE_HYBRID_H

#include "trace_frustum.h"
#include "trace_packet.h"

/* The rays R, FIRST .. FIRST + 15 of RAYS, in the best way there is; KNOWN is what was found so far. */
TRACE_APART static void trace_sixteen(__global const dev_node8 *nodes,
                                      __global const dev_block4 *blocks,
                                      __global const dev_ray *rays, __global dev_hit *hits,
                                      rays16 r, hits16 known, uint first, uint count, uint root,
                                      float extent_m) {
    frustum f;
    group16 g;
    if (root == DEV_EMPTY || !frustum_prepare(&r, 1, extent_m, &f, &g)) {
        trace_packet16(nodes, blocks, rays, hits, r, known, first, count, root, extent_m);
        return;
    }
    g.best = known;
    f.limit = greatest16(known.t);
    bool done = walk_frustum(nodes, blocks, root, 1, FRUSTUM_BUDGET_16, &f, &g);
    if (!done) {
        rays16 nearer = r;
        nearer.t_max = g.best.t;
        uint lanes = sieve16(nodes, nearer, root, extent_m);
        g.best = walk_singly(nodes, blocks, &rays[first], g.best, lanes, root, extent_m);
    }
    store_hits16(hits, first, count, g.best);
}

TRACE_APART static void trace_sixteen_new(__global const dev_node8 *nodes,
                                          __global const dev_block4 *blocks,
                                          __global const dev_ray *rays, __global dev_hit *hits,
                                          uint first, uint count, uint root, float extent_m) {
    rays16 r = load_rays16(rays, first, count);
    hits16 none = {r.t_max, (uint16)(~0u)};
    trace_sixteen(nodes, blocks, rays, hits, r, none, first, count, root, extent_m);
}

TRACE_APART static void trace_sixty_four(__global const dev_node8 *nodes,
                                         __global const dev_block4 *blocks,
                                         __global const dev_ray *rays, __global dev_hit *hits,
                                         uint first, uint count, uint root, float extent_m) {
    rays16 r[4];
    frustum f;
    group16 g[4];
    bool whole = first + 64 <= count && root != DEV_EMPTY;
    for (uint i = 0; i < 4 && whole; i++) {
        r[i] = load_rays16(rays, first + 16 * i, count);
    }
    if (!whole || !frustum_prepare(r, 4, extent_m, &f, g)) {
        for (uint at = first; at < first + 64 && at < count; at += 16) {
            trace_sixteen_new(nodes, blocks, rays, hits, at, count, root, extent_m);
        }
        return;
    }
    bool done = walk_frustum(nodes, blocks, root, 4, FRUSTUM_BUDGET_64, &f, g);
    for (uint i = 0; i < 4; i++) {
        uint at = first + 16 * i;
        if (done) {
            store_hits16(hits, at, count, g[i].best);
        } else {
            trace_sixteen(nodes, blocks, rays, hits, r[i], g[i].best, at, count, root, extent_m);
        }
    }
}

#endif
