/*
 * The flat patches that the facets of a surface form.
 */
#ifndef ASDIC_SCENE_PATCH_H
#define ASDIC_SCENE_PATCH_H

#include "surface.h"

/* Touching facets in one plane, or so nearly that rounded coordinates tell the difference. */
struct asdic_patch {
    double area_m2;
    double length2_m2;  /* square of its length: of a rectangle's longer side */
    double breadth2_m2; /* of the shorter one */
    asdic_vec3 along;   /* unit, along its length */
    asdic_vec3 normal;  /* of what is nearly in a plane; 0: each facet's own */
    bool ends;          /* keeps its own normals at an edge to another, below the crease angle */
};

/* The patches, of a part whose extent is SIZE_M. */
asdic_status asdic_surface_find_patches(asdic_context *ctx, double size_m, asdic_surface *surface);

/* Whether it is of facets that are nearly in a plane, and has one normal. */
static inline bool asdic_patch_is_level(const asdic_patch *patch) {
    return patch->normal.x != 0.0 || patch->normal.y != 0.0 || patch->normal.z != 0.0;
}

/* How far it reaches along WAY, in its plane, times the length of WAY. */
double asdic_patch_width(const asdic_patch *patch, asdic_vec3 way);

#endif
