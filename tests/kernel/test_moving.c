/*
 * Objects that move between pings, against scenes built anew with the objects there.
 */
#include "ping_rig.h"

#include "base/vec.h"

#include <math.h>

static test_device t;

/* A bumpy bottom that is wider than anything else, so that the scene's box never changes. */
static asdic_mesh *bumpy_bottom(void) {
    enum { SIDE = 24 };
    double v[(SIDE + 1) * (SIDE + 1) * 3];
    uint32_t index[SIDE * SIDE * 6];
    size_t n = 0;
    for (int i = 0; i < (SIDE + 1) * (SIDE + 1); i++) {
        int x = i / (SIDE + 1), y = i % (SIDE + 1);
        v[3 * i] = 10.0 * (x - SIDE / 2);
        v[3 * i + 1] = 10.0 * (y - SIDE / 2);
        v[3 * i + 2] = (x + y) % SIDE == 3 ? 0.5 : 11.0 + sin(0.9 * x) * cos(0.7 * y);
    }
    for (uint32_t i = 0; i < SIDE * SIDE; i++) {
        uint32_t a = i / SIDE * (SIDE + 1) + i % SIDE, b = a + SIDE + 1;
        const uint32_t corners[6] = {a, b, a + 1, b, b + 1, a + 1};
        for (int k = 0; k < 6; k++) {
            index[n++] = corners[k];
        }
    }
    asdic_mesh *mesh = NULL;
    assert_ok(t.ctx, asdic_mesh_from_triangles(t.ctx, v, (SIDE + 1) * (SIDE + 1), index,
                                               2 * SIDE * SIDE, &mesh));
    return mesh;
}

/* What a test puts in the water: the pose of each object, and of one point. */
#define MOST 24
typedef struct cast {
    int objects;
    bool spheres; /* else boxes, which stay flat */
    asdic_pose at[MOST];
    asdic_vec3 point;
} cast;

static const char *name_of(int i) {
    static char name[24];
    snprintf(name, sizeof name, "object%d", i);
    return name;
}

static void add_object(asdic_scene *scene, const cast *c, int i, bool moving) {
    asdic_mesh *mesh = NULL;
    asdic_status status = c->spheres
                              ? asdic_mesh_sphere(t.ctx, 1.0 + 0.1 * i, 24, &mesh)
                              : asdic_mesh_box(t.ctx, (asdic_vec3){1.0 + 0.1 * i, 2.0, 1.5}, &mesh);
    assert_ok(t.ctx, status);
    asdic_material steel = asdic_material_facet(45.0, 1e-3, 0.1);
    status = moving ? asdic_scene_add_moving_object(scene, name_of(i), mesh, c->at[i], steel)
                    : asdic_scene_add_object(scene, name_of(i), mesh, c->at[i], steel);
    assert_ok(t.ctx, status);
    asdic_mesh_destroy(&mesh);
}

/* BOTTOM: with a mesh; else nothing but the objects. */
static ping_rig cast_rig(const cast *c, bool moving, bool bottom) {
    ping_rig r = rig_create(&t);
    r.sampling.rays = 4096;
    if (bottom) {
        asdic_mesh *mesh = bumpy_bottom();
        assert_ok(t.ctx, asdic_scene_add_bottom(r.scene, mesh, (asdic_pose){{0, 0, 0}, 0, 0, 0},
                                                asdic_material_bottom(2.0)));
        asdic_mesh_destroy(&mesh);
    }
    for (int i = 0; i < c->objects; i++) {
        add_object(r.scene, c, i, moving);
    }
    assert_ok(t.ctx, asdic_scene_add_point(r.scene, "buoy", c->point, -10.0));
    return r;
}

static asdic_ping *shoot(asdic_simulator *sim, const ping_rig *r) {
    asdic_ping *ping = rig_ping(r, sim);
    assert_ok(t.ctx, asdic_simulator_learn(sim, &r->pose, 0));
    assert_ok(t.ctx, asdic_simulator_ping(sim, &r->pose, 0, ping));
    return ping;
}

static void move_all(asdic_simulator *sim, const cast *c) {
    for (int i = 0; i < c->objects; i++) {
        assert_ok(t.ctx, asdic_simulator_move(sim, name_of(i), &c->at[i]));
    }
    asdic_pose buoy = {.position_m = c->point};
    assert_ok(t.ctx, asdic_simulator_move(sim, "buoy", &buoy));
}

/* Ahead of the sonar, spread out, turned by TURN_RAD each. */
static cast spread_cast(int objects, bool spheres, double first_m, double turn_rad) {
    cast c = {.objects = objects, .spheres = spheres, .point = {first_m + 2.0, 1.0, 6.0}};
    for (int i = 0; i < objects; i++) {
        c.at[i] = (asdic_pose){.position_m = {first_m + 3.5 * i, (i % 5 - 2) * 1.25, 5.0 + i % 4},
                               .roll_rad = 0.3 * turn_rad * i,
                               .pitch_rad = -0.2 * turn_rad,
                               .yaw_rad = turn_rad * (i + 1)};
    }
    return c;
}

/* Largest difference of levels above -150 dB, all components. */
static double largest_db(const asdic_ping *a, const asdic_ping *b) {
    double most = 0.0;
    for (size_t i = 0; i < a->beams * a->bins; i++) {
        for (int c = 0; c < ASDIC_NOISE; c++) {
            double x = a->intensity_lin[c][i], y = b->intensity_lin[c][i];
            if (x > 1e-15 || y > 1e-15) {
                most = fmax(most, fabs(10.0 * log10((x + 1e-18) / (y + 1e-18))));
            }
        }
    }
    return most;
}

/* Moves from FROM to TO and back; pings there against scenes built there. TOLERANCE_DB 0: the same
 * bytes. */
static void moving_meets_building(const cast *from, const cast *to, bool bottom,
                                  double tolerance_db) {
    ping_rig moving = cast_rig(from, true, bottom), there = cast_rig(to, false, bottom);
    ping_rig here = cast_rig(from, false, bottom);
    asdic_simulator *sim = rig_simulator(&moving);
    asdic_simulator *other = rig_simulator(&moving); /* sees the same scene, at another time */
    asdic_ping *before = shoot(sim, &moving);
    move_all(sim, to);
    asdic_ping *moved = shoot(sim, &moving), *still = shoot(other, &moving);
    asdic_ping *built = rig_shoot(&there, 0, true), *first = rig_shoot(&here, 0, true);
    assert_false(rig_same(before, moved)); /* the move shows */
    assert_true(rig_same(before, still));
    double from_db = largest_db(before, first), to_db = largest_db(moved, built);
    print_message("%d objects: %.2g dB before, %.2g dB after the move\n", from->objects, from_db,
                  to_db);
    if (tolerance_db == 0.0) {
        assert_true(rig_same(before, first));
        assert_true(rig_same(moved, built));
    }
    assert_true(from_db <= tolerance_db && to_db <= tolerance_db);
    asdic_ping_destroy(&still);
    move_all(sim, from);
    still = shoot(sim, &moving);
    assert_true(rig_same(before, still)); /* and back */
    asdic_ping *all[] = {before, moved, still, built, first};
    for (size_t i = 0; i < sizeof all / sizeof *all; i++) {
        asdic_ping_destroy(&all[i]);
    }
    asdic_simulator_destroy(&other);
    asdic_simulator_destroy(&sim);
    rig_destroy(&here);
    rig_destroy(&there);
    rig_destroy(&moving);
}

static void boxes_over_a_bottom_give_the_same_bytes(void **state) {
    (void)state;
    cast from = spread_cast(3, false, 14.0, 0.0), to = spread_cast(3, false, 21.5, 0.4);
    moving_meets_building(&from, &to, true, 0.0);
}

static void crowds_give_the_same_bytes(void **state) {
    (void)state;
    cast from = spread_cast(MOST, false, 8.0, 0.1), to = spread_cast(MOST, false, 12.25, 1.3);
    moving_meets_building(&from, &to, true, 0.0);
}

static void turned_spheres_agree(void **state) {
    (void)state;
    cast from = spread_cast(4, true, 14.0, 0.2), to = spread_cast(4, true, 18.0, 1.1);
    moving_meets_building(&from, &to, true, 1e-3);
}

static void nothing_has_to_stay(void **state) {
    (void)state;
    cast from = spread_cast(2, false, 14.0, 0.2), to = spread_cast(2, false, 40.0, -0.7);
    moving_meets_building(&from, &to, false, 1e-3);
}

/* On another part of the globe, sonar, objects and all, whole steps of the frame away (scene/placement.h), and back. */
static void far_from_where_they_were_built_shapes_stay(void **state) {
    (void)state;
    cast near = spread_cast(3, true, 14.0, 0.3), far = near;
    ping_rig r = cast_rig(&near, true, false);
    const asdic_pose start = r.pose;
    const asdic_vec3 off = {600 * 8192.0, -70 * 8192.0, 0.0};
    r.pose.position_m = asdic_vec3_add(r.pose.position_m, off);
    far.point = asdic_vec3_add(far.point, off);
    for (int i = 0; i < far.objects; i++) {
        far.at[i].position_m = asdic_vec3_add(far.at[i].position_m, off);
    }
    asdic_simulator *sim = rig_simulator(&r);
    move_all(sim, &far);
    asdic_ping *there = shoot(sim, &r);
    r.pose = start;
    move_all(sim, &near);
    asdic_ping *back = shoot(sim, &r), *here = rig_shoot(&r, 0, true);
    double db = largest_db(here, there);
    print_message("%.2g dB at 4,900 km\n", db);
    assert_true(db <= 1e-3);
    assert_true(rig_same(here, back));
    asdic_ping_destroy(&there);
    asdic_ping_destroy(&back);
    asdic_ping_destroy(&here);
    asdic_simulator_destroy(&sim);
    rig_destroy(&r);
}

static void mistakes_are_told(void **state) {
    (void)state;
    cast c = spread_cast(1, false, 14.0, 0.0);
    ping_rig moving = cast_rig(&c, true, true), fixed = cast_rig(&c, false, true);
    asdic_simulator *sim = rig_simulator(&moving), *still = rig_simulator(&fixed);
    asdic_pose pose = c.at[0], bad = c.at[0];
    bad.position_m.y = NAN;
    assert_int_equal(asdic_simulator_move(sim, "nobody", &pose), ASDIC_ERROR_ARGUMENT);
    assert_non_null(strstr(asdic_context_error(t.ctx), "nobody"));
    assert_int_equal(asdic_simulator_move(sim, "", &pose), ASDIC_ERROR_ARGUMENT);
    assert_int_equal(asdic_simulator_move(sim, "object0", &bad), ASDIC_ERROR_ARGUMENT);
    assert_int_equal(asdic_simulator_move(sim, "object0", NULL), ASDIC_ERROR_ARGUMENT);
    assert_int_equal(asdic_simulator_move(still, "object0", &pose), ASDIC_ERROR_ARGUMENT);
    assert_non_null(strstr(asdic_context_error(t.ctx), "not added as a moving one"));
    asdic_simulator_destroy(&still);
    asdic_simulator_destroy(&sim);
    rig_destroy(&fixed);
    rig_destroy(&moving);
}

/* Of a point and an object of one name that moves, the first added is the one that is meant: moved away, it takes its
 * echo along. */
static void the_first_of_a_name_is_moved(void **state) {
    (void)state;
    for (int point_first = 0; point_first < 2; point_first++) {
        ping_rig r = rig_create(&t);
        asdic_mesh *box = NULL;
        asdic_ping *ping = NULL;
        const asdic_pose there = {.position_m = {20.0, 0.0, 7.0}},
                         away = {{5e3, 0.0, 7.0}, 0, 0, 0};
        rig_empty(&r);
        assert_ok(t.ctx, asdic_mesh_box(t.ctx, (asdic_vec3){1.0, 1.0, 1.0}, &box));
        asdic_material steel = asdic_material_facet(45.0, 1e-3, 0.1);
        for (int k = 0; k < 2; k++) {
            assert_ok(t.ctx,
                      k == !point_first
                          ? asdic_scene_add_point(r.scene, "twin", there.position_m, 0.0)
                          : asdic_scene_add_moving_object(r.scene, "twin", box, there, steel));
        }
        assert_ok(t.ctx, asdic_scene_commit(r.scene));
        r.sampling.truth = true;
        asdic_simulator *sim = rig_simulator(&r);
        assert_ok(t.ctx, asdic_ping_create(t.ctx, r.sonar.receiver_count,
                                           asdic_simulator_bin_count(sim), &ping));
        assert_ok(t.ctx, asdic_ping_add_truth(t.ctx, ping));
        assert_ok(t.ctx, asdic_simulator_move(sim, "twin", &away));
        assert_ok(t.ctx, asdic_simulator_ping(sim, &r.pose, 0, ping));
        bool first = false, second = false;
        for (size_t i = 0; i < ping->beams * ping->bins; i++) {
            first |= ping->truth->object[i] == 1;
            second |= ping->truth->object[i] == 2;
        }
        assert_false(first);
        assert_true(second);
        asdic_ping_destroy(&ping);
        asdic_simulator_destroy(&sim);
        asdic_mesh_destroy(&box);
        rig_destroy(&r);
    }
}

/* Through layers of water a tracer keeps a body's copy for each of them apart: also of a bar that lay level when the
 * scene was built, and then leans, with a sonar 3 m deep that looks at it across ten of them. */
static void what_rises_through_layers_is_met_once(void **state) {
    (void)state;
    const asdic_pose level = {.position_m = {30.0, 0.0, 10.0}};
    const asdic_pose leaning = {.position_m = {30.0, 0.0, 6.0}, .pitch_rad = 0.7};
    double energy[2][2000] = {{0.0}}, sum = 0.0, off = 0.0;
    for (int moves = 0; moves < 2; moves++) {
        ping_rig r = rig_create(&t);
        asdic_mesh *bar = NULL;
        asdic_sound_profile *water = &r.env.sound_speed_profile;
        r.sampling.rays = 1 << 15;
        r.sampling.multipath = ASDIC_MULTIPATH_OFF;
        r.pose.position_m.z = 3.0;
        r.sonar.bin_length_m = 0.25;
        water->points = 12;
        for (int i = 0; i < 12; i++) {
            water->depth_m[i] = i;
            water->sound_speed_mps[i] = 1490.0 + 1e-3 * (i % 2);
        }
        assert_ok(t.ctx, asdic_mesh_box(t.ctx, (asdic_vec3){10.0, 1.0, 1.0}, &bar));
        asdic_material white = asdic_material_bottom(2.0);
        assert_ok(t.ctx, moves ? asdic_scene_add_moving_object(r.scene, "bar", bar, level, white)
                               : asdic_scene_add_object(r.scene, "bar", bar, leaning, white));
        assert_ok(t.ctx, asdic_scene_commit(r.scene));
        asdic_simulator *sim = rig_simulator(&r);
        if (moves) {
            assert_ok(t.ctx, asdic_simulator_move(sim, "bar", &leaning));
        }
        asdic_ping *ping = shoot(sim, &r);
        assert_in_range(ping->bins, 200, 2000);
        for (size_t n = 0; n < ping->bins; n++) {
            energy[moves][n] = ping->intensity_lin[ASDIC_OBJECT][n];
        }
        asdic_ping_destroy(&ping);
        asdic_simulator_destroy(&sim);
        asdic_mesh_destroy(&bar);
        rig_destroy(&r);
    }
    for (int n = 0; n < 2000; n++) {
        sum += energy[0][n];
        off += fabs(energy[1][n] - energy[0][n]);
    }
    print_message("a bar that rose: %.2g of its energy elsewhere\n", off / sum);
    assert_true(sum > 0.0 && off < 0.03 * sum);
}

int main(void) {
    t = test_device_open_or_skip();
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(boxes_over_a_bottom_give_the_same_bytes),
        cmocka_unit_test(crowds_give_the_same_bytes),
        cmocka_unit_test(turned_spheres_agree),
        cmocka_unit_test(nothing_has_to_stay),
        cmocka_unit_test(far_from_where_they_were_built_shapes_stay),
        cmocka_unit_test(mistakes_are_told),
        cmocka_unit_test(the_first_of_a_name_is_moved),
        cmocka_unit_test(what_rises_through_layers_is_met_once),
    };
    return test_device_end(&t, cmocka_run_group_tests(tests, NULL, NULL));
}
