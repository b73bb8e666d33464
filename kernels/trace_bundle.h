/*
 * What rays from one point share, 64 or 16 of them: the range of their directions, and which boxes some
 * ray between the extreme ones may enter.
 */
#ifndef ASDIC_KERNEL_TRACE_BUNDLE_H
#define ASDIC_KERNEL_TRACE_BUNDLE_H

#include "trace_lanes.h"

/* A packet gives up at its first leaf already when a group's window is so many times larger than the
 * leaf's largest triangle: its rays then meet a triangle each. */
#define FRUSTUM_WIDE_64 32.0f
#define FRUSTUM_WIDE_16 128.0f

/* Sixteen rays; s as in intersect.h, but along the packet's axis. */
typedef struct group16 {
    float16 inverse[3];
    float16 sx, sy, sz;
    float16 own_x, own_y, own_z; /* s along each ray's own axis; unset where that is the packet's */
    int16 turn;                  /* by how many axes the ray's own follows the packet's */
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
    bool one_axis;     /* all rays have the dominant axis kz */
    bool picky;        /* windows are larger than triangles: ask each ray before it is tested */
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
    return !some16(other) && fabs(r[0].ox.s0 + r[0].oy.s0 + r[0].oz.s0) < INFINITY;
}

/* All directions have the signs of the first one. */
static inline bool share_octant(const rays16 *r, uint groups) {
    int16 other = (int16)(0);
    for (uint g = 0; g < groups; g++) {
        other |= (r[g].dx < 0.0f) ^ (int16)(r[0].dx.s0 < 0.0f ? -1 : 0);
        other |= (r[g].dy < 0.0f) ^ (int16)(r[0].dy.s0 < 0.0f ? -1 : 0);
        other |= (r[g].dz < 0.0f) ^ (int16)(r[0].dz.s0 < 0.0f ? -1 : 0);
    }
    return !some16(other);
}

/* All directions have the dominant axis KZ. */
static inline bool share_axis(const rays16 *r, uint groups, uint kz) {
    int16 other = (int16)(0);
    for (uint g = 0; g < groups; g++) {
        float16 ax = fabs(r[g].dx), ay = fabs(r[g].dy), az = fabs(r[g].dz);
        other |= kz == 0   ? ~((ax >= ay) & (ax >= az))
                 : kz == 1 ? ~((ay > ax) & (ay >= az))
                           : ~((az > ax) & (az > ay));
    }
    return !some16(other);
}

static inline void bound_prepare(float o, float d, float skin, uint row, bound *a) {
    bool negative = d < 0.0f;
    a->near_o = negative ? o - skin : o + skin;
    a->far_o = negative ? o + skin : o - skin;
    a->near_row = row + (negative ? 1 : 0);
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

/* What a ray whose dominant axis is not KZ needs for its hits. */
static inline void own_axes(rays16 r, uint kz, group16 *g) {
    int16 own = dominant_axis16(r);
    g->own_z = choose3(own, g->inverse[0], g->inverse[1], g->inverse[2]);
    g->own_x = choose3(own, r.dy, r.dz, r.dx) * g->own_z;
    g->own_y = choose3(own, r.dz, r.dx, r.dy) * g->own_z;
    int16 turn = own - (int16)(kz);
    g->turn = turn < 0 ? turn + 3 : turn;
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

/* False when the rays do not share origin and signs. */
static inline bool frustum_prepare(const rays16 *r, uint groups, float extent_m, frustum *f,
                                   group16 *g) {
    float x = r[0].ox.s0, y = r[0].oy.s0, z = r[0].oz.s0;
    float dx = r[0].dx.s0, dy = r[0].dy.s0, dz = r[0].dz.s0, skin = ray_skin(x, y, z, extent_m);
    uint kz = dominant_axis(dx, dy, dz);
    if (!share_origin(r, groups) || !share_octant(r, groups)) {
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
    f->one_axis = share_axis(r, groups, kz);
    for (uint i = 0; i < groups; i++) {
        group_prepare(r[i], kz, &g[i]);
        if (!f->one_axis) {
            own_axes(r[i], kz, &g[i]);
        }
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
static inline int8 enter_frustum8(__global const float8 *row, const frustum *f, float8 *entry) {
    float8 in = (float8)(0.0f), out = (float8)(f->limit);
    bound8(row, &f->axis[0], &in, &out);
    bound8(row, &f->axis[1], &in, &out);
    bound8(row, &f->axis[2], &in, &out);
    *entry = in;
    return in <= out;
}

#endif
