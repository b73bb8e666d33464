/*
 * The present positions of a scene's objects. Each simulator has its own, so that others can see
 * the same scene at another time.
 */
#ifndef ASDIC_SCENE_PLACEMENT_H
#define ASDIC_SCENE_PLACEMENT_H

#include "moving.h"

typedef struct asdic_placement {
    const asdic_scene *scene;
    asdic_vec3 origin_m; /* of the frame in which things are: the scene's, until it is centred */
    bool is_anchored;    /* something stays: the frame does, too */
    double step_m;       /* in which a frame follows the sonar */
    asdic_part *parts;   /* the scene's, spheres as they are now */
    asdic_point *points; /* the scene's, positions as they are now */
    asdic_pose *poses;   /* of what moves, a movable with all its copies */
    dev_node8 *nodes;    /* the first nodes of the scene: the top, and the moving objects */
    dev_block4 *blocks;
    dev_triangle *triangles; /* of what moves, in the scene's order of it */
    size_t *first;           /* by movable: in triangles */
    asdic_root *roots;       /* of the movables, then of the rest, empty where nothing stays */
    float extent_m;          /* largest coordinate by magnitude, as of asdic_bvh */
    double *scratch_m;
} asdic_placement;

/* As the scene was committed. */
asdic_status asdic_placement_create(const asdic_scene *scene, asdic_placement **out);
void asdic_placement_destroy(asdic_placement **placement);

/* The triangle with that index in the scene, where it is now. */
const dev_triangle *asdic_placement_triangle(const asdic_placement *placement, size_t index);

/* The origin of the frame in which a sonar at POSITION_M sees the scene: the scene's own where anything stays. What
 * moves can go anywhere, and single precision holds shapes near an origin alone: where nothing stays, it follows the
 * sonar in long steps north and east. */
asdic_vec3 asdic_placement_frame(const asdic_placement *placement, asdic_vec3 position_m);

/* Brings the frame's origin there; whether it was elsewhere, and all movables have changed. */
bool asdic_placement_center(asdic_placement *placement, asdic_vec3 position_m);

/* Moves a movable of the scene; of a lifted view, all its copies. */
void asdic_placement_move(asdic_placement *placement, size_t movable, const asdic_pose *pose);

#endif
