/*
 * Rays from one point, 64 or 16 of them: nodes are culled for all at once and rays are tested in
 * the leaves only. Unbeatable where a packet is narrow against the triangles; one that turns out
 * wide gives up after some work.
 */
#ifndef ASDIC_KERNEL_TRACE_FRUSTUM_H
#define ASDIC_KERNEL_TRACE_FRUSTUM_H

#include "trace_lanes.h"
#include "trace_wide8.h"

/* Work after which a packet gives up: a node counts 1, a leaf 2, each of its triangles that a group of
 * sixteen has to test 1; each is some fifty cycles. About what the rays cost in smaller parts. */
#define FRUSTUM_BUDGET_64 400
#define FRUSTUM_BUDGET_16 300

/* A packet gives up at its first leaf already when a group's window is so many times larger than the
 * leaf's largest triangle: its rays then meet a triangle each. */
#define FRUSTUM_WIDE_64 8.0f
#define FRUSTUM_WIDE_16 64.0f

/* Sixteen rays; s as in intersect.h. */
typedef struct group16 {
    float16 inverse[3];
    float16 sx, sy, sz;
    hits16 best;
} group16;

/* What the rays of one axis share, and the range of their inverse directions. */
typedef struct bound {
    float near_o, far_o, least, most;
    uint near_row; /* row of the node; the far one is ^ 1 */
} bound;

typedef struct frustum {
    bound axis[3];
    float o[3]; /* the origin, permuted */
    uint kx, ky, kz;
    float16 window[4]; /* centre and half width of (sx, sy): lane 4 * group + triangle */
    float limit;       /* the farthest hit so far */
    float widest; /* twice the area of the largest window, over how often a triangle may go into it;
                          0 once that was checked */
} frustum;

/* All rays from one point, and none skipped. */
static inline bool share_origin(const rays16 *r, uint groups) {
    int16 other = (int16)(0);
    for (uint g = 0; g < groups; g++) {
        float16 sum = (r[g].dx + r[g].dy) + r[g].dz;
        other |= (r[g].ox != r[0].ox.s0) | (r[g].oy != r[0].oy.s0) | (r[g].oz != r[0].oz.s0);
        other |= !(r[g].t_max > 0.0f) | !(fabs(sum) < INFINITY);
    }
    return !any16(other) && fabs(r[0].ox.s0 + r[0].oy.s0 + r[0].oz.s0) < INFINITY;
}

/* All directions have the signs and the dominant axis of the first one. */
static inline bool share_octant(const rays16 *r, uint groups, uint kz) {
    int16 other = (int16)(0);
    for (uint g = 0; g < groups; g++) {
        other |= (r[g].dx < 0.0f) ^ (int16)(r[0].dx.s0 < 0.0f ? -1 : 0);
        other |= (r[g].dy < 0.0f) ^ (int16)(r[0].dy.s0 < 0.0f ? -1 : 0);
        other |= (r[g].dz < 0.0f) ^ (int16)(r[0].dz.s0 < 0.0f ? -1 : 0);
        float16 ax = fabs(r[g].dx), ay = fabs(r[g].dy), az = fabs(r[g].dz);
        other |= kz == 0   ? ~((ax >= ay) & (ax >= az))
                 : kz == 1 ? ~((ay > ax) & (ay >= az))
                           : ~((az > ax) & (az > ay));
    }
    return !any16(other);
}

static inline void bound_prepare(float o, float d, float skin, uint row, bound *a) {
    bool negative = d < 0.0f;
    a->near_o = negative ? o - skin : o + skin;
    a->far_o = negative ? o + skin : o - skin;
    a->near_row = row + (negative ? 1 : 0);
}

static inline float16 inverse16(float16 d) {
    float16 tiny = d < 0.0f ? (float16)(-1e-18f) : (float16)(1e-18f);
    return 1.0f / (fabs(d) < 1e-18f ? tiny : d);
}

static inline void group_prepare(rays16 r, uint kz, group16 *g) {
    g->inverse[0] = inverse16(r.dx);
    g->inverse[1] = inverse16(r.dy);
    g->inverse[2] = inverse16(r.dz);
    g->sz = kz == 0 ? g->inverse[0] : kz == 1 ? g->inverse[1] : g->inverse[2];
    g->sx = (kz == 0 ? r.dy : kz == 1 ? r.dz : r.dx) * g->sz;
    g->sy = (kz == 0 ? r.dz : kz == 1 ? r.dx : r.dy) * g->sz;
    g->best.t = r.t_max;
    g->best.id = (uint16)(~0u);
}

static inline void set_window(float4 lo, float4 hi, float16 *centre, float16 *half_width) {
    float4 c = 0.5f * (lo + hi), h = 0.5f * (hi - lo);
    *centre = (float16)(c.xxxx, c.yyyy, c.zzzz, c.wwww);
    *half_width = (float16)(h.xxxx, h.yyyy, h.zzzz, h.wwww);
}

/* A window for each of four groups. */
static inline void windows64(const group16 *g, frustum *f) {
    float4 lo = (float4)(least16(g[0].sx), least16(g[1].sx), least16(g[2].sx), least16(g[3].sx));
    float4 hi = (float4)(greatest16(g[0].sx), greatest16(g[1].sx), greatest16(g[2].sx),
                         greatest16(g[3].sx));
    set_window(lo, hi, &f->window[0], &f->window[2]);
    lo = (float4)(least16(g[0].sy), least16(g[1].sy), least16(g[2].sy), least16(g[3].sy));
    hi = (float4)(greatest16(g[0].sy), greatest16(g[1].sy), greatest16(g[2].sy),
                  greatest16(g[3].sy));
    set_window(lo, hi, &f->window[1], &f->window[3]);
}

/* One window for the only group. */
static inline void window16(const group16 *g, frustum *f) {
    set_window((float4)(least16(g->sx)), (float4)(greatest16(g->sx)), &f->window[0], &f->window[2]);
    set_window((float4)(least16(g->sy)), (float4)(greatest16(g->sy)), &f->window[1], &f->window[3]);
}

static inline void set_limit(const group16 *g, uint groups, frustum *f) {
    float16 t = g[0].best.t;
    for (uint i = 1; i < groups; i++) {
        t = GREATER(t, g[i].best.t);
    }
    f->limit = greatest16(t);
}

/* Narrows the frustum to GROUPS groups. */
static inline void frustum_enclose(const group16 *g, uint groups, frustum *f) {
#pragma unroll
    for (uint k = 0; k < 3; k++) {
        float16 least = g[0].inverse[k], most = least;
        for (uint i = 1; i < groups; i++) {
            least = LESSER(least, g[i].inverse[k]);
            most = GREATER(most, g[i].inverse[k]);
        }
        f->axis[k].least = least16(least);
        f->axis[k].most = greatest16(most);
    }
    if (groups == 4) {
        windows64(g, f);
    } else {
        window16(g, f);
    }
    set_limit(g, groups, f);
}

/* False when the rays do not share origin, signs and dominant axis. */
static inline bool frustum_prepare(const rays16 *r, uint groups, float extent_m, frustum *f,
                                   group16 *g) {
    float x = r[0].ox.s0, y = r[0].oy.s0, z = r[0].oz.s0;
    float dx = r[0].dx.s0, dy = r[0].dy.s0, dz = r[0].dz.s0, skin = ray_skin(x, y, z, extent_m);
    uint kz = dominant_axis(dx, dy, dz);
    if (!share_origin(r, groups) || !share_octant(r, groups, kz)) {
        return false;
    }
    bound_prepare(x, dx, skin, 0, &f->axis[0]);
    bound_prepare(y, dy, skin, 2, &f->axis[1]);
    bound_prepare(z, dz, skin, 4, &f->axis[2]);
    f->kz = kz;
    f->kx = kz == 2 ? 0 : kz + 1;
    f->ky = f->kx == 2 ? 0 : f->kx + 1;
    f->o[0] = kz == 0 ? y : kz == 1 ? z : x;
    f->o[1] = kz == 0 ? z : kz == 1 ? x : y;
    f->o[2] = kz == 0 ? x : kz == 1 ? y : z;
    for (uint i = 0; i < groups; i++) {
        group_prepare(r[i], kz, &g[i]);
    }
    frustum_enclose(g, groups, f);
    float16 windows = f->window[2] * f->window[3];
    f->widest = 8.0f * greatest16(windows) / (groups == 4 ? FRUSTUM_WIDE_64 : FRUSTUM_WIDE_16);
    return true;
}

static inline void bound8(__global const float8 *row, const bound *a, float8 *in, float8 *out) {
    float8 near = row[a->near_row] - a->near_o, far = row[a->near_row ^ 1] - a->far_o;
    *in = GREATER(*in, LESSER(near * a->least, near * a->most));
    *out = LESSER(*out, GREATER(far * a->least, far * a->most));
}

/* Which boxes some ray between the extreme ones may enter, and the earliest entry. */
static inline uint enter_frustum8(__global const float8 *row, const frustum *f, float8 *entry) {
    float8 in = (float8)(0.0f), out = (float8)(f->limit);
    bound8(row, &f->axis[0], &in, &out);
    bound8(row, &f->axis[1], &in, &out);
    bound8(row, &f->axis[2], &in, &out);
    *entry = in;
    return bits8(in <= out);
}

/* Four triangles of a leaf, seen from the packet's origin. */
typedef struct seen4 {
    float4 corner[9];       /* relative to the origin, permuted */
    float4 near[3], far[3]; /* their boxes' planes, by axis: distance from the shifted origins */
} seen4;

static inline void seen4_prepare(__global const float4 *v, const frustum *f, seen4 *s) {
#pragma unroll
    for (uint c = 0; c < 3; c++) {
        s->corner[3 * c] = v[3 * c + f->kx] - f->o[0];
        s->corner[3 * c + 1] = v[3 * c + f->ky] - f->o[1];
        s->corner[3 * c + 2] = v[3 * c + f->kz] - f->o[2];
    }
#pragma unroll
    for (uint k = 0; k < 3; k++) {
        float4 lo = LESSER(LESSER(v[k], v[3 + k]), v[6 + k]);
        float4 hi = GREATER(GREATER(v[k], v[3 + k]), v[6 + k]);
        int4 flip = (int4)(-(int)(f->axis[k].near_row & 1));
        s->near[k] = (flip ? hi : lo) - f->axis[k].near_o;
        s->far[k] = (flip ? lo : hi) - f->axis[k].far_o;
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
    float4 area = EDGE(x[1] - x[0], y[1] - y[0], x[2] - x[0], y[2] - y[0]);
    o.area = fabs(area);
    float4 sign = area < 0.0f ? (float4)(1.0f) : (float4)(-1.0f), slack = 1e-3f * fabs(area);
#pragma unroll
    for (uint c = 0; c < 3; c++) {
        uint next = c == 2 ? 0 : c + 1;
        float4 a = sign * (y[next] - y[c]), b = sign * (x[c] - x[next]);
        o.edge[c].a = a;
        o.edge[c].b = b;
        o.edge[c].d = (a * x[c] + b * y[c]) + (slack + 1e-5f * (fabs(a) + fabs(b)));
    }
    return o;
}

/* Whether some ray of the group lies within the outline of triangle LANE. */
static inline uint holds(const outline4 *o, float nearest, uint lane, const group16 *g) {
    int16 beyond = nearest * g->sz > g->best.t;
#pragma unroll
    for (uint c = 0; c < 3; c++) {
        float16 a = (float16)(((const float *)&o->edge[c].a)[lane]);
        float16 b = (float16)(((const float *)&o->edge[c].b)[lane]);
        float16 d = (float16)(((const float *)&o->edge[c].d)[lane]);
        beyond |= TRACE_FMA(a, g->sx, b * g->sy) > d;
    }
    return any16(~beyond) ? 1u << lane : 0;
}

/* Which triangles some ray of a group may meet. */
static inline uint touch1(const outline4 *o, float4 near, const group16 *g) {
    return holds(o, near.x, 0, g) | holds(o, near.y, 1, g) | holds(o, near.z, 2, g) |
           holds(o, near.w, 3, g) | bits4(~o->plain);
}

/* The same for four groups, as bit 4 * group + triangle. */
static inline uint touch4(const outline4 *o, const frustum *f) {
    int16 beyond = (int16)(0);
#pragma unroll
    for (uint c = 0; c < 3; c++) {
        float16 a = o->edge[c].a.xyzwxyzwxyzwxyzw, b = o->edge[c].b.xyzwxyzwxyzwxyzw;
        float16 nearest = (a * f->window[0] + b * f->window[1]) -
                          (fabs(a) * f->window[2] + fabs(b) * f->window[3]);
        beyond |= nearest > o->edge[c].d.xyzwxyzwxyzwxyzw;
    }
    return bits16(~(beyond & o->plain.xyzwxyzwxyzwxyzw));
}

/* No early way out: what touches mostly hits, and a branch taken wrongly costs more
 * than the rest of the test. */
static inline void hit_seen(const seen4 *s, uint lane, uint id, group16 *g) {
    const float *v = (const float *)s->corner + lane;
    const float *near = (const float *)s->near + lane, *far = (const float *)s->far + lane;
    float16 t;
    int16 met = intersect16((float16)(v[0]), (float16)(v[4]), (float16)(v[8]), (float16)(v[12]),
                            (float16)(v[16]), (float16)(v[20]), (float16)(v[24]), (float16)(v[28]),
                            (float16)(v[32]), g->sx, g->sy, g->sz, &t);
    float16 in = GREATER(near[0] * g->inverse[0], near[4] * g->inverse[1]);
    float16 out = LESSER(far[0] * g->inverse[0], far[4] * g->inverse[1]);
    in = GREATER(GREATER(in, near[8] * g->inverse[2]), (float16)(0.0f));
    out = LESSER(out, far[8] * g->inverse[2]);
    t = LESSER(GREATER(t, in), out);
    hits16 best = g->best;
    met &= (in <= out) & ((t < best.t) | ((t == best.t) & ((uint16)(id) < best.id)));
    g->best.t = met ? t : best.t;
    g->best.id = met ? (uint16)(id) : best.id;
}

/* Returns how many triangles were tested; ~0u: none, the packet is too wide for them. */
static inline uint hit_leaf(__global const dev_block4 *block, uint groups, frustum *f, group16 *g) {
    seen4 seen;
    seen4_prepare((__global const float4 *)block, f, &seen);
    outline4 outline = outline_of(&seen, f->axis[f->kz].least);
    if (f->widest > 0.0f) {
        float4 area = outline.plain ? outline.area : (float4)(INFINITY);
        if (!any4(area > f->widest)) {
            return ~0u;
        }
        f->widest = 0.0f;
    }
    uint bits = groups == 4 ? touch4(&outline, f) : touch1(&outline, seen.near[f->kz], g),
         tested = popcount(bits);
    for (; bits; bits &= bits - 1) {
        uint bit = lowest_bit(bits), lane = bit & 3, id = block->id[lane];
        if (id != ~0u) {
            hit_seen(&seen, lane, id, &g[bit >> 2]);
        }
    }
    set_limit(g, groups, f);
    return tested;
}

/* The nearest of the entered children, or DEV_EMPTY; the others go on the stack in order. Unlike for a
 * single ray it pays to sort: a packet that meets triangles in the wrong order tests many in vain. */
static inline uint nearest_entered(__global const dev_node8 *nodes,
                                   __global const dev_block4 *blocks, uint word, const frustum *f,
                                   stack8 *s, uint *top) {
    float8 entry;
    float in[8];
    __global const uint *child = nodes[word].child;
    uint bits = enter_frustum8((__global const float8 *)&nodes[word], f, &entry), floor = *top;
    if (!bits) {
        return DEV_EMPTY;
    }
    vstore8(entry, 0, in);
    uint lane = lowest_bit(bits), best = child[lane];
    float nearest = in[lane];
    fetch_early(nodes, blocks, best);
    for (bits &= bits - 1; bits; bits &= bits - 1) {
        lane = lowest_bit(bits);
        uint at = (*top)++, other = child[lane];
        float other_in = in[lane];
        fetch_early(nodes, blocks, other);
        bool swap = other_in < nearest;
        float later_in = swap ? nearest : other_in;
        uint later = swap ? best : other;
        nearest = swap ? other_in : nearest;
        best = swap ? other : best;
        while (at > floor && s->entry[at - 1] < later_in) {
            s->entry[at] = s->entry[at - 1];
            s->child[at] = s->child[at - 1];
            at--;
        }
        s->entry[at] = later_in;
        s->child[at] = later;
    }
    return best;
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
