#include "moving.h"

#include "base/try.h"

#include "bvh.h"
#include "lifted.h"
#include "place.h"
#include "smooth.h"

#include "../../kernels/smooth.h"
#include "../base/context.h"
#include "../base/vec.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static void root_add(asdic_root *r, const float lo[3], const float hi[3]) {
    for (int k = 0; k < 3; k++) {
        r->lo[k] = fminf(r->lo[k], lo[k]);
        r->hi[k] = fmaxf(r->hi[k], hi[k]);
    }
}

static void add_block(const dev_block4 *block, asdic_root *r) {
    for (int lane = 0; lane < DEV_LEAF_TRIANGLES && block->id[lane] != ~0u; lane++) {
        float corner[3][3], lo[3], hi[3];
        for (int i = 0; i < 9; i++) {
            corner[i / 3][i % 3] = block->v[i][lane];
        }
        asdic_triangle_box((const float *const[]){corner[0], corner[1], corner[2]}, lo, hi);
        root_add(r, lo, hi);
    }
}

static void add_node(const dev_node8 *node, asdic_root *r) {
    for (int i = 0; i < DEV_BVH_WIDTH; i++) {
        if (node->child[i] != DEV_EMPTY) {
            const float lo[3] = {node->lo_x[i], node->lo_y[i], node->lo_z[i]};
            const float hi[3] = {node->hi_x[i], node->hi_y[i], node->hi_z[i]};
            root_add(r, lo, hi);
        }
    }
}

asdic_root asdic_root_of(const dev_node8 *nodes, const dev_block4 *blocks, uint32_t word) {
    asdic_root r = {{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}, word};
    if (word == DEV_EMPTY) {
        return r;
    }
    if (word & DEV_LEAF) {
        add_block(&blocks[word & ~DEV_LEAF], &r);
    } else {
        add_node(&nodes[word], &r);
    }
    return r;
}

/* Corner NTH of a block's triangle. */
static void place_corner(const float v[3], double bend_per_m, double shift_m, int nth, int lane,
                         dev_block4 *block) {
    block->v[3 * nth][lane] = v[0];
    block->v[3 * nth + 1][lane] = v[1];
    float z = asdic_lifted_z(bend_per_m, (const double[]){v[0], v[1], v[2]});
    block->v[3 * nth + 2][lane] = (float)((double)z + shift_m);
}

void asdic_movable_refit(const asdic_movable *m, const dev_triangle *triangles, double bend_per_m,
                         double shift_m, dev_node8 *nodes, dev_block4 *blocks) {
    for (size_t b = 0; b < m->block_count; b++) {
        dev_block4 *block = &blocks[m->first_block + b];
        for (int lane = 0; lane < DEV_LEAF_TRIANGLES && block->id[lane] != ~0u; lane++) {
            const dev_triangle *t = &triangles[block->id[lane] - m->first];
            place_corner(t->v0, bend_per_m, shift_m, 0, lane, block);
            place_corner(t->v1, bend_per_m, shift_m, 1, lane, block);
            place_corner(t->v2, bend_per_m, shift_m, 2, lane, block);
        }
    }
    /* Children come after their parents. */
    for (size_t n = m->first_node + m->node_count; n-- > m->first_node;) {
        for (int i = 0; i < DEV_BVH_WIDTH; i++) {
            uint32_t word = nodes[n].child[i];
            if (word != DEV_EMPTY) {
                asdic_root r = asdic_root_of(nodes, blocks, word);
                asdic_node8_set_child(&nodes[n], i, r.lo, r.hi, word);
            }
        }
    }
}

void asdic_movable_place(const asdic_movable *m, const asdic_pose *pose, asdic_vec3 origin_m,
                         double *world_m, dev_triangle *triangles) {
    asdic_mat3 turn = asdic_mat3_of(pose);
    for (size_t i = 0; i < m->count; i++) {
        dev_triangle *t = &triangles[i];
        asdic_place_corners(&m->corners_m[9 * i], turn, pose->position_m, &world_m[9 * i]);
        asdic_place_triangle(&world_m[9 * i], origin_m, t);
        for (size_t k = 0; k < 3 && t->corner_normals[0] != DEV_FLAT; k++) {
            t->corner_normals[k] = asdic_smooth_pack(asdic_mat3_apply(turn, m->normals[3 * i + k]));
        }
    }
}

/* ---- assembly ------------------------------------------------------------------------------- */

/* Joins several trees into one: room for the top, then the parts in the order given. */
typedef struct joiner {
    asdic_bvh *out;
    unsigned deepest;
} joiner;

/* Appends PART's nodes and blocks, which fit; returns its root's child word. */
static uint32_t join(joiner *j, const asdic_bvh *part) {
    asdic_bvh *out = j->out;
    uint32_t node = (uint32_t)out->node_count, block = (uint32_t)out->block_count;
    if (part->root == DEV_EMPTY) {
        return DEV_EMPTY;
    }
    memcpy(out->blocks + block, part->blocks, part->block_count * sizeof *part->blocks);
    for (size_t n = 0; n < part->node_count; n++) {
        dev_node8 *to = &out->nodes[out->node_count++];
        *to = part->nodes[n];
        for (int i = 0; i < DEV_BVH_WIDTH; i++) {
            if (to->child[i] != DEV_EMPTY) {
                to->child[i] += to->child[i] & DEV_LEAF ? block : node;
            }
        }
    }
    out->block_count += part->block_count;
    j->deepest = part->depth > j->deepest ? part->depth : j->deepest;
    return part->root + (part->root & DEV_LEAF ? block : node);
}

static asdic_status allocate(asdic_scene *scene, const asdic_bvh *parts, size_t count) {
    size_t nodes = count, blocks = 0;
    for (size_t i = 0; i < count; i++) {
        nodes += parts[i].node_count;
        blocks += parts[i].block_count;
    }
    scene->bvh.nodes = calloc(nodes, sizeof *scene->bvh.nodes);
    scene->bvh.blocks = malloc(blocks * sizeof *scene->bvh.blocks);
    return scene->bvh.nodes && scene->bvh.blocks
               ? ASDIC_OK
               : asdic_fail_memory(scene->ctx, "a hierarchy with moving parts");
}

/* PARTS: by movable, then what stays. */
static asdic_status join_all(asdic_scene *scene, const asdic_bvh *parts, asdic_root *roots) {
    size_t movables = scene->movable_count, count = movables + 1;
    asdic_bvh *bvh = &scene->bvh;
    TRY(allocate(scene, parts, count));
    joiner j = {.out = bvh};
    bvh->node_count = count;
    for (size_t i = 0; i < movables; i++) {
        asdic_movable *m = &scene->movables[i];
        m->first_node = bvh->node_count;
        m->first_block = bvh->block_count;
        m->node_count = parts[i].node_count;
        m->block_count = parts[i].block_count;
        m->root = join(&j, &parts[i]);
    }
    scene->moving_nodes = bvh->node_count;
    scene->moving_blocks = bvh->block_count;
    scene->still_root = join(&j, &parts[movables]);
    for (size_t i = 0; i < count; i++) {
        uint32_t word = i < movables ? scene->movables[i].root : scene->still_root;
        roots[i] = asdic_root_of(bvh->nodes, bvh->blocks, word);
        bvh->extent_m = fmaxf(bvh->extent_m, parts[i].extent_m);
    }
    unsigned top;
    asdic_top_build(bvh->nodes, roots, scene->still_root == DEV_EMPTY ? movables : count, &top);
    bvh->root = 0;
    bvh->depth = top + j.deepest;
    return ASDIC_OK;
}

/* OUT: A and B under one node. */
static asdic_status join_two(asdic_context *ctx, const asdic_bvh *a, const asdic_bvh *b,
                             asdic_bvh *out) {
    *out = (asdic_bvh){.nodes = calloc(a->node_count + b->node_count + 1, sizeof *out->nodes),
                       .blocks = malloc((a->block_count + b->block_count) * sizeof *out->blocks),
                       .node_count = 1,
                       .extent_m = fmaxf(a->extent_m, b->extent_m)};
    if (!out->nodes || !out->blocks) {
        asdic_bvh_finish(out);
        return asdic_fail_memory(ctx, "a hierarchy of bottom and objects");
    }
    joiner j = {.out = out};
    uint32_t words[2] = {join(&j, a), join(&j, b)};
    asdic_root roots[2] = {asdic_root_of(out->nodes, out->blocks, words[0]),
                           asdic_root_of(out->nodes, out->blocks, words[1])};
    unsigned top;
    asdic_top_build(out->nodes, roots, words[1] == DEV_EMPTY ? 1 : 2, &top);
    out->depth = top + j.deepest;
    return ASDIC_OK;
}

static asdic_status build(asdic_scene *scene, const uint32_t *ids, size_t count, asdic_bvh *out) {
    return asdic_bvh_build(scene->ctx, scene->triangles, ids, count, scene->threads, out);
}

/* The hierarchy of what stays, COUNT triangles of these IDS in ascending order. */
static asdic_status build_still(asdic_scene *scene, const uint32_t *ids, size_t count,
                                asdic_bvh *out) {
    size_t first = scene->ground_count;
    asdic_ground *ground = scene->ground;
    if (!ground || first == 0) {
        return build(scene, ids, count, out);
    }
    asdic_bvh rest = {.root = DEV_EMPTY};
    if (ground->bvh.root == DEV_EMPTY) {
        TRY(build(scene, ids, first, &ground->bvh));
    }
    TRY(build(scene, ids + first, count - first, &rest));
    asdic_status status = join_two(scene->ctx, &ground->bvh, &rest, out);
    asdic_bvh_finish(&rest);
    return status;
}

/* The ids of the triangles that stay: all of the ground, then some. */
static size_t list_still(const asdic_scene *scene, uint32_t *ids) {
    size_t count = 0;
    while (count < scene->ground_count) {
        ids[count] = (uint32_t)count;
        count++;
    }
    for (size_t i = count; i < scene->triangle_count; i++) {
        if (!scene->parts[scene->triangles[i].part].moves) {
            ids[count++] = (uint32_t)i;
        }
    }
    return count;
}

static asdic_status build_parts(asdic_scene *scene, uint32_t *ids, asdic_bvh *parts) {
    for (size_t i = 0; i < scene->movable_count; i++) {
        const asdic_movable *m = &scene->movables[i];
        for (size_t k = 0; k < m->count; k++) {
            ids[k] = (uint32_t)(m->first + k);
        }
        TRY(build(scene, ids, m->count, &parts[i]));
    }
    size_t still = list_still(scene, ids);
    return build_still(scene, ids, still, &parts[scene->movable_count]);
}

static asdic_status assemble_with_movables(asdic_scene *scene, uint32_t *ids) {
    size_t count = scene->movable_count + 1;
    asdic_bvh *parts = calloc(count, sizeof *parts);
    asdic_root *roots = malloc(count * sizeof *roots);
    asdic_status status = parts && roots
                              ? build_parts(scene, ids, parts)
                              : asdic_fail_memory(scene->ctx, "a scene with moving parts");
    status = status ? status : join_all(scene, parts, roots);
    for (size_t i = 0; parts && i < count; i++) {
        asdic_bvh_finish(&parts[i]);
    }
    free(roots);
    free(parts);
    return status;
}

asdic_status asdic_scene_assemble(asdic_scene *scene) {
    if (scene->movable_count == 0 && !scene->ground) {
        return build(scene, NULL, scene->triangle_count, &scene->bvh);
    }
    uint32_t *ids = malloc((scene->triangle_count + 1) * sizeof *ids);
    if (!ids) {
        return asdic_fail_memory(scene->ctx, "the triangles of a scene");
    }
    asdic_status status = scene->movable_count > 0
                              ? assemble_with_movables(scene, ids)
                              : build_still(scene, ids, list_still(scene, ids), &scene->bvh);
    free(ids);
    return status;
}
