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
    uint32_t facet;     /* its first */
    bool ends;          /* keeps its own normals at an edge to another, below the crease angle */
};

/* The patches, of a part whose extent is SIZE_M. */
asdic_status asdic_surface_find_patches(asdic_context *ctx, double size_m, asdic_surface *surface);

/* Whether it is of facets that are nearly in a plane, and has one normal. */
static inline bool asdic_patch_is_level(const asdic_patch *patch) {
    return patch->normal.x != 0.0 || patch->normal.y != 0.0 || patch->normal.z != 0.0;
}

/* Its normal, or its first facet's. */
static inline asdic_vec3 asdic_patch_normal(const asdic_surface *surface, uint32_t patch) {
    const asdic_patch *p = &surface->patches[patch];
    return asdic_patch_is_level(p) ? p->normal : asdic_surface_normal(surface, p->facet);
}

/* How far it reaches along WAY, in its plane, times the length of WAY. */
double asdic_patch_width(const asdic_patch *patch, asdic_vec3 way);

/* How far PATCH reaches along WAY, of which what is in its plane counts. */
double asdic_patch_reach(const asdic_surface *surface, uint32_t patch, asdic_vec3 way);

#endif
