/*
 * Where a scene's objects are now: what a simulator has of its own, so that others may see the
 * same scene at another time.
 */
#ifndef ASDIC_SCENE_PLACEMENT_H
#define ASDIC_SCENE_PLACEMENT_H

#include "moving.h"

typedef struct asdic_placement {
    const asdic_scene *scene;
    asdic_part *parts;   /* the scene's, spheres as they are now */
    asdic_point *points; /* the scene's, positions as they are now */
    dev_node8 *nodes;    /* the scene's first ones: of the top, of what moves */
    dev_block4 *blocks;
    dev_triangle *triangles; /* of what moves, in the scene's order of it */
    size_t *first;           /* by movable: in triangles */
    asdic_root *roots;       /* by movable, then what stays; the last is empty where nothing does */
    float extent_m;          /* largest coordinate by magnitude, as of asdic_bvh */
    double *scratch_m;
} asdic_placement;

/* As the scene was committed. */
asdic_status asdic_placement_create(const asdic_scene *scene, asdic_placement **out);
void asdic_placement_destroy(asdic_placement **placement);

/* The triangle with that index in the scene, where it is now. */
const dev_triangle *asdic_placement_triangle(const asdic_placement *placement, size_t index);

/* Moves a movable of the scene. */
void asdic_placement_move(asdic_placement *placement, size_t movable, const asdic_pose *pose);

#endif
