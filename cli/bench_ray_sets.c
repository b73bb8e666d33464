/* The rays of `asdic bench rays`: cones and spheres, in order of direction and in none. */
#include "bench_rays.h"

#include <math.h>
#include <stdlib.h>

#define CONE_HALF_ANGLE_RAD (10.0 * CLI_PI / 180.0)

const char *bench_ray_set_name(bench_ray_set set) {
    static const char *const names[BENCH_RAY_SETS] = {[BENCH_CONE_DENSE] = "cone-dense",
                                                      [BENCH_CONE] = "cone",
                                                      [BENCH_SPHERE_DENSE] = "sphere-dense",
                                                      [BENCH_SPHERE] = "sphere",
                                                      [BENCH_SPHERE_RANDOM] = "sphere-random"};
    return set < BENCH_RAY_SETS ? names[set] : "?";
}

/* splitmix64 (Steele, Lea & Flood 2014). */
double bench_uniform(uint64_t *state) {
    uint64_t z = *state += 0x9e3779b97f4a7c15u;
    z = (z ^ z >> 30) * 0xbf58476d1ce4e5b9u;
    z = (z ^ z >> 27) * 0x94d049bb133111ebu;
    return (double)((z ^ z >> 31) >> 11) * 0x1p-53;
}

asdic_ray bench_ray_from(const float from_m[3], const double direction[3]) {
    double length = sqrt(direction[0] * direction[0] + direction[1] * direction[1] +
                         direction[2] * direction[2]);
    asdic_ray ray = {.longest_m = INFINITY};
    for (int k = 0; k < 3; k++) {
        ray.origin_m[k] = from_m[k];
        ray.direction[k] = (float)(direction[k] / length);
    }
    return ray;
}

/* ---- order ---------------------------------------------------------------------------------- */

typedef struct keyed {
    uint64_t key;
    asdic_ray ray;
} keyed;

static int compare_keys(const void *a, const void *b) {
    uint64_t x = ((const keyed *)a)->key, y = ((const keyed *)b)->key;
    return (x > y) - (x < y);
}

/* Two free bits after each of the lowest 21. */
static uint64_t spread_bits(uint64_t x) {
    x &= 0x1fffff;
    x = (x | x << 32) & 0x1f00000000ffffu;
    x = (x | x << 16) & 0x1f0000ff0000ffu;
    x = (x | x << 8) & 0x100f00f00f00f00fu;
    x = (x | x << 4) & 0x10c30c30c30c30c3u;
    return (x | x << 2) & 0x1249249249249249u;
}

/* Morton order of direction (G. M. Morton 1966); without memory the rays stay as they are. */
static void sort_rays(asdic_ray *rays, size_t count) {
    keyed *sorted = malloc(count * sizeof *sorted);
    for (size_t i = 0; sorted && i < count; i++) {
        sorted[i].ray = rays[i];
        sorted[i].key = 0;
        for (int k = 0; k < 3; k++) {
            uint64_t cell = (uint64_t)((0.5 * rays[i].direction[k] + 0.5) * 65535.0);
            sorted[i].key |= spread_bits(cell) << k;
        }
    }
    if (sorted) {
        qsort(sorted, count, sizeof *sorted, compare_keys);
    }
    for (size_t i = 0; sorted && i < count; i++) {
        rays[i] = sorted[i].ray;
    }
    free(sorted);
}

/* ---- sets ----------------------------------------------------------------------------------- */

void bench_axes_across(const float w[3], double u[3], double v[3]) {
    double up[3] = {0.0, 0.0, fabsf(w[2]) < 0.9f ? 1.0 : 0.0};
    up[0] = up[2] == 0.0 ? 1.0 : 0.0;
    for (int k = 0; k < 3; k++) {
        int a = (k + 1) % 3, b = (k + 2) % 3;
        u[k] = up[a] * w[b] - up[b] * w[a];
    }
    double length = sqrt(u[0] * u[0] + u[1] * u[1] + u[2] * u[2]);
    for (int k = 0; k < 3; k++) {
        u[k] /= length;
    }
    for (int k = 0; k < 3; k++) {
        int a = (k + 1) % 3, b = (k + 2) % 3;
        v[k] = w[a] * u[b] - w[b] * u[a];
    }
}

/* Stratified over solid angle. */
static void fill_cone(const bench_ray_scene *s, asdic_ray *rays, size_t count) {
    uint64_t seed = 1;
    size_t columns = (size_t)ceil(sqrt((double)count));
    double rows = (double)((count + columns - 1) / columns), u[3], v[3];
    bench_axes_across(s->towards, u, v);
    for (size_t i = 0; i < count; i++) {
        double x = ((double)(i % columns) + bench_uniform(&seed)) / (double)columns;
        double y = ((double)(i / columns) + bench_uniform(&seed)) / rows;
        double cosine = 1.0 - x * (1.0 - cos(CONE_HALF_ANGLE_RAD));
        double sine = sqrt(1.0 - cosine * cosine), turn = 2.0 * CLI_PI * y, direction[3];
        for (int k = 0; k < 3; k++) {
            direction[k] = cosine * s->towards[k] + sine * (cos(turn) * u[k] + sin(turn) * v[k]);
        }
        rays[i] = bench_ray_from(s->from_m, direction);
    }
}

static void fill_sphere(const bench_ray_scene *s, asdic_ray *rays, size_t count) {
    uint64_t seed = 2;
    for (size_t i = 0; i < count; i++) {
        double z = 2.0 * bench_uniform(&seed) - 1.0, turn = 2.0 * CLI_PI * bench_uniform(&seed);
        double across = sqrt(1.0 - z * z);
        const double direction[3] = {across * cos(turn), across * sin(turn), z};
        rays[i] = bench_ray_from(s->from_m, direction);
    }
}

void bench_rays_fill(bench_ray_set set, const bench_ray_scene *s, asdic_ray *rays, size_t count) {
    if (set == BENCH_CONE_DENSE || set == BENCH_CONE) {
        fill_cone(s, rays, count);
    } else {
        fill_sphere(s, rays, count);
    }
    if (set != BENCH_SPHERE_RANDOM) {
        sort_rays(rays, count);
    }
}
