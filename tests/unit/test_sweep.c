/*
 * Scanning heads: which way they look at which ping, and where that is in the world.
 */
#include "asserts.h"

#include "base/vec.h"

#include <asdic/sweep.h>

#include <math.h>

#define DEG (3.14159265358979323846 / 180.0)

static double bearing_deg(const asdic_sweep *sweep, uint64_t ping) {
    return asdic_sweep_bearing_rad(sweep, asdic_sweep_direction(sweep, ping)) / DEG;
}

static void circles_go_round(void **state) {
    (void)state;
    asdic_sweep sweep = asdic_sweep_of(360 * DEG, 0.9 * DEG); /* 400 gradians */
    assert_int_equal(sweep.directions, 400);
    assert_true(sweep.is_circle);
    const struct {
        uint64_t ping;
        double deg;
    } rows[] = {{0, -180},    {1, -179.1}, {200, 0},          {300, 90},
                {399, 179.1}, {400, -180}, {4000000200, 0.0}, {UINT64_MAX, -166.5}};
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        assert_close(bearing_deg(&sweep, rows[i].ping), rows[i].deg, 1e-12);
    }
}

static void sectors_go_back_and_forth(void **state) {
    (void)state;
    asdic_sweep sweep = asdic_sweep_of(60 * DEG, 15 * DEG);
    const double there_and_back_deg[] = {-30, -15, 0, 15, 30, 15, 0, -15, -30, -15};
    assert_int_equal(sweep.directions, 5);
    assert_false(sweep.is_circle);
    for (uint64_t k = 0; k < 10; k++) {
        assert_close(bearing_deg(&sweep, k), there_and_back_deg[k], 1e-12);
        assert_close(bearing_deg(&sweep, k + 800), there_and_back_deg[k], 1e-12);
    }
}

static void nothing_turns_without_steps(void **state) {
    (void)state;
    asdic_sweep sweep = asdic_sweep_of(360 * DEG, 0.0);
    const asdic_pose pose = {{1, 2, 3}, 0.1, -0.2, 7.5};
    asdic_pose sonar = asdic_sweep_sonar(&sweep, &pose, 17);
    assert_int_equal(sweep.directions, 0);
    assert_memory_equal(&sonar, &pose, sizeof pose);
    assert_close(asdic_sweep_bearing_rad(&sweep, 0), 0, 0);
    const double none[][2] = {{60, 130}, {60, 61},  {360, 540}, {60, 1e-300},   {60, 1e-5},
                              {0, 10},   {60, NAN}, {NAN, 10},  {60, INFINITY}, {-60, 10}};
    for (size_t i = 0; i < sizeof none / sizeof *none; i++) {
        sweep = asdic_sweep_of(none[i][0] * DEG, none[i][1] * DEG);
        sonar = asdic_sweep_sonar(&sweep, &pose, 17);
        assert_int_equal(sweep.directions, 0);
        assert_memory_equal(&sonar, &pose, sizeof pose);
    }
    assert_int_equal(asdic_sweep_of(60 * DEG, 60.00003 * DEG).directions, 2); /* rounded */
}

/* What a beam aimed DOWN_RAD below the head's plane looks at is the head's direction in the
 * vehicle's frame, turned by the vehicle's attitude alone. */
static void heads_turn_in_the_vehicle(void **state) {
    (void)state;
    asdic_sweep sweep = asdic_sweep_of(360 * DEG, 7.2 * DEG);
    const asdic_pose vehicles[] = {{{1, 2, 3}, 0, 0, 400 * DEG},
                                   {{1, 2, 3}, 20 * DEG, -35 * DEG, 100 * DEG},
                                   {{1, 2, 3}, -75 * DEG, 60 * DEG, -250 * DEG}};
    const double down_rad = 8 * DEG;
    for (size_t v = 0; v < 3; v++) {
        for (uint64_t ping = 0; ping < 50; ping++) {
            const asdic_pose *at = &vehicles[v];
            double head = bearing_deg(&sweep, ping) * DEG;
            asdic_vec3 in_vehicle = {cos(down_rad) * cos(head), cos(down_rad) * sin(head),
                                     sin(down_rad)};
            asdic_vec3 in_sonar = {cos(down_rad), 0, sin(down_rad)};
            asdic_pose sonar = asdic_sweep_sonar(&sweep, at, ping);
            asdic_vec3 wanted = asdic_mat3_apply(
                asdic_mat3_attitude(at->roll_rad, at->pitch_rad, at->yaw_rad), in_vehicle);
            asdic_vec3 found = asdic_mat3_apply(
                asdic_mat3_attitude(sonar.roll_rad, sonar.pitch_rad, sonar.yaw_rad), in_sonar);
            assert_close(asdic_vec3_length(asdic_vec3_sub(found, wanted)), 0, 1e-14);
            assert_close(sonar.position_m.z, 3, 0);
            asdic_pose back = asdic_sweep_vehicle(&sweep, &sonar, ping);
            asdic_vec3 bow =
                asdic_mat3_apply(asdic_mat3_attitude(at->roll_rad, at->pitch_rad, at->yaw_rad),
                                 (asdic_vec3){1, 0, 0});
            asdic_vec3 again =
                asdic_mat3_apply(asdic_mat3_attitude(back.roll_rad, back.pitch_rad, back.yaw_rad),
                                 (asdic_vec3){1, 0, 0});
            assert_close(asdic_vec3_length(asdic_vec3_sub(again, bow)), 0, 1e-14);
        }
    }
}

static double most_apart(asdic_mat3 a, asdic_mat3 b) {
    double most = 0.0;
    for (int k = 0; k < 9; k++) {
        most = fmax(most, fabs(a.m[k / 3][k % 3] - b.m[k / 3][k % 3]));
    }
    return most;
}

/* A profiler rolled by a quarter turn scans a vertical plane: straight up and down, where yaw and roll are told
 * apart by nothing, its attitude is still the vehicle's times the head's. */
static void heads_look_straight_up_and_down(void **state) {
    (void)state;
    asdic_sweep sweep = asdic_sweep_of(360 * DEG, 10 * DEG);
    size_t vertical = 0;
    for (int k = 0; k < 17 * 4 * 36; k++) {
        double pitch_deg = -80 + 10 * (k / 4 % 17), roll_deg = -90 + 90 * (k % 4);
        const asdic_pose at = {{1, 2, 3}, roll_deg * DEG, pitch_deg * DEG, (k / 68) * 7 * DEG};
        for (uint64_t ping = 0; ping < 36; ping++) {
            asdic_mat3 head = asdic_mat3_attitude(0, 0, bearing_deg(&sweep, ping) * DEG);
            asdic_pose sonar = asdic_sweep_sonar(&sweep, &at, ping);
            asdic_pose back = asdic_sweep_vehicle(&sweep, &sonar, ping);
            asdic_mat3 wanted = asdic_mat3_multiply(asdic_mat3_of(&at), head);
            assert_true(most_apart(asdic_mat3_of(&sonar), wanted) < 1e-14);
            assert_true(most_apart(asdic_mat3_of(&back), asdic_mat3_of(&at)) < 1e-14);
            vertical += fabs(wanted.m[2][0]) > 1 - 1e-12;
        }
    }
    assert_true(vertical > 1000);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(circles_go_round),
        cmocka_unit_test(sectors_go_back_and_forth),
        cmocka_unit_test(nothing_turns_without_steps),
        cmocka_unit_test(heads_turn_in_the_vehicle),
        cmocka_unit_test(heads_look_straight_up_and_down),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
