/* Rays aimed exactly at vertices, and which of them a caster lets through the surface. A direction
 * is rounded: a ray may pass its vertex beside the silhouette, or meet the limb well behind it. */
#include "beside.h"

#include <math.h>
#include <stdlib.h>

#define PI 3.14159265358979323846
/* A ray, and lines round it as far away as rounding may shift it, relative to the coordinates in
 * play: four roundings. */
#define LINES 9
#define ROUNDING 0x1p-22

/* One ray that met nothing up to its vertex. */
typedef struct suspect {
    float vertex[3];
    size_t ray;
    double range_m[LINES]; /* the farthest that its lines may meet the triangles at the vertex;
                              INFINITY: they do not */
} suspect;

/* Corners of triangles, drawn at random: numbers into CORNERS_M / 3. */
static size_t next_corner(uint64_t *seed, size_t triangles) {
    return (size_t)(bench_uniform(seed) * 3.0 * (double)triangles);
}

void bench_rays_at_vertices(const bench_ray_scene *s, const float *corners_m, size_t triangles,
                            asdic_ray *rays, size_t count) {
    uint64_t seed = BENCH_VERTEX_SEED;
    for (size_t i = 0; i < count; i++) {
        const float *v = &corners_m[3 * next_corner(&seed, triangles)];
        double to[3], range2 = 0.0;
        for (int k = 0; k < 3; k++) {
            to[k] = (double)v[k] - s->from_m[k];
            range2 += to[k] * to[k];
        }
        rays[i] = bench_ray_from(s->from_m, to);
        rays[i].unused = (float)sqrt(range2);
    }
}

static int compare_places(const float *a, const float *b) {
    for (int k = 0; k < 3; k++) {
        if (a[k] != b[k]) {
            return a[k] < b[k] ? -1 : 1;
        }
    }
    return 0;
}

static int compare_suspects(const void *a, const void *b) {
    return compare_places(((const suspect *)a)->vertex, ((const suspect *)b)->vertex);
}

/* The first suspect at VERTEX or behind it. */
static size_t find_suspect(const suspect *suspects, size_t count, const float *vertex) {
    size_t low = 0, high = count;
    while (low < high) {
        size_t middle = low + (high - low) / 2;
        if (compare_places(suspects[middle].vertex, vertex) < 0) {
            low = middle + 1;
        } else {
            high = middle;
        }
    }
    return low;
}

/* Six times the volume of (D, P, Q). */
static long double volume(const long double d[3], const long double p[3], const long double q[3]) {
    return d[0] * (p[1] * q[2] - p[2] * q[1]) + d[1] * (p[2] * q[0] - p[0] * q[2]) +
           d[2] * (p[0] * q[1] - p[1] * q[0]);
}

/* Twice the area of a triangle. */
static long double area(const long double c[3][3]) {
    long double e[3], f[3];
    for (int k = 0; k < 3; k++) {
        e[k] = c[1][k] - c[0][k];
        f[k] = c[2][k] - c[0][k];
    }
    return hypotl(hypotl(e[1] * f[2] - e[2] * f[1], e[2] * f[0] - e[0] * f[2]),
                  e[0] * f[1] - e[1] * f[0]);
}

/* Where the line from ORIGIN along D meets the triangle, edges and all, when SHIFT_M moves it;
 * INFINITY: nowhere ahead. Differences and products of floats are all but exact in long double: it
 * errs about the side of an edge within 1e-18 of it only, and for both its triangles alike. */
static double farthest_m(const long double origin[3], const long double d[3], const float *triangle,
                         double shift_m) {
    long double corner[3][3];
    for (int c = 0; c < 3; c++) {
        for (int k = 0; k < 3; k++) {
            corner[c][k] = triangle[3 * c + k] - origin[k];
        }
    }
    long double u = volume(d, corner[1], corner[2]), v = volume(d, corner[2], corner[0]),
                w = volume(d, corner[0], corner[1]), across = u + v + w;
    bool within = (u >= 0.0L && v >= 0.0L && w >= 0.0L) || (u <= 0.0L && v <= 0.0L && w <= 0.0L);
    long double range = volume(corner[0], corner[1], corner[2]) / across;
    return within && range > 0.0L ? (double)(range + shift_m * area(corner) / fabsl(across))
                                  : INFINITY;
}

/* Tries the lines of a suspect on one of the triangles at its vertex. */
static void probe(const asdic_ray *ray, const float *triangle, suspect *s) {
    float reach = 0.0f;
    double side[3], up[3];
    long double d[3];
    for (int k = 0; k < 3; k++) {
        d[k] = ray->direction[k];
        reach = fmaxf(reach, fabsf(ray->origin_m[k]) + ray->unused);
    }
    bench_axes_across(ray->direction, side, up);
    double shift_m = ROUNDING * (double)reach;
    for (int i = 0; i < LINES; i++) { /* the ray itself comes last */
        double turn = 2.0 * PI * i / (LINES - 1), off_m = i < LINES - 1 ? shift_m : 0.0;
        long double from[3];
        for (int k = 0; k < 3; k++) {
            from[k] = ray->origin_m[k] + off_m * (cos(turn) * side[k] + sin(turn) * up[k]);
        }
        s->range_m[i] = fmin(s->range_m[i], farthest_m(from, d, triangle, shift_m));
    }
}

/* Rays that met nothing up to their vertex; returns how many. */
static size_t gather_suspects(const float *corners_m, size_t triangles, const asdic_ray *rays,
                              const asdic_ray_hit *hits, size_t count, suspect *suspects) {
    uint64_t seed = BENCH_VERTEX_SEED;
    size_t found = 0;
    for (size_t i = 0; i < count; i++) {
        const float *v = &corners_m[3 * next_corner(&seed, triangles)];
        if (!(hits[i].range_m <= 1.0001f * rays[i].unused)) {
            suspect *s = &suspects[found++];
            *s = (suspect){{v[0], v[1], v[2]}, i, {0.0}};
            for (int k = 0; k < LINES; k++) {
                s->range_m[k] = INFINITY;
            }
        }
    }
    return found;
}

static void judge(const suspect *s, float range_m, bench_vertex_rays *count) {
    double most_m = 0.0;
    bool surrounded = true, met = isfinite(s->range_m[LINES - 1]);
    for (int i = 0; i < LINES; i++) {
        bool there = isfinite(s->range_m[i]);
        most_m = there ? fmax(most_m, s->range_m[i]) : most_m;
        surrounded &= there;
    }
    if (range_m <= most_m) {
        return; /* what it met is the surface within rounding of the ray */
    }
    count->missed += surrounded;
    count->grazed += met && !surrounded;
    count->passed += !met;
}

bench_vertex_rays bench_rays_judge(const float *corners_m, size_t triangles, const asdic_ray *rays,
                                   const asdic_ray_hit *hits, size_t count) {
    suspect *suspects = malloc(count * sizeof *suspects);
    bench_vertex_rays counts = {0};
    size_t found = 0;
    if (suspects) {
        found = gather_suspects(corners_m, triangles, rays, hits, count, suspects);
        qsort(suspects, found, sizeof *suspects, compare_suspects);
    }
    for (size_t i = 0; found > 0 && i < 3 * triangles; i++) {
        const float *vertex = &corners_m[3 * i];
        size_t at = find_suspect(suspects, found, vertex);
        for (; at < found && compare_places(suspects[at].vertex, vertex) == 0; at++) {
            probe(&rays[suspects[at].ray], &corners_m[i / 3 * 9], &suspects[at]);
        }
    }
    for (size_t i = 0; i < found; i++) {
        judge(&suspects[i], hits[suspects[i].ray].range_m, &counts);
    }
    free(suspects);
    return counts;
}
