#include "placement.h"

#include "lifted.h"
#include "place.h"

#include "../base/context.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* A copy of COUNT things of BYTES each; not NULL when COUNT is 0. */
static void *copy(const void *from, size_t count, size_t bytes) {
    void *to = calloc(count + 1, bytes);
    if (to && count > 0) {
        memcpy(to, from, count * bytes);
    }
    return to;
}

static float largest_coordinate(const asdic_root *roots, size_t count) {
    float extent = 0.0f;
    for (size_t i = 0; i < count; i++) {
        for (int k = 0; k < 3; k++) {
            extent = fmaxf(extent, fmaxf(fabsf(roots[i].lo[k]), fabsf(roots[i].hi[k])));
        }
    }
    return extent;
}

/* Heights that COUNT triangles are between, in the scene frame. */
static void find_heights(const dev_triangle *triangles, size_t count, float *low, float *high) {
    *low = INFINITY;
    *high = -INFINITY;
    for (size_t i = 0; i < count; i++) {
        const dev_triangle *t = &triangles[i];
        *low = fminf(*low, fminf(fminf(t->v0[2], t->v1[2]), t->v2[2]));
        *high = fmaxf(*high, fmaxf(fmaxf(t->v0[2], t->v1[2]), t->v2[2]));
    }
}

/* Lifts copy NTH, as the bend of its layer asks for, and finds its root. Copies of an object are in the layers that it
 * reaches, from the top down; one that is left over is nowhere. */
static void lift_copy(asdic_placement *p, size_t nth) {
    const asdic_scene *scene = p->scene;
    const asdic_movable *m = &scene->movables[nth];
    const dev_triangle *triangles = p->triangles + p->first[nth];
    double bend = scene->bend_per_m, shift = 0.0;
    p->roots[nth] = (asdic_root){.word = DEV_EMPTY};
    if (scene->layers) {
        const dev_layer *layers = scene->layers;
        float low, high;
        find_heights(triangles, m->count, &low, &high);
        size_t at = 0, last = scene->layer_count - 1;
        while (at < last && layers[at].bottom_m + (float)ASDIC_LAYER_OVERLAP_M < low) {
            at++;
        }
        at += nth % scene->copies;
        bool used = at <= last && (nth % scene->copies == 0 ||
                                   layers[at].top_m - (float)ASDIC_LAYER_OVERLAP_M <= high);
        if (!used) {
            return;
        }
        bend = layers[at].bend_per_m;
        shift = layers[at].shift_m;
    }
    asdic_movable_refit(m, triangles, bend, shift, p->nodes, p->blocks);
    p->roots[nth] = asdic_root_of(p->nodes, p->blocks, m->root);
}

/* The top over all roots. */
static void join_roots(asdic_placement *p) {
    size_t all = p->scene->movable_count + 1, count = 0;
    asdic_root *sorted = p->roots + all;
    unsigned depth;
    for (size_t i = 0; i < all; i++) {
        if (p->roots[i].word != DEV_EMPTY) {
            sorted[count++] = p->roots[i];
        }
    }
    asdic_top_build(p->nodes, sorted, count, &depth);
    p->extent_m = largest_coordinate(sorted, count);
}

static void copy_triangles(asdic_placement *p) {
    const asdic_scene *scene = p->scene;
    size_t at = 0;
    for (size_t i = 0; i < scene->movable_count; i++) {
        const asdic_movable *m = &scene->movables[i];
        if (i % asdic_scene_copies(scene) > 0) {
            p->first[i] = p->first[i - 1];
            continue;
        }
        p->first[i] = at;
        p->poses[i / asdic_scene_copies(scene)] = m->pose;
        memcpy(p->triangles + at, scene->triangles + m->first, m->count * sizeof *p->triangles);
        at += m->count;
    }
}

/* Steps of an origin that follows the sonar, m: half a millimetre is lost at half of one. What lies so far out is
 * lifted high; layers are not to be that far apart. */
#define FRAME_STEP_M 8192.0

/* Whether any triangle of SCENE does not move. */
static bool anything_stays(const asdic_scene *scene) {
    size_t moving = 0;
    for (size_t i = 0; i < scene->movable_count; i += asdic_scene_copies(scene)) {
        moving += scene->movables[i].count;
    }
    return moving < scene->triangle_count;
}

asdic_status asdic_placement_create(const asdic_scene *scene, asdic_placement **out) {
    size_t triangles = 0, most = 0;
    for (size_t i = 0; i < scene->movable_count; i++) {
        triangles += scene->movables[i].count;
        most = scene->movables[i].count > most ? scene->movables[i].count : most;
    }
    asdic_placement *p = *out = calloc(1, sizeof *p);
    if (!p) {
        return asdic_fail_memory(scene->ctx, "the poses of objects");
    }
    p->scene = scene;
    p->origin_m = scene->origin_m;
    p->is_anchored = anything_stays(scene);
    p->step_m = scene->layers ? ASDIC_LAYERED_STEP_M : FRAME_STEP_M;
    p->extent_m = scene->bvh.extent_m;
    p->parts = copy(scene->parts, scene->part_count, sizeof *p->parts);
    p->points = copy(scene->points, scene->point_count, sizeof *p->points);
    p->poses = calloc(scene->movable_count + 1, sizeof *p->poses);
    p->nodes = copy(scene->bvh.nodes, scene->moving_nodes, sizeof *p->nodes);
    p->blocks = copy(scene->bvh.blocks, scene->moving_blocks, sizeof *p->blocks);
    p->triangles = calloc(triangles + 1, sizeof *p->triangles);
    p->first = calloc(scene->movable_count + 1, sizeof *p->first);
    p->roots = calloc(2 * (scene->movable_count + 1), sizeof *p->roots);
    p->scratch_m = calloc(9 * most + 1, sizeof *p->scratch_m);
    if (!p->parts || !p->points || !p->poses || !p->nodes || !p->blocks || !p->triangles ||
        !p->first || !p->roots || !p->scratch_m) {
        asdic_placement_destroy(out);
        return asdic_fail_memory(scene->ctx, "the poses of objects");
    }
    copy_triangles(p);
    for (size_t i = 0; i < scene->movable_count; i++) {
        p->roots[i] = asdic_root_of(p->nodes, p->blocks, scene->movables[i].root);
        if (scene->layers) {
            lift_copy(p, i);
        }
    }
    p->roots[scene->movable_count] =
        scene->movable_count > 0
            ? asdic_root_of(scene->bvh.nodes, scene->bvh.blocks, scene->still_root)
            : (asdic_root){.word = DEV_EMPTY};
    if (scene->layers && scene->movable_count > 0) {
        join_roots(p);
    }
    return ASDIC_OK;
}

void asdic_placement_destroy(asdic_placement **placement) {
    if (!placement || !*placement) {
        return;
    }
    asdic_placement *p = *placement;
    free(p->parts);
    free(p->points);
    free(p->poses);
    free(p->nodes);
    free(p->blocks);
    free(p->triangles);
    free(p->first);
    free(p->roots);
    free(p->scratch_m);
    free(p);
    *placement = NULL;
}

const dev_triangle *asdic_placement_triangle(const asdic_placement *p, size_t index) {
    const asdic_scene *scene = p->scene;
    const dev_triangle *t = &scene->triangles[index];
    if (!scene->parts[t->part].moves) {
        return t;
    }
    size_t low = 0,
           high = scene->movable_count - 1; /* the movable that has it: they follow another */
    while (low < high) {
        size_t middle = (low + high + 1) / 2;
        if (scene->movables[middle].first <= index) {
            low = middle;
        } else {
            high = middle - 1;
        }
    }
    return p->triangles + p->first[low] + (index - scene->movables[low].first);
}

void asdic_placement_move(asdic_placement *p, size_t movable, const asdic_pose *pose) {
    const asdic_scene *scene = p->scene;
    size_t copies = asdic_scene_copies(scene);
    const asdic_movable *m = &scene->movables[movable * copies];
    dev_triangle *triangles = p->triangles + p->first[movable * copies];
    asdic_vec3 lo, hi;
    p->poses[movable] = *pose;
    asdic_movable_place(m, pose, p->origin_m, p->scratch_m, triangles);
    asdic_place_sphere(p->scratch_m, m->count, &p->parts[m->part], &lo, &hi);
    for (size_t i = movable * copies; i < (movable + 1) * copies; i++) {
        lift_copy(p, i);
    }
    join_roots(p);
}

asdic_vec3 asdic_placement_frame(const asdic_placement *p, asdic_vec3 position_m) {
    asdic_vec3 at = p->scene->origin_m;
    if (!p->is_anchored) {
        at.x += p->step_m * rint((position_m.x - at.x) / p->step_m);
        at.y += p->step_m * rint((position_m.y - at.y) / p->step_m);
    }
    return at;
}

bool asdic_placement_center(asdic_placement *p, asdic_vec3 position_m) {
    asdic_vec3 at = asdic_placement_frame(p, position_m);
    if (at.x == p->origin_m.x && at.y == p->origin_m.y) {
        return false;
    }
    p->origin_m = at;
    for (size_t i = 0; i < p->scene->movable_count / asdic_scene_copies(p->scene); i++) {
        asdic_placement_move(p, i, &p->poses[i]);
    }
    return true;
}
