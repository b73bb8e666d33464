/*
 * Sixteen rays, and their hits, as vectors: from memory and back, and what they have in common.
 */
#ifndef ASDIC_KERNEL_TRACE_LANES_H
#define ASDIC_KERNEL_TRACE_LANES_H

#include "intersect.h"

DEFINE_INTERSECT(intersect16, float16, int16)

static inline float least16(float16 v) {
    float8 a = LESSER(v.lo, v.hi);
    float4 b = LESSER(a.lo, a.hi);
    float2 c = LESSER(b.lo, b.hi);
    return LESSER(c.x, c.y);
}

static inline float greatest16(float16 v) {
    return -least16(-v);
}

/* One over directions' cosines, finite for those that are nearly zero. */
static inline float16 inverse16(float16 d) {
    float16 tiny = d < 0.0f ? (float16)(-1e-18f) : (float16)(1e-18f);
    return 1.0f / (fabs(d) < 1e-18f ? tiny : d);
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

static inline float16 choose3(int16 k, float16 at0, float16 at1, float16 at2) {
    return k == 0 ? at0 : k == 1 ? at1 : at2;
}

/* As dominant_axis, of every ray. */
static inline int16 dominant_axis16(rays16 r) {
    float16 ax = fabs(r.dx), ay = fabs(r.dy), az = fabs(r.dz);
    return ((ax >= ay) & (ax >= az)) ? (int16)(0) : (ay >= az ? (int16)(1) : (int16)(2));
}

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
    float16 t_m = h.id == ~0u ? (float16)(INFINITY) : h.t;
    if (first + 16 <= count) {
        float16 id = as_float16(h.id), low, high;
        low.even = t_m.lo;
        low.odd = id.lo;
        high.even = t_m.hi;
        high.odd = id.hi;
        ((__global float16 *)&hits[first])[0] = low;
        ((__global float16 *)&hits[first])[1] = high;
        return;
    }
    float t[16];
    uint id[16];
    vstore16(t_m, 0, t);
    vstore16(h.id, 0, id);
    for (uint i = 0; first + i < count; i++) {
        hits[first + i].t_m = t[i];
        hits[first + i].triangle = id[i];
    }
}

#endif
