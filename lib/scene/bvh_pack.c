/*
 * Collapse of the binary tree into eight-wide nodes with the least sum of surface areas, by dynamic
 * programming from the leaves up (H. Ylitie, T. Karras, S. Laine, "Efficient Incoherent Ray
 * Traversal on GPUs Through Compressed Wide BVHs", HPG 2017, section 3.1; leaves are fixed here).
 */
#include "bvh.h"

#include "../base/context.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Finite, so that (plane - origin) * inverse is never infinity * 0. */
#define FAR_PLANE 3e38f

typedef struct pack_task {
    uint32_t node2, node8; /* inner binary node, and where its eight-wide form goes */
    unsigned depth;
} pack_task;

/* forest[n][i - 1]: the least sum of areas of eight-wide nodes that hold the subtree of binary
 * node n under at most i roots. */
typedef float forest[DEV_BVH_WIDTH - 1];

typedef struct packer {
    const asdic_bvh_node2 *nodes;
    const asdic_bvh_item *items;
    const dev_triangle *triangles;
    forest *best;
    asdic_bvh *out;
    pack_task *stack;
    size_t top;
} packer;

static float half_area(const asdic_bvh_node2 *n) {
    float x = n->hi[0] - n->lo[0], y = n->hi[1] - n->lo[1], z = n->hi[2] - n->lo[2];
    return x * y + y * z + z * x;
}

static float least_sum(const forest *best, uint32_t left, uint32_t right, int roots, int *share) {
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

/* Children have higher indices than their parents; entries never built have no link. */
static void plan_collapse(const asdic_bvh_node2 *nodes, size_t count, forest *best) {
    for (size_t n = count; n-- > 0;) {
        const asdic_bvh_node2 *node = &nodes[n];
        if (node->count > 0) {
            memset(best[n], 0, sizeof best[n]);
            continue;
        }
        if (node->link == 0) {
            continue;
        }
        int share = 0;
        uint32_t left = (uint32_t)n + 1, right = node->link;
        float one = half_area(node) + least_sum(best, left, right, DEV_BVH_WIDTH, &share);
        best[n][0] = one;
        for (int roots = 2; roots < DEV_BVH_WIDTH; roots++) {
            float several = least_sum(best, left, right, roots, &share);
            best[n][roots - 1] = several < one ? several : one;
        }
    }
}

/* Adds the roots under which the plan holds NODE2, at most ROOTS of them, to CHILD. */
static void gather_roots(const packer *p, uint32_t node2, int roots, uint32_t *child, int *count) {
    const asdic_bvh_node2 *node = &p->nodes[node2];
    int share = 0;
    if (node->count == 0 && roots > 1 &&
        least_sum(p->best, node2 + 1, node->link, roots, &share) < p->best[node2][0]) {
        gather_roots(p, node2 + 1, share, child, count);
        gather_roots(p, node->link, roots - share, child, count);
    } else {
        child[(*count)++] = node2;
    }
}

/* The up to eight binary nodes that become children of NODE2; returns how many. */
static int gather_children(const packer *p, uint32_t node2, uint32_t child[DEV_BVH_WIDTH]) {
    uint32_t left = node2 + 1, right = p->nodes[node2].link;
    int count = 0, share = 1;
    least_sum(p->best, left, right, DEV_BVH_WIDTH, &share);
    gather_roots(p, left, share, child, &count);
    gather_roots(p, right, DEV_BVH_WIDTH - share, child, &count);
    return count;
}

static uint32_t pack_block(packer *p, const asdic_bvh_node2 *leaf) {
    uint32_t index = (uint32_t)p->out->block_count++;
    dev_block4 *block = &p->out->blocks[index];
    for (uint32_t lane = 0; lane < DEV_LEAF_TRIANGLES; lane++) {
        if (lane >= leaf->count) {
            block->id[lane] = ~0u; /* corners stay zero: never hit */
            continue;
        }
        uint32_t id = p->items[leaf->link + lane].id;
        const dev_triangle *t = &p->triangles[id];
        block->id[lane] = id;
        for (int k = 0; k < 3; k++) {
            block->v[k][lane] = t->v0[k];
            block->v[3 + k][lane] = t->v1[k];
            block->v[6 + k][lane] = t->v2[k];
        }
    }
    return DEV_LEAF | index;
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
            asdic_node8_set_child(node, i, n->lo, n->hi, pack_block(p, n));
        } else {
            uint32_t index = (uint32_t)p->out->node_count++;
            asdic_node8_set_child(node, i, n->lo, n->hi, index);
            p->stack[p->top++] = (pack_task){child[i], index, task.depth + 1};
        }
    }
}

static void count_nodes(const asdic_bvh_node2 *nodes, uint32_t *stack, size_t *inner,
                        size_t *leaves) {
    size_t top = 0;
    stack[top++] = 0;
    *inner = *leaves = 0;
    while (top > 0) {
        uint32_t at = stack[--top];
        if (nodes[at].count > 0) {
            ++*leaves;
            continue;
        }
        ++*inner;
        stack[top++] = at + 1;
        stack[top++] = nodes[at].link;
    }
}

static asdic_status pack(packer *p, size_t entries) {
    uint32_t count_stack[ASDIC_BVH_HEURISTIC_DEPTH + 40];
    pack_task stack[DEV_BVH_WIDTH * (ASDIC_BVH_HEURISTIC_DEPTH + 40)];
    asdic_bvh *out = p->out;
    size_t inner, leaves;
    count_nodes(p->nodes, count_stack, &inner, &leaves);
    out->blocks = calloc(leaves, sizeof *out->blocks);
    /* Every eight-wide node takes at least one binary node with it. */
    out->nodes = malloc((inner + 1) * sizeof *out->nodes);
    if (!out->blocks || !out->nodes) {
        return ASDIC_ERROR_MEMORY;
    }
    if (p->nodes[0].count > 0) {
        out->root = pack_block(p, &p->nodes[0]);
        return ASDIC_OK;
    }
    plan_collapse(p->nodes, entries, p->best);
    p->stack = stack;
    out->root = 0;
    out->node_count = 1;
    stack[p->top++] = (pack_task){0, 0, 1};
    while (p->top > 0) {
        pack_node(p, stack[--p->top]);
    }
    dev_node8 *trimmed = realloc(out->nodes, out->node_count * sizeof *out->nodes);
    out->nodes = trimmed ? trimmed : out->nodes;
    return ASDIC_OK;
}

asdic_status asdic_bvh_pack(asdic_context *ctx, const asdic_bvh_node2 *nodes,
                            const asdic_bvh_item *items, const dev_triangle *triangles,
                            size_t count, asdic_bvh *out) {
    size_t entries = 2 * count - 1;
    *out = (asdic_bvh){.root = DEV_EMPTY};
    packer p = {.nodes = nodes, .items = items, .triangles = triangles, .out = out};
    p.best = malloc(entries * sizeof *p.best);
    asdic_status status = p.best ? pack(&p, entries) : ASDIC_ERROR_MEMORY;
    free(p.best);
    if (status != ASDIC_OK) {
        asdic_bvh_finish(out);
        return asdic_fail(ctx, status, "out of memory while packing a hierarchy of %zu triangles",
                          count);
    }
    return ASDIC_OK;
}
