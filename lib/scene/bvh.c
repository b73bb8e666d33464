#include "bvh.h"

#include "../base/context.h"

#include <math.h>
#include <stdlib.h>
#include <unistd.h>

static void item_from_triangle(const dev_triangle *t, uint32_t id, asdic_bvh_item *item) {
    item->id = id;
    item->zero = 0;
    for (int k = 0; k < 3; k++) {
        float a = t->v0[k], b = t->v1[k], c = t->v2[k];
        float lo = a < b ? a : b, hi = a > b ? a : b;
        item->lo[k] = lo < c ? lo : c;
        item->hi[k] = hi > c ? hi : c;
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
        long online = sysconf(_SC_NPROCESSORS_ONLN);
        threads = online > 0 ? (unsigned)online : 1;
    }
    asdic_status status;
    asdic_bvh_item *items = malloc(count * sizeof *items);
    asdic_bvh_node2 *nodes = calloc(2 * count - 1, sizeof *nodes);
    if (!items || !nodes) {
        status = asdic_fail(ctx, ASDIC_ERROR_MEMORY,
                            "out of memory while building a hierarchy of %zu triangles", count);
        goto fail;
    }
    for (size_t i = 0; i < count; i++) {
        uint32_t id = ids ? ids[i] : (uint32_t)i;
        item_from_triangle(&triangles[id], id, &items[i]);
    }
    status = asdic_bvh_split(ctx, items, count, threads, nodes);
    if (status == ASDIC_OK) {
        status = asdic_bvh_pack(ctx, nodes, items, triangles, count, out);
    }
    if (status == ASDIC_OK) {
        out->extent_m = largest_coordinate(&nodes[0]);
    }
fail:
    free(nodes);
    free(items);
    return status;
}

void asdic_bvh_finish(asdic_bvh *bvh) {
    if (bvh) {
        free(bvh->nodes);
        free(bvh->blocks);
        *bvh = (asdic_bvh){.root = DEV_EMPTY};
    }
}
