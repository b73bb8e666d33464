/*
 * Points by place: those near a segment are found without a look at most others.
 */
#ifndef ASDIC_SCENE_POINT_TREE_H
#define ASDIC_SCENE_POINT_TREE_H

#include <asdic/common.h>

#include <stddef.h>
#include <stdint.h>

typedef struct asdic_point_place {
    asdic_vec3 at_m;
    uint32_t id;
} asdic_point_place;

/* Puts COUNT points in the order of a tree. */
void asdic_point_tree_plant(asdic_point_place *points, size_t count);

typedef struct asdic_point_search {
    asdic_vec3 from_m, way_m; /* the segment: where it begins, and from there to its end */
    double reach_m;
    void (*meet)(void *caller, const asdic_point_place *point);
    void *caller;
} asdic_point_search;

/* Meets each point of a tree that lies within reach of the segment, and some more. */
void asdic_point_tree_search(const asdic_point_place *points, size_t count,
                             const asdic_point_search *search);

#endif
