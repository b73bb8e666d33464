/*
 * Where facets touch that share no edge: a vertex of some lies on an open edge of another, as where two strips of a
 * surface are cut apart differently.
 */
#ifndef ASDIC_SCENE_JOINT_H
#define ASDIC_SCENE_JOINT_H

#include "surface.h"

/* Lets every facet whose open edge passes a vertex touch it with the edge's two corners: those of the two facets that
 * it would be, if cut there. OPEN has COUNT corners at which open edges begin. TOLERANCE: how far from an edge, by its
 * length. */
asdic_status asdic_surface_join(asdic_context *ctx, asdic_surface *surface, const uint32_t *open,
                                size_t count, double tolerance);

#endif
