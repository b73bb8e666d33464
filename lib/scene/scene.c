/*
 * Scene assembly: meshes are placed in the world in double precision and kept until commit.
 */
#include "moving.h"

#include "laws/scatterer.h"
#include "place.h"
#include "triangles.h"

#include "../base/context.h"
#include "../base/memory_left.h"
#include "../base/try.h"
#include "../base/vec.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

asdic_status asdic_scene_create(asdic_context *ctx, asdic_scene **out) {
    if (!out) {
        return asdic_fail(ctx, ASDIC_ERROR_ARGUMENT, "no place for the scene was given");
    }
    *out = calloc(1, sizeof **out);
    if (!*out) {
        return asdic_fail_memory(ctx, "a scene");
    }
    (*out)->ctx = ctx;
    (*out)->has_surface = true;
    (*out)->surface = asdic_material_of(asdic_law_find("course"));
    (*out)->bvh.root = DEV_EMPTY;
    (*out)->crease_rad = ASDIC_CREASE_RAD;
    return ASDIC_OK;
}

static void forget_movables(asdic_scene *scene) {
    for (size_t i = 0; i < scene->movable_count; i++) {
        free(scene->movables[i].corners_m);
        free(scene->movables[i].normals);
    }
    scene->movable_count = 0;
}

static void forget_ground(asdic_ground *ground) {
    if (ground) {
        asdic_bvh_finish(&ground->bvh);
        asdic_bvh_finish(&ground->lifted);
        free(ground->layers);
        pthread_mutex_destroy(&ground->lock);
        free(ground);
    }
}

void asdic_scene_destroy(asdic_scene **scene) {
    if (!scene || !*scene) {
        return;
    }
    asdic_scene *s = *scene;
    free(s->materials);
    free(s->parts);
    free(s->points);
    forget_movables(s);
    free(s->movables);
    free(s->corners_m);
    free(s->corner_parts);
    free(s->triangles);
    asdic_bvh_finish(&s->bvh);
    forget_ground(s->ground);
    free(s);
    *scene = NULL;
}

static asdic_status check_open(const asdic_scene *scene) {
    if (scene->committed) {
        return asdic_fail(scene->ctx, ASDIC_ERROR_ARGUMENT,
                          "the scene is committed; nothing can be added or changed any more");
    }
    return ASDIC_OK;
}

asdic_status asdic_scene_set_surface(asdic_scene *scene, bool enabled) {
    if (!scene) {
        return asdic_fail_null(NULL, __func__);
    }
    TRY(check_open(scene));
    scene->has_surface = enabled;
    return ASDIC_OK;
}

asdic_status asdic_scene_set_surface_law(asdic_scene *scene, asdic_material material) {
    if (!scene) {
        return asdic_fail_null(NULL, __func__);
    }
    TRY(check_open(scene));
    TRY(asdic_material_check_use(scene->ctx, &material, ASDIC_LAW_SURFACE));
    scene->surface = material;
    return ASDIC_OK;
}

void asdic_scene_set_threads(asdic_scene *scene, unsigned threads) {
    if (!scene) {
        return;
    }
    scene->threads = threads;
}

static bool in_range(double value, double low, double high) {
    return value >= low && value <= high; /* false for NAN */
}

static asdic_status add_material(asdic_scene *scene, const asdic_material *material, unsigned use,
                                 size_t *index) {
    TRY(asdic_material_check_use(scene->ctx, material, use));
    asdic_material *grown = realloc(scene->materials, (scene->material_count + 1) * sizeof *grown);
    if (!grown) {
        return asdic_fail_memory(scene->ctx, "a material");
    }
    scene->materials = grown;
    scene->materials[scene->material_count] = *material;
    *index = scene->material_count++;
    return ASDIC_OK;
}

asdic_status asdic_scene_set_bottom_plane(asdic_scene *scene, double depth_m,
                                          asdic_material material) {
    if (!scene) {
        return asdic_fail_null(NULL, __func__);
    }
    TRY(check_open(scene));
    if (!in_range(depth_m, 0.0, 12000.0)) {
        return asdic_fail(scene->ctx, ASDIC_ERROR_ARGUMENT,
                          "bottom depth %g m is out of range [0, 12000]", depth_m);
    }
    TRY(add_material(scene, &material, ASDIC_LAW_BOTTOM, &scene->bottom_plane_material));
    scene->has_bottom_plane = true;
    scene->bottom_plane_depth_m = depth_m;
    return ASDIC_OK;
}

/* Bytes that a triangle takes at most: corners, hierarchy and the device's copy together. Measured
 * on 4 million triangles: 1,160 MiB. */
#define TRIANGLE_BYTES 304

/* Fails before the memory of the machine runs out and the system kills the process. The free memory
 * is read before the first triangle. */
static asdic_status check_memory(asdic_scene *scene, size_t triangles) {
    uint64_t needed = (uint64_t)triangles * TRIANGLE_BYTES;
    if (scene->memory_bytes == 0) {
        scene->memory_bytes = asdic_memory_left();
    }
    char what[64];
    snprintf(what, sizeof what, "a scene of %zu triangles or more needs", triangles);
    return asdic_memory_check(scene->ctx, needed, scene->memory_bytes, what,
                              "use fewer or coarser objects ('segments')");
}

asdic_status asdic_scene_reserve(asdic_scene *scene, size_t more) {
    size_t needed = scene->triangle_count + more;
    if (needed <= scene->triangle_capacity) {
        return ASDIC_OK;
    }
    TRY(check_memory(scene, needed));
    size_t capacity = needed > 2 * scene->triangle_capacity ? needed : 2 * scene->triangle_capacity;
    double *corners = realloc(scene->corners_m, capacity * 9 * sizeof *corners);
    if (corners) {
        scene->corners_m = corners;
    }
    uint32_t *parts = realloc(scene->corner_parts, capacity * sizeof *parts);
    if (parts) {
        scene->corner_parts = parts;
    }
    if (!corners || !parts) {
        return asdic_fail(scene->ctx, ASDIC_ERROR_MEMORY,
                          "out of memory for a scene of %zu triangles", needed);
    }
    scene->triangle_capacity = capacity;
    return ASDIC_OK;
}

static void place_triangles(asdic_scene *scene, const asdic_mesh *mesh, const asdic_pose *pose) {
    asdic_mat3 turn = asdic_mat3_of(pose);
    for (size_t i = 0; i < mesh->triangle_count; i++) {
        size_t at = scene->triangle_count++;
        scene->corner_parts[at] = (uint32_t)scene->part_count;
        double corners_m[9];
        asdic_mesh_corners(mesh, i, corners_m);
        asdic_place_corners(corners_m, turn, pose->position_m, &scene->corners_m[9 * at]);
    }
}

#define POSE_LIMIT 1e7 /* m and rad, as scene files have it */

/* Farther positions are none on earth, and their products overflow the kernels' floats. */
asdic_status asdic_pose_check(asdic_context *ctx, const asdic_pose *pose) {
    const double values[] = {pose->position_m.x, pose->position_m.y, pose->position_m.z,
                             pose->roll_rad,     pose->pitch_rad,    pose->yaw_rad};
    for (size_t i = 0; i < sizeof values / sizeof *values; i++) {
        if (!(fabs(values[i]) <= POSE_LIMIT)) {
            return asdic_fail(ctx, ASDIC_ERROR_ARGUMENT,
                              "a pose is not finite or beyond %g: position (%g, %g, %g) m, roll "
                              "%g, pitch %g, yaw %g rad",
                              POSE_LIMIT, values[0], values[1], values[2], values[3], values[4],
                              values[5]);
        }
    }
    return ASDIC_OK;
}

static asdic_status add_part(asdic_scene *scene, asdic_part *part, const asdic_mesh *mesh,
                             const asdic_pose *pose, const asdic_material *material) {
    TRY(check_open(scene));
    TRY(asdic_pose_check(scene->ctx, pose));
    TRY(asdic_scene_reserve(scene, mesh->triangle_count));
    asdic_part *grown = realloc(scene->parts, (scene->part_count + 1) * sizeof *grown);
    if (!grown) {
        return asdic_fail_memory(scene->ctx, "an object");
    }
    scene->parts = grown;
    unsigned use = part->kind == DEV_KIND_OBJECT ? ASDIC_LAW_OBJECT : ASDIC_LAW_BOTTOM;
    TRY(add_material(scene, material, use, &part->material));
    place_triangles(scene, mesh, pose);
    part->crease_rad = scene->crease_rad;
    part->number = part->kind == DEV_KIND_OBJECT ? (unsigned)++scene->object_count : 0;
    scene->parts[scene->part_count++] = *part;
    return ASDIC_OK;
}

asdic_status asdic_scene_add_bottom(asdic_scene *scene, const asdic_mesh *mesh, asdic_pose pose,
                                    asdic_material material) {
    if (!scene || !mesh) {
        return asdic_fail_null(scene ? scene->ctx : NULL, __func__);
    }
    asdic_part part = {.kind = DEV_KIND_BOTTOM};
    return add_part(scene, &part, mesh, &pose, &material);
}

asdic_status asdic_scene_set_crease(asdic_scene *scene, double crease_rad) {
    if (!scene) {
        return asdic_fail_null(NULL, __func__);
    }
    if (!(crease_rad >= 0.0 && crease_rad <= 0.5 * ASDIC_PI)) {
        return asdic_fail(scene->ctx, ASDIC_ERROR_ARGUMENT,
                          "a crease of %g rad; 0 to pi / 2 are allowed", crease_rad);
    }
    scene->crease_rad = crease_rad;
    return ASDIC_OK;
}

/* Copies NAME to OUT, which has ASDIC_NAME_SIZE bytes. */
static asdic_status copy_name(const asdic_scene *scene, const char *name, char *out) {
    size_t length = name ? strlen(name) : 0;
    if (length == 0 || length >= ASDIC_NAME_SIZE) {
        return asdic_fail(scene->ctx, ASDIC_ERROR_ARGUMENT,
                          "an object's name has %zu characters; 1 to %d are allowed", length,
                          ASDIC_NAME_SIZE - 1);
    }
    memcpy(out, name, length + 1);
    return ASDIC_OK;
}

asdic_status asdic_scene_add_object(asdic_scene *scene, const char *name, const asdic_mesh *mesh,
                                    asdic_pose pose, asdic_material material) {
    if (!scene || !mesh) {
        return asdic_fail_null(scene ? scene->ctx : NULL, __func__);
    }
    asdic_part part = {.kind = DEV_KIND_OBJECT};
    TRY(copy_name(scene, name, part.name));
    return add_part(scene, &part, mesh, &pose, &material);
}

/* Makes room for a movable of COUNT triangles; it is not counted yet. */
static asdic_status reserve_movable(asdic_scene *scene, size_t count) {
    asdic_movable *grown = realloc(scene->movables, (scene->movable_count + 1) * sizeof *grown);
    if (!grown) {
        return asdic_fail_memory(scene->ctx, "a moving object");
    }
    scene->movables = grown;
    asdic_movable *m = &grown[scene->movable_count];
    *m = (asdic_movable){.count = count, .corners_m = malloc((9 * count + 1) * sizeof(double))};
    return m->corners_m ? ASDIC_OK : asdic_fail_memory(scene->ctx, "a moving object");
}

asdic_status asdic_scene_add_moving_object(asdic_scene *scene, const char *name,
                                           const asdic_mesh *mesh, asdic_pose pose,
                                           asdic_material material) {
    if (!scene || !mesh) {
        return asdic_fail_null(scene ? scene->ctx : NULL, __func__);
    }
    asdic_part part = {.kind = DEV_KIND_OBJECT, .moves = true};
    TRY(copy_name(scene, name, part.name));
    TRY(check_open(scene));
    TRY(reserve_movable(scene, mesh->triangle_count));
    asdic_movable *m = &scene->movables[scene->movable_count];
    m->part = scene->part_count;
    m->first = scene->triangle_count;
    m->pose = m->anchor = pose;
    asdic_status status = add_part(scene, &part, mesh, &pose, &material);
    if (status) {
        free(m->corners_m);
        return status;
    }
    for (size_t i = 0; i < m->count; i++) {
        asdic_mesh_corners(mesh, i, &m->corners_m[9 * i]);
    }
    scene->movable_count++;
    return ASDIC_OK;
}

asdic_status asdic_scene_add_point(asdic_scene *scene, const char *name, asdic_vec3 position_m,
                                   double target_strength_db) {
    if (!scene) {
        return asdic_fail_null(NULL, __func__);
    }
    asdic_point point = {.position_m = position_m, .target_strength_db = target_strength_db};
    asdic_pose pose = {.position_m = position_m};
    TRY(check_open(scene));
    TRY(copy_name(scene, name, point.name));
    TRY(asdic_pose_check(scene->ctx, &pose));
    if (!in_range(target_strength_db, -200.0, 100.0)) {
        return asdic_fail(scene->ctx, ASDIC_ERROR_ARGUMENT,
                          "target strength %g dB is out of range [-200, 100]", target_strength_db);
    }
    asdic_point *grown = realloc(scene->points, (scene->point_count + 1) * sizeof *grown);
    if (!grown) {
        return asdic_fail_memory(scene->ctx, "a point target");
    }
    scene->points = grown;
    point.number = (unsigned)++scene->object_count;
    scene->points[scene->point_count++] = point;
    return ASDIC_OK;
}

asdic_status asdic_scene_keep_ground(asdic_scene *scene) {
    asdic_ground *ground = calloc(1, sizeof *ground);
    if (!ground || pthread_mutex_init(&ground->lock, NULL) != 0) {
        free(ground);
        return asdic_fail_memory(scene->ctx, "a bottom");
    }
    ground->bvh.root = ground->lifted.root = DEV_EMPTY;
    scene->ground = ground;
    return ASDIC_OK;
}

bool asdic_scene_can_reopen(const asdic_scene *scene) {
    return scene->committed && scene->ground && scene->ground_count > 0;
}

asdic_status asdic_scene_reopen(asdic_scene *scene) {
    if (!asdic_scene_can_reopen(scene)) {
        return asdic_fail(scene->ctx, ASDIC_ERROR_ARGUMENT,
                          "the scene keeps no bottom to which objects could be added anew");
    }
    size_t parts = 0, materials = 0;
    while (parts < scene->part_count && scene->parts[parts].kind == DEV_KIND_BOTTOM) {
        materials = scene->parts[parts++].material + 1;
    }
    forget_movables(scene);
    asdic_bvh_finish(&scene->bvh);
    scene->part_count = parts;
    scene->material_count = materials;
    scene->point_count = scene->object_count = 0;
    scene->triangle_count = scene->built = scene->ground_count;
    scene->moving_nodes = scene->moving_blocks = 0;
    scene->still_root = 0;
    scene->committed = false;
    return ASDIC_OK;
}

void asdic_scene_set_bottom(asdic_scene *scene, const asdic_material *material) {
    if (scene->has_bottom_plane) {
        scene->materials[scene->bottom_plane_material] = *material;
    }
    for (size_t i = 0; i < scene->part_count; i++) {
        if (scene->parts[i].kind == DEV_KIND_BOTTOM) {
            scene->materials[scene->parts[i].material] = *material;
        }
    }
}
