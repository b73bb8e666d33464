/*
 * Normals, at the facets' corners, of the curved surface that they stand for.
 */
#ifndef ASDIC_SCENE_CORNER_NORMALS_H
#define ASDIC_SCENE_CORNER_NORMALS_H

#include "surface.h"

/* Fills NORMALS, three a facet, of a surface whose patches are found. */
asdic_status asdic_corner_normals_find(asdic_context *ctx, asdic_surface *surface,
                                       asdic_vec3 *normals);

#endif
