/* Flat patches and interpolated normals of facets that stand for curved surfaces. */
#include "smooth_rig.h"

#include "base/clock.h"
#include "scene/smooth.h"

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
    static const unsigned segments[] = {16,  24,  96,  142,
                                        200, 256, 504, 1024}; /* slivers at the poles */
    for (size_t s = 0; s < sizeof segments / sizeof *segments; s++) {
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

static void assert_cylinder(double radius_m, double length_m, unsigned segments) {
    asdic_mesh *mesh;
    assert_ok(ctx, asdic_mesh_cylinder(ctx, radius_m, length_m, segments, &mesh));
    asdic_scene *scene = steel_scene(mesh);
    unsigned ends = 0;
    for (size_t i = 0; i < scene->triangle_count; i++) {
        const dev_triangle *t = &scene->triangles[i];
        if (t->corner_normals[0] == DEV_FLAT) {
            ends++;
            assert_close_relative(t->flat_m2, PI * radius_m * radius_m, 0.01); /* a polygon's */
        } else {
            assert_close_relative(t->flat_m2, length_m * length_m, 1e-3);
        }
        assert_true(t->radius_m == 0.0f || t->radius_m > 1e3f);
    }
    assert_int_equal(ends, 2 * segments);
    asdic_scene_destroy(&scene);
}

static void a_cylinder_is_straight_one_way(void **state) {
    (void)state;
    assert_cylinder(0.25, 2.0, 48);
    assert_cylinder(30.0, 0.3, 256); /* strips 0.74 m wide */
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

/* The bottom law takes the facets' own normals. */
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
        cmocka_unit_test(a_cylinder_is_straight_one_way),
        cmocka_unit_test(fine_strips_leave_a_capped_cylinder_round),
        cmocka_unit_test(uneven_tubes_are_round_and_straight),
        cmocka_unit_test(a_tube_of_strips_cut_apart_is_round_and_straight),
        cmocka_unit_test(a_plate_of_rounded_coordinates_is_flat),
        cmocka_unit_test(a_plate_of_low_waves_is_not),
        cmocka_unit_test(what_is_long_and_thin_stays_round),
        cmocka_unit_test(facets_wound_either_way_are_one_body),
        cmocka_unit_test(other_laws_stay_flat),
        cmocka_unit_test(loose_slivers_are_committed_soon),
    };
    return cmocka_run_group_tests(tests, context_begin, context_end);
}
