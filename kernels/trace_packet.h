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

/* So many rays or fewer go on alone. */
#define PACKET_ALONE 3

/* One axis of a packet: planes in the order in which its rays meet them. */
typedef struct axis16 {
    float16 near_o, far_o, inverse;
    uint near_row;                      /* row of the node; the far one is ^ 1 */
    float first_o, last_o, least, most; /* intervals: of near_o, far_o (the wider end), inverse */
} axis16;

static inline void axis16_prepare(float16 o, float16 d, float16 skin, uint row, axis16 *a) {
    bool negative = d.s0 < 0.0f;
    float16 tiny = (float16)(negative ? -1e-18f : 1e-18f);
    a->inverse = 1.0f / (fabs(d) < 1e-18f ? tiny : d);
    a->near_o = negative ? o - skin : o + skin;
    a->far_o = negative ? o + skin : o - skin;
    a->near_row = row + (negative ? 1 : 0);
    a->first_o = negative ? least16(a->near_o) : greatest16(a->near_o);
    a->last_o = negative ? greatest16(a->far_o) : least16(a->far_o);
    a->least = least16(a->inverse);
    a->most = greatest16(a->inverse);
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
} packet16;

/* Skipped rays take the place of the first live one, so that they widen nothing. */
static inline rays16 fill_skipped(rays16 r, int16 live) {
    rays16 filled;
    float lane[16];
    uint first = lowest_bit(bits16(live));
    vstore16(r.ox, 0, lane);
    filled.ox = live ? r.ox : (float16)(lane[first]);
    vstore16(r.oy, 0, lane);
    filled.oy = live ? r.oy : (float16)(lane[first]);
    vstore16(r.oz, 0, lane);
    filled.oz = live ? r.oz : (float16)(lane[first]);
    vstore16(r.dx, 0, lane);
    filled.dx = live ? r.dx : (float16)(lane[first]);
    vstore16(r.dy, 0, lane);
    filled.dy = live ? r.dy : (float16)(lane[first]);
    vstore16(r.dz, 0, lane);
    filled.dz = live ? r.dz : (float16)(lane[first]);
    filled.t_max = r.t_max;
    return filled;
}

/* P->best is set already; the signs of the rays' directions agree. */
static inline void packet16_prepare(rays16 r, float extent_m, packet16 *p) {
    float16 reach = GREATER(GREATER(fabs(r.ox), fabs(r.oy)), fabs(r.oz));
    float16 skin = (reach + extent_m) * TRACE_SKIN;
    axis16_prepare(r.ox, r.dx, skin, 0, &p->x);
    axis16_prepare(r.oy, r.dy, skin, 2, &p->y);
    axis16_prepare(r.oz, r.dz, skin, 4, &p->z);
    p->kz = dominant_axis16(r);
    p->kz1 = p->kz.s0;
    p->kx1 = p->kz1 == 2 ? 0 : p->kz1 + 1;
    p->ky1 = p->kx1 == 2 ? 0 : p->kx1 + 1;
    p->one_axis = !some16(p->kz != (int)p->kz1);
    p->sz = choose3(p->kz, p->x.inverse, p->y.inverse, p->z.inverse);
    p->sx = choose3(p->kz, r.dy, r.dz, r.dx) * p->sz;
    p->sy = choose3(p->kz, r.dz, r.dx, r.dy) * p->sz;
    p->ox = p->one_axis ? choose3(p->kz, r.oy, r.oz, r.ox) : r.ox;
    p->oy = p->one_axis ? choose3(p->kz, r.oz, r.ox, r.oy) : r.oy;
    p->oz = p->one_axis ? choose3(p->kz, r.ox, r.oy, r.oz) : r.oz;
    p->limit = greatest16(p->best.t);
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
    float least = LESSER(LESSER(a, b), c), most = GREATER(GREATER(a, b), c);
    float lo = BOX_LO(least, most), hi = BOX_HI(least, most);
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
    float16 ax, ay, az, bx, by, bz, cx, cy, cz, over, under;
    corner16(v, p, &ax, &ay, &az);
    corner16(v + 12, p, &bx, &by, &bz);
    corner16(v + 24, p, &cx, &cy, &cz);
    int16 met = intersect16(ax, ay, az, bx, by, bz, cx, cy, cz, p->sx, p->sy, p->sz, &over, &under);
    float16 t = over / under;
    if (!some16(met)) {
        return;
    }
    float16 in = (float16)(0.0f), out = (float16)(INFINITY);
    enter_axis16(v[0], v[12], v[24], &p->x, &in, &out);
    enter_axis16(v[4], v[16], v[28], &p->y, &in, &out);
    enter_axis16(v[8], v[20], v[32], &p->z, &in, &out);
    t = GREATER(t, in);
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

static inline float lane_of(const float16 *v, uint lane) {
    return ((const float *)v)[lane];
}

/* One ray of the packet, as ray8_prepare would make it. */
static inline ray8 ray8_of(const packet16 *p, uint lane) {
    ray8 r;
    bool nx = p->x.near_row & 1, ny = p->y.near_row & 1, nz = p->z.near_row & 1;
    r.near_o = vector_of(lane_of(&p->x.near_o, lane), lane_of(&p->y.near_o, lane),
                         lane_of(&p->z.near_o, lane));
    r.far_o = vector_of(lane_of(&p->x.far_o, lane), lane_of(&p->y.far_o, lane),
                        lane_of(&p->z.far_o, lane));
    r.inverse = vector_of(lane_of(&p->x.inverse, lane), lane_of(&p->y.inverse, lane),
                          lane_of(&p->z.inverse, lane));
    r.near_x = p->x.near_row;
    r.near_y = p->y.near_row;
    r.near_z = p->z.near_row;
    r.lo_o = vector_of(nx ? r.far_o.x : r.near_o.x, ny ? r.far_o.y : r.near_o.y,
                       nz ? r.far_o.z : r.near_o.z);
    r.hi_o = vector_of(nx ? r.near_o.x : r.far_o.x, ny ? r.near_o.y : r.far_o.y,
                       nz ? r.near_o.z : r.far_o.z);
    r.kz = ((const int *)&p->kz)[lane];
    r.kx = r.kz == 2 ? 0 : r.kz + 1;
    r.ky = r.kx == 2 ? 0 : r.kx + 1;
    vector o = vector_of(lane_of(&p->ox, lane), lane_of(&p->oy, lane), lane_of(&p->oz, lane));
    r.ox = p->one_axis ? o.x : along(o, r.kx);
    r.oy = p->one_axis ? o.y : along(o, r.ky);
    r.oz = p->one_axis ? o.z : along(o, r.kz);
    r.sx = lane_of(&p->sx, lane);
    r.sy = lane_of(&p->sy, lane);
    r.sz = lane_of(&p->sz, lane);
    return r;
}

/* The rays LANES of a packet, at most PACKET_ALONE, go on alone from WORD. */
static inline void walk_alone(__global const dev_node8 *nodes, __global const dev_block4 *blocks,
                              uint lanes, uint word, packet16 *p) {
    float *t = (float *)&p->best.t;
    uint *id = (uint *)&p->best.id;
    walker8 w[PACKET_ALONE];
    uint count = 0, lane[PACKET_ALONE];
    for (; lanes; lanes &= lanes - 1) {
        uint i = lowest_bit(lanes);
        w[count].r = ray8_of(p, i);
        w[count].best.t_m = t[i];
        w[count].best.triangle = id[i];
        w[count].word = word;
        w[count].top = 0;
        lane[count++] = i;
    }
    walk_in_turns(nodes, blocks, w, (1u << count) - 1);
    for (uint i = 0; i < count; i++) {
        t[lane[i]] = w[i].best.t_m;
        id[lane[i]] = w[i].best.triangle;
    }
    p->limit = greatest16(p->best.t);
}

/* The same of sixteen RAYS that have not been a packet, from ROOT. */
TRACE_APART static hits16 walk_singly(__global const dev_node8 *nodes,
                                      __global const dev_block4 *blocks,
                                      __global const dev_ray *rays, hits16 known, uint lanes,
                                      uint root, float extent_m) {
    float *t = (float *)&known.t;
    uint *id = (uint *)&known.id;
    walker8 w[16];
    for (uint left = lanes; left; left &= left - 1) {
        uint i = lowest_bit(left);
        w[i].r = ray8_prepare(rays[i], extent_m);
        w[i].best.t_m = t[i];
        w[i].best.triangle = id[i];
        w[i].word = root;
        w[i].top = 0;
    }
    walk_in_turns(nodes, blocks, w, lanes);
    for (; lanes; lanes &= lanes - 1) {
        uint i = lowest_bit(lanes);
        t[i] = w[i].best.t_m;
        id[i] = w[i].best.triangle;
    }
    return known;
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

/* The nearest hits of the packet below ROOT. */
static inline void walk16(__global const dev_node8 *nodes, __global const dev_block4 *blocks,
                          uint root, packet16 *p) {
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
        if (popcount(lanes) <= PACKET_ALONE) {
            walk_alone(nodes, blocks, lanes, word, p);
        } else if (word & DEV_LEAF) {
            hit_block16(&blocks[word & ~DEV_LEAF], p);
        } else {
            push_children16(&s, &top, &nodes[word], p);
        }
    }
}

/* The rays R, which are FIRST .. FIRST + 15 of RAYS; KNOWN is what was found so far. Those whose
 * directions have the same signs go together. */
static inline void trace_packet16(__global const dev_node8 *nodes,
                                  __global const dev_block4 *blocks, __global const dev_ray *rays,
                                  __global dev_hit *hits, rays16 r, hits16 known, uint first,
                                  uint count, uint root, float extent_m) {
    hits16 best = known;
    float16 sum = ((r.ox + r.oy) + (r.oz + r.dx)) + (r.dy + r.dz);
    int16 live = (r.t_max > 0.0f) & (fabs(sum) < INFINITY); /* a NAN must not spoil the intervals */
    int16 octant = ((r.dx < 0.0f) & 1) | ((r.dy < 0.0f) & 2) | ((r.dz < 0.0f) & 4);
    uint left = root == DEV_EMPTY ? 0 : bits16(live);
    int code[16];
    vstore16(octant, 0, code);
    while (left) {
        packet16 p;
        int16 same = live & (octant == code[lowest_bit(left)]);
        uint lanes = bits16(same);
        left &= ~lanes;
        if (popcount(lanes) <= PACKET_ALONE) {
            best = walk_singly(nodes, blocks, &rays[first], best, lanes, root, extent_m);
            continue;
        }
        p.best.t = same ? best.t : (float16)(-1.0f);
        p.best.id = best.id;
        packet16_prepare(lanes == 0xffff ? r : fill_skipped(r, same), extent_m, &p);
        walk16(nodes, blocks, root, &p);
        best.t = same ? p.best.t : best.t;
        best.id = same ? p.best.id : best.id;
    }
    store_hits16(hits, first, count, best);
}

#endif
