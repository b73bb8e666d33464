/*
 * How near a moving point comes to a scene: exact distances from a segment to triangles, on the host.
 */
#ifndef ASDIC_SCENE_NEAREST_H
#define ASDIC_SCENE_NEAREST_H

#include "placement.h"

#define ASDIC_NOTHING ((size_t)-1)

typedef struct asdic_nearest {
    double distance_m;
    size_t part; /* of the scene; ASDIC_NOTHING: none, or the bottom's plane */
} asdic_nearest;

/* From the straight way FROM_M to TO_M (world) to the nearest triangle, point or bottom plane, where
 * that is below WITHIN_M; else WITHIN_M. The sea surface does not count. */
asdic_nearest asdic_placement_nearest(const asdic_placement *placement, asdic_vec3 from_m,
                                      asdic_vec3 to_m, double within_m);

/* Whether POSITION_M (world) is inside an object: a plumb line down meets its triangles an odd
 * number of times. PART becomes the object's. Objects are closed, as all but plates and torn meshes. */
bool asdic_placement_is_inside(const asdic_placement *placement, asdic_vec3 position_m,
                               size_t *part);

#endif
