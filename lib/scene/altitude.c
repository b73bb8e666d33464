/*
 * Altitude above the bottom, straight below and above its summits: walks the same hierarchy on the
 * host in double.
 */
#include "scene.h"

#include "base/vec.h"

#include <math.h>

typedef struct descent descent;
struct descent {
    const asdic_scene *scene;
    double at[3]; /* scene frame */
    double reach_m;
    double best_z; /* nearest bottom at or below, so far */
    bool (*may_matter)(const descent *d, const dev_node8 *n, int i);
    void (*look)(descent *d, const dev_triangle *t); /* at a triangle of the bottom */
};

/* Recursion is at most as deep as the tree, some tens of levels. */
static void descend(descent *d, uint32_t word) {
    const asdic_scene *scene = d->scene;
    if (word == DEV_EMPTY) {
        return;
    }
    if (word & DEV_LEAF) {
        const dev_block4 *block = &scene->bvh.blocks[word & ~DEV_LEAF];
        for (int i = 0; i < DEV_LEAF_TRIANGLES; i++) {
            const dev_triangle *t = block->id[i] != ~0u ? &scene->triangles[block->id[i]] : NULL;
            if (t && scene->parts[t->part].kind == DEV_KIND_BOTTOM) {
                d->look(d, t);
            }
        }
        return;
    }
    const dev_node8 *node = &scene->bvh.nodes[word];
    for (int i = 0; i < DEV_BVH_WIDTH; i++) {
        if (node->child[i] != DEV_EMPTY && d->may_matter(d, node, i)) {
            descend(d, node->child[i]);
        }
    }
}

/* Twice the signed area of (point, a, b), seen from above. */
static double side(const descent *d, const float a[3], const float b[3]) {
    return ((double)a[0] - d->at[0]) * ((double)b[1] - d->at[1]) -
           ((double)a[1] - d->at[1]) * ((double)b[0] - d->at[0]);
}

static void plumb(descent *d, const dev_triangle *t) {
    double u = side(d, t->v1, t->v2), v = side(d, t->v2, t->v0), w = side(d, t->v0, t->v1);
    double area = u + v + w;
    bool inside = (u >= 0.0 && v >= 0.0 && w >= 0.0) || (u <= 0.0 && v <= 0.0 && w <= 0.0);
    if (!inside || area == 0.0) {
        return;
    }
    double z = (u * t->v0[2] + v * t->v1[2] + w * t->v2[2]) / area;
    if (z >= d->at[2] && z < d->best_z) {
        d->best_z = z;
    }
}

static bool is_plumb(const descent *d, const dev_node8 *n, int i) {
    return d->at[0] >= n->lo_x[i] && d->at[0] <= n->hi_x[i] && d->at[1] >= n->lo_y[i] &&
           d->at[1] <= n->hi_y[i] && d->at[2] <= n->hi_z[i] && d->best_z >= n->lo_z[i];
}

double asdic_scene_altitude_m(const asdic_scene *scene, asdic_vec3 position_m) {
    if (!scene) {
        return INFINITY;
    }
    asdic_vec3 at = asdic_vec3_sub(position_m, scene->origin_m);
    descent d = {scene, {at.x, at.y, at.z}, 0.0, INFINITY, is_plumb, plumb};
    descend(&d, scene->bvh.root);
    double altitude = d.best_z - at.z;
    if (scene->has_bottom_plane && scene->bottom_plane_depth_m >= position_m.z) {
        altitude = fmin(altitude, scene->bottom_plane_depth_m - position_m.z);
    }
    return altitude;
}

static bool may_rise(const descent *d, const dev_node8 *n, int i) {
    const float *lo[3] = {n->lo_x, n->lo_y, n->lo_z}, *hi[3] = {n->hi_x, n->hi_y, n->hi_z};
    double distance2 = 0.0;
    for (int k = 0; k < 3; k++) {
        double off = fmax(fmax(lo[k][i] - d->at[k], d->at[k] - hi[k][i]), 0.0);
        distance2 += off * off;
    }
    return n->lo_z[i] < d->best_z && n->hi_z[i] > d->at[2] && distance2 <= d->reach_m * d->reach_m;
}

static void rise(descent *d, const dev_triangle *t) {
    double top = fmin(fmin(t->v0[2], t->v1[2]), t->v2[2]);
    if (top > d->at[2] && top < d->best_z) {
        d->best_z = top;
    }
}

double asdic_scene_clearance_m(const asdic_scene *scene, asdic_vec3 position_m, double reach_m) {
    asdic_vec3 at = asdic_vec3_sub(position_m, scene->origin_m);
    descent d = {scene, {at.x, at.y, at.z}, reach_m, INFINITY, may_rise, rise};
    descend(&d, scene->bvh.root);
    return d.best_z - at.z;
}
