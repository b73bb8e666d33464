/*
 * Where patches meet below the crease angle, and whether what turns there goes on turning beyond.
 */
#ifndef ASDIC_SCENE_FOLD_H
#define ASDIC_SCENE_FOLD_H

#include "patch.h"

/* One patch beside another. */
struct asdic_fold {
    uint32_t patch;
    uint32_t shared; /* vertices; one alone is no edge */
    float at_m[3];   /* their mean, from the patch' first corner */
    float rate;      /* turn by length across the edge, rad/m */
    float beyond;    /* the least at the far side, where it turns on; INFINITY: it does not */
    bool ends;       /* the patch keeps its own normal along the edge */
    bool straight;   /* it does as a wall: what rounds the edge begins along it */
};

/* All folds beside a patch of more than one facet: a facet by itself is of a surface that is triangulated at will. */
asdic_status asdic_surface_find_folds(asdic_context *ctx, asdic_surface *surface);

/* How PATCH turns into OTHER: in its plane, as long as the sine. */
asdic_vec3 asdic_fold_turn(const asdic_surface *surface, uint32_t patch, uint32_t other);

/* Whether PATCH is a wall beside OTHER, which rounds its edge. */
bool asdic_fold_is_straight(const asdic_surface *surface, uint32_t patch, uint32_t other);

/* Whether the surface ends for PATCH at an edge to OTHER, or both have a vertex alone in common. */
bool asdic_fold_parts(const asdic_surface *surface, uint32_t patch, uint32_t other);

#endif
