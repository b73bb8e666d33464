/*
 * Where a curved surface is straight one way, as a pipe is along its axis.
 */
#ifndef ASDIC_SCENE_STRAIGHT_H
#define ASDIC_SCENE_STRAIGHT_H

#include "surface.h"

/* Fills radii and in-phase areas of the facets of a part that stand for a curved surface, from the NORMALS of all
 * corners, three a facet. */
asdic_status asdic_surface_find_straight(asdic_context *ctx, asdic_surface *surface,
                                         const asdic_vec3 *normals);

#endif
