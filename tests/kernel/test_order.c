/*
 * A library used in the wrong order, beyond its limits, after a failure, and by two threads at once,
 * each with a context of its own.
 */
#include "asserts.h"
#include "test_device.h"

#include <asdic/asdic.h>

#include <pthread.h>
#include <stdlib.h>

static test_device t;

#define BINS 20
#define THREAD_PINGS 3

static asdic_sonar sonar_of(const asdic_beam *beam) {
    asdic_sonar sonar = asdic_sonar_default();
    sonar.receivers = beam;
    sonar.receiver_count = 1;
    sonar.bin_length_m = 1.0;
    sonar.ping_rate_hz = 30.0;
    return sonar;
}

static asdic_scene *scene_of(asdic_context *ctx) {
    asdic_scene *scene = NULL;
    assert_ok(ctx, asdic_scene_create(ctx, &scene));
    assert_ok(ctx, asdic_scene_set_bottom_plane(scene, 12.0, asdic_material_bottom(2.0)));
    return scene;
}

static asdic_beam beam(void) {
    return (asdic_beam){.name = "a", .length_h_m = 0.05, .length_v_m = 0.05};
}

static asdic_status create(asdic_context *ctx, asdic_device *device, const asdic_scene *scene,
                           const asdic_sonar *sonar, uint32_t rays, double depth_m,
                           asdic_simulator **out) {
    asdic_environment env = asdic_environment_default();
    asdic_sampling sampling = asdic_sampling_default();
    sampling.rays = rays;
    return asdic_simulator_create(ctx, device, scene, &env, sonar, &sampling, depth_m, out);
}

static void a_scene_is_committed_once(void **state) {
    (void)state;
    asdic_scene *scene = scene_of(t.ctx);
    asdic_mesh *box = NULL;
    asdic_simulator *sim = NULL;
    asdic_pose here = {.position_m = {5.0, 0.0, 5.0}};
    asdic_beam one = beam();
    asdic_sonar sonar = sonar_of(&one);
    assert_ok(t.ctx, asdic_mesh_box(t.ctx, (asdic_vec3){1.0, 1.0, 1.0}, &box));
    assert_status(t.ctx, create(t.ctx, t.device, scene, &sonar, 64, 5.0, &sim),
                  ASDIC_ERROR_ARGUMENT);
    assert_null(sim);
    assert_ok(t.ctx, asdic_scene_commit(scene));
    assert_status(t.ctx,
                  asdic_scene_add_object(scene, "late", box, here, asdic_material_bottom(2.0)),
                  ASDIC_ERROR_ARGUMENT);
    assert_status(t.ctx, asdic_scene_add_point(scene, "late", here.position_m, -10.0),
                  ASDIC_ERROR_ARGUMENT);
    assert_status(t.ctx, asdic_scene_set_bottom_plane(scene, 9.0, asdic_material_bottom(2.0)),
                  ASDIC_ERROR_ARGUMENT);
    assert_status(t.ctx, asdic_scene_set_surface(scene, false), ASDIC_ERROR_ARGUMENT);
    assert_true(asdic_scene_get_info(scene).has_surface);
    assert_status(
        t.ctx, asdic_scene_set_surface_law(scene, asdic_material_of(asdic_law_find("apl-surface"))),
        ASDIC_ERROR_ARGUMENT);
    assert_status(t.ctx, asdic_scene_commit(scene), ASDIC_ERROR_ARGUMENT);
    asdic_mesh_destroy(&box);
    asdic_scene_destroy(&scene);
}

/* A law is taken for what law.h says it is made for; a bottom also takes those of objects. */
static void laws_are_taken_for_their_uses(void **state) {
    (void)state;
    asdic_scene *scene = NULL;
    asdic_mesh *box = NULL;
    asdic_ping *ping = NULL;
    asdic_pose here = {.position_m = {5.0, 0.0, 5.0}};
    asdic_environment env = asdic_environment_default();
    asdic_beam one = beam();
    asdic_sonar sonar = sonar_of(&one);
    assert_ok(t.ctx, asdic_scene_create(t.ctx, &scene));
    assert_ok(t.ctx, asdic_mesh_box(t.ctx, (asdic_vec3){1.0, 1.0, 1.0}, &box));
    assert_ok(t.ctx, asdic_ping_create(t.ctx, 1, BINS, &ping));
    for (size_t i = 0; i < asdic_law_count(); i++) {
        asdic_law_info law = asdic_law_get_info(asdic_law_get(i));
        asdic_material m = asdic_material_of(asdic_law_get(i));
        const double rows[] = {1.0, -30.0, 90.0, -10.0};
        m.rows = rows;
        m.row_count = 2;
        asdic_flat_scene flat = {true, true, 5.0, 5.0, m, {0}};
        asdic_flat_scene up = {true, true, 5.0, 5.0, asdic_material_bottom(2.0), m};
        asdic_status bottom =
            law.uses & (ASDIC_LAW_BOTTOM | ASDIC_LAW_OBJECT) ? ASDIC_OK : ASDIC_ERROR_ARGUMENT;
        asdic_status surface = law.uses & ASDIC_LAW_SURFACE ? ASDIC_OK : ASDIC_ERROR_ARGUMENT;
        asdic_status object = law.uses & ASDIC_LAW_OBJECT ? ASDIC_OK : ASDIC_ERROR_ARGUMENT;
        assert_status(t.ctx, asdic_scene_set_bottom_plane(scene, 12.0, m), bottom);
        assert_status(t.ctx, asdic_scene_add_bottom(scene, box, here, m), bottom);
        assert_status(t.ctx, asdic_scene_set_surface_law(scene, m), surface);
        assert_status(t.ctx, asdic_scene_add_object(scene, "a", box, here, m), object);
        assert_status(t.ctx, asdic_expected_compute(t.ctx, &flat, &env, &sonar, &here, ping),
                      bottom);
        assert_status(t.ctx, asdic_expected_compute(t.ctx, &up, &env, &sonar, &here, ping),
                      surface);
    }
    assert_status(
        t.ctx,
        asdic_scene_set_bottom_plane(scene, 12.0, asdic_material_of(asdic_law_find("course"))),
        ASDIC_ERROR_ARGUMENT);
    assert_contains(asdic_context_error(t.ctx), "course is no law of a bottom; those are ");
    asdic_ping_destroy(&ping);
    asdic_mesh_destroy(&box);
    asdic_scene_destroy(&scene);
}

static void numbers_beyond_limits_are_refused(void **state) {
    (void)state;
    static const double bad[] = {NAN, INFINITY, -INFINITY, -1.0, 1e300};
    asdic_scene *scene = scene_of(t.ctx);
    asdic_simulator *sim = NULL;
    asdic_ping *ping = NULL;
    asdic_mesh *mesh = NULL;
    asdic_beam one = beam();
    assert_ok(t.ctx, asdic_scene_commit(scene));
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        for (int field = 0; field < 4; field++) {
            asdic_sonar sonar = sonar_of(&one);
            double *const at[] = {&sonar.frequency_hz, &sonar.bandwidth_hz, &sonar.ping_rate_hz,
                                  &sonar.bin_length_m};
            *at[field] = bad[i];
            assert_status(t.ctx, asdic_sonar_check(t.ctx, &sonar), ASDIC_ERROR_ARGUMENT);
            assert_status(t.ctx, create(t.ctx, t.device, scene, &sonar, 64, 5.0, &sim),
                          ASDIC_ERROR_ARGUMENT);
            assert_null(sim);
        }
        assert_status(t.ctx, asdic_mesh_sphere(t.ctx, bad[i], 16, &mesh), ASDIC_ERROR_ARGUMENT);
        assert_status(t.ctx, asdic_mesh_box(t.ctx, (asdic_vec3){1.0, bad[i], 1.0}, &mesh),
                      ASDIC_ERROR_ARGUMENT);
        assert_null(mesh);
    }
    asdic_sonar sonar = sonar_of(&one);
    assert_status(t.ctx, create(t.ctx, t.device, scene, &sonar, 0, 5.0, &sim),
                  ASDIC_ERROR_ARGUMENT);
    assert_status(t.ctx, create(t.ctx, t.device, scene, &sonar, UINT32_MAX, 5.0, &sim),
                  ASDIC_ERROR_ARGUMENT);
    const double depths_m[] = {NAN, INFINITY, 3e286, -3e286, 11001.0};
    for (size_t i = 0; i < sizeof depths_m / sizeof *depths_m; i++) {
        assert_status(t.ctx, create(t.ctx, t.device, scene, &sonar, 64, depths_m[i], &sim),
                      ASDIC_ERROR_ARGUMENT);
    }
    assert_status(t.ctx, asdic_ping_create(t.ctx, 0, 1, &ping), ASDIC_ERROR_ARGUMENT);
    asdic_status status = asdic_ping_create(t.ctx, SIZE_MAX / 2, 3, &ping);
    assert_true(status == ASDIC_ERROR_ARGUMENT || status == ASDIC_ERROR_MEMORY);
    assert_null(ping);
    asdic_scene_destroy(&scene);
}

static void a_ping_that_does_not_fit_is_refused_and_the_next_works(void **state) {
    (void)state;
    asdic_scene *scene = scene_of(t.ctx);
    asdic_simulator *sim = NULL;
    asdic_ping *small = NULL, *right = NULL;
    asdic_beam one = beam();
    asdic_sonar sonar = sonar_of(&one);
    asdic_pose pose = {.position_m = {0.0, 0.0, 5.0}}, bad = {.position_m = {0.0, NAN, 5.0}};
    assert_ok(t.ctx, asdic_scene_commit(scene));
    assert_ok(t.ctx, create(t.ctx, t.device, scene, &sonar, 64, 5.0, &sim));
    size_t bins = asdic_simulator_bin_count(sim);
    assert_ok(t.ctx, asdic_ping_create(t.ctx, 1, bins - 1, &small));
    assert_ok(t.ctx, asdic_ping_create(t.ctx, 1, bins, &right));
    assert_status(t.ctx, asdic_simulator_ping(sim, &pose, 0, small), ASDIC_ERROR_ARGUMENT);
    assert_status(t.ctx, asdic_simulator_ping(sim, &bad, 0, right), ASDIC_ERROR_ARGUMENT);
    assert_status(t.ctx, asdic_simulator_learn(sim, &bad, 0), ASDIC_ERROR_ARGUMENT);
    asdic_pose deep = {.position_m = {0.0, 0.0, 11001.0}};
    assert_status(t.ctx, asdic_simulator_ping(sim, &deep, 0, right), ASDIC_ERROR_ARGUMENT);
    assert_contains(asdic_context_error(t.ctx), "11001 m, is out of range [-11000, 11000] m");
    assert_status(t.ctx, asdic_simulator_learn(sim, &deep, 0), ASDIC_ERROR_ARGUMENT);
    bad.position_m.y = 1e100; /* beyond float */
    assert_status(t.ctx, asdic_simulator_ping(sim, &bad, 0, right), ASDIC_ERROR_ARGUMENT);
    assert_status(t.ctx, asdic_simulator_learn(sim, &bad, 0), ASDIC_ERROR_ARGUMENT);
    assert_ok(t.ctx, asdic_simulator_ping(sim, &pose, 0, right));
    asdic_ping_destroy(&small);
    asdic_ping_destroy(&right);
    asdic_simulator_destroy(&sim);
    asdic_scene_destroy(&scene);
}

typedef struct lane {
    pthread_t thread;
    asdic_status status;
    double levels[THREAD_PINGS][BINS];
} lane;

/* Everything of its own, and a failure in between. */
static void *drive(void *argument) {
    lane *l = argument;
    asdic_context *ctx = NULL;
    asdic_device **devices = NULL;
    asdic_mission *none = NULL;
    asdic_simulator *sim = NULL;
    asdic_ping *ping = NULL;
    asdic_scene *scene = NULL;
    size_t count = 0;
    asdic_beam one = beam();
    asdic_sonar sonar = sonar_of(&one);
    l->status = asdic_context_create(&ctx);
    l->status =
        l->status ? l->status : asdic_devices_open(ctx, getenv("ASDIC_DEVICE"), &devices, &count);
    l->status = l->status ? l->status : asdic_scene_create(ctx, &scene);
    l->status = l->status ? l->status
                          : asdic_scene_set_bottom_plane(scene, 12.0, asdic_material_bottom(2.0));
    l->status = l->status ? l->status : asdic_scene_commit(scene);
    l->status = l->status ? l->status : create(ctx, devices[0], scene, &sonar, 2000, 5.0, &sim);
    if (l->status == ASDIC_OK) {
        l->status = asdic_ping_create(ctx, 1, asdic_simulator_bin_count(sim), &ping);
    }
    for (size_t i = 0; i < THREAD_PINGS && l->status == ASDIC_OK; i++) {
        asdic_pose pose = {.position_m = {(double)i, 0.0, 5.0}};
        if (asdic_mission_load(ctx, "/nonexistent/a.yaml", &none) != ASDIC_ERROR_INPUT) {
            l->status = ASDIC_ERROR_IO;
        }
        l->status = l->status ? l->status : asdic_simulator_ping(sim, &pose, i, ping);
        for (size_t bin = 0; bin < BINS && l->status == ASDIC_OK; bin++) {
            l->levels[i][bin] = ping->intensity_lin[ASDIC_TOTAL][bin];
        }
    }
    asdic_ping_destroy(&ping);
    asdic_simulator_destroy(&sim);
    asdic_scene_destroy(&scene);
    asdic_devices_close(&devices, count);
    asdic_context_destroy(&ctx);
    return NULL;
}

static void two_threads_with_a_context_each(void **state) {
    (void)state;
    static lane alone, lanes[2];
    drive(&alone);
    assert_int_equal(alone.status, ASDIC_OK);
    for (int i = 0; i < 2; i++) {
        assert_int_equal(pthread_create(&lanes[i].thread, NULL, drive, &lanes[i]), 0);
    }
    for (int i = 0; i < 2; i++) {
        pthread_join(lanes[i].thread, NULL);
        assert_int_equal(lanes[i].status, ASDIC_OK);
        assert_memory_equal(lanes[i].levels, alone.levels, sizeof alone.levels);
    }
}

int main(void) {
    t = test_device_open_or_skip();
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_scene_is_committed_once),
        cmocka_unit_test(laws_are_taken_for_their_uses),
        cmocka_unit_test(numbers_beyond_limits_are_refused),
        cmocka_unit_test(a_ping_that_does_not_fit_is_refused_and_the_next_works),
        cmocka_unit_test(two_threads_with_a_context_each),
    };
    return test_device_end(&t, cmocka_run_group_tests_name("order", tests, NULL, NULL));
}
