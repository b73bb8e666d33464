/*
 * The rig of ping_rig.h in water that bends rays, and how far its pings are from what is expected.
 */
#ifndef ASDIC_TEST_BENT_RIG_H
#define ASDIC_TEST_BENT_RIG_H

#include "ping_rig.h"

static test_device t;

#define DEPTH 12.0

/* R.m.s. and largest difference of a component's levels from those of TRUTH, from 2 m on. */
typedef struct difference {
    double rms_db, most_db;
} difference;

static inline difference compare(const asdic_ping *ping, const asdic_ping *truth,
                                 asdic_component c) {
    difference d = {0.0, 0.0};
    double count = 0.0;
    for (size_t i = 0; i < ping->beams * ping->bins; i++) {
        if (i % ping->bins < 4 || truth->intensity_lin[c][i] <= 0.0) {
            continue;
        }
        double off = fabs(asdic_level_db(ping->intensity_lin[c][i]) -
                          asdic_level_db(truth->intensity_lin[c][i]));
        d.rms_db += off * off;
        d.most_db = fmax(d.most_db, off);
        count += 1.0;
    }
    d.rms_db = sqrt(d.rms_db / fmax(count, 1.0));
    return d;
}

static inline ping_rig bent_rig(double gradient_per_s, uint32_t rays) {
    ping_rig r = rig_create(&t);
    r.sonar.receiver_count = 1;
    r.sampling.rays = rays;
    r.env.sound_speed_gradient_per_s = gradient_per_s;
    return r;
}

static inline asdic_ping *expected(const ping_rig *r, const asdic_ping *like) {
    asdic_flat_scene flat = {.has_surface = true,
                             .has_bottom = true,
                             .altitude_m = DEPTH - r->pose.position_m.z,
                             .depth_m = r->pose.position_m.z,
                             .bottom = asdic_material_bottom(2.0)};
    asdic_ping *truth = NULL;
    assert_ok(t.ctx, asdic_ping_create(t.ctx, like->beams, like->bins, &truth));
    assert_ok(t.ctx, asdic_expected_compute(t.ctx, &flat, &r->env, &r->sonar, &r->pose, truth));
    return truth;
}

/* The bottom as two triangles, whose edges are 600 m long: lifted, they would leave the water. Deeper than the plane by
 * so many metres. */
static inline asdic_scene *bottom_of_two_triangles_at(double deeper_m) {
    static const double v[] = {-300,  -300, DEPTH, 300,   -300, DEPTH, 300, 300,
                               DEPTH, -300, 300,   DEPTH, -299, -300,  0.5};
    static const uint32_t index[] = {0, 2, 1, 0, 3, 2, 0, 1, 4}; /* and a fin far behind */
    asdic_scene *scene = NULL;
    asdic_mesh *mesh = NULL;
    assert_ok(t.ctx, asdic_mesh_from_triangles(t.ctx, v, 5, index, 3, &mesh));
    assert_ok(t.ctx, asdic_scene_create(t.ctx, &scene));
    const asdic_pose pose = {.position_m = {0.0, 0.0, deeper_m}};
    assert_ok(t.ctx, asdic_scene_add_bottom(scene, mesh, pose, asdic_material_bottom(2.0)));
    asdic_mesh_destroy(&mesh);
    return scene;
}

static inline asdic_scene *bottom_of_two_triangles(void) {
    return bottom_of_two_triangles_at(0.0);
}

#endif
