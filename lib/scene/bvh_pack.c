/*
 * Collapse of the binary tree into eight-wide nodes with the least sum of surface areas, by dynamic
 * programming from the leaves up (H. Ylitie, T. Karras, S. Laine, "Efficient Incoherent Ray
 * Traversal on GPUs Through Compressed Wide BVHs", HPG 2017, section 3.1; leaves are fixed here).
 */
#include "bvh.h"

#include "../base/context.h"
#include "../base/share.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Finite, so that (plane - origin) * inverse is never infinity * 0. */
#define FAR_PLANE 3e38f

typedef struct pack_task {
    uint32_t node2, node8; /* inner binary node, and where its eight-wide form goes */
    unsigned depth;
} pack_task;

typedef struct packer {
    const asdic_bvh_node2 *nodes;
    const asdic_bvh_forest *best;
    const asdic_bvh_item *items;
    const dev_triangle *triangles;
    asdic_bvh *out;
    uint32_t *leaves; /* binary node by block */
    pack_task stack[DEV_BVH_WIDTH * ASDIC_BVH_MOST_DEPTH];
    size_t top;
} packer;

static float half_area(const asdic_bvh_node2 *n) {
    float x = n->hi[0] - n->lo[0], y = n->hi[1] - n->lo[1], z = n->hi[2] - n->lo[2];
    return x * y + y * z + z * x;
}

static float least_sum(const asdic_bvh_forest *best, uint32_t left, uint32_t right, int roots,
                       int *share) {
    float least = INFINITY;
    for (int k = 1; k < roots; k++) {
        float sum = best[left][k - 1] + best[right][roots - k - 1];
        if (sum < least) {
            least = sum;
            *share = k;
        }
    }
    return least;
}

void asdic_bvh_plan(const asdic_bvh_node2 *nodes, asdic_bvh_forest *best, size_t node) {
    int share = 0;
    uint32_t left = nodes[node].link, right = left + 1;
    const asdic_bvh_forest *known = (const asdic_bvh_forest *)best;
    float one = half_area(&nodes[node]) + least_sum(known, left, right, DEV_BVH_WIDTH, &share);
    best[node][0] = one;
    for (int roots = 2; roots < DEV_BVH_WIDTH; roots++) {
        float several = least_sum(known, left, right, roots, &share);
        best[node][roots - 1] = several < one ? several : one;
    }
}

/* Adds the roots under which the plan holds NODE2, at most ROOTS of them, to CHILD. */
static void gather_roots(const packer *p, uint32_t node2, int roots, uint32_t *child, int *count) {
    const asdic_bvh_node2 *node = &p->nodes[node2];
    int share = 0;
    if (node->count == 0 && roots > 1 &&
        least_sum(p->best, node->link, node->link + 1, roots, &share) < p->best[node2][0]) {
        gather_roots(p, node->link, share, child, count);
        gather_roots(p, node->link + 1, roots - share, child, count);
    } else {
        child[(*count)++] = node2;
    }
}

/* The up to eight binary nodes that become children of NODE2; returns how many. */
static int gather_children(const packer *p, uint32_t node2, uint32_t child[DEV_BVH_WIDTH]) {
    uint32_t left = p->nodes[node2].link, right = left + 1;
    int count = 0, share = 1;
    least_sum(p->best, left, right, DEV_BVH_WIDTH, &share);
    gather_roots(p, left, share, child, &count);
    gather_roots(p, right, DEV_BVH_WIDTH - share, child, &count);
    return count;
}

/* Leaves its filling to fill_blocks. */
static uint32_t pack_block(packer *p, uint32_t leaf) {
    uint32_t index = (uint32_t)p->out->block_count++;
    p->leaves[index] = leaf;
    return DEV_LEAF | index;
}

static void fill_blocks(void *user, unsigned worker, size_t first, size_t end) {
    (void)worker;
    const packer *p = user;
    for (size_t i = first; i < end; i++) {
        const asdic_bvh_node2 *leaf = &p->nodes[p->leaves[i]];
        dev_block4 *block = &p->out->blocks[i];
        for (uint32_t lane = 0; lane < DEV_LEAF_TRIANGLES; lane++) {
            bool used = lane < leaf->count;
            uint32_t id = p->items[leaf->link + (used ? lane : 0)].id;
            const dev_triangle *t = &p->triangles[id];
            block->id[lane] = used ? id : ~0u;
            for (int k = 0; k < 3; k++) { /* three equal corners are never hit */
                block->v[k][lane] = used ? t->v0[k] : 0.0f;
                block->v[3 + k][lane] = used ? t->v1[k] : 0.0f;
                block->v[6 + k][lane] = used ? t->v2[k] : 0.0f;
            }
        }
    }
}

void asdic_node8_set_child(dev_node8 *node, int i, const float *lo, const float *hi,
                           uint32_t word) {
    static const float first[3] = {FAR_PLANE, FAR_PLANE, FAR_PLANE};
    static const float last[3] = {-FAR_PLANE, -FAR_PLANE, -FAR_PLANE};
    hi = lo ? hi : last;
    lo = lo ? lo : first;
    node->lo_x[i] = lo[0];
    node->lo_y[i] = lo[1];
    node->lo_z[i] = lo[2];
    node->hi_x[i] = hi[0];
    node->hi_y[i] = hi[1];
    node->hi_z[i] = hi[2];
    node->child[i] = lo == first ? DEV_EMPTY : word;
}

static void pack_node(packer *p, pack_task task) {
    uint32_t child[DEV_BVH_WIDTH];
    int count = gather_children(p, task.node2, child);
    dev_node8 *node = &p->out->nodes[task.node8];
    memset(node->pad, 0, sizeof node->pad);
    if (task.depth > p->out->depth) {
        p->out->depth = task.depth;
    }
    for (int i = 0; i < DEV_BVH_WIDTH; i++) {
        if (i >= count) {
            asdic_node8_set_child(node, i, NULL, NULL, DEV_EMPTY);
            continue;
        }
        const asdic_bvh_node2 *n = &p->nodes[child[i]];
        if (n->count > 0) {
            asdic_node8_set_child(node, i, n->lo, n->hi, pack_block(p, child[i]));
        } else {
            uint32_t index = (uint32_t)p->out->node_count++;
            asdic_node8_set_child(node, i, n->lo, n->hi, index);
            p->stack[p->top++] = (pack_task){child[i], index, task.depth + 1};
        }
    }
}

static void pack_nodes(packer *p) {
    asdic_bvh *out = p->out;
    if (p->nodes[0].count > 0) {
        out->root = pack_block(p, 0);
        return;
    }
    out->root = 0;
    out->node_count = 1;
    p->stack[p->top++] = (pack_task){0, 0, 1};
    while (p->top > 0) {
        pack_node(p, p->stack[--p->top]);
    }
    dev_node8 *trimmed = realloc(out->nodes, out->node_count * sizeof *out->nodes);
    out->nodes = trimmed ? trimmed : out->nodes;
}

asdic_status asdic_bvh_pack(asdic_context *ctx, const asdic_bvh_tree *tree,
                            const asdic_bvh_item *items, const dev_triangle *triangles,
                            unsigned threads, asdic_bvh *out) {
    packer p = {.nodes = tree->nodes,
                .best = (const asdic_bvh_forest *)tree->best,
                .items = items,
                .triangles = triangles,
                .out = out};
    *out = (asdic_bvh){.root = DEV_EMPTY};
    out->blocks = malloc(tree->leaves * sizeof *out->blocks);
    /* Every eight-wide node takes at least one binary node with it. */
    out->nodes = malloc(tree->leaves * sizeof *out->nodes);
    p.leaves = malloc(tree->leaves * sizeof *p.leaves);
    if (!out->blocks || !out->nodes || !p.leaves) {
        free(p.leaves);
        asdic_bvh_finish(out);
        return asdic_fail(ctx, ASDIC_ERROR_MEMORY,
                          "out of memory while packing a hierarchy of %zu leaves", tree->leaves);
    }
    pack_nodes(&p);
    asdic_share(threads, out->block_count, ASDIC_BVH_SHARE, fill_blocks, &p);
    free(p.leaves);
    return ASDIC_OK;
}
