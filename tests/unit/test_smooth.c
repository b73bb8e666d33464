/* Flat patches and interpolated normals of facets that stand for curved surfaces. */
#include "asserts.h"

#include "kernels/smooth.h"
#include "scene/scene.h"
#include "scene/smooth.h"
#include "scene/triangles.h"

#include <asdic/asdic.h>

#define PI 3.14159265358979323846

static asdic_context *ctx;

static asdic_scene *scene_of(asdic_mesh *mesh, asdic_pose pose, asdic_material material) {
    asdic_scene *scene;
    assert_ok(ctx, asdic_scene_create(ctx, &scene));
    assert_ok(ctx, asdic_scene_add_object(scene, "body", mesh, pose, material));
    assert_ok(ctx, asdic_scene_commit(scene));
    asdic_mesh_destroy(&mesh);
    return scene;
}

static asdic_scene *steel_scene(asdic_mesh *mesh) {
    asdic_pose pose = {.position_m = {400.0, -30.0, 12.0}, .yaw_rad = 0.3, .pitch_rad = -0.2};
    return scene_of(mesh, pose, asdic_material_facet(45.0, 0.0, 0.0));
}

/* Angle between the interpolated normal at the weighted point of T and that of EXPECTED. */
static double off_rad(const dev_triangle *t, const float p[3], asdic_vec3 expected) {
    vector n = smooth_normal(t, vector_load(p));
    double length =
        sqrt(expected.x * expected.x + expected.y * expected.y + expected.z * expected.z);
    double x = n.x - expected.x / length, y = n.y - expected.y / length,
           z = n.z - expected.z / length;
    return sqrt(x * x + y * y + z * z);
}

static void point_at(const dev_triangle *t, double u, double v, float p[3]) {
    for (int k = 0; k < 3; k++) {
        p[k] = (float)((1.0 - u - v) * t->v0[k] + u * t->v1[k] + v * t->v2[k]);
    }
}

static void packing_keeps_directions(void **state) {
    (void)state;
    double most = 0.0;
    for (int i = 0; i < 20000; i++) { /* a spiral over the sphere, poles and seams included */
        double z = 1.0 - 2.0 * i / 19999.0, m = sqrt(fmax(1.0 - z * z, 0.0)), phi = 2.4 * i;
        vector n = smooth_unpack(asdic_smooth_pack((asdic_vec3){m * cos(phi), m * sin(phi), z}));
        most = fmax(most,
                    fmax(fabs(n.x - m * cos(phi)), fmax(fabs(n.y - m * sin(phi)), fabs(n.z - z))));
    }
    print_message("directions off by %.2g rad at most\n", most);
    assert_true(most < 6e-5);
    assert_true(asdic_smooth_pack((asdic_vec3){0, 0, -1}) != DEV_FLAT);
}

static void a_box_stays_flat(void **state) {
    (void)state;
    asdic_mesh *mesh;
    assert_ok(ctx, asdic_mesh_box(ctx, (asdic_vec3){4.0, 20.0, 2.0}, &mesh));
    asdic_scene *scene = steel_scene(mesh);
    int faces[3] = {0};
    for (size_t i = 0; i < scene->triangle_count; i++) {
        const dev_triangle *t = &scene->triangles[i];
        assert_int_equal(t->corner_normals[0], DEV_FLAT);
        assert_true(t->radius_m == 0.0f);
        faces[0] += fabs(t->flat_m2 - 40.0) < 1e-3;
        faces[1] += fabs(t->flat_m2 - 8.0) < 1e-3;
        faces[2] += fabs(t->flat_m2 - 80.0) < 1e-3;
    }
    assert_int_equal(faces[0], 4); /* ends: 20 x 2 */
    assert_int_equal(faces[1], 4); /* sides: 4 x 2 */
    assert_int_equal(faces[2], 4); /* top and bottom: 4 x 20 */
    asdic_scene_destroy(&scene);
}

static void a_sphere_is_round(void **state) {
    (void)state;
    static const unsigned segments[] = {16, 24, 96};
    for (int s = 0; s < 3; s++) {
        asdic_mesh *mesh;
        assert_ok(ctx, asdic_mesh_sphere(ctx, 0.5, segments[s], &mesh));
        asdic_scene *scene = steel_scene(mesh);
        double most = 0.0, least_m = 1e9, most_m = 0.0;
        asdic_vec3 c = scene->parts[0].center_m, o = scene->origin_m;
        for (size_t i = 0; i < scene->triangle_count; i++) {
            const dev_triangle *t = &scene->triangles[i];
            assert_int_not_equal(t->corner_normals[0], DEV_FLAT);
            float p[3];
            point_at(t, 0.2 + 0.01 * (i % 7), 0.3, p);
            asdic_vec3 radial = {p[0] + o.x - c.x, p[1] + o.y - c.y, p[2] + o.z - c.z};
            most = fmax(most, off_rad(t, p, radial));
            least_m = fmin(least_m, t->radius_m);
            most_m = fmax(most_m, t->radius_m);
        }
        double step = 2.0 * PI / segments[s];
        print_message("%u segments: normals off by %.3f of a step, radius %.3f to %.3f m\n",
                      segments[s], most / step, least_m, most_m);
        assert_true(most < 0.05 * step);
        assert_true(least_m > 0.4 && most_m < 0.65);
        asdic_scene_destroy(&scene);
    }
}

static void a_cylinder_is_straight_one_way(void **state) {
    (void)state;
    asdic_mesh *mesh;
    assert_ok(ctx, asdic_mesh_cylinder(ctx, 0.25, 2.0, 48, &mesh));
    asdic_scene *scene = steel_scene(mesh);
    int ends = 0;
    for (size_t i = 0; i < scene->triangle_count; i++) {
        const dev_triangle *t = &scene->triangles[i];
        if (t->corner_normals[0] == DEV_FLAT) {
            ends++;
            assert_close_relative(t->flat_m2, PI * 0.0625, 0.01); /* a polygon of 48 corners */
        } else {
            assert_close_relative(t->flat_m2, 4.0, 1e-3);
        }
        assert_true(t->radius_m == 0.0f || t->radius_m > 1e3f);
    }
    assert_int_equal(ends, 2 * 48);
    asdic_scene_destroy(&scene);
}

/* A face of 1 m with a rounded edge of five strips of 2 cm: the face stays flat, the strips do not. */
static void a_rounded_edge_leaves_its_face_flat(void **state) {
    (void)state;
    enum { STRIPS = 5, VERTICES = 2 * (STRIPS + 2) };
    double v[3 * VERTICES], x = 0.0, z = 0.0;
    uint32_t f[6 * (STRIPS + 1)];
    for (int i = 0; i < STRIPS + 2; i++) {
        for (int side = 0; side < 2; side++) {
            v[6 * i + 3 * side] = x;
            v[6 * i + 3 * side + 1] = side;
            v[6 * i + 3 * side + 2] = z;
        }
        double length = i == 0 ? 1.0 : 0.02, angle = 0.25 * i;
        x += length * cos(angle);
        z += length * sin(angle);
    }
    for (uint32_t i = 0; i < STRIPS + 1; i++) {
        uint32_t corners[6] = {2 * i, 2 * i + 1, 2 * i + 3, 2 * i, 2 * i + 3, 2 * i + 2};
        memcpy(f + 6 * i, corners, sizeof corners);
    }
    asdic_mesh *mesh;
    assert_ok(ctx, asdic_mesh_from_triangles(ctx, v, VERTICES, f, 2 * (STRIPS + 1), &mesh));
    asdic_scene *scene = steel_scene(mesh);
    for (int i = 0; i < 2 * (STRIPS + 1); i++) {
        bool face = i < 2;
        assert_int_equal(scene->triangles[i].corner_normals[0] == DEV_FLAT, face);
    }
    assert_close(scene->triangles[0].flat_m2, 1.0, 1e-4);
    asdic_scene_destroy(&scene);
}

/* The bottom law takes the facets' own normals. */
static asdic_mesh *body(int shape) {
    asdic_mesh *mesh = NULL;
    assert_ok(ctx, shape == 0   ? asdic_mesh_box(ctx, (asdic_vec3){4.0, 20.0, 2.0}, &mesh)
                   : shape == 1 ? asdic_mesh_sphere(ctx, 0.5, 24, &mesh)
                                : asdic_mesh_cylinder(ctx, 0.25, 2.0, 48, &mesh));
    return mesh;
}

/* Files may hold the facets of a body wound either way. */
static void facets_wound_either_way_are_one_body(void **state) {
    (void)state;
    for (int shape = 0; shape < 3; shape++) {
        asdic_mesh *mesh = body(shape);
        for (size_t i = 0; i < mesh->triangle_count; i++) {
            uint32_t *f = &mesh->indices[3 * i], second = f[1];
            if (i * 7 % 5 < 2) {
                f[1] = f[2];
                f[2] = second;
            }
        }
        asdic_scene *mixed = steel_scene(mesh), *right = steel_scene(body(shape));
        assert_int_equal(mixed->triangle_count, right->triangle_count);
        for (size_t i = 0; i < right->triangle_count; i++) {
            const dev_triangle *a = &mixed->triangles[i], *b = &right->triangles[i];
            float p[3], side = i * 7 % 5 < 2 ? -1.0f : 1.0f;
            point_at(b, 0.3, 0.3, p);
            vector n = smooth_normal(b, vector_load(p));
            assert_true((a->corner_normals[0] == DEV_FLAT) == (b->corner_normals[0] == DEV_FLAT));
            assert_close_relative(a->flat_m2, b->flat_m2, 1e-5);
            assert_close_relative(a->radius_m, b->radius_m, 1e-4);
            assert_true(off_rad(a, p, (asdic_vec3){side * n.x, side * n.y, side * n.z}) < 2e-4);
        }
        asdic_scene_destroy(&mixed);
        asdic_scene_destroy(&right);
    }
}

static void other_laws_stay_flat(void **state) {
    (void)state;
    asdic_mesh *mesh;
    assert_ok(ctx, asdic_mesh_sphere(ctx, 0.5, 24, &mesh));
    asdic_scene *scene =
        scene_of(mesh, (asdic_pose){.position_m = {9.0, 0.0, 3.0}}, asdic_material_bottom(2.0));
    for (size_t i = 0; i < scene->triangle_count; i++) {
        assert_int_equal(scene->triangles[i].corner_normals[0], DEV_FLAT);
    }
    asdic_scene_destroy(&scene);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(packing_keeps_directions),
        cmocka_unit_test(a_box_stays_flat),
        cmocka_unit_test(a_sphere_is_round),
        cmocka_unit_test(a_cylinder_is_straight_one_way),
        cmocka_unit_test(a_rounded_edge_leaves_its_face_flat),
        cmocka_unit_test(facets_wound_either_way_are_one_body),
        cmocka_unit_test(other_laws_stay_flat),
    };
    if (asdic_context_create(&ctx) != ASDIC_OK) {
        return 1;
    }
    int failed = cmocka_run_group_tests(tests, NULL, NULL);
    asdic_context_destroy(&ctx);
    return failed;
}
