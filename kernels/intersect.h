/*
 * Ray against box and ray against triangle: the one definition of a hit that every kernel shares.
 *
 * A hit is a function of (ray, triangle) alone, so the nearest hit does not depend on the order in
 * which a kernel meets the triangles, nor on how many lanes it tests at once:
 *
 *   1. Watertight test: S. Woop, C. Benthin, I. Wald, "Watertight Ray/Triangle Intersection",
 *      JCGT 2(1), 2013. The corners are sheared so that the ray becomes the z axis; the three edge
 *      functions then are 2-D cross products of rounded corners. Their signs are right (EDGE), so
 *      that both triangles of an edge agree on which side of it the ray passes: no ray slips between.
 *      TRACE_TOLERANCE widens triangles by 1e-4 of their size, for meshes whose corners agree to a
 *      few digits only, and for rays aimed at a silhouette, whose direction is rounded.
 *   2. The ray must enter the triangle's own bounding box, by the same slab test as for the nodes. The
 *      box has room for the widened triangle (DEV_BOX_MARGIN).
 *   3. t is that of the triangle's plane, but not less than where the ray enters the box.
 *
 * (b - o) * inverse is monotonic in b, so the interval of any enclosing box encloses the interval
 * of the triangle's box, bit for bit: entry(node) <= entry(triangle) <= t. A traversal that skips
 * a node only when entry > best t so far can never skip the nearest hit. Equal t: lowest id wins.
 *
 * How exact that is, R being the largest coordinate of the ray's origin plus that of the scene: the
 * point at t lies within 2^-21 R (TRACE_SKIN) of the widened triangle, so that t errs by at most 2^-21 R
 * over the sine of the angle between ray and plane; and no triangle is missed whose plane the ray's
 * origin, and whose edges the ray's line, keeps at least as far away on the inside. Held against exact
 * arithmetic by tests/kernel/test_ranges.c: of 33 million rays, hard ones, the worst takes 0.62 of it.
 *
 * Lanes are the triangles of a block (one ray) or the rays of a packet (one triangle).
 */
#ifndef ASDIC_KERNEL_INTERSECT_H
#define ASDIC_KERNEL_INTERSECT_H

#pragma OPENCL FP_CONTRACT OFF

#include "fused.h"
#include "lanes.h"
#include "types.h"

#define TRACE_TOLERANCE 1e-4f

/* Entries of a traversal's stack, at least 7 * depth + 8. */
#ifndef TRACE_STACK
#define TRACE_STACK 128
#endif

/* A function of its own, so that its arrays lie on the stack once: PoCL gives what it inlines into a
 * kernel a place for every work-item of the group, which then do not fit the cache. */
#if defined(__clang__)
#define TRACE_APART __attribute__((noinline))
#else
#define TRACE_APART
#endif

/* Not fmin and fmax: those honour NaN and cost several instructions. */
#define LESSER(a, b) ((a) < (b) ? (a) : (b))
#define GREATER(a, b) ((a) > (b) ? (a) : (b))

/* The planes of a triangle's box from its corners' LO and HI; as the host does it. */
#define BOX_LO(lo, hi) fused((lo) - (hi), DEV_BOX_MARGIN, (lo))
#define BOX_HI(lo, hi) fused((hi) - (lo), DEV_BOX_MARGIN, (hi))

#define SLAB(plane, origin, inverse) (((plane) - (origin)) * (inverse))

/* The largest axis of the direction, ties to the lower one. */
static inline int dominant_axis(float x, float y, float z) {
    float ax = fabs(x), ay = fabs(y), az = fabs(z);
    return ax >= ay && ax >= az ? 0 : ay >= az ? 1 : 2;
}

/* Keeps 1 / direction finite, so that a ray along an axis gives no 0 * infinity. */
static inline float safe_inverse(float direction) {
    float d = fabs(direction) < 1e-18f ? (direction < 0.0f ? -1e-18f : 1e-18f) : direction;
    return 1.0f / d;
}

/* How far planes are moved apart for a ray from (x, y, z). */
static inline float ray_skin(float x, float y, float z, float extent_m) {
    float reach = GREATER(GREATER(fabs(x), fabs(y)), fabs(z));
    return (reach + extent_m) * TRACE_SKIN;
}

/* Twice the area of (0, p, q), to two units in its last place however much cancels, so that its sign is
 * right. Kahan's difference of products: C.-P. Jeannerod, N. Louvet, J.-M. Muller, "Further Analysis of
 * Kahan's Algorithm", Mathematics of Computation 82, 2013. Where products do not fuse, what their
 * roundings lose is found by splitting (T. J. Dekker, Numerische Mathematik 18, 1971) and added: J.-M.
 * Muller, "On the Error of Computing ab + cd", ACM TOMS 41(2), 2015. */
#ifdef ASDIC_FUSED
#define EDGE(px, py, qx, qy) (fused((qx), (py), -((qy) * (px))) + fused(-(qy), (px), (qy) * (px)))
#else
#define UPPER(a) (4097.0f * (a) - (4097.0f * (a) - (a)))
#define LOWER(a) (-UPPER(a) + (a))
#define LOST(a, b)                                                                                 \
    (((UPPER(a) * UPPER(b) - (a) * (b)) + UPPER(a) * LOWER(b) + LOWER(a) * UPPER(b)) +             \
     LOWER(a) * LOWER(b))
#define EDGE(px, py, qx, qy) (((qx) * (py) - (qy) * (px)) + (LOST(qx, py) - LOST(qy, px)))
#endif

/* Defines `intersect4` and the like, one text for every number of lanes.
 *
 * Corners a, b, c relative to the ray's origin, z being the dominant axis of the direction; shear
 * (sx, sy) = d_x / d_z, d_y / d_z, sz = 1 / d_z. True where the ray's line meets the triangle
 * ahead; the distance along the ray then is *OVER / *UNDER, between those of the corners. It is left to
 * the caller, who need not wait for it where nothing is met. */
#define DEFINE_INTERSECT(name, lanes, lane_mask)                                                   \
    static inline lane_mask name(lanes ax, lanes ay, lanes az, lanes bx, lanes by, lanes bz,       \
                                 lanes cx, lanes cy, lanes cz, lanes sx, lanes sy, lanes sz,       \
                                 lanes *over, lanes *under) {                                      \
        ax = fused(-sx, az, ax);                                                                   \
        ay = fused(-sy, az, ay);                                                                   \
        bx = fused(-sx, bz, bx);                                                                   \
        by = fused(-sy, bz, by);                                                                   \
        cx = fused(-sx, cz, cx);                                                                   \
        cy = fused(-sy, cz, cy);                                                                   \
        lanes u = EDGE(bx, by, cx, cy), v = EDGE(cx, cy, ax, ay), w = EDGE(ax, ay, bx, by);        \
        lanes low = LESSER(LESSER(u, v), w), high = GREATER(GREATER(u, v), w);                     \
        *under = (u + v) + w;                                                                      \
        *over = fused(w, cz, fused(v, bz, u * az)) * sz;                                           \
        lanes slack = TRACE_TOLERANCE * fabs(*under);                                              \
        return ((*over > 0.0f) & (low > -slack)) | ((*over < 0.0f) & (high < slack));              \
    }

static inline uint lowest_bit(uint bits) {
    return 31 - clz(bits & -bits);
}

#endif
