#include "bvh.h"

#include "../base/context.h"
#include "../base/share.h"

#include <math.h>
#include <stdlib.h>

typedef struct filler {
    const dev_triangle *triangles;
    const uint32_t *ids; /* NULL: 0, 1, ... */
    asdic_bvh_item *items;
} filler;

void asdic_triangle_box(const float *const corner[3], float lo[3], float hi[3]) {
    for (int k = 0; k < 3; k++) {
        float a = corner[0][k], b = corner[1][k], c = corner[2][k];
        float least = a < b ? a : b, most = a > b ? a : b;
        least = least < c ? least : c;
        most = most > c ? most : c;
        lo[k] = least - (most - least) * DEV_BOX_MARGIN;
        hi[k] = most + (most - least) * DEV_BOX_MARGIN;
    }
}

static void fill_items(void *user, unsigned worker, size_t first, size_t end) {
    (void)worker;
    const filler *f = user;
    for (size_t i = first; i < end; i++) {
        uint32_t id = f->ids ? f->ids[i] : (uint32_t)i;
        const dev_triangle *t = &f->triangles[id];
        asdic_bvh_item *item = &f->items[i];
        item->id = id;
        item->zero = 0;
        asdic_triangle_box((const float *const[]){t->v0, t->v1, t->v2}, item->lo, item->hi);
    }
}

static float largest_coordinate(const asdic_bvh_node2 *root) {
    float extent = 0.0f;
    for (int k = 0; k < 3; k++) {
        float lo = fabsf(root->lo[k]), hi = fabsf(root->hi[k]);
        extent = lo > extent ? lo : extent;
        extent = hi > extent ? hi : extent;
    }
    return extent;
}

asdic_status asdic_bvh_build(asdic_context *ctx, const dev_triangle *triangles, const uint32_t *ids,
                             size_t count, unsigned threads, asdic_bvh *out) {
    *out = (asdic_bvh){.root = DEV_EMPTY};
    if (count == 0) {
        return ASDIC_OK;
    }
    if (count > ASDIC_BVH_MAX_TRIANGLES) {
        return asdic_fail(ctx, ASDIC_ERROR_MEMORY, "%zu triangles are more than the %u of a scene",
                          count, ASDIC_BVH_MAX_TRIANGLES);
    }
    if (threads == 0) {
        threads = asdic_processors();
    }
    asdic_bvh_tree tree = {.nodes = NULL};
    filler f = {triangles, ids, malloc(count * sizeof *f.items)};
    asdic_status status = ASDIC_OK;
    if (!f.items) {
        status = asdic_fail(ctx, ASDIC_ERROR_MEMORY,
                            "out of memory while building a hierarchy of %zu triangles", count);
        goto fail;
    }
    asdic_share(threads, count, ASDIC_BVH_SHARE, fill_items, &f);
    status = asdic_bvh_grow(ctx, f.items, count, threads, &tree);
    status = status ? status : asdic_bvh_pack(ctx, &tree, f.items, triangles, threads, out);
    if (status == ASDIC_OK) {
        out->extent_m = largest_coordinate(&tree.nodes[0]);
    }
fail:
    asdic_bvh_tree_finish(&tree);
    free(f.items);
    return status;
}

void asdic_bvh_finish(asdic_bvh *bvh) {
    if (bvh) {
        free(bvh->nodes);
        free(bvh->blocks);
        *bvh = (asdic_bvh){.root = DEV_EMPTY};
    }
}
