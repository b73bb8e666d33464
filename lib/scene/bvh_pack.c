/*
 * Collapse of the binary tree: an eight-wide node takes the two children of a binary node and
 * keeps opening the one with the largest surface until it has eight.
 */
#include "bvh.h"

#include "../base/context.h"

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
    const asdic_bvh_item *items;
    const dev_triangle *triangles;
    asdic_bvh *out;
    pack_task *stack;
    size_t top;
} packer;

static float half_area(const asdic_bvh_node2 *n) {
    float x = n->hi[0] - n->lo[0], y = n->hi[1] - n->lo[1], z = n->hi[2] - n->lo[2];
    return x * y + y * z + z * x;
}

/* The up to eight binary nodes that become children of NODE2; returns how many. */
static int gather_children(const packer *p, uint32_t node2, uint32_t child[DEV_BVH_WIDTH]) {
    int count = 2;
    child[0] = node2 + 1;
    child[1] = p->nodes[node2].link;
    while (count < DEV_BVH_WIDTH) {
        int widest = -1;
        float area = -1.0f;
        for (int i = 0; i < count; i++) {
            const asdic_bvh_node2 *n = &p->nodes[child[i]];
            if (n->count == 0 && half_area(n) > area) {
                area = half_area(n);
                widest = i;
            }
        }
        if (widest < 0) {
            break;
        }
        uint32_t opened = child[widest];
        child[widest] = opened + 1;
        child[count++] = p->nodes[opened].link;
    }
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

static void set_child(dev_node8 *node, int i, const asdic_bvh_node2 *box, uint32_t word) {
    static const asdic_bvh_node2 NOWHERE = {
        {FAR_PLANE, FAR_PLANE, FAR_PLANE}, 0, {-FAR_PLANE, -FAR_PLANE, -FAR_PLANE}, 0};
    box = box ? box : &NOWHERE;
    node->lo_x[i] = box->lo[0];
    node->lo_y[i] = box->lo[1];
    node->lo_z[i] = box->lo[2];
    node->hi_x[i] = box->hi[0];
    node->hi_y[i] = box->hi[1];
    node->hi_z[i] = box->hi[2];
    node->child[i] = word;
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
            set_child(node, i, NULL, DEV_EMPTY);
            continue;
        }
        const asdic_bvh_node2 *n = &p->nodes[child[i]];
        if (n->count > 0) {
            set_child(node, i, n, pack_block(p, n));
        } else {
            uint32_t index = (uint32_t)p->out->node_count++;
            set_child(node, i, n, index);
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

asdic_status asdic_bvh_pack(asdic_context *ctx, const asdic_bvh_node2 *nodes,
                            const asdic_bvh_item *items, const dev_triangle *triangles,
                            asdic_bvh *out) {
    uint32_t count_stack[ASDIC_BVH_HEURISTIC_DEPTH + 40];
    size_t inner, leaves;
    count_nodes(nodes, count_stack, &inner, &leaves);
    pack_task stack[DEV_BVH_WIDTH * (ASDIC_BVH_HEURISTIC_DEPTH + 40)];
    *out = (asdic_bvh){.root = DEV_EMPTY};
    out->blocks = calloc(leaves, sizeof *out->blocks);
    /* Every eight-wide node takes at least one binary node with it. */
    out->nodes = malloc((inner + 1) * sizeof *out->nodes);
    if (!out->blocks || !out->nodes) {
        asdic_bvh_finish(out);
        return asdic_fail(ctx, ASDIC_ERROR_MEMORY,
                          "out of memory while packing a hierarchy of %zu blocks", leaves);
    }
    packer p = {nodes, items, triangles, out, stack, 0};
    if (nodes[0].count > 0) {
        out->root = pack_block(&p, &nodes[0]);
        return ASDIC_OK;
    }
    out->root = 0;
    out->node_count = 1;
    stack[p.top++] = (pack_task){0, 0, 1};
    while (p.top > 0) {
        pack_node(&p, stack[--p.top]);
    }
    dev_node8 *trimmed = realloc(out->nodes, out->node_count * sizeof *out->nodes);
    out->nodes = trimmed ? trimmed : out->nodes;
    return ASDIC_OK;
}
