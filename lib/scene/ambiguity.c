#include "ambiguity.h"

#include "fold.h"

#include "laws/scatterer.h"

#include "../base/context.h"
#include "../base/try.h"
#include "../base/vec.h"

#include <stdlib.h>

/* What turns by less from face to face than 18 plates round a drum is taken for round, and nobody asks: by less than 20
 * degrees, but for the last bits of the corners. */
#define PLATES_RAD (19.99 * ASDIC_PI / 180.0)
/* Plates beside each other are as wide, to this ratio; the barrel of a bottle is no plate beside its shoulder. */
#define AS_WIDE 2.0
/* What bends on does so by this share at least. */
#define BENDS_ON (1.0 / 6.0)
/* ... and the same way: the cosine of the angle between turns at both sides of a patch. */
#define SAME_WAY (-0.5)

/* Faces of a ground may be alike by chance: those that are make so much of a body's area, or none does. */
#define LEAST_SHARE 0.01

/* Whether PATCH, which turns into OTHER, turns on at its other side, the same way. */
static bool bends_on(const asdic_surface *s, uint32_t patch, uint32_t other) {
    asdic_vec3 turn = asdic_fold_turn(s, patch, other);
    double sine = asdic_vec3_length(turn);
    for (uint32_t i = s->first_fold[patch]; i < s->first_fold[patch + 1]; i++) {
        asdic_vec3 far = asdic_fold_turn(s, patch, s->folds[i].patch);
        double there = asdic_vec3_length(far);
        if (there >= BENDS_ON * sine && asdic_vec3_dot(turn, far) <= SAME_WAY * sine * there) {
            return true;
        }
    }
    return false;
}

/* Whether what turns over the edge between both may be plates as well as an arc. */
static bool is_ambiguous(const asdic_surface *s, uint32_t patch, uint32_t other) {
    if (asdic_fold_parts(s, patch, other) || asdic_fold_parts(s, other, patch)) {
        return false;
    }
    asdic_vec3 turn = asdic_fold_turn(s, patch, other);
    double own_m = asdic_patch_reach(s, patch, turn), next_m = asdic_patch_reach(s, other, turn);
    return own_m <= AS_WIDE * next_m && next_m <= AS_WIDE * own_m &&
           (bends_on(s, patch, other) || bends_on(s, other, patch));
}

/* Adds the edge between two patches. */
static void add_edge(const asdic_surface *s, uint32_t patch, uint32_t other, asdic_ambiguity *out) {
    double turn_rad = asin(fmin(asdic_vec3_length(asdic_fold_turn(s, patch, other)), 1.0));
    double area_m2 = fmax(s->patches[patch].area_m2, s->patches[other].area_m2);
    if (!(turn_rad >= PLATES_RAD) || !is_ambiguous(s, patch, other)) {
        return;
    }
    out->edges++;
    out->faces_m2 += 0.5 * (s->patches[patch].area_m2 + s->patches[other].area_m2);
    out->most_rad = fmax(out->most_rad, turn_rad);
    if (area_m2 * turn_rad > out->area_m2 * out->turn_rad) {
        out->area_m2 = area_m2;
        out->turn_rad = turn_rad;
    }
}

/* What is round with the wide crease angle, of patches that the usual one makes. */
static asdic_status find(asdic_context *ctx, double size_m, asdic_surface *s,
                         asdic_ambiguity *out) {
    s->crease_cosine = cos(ASDIC_CREASE_RAD);
    TRY(asdic_surface_find_patches(ctx, size_m, s));
    s->crease_cosine = cos(ASDIC_ROUND_DEG * ASDIC_PI / 180.0);
    TRY(asdic_surface_find_folds(ctx, s));
    for (uint32_t patch = 0; patch < s->count; patch++) {
        for (uint32_t i = s->first_fold[patch]; i < s->first_fold[patch + 1]; i++) {
            if (s->folds[i].patch > patch) {
                add_edge(s, patch, s->folds[i].patch, out);
            }
        }
    }
    return ASDIC_OK;
}

bool asdic_scene_may_be_ambiguous(const asdic_scene *scene, const asdic_part *part) {
    return part->kind == DEV_KIND_OBJECT && !part->is_primitive &&
           part->crease_rad == ASDIC_CREASE_RAD &&
           scene->materials[part->material].law->formula == DEV_LAW_FACET;
}

asdic_status asdic_scene_find_ambiguity(const asdic_scene *scene, size_t begin, size_t end,
                                        asdic_ambiguity *out) {
    const asdic_part *part = &scene->parts[scene->triangles[begin].part];
    size_t count = end - begin;
    *out = (asdic_ambiguity){0};
    asdic_surface surface = {0};
    double *corners_m = malloc(9 * count * sizeof *corners_m);
    dev_triangle *facets = malloc(count * sizeof *facets); /* of its own: rims are marked in them */
    asdic_status status =
        corners_m && facets ? ASDIC_OK : asdic_fail_memory(scene->ctx, "the edges of an object");
    for (size_t i = 0; !status && i < count; i++) {
        facets[i] = scene->triangles[begin + i];
        for (size_t k = 0; k < 3; k++) {
            corners_m[9 * i + k] = facets[i].v0[k];
            corners_m[9 * i + 3 + k] = facets[i].v1[k];
            corners_m[9 * i + 6 + k] = facets[i].v2[k];
        }
    }
    status = status ? status
                    : asdic_surface_init(scene->ctx, corners_m, facets, (uint32_t)count, &surface);
    status = status ? status : find(scene->ctx, 2.0 * part->radius_m, &surface, out);
    if (status || out->faces_m2 < LEAST_SHARE * part->area_m2) {
        *out = (asdic_ambiguity){0};
    }
    asdic_surface_finish(&surface);
    free(corners_m);
    free(facets);
    return status;
}
