/*
 * Rays aimed at faces: of what is too large for a cone, and of small pieces that send back far more than what is
 * beside them, which a cone's even rays seldom meet.
 */
#include "dice.h"
#include "ping_rig.h"
#include "target_bodies.h"
#include "target_rig.h"

#include "base/vec.h"
#include "scene/triangles.h"

#include <math.h>

static test_device t;

/* Rays aimed at the faces of what is too large for a cone are as dense on each as is said: they add up to all, and
 * what they hear with the others is as loud as what these hear alone. */
static void rays_at_faces_add_up(void **state) {
    (void)state;
    ping_rig r = rig_create(&t);
    asdic_mesh *mesh = NULL;
    asdic_pose pose = {{9.0, 0.0, 6.0}, 0.3, 0.4, 0.7};
    assert_ok(t.ctx, asdic_mesh_box(t.ctx, (asdic_vec3){8.0, 6.0, 3.0}, &mesh));
    assert_ok(t.ctx, asdic_scene_add_object(r.scene, "block", mesh, pose,
                                            asdic_material_facet(45.0, 1e-3, 0.2)));
    asdic_simulator *sim = rig_simulator(&r);
    assert_ok(t.ctx, asdic_simulator_learn(sim, &r.pose, 0));
    const asdic_scene *scene = sim->setup.scene;
    double sum = 0.0;
    for (size_t i = 0; i < scene->triangle_count; i++) {
        const dev_triangle *at = &scene->triangles[i];
        asdic_vec3 v[3];
        for (int k = 0; k < 3; k++) {
            const float *c = k == 0 ? at->v0 : k == 1 ? at->v1 : at->v2;
            v[k] = (asdic_vec3){(double)c[0], (double)c[1], (double)c[2]};
        }
        asdic_vec3 normal =
            asdic_vec3_cross(asdic_vec3_sub(v[1], v[0]), asdic_vec3_sub(v[2], v[0]));
        sum += (double)sim->learnt.faces.density[i] * 0.5 * asdic_vec3_length(normal);
    }
    print_message("%zu faces of %zu, sum %.6f\n", sim->learnt.faces.count, scene->triangle_count,
                  sum);
    assert_true(sim->learnt.faces.count > 0);
    assert_close(sum, 1.0, 1e-4);
    asdic_simulator_destroy(&sim);
    double heard[2] = {0.0, 0.0};
    for (int k = 0; k < 2; k++) {
        r.sampling.sampler = k ? ASDIC_SAMPLER_BEAM : ASDIC_SAMPLER_ADAPTIVE;
        r.sampling.rays = 1u << 17;
        asdic_ping *ping = rig_shoot(&r, 0, true);
        for (size_t n = 0; n < ping->bins; n++) {
            heard[k] += ping->intensity_lin[ASDIC_OBJECT][n];
        }
        asdic_ping_destroy(&ping);
    }
    double off_db = asdic_level_db(heard[0]) - asdic_level_db(heard[1]);
    print_message("a block with aimed rays: %.3f dB beside the beam sampler\n", off_db);
    assert_true(fabs(off_db) < 0.1);
    asdic_mesh_destroy(&mesh);
    rig_destroy(&r);
}

/* Shares of the aimed rays by triangle, of a block and a plate beside it, as wound or TURNED inside out. */
static void share_faces(bool turned, float density[14]) {
    ping_rig r = rig_create(&t);
    asdic_mesh *meshes[2];
    assert_ok(t.ctx, asdic_mesh_box(t.ctx, (asdic_vec3){8.0, 6.0, 3.0}, &meshes[0]));
    assert_ok(t.ctx, asdic_mesh_plate(t.ctx, 8.0, 6.0, &meshes[1]));
    for (int m = 0; m < 2; m++) {
        uint32_t *f = meshes[m]->indices;
        for (size_t i = 0; turned && i < meshes[m]->triangle_count; i++) {
            uint32_t second = f[3 * i + 1];
            f[3 * i + 1] = f[3 * i + 2];
            f[3 * i + 2] = second;
        }
        asdic_pose pose = {.position_m = {9.0, 8.0 * m, 6.0}, .yaw_rad = 0.3};
        assert_ok(t.ctx, asdic_scene_add_object(r.scene, m ? "plate" : "block", meshes[m], pose,
                                                asdic_material_facet(45.0, 1e-3, 0.2)));
        asdic_mesh_destroy(&meshes[m]);
    }
    asdic_simulator *sim = rig_simulator(&r);
    assert_ok(t.ctx, asdic_simulator_learn(sim, &r.pose, 0));
    assert_int_equal(sim->setup.scene->triangle_count, 14);
    memcpy(density, sim->learnt.faces.density, 14 * sizeof *density);
    asdic_simulator_destroy(&sim);
    rig_destroy(&r);
}

/* A face gets as many rays whichever way it is wound: a body's outside is known, and a sheet has none. */
static void faces_get_rays_however_they_are_wound(void **state) {
    (void)state;
    float outwards[14], inwards[14], most = 0.0f;
    share_faces(false, outwards);
    share_faces(true, inwards);
    for (int i = 0; i < 14; i++) {
        print_message("triangle %2d: %.6f outwards, %.6f inwards\n", i, (double)outwards[i],
                      (double)inwards[i]);
        assert_close_relative(inwards[i], outwards[i], 1e-4);
        most = fmaxf(most, outwards[i]);
    }
    assert_true(outwards[12] > 0.1f * most && outwards[13] > 0.1f * most);
}

/* What rays of SAMPLER hear of a wall of 30 m by 3 m, 38 m ahead, that stands below a thermocline. */
static double heard_of_a_wall(asdic_sampler sampler, unsigned rays) {
    ping_rig r = rig_create(&t);
    asdic_mesh *mesh = NULL;
    double sum = 0.0;
    r.env.sound_speed_profile = (asdic_sound_profile){
        6, {0.0, 3.0, 5.5, 8.0, 10.0, 40.0}, {1482.0, 1481.0, 1472.0, 1449.0, 1436.0, 1431.0}};
    r.env.refraction = ASDIC_REFRACTION_FULL;
    r.env.max_depth_m = 40.0;
    r.pose.position_m = (asdic_vec3){0.0, 0.0, 3.0};
    r.sampling.sampler = sampler;
    r.sampling.rays = rays;
    assert_ok(t.ctx, asdic_mesh_box(t.ctx, (asdic_vec3){0.1, 30.0, 3.0}, &mesh));
    assert_ok(t.ctx, asdic_scene_add_object(r.scene, "wall", mesh,
                                            (asdic_pose){.position_m = {38.0, 0.0, 9.5}},
                                            asdic_material_bottom(2.0)));
    asdic_ping *ping = rig_shoot(&r, 0, true);
    for (size_t n = 0; n < ping->bins; n++) {
        sum += ping->intensity_lin[ASDIC_OBJECT][n];
    }
    asdic_ping_destroy(&ping);
    asdic_mesh_destroy(&mesh);
    rig_destroy(&r);
    return asdic_level_db(sum);
}

/* Rays that follow layers miss faces which they were aimed at by one bend, and nothing made up for it. */
static void a_wall_in_layers_is_heard_whole(void **state) {
    (void)state;
    double aimed_db = heard_of_a_wall(ASDIC_SAMPLER_ADAPTIVE, 1u << 16);
    double even_db = heard_of_a_wall(ASDIC_SAMPLER_BEAM, 1u << 18);
    print_message("a wall below a thermocline: %.2f and %.2f dB\n", aimed_db, even_db);
    assert_true(fabs(aimed_db - even_db) < 0.3);
}

/* A beam 10 m long across the sonar's way, seen along its end: the echo fades towards the first null. The side behind
 * the end's far edge is not seen; 1e-4 of its length, by which tracers widen it, returned 8 dB more than all of that bin. */
static void ends_of_long_bodies_fade(void **state) {
    (void)state;
    ping_rig r = rig_create(&t);
    asdic_mesh *mesh = NULL;
    r.sonar.receiver_count = 1;
    r.sonar.transmitter.length_h_m = r.sonar.transmitter.length_v_m = 0.03;
    r.receivers[0] = r.sonar.transmitter;
    r.sonar.bandwidth_hz = 15e3;
    r.sonar.bin_length_m = 0.05;
    r.sonar.max_range_m = 12.0;
    r.env.sound_speed_mps = 1500.0;
    r.sampling.rays = 1u << 17;
    r.pose.position_m = (asdic_vec3){0.0, 0.05, 6.0};
    assert_ok(t.ctx, asdic_mesh_box(t.ctx, (asdic_vec3){0.9, 10.0, 0.9}, &mesh));
    assert_ok(t.ctx, asdic_scene_add_object(r.scene, "beam", mesh,
                                            (asdic_pose){.position_m = {10.0, -5.0, 6.0}},
                                            asdic_material_facet(45.0, 0.01, 0.2)));
    asdic_ping *ping = rig_shoot(&r, 0, true);
    const double *object = ping->intensity_lin[ASDIC_OBJECT];
    for (size_t n = 200; n < 210; n++) {
        print_message("%.3f m: %.2f dB\n", 0.05 * ((double)n + 0.5), asdic_level_db(object[n]));
        assert_true(object[n] > 0.0 && object[n] < object[n - 3]);
    }
    asdic_ping_destroy(&ping);
    asdic_mesh_destroy(&mesh);
    rig_destroy(&r);
}

/* Without objects no rays are aimed at faces. */
static void a_floor_alone_has_no_faces(void **state) {
    (void)state;
    ping_rig r = rig_create(&t);
    asdic_simulator *sim = rig_simulator(&r);
    assert_ok(t.ctx, asdic_simulator_learn(sim, &r.pose, 0));
    assert_int_equal(sim->learnt.faces.count, 0);
    assert_int_equal(sim->shots[0].ping->sampling.face_count, 0);
    asdic_simulator_destroy(&sim);
    rig_destroy(&r);
}

#define PLATE_M 0.2
#define FAR_M 150.0

/* A square plate in S at AT, its normal along N, unit. */
static void add_plate(soup *s, asdic_vec3 at, asdic_vec3 n) {
    asdic_vec3 up = {0.0, 0.0, 1.0};
    asdic_vec3 u = asdic_vec3_cross(up, n);
    u = asdic_vec3_scale(u, 0.5 * PLATE_M / asdic_vec3_length(u));
    asdic_vec3 v = asdic_vec3_cross(n, u), corner[4];
    for (int k = 0; k < 4; k++) {
        asdic_vec3 side = k == 0 || k == 3 ? asdic_vec3_scale(u, -1.0) : u;
        corner[k] = asdic_vec3_add(at, asdic_vec3_add(side, k < 2 ? asdic_vec3_scale(v, -1.0) : v));
    }
    double c[4][3];
    for (int k = 0; k < 4; k++) {
        c[k][0] = corner[k].x;
        c[k][1] = corner[k].y;
        c[k][2] = corner[k].z;
    }
    soup_facet(s, c[0], c[1], c[2]);
    soup_facet(s, c[0], c[2], c[3]);
}

/* COUNT plates that look 40 to 80 degrees past the sonar, as far as REACH_M to all sides, and one that mirrors it,
 * 3 m aside. */
static asdic_mesh *scattered_plates(size_t count, double reach_m) {
    soup s = soup_create(2 * (count + 1), NULL);
    uint64_t state = 7;
    for (size_t i = 0; i < count; i++) {
        double off = (40.0 + 40.0 * random_unit(&state)) * RIG_DEGREE,
               turn = 2.0 * ASDIC_PI * random_unit(&state);
        asdic_vec3 n = {-cos(off), sin(off) * cos(turn), sin(off) * sin(turn)};
        asdic_vec3 at = {4.0 * random_unit(&state) + 0.3,
                         reach_m * (2.0 * random_unit(&state) - 1.0),
                         reach_m * (2.0 * random_unit(&state) - 1.0)};
        add_plate(&s, at, n);
    }
    asdic_vec3 to = {-FAR_M, -3.0, 0.0};
    add_plate(&s, (asdic_vec3){0.0, 3.0, 0.0}, asdic_vec3_scale(to, 1.0 / asdic_vec3_length(to)));
    return soup_mesh(t.ctx, &s);
}

/* The least and the most that pings of R hear of its body, target strength in dB. */
typedef struct heard {
    double least_db, most_db;
} heard;

static heard hear(target_rig *r, double range_m) {
    enum { PINGS = 16 };
    heard h = {INFINITY, -INFINITY};
    asdic_ping *ping = NULL;
    asdic_simulator *sim = target_rig_simulator(r, &ping);
    assert_ok(t.ctx, asdic_simulator_learn(sim, &r->pose, 0));
    for (int k = 0; k < PINGS; k++) {
        double energy = target_rig_shoot(r, sim, k, ASDIC_OBJECT, ping);
        double strength_db = target_rig_strength_db(r, energy, range_m);
        h.least_db = fmin(h.least_db, strength_db);
        h.most_db = fmax(h.most_db, strength_db);
    }
    asdic_ping_destroy(&ping);
    asdic_simulator_destroy(&sim);
    return h;
}

/* One plate among a thousand sends back nearly all: every ping hears it as loud as theory has it, be the object small
 * enough for a cone or not. Even rays of the cone would meet it less than once. */
static void a_piece_that_mirrors_is_heard(void **state) {
    (void)state;
    static const struct { double reach_m, off_db; } cases[] = {{60.0, 1.3}, {20.0, 0.4}};
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        target_rig r = target_rig_create(&t, 100e3, FAR_M, 0.5);
        double theory_db = 20.0 * log10(PLATE_M * PLATE_M * r.sonar.frequency_hz / 1500.0);
        r.sampling.rays = 8192;
        target_rig_add(&r, scattered_plates(1000, cases[k].reach_m), FAR_M, 0.0,
                       asdic_material_facet(200.0, 1e-5, 1e-3));
        heard h = hear(&r, hypot(FAR_M, 3.0));
        print_message("plates within %.0f m: %.2f to %.2f dB, theory %.2f\n", cases[k].reach_m,
                      h.least_db, h.most_db, theory_db);
        assert_true(h.least_db > theory_db - cases[k].off_db);
        assert_true(h.most_db < theory_db + cases[k].off_db);
        target_rig_destroy(&r);
    }
}

int main(void) {
    t = test_device_open_or_skip();
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(rays_at_faces_add_up),
        cmocka_unit_test(faces_get_rays_however_they_are_wound),
        cmocka_unit_test(a_wall_in_layers_is_heard_whole),
        cmocka_unit_test(ends_of_long_bodies_fade),
        cmocka_unit_test(a_floor_alone_has_no_faces),
        cmocka_unit_test(a_piece_that_mirrors_is_heard),
    };
    return test_device_end(&t, cmocka_run_group_tests(tests, NULL, NULL));
}
