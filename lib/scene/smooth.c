#include "smooth.h"

#include "base/try.h"

#include "crease.h"
#include "fold.h"
#include "moving.h"
#include "surface.h"

#include "laws/scatterer.h"

#include "../../kernels/smooth.h"
#include "../base/context.h"
#include "../base/vec.h"

#include <stdlib.h>

uint32_t asdic_smooth_pack(asdic_vec3 n) {
    double sum = fabs(n.x) + fabs(n.y) + fabs(n.z);
    double x = n.x / sum, y = n.y / sum;
    if (n.z < 0.0) { /* the lower half is folded outwards */
        double fold = x;
        x = (1.0 - fabs(y)) * (fold < 0.0 ? -1.0 : 1.0);
        y = (1.0 - fabs(fold)) * (y < 0.0 ? -1.0 : 1.0);
    }
    uint32_t low = (uint16_t)(int16_t)lround(x * OCTAHEDRON_STEPS);
    uint32_t high = (uint16_t)(int16_t)lround(y * OCTAHEDRON_STEPS);
    return low | high << 16;
}

/* Gives FACET its corners' NORMALS; a part that moves keeps them in its mesh's frame, in KEPT: BACK is how it is turned. */
static void smooth_facet(const asdic_surface *s, uint32_t facet, const asdic_vec3 normals[3],
                         const asdic_mat3 *back, asdic_vec3 *kept) {
    dev_triangle *t = &s->facets[facet];
    const asdic_patch *patch = &s->patches[s->patch[facet]];
    bool level = asdic_patch_is_level(patch);
    t->flat_m2 = (float)patch->area_m2;
    if (!level && !asdic_crease_is_bent(s, facet)) {
        return;
    }
    for (int k = 0; k < 3; k++) {
        asdic_vec3 own = asdic_vec3_scale(normals[k], s->side[facet]); /* to the facet's side */
        t->corner_normals[k] = asdic_smooth_pack(own);
        if (kept) {
            kept[k] = asdic_mat3_apply_inverse(*back, own);
        }
    }
    t->flat_m2 = (float)(level ? patch->area_m2 : patch->length2_m2);
}

/* PART as one that moves, with room for its normals; NULL where it stays. */
static asdic_status find_movable(asdic_scene *scene, size_t part, asdic_movable **out) {
    *out = NULL;
    for (size_t i = 0; i < scene->movable_count && !*out; i++) {
        *out = scene->movables[i].part == part ? &scene->movables[i] : NULL;
    }
    if (!*out) {
        return ASDIC_OK;
    }
    free((*out)->normals); /* of a commit that failed */
    (*out)->normals = calloc(3 * (*out)->count + 1, sizeof *(*out)->normals);
    return (*out)->normals ? ASDIC_OK : asdic_fail_memory(scene->ctx, "a moving object's normals");
}

/* Smooths the facets of PART, whose are the triangles of SURFACE. */
static asdic_status smooth_part(asdic_scene *scene, size_t part, asdic_surface *surface) {
    asdic_movable *moving;
    TRY(find_movable(scene, part, &moving));
    TRY(asdic_surface_find_patches(scene->ctx, 2.0 * scene->parts[part].radius_m, surface));
    TRY(asdic_surface_find_folds(scene->ctx, surface));
    asdic_vec3 *normals = malloc(3 * (size_t)surface->count * sizeof *normals);
    asdic_status status = normals ? asdic_corner_normals_find(scene->ctx, surface, normals)
                                  : asdic_fail_memory(scene->ctx, "the normals of an object");
    asdic_mat3 back = asdic_mat3_of(moving ? &moving->anchor : &(asdic_pose){0});
    for (size_t facet = 0; !status && facet < surface->count; facet++) {
        smooth_facet(surface, (uint32_t)facet, normals + 3 * facet, &back,
                     moving ? moving->normals + 3 * facet : NULL);
    }
    status = status ? status : asdic_surface_find_straight(scene->ctx, surface, normals);
    free(normals);
    return status;
}

/* Rims of an object, triangles BEGIN to END; what is CURVED is smoothed as well. */
static asdic_status finish_part(asdic_scene *scene, size_t begin, size_t end, bool curved) {
    asdic_surface surface;
    asdic_status status =
        asdic_surface_init(scene->ctx, scene->corners_m + 9 * begin, scene->triangles + begin,
                           (uint32_t)(end - begin), &surface);
    surface.crease_cosine = cos(scene->parts[scene->triangles[begin].part].crease_rad);
    if (!status && curved) {
        status = smooth_part(scene, scene->triangles[begin].part, &surface);
    }
    asdic_surface_finish(&surface);
    return status;
}

asdic_status asdic_scene_smooth(asdic_scene *scene) {
    for (size_t begin = scene->built, end; begin < scene->triangle_count; begin = end) {
        /* A part's triangles lie together, in the order in which they were added. */
        uint32_t number = scene->triangles[begin].part;
        for (end = begin; end < scene->triangle_count && scene->triangles[end].part == number;) {
            scene->triangles[end++].corner_normals[0] = DEV_FLAT;
        }
        const asdic_part *part = &scene->parts[number];
        bool curved = scene->materials[part->material].law->formula == DEV_LAW_FACET;
        if (!scene->is_silent && (curved || part->kind == DEV_KIND_OBJECT)) {
            TRY(finish_part(scene, begin, end, curved));
        }
    }
    return ASDIC_OK;
}
