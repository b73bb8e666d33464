/* Flat patches and interpolated normals of facets that stand for curved surfaces. */
#include "asserts.h"

#include "base/clock.h"
#include "base/vec.h"
#include "kernels/smooth.h"
#include "scene/mesh_build.h"
#include "scene/scene.h"
#include "scene/point_tree.h"
#include "scene/smooth.h"
#include "scene/triangles.h"

#include <asdic/asdic.h>

#include <stdlib.h>
#include <string.h>

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

/* Most that normals are off the radial ones, of a ball that SCENE holds. */
static double off_radial_rad(const asdic_scene *scene) {
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

static void a_sphere_is_round(void **state) {
    (void)state;
    static const unsigned segments[] = {16, 24, 96};
    for (int s = 0; s < 3; s++) {
        asdic_mesh *mesh;
        assert_ok(ctx, asdic_mesh_sphere(ctx, 0.5, segments[s], &mesh));
        asdic_scene *scene = steel_scene(mesh);
        double most = off_radial_rad(scene), least_m = 1e9, most_m = 0.0;
        for (size_t i = 0; i < scene->triangle_count; i++) {
            least_m = fmin(least_m, scene->triangles[i].radius_m);
            most_m = fmax(most_m, scene->triangles[i].radius_m);
        }
        double step = 2.0 * PI / segments[s];
        print_message("%u segments: normals off by %.3f of a step, radius %.3f to %.3f m\n",
                      segments[s], most / step, least_m, most_m);
        assert_true(most < 0.05 * step);
        assert_true(least_m > 0.4 && most_m < 0.65);
        asdic_scene_destroy(&scene);
    }
}

/* Facets of all sizes side by side, as marching cubes leave them: every third ring and meridian of a
 * ball moved nine tenths of the way to the next. */
static void a_ball_of_unequal_facets_is_round(void **state) {
    (void)state;
    enum { SEGMENTS = 48 };
    asdic_mesh *mesh;
    assert_ok(ctx, asdic_mesh_sphere(ctx, 0.5, SEGMENTS, &mesh));
    for (size_t i = 1; i + 1 < mesh->vertex_count; i++) {
        double *v = &mesh->vertices_m[3 * i], ring = floor((double)(i - 1) / SEGMENTS);
        double polar = acos(v[2] / 0.5), azimuth = atan2(v[1], v[0]), step = 2.0 * PI / SEGMENTS;
        polar += fmod(ring, 3.0) == 0.0 ? 0.9 * step : 0.0;
        azimuth += i % 3 == 1 ? 0.9 * step : 0.0;
        v[0] = 0.5 * sin(polar) * cos(azimuth);
        v[1] = 0.5 * sin(polar) * sin(azimuth);
        v[2] = 0.5 * cos(polar);
    }
    asdic_scene *scene = steel_scene(mesh);
    double most = off_radial_rad(scene) * SEGMENTS / (2.0 * PI);
    print_message("normals off by %.3f of a step\n", most);
    assert_true(most < 0.05);
    asdic_scene_destroy(&scene);
}

/* Every facet with corners of its own, apart by the last bit of single precision or none. */
static void twins_are_one_vertex(void **state) {
    (void)state;
    asdic_mesh *ball, *mesh;
    assert_ok(ctx, asdic_mesh_sphere(ctx, 0.5, 24, &ball));
    size_t corners = 3 * ball->triangle_count;
    double *v = malloc(3 * corners * sizeof *v);
    uint32_t *f = malloc(corners * sizeof *f);
    assert_true(v && f);
    for (size_t i = 0; i < corners; i++) {
        f[i] = (uint32_t)i;
        for (size_t k = 0; k < 3; k++) {
            v[3 * i + k] = ball->vertices_m[3 * ball->indices[i] + k] + 6e-8 * (double)(i * 7 % 3);
        }
    }
    assert_ok(ctx, asdic_mesh_from_triangles(ctx, v, corners, f, corners / 3, &mesh));
    assert_int_equal(asdic_mesh_get_info(mesh).open_edges, 0);
    asdic_scene *scene = steel_scene(mesh);
    assert_true(off_radial_rad(scene) < 0.05 * 2.0 * PI / 24);
    asdic_scene_destroy(&scene);
    asdic_mesh_destroy(&ball);
    free(v);
    free(f);
}

/* However small beside the mesh, a facet keeps three corners; and cracks of 1e-5 stay open. */
static void neighbours_are_no_twins(void **state) {
    (void)state;
    static const double v[] = {0, 0, 0, 1,    0, 0, 1,        1,    0, /* a large facet */
                               0, 0, 2, 1e-7, 0, 2, 1e-7,     1e-7, 2, /* and a tiny one */
                               0, 0, 0, 1,    1, 0, -0.00001, 1,    0};
    static const uint32_t f[] = {0, 1, 2, 3, 4, 5, 6, 7, 8}, near[] = {0, 1, 2, 6, 7, 8};
    asdic_mesh *mesh;
    assert_ok(ctx, asdic_mesh_from_triangles(ctx, v, 9, f, 3, &mesh));
    assert_int_equal(asdic_mesh_get_info(mesh).open_edges, 7);
    asdic_mesh_destroy(&mesh);
    assert_ok(ctx, asdic_mesh_from_triangles(ctx, v, 9, near, 2, &mesh));
    assert_int_equal(asdic_mesh_get_info(mesh).open_edges, 4);
    asdic_mesh_destroy(&mesh);
}

/* A ball of rings and meridians whose poles are rings of POLE_M; LOOSE: of facets of their own corners. */
static asdic_mesh *ball_of_rings(double pole_m, bool loose) {
    enum { RINGS = 25, SEGMENTS = 48, FACETS = 2 * (RINGS - 1) * SEGMENTS };
    double v[3 * RINGS * SEGMENTS];
    uint32_t f[3 * FACETS];
    for (uint32_t i = 0; i < RINGS * SEGMENTS; i++) {
        double polar = PI * (i / SEGMENTS) / (RINGS - 1), azimuth = 2.0 * PI * i / SEGMENTS;
        double across = fmax(0.5 * sin(polar), pole_m);
        v[3 * i] = across * cos(azimuth);
        v[3 * i + 1] = across * sin(azimuth);
        v[3 * i + 2] = 0.5 * cos(polar);
    }
    for (uint32_t i = 0; i < (RINGS - 1) * SEGMENTS; i++) {
        uint32_t a = i, b = i / SEGMENTS * SEGMENTS + (i + 1) % SEGMENTS;
        const uint32_t two[] = {a, a + SEGMENTS, b + SEGMENTS, a, b + SEGMENTS, b};
        memcpy(f + 6 * i, two, sizeof two);
    }
    asdic_mesh *mesh;
    if (loose) {
        double own[9 * FACETS];
        for (uint32_t i = 0; i < 3 * FACETS; i++) {
            memcpy(own + 3 * i, v + 3 * f[i], 3 * sizeof *v);
            f[i] = i;
        }
        assert_ok(ctx, asdic_mesh_from_triangles(ctx, own, 3 * FACETS, f, FACETS, &mesh));
    } else {
        assert_ok(ctx, asdic_mesh_from_triangles(ctx, v, RINGS * SEGMENTS, f, FACETS, &mesh));
    }
    return mesh;
}

static void a_pole_of_roundings_is_one_vertex(void **state) {
    (void)state;
    static const double poles_m[] = {0.0, 1e-17, 1e-12, 4e-8, 1e-6};
    for (int p = 0; p < 10; p++) {
        asdic_mesh *mesh = ball_of_rings(poles_m[p / 2], p % 2);
        asdic_mesh_info info = asdic_mesh_get_info(mesh);
        assert_int_equal(info.open_edges, 0);
        assert_int_equal(info.dropped, 2 * 48);
        asdic_scene *scene = steel_scene(mesh);
        double most = off_radial_rad(scene) * 48 / (2.0 * PI);
        print_message("poles of %g m: normals off by %.3f of a step\n", poles_m[p / 2], most);
        assert_true(most < 0.05);
        asdic_scene_destroy(&scene);
    }
}

/* Slivers from the rim of a hole, whose ends lead round it, in any order; in the plate's 2 m it is no rounding. */
static void a_fine_hole_stays_one(void **state) {
    (void)state;
    enum { SEGMENTS = 1000 };
    double v[6 * SEGMENTS];
    uint32_t f[6 * SEGMENTS];
    for (uint32_t i = 0; i < SEGMENTS; i++) {
        double azimuth = 2.0 * PI * i / SEGMENTS, c = cos(azimuth), s = sin(azimuth);
        const double rims[] = {0.5e-3 * c, 0.5e-3 * s, 0.0, c, s, 0.0};
        memcpy(v + 3 * i, rims, sizeof rims / 2);
        memcpy(v + 3 * (i + SEGMENTS), rims + 3, sizeof rims / 2);
    }
    for (int turned = 0; turned < 2; turned++) {
        for (uint32_t i = 0; i < SEGMENTS; i++) {
            uint32_t a = turned ? SEGMENTS - 1 - i : i, b = (a + 1) % SEGMENTS;
            const uint32_t two[] = {a, a + SEGMENTS, b + SEGMENTS, a, b + SEGMENTS, b};
            memcpy(f + 6 * i, two, sizeof two);
        }
        asdic_mesh *mesh;
        assert_ok(ctx, asdic_mesh_from_triangles(ctx, v, 2 * SEGMENTS, f, 2 * SEGMENTS, &mesh));
        asdic_mesh_info info = asdic_mesh_get_info(mesh);
        print_message("%zu facets, %zu open edges\n", info.triangles, info.open_edges);
        assert_int_equal(info.triangles, info.open_edges);
        assert_true(info.open_edges > SEGMENTS + 250); /* the rim's too */
        asdic_mesh_destroy(&mesh);
    }
}

/* Facets of their own corners, apart by roundings, and one facet beside them of which an edge is a rounding; or all of
 * whose edges are. */
static void a_sliver_parts_no_twins(void **state) {
    (void)state;
    for (int point = 0; point < 2; point++) {
        asdic_mesh *ball, *mesh;
        assert_ok(ctx, asdic_mesh_sphere(ctx, 0.5, 24, &ball));
        size_t corners = 3 * ball->triangle_count;
        double *v = malloc(3 * (corners + 3) * sizeof *v), length_m = point ? 1e-9 : 1e-2;
        uint32_t *f = malloc((corners + 3) * sizeof *f);
        assert_true(v && f);
        for (size_t i = 0; i < corners + 3; i++) {
            f[i] = (uint32_t)i;
            for (size_t k = 0; k < 3 && i < corners; k++) {
                v[3 * i + k] =
                    ball->vertices_m[3 * ball->indices[i] + k] + 6e-8 * (double)(i * 7 % 3);
            }
        }
        const double sliver[] = {0.4, 0.0, 0.0, 0.4, 0.0, 1e-9, 0.4, length_m, 0.0};
        memcpy(v + 3 * corners, sliver, sizeof sliver);
        assert_ok(ctx, asdic_mesh_from_triangles(ctx, v, corners + 3, f, corners / 3 + 1, &mesh));
        assert_int_equal(asdic_mesh_get_info(mesh).open_edges, 0);
        assert_int_equal(asdic_mesh_get_info(mesh).dropped, 1);
        asdic_scene *scene = steel_scene(mesh);
        assert_true(off_radial_rad(scene) < 0.05 * 2.0 * PI / 24);
        asdic_scene_destroy(&scene);
        asdic_mesh_destroy(&ball);
        free(v);
        free(f);
    }
}

/* Long strips whose width is no rounding beside their length keep it, and small details beside what is large. */
static void what_is_thin_is_no_rounding(void **state) {
    (void)state;
    asdic_mesh *mesh, *ball;
    for (size_t ends = 0; ends < 2;
         ends++) { /* a tether of 2 mm, open or with caps, of strips of 1 km */
        assert_ok(ctx, asdic_mesh_cylinder(ctx, 0.001, 1000.0, 48, &ball));
        size_t count = ends ? ball->triangle_count : 2 * 48, kept = 0;
        for (size_t i = 0; i < ball->triangle_count; i++) {
            double c[9];
            asdic_mesh_corners(ball, i, c);
            if (ends || c[1] != c[4] || c[1] != c[7]) {
                memmove(&ball->indices[3 * kept++], &ball->indices[3 * i], 3 * sizeof(uint32_t));
            }
        }
        assert_int_equal(kept, count);
        assert_ok(ctx, asdic_mesh_from_triangles(ctx, ball->vertices_m, ball->vertex_count,
                                                 ball->indices, count, &mesh));
        assert_int_equal(asdic_mesh_get_info(mesh).triangles, count);
        assert_int_equal(asdic_mesh_get_info(mesh).open_edges, ends ? 0 : 2 * 48);
        asdic_mesh_destroy(&mesh);
        asdic_mesh_destroy(&ball);
    }
    assert_ok(ctx, asdic_mesh_sphere(ctx, 0.01, 48, &ball)); /* within 20 km */
    size_t vertices = ball->vertex_count, triangles = ball->triangle_count;
    double *v = malloc(3 * (vertices + 3) * sizeof *v);
    uint32_t *f = malloc(3 * (triangles + 1) * sizeof *f);
    assert_true(v && f);
    memcpy(v, ball->vertices_m, 3 * vertices * sizeof *v);
    memcpy(f, ball->indices, 3 * triangles * sizeof *f);
    const double large[] = {-1e4, -1e4, 1.0, 1e4, -1e4, 1.0, 0.0, 1e4, 1.0};
    memcpy(v + 3 * vertices, large, sizeof large);
    for (uint32_t k = 0; k < 3; k++) {
        f[3 * triangles + k] = (uint32_t)vertices + k;
    }
    assert_ok(ctx, asdic_mesh_from_triangles(ctx, v, vertices + 3, f, triangles + 1, &mesh));
    size_t lost = asdic_mesh_get_info(mesh).dropped;
    print_message("of %zu facets of a ball of 2 cm %zu are lost in 20 km\n", triangles, lost);
    assert_int_equal(asdic_mesh_get_info(mesh).open_edges, 3);
    /* single precision has 1.2 mm there: rings about the poles are points */
    assert_true(lost <= 4 * 48);
    asdic_mesh_destroy(&mesh);
    asdic_mesh_destroy(&ball);
    free(v);
    free(f);
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

/* A capped cylinder of strips of 15 degrees, one of which is cut into eight: each is as round as any other. */
static void fine_strips_leave_a_capped_cylinder_round(void **state) {
    (void)state;
    enum { COARSE = 24, FINE = 8, ROUND = COARSE - 1 + FINE };
    double v[6 * ROUND + 6];
    uint32_t f[3 * 4 * ROUND];
    for (uint32_t i = 0; i < ROUND; i++) {
        double angle = i < FINE ? 2.0 * PI / COARSE * i / FINE : 2.0 * PI / COARSE * (i + 1 - FINE);
        for (int end = 0; end < 2; end++) {
            double *at = v + 6 * i + 3 * end;
            at[0] = 0.1 * cos(angle);
            at[1] = 0.1 * sin(angle);
            at[2] = 0.3 * end;
        }
        uint32_t a = 2 * i, b = 2 * ((i + 1) % ROUND), low = 2 * ROUND, high = low + 1;
        const uint32_t one_way[] = {a, b, b + 1, a, b + 1, a + 1, low, b, a, high, a + 1, b + 1};
        const uint32_t other[] = {a, b, a + 1, b, b + 1, a + 1, low, b, a, high, a + 1, b + 1};
        memcpy(f + 12 * i, i % 3 ? one_way : other, sizeof other);
    }
    const double ends[] = {0.0, 0.0, 0.0, 0.0, 0.0, 0.3};
    memcpy(v + 6 * ROUND, ends, sizeof ends);
    asdic_mesh *mesh;
    assert_ok(ctx, asdic_mesh_from_triangles(ctx, v, 2 * ROUND + 2, f, 4 * ROUND, &mesh));
    asdic_pose upright = {.position_m = {40.0, 0.0, 12.0}};
    asdic_scene *scene = scene_of(mesh, upright, asdic_material_facet(45.0, 0.0, 0.0));
    double most = 0.0;
    size_t caps = 0;
    for (size_t i = 0; i < scene->triangle_count; i++) {
        const dev_triangle *t = &scene->triangles[i];
        if (t->corner_normals[0] == DEV_FLAT) {
            caps++;
            continue;
        }
        for (int k = 0; k < 3; k++) {
            float p[3];
            point_at(t, k == 1, k == 2, p);
            double x = p[0] + scene->origin_m.x - 40.0, y = p[1] + scene->origin_m.y;
            most = fmax(most, off_rad(t, p, (asdic_vec3){x, y, 0.0}) * COARSE / (2.0 * PI));
        }
    }
    print_message("normals off by %.3f of a coarse strip's step\n", most);
    assert_true(most < 0.25);
    assert_int_equal(caps, 2 * ROUND);
    asdic_scene_destroy(&scene);
}

/* In [-1/2, 1/2), unlike for neighbouring numbers (the end of MurmurHash3, A. Appleby). */
static double jitter(uint32_t h) {
    h = (h ^ h >> 16) * 0x85ebca6bu;
    h = (h ^ h >> 13) * 0xc2b2ae35u;
    return (double)((h ^ h >> 16) & 0xffffu) / 65536.0 - 0.5;
}

/* A tube of 0.25 m by 1 m with caps: strips of uneven width, each cut into as many pieces by rings; LOOSE, every vertex goes
 * its own way on the tube, as meshers leave them. */
static asdic_mesh *uneven_tube(uint32_t strips, uint32_t pieces, bool loose, double share) {
    uint32_t rings = pieces + 1, ends = rings * strips, facets = 0;
    double *v = malloc(3 * (ends + 2) * sizeof *v);
    uint32_t *f = malloc(6 * strips * rings * sizeof *f);
    assert_true(v && f);
    for (uint32_t i = 0; i < ends; i++) {
        uint32_t ring = i / strips, strip = i % strips;
        bool inner = ring > 0 && ring < pieces;
        double aside = share * jitter(loose ? i : strip), half = loose ? 0.5 * (ring % 2) : 0.0;
        double angle = 2.0 * PI * (strip + half + aside) / strips;
        v[3 * i] = 0.25 * cos(angle);
        v[3 * i + 1] = 0.25 * sin(angle);
        v[3 * i + 2] = (ring + (inner ? share * jitter(loose ? i + 7919 : ring) : 0.0)) / pieces;
    }
    const double middles[] = {0.0, 0.0, 0.0, 0.0, 0.0, 1.0};
    memcpy(v + 3 * ends, middles, sizeof middles);
    for (uint32_t i = 0; i < ends; i++) {
        uint32_t ring = i / strips, next = ring * strips + (i + 1) % strips;
        uint32_t a = ring % 2 && loose ? next + strips : i + strips, b = next + strips;
        if (ring == 0 || ring == pieces) {
            const uint32_t cap[] = {ring ? i : next, ring ? next : i, ends + (ring > 0)};
            memcpy(f + 3 * facets++, cap, sizeof cap);
        }
        if (ring < pieces && ring % 2 && loose) { /* the ring above lies half a strip back */
            const uint32_t two[] = {i, next, b, i, b, i + strips};
            memcpy(f + 3 * facets, two, sizeof two);
            facets += 2;
        } else if (ring < pieces) {
            const uint32_t two[] = {i, next, a, next, b, a};
            memcpy(f + 3 * facets, two, sizeof two);
            facets += 2;
        }
    }
    asdic_mesh *mesh;
    assert_ok(ctx, asdic_mesh_from_triangles(ctx, v, ends + 2, f, facets, &mesh));
    free(v);
    free(f);
    return mesh;
}

/* The same of strips that are each cut at heights of their own: their vertices lie on the next ones' edges. */
static asdic_mesh *tube_cut_apart(uint32_t strips, uint32_t pieces, double share) {
    uint32_t rows = 2 * (pieces + 1), vertices = strips * rows, facets = 0;
    double *v = malloc(3 * (vertices + 2) * sizeof *v);
    uint32_t *f = malloc(6 * strips * (pieces + 1) * sizeof *f);
    assert_true(v && f);
    for (uint32_t i = 0; i < vertices; i++) {
        uint32_t row = i % rows / 2, strip = (i / rows + i % 2) % strips;
        double angle = 2.0 * PI * (strip + share * jitter(strip)) / strips;
        bool inner = row > 0 && row < pieces;
        v[3 * i] = 0.25 * cos(angle);
        v[3 * i + 1] = 0.25 * sin(angle);
        v[3 * i + 2] = (row + (inner ? share * jitter(i / 2 + 7919) : 0.0)) / pieces;
    }
    const double middles[] = {0.0, 0.0, 0.0, 0.0, 0.0, 1.0};
    memcpy(v + 3 * vertices, middles, sizeof middles);
    for (uint32_t strip = 0; strip < strips; strip++) {
        uint32_t low = strip * rows, high = low + rows - 2;
        const uint32_t caps[] = {low + 1, low, vertices, high, high + 1, vertices + 1};
        memcpy(f + 3 * facets, caps, sizeof caps);
        facets += 2;
        for (uint32_t i = low; i < high; i += 2, facets += 2) {
            const uint32_t two[] = {i, i + 1, i + 2, i + 1, i + 3, i + 2};
            memcpy(f + 3 * facets, two, sizeof two);
        }
    }
    asdic_mesh *mesh;
    assert_ok(ctx, asdic_mesh_from_triangles(ctx, v, vertices + 2, f, facets, &mesh));
    free(v);
    free(f);
    return mesh;
}

/* What a tube returns broadside is that of its length in phase while its normals keep to the plane across. */
static void assert_tube(asdic_mesh *mesh, const char *name, uint32_t strips, double share,
                        double rms_rad) {
    asdic_pose upright = {.position_m = {40.0, 0.0, 12.0}};
    asdic_scene *scene = scene_of(mesh, upright, asdic_material_facet(45.0, 0.0, 0.0));
    double sum = 0.0, sides = 0.0, straight = 0.0, most = 0.0;
    for (size_t k = 0; k < scene->triangle_count; k++) {
        const dev_triangle *t = &scene->triangles[k];
        if (fabsf(t->normal[2]) > 0.9f) {
            assert_int_equal(t->corner_normals[0], DEV_FLAT);
            continue;
        }
        assert_int_not_equal(t->corner_normals[0], DEV_FLAT);
        for (int c = 0; c < 3; c++) {
            float p[3];
            point_at(t, c == 1, c == 2, p);
            double x = p[0] + scene->origin_m.x - 40.0, y = p[1] + scene->origin_m.y;
            most = fmax(most, off_rad(t, p, (asdic_vec3){x, y, 0.0}));
            double along = smooth_unpack(t->corner_normals[c]).z;
            sum += along * along / 3.0;
        }
        sides++;
        straight += t->radius_m == 0.0f && fabs(t->flat_m2 - 1.0) < 0.1;
    }
    print_message(
        "%u strips %s: off the radial %.4f rad, along %.5f r.m.s., %.3f of it straight along "
        "1 m\n",
        strips, name, most, sqrt(sum / sides), straight / sides);
    assert_true(most < share * 2.0 * PI / strips);
    assert_true(sqrt(sum / sides) < rms_rad);
    assert_true(straight == sides);
    asdic_scene_destroy(&scene);
}

static void uneven_tubes_are_round_and_straight(void **state) {
    (void)state;
    assert_tube(uneven_tube(24, 3, false, 0.95), "in 3", 24, 0.15, 1e-4);
    assert_tube(uneven_tube(32, 6, false, 0.95), "in 6", 32, 0.15, 1e-4);
    assert_tube(uneven_tube(48, 24, true, 0.4), "loose in 24", 48, 0.15, 1.5e-3);
    assert_tube(uneven_tube(96, 48, true, 0.4), "loose in 48", 96, 0.15, 0.7e-3);
}

/* No edge is common to two strips. */
static void a_tube_of_strips_cut_apart_is_round_and_straight(void **state) {
    (void)state;
    assert_tube(tube_cut_apart(24, 4, 0.5), "apart in 4", 24, 0.01, 1e-4);
    assert_tube(tube_cut_apart(32, 6, 0.8), "apart in 6", 32, 0.01, 1e-4);
}

enum { LONG = 40, WIDE = 20, VERTICES = (LONG + 1) * (WIDE + 1) };

/* A plate of 1 by 0.5 m, tilted, of uneven facets; waves of HEIGHT_M run along it, coordinates are whole STEPS_M. */
static asdic_scene *plate(double height_m, double step_m) {
    double v[3 * VERTICES];
    uint32_t f[6 * LONG * WIDE], facets = 0;
    for (uint32_t i = 0; i < VERTICES; i++) {
        uint32_t column = i / (WIDE + 1), row = i % (WIDE + 1);
        bool inner = column > 0 && column < LONG && row > 0 && row < WIDE;
        double x = (column + (inner ? 0.5 * jitter(i) : 0.0)) / LONG;
        double y = (row + (inner ? 0.5 * jitter(i + 7919) : 0.0)) / WIDE * 0.5;
        double up = height_m * sin(2.0 * PI * 4.0 * x), across = 0.296 * x + 0.955 * y;
        double turned[] = {0.955 * x - 0.296 * y, 0.8 * across - 0.6 * up, 0.6 * across + 0.8 * up};
        for (int k = 0; k < 3; k++) {
            v[3 * i + k] = step_m * round(turned[k] / step_m);
        }
        if (column < LONG && row < WIDE) {
            const uint32_t two[] = {i, i + WIDE + 1, i + WIDE + 2, i, i + WIDE + 2, i + 1};
            memcpy(f + 3 * facets, two, sizeof two);
            facets += 2;
        }
    }
    asdic_mesh *mesh;
    assert_ok(ctx, asdic_mesh_from_triangles(ctx, v, VERTICES, f, facets, &mesh));
    return scene_of(mesh, (asdic_pose){.position_m = {0.0, 0.0, 12.0}},
                    asdic_material_facet(45.0, 0.0, 0.0));
}

/* A file that gives tenths of millimetres: facets of a flat plate lean by hundredths of a radian. */
static void a_plate_of_rounded_coordinates_is_flat(void **state) {
    (void)state;
    asdic_scene *scene = plate(0.0, 1e-4);
    double most = 0.0;
    for (size_t i = 0; i < scene->triangle_count; i++) {
        const dev_triangle *t = &scene->triangles[i];
        float p[3];
        point_at(t, 0.3, 0.3, p);
        most = fmax(most, off_rad(t, p, (asdic_vec3){0.0, -0.6, 0.8}));
        assert_close_relative(t->flat_m2, 0.5 * (0.955 * 0.955 + 0.296 * 0.296), 1e-3);
        assert_true(t->radius_m == 0.0f);
    }
    print_message("normals off by %.5f rad\n", most);
    assert_true(most < 2e-4);
    asdic_scene_destroy(&scene);
}

/* Waves no higher than roundings are: facets beside one another lean alike. */
static void a_plate_of_low_waves_is_not(void **state) {
    (void)state;
    asdic_scene *scene = plate(1e-4, 1e-9);
    double most = 0.0;
    for (size_t i = 0; i < scene->triangle_count; i++) {
        float p[3];
        point_at(&scene->triangles[i], 0.3, 0.3, p);
        most = fmax(most, off_rad(&scene->triangles[i], p, (asdic_vec3){0.0, -0.6, 0.8}));
    }
    print_message("normals up to %.5f rad off\n", most);
    assert_true(most > 0.8 * 2.0 * PI * 4.0 * 1e-4); /* they lean by that */
    asdic_scene_destroy(&scene);
}

/* Open strips of 10 m round an axis: a line, thinner than a thousandth of its length, a slat. */
static void what_is_long_and_thin_stays_round(void **state) {
    (void)state;
    static const struct {
        const char *name;
        double radius_m, turn_rad;
        uint32_t strips;
    } shapes[] = {{"line", 0.0015, 2.0 * PI, 16}, {"slat", 0.417, 0.24, 8}};
    for (int k = 0; k < 2; k++) {
        double v[6 * 17];
        uint32_t f[6 * 16], strips = shapes[k].strips, count = k == 0 ? strips : strips + 1;
        for (uint32_t i = 0; i < 2 * count; i++) {
            double angle = shapes[k].turn_rad * (i / 2) / strips;
            v[3 * i] = shapes[k].radius_m * cos(angle);
            v[3 * i + 1] = shapes[k].radius_m * sin(angle);
            v[3 * i + 2] = 10.0 * (i % 2);
        }
        for (uint32_t i = 0; i < strips; i++) {
            uint32_t low = 2 * i, next = 2 * ((i + 1) % count);
            const uint32_t two[] = {low, next, next + 1, low, next + 1, low + 1};
            memcpy(f + 6 * i, two, sizeof two);
        }
        asdic_mesh *mesh;
        assert_ok(ctx, asdic_mesh_from_triangles(ctx, v, 2 * count, f, 2 * strips, &mesh));
        asdic_scene *scene =
            scene_of(mesh, (asdic_pose){.yaw_rad = 0.0}, asdic_material_facet(45.0, 0.0, 0.0));
        double most = 0.0;
        for (uint32_t i = 0; i < 2 * strips; i++) {
            const dev_triangle *t = &scene->triangles[i];
            assert_int_not_equal(t->corner_normals[0], DEV_FLAT);
            float p[3];
            point_at(t, 1.0 / 3.0, 1.0 / 3.0, p);
            double x = p[0] + scene->origin_m.x, y = p[1] + scene->origin_m.y;
            most = fmax(most, off_rad(t, p, (asdic_vec3){x, y, 0.0}));
        }
        print_message("%s: normals off by %.4f rad\n", shapes[k].name, most);
        assert_true(most < 0.4 * shapes[k].turn_rad / strips);
        asdic_scene_destroy(&scene);
    }
}

/* Strips of 1 m that turn by so much from one to the next, each in CUTS along its width. */
static asdic_scene *folded(const double *lengths_m, const double *turns_rad, int strips, int cuts) {
    enum { MOST = 16 };
    double v[6 * (MOST + 1)] = {0}, angle = 0.0;
    uint32_t f[6 * MOST];
    uint32_t count = (uint32_t)(strips * cuts);
    assert_true(count <= MOST);
    for (uint32_t i = 0; i < count; i++) {
        int strip = (int)i / cuts;
        angle += (int)i % cuts == 0 ? turns_rad[strip] : 0.0;
        v[6 * i + 4] = 1.0;
        for (int side = 0; side < 2; side++) {
            v[6 * i + 6 + 3 * side] = v[6 * i] + lengths_m[strip] / cuts * cos(angle);
            v[6 * i + 7 + 3 * side] = side;
            v[6 * i + 8 + 3 * side] = v[6 * i + 2] + lengths_m[strip] / cuts * sin(angle);
        }
        uint32_t corners[6] = {2 * i, 2 * i + 1, 2 * i + 3, 2 * i, 2 * i + 3, 2 * i + 2};
        memcpy(f + 6 * i, corners, sizeof corners);
    }
    asdic_mesh *mesh;
    assert_ok(ctx, asdic_mesh_from_triangles(ctx, v, 2 * (count + 1), f, 2 * count, &mesh));
    return steel_scene(mesh);
}

/* A face of 1 m stays flat, whether its edge is rounded by five strips of 2 cm, which do not, or
 * bevelled by one, and whatever it is cut into. */
static void an_edge_leaves_its_face_flat(void **state) {
    (void)state;
    static const double round_m[] = {1.0, 0.02, 0.02, 0.02, 0.02, 0.02};
    static const double round_rad[] = {0.0, 0.25, 0.25, 0.25, 0.25, 0.25};
    static const double bevel_m[] = {1.0, 0.02, 1.0}, bevel_rad[] = {0.0, 0.5, 0.5};
    for (int bevel = 0; bevel < 2; bevel++) {
        for (int cuts = 1; cuts < 3; cuts++) {
            int strips = bevel ? 3 : 6;
            asdic_scene *scene =
                folded(bevel ? bevel_m : round_m, bevel ? bevel_rad : round_rad, strips, cuts);
            for (int i = 0; i < 2 * cuts * strips; i++) {
                bool face = (bevel ? bevel_m : round_m)[i / 2 / cuts] == 1.0;
                bool flat = scene->triangles[i].corner_normals[0] == DEV_FLAT;
                assert_true(face ? flat : !flat || cuts > 1);
            }
            assert_close(scene->triangles[0].flat_m2, 1.0, 1e-4);
            asdic_scene_destroy(&scene);
        }
    }
}

/* Plates of one width, two or three: nothing goes on turning; five do. */
static void few_plates_stay_flat(void **state) {
    (void)state;
    static const double lengths_m[5] = {1.0, 1.0, 1.0, 1.0, 1.0};
    static const double turns_rad[] = {0.02, 0.1, 0.2, 0.5};
    for (int k = 0; k < 4; k++) {
        double turn = turns_rad[k], rad[5] = {0.0, turn, turn, turn, turn};
        for (int strips = 2; strips <= 5; strips += strips == 3 ? 2 : 1) {
            for (int cuts = 1; cuts <= 3; cuts++) {
                asdic_scene *scene = folded(lengths_m, rad, strips, cuts);
                for (int i = 0; i < 2 * cuts * strips; i++) {
                    bool flat = scene->triangles[i].corner_normals[0] == DEV_FLAT;
                    int quad = i / 2, at = quad % cuts;
                    bool bent = (at == 0 && quad > 0) || (at == cuts - 1 && quad < 5 * cuts - 1);
                    assert_int_equal(flat, strips < 5 || !bent);
                }
                asdic_scene_destroy(&scene);
            }
        }
    }
}

typedef struct ring {
    double x_m, radius_m;
} ring;

/* COUNT rings of SIDES corners about x, closed by caps, at CREASE_RAD. */
static asdic_scene *lathe(const ring *rings, uint32_t count, uint32_t sides, double crease_rad) {
    uint32_t ends = count * sides, facets = 0;
    double *v = calloc(3 * (ends + 2), sizeof *v);
    uint32_t *f = malloc(6 * ends * sizeof *f);
    assert_true(v && f);
    for (uint32_t i = 0; i < ends; i++) {
        uint32_t level = i / sides, next = i % sides + 1 < sides ? i + 1 : i + 1 - sides;
        double angle = 2.0 * PI * (i % sides + 0.5) / sides;
        v[3 * i] = rings[level].x_m;
        v[3 * i + 1] = rings[level].radius_m * cos(angle);
        v[3 * i + 2] = rings[level].radius_m * sin(angle);
        if (level == 0 || level + 1 == count) {
            const uint32_t cap[] = {level ? i : next, level ? next : i, ends + (level > 0)};
            memcpy(f + 3 * facets++, cap, sizeof cap);
        }
        if (level + 1 < count) {
            const uint32_t two[] = {i, next, next + sides, i, next + sides, i + sides};
            memcpy(f + 3 * facets, two, sizeof two);
            facets += 2;
        }
    }
    v[3 * ends] = rings[0].x_m;
    v[3 * ends + 3] = rings[count - 1].x_m;
    asdic_mesh *mesh;
    assert_ok(ctx, asdic_mesh_from_triangles(ctx, v, ends + 2, f, facets, &mesh));
    free(v);
    free(f);
    asdic_scene *scene;
    assert_ok(ctx, asdic_scene_create(ctx, &scene));
    assert_ok(ctx, asdic_scene_set_crease(scene, crease_rad));
    assert_ok(ctx, asdic_scene_add_object(scene, "body", mesh, (asdic_pose){.position_m.z = 9.0},
                                          asdic_material_facet(45.0, 0.0, 0.0)));
    assert_ok(ctx, asdic_scene_commit(scene));
    asdic_mesh_destroy(&mesh);
    return scene;
}

#define CREASE_RAD (35.0 * PI / 180.0)

/* How many facets of SCENE are flat; of the others, the most that a corner's normal leans along x off its facet's own. */
static size_t count_flat(const asdic_scene *scene, double *most) {
    size_t count = 0;
    for (size_t i = 0; i < scene->triangle_count; i++) {
        const dev_triangle *t = &scene->triangles[i];
        bool flat = t->corner_normals[0] == DEV_FLAT;
        count += flat;
        for (int k = 0; !flat && k < 3; k++) {
            *most = fmax(*most, fabs(smooth_unpack(t->corner_normals[k]).x - t->normal[0]));
        }
    }
    return count;
}

/* Boxes whose ends are chamfered by 30 degrees, narrow or wide, or taper off to the other end. */
static void a_chamfered_box_is_flat(void **state) {
    (void)state;
    static const double widths_m[] = {0.01, 0.04, 0.045, 0.06, 0.3};
    for (int k = 0; k < 5; k++) {
        double w = widths_m[k], cosine = cos(PI / 6.0), out = sqrt(2.0) * (0.1 + w * cosine),
               off = 0.0;
        const ring box[] = {{0.0, 0.1 * sqrt(2.0)}, {0.5 * w, out}, {0.3 + w, out}};
        asdic_scene *scene = lathe(box, 3, 4, CREASE_RAD);
        assert_int_equal(count_flat(scene, &off), scene->triangle_count);
        asdic_scene_destroy(&scene);
    }
}

/* Barrels that end in cones, gentle or not, and in a dome: round across, straight along. */
static void a_barrel_with_cones_is_straight(void **state) {
    (void)state;
    static const double angles_deg[] = {1.0, 5.0, 11.3, 25.0};
    for (int k = 0; k < 4; k++) {
        for (uint32_t sides = 12; sides <= 48; sides += 12) {
            double drop = 0.15 * tan(angles_deg[k] * PI / 180.0), cones = 0.0, domed = 0.0;
            const ring one[] = {{-0.5, 0.1}, {0.5, 0.1}, {0.65, 0.1 - drop}};
            const ring two[] = {
                {-0.65, 0.1 - drop}, {-0.5, 0.1}, {0.0, 0.1}, {0.5, 0.1}, {0.65, 0.1 - drop}};
            const ring neck[] = {{-0.5, 0.1}, {0.0, 0.1}, {0.15, 0.1 - drop}, {0.7, 0.1 - drop}};
            asdic_scene *scenes[] = {lathe(one, 3, sides, CREASE_RAD),
                                     lathe(two, 5, sides, CREASE_RAD),
                                     lathe(neck, 4, sides, CREASE_RAD)};
            for (int i = 0; i < 3; i++) {
                assert_int_equal(count_flat(scenes[i], &cones), 2 * sides);
                asdic_scene_destroy(&scenes[i]);
            }
            ring dome[10];
            for (int i = 0; i < 9; i++) {
                double angle = 0.5 * PI * (i + 0.1) / 8.1;
                dome[i] = (ring){-0.5 - 0.1 * cos(angle), 0.1 * sin(angle)};
            }
            dome[9] = (ring){0.5, 0.1};
            asdic_scene *scene = lathe(dome, 10, sides, CREASE_RAD);
            for (size_t i = 0; i < scene->triangle_count; i++) {
                const dev_triangle *t = &scene->triangles[i];
                for (int c = 0;
                     t->corner_normals[0] != DEV_FLAT && fabs(t->normal[0]) < 1e-6 && c < 3; c++) {
                    domed = fmax(domed, fabs(smooth_unpack(t->corner_normals[c]).x));
                }
            }
            asdic_scene_destroy(&scene);
            print_message("%g deg, %u sides: normals lean along by %.2g, beside a dome %.2g\n",
                          angles_deg[k], sides, cones, domed);
            assert_true(cones < 0.02 && domed < 1e-3);
        }
    }
}

/* Half the thickness of NACA 0015 over its chord; Abbott and von Doenhoff 1959, eq. 6.2, its trailing edge closed. */
static double naca_0015(double x) {
    return 0.75 * (0.2969 * sqrt(x) - x * (0.126 + x * (0.3516 - x * (0.2843 - x * 0.1036))));
}

/* Strips of a wing are wide amidships and narrow at the nose, and turn by unlike angles: it is round all the same. */
static void a_wing_of_few_strips_is_round(void **state) {
    (void)state;
    enum { STATIONS = 8, AROUND = 2 * STATIONS, ROWS = 4 };
    double v[3 * AROUND * (ROWS + 1)];
    uint32_t f[6 * AROUND * ROWS];
    for (uint32_t i = 0; i < AROUND * (ROWS + 1); i++) {
        int k =
            (int)(i % AROUND) - STATIONS; /* from the trailing edge above to the nose and back */
        double x = 0.5 * (1.0 - cos(PI * k / STATIONS));
        v[3 * i] = 0.5 * x;
        v[3 * i + 1] = 1.0 / ROWS * (i / AROUND);
        v[3 * i + 2] = (k < 0 ? -0.5 : 0.5) * naca_0015(x);
        if (i < AROUND * ROWS) {
            uint32_t next = i - i % AROUND + (i + 1) % AROUND;
            const uint32_t two[] = {i, next, next + AROUND, i, next + AROUND, i + AROUND};
            memcpy(f + 6 * i, two, sizeof two);
        }
    }
    asdic_mesh *mesh;
    asdic_scene *scene;
    assert_ok(ctx,
              asdic_mesh_from_triangles(ctx, v, AROUND * (ROWS + 1), f, 2 * AROUND * ROWS, &mesh));
    assert_ok(ctx, asdic_scene_create(ctx, &scene));
    assert_ok(ctx, asdic_scene_add_object(scene, "wing", mesh, (asdic_pose){.position_m.z = 9.0},
                                          asdic_material_facet(45.0, 0.0, 0.0)));
    assert_ok(ctx, asdic_scene_commit(scene));
    asdic_mesh_destroy(&mesh);
    size_t creases = 0;
    for (size_t n = 0; n < 9 * scene->triangle_count * scene->triangle_count; n++) {
        const dev_triangle *a = &scene->triangles[n / 9 / scene->triangle_count],
                           *b = &scene->triangles[n / 9 % scene->triangle_count];
        const float *at[2][3] = {{a->v0, a->v1, a->v2}, {b->v0, b->v1, b->v2}};
        vector one = smooth_unpack(a->corner_normals[n / 3 % 3]),
               two = smooth_unpack(b->corner_normals[n % 3]);
        bool leans = a->normal[0] * b->normal[0] + a->normal[1] * b->normal[1] +
                         a->normal[2] * b->normal[2] <
                     (float)cos(CREASE_RAD);
        bool meet = memcmp(at[0][n / 3 % 3], at[1][n % 3], sizeof a->v0) == 0;
        creases += meet && !leans && vector_dot(one, two) < 0.999f;
    }
    print_message("%zu corners with two normals\n", creases);
    assert_int_equal(creases, 0);
    asdic_scene_destroy(&scene);
}

/* Facets of a cylinder are flat where its crease angle says so. */
static void a_crease_angle_makes_facets_flat(void **state) {
    (void)state;
    static const ring tube[] = {{0.0, 0.1}, {1.0, 0.1}};
    static const double creases_rad[] = {0.0, 29.0 * PI / 180.0, 31.0 * PI / 180.0, PI / 2.0};
    for (int k = 0; k < 4; k++) {
        double off;
        asdic_scene *scene = lathe(tube, 2, 12, creases_rad[k]);
        assert_int_equal(count_flat(scene, &off), k < 2 ? scene->triangle_count : 24);
        asdic_scene_destroy(&scene);
    }
    asdic_scene *scene;
    assert_ok(ctx, asdic_scene_create(ctx, &scene));
    assert_int_equal(asdic_scene_set_crease(scene, 1.6), ASDIC_ERROR_ARGUMENT);
    assert_int_equal(asdic_scene_set_crease(scene, -0.1), ASDIC_ERROR_ARGUMENT);
    assert_int_equal(asdic_scene_set_crease(scene, NAN), ASDIC_ERROR_ARGUMENT);
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

/* Facets of their own corners, and one that is a point, far from the origin of coordinates. */
static void a_facet_that_is_a_point_slows_no_welding(void **state) {
    (void)state;
    enum { FACETS = 40000, CORNERS = 3 * FACETS };
    double *vertices_m = malloc(3 * CORNERS * sizeof *vertices_m);
    uint32_t *indices = malloc(CORNERS * sizeof *indices);
    for (size_t i = 0; i < CORNERS; i++) { /* a strip, and the point */
        bool is_point = i / 3 == FACETS - 1;
        vertices_m[3 * i] = is_point ? -1.0 : (double)(i / 3 + i % 3);
        vertices_m[3 * i + 1] = (double)(is_point ? 0 : (i / 3 + i % 3) % 2);
        vertices_m[3 * i + 2] = 20.0;
        indices[i] = (uint32_t)i;
    }
    double start_s = asdic_processor_s();
    asdic_mesh *mesh;
    assert_ok(ctx, asdic_mesh_from_triangles(ctx, vertices_m, CORNERS, indices, FACETS, &mesh));
    assert_true(asdic_processor_s() - start_s < 1.0);
    assert_int_equal(mesh->dropped, 1);
    for (size_t i = 3; i < CORNERS - 3; i++) {
        assert_int_equal(mesh->indices[i], i % 3 == 2 ? i : mesh->indices[i - 2]);
    }
    asdic_mesh_destroy(&mesh);
    free(indices);
    free(vertices_m);
}

typedef struct near_segment {
    const asdic_point_search *search;
    size_t count;
} near_segment;

static void count_near(void *caller, const asdic_point_place *point) {
    near_segment *near = caller;
    asdic_vec3 way = near->search->way_m, p = asdic_vec3_sub(point->at_m, near->search->from_m);
    double along = asdic_vec3_dot(p, way) / asdic_vec3_dot(way, way);
    asdic_vec3 aside = asdic_vec3_sub(p, asdic_vec3_scale(way, along));
    near->count +=
        along >= 0.0 && along <= 1.0 && asdic_vec3_length(aside) <= near->search->reach_m;
}

/* Points of a lattice share coordinates; segments go along its axes, and askew. */
static void a_tree_meets_all_points_near_a_segment(void **state) {
    (void)state;
    enum { SIDE = 15, POINTS = SIDE * SIDE * SIDE, SEGMENTS = 300 };
    asdic_point_place points[POINTS];
    size_t met = 0;
    for (uint32_t i = 0; i < POINTS; i++) {
        points[i] = (asdic_point_place){{i % SIDE, i / SIDE % SIDE, i / SIDE / SIDE}, i};
    }
    asdic_point_tree_plant(points, POINTS);
    for (uint32_t i = 0; i < SEGMENTS; i++) {
        double way[3], step = i % 2 ? 1.0 : 0.0;
        for (uint32_t k = 0; k < 3; k++) {
            way[k] = i % 3 == k ? 9.0 * jitter(7 * i + k) : step * 20.0 * jitter(7 * i + k);
        }
        asdic_point_search search = {.from_m = {i % 13, i % 11, i % 7},
                                     .way_m = {way[0], way[1], way[2]},
                                     .reach_m = i % 5 * 0.4,
                                     .meet = count_near};
        near_segment tree = {.search = &search}, all = tree;
        search.caller = &tree;
        asdic_point_tree_search(points, POINTS, &search);
        for (size_t k = 0; k < POINTS; k++) {
            count_near(&all, &points[k]);
        }
        assert_int_equal(tree.count, all.count);
        met += all.count;
    }
    assert_true(met > SEGMENTS);
}

/* Slivers upright side by side, whose open edges are as long as the object: none joins another, and none takes time. */
static void loose_slivers_are_committed_soon(void **state) {
    (void)state;
    enum { SIDE = 200, SLIVERS = SIDE * SIDE };
    double *vertices_m = malloc(9 * SLIVERS * sizeof *vertices_m);
    uint32_t *indices = malloc(3 * SLIVERS * sizeof *indices);
    for (uint32_t i = 0; i < SLIVERS; i++) {
        double x = 0.1 * (i % SIDE), y = 0.1 * (double)(i / SIDE);
        const double corners[9] = {x, y, 0.0, x + 0.02, y, 0.0, x, y + 0.005, 10.0};
        memcpy(&vertices_m[9 * (size_t)i], corners, sizeof corners);
        for (uint32_t k = 0; k < 3; k++) {
            indices[3 * i + k] = 3 * i + k;
        }
    }
    asdic_mesh *mesh;
    assert_ok(ctx,
              asdic_mesh_from_triangles(ctx, vertices_m, 3 * SLIVERS, indices, SLIVERS, &mesh));
    double start_s = asdic_processor_s();
    asdic_scene *scene = steel_scene(mesh);
    assert_true(asdic_processor_s() - start_s < 4.0);
    for (size_t i = 0; i < SLIVERS; i++) {
        assert_int_equal(scene->triangles[i].corner_normals[0], DEV_FLAT);
    }
    asdic_scene_destroy(&scene);
    free(indices);
    free(vertices_m);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(packing_keeps_directions),
        cmocka_unit_test(a_box_stays_flat),
        cmocka_unit_test(a_sphere_is_round),
        cmocka_unit_test(a_ball_of_unequal_facets_is_round),
        cmocka_unit_test(twins_are_one_vertex),
        cmocka_unit_test(neighbours_are_no_twins),
        cmocka_unit_test(a_pole_of_roundings_is_one_vertex),
        cmocka_unit_test(a_fine_hole_stays_one),
        cmocka_unit_test(a_sliver_parts_no_twins),
        cmocka_unit_test(what_is_thin_is_no_rounding),
        cmocka_unit_test(a_cylinder_is_straight_one_way),
        cmocka_unit_test(fine_strips_leave_a_capped_cylinder_round),
        cmocka_unit_test(uneven_tubes_are_round_and_straight),
        cmocka_unit_test(a_tube_of_strips_cut_apart_is_round_and_straight),
        cmocka_unit_test(a_plate_of_rounded_coordinates_is_flat),
        cmocka_unit_test(a_plate_of_low_waves_is_not),
        cmocka_unit_test(what_is_long_and_thin_stays_round),
        cmocka_unit_test(an_edge_leaves_its_face_flat),
        cmocka_unit_test(few_plates_stay_flat),
        cmocka_unit_test(a_chamfered_box_is_flat),
        cmocka_unit_test(a_barrel_with_cones_is_straight),
        cmocka_unit_test(a_wing_of_few_strips_is_round),
        cmocka_unit_test(a_crease_angle_makes_facets_flat),
        cmocka_unit_test(facets_wound_either_way_are_one_body),
        cmocka_unit_test(other_laws_stay_flat),
        cmocka_unit_test(a_facet_that_is_a_point_slows_no_welding),
        cmocka_unit_test(a_tree_meets_all_points_near_a_segment),
        cmocka_unit_test(loose_slivers_are_committed_soon),
    };
    if (asdic_context_create(&ctx) != ASDIC_OK) {
        return 1;
    }
    int failed = cmocka_run_group_tests(tests, NULL, NULL);
    asdic_context_destroy(&ctx);
    return failed;
}
