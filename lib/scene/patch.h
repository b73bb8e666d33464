/*
 * Flat patches: how much of a part reflects in phase.
 */
#ifndef ASDIC_SCENE_PATCH_H
#define ASDIC_SCENE_PATCH_H

#include "scene.h"

/* Fills AREAS_M2[part] with the area of the largest set of coplanar facets of every part of a
 * committed scene that follows the facet law, 0 for others. Facets in one plane count as one patch
 * whether or not they touch. */
asdic_status asdic_scene_patch_areas(const asdic_scene *scene, double *areas_m2);

#endif
