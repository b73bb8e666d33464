/*
 * Curved surfaces behind flat facets: what kernels/smooth.h needs of every facet.
 */
#ifndef ASDIC_SCENE_SMOOTH_H
#define ASDIC_SCENE_SMOOTH_H

#include "scene.h"

/* Fills corner normals, flat areas and radii of the triangles of every part that follows the facet
 * law; the others stay flat. Needs the parts' bounding spheres and the pending corners. */
asdic_status asdic_scene_smooth(asdic_scene *scene);

/* Unit vector N in 32 bits; smooth_unpack reads it. */
uint32_t asdic_smooth_pack(asdic_vec3 n);

#endif
