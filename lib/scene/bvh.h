/*
 * The two steps of building a hierarchy: a binary tree by surface-area heuristic, then its
 * collapse into eight-wide nodes and blocks of four triangles.
 */
#ifndef ASDIC_SCENE_BVH_H
#define ASDIC_SCENE_BVH_H

#include "scene.h"

/* One triangle while building: its box and its id. */
typedef struct asdic_bvh_item {
    float lo[3];
    uint32_t id;
    float hi[3];
    uint32_t zero;
} asdic_bvh_item;

/* Inner node: count 0, left child at its own index + 1, right child at `link`. Leaf: count items
 * from `link`. */
typedef struct asdic_bvh_node2 {
    float lo[3];
    uint32_t link;
    float hi[3];
    uint32_t count;
} asdic_bvh_node2;

/* Below this depth the heuristic gives way to halving, which ends within 32 more levels. */
#define ASDIC_BVH_HEURISTIC_DEPTH 40

/* Fills NODES (2 * count - 1 zeroed entries, the root first; those in between that no node needs
 * stay zero, children come after their parents)
 * and sorts ITEMS into leaf order, with THREADS threads; the result does not depend on THREADS. */
asdic_status asdic_bvh_split(asdic_context *ctx, asdic_bvh_item *items, size_t count,
                             unsigned threads, asdic_bvh_node2 *nodes);

/* Turns the binary tree into OUT's nodes and blocks, which it allocates. */
asdic_status asdic_bvh_pack(asdic_context *ctx, const asdic_bvh_node2 *nodes,
                            const asdic_bvh_item *items, const dev_triangle *triangles,
                            size_t count, asdic_bvh *out);

/* Makes child I of NODE the box LO to HI with WORD below it; LO NULL: no child. */
void asdic_node8_set_child(dev_node8 *node, int i, const float *lo, const float *hi, uint32_t word);

#endif
