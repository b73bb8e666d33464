/*
 * What cells state after a vehicle has gone on, or an object has moved: means over the cells around, counted one by one.
 */
#include "asserts.h"
#include "test_context.h"

#include "scene/scene.h"
#include "sim/drift.h"

#include <stdlib.h>

#define BINS 30
#define BEAMS 20
#define BIN_M 0.5
#define SPACING_RAD 0.1

/* A simulator that has learnt, of as many BEAMS, MANY or few, with an object that moves. */
typedef struct rig {
    asdic_simulator *sim;
    asdic_scene *scene;
    asdic_placement placement;
    asdic_pose object;
    asdic_beam receivers[BEAMS];
    asdic_stated_error stated[BEAMS * BINS];
} rig;

static bool is_known(size_t beam, size_t bin) {
    return (3 * beam + bin) % 5 != 0 && bin != 20;
}

static void learn(rig *r, size_t beams, bool many) {
    *r = (rig){.sim = calloc(1, sizeof *r->sim), .scene = calloc(1, sizeof *r->scene)};
    assert_true(r->sim && r->scene);
    asdic_simulator *sim = r->sim;
    r->scene->movable_count = 1;
    r->object.position_m = (asdic_vec3){10.0, 0.0, 5.0};
    r->placement.poses = &r->object;
    for (size_t b = 0; b < beams; b++) { /* in no order */
        r->receivers[b].yaw_rad = SPACING_RAD * (double)(7 * b % beams);
    }
    for (size_t i = 0; i < beams * BINS; i++) {
        bool known = is_known(i / BINS, i % BINS);
        r->stated[i] =
            (asdic_stated_error){.of_block = known ? 1e-3f * (float)(1 + i * i % 37) : 1.0f,
                                 .of_groups = many ? known : 0.3f,
                                 .mean_lin = known ? (float)(2 + i * i % 41) : 0.0f,
                                 .rare = 0.01f};
    }
    sim->ctx = ctx;
    sim->setup.scene = r->scene;
    sim->setup.sonar =
        (asdic_sonar){.receivers = r->receivers, .receiver_count = beams, .bin_length_m = BIN_M};
    sim->setup.bins = BINS;
    sim->setup.cells = beams * BINS;
    sim->setup.threads = 2;
    sim->placement = &r->placement;
    sim->fan.many = many;
    sim->learnt.stated = r->stated;
    sim->learnt.lesson = (asdic_lesson){.pose = {.position_m = {1.0, 2.0, 5.0}, .yaw_rad = 6.2}};
    for (int turn = 0; turn < 2; turn++) { /* the second time in the memory of the first */
        assert_ok(ctx, asdic_drift_learn(sim));
    }
}

static void forget(rig *r) {
    asdic_drift_destroy(&r->sim->learnt.drift);
    asdic_drift_destroy(&r->sim->learnt.drift);
    free(r->sim);
    free(r->scene);
}

/* Of BEAM's bin N, by counting the cells within REACH. */
static float stated_by(const rig *r, asdic_drift_reach reach, size_t beam, size_t n) {
    double sum = 0.0, count = 0.0;
    for (size_t i = 0; i < r->sim->setup.cells; i++) {
        size_t b = i / BINS, k = i % BINS;
        bool counts = is_known(b, k) && b <= beam + reach.beams && beam <= b + reach.beams &&
                      k <= n + reach.bins && n <= k + reach.bins;
        sum += counts ? (double)r->stated[i].of_block : 0.0;
        count += counts;
    }
    float own = r->stated[beam * BINS + n].of_block;
    bool stays = count < 1.0 || (r->sim->fan.many && is_known(beam, n));
    return stays ? fmaxf(own, count < 1.0 ? 0.0f : (float)(sum / count)) : (float)(sum / count);
}

/* What was missed in BEAM's bin N is no more than its own within REACH heard; nothing is known to be, where echoes went to
 * other beams. */
static float heard_by(const rig *r, asdic_drift_reach reach, size_t beam, size_t n) {
    float least = r->stated[beam * BINS + n].mean_lin;
    for (size_t k = 0; k < BINS; k++) {
        bool counts = k <= n + reach.bins && n <= k + reach.bins;
        least = counts ? fminf(least, r->stated[beam * BINS + k].mean_lin) : least;
    }
    return reach.beams > 0 ? 0.0f : least;
}

static void check_rows(const rig *r, const asdic_drift *drift) {
    for (size_t beam = 0; beam < r->sim->setup.sonar.receiver_count; beam++) {
        const asdic_stated_error *rows[] = {asdic_drift_row(r->sim, drift, 1, beam, false),
                                            asdic_drift_row(r->sim, drift, 1, beam, true)};
        const asdic_drift_reach reaches[] = {drift->others, drift->objects};
        for (size_t n = 0; n < BINS; n++) {
            asdic_stated_error own = r->stated[beam * BINS + n];
            for (int k = 0; k < 2; k++) {
                bool stays = reaches[k].bins + reaches[k].beams == 0;
                assert_close_relative(rows[k][n].of_block,
                                      stays ? own.of_block : stated_by(r, reaches[k], beam, n),
                                      1e-6);
                assert_true(rows[k][n].mean_lin == heard_by(r, drift->heard, beam, n));
                assert_true(rows[k][n].of_groups == own.of_groups && rows[k][n].rare == own.rare);
            }
        }
    }
}

static void cells_state_what_those_around_learnt(void **state) {
    (void)state;
    static const asdic_drift ways[] = {{.heard = {0, 0}},
                                       {.others = {1, 0}, .objects = {4, 0}, .heard = {1, 0}},
                                       {.others = {4, 0}, .objects = {4, 0}},
                                       {.others = {0, 2}, .objects = {3, 1}, .heard = {2, 0}},
                                       {.others = {5, BEAMS}, .heard = {0, 1}},
                                       {.objects = {BINS, 3}, .heard = {BINS, 0}},
                                       {.heard = {3, 0}},
                                       {.heard = {3, 2}}};
    for (int many = 0; many < 2; many++) {
        rig r;
        learn(&r, many ? BEAMS : 3, many);
        for (size_t i = 0; i < sizeof ways / sizeof *ways; i++) {
            check_rows(&r, &ways[i]);
        }
        assert_ptr_equal(asdic_drift_row(r.sim, &ways[0], 0, 1, false), r.stated + BINS);
        forget(&r);
    }
}

static void assert_reach(asdic_drift_reach reach, size_t bins, size_t beams) {
    assert_int_equal(reach.bins, bins);
    assert_int_equal(reach.beams, beams);
}

/* Twice the way, and twice the angle, in cells. */
static void ways_are_counted_in_cells(void **state) {
    (void)state;
    for (int many = 0; many < 2; many++) {
        rig r;
        learn(&r, many ? BEAMS : 3, many);
        size_t most = many ? BEAMS : 3;
        asdic_pose pose = r.sim->learnt.lesson.pose;
        asdic_drift drift = asdic_drift_since(r.sim, &pose);
        assert_false(drift.is_any);
        assert_reach(drift.others, 0, 0);
        assert_reach(drift.objects, 0, 0);
        pose.pitch_rad = 1e-3;
        assert_true(asdic_drift_since(r.sim, &pose).is_any);
        pose.pitch_rad = 0.0;
        pose.roll_rad = 1e-3;
        assert_true(asdic_drift_since(r.sim, &pose).is_any);
        pose.roll_rad = 0.0;
        pose.yaw_rad = 6.2 - 6.283185307179586 + 0.13; /* past north */
        drift = asdic_drift_since(r.sim, &pose);
        assert_true(drift.is_any);
        assert_reach(drift.others, 0, 3 < most ? 3 : most);
        assert_reach(drift.heard, 0, many ? 3 : 0);
        pose.yaw_rad = 6.2 + 3.0;
        assert_reach(asdic_drift_since(r.sim, &pose).others, 0, most);
        pose.yaw_rad = 6.2;
        pose.position_m = (asdic_vec3){1.0 + 0.2, 2.0 + 0.3, 5.0 + 0.6}; /* 0.7 m */
        drift = asdic_drift_since(r.sim, &pose);
        assert_true(drift.is_any);
        assert_reach(drift.others, 3, 0);
        assert_reach(drift.objects, 3, 0);
        assert_reach(drift.heard, many ? 3 : 0, 0);
        /* The object, 9 m north and 2 west, comes 3 m south and 4 east: from -0.2187 to 0.3218 rad. */
        pose = r.sim->learnt.lesson.pose;
        r.object.position_m = (asdic_vec3){7.0, 4.0, 5.0};
        drift = asdic_drift_since(r.sim, &pose);
        assert_true(drift.is_any);
        assert_reach(drift.others, 0, 0);
        if (many) {
            assert_reach(drift.objects, 20, 11);
        } else { /* whose own rays show it */
            assert_reach(drift.objects, 0, 0);
        }
        assert_reach(drift.heard, 20, many ? 11 : 3);
        pose.position_m.z += 0.5;
        assert_reach(asdic_drift_since(r.sim, &pose).heard, many ? 22 : 20, many ? 11 : 3);
        assert_reach(asdic_drift_since(r.sim, &pose).objects, many ? 22 : 2, many ? 11 : 0);
        pose.position_m.z += 20.0;
        assert_reach(asdic_drift_since(r.sim, &pose).others, BINS, 0);
        forget(&r);
    }
}

/* Over planes, and of a single receiver, there is nothing to count. */
static void planes_do_not_drift(void **state) {
    (void)state;
    rig r;
    learn(&r, 1, false);
    asdic_pose pose = r.sim->learnt.lesson.pose;
    pose.yaw_rad += 1.0;
    assert_reach(asdic_drift_since(r.sim, &pose).others, 0, 0);
    pose.position_m.x += 3.0;
    assert_reach(asdic_drift_since(r.sim, &pose).others, 12, 0);
    r.sim->learnt.lesson.is_even = true;
    assert_false(asdic_drift_since(r.sim, &pose).is_any);
    asdic_drift_destroy(&r.sim->learnt.drift);
    assert_ok(ctx, asdic_drift_learn(r.sim));
    assert_null(r.sim->learnt.drift);
    r.sim->learnt.lesson.is_even = false;
    assert_false(asdic_drift_since(r.sim, &pose).is_any);
    forget(&r);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(cells_state_what_those_around_learnt),
        cmocka_unit_test(ways_are_counted_in_cells),
        cmocka_unit_test(planes_do_not_drift),
    };
    return cmocka_run_group_tests(tests, context_begin, context_end);
}
