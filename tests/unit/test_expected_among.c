/*
 * Expected levels of many places: as those of each place alone but for 0.02 dB, and a function of the
 * place, whatever was asked before.
 */
#include "asserts.h"

#include <asdic/asdic.h>

#include "base/vec.h"
#include "sim/expected.h"

#include <math.h>
#include <string.h>

#define DEGREE (ASDIC_PI / 180.0)
#define BINS 60
#define BEAMS 2
#define TOLERANCE_DB 0.02

typedef struct setup {
    asdic_context *ctx;
    asdic_environment env;
    asdic_sonar sonar;
    asdic_beam receivers[BEAMS];
    asdic_expected_place place;
    asdic_ping *alone, *among;
    asdic_ring_shelf *shelf;
} setup;

static setup begin(void) {
    setup s = {.env = asdic_environment_default(), .sonar = asdic_sonar_default()};
    s.sonar.transmitter.length_h_m = s.sonar.transmitter.length_v_m = 0.06;
    s.receivers[0] = s.receivers[1] = s.sonar.transmitter;
    s.receivers[1].pitch_rad = 15.0 * DEGREE;
    s.sonar.receiver_count = BEAMS;
    s.sonar.bin_length_m = 0.5;
    s.sonar.source_level_db = 200.0; /* all echoes are above the noise */
    s.place.flat = (asdic_flat_scene){.has_surface = true,
                                      .has_bottom = true,
                                      .altitude_m = 5.0,
                                      .depth_m = 15.0,
                                      .bottom = asdic_material_bottom(2.0)};
    assert_int_equal(asdic_context_create(&s.ctx), ASDIC_OK);
    assert_ok(s.ctx, asdic_ping_create(s.ctx, BEAMS, BINS, &s.alone));
    assert_ok(s.ctx, asdic_ping_create(s.ctx, BEAMS, BINS, &s.among));
    assert_ok(s.ctx, asdic_ring_shelf_create(s.ctx, 4, &s.shelf));
    return s;
}

static void end(setup *s) {
    asdic_ring_shelf_destroy(&s->shelf);
    asdic_ping_destroy(&s->alone);
    asdic_ping_destroy(&s->among);
    asdic_context_destroy(&s->ctx);
}

/* A thermocline from 4 to 12 m, and below it water of one gradient. */
static void add_cast(asdic_environment *env) {
    const double depth_m[] = {0.0, 4.0, 6.0, 8.0, 10.0, 12.0, 40.0};
    const double speed_mps[] = {1482.0, 1480.0, 1468.0, 1446.0, 1434.0, 1430.0, 1431.0};
    env->sound_speed_profile.points = 7;
    memcpy(env->sound_speed_profile.depth_m, depth_m, sizeof depth_m);
    memcpy(env->sound_speed_profile.sound_speed_mps, speed_mps, sizeof speed_mps);
}

static void compute(setup *s, double depth_m, double pitch_deg) {
    s->sonar.receivers = s->receivers;
    s->place.flat.depth_m = depth_m;
    s->place.flat.altitude_m = 20.0 - depth_m;
    s->place.pose.pitch_rad = pitch_deg * DEGREE;
    assert_ok(s->ctx, asdic_expected_compute_among(s->ctx, s->shelf, &s->place, 0.0, &s->env,
                                                   &s->sonar, s->among));
}

static void compare(setup *s, double depth_m, double pitch_deg) {
    compute(s, depth_m, pitch_deg);
    assert_ok(s->ctx, asdic_expected_compute(s->ctx, &s->place.flat, &s->env, &s->sonar,
                                             &s->place.pose, s->alone));
    for (size_t i = 0; i < (size_t)BEAMS * BINS; i++) {
        double a = s->alone->intensity_lin[ASDIC_TOTAL][i];
        double b = s->among->intensity_lin[ASDIC_TOTAL][i];
        assert_true(a > 0.0 && b > 0.0);
        assert_close(10.0 * log10(b / a), 0.0, TOLERANCE_DB);
    }
}

static void test_straight(void **state) {
    (void)state;
    setup s = begin();
    for (double t = 0.0; t < 1.0; t += 0.1) {
        compare(&s, 15.0 - 9.0 * t, 25.0 * sin(ASDIC_PI * t));
    }
    end(&s);
}

static void test_bent(void **state) {
    (void)state;
    setup s = begin();
    add_cast(&s.env);
    for (double t = 0.0; t < 1.0; t += 0.25) {
        compare(&s, 15.0 - 10.0 * t, 25.0 * sin(ASDIC_PI * t));
    }
    end(&s);
}

/* What was asked in between does not show; profiles of an attitude are made once. */
static void test_function_of_the_place(void **state) {
    (void)state;
    setup s = begin();
    double first[BEAMS * BINS];
    compute(&s, 15.0, 3.0);
    memcpy(first, s.among->intensity_lin[ASDIC_TOTAL], sizeof first);
    for (int i = 0; i < 12; i++) {
        compute(&s, 10.0, i);
    }
    compute(&s, 15.0, 3.0);
    assert_memory_equal(first, s.among->intensity_lin[ASDIC_TOTAL], sizeof first);
    const asdic_ring rings[2] = {{asdic_face_aim(&s.receivers[0], &s.place.pose, 0.015),
                                  asdic_face_aim(&s.receivers[1], &s.place.pose, 0.015), 0.0},
                                 {asdic_face_aim(&s.receivers[1], &s.place.pose, 0.015),
                                  asdic_face_aim(&s.receivers[1], &s.place.pose, 0.015), 0.0}};
    asdic_ring_profile *const *profiles;
    assert_ok(s.ctx, asdic_ring_shelf_take(s.shelf, rings, 2, &profiles));
    const asdic_ring_profile *kept = profiles[1];
    assert_ok(s.ctx, asdic_ring_shelf_take(s.shelf, rings, 2, &profiles));
    assert_ptr_equal(kept, profiles[1]);
    end(&s);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_straight), cmocka_unit_test(test_bent),
                                       cmocka_unit_test(test_function_of_the_place)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
