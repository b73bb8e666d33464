/*
 * A committed scene: triangles relative to an origin, their hierarchy, parts and materials.
 * Everything a simulator uploads.
 */
#ifndef ASDIC_SCENE_SCENE_H
#define ASDIC_SCENE_SCENE_H

#include <asdic/scene.h>

#include "../../kernels/ping_types.h"
#include "../../kernels/types.h"

#include <pthread.h>

/* Of parts that do not say otherwise. A round body of 16 facets turns by 22.5 degrees from one to the next, one of 11 by
 * 33. */
#define ASDIC_CREASE_RAD (35.0 * ASDIC_PI / 180.0)

typedef struct asdic_bvh {
    dev_node8 *nodes;
    dev_block4 *blocks;
    size_t node_count, block_count;
    uint32_t root;  /* child word: node 0, a lone leaf, or DEV_EMPTY without triangles */
    unsigned depth; /* levels of inner nodes: the traversal stack needs 7 * depth + 8 entries */
    float extent_m; /* largest coordinate by magnitude */
} asdic_bvh;

typedef struct asdic_part {
    char name[ASDIC_NAME_SIZE]; /* "" for the bottom */
    unsigned kind;              /* DEV_KIND_BOTTOM, DEV_KIND_OBJECT */
    bool moves;
    size_t material;     /* index into materials */
    unsigned number;     /* of an object, from 1 on, points included */
    asdic_vec3 center_m; /* bounding sphere, world */
    double radius_m;
    double area_m2;    /* of an object, one side */
    double crease_rad; /* facets that lean less against each other stand for a curved surface */
    bool is_primitive; /* made by the scene file, not read: what its facets stand for is known */
    int outward; /* whether its triangles, as wound, face out of it: 1, -1 into it, 0: a sheet */
} asdic_part;

typedef struct asdic_point {
    char name[ASDIC_NAME_SIZE];
    unsigned number;
    asdic_vec3 position_m; /* world */
    double target_strength_db;
    bool moves; /* it has a track */
} asdic_point;

typedef struct asdic_movable asdic_movable; /* moving.h */

/* Hierarchies of the bottom alone, which stay when objects are taken out: of its triangles, and of those lifted
 * in the layers that a lifted view asked for last. */
typedef struct asdic_ground {
    asdic_bvh bvh;
    pthread_mutex_t lock; /* guards what follows: views are made in several threads */
    asdic_bvh lifted;
    dev_layer *layers; /* NULL: not lifted yet */
    size_t layer_count;
} asdic_ground;

struct asdic_scene {
    asdic_context *ctx;
    bool committed;
    bool is_silent; /* nobody listens: objects are not prepared for echoes */
    bool has_surface, has_bottom_plane;
    double bottom_plane_depth_m;
    size_t bottom_plane_material;
    asdic_material surface;
    asdic_material *materials;
    size_t material_count;
    asdic_part *parts;
    size_t part_count;
    asdic_point *points;
    size_t point_count;
    size_t object_count; /* parts and points with a number */
    asdic_movable *movables;
    size_t movable_count;
    /* Pending triangles before commit: world coordinates in double, 9 per triangle. */
    double *corners_m;
    uint32_t *corner_parts;
    size_t triangle_count, triangle_capacity;
    uint64_t memory_bytes; /* that there were before the first triangle */
    /* After commit: relative to origin_m, in float. */
    asdic_vec3 origin_m;
    dev_triangle *triangles;
    asdic_bvh bvh;
    size_t moving_nodes, moving_blocks; /* the first ones, see moving.h */
    uint32_t still_root;                /* child word of what stays, where something moves */
    double bend_per_m;                  /* of a lifted view (lifted.h); else 0 */
    const dev_layer *layers;            /* of a view lifted layer by layer; else NULL */
    size_t layer_count, copies;         /* ... in which each movable is there COPIES times */
    asdic_vec3 min_m, max_m;
    double build_s, hierarchy_s;
    double crease_rad; /* of parts to come */
    unsigned threads;  /* 0: one per processor */
    /* The bottom's triangles, where they are the first: their box, and, of a scene that may be
     * reopened, what is kept of them. */
    size_t ground_count;
    asdic_vec3 ground_min_m, ground_max_m;
    asdic_ground *ground; /* NULL: nothing */
    size_t built;         /* triangles that an earlier commit has placed: the ground's, or none */
};

/* How many movables in a row are one object. */
static inline size_t asdic_scene_copies(const asdic_scene *scene) {
    return scene->copies > 0 ? scene->copies : 1;
}

/* Node indices of the binary tree fit 32 bits. */
#define ASDIC_BVH_MAX_TRIANGLES 0x7fffffffu

/* Builds a hierarchy over the COUNT triangles with these IDS (NULL: 0, 1, ...) with THREADS threads
 * (0: one per processor); the result is the same for any number of them. */
asdic_status asdic_bvh_build(asdic_context *ctx, const dev_triangle *triangles, const uint32_t *ids,
                             size_t count, unsigned threads, asdic_bvh *out);
void asdic_bvh_finish(asdic_bvh *bvh);

/* Before the first commit: the bottom gets a hierarchy of its own, which asdic_scene_reopen keeps, lifted
 * (lifted.h) as well as not. Hits are the same. */
asdic_status asdic_scene_keep_ground(asdic_scene *scene);

/* Takes all objects and points out of a committed scene that keeps its ground and has one. Others
 * can be added, and the scene committed, at a cost that does not depend on the bottom. */
asdic_status asdic_scene_reopen(asdic_scene *scene);

/* Whether it can be. */
bool asdic_scene_can_reopen(const asdic_scene *scene);

/* Makes every bottom of MATERIAL, which has been checked; simulators created before keep what they
 * have. */
void asdic_scene_set_bottom(asdic_scene *scene, const asdic_material *material);

/* Makes room for MORE triangles. ASDIC_ERROR_MEMORY, before anything is allocated, where the
 * machine has no room. */
asdic_status asdic_scene_reserve(asdic_scene *scene, size_t more);

/* Height above the bottom's highest triangle within REACH_M that lies lower than POSITION_M;
 * INFINITY: none. Of a bottom that reaches above the position, the triangles below it count. */
double asdic_scene_clearance_m(const asdic_scene *scene, asdic_vec3 position_m, double reach_m);

/* Whether a pose is finite. */
asdic_status asdic_pose_check(asdic_context *ctx, const asdic_pose *pose);

#endif
