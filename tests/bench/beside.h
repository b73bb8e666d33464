/*
 * Rays beside Embree: scenes, sets, what either caster does with them, and the goals to reach.
 */
#ifndef TESTS_BENCH_BESIDE_H
#define TESTS_BENCH_BESIDE_H

#include "bench_rays.h"

#define BESIDE_SCENES 3 /* terrain, object, small */

asdic_status beside_scene(const bench *b, size_t index, bench_ray_scene *out);
/* Corners of all triangles, 9 per triangle, scene frame; NULL without memory. */
float *beside_corners(const bench_ray_scene *s, size_t *count);

/* The mirror rays of COUNT rays' HITS; returns how many. MIRRORED has room for COUNT. */
size_t bench_rays_mirror(const float *corners_m, const asdic_ray *rays, const asdic_ray_hit *hits,
                         size_t count, asdic_ray *mirrored);

#define BENCH_VERTEX_SEED 3
/* Rays aimed exactly at vertices, in no order; `unused` is the range of the vertex. */
void bench_rays_at_vertices(const bench_ray_scene *s, const float *corners_m, size_t triangles,
                            asdic_ray *rays, size_t count);
/* Rays of that set that met nothing up to their vertex although, by exact arithmetic on the
 * triangles there, or because. Those that met the limb behind it, where it is, are none of them. */
typedef struct bench_vertex_rays {
    size_t missed; /* although they meet the surface, and so do all lines within rounding */
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

/* Builds its hierarchy of quality "medium" with THREADS threads; *BUILD_S is what that took.
 * ROBUST: its watertight intersection. NULL when it fails. */
bench_embree *bench_embree_create(const float *corners_m, size_t triangles, unsigned threads,
                                  bool robust, double *build_s);
void bench_embree_destroy(bench_embree *e);
/* Nearest hits, on as many threads as given to create. */
void bench_embree_cast(const bench_embree *e, bench_embree_mode mode, const asdic_ray *rays,
                       size_t count, asdic_ray_hit *hits);

#endif
