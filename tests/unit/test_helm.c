/* Steering by hand: circles of the known radius, dives, depths held, nothing hit. */
#include "asserts.h"

#include "live/helm.h"

#include <asdic/asdic.h>

#include <math.h>

typedef struct sea {
    asdic_context *ctx;
    asdic_scene *scene; /* 20 m deep */
} sea;

static int make_sea(void **state) {
    static sea s;
    *state = &s;
    return asdic_context_create(&s.ctx) || asdic_scene_create(s.ctx, &s.scene) ||
           asdic_scene_set_bottom_plane(s.scene, 20.0, asdic_material_bottom(2.0)) ||
           asdic_scene_commit(s.scene);
}

static int drain(void **state) {
    sea *s = *state;
    asdic_scene_destroy(&s->scene);
    asdic_context_destroy(&s->ctx);
    return 0;
}

static asdic_helm take(asdic_vehicle vehicle, double speed_mps) {
    asdic_flight flight = {.vehicle = vehicle,
                           .speed_mps = speed_mps,
                           .turn_radius_m = 6.0,
                           .response_s = 1.0,
                           .dive_rate_mps = 0.5};
    asdic_pose pose = {.position_m = {0.0, 0.0, 8.0}};
    asdic_helm helm;
    asdic_helm_init(&helm, &flight);
    asdic_helm_take(&helm, &pose, speed_mps);
    return helm;
}

static asdic_pose fly(const sea *s, asdic_helm *helm, double seconds) {
    asdic_pose pose = {.yaw_rad = NAN};
    for (int i = 0; i < (int)(10.0 * seconds); i++) {
        pose = asdic_helm_advance(helm, s->scene, 0.1);
    }
    return pose;
}

static void straight_on_it_keeps_course_and_depth(void **state) {
    static const asdic_vehicle vehicles[] = {ASDIC_VEHICLE_NOMOTO, ASDIC_VEHICLE_REMUS100};
    for (int v = 0; v < 2; v++) {
        asdic_helm helm = take(vehicles[v], 1.5);
        asdic_pose pose = fly(*state, &helm, 20.0);
        assert_close(pose.position_m.x, 30.0, 0.2);
        assert_close(pose.position_m.y, 0.0, 1e-6);
        assert_close(pose.position_m.z, 8.0, 1e-3);
    }
}

/* Full rudder: speed over yaw rate is the radius that the model states. */
static void full_rudder_flies_the_circle(void **state) {
    static const struct {
        asdic_vehicle vehicle;
        double radius_m;
    } cases[] = {{ASDIC_VEHICLE_NOMOTO, 6.0}, {ASDIC_VEHICLE_REMUS100, 4.41}};
    for (int k = 0; k < 2; k++) {
        asdic_helm helm = take(cases[k].vehicle, 1.5);
        for (int i = 0; i < 5; i++) { /* more than full is full */
            asdic_helm_change_rudder(&helm, 0.25);
        }
        double lowest = INFINITY, highest = -INFINITY;
        asdic_pose pose = fly(*state, &helm, 30.0);
        assert_true(pose.yaw_rad > 3.0); /* to starboard */
        for (int i = 0; i < 300; i++) {
            pose = asdic_helm_advance(&helm, ((sea *)*state)->scene, 0.1);
            lowest = fmin(lowest, pose.position_m.y);
            highest = fmax(highest, pose.position_m.y);
        }
        assert_close(0.5 * (highest - lowest), cases[k].radius_m, 0.02 * cases[k].radius_m);
        asdic_helm_change_rudder(&helm, 0.0);
        fly(*state, &helm, 10.0);
        double yaw_rad = helm.state.yaw_rad;
        assert_close(fly(*state, &helm, 5.0).yaw_rad, yaw_rad, 0.02);
    }
}

static void planes_dive_and_hold_keeps_the_depth(void **state) {
    static const asdic_vehicle vehicles[] = {ASDIC_VEHICLE_NOMOTO, ASDIC_VEHICLE_REMUS100};
    for (int v = 0; v < 2; v++) {
        asdic_helm helm = take(vehicles[v], 1.5);
        asdic_helm_change_planes(&helm, 0.5);
        assert_false(helm.holds_depth);
        asdic_pose pose = fly(*state, &helm, 10.0);
        assert_true(pose.position_m.z > 9.5 && pose.pitch_rad < -0.1); /* bow down */
        asdic_helm_toggle_hold(&helm);
        double z_m = helm.hold_z_m;
        fly(*state, &helm, 30.0);
        assert_close(helm.state.z_m, z_m, 0.1);
    }
}

static void neither_ground_nor_air_is_flown_through(void **state) {
    for (int k = 0; k < 2; k++) {
        asdic_helm helm = take(k ? ASDIC_VEHICLE_REMUS100 : ASDIC_VEHICLE_NOMOTO, 2.0);
        asdic_helm_change_planes(&helm, 1.0);
        for (int i = 0; i < 1000; i++) {
            double z_m = asdic_helm_advance(&helm, ((sea *)*state)->scene, 0.1).position_m.z;
            assert_true(z_m <= 19.7 + 1e-9);
        }
        assert_close(helm.state.z_m, 19.7, 0.05);
        asdic_helm_change_planes(&helm, -2.0);
        assert_true(fly(*state, &helm, 100.0).position_m.z >= 0.3 - 1e-9);
    }
}

static void speeds_stay_within_the_models(void **state) {
    asdic_helm helm = take(ASDIC_VEHICLE_REMUS100, 1.5);
    asdic_helm_change_speed(&helm, 9.0);
    assert_true(helm.wanted_mps == 2.5);
    asdic_helm_change_speed(&helm, -1.6);
    assert_true(helm.wanted_mps == 0.0); /* nothing between rest and 1 m/s is known */
    asdic_helm_change_speed(&helm, 0.25);
    assert_true(helm.wanted_mps == 1.0);
    helm = take(ASDIC_VEHICLE_NOMOTO, 0.0);
    asdic_pose rest = fly(*state, &helm, 5.0);
    assert_true(rest.position_m.x == 0.0 && rest.position_m.z == 8.0);
    asdic_helm_change_speed(&helm, 1.0);
    assert_close(fly(*state, &helm, 20.0).position_m.x, 19.0, 0.3); /* a lag of 1 s */
}

/* 0.3 m of water is left above and below; 6 m/s is the most, 0.05 m/s the least that answers; the REMUS 100 does not
 * go slower than its model allows, but stops. */
static void limits_are_those_that_are_said(void **state) {
    asdic_helm helm = take(ASDIC_VEHICLE_NOMOTO, 1.5);
    asdic_helm_change_planes(&helm, -1.0);
    assert_close(fly(*state, &helm, 60.0).position_m.z, 0.3, 1e-9);
    asdic_helm_change_planes(&helm, 2.0);
    assert_close(fly(*state, &helm, 120.0).position_m.z, 19.7, 1e-9);

    asdic_helm_change_speed(&helm, 100.0);
    assert_close(helm.wanted_mps, 6.0, 0.0);
    asdic_helm_change_speed(&helm, -100.0);
    assert_close(helm.wanted_mps, 0.0, 0.0);

    helm = take(ASDIC_VEHICLE_NOMOTO, 0.049);
    assert_close(fly(*state, &helm, 10.0).position_m.x, 0.0, 0.0);
    helm = take(ASDIC_VEHICLE_NOMOTO, 0.051);
    assert_close(fly(*state, &helm, 10.0).position_m.x, 0.51, 1e-3);

    helm = take(ASDIC_VEHICLE_REMUS100, ASDIC_REMUS100_MIN_MPS);
    assert_close(helm.wanted_mps, ASDIC_REMUS100_MIN_MPS, 0.0);
    asdic_helm_change_speed(&helm, -0.01);
    assert_close(helm.wanted_mps, 0.0, 0.0);
    asdic_helm_change_speed(&helm, 0.01);
    assert_close(helm.wanted_mps, ASDIC_REMUS100_MIN_MPS, 0.0);
    asdic_helm_change_speed(&helm, 100.0);
    assert_close(helm.wanted_mps, ASDIC_REMUS100_MAX_MPS, 0.0);
}

/* Slow vehicles cannot dive steeper than at a slope of 0.57. */
static void slow_dives_are_no_steeper(void **state) {
    asdic_helm helm = take(ASDIC_VEHICLE_NOMOTO, 0.5); /* 0.5 m/s down is what it may */
    asdic_helm_change_planes(&helm, 1.0);
    fly(*state, &helm, 10.0); /* settled */
    double z_m = helm.state.z_m;
    assert_close(fly(*state, &helm, 10.0).position_m.z - z_m, 10.0 * 0.57 * 0.5, 0.02);
    assert_close(helm.flight.dive_rate_mps, 0.5, 0.0); /* as before */
}

/* The first touch of the planes leaves the depth that is held; rudder and planes add up to 1. */
static void touches_add_up(void **state) {
    asdic_helm helm = take(ASDIC_VEHICLE_NOMOTO, 1.5);
    assert_true(helm.holds_depth && helm.hold_z_m == 8.0);
    helm.planes = 0.7;
    asdic_helm_change_planes(&helm, 0.25);
    assert_false(helm.holds_depth);
    assert_close(helm.planes, 0.25, 0.0);
    asdic_helm_change_planes(&helm, 0.25);
    assert_close(helm.planes, 0.5, 0.0);
    asdic_helm_change_planes(&helm, 7.0);
    assert_close(helm.planes, 1.0, 0.0);
    fly(*state, &helm, 3.0);
    asdic_helm_toggle_hold(&helm);
    assert_true(helm.holds_depth && helm.hold_z_m == helm.state.z_m && helm.planes == 0.0);
    asdic_helm_toggle_hold(&helm);
    assert_false(helm.holds_depth);

    asdic_helm_change_rudder(&helm, -0.25);
    asdic_helm_change_rudder(&helm, -0.25);
    assert_close(helm.rudder, -0.5, 0.0);
    asdic_helm_change_rudder(&helm, -7.0);
    assert_close(helm.rudder, -1.0, 0.0);
    asdic_helm_change_rudder(&helm, 0.0);
    assert_close(helm.rudder, 0.0, 0.0);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(straight_on_it_keeps_course_and_depth),
        cmocka_unit_test(full_rudder_flies_the_circle),
        cmocka_unit_test(planes_dive_and_hold_keeps_the_depth),
        cmocka_unit_test(neither_ground_nor_air_is_flown_through),
        cmocka_unit_test(speeds_stay_within_the_models),
        cmocka_unit_test(limits_are_those_that_are_said),
        cmocka_unit_test(slow_dives_are_no_steeper),
        cmocka_unit_test(touches_add_up),
    };
    return cmocka_run_group_tests(tests, make_sea, drain);
}
