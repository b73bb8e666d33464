/* Every rule of a plan: a scene that needs the term keeps it; where the term is left out, the ping
 * changes by no more than the bound. */
#include "ping_rig.h"

#include <asdic/plan.h>

static test_device t;

static asdic_plan plan_of(ping_rig *r) {
    asdic_plan plan;
    r->sonar.receivers = r->receivers;
    if (!asdic_scene_get_info(r->scene).bvh_nodes) {
        asdic_scene_commit(r->scene);
    }
    assert_ok(t.ctx, asdic_plan_make(t.ctx, r->scene, &r->env, &r->sonar, &r->sampling, &r->pose, 1,
                                     &plan));
    return plan;
}

/* Largest change of a total when the plan is followed instead of modelling everything, less the
 * sampling error of both. */
static double change_db(ping_rig *r, const asdic_plan *plan) {
    r->sampling.left_out = 0;
    asdic_ping *all = rig_shoot(r, 0, true);
    r->sampling.left_out = plan->left_out;
    asdic_ping *planned = rig_shoot(r, 0, true);
    double most = 0.0;
    for (size_t i = 0; i < all->beams * all->bins; i++) {
        double a = all->intensity_lin[ASDIC_TOTAL][i], b = planned->intensity_lin[ASDIC_TOTAL][i];
        assert_true((a > 0.0) == (b > 0.0));
        if (a > 0.0) {
            double d = fabs(asdic_level_db(a) - asdic_level_db(b));
            most = fmax(most, d - 4.0 * (all->stderr_db[i] + planned->stderr_db[i]));
        }
    }
    asdic_ping_destroy(&all);
    asdic_ping_destroy(&planned);
    return most;
}

static void needed_terms_are_kept(void **state) {
    (void)state;
    ping_rig r = rig_create(&t);
    asdic_plan plan = plan_of(&r);
    assert_true(plan.rows[ASDIC_TERM_BOTTOM].kept);
    assert_true(plan.rows[ASDIC_TERM_SURFACE].kept);
    assert_true(plan.rows[ASDIC_TERM_VOLUME].kept);
    assert_false(plan.rows[ASDIC_TERM_OBJECTS].kept);
    assert_false(plan.rows[ASDIC_TERM_MULTIPATH].kept);
    assert_false(plan.rows[ASDIC_TERM_REAR].kept);
    r.sonar.noise_enabled = true;
    r.sonar.source_level_db = 200.0;
    r.sonar.rear_floor_db = -40.0;
    plan = plan_of(&r);
    assert_true(plan.rows[ASDIC_TERM_SURFACE].kept);
    assert_true(plan.rows[ASDIC_TERM_VOLUME].kept);
    assert_true(plan.rows[ASDIC_TERM_NOISE].kept);
    assert_true(plan.rows[ASDIC_TERM_REAR].kept);
    rig_destroy(&r);
}

/* A quiet source in noise: surface and water drown, and the level shows it. */
static void what_drowns_is_left_out(void **state) {
    (void)state;
    ping_rig r = rig_create(&t);
    r.sonar.noise_enabled = true;
    /* The largest source level at which both still go. */
    double low = 0.0, high = 200.0;
    for (int k = 0; k < 30; k++) {
        r.sonar.source_level_db = 0.5 * (low + high);
        asdic_plan plan = plan_of(&r);
        bool both = !plan.rows[ASDIC_TERM_SURFACE].kept && !plan.rows[ASDIC_TERM_VOLUME].kept;
        *(both ? &low : &high) = r.sonar.source_level_db;
    }
    r.sonar.source_level_db = low;
    asdic_plan plan = plan_of(&r);
    double bound = plan.rows[ASDIC_TERM_SURFACE].bound_db + plan.rows[ASDIC_TERM_VOLUME].bound_db;
    double change = change_db(&r, &plan);
    print_message("source level %.1f dB: bound %.2g dB, change %.2g dB\n", low, bound, change);
    assert_true(bound <= 2.0 * ASDIC_PLAN_NEGLIGIBLE_DB);
    assert_true(change <= bound);
    rig_destroy(&r);
}

static void what_lies_beyond_is_left_out(void **state) {
    (void)state;
    ping_rig r = rig_create(&t);
    asdic_scene_destroy(&r.scene);
    assert_ok(t.ctx, asdic_scene_create(t.ctx, &r.scene));
    assert_ok(t.ctx, asdic_scene_set_bottom_plane(r.scene, 505.0, asdic_material_bottom(2.0)));
    r.pose.position_m.z = 500.0;
    asdic_plan plan = plan_of(&r);
    assert_true(plan.rows[ASDIC_TERM_BOTTOM].kept);
    assert_false(plan.rows[ASDIC_TERM_SURFACE].kept);
    assert_true(plan.rows[ASDIC_TERM_SURFACE].bound_db == 0.0);
    assert_true(change_db(&r, &plan) <= 0.0);
    r.pose.position_m.z = 250.0;
    plan = plan_of(&r);
    assert_false(plan.rows[ASDIC_TERM_BOTTOM].kept);
    assert_true(plan.rows[ASDIC_TERM_BOTTOM].bound_db == 0.0);
    rig_destroy(&r);
}

static void objects_count_where_they_reach(void **state) {
    (void)state;
    static const struct {
        double x_m, impedance_mrayl;
        bool objects, multipath;
    } cases[] = {
        {30.0, 45.0, true, true}, {30.0, 1.5274, true, false}, {300.0, 45.0, false, false}};
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        ping_rig r = rig_create(&t);
        asdic_mesh *mesh = NULL;
        assert_ok(t.ctx, asdic_mesh_box(t.ctx, (asdic_vec3){1.0, 1.0, 1.0}, &mesh));
        asdic_pose pose = {.position_m = {cases[k].x_m, 0.0, 9.0}};
        asdic_material material = asdic_material_facet(cases[k].impedance_mrayl, 1e-3, 0.1);
        assert_ok(t.ctx, asdic_scene_add_object(r.scene, "box", mesh, pose, material));
        asdic_mesh_destroy(&mesh);
        asdic_plan plan = plan_of(&r);
        assert_int_equal(plan.rows[ASDIC_TERM_OBJECTS].kept, cases[k].objects);
        assert_int_equal(plan.rows[ASDIC_TERM_MULTIPATH].kept, cases[k].multipath);
        assert_true(change_db(&r, &plan) <= 0.0);
        rig_destroy(&r);
    }
}

int main(void) {
    t = test_device_open_or_skip();
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(needed_terms_are_kept),
        cmocka_unit_test(what_drowns_is_left_out),
        cmocka_unit_test(what_lies_beyond_is_left_out),
        cmocka_unit_test(objects_count_where_they_reach),
    };
    int failed = cmocka_run_group_tests(tests, NULL, NULL);
    test_device_close(&t);
    return failed;
}
