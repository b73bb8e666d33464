/*
 * Stated against true errors, over many lattice shifts and calibrations.
 */
#ifndef ASDIC_TESTS_HONESTY_RIG_H
#define ASDIC_TESTS_HONESTY_RIG_H

#include "asserts.h"
#include "test_device.h"

#include <asdic/asdic.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>

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
    const char *mover; /* NULL: nothing moves */
    asdic_pose mover_learnt_at, mover_at;
    size_t bins;
} honesty_rig;

static inline honesty_rig rig_of(asdic_mission *mission) {
    honesty_rig r = {.mission = mission, .sonar = *asdic_mission_sonar(mission)};
    r.sonar.noise_enabled = false;
    r.sonar.speckle = ASDIC_SPECKLE_NONE;
    r.learnt_at = r.pose = asdic_mission_pose(mission, 0, NULL);
    return r;
}

static inline honesty_rig rig_open(const honesty_case *c) {
    asdic_mission *mission = NULL;
    char path[1024];
    snprintf(path, sizeof path, "%s/scenes/%s.yaml", DATA_DIR, c->scene);
    assert_ok(t.ctx, asdic_mission_load(t.ctx, path, &mission));
    honesty_rig r = rig_of(mission);
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
    r.learnt_at.pitch_rad += c->pitch_deg * DEGREE;
    r.pose = r.learnt_at;
    r.pose.position_m.x += c->ahead_m;
    return r;
}

static inline honesty_rig rig_of_text(const char *text) {
    asdic_scene_text scene = {.text = text, .length = strlen(text), .name = "scene.yaml"};
    asdic_mission *mission = NULL;
    assert_ok(t.ctx, asdic_mission_load_text(t.ctx, &scene, &mission));
    return rig_of(mission);
}

static inline void rig_close(honesty_rig *r) {
    asdic_mission_destroy(&r->mission);
    free(r->beams);
}

static inline asdic_simulator *rig_simulator(honesty_rig *r, uint32_t rays) {
    asdic_sampling sampling = *asdic_mission_sampling(r->mission);
    asdic_simulator *sim = NULL;
    sampling.rays = rays;
    assert_ok(t.ctx, asdic_simulator_create(t.ctx, t.device, asdic_mission_scene(r->mission),
                                            asdic_mission_environment(r->mission), &r->sonar,
                                            &sampling, r->pose.position_m.z, &sim));
    r->bins = asdic_simulator_bin_count(sim);
    return sim;
}

static inline void move(const honesty_rig *r, asdic_simulator *sim, const asdic_pose *to) {
    if (r->mover) {
        assert_ok(t.ctx, asdic_simulator_move(sim, r->mover, to));
    }
}

static inline asdic_ping *new_ping(const honesty_rig *r) {
    asdic_ping *ping = NULL;
    assert_ok(t.ctx, asdic_ping_create(t.ctx, r->sonar.receiver_count, r->bins, &ping));
    return ping;
}

/* The truth of pings of so many RAYS: by quadrature of a flat scene; else the mean of pings that err some twenty times
 * less. */
static inline asdic_ping *truth_of(honesty_rig *r, uint32_t rays) {
    enum { PINGS = 12 };
    asdic_simulator *sim = rig_simulator(r, rays > 4096 ? 1 << 18 : 1 << 16);
    asdic_ping *truth = new_ping(r), *ping = new_ping(r);
    size_t cells = truth->beams * truth->bins;
    if (asdic_scene_get_info(asdic_mission_scene(r->mission)).triangles == 0) {
        asdic_flat_scene flat = asdic_mission_flat_scene(r->mission, 0);
        double deeper_m = r->pose.position_m.z - flat.depth_m;
        flat.depth_m += deeper_m;
        flat.altitude_m -= deeper_m;
        assert_ok(t.ctx, asdic_expected_compute(t.ctx, &flat, asdic_mission_environment(r->mission),
                                                &r->sonar, &r->pose, truth));
    } else {
        move(r, sim, &r->mover_at);
        assert_ok(t.ctx, asdic_simulator_learn(sim, &r->pose, REFERENCE_INDEX));
        for (uint64_t k = 0; k < PINGS; k++) {
            assert_ok(t.ctx, asdic_simulator_ping(sim, &r->pose, REFERENCE_INDEX + k, ping));
            for (size_t i = 0; i < cells; i++) {
                truth->intensity_lin[ASDIC_TOTAL][i] +=
                    ping->intensity_lin[ASDIC_TOTAL][i] / (double)PINGS;
                truth->intensity_lin[ASDIC_VOLUME][i] +=
                    ping->intensity_lin[ASDIC_VOLUME][i] / (double)PINGS;
                truth->intensity_lin[ASDIC_OBJECT][i] +=
                    ping->intensity_lin[ASDIC_OBJECT][i] / (double)PINGS;
            }
        }
    }
    asdic_ping_destroy(&ping);
    asdic_simulator_destroy(&sim);
    return truth;
}

/* Squares of true over stated errors, and how many; of a beam or another kind of bin. */
typedef struct honesty_sum {
    double squares, count;
} honesty_sum;

static inline double rms_of(honesty_sum s) {
    return sqrt(s.squares / s.count);
}

/* Adds the SQUARE of cell I to where it belongs. */
typedef void honesty_adder(const honesty_rig *r, const asdic_ping *truth, size_t i, double square,
                           honesty_sum *sums);

static inline void add_square(honesty_sum *sum, double square) {
    sum->squares += square;
    sum->count += 1.0;
}

/* Of the bins of PING from 2 m on. */
static inline void add_ratios(const honesty_rig *r, const asdic_ping *ping, const asdic_ping *truth,
                              honesty_adder *add, honesty_sum *sums) {
    size_t first = (size_t)ceil(2.0 / r->sonar.bin_length_m);
    for (size_t i = 0; i < ping->beams * ping->bins; i++) {
        if (i % ping->bins < first || !(ping->stderr_db[i] > 0.0f)) {
            continue;
        }
        double off = asdic_level_db(ping->intensity_lin[ASDIC_TOTAL][i]) -
                     asdic_level_db(truth->intensity_lin[ASDIC_TOTAL][i]);
        double ratio = off / ping->stderr_db[i];
        add(r, truth, i, ratio * ratio, sums);
    }
}

/* Of so many BLOCKS of four pings each. */
static inline void add_errors(honesty_rig *r, uint32_t rays, int blocks, honesty_adder *add,
                              honesty_sum *sums) {
    enum { PINGS = 4 };
    asdic_ping *truth = truth_of(r, rays);
    asdic_simulator *sim = rig_simulator(r, rays);
    asdic_ping *ping = new_ping(r);
    for (int block = 0; block < blocks; block++) {
        uint64_t index = (uint64_t)block * ASDIC_LEARN_BLOCK;
        move(r, sim, &r->mover_learnt_at);
        assert_ok(t.ctx, asdic_simulator_learn(sim, &r->learnt_at, index));
        move(r, sim, &r->mover_at);
        for (uint64_t k = 0; k < PINGS; k++) {
            assert_ok(t.ctx, asdic_simulator_ping(sim, &r->pose, index + k, ping));
            add_ratios(r, ping, truth, add, sums);
        }
    }
    asdic_ping_destroy(&ping);
    asdic_ping_destroy(&truth);
    asdic_simulator_destroy(&sim);
}

/* All bins, and the far third. */
static inline void add_far(const honesty_rig *r, const asdic_ping *truth, size_t i, double square,
                           honesty_sum *sums) {
    size_t first = (size_t)ceil(2.0 / r->sonar.bin_length_m);
    add_square(&sums[0], square);
    if (i % truth->bins >= r->bins - (r->bins - first) / 3) {
        add_square(&sums[1], square);
    }
}

#endif
