/*
 * One ray at a time, eight boxes at a time: the form for CPUs and rays without order.
 */
#ifndef ASDIC_KERNEL_TRACE_WIDE8_H
#define ASDIC_KERNEL_TRACE_WIDE8_H

#include "intersect.h"

/* A ray made ready for traversal. Planes are chosen by the sign of the direction, and the origin
 * is moved by the skin away from near planes and towards far planes. */
typedef struct ray8 {
    float o[3], near_o[3], far_o[3], inverse[3];
    uint near_row[3], far_row[3]; /* rows of a node: lo_x hi_x lo_y hi_y lo_z hi_z */
    int kx, ky, kz;
    float sx, sy, sz;
} ray8;

static inline ray8 ray8_prepare(dev_ray ray, float extent_m) {
    ray8 r;
    float reach = GREATER(GREATER(fabs(ray.origin[0]), fabs(ray.origin[1])), fabs(ray.origin[2]));
    float skin = (reach + extent_m) * TRACE_SKIN;
    for (int k = 0; k < 3; k++) {
        float d = ray.direction[k];
        float inward = d < 0.0f ? -skin : skin;
        r.o[k] = ray.origin[k];
        r.near_o[k] = ray.origin[k] + inward;
        r.far_o[k] = ray.origin[k] - inward;
        r.inverse[k] = safe_inverse(d);
        r.near_row[k] = 2 * k + (d < 0.0f);
        r.far_row[k] = 2 * k + !(d < 0.0f);
    }
    r.kz = dominant_axis(ray.direction[0], ray.direction[1], ray.direction[2]);
    r.kx = r.kz == 2 ? 0 : r.kz + 1;
    r.ky = r.kx == 2 ? 0 : r.kx + 1;
    r.sz = 1.0f / ray.direction[r.kz];
    r.sx = ray.direction[r.kx] / ray.direction[r.kz];
    r.sy = ray.direction[r.ky] / ray.direction[r.kz];
    return r;
}

/* Lanes of a comparison as bits; PoCL has no movemask. */
static inline uint bits8(int8 m) {
    return (uint)(((as_ulong(convert_char8(m)) & 0x8040201008040201ul) * 0x0101010101010101ul) >>
                  56);
}

static inline uint bits4(int4 m) {
    return ((as_uint(convert_char4(m)) & 0x08040201u) * 0x01010101u) >> 24;
}

static inline uint lowest_bit(uint bits) {
    return 31 - clz(bits & -bits);
}

/* Which of a node's boxes the ray enters before T_MAX, and where. */
static inline uint enter8(__global const float *node, const ray8 *r, float t_max, float8 *entry) {
    float8 x = SLAB(vload8(r->near_row[0], node), r->near_o[0], r->inverse[0]);
    float8 y = SLAB(vload8(r->near_row[1], node), r->near_o[1], r->inverse[1]);
    float8 z = SLAB(vload8(r->near_row[2], node), r->near_o[2], r->inverse[2]);
    float8 in = GREATER(GREATER(x, y), GREATER(z, (float8)(0.0f)));
    x = SLAB(vload8(r->far_row[0], node), r->far_o[0], r->inverse[0]);
    y = SLAB(vload8(r->far_row[1], node), r->far_o[1], r->inverse[1]);
    z = SLAB(vload8(r->far_row[2], node), r->far_o[2], r->inverse[2]);
    float8 out = LESSER(LESSER(x, y), LESSER(z, (float8)(t_max)));
    *entry = in;
    return bits8(in <= out);
}

/* The same for the boxes of a block's triangles; *IN and *OUT bound t. */
static inline void enter_triangles4(__global const float *v, const ray8 *r, float4 *in,
                                    float4 *out) {
    float4 near[3], far[3];
    for (int k = 0; k < 3; k++) {
        float4 a = vload4(k, v), b = vload4(3 + k, v), c = vload4(6 + k, v);
        float4 lo = LESSER(LESSER(a, b), c), hi = GREATER(GREATER(a, b), c);
        near[k] = SLAB((r->near_row[k] & 1) ? hi : lo, r->near_o[k], r->inverse[k]);
        far[k] = SLAB((r->near_row[k] & 1) ? lo : hi, r->far_o[k], r->inverse[k]);
    }
    *in = GREATER(GREATER(near[0], near[1]), GREATER(near[2], (float4)(0.0f)));
    *out = LESSER(LESSER(far[0], far[1]), far[2]);
}

static inline void hit_block(__global const dev_block4 *block, const ray8 *r, dev_hit *best) {
    __global const float *v = &block->v[0][0];
    int kx = r->kx, ky = r->ky, kz = r->kz;
    float ox = r->o[kx], oy = r->o[ky], oz = r->o[kz];
    float4 t;
    int4 met =
        intersect_lanes(vload4(kx, v) - ox, vload4(ky, v) - oy, vload4(kz, v) - oz,
                        vload4(3 + kx, v) - ox, vload4(3 + ky, v) - oy, vload4(3 + kz, v) - oz,
                        vload4(6 + kx, v) - ox, vload4(6 + ky, v) - oy, vload4(6 + kz, v) - oz,
                        (float4)(r->sx), (float4)(r->sy), (float4)(r->sz), &t);
    if (!bits4(met & (t > 0.0f))) {
        return;
    }
    float4 in, out;
    enter_triangles4(v, r, &in, &out);
    met &= (t > 0.0f) & (in <= out);
    t = LESSER(GREATER(t, in), out);
    float lane_t[4];
    vstore4(t, 0, lane_t);
    for (uint bits = bits4(met & (t <= best->t_m)); bits; bits &= bits - 1) {
        uint lane = lowest_bit(bits);
        if (lane_t[lane] < best->t_m ||
            (lane_t[lane] == best->t_m && block->id[lane] < best->triangle)) {
            best->t_m = lane_t[lane];
            best->triangle = block->id[lane];
        }
    }
}

/* Children still to visit, the nearest on top. */
typedef struct stack8 {
    uint child[TRACE_STACK];
    float entry[TRACE_STACK];
    uint top;
} stack8;

/* Puts the entered children on the stack, the nearest last. */
static inline void push_sorted(stack8 *s, __global const uint *child, uint bits, float8 entry) {
    float in[8];
    vstore8(entry, 0, in);
    uint floor = s->top;
    for (; bits; bits &= bits - 1) {
        uint lane = lowest_bit(bits);
        uint at = s->top++;
        while (at > floor && s->entry[at - 1] < in[lane]) {
            s->entry[at] = s->entry[at - 1];
            s->child[at] = s->child[at - 1];
            at--;
        }
        s->entry[at] = in[lane];
        s->child[at] = child[lane];
    }
}

static inline dev_hit trace_wide8(__global const dev_node8 *nodes,
                                  __global const dev_block4 *blocks, dev_ray ray, uint root,
                                  float extent_m) {
    dev_hit best = {ray.t_max, ~0u};
    ray8 r = ray8_prepare(ray, extent_m);
    stack8 s;
    s.top = 0;
    uint word = root;
    for (;;) {
        if (word & DEV_LEAF) {
            hit_block(&blocks[word & ~DEV_LEAF], &r, &best);
        } else {
            float8 entry;
            uint bits = enter8(nodes[word].lo_x, &r, best.t_m, &entry);
            if (bits && !(bits & (bits - 1))) {
                word = nodes[word].child[lowest_bit(bits)];
                continue;
            }
            push_sorted(&s, nodes[word].child, bits, entry);
        }
        do {
            if (s.top == 0) {
                return best;
            }
            s.top--;
            word = s.child[s.top];
        } while (s.entry[s.top] > best.t_m);
    }
}

#endif
