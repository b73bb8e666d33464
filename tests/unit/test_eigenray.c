/*
 * Rays between two places in layered water, against fans of rays by Runge-Kutta steps.
 */
#include "asserts.h"
#include "layer_steps.h"
#include "test_context.h"

#include "sim/eigenray.h"
#include "sim/passage.h"

#include <stdlib.h>

#define PI 3.14159265358979323846

typedef struct water_case {
    const char *name;
    asdic_sound_profile cast;
    double from_m;
} water_case;

/* The sonar in a thermocline, above one, at its foot, on a knee's plane, on and off the axis of a channel. */
static const water_case cases[] = {
    {"thermocline", {4, {0.0, 5.0, 9.0, 12.0}, {1482.0, 1480.0, 1471.0, 1470.0}}, 7.0},
    {"above", {4, {0.0, 6.0, 9.0, 30.0}, {1482.0, 1481.0, 1450.0, 1448.0}}, 3.0},
    {"foot", {4, {0.0, 4.0, 7.0, 20.0}, {1490.0, 1489.0, 1455.0, 1456.0}}, 7.5},
    {"knee", {3, {0.0, 8.0, 60.0}, {1495.0, 1495.0, 1443.0}}, 8.0},
    {"channel", {4, {0.0, 3.0, 7.0, 12.0}, {1500.0, 1490.0, 1480.0, 1486.0}}, 6.0},
    {"axis", {4, {0.0, 3.0, 7.0, 12.0}, {1500.0, 1490.0, 1480.0, 1486.0}}, 7.0}};

static asdic_environment water_of(const water_case *c) {
    asdic_environment env = asdic_environment_default();
    env.sound_speed_profile = c->cast;
    return env;
}

/* Steps, s: of rays that are compared, and of fans that are counted in. */
#define FINE 1e-5
#define COARSE 2e-4

/* Depth at ACROSS_M of the ray of ELEVATION. */
static double depth_of(const asdic_environment *env, double from_m, double elevation,
                       double across_m, double whole) {
    double time_s;
    return trace_across(env, from_m, elevation, across_m, whole, &time_s).z;
}

/* Depth, time, length and spreading of RAY by steps. */
static void is_that_of_steps(const asdic_environment *env, const water_case *c, double to_m,
                             double across_m, const asdic_eigenray *ray, double worst[4]) {
    stepped_ray at = stepped_ray_of(env, c->from_m, across_m, ray->elevation_rad);
    double miss = missed_by(env, c->from_m, to_m, across_m, ray->elevation_rad, FINE);
    double db = 10.0 * log10(asdic_bent_ray_spread_m2(&ray->end) / at.spread_m2);
    assert_close(miss, 0.0, 2e-7);
    assert_close(ray->end.time_s, at.time_s, 1e-9);
    assert_close(ray->end.length_m, at.length_m, 1e-6);
    assert_close(ray->end.sine, sin(at.angle), 1e-8);
    worst[0] = fmax(worst[0], fabs(miss));
    worst[1] = fmax(worst[1], fabs(ray->end.time_s - at.time_s));
    worst[2] = fmax(worst[2], fabs(ray->end.length_m - at.length_m));
    worst[3] = at.spread_m2 > 1e-2 * across_m * across_m ? fmax(worst[3], fabs(db)) : worst[3];
}

/* The legs of RAY lead from plane to plane to its end, where steps have it; the first begins in the layer of FROM_M,
 * or on a plane of it. */
static void has_legs_from_plane_to_plane(const asdic_environment *env, const asdic_layers *layers,
                                         double from_m, double across_m,
                                         const asdic_eigenray *ray) {
    static asdic_eigenray_leg legs[ASDIC_MOST_EIGENRAY_LEGS + 1];
    memset(legs, 0xff, sizeof legs);
    size_t count = asdic_eigenray_legs(layers, from_m, across_m, ray, legs);
    double z_m = from_m, so_far_m = 0.0;
    assert_in_range(count, 1, ASDIC_MOST_EIGENRAY_LEGS);
    for (size_t i = 0; i < count; i++) {
        const asdic_eigenray_leg *leg = &legs[i];
        assert_true(leg->layer < layers->count);
        const asdic_layer *layer = &layers->layer[leg->layer];
        bool on_plane = leg->z_m == layer->top_m || leg->z_m == layer->bottom_m;
        assert_true(z_m >= layer->top_m && z_m <= layer->bottom_m);
        assert_true(leg->z_m >= layer->top_m && leg->z_m <= layer->bottom_m);
        assert_true(on_plane || i + 1 == count);
        assert_true(leg->across_m >= so_far_m);
        assert_close(depth_of(env, from_m, ray->elevation_rad, leg->across_m, COARSE), leg->z_m,
                     1e-3);
        z_m = leg->z_m;
        so_far_m = leg->across_m;
    }
    assert_close(so_far_m, across_m, 1e-6);
    assert_close(z_m, ray->end.z_m, 1e-6);
    assert_true(isnan(legs[count].z_m)); /* no more than it says */
}

/* How often the depth of a fan of rays by steps passes TO_M, jumps left out. */
static size_t count_in_fan(const double *fan, size_t rays, double to_m) {
    size_t count = 0;
    for (size_t i = 0; i + 1 < rays; i++) {
        count += (fan[i] > to_m) != (fan[i + 1] > to_m) && fabs(fan[i + 1] - fan[i]) < 0.5;
    }
    return count;
}

static void rays_are_those_of_steps(void **state) {
    enum { FAN = 1501 };
    static const double to_m[] = {1.3, 5.0, 6.9, 11.0}, across_m[] = {12.0, 45.0, 110.0};
    (void)state;
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        asdic_environment env = water_of(&cases[k]);
        asdic_layers layers;
        asdic_layers_of(&env, cases[k].from_m, &layers);
        double worst[4] = {0.0, 0.0, 0.0, 0.0};
        size_t rays = 0, most = 0, missing = 0;
        for (size_t a = 0; a < 3; a++) {
            double fan[FAN];
            for (size_t i = 0; i < FAN; i++) {
                double x = 2.0 * ((double)i + 0.5) / FAN - 1.0;
                fan[i] = depth_of(&env, cases[k].from_m, 1.0 * x * fabs(x), across_m[a], COARSE);
            }
            for (size_t i = 0; i < 4; i++) {
                asdic_eigenray found[ASDIC_MOST_EIGENRAYS];
                size_t count =
                    asdic_eigenrays_find(&layers, cases[k].from_m, to_m[i], across_m[a], found);
                size_t in_fan = count_in_fan(fan, FAN, to_m[i]);
                for (size_t n = 0; n < count; n++) {
                    is_that_of_steps(&env, &cases[k], to_m[i], across_m[a], &found[n], worst);
                    has_legs_from_plane_to_plane(&env, &layers, cases[k].from_m, across_m[a],
                                                 &found[n]);
                }
                rays += count;
                most = count > most ? count : most;
                missing += in_fan > count && count < ASDIC_MOST_EIGENRAYS ? in_fan - count : 0;
            }
        }
        print_message("%s: %zu rays, %zu to one place at most, %zu missing; depth within %.1g m, "
                      "time %.1g s, length %.1g m, level %.2g dB\n",
                      cases[k].name, rays, most, missing, worst[0], worst[1], worst[2], worst[3]);
        assert_int_equal(missing, 0);
        assert_true(rays > 6 && worst[3] < 0.01);
    }
}

/* Between two places at one depth of even water one ray goes, the level one; so does one to a place at just the
 * elevation of a ray that is tried. */
static void even_water_has_one_ray(void **state) {
    static const asdic_sound_profile even = {4, {0.0, 10.0, 20.0, 40.0}, {1500, 1500, 1480, 1480}};
    static const struct {
        double from_m, to_m, across_m;
    } ways[] = {{7.0, 7.0, 0.5},  {7.0, 7.0, 14.0},   {3.3, 3.3, 75.0}, {10.0, 10.0, 20.0},
                {0.0, 0.0, 30.0}, {30.0, 30.0, 80.0}, {9.0, 7.0, 2.0},  {4.0, 9.0, 5.0}};
    (void)state;
    for (size_t k = 0; k < sizeof ways / sizeof *ways; k++) {
        const double from_m = ways[k].from_m, to_m = ways[k].to_m, across_m = ways[k].across_m;
        const double way2 = across_m * across_m + (to_m - from_m) * (to_m - from_m);
        const water_case c = {"even", even, from_m};
        asdic_environment env = water_of(&c);
        asdic_layers layers;
        asdic_eigenray found[ASDIC_MOST_EIGENRAYS];
        asdic_layers_of(&env, from_m, &layers);
        assert_int_equal(asdic_eigenrays_find(&layers, from_m, to_m, across_m, found), 1);
        assert_close(found[0].elevation_rad, atan2(to_m - from_m, across_m), 1e-9);
        assert_close(asdic_bent_ray_spread_m2(&found[0].end), way2, 1e-9 * way2);
    }
}

/* Of rays that swing by less than two wavelengths, whatever these are, one stands for all. */
static void one_of_all_rays_is_left(void **state) {
    (void)state;
    const asdic_environment env = water_of(&cases[5]);
    asdic_passage way = {.top_m = 0.0, .bottom_m = 12.0};
    asdic_eigenray rays[ASDIC_MOST_EIGENRAYS];
    asdic_layers_of(&env, 7.0, &way.layers);
    size_t found = asdic_passage_rays(&way, 7.0, 7.0, 300.0, rays);
    const asdic_eigenray first = rays[0];
    assert_true(found > 2);
    assert_int_equal(asdic_passage_waves(&way, 7.0, 300.0, 0.0, rays, found), found);
    assert_int_equal(asdic_passage_waves(&way, 7.0, 300.0, 1e3, rays, found), 1);
    assert_memory_equal(&rays[0], &first, sizeof first);
    assert_int_equal(asdic_passage_waves(&way, 7.0, 300.0, 1e3, rays, 0), 0);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(rays_are_those_of_steps),
        cmocka_unit_test(even_water_has_one_ray),
        cmocka_unit_test(one_of_all_rays_is_left),
    };
    return cmocka_run_group_tests(tests, context_begin, context_end);
}
