/*
 * Ray throughput, inside: scenes, sets of rays, what another caster does with them.
 */
#ifndef ASDIC_CLI_BENCH_RAYS_H
#define ASDIC_CLI_BENCH_RAYS_H

#include "bench.h"

#include <asdic/rays.h>

/* ---- scenes --------------------------------------------------------------------------------- */

typedef struct bench_ray_scene {
    char name[64];
    asdic_scene *scene;
    float from_m[3];  /* the sonar, scene frame */
    float towards[3]; /* axis of the cones, unit */
} bench_ray_scene;

#define BENCH_RAY_SCENES 3 /* built in: terrain, object, small */

/* Number INDEX of the built-in ones, of fewer triangles where QUICK. */
asdic_status bench_ray_scene_make(cli *c, size_t index, bool quick, unsigned threads,
                                  bench_ray_scene *out);
/* A mesh from a file, seen from outside. */
asdic_status bench_ray_scene_load(cli *c, const char *path, unsigned threads, bench_ray_scene *out);

/* Corners of all triangles, 9 per triangle, scene frame; NULL without memory. */
float *bench_ray_scene_corners(const bench_ray_scene *s, size_t *count);

/* ---- sets of rays --------------------------------------------------------------------------- */

typedef enum bench_ray_set {
    BENCH_CONE_DENSE,      /* 20 degrees across, stratified, in Morton order of direction */
    BENCH_MIRRORED_DENSE,  /* mirror rays of its hits, in its order */
    BENCH_CONE,            /* as many rays as a ping has */
    BENCH_SPHERE_DENSE,    /* all directions, in Morton order */
    BENCH_SPHERE,          /* as many rays as a ping has */
    BENCH_SPHERE_RANDOM,   /* in no order */
    BENCH_MIRRORED_RANDOM, /* mirror rays of its hits */
    BENCH_VERTICES,        /* aimed exactly at vertices, in no order */
    BENCH_RAY_SETS
} bench_ray_set;

const char *bench_ray_set_name(bench_ray_set set);

/* Fills RAYS with COUNT rays of a set that needs no hits. */
void bench_rays_fill(bench_ray_set set, const bench_ray_scene *s, const float *corners_m,
                     size_t triangles, asdic_ray *rays, size_t count);
/* The mirror rays of COUNT rays' HITS; returns how many. MIRRORED has room for COUNT. */
size_t bench_rays_mirror(const float *corners_m, const asdic_ray *rays, const asdic_ray_hit *hits,
                         size_t count, asdic_ray *mirrored);

/* splitmix64 (Steele, Lea & Flood 2014), 0 <= x < 1. */
double bench_uniform(uint64_t *state);
/* From FROM_M along DIRECTION of any length. */
asdic_ray bench_ray_from(const float from_m[3], const double direction[3]);

/* Two unit axes across the unit vector W, and each other. */
void bench_axes_across(const float w[3], double u[3], double v[3]);

#define BENCH_VERTEX_SEED 3
/* Fills the set BENCH_VERTICES; `unused` is the range of the vertex. */
void bench_rays_at_vertices(const bench_ray_scene *s, const float *corners_m, size_t triangles,
                            asdic_ray *rays, size_t count);
/* Rays of that set that met nothing up to their vertex although, by exact arithmetic on the triangles
 * there, or because. Those that met the limb behind it, where it is, are none of them. */
typedef struct bench_vertex_rays {
    size_t
        missed; /* although they meet the surface, and so do all lines within rounding: slipped through */
    size_t grazed; /* although they meet it, but within rounding of a silhouette or a rim */
    size_t passed; /* because they pass a silhouette or a rim */
} bench_vertex_rays;

/* Zeros without memory. */
bench_vertex_rays bench_rays_judge(const float *corners_m, size_t triangles, const asdic_ray *rays,
                                   const asdic_ray_hit *hits, size_t count);

/* ---- Embree --------------------------------------------------------------------------------- */

typedef struct bench_embree bench_embree;

typedef enum bench_embree_mode {
    BENCH_EMBREE_SINGLE,   /* rtcIntersect1 */
    BENCH_EMBREE_PACKET,   /* rtcIntersect16 */
    BENCH_EMBREE_COHERENT, /* the same, rays declared coherent */
    BENCH_EMBREE_MODES
} bench_embree_mode;

/* "3.13.5"; NULL in a program that was built without it. */
const char *bench_embree_version(void);

/* Builds its hierarchy of quality "medium" with THREADS threads; *BUILD_S is what that took. ROBUST:
 * its watertight intersection. NULL when it fails. */
bench_embree *bench_embree_create(const float *corners_m, size_t triangles, unsigned threads,
                                  bool robust, double *build_s);
void bench_embree_destroy(bench_embree *e);
/* Nearest hits, on as many threads as given to create. */
void bench_embree_cast(const bench_embree *e, bench_embree_mode mode, const asdic_ray *rays,
                       size_t count, asdic_ray_hit *hits);

/* ---- results -------------------------------------------------------------------------------- */

typedef struct bench_ray_row {
    bench_ray_set set;
    size_t rays, hits;
    double goal;        /* the ratio to reach; NAN: none */
    const char *kernel; /* the form that was fastest, or was asked for */
    double ours_s;      /* medians */
    double embree_s[BENCH_EMBREE_MODES];
    size_t disagree; /* one hits, the other does not, or ranges differ by more than 1e-3 */
    bench_vertex_rays at_vertices, embree_at_vertices;
} bench_ray_row;

typedef struct bench_ray_result {
    char scene[64];
    size_t triangles, nodes;
    uint64_t bytes;
    double build_s, embree_build_s; /* the fastest of several, wall time */
    bench_ray_row rows[BENCH_RAY_SETS];
    size_t count;
} bench_ray_result;

typedef struct bench_ray_frame {
    const asdic_device_info *device;
    unsigned threads;
    const char *clock; /* "processor" time of the process, or "wall" */
} bench_ray_frame;

/* The mode of Embree that a set is compared with, and the ratio of speeds (Embree's time over ours)
 * that it should reach in the scene of that name; NAN: none. */
double bench_ray_goal(const char *scene, bench_ray_set set);
const char *bench_ray_rival(bench_ray_set set);
double bench_ray_ratio(const bench_ray_row *row);

void bench_rays_head(const bench_ray_frame *frame);
void bench_rays_print(const bench_ray_result *result);
void bench_rays_json(const bench_ray_frame *frame, const bench_ray_result *results, size_t count);
int bench_rays_csv(const cli *c, const char *path, const bench_ray_frame *frame,
                   const bench_ray_result *results, size_t count);

#endif
