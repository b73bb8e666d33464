/*
 * Which of sixteen rays enter any child of the root: most rays near an object in open water do not, and to
 * make a ray ready for a walk costs more than to find that out for sixteen at once.
 */
#ifndef ASDIC_KERNEL_TRACE_SIEVE_H
#define ASDIC_KERNEL_TRACE_SIEVE_H

#include "trace_lanes.h"

/* One axis of sixteen rays. */
typedef struct sieve_axis {
    float16 near_o, far_o, inverse;
    int16 negative;
} sieve_axis;

static inline sieve_axis sieve_axis_of(float16 o, float16 d, float16 skin) {
    sieve_axis a;
    a.negative = d < 0.0f;
    a.near_o = a.negative ? o - skin : o + skin;
    a.far_o = a.negative ? o + skin : o - skin;
    a.inverse = inverse16(d);
    return a;
}

/* Between two planes of a box. */
static inline void sieve_slab(float lo, float hi, const sieve_axis *a, float16 *in, float16 *out) {
    float16 first = a->negative ? (float16)(hi) : (float16)(lo);
    float16 last = a->negative ? (float16)(lo) : (float16)(hi);
    *in = GREATER(*in, SLAB(first, a->near_o, a->inverse));
    *out = LESSER(*out, SLAB(last, a->far_o, a->inverse));
}

/* Those of the rays R, as lanes, that have a length and enter a box below ROOT within it. */
static inline uint sieve16(__global const dev_node8 *nodes, rays16 r, uint root, float extent_m) {
    uint live = bits16(r.t_max > 0.0f);
    if (live == 0 || (root & DEV_LEAF)) {
        return root == DEV_EMPTY ? 0 : live;
    }
    __global const dev_node8 *node = &nodes[root];
    float16 reach = GREATER(GREATER(fabs(r.ox), fabs(r.oy)), fabs(r.oz));
    float16 skin = (reach + extent_m) * TRACE_SKIN;
    sieve_axis x = sieve_axis_of(r.ox, r.dx, skin), y = sieve_axis_of(r.oy, r.dy, skin),
               z = sieve_axis_of(r.oz, r.dz, skin);
    int16 enters = (int16)(0);
#pragma unroll
    for (uint k = 0; k < 8; k++) {
        float16 in = (float16)(0.0f), out = r.t_max;
        sieve_slab(node->lo_x[k], node->hi_x[k], &x, &in, &out);
        sieve_slab(node->lo_y[k], node->hi_y[k], &y, &in, &out);
        sieve_slab(node->lo_z[k], node->hi_z[k], &z, &in, &out);
        enters |= in <= out;
    }
    return bits16(enters) & live;
}

#endif
