/*
 * The curve that live view shows as expected in water that bends rays: in one layer and through a cast, against a fan
 * of rays by Runge-Kutta steps, and where the sonar goes.
 */
#include "asserts.h"
#include "layer_steps.h"
#include "test_context.h"

#include "laws/scatterer.h"
#include "live/live_expected.h"
#include "sim/environment.h"

#include <asdic/asdic.h>

#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

#define PI 3.14159265358979323846
#define BOTTOM_M 12.0
#define FAN 20001

static asdic_mission *load(const char *water) {
    char path[] = "/tmp/asdic-live-XXXXXX";
    int file = mkstemp(path);
    assert_true(file >= 0);
    FILE *out = fdopen(file, "w");
    assert_non_null(out);
    fprintf(out,
            "version: 1\nenvironment: %s\nbottom: {depth_m: 12, type: sand}\nsonar:\n"
            "  frequency_khz: 100\n  bandwidth_khz: 10\n  ping_rate_hz: 10\n"
            "  source_level_db: 0\n  bin_length_m: 1\n  rear_floor_db: none\n"
            "  transmitter: {length_h_m: 0.0001, length_v_m: 0.0001}\n"
            "  receivers: [{name: all, length_h_m: 0.0001, length_v_m: 0.0001}]\n"
            "mission: {pose: {position_m: [0, 0, 7]}}\n",
            water);
    assert_int_equal(fclose(out), 0);
    asdic_mission *mission = NULL;
    assert_ok(ctx, asdic_mission_load(ctx, path, &mission));
    unlink(path);
    return mission;
}

/* Where a ray comes to the bottom; false: it does not, or to the surface first. */
static bool land(const asdic_environment *env, double depth, double e, traced *at, double *time_s) {
    *at = (traced){0.0, depth, e, 0.0};
    for (*time_s = 0.0; *time_s < 0.06 && at->z > 0.0;) {
        double h = 1e-4, least = 0.0;
        traced next = step(env, at, h);
        if (next.z > BOTTOM_M || crosses(env, at->z, next.z)) {
            for (int i = 0; i < 40; i++) {
                double middle = 0.5 * (least + h);
                next = step(env, at, middle);
                *(next.z > BOTTOM_M || crosses(env, at->z, next.z) ? &h : &least) = middle;
            }
            h += 1e-14;
            next = step(env, at, h);
        }
        *at = next;
        *time_s += h;
        if (at->z > BOTTOM_M) {
            return true;
        }
    }
    return false;
}

/* What the bottom sends back, by range, from rays even in elevation: a ring of half of all azimuths. */
static void refer(const asdic_mission *mission, const asdic_environment *steps, double depth,
                  double *level, size_t bins) {
    const asdic_environment *env = asdic_mission_environment(mission);
    const asdic_sonar *sonar = asdic_mission_sonar(mission);
    asdic_water_column water = asdic_water_column_at(env, sonar, depth);
    asdic_law_water in = asdic_water_column_laws(&water, env, sonar);
    asdic_flat_scene flat = asdic_mission_flat_scene(mission, 0);
    asdic_scatterer sand = asdic_scatterer_at(&flat.bottom, &in);
    double c0 = speed_of(steps, depth), q = speed_of(steps, BOTTOM_M) / c0, before = 0.0,
           t_before = 0.0;
    bool had = false;
    for (int i = 0; i < FAN; i++) {
        double de = (PI - 0.002) / FAN, e = -0.5 * PI + 0.001 + de * ((double)i + 0.5), time_s;
        traced at;
        bool there = land(steps, depth, e, &at, &time_s);
        if (there && had) {
            /* The ring between two rays, at its middle. */
            double r = 0.5 * (at.r + before), sine = fabs(sin(at.angle)), middle = e - 0.5 * de;
            double tube = r * fabs(at.r - before) / de * sine / cos(middle);
            double energy = PI * cos(middle) * de * asdic_scatterer_strength(&sand, sine) / sine *
                            q * q / tube *
                            exp(-2.0 * water.absorption_np_per_m * (at.length - 1.0));
            double a = c0 * fmin(time_s, t_before), b = c0 * fmax(time_s, t_before);
            for (size_t n = (size_t)a; n < bins && (double)n < b; n++) {
                level[n] += energy * (fmin(b, (double)n + 1.0) - fmax(a, (double)n)) / (b - a);
            }
        }
        had = there;
        before = at.r;
        t_before = time_s;
    }
}

static void curves_follow_bent_rays(void **state) {
    static const struct {
        const char *water;
        asdic_sound_profile cast;
    } cases[] = {{"{sound_speed_mps: 1490, sound_speed_gradient_per_s: -0.4}",
                  {2, {0.0, 100.0}, {1490.0, 1450.0}}},
                 {"{sound_speed_profile: [[0, 1482], [5, 1480], [9, 1471], [12, 1470]]}",
                  {4, {0.0, 5.0, 9.0, 12.0}, {1482.0, 1480.0, 1471.0, 1470.0}}}};
    static const double depth_m[] = {7.0, 8.5};
    (void)state;
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        asdic_mission *mission = load(cases[k].water);
        asdic_environment steps = *asdic_mission_environment(mission);
        steps.sound_speed_profile = cases[k].cast;
        size_t bins = asdic_sonar_bin_count(asdic_mission_sonar(mission), 1480.0);
        asdic_live_expected live;
        assert_ok(ctx, asdic_live_expected_init(ctx, bins, false, &live));
        for (int i = 0; i < 2; i++) {
            asdic_loop_ping ping = {.pose = {.position_m = {3.0, 1.0, depth_m[i]}},
                                    .altitude_m = BOTTOM_M - depth_m[i]};
            double *level = calloc(bins, sizeof *level), sum = 0.0, most = 0.0, count = 0.0;
            assert_non_null(level);
            assert_ok(ctx, asdic_live_expected_follow(&live, mission, &ping, 0));
            const float *shown = asdic_live_expected_db(&live, ASDIC_BOTTOM);
            assert_non_null(shown);
            refer(mission, &steps, depth_m[i], level, bins);
            for (size_t n = 7; n + 3 < bins; n++) {
                if (level[n] > 0.0) {
                    double off = fabs((double)shown[n] - asdic_level_db(level[n]));
                    sum += off * off;
                    most = fmax(most, off);
                    count += 1.0;
                }
            }
            print_message("%s at %.1f m: %.0f bins, r.m.s. %.4f dB, most %.3f\n", cases[k].water,
                          depth_m[i], count, sqrt(sum / count), most);
            assert_true(count > 30.0 && sqrt(sum / count) < 0.005);
            free(level);
        }
        asdic_live_expected_finish(&live);
        asdic_mission_destroy(&mission);
    }
}

/* In the background the same curve comes, a while later. */
static void curves_come_from_the_background(void **state) {
    (void)state;
    asdic_mission *mission = load("{sound_speed_mps: 1490}");
    size_t bins = asdic_sonar_bin_count(asdic_mission_sonar(mission), 1490.0);
    const asdic_loop_ping ping = {.pose = {.position_m = {0.0, 0.0, 7.0}}, .altitude_m = 5.0};
    const float *shown[2] = {NULL};
    asdic_live_expected live[2];
    for (int k = 0; k < 2; k++) {
        assert_ok(ctx, asdic_live_expected_init(ctx, bins, k == 1, &live[k]));
        assert_null(asdic_live_expected_db(&live[k], ASDIC_BOTTOM));
        for (int wait = 0; !shown[k] && wait < 4000; wait++) {
            assert_ok(ctx, asdic_live_expected_follow(&live[k], mission, &ping, 0));
            shown[k] = asdic_live_expected_db(&live[k], ASDIC_BOTTOM);
            assert_true(shown[k] || k == 1);
            usleep(shown[k] ? 0 : 5000);
        }
        assert_non_null(shown[k]);
    }
    assert_memory_equal(shown[0], shown[1], bins * sizeof *shown[0]);
    asdic_live_expected_finish(&live[0]);
    asdic_live_expected_finish(&live[1]);
    asdic_mission_destroy(&mission);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(curves_follow_bent_rays),
                                       cmocka_unit_test(curves_come_from_the_background)};
    return cmocka_run_group_tests(tests, context_begin, context_end);
}
