/* What is at one place in a mesh: vertices apart by roundings, slivers between them. */
#include "smooth_rig.h"

#include "base/clock.h"

/* BALL's facets with corners of their own, apart by roundings. */
static void loosen(const asdic_mesh *ball, double *v, uint32_t *f) {
    for (size_t i = 0; i < 3 * ball->triangle_count; i++) {
        f[i] = (uint32_t)i;
        for (size_t k = 0; k < 3; k++) {
            v[3 * i + k] = ball->vertices_m[3 * ball->indices[i] + k] + 6e-8 * (double)(i * 7 % 3);
        }
    }
}

/* Whether the ball of 24 segments in MESH, which goes with it, has radial normals. */
static void assert_round(asdic_mesh *mesh) {
    asdic_scene *scene = steel_scene(mesh);
    assert_true(off_radial_rad(scene) < 0.05 * 2.0 * PI / 24);
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
    loosen(ball, v, f);
    assert_ok(ctx, asdic_mesh_from_triangles(ctx, v, corners, f, corners / 3, &mesh));
    assert_int_equal(asdic_mesh_get_info(mesh).open_edges, 0);
    assert_round(mesh);
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
        loosen(ball, v, f);
        const double sliver[] = {0.4, 0.0, 0.0, 0.4, 0.0, 1e-9, 0.4, length_m, 0.0};
        memcpy(v + 3 * corners, sliver, sizeof sliver);
        for (size_t i = corners; i < corners + 3; i++) {
            f[i] = (uint32_t)i;
        }
        assert_ok(ctx, asdic_mesh_from_triangles(ctx, v, corners + 3, f, corners / 3 + 1, &mesh));
        assert_int_equal(asdic_mesh_get_info(mesh).open_edges, 0);
        assert_int_equal(asdic_mesh_get_info(mesh).dropped, 1);
        assert_round(mesh);
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

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(twins_are_one_vertex),
        cmocka_unit_test(neighbours_are_no_twins),
        cmocka_unit_test(a_pole_of_roundings_is_one_vertex),
        cmocka_unit_test(a_fine_hole_stays_one),
        cmocka_unit_test(a_sliver_parts_no_twins),
        cmocka_unit_test(what_is_thin_is_no_rounding),
        cmocka_unit_test(a_facet_that_is_a_point_slows_no_welding),
    };
    return cmocka_run_group_tests(tests, context_begin, context_end);
}
