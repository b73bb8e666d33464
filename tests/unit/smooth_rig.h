/* Bodies of smooth steel, and how far their normals are off those of what their facets stand for. */
#ifndef ASDIC_TESTS_SMOOTH_RIG_H
#define ASDIC_TESTS_SMOOTH_RIG_H

#include "asserts.h"
#include "test_context.h"

#include "base/vec.h"
#include "kernels/smooth.h"
#include "scene/scene.h"
#include "scene/triangles.h"

#include <asdic/asdic.h>

#include <stdlib.h>
#include <string.h>

#define PI 3.14159265358979323846

static inline asdic_scene *scene_of(asdic_mesh *mesh, asdic_pose pose, asdic_material material) {
    asdic_scene *scene;
    assert_ok(ctx, asdic_scene_create(ctx, &scene));
    assert_ok(ctx, asdic_scene_add_object(scene, "body", mesh, pose, material));
    assert_ok(ctx, asdic_scene_commit(scene));
    asdic_mesh_destroy(&mesh);
    return scene;
}

static inline asdic_scene *steel_scene(asdic_mesh *mesh) {
    asdic_pose pose = {.position_m = {400.0, -30.0, 12.0}, .yaw_rad = 0.3, .pitch_rad = -0.2};
    return scene_of(mesh, pose, asdic_material_facet(45.0, 0.0, 0.0));
}

/* Angle between the interpolated normal at the weighted point of T and that of EXPECTED. */
static inline double off_rad(const dev_triangle *t, const float p[3], asdic_vec3 expected) {
    vector n = smooth_normal(t, vector_load(p));
    double length =
        sqrt(expected.x * expected.x + expected.y * expected.y + expected.z * expected.z);
    double x = n.x - expected.x / length, y = n.y - expected.y / length,
           z = n.z - expected.z / length;
    return sqrt(x * x + y * y + z * z);
}

static inline void point_at(const dev_triangle *t, double u, double v, float p[3]) {
    for (int k = 0; k < 3; k++) {
        p[k] = (float)((1.0 - u - v) * t->v0[k] + u * t->v1[k] + v * t->v2[k]);
    }
}

/* Most that normals are off the radial ones, of a ball that SCENE holds. */
static inline double off_radial_rad(const asdic_scene *scene) {
    double most = 0.0;
    asdic_vec3 c = scene->parts[0].center_m, o = scene->origin_m;
    for (size_t i = 0; i < scene->triangle_count; i++) {
        const dev_triangle *t = &scene->triangles[i];
        assert_int_not_equal(t->corner_normals[0], DEV_FLAT);
        float p[3];
        point_at(t, 0.2 + 0.01 * (i % 7), 0.3, p);
        asdic_vec3 radial = {p[0] + o.x - c.x, p[1] + o.y - c.y, p[2] + o.z - c.z};
        most = fmax(most, off_rad(t, p, radial));
    }
    return most;
}

/* In [-1/2, 1/2), unlike for neighbouring numbers (the end of MurmurHash3, A. Appleby). */
static inline double jitter(uint32_t h) {
    h = (h ^ h >> 16) * 0x85ebca6bu;
    h = (h ^ h >> 13) * 0xc2b2ae35u;
    return (double)((h ^ h >> 16) & 0xffffu) / 65536.0 - 0.5;
}

#endif
