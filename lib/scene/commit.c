/*
 * Commit: world coordinates in double become floats relative to the scene's centre, so that a
 * scene a million metres from the world's origin loses nothing, and the hierarchy is built.
 */
#include "moving.h"

#include "base/try.h"
#include "place.h"
#include "smooth.h"

#include "../base/clock.h"
#include "../base/context.h"
#include "../base/vec.h"

#include <stdlib.h>

/* The lower and the upper corner of a box. */
typedef struct box {
    asdic_vec3 lo, hi;
} box;

static box join(box a, box b) {
    return (box){
        {fmin(a.lo.x, b.lo.x), fmin(a.lo.y, b.lo.y), fmin(a.lo.z, b.lo.z)},
        {fmax(a.hi.x, b.hi.x), fmax(a.hi.y, b.hi.y), fmax(a.hi.z, b.hi.z)},
    };
}

/* Brings M's CORNERS to its anchor, and PART's radius with them; the box round them. */
static box anchor(const asdic_movable *m, double *corners_m, asdic_part *part) {
    asdic_mat3 turn = asdic_mat3_of(&m->anchor);
    asdic_part there;
    box out;
    for (size_t i = 0; i < m->count; i++) {
        asdic_place_corners(&m->corners_m[9 * i], turn, m->anchor.position_m, &corners_m[9 * i]);
    }
    asdic_place_sphere(corners_m, m->count, &there, &out.lo, &out.hi);
    part->radius_m = there.radius_m;
    return out;
}

/* Bounding spheres of the parts that are not placed yet; the triangles of a part are contiguous. The
 * boxes of the scene and of the ground: bottoms, before any object. The ground's centre is the
 * origin, so that objects come and go without it; without a ground the centre of what stays, or,
 * where all moves, of that at its anchors, where what moves is until it is placed. */
static void measure_parts(asdic_scene *scene) {
    const box empty = {{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}};
    box all = empty, ground = empty, still = empty, anchored = empty;
    const asdic_movable *movable = scene->movables; /* the next one: as parts, in order */
    size_t count = scene->built;
    if (count > 0) {
        all = ground = (box){scene->ground_min_m, scene->ground_max_m};
    }
    for (size_t begin = count, end; begin < scene->triangle_count; begin = end) {
        uint32_t number = scene->corner_parts[begin];
        for (end = begin; end < scene->triangle_count && scene->corner_parts[end] == number;) {
            end++;
        }
        box part;
        asdic_place_sphere(&scene->corners_m[9 * begin], end - begin, &scene->parts[number],
                           &part.lo, &part.hi);
        if (scene->parts[number].kind == DEV_KIND_OBJECT) {
            asdic_place_faces(&scene->corners_m[9 * begin], end - begin, &scene->parts[number]);
        }
        all = join(all, part);
        if (scene->parts[number].moves) {
            anchored = join(anchored,
                            anchor(movable++, &scene->corners_m[9 * begin], &scene->parts[number]));
        } else {
            still = join(still, part);
        }
        if (begin == count && scene->parts[number].kind == DEV_KIND_BOTTOM) {
            ground = join(ground, part);
            count = end;
        }
    }
    if (scene->triangle_count > 0) {
        box frame = count > 0 ? ground : isfinite(still.lo.x) ? still : anchored;
        scene->min_m = all.lo;
        scene->max_m = all.hi;
        scene->ground_count = count;
        scene->ground_min_m = ground.lo;
        scene->ground_max_m = ground.hi;
        scene->origin_m = asdic_vec3_scale(asdic_vec3_add(frame.lo, frame.hi), 0.5);
    }
}

/* Moving objects are placed as later poses place them, so that moving one back gives the same
 * bytes. */
static asdic_status place_movables(asdic_scene *scene) {
    size_t most = 0;
    for (size_t i = 0; i < scene->movable_count; i++) {
        most = scene->movables[i].count > most ? scene->movables[i].count : most;
    }
    double *world_m = malloc((9 * most + 1) * sizeof *world_m);
    for (size_t i = 0; world_m && i < scene->movable_count; i++) {
        const asdic_movable *m = &scene->movables[i];
        asdic_movable_place(m, &m->pose, scene->origin_m, world_m, scene->triangles + m->first);
    }
    bool placed = world_m != NULL;
    free(world_m);
    return placed ? ASDIC_OK : asdic_fail_memory(scene->ctx, "what moves");
}

asdic_status asdic_scene_commit(asdic_scene *scene) {
    if (!scene) {
        return asdic_fail_null(NULL, __func__);
    }
    if (scene->committed) {
        return asdic_fail(scene->ctx, ASDIC_ERROR_ARGUMENT, "the scene is committed already");
    }
    double start_s = asdic_clock_s();
    measure_parts(scene);
    dev_triangle *grown =
        realloc(scene->triangles, (scene->triangle_count + 1) * sizeof *scene->triangles);
    if (!grown) {
        return asdic_fail(scene->ctx, ASDIC_ERROR_MEMORY,
                          "out of memory for a scene of %zu triangles", scene->triangle_count);
    }
    scene->triangles = grown;
    for (size_t i = scene->built; i < scene->triangle_count; i++) {
        scene->triangles[i] = (dev_triangle){.part = scene->corner_parts[i]};
        asdic_place_triangle(&scene->corners_m[9 * i], scene->origin_m, &scene->triangles[i]);
    }
    TRY(asdic_scene_smooth(scene));
    TRY(place_movables(scene));
    double assemble_s = asdic_clock_s();
    TRY(asdic_scene_assemble(scene));
    free(scene->corners_m);
    free(scene->corner_parts);
    scene->corners_m = NULL;
    scene->corner_parts = NULL;
    scene->triangle_capacity = 0;
    scene->committed = true;
    scene->build_s = asdic_clock_s() - start_s;
    scene->hierarchy_s = asdic_clock_s() - assemble_s;
    return ASDIC_OK;
}

asdic_scene_info asdic_scene_get_info(const asdic_scene *scene) {
    if (!scene) {
        return (asdic_scene_info){0};
    }
    asdic_scene_info info = {
        .has_surface = scene->has_surface,
        .has_bottom_plane = scene->has_bottom_plane,
        .bottom_plane_depth_m = scene->bottom_plane_depth_m,
        .triangles = scene->triangle_count,
        .objects = scene->point_count,
        .bvh_nodes = scene->bvh.node_count,
        .bvh_bytes =
            scene->bvh.node_count * sizeof(dev_node8) + scene->bvh.block_count * sizeof(dev_block4),
        .build_s = scene->build_s,
        .hierarchy_s = scene->hierarchy_s,
        .origin_m = scene->origin_m,
        .min_m = scene->min_m,
        .max_m = scene->max_m,
    };
    for (size_t p = 0; p < scene->part_count; p++) {
        info.objects += scene->parts[p].kind == DEV_KIND_OBJECT;
    }
    return info;
}
