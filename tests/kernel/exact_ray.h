/*
 * Ray against triangle in integers: what the ranges of the casters are held against.
 *
 * Corners and origins are floats on a grid of 2^-20 m within 2^17 m, directions floats on a grid of
 * 2^-40: integers of at most 39 bits (differences of corners and origin) and 41. A determinant of three
 * such columns has at most 122 bits, so that hit or miss, and both terms of every quotient, are exact;
 * quotients and what follows from them are rounded to long double.
 */
#ifndef ASDIC_TESTS_EXACT_RAY_H
#define ASDIC_TESTS_EXACT_RAY_H

#include "kernels/types.h"

#include <math.h>
#include <stdbool.h>
#include <stdint.h>

#define EXACT_LENGTH 0x1p20
#define EXACT_DIRECTION 0x1p40

__extension__ typedef __int128 exact_int;

/* A float on the grid of lengths, or of directions, next to X. */
static inline float exact_snap(double x, double grid) {
    return (float)(nearbyint((double)(float)x * grid) / grid);
}

typedef struct exact_column {
    int64_t x, y, z;
} exact_column;

typedef struct exact_normal {
    exact_int x, y, z;
} exact_normal;

static inline exact_column exact_corner(const float v[3], const float origin[3]) {
    return (exact_column){(int64_t)(EXACT_LENGTH * v[0]) - (int64_t)(EXACT_LENGTH * origin[0]),
                          (int64_t)(EXACT_LENGTH * v[1]) - (int64_t)(EXACT_LENGTH * origin[1]),
                          (int64_t)(EXACT_LENGTH * v[2]) - (int64_t)(EXACT_LENGTH * origin[2])};
}

static inline exact_normal exact_cross(exact_column a, exact_column b) {
    return (exact_normal){(exact_int)a.y * b.z - (exact_int)a.z * b.y,
                          (exact_int)a.z * b.x - (exact_int)a.x * b.z,
                          (exact_int)a.x * b.y - (exact_int)a.y * b.x};
}

static inline exact_int exact_dot(exact_column a, exact_normal b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

/* Where a ray's line meets a triangle's plane. */
typedef struct exact_meeting {
    bool inside;       /* of the triangle, edges and all, and ahead */
    long double range; /* in lengths of the direction */
    long double sine;  /* of the angle between ray and plane */
} exact_meeting;

static inline exact_meeting exact_meet(const dev_ray *ray, const dev_triangle *t) {
    const float *r = ray->direction;
    exact_column d = {(int64_t)(EXACT_DIRECTION * r[0]), (int64_t)(EXACT_DIRECTION * r[1]),
                      (int64_t)(EXACT_DIRECTION * r[2])};
    exact_column a = exact_corner(t->v0, ray->origin), b = exact_corner(t->v1, ray->origin),
                 c = exact_corner(t->v2, ray->origin);
    exact_normal bc = exact_cross(b, c), ca = exact_cross(c, a), ab = exact_cross(a, b);
    exact_int u = exact_dot(d, bc), v = exact_dot(d, ca), w = exact_dot(d, ab);
    exact_int under = u + v + w, over = exact_dot(a, bc);
    bool right = u >= 0 && v >= 0 && w >= 0 && over > 0;
    bool left = u <= 0 && v <= 0 && w <= 0 && over < 0;
    if (under == 0 || !(right || left)) {
        return (exact_meeting){.inside = false};
    }
    long double nx = (long double)(bc.x + ca.x + ab.x), ny = (long double)(bc.y + ca.y + ab.y),
                nz = (long double)(bc.z + ca.z + ab.z), dx = (long double)d.x,
                dy = (long double)d.y, dz = (long double)d.z;
    long double lengths = sqrtl(nx * nx + ny * ny + nz * nz) * sqrtl(dx * dx + dy * dy + dz * dz);
    return (exact_meeting){.inside = true,
                           .range = (long double)over / (long double)under *
                                    (EXACT_DIRECTION / EXACT_LENGTH),
                           .sine = fabsl((long double)under) / lengths};
}

/* ---- distances, in long double from floats: errors of 1e-18 of the coordinates ---------------- */

typedef struct exact_point {
    long double k[3];
} exact_point;

static inline exact_point exact_difference(exact_point a, exact_point b) {
    return (exact_point){{a.k[0] - b.k[0], a.k[1] - b.k[1], a.k[2] - b.k[2]}};
}

static inline exact_point exact_along(exact_point a, long double share, exact_point b) {
    return (exact_point){
        {a.k[0] + share * b.k[0], a.k[1] + share * b.k[1], a.k[2] + share * b.k[2]}};
}

static inline long double exact_product(exact_point a, exact_point b) {
    return a.k[0] * b.k[0] + a.k[1] * b.k[1] + a.k[2] * b.k[2];
}

static inline exact_point exact_across(exact_point a, exact_point b) {
    return (exact_point){{a.k[1] * b.k[2] - a.k[2] * b.k[1], a.k[2] * b.k[0] - a.k[0] * b.k[2],
                          a.k[0] * b.k[1] - a.k[1] * b.k[0]}};
}

/* The triangle's corners as the ray's origin sees them, each barycentric coordinate allowed to fall to
 * -WIDER. */
static inline void exact_corners(const dev_ray *ray, const dev_triangle *t, long double wider,
                                 exact_point out[3]) {
    exact_point v[3];
    for (int k = 0; k < 3; k++) {
        v[0].k[k] = (long double)t->v0[k] - ray->origin[k];
        v[1].k[k] = (long double)t->v1[k] - ray->origin[k];
        v[2].k[k] = (long double)t->v2[k] - ray->origin[k];
    }
    for (int c = 0; c < 3; c++) {
        exact_point p = exact_difference(v[c], v[(c + 1) % 3]),
                    q = exact_difference(v[c], v[(c + 2) % 3]);
        out[c] = exact_along(exact_along(v[c], wider, p), wider, q);
    }
}

static inline long double exact_to_edge(exact_point p, exact_point a, exact_point b) {
    exact_point along = exact_difference(b, a), from = exact_difference(p, a);
    long double length2 = exact_product(along, along);
    long double share = length2 > 0.0L ? exact_product(along, from) / length2 : 0.0L;
    from = exact_along(from, -fminl(fmaxl(share, 0.0L), 1.0L), along);
    return sqrtl(exact_product(from, from));
}

/* How far the ray's point at RANGE is from the widened triangle. */
static inline long double exact_distance(const dev_ray *ray, const dev_triangle *t,
                                         long double wider, long double range) {
    exact_point c[3], d = {{ray->direction[0], ray->direction[1], ray->direction[2]}};
    exact_corners(ray, t, wider, c);
    exact_point p = exact_along((exact_point){{0.0L}}, range, d);
    exact_point e = exact_difference(c[1], c[0]), f = exact_difference(c[2], c[0]),
                q = exact_difference(p, c[0]), n = exact_across(e, f);
    long double nn = exact_product(n, n), u = exact_product(exact_across(q, f), n),
                v = exact_product(exact_across(e, q), n);
    if (nn > 0.0L && u >= 0.0L && v >= 0.0L && u + v <= nn) {
        return fabsl(exact_product(q, n)) / sqrtl(nn);
    }
    return fminl(fminl(exact_to_edge(p, c[0], c[1]), exact_to_edge(p, c[1], c[2])),
                 exact_to_edge(p, c[2], c[0]));
}

/* Of a ray that meets the triangle: how far its line keeps from the lines of the edges, at least. */
static inline long double exact_clearance(const dev_ray *ray, const dev_triangle *t) {
    exact_point c[3], d = {{ray->direction[0], ray->direction[1], ray->direction[2]}};
    exact_corners(ray, t, 0.0L, c);
    long double least = INFINITY;
    for (int i = 0; i < 3; i++) {
        exact_point across = exact_across(d, exact_difference(c[(i + 1) % 3], c[i]));
        long double length = sqrtl(exact_product(across, across));
        least = fminl(least, fabsl(exact_product(c[i], across)) / length);
    }
    return least;
}

#endif
