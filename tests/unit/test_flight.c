/*
 * The vehicle that flies waypoints, held to what its kinematics promise.
 */
#include "../assert_close.h"

#include "base/context.h"
#include "base/vec.h"
#include "mission/flight.h"
#include "mission/track_points.h"

static asdic_track *fly(asdic_flight flight) {
    asdic_context *ctx = NULL;
    asdic_track *track = NULL;
    assert_int_equal(asdic_context_create(&ctx), ASDIC_OK);
    asdic_status status = asdic_flight_fly(ctx, &flight, &track);
    if (status != ASDIC_OK) {
        print_error("%s\n", asdic_context_error(ctx));
    }
    assert_int_equal(status, ASDIC_OK);
    asdic_context_destroy(&ctx);
    return track;
}

/* What holds everywhere: constant speed along the body's axis, turns no tighter and dives no
 * faster than allowed, steps of even time. */
static void check_kinematics(const asdic_flight *f, const asdic_track *track) {
    for (size_t i = 1; i < track->count; i++) {
        const track_point *a = &track->points[i - 1], *b = &track->points[i];
        double step_s = b->time_s - a->time_s;
        double dx = b->x_m - a->x_m, dy = b->y_m - a->y_m, dz = b->z_m - a->z_m;
        assert_close(sqrt(dx * dx + dy * dy + dz * dz) / step_s, f->speed_mps, 0, 1e-3);
        assert_true(fabs(dz) / step_s <= f->dive_rate_mps * (1 + 1e-9));
        double forward_mps = hypot(dx, dy) / step_s;
        assert_true(fabs(b->yaw_rad - a->yaw_rad) / step_s <=
                    f->speed_mps / f->turn_radius_m * (1 + 1e-9));
        double yaw = 0.5 * (a->yaw_rad + b->yaw_rad), pitch = 0.5 * (a->pitch_rad + b->pitch_rad);
        assert_close(dx / step_s, forward_mps * cos(yaw), 2e-3 * f->speed_mps, 0);
        assert_close(dy / step_s, forward_mps * sin(yaw), 2e-3 * f->speed_mps, 0);
        assert_close(dz / step_s, -f->speed_mps * sin(pitch), 2e-3 * f->speed_mps, 0);
        assert_close(b->roll_rad, 0, 0, 0);
    }
}

static double nearest_m(const asdic_track *track, const double *point_m) {
    double best_m = INFINITY;
    for (size_t i = 0; i < track->count; i++) {
        const track_point *p = &track->points[i];
        best_m = fmin(best_m, hypot(p->x_m - point_m[0], p->y_m - point_m[1]));
    }
    return best_m;
}

static void straight_line_takes_length_over_speed(void **state) {
    (void)state;
    const double points_m[] = {10, 20, 5, 40, 60, 5}; /* 50 m */
    const asdic_flight flight = {points_m, 2, 2.0, 5.0, 1.0, 0.3};
    asdic_track *track = fly(flight);
    check_kinematics(&flight, track);
    assert_close(asdic_track_end_s(track), 25.0, 0.11, 0);
    asdic_pose pose = asdic_track_pose(track, 12.5);
    assert_close(pose.position_m.x, 25, 1e-9, 0);
    assert_close(pose.position_m.y, 40, 1e-9, 0);
    assert_close(pose.position_m.z, 5, 0, 0);
    assert_close(pose.yaw_rad, atan2(4, 3), 1e-12, 0);
    asdic_track_destroy(&track);
}

static void box_is_flown_close_to_its_corners(void **state) {
    (void)state;
    const double points_m[] = {0, 0, 5, 100, 0, 5, 100, 60, 5, 0, 60, 5, 0, 0, 5};
    const asdic_flight flight = {points_m, 5, 1.5, 5.0, 0.5, 0.3};
    asdic_track *track = fly(flight);
    check_kinematics(&flight, track);
    for (size_t i = 0; i < 5; i++) {
        assert_true(nearest_m(track, points_m + 3 * i) < 0.6 * flight.turn_radius_m);
    }
    /* Half-way along each side the vehicle is on it. */
    const double middles_m[] = {50, 0, 100, 30, 50, 60, 0, 30};
    for (size_t i = 0; i < 4; i++) {
        assert_true(nearest_m(track, middles_m + 2 * i) < 0.5);
    }
    assert_close(asdic_track_end_s(track), 320 / 1.5, 0, 0.1);
    asdic_track_destroy(&track);
}

static void depth_is_reached_without_overshoot(void **state) {
    (void)state;
    const double points_m[] = {0, 0, 5, 100, 0, 15, 200, 0, 2};
    const asdic_flight flight = {points_m, 3, 1.5, 5.0, 1.0, 0.3};
    asdic_track *track = fly(flight);
    check_kinematics(&flight, track);
    double deepest_m = 0, fastest_mps = 0;
    for (size_t i = 1; i < track->count; i++) {
        const track_point *a = &track->points[i - 1], *b = &track->points[i];
        deepest_m = fmax(deepest_m, b->z_m);
        fastest_mps = fmax(fastest_mps, (b->z_m - a->z_m) / (b->time_s - a->time_s));
        assert_true(b->z_m <= 15.001 && b->z_m >= 1.999);
    }
    assert_close(deepest_m, 15, 0.01, 0);
    assert_close(fastest_mps, 0.3, 0, 1e-3);
    assert_close(track->points[track->count - 1].z_m, 2, 0.01, 0);
    asdic_track_destroy(&track);
}

/* With a quick response the tightest turn is a circle of the given radius. */
static void tightest_turn_has_the_radius(void **state) {
    (void)state;
    const double points_m[] = {0, 0, 5, 200, 0, 5, 0, 1, 5};
    const asdic_flight flight = {points_m, 3, 2.0, 20.0, 0.1, 0.3};
    asdic_track *track = fly(flight);
    check_kinematics(&flight, track);
    double fastest = 0;
    for (size_t i = 1; i < track->count; i++) {
        const track_point *a = &track->points[i - 1], *b = &track->points[i];
        fastest = fmax(fastest, fabs(b->yaw_rad - a->yaw_rad) / (b->time_s - a->time_s));
    }
    assert_close(flight.speed_mps / fastest, flight.turn_radius_m, 0, 1e-3);
    asdic_track_destroy(&track);
}

/* A small generator of its own, the same everywhere. */
static double draw(uint32_t *state) {
    *state ^= *state << 13;
    *state ^= *state >> 17;
    *state ^= *state << 5;
    return *state / 4294967296.0;
}

/* Legs shorter than the turn, sharp turns, slow rudders: the flight ends all the same. */
static void any_waypoints_come_to_an_end(void **state) {
    (void)state;
    uint32_t random = 12345;
    for (int i = 0; i < 200; i++) {
        double points_m[30];
        for (size_t k = 0; k < 30; k++) {
            points_m[k] = (k % 3 == 2 ? 20 : 100) * draw(&random);
        }
        const asdic_flight flight = {points_m,
                                     10,
                                     0.5 + 3 * draw(&random),
                                     0.5 + 30 * draw(&random),
                                     0.1 + 3 * draw(&random),
                                     0.4 * draw(&random) + 0.01};
        asdic_track *track = fly(flight);
        check_kinematics(&flight, track);
        asdic_track_destroy(&track);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(straight_line_takes_length_over_speed),
        cmocka_unit_test(box_is_flown_close_to_its_corners),
        cmocka_unit_test(depth_is_reached_without_overshoot),
        cmocka_unit_test(tightest_turn_has_the_radius),
        cmocka_unit_test(any_waypoints_come_to_an_end),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
