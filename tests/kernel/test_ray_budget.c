/* The rays that a tolerance takes: which pings are looked at, which bins count, which are the roughest, and where the
 * search ends, against the same pings simulated and judged here. */
#include "asserts.h"
#include "test_device.h"

#include "lib/mission/mission.h"

#include <asdic/asdic.h>

#include <stdlib.h>

#define SCENE                                                                                      \
    "version: 1\n"                                                                                 \
    "bottom: {depth_m: 12, type: sand}\n"                                                          \
    "sonar:\n"                                                                                     \
    "  {frequency_khz: 100, ping_rate_hz: 20, source_level_db: %g, noise: {enabled: %s}, "         \
    "receivers: "                                                                                  \
    "[{name: a}, {name: b, pitch_deg: 20}]}\n"                                                     \
    "mission: {waypoints: {points_m: [[0, 0, 5], [%g, 0, 9]], speed_mps: 1}}\n"                    \
    "sampling: {rays: 400, sampler: beam}\n"

static test_device t;

static asdic_mission *load(double source_level_db, const char *noise, double length_m) {
    char text[1024];
    asdic_mission *m = NULL;
    int length = snprintf(text, sizeof text, SCENE, source_level_db, noise, length_m);
    asdic_scene_text scene = {.text = text, .length = (size_t)length, .name = "scene.yaml"};
    assert_ok(t.ctx, asdic_mission_load_text(t.ctx, &scene, &m));
    return m;
}

static int rougher_first(const void *a, const void *b) {
    const asdic_rough_bin *x = a, *y = b;
    return (x->stderr_db < y->stderr_db) - (x->stderr_db > y->stderr_db);
}

enum { MOST_BINS = 16384 };
static asdic_rough_bin all[MOST_BINS];

/* The bins of pings NUMBERS that count with RAYS, each learnt where the mission learns, the roughest first; their
 * number. */
static size_t judge(const asdic_mission *m, uint32_t rays, const size_t *numbers, size_t pings) {
    asdic_sampling sampling = *asdic_mission_sampling((asdic_mission *)(uintptr_t)m);
    asdic_simulator *sim = NULL;
    asdic_ping *ping = NULL;
    size_t count = 0;
    sampling.rays = rays;
    assert_ok(t.ctx,
              asdic_simulator_create(t.ctx, t.device, asdic_mission_scene(m),
                                     asdic_mission_environment(m), asdic_mission_sonar(m),
                                     &sampling, asdic_mission_pose(m, 0, NULL).position_m.z, &sim));
    assert_ok(t.ctx, asdic_ping_create(t.ctx, 2, asdic_simulator_bin_count(sim), &ping));
    for (size_t k = 0; k < pings; k++) {
        size_t together, lesson = asdic_mission_lesson(m, numbers[k], 1, &together);
        asdic_pose pose = asdic_mission_pose(m, lesson, NULL);
        assert_ok(t.ctx, asdic_simulator_learn(sim, &pose, lesson));
        pose = asdic_mission_pose(m, numbers[k], NULL);
        assert_ok(t.ctx, asdic_simulator_ping(sim, &pose, numbers[k], ping));
        for (size_t i = 0; i < 2 * ping->bins; i++) {
            double noise = ping->intensity_lin[ASDIC_NOISE][i];
            double echo = ping->intensity_lin[ASDIC_TOTAL][i] - noise;
            if (echo > 1e-9 * noise && echo >= noise) {
                assert_true(count < MOST_BINS);
                all[count++] = (asdic_rough_bin){numbers[k], i / ping->bins, i % ping->bins,
                                                 ping->stderr_db[i]};
            }
        }
    }
    asdic_ping_destroy(&ping);
    asdic_simulator_destroy(&sim);
    qsort(all, count, sizeof *all, rougher_first);
    return count;
}

static void assert_budget(const asdic_ray_budget *b, double tolerance_db, size_t count) {
    size_t rough = 0;
    while (rough < count && all[rough].stderr_db > tolerance_db) {
        rough++;
    }
    print_message("%u rays: %zu pings, %zu of %zu bins above %g dB, worst %g\n", b->rays, b->pings,
                  rough, count, tolerance_db, all[0].stderr_db);
    assert_int_equal(b->judged, count);
    assert_int_equal(b->rough_count, rough);
    assert_true(b->worst_db == all[0].stderr_db);
    assert_true(b->ping_s > 0.0 && b->ping_s < 60.0 && b->learn_s > 0.0 && b->learn_s < 60.0);
    for (size_t i = 0; i < rough && i < ASDIC_ROUGH_BINS; i++) {
        const asdic_rough_bin *bin = &b->rough[i];
        assert_true(bin->stderr_db == all[i].stderr_db);
        size_t k = 0;
        while (k < count &&
               (all[k].ping != bin->ping || all[k].beam != bin->beam || all[k].bin != bin->bin)) {
            k++;
        }
        assert_true(k < count && all[k].stderr_db == bin->stderr_db);
        for (size_t n = 0; n < i; n++) {
            assert_true(b->rough[n].ping != bin->ping || b->rough[n].beam != bin->beam ||
                        b->rough[n].bin != bin->bin);
        }
    }
}

/* Of a mission of LENGTH_M m, 20 pings a metre. */
static void assert_looks_at(double length_m, size_t all_pings, const size_t *numbers,
                            size_t pings) {
    asdic_mission *m = load(0.0, "false", length_m);
    assert_int_equal(asdic_mission_ping_count(m), all_pings);
    asdic_ray_budget budget;
    asdic_tolerance tolerance = {.stderr_db = 3.0, .share = 1.0, .most_rays = 400};
    assert_ok(t.ctx, asdic_mission_find_rays(t.ctx, m, t.device, &tolerance, &budget));
    assert_int_equal(budget.pings, pings);
    assert_int_equal(budget.rays, 400);
    assert_budget(&budget, 3.0, judge(m, 400, numbers, pings));
    assert_true(budget.rough_count > ASDIC_ROUGH_BINS);
    assert_false(budget.is_kept);
    asdic_mission_destroy(&m);
}

/* Of 22 pings. */
static const size_t looked_at[16] = {0, 1, 2, 4, 5, 6, 8, 9, 11, 12, 13, 15, 16, 17, 19, 21};

/* One in each sixteenth of the mission, at any place in a block of 32; the first and the last. */
static void pings_are_spread_over_the_mission(void **state) {
    (void)state;
    assert_looks_at(0.2, 6, (const size_t[]){0, 1, 2, 3, 4, 5}, 6);
    assert_looks_at(1.0, 22, looked_at, 16);
    assert_looks_at(
        1.5, 32, (const size_t[]){0, 3, 4, 7, 8, 10, 13, 14, 17, 19, 20, 23, 24, 26, 29, 31}, 16);
    assert_looks_at(
        10.0, 210,
        (const size_t[]){0, 21, 29, 50, 58, 66, 87, 95, 117, 125, 133, 154, 162, 170, 191, 209},
        16);
}

/* Doubled until a share of the bins is exact enough; the last step ends at the most that may be. */
static void rays_double_until_they_suffice(void **state) {
    (void)state;
    asdic_mission *m = load(0.0, "false", 1.0);
    asdic_ray_budget budget;
    size_t count = judge(m, 1600, looked_at, 16), rough = 0;
    double tolerance_db = all[count / 4].stderr_db; /* a quarter of the bins is rougher */
    while (all[rough].stderr_db > tolerance_db) {
        rough++;
    }
    double share = 1.0 - ((double)rough + 0.5) / (double)count;
    judge(m, 800, looked_at, 16);
    assert_true(all[rough].stderr_db > tolerance_db); /* half as many do not suffice */
    asdic_tolerance tolerance = {tolerance_db, share, 100000};
    assert_ok(t.ctx, asdic_mission_find_rays(t.ctx, m, t.device, &tolerance, &budget));
    assert_int_equal(budget.rays, 1600);
    assert_true(budget.is_kept);
    assert_int_equal(asdic_mission_sampling(m)->rays, 1600);
    assert_budget(&budget, tolerance_db, judge(m, 1600, looked_at, 16));

    asdic_mission_sampling(m)->rays = 400;
    tolerance.share = share + 1.0 / (double)count; /* one bin more */
    tolerance.most_rays = 1600;
    assert_ok(t.ctx, asdic_mission_find_rays(t.ctx, m, t.device, &tolerance, &budget));
    assert_int_equal(budget.rays, 1600);
    assert_false(budget.is_kept);
    asdic_mission_sampling(m)->rays = 400;
    tolerance.most_rays = 1500;
    tolerance.stderr_db = 1e-3;
    assert_ok(t.ctx, asdic_mission_find_rays(t.ctx, m, t.device, &tolerance, &budget));
    assert_int_equal(budget.rays, 1500);
    asdic_mission_destroy(&m);
}

/* Bins whose echo is below the noise do not count. */
static void the_noise_hides_bins(void **state) {
    (void)state;
    asdic_mission *m = load(160.0, "true", 1.0);
    asdic_ray_budget budget;
    asdic_tolerance tolerance = {.stderr_db = 3.0, .share = 1.0, .most_rays = 400};
    size_t count = judge(m, 400, looked_at, 16);
    print_message("%zu bins count\n", count);
    assert_true(count > 16 * 20 && count < 16 * 130);
    assert_ok(t.ctx, asdic_mission_find_rays(t.ctx, m, t.device, &tolerance, &budget));
    assert_budget(&budget, 3.0, count);
    asdic_mission_destroy(&m);
}

/* Where no bin is above the noise the search ends at once, and claims nothing. */
static void in_silence_nothing_is_kept(void **state) {
    (void)state;
    asdic_mission *m = load(20.0, "true", 1.0);
    asdic_ray_budget budget;
    asdic_tolerance tolerance = {.stderr_db = 3.0, .share = 0.5, .most_rays = 1600};
    assert_ok(t.ctx, asdic_mission_find_rays(t.ctx, m, t.device, &tolerance, &budget));
    assert_int_equal(budget.judged, 0);
    assert_int_equal(budget.rays, 400);
    assert_false(budget.is_kept);
    asdic_mission_destroy(&m);
}

static void wrong_tolerances_are_refused(void **state) {
    (void)state;
    static const asdic_tolerance bad[] = {
        {0.0, 1.0, 500}, {0.1, 0.0, 500}, {0.1, 1.01, 500}, {(double)NAN, 1.0, 500}};
    asdic_mission *m = load(0.0, "false", 1.0);
    asdic_ray_budget budget;
    for (size_t i = 0; i < 4; i++) {
        assert_status(t.ctx, asdic_mission_find_rays(t.ctx, m, t.device, &bad[i], &budget),
                      ASDIC_ERROR_ARGUMENT);
    }
    asdic_tolerance good = {0.1, 1.0, 500};
    assert_status(t.ctx, asdic_mission_find_rays(t.ctx, m, t.device, &good, NULL),
                  ASDIC_ERROR_ARGUMENT);
    assert_status(t.ctx, asdic_mission_find_rays(t.ctx, m, NULL, &good, &budget),
                  ASDIC_ERROR_ARGUMENT);
    asdic_mission_sampling(m)->coherent = true; /* whose pings state no error */
    assert_status(t.ctx, asdic_mission_find_rays(t.ctx, m, t.device, &good, &budget),
                  ASDIC_ERROR_ARGUMENT);
    asdic_mission_destroy(&m);
}

int main(void) {
    t = test_device_open_or_skip();
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(pings_are_spread_over_the_mission),
        cmocka_unit_test(rays_double_until_they_suffice),
        cmocka_unit_test(the_noise_hides_bins),
        cmocka_unit_test(in_silence_nothing_is_kept),
        cmocka_unit_test(wrong_tolerances_are_refused),
    };
    return test_device_end(&t, cmocka_run_group_tests(tests, NULL, NULL));
}
