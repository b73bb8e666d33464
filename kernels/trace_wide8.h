/*
 * Every ray by itself, eight boxes at a time: the form for CPUs and rays without order. Such rays wait
 * for memory most of the time, so sixteen of them take turns: of sixty-four those that enter any box at all.
 */
#ifndef ASDIC_KERNEL_TRACE_WIDE8_H
#define ASDIC_KERNEL_TRACE_WIDE8_H

#include "trace_sieve.h"
#include "vector.h"

/* A ray made ready for traversal. Planes are chosen by the sign of the direction, and the origin
 * is moved by the skin away from near planes and towards far planes. */
typedef struct ray8 {
    vector near_o, far_o, inverse;
    uint near_x, near_y, near_z; /* rows of a node: lo_x hi_x lo_y hi_y lo_z hi_z; far is ^ 1 */
    vector lo_o, hi_o;           /* the same by plane instead of by order */
    uint kx, ky, kz;
    float ox, oy, oz; /* origin along kx, ky, kz */
    float sx, sy, sz;
} ray8;

/* Not an index into memory: a store that a load has to wait for costs more than the choice. */
static inline float along(vector v, uint k) {
    return k == 0 ? v.x : k == 1 ? v.y : v.z;
}

static inline ray8 ray8_prepare(dev_ray ray, float extent_m) {
    ray8 r;
    vector o = vector_of(ray.origin[0], ray.origin[1], ray.origin[2]);
    vector d = vector_of(ray.direction[0], ray.direction[1], ray.direction[2]);
    bool nx = d.x < 0.0f, ny = d.y < 0.0f, nz = d.z < 0.0f;
    float skin = ray_skin(o.x, o.y, o.z, extent_m);
    r.lo_o = vector_of(o.x + skin, o.y + skin, o.z + skin);
    r.hi_o = vector_of(o.x - skin, o.y - skin, o.z - skin);
    r.near_o =
        vector_of(nx ? r.hi_o.x : r.lo_o.x, ny ? r.hi_o.y : r.lo_o.y, nz ? r.hi_o.z : r.lo_o.z);
    r.far_o =
        vector_of(nx ? r.lo_o.x : r.hi_o.x, ny ? r.lo_o.y : r.hi_o.y, nz ? r.lo_o.z : r.hi_o.z);
    r.inverse = vector_of(safe_inverse(d.x), safe_inverse(d.y), safe_inverse(d.z));
    r.near_x = nx ? 1 : 0;
    r.near_y = ny ? 3 : 2;
    r.near_z = nz ? 5 : 4;
    r.kz = dominant_axis(d.x, d.y, d.z);
    r.kx = r.kz == 2 ? 0 : r.kz + 1;
    r.ky = r.kx == 2 ? 0 : r.kx + 1;
    r.ox = along(o, r.kx);
    r.oy = along(o, r.ky);
    r.oz = along(o, r.kz);
    r.sz = along(r.inverse, r.kz);
    r.sx = along(d, r.kx) * r.sz;
    r.sy = along(d, r.ky) * r.sz;
    return r;
}

DEFINE_INTERSECT(intersect4, float4, int4)

/* Rows are read as vectors through a cast: vload8 may fall apart into narrow loads, and the structs
 * are made of whole, aligned rows. */

/* Which of a node's boxes the ray enters before T_MAX, and where. */
static inline uint enter8(__global const float8 *row, const ray8 *r, float t_max, float8 *entry) {
    float8 x = SLAB(row[r->near_x], r->near_o.x, r->inverse.x);
    float8 y = SLAB(row[r->near_y], r->near_o.y, r->inverse.y);
    float8 z = SLAB(row[r->near_z], r->near_o.z, r->inverse.z);
    float8 in = GREATER(GREATER(x, y), GREATER(z, (float8)(0.0f)));
    x = SLAB(row[r->near_x ^ 1], r->far_o.x, r->inverse.x);
    y = SLAB(row[r->near_y ^ 1], r->far_o.y, r->inverse.y);
    z = SLAB(row[r->near_z ^ 1], r->far_o.z, r->inverse.z);
    float8 out = LESSER(LESSER(x, y), LESSER(z, (float8)(t_max)));
    *entry = in;
    return bits8(in <= out);
}

/* One axis of the boxes of a block's triangles: where the ray enters and leaves. */
static inline void enter_axis4(float4 a, float4 b, float4 c, float lo_o, float hi_o, float inverse,
                               float4 *in, float4 *out) {
    float4 lo = LESSER(LESSER(a, b), c), hi = GREATER(GREATER(a, b), c);
    float4 at_lo = SLAB(BOX_LO(lo, hi), lo_o, inverse), at_hi = SLAB(BOX_HI(lo, hi), hi_o, inverse);
    *in = GREATER(*in, LESSER(at_lo, at_hi));
    *out = LESSER(*out, GREATER(at_lo, at_hi));
}

static inline void hit_block(__global const dev_block4 *block, const ray8 *r, dev_hit *best) {
    __global const float4 *v = (__global const float4 *)block;
    uint kx = r->kx, ky = r->ky, kz = r->kz;
    float4 over, under;
    int4 met = intersect4(v[kx] - r->ox, v[ky] - r->oy, v[kz] - r->oz, v[3 + kx] - r->ox,
                          v[3 + ky] - r->oy, v[3 + kz] - r->oz, v[6 + kx] - r->ox,
                          v[6 + ky] - r->oy, v[6 + kz] - r->oz, (float4)(r->sx), (float4)(r->sy),
                          (float4)(r->sz), &over, &under);
    if (!some4(met)) {
        return;
    }
    float4 t = over / under;
    float4 in = (float4)(0.0f), out = (float4)(INFINITY);
    enter_axis4(v[0], v[3], v[6], r->lo_o.x, r->hi_o.x, r->inverse.x, &in, &out);
    enter_axis4(v[1], v[4], v[7], r->lo_o.y, r->hi_o.y, r->inverse.y, &in, &out);
    enter_axis4(v[2], v[5], v[8], r->lo_o.z, r->hi_o.z, r->inverse.z, &in, &out);
    t = GREATER(t, in);
    float lane_t[4];
    vstore4(t, 0, lane_t);
    for (uint bits = bits4(met & (in <= out) & (t <= best->t_m)); bits; bits &= bits - 1) {
        uint lane = lowest_bit(bits), id = block->id[lane];
        if (lane_t[lane] < best->t_m || (lane_t[lane] == best->t_m && id < best->triangle)) {
            best->t_m = lane_t[lane];
            best->triangle = id;
        }
    }
}

/* Children still to visit, roughly the nearest on top. */
typedef struct stack8 {
    uint child[TRACE_STACK];
    float entry[TRACE_STACK];
} stack8;

/* Starts to bring what WORD names into the cache, where the compiler is known to know how. */
static inline void fetch_early(__global const dev_node8 *nodes, __global const dev_block4 *blocks,
                               uint word) {
#if defined(__clang__) && (defined(__x86_64__) || defined(__aarch64__))
    __global const char *at = (word & DEV_LEAF) ? (__global const char *)&blocks[word & ~DEV_LEAF]
                                                : (__global const char *)&nodes[word];
    __builtin_prefetch(at);
    __builtin_prefetch(at + 64);
    __builtin_prefetch(at + 128);
#endif
}

/* The nearest of the entered children; the others go on the stack. */
static inline uint nearest_child(__global const dev_node8 *nodes, __global const dev_block4 *blocks,
                                 stack8 *s, uint *top, __global const uint *child, uint bits,
                                 float8 entry) {
    float in[8];
    vstore8(entry, 0, in);
    uint lane = lowest_bit(bits), word = child[lane];
    float nearest = in[lane];
    for (bits &= bits - 1; bits; bits &= bits - 1) {
        lane = lowest_bit(bits);
        float other = in[lane];
        uint other_word = child[lane];
        fetch_early(nodes, blocks, other_word);
        bool swap = other < nearest;
        s->child[*top] = swap ? word : other_word;
        s->entry[*top] = swap ? nearest : other;
        word = swap ? other_word : word;
        nearest = swap ? other : nearest;
        ++*top;
    }
    return word;
}

/* A ray on its way. */
typedef struct walker8 {
    ray8 r;
    stack8 s;
    uint top, word; /* what it visits next */
    dev_hit best;
} walker8;

/* Visits one node or leaf; false at the end of the walk. */
static inline bool step8(__global const dev_node8 *nodes, __global const dev_block4 *blocks,
                         walker8 *w) {
    uint word = w->word;
    if (word & DEV_LEAF) {
        hit_block(&blocks[word & ~DEV_LEAF], &w->r, &w->best);
    } else {
        float8 entry;
        uint bits = enter8((__global const float8 *)&nodes[word], &w->r, w->best.t_m, &entry);
        if (bits) {
            w->word = nearest_child(nodes, blocks, &w->s, &w->top, nodes[word].child, bits, entry);
            fetch_early(nodes, blocks, w->word);
            return true;
        }
    }
    do {
        if (w->top == 0) {
            return false;
        }
        w->top--;
    } while (w->s.entry[w->top] > w->best.t_m);
    w->word = w->s.child[w->top];
    return true;
}

/* The walkers ALIVE to the end of their ways: while one waits for memory the next goes on. */
TRACE_APART static void walk_in_turns(__global const dev_node8 *nodes,
                                      __global const dev_block4 *blocks, walker8 *w, uint alive) {
    while (alive) {
        for (uint turn = alive; turn; turn &= turn - 1) {
            uint i = lowest_bit(turn);
            alive &= step8(nodes, blocks, &w[i]) ? ~0u : ~(1u << i);
        }
    }
}

/* Rays of a work-item: those of them that enter a box below the root are enough to take turns. */
#define TURNS_RAYS 64

/* Up to sixteen rays from ROOT, by their numbers in RAYS. */
static inline void walk_rays(__global const dev_node8 *nodes, __global const dev_block4 *blocks,
                             __global const dev_ray *rays, __global dev_hit *hits, const uint *own,
                             uint count, uint root, float extent_m) {
    walker8 w[16];
    for (uint i = 0; i < count; i++) {
        dev_ray ray = rays[own[i]];
        w[i].r = ray8_prepare(ray, extent_m);
        w[i].best.t_m = ray.t_max;
        w[i].best.triangle = ~0u;
        w[i].word = root;
        w[i].top = 0;
    }
    walk_in_turns(nodes, blocks, w, (1u << count) - 1);
    for (uint i = 0; i < count; i++) {
        if (w[i].best.triangle != ~0u) {
            hits[own[i]] = w[i].best;
        }
    }
}

/* Rays FIRST .. FIRST + 63, those below COUNT. */
TRACE_APART static void trace_in_turns(__global const dev_node8 *nodes,
                                       __global const dev_block4 *blocks,
                                       __global const dev_ray *rays, __global dev_hit *hits,
                                       uint first, uint count, uint root, float extent_m) {
    uint entering[TURNS_RAYS], entered = 0;
    for (uint at = first; at < first + TURNS_RAYS && at < count; at += 16) {
        rays16 r = load_rays16(rays, at, count);
        hits16 none = {r.t_max, (uint16)(~0u)};
        store_hits16(hits, at, count, none);
        for (uint left = sieve16(nodes, r, root, extent_m); left; left &= left - 1) {
            entering[entered++] = at + lowest_bit(left);
        }
    }
    for (uint at = 0; at < entered; at += 16) {
        uint some = entered - at < 16 ? entered - at : 16;
        walk_rays(nodes, blocks, rays, hits, &entering[at], some, root, extent_m);
    }
}

#endif
