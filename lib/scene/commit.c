/*
 * Commit: world coordinates in double become floats relative to the scene's centre, so that a
 * scene a million metres from the world's origin loses nothing, and the hierarchy is built.
 */
#include "scene.h"
#include "smooth.h"

#include "../base/context.h"
#include "../base/vec.h"

#include <stdlib.h>
#include <time.h>

typedef struct box {
    asdic_vec3 lo, hi;
} box;

static double now_s(void) {
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static asdic_vec3 scene_corner(const asdic_scene *scene, size_t index) {
    const double *v = &scene->corners_m[3 * index];
    return (asdic_vec3){v[0], v[1], v[2]};
}

static void box_add(box *b, asdic_vec3 lo, asdic_vec3 hi) {
    b->lo = (asdic_vec3){fmin(b->lo.x, lo.x), fmin(b->lo.y, lo.y), fmin(b->lo.z, lo.z)};
    b->hi = (asdic_vec3){fmax(b->hi.x, hi.x), fmax(b->hi.y, hi.y), fmax(b->hi.z, hi.z)};
}

static asdic_vec3 box_centre(const box *b) {
    return asdic_vec3_scale(asdic_vec3_add(b->lo, b->hi), 0.5);
}

/* Bounding spheres of the parts, the scene's box and its centre. */
static asdic_status measure_parts(asdic_scene *scene) {
    const box nothing = {{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}};
    box *boxes = malloc((scene->part_count + 1) * sizeof *boxes);
    if (!boxes) {
        return asdic_fail_memory(scene->ctx, "the boxes of a scene's objects");
    }
    for (size_t p = 0; p < scene->part_count; p++) {
        boxes[p] = nothing;
    }
    for (size_t i = 0; i < 3 * scene->triangle_count; i++) {
        asdic_vec3 v = scene_corner(scene, i);
        box_add(&boxes[scene->corner_parts[i / 3]], v, v);
    }
    box whole = nothing;
    for (size_t p = 0; p < scene->part_count; p++) {
        scene->parts[p].center_m = box_centre(&boxes[p]);
        scene->parts[p].radius_m = 0.0;
        box_add(&whole, boxes[p].lo, boxes[p].hi);
    }
    for (size_t i = 0; i < 3 * scene->triangle_count; i++) {
        asdic_part *part = &scene->parts[scene->corner_parts[i / 3]];
        asdic_vec3 from_centre = asdic_vec3_sub(scene_corner(scene, i), part->center_m);
        part->radius_m = fmax(part->radius_m, asdic_vec3_length(from_centre));
    }
    if (scene->triangle_count > 0) {
        scene->min_m = whole.lo;
        scene->max_m = whole.hi;
        scene->origin_m = box_centre(&whole);
    }
    free(boxes);
    return ASDIC_OK;
}

static void round_corner(const asdic_scene *scene, asdic_vec3 world, float out[3]) {
    asdic_vec3 local = asdic_vec3_sub(world, scene->origin_m);
    out[0] = (float)local.x;
    out[1] = (float)local.y;
    out[2] = (float)local.z;
}

/* The normal comes from the corners before rounding: a facet of centimetres in a scene of
 * kilometres keeps its direction. */
static void make_triangle(const asdic_scene *scene, size_t index, dev_triangle *out) {
    asdic_vec3 a = scene_corner(scene, 3 * index), b = scene_corner(scene, 3 * index + 1);
    asdic_vec3 c = scene_corner(scene, 3 * index + 2);
    asdic_vec3 n = asdic_vec3_cross(asdic_vec3_sub(b, a), asdic_vec3_sub(c, a));
    double length = asdic_vec3_length(n);
    *out = (dev_triangle){.part = scene->corner_parts[index]};
    round_corner(scene, a, out->v0);
    round_corner(scene, b, out->v1);
    round_corner(scene, c, out->v2);
    /* A facet of a mesh has an area; far from the origin a tiny one may lose it in the placing. */
    n = length > 0.0 ? asdic_vec3_scale(n, 1.0 / length) : (asdic_vec3){0.0, 0.0, -1.0};
    out->normal[0] = (float)n.x;
    out->normal[1] = (float)n.y;
    out->normal[2] = (float)n.z;
}

asdic_status asdic_scene_commit(asdic_scene *scene) {
    if (scene->committed) {
        return asdic_fail(scene->ctx, ASDIC_ERROR_ARGUMENT, "the scene is committed already");
    }
    double start_s = now_s();
    asdic_status status = measure_parts(scene);
    if (status != ASDIC_OK) {
        return status;
    }
    free(scene->triangles);
    scene->triangles = malloc((scene->triangle_count + 1) * sizeof *scene->triangles);
    if (!scene->triangles) {
        return asdic_fail(scene->ctx, ASDIC_ERROR_MEMORY,
                          "out of memory for a scene of %zu triangles", scene->triangle_count);
    }
    for (size_t i = 0; i < scene->triangle_count; i++) {
        make_triangle(scene, i, &scene->triangles[i]);
    }
    status = asdic_scene_smooth(scene);
    if (status != ASDIC_OK) {
        return status;
    }
    status = asdic_bvh_build(scene->ctx, scene->triangles, scene->triangle_count, 0, &scene->bvh);
    if (status != ASDIC_OK) {
        return status;
    }
    free(scene->corners_m);
    free(scene->corner_parts);
    scene->corners_m = NULL;
    scene->corner_parts = NULL;
    scene->triangle_capacity = 0;
    scene->committed = true;
    scene->build_s = now_s() - start_s;
    return ASDIC_OK;
}

asdic_scene_info asdic_scene_get_info(const asdic_scene *scene) {
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
        .min_m = scene->min_m,
        .max_m = scene->max_m,
    };
    for (size_t p = 0; p < scene->part_count; p++) {
        info.objects += scene->parts[p].kind == DEV_KIND_OBJECT;
    }
    return info;
}
