/*
 * Pings in water whose sound speed changes evenly with depth: against quadrature that follows rays by itself,
 * over planes and over meshes, and against straight rays where they hardly bend. With the argument "full" in more layouts.
 */
#include "bent_rig.h"

#include "scene/scene.h"

#include <string.h>

static bool full;

static void pings_meet_quadrature(void **state) {
    static const double gradients[] = {0.016, -0.2, 0.2, -1.0, 1.0};
    static const asdic_component each[] = {ASDIC_BOTTOM, ASDIC_SURFACE, ASDIC_VOLUME};
    (void)state;
    for (size_t k = 0; k < sizeof gradients / sizeof *gradients; k++) {
        difference d[2], part[3];
        asdic_ping *truth = NULL;
        for (int many = 0; many < 2; many++) {
            ping_rig r = bent_rig(gradients[k], many ? 1u << 18 : 4096u);
            asdic_ping *ping = rig_shoot(&r, 0, true);
            truth = truth ? truth : expected(&r, ping); /* whatever the rays */
            d[many] = compare(ping, truth, ASDIC_TOTAL);
            for (int c = 0; c < 3; c++) {
                part[c] = compare(ping, truth, each[c]);
            }
            asdic_ping_destroy(&ping);
            rig_destroy(&r);
        }
        asdic_ping_destroy(&truth);
        print_message("%6.3f 1/s: r.m.s. %.4f dB of 4,096 rays; of 262,144 %.4f, bottom %.4f, "
                      "surface %.4f, volume %.4f\n",
                      gradients[k], d[0].rms_db, d[1].rms_db, part[0].rms_db, part[1].rms_db,
                      part[2].rms_db);
        assert_true(d[0].rms_db < 0.06 && d[0].most_db < 0.8);
        assert_true(d[1].rms_db < 0.004 && d[1].most_db < 0.05);
        assert_true(part[0].rms_db < 0.01 && part[1].rms_db < 0.02 && part[2].rms_db < 0.006);
    }
}

/* The sonar's heights near the planes: grazing rays, turning ones, ones that never come to a plane. */
static void high_and_low_sonars_meet_quadrature(void **state) {
    static const double depths[] = {0.6, 11.4};
    (void)state;
    for (int k = 0; k < 4; k++) {
        ping_rig r = bent_rig(k % 2 ? 0.5 : -0.5, 1u << 16);
        r.pose.position_m.z = depths[k / 2];
        r.env.max_depth_m = NAN;
        asdic_ping *ping = rig_shoot(&r, 0, true), *truth = expected(&r, ping);
        difference d = compare(ping, truth, ASDIC_TOTAL);
        print_message("at %4.1f m, %4.1f 1/s: r.m.s. %.4f dB, most %.3f\n", depths[k / 2],
                      k % 2 ? 0.5 : -0.5, d.rms_db, d.most_db);
        assert_true(d.rms_db < 0.03 && d.most_db < 0.4);
        asdic_ping_destroy(&truth);
        asdic_ping_destroy(&ping);
        rig_destroy(&r);
    }
}

/* The last bin that a plane's echo fills to a tenth at least, where rays that bend away graze it. */
static size_t end_of_reach(const asdic_ping *truth, asdic_component c) {
    size_t last = truth->bins - 1;
    while (truth->intensity_lin[c][last] < 0.1 * truth->intensity_lin[c][last - 1] ||
           truth->intensity_lin[c][last - 1] <= 0.0) {
        last--;
    }
    return last;
}

/* The sine of a grazing angle there is a small difference of what is rounded. */
static void reaches_end_as_loud_as_expected(void **state) {
    static const struct {
        double depth_m, gradient_per_s;
        asdic_component plane;
    } cases[] = {
        {11.0, 4.0, ASDIC_BOTTOM},  {11.0, 13.0, ASDIC_BOTTOM},  {9.0, 4.0, ASDIC_BOTTOM},
        {1.0, -4.0, ASDIC_SURFACE}, {1.0, -13.0, ASDIC_SURFACE}, {3.0, -8.0, ASDIC_SURFACE},
    };
    enum { PINGS = 8 };
    (void)state;
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        ping_rig r = bent_rig(cases[k].gradient_per_s, 16384u);
        r.pose.position_m.z = cases[k].depth_m;
        double most_db = 0.0, mean = 0.0;
        size_t last = 0;
        for (uint64_t i = 0; i < PINGS; i++) {
            asdic_ping *ping = rig_shoot(&r, ASDIC_LEARN_BLOCK * i, true),
                       *truth = expected(&r, ping);
            last = end_of_reach(truth, cases[k].plane);
            double ratio = ping->intensity_lin[cases[k].plane][last] /
                           truth->intensity_lin[cases[k].plane][last];
            most_db = fmax(most_db, fabs(asdic_level_db(ratio)));
            mean += ratio / PINGS;
            asdic_ping_destroy(&truth);
            asdic_ping_destroy(&ping);
        }
        print_message(
            "at %4.1f m, %5.1f 1/s: the reach ends in bin %zu, mean %+.3f dB, most %.3f\n",
            cases[k].depth_m, cases[k].gradient_per_s, last, asdic_level_db(mean), most_db);
        assert_true(fabs(asdic_level_db(mean)) < 0.06 && most_db < 0.2);
        rig_destroy(&r);
    }
}

/* A sonar in water of one speed, with layers below that end its reach: rays that hardly differ in elevation bring the
 * last bins. Laid out by a bend that is fitted to the sound speed they were missing there, by up to 26 dB. */
static void layers_end_reaches_as_loud_as_expected(void **state) {
    static const struct {
        double depth_m;
        asdic_sound_profile water;
    } cases[] = {
        {11.2, {3, {0.0, 11.3, 12.0}, {1500.0, 1500.0, 1500.7}}},
        {11.7, {3, {0.0, 11.9, 12.0}, {1500.0, 1500.0, 1500.08}}},
        {10.0, {3, {0.0, 11.0, 12.0}, {1500.0, 1500.0, 1502.0}}},
        {0.6, {3, {0.0, 9.0, 12.0}, {1500.0, 1500.0, 1499.0}}},
    };
    enum { PINGS = 4 };
    (void)state;
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        ping_rig r = bent_rig(0.0, 4096u);
        r.pose.position_m.z = cases[k].depth_m;
        r.env.sound_speed_profile = cases[k].water;
        asdic_ping *truth = NULL;
        double most = 0.0, most_db = 0.0;
        for (uint64_t i = 0; i < PINGS; i++) {
            asdic_ping *ping = rig_shoot(&r, ASDIC_LEARN_BLOCK * i, true);
            truth = truth ? truth : expected(&r, ping);
            for (size_t n = ping->bins / 4; n < ping->bins; n++) {
                double off = fabs(asdic_level_db(ping->intensity_lin[ASDIC_TOTAL][n] /
                                                 truth->intensity_lin[ASDIC_TOTAL][n]));
                most_db = fmax(most_db, off);
                most = fmax(most, off / ping->stderr_db[n]);
            }
            asdic_ping_destroy(&ping);
        }
        print_message("at %4.1f m: %.2f dB off at most, %.1f stated errors\n", cases[k].depth_m,
                      most_db, most);
        assert_true(most_db < 1.5 && most < 12.0);
        asdic_ping_destroy(&truth);
        rig_destroy(&r);
    }
}

static void stated_errors_are_honest(void **state) {
    enum { BLOCKS = 12, PINGS = 4 };
    (void)state;
    for (int k = 0; k < 2; k++) {
        ping_rig r = bent_rig(k ? 0.4 : -0.4, 4096u);
        asdic_simulator *sim = rig_simulator(&r);
        asdic_ping *ping = NULL, *truth;
        double sum = 0.0, count = 0.0;
        assert_ok(t.ctx, asdic_ping_create(t.ctx, 1, asdic_simulator_bin_count(sim), &ping));
        truth = expected(&r, ping);
        for (uint64_t i = 0; i < (uint64_t)BLOCKS * PINGS; i++) {
            if (i % PINGS == 0) {
                assert_ok(t.ctx, asdic_simulator_learn(sim, &r.pose, ASDIC_LEARN_BLOCK * i));
            }
            assert_ok(t.ctx,
                      asdic_simulator_ping(
                          sim, &r.pose, ASDIC_LEARN_BLOCK * (i / PINGS * PINGS) + i % PINGS, ping));
            for (size_t n = 4; n < ping->bins; n++) {
                double off = asdic_level_db(ping->intensity_lin[ASDIC_TOTAL][n]) -
                             asdic_level_db(truth->intensity_lin[ASDIC_TOTAL][n]);
                sum += pow(off / ping->stderr_db[n], 2.0);
                count += 1.0;
            }
        }
        print_message("%4.1f 1/s: true over stated error %.2f\n", k ? 0.4 : -0.4,
                      sqrt(sum / count));
        assert_true(sqrt(sum / count) > 0.8 && sqrt(sum / count) < 1.3);
        asdic_ping_destroy(&truth);
        asdic_ping_destroy(&ping);
        asdic_simulator_destroy(&sim);
        rig_destroy(&r);
    }
}

/* A box that shows no side squarely: its triangles' planes have three parts. */
static void add_tilted_box(ping_rig *r) {
    asdic_mesh *mesh = NULL;
    asdic_pose pose = {{14.0, 1.0, 7.0}, 0.3, -0.2, 0.7};
    assert_ok(t.ctx, asdic_mesh_box(t.ctx, (asdic_vec3){2.0, 3.0, 1.0}, &mesh));
    assert_ok(t.ctx,
              asdic_scene_add_object(r->scene, "box", mesh, pose, asdic_material_bottom(2.0)));
    asdic_mesh_destroy(&mesh);
}

/* As the gradient goes to nothing, pings go to those of straight rays; without one they have their bytes. */
static void no_gradient_is_straight(void **state) {
    static const double gradients[] = {0.0, -0.0, 1e-30, -1e-30, 1e-7, -1e-7};
    (void)state;
    ping_rig straight = rig_create(&t);
    straight.sonar.receiver_count = 1;
    straight.sampling.rays = 4096;
    straight.env.sound_speed_mps = 1490.0;
    add_tilted_box(&straight);
    asdic_ping *truth = rig_shoot(&straight, 0, true);
    for (size_t k = 0; k < sizeof gradients / sizeof *gradients; k++) {
        ping_rig r = bent_rig(gradients[k], 4096u);
        r.env.sound_speed_mps = 1490.0;
        add_tilted_box(&r);
        asdic_ping *ping = rig_shoot(&r, 0, true);
        difference d = compare(ping, truth, ASDIC_TOTAL), box = compare(ping, truth, ASDIC_OBJECT);
        print_message("%g 1/s: r.m.s. %.2g dB off straight rays, a box %.2g dB\n", gradients[k],
                      d.rms_db, box.rms_db);
        assert_true(gradients[k] == 0.0 ? rig_same(ping, truth)
                                        : d.rms_db < 0.01 && box.rms_db < 0.01);
        asdic_ping_destroy(&ping);
        rig_destroy(&r);
    }
    asdic_ping_destroy(&truth);
    rig_destroy(&straight);
}

static void large_triangles_are_a_plane(void **state) {
    static const asdic_ray_kernel kernels[] = {ASDIC_RAY_KERNEL_WIDE8, ASDIC_RAY_KERNEL_PKT16,
                                               ASDIC_RAY_KERNEL_FRUSTUM64, ASDIC_RAY_KERNEL_SCALAR};
    (void)state;
    for (int sign = -1; sign <= 1; sign += 2) {
        asdic_ping *first = NULL;
        for (int k = 0; k < 4; k++) {
            ping_rig r = bent_rig(sign, 1u << 16);
            asdic_scene_destroy(&r.scene);
            r.scene = bottom_of_two_triangles();
            r.sampling.kernel = kernels[k];
            asdic_ping *ping = rig_shoot(&r, 0, true);
            if (k == 0) {
                asdic_ping *truth = expected(&r, ping);
                difference d = compare(ping, truth, ASDIC_TOTAL);
                print_message("%d 1/s, two triangles: r.m.s. %.4f dB, most %.3f\n", sign, d.rms_db,
                              d.most_db);
                assert_true(d.rms_db < 0.03 && d.most_db < 0.3);
                asdic_ping_destroy(&truth);
                first = ping;
            } else {
                assert_true(rig_same(ping, first));
                asdic_ping_destroy(&ping);
            }
            rig_destroy(&r);
        }
        asdic_ping_destroy(&first);
    }
}

/* An object brought to a place by moving it gives the bytes of one that was added there. */
static void moved_objects_are_those_built_there(void **state) {
    static const asdic_pose there = {{14.0, 3.0, 6.0}, 0.3, -0.2, 0.7},
                            before = {{9.0, -4.0, 8.0}, 0, 0, 0};
    asdic_ping *pings[2];
    (void)state;
    for (int moved = 0; moved < 2; moved++) {
        ping_rig r = bent_rig(0.8, 8192u);
        asdic_mesh *mesh = NULL;
        asdic_scene_destroy(&r.scene);
        r.scene = bottom_of_two_triangles();
        assert_ok(t.ctx, asdic_mesh_box(t.ctx, (asdic_vec3){2.0, 3.0, 1.0}, &mesh));
        assert_ok(t.ctx, asdic_scene_add_moving_object(r.scene, "box", mesh, moved ? before : there,
                                                       asdic_material_facet(45.0, 1e-3, 0.1)));
        asdic_mesh_destroy(&mesh);
        asdic_simulator *sim = rig_simulator(&r);
        assert_ok(t.ctx,
                  asdic_ping_create(t.ctx, 1, asdic_simulator_bin_count(sim), &pings[moved]));
        assert_ok(t.ctx, asdic_simulator_move(sim, "box", &there));
        assert_ok(t.ctx, asdic_simulator_learn(sim, &r.pose, 0));
        assert_ok(t.ctx, asdic_simulator_ping(sim, &r.pose, 0, pings[moved]));
        asdic_simulator_destroy(&sim);
        rig_destroy(&r);
    }
    assert_true(pings[0]->intensity_lin[ASDIC_OBJECT][28] > 0.0);
    assert_true(rig_same(pings[0], pings[1]));
    asdic_ping_destroy(&pings[0]);
    asdic_ping_destroy(&pings[1]);
}

static bool heard(const asdic_ping *ping, asdic_component c) {
    double sum = 0.0;
    for (size_t i = 0; i < ping->beams * ping->bins; i++) {
        sum += ping->intensity_lin[c][i];
    }
    return sum > 0.0;
}

/* The same through layers, which the box reaches one after the other and up to four at a time; and as one that stays,
 * of which each layer has its own triangles, cut where the lift bends long edges. */
static void moved_objects_are_in_all_their_layers(void **state) {
    static const asdic_pose there[] = {{{14.0, 3.0, 6.0}, 0.3, -0.2, 0.7},
                                       {{16.0, -2.0, 9.4}, 0.1, 1.2, 0.4},
                                       {{12.0, 0.0, 1.8}, 0.0, 0.0, 0.2}};
    static const asdic_pose before = {{9.0, -4.0, 10.0}, 0, 0, 0};
    /* Far aside, where what is lifted lies much higher. */
    static const asdic_pose aside = {{20.0, 55.0, 9.0}, 0.0, 0.0, 0.4},
                            other = {{5, -9, 3}, 0, 0, 0};
    enum { POSES = sizeof there / sizeof *there };
    asdic_ping *pings[3];
    (void)state;
    for (int k = 0; k < 3 * POSES; k++) {
        ping_rig r = bent_rig(0.0, 1u << 16);
        asdic_mesh *mesh = NULL;
        int pose = k / 3, way = k % 3;
        r.env.sound_speed_profile =
            (asdic_sound_profile){7,
                                  {0.0, 2.0, 5.5, 6.2, 7.0, 9.0, 12.0},
                                  {1500.0, 1498.5, 1494.0, 1493.2, 1492.0, 1489.5, 1491.0}};
        asdic_scene_destroy(&r.scene);
        r.scene = bottom_of_two_triangles();
        assert_ok(t.ctx, asdic_mesh_box(t.ctx, (asdic_vec3){2.0, 3.0, 1.0}, &mesh));
        assert_ok(t.ctx, way < 2 ? asdic_scene_add_moving_object(r.scene, "box", mesh,
                                                                 way ? before : there[pose],
                                                                 asdic_material_bottom(2.0))
                                 : asdic_scene_add_object(r.scene, "box", mesh, there[pose],
                                                          asdic_material_bottom(2.0)));
        assert_ok(t.ctx, way < 2 ? asdic_scene_add_moving_object(r.scene, "second", mesh,
                                                                 way ? other : aside,
                                                                 asdic_material_bottom(2.0))
                                 : asdic_scene_add_object(r.scene, "second", mesh, aside,
                                                          asdic_material_bottom(2.0)));
        asdic_mesh_destroy(&mesh);
        asdic_simulator *sim = rig_simulator(&r);
        assert_ok(t.ctx, asdic_ping_create(t.ctx, 1, asdic_simulator_bin_count(sim), &pings[way]));
        if (way == 1) {
            assert_ok(t.ctx, asdic_simulator_move(sim, "box", &there[pose]));
            assert_ok(t.ctx, asdic_simulator_move(sim, "second", &aside));
        }
        assert_ok(t.ctx, asdic_simulator_learn(sim, &r.pose, 0));
        assert_ok(t.ctx, asdic_simulator_ping(sim, &r.pose, 0, pings[way]));
        asdic_simulator_destroy(&sim);
        rig_destroy(&r);
        if (way == 2) {
            difference object = compare(pings[0], pings[2], ASDIC_OBJECT);
            difference total = compare(pings[0], pings[2], ASDIC_TOTAL);
            print_message("pose %d: object %.2g dB r.m.s., all %.2g off one that stays\n", pose,
                          object.rms_db, total.rms_db);
            assert_true(rig_same(pings[0], pings[1]));
            assert_true(object.rms_db < 0.1 && total.rms_db < 0.02);
            assert_true(heard(pings[0], ASDIC_OBJECT));
            for (int i = 0; i < 3; i++) {
                asdic_ping_destroy(&pings[i]);
            }
        }
    }
}

/* Lifted, layers lie higher the farther out they are, and not alike: at the distance from the origin at which those of a
 * mixed layer and of the thermocline below would touch a box is met in its own layer alone, whether anything stays near
 * the origin or not. Levels are those near the origin, and back there the bytes are. */
static void what_moves_far_out_is_in_its_own_layers(void **state) {
    (void)state;
    for (int anchored = 0; anchored < 2; anchored++) {
        ping_rig r = bent_rig(0.0, 2048u);
        asdic_mesh *mesh = NULL;
        asdic_pose at = {{14.0, 0.0, 7.5}, 0.0, 0.0, 0.4},
                   behind = {.position_m = {-90.0, 0.0, 8.0}};
        asdic_ping *pings[4];
        r.env.sound_speed_profile =
            (asdic_sound_profile){4, {0.0, 6.0, 9.0, 12.0}, {1500.0, 1500.0, 1470.0, 1469.0}};
        r.pose.position_m.z = 3.0;
        assert_ok(t.ctx, asdic_mesh_box(t.ctx, (asdic_vec3){1.0, 6.0, 2.4}, &mesh));
        assert_ok(t.ctx, asdic_scene_add_moving_object(r.scene, "box", mesh, at,
                                                       asdic_material_bottom(2.0)));
        if (anchored) {
            assert_ok(t.ctx, asdic_scene_add_object(r.scene, "pier", mesh, behind,
                                                    asdic_material_bottom(2.0)));
        }
        asdic_mesh_destroy(&mesh);
        asdic_simulator *sim = rig_simulator(&r);
        for (int i = 0; i < 4; i++) {
            assert_ok(t.ctx,
                      asdic_ping_create(t.ctx, 1, asdic_simulator_bin_count(sim), &pings[i]));
        }
        const dev_layer *up = &sim->setup.layers[0], *low = up + 1;
        double apart_m = low->shift_m - up->shift_m + 4.0;
        double far_m = sqrt(2.0 * apart_m / (up->bend_per_m - low->bend_per_m));
        double off_m = far_m - at.position_m.x + r.scene->origin_m.x;
        asdic_pose poses[2] = {r.pose, r.pose}, there = at;
        poses[1].position_m.x += off_m;
        there.position_m.x += off_m;
        assert_ok(t.ctx, asdic_simulator_ping(sim, &r.pose, 1, pings[0]));
        assert_ok(t.ctx, asdic_simulator_move(sim, "box", &there));
        assert_ok(t.ctx, asdic_simulator_pings(sim, poses, 0, 2, pings + 1));
        assert_ok(t.ctx, asdic_simulator_move(sim, "box", &at));
        assert_ok(t.ctx, asdic_simulator_ping(sim, &r.pose, 1, pings[3]));
        assert_true(rig_same(pings[0], pings[3]));
        assert_true(asdic_simulator_ping_batch(sim) > 1 && heard(pings[0], ASDIC_OBJECT));
        difference d = compare(pings[2], pings[0], ASDIC_OBJECT);
        difference all = compare(pings[2], pings[0], ASDIC_TOTAL);
        print_message("%.0f m out: object %.3f dB r.m.s., all %.4f\n", far_m, d.rms_db, all.rms_db);
        assert_true(d.rms_db < 0.1 && all.rms_db < 0.01);
        for (int i = 0; i < 4; i++) {
            asdic_ping_destroy(&pings[i]);
        }
        asdic_simulator_destroy(&sim);
        rig_destroy(&r);
    }
}

/* A box is in fewer layers at a time than it could be. Where it is not, nothing of it is met either: by a sonar that dives
 * as far below it as layers are lifted apart. */
static void what_moves_is_in_no_other_layer(void **state) {
    (void)state;
    ping_rig r = bent_rig(0.0, 1u << 14);
    asdic_mesh *mesh = NULL;
    const asdic_pose at = {{14.0, 0.0, 10.0}, 0.0, 0.0, 0.4};
    r.env.sound_speed_profile =
        (asdic_sound_profile){4, {0.0, 6.0, 9.0, 12.0}, {1500.0, 1499.0, 1490.0, 1489.0}};
    rig_empty(&r);
    assert_ok(t.ctx, asdic_mesh_box(t.ctx, (asdic_vec3){6.0, 6.0, 1.0}, &mesh));
    assert_ok(t.ctx,
              asdic_scene_add_moving_object(r.scene, "box", mesh, at, asdic_material_bottom(2.0)));
    asdic_mesh_destroy(&mesh);
    asdic_simulator *sim = rig_simulator(&r);
    asdic_ping *ping = NULL;
    double apart_m = sim->setup.layers[1].shift_m - sim->setup.layers[0].shift_m;
    assert_true(sim->placement->scene->copies > 1);
    r.pose.position_m.z = at.position_m.z + apart_m - 3.0;
    assert_ok(t.ctx, asdic_ping_create(t.ctx, 1, asdic_simulator_bin_count(sim), &ping));
    assert_ok(t.ctx, asdic_simulator_ping(sim, &r.pose, 0, ping));
    assert_false(heard(ping, ASDIC_OBJECT));
    asdic_ping_destroy(&ping);
    asdic_simulator_destroy(&sim);
    rig_destroy(&r);
}

/* A bottom that is kept is lifted once, in one layer or several, for sonars at about the same depth; pings are those
 * over one that is lifted anew. */
static void kept_bottoms_stay_lifted(void **state) {
    (void)state;
    for (int many = 0; many < 2; many++) {
        asdic_scene *kept = bottom_of_two_triangles();
        const dev_node8 *lifted = NULL;
        assert_ok(t.ctx, asdic_scene_keep_ground(kept));
        for (int i = 0; i < 4; i++) {
            asdic_ping *pings[2];
            for (int fresh = 0; fresh < 2; fresh++) {
                ping_rig r = bent_rig(many ? 0.0 : 0.8, 4096u);
                if (many) {
                    r.env.sound_speed_profile = (asdic_sound_profile){
                        4, {0.0, 2.0, 7.0, 12.0}, {1500.0, 1498.5, 1492.0, 1491.0}};
                }
                r.pose.position_m.z += 0.05 * i;
                asdic_scene_destroy(&r.scene);
                r.scene = fresh ? bottom_of_two_triangles() : kept;
                pings[fresh] = rig_shoot(&r, 0, false);
                r.scene = fresh ? r.scene : NULL;
                rig_destroy(&r);
            }
            assert_true(rig_same(pings[0], pings[1]));
            asdic_ping_destroy(&pings[0]);
            asdic_ping_destroy(&pings[1]);
            assert_true(kept->ground->lifted.nodes &&
                        (i == 0 || kept->ground->lifted.nodes == lifted));
            lifted = kept->ground->lifted.nodes;
        }
        asdic_scene_destroy(&kept);
    }
}

/* Casts: isothermal over a thermocline, one in which the sonar is, a channel that traps rays, ten layers; each
 * over the plane, then over two triangles. */
static void layers_meet_quadrature(void **state) {
    static const struct {
        asdic_sound_profile cast;
        double rms_db;
    } cases[] = {
        {{3, {0.0, 8.0, 60.0}, {1495.0, 1495.0, 1443.0}}, 0.01},
        {{4, {0.0, 5.0, 9.0, 12.0}, {1482.0, 1480.0, 1471.0, 1470.0}}, 0.01},
        {{3, {0.0, 7.0, 12.0}, {1490.0, 1484.0, 1489.0}}, 0.1},
        {{11,
          {0.0, 1.2, 2.4, 3.6, 4.8, 6.0, 7.2, 8.4, 9.6, 10.8, 12.0},
          {1480.0, 1480.1, 1480.3, 1480.6, 1481.0, 1481.5, 1481.3, 1481.0, 1480.6, 1480.1, 1479.5}},
         0.01}};
    (void)state;
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        asdic_ping *truth = NULL;
        for (int mesh = 0; mesh < 2; mesh++) {
            ping_rig r = bent_rig(0.0, 1u << 16);
            r.env.sound_speed_profile = cases[k].cast;
            if (mesh) {
                asdic_scene_destroy(&r.scene);
                r.scene = bottom_of_two_triangles();
                r.layout.width = k == 0 ? 1 : r.layout.width; /* as on a GPU */
            }
            asdic_ping *ping = rig_shoot(&r, 0, true);
            truth = truth ? truth : expected(&r, ping); /* the same plane */
            difference d = compare(ping, truth, ASDIC_TOTAL),
                       b = compare(ping, truth, ASDIC_BOTTOM),
                       s = compare(ping, truth, ASDIC_SURFACE),
                       v = compare(ping, truth, ASDIC_VOLUME);
            print_message("cast %zu, %s: r.m.s. %.4f dB, most %.3f; bottom %.4f, surface %.4f, "
                          "volume %.4f\n",
                          k, mesh ? "triangles" : "plane", d.rms_db, d.most_db, b.rms_db, s.rms_db,
                          v.rms_db);
            assert_true(d.rms_db < cases[k].rms_db && s.rms_db < 0.05 && b.rms_db < 0.05);
            asdic_ping_destroy(&ping);
            rig_destroy(&r);
        }
        asdic_ping_destroy(&truth);
    }
}

/* No bottom, and the sonar amid a thermocline of 20 m/s a metre, which the sampler takes for all of the water: going on,
 * it would halve the sound speed within the range. */
static void a_steep_thermocline_meets_quadrature(void **state) {
    static const double below_mps[] = {1480.0, 1520.0};
    (void)state;
    for (int k = 0; k < 2; k++) {
        ping_rig r = bent_rig(0.0, 1u << 16);
        rig_empty(&r);
        r.env.sound_speed_profile = (asdic_sound_profile){
            4, {0.0, 6.5, 7.5, 60.0}, {1500.0, 1500.0, below_mps[k], below_mps[k]}};
        asdic_flat_scene flat = {.has_surface = true, .depth_m = r.pose.position_m.z};
        asdic_ping *ping = rig_shoot(&r, 0, true), *truth = NULL;
        assert_ok(t.ctx, asdic_ping_create(t.ctx, 1, ping->bins, &truth));
        assert_ok(t.ctx, asdic_expected_compute(t.ctx, &flat, &r.env, &r.sonar, &r.pose, truth));
        difference d = compare(ping, truth, ASDIC_VOLUME);
        print_message("%.0f m/s below, no bottom: volume r.m.s. %.4f dB, most %.3f\n", below_mps[k],
                      d.rms_db, d.most_db);
        assert_true(d.rms_db < 0.05 && d.most_db < 0.2);
        asdic_ping_destroy(&truth);
        asdic_ping_destroy(&ping);
        rig_destroy(&r);
    }
}

/* The nadir beyond a step of 16 m/s within 5 cm, as between fresh water and salt: the layer's own rays, followed to the
 * end of the range, would have left for water of any speed. */
static void steep_rays_cross_a_thin_layer(void **state) {
    (void)state;
    for (int below = 0; below < 2; below++) {
        asdic_sound_profile casts[] = {
            {4, {0.0, 3.0, 3.05, 60.0}, {1496.0, 1496.0, 1480.0, 1480.0}},
            {4, {0.0, 9.0, 9.05, 60.0}, {1480.0, 1480.0, 1496.0, 1496.0}}};
        ping_rig r = bent_rig(0.0, 1u << 15);
        r.env.sound_speed_profile = casts[below];
        r.sonar.transmitter.pitch_rad = (below ? 60.0 : -60.0) * RIG_DEGREE;
        r.receivers[0] = r.sonar.transmitter;
        asdic_component c = below ? ASDIC_BOTTOM : ASDIC_SURFACE;
        asdic_ping *ping = rig_shoot(&r, 0, true), *truth = expected(&r, ping);
        difference d = compare(ping, truth, c);
        print_message("beyond a step %s: r.m.s. %.4f dB, most %.3f\n", below ? "below" : "above",
                      d.rms_db, d.most_db);
        assert_true(d.rms_db < 0.3 && d.most_db < 2.0);
        asdic_ping_destroy(&truth);
        asdic_ping_destroy(&ping);
        rig_destroy(&r);
    }
}

/* A thermocline of 10 m/s within a metre, with which the sound speed would be 0 far above the plane beyond it: the bottom
 * under it, the surface over one that is upside down. */
static void planes_far_beyond_a_thermocline_are_met(void **state) {
    (void)state;
    for (int below = 0; below < 2; below++) {
        asdic_sound_profile casts[] = {
            {4, {0.0, 300.0, 301.0, 500.0}, {1480.0, 1480.0, 1490.0, 1490.0}},
            {4, {0.0, 20.0, 21.0, 500.0}, {1490.0, 1490.0, 1480.0, 1480.0}}};
        ping_rig r = bent_rig(0.0, 1u << 14);
        asdic_ping *truth = NULL;
        r.env.sound_speed_profile = casts[below];
        r.pose.position_m.z = below ? 5.0 : 315.0;
        r.sonar.max_range_m = 400.0;
        r.sonar.ping_rate_hz = 1.0;
        r.sonar.bin_length_m = 10.0;
        r.sonar.frequency_hz = 3e4;
        r.sonar.transmitter.pitch_rad = (below ? 60.0 : -60.0) * RIG_DEGREE;
        r.receivers[0] = r.sonar.transmitter;
        rig_empty(&r);
        assert_ok(t.ctx, asdic_scene_set_bottom_plane(r.scene, 320.0, asdic_material_bottom(2.0)));
        asdic_flat_scene flat = {.has_surface = true,
                                 .has_bottom = true,
                                 .altitude_m = 320.0 - r.pose.position_m.z,
                                 .depth_m = r.pose.position_m.z,
                                 .bottom = asdic_material_bottom(2.0)};
        asdic_ping *ping = rig_shoot(&r, 0, true);
        assert_ok(t.ctx, asdic_ping_create(t.ctx, 1, ping->bins, &truth));
        assert_ok(t.ctx, asdic_expected_compute(t.ctx, &flat, &r.env, &r.sonar, &r.pose, truth));
        difference d = compare(ping, truth, below ? ASDIC_BOTTOM : ASDIC_SURFACE);
        print_message("far %s a thermocline: r.m.s. %.4f dB, most %.3f\n",
                      below ? "below" : "above", d.rms_db, d.most_db);
        assert_true(d.rms_db < 0.1 && d.most_db < 0.5);
        asdic_ping_destroy(&truth);
        asdic_ping_destroy(&ping);
        rig_destroy(&r);
    }
}

/* A plane and a box from 5 to 11 m that mirror: five layers have triangles, rays end in each of them. By default in two
 * layouts, since each is compiled anew for layers; straight rays have theirs in test_ping_bytes.c. */
static void legs_are_the_same_for_all_kernels_and_layouts(void **state) {
    static const asdic_ray_kernel kernels[] = {ASDIC_RAY_KERNEL_WIDE8, ASDIC_RAY_KERNEL_PKT16,
                                               ASDIC_RAY_KERNEL_FRUSTUM64, ASDIC_RAY_KERNEL_SCALAR};
    static const asdic_layout layouts[] = {
        {.deposit = ASDIC_DEPOSIT_COLLECT, .local = 8, .batch_slots = 1 << 20, .workers = 1},
        {.deposit = ASDIC_DEPOSIT_COLLECT, .local = 1, .batch_slots = 16384},
        {.deposit = ASDIC_DEPOSIT_COLLECT, .local = 64, .batch_slots = 20000, .workers = 3},
        {.deposit = ASDIC_DEPOSIT_ATOMIC32, .local = 4096, .batch_slots = 20000}};
    (void)state;
    asdic_ping *first = NULL;
    for (int k = 0; k < 4; k++) {
        asdic_mesh *mesh = NULL;
        ping_rig r = bent_rig(0.0, 40000u);
        r.env.sound_speed_profile = (asdic_sound_profile){
            6, {0.0, 3.0, 5.0, 8.0, 10.0, 12.0}, {1490.0, 1489.0, 1487.0, 1480.0, 1482.0, 1481.0}};
        asdic_scene_destroy(&r.scene);
        r.scene = bottom_of_two_triangles();
        assert_ok(t.ctx, asdic_mesh_box(t.ctx, (asdic_vec3){3.0, 9.0, 6.0}, &mesh));
        asdic_pose at = {{14.0, 3.0, 8.0}, 0.1, 0.2, 0.7};
        assert_ok(t.ctx, asdic_scene_add_object(r.scene, "box", mesh, at,
                                                asdic_material_facet(45.0, 1e-3, 0.1)));
        asdic_mesh_destroy(&mesh);
        r.sampling.multipath = ASDIC_MULTIPATH_BOUNDARIES;
        r.sampling.kernel = kernels[k];
        unsigned width = r.layout.width;
        r.layout = layouts[full || k == 2 ? k : 0];
        r.layout.width = width;
        asdic_ping *ping = rig_shoot(&r, 0, true);
        assert_true(asdic_level_db(ping->intensity_lin[ASDIC_OBJECT][28]) > -120.0);
        assert_true(asdic_level_db(ping->intensity_lin[ASDIC_MULTIPATH][40]) > -150.0);
        assert_true(k == 0 || rig_same(ping, first));
        if (k == 0) {
            first = ping;
        } else {
            asdic_ping_destroy(&ping);
        }
        rig_destroy(&r);
    }
    asdic_ping_destroy(&first);
}

/* On the axis of a channel a level ray crosses it thousands of times, and is followed to the end: one that is not
 * goes on as if its last layer had no end, and the pilots learn of echoes that are not there. */
static void trapped_rays_are_followed(void **state) {
    (void)state;
    ping_rig r = bent_rig(0.0, 20000u);
    r.pose.position_m.z = 7.0;
    r.sonar.ping_rate_hz = 5.0;
    r.env.sound_speed_profile =
        (asdic_sound_profile){4, {0.0, 3.0, 7.0, 12.0}, {1500.0, 1490.0, 1480.0, 1486.0}};
    asdic_ping *ping = rig_shoot(&r, 0, true), *truth = expected(&r, ping);
    double stated_db = 0.0, count = 0.0;
    for (size_t i = 4; i < ping->bins; i++) {
        if (truth->intensity_lin[ASDIC_BOTTOM][i] > 0.0) {
            stated_db += (double)ping->stderr_db[i];
            count += 1.0;
        }
    }
    stated_db /= count;
    print_message("a channel: stated error where the bottom is heard, on average, %.4f dB\n",
                  stated_db);
    assert_true(count > 100.0 && stated_db < 0.06);
    asdic_ping_destroy(&truth);
    asdic_ping_destroy(&ping);
    rig_destroy(&r);
}

/* Among triangles each crossing of a layer's plane is a leg to trace: nearly level rays have more of them than are
 * followed. The ping is made all the same, and the others' echoes are right. */
static void rays_with_too_many_legs_are_given_up(void **state) {
    (void)state;
    ping_rig r = bent_rig(0.0, 4096u);
    r.pose.position_m.z = 7.0;
    r.sonar.ping_rate_hz = 5.0;
    r.sonar.transmitter.length_v_m = 0.75; /* of a beam within half a degree */
    r.env.sound_speed_profile =
        (asdic_sound_profile){4, {0.0, 3.0, 7.0, 12.0}, {1500.0, 1490.0, 1480.0, 1486.0}};
    asdic_scene_destroy(&r.scene);
    r.scene = bottom_of_two_triangles();
    asdic_ping *ping = rig_shoot(&r, 0, false), *truth = expected(&r, ping);
    difference d = compare(ping, truth, ASDIC_TOTAL);
    print_message("level in a channel: r.m.s. %.4f dB, most %.3f\n", d.rms_db, d.most_db);
    assert_true(d.rms_db < 1.0); /* of so few rays in so narrow a beam */
    asdic_ping_destroy(&truth);
    asdic_ping_destroy(&ping);
    rig_destroy(&r);
}

/* A scene 3 km deeper is lifted as it is near the surface: single precision stays as fine. */
static void deep_scenes_are_lifted_as_shallow_ones(void **state) {
    const double deeper_m = 3000.0;
    double apart_m[2];
    (void)state;
    for (int deep = 0; deep < 2; deep++) {
        ping_rig r = bent_rig(0.0, 1u << 16);
        const double by_m = deep * deeper_m;
        r.env.max_depth_m = NAN;
        r.env.sound_speed_profile = (asdic_sound_profile){
            4, {by_m, by_m + 5.0, by_m + 9.0, by_m + 12.0}, {1482.0, 1480.0, 1471.0, 1470.0}};
        r.pose.position_m.z += by_m;
        asdic_scene_destroy(&r.scene);
        r.scene = bottom_of_two_triangles_at(by_m);
        asdic_scene_set_surface(r.scene, false);
        asdic_simulator *sim = rig_simulator(&r);
        assert_true(sim->setup.layer_count > 2);
        apart_m[deep] = (double)sim->setup.layers[1].shift_m - (double)sim->setup.layers[0].shift_m;
        asdic_simulator_destroy(&sim);
        asdic_ping *ping = rig_shoot(&r, 0, true), *truth = NULL;
        asdic_flat_scene flat = {.has_bottom = true,
                                 .altitude_m = DEPTH + by_m - r.pose.position_m.z,
                                 .depth_m = r.pose.position_m.z,
                                 .bottom = asdic_material_bottom(2.0)};
        assert_ok(t.ctx, asdic_ping_create(t.ctx, ping->beams, ping->bins, &truth));
        assert_ok(t.ctx, asdic_expected_compute(t.ctx, &flat, &r.env, &r.sonar, &r.pose, truth));
        difference d = compare(ping, truth, ASDIC_BOTTOM);
        print_message("%g m deeper: layers %g m apart, bottom r.m.s. %.4f dB\n", by_m,
                      apart_m[deep], d.rms_db);
        assert_true(d.rms_db < 0.05);
        asdic_ping_destroy(&truth);
        asdic_ping_destroy(&ping);
        rig_destroy(&r);
    }
    assert_true(apart_m[0] > 2.0 * DEPTH && apart_m[0] < 1000.0);
    assert_close_relative(apart_m[1], apart_m[0], 0.3); /* rounded to quarters */
}

/* Without a bottom rays go on down to the range: what no water has is refused there, by simulation and quadrature. */
static void impossible_open_water_is_refused(void **state) {
    static const struct {
        double gradient_per_s;
        asdic_status status;
    } cases[] = {{-2.0, ASDIC_OK}, {-3.0, ASDIC_ERROR_ARGUMENT}, {-11.0, ASDIC_ERROR_ARGUMENT}};
    (void)state;
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        ping_rig r = bent_rig(cases[k].gradient_per_s, 1024u);
        asdic_simulator *sim = NULL;
        asdic_ping *truth = NULL;
        rig_empty(&r);
        assert_ok(t.ctx, asdic_scene_commit(r.scene));
        r.env.sound_speed_mps = 1490.0;
        r.sonar.max_range_m = 60.0;
        r.sonar.receivers = r.receivers;
        asdic_flat_scene flat = {.has_surface = true, .depth_m = r.pose.position_m.z};
        assert_ok(t.ctx, asdic_ping_create(t.ctx, 1, 120, &truth));
        assert_status(t.ctx, asdic_expected_compute(t.ctx, &flat, &r.env, &r.sonar, &r.pose, truth),
                      cases[k].status);
        assert_status(t.ctx,
                      asdic_simulator_create(t.ctx, t.device, r.scene, &r.env, &r.sonar,
                                             &r.sampling, r.pose.position_m.z, &sim),
                      cases[k].status);
        asdic_simulator_destroy(&sim);
        asdic_ping_destroy(&truth);
        rig_destroy(&r);
    }
}

/* Sound speeds that no water has are refused, with the depth; a cast of several layers is taken as one. */
static void impossible_water_is_refused(void **state) {
    (void)state;
    ping_rig r = bent_rig(-20.0, 1024u);
    r.sonar.receivers = r.receivers;
    asdic_simulator *sim = NULL;
    assert_ok(t.ctx, asdic_scene_commit(r.scene));
    assert_int_equal(asdic_simulator_create(t.ctx, t.device, r.scene, &r.env, &r.sonar, &r.sampling,
                                            r.pose.position_m.z, &sim),
                     ASDIC_ERROR_ARGUMENT);
    assert_non_null(strstr(asdic_context_error(t.ctx), "depth of"));
    r.env.sound_speed_gradient_per_s = 0.0;
    r.env.sound_speed_profile =
        (asdic_sound_profile){3, {0.0, 8.0, 12.0}, {1490.0, 1490.0, 1486.0}};
    asdic_ping *ping = rig_shoot(&r, 0, true);
    assert_true(ping->intensity_lin[ASDIC_BOTTOM][40] > 0.0);
    asdic_ping_destroy(&ping);
    rig_destroy(&r);
}

int main(int argc, char **argv) {
    full = argc == 2 && strcmp(argv[1], "full") == 0;
    t = test_device_open_or_skip();
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(pings_meet_quadrature),
        cmocka_unit_test(high_and_low_sonars_meet_quadrature),
        cmocka_unit_test(reaches_end_as_loud_as_expected),
        cmocka_unit_test(layers_end_reaches_as_loud_as_expected),
        cmocka_unit_test(stated_errors_are_honest),
        cmocka_unit_test(no_gradient_is_straight),
        cmocka_unit_test(large_triangles_are_a_plane),
        cmocka_unit_test(moved_objects_are_those_built_there),
        cmocka_unit_test(moved_objects_are_in_all_their_layers),
        cmocka_unit_test(what_moves_far_out_is_in_its_own_layers),
        cmocka_unit_test(what_moves_is_in_no_other_layer),
        cmocka_unit_test(kept_bottoms_stay_lifted),
        cmocka_unit_test(layers_meet_quadrature),
        cmocka_unit_test(a_steep_thermocline_meets_quadrature),
        cmocka_unit_test(steep_rays_cross_a_thin_layer),
        cmocka_unit_test(planes_far_beyond_a_thermocline_are_met),
        cmocka_unit_test(legs_are_the_same_for_all_kernels_and_layouts),
        cmocka_unit_test(trapped_rays_are_followed),
        cmocka_unit_test(rays_with_too_many_legs_are_given_up),
        cmocka_unit_test(deep_scenes_are_lifted_as_shallow_ones),
        cmocka_unit_test(impossible_water_is_refused),
        cmocka_unit_test(impossible_open_water_is_refused),
    };
    return test_device_end(&t, cmocka_run_group_tests(tests, NULL, NULL));
}
