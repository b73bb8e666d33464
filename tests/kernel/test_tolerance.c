/*
 * Rays for a tolerance: enough of them, the same every time, and honest about what is out of reach.
 */
#include "asserts.h"
#include "test_device.h"

#include "base/clock.h"

#include <asdic/asdic.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>

static test_device t;

static asdic_mission *load(const char *scene, uint32_t rays) {
    asdic_mission *mission = NULL;
    char path[1024];
    snprintf(path, sizeof path, "%s/scenes/%s", DATA_DIR, scene);
    assert_ok(t.ctx, asdic_mission_load(t.ctx, path, &mission));
    asdic_mission_sampling(mission)->rays = rays;
    return mission;
}

static asdic_status find_rays(asdic_mission *mission, double share, double tolerance_db,
                              uint32_t most_rays, asdic_ray_budget *out) {
    const asdic_tolerance tolerance = {tolerance_db, share, most_rays};
    return asdic_mission_find_rays(t.ctx, mission, t.device, &tolerance, out);
}

/* The rays found keep the tolerance in truth, too; half of them do not by their own account. */
static void found_rays_keep_the_tolerance(void **state) {
    (void)state;
    const double tolerance_db = 0.1;
    asdic_mission *mission = load("bench_flat.yaml", 512);
    asdic_ray_budget found, again, half;
    double began_s = asdic_clock_s();
    assert_ok(t.ctx, find_rays(mission, 1.0, tolerance_db, 1u << 18, &found));
    assert_true(found.ping_s > 0.0 && found.learn_s > 0.0);
    assert_true(found.ping_s + found.learn_s < asdic_clock_s() - began_s);
    print_message("%g dB: %u rays, worst bin %.3f dB\n", tolerance_db, found.rays, found.worst_db);
    assert_int_equal(found.rough_count, 0);
    assert_true(found.worst_db <= tolerance_db && found.rays > 512);
    assert_int_equal(asdic_mission_sampling(mission)->rays, found.rays);

    asdic_mission_sampling(mission)->rays = 512;
    assert_ok(t.ctx, find_rays(mission, 1.0, tolerance_db, 1u << 18, &again));
    assert_int_equal(again.rays, found.rays);
    assert_true(again.worst_db == found.worst_db);

    asdic_mission_sampling(mission)->rays = found.rays / 2;
    assert_ok(t.ctx, find_rays(mission, 1.0, tolerance_db, found.rays / 2, &half));
    assert_true(half.rough_count > 0 && half.worst_db > tolerance_db);

    asdic_mission_sampling(mission)->rays = found.rays;
    asdic_pose pose = asdic_mission_pose(mission, 0, NULL);
    asdic_flat_scene flat = asdic_mission_flat_scene(mission, 0);
    asdic_simulator *sim = NULL;
    asdic_ping *ping = NULL, *truth = NULL;
    assert_ok(t.ctx, asdic_simulator_create(
                         t.ctx, t.device, asdic_mission_scene(mission),
                         asdic_mission_environment(mission), asdic_mission_sonar(mission),
                         asdic_mission_sampling(mission), pose.position_m.z, &sim));
    size_t bins = asdic_simulator_bin_count(sim);
    assert_ok(t.ctx, asdic_ping_create(t.ctx, 1, bins, &ping));
    assert_ok(t.ctx, asdic_ping_create(t.ctx, 1, bins, &truth));
    assert_ok(t.ctx, asdic_expected_compute(t.ctx, &flat, asdic_mission_environment(mission),
                                            asdic_mission_sonar(mission), &pose, truth));
    assert_ok(t.ctx, asdic_simulator_learn(sim, &pose, 0));
    for (uint64_t k = 0; k < 8; k++) {
        assert_ok(t.ctx, asdic_simulator_ping(sim, &pose, k, ping));
        for (size_t n = 4; n < bins; n++) {
            double off = asdic_level_db(ping->intensity_lin[ASDIC_TOTAL][n]) -
                         asdic_level_db(truth->intensity_lin[ASDIC_TOTAL][n]);
            assert_true(fabs(off) < 4.0 * tolerance_db);
        }
    }
    asdic_ping_destroy(&truth);
    asdic_ping_destroy(&ping);
    asdic_simulator_destroy(&sim);
    asdic_mission_destroy(&mission);
}

/* Adds PINGS pings of RAYS rays from number FIRST on to SUM, or, when TRUTH is given, their squared errors
 * in dB re that; returns how many there are. */
static size_t add_pings(const asdic_mission *mission, uint32_t rays, uint64_t first, int pings,
                        const double *truth, double *sum) {
    asdic_sampling sampling = *asdic_mission_sampling((asdic_mission *)mission);
    sampling.rays = rays;
    asdic_pose pose = asdic_mission_pose(mission, 0, NULL);
    asdic_simulator *sim = NULL;
    asdic_ping *ping = NULL;
    assert_ok(t.ctx, asdic_simulator_create(t.ctx, t.device, asdic_mission_scene(mission),
                                            asdic_mission_environment(mission),
                                            asdic_mission_sonar(mission), &sampling,
                                            pose.position_m.z, &sim));
    size_t beams = asdic_mission_sonar(mission)->receiver_count;
    assert_ok(t.ctx, asdic_ping_create(t.ctx, beams, asdic_simulator_bin_count(sim), &ping));
    size_t cells = ping->beams * ping->bins;
    assert_ok(t.ctx, asdic_simulator_learn(sim, &pose, first));
    for (uint64_t k = 0; k < (uint64_t)pings; k++) {
        assert_ok(t.ctx, asdic_simulator_ping(sim, &pose, first + k, ping));
        for (size_t i = 0; i < cells; i++) {
            double energy = ping->intensity_lin[ASDIC_TOTAL][i];
            double off = truth ? asdic_level_db(energy) - asdic_level_db(truth[i]) : 0.0;
            sum[i] += truth ? off * off : energy / pings;
        }
    }
    asdic_ping_destroy(&ping);
    asdic_simulator_destroy(&sim);
    return cells;
}

/* On a rough mesh and for a fan of 512 beams: with the rays found no bin errs by more than the
 * tolerance in truth (r.m.s. over pings, whose own spread over eight is allowed for), with the rays that
 * the search began with a good many do. */
static void rough_bottoms_and_fans_keep_it(void **state) {
    (void)state;
    enum { MOST_CELLS = 512 * 149, PINGS = 8 };
    static const char *const scenes[] = {"bench_terrain.yaml", "bench_fan.yaml"};
    const double tolerance_db = 1.0;
    double *truth = calloc(MOST_CELLS, sizeof *truth),
           *squares = calloc(MOST_CELLS, sizeof *squares);
    for (size_t s = 0; s < 2; s++) {
        asdic_mission *mission = load(scenes[s], 2000);
        asdic_ray_budget found;
        assert_ok(t.ctx, find_rays(mission, 1.0, tolerance_db, 1u << 18, &found));
        assert_int_equal(found.rough_count, 0);
        memset(truth, 0, MOST_CELLS * sizeof *truth);
        size_t cells = add_pings(mission, 1u << 18, 1000000, 12, NULL, truth);
        size_t over[2] = {0, 0};
        for (int k = 0; k < 2; k++) {
            memset(squares, 0, MOST_CELLS * sizeof *squares);
            add_pings(mission, k ? 2000 : found.rays, 0, PINGS, truth, squares);
            for (size_t i = 0; i < cells; i++) {
                over[k] += i % 149 >= 4 && sqrt(squares[i] / PINGS) > 1.5 * tolerance_db;
            }
        }
        print_message(
            "%s, %g dB: %u rays, stated worst %.2f dB; bins above in truth: %zu, with 2000 "
            "rays %zu of %zu\n",
            scenes[s], tolerance_db, found.rays, found.worst_db, over[0], over[1], cells);
        assert_true(over[0] * 200 < cells && over[1] * 10 > cells);
        asdic_mission_destroy(&mission);
    }
    free(truth);
    free(squares);
}

static void what_is_out_of_reach_is_named(void **state) {
    (void)state;
    asdic_mission *mission = load("bench_step.yaml", 1000);
    asdic_ray_budget found;
    assert_ok(t.ctx, find_rays(mission, 1.0, 1e-4, 3000, &found));
    assert_int_equal(found.rays, 3000);
    assert_false(found.is_kept);
    assert_true(found.rough_count > ASDIC_ROUGH_BINS);
    assert_true(found.rough[0].stderr_db == found.worst_db);
    for (size_t i = 0; i < ASDIC_ROUGH_BINS; i++) {
        assert_true(found.rough[i].beam < 3 && found.rough[i].bin < 149);
        assert_true(i == 0 || found.rough[i].stderr_db <= found.rough[i - 1].stderr_db);
    }
    assert_status(t.ctx, find_rays(mission, 1.0, 0.0, 3000, &found), ASDIC_ERROR_ARGUMENT);
    assert_status(t.ctx, find_rays(NULL, 1.0, 1.0, 3000, &found), ASDIC_ERROR_ARGUMENT);
    asdic_mission_destroy(&mission);
}

/* What a few bins want, all the others would have to pay for. */
static void a_share_is_found_with_fewer_rays(void **state) {
    (void)state;
    const double tolerance_db = 0.5;
    asdic_mission *mission = load("bench_terrain.yaml", 1024);
    asdic_ray_budget most, all;
    assert_ok(t.ctx, find_rays(mission, 0.9, tolerance_db, 1u << 18, &most));
    print_message("%u rays: %zu of %zu bins rough, worst %.2f dB\n", most.rays, most.rough_count,
                  most.judged, most.worst_db);
    assert_true(most.is_kept && most.rough_count > 0 && most.worst_db > tolerance_db);
    assert_true((double)most.rough_count <= 0.1 * (double)most.judged);
    assert_true(most.rough[0].stderr_db == most.worst_db);

    asdic_mission_sampling(mission)->rays = most.rays / 2; /* half of them would not do */
    assert_ok(t.ctx, find_rays(mission, 0.9, tolerance_db, most.rays / 2, &all));
    assert_true(!all.is_kept && (double)all.rough_count > 0.1 * (double)all.judged);

    asdic_mission_sampling(mission)->rays = 1024;
    assert_ok(t.ctx, find_rays(mission, 1.0, tolerance_db, 1u << 18, &all));
    assert_true(all.rays > most.rays && all.judged > 0);
    assert_status(t.ctx, find_rays(mission, 0.0, tolerance_db, 4096, &all), ASDIC_ERROR_ARGUMENT);
    assert_status(t.ctx, find_rays(mission, 1.1, tolerance_db, 4096, &all), ASDIC_ERROR_ARGUMENT);
    asdic_mission_destroy(&mission);
}

/* Bins whose echo is below the noise do not count, however rough. */
static void noise_forgives(void **state) {
    (void)state;
    asdic_mission *mission = load("bench_step.yaml", 4096);
    asdic_ray_budget silent, noisy;
    assert_ok(t.ctx, find_rays(mission, 1.0, 0.05, 4096, &silent));
    ((asdic_sonar *)asdic_mission_sonar(mission))->noise_enabled = true;
    ((asdic_sonar *)asdic_mission_sonar(mission))->source_level_db = 160.0;
    assert_ok(t.ctx, find_rays(mission, 1.0, 0.05, 4096, &noisy));
    print_message("rough bins: %zu without noise, %zu with\n", silent.rough_count,
                  noisy.rough_count);
    assert_true(noisy.rough_count < silent.rough_count && noisy.worst_db < silent.worst_db);
    asdic_mission_destroy(&mission);
}

int main(void) {
    t = test_device_open_or_skip();
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(found_rays_keep_the_tolerance),
        cmocka_unit_test(rough_bottoms_and_fans_keep_it),
        cmocka_unit_test(what_is_out_of_reach_is_named),
        cmocka_unit_test(a_share_is_found_with_fewer_rays),
        cmocka_unit_test(noise_forgives),
    };
    return test_device_end(&t, cmocka_run_group_tests(tests, NULL, NULL));
}
