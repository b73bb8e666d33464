/*
 * How near a moving point comes to a scene: exact distances from a segment to triangles, on the host.
 * What moves meanwhile sees another segment: the point's way in its own frame.
 */
#ifndef ASDIC_SCENE_NEAREST_H
#define ASDIC_SCENE_NEAREST_H

#include "placement.h"

#define ASDIC_NOTHING ((size_t)-1)

typedef struct asdic_nearest {
    double distance_m;
    size_t part; /* of the scene; ASDIC_NOTHING: none, or the bottom's plane */
} asdic_nearest;

/* Straight, in the world as it is while things stand where the placement has them. */
typedef struct asdic_way {
    asdic_vec3 from_m, to_m;
} asdic_way;

/* From WAY to the nearest triangle, point or bottom plane, where that is below WITHIN_M; else
 * WITHIN_M. The sea surface does not count. MOVING: the way as each movable of the scene sees it,
 * then as each of its points does; NULL: as WAY. */
asdic_nearest asdic_placement_nearest(const asdic_placement *placement, const asdic_way *way,
                                      const asdic_way *moving, double within_m);

/* From where LOOK begins to the nearest of what PART, as of asdic_nearest, has within SECTOR_RAD of its
 * direction and nearer than WITHIN_M; INFINITY: nothing. MOVING as above. */
double asdic_placement_ahead(const asdic_placement *placement, size_t part, const asdic_way *look,
                             const asdic_way *moving, double sector_rad, double within_m);

/* Whether POSITION_M (world) is inside an object: a plumb line meets its triangles an odd number of
 * times below, and above. PART becomes the object's. Over and under a plate, or a mesh that is open to
 * one of these sides, is outside. */
bool asdic_placement_is_inside(const asdic_placement *placement, asdic_vec3 position_m,
                               size_t *part);

#endif
