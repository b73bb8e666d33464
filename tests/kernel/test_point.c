/* Point targets: the sonar equation to the last digits, and what hides them. */
#include "ping_rig.h"

#include "kernels/beam.h"

static test_device t;

/* SL - TL + TS and both beams at RANGE_M, bearing AZIMUTH and elevation DOWN of the bow; each leaks behind its face. */
static double expected_db(const ping_rig *r, int beam, double range_m, double azimuth_rad,
                          double down_rad, double strength_db) {
    double alpha = asdic_environment_absorption_db_per_km(&r->env, r->sonar.frequency_hz, 7.0);
    double c_mps = asdic_environment_sound_speed_mps(&r->env, 7.0);
    double per_m = r->sonar.frequency_hz / c_mps, gain = 1.0;
    for (int way = 0; way < 2; way++) {
        const asdic_beam *face = way ? &r->receivers[beam] : &r->sonar.transmitter;
        double pitch = face->pitch_rad;
        double x = cos(down_rad) * cos(azimuth_rad), z = sin(down_rad);
        gain *= beam_pattern_lin(x * cos(pitch) + z * sin(pitch), cos(down_rad) * sin(azimuth_rad),
                                 z * cos(pitch) - x * sin(pitch), face->length_h_m * per_m,
                                 face->length_v_m * per_m, pow(10.0, 0.1 * r->sonar.rear_floor_db));
    }
    return r->sonar.source_level_db + strength_db + 10.0 * log10(gain) - 40.0 * log10(range_m) -
           2.0 * (range_m - 1.0) * alpha / 1000.0;
}

static ping_rig empty_sea(void) {
    ping_rig r = rig_create(&t);
    r.env.particle_strength_db = -200.0;
    r.sampling.rays = 1024;
    asdic_scene_destroy(&r.scene);
    assert_ok(t.ctx, asdic_scene_create(t.ctx, &r.scene));
    asdic_scene_set_surface(r.scene, false);
    return r;
}

static asdic_vec3 place(double range_m, double azimuth_rad, double down_rad) {
    return (asdic_vec3){range_m * cos(down_rad) * cos(azimuth_rad),
                        range_m * cos(down_rad) * sin(azimuth_rad), 7.0 + range_m * sin(down_rad)};
}

static double level_db(const asdic_ping *ping, int beam, double range_m) {
    size_t bin = (size_t)(range_m / ping->bin_length_m);
    return asdic_level_db(ping->intensity_lin[ASDIC_OBJECT][beam * ping->bins + bin]);
}

static void points_meet_the_sonar_equation(void **state) {
    (void)state;
    static const struct {
        double range_m, azimuth_deg, down_deg, strength_db;
    } points[] = {{0.8, 0, 0, -42.3},   {12.26, 0, 0, -42.3},   {30.1, 10, -5, 3.0},
                  {55.2, -25, 20, -20}, {70.7, 60, -40, -60.0}, {74.3, 1, 1, 100.0},
                  {20.3, 151, 7, 10},   {45.4, -117, -3, 20}}; /* the last two behind the faces */
    enum { COUNT = sizeof points / sizeof *points };
    ping_rig r = empty_sea();
    r.sonar.source_level_db = 200.0;
    r.sonar.rear_floor_db = -20.0;
    r.sonar.transmitter.length_h_m = 0.013; /* as no receiver is */
    r.sonar.transmitter.length_v_m = 0.021;
    r.sonar.transmitter.pitch_rad = -0.07;
    for (int i = 0; i < COUNT; i++) {
        assert_ok(t.ctx,
                  asdic_scene_add_point(r.scene, "sphere",
                                        place(points[i].range_m, points[i].azimuth_deg * RIG_DEGREE,
                                              points[i].down_deg * RIG_DEGREE),
                                        points[i].strength_db));
    }
    asdic_ping *ping = rig_shoot(&r, 3, true);
    double most = 0.0;
    for (int beam = 0; beam < RIG_BEAMS; beam++) {
        for (int i = 0; i < COUNT; i++) {
            double expected =
                expected_db(&r, beam, points[i].range_m, points[i].azimuth_deg * RIG_DEGREE,
                            points[i].down_deg * RIG_DEGREE, points[i].strength_db);
            most = fmax(most, fabs(level_db(ping, beam, points[i].range_m) - expected));
        }
    }
    print_message("off by %.2g dB at most\n", most);
    assert_true(most < 1e-4); /* beyond the main lobe a face's rounded axes count */
    /* Nothing else is in the object component, and the total holds it. */
    double sum = 0.0, object = 0.0;
    for (size_t n = 0; n < ping->bins; n++) {
        sum += ping->intensity_lin[ASDIC_OBJECT][n] > 0.0;
        object += ping->intensity_lin[ASDIC_TOTAL][n] - ping->intensity_lin[ASDIC_OBJECT][n] -
                  ping->intensity_lin[ASDIC_VOLUME][n];
    }
    assert_true(sum == COUNT);
    assert_true(fabs(object) < 1e-12 * ping->intensity_lin[ASDIC_TOTAL][148]);
    asdic_ping_destroy(&ping);
    rig_destroy(&r);
}

/* The same bytes for every ping, seed and number of rays. */
static void points_have_no_sampling_error(void **state) {
    (void)state;
    ping_rig r = empty_sea();
    assert_ok(t.ctx, asdic_scene_add_point(r.scene, "sphere", place(20.2, 0, 0), -30.0));
    asdic_ping *a = rig_shoot(&r, 3, true);
    r.sampling.seed = 99;
    r.sampling.rays = 4096;
    asdic_ping *b = rig_shoot(&r, 4, false);
    assert_memory_equal(a->intensity_lin[ASDIC_OBJECT], b->intensity_lin[ASDIC_OBJECT],
                        a->beams * a->bins * sizeof(double));
    /* The water's own error hardly counts beside the point. */
    assert_true(a->intensity_lin[ASDIC_OBJECT][40] > 0.0);
    assert_true(a->stderr_db[40] < 1e-6f);
    asdic_ping_destroy(&a);
    asdic_ping_destroy(&b);
    rig_destroy(&r);
}

/* Each of these hides the point; without it the point is heard. */
static void points_are_hidden(void **state) {
    (void)state;
    enum { NOTHING, BOX, FLOOR, FLOOR_MESH, SURFACE, BLANKING, RANGE, BEHIND, CASES };
    for (int what = NOTHING; what < CASES; what++) {
        ping_rig r = empty_sea();
        double range_m = what == BLANKING ? 0.4 : what == RANGE ? 74.6 : 20.2;
        asdic_vec3 at = place(range_m, what == BEHIND ? 3.1 : 0.0, 0.0);
        asdic_mesh *mesh = NULL;
        asdic_pose pose = {.position_m = {10.0, 0.0, 7.0}};
        if (what == BOX) {
            assert_ok(t.ctx, asdic_mesh_box(t.ctx, (asdic_vec3){0.1, 1.0, 1.0}, &mesh));
            assert_ok(t.ctx, asdic_scene_add_object(r.scene, "box", mesh, pose,
                                                    asdic_material_bottom(2.0)));
        } else if (what == FLOOR) { /* a point in the mud under a sonar above it */
            at.z = 12.5;
            assert_ok(t.ctx,
                      asdic_scene_set_bottom_plane(r.scene, 12.0, asdic_material_bottom(2.0)));
        } else if (what == FLOOR_MESH) {
            pose.pitch_rad = 90 * RIG_DEGREE;
            pose.position_m.z = 12.0;
            at.z = 14.0;
            at.x = 12.0;
            assert_ok(t.ctx, asdic_mesh_plate(t.ctx, 40.0, 40.0, &mesh));
            assert_ok(t.ctx,
                      asdic_scene_add_bottom(r.scene, mesh, pose, asdic_material_bottom(2.0)));
        } else if (what == SURFACE) {
            asdic_scene_set_surface(r.scene, true);
            at.z = -1.0;
        }
        assert_ok(t.ctx, asdic_scene_add_point(r.scene, "sphere", at, 10.0));
        asdic_ping *ping = rig_shoot(&r, 0, false);
        double heard = 0.0;
        for (size_t n = 0; n < ping->bins; n++) {
            /* A box is heard itself, but not where the point is. */
            heard += what == BOX && n < 30 ? 0.0 : ping->intensity_lin[ASDIC_OBJECT][n];
        }
        assert_int_equal(heard > 0.0, what == NOTHING);
        asdic_ping_destroy(&ping);
        asdic_mesh_destroy(&mesh);
        rig_destroy(&r);
    }
}

static void wrong_points_are_refused(void **state) {
    (void)state;
    ping_rig r = empty_sea();
    asdic_vec3 at = {1.0, 2.0, 3.0};
    assert_status(t.ctx, asdic_scene_add_point(r.scene, "", at, 0.0), ASDIC_ERROR_ARGUMENT);
    assert_status(t.ctx, asdic_scene_add_point(r.scene, "x", at, 101.0), ASDIC_ERROR_ARGUMENT);
    assert_status(t.ctx, asdic_scene_add_point(r.scene, "x", at, NAN), ASDIC_ERROR_ARGUMENT);
    at.y = INFINITY;
    assert_status(t.ctx, asdic_scene_add_point(r.scene, "x", at, 0.0), ASDIC_ERROR_ARGUMENT);
    assert_ok(t.ctx, asdic_scene_commit(r.scene));
    at.y = 0.0;
    assert_status(t.ctx, asdic_scene_add_point(r.scene, "x", at, 0.0), ASDIC_ERROR_ARGUMENT);
    assert_contains(asdic_context_error(t.ctx), "committed");
    rig_destroy(&r);
}

int main(void) {
    t = test_device_open_or_skip();
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(points_meet_the_sonar_equation),
        cmocka_unit_test(points_have_no_sampling_error),
        cmocka_unit_test(points_are_hidden),
        cmocka_unit_test(wrong_points_are_refused),
    };
    int failed = cmocka_run_group_tests(tests, NULL, NULL);
    test_device_close(&t);
    return failed;
}
