/*
 * Primitives, placing, recentring, altitude.
 */
#include "mesh_rig.h"

#include "lib/base/vec.h"
#include "lib/scene/bvh.h"
#include "lib/scene/lifted.h"
#include "lib/scene/place.h"
#include "lib/scene/placement.h"
#include "lib/scene/scene.h"
#include "lib/scene/triangles.h"
#include "test_context.h"

#include <stdlib.h>

static void check(asdic_status status) {
    if (status != ASDIC_OK) {
        print_error("%s\n", asdic_context_error(ctx));
    }
    assert_int_equal(status, ASDIC_OK);
}

static asdic_vec3 mesh_corner(const asdic_mesh *mesh, size_t facet, int corner) {
    const double *v = &mesh->vertices_m[3 * (size_t)mesh->indices[3 * facet + corner]];
    return (asdic_vec3){v[0], v[1], v[2]};
}

/* Enclosed volume by the divergence theorem: positive only if facets look outward. */
static double volume_m3(const asdic_mesh *mesh) {
    double volume = 0.0;
    for (size_t i = 0; i < mesh->triangle_count; i++) {
        volume +=
            asdic_vec3_dot(mesh_corner(mesh, i, 0),
                           asdic_vec3_cross(mesh_corner(mesh, i, 1), mesh_corner(mesh, i, 2)));
    }
    return volume / 6.0;
}

/* How asdic_place_faces finds MESH, its last CUT facets left out, wound as it is or the other way round; destroys it. */
static int outward_of(asdic_mesh *mesh, size_t cut, bool turned) {
    size_t count = mesh->triangle_count - cut;
    double *world_m = malloc(9 * count * sizeof *world_m);
    for (size_t i = 0; i < 3 * count; i++) {
        asdic_vec3 v = mesh_corner(mesh, i / 3, turned ? 2 - (int)(i % 3) : (int)(i % 3));
        world_m[3 * i] = v.x + 1e6;
        world_m[3 * i + 1] = v.y;
        world_m[3 * i + 2] = v.z;
    }
    asdic_part part = {.center_m = {1e6, 0.0, 0.0}};
    asdic_place_faces(world_m, count, &part);
    free(world_m);
    asdic_mesh_destroy(&mesh);
    return part.outward;
}

static void bodies_have_an_outside_and_sheets_have_none(void **state) {
    (void)state;
    for (int turned = 0; turned < 2; turned++) {
        asdic_mesh *box, *holed, *sphere, *open, *plate;
        check(asdic_mesh_box(ctx, (asdic_vec3){2.0, 3.0, 5.0}, &box));
        check(asdic_mesh_sphere(ctx, 2.0, 200, &sphere));
        check(asdic_mesh_sphere(ctx, 2.0, 200, &holed));
        check(asdic_mesh_box(ctx, (asdic_vec3){2.0, 3.0, 5.0}, &open));
        check(asdic_mesh_plate(ctx, 2.0, 3.0, &plate));
        assert_int_equal(outward_of(box, 0, turned), turned ? -1 : 1);
        assert_int_equal(outward_of(sphere, 0, turned), turned ? -1 : 1);
        assert_int_equal(outward_of(holed, 1, turned), turned ? -1 : 1);
        assert_int_equal(outward_of(open, 2, turned), 0);
        assert_int_equal(outward_of(plate, 0, turned), 0);
    }
}

static void primitives_are_closed_and_look_outward(void **state) {
    (void)state;
    asdic_mesh *mesh;
    check(asdic_mesh_box(ctx, (asdic_vec3){2.0, 3.0, 5.0}, &mesh));
    assert_int_equal(asdic_mesh_get_info(mesh).open_edges, 0);
    assert_close(volume_m3(mesh), 30.0, 1e-12);
    asdic_mesh_destroy(&mesh);
    check(asdic_mesh_sphere(ctx, 2.0, 200, &mesh));
    assert_int_equal(asdic_mesh_get_info(mesh).open_edges, 0);
    assert_close_relative(volume_m3(mesh), 4.0 / 3.0 * ASDIC_PI * 8.0, 1e-3);
    asdic_mesh_destroy(&mesh);
    check(asdic_mesh_sphere(ctx, 1.0, 3, &mesh));
    assert_int_equal(asdic_mesh_get_info(mesh).open_edges, 0);
    assert_true(volume_m3(mesh) > 0.0);
    asdic_mesh_destroy(&mesh);
    check(asdic_mesh_cylinder(ctx, 0.5, 4.0, 300, &mesh));
    asdic_mesh_info info = asdic_mesh_get_info(mesh);
    assert_int_equal(info.open_edges, 0);
    assert_close_relative(volume_m3(mesh), ASDIC_PI * 0.25 * 4.0, 1e-3);
    assert_close(info.max_m.y, 2.0, 0.0); /* the axis is y */
    asdic_mesh_destroy(&mesh);
    check(asdic_mesh_plate(ctx, 2.0, 3.0, &mesh));
    info = asdic_mesh_get_info(mesh);
    assert_int_equal(info.open_edges, 4);
    assert_close(info.max_m.x - info.min_m.x, 0.0, 0.0);
    assert_close(info.max_m.y, 1.0, 0.0);
    asdic_vec3 normal =
        asdic_vec3_cross(asdic_vec3_sub(mesh_corner(mesh, 0, 1), mesh_corner(mesh, 0, 0)),
                         asdic_vec3_sub(mesh_corner(mesh, 0, 2), mesh_corner(mesh, 0, 0)));
    assert_true(normal.x > 0.0 && normal.y == 0.0 && normal.z == 0.0);
    asdic_mesh_destroy(&mesh);
}

static void primitives_refuse_nonsense(void **state) {
    (void)state;
    asdic_mesh *mesh;
    assert_int_equal(asdic_mesh_box(ctx, (asdic_vec3){2, 0, 5}, &mesh), ASDIC_ERROR_ARGUMENT);
    assert_null(mesh);
    assert_non_null(strstr(asdic_context_error(ctx), "y size 0"));
    assert_int_equal(asdic_mesh_sphere(ctx, NAN, 8, &mesh), ASDIC_ERROR_ARGUMENT);
    assert_int_equal(asdic_mesh_sphere(ctx, 1.0, 2, &mesh), ASDIC_ERROR_ARGUMENT);
    assert_int_equal(asdic_mesh_cylinder(ctx, 1.0, -1.0, 8, &mesh), ASDIC_ERROR_ARGUMENT);
    assert_int_equal(asdic_mesh_plate(ctx, INFINITY, 1.0, &mesh), ASDIC_ERROR_ARGUMENT);
}

static void arrays_are_checked(void **state) {
    (void)state;
    const double vertices[] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 2, 0, 0};
    const uint32_t facets[] = {0, 1, 2, 0, 1, 3, 1, 1, 2};
    const uint32_t wrong[] = {0, 1, 4};
    asdic_mesh *mesh;
    check(asdic_mesh_from_triangles(ctx, vertices, 4, facets, 3, &mesh));
    assert_int_equal(asdic_mesh_get_info(mesh).triangles, 1);
    assert_int_equal(asdic_mesh_get_info(mesh).dropped, 2); /* on a line; a corner twice */
    asdic_mesh_destroy(&mesh);
    assert_int_equal(asdic_mesh_from_triangles(ctx, vertices, 4, wrong, 1, &mesh),
                     ASDIC_ERROR_INPUT);
    assert_null(mesh);
    const double hole[] = {0, 0, 0, 1, NAN, 0, 0, 1, 0};
    assert_int_equal(asdic_mesh_from_triangles(ctx, hole, 3, facets, 1, &mesh), ASDIC_ERROR_INPUT);
}

static void placing_keeps_precision_far_out(void **state) {
    (void)state;
    asdic_mesh *mesh;
    asdic_scene *scene;
    check(asdic_mesh_box(ctx, (asdic_vec3){2.0, 2.0, 2.0}, &mesh));
    check(asdic_scene_create(ctx, &scene));
    asdic_pose pose = {.position_m = {4.5e6 + 0.123, 5.0e5 + 0.456, 30.789}, .yaw_rad = 0.7};
    check(asdic_scene_add_object(scene, "cube", mesh, pose, asdic_material_facet(45, 1e-3, 0.1)));
    check(asdic_scene_commit(scene));
    asdic_mesh_destroy(&mesh);
    assert_close(scene->origin_m.x, pose.position_m.x, 1e-9);
    for (size_t i = 0; i < scene->triangle_count; i++) {
        const dev_triangle *t = &scene->triangles[i];
        double length2 = 0.0;
        for (int k = 0; k < 3; k++) {
            length2 += (double)t->v0[k] * t->v0[k];
        }
        assert_close(sqrt(length2), sqrt(3.0), 1e-6);
        /* the normals of a turned cube: along z, or at 0.7 rad in the plane */
        double turned = fabs(cos(0.7) * t->normal[0] + sin(0.7) * t->normal[1]);
        assert_true(fabs(fabs(t->normal[2]) - 1.0) < 1e-6 || fabs(turned - 1.0) < 1e-6 ||
                    fabs(turned) < 1e-6);
    }
    assert_close(scene->parts[0].radius_m, sqrt(3.0), 1e-9);
    asdic_scene_info info = asdic_scene_get_info(scene);
    assert_int_equal(info.triangles, 12);
    assert_int_equal(info.objects, 1);
    assert_close(info.max_m.z, 31.789, 1e-9);
    asdic_scene_destroy(&scene);
}

static void attitude_turns_in_aerospace_order(void **state) {
    (void)state;
    asdic_mesh *mesh;
    asdic_scene *scene;
    check(asdic_mesh_plate(ctx, 1.0, 1.0, &mesh));
    check(asdic_scene_create(ctx, &scene));
    /* nose up by 90 degrees: the normal along x points up, that is -z */
    asdic_pose pose = {.pitch_rad = ASDIC_PI / 2.0, .yaw_rad = 0.4};
    check(asdic_scene_add_object(scene, "plate", mesh, pose, asdic_material_facet(45, 1e-3, 0.1)));
    check(asdic_scene_commit(scene));
    assert_close(scene->triangles[0].normal[2], -1.0, 1e-6);
    asdic_scene_destroy(&scene);
    asdic_mesh_destroy(&mesh);
}

static void altitude_takes_the_nearest_bottom_below(void **state) {
    (void)state;
    asdic_mesh *shelf, *box;
    asdic_scene *scene;
    check(asdic_mesh_box(ctx, (asdic_vec3){10.0, 10.0, 2.0}, &shelf));
    check(asdic_mesh_box(ctx, (asdic_vec3){1.0, 1.0, 1.0}, &box));
    check(asdic_scene_create(ctx, &scene));
    check(asdic_scene_set_bottom_plane(scene, 40.0, asdic_material_bottom(2)));
    asdic_pose at_25 = {.position_m = {0.0, 0.0, 25.0}}, at_10 = {.position_m = {0.0, 0.0, 10.0}};
    check(asdic_scene_add_bottom(scene, shelf, at_25, asdic_material_bottom(4)));
    check(asdic_scene_add_object(scene, "box", box, at_10, asdic_material_facet(45, 1e-3, 0.1)));
    check(asdic_scene_commit(scene));
    assert_close(asdic_scene_altitude_m(scene, (asdic_vec3){0.2, 0.1, 4.0}), 20.0, 1e-5);
    assert_close(asdic_scene_altitude_m(scene, (asdic_vec3){0.0, 0.0, 4.0}), 20.0, 1e-5);
    assert_close(asdic_scene_altitude_m(scene, (asdic_vec3){5.0, 5.0, 4.0}), 20.0, 1e-5);
    assert_close(asdic_scene_altitude_m(scene, (asdic_vec3){6.0, 0.0, 4.0}), 36.0, 1e-5);
    assert_close(asdic_scene_altitude_m(scene, (asdic_vec3){0.2, 0.1, 25.0}), 1.0, 1e-5);
    assert_close(asdic_scene_altitude_m(scene, (asdic_vec3){0.2, 0.1, 30.0}), 10.0, 1e-5);
    assert_true(isinf(asdic_scene_altitude_m(scene, (asdic_vec3){0.2, 0.1, 41.0})));
    asdic_scene_destroy(&scene);
    asdic_mesh_destroy(&shelf);
    asdic_mesh_destroy(&box);
}

/* A bottom 30 m deep, 200 m to each side, of squares of 10 m; its corner 80 m north of the middle is 20 m deep. */
static void add_hill(asdic_scene *scene) {
    enum { SIDE = 41 };
    static double corners_m[3 * SIDE * SIDE];
    static uint32_t triangles[6 * SIDE * SIDE];
    asdic_mesh *mesh;
    size_t count = 0;
    for (uint32_t i = 0; i < SIDE * SIDE; i++) {
        double x = 10.0 * (i / SIDE) - 200.0, y = 10.0 * (i % SIDE) - 200.0;
        corners_m[3 * i] = x;
        corners_m[3 * i + 1] = y;
        corners_m[3 * i + 2] = x == 80.0 && y == 0.0 ? 20.0 : 30.0;
        if (i / SIDE + 1 < SIDE && i % SIDE + 1 < SIDE) {
            const uint32_t two[6] = {i, i + 1, i + SIDE, i + SIDE, i + 1, i + SIDE + 1};
            memcpy(&triangles[6 * count++], two, sizeof two);
        }
    }
    check(asdic_mesh_from_triangles(ctx, corners_m, SIDE * SIDE, triangles, 2 * count, &mesh));
    check(asdic_scene_add_bottom(scene, mesh, (asdic_pose){0}, asdic_material_bottom(2)));
    asdic_mesh_destroy(&mesh);
}

/* Reaches are tens of metres off where more or less would count, since whole boxes of triangles are taken. */
static void clearance_is_of_the_highest_bottom_in_reach(void **state) {
    (void)state;
    static const struct {
        asdic_vec3 from_m;
        double reach_m, clearance_m;
    } cases[] = {
        {{0, 0, 10}, 1e3, 10},        {{0, 0, 10}, 120, 10},        {{0, 0, 10}, 40, 20},
        {{0, 0, 10}, 15, INFINITY},   {{80, 80, 10}, 120, 10},      {{80, 80, 10}, 40, 20},
        {{0, -80, 10}, 150, 10},      {{0, -80, 10}, 80, 20}, /* 113 m off, 80 along each axis */
        {{80, 0, 25}, 120, 5},        {{80, 0, 31}, 1e3, INFINITY}, {{80, 0, -60}, 100, 80},
        {{80, 0, -60}, 60, INFINITY}, {{0, 0, 29}, 40, 1},
    };
    asdic_mesh *box;
    asdic_scene *scene;
    asdic_pose at_15 = {.position_m = {0.0, 5.0, 15.0}};
    check(asdic_mesh_box(ctx, (asdic_vec3){1.0, 1.0, 1.0}, &box));
    check(asdic_scene_create(ctx, &scene));
    add_hill(scene);
    check(asdic_scene_add_object(scene, "box", box, at_15, asdic_material_facet(45, 1e-3, 0.1)));
    check(asdic_scene_commit(scene));
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        double m = asdic_scene_clearance_m(scene, cases[i].from_m, cases[i].reach_m);
        if (isinf(cases[i].clearance_m)) {
            assert_true(isinf(m) && m > 0.0);
        } else {
            assert_close(m, cases[i].clearance_m, 1e-5);
        }
    }
    asdic_scene_destroy(&scene);
    asdic_mesh_destroy(&box);
}

static void scene_checks_its_arguments(void **state) {
    (void)state;
    asdic_mesh *mesh;
    asdic_scene *scene;
    asdic_pose here = {.yaw_rad = 0.0}, nowhere = {.position_m = {NAN, 0.0, 0.0}};
    check(asdic_mesh_plate(ctx, 1.0, 1.0, &mesh));
    check(asdic_scene_create(ctx, &scene));
    assert_int_equal(asdic_scene_set_bottom_plane(scene, -1.0, asdic_material_bottom(2)),
                     ASDIC_ERROR_ARGUMENT);
    assert_int_equal(asdic_scene_set_bottom_plane(scene, 10.0, asdic_material_bottom(5)),
                     ASDIC_ERROR_ARGUMENT);
    assert_int_equal(asdic_scene_add_bottom(scene, mesh, nowhere, asdic_material_bottom(2)),
                     ASDIC_ERROR_ARGUMENT);
    assert_int_equal(asdic_scene_add_object(scene, "", mesh, here, asdic_material_facet(45, 0, 0)),
                     ASDIC_ERROR_ARGUMENT);
    assert_int_equal(asdic_scene_add_object(scene, "x", mesh, here, asdic_material_facet(-1, 0, 0)),
                     ASDIC_ERROR_ARGUMENT);
    check(asdic_scene_commit(scene));
    assert_int_equal(asdic_scene_commit(scene), ASDIC_ERROR_ARGUMENT);
    assert_int_equal(asdic_scene_add_bottom(scene, mesh, here, asdic_material_bottom(2)),
                     ASDIC_ERROR_ARGUMENT);
    asdic_scene_destroy(&scene);
    asdic_mesh_destroy(&mesh);
}

/* Degenerate input must end, in a bounded tree, with every triangle in it once. */
static void hierarchy_of_awkward_input(void **state) {
    (void)state;
    enum { COUNT = 5000 };
    dev_triangle *t = calloc(COUNT, sizeof *t);
    uint8_t *seen = calloc(COUNT, 1);
    assert_true(t && seen);
    for (int kind = 0; kind < 4; kind++) {
        for (int i = 0; i < COUNT; i++) {
            /* all equal; on a line; exponentially spaced; all points */
            float x = kind == 1 ? (float)i : kind == 2 ? powf(1.02f, (float)i - 2500.0f) : 0.0f;
            float size = kind == 3 ? 0.0f : 1.0f;
            t[i] = (dev_triangle){.v0 = {x, 0, 0}, .v1 = {x + size, 0, 0}, .v2 = {x, size, 0}};
        }
        asdic_bvh bvh;
        check(asdic_bvh_build(ctx, t, NULL, COUNT, 1, &bvh));
        assert_in_range(bvh.depth, 1, 72);
        memset(seen, 0, COUNT);
        for (size_t b = 0; b < bvh.block_count; b++) {
            for (int lane = 0; lane < DEV_LEAF_TRIANGLES; lane++) {
                if (bvh.blocks[b].id[lane] != ~0u) {
                    assert_int_equal(seen[bvh.blocks[b].id[lane]]++, 0);
                }
            }
        }
        for (int i = 0; i < COUNT; i++) {
            assert_int_equal(seen[i], 1);
        }
        asdic_bvh_finish(&bvh);
    }
    free(t);
    free(seen);
}

/* What a ray is expected to cost below a cut of ITEMS whose centres lie up to AT along AXIS: both boxes' areas, by blocks
 * of four. */
static double cost_of_cut(const asdic_bvh_item *items, size_t count, int axis, float at) {
    double cost = 0.0;
    for (int side = 0; side < 2; side++) {
        float lo[3] = {INFINITY, INFINITY, INFINITY}, hi[3] = {-INFINITY, -INFINITY, -INFINITY};
        size_t held = 0;
        for (size_t i = 0; i < count; i++) {
            if ((0.5f * (items[i].lo[axis] + items[i].hi[axis]) > at) == side) {
                held++;
                for (int k = 0; k < 3; k++) {
                    lo[k] = fminf(lo[k], items[i].lo[k]);
                    hi[k] = fmaxf(hi[k], items[i].hi[k]);
                }
            }
        }
        double x = (double)(hi[0] - lo[0]), y = (double)(hi[1] - lo[1]),
               z = (double)(hi[2] - lo[2]);
        cost += held ? (x * y + y * z + z * x) * ceil((double)held / 4.0) : (double)INFINITY;
    }
    return cost;
}

/* Boxes of any size round centres that lie in planes: of all cuts between two planes there is none that costs less. */
static void a_cut_is_the_cheapest(void **state) {
    (void)state;
    static const struct {
        size_t count;
        unsigned planes; /* as many as there are bins */
    } cases[] = {{40, 8}, {90, 16}, {127, 16}, {128, 16}, {201, 16}};
    static asdic_bvh_item items[201];
    uint32_t random = 1;
    for (int round = 0; round < 200; round++) {
        size_t count = cases[round % 5].count;
        unsigned planes = cases[round % 5].planes;
        double best = (double)INFINITY;
        for (size_t i = 0; i < count; i++) {
            for (int k = 0; k < 3; k++) {
                unsigned draw = (random = random * 1664525u + 1013904223u) >> 8;
                float at = i < 2 ? (float)(i * (planes - 1)) : (float)(draw % planes);
                float half = ldexpf(1.0f, (int)(draw / planes % 6) - 2);
                items[i].lo[k] = at - half;
                items[i].hi[k] = at + half;
            }
        }
        for (int axis = 0; axis < 3; axis++) {
            for (unsigned at = 0; at < planes; at++) {
                best = fmin(best, cost_of_cut(items, count, axis, (float)at));
            }
        }
        asdic_bvh_task whole = {.count = count}, part[2];
        asdic_bvh_measure(items, &whole);
        asdic_bvh_split(items, &whole, &part[0], &part[1]);
        assert_int_equal(part[0].count + part[1].count, count);
        double cost = 0.0;
        for (int side = 0; side < 2; side++) {
            asdic_bvh_task measured = part[side];
            asdic_bvh_measure(items, &measured);
            asdic_bvh_box *a = &measured.box, *b = &part[side].box;
            for (int k = 0; k < 3; k++) {
                assert_true(a->lo[k] == b->lo[k] && a->hi[k] == b->hi[k]);
            }
            double x = (double)(a->hi[0] - a->lo[0]), y = (double)(a->hi[1] - a->lo[1]);
            double z = (double)(a->hi[2] - a->lo[2]);
            cost += (x * y + y * z + z * x) * ceil((double)measured.count / 4.0);
        }
        assert_close_relative(cost, best, 1e-5);
    }
}

/* Counts each triangle below WORD in SEEN; those must lie in the box from LO to HI. Returns the levels of nodes. */
static unsigned walk_hierarchy(const asdic_scene *scene, uint32_t word, const float lo[3],
                               const float hi[3], uint8_t *seen) {
    unsigned below = 0;
    if (word & DEV_LEAF) {
        assert_true((word & ~DEV_LEAF) < scene->bvh.block_count);
        for (int lane = 0; lane < DEV_LEAF_TRIANGLES; lane++) {
            uint32_t id = scene->bvh.blocks[word & ~DEV_LEAF].id[lane];
            if (id != ~0u) {
                const dev_triangle *t = &scene->triangles[id];
                assert_true(id < scene->triangle_count);
                assert_int_equal(seen[id]++, 0);
                for (int k = 0; k < 3; k++) {
                    assert_true(t->v0[k] >= lo[k] && t->v1[k] >= lo[k] && t->v2[k] >= lo[k]);
                    assert_true(t->v0[k] <= hi[k] && t->v1[k] <= hi[k] && t->v2[k] <= hi[k]);
                }
            }
        }
        return 0;
    }
    assert_true(word < scene->bvh.node_count);
    const dev_node8 *n = &scene->bvh.nodes[word];
    for (int i = 0; i < DEV_BVH_WIDTH; i++) {
        if (n->child[i] != DEV_EMPTY) {
            const float l[3] = {n->lo_x[i], n->lo_y[i], n->lo_z[i]};
            const float h[3] = {n->hi_x[i], n->hi_y[i], n->hi_z[i]};
            unsigned levels = walk_hierarchy(scene, n->child[i], l, h, seen);
            below = levels > below ? levels : below;
        }
    }
    return below + 1;
}

/* Objects that move have hierarchies of their own below a few nodes, beside that of what stays. */
static void what_moves_and_what_stays_are_in_the_hierarchy(void **state) {
    (void)state;
    const float least[3] = {-INFINITY, -INFINITY, -INFINITY};
    const float most[3] = {INFINITY, INFINITY, INFINITY};
    asdic_mesh *sphere, *plate;
    check(asdic_mesh_sphere(ctx, 1.0, 12, &sphere));
    check(asdic_mesh_plate(ctx, 1.0, 1.0, &plate));
    for (int movables = 0; movables <= 20; movables += 5) {
        asdic_scene *scene;
        check(asdic_scene_create(ctx, &scene));
        add_hill(scene);
        for (int i = 0; i < movables; i++) {
            asdic_pose pose = {.position_m = {7.0 * i, -3.0 * i, 10.0}};
            check(asdic_scene_add_moving_object(scene, "mover", i % 3 ? sphere : plate, pose,
                                                asdic_material_facet(45, 1e-3, 0.1)));
        }
        check(asdic_scene_commit(scene));
        uint8_t *seen = calloc(scene->triangle_count, 1);
        assert_non_null(seen);
        unsigned levels = walk_hierarchy(scene, scene->bvh.root, least, most, seen);
        /* by which the walk's stack is made: exact, or the sum of the deepest above and below */
        assert_in_range(scene->bvh.depth, levels, levels + (movables > 8));
        for (size_t i = 0; i < scene->triangle_count; i++) {
            assert_int_equal(seen[i], 1);
        }
        free(seen);
        asdic_scene_destroy(&scene);
    }
    asdic_mesh_destroy(&sphere);
    asdic_mesh_destroy(&plate);
}

static float largest_in(const dev_triangle *t, float largest) {
    for (int k = 0; k < 3; k++) {
        float one = fmaxf(fabsf(t->v0[k]), fmaxf(fabsf(t->v1[k]), fabsf(t->v2[k])));
        largest = fmaxf(largest, one);
    }
    return largest;
}

/* Each triangle of what moves is where its object is, and the extent is that of the farthest corner. */
static void what_moves_is_where_it_was_put(void **state) {
    (void)state;
    enum { MOVABLES = 6 };
    asdic_mesh *sphere, *plate;
    asdic_scene *scene;
    asdic_placement *placement;
    asdic_pose pose[MOVABLES];
    check(asdic_mesh_sphere(ctx, 1.0, 12, &sphere));
    check(asdic_mesh_plate(ctx, 1.0, 1.0, &plate));
    check(asdic_scene_create(ctx, &scene));
    add_hill(scene);
    for (int i = 0; i < MOVABLES; i++) { /* beyond the bottom, each in another direction */
        double far_m = 300.0 + 50.0 * i, side = i & 1 ? -1.0 : 1.0;
        pose[i].position_m = (asdic_vec3){i < 4 ? side * far_m : 0.0, i < 2 ? 0.0 : -side * far_m,
                                          i < 4 ? 10.0 : side * far_m};
        pose[i].roll_rad = pose[i].pitch_rad = pose[i].yaw_rad = 0.0;
    }
    for (int i = 0; i < MOVABLES; i++) {
        check(asdic_scene_add_moving_object(scene, "mover", i % 3 ? sphere : plate, pose[i],
                                            asdic_material_facet(45, 1e-3, 0.1)));
        pose[i].position_m.x += 20.0; /* what stays comes between them */
        check(asdic_scene_add_object(scene, "stays", plate, pose[i],
                                     asdic_material_facet(45, 1e-3, 0.1)));
    }
    check(asdic_scene_commit(scene));
    float largest = 0.0f;
    for (size_t i = 0; i < scene->triangle_count; i++) {
        largest = largest_in(&scene->triangles[i], largest);
    }
    assert_close(scene->bvh.extent_m, largest, 1e-3);
    check(asdic_placement_create(scene, &placement));
    assert_int_equal(placement->first[0], 0); /* there is room for no more than its triangles */
    assert_close(placement->extent_m, largest, 1e-3);
    for (int round = 0; round < MOVABLES; round++) { /* each is the farthest once */
        for (int i = 0; i < MOVABLES; i++) {
            double far_m = i == round ? 900.0 + 10.0 * i : 210.0 + 10.0 * i;
            double at_m[3] = {i, -i, 10.0 + i};
            at_m[i / 2] = i & 1 ? -far_m : far_m;
            pose[i].position_m = (asdic_vec3){at_m[0], at_m[1], at_m[2]};
            asdic_placement_move(placement, (size_t)i, &pose[i]);
        }
        size_t counted[MOVABLES] = {0};
        largest = 0.0f;
        for (size_t i = 0; i < scene->triangle_count; i++) {
            const dev_triangle *t = asdic_placement_triangle(placement, i);
            largest = largest_in(t, largest);
            assert_int_equal(t->part, scene->triangles[i].part);
            if (!scene->parts[t->part].moves) {
                assert_ptr_equal(t, &scene->triangles[i]);
                continue;
            }
            size_t own = (t->part - scene->movables[0].part) / 2;
            asdic_vec3 corner = {t->v0[0], t->v0[1], t->v0[2]};
            corner = asdic_vec3_add(corner, scene->origin_m);
            assert_in_range(own, 0, MOVABLES - 1);
            assert_true(asdic_vec3_length(asdic_vec3_sub(corner, pose[own].position_m)) < 1.01);
            counted[own]++;
        }
        for (int i = 0; i < MOVABLES; i++) {
            assert_int_equal(counted[i], (i % 3 ? sphere : plate)->triangle_count);
        }
        assert_close(placement->extent_m, largest, 1e-3);
    }
    asdic_placement_destroy(&placement);
    asdic_scene_destroy(&scene);
    asdic_mesh_destroy(&sphere);
    asdic_mesh_destroy(&plate);
}

/* Near the plane between two layers, in which the same triangle is lifted to 100 m apart, it is in both, as far as
 * lifted.h says. */
static void triangles_on_a_layers_plane_are_in_both(void **state) {
    (void)state;
    static const double off_m[] = {-0.02, -0.009, 0.0, 0.009, 0.02};
    static const double corners_m[] = {0, 0, 0, 2, 0, 0, 0, 2, 0};
    static const uint32_t index[] = {0, 1, 2};
    asdic_mesh *mesh;
    check(asdic_mesh_from_triangles(ctx, corners_m, 3, index, 1, &mesh));
    for (size_t i = 0; i < sizeof off_m / sizeof *off_m; i++) {
        asdic_scene *scene, *lifted;
        double found_m[2] = {NAN, NAN};
        const asdic_pose pose = {.position_m = {0.0, 0.0, 9.0}};
        check(asdic_scene_create(ctx, &scene));
        check(asdic_scene_add_bottom(scene, mesh, pose, asdic_material_bottom(2.0)));
        check(asdic_scene_commit(scene));
        const float at_m = scene->triangles[0].v0[2], plane_m = at_m - (float)off_m[i];
        const dev_layer layers[2] = {{.top_m = -INFINITY, .bottom_m = plane_m},
                                     {.top_m = plane_m, .bottom_m = INFINITY, .shift_m = 100}};
        check(asdic_scene_lift_layers(scene, layers, 2, &lifted));
        for (size_t b = 0; b < lifted->bvh.block_count; b++) {
            const dev_block4 *block = &lifted->bvh.blocks[b];
            for (int lane = 0; lane < DEV_LEAF_TRIANGLES && block->id[lane] != ~0u; lane++) {
                double z_m = (double)block->v[2][lane];
                assert_int_equal(block->id[lane], 0);
                found_m[z_m > 50.0] = z_m;
            }
        }
        if (off_m[i] < 0.015) {
            assert_close(found_m[0], (double)at_m, 1e-5);
        }
        if (off_m[i] > -0.015) {
            assert_close(found_m[1], (double)at_m + 100.0, 1e-5);
        }
        assert_true(isnan(found_m[0]) == (off_m[i] > 0.015));
        assert_true(isnan(found_m[1]) == (off_m[i] < -0.015));
        asdic_scene_unlift(&lifted);
        asdic_scene_destroy(&scene);
    }
    asdic_mesh_destroy(&mesh);
}

static void threads_do_not_show(void **state) {
    (void)state;
    enum { COUNT = 60000 };
    dev_triangle *t = calloc(COUNT, sizeof *t);
    assert_non_null(t);
    uint32_t random = 1;
    for (int i = 0; i < COUNT; i++) {
        for (int k = 0; k < 3; k++) {
            random = random * 1664525u + 1013904223u;
            t[i].v0[k] = (float)(random >> 8) * 1e-5f;
            t[i].v1[k] = t[i].v0[k] + (float)(random >> 28);
            t[i].v2[k] = t[i].v0[k] - (float)(k == 1);
        }
    }
    asdic_bvh one, five;
    check(asdic_bvh_build(ctx, t, NULL, COUNT, 1, &one));
    check(asdic_bvh_build(ctx, t, NULL, COUNT, 5, &five));
    assert_int_equal(one.node_count, five.node_count);
    assert_int_equal(one.block_count, five.block_count);
    assert_memory_equal(one.nodes, five.nodes, one.node_count * sizeof *one.nodes);
    assert_memory_equal(one.blocks, five.blocks, one.block_count * sizeof *one.blocks);
    asdic_bvh_finish(&one);
    asdic_bvh_finish(&five);
    free(t);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(primitives_are_closed_and_look_outward),
        cmocka_unit_test(bodies_have_an_outside_and_sheets_have_none),
        cmocka_unit_test(primitives_refuse_nonsense),
        cmocka_unit_test(arrays_are_checked),
        cmocka_unit_test(placing_keeps_precision_far_out),
        cmocka_unit_test(attitude_turns_in_aerospace_order),
        cmocka_unit_test(altitude_takes_the_nearest_bottom_below),
        cmocka_unit_test(clearance_is_of_the_highest_bottom_in_reach),
        cmocka_unit_test(scene_checks_its_arguments),
        cmocka_unit_test(hierarchy_of_awkward_input),
        cmocka_unit_test(a_cut_is_the_cheapest),
        cmocka_unit_test(what_moves_and_what_stays_are_in_the_hierarchy),
        cmocka_unit_test(what_moves_is_where_it_was_put),
        cmocka_unit_test(triangles_on_a_layers_plane_are_in_both),
        cmocka_unit_test(threads_do_not_show),
    };
    return cmocka_run_group_tests(tests, context_begin, context_end);
}
