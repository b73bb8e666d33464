/*
 * What the bench says of rays aimed at vertices, for casters that are right, blind or dull by
 * construction: over a rough floor seen at a ten-thousandth of a radian, where rounding a direction
 * moves ranges by a thousandth.
 */
#include "asserts.h"

#include "beside.h"

#include <stdlib.h>

#define SIDE 16 /* cells of the floor */
#define TRIANGLES (2 * SIDE * SIDE)
#define RAYS 4096

static float corners[9 * TRIANGLES];
static const bench_ray_scene scene = {.from_m = {0.1f, -0.2f, 0.3f}};

/* Metres ahead, aside and below of the point that rays start from, in axes that no coordinate
 * follows. */
static void put_corner(int i, int j, float out[3]) {
    static const double ahead[3] = {2.0 / 3.0, 2.0 / 3.0, 1.0 / 3.0},
                        aside[3] = {-2.0 / 3.0, 1.0 / 3.0, 2.0 / 3.0},
                        below[3] = {1.0 / 3.0, -2.0 / 3.0, 2.0 / 3.0};
    double x = 10.0 + i, y = j - 0.5 * SIDE, z = 1e-3 + 1e-5 * ((7 * i + 3 * j) % 5);
    for (int k = 0; k < 3; k++) {
        out[k] = (float)(scene.from_m[k] + x * ahead[k] + y * aside[k] + z * below[k]);
    }
}

static int make_floor(void **state) {
    (void)state;
    for (int n = 0; n < TRIANGLES; n++) {
        int i = n / 2 / SIDE, j = n / 2 % SIDE, odd = n % 2;
        put_corner(i + odd, j + odd, &corners[9 * n]);
        put_corner(i + 1 - odd, j + odd, &corners[9 * n + 3]);
        put_corner(i + 1 - odd, j + 1 - odd, &corners[9 * n + 6]);
    }
    return 0;
}

/* Where the ray meets the triangle: T. Moeller, B. Trumbore, Journal of Graphics Tools 2(1),
 * 1997. */
static double meet(const asdic_ray *ray, const float *v) {
    long double e[3], f[3], s[3], p[3], q[3], det = 0.0L, u = 0.0L, w = 0.0L, t = 0.0L;
    for (int k = 0; k < 3; k++) {
        e[k] = (long double)v[3 + k] - v[k];
        f[k] = (long double)v[6 + k] - v[k];
        s[k] = (long double)ray->origin_m[k] - v[k];
    }
    for (int k = 0; k < 3; k++) {
        int a = (k + 1) % 3, b = (k + 2) % 3;
        p[k] = ray->direction[a] * f[b] - ray->direction[b] * f[a];
        q[k] = s[a] * e[b] - s[b] * e[a];
    }
    for (int k = 0; k < 3; k++) {
        det += e[k] * p[k];
        u += s[k] * p[k];
        w += ray->direction[k] * q[k];
        t += f[k] * q[k];
    }
    return u / det >= 0.0L && w / det >= 0.0L && (u + w) / det <= 1.0L && t / det > 0.0L
               ? (double)(t / det)
               : INFINITY;
}

static void cast_exactly(const asdic_ray *rays, asdic_ray_hit *hits) {
    for (int i = 0; i < RAYS; i++) {
        double nearest = INFINITY;
        for (int n = 0; n < TRIANGLES; n++) {
            nearest = fmin(nearest, meet(&rays[i], &corners[9 * n]));
        }
        hits[i].range_m = (float)nearest;
    }
}

static void verdicts(void **state) {
    (void)state;
    asdic_ray *rays = calloc(RAYS, sizeof *rays);
    asdic_ray_hit *hits = calloc(RAYS, sizeof *hits);
    assert_true(rays && hits);
    bench_rays_at_vertices(&scene, corners, TRIANGLES, rays, RAYS);
    cast_exactly(rays, hits);
    size_t behind = 0, nothing = 0;
    for (int i = 0; i < RAYS; i++) {
        behind += isfinite(hits[i].range_m) && hits[i].range_m > 1.0001f * rays[i].unused;
        nothing += isinf(hits[i].range_m);
    }
    assert_true(behind > RAYS / 20 && nothing > 10);

    bench_vertex_rays right = bench_rays_judge(corners, TRIANGLES, rays, hits, RAYS);
    assert_int_equal(right.missed, 0);
    assert_int_equal(right.grazed, 0);
    assert_int_equal(right.passed, nothing); /* past the rim */

    for (int i = 0; i < RAYS; i++) {
        hits[i].range_m = INFINITY;
    }
    bench_vertex_rays blind = bench_rays_judge(corners, TRIANGLES, rays, hits, RAYS);
    assert_int_equal(blind.passed, nothing);
    assert_int_equal(blind.missed + blind.grazed, RAYS - nothing);
    /* All but the rim's vertices have floor all round: 15 of 17 each way. */
    assert_true(blind.missed > RAYS * 7 / 10 && blind.grazed > RAYS / 100);

    for (int i = 0; i < RAYS; i++) {
        hits[i].range_m = 1.5f * rays[i].unused;
    }
    bench_vertex_rays dull = bench_rays_judge(corners, TRIANGLES, rays, hits, RAYS);
    assert_int_equal(dull.missed, blind.missed);
    free(rays);
    free(hits);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(verdicts)};
    return cmocka_run_group_tests(tests, make_floor, NULL);
}
