/*
 * What trials count with: distances against a search of another kind, and intervals against sums over
 * all that can happen.
 */
#include "asserts.h"
#include "dice.h"

#include <asdic/asdic.h>

#include "base/vec.h"
#include "mission/mission.h"
#include "scene/lifted.h"
#include "scene/nearest.h"
#include "trial/trial_run.h"

#include <fcntl.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

/* --- distances --------------------------------------------------------------------------------- */

static asdic_vec3 random_place(uint64_t *state, double size_m) {
    double x = random_unit(state), y = random_unit(state), z = random_unit(state);
    return (asdic_vec3){size_m * (x - 0.5), size_m * (y - 0.5), size_m * (z - 0.5) + 50.0};
}

static asdic_vec3 mix(const asdic_vec3 v[3], double u, double w) {
    asdic_vec3 ab = asdic_vec3_scale(asdic_vec3_sub(v[1], v[0]), u);
    asdic_vec3 ac = asdic_vec3_scale(asdic_vec3_sub(v[2], v[0]), w);
    return asdic_vec3_add(v[0], asdic_vec3_add(ab, ac));
}

/* The distance is a convex function of the place on the segment and of that on the triangle, so that
 * going downhill in shrinking steps ends at its least. */
static double search(asdic_vec3 a, asdic_vec3 b, const asdic_vec3 v[3]) {
    double at[3] = {0.5, 0.3, 0.3}, best = INFINITY;
    for (double step = 0.5; step > 1e-7; step *= 0.7) {
        for (int round = 0; round < 40; round++) {
            double next[3] = {at[0], at[1], at[2]};
            for (int k = 0; k < 27; k++) {
                double t = fmin(fmax(at[0] + step * (k % 3 - 1), 0.0), 1.0);
                double u = fmin(fmax(at[1] + step * (k / 3 % 3 - 1), 0.0), 1.0);
                double w = fmin(fmax(at[2] + step * (k / 9 - 1), 0.0), 1.0);
                double over = u + w > 1.0 ? 0.5 * (u + w - 1.0) : 0.0;
                u = fmin(fmax(u - over, 0.0), 1.0);
                w = fmin(fmax(w - over, 0.0), 1.0 - u);
                asdic_vec3 p = asdic_vec3_add(a, asdic_vec3_scale(asdic_vec3_sub(b, a), t));
                double found = asdic_vec3_length(asdic_vec3_sub(p, mix(v, u, w)));
                if (found < best) {
                    best = found;
                    next[0] = t;
                    next[1] = u;
                    next[2] = w;
                }
            }
            if (next[0] == at[0] && next[1] == at[1] && next[2] == at[2]) {
                break;
            }
            at[0] = next[0];
            at[1] = next[1];
            at[2] = next[2];
        }
    }
    return best;
}

static asdic_scene *make_scene(asdic_context *ctx) {
    asdic_scene *scene = NULL;
    asdic_mesh *ball = NULL, *box = NULL;
    asdic_material rock = asdic_material_bottom(4.0);
    assert_int_equal(asdic_scene_create(ctx, &scene), ASDIC_OK);
    assert_int_equal(asdic_mesh_sphere(ctx, 3.0, 12, &ball), ASDIC_OK);
    assert_int_equal(asdic_mesh_box(ctx, (asdic_vec3){8, 2, 4}, &box), ASDIC_OK);
    asdic_pose at = {.position_m = {6, 2, 48}};
    assert_int_equal(asdic_scene_add_object(scene, "ball", ball, at, rock), ASDIC_OK);
    assert_int_equal(asdic_scene_add_moving_object(scene, "box", box, at, rock), ASDIC_OK);
    assert_int_equal(asdic_scene_add_point(scene, "fish", (asdic_vec3){0, 9, 50}, -30.0), ASDIC_OK);
    assert_int_equal(asdic_scene_commit(scene), ASDIC_OK);
    asdic_mesh_destroy(&ball);
    asdic_mesh_destroy(&box);
    return scene;
}

typedef struct rig {
    asdic_context *ctx;
    asdic_scene *scene;
    asdic_placement *placement;
} rig;

static rig begin(void) {
    rig r = {.ctx = NULL};
    assert_int_equal(asdic_context_create(&r.ctx), ASDIC_OK);
    r.scene = make_scene(r.ctx);
    assert_int_equal(asdic_placement_create(r.scene, &r.placement), ASDIC_OK);
    return r;
}

static void end(rig *r) {
    asdic_placement_destroy(&r->placement);
    asdic_scene_destroy(&r->scene);
    asdic_context_destroy(&r->ctx);
}

/* To all triangles one by one, and to the point. */
static double nearest_of_all(const asdic_placement *p, asdic_vec3 a, asdic_vec3 b) {
    const asdic_scene *scene = p->scene;
    const asdic_vec3 fish[3] = {{0, 9, 50}, {0, 9, 50}, {0, 9, 50}};
    double best = search(a, b, fish);
    for (size_t i = 0; i < scene->triangle_count; i++) {
        const dev_triangle *t = asdic_placement_triangle(p, i);
        const float *from[3] = {t->v0, t->v1, t->v2};
        asdic_vec3 v[3];
        for (int k = 0; k < 3; k++) {
            asdic_vec3 corner = {from[k][0], from[k][1], from[k][2]};
            v[k] = asdic_vec3_add(corner, scene->origin_m);
        }
        best = fmin(best, search(a, b, v));
    }
    return best;
}

static void test_nearest(void **state) {
    (void)state;
    rig r = begin();
    uint64_t random = 1;
    for (int i = 0; i < 30; i++) {
        asdic_pose pose = {.position_m = random_place(&random, 20.0),
                           .roll_rad = random_unit(&random),
                           .yaw_rad = 6.0 * random_unit(&random)};
        asdic_placement_move(r.placement, 0, &pose);
        asdic_vec3 a = random_place(&random, 30.0);
        asdic_vec3 b = i % 3 ? random_place(&random, 30.0) : a;
        asdic_nearest found =
            asdic_placement_nearest(r.placement, &(asdic_way){a, b}, NULL, 1000.0);
        double wanted_m = nearest_of_all(r.placement, a, b);
        if (fabs(found.distance_m - wanted_m) > 2e-3) {
            fail_msg("%d: %.9g m, by search %.9g m", i, found.distance_m, wanted_m);
        }
        asdic_nearest within =
            asdic_placement_nearest(r.placement, &(asdic_way){a, b}, NULL, 0.5 * wanted_m);
        if (wanted_m > 0.1) { /* else the way goes through something */
            assert_true(within.part == ASDIC_NOTHING && within.distance_m == 0.5 * wanted_m);
        }
    }
    end(&r);
}

static void test_inside(void **state) {
    (void)state;
    rig r = begin();
    asdic_pose away = {.position_m = {-20, 0, 50}};
    asdic_placement_move(r.placement, 0, &away);
    uint64_t random = 5;
    for (int i = 0; i < 2000; i++) {
        size_t part = 9;
        asdic_vec3 at = asdic_vec3_add(random_place(&random, 8.0), (asdic_vec3){6, 2, -2});
        double off_m = asdic_vec3_length(asdic_vec3_sub(at, (asdic_vec3){6, 2, 48}));
        bool is_inside = asdic_placement_is_inside(r.placement, at, &part);
        if (off_m < 2.7) { /* inside all facets of the ball */
            assert_true(is_inside && part == 0);
        } else if (off_m > 3.0) {
            assert_false(is_inside);
        }
    }
    end(&r);
}

/* Where plumb lines go through edges and corners of facets: those below a body's middle and others on the diagonals
 * of a box, and through the poles of a ball. The scene's origin is the middle, so that nothing is rounded. */
static void test_inside_over_edges(void **state) {
    (void)state;
    for (int is_ball = 0; is_ball < 2; is_ball++) {
        rig r = {.ctx = NULL};
        asdic_mesh *mesh = NULL;
        const asdic_pose pose = {.position_m = {40, 8, 16}};
        assert_int_equal(asdic_context_create(&r.ctx), ASDIC_OK);
        assert_int_equal(asdic_scene_create(r.ctx, &r.scene), ASDIC_OK);
        assert_int_equal(is_ball ? asdic_mesh_sphere(r.ctx, 2.0, 16, &mesh)
                                 : asdic_mesh_box(r.ctx, (asdic_vec3){4, 4, 4}, &mesh),
                         ASDIC_OK);
        assert_int_equal(asdic_scene_add_object(r.scene, "body", mesh, pose,
                                                asdic_material_facet(45.0, 1e-3, 0.1)),
                         ASDIC_OK);
        assert_int_equal(asdic_scene_commit(r.scene), ASDIC_OK);
        assert_int_equal(asdic_placement_create(r.scene, &r.placement), ASDIC_OK);
        for (int i = -1; i <= 1; i++) {
            for (int k = 0; k < 36; k++) {
                const asdic_vec3 off = {0.25 * i * (k / 4 - 4), 0.25 * (k / 4 - 4),
                                        3.0 * (k % 4) - 4.0};
                size_t part = 9;
                assert_int_equal(asdic_placement_is_inside(
                                     r.placement, asdic_vec3_add(pose.position_m, off), &part),
                                 fabs(off.z) < 2.0);
            }
        }
        asdic_mesh_destroy(&mesh);
        end(&r);
    }
}

/* Over and under a plate that lies flat, in its middle and on its diagonal. */
static void test_nothing_is_inside_a_plate(void **state) {
    (void)state;
    rig r = {.ctx = NULL};
    asdic_mesh *mesh = NULL;
    const asdic_pose pose = {.position_m = {40, 8, 16}, .pitch_rad = 0.5 * ASDIC_PI};
    assert_int_equal(asdic_context_create(&r.ctx), ASDIC_OK);
    assert_int_equal(asdic_scene_create(r.ctx, &r.scene), ASDIC_OK);
    assert_int_equal(asdic_mesh_plate(r.ctx, 4.0, 4.0, &mesh), ASDIC_OK);
    assert_int_equal(
        asdic_scene_add_object(r.scene, "plate", mesh, pose, asdic_material_facet(45.0, 1e-3, 0.1)),
        ASDIC_OK);
    assert_int_equal(asdic_scene_commit(r.scene), ASDIC_OK);
    assert_int_equal(asdic_placement_create(r.scene, &r.placement), ASDIC_OK);
    for (int i = -4; i <= 4; i++) {
        for (int down_m = -1; down_m <= 1; down_m += 2) {
            const asdic_vec3 at = {40.0 + 0.4 * i, 8.0 + 0.1 * i, 16.0 + down_m};
            size_t part = 9;
            assert_false(asdic_placement_is_inside(r.placement, at, &part));
        }
    }
    asdic_mesh_destroy(&mesh);
    end(&r);
}

/* --- objects that come and go ------------------------------------------------------------------ */

#define SIDE 24

static asdic_mesh *make_hills(asdic_context *ctx) {
    static double vertices_m[SIDE * SIDE * 3];
    static uint32_t indices[(SIDE - 1) * (SIDE - 1) * 6];
    size_t at = 0;
    for (int i = 0; i < SIDE * SIDE; i++) {
        double x = 3.0 * (i % SIDE), y = 3.0 * (i / SIDE);
        vertices_m[3 * i] = x;
        vertices_m[3 * i + 1] = y;
        vertices_m[3 * i + 2] = 60.0 + 2.0 * sin(0.3 * x) * cos(0.2 * y);
    }
    for (uint32_t i = 0; i < SIDE * (SIDE - 1); i++) {
        if (i % SIDE < SIDE - 1) {
            const uint32_t quad[6] = {i, i + 1, i + SIDE, i + 1, i + SIDE + 1, i + SIDE};
            for (int k = 0; k < 6; k++) {
                indices[at++] = quad[k];
            }
        }
    }
    asdic_mesh *mesh = NULL;
    assert_int_equal(
        asdic_mesh_from_triangles(ctx, vertices_m, SIDE * SIDE, indices, at / 3, &mesh), ASDIC_OK);
    return mesh;
}

/* A ball, and perhaps a box that moves, somewhere: also beyond the hills and above them. */
static void add_objects(asdic_context *ctx, asdic_scene *scene, uint64_t seed, bool with_box) {
    asdic_mesh *ball = NULL, *box = NULL;
    asdic_material rock = asdic_material_bottom(4.0);
    assert_int_equal(asdic_mesh_sphere(ctx, 1.0 + random_unit(&seed), 12, &ball), ASDIC_OK);
    assert_int_equal(asdic_mesh_box(ctx, (asdic_vec3){8, 2, 4}, &box), ASDIC_OK);
    asdic_pose at = {.position_m = random_place(&seed, 150.0)};
    assert_int_equal(asdic_scene_add_object(scene, "ball", ball, at, rock), ASDIC_OK);
    if (with_box) {
        at.position_m = random_place(&seed, 60.0);
        assert_int_equal(asdic_scene_add_moving_object(scene, "box", box, at, rock), ASDIC_OK);
    }
    assert_int_equal(asdic_scene_commit(scene), ASDIC_OK);
    asdic_mesh_destroy(&ball);
    asdic_mesh_destroy(&box);
}

static asdic_scene *make_hilly(asdic_context *ctx, const asdic_mesh *hills) {
    asdic_scene *scene = NULL;
    assert_int_equal(asdic_scene_create(ctx, &scene), ASDIC_OK);
    assert_int_equal(
        asdic_scene_add_bottom(scene, hills, (asdic_pose){0}, asdic_material_bottom(2.0)),
        ASDIC_OK);
    return scene;
}

static void compare_scenes(const asdic_scene *a, const asdic_scene *b) {
    assert_int_equal(a->triangle_count, b->triangle_count);
    assert_memory_equal(a->triangles, b->triangles, a->triangle_count * sizeof *a->triangles);
    assert_memory_equal(&a->origin_m, &b->origin_m, sizeof a->origin_m);
    assert_int_equal(a->part_count, b->part_count);
    assert_int_equal(a->material_count, b->material_count);
    assert_true(a->bvh.extent_m == b->bvh.extent_m);
    assert_true(a->min_m.z == b->min_m.z && a->max_m.x == b->max_m.x);
    asdic_placement *pa = NULL, *pb = NULL;
    assert_int_equal(asdic_placement_create(a, &pa), ASDIC_OK);
    assert_int_equal(asdic_placement_create(b, &pb), ASDIC_OK);
    uint64_t random = 5;
    for (int i = 0; i < 300; i++) {
        asdic_way way = {random_place(&random, 120.0), random_place(&random, 120.0)};
        asdic_nearest na = asdic_placement_nearest(pa, &way, NULL, 1000.0);
        asdic_nearest nb = asdic_placement_nearest(pb, &way, NULL, 1000.0);
        assert_true(na.distance_m == nb.distance_m && na.part == nb.part);
    }
    asdic_placement_destroy(&pa);
    asdic_placement_destroy(&pb);
}

/* A lifted triangle of a hierarchy. */
typedef struct leaf {
    uint32_t id;
    float v[9];
} leaf;

static int compare_leaves(const void *a, const void *b) {
    return memcmp(a, b, sizeof(leaf));
}

static leaf *list_leaves(const asdic_bvh *bvh, size_t *count) {
    leaf *out = calloc(bvh->block_count * DEV_LEAF_TRIANGLES, sizeof *out);
    assert_non_null(out);
    *count = 0;
    for (size_t b = 0; b < bvh->block_count; b++) {
        const dev_block4 *block = &bvh->blocks[b];
        for (int i = 0; i < DEV_LEAF_TRIANGLES && block->id[i] != ~0u; i++) {
            leaf *to = &out[(*count)++];
            to->id = block->id[i];
            for (int k = 0; k < 9; k++) {
                to->v[k] = block->v[k][i];
            }
        }
    }
    qsort(out, *count, sizeof *out, compare_leaves);
    return out;
}

/* Lifted in LAYERS, both scenes have the same triangles, of which a hierarchy holds all. */
static void compare_lifted(const asdic_scene *a, const asdic_scene *b, const dev_layer *layers,
                           size_t layer_count) {
    asdic_scene *la = NULL, *lb = NULL;
    assert_int_equal(asdic_scene_lift_layers(a, layers, layer_count, &la), ASDIC_OK);
    assert_int_equal(asdic_scene_lift_layers(b, layers, layer_count, &lb), ASDIC_OK);
    size_t na, nb;
    leaf *leaves_a = list_leaves(&la->bvh, &na), *leaves_b = list_leaves(&lb->bvh, &nb);
    assert_int_equal(na, nb);
    assert_true(na > a->triangle_count); /* some are in two layers, or halved */
    assert_memory_equal(leaves_a, leaves_b, na * sizeof *leaves_a);
    assert_true(la->bvh.extent_m == lb->bvh.extent_m);
    free(leaves_a);
    free(leaves_b);
    asdic_scene_unlift(&la);
    asdic_scene_unlift(&lb);
}

/* A scene that keeps its ground, to be reopened. */
static asdic_scene *make_kept(asdic_context *ctx, const asdic_mesh *hills) {
    asdic_scene *kept = make_hilly(ctx, hills);
    assert_int_equal(asdic_scene_keep_ground(kept), ASDIC_OK);
    add_objects(ctx, kept, 1, true);
    return kept;
}

/* A floor so large that eight million pieces would keep to 2 mm: it falls into four million at most, also in a cast,
 * whose topmost layer does not bend rays. */
static void test_large_floor(void **state) {
    (void)state;
    static const double corners[] = {-14e3, -14e3, 60, 14e3, -14e3, 60, -14e3, 14e3, 60};
    static const uint32_t index[] = {0, 1, 2};
    const dev_layer cast[] = {{-1e5f, -20.0f, 0.0f, 0.0f, 1}, {-20.0f, 1e5f, -8e-5f, 0.0f, 1}};
    asdic_context *ctx = NULL;
    asdic_scene *scene = NULL, *lifted = NULL;
    asdic_mesh *mesh = NULL;
    size_t count = 0;
    assert_int_equal(asdic_context_create(&ctx), ASDIC_OK);
    assert_int_equal(asdic_scene_create(ctx, &scene), ASDIC_OK);
    assert_int_equal(asdic_mesh_from_triangles(ctx, corners, 3, index, 1, &mesh), ASDIC_OK);
    assert_int_equal(asdic_scene_add_bottom(scene, mesh, (asdic_pose){.yaw_rad = 0.0},
                                            asdic_material_bottom(2.0)),
                     ASDIC_OK);
    assert_int_equal(asdic_scene_commit(scene), ASDIC_OK);
    assert_int_equal(asdic_scene_lift_layers(scene, cast, 2, &lifted), ASDIC_OK);
    free(list_leaves(&lifted->bvh, &count));
    assert_true(count > 1000000 && count <= 4000000);
    asdic_scene_unlift(&lifted);
    asdic_mesh_destroy(&mesh);
    asdic_scene_destroy(&scene);
    asdic_context_destroy(&ctx);
}

/* A scene whose objects were taken out and replaced is that with the new ones, built from nothing. */
static void test_reopened(void **state) {
    (void)state;
    asdic_context *ctx = NULL;
    assert_int_equal(asdic_context_create(&ctx), ASDIC_OK);
    asdic_mesh *hills = make_hills(ctx);
    asdic_scene *kept = make_kept(ctx, hills);
    for (uint64_t seed = 2; seed < 8; seed++) {
        assert_int_equal(asdic_scene_reopen(kept), ASDIC_OK);
        add_objects(ctx, kept, seed, seed % 2);
        const dev_node8 *ground = kept->ground->bvh.nodes;
        asdic_scene *fresh = make_hilly(ctx, hills);
        add_objects(ctx, fresh, seed, seed % 2);
        compare_scenes(kept, fresh);
        assert_true(!asdic_scene_can_reopen(fresh) && ground && kept->ground->bvh.nodes == ground);
        asdic_scene_destroy(&fresh);
    }
    asdic_scene_destroy(&kept);
    asdic_mesh_destroy(&hills);
    asdic_context_destroy(&ctx);
}

/* So is its lifted view; the bottom is lifted once for the same layers, and anew for others. */
static void test_reopened_and_lifted(void **state) {
    (void)state;
    static const dev_layer water[2][2] = {
        {{-1e5f, 0.5f, 2e-4f, -500.0f, 1}, {0.5f, 1e5f, -5e-4f, 500.0f, 1}},
        {{-1e5f, -0.5f, 3e-3f, -500.0f, 1}, {-0.5f, 1e5f, 1e-4f, 500.0f, 1}}};
    asdic_context *ctx = NULL;
    assert_int_equal(asdic_context_create(&ctx), ASDIC_OK);
    asdic_mesh *hills = make_hills(ctx);
    asdic_scene *kept = make_kept(ctx, hills);
    const dev_node8 *before = NULL;
    for (uint64_t seed = 2; seed < 8; seed++) {
        assert_int_equal(asdic_scene_reopen(kept), ASDIC_OK);
        add_objects(ctx, kept, seed, seed % 2);
        asdic_scene *fresh = make_hilly(ctx, hills);
        add_objects(ctx, fresh, seed, seed % 2);
        compare_lifted(kept, fresh, water[seed >= 5], 2);
        compare_scenes(kept, fresh);
        bool is_same = kept->ground->lifted.nodes == before;
        assert_int_equal(is_same, seed != 2 && seed != 5);
        before = kept->ground->lifted.nodes;
        asdic_scene_destroy(&fresh);
    }
    asdic_scene_destroy(&kept);
    asdic_mesh_destroy(&hills);
    asdic_context_destroy(&ctx);
}

/* --- meshes from files ------------------------------------------------------------------------- */

static void write_file(const char *path, const char *text) {
    FILE *file = fopen(path, "w");
    assert_non_null(file);
    assert_true(fputs(text, file) >= 0);
    assert_int_equal(fclose(file), 0);
}

/* Says of PATH that it was changed SECONDS after 2001. */
static void date_file(const char *path, long seconds) {
    const struct timespec times[2] = {{978307200 + seconds, 0}, {978307200 + seconds, 0}};
    assert_int_equal(utimensat(AT_FDCWD, path, times, 0), 0);
}

static asdic_status load_run(asdic_context *ctx, uint64_t run, asdic_mission **before) {
    const asdic_draw draw = {.seed = 1, .run = run};
    asdic_mission *m = NULL;
    asdic_status status = asdic_mission_load_trial(ctx, "scene.yaml", NULL, 0, &draw, *before, &m);
    asdic_mission_destroy(before);
    *before = m;
    return status;
}

/* A mesh is read again only where its file looks other than before. */
static void test_meshes_are_read_once(void **state) {
    (void)state;
    static const char mesh[] = "OFF\n4 4 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n"
                               "3 0 2 1\n3 0 1 3\n3 1 2 3\n3 2 0 3\n";
    char folder[] = "trial_XXXXXX", nonsense[sizeof mesh];
    asdic_context *ctx = NULL;
    asdic_mission *m = NULL;
    assert_int_equal(asdic_context_create(&ctx), ASDIC_OK);
    assert_true(mkdtemp(folder) && chdir(folder) == 0);
    write_file("scene.yaml",
               "version: 1\n"
               "bottom: {depth_m: 20}\n"
               "objects:\n"
               "  - {name: a, mesh: {file: a.off}, position_m: [30, 0, 10]}\n"
               "  - {name: b, mesh: {file: a.off}, position_m: [30, 5, 10]}\n"
               "sonar: {frequency_khz: 100, source_level_db: 190, max_range_m: 30,\n"
               "  receivers: [{length_h_m: 0.06, length_v_m: 0.06}]}\n"
               "mission: {waypoints: {points_m: [[0, 0, 10], [60, 0, 10]], speed_mps: 1}}\n"
               "trial:\n"
               "  draws: [{key: 'objects[0].position_m[0]', uniform: [20, 40]}]\n");
    write_file("a.off", mesh);
    date_file("a.off", 0);
    assert_int_equal(load_run(ctx, 0, &m), ASDIC_OK);
    assert_int_equal(m->scene->triangle_count, 8);
    memset(nonsense, 'x', sizeof nonsense - 1);
    nonsense[sizeof nonsense - 1] = '\0';
    write_file("a.off", nonsense);
    date_file("a.off", 0);
    for (uint64_t run = 1; run < 4; run++) {
        assert_int_equal(load_run(ctx, run, &m), ASDIC_OK);
        assert_int_equal(m->scene->triangle_count, 8);
    }
    date_file("a.off", 1);
    assert_int_equal(load_run(ctx, 4, &m), ASDIC_ERROR_INPUT);
    assert_true(remove("a.off") == 0 && remove("scene.yaml") == 0);
    assert_true(chdir("..") == 0 && rmdir(folder) == 0);
    asdic_mission_destroy(&m);
    asdic_context_destroy(&ctx);
}

/* What nobody listens to is not prepared for echoes; a run that pings finds it prepared, whatever the run before was. */
static void test_an_ideal_sonar_prepares_no_echoes(void **state) {
    (void)state;
    static const char scene[] =
        "version: 1\n"
        "bottom: {depth_m: 20}\n"
        "objects: [{name: a, sphere: {radius_m: 1}, position_m: [20, 0, 10]}]\n"
        "sonar: {frequency_khz: 100, source_level_db: 190, max_range_m: 30, receivers: [{}]}\n"
        "mission: {waypoints: {points_m: [[0, 0, 10], [60, 0, 10]], speed_mps: 1}}\n"
        "trial: {time_s: 9%s}\n";
    char folder[] = "trial_XXXXXX", text[sizeof scene + 40];
    asdic_context *ctx = NULL;
    asdic_mission *m = NULL;
    assert_int_equal(asdic_context_create(&ctx), ASDIC_OK);
    assert_true(mkdtemp(folder) && chdir(folder) == 0);
    for (uint64_t run = 0; run < 4; run++) {
        bool is_ideal = run == 0 || run == 2;
        snprintf(text, sizeof text, scene, is_ideal ? ", ideal: {pd: 1}" : "");
        write_file("scene.yaml", text);
        assert_int_equal(load_run(ctx, run, &m), ASDIC_OK);
        bool is_flat = m->scene->triangles[0].corner_normals[0] == DEV_FLAT;
        assert_int_equal(is_flat, is_ideal);
    }
    assert_true(remove("scene.yaml") == 0 && chdir("..") == 0 && rmdir(folder) == 0);
    asdic_mission_destroy(&m);
    asdic_context_destroy(&ctx);
}

/* Where even as many rays as those of `auto` leave rough pings, a trial takes as many, as a number. */
static void test_rays_of_a_fine_sonar(void **state) {
    (void)state;
    char folder[] = "trial_XXXXXX";
    asdic_context *ctx = NULL;
    asdic_mission *run = NULL, *trial = NULL;
    asdic_trial_options options = asdic_trial_options_default();
    options.scene = "scene.yaml";
    assert_int_equal(asdic_context_create(&ctx), ASDIC_OK);
    assert_true(mkdtemp(folder) && chdir(folder) == 0);
    write_file("scene.yaml",
               "version: 1\n"
               "bottom: {depth_m: 20}\n"
               "objects: [{name: a, sphere: {radius_m: 1}, position_m: [20, 0, 10]}]\n"
               "sonar: {frequency_khz: 400, source_level_db: 190, max_range_m: 30,\n"
               "  bin_length_m: 0.01, receivers:\n"
               "  {fan: {count: 256, sector_deg: 130, length_h_m: 1.7, length_v_m: 0.1}}}\n"
               "mission: {waypoints: {points_m: [[0, 0, 10], [60, 0, 10]], speed_mps: 1}}\n");
    assert_int_equal(asdic_mission_load(ctx, "scene.yaml", &run), ASDIC_OK);
    assert_int_equal(asdic_trial_load(ctx, &options, 0, 0, NULL, &trial), ASDIC_OK);
    asdic_ray_forecast whole = asdic_mission_ray_forecast(run);
    asdic_ray_forecast taken = asdic_mission_ray_forecast(trial);
    assert_true(whole.is_auto && whole.is_rough);
    assert_int_equal(taken.rays, whole.rays);
    assert_false(taken.is_auto);
    assert_true(remove("scene.yaml") == 0 && chdir("..") == 0 && rmdir(folder) == 0);
    asdic_mission_destroy(&run);
    asdic_mission_destroy(&trial);
    asdic_context_destroy(&ctx);
}

/* --- intervals --------------------------------------------------------------------------------- */

static double log_choose(double n, double k) {
    return lgamma(n + 1.0) - lgamma(k + 1.0) - lgamma(n - k + 1.0);
}

/* Over all counts that can happen, the bounds hold the truth with 0.95 or more. */
static void test_shares_cover(void **state) {
    (void)state;
    for (double p = 0.01; p < 1.0; p += 0.07) {
        double held = 0.0;
        for (uint64_t k = 0; k <= 40; k++) {
            asdic_trial_figure f = asdic_trial_share(k, 40, 0.95);
            double chance = exp(log_choose(40, (double)k) + (double)k * log(p) +
                                (40.0 - (double)k) * log1p(-p));
            held += f.low <= p && p <= f.high ? chance : 0.0;
        }
        assert_true(held >= 0.95 && held <= 1.0 + 1e-9);
    }
}

/* The log likelihood of B, C discordant of N where the chances differ by D and the second is Q. */
static double likelihood(double b, double c, double n, double d, double q) {
    double rest = 1.0 - 2.0 * q - d;
    return (b > 0.0 ? b * log(q + d) : 0.0) + (c > 0.0 ? c * log(q) : 0.0) +
           (n > b + c ? (n - b - c) * log(rest) : 0.0);
}

/* Tango's bounds are where the score is 1.96; the likeliest Q is found by a search here. */
static void test_differences(void **state) {
    (void)state;
    static const uint64_t cases[][3] = {{12, 3, 50}, {40, 45, 1000}, {1, 0, 30}, {5, 5, 20}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        double b = (double)cases[i][0], c = (double)cases[i][1], n = (double)cases[i][2];
        asdic_trial_figure f = asdic_trial_paired(cases[i][0], cases[i][1], cases[i][2], 0.95);
        assert_true(f.value == (b - c) / n && f.low < f.value && f.value < f.high);
        const double ends[2] = {f.low, f.high};
        for (int k = 0; k < 2; k++) {
            double d = ends[k], low = fmax(0.0, -d), high = 0.5 * (1.0 - d);
            for (int step = 0; step < 200; step++) { /* golden section of a concave function */
                double x = high - 0.618033988749895 * (high - low);
                double y = low + 0.618033988749895 * (high - low);
                if (likelihood(b, c, n, d, x) < likelihood(b, c, n, d, y)) {
                    low = x;
                } else {
                    high = y;
                }
            }
            double q = 0.5 * (low + high);
            double score = (b - c - n * d) / sqrt(n * (2.0 * q + d - d * d));
            if (fabs(fabs(score) - 1.959964) > 1e-3) {
                fail_msg("case %zu: score %.6g at %.6g", i, score, d);
            }
        }
    }
    /* Bounds are told to the last digits; where all pairs are discordant they end at the end. */
    asdic_trial_figure even = asdic_trial_paired(5, 5, 20, 0.95);
    assert_close(even.high, -even.low, 1e-12);
    assert_close(asdic_trial_paired(7, 0, 7, 0.95).high, 1.0, 1e-12);
    assert_close(asdic_trial_paired(0, 7, 7, 0.95).low, -1.0, 1e-12);
    assert_close(asdic_trial_paired(1, 0, 1, 0.95).value, 1.0, 0.0);
    /* Of nothing, or of less than all, anything may be true. */
    static const uint64_t unknown[][3] = {{0, 0, 0}, {3, 2, 4}, {UINT64_MAX, 2, 4}};
    for (int i = 0; i < 3; i++) {
        asdic_trial_figure f =
            asdic_trial_paired(unknown[i][0], unknown[i][1], unknown[i][2], 0.95);
        assert_true(isnan(f.value) && f.low == -1.0 && f.high == 1.0);
    }
}

/* Twice the binomial tail; many pairs go by the normal law, 1.96 standard errors being 5 %. */
static void test_mcnemar(void **state) {
    (void)state;
    assert_close(asdic_trial_mcnemar(1, 9), 2.0 * 11.0 / 1024.0, 1e-12);
    assert_close(asdic_trial_mcnemar(9, 1), 2.0 * 11.0 / 1024.0, 1e-12);
    assert_close(asdic_trial_mcnemar(0, 5), 2.0 / 32.0, 1e-12);
    assert_true(asdic_trial_mcnemar(0, 0) == 1.0 && asdic_trial_mcnemar(4, 4) == 1.0);
    assert_true(asdic_trial_mcnemar(1, 0) == 1.0);
    /* 250000 pairs: a standard error of 500. */
    assert_close(asdic_trial_mcnemar(125000 - 490, 125000 + 490), erfc(1.96 / sqrt(2.0)), 1e-12);
    assert_close(asdic_trial_mcnemar(125000 + 490, 125000 - 490), 0.0499957902964409, 1e-12);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_nearest),
        cmocka_unit_test(test_inside),
        cmocka_unit_test(test_inside_over_edges),
        cmocka_unit_test(test_nothing_is_inside_a_plate),
        cmocka_unit_test(test_large_floor),
        cmocka_unit_test(test_reopened),
        cmocka_unit_test(test_reopened_and_lifted),
        cmocka_unit_test(test_meshes_are_read_once),
        cmocka_unit_test(test_an_ideal_sonar_prepares_no_echoes),
        cmocka_unit_test(test_rays_of_a_fine_sonar),
        cmocka_unit_test(test_shares_cover),
        cmocka_unit_test(test_differences),
        cmocka_unit_test(test_mcnemar),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
