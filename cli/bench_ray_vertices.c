/* Rays aimed exactly at vertices, and which of them a caster lets through the surface. */
#include "bench_rays.h"

#include <math.h>
#include <stdlib.h>

#define PI 3.14159265358979323846
/* Lines round a ray, and how far from it, relative to the coordinates in play: four roundings. */
#define PROBES 8
#define ROUNDING 0x1p-22

/* One ray that met nothing up to its vertex. */
typedef struct suspect {
    float vertex[3];
    unsigned met; /* probes */
    size_t ray;
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

/* Whether the line from ORIGIN along D meets the triangle: products of floats are all but exact in
 * long double. */
static bool meets(const long double origin[3], const long double d[3], const float *triangle) {
    long double corner[3][3];
    for (int c = 0; c < 3; c++) {
        for (int k = 0; k < 3; k++) {
            corner[c][k] = triangle[3 * c + k] - origin[k];
        }
    }
    long double u = volume(d, corner[1], corner[2]), v = volume(d, corner[2], corner[0]),
                w = volume(d, corner[0], corner[1]);
    return (u > 0.0L && v > 0.0L && w > 0.0L) || (u < 0.0L && v < 0.0L && w < 0.0L);
}

/* Which of PROBES lines round the ray, as far from it as rounding may shift it, meet the triangle. */
static unsigned probe(const asdic_ray *ray, const float *triangle) {
    unsigned met = 0;
    float reach = 0.0f;
    double side[3], up[3];
    long double d[3];
    for (int k = 0; k < 3; k++) {
        d[k] = ray->direction[k];
        reach = fmaxf(reach, fabsf(ray->origin_m[k]) + ray->unused);
    }
    bench_axes_across(ray->direction, side, up);
    for (int i = 0; i < PROBES; i++) {
        double turn = 2.0 * PI * i / PROBES, off_m = ROUNDING * (double)reach;
        long double from[3];
        for (int k = 0; k < 3; k++) {
            from[k] = ray->origin_m[k] + off_m * (cos(turn) * side[k] + sin(turn) * up[k]);
        }
        met |= (unsigned)meets(from, d, triangle) << i;
    }
    return met;
}

/* Rays that met nothing up to their vertex; returns how many. */
static size_t gather_suspects(const float *corners_m, size_t triangles, const asdic_ray *rays,
                              const asdic_ray_hit *hits, size_t count, suspect *suspects) {
    uint64_t seed = BENCH_VERTEX_SEED;
    size_t found = 0;
    for (size_t i = 0; i < count; i++) {
        const float *v = &corners_m[3 * next_corner(&seed, triangles)];
        if (!(hits[i].range_m <= 1.0001f * rays[i].unused)) {
            suspects[found++] = (suspect){{v[0], v[1], v[2]}, 0, i};
        }
    }
    return found;
}

size_t bench_rays_missed(const float *corners_m, size_t triangles, const asdic_ray *rays,
                         const asdic_ray_hit *hits, size_t count, size_t *passed) {
    suspect *suspects = malloc(count * sizeof *suspects);
    size_t missed = 0, found = 0;
    if (suspects) {
        found = gather_suspects(corners_m, triangles, rays, hits, count, suspects);
        qsort(suspects, found, sizeof *suspects, compare_suspects);
    }
    for (size_t i = 0; found > 0 && i < 3 * triangles; i++) {
        const float *vertex = &corners_m[3 * i];
        size_t at = find_suspect(suspects, found, vertex);
        for (; at < found && compare_places(suspects[at].vertex, vertex) == 0; at++) {
            suspects[at].met |= probe(&rays[suspects[at].ray], &corners_m[i / 3 * 9]);
        }
    }
    for (size_t i = 0; i < found; i++) {
        missed += suspects[i].met == (1u << PROBES) - 1;
    }
    *passed = found - missed;
    free(suspects);
    return missed;
}
