/*
 * Rays from one point, 64 or 16 of them: nodes are culled for all at once and rays are tested in
 * the leaves only. Unbeatable where a packet is narrow against the triangles; one that turns out
 * wide gives up after some work.
 */
#ifndef ASDIC_KERNEL_TRACE_FRUSTUM_H
#define ASDIC_KERNEL_TRACE_FRUSTUM_H

#include "trace_bundle.h"
#include "trace_wide8.h"

/* Work after which a packet gives up: a node counts 1, a leaf 2, each of its triangles that a group of
 * sixteen has to test 1; each is some fifty cycles. About what the rays cost in smaller parts. */
#define FRUSTUM_BUDGET_64 800
#define FRUSTUM_BUDGET_16 300

/* Four triangles of a leaf, seen from the packet's origin. */
typedef struct seen4 {
    float4 corner[9];       /* relative to the origin, permuted */
    float4 near[3], far[3]; /* their boxes' planes, by axis: distance from the shifted origins */
} seen4;

static inline void see_corners(__global const float4 *v, const frustum *f, seen4 *s) {
#pragma unroll
    for (uint c = 0; c < 3; c++) {
        s->corner[3 * c] = v[3 * c + f->kx] - f->o[0];
        s->corner[3 * c + 1] = v[3 * c + f->ky] - f->o[1];
        s->corner[3 * c + 2] = v[3 * c + f->kz] - f->o[2];
    }
}

/* One axis of their boxes: the planes that rays meet first and last. */
static inline void see_planes(__global const float4 *v, const bound *a, uint k, float4 *near,
                              float4 *far) {
    float4 least = LESSER(LESSER(v[k], v[3 + k]), v[6 + k]);
    float4 most = GREATER(GREATER(v[k], v[3 + k]), v[6 + k]);
    float4 lo = BOX_LO(least, most), hi = BOX_HI(least, most);
    int4 flip = (int4)(-(int)(a->near_row & 1));
    *near = (flip ? hi : lo) - a->near_o;
    *far = (flip ? lo : hi) - a->far_o;
}

static inline void see_boxes(__global const float4 *v, const frustum *f, seen4 *s) {
#pragma unroll
    for (uint k = 0; k < 3; k++) {
        see_planes(v, &f->axis[k], k, &s->near[k], &s->far[k]);
    }
}

/* The edge of four outlines that runs between two corners: outside is a sx + b sy > d. */
typedef struct edge4 {
    float4 a, b, d;
} edge4;

/* Four triangles in the plane of (x / z, y / z), where a ray is the point (sx, sy). */
typedef struct outline4 {
    edge4 edge[3];
    int4 plain;  /* all corners ahead, and not far aside: the outline can be trusted */
    float4 area; /* twice */
} outline4;

/* The edges lie outside of the triangles by more than what rounding and the tolerance of the exact
 * test can add. */
static inline outline4 outline_of(const seen4 *s, float ahead) {
    outline4 o;
    float4 x[3], y[3];
    o.plain = (int4)(-1);
#pragma unroll
    for (uint c = 0; c < 3; c++) {
        float4 z = s->corner[3 * c + 2], inverse = 1.0f / z;
        x[c] = s->corner[3 * c] * inverse;
        y[c] = s->corner[3 * c + 1] * inverse;
        o.plain &= (z * ahead > 0.0f) & (fabs(x[c]) < 8.0f) & (fabs(y[c]) < 8.0f);
    }
    /* Seen from much nearer one corner than another, a triangle's tolerance would outgrow the slack. */
    float4 z0 = s->corner[2] * ahead, z1 = s->corner[5] * ahead, z2 = s->corner[8] * ahead;
    o.plain &= GREATER(GREATER(z0, z1), z2) <= 8.0f * LESSER(LESSER(z0, z1), z2);
    float4 area = (x[2] - x[0]) * (y[1] - y[0]) - (y[2] - y[0]) * (x[1] - x[0]);
    o.area = fabs(area);
    float4 sign = area < 0.0f ? (float4)(1.0f) : (float4)(-1.0f), slack = 1e-3f * fabs(area);
#pragma unroll
    for (uint c = 0; c < 3; c++) {
        uint next = c == 2 ? 0 : c + 1;
        float4 a = sign * (y[next] - y[c]), b = sign * (x[c] - x[next]);
        o.edge[c].a = a;
        o.edge[c].b = b;
        float4 room = fused((float4)(1e-5f), fabs(a) + fabs(b), slack);
        o.edge[c].d = fused(a, x[c], fused(b, y[c], room));
    }
    return o;
}

/* Which triangles the window of which group touches, as bit 4 * group + triangle. */
static inline uint touch4(const outline4 *o, const frustum *f) {
    int16 beyond = (int16)(0);
#pragma unroll
    for (uint c = 0; c < 3; c++) {
        float16 a = o->edge[c].a.xyzwxyzwxyzwxyzw, b = o->edge[c].b.xyzwxyzwxyzwxyzw;
        float16 nearest = fused(a, f->window[0], b * f->window[1]) -
                          fused(fabs(a), f->window[2], fabs(b) * f->window[3]);
        beyond |= nearest > o->edge[c].d.xyzwxyzwxyzwxyzw;
    }
    return bits16(~(beyond & o->plain.xyzwxyzwxyzwxyzw));
}

/* Four rays of the group at each of four outlines. */
static inline float16 four_rays(const float16 *v, uint at) {
    return ((const float4 *)v)[at].xyzwxyzwxyzwxyzw;
}

/* Within which outlines some ray of the group lies that may meet the triangle before what it has met:
 * NEAREST is how far the triangles are along the packet's axis. Sixteen pairs of ray and outline at once,
 * all of them: to look at one outline after the other costs wrongly foreseen branches. */
static inline uint holding(const outline4 *o, float4 nearest, const group16 *g) {
    int16 within = (int16)(0), plain = o->plain.xxxxyyyyzzzzwwww;
    float16 ahead = nearest.xxxxyyyyzzzzwwww, a[3], b[3], d[3];
#pragma unroll
    for (uint c = 0; c < 3; c++) {
        a[c] = o->edge[c].a.xxxxyyyyzzzzwwww;
        b[c] = o->edge[c].b.xxxxyyyyzzzzwwww;
        d[c] = o->edge[c].d.xxxxyyyyzzzzwwww;
    }
#pragma unroll
    for (uint at = 0; at < 4; at++) {
        float16 sx = four_rays(&g->sx, at), sy = four_rays(&g->sy, at);
        int16 beyond = ahead * four_rays(&g->sz, at) > four_rays(&g->best.t, at);
#pragma unroll
        for (uint c = 0; c < 3; c++) {
            beyond |= fused(a[c], sx, b[c] * sy) > d[c];
        }
        within |= ~beyond;
    }
    uint bits = bits16(within | ~plain);
    bits |= bits >> 2;
    bits = (bits | bits >> 1) & 0x1111;
    return (bits * 0x1248 >> 12) & 0xf;
}

/* Those of the touched triangles that some ray may meet; where the outline cannot be trusted, all. */
static inline uint holding4(const outline4 *o, float4 nearest, uint touched, const group16 *g) {
    uint kept = 0;
    for (uint i = 0; i < 4; i++) {
        uint mine = touched & (0xfu << 4 * i);
        kept |= mine ? mine & (holding(o, nearest, &g[i]) << 4 * i) : 0;
    }
    return kept;
}

/* A corner's coordinate for each ray: of the packet's axes the AT-th after the ray's own dominant one. */
static inline float16 turned(const float *corner, const group16 *g, uint at) {
    return choose3(g->turn, (float16)(corner[4 * at]), (float16)(corner[4 * ((at + 1) % 3)]),
                   (float16)(corner[4 * ((at + 2) % 3)]));
}

static inline int16 meet_turned(const float *v, const group16 *g, float16 *over, float16 *under) {
    return intersect16(turned(v, g, 0), turned(v, g, 1), turned(v, g, 2), turned(v + 12, g, 0),
                       turned(v + 12, g, 1), turned(v + 12, g, 2), turned(v + 24, g, 0),
                       turned(v + 24, g, 1), turned(v + 24, g, 2), g->own_x, g->own_y, g->own_z,
                       over, under);
}

static inline int16 meet(const float *v, const group16 *g, float16 *over, float16 *under) {
    return intersect16((float16)(v[0]), (float16)(v[4]), (float16)(v[8]), (float16)(v[12]),
                       (float16)(v[16]), (float16)(v[20]), (float16)(v[24]), (float16)(v[28]),
                       (float16)(v[32]), g->sx, g->sy, g->sz, over, under);
}

/* No early way out: what touches mostly hits, and a branch taken wrongly costs more
 * than the rest of the test. */
static inline void hit_seen(const seen4 *s, uint lane, uint id, bool one_axis, group16 *g) {
    const float *v = (const float *)s->corner + lane;
    const float *near = (const float *)s->near + lane, *far = (const float *)s->far + lane;
    float16 over, under;
    int16 met = one_axis ? meet(v, g, &over, &under) : meet_turned(v, g, &over, &under);
    float16 t = over / under;
    float16 in = GREATER(near[0] * g->inverse[0], near[4] * g->inverse[1]);
    float16 out = LESSER(far[0] * g->inverse[0], far[4] * g->inverse[1]);
    in = GREATER(GREATER(in, near[8] * g->inverse[2]), (float16)(0.0f));
    out = LESSER(out, far[8] * g->inverse[2]);
    t = GREATER(t, in);
    hits16 best = g->best;
    met &= (in <= out) & ((t < best.t) | ((t == best.t) & ((uint16)(id) < best.id)));
    g->best.t = met ? t : best.t;
    g->best.id = met ? (uint16)(id) : best.id;
}

/* Returns how many triangles were tested; ~0u: none, the packet is too wide for them. */
static inline uint hit_leaf(__global const dev_block4 *block, uint groups, frustum *f, group16 *g) {
    __global const float4 *v = (__global const float4 *)block;
    const bound *ahead = &f->axis[f->kz];
    seen4 seen;
    see_corners(v, f, &seen);
    outline4 outline = outline_of(&seen, ahead->least);
    if (f->widest > 0.0f) {
        float4 area = outline.plain ? outline.area : (float4)(INFINITY);
        if (!some4(area > f->widest)) {
            return ~0u;
        }
        f->picky = !some4(area > f->widest * FRUSTUM_WIDE_64);
        f->widest = 0.0f;
    }
    float4 nearest, farthest;
    see_planes(v, ahead, f->kz, &nearest, &farthest);
    uint bits = groups == 4 ? touch4(&outline, f) : holding(&outline, nearest, g);
    if (groups == 4 && f->picky) {
        bits = holding4(&outline, nearest, bits, g);
    }
    if (!bits) {
        return 0;
    }
    see_boxes(v, f, &seen);
    uint tested = popcount(bits);
    for (; bits; bits &= bits - 1) {
        uint bit = lowest_bit(bits), lane = bit & 3, id = block->id[lane];
        if (id != ~0u) {
            hit_seen(&seen, lane, id, f->one_axis, &g[bit >> 2]);
        }
    }
    set_limit(g, groups, f);
    return tested;
}

/* The nearest of the entered children, or DEV_EMPTY; the others go on the stack in order. Unlike for a
 * single ray it pays to sort: a packet that meets triangles in the wrong order tests many in vain. By
 * counting how many come later than each, not by exchanging: branches that nobody can foresee cost
 * more than all of it. */
static inline uint nearest_entered(__global const dev_node8 *nodes,
                                   __global const dev_block4 *blocks, uint word, const frustum *f,
                                   stack8 *s, uint *top) {
    float8 entry;
    float in[8];
    int key[8], place[8];
    __global const uint *child = nodes[word].child;
    int8 entered = enter_frustum8((__global const float8 *)&nodes[word], f, &entry);
    uint bits = bits8(entered), count = popcount(bits);
    if (count < 2) {
        return bits ? child[lowest_bit(bits)] : DEV_EMPTY;
    }
    /* Without their signs (of zeros) entries compare like integers; the lane makes them different. */
    int8 keys = (as_int8(entry) & 0x7ffffff8) | (int8)(0, 1, 2, 3, 4, 5, 6, 7), later = (int8)(0);
    keys = entered ? keys : (int8)(-1);
    vstore8(keys, 0, key);
    vstore8(entry, 0, in);
#pragma unroll
    for (uint i = 0; i < 8; i++) {
        later -= (int8)(key[i]) > keys;
    }
    vstore8(later, 0, place);
    for (; bits; bits &= bits - 1) {
        uint lane = lowest_bit(bits), at = *top + (uint)place[lane];
        fetch_early(nodes, blocks, child[lane]);
        s->child[at] = child[lane];
        s->entry[at] = in[lane];
    }
    *top += count - 1;
    return s->child[*top];
}

/* The nearest hits below WORD; false when BUDGET did not suffice. What was found until then is right:
 * it only has to be beaten. */
static inline bool walk_frustum(__global const dev_node8 *nodes, __global const dev_block4 *blocks,
                                uint word, uint groups, uint budget, frustum *f, group16 *g) {
    stack8 s;
    uint top = 0, work = 0;
    for (;;) {
        if (work > budget) {
            return false;
        }
        work++;
        if (word & DEV_LEAF) {
            uint tested = hit_leaf(&blocks[word & ~DEV_LEAF], groups, f, g);
            if (tested == ~0u) {
                return false;
            }
            work += 1 + tested;
        } else {
            uint child = nearest_entered(nodes, blocks, word, f, &s, &top);
            if (child != DEV_EMPTY) {
                word = child;
                continue;
            }
        }
        do {
            if (top == 0) {
                return true;
            }
            top--;
        } while (s.entry[top] > f->limit);
        word = s.child[top];
    }
}

#endif
