/*
 * Objects that move. Each has a subtree of its own, and a few nodes on top join those with the tree
 * of all that stays. A new pose moves the object's triangles and fits its subtree's boxes round
 * them anew, so that its cost does not depend on the rest of the scene. A hit is a function of ray
 * and triangle alone (kernels/intersect.h): the shape of the tree never shows.
 *
 * Nodes and blocks of what moves come first in the scene's arrays: top nodes, then the movables'.
 */
#ifndef ASDIC_SCENE_MOVING_H
#define ASDIC_SCENE_MOVING_H

#include "scene.h"

/* Part of a committed scene that moves. */
struct asdic_movable {
    size_t part;
    size_t first, count; /* its triangles */
    double *corners_m;   /* 9 per triangle, mesh frame */
    asdic_vec3 *normals; /* 3 per triangle, mesh frame: at curved facets' corners; NULL: none */
    asdic_pose pose;     /* as added */
    asdic_pose anchor;   /* as added, or set before commit: where origin and normals are found */
    uint32_t root;       /* child word of its subtree */
    size_t first_node, node_count, first_block, block_count;
};

/* A subtree as the top sees it. */
typedef struct asdic_root {
    float lo[3], hi[3];
    uint32_t word;
} asdic_root;

/* Builds the hierarchy of a scene from its triangles; moving objects have subtrees of their own. */
asdic_status asdic_scene_assemble(asdic_scene *scene);

/* The end of the nodes and blocks that lie under WORD. */
asdic_root asdic_root_of(const dev_node8 *nodes, const dev_block4 *blocks, uint32_t word);

/* Joins COUNT roots, which it sorts, under the first of NODES; returns how many nodes it took, at
 * most COUNT, and in *DEPTH the levels of them, both of which depend on COUNT alone. */
size_t asdic_top_build(dev_node8 *nodes, asdic_root *roots, size_t count, unsigned *depth);

/* Fits the movable's blocks and nodes, its root first, round TRIANGLES (indexed by triangle id less
 * FIRST), lifted by BEND_PER_M (lifted.h) and then SHIFT_M lower. */
void asdic_movable_refit(const asdic_movable *m, const dev_triangle *triangles, double bend_per_m,
                         double shift_m, dev_node8 *nodes, dev_block4 *blocks);

/* Triangles of the movable at POSE; only positions and normals change. WORLD_M, 9 per triangle,
 * receives the corners. */
void asdic_movable_place(const asdic_movable *m, const asdic_pose *pose, asdic_vec3 origin_m,
                         double *world_m, dev_triangle *triangles);

#endif
