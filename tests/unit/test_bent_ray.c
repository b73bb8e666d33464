/*
 * Rays through layers, and the levels expected of them, against straight ones, finite differences and a
 * Runge-Kutta integrator.
 */
#include "asserts.h"
#include "layer_steps.h"
#include "test_context.h"

#include "sim/bent_ray.h"

#include <asdic/expected.h>

#include <math.h>

#define PI 3.14159265358979323846

static asdic_environment cast(size_t points, const double depth_m[], const double speed_mps[]) {
    asdic_environment env = asdic_environment_default();
    env.sound_speed_profile.points = points;
    for (size_t i = 0; i < points; i++) {
        env.sound_speed_profile.depth_m[i] = depth_m[i];
        env.sound_speed_profile.sound_speed_mps[i] = speed_mps[i];
    }
    return env;
}

/* ---- Against straight rays ---- */

#define BINS 74

static asdic_ping *expect(const asdic_environment *env, double bin_m) {
    asdic_sonar sonar = asdic_sonar_default();
    asdic_beam receiver = sonar.transmitter;
    asdic_flat_scene flat = {.has_surface = true,
                             .has_bottom = true,
                             .altitude_m = 5.0,
                             .depth_m = 7.0,
                             .bottom = asdic_material_bottom(2.0)};
    asdic_pose pose = {.pitch_rad = 0.1, .roll_rad = 0.05};
    asdic_ping *ping = NULL;
    sonar.noise_enabled = false;
    sonar.receiver_count = 1;
    sonar.receivers = &receiver;
    sonar.bin_length_m = bin_m;
    assert_ok(ctx, asdic_ping_create(ctx, 1, BINS, &ping));
    assert_ok(ctx, asdic_expected_compute(ctx, &flat, env, &sonar, &pose, ping));
    return ping;
}

/* Gradients next to nothing, of both signs, in one layer and in several. */
static void levels_go_over_into_those_of_straight_rays(void **state) {
    const double depth[] = {1.0, 7.0, 9.0, 11.0};
    (void)state;
    asdic_environment env = asdic_environment_default();
    env.sound_speed_mps = 1490.0;
    asdic_ping *straight = expect(&env, 1.0);
    double worst = 0.0;
    for (int i = 0; i < 6; i++) {
        double g = (i % 2 ? -1.0 : 1.0) * (i < 2 ? 1e-7 : 1e-9);
        asdic_environment bent = env;
        if (i < 4) {
            bent.sound_speed_gradient_per_s = g;
        } else {
            const double speed[] = {1490.0 + 50.0 * g, 1490.0, 1490.0 + 4.0 * g, 1490.0 - 3.0 * g};
            bent = cast(4, depth, speed);
        }
        asdic_ping *ping = expect(&bent, 1.0);
        for (int c = ASDIC_BOTTOM; c <= ASDIC_VOLUME; c++) {
            for (size_t n = 0; n < BINS; n++) {
                double a = straight->intensity_lin[c][n], b = ping->intensity_lin[c][n];
                if (a > 0.0) {
                    worst = fmax(worst, fabs(10.0 * log10(b / a)));
                    assert_close(10.0 * log10(b / a), 0.0, 1e-4);
                } else {
                    assert_true(b <= 1e-6 * straight->intensity_lin[c][n + 1]);
                }
            }
        }
        asdic_ping_destroy(&ping);
    }
    asdic_ping_destroy(&straight);
    print_message("%.2g dB at most\n", worst);
}

/* No gradient, and a cast of one speed, are straight rays to the last bit. */
static void one_speed_gives_the_same_bytes(void **state) {
    const double depth[] = {0.0, 5.0, 30.0}, speed[] = {1490.0, 1490.0, 1490.0};
    (void)state;
    asdic_environment env = asdic_environment_default(), same = cast(3, depth, speed);
    env.sound_speed_mps = 1490.0;
    asdic_ping *a = expect(&env, 1.0), *b = expect(&same, 1.0);
    for (int c = 0; c < ASDIC_COMPONENT_COUNT; c++) {
        assert_memory_equal(a->intensity_lin[c], b->intensity_lin[c], BINS * sizeof(double));
    }
    asdic_ping_destroy(&a);
    asdic_ping_destroy(&b);
}

/* ---- Against a Runge-Kutta integrator ---- */

/* The ray through layers at TIME_S. */
static asdic_bent_ray ray_at(const asdic_layers *layers, double depth, double elevation,
                             double time_s) {
    asdic_bent_ray ray = asdic_bent_ray_start(layers, depth, elevation);
    for (;;) {
        int way;
        double exit = asdic_bent_ray_exit(layers, &ray, &way);
        if (ray.time_s + exit >= time_s) {
            return asdic_bent_ray_later(layers, &ray, time_s - ray.time_s);
        }
        ray = asdic_bent_ray_at_plane(layers, &ray, exit, way);
        assert_true(asdic_bent_ray_cross(layers, &ray, way));
    }
}

/* A channel, a thermocline and a sonar on a plane; launches at 0 and +-90 degrees, turning rays. */
static void rays_are_those_of_an_integrator(void **state) {
    const double depth[] = {2.0, 8.0, 12.0, 30.0}, speed[] = {1490.0, 1478.0, 1478.5, 1500.0};
    const double from[] = {8.0, 9.5, 5.0};
    const double elevation_deg[] = {90.0, 30.0, 7.0, 1.0, 0.0, -0.5, -4.0, -11.0, -60.0, -90.0};
    const double time_s = 0.07;
    asdic_layers layers;
    double worst_m = 0.0, worst_width = 0.0;
    (void)state;
    asdic_environment env = cast(4, depth, speed);
    asdic_layers_of(&env, 8.0, &layers);
    assert_int_equal(layers.count, 5);
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 10; j++) {
            double e = elevation_deg[j] * PI / 180.0, de = 1e-6;
            asdic_bent_ray ray = ray_at(&layers, from[i], e, time_s);
            asdic_bent_ray up = ray_at(&layers, from[i], e + de, time_s);
            asdic_bent_ray down = ray_at(&layers, from[i], e - de, time_s);
            traced at = trace(&env, from[i], e, time_s);
            double r = ray.level_spm * ray.area_m2_per_s;
            double allowed = from[i] == 8.0 && e == 0.0 ? 1e-4 : 1e-9; /* along the axis */
            assert_close(r, at.r, allowed);
            assert_close(ray.z_m, at.z, allowed);
            assert_close(ray.sine, sin(at.angle), allowed);
            assert_close(ray.length_m, at.length, allowed);
            worst_m = fmax(worst_m, hypot(r - at.r, ray.z_m - at.z));
            /* The step between neighbours at one time is across the ray: the width. At 0 degrees on a
             * plane the neighbours part. */
            if (e != 0.0) {
                double dr = up.level_spm * up.area_m2_per_s - down.level_spm * down.area_m2_per_s;
                double dz = up.z_m - down.z_m, cosine = ray.level_spm * ray.speed_mps;
                double width = (dz * cosine - dr * ray.sine) / (2.0 * de);
                assert_close(ray.width_m, width, 1e-4 * fabs(width) + 1e-3);
                worst_width = fmax(worst_width, fabs(ray.width_m / width - 1.0));
            }
        }
    }
    print_message("places within %.2g m, widths within %.2g\n", worst_m, worst_width);
}

/* ---- What rays are laid out for ---- */

/* The plane that the end of the water of ENV at 12 m, or the surface, looks like from DEPTH_M. */
static asdic_bent_plane seen(const asdic_environment *env, double depth_m, bool below,
                             double reach_m) {
    const asdic_flat_scene flat = {
        .has_surface = true, .has_bottom = true, .depth_m = depth_m, .altitude_m = 12.0 - depth_m};
    asdic_layers layers;
    asdic_layers_between(env, &flat, &layers);
    return asdic_bent_plane_through(&layers, depth_m, below, reach_m);
}

/* Of one layer it is the plane itself. Through others it turns back what they do, and what comes to it at the end of its
 * reach comes to the end of the water there, as the integrator has it. */
static void layers_look_like_a_plane(void **state) {
    static const struct {
        double depth[4], speed[4], from_m, reach_m, fastest;
        bool below;
    } cases[] = {
        {{0, 11.3, 12, 13}, {1500, 1500, 1500.7, 1502}, 11.2, 75.0, 1500.7, true},
        {{0, 11.3, 12, 13}, {1500, 1500, 1500.7, 1502}, 11.2, 30.0, 1500.7, true},
        {{0, 9, 10, 12}, {1500, 1500, 1508, 1501}, 5.0, 100.0, 1508.0, true},
        {{0, 9, 10, 12}, {1500, 1500, 1490, 1489}, 5.0, 100.0, 1500.0, true},
        {{0, 2, 4, 12}, {1500, 1500, 1480, 1478}, 7.0, 60.0, 1500.0, false},
        {{0, 9, 10, 12}, {1500, 1500, 1490, 1489}, 0.6, 75.0, 1500.0, false},
    };
    (void)state;
    asdic_environment one = asdic_environment_default();
    one.sound_speed_mps = 1490.0;
    one.sound_speed_gradient_per_s = 0.5;
    asdic_bent_plane bottom = seen(&one, 7.0, true, 200.0);
    assert_close(bottom.height_m, 5.0, 1e-6);
    assert_close(bottom.bend_per_m, 0.5 / 1493.5, 1e-10);
    bottom = seen(&one, 7.0, true, 40.0);
    assert_close(bottom.height_m, 5.0, 1e-5);
    one.sound_speed_gradient_per_s = -0.5;
    bottom = seen(&one, 7.0, false, 250.0);
    assert_close(bottom.height_m, 7.0, 1e-6);
    assert_close(bottom.bend_per_m, 0.5 / 1486.5, 1e-10);
    assert_true(seen(&one, 7.0, true, 300.0).bend_per_m < 0.0);
    /* Speeds that rounding makes two are one. */
    const double down[] = {0.0, 9.0, 10.0, 12.0}, same[] = {1500.0, 1400.0, 1400.0, 1500.0};
    const double rounded[] = {1500.0, 1400.0, 1400.0, 1500.0 + 1e-12};
    asdic_environment alike = cast(4, down, same), nearly = cast(4, down, rounded);
    bottom = seen(&alike, 0.0, true, 20.0);
    asdic_bent_plane next = seen(&nearly, 0.0, true, 20.0);
    assert_close(next.height_m, bottom.height_m, 1e-6);
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        asdic_environment env = cast(4, cases[k].depth, cases[k].speed);
        asdic_bent_plane p = seen(&env, cases[k].from_m, cases[k].below, cases[k].reach_m);
        double speed = asdic_environment_sound_speed_mps(&env, cases[k].from_m);
        double turn = 1.0 + p.bend_per_m * p.height_m, side = cases[k].below ? 1.0 : -1.0;
        assert_close(turn * speed, cases[k].fastest, 1e-9);
        /* Of the steepest that turn, and as kernels/ray_bent.h has a ray that meets a plane at a range. */
        double graze = sqrt(1.0 - 1.0 / (turn * turn)), sine = graze + 1e-7, b = p.bend_per_m;
        double x = (sine - sqrt(sine * sine - graze * graze)) / (1.0 + 1.0 / turn);
        double end_m = b > 0.0 ? fmin(2.0 * atanh(x) / b, cases[k].reach_m) : cases[k].reach_m;
        sine = b > 0.0 ? (1.0 - 1.0 / turn) / sinh(b * end_m) + tanh(0.5 * b * end_m)
                       : p.height_m / end_m;
        traced at = trace(&env, cases[k].from_m, side * asin(sine), end_m / speed);
        print_message("case %zu: %.3f m away, %.3g 1/m; a ray is %.2g m off at %.1f m\n", k,
                      p.height_m, p.bend_per_m, fabs(at.z - (cases[k].below ? 12.0 : 0.0)), end_m);
        assert_close(at.z, cases[k].below ? 12.0 : 0.0, 1e-4);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(levels_go_over_into_those_of_straight_rays),
        cmocka_unit_test(one_speed_gives_the_same_bytes),
        cmocka_unit_test(rays_are_those_of_an_integrator),
        cmocka_unit_test(layers_look_like_a_plane),
    };
    return cmocka_run_group_tests(tests, context_begin, context_end);
}
