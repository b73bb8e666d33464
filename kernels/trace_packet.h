/*
 * Sixteen rays as one packet, for rays in an order that keeps neighbours together. The packet's
 * intervals of origin and inverse direction cull eight boxes at once, then its rays are tested
 * against each box that is left; where few rays are left they go on alone, as in trace_wide8.h.
 *
 * Interval products are rounded like the rays' own: what any ray enters, the packet enters.
 */
#ifndef ASDIC_KERNEL_TRACE_PACKET_H
#define ASDIC_KERNEL_TRACE_PACKET_H

#include "trace_wide8.h"

/* So many rays or fewer go on alone; of a packet that is known to be wide, more. */
#define PACKET_ALONE 3
#define PACKET_ALONE_WIDE 10

DEFINE_INTERSECT(intersect16, float16, int16)

static inline uint bits16(int16 m) {
    ulong2 bytes = as_ulong2(convert_char16(m));
    ulong low = ((bytes.x & 0x8040201008040201ul) * 0x0101010101010101ul) >> 56;
    ulong high = ((bytes.y & 0x8040201008040201ul) * 0x0101010101010101ul) >> 56;
    return (uint)(low | high << 8);
}

static inline float least16(float16 v) {
    float8 a = LESSER(v.lo, v.hi);
    float4 b = LESSER(a.lo, a.hi);
    float2 c = LESSER(b.lo, b.hi);
    return LESSER(c.x, c.y);
}

static inline float greatest16(float16 v) {
    return -least16(-v);
}

/* Sixteen structs of eight floats become eight vectors of sixteen: three rounds of even and odd. */
typedef struct columns {
    float16 c[8];
} columns;

static inline columns unzip(columns in) {
    columns out;
#pragma unroll
    for (int i = 0; i < 4; i++) {
        float16 a = in.c[2 * i], b = in.c[2 * i + 1];
        out.c[i] = (float16)(a.even, b.even);
        out.c[4 + i] = (float16)(a.odd, b.odd);
    }
    return out;
}

static inline float16 sixteen(__global const dev_ray *rays, uint first, uint last, uint field) {
    float v[16];
    for (uint i = 0; i < 16; i++) {
        uint at = first + i < last ? first + i : last;
        v[i] = ((__global const float *)&rays[at])[field];
    }
    return vload16(0, v);
}

typedef struct rays16 {
    float16 ox, oy, oz, dx, dy, dz, t_max;
} rays16;

/* Rays FIRST .. FIRST + 15; those from COUNT on are skipped rays. */
static inline rays16 load_rays16(__global const dev_ray *rays, uint first, uint count) {
    rays16 r;
    if (first + 16 <= count) {
        columns c;
#pragma unroll
        for (uint i = 0; i < 8; i++) {
            c.c[i] = ((__global const float16 *)&rays[first])[i];
        }
        c = unzip(unzip(unzip(c)));
        r.ox = c.c[0];
        r.oy = c.c[1];
        r.oz = c.c[2];
        r.t_max = c.c[3];
        r.dx = c.c[4];
        r.dy = c.c[5];
        r.dz = c.c[6];
        return r;
    }
    r.ox = sixteen(rays, first, count - 1, 0);
    r.oy = sixteen(rays, first, count - 1, 1);
    r.oz = sixteen(rays, first, count - 1, 2);
    r.t_max = sixteen(rays, first, count - 1, 3);
    r.dx = sixteen(rays, first, count - 1, 4);
    r.dy = sixteen(rays, first, count - 1, 5);
    r.dz = sixteen(rays, first, count - 1, 6);
    const int16 lane = (int16)(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15);
    r.t_max = lane < (int)(count - first) ? r.t_max : (float16)(-1.0f);
    return r;
}

typedef struct hits16 {
    float16 t;
    uint16 id;
} hits16;

static inline void store_hits16(__global dev_hit *hits, uint first, uint count, hits16 h) {
    h.t = h.id == ~0u ? (float16)(INFINITY) : h.t;
    if (first + 16 <= count) {
        float16 id = as_float16(h.id), low, high;
        low.even = h.t.lo;
        low.odd = id.lo;
        high.even = h.t.hi;
        high.odd = id.hi;
        ((__global float16 *)&hits[first])[0] = low;
        ((__global float16 *)&hits[first])[1] = high;
        return;
    }
    float t[16];
    uint id[16];
    vstore16(h.t, 0, t);
    vstore16(h.id, 0, id);
    for (uint i = 0; first + i < count; i++) {
        hits[first + i].t_m = t[i];
        hits[first + i].triangle = id[i];
    }
}

/* One axis of a packet: planes in the order in which its rays meet them. */
typedef struct axis16 {
    float16 near_o, far_o, inverse;
    uint near_row;                      /* row of the node; the far one is ^ 1 */
    float first_o, last_o, least, most; /* intervals: of near_o, far_o (the wider end), inverse */
} axis16;

/* False when the rays do not agree on the sign of their directions. */
static inline bool axis16_prepare(float16 o, float16 d, float16 skin, uint row, axis16 *a) {
    int16 negative = d < 0.0f;
    bool any_negative = any16(negative), all_negative = !any16(~negative);
    float16 clamped = fabs(d) < 1e-18f ? (negative ? (float16)(-1e-18f) : (float16)(1e-18f)) : d;
    a->inverse = 1.0f / clamped;
    a->near_o = any_negative ? o - skin : o + skin;
    a->far_o = any_negative ? o + skin : o - skin;
    a->near_row = row + (any_negative ? 1 : 0);
    a->first_o = any_negative ? least16(a->near_o) : greatest16(a->near_o);
    a->last_o = any_negative ? greatest16(a->far_o) : least16(a->far_o);
    a->least = least16(a->inverse);
    a->most = greatest16(a->inverse);
    return any_negative == all_negative;
}

typedef struct packet16 {
    axis16 x, y, z;
    float16 ox, oy, oz; /* origins, along the permuted axes where `one_axis` */
    float16 sx, sy, sz;
    int16 kz;
    uint kx1, ky1, kz1; /* the permutation where all rays share it */
    bool one_axis;
    hits16 best;
    float limit; /* the farthest of best.t */
    uint alone;  /* so many rays or fewer go on alone */
} packet16;

static inline float16 choose3(int16 k, float16 at0, float16 at1, float16 at2) {
    return k == 0 ? at0 : k == 1 ? at1 : at2;
}

/* Skipped rays take the place of the first live one, so that they widen nothing. */
static inline rays16 fill_skipped(rays16 r, int16 live) {
    float lane[16];
    uint first = lowest_bit(bits16(live));
    vstore16(r.ox, 0, lane);
    r.ox = live ? r.ox : (float16)(lane[first]);
    vstore16(r.oy, 0, lane);
    r.oy = live ? r.oy : (float16)(lane[first]);
    vstore16(r.oz, 0, lane);
    r.oz = live ? r.oz : (float16)(lane[first]);
    vstore16(r.dx, 0, lane);
    r.dx = live ? r.dx : (float16)(lane[first]);
    vstore16(r.dy, 0, lane);
    r.dy = live ? r.dy : (float16)(lane[first]);
    vstore16(r.dz, 0, lane);
    r.dz = live ? r.dz : (float16)(lane[first]);
    return r;
}

/* False when the rays are too different to go together. */
static inline bool packet16_prepare(rays16 r, float extent_m, packet16 *p) {
    float16 reach = GREATER(GREATER(fabs(r.ox), fabs(r.oy)), fabs(r.oz));
    float16 skin = (reach + extent_m) * TRACE_SKIN;
    bool agree = axis16_prepare(r.ox, r.dx, skin, 0, &p->x);
    agree &= axis16_prepare(r.oy, r.dy, skin, 2, &p->y);
    agree &= axis16_prepare(r.oz, r.dz, skin, 4, &p->z);
    float16 ax = fabs(r.dx), ay = fabs(r.dy), az = fabs(r.dz);
    p->kz = ((ax >= ay) & (ax >= az)) ? (int16)(0) : (ay >= az ? (int16)(1) : (int16)(2));
    p->kz1 = p->kz.s0;
    p->kx1 = p->kz1 == 2 ? 0 : p->kz1 + 1;
    p->ky1 = p->kx1 == 2 ? 0 : p->kx1 + 1;
    p->one_axis = !any16(p->kz != (int)p->kz1);
    p->sz = choose3(p->kz, p->x.inverse, p->y.inverse, p->z.inverse);
    p->sx = choose3(p->kz, r.dy, r.dz, r.dx) * p->sz;
    p->sy = choose3(p->kz, r.dz, r.dx, r.dy) * p->sz;
    p->ox = p->one_axis ? choose3(p->kz, r.oy, r.oz, r.ox) : r.ox;
    p->oy = p->one_axis ? choose3(p->kz, r.oz, r.ox, r.oy) : r.oy;
    p->oz = p->one_axis ? choose3(p->kz, r.ox, r.oy, r.oz) : r.oz;
    p->limit = greatest16(p->best.t);
    return agree;
}

/* Bounds of entry and exit of one axis for all rays of the packet. */
static inline float8 first_entry(__global const float8 *row, const axis16 *a) {
    float8 x = row[a->near_row] - a->first_o;
    return LESSER(x * a->least, x * a->most);
}

static inline float8 last_exit(__global const float8 *row, const axis16 *a) {
    float8 x = row[a->near_row ^ 1] - a->last_o;
    return GREATER(x * a->least, x * a->most);
}

/* Which boxes the packet as a whole enters, and the earliest entry. */
static inline uint enter_bundle8(__global const float8 *row, const packet16 *p, float8 *entry) {
    float8 in = GREATER(GREATER(first_entry(row, &p->x), first_entry(row, &p->y)),
                        GREATER(first_entry(row, &p->z), (float8)(0.0f)));
    float8 out = LESSER(LESSER(last_exit(row, &p->x), last_exit(row, &p->y)),
                        LESSER(last_exit(row, &p->z), (float8)(p->limit)));
    *entry = in;
    return bits8(in <= out);
}

/* Which of the rays enter box LANE of a node. */
static inline uint enter_box16(__global const float *node, uint lane, const packet16 *p) {
    const axis16 *x = &p->x, *y = &p->y, *z = &p->z;
    float16 in = GREATER(SLAB(node[8 * x->near_row + lane], x->near_o, x->inverse),
                         SLAB(node[8 * y->near_row + lane], y->near_o, y->inverse));
    in = GREATER(in, SLAB(node[8 * z->near_row + lane], z->near_o, z->inverse));
    in = GREATER(in, (float16)(0.0f));
    float16 out = LESSER(SLAB(node[8 * (x->near_row ^ 1) + lane], x->far_o, x->inverse),
                         SLAB(node[8 * (y->near_row ^ 1) + lane], y->far_o, y->inverse));
    out = LESSER(out, SLAB(node[8 * (z->near_row ^ 1) + lane], z->far_o, z->inverse));
    out = LESSER(out, p->best.t);
    return bits16(in <= out);
}

/* One axis of a triangle's box: A, B, C are its corners' coordinates. */
static inline void enter_axis16(float a, float b, float c, const axis16 *x, float16 *in,
                                float16 *out) {
    float lo = LESSER(LESSER(a, b), c), hi = GREATER(GREATER(a, b), c);
    bool flip = x->near_row & 1;
    *in = GREATER(*in, SLAB(flip ? hi : lo, x->near_o, x->inverse));
    *out = LESSER(*out, SLAB(flip ? lo : hi, x->far_o, x->inverse));
}

/* A corner relative to the rays' origins, permuted. */
static inline void corner16(__global const float *v, const packet16 *p, float16 *x, float16 *y,
                            float16 *z) {
    if (p->one_axis) {
        *x = v[4 * p->kx1] - p->ox;
        *y = v[4 * p->ky1] - p->oy;
        *z = v[4 * p->kz1] - p->oz;
        return;
    }
    float16 at0 = v[0] - p->ox, at1 = v[4] - p->oy, at2 = v[8] - p->oz;
    *x = choose3(p->kz, at1, at2, at0);
    *y = choose3(p->kz, at2, at0, at1);
    *z = choose3(p->kz, at0, at1, at2);
}

static inline void hit_triangle16(__global const float *v, uint id, packet16 *p) {
    float16 ax, ay, az, bx, by, bz, cx, cy, cz, t;
    corner16(v, p, &ax, &ay, &az);
    corner16(v + 12, p, &bx, &by, &bz);
    corner16(v + 24, p, &cx, &cy, &cz);
    int16 met = intersect16(ax, ay, az, bx, by, bz, cx, cy, cz, p->sx, p->sy, p->sz, &t);
    if (!any16(met)) {
        return;
    }
    float16 in = (float16)(0.0f), out = (float16)(INFINITY);
    enter_axis16(v[0], v[12], v[24], &p->x, &in, &out);
    enter_axis16(v[4], v[16], v[28], &p->y, &in, &out);
    enter_axis16(v[8], v[20], v[32], &p->z, &in, &out);
    t = LESSER(GREATER(t, in), out);
    int16 nearer = (t < p->best.t) | ((t == p->best.t) & ((uint16)(id) < p->best.id));
    met &= (in <= out) & nearer;
    p->best.t = met ? t : p->best.t;
    p->best.id = met ? (uint16)(id) : p->best.id;
}

static inline void hit_block16(__global const dev_block4 *block, packet16 *p) {
    for (uint lane = 0; lane < DEV_LEAF_TRIANGLES; lane++) {
        uint id = block->id[lane];
        if (id == ~0u) {
            break; /* unused lanes come last */
        }
        hit_triangle16(&block->v[0][lane], id, p);
    }
    p->limit = greatest16(p->best.t);
}

/* The rays LANES walk on alone from WORD. */
static inline void walk_alone(__global const dev_node8 *nodes, __global const dev_block4 *blocks,
                              __global const dev_ray *rays, uint lanes, uint word, float extent_m,
                              packet16 *p) {
    float t[16];
    uint id[16];
    vstore16(p->best.t, 0, t);
    vstore16(p->best.id, 0, id);
    for (; lanes; lanes &= lanes - 1) {
        uint lane = lowest_bit(lanes);
        dev_hit best = {t[lane], id[lane]};
        ray8 r = ray8_prepare(rays[lane], extent_m);
        walk8(nodes, blocks, &r, word, &best);
        t[lane] = best.t_m;
        id[lane] = best.triangle;
    }
    p->best.t = vload16(0, t);
    p->best.id = vload16(0, id);
    p->limit = greatest16(p->best.t);
}

typedef struct stack16 {
    uint child[TRACE_STACK];
    float entry[TRACE_STACK];
    uint lanes[TRACE_STACK];
} stack16;

/* Puts the children that rays enter on the stack, roughly the nearest on top. */
static inline void push_children16(stack16 *s, uint *top, __global const dev_node8 *node,
                                   const packet16 *p) {
    float8 entry;
    float in[8];
    uint bits = enter_bundle8((__global const float8 *)node, p, &entry), word = 0, lanes = 0;
    float nearest = INFINITY;
    vstore8(entry, 0, in);
    for (; bits; bits &= bits - 1) {
        uint child = lowest_bit(bits);
        uint entered = enter_box16(node->lo_x, child, p);
        if (!entered) {
            continue;
        }
        bool swap = in[child] < nearest;
        if (lanes) {
            s->child[*top] = swap ? word : node->child[child];
            s->entry[*top] = swap ? nearest : in[child];
            s->lanes[*top] = swap ? lanes : entered;
            ++*top;
        }
        swap |= !lanes;
        word = swap ? node->child[child] : word;
        nearest = swap ? in[child] : nearest;
        lanes = swap ? entered : lanes;
    }
    if (lanes) {
        s->child[*top] = word;
        s->entry[*top] = nearest;
        s->lanes[*top] = lanes;
        ++*top;
    }
}

/* The nearest hits of the packet below ROOT. RAYS are the packet's own sixteen. */
static inline void walk16(__global const dev_node8 *nodes, __global const dev_block4 *blocks,
                          __global const dev_ray *rays, uint root, float extent_m, packet16 *p) {
    stack16 s;
    uint top = 1;
    s.child[0] = root;
    s.entry[0] = 0.0f;
    s.lanes[0] = bits16(p->best.t > 0.0f);
    while (top > 0) {
        top--;
        uint word = s.child[top], lanes = s.lanes[top];
        if (s.entry[top] > p->limit) {
            continue;
        }
        if (popcount(lanes) <= p->alone) {
            walk_alone(nodes, blocks, rays, lanes, word, extent_m, p);
        } else if (word & DEV_LEAF) {
            hit_block16(&blocks[word & ~DEV_LEAF], p);
        } else {
            push_children16(&s, &top, &nodes[word], p);
        }
    }
}

/* The rays R, which are FIRST .. FIRST + 15 of RAYS; KNOWN is what was found so far. */
static inline void trace_packet16(__global const dev_node8 *nodes,
                                  __global const dev_block4 *blocks, __global const dev_ray *rays,
                                  __global dev_hit *hits, rays16 r, hits16 known, uint alone,
                                  uint first, uint count, uint root, float extent_m) {
    float16 sum = ((r.ox + r.oy) + (r.oz + r.dx)) + (r.dy + r.dz);
    int16 live = (r.t_max > 0.0f) & (fabs(sum) < INFINITY); /* a NAN must not spoil the intervals */
    packet16 p;
    p.best = known;
    if (any16(live) && root != DEV_EMPTY) {
        if (any16(~live)) {
            r = fill_skipped(r, live);
            known.t = live ? known.t : (float16)(-1.0f);
        }
        p.best = known;
        if (packet16_prepare(r, extent_m, &p)) {
            p.alone = alone;
            walk16(nodes, blocks, &rays[first], root, extent_m, &p);
        } else {
            walk_alone(nodes, blocks, &rays[first], bits16(live), root, extent_m, &p);
        }
    }
    store_hits16(hits, first, count, p.best);
}

#endif
