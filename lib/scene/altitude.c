/*
 * Altitude above the bottom, straight below and above its summits: walks the same hierarchy on the
 * host in double.
 */
#include "scene.h"

#include "base/vec.h"

#include <math.h>

typedef struct plumb {
    double x, y, z; /* scene frame */
    double best_z;  /* nearest bottom at or below z so far */
    const asdic_scene *scene;
} plumb;

/* Twice the signed area of (point, a, b), seen from above. */
static double side(const plumb *p, const float a[3], const float b[3]) {
    return ((double)a[0] - p->x) * ((double)b[1] - p->y) -
           ((double)a[1] - p->y) * ((double)b[0] - p->x);
}

static void plumb_triangle(plumb *p, uint32_t id) {
    const dev_triangle *t = &p->scene->triangles[id];
    if (p->scene->parts[t->part].kind != DEV_KIND_BOTTOM) {
        return;
    }
    double u = side(p, t->v1, t->v2), v = side(p, t->v2, t->v0), w = side(p, t->v0, t->v1);
    double area = u + v + w;
    bool inside = (u >= 0.0 && v >= 0.0 && w >= 0.0) || (u <= 0.0 && v <= 0.0 && w <= 0.0);
    if (!inside || area == 0.0) {
        return;
    }
    double z = (u * t->v0[2] + v * t->v1[2] + w * t->v2[2]) / area;
    if (z >= p->z && z < p->best_z) {
        p->best_z = z;
    }
}

static bool box_matters(const plumb *p, const dev_node8 *n, int i) {
    return p->x >= n->lo_x[i] && p->x <= n->hi_x[i] && p->y >= n->lo_y[i] && p->y <= n->hi_y[i] &&
           p->z <= n->hi_z[i] && p->best_z >= n->lo_z[i];
}

/* Recursion is at most as deep as the tree, some tens of levels. */
static void plumb_word(plumb *p, uint32_t word) {
    const asdic_bvh *bvh = &p->scene->bvh;
    if (word & DEV_LEAF) {
        const dev_block4 *block = &bvh->blocks[word & ~DEV_LEAF];
        for (int i = 0; i < DEV_LEAF_TRIANGLES; i++) {
            if (block->id[i] != ~0u) {
                plumb_triangle(p, block->id[i]);
            }
        }
        return;
    }
    const dev_node8 *node = &bvh->nodes[word];
    for (int i = 0; i < DEV_BVH_WIDTH; i++) {
        if (node->child[i] != DEV_EMPTY && box_matters(p, node, i)) {
            plumb_word(p, node->child[i]);
        }
    }
}

double asdic_scene_altitude_m(const asdic_scene *scene, asdic_vec3 position_m) {
    if (!scene) {
        return INFINITY;
    }
    plumb p = {position_m.x - scene->origin_m.x, position_m.y - scene->origin_m.y,
               position_m.z - scene->origin_m.z, INFINITY, scene};
    if (scene->bvh.root != DEV_EMPTY) {
        plumb_word(&p, scene->bvh.root);
    }
    double altitude = p.best_z - p.z;
    if (scene->has_bottom_plane && scene->bottom_plane_depth_m >= position_m.z) {
        altitude = fmin(altitude, scene->bottom_plane_depth_m - position_m.z);
    }
    return altitude;
}

/* The highest bottom below a point's depth. */
typedef struct summit {
    const asdic_scene *scene;
    double at[3]; /* scene frame */
    double reach_m;
    double best_z; /* so far */
} summit;

static bool box_may_rise(const summit *s, const dev_node8 *n, int i) {
    const float *lo[3] = {n->lo_x, n->lo_y, n->lo_z}, *hi[3] = {n->hi_x, n->hi_y, n->hi_z};
    double distance2 = 0.0;
    for (int k = 0; k < 3; k++) {
        double off = fmax(fmax(lo[k][i] - s->at[k], s->at[k] - hi[k][i]), 0.0);
        distance2 += off * off;
    }
    return n->lo_z[i] < s->best_z && n->hi_z[i] > s->at[2] && distance2 <= s->reach_m * s->reach_m;
}

static void rise_to(summit *s, uint32_t id) {
    const dev_triangle *t = &s->scene->triangles[id];
    double top = fmin(fmin(t->v0[2], t->v1[2]), t->v2[2]);
    if (s->scene->parts[t->part].kind == DEV_KIND_BOTTOM && top > s->at[2] && top < s->best_z) {
        s->best_z = top;
    }
}

static void raise_word(summit *s, uint32_t word) {
    const asdic_bvh *bvh = &s->scene->bvh;
    if (word & DEV_LEAF) {
        const dev_block4 *block = &bvh->blocks[word & ~DEV_LEAF];
        for (int i = 0; i < DEV_LEAF_TRIANGLES; i++) {
            if (block->id[i] != ~0u) {
                rise_to(s, block->id[i]);
            }
        }
        return;
    }
    const dev_node8 *node = &bvh->nodes[word];
    for (int i = 0; i < DEV_BVH_WIDTH; i++) {
        if (node->child[i] != DEV_EMPTY && box_may_rise(s, node, i)) {
            raise_word(s, node->child[i]);
        }
    }
}

double asdic_scene_clearance_m(const asdic_scene *scene, asdic_vec3 position_m, double reach_m) {
    asdic_vec3 at = asdic_vec3_sub(position_m, scene->origin_m);
    summit s = {scene, {at.x, at.y, at.z}, reach_m, INFINITY};
    if (scene->bvh.root != DEV_EMPTY) {
        raise_word(&s, scene->bvh.root);
    }
    return s.best_z - at.z;
}
