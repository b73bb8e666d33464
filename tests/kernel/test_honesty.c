/*
 * Stated against true errors, over many lattice shifts and calibrations: the r.m.s. of one over the other
 * lies within 0.8 and 1.3 over all bins from 2 m on and over the far third of them.
 */
#include "asserts.h"
#include "test_device.h"

#include <asdic/asdic.h>

#include <math.h>
#include <stdlib.h>

#define DEGREE (3.14159265358979323846 / 180.0)
/* Pings of references have numbers far apart, hence other lattice shifts. */
#define REFERENCE_INDEX 1000000u

static test_device t;

typedef struct honesty_case {
    const char *scene;
    uint32_t rays;
    double pitch_deg, bin_m; /* bin_m 0: the scene's */
    size_t beams;            /* of its sector; 0: as they are */
    double ahead_m;          /* of where the block was learnt, as later pings are */
    int blocks;
    double most;
} honesty_case;

/* A scene's simulator with a case's sonar and so many rays. */
typedef struct honesty_rig {
    asdic_mission *mission;
    asdic_sonar sonar;
    asdic_beam *beams;
    asdic_pose learnt_at, pose;
    size_t bins;
} honesty_rig;

static honesty_rig rig_open(const honesty_case *c) {
    honesty_rig r = {0};
    char path[1024];
    snprintf(path, sizeof path, "%s/scenes/%s.yaml", DATA_DIR, c->scene);
    assert_ok(t.ctx, asdic_mission_load(t.ctx, path, &r.mission));
    r.sonar = *asdic_mission_sonar(r.mission);
    r.sonar.noise_enabled = false;
    r.sonar.bin_length_m = c->bin_m > 0.0 ? c->bin_m : r.sonar.bin_length_m;
    if (c->beams) {
        double span = r.sonar.receivers[r.sonar.receiver_count - 1].yaw_rad;
        r.beams = calloc(c->beams, sizeof *r.beams);
        for (size_t b = 0; b < c->beams; b++) {
            r.beams[b] = r.sonar.receivers[0];
            r.beams[b].yaw_rad = span * (2.0 * (double)b / (double)(c->beams - 1) - 1.0);
        }
        r.sonar.receivers = r.beams;
        r.sonar.receiver_count = c->beams;
    }
    r.learnt_at = asdic_mission_pose(r.mission, 0, NULL);
    r.learnt_at.pitch_rad += c->pitch_deg * DEGREE;
    r.pose = r.learnt_at;
    r.pose.position_m.x += c->ahead_m;
    return r;
}

static asdic_simulator *rig_simulator(honesty_rig *r, uint32_t rays) {
    asdic_sampling sampling = *asdic_mission_sampling(r->mission);
    asdic_simulator *sim = NULL;
    sampling.rays = rays;
    assert_ok(t.ctx, asdic_simulator_create(t.ctx, t.device, asdic_mission_scene(r->mission),
                                            asdic_mission_environment(r->mission), &r->sonar,
                                            &sampling, r->pose.position_m.z, &sim));
    r->bins = asdic_simulator_bin_count(sim);
    return sim;
}

static asdic_ping *new_ping(const honesty_rig *r) {
    asdic_ping *ping = NULL;
    assert_ok(t.ctx, asdic_ping_create(t.ctx, r->sonar.receiver_count, r->bins, &ping));
    return ping;
}

/* The truth by quadrature of a flat scene; else the mean of pings that err some twenty times less. */
static asdic_ping *truth_of(honesty_rig *r) {
    enum { PINGS = 12, RAYS = 1 << 18 };
    asdic_simulator *sim = rig_simulator(r, RAYS);
    asdic_ping *truth = new_ping(r), *ping = new_ping(r);
    size_t cells = truth->beams * truth->bins;
    if (asdic_scene_get_info(asdic_mission_scene(r->mission)).triangles == 0) {
        asdic_flat_scene flat = asdic_mission_flat_scene(r->mission, 0);
        assert_ok(t.ctx, asdic_expected_compute(t.ctx, &flat, asdic_mission_environment(r->mission),
                                                &r->sonar, &r->pose, truth));
    } else {
        assert_ok(t.ctx, asdic_simulator_learn(sim, &r->pose, REFERENCE_INDEX));
        for (uint64_t k = 0; k < PINGS; k++) {
            assert_ok(t.ctx, asdic_simulator_ping(sim, &r->pose, REFERENCE_INDEX + k, ping));
            for (size_t i = 0; i < cells; i++) {
                truth->intensity_lin[ASDIC_TOTAL][i] +=
                    ping->intensity_lin[ASDIC_TOTAL][i] / (double)PINGS;
            }
        }
    }
    asdic_ping_destroy(&ping);
    asdic_simulator_destroy(&sim);
    return truth;
}

static void stated_errors_are_honest(const honesty_case *c) {
    enum { PINGS = 4 };
    honesty_rig r = rig_open(c);
    asdic_ping *truth = truth_of(&r);
    asdic_simulator *sim = rig_simulator(&r, c->rays);
    asdic_ping *ping = new_ping(&r);
    double sum[2] = {0.0, 0.0}, count[2] = {0.0, 0.0}; /* all, far */
    size_t first = (size_t)ceil(2.0 / r.sonar.bin_length_m), far = r.bins - (r.bins - first) / 3;
    for (int block = 0; block < c->blocks; block++) {
        uint64_t index = (uint64_t)block * ASDIC_LEARN_BLOCK;
        assert_ok(t.ctx, asdic_simulator_learn(sim, &r.learnt_at, index));
        for (uint64_t k = 0; k < PINGS; k++) {
            assert_ok(t.ctx, asdic_simulator_ping(sim, &r.pose, index + k, ping));
            for (size_t i = 0; i < ping->beams * ping->bins; i++) {
                if (i % ping->bins < first || !(ping->stderr_db[i] > 0.0f)) {
                    continue;
                }
                double off = asdic_level_db(ping->intensity_lin[ASDIC_TOTAL][i]) -
                             asdic_level_db(truth->intensity_lin[ASDIC_TOTAL][i]);
                double ratio = off / ping->stderr_db[i];
                for (int part = 0; part < 1 + (i % ping->bins >= far); part++) {
                    sum[part] += ratio * ratio;
                    count[part] += 1.0;
                }
            }
        }
    }
    double all = sqrt(sum[0] / count[0]), last = sqrt(sum[1] / count[1]);
    print_message("%-13s %6u rays, pitch %3g, bins of %3g m, %2.1f m on: true over stated %.2f, "
                  "far %.2f\n",
                  c->scene, c->rays, c->pitch_deg, r.sonar.bin_length_m, c->ahead_m, all, last);
    assert_true(all > 0.8 && all < c->most && last > 0.8 && last < c->most);
    asdic_ping_destroy(&ping);
    asdic_ping_destroy(&truth);
    asdic_simulator_destroy(&sim);
    asdic_mission_destroy(&r.mission);
    free(r.beams);
}

static void flat_bottoms(void **state) {
    (void)state;
    static const honesty_case cases[] = {
        {"bench_flat", 4096, 0.0, 0.0, 0, 0.0, 16, 1.3},
        {"bench_flat", 65536, 0.0, 0.0, 0, 0.0, 8, 1.3},
        {"bench_flat", 65536, 20.0, 0.0, 0, 0.0, 12, 1.3}, /* far bins in deep nulls */
        {"bench_flat", 4096, -20.0, 0.0, 0, 0.0, 16, 1.3},
    };
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        stated_errors_are_honest(&cases[k]);
    }
}

/* The pulse is 75 mm long: two bins, one and a half, less than one. */
static void short_bins(void **state) {
    (void)state;
    static const double bins_m[] = {0.0364, 0.05, 0.1, 0.2};
    for (size_t k = 0; k < sizeof bins_m / sizeof *bins_m; k++) {
        honesty_case c = {"bench_flat", 4096, 0.0, bins_m[k], 0, 0.0, 8, 1.3};
        stated_errors_are_honest(&c);
    }
}

static void rough_bottoms(void **state) {
    (void)state;
    static const honesty_case cases[] = {
        {"bench_terrain", 4096, 0.0, 0.0, 0, 0.0, 24, 1.3},
        {"bench_terrain", 20000, 0.0, 0.0, 0, 0.0, 12, 1.3},
        {"bench_terrain", 4096, 0.0, 0.0, 0, 1.5, 24, 1.5}, /* other bins hold the spikes by then */
    };
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        stated_errors_are_honest(&cases[k]);
    }
}

static void several_beams(void **state) {
    (void)state;
    static const honesty_case cases[] = {
        {"bench_step", 4096, 0.0, 0.0, 0, 0.0, 12, 1.3},
        {"bench_fan", 20000, 0.0, 0.0, 64, 0.0, 4, 1.3},
        {"bench_fan", 65536, -10.0, 0.0, 64, 0.0, 4, 1.3},
    };
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        stated_errors_are_honest(&cases[k]);
    }
}

int main(void) {
    t = test_device_open_or_skip();
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(flat_bottoms),
        cmocka_unit_test(short_bins),
        cmocka_unit_test(rough_bottoms),
        cmocka_unit_test(several_beams),
    };
    int failed = cmocka_run_group_tests(tests, NULL, NULL);
    test_device_close(&t);
    return failed;
}
