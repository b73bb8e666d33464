/*
 * The steps of building a hierarchy: a binary tree by surface-area heuristic, the plan of its
 * collapse from the leaves up, then eight-wide nodes and blocks of four triangles.
 */
#ifndef ASDIC_SCENE_BVH_H
#define ASDIC_SCENE_BVH_H

#include "scene.h"

#include "../base/float4.h"

/* One triangle while building: its box and its id. */
typedef struct asdic_bvh_item {
    float lo[3];
    uint32_t id;
    float hi[3];
    uint32_t zero;
} asdic_bvh_item;

/* Inner node: count 0, children at `link` and `link` + 1. Leaf: count items from `link`. */
typedef struct asdic_bvh_node2 {
    float lo[3];
    uint32_t link;
    float hi[3];
    uint32_t count;
} asdic_bvh_node2;

/* Entry i - 1: the least sum of areas of wide nodes that hold a binary node's subtree under at most
 * i roots; zeros for a leaf. The first is negative while it is not known. */
typedef float asdic_bvh_forest[DEV_BVH_WIDTH - 1];

typedef struct asdic_bvh_tree {
    asdic_bvh_node2 *nodes; /* the root first; not every entry is used */
    asdic_bvh_forest *best; /* by node */
    size_t leaves;
} asdic_bvh_tree;

/* Below this depth the heuristic gives way to halving, which ends within 32 more levels. */
#define ASDIC_BVH_HEURISTIC_DEPTH 40
#define ASDIC_BVH_MOST_DEPTH (ASDIC_BVH_HEURISTIC_DEPTH + 40)

/* A box; the fourth lanes are idle. */
typedef struct asdic_bvh_box {
    float4 lo, hi;
} asdic_bvh_box;

/* One subtree to build: items [first, first + count), its box and the box of twice its
 * centroids. */
typedef struct asdic_bvh_task {
    size_t first, count, node;
    unsigned depth;
    asdic_bvh_box box, centroids;
} asdic_bvh_task;

/* The box of a triangle, as the kernels compute it (BOX_LO and BOX_HI of intersect.h). */
void asdic_triangle_box(const float *const corner[3], float lo[3], float hi[3]);

/* The boxes of a task's items. */
void asdic_bvh_measure(const asdic_bvh_item *items, asdic_bvh_task *task);

/* Sorts the items of T, which are more than a leaf holds, into two halves of the work. The caller
 * makes their nodes. */
void asdic_bvh_split(asdic_bvh_item *items, const asdic_bvh_task *t, asdic_bvh_task *left,
                     asdic_bvh_task *right);

/* Builds the tree over ITEMS, which it sorts into leaf order, with THREADS threads; the shape of
 * the tree does not depend on THREADS. Finish it even when this fails. */
asdic_status asdic_bvh_grow(asdic_context *ctx, asdic_bvh_item *items, size_t count,
                            unsigned threads, asdic_bvh_tree *tree);
void asdic_bvh_tree_finish(asdic_bvh_tree *tree);

/* Fills the forest of an inner node from those of its children. */
void asdic_bvh_plan(const asdic_bvh_node2 *nodes, asdic_bvh_forest *best, size_t node);

/* Triangles, or leaves, that a thread takes at once where they are filled (base/share.h). */
#define ASDIC_BVH_SHARE 8192

/* Turns the binary tree into OUT's nodes and blocks, which it allocates. */
asdic_status asdic_bvh_pack(asdic_context *ctx, const asdic_bvh_tree *tree,
                            const asdic_bvh_item *items, const dev_triangle *triangles,
                            unsigned threads, asdic_bvh *out);

/* Makes child I of NODE the box LO to HI with WORD below it; LO NULL: no child. */
void asdic_node8_set_child(dev_node8 *node, int i, const float *lo, const float *hi, uint32_t word);

#endif
