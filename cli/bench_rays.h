/*
 * Ray throughput, inside: scenes and sets of rays, which tests/bench/ uses too.
 */
#ifndef ASDIC_CLI_BENCH_RAYS_H
#define ASDIC_CLI_BENCH_RAYS_H

#include "bench.h"

#include <asdic/rays.h>

/* ---- scenes --------------------------------------------------------------------------------- */

typedef struct bench_ray_scene {
    char name[64];
    asdic_scene *scene; /* destroyed by the caller, also on failure */
    float from_m[3];    /* the sonar, scene frame */
    float towards[3];   /* axis of the cones, unit */
} bench_ray_scene;

/* A rough floor of a million triangles, of fewer in a quick bench. */
asdic_status bench_ray_scene_terrain(const bench *b, bench_ray_scene *out);
/* A mesh from a file, seen from outside. */
asdic_status bench_ray_scene_load(const bench *b, const char *path, bench_ray_scene *out);

/* A scene of MESH as bottom; and the sonar at world position AT_M, its cones PITCH_RAD down. */
asdic_status bench_ray_scene_commit(const bench *b, const asdic_mesh *mesh, asdic_scene **out);
void bench_ray_scene_look(bench_ray_scene *s, asdic_vec3 at_m, double pitch_rad);

/* ---- sets of rays --------------------------------------------------------------------------- */

typedef enum bench_ray_set {
    BENCH_CONE_DENSE,    /* 20 degrees across, stratified, in Morton order of direction */
    BENCH_CONE,          /* as many rays as a ping has */
    BENCH_SPHERE_DENSE,  /* all directions, in Morton order */
    BENCH_SPHERE,        /* as many rays as a ping has */
    BENCH_SPHERE_RANDOM, /* in no order */
    BENCH_RAY_SETS
} bench_ray_set;

const char *bench_ray_set_name(bench_ray_set set);
bool bench_ray_set_is_few(bench_ray_set set);

void bench_rays_fill(bench_ray_set set, const bench_ray_scene *s, asdic_ray *rays, size_t count);

/* splitmix64 (Steele, Lea & Flood 2014), 0 <= x < 1. */
double bench_uniform(uint64_t *state);
/* From FROM_M along DIRECTION of any length. */
asdic_ray bench_ray_from(const float from_m[3], const double direction[3]);
/* Two unit axes across the unit vector W, and each other. */
void bench_axes_across(const float w[3], double u[3], double v[3]);

/* ---- effort --------------------------------------------------------------------------------- */

#define BENCH_MOST_REPEATS 25

typedef struct bench_ray_effort {
    size_t dense, few; /* rays of a set */
    size_t dense_repeats, few_repeats;
} bench_ray_effort;

bench_ray_effort bench_ray_effort_of(const bench *b);

/* Of the processor where one thread of it is the device, else on the wall. */
double bench_ray_clock_s(const bench *b);

#endif
