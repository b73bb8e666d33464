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

static void what_lies_beyond_is_left_out(void **state) {
    (void)state;
    ping_rig r = rig_create(&t);
    rig_empty(&r);
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
    assert_true(change_db(&r, &plan) <= 0.0);
    rig_destroy(&r);
}

/* A steel box of 1 m, 9 m deep, X ahead and Y to starboard. */
static ping_rig box_rig(double x_m, double y_m, double impedance_mrayl) {
    ping_rig r = rig_create(&t);
    asdic_mesh *mesh = NULL;
    assert_ok(t.ctx, asdic_mesh_box(t.ctx, (asdic_vec3){1.0, 1.0, 1.0}, &mesh));
    asdic_pose pose = {.position_m = {x_m, y_m, 9.0}};
    asdic_material material = asdic_material_facet(impedance_mrayl, 1e-3, 0.1);
    assert_ok(t.ctx, asdic_scene_add_object(r.scene, "box", mesh, pose, material));
    asdic_mesh_destroy(&mesh);
    return r;
}

static void objects_count_where_they_reach(void **state) {
    (void)state;
    static const struct {
        double x_m, y_m, impedance_mrayl;
        bool objects, multipath;
    } cases[] = {{30.0, 0.0, 45.0, true, true},
                 {30.0, 0.0, 1.5274, true, false},
                 {300.0, 0.0, 45.0, false, false},   /* beyond the range */
                 {-30.0, 5.0, 1.5274, false, false}, /* behind the faces */
                 {-30.0, 5.0, 45.0, true, true}};    /* there too, but reflecting to the front */
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        ping_rig r = box_rig(cases[k].x_m, cases[k].y_m, cases[k].impedance_mrayl);
        asdic_plan plan = plan_of(&r);
        assert_int_equal(plan.rows[ASDIC_TERM_OBJECTS].kept, cases[k].objects);
        assert_int_equal(plan.rows[ASDIC_TERM_MULTIPATH].kept, cases[k].multipath);
        assert_true(cases[k].objects || plan.rows[ASDIC_TERM_OBJECTS].bound_db == 0.0);
        assert_true(change_db(&r, &plan) <= 0.0);
        if (!cases[k].objects && cases[k].x_m < 0.0) { /* a leak backwards brings it back */
            r.sonar.rear_floor_db = -40.0;
            assert_true(plan_of(&r).rows[ASDIC_TERM_OBJECTS].kept);
        }
        rig_destroy(&r);
    }
}

/* Amid slow water the range of a bin is shorter than the way through faster water that it is heard over: the surface
 * and a ball 94 m away are heard at less than 93 m. */
static void what_fast_water_brings_near_is_kept(void **state) {
    (void)state;
    ping_rig r = rig_create(&t);
    asdic_mesh *mesh = NULL;
    rig_empty(&r);
    assert_ok(t.ctx, asdic_mesh_sphere(t.ctx, 1.0, 96, &mesh));
    assert_ok(t.ctx, asdic_scene_add_object(r.scene, "ball", mesh,
                                            (asdic_pose){.position_m = {8.0, 0.0, 1.5}},
                                            asdic_material_facet(45.0, 1e-3, 0.1)));
    asdic_mesh_destroy(&mesh);
    r.env.max_depth_m = NAN;
    r.env.sound_speed_profile =
        (asdic_sound_profile){3, {0.0, 20.0, 60.0}, {1500.0, 1500.0, 1400.0}};
    r.pose.position_m.z = 93.5;
    r.sonar.max_range_m = 93.0;
    r.sonar.ping_rate_hz = 5.0;
    r.sonar.transmitter.pitch_rad = r.receivers[0].pitch_rad = -90.0 * RIG_DEGREE;
    asdic_plan plan = plan_of(&r);
    assert_true(plan.rows[ASDIC_TERM_SURFACE].kept && plan.rows[ASDIC_TERM_OBJECTS].kept);
    r.sonar.max_range_m = 80.0;
    plan = plan_of(&r);
    assert_false(plan.rows[ASDIC_TERM_SURFACE].kept || plan.rows[ASDIC_TERM_OBJECTS].kept);
    assert_true(change_db(&r, &plan) <= 0.0);
    rig_destroy(&r);
}

/* Largest source level at which TERM goes, within 0 .. 250 dB. */
static double drown(ping_rig *r, asdic_term term) {
    double low = 0.0, high = 250.0;
    r->sonar.noise_enabled = true;
    for (int k = 0; k < 30; k++) {
        r->sonar.source_level_db = 0.5 * (low + high);
        *(plan_of(r).rows[term].kept ? &high : &low) = r->sonar.source_level_db;
    }
    r->sonar.source_level_db = low;
    return low;
}

/* What comes from reflections, the object itself, surface or water goes where the noise hides it, and not a
 * decibel later. */
static void what_drowns_is_left_out(void **state) {
    (void)state;
    static const asdic_term terms[] = {ASDIC_TERM_MULTIPATH, ASDIC_TERM_OBJECTS, ASDIC_TERM_SURFACE,
                                       ASDIC_TERM_VOLUME};
    for (size_t k = 0; k < sizeof terms / sizeof *terms; k++) {
        ping_rig r = box_rig(30.0, 0.0, 45.0);
        double level_db = drown(&r, terms[k]);
        asdic_plan plan = plan_of(&r);
        double bound = 0.0;
        for (int i = 0; i < ASDIC_TERM_COUNT; i++) {
            const asdic_plan_row *row = &plan.rows[i];
            bound += row->kept || i == ASDIC_TERM_NOISE ? 0.0 : row->bound_db;
        }
        double change = change_db(&r, &plan);
        print_message("%s gone at %.1f dB: bound %.2g dB, change %.2g dB\n",
                      plan.rows[terms[k]].name, level_db, bound, change);
        assert_true(level_db > 1.0);
        assert_false(plan.rows[terms[k]].kept);
        assert_true(plan.rows[terms[k]].bound_db <= ASDIC_PLAN_NEGLIGIBLE_DB);
        assert_true(change <= bound);
        r.sonar.source_level_db = level_db + 1.0;
        assert_true(plan_of(&r).rows[terms[k]].kept);
        r.sonar.source_level_db = 180.0; /* left out all the same, it is missed */
        plan.left_out = 1u << terms[k];
        assert_true(change_db(&r, &plan) > 0.01);
        rig_destroy(&r);
    }
}

/* A bound on the water's energy is proportional to the transmitter's solid angle. Of a line of N wavelengths, upright or
 * level, that is pi times the integral of sinc^2(N u) over -1 <= u <= 1: from pi (1 - 1 / (pi^2 N)) / N for whole N
 * to 2 pi for a point. */
static void a_fan_of_water_is_bounded(void **state) {
    (void)state;
    static const double lengths_wl[3][2] = {{0.01, 0.01}, {20.0, 0.01}, {0.01, 20.0}};
    ping_rig r = rig_create(&t);
    double energies[3];
    r.sonar.noise_enabled = true;
    r.sonar.source_level_db = 200.0;
    double wavelength_m =
        asdic_environment_sound_speed_mps(&r.env, r.pose.position_m.z) / r.sonar.frequency_hz;
    for (int k = 0; k < 3; k++) {
        r.sonar.transmitter.length_h_m = lengths_wl[k][0] * wavelength_m;
        r.sonar.transmitter.length_v_m = lengths_wl[k][1] * wavelength_m;
        double bound_db = plan_of(&r).rows[ASDIC_TERM_VOLUME].bound_db;
        assert_true(bound_db > 1e-6);
        energies[k] = pow(10.0, 0.1 * bound_db) - 1.0;
    }
    double wanted = (1.0 - 1.0 / (M_PI * M_PI * 20.0)) / 40.0;
    for (int k = 1; k < 3; k++) {
        assert_float_equal(energies[k] / energies[0] / wanted, 1.0, 2e-3);
    }
    rig_destroy(&r);
}

/* Boric acid goes where it takes less than the bound from any level, at high frequencies and short
 * ranges; what is left out then is really missing. */
static void boric_acid_goes_at_short_range(void **state) {
    (void)state;
    ping_rig r = rig_create(&t);
    assert_true(plan_of(&r).rows[ASDIC_TERM_BORIC_ACID].kept);
    r.sonar.frequency_hz = 450e3;
    r.sonar.ping_rate_hz = 200.0;
    r.sonar.bin_length_m = 0.1;
    asdic_plan plan = plan_of(&r);
    double bound = plan.rows[ASDIC_TERM_BORIC_ACID].bound_db;
    assert_false(plan.rows[ASDIC_TERM_BORIC_ACID].kept);
    assert_true(bound > 0.0 && bound <= ASDIC_PLAN_NEGLIGIBLE_DB);
    asdic_ping *all = rig_shoot(&r, 0, true);
    r.sampling.left_out = 1u << ASDIC_TERM_BORIC_ACID;
    asdic_ping *without = rig_shoot(&r, 0, true);
    double most = 0.0;
    for (size_t i = 0; i < all->beams * all->bins; i++) {
        double a = all->intensity_lin[ASDIC_TOTAL][i], b = without->intensity_lin[ASDIC_TOTAL][i];
        most = a > 0.0 ? fmax(most, fabs(asdic_level_db(b) - asdic_level_db(a))) : most;
    }
    print_message("boric acid: bound %.2g dB, change %.2g dB\n", bound, most);
    assert_true(most > 0.1 * bound && most <= bound);
    asdic_ping_destroy(&all);
    asdic_ping_destroy(&without);
    rig_destroy(&r);
}

/* Many pings over a flat scene: the quadrature, whose pings agree with rays within what these state,
 * and are the same on any heading and in any order. One ping, or a thing in the water: rays. */
static void flat_scenes_need_no_rays(void **state) {
    (void)state;
    enum { COUNT = 200 };
    ping_rig r = rig_create(&t);
    asdic_pose poses[COUNT] = {{.position_m = {0}}};
    asdic_plan plan;
    r.sonar.receiver_count = 1;
    assert_true(plan_of(&r).rows[ASDIC_TERM_RAYS].kept);
    for (int k = 0; k < COUNT; k++) {
        poses[k] = r.pose;
        poses[k].position_m.x = k;
        poses[k].yaw_rad = 0.01 * k;
        poses[k].position_m.z = k % 2 ? 7.0 : 7.4;
    }
    assert_ok(t.ctx,
              asdic_plan_make(t.ctx, r.scene, &r.env, &r.sonar, &r.sampling, poses, COUNT, &plan));
    assert_false(plan.rows[ASDIC_TERM_RAYS].kept);
    r.sampling.rays = 65536;
    assert_true(change_db(&r, &plan) < 0.02);

    r.sampling.left_out = plan.left_out;
    asdic_simulator *sim = rig_simulator(&r);
    asdic_ping *first = NULL, *again = NULL;
    assert_ok(t.ctx, asdic_ping_create(t.ctx, 1, asdic_simulator_bin_count(sim), &first));
    assert_ok(t.ctx, asdic_ping_create(t.ctx, 1, asdic_simulator_bin_count(sim), &again));
    assert_ok(t.ctx, asdic_simulator_ping(sim, &poses[3], 3, first));
    assert_ok(t.ctx, asdic_simulator_ping(sim, &poses[2], 2, again));
    assert_false(rig_same(first, again));
    asdic_simulator_destroy(&sim);
    sim = rig_simulator(&r);
    assert_ok(t.ctx, asdic_simulator_ping(sim, &poses[5], 5, again));
    assert_true(rig_same(first, again));
    assert_true(again->rays == 0);
    asdic_ping_destroy(&first);
    asdic_ping_destroy(&again);
    asdic_simulator_destroy(&sim);
    for (int k = 0; k < COUNT; k++) {
        poses[k].pitch_rad = 1e-3 * k;
    }
    assert_ok(t.ctx,
              asdic_plan_make(t.ctx, r.scene, &r.env, &r.sonar, &r.sampling, poses, COUNT, &plan));
    assert_true(plan.rows[ASDIC_TERM_RAYS].kept);
    rig_destroy(&r);
}

int main(void) {
    t = test_device_open_or_skip();
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(needed_terms_are_kept),
        cmocka_unit_test(what_lies_beyond_is_left_out),
        cmocka_unit_test(objects_count_where_they_reach),
        cmocka_unit_test(what_fast_water_brings_near_is_kept),
        cmocka_unit_test(what_drowns_is_left_out),
        cmocka_unit_test(a_fan_of_water_is_bounded),
        cmocka_unit_test(boric_acid_goes_at_short_range),
        cmocka_unit_test(flat_scenes_need_no_rays),
    };
    return test_device_end(&t, cmocka_run_group_tests(tests, NULL, NULL));
}
