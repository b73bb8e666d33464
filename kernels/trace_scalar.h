/*
 * One ray a work-item and no vectors: the form for GPUs, where the lanes are the work-items.
 */
#ifndef ASDIC_KERNEL_TRACE_SCALAR_H
#define ASDIC_KERNEL_TRACE_SCALAR_H

#include "intersect.h"

DEFINE_INTERSECT(intersect1, float, int)

/* A ray made ready: planes of low coordinates meet lo_o, those of high ones hi_o. */
typedef struct ray1 {
    float o[3], lo_o[3], hi_o[3], inverse[3];
    float sx, sy, sz;
    uint kz;
} ray1;

static inline ray1 ray1_prepare(dev_ray ray, float extent_m) {
    ray1 r;
    float skin = ray_skin(ray.origin[0], ray.origin[1], ray.origin[2], extent_m);
#pragma unroll
    for (uint k = 0; k < 3; k++) {
        r.o[k] = ray.origin[k];
        r.lo_o[k] = ray.origin[k] + skin;
        r.hi_o[k] = ray.origin[k] - skin;
        r.inverse[k] = safe_inverse(ray.direction[k]);
    }
    float x = ray.direction[0], y = ray.direction[1], z = ray.direction[2];
    r.kz = dominant_axis(x, y, z);
    r.sz = r.kz == 0 ? r.inverse[0] : r.kz == 1 ? r.inverse[1] : r.inverse[2];
    r.sx = (r.kz == 0 ? y : r.kz == 1 ? z : x) * r.sz;
    r.sy = (r.kz == 0 ? z : r.kz == 1 ? x : y) * r.sz;
    return r;
}

/* Entry and exit of a box, one axis. */
static inline void enter_axis1(float lo, float hi, const ray1 *r, uint k, float *in, float *out) {
    float a = SLAB(lo, r->lo_o[k], r->inverse[k]), b = SLAB(hi, r->hi_o[k], r->inverse[k]);
    *in = GREATER(*in, LESSER(a, b));
    *out = LESSER(*out, GREATER(a, b));
}

/* Brings the dominant axis of (x, y, z) to the end. */
static inline void permute(float x, float y, float z, uint kz, float *out) {
    out[0] = kz == 0 ? y : kz == 1 ? z : x;
    out[1] = kz == 0 ? z : kz == 1 ? x : y;
    out[2] = kz == 0 ? x : kz == 1 ? y : z;
}

static inline void hit_triangle1(__global const float *v, uint id, const ray1 *r, dev_hit *best) {
    float a[3], b[3], c[3], over, under;
    permute(v[0] - r->o[0], v[4] - r->o[1], v[8] - r->o[2], r->kz, a);
    permute(v[12] - r->o[0], v[16] - r->o[1], v[20] - r->o[2], r->kz, b);
    permute(v[24] - r->o[0], v[28] - r->o[1], v[32] - r->o[2], r->kz, c);
    if (!intersect1(a[0], a[1], a[2], b[0], b[1], b[2], c[0], c[1], c[2], r->sx, r->sy, r->sz,
                    &over, &under)) {
        return;
    }
    float t = over / under;
    float in = 0.0f, out = INFINITY;
#pragma unroll
    for (uint k = 0; k < 3; k++) {
        float p = v[4 * k], q = v[12 + 4 * k], s = v[24 + 4 * k];
        float lo = LESSER(LESSER(p, q), s), hi = GREATER(GREATER(p, q), s);
        enter_axis1(BOX_LO(lo, hi), BOX_HI(lo, hi), r, k, &in, &out);
    }
    t = GREATER(t, in);
    if (in <= out && (t < best->t_m || (t == best->t_m && id < best->triangle))) {
        best->t_m = t;
        best->triangle = id;
    }
}

static inline void hit_block1(__global const dev_block4 *block, const ray1 *r, dev_hit *best) {
    for (uint lane = 0; lane < DEV_LEAF_TRIANGLES; lane++) {
        uint id = block->id[lane];
        if (id == ~0u) {
            return; /* unused lanes come last */
        }
        hit_triangle1(&block->v[0][lane], id, r, best);
    }
}

/* Inner nodes on the way down that have children left to visit, one bit each. GPUs keep a private array
 * in slow memory: it holds two words a level, where a stack of children would hold fourteen. TRACE_STACK
 * is at least 7 for each level and 8. */
#define LEVELS (TRACE_STACK / 7)
#define ALL_CHILDREN 0xffu

typedef struct stack1 {
    uint node[LEVELS], left[LEVELS];
} stack1;

/* The nearest of NODE's children in *LEFT that the ray enters before T_MAX, or DEV_EMPTY. The others that
 * it enters stay in *LEFT. */
static inline uint enter_node1(__global const dev_node8 *node, const ray1 *r, float t_max,
                               uint *left) {
    uint word = DEV_EMPTY, entered = 0u, taken = 0u;
    float nearest = INFINITY;
    for (uint i = 0; i < DEV_BVH_WIDTH; i++) {
        uint bit = 1u << i;
        if ((*left & bit) == 0u) {
            continue;
        }
        uint child = node->child[i];
        float in = 0.0f, out = t_max;
        enter_axis1(node->lo_x[i], node->hi_x[i], r, 0, &in, &out);
        enter_axis1(node->lo_y[i], node->hi_y[i], r, 1, &in, &out);
        enter_axis1(node->lo_z[i], node->hi_z[i], r, 2, &in, &out);
        if (child == DEV_EMPTY || !(in <= out)) {
            continue;
        }
        entered |= bit;
        if (in < nearest || word == DEV_EMPTY) {
            word = child;
            nearest = in;
            taken = bit;
        }
    }
    *left = entered & ~taken;
    return word;
}

/* The nearest hit below WORD, if it is nearer than *BEST. */
static inline void walk1(__global const dev_node8 *nodes, __global const dev_block4 *blocks,
                         const ray1 *r, uint word, dev_hit *best) {
    stack1 s;
    uint top = 0;
    for (;;) {
        uint node = word, left = ALL_CHILDREN;
        if (word & DEV_LEAF) {
            if (word != DEV_EMPTY) {
                hit_block1(&blocks[word & ~DEV_LEAF], r, best);
            }
            if (top == 0u) {
                return;
            }
            top--;
            node = s.node[top];
            left = s.left[top];
        }
        word = enter_node1(&nodes[node], r, best->t_m, &left);
        if (left != 0u) {
            s.node[top] = node;
            s.left[top] = left;
            top++;
        }
    }
}

#endif
