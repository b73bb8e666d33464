/*
 * Structs shared by host and device, bit for bit: no float3, no pointers, no bool, sizes checked
 * by tests/kernel. All lengths in metres in the scene frame (world axes, recentred), energies
 * linear.
 */
#ifndef ASDIC_KERNEL_TYPES_H
#define ASDIC_KERNEL_TYPES_H

#ifndef __OPENCL_C_VERSION__
#include <stdint.h>
typedef uint32_t dev_uint;
typedef int32_t dev_int;
#else
typedef uint dev_uint;
typedef int dev_int;
#endif

/* What a ray can meet; also the deposit component of a direct echo. */
#define DEV_KIND_NONE 0
#define DEV_KIND_BOTTOM 1
#define DEV_KIND_SURFACE 2
#define DEV_KIND_OBJECT 3

#define DEV_BVH_WIDTH 8
#define DEV_LEAF_TRIANGLES 4

/* Child word: inner node: index of the node; leaf: DEV_LEAF | index of its block; absent:
 * DEV_EMPTY with an inverted box (lo above hi), which no ray enters. */
#define DEV_LEAF 0x80000000u
#define DEV_EMPTY 0xffffffffu

typedef struct dev_node8 {
    float lo_x[8], hi_x[8], lo_y[8], hi_y[8], lo_z[8], hi_z[8];
    dev_uint child[8];
    dev_uint pad[8];
} dev_node8; /* 256 bytes */

/* Four triangles, structure of arrays: v[3 * corner + axis][lane]. Corners, not edges: two
 * triangles that share a corner then compute the same bits for it, which is what makes the
 * intersection watertight. Unused lanes have three equal corners (never hit) and id ~0u. */
typedef struct dev_block4 {
    float v[9][4];
    dev_uint id[4]; /* index into the scene's triangles */
} dev_block4;       /* 160 bytes */

/* A triangle's box is that of its corners, grown on all sides by this share of its extent: room for the
 * tolerance of intersect.h, by which triangles are met beyond their edges (twice 1e-4 at a corner). A
 * power of two, so that host and device compute the same bits, whether they fuse products or not. */
#define DEV_BOX_MARGIN 2.44140625e-4f /* 2^-12 */

/* A ray in the scene frame; direction of unit length. t_max_m <= 0: skip, no hit. */
typedef struct dev_ray {
    float origin[3];
    float t_max;
    float direction[3];
    dev_uint source; /* whatever it was made from; for who made it */
} dev_ray;           /* 32 bytes */

/* Per triangle id: corners, unit normal, part index, and how it goes on beyond its edges. */
typedef struct dev_triangle {
    float v0[3], v1[3], v2[3];
    float normal[3];            /* unit, as wound */
    dev_uint part;              /* index of dev_part */
    dev_uint corner_normals[3]; /* of the curved surface it stands for (smooth.h), or DEV_FLAT */
    float flat_m2;  /* flat area that reflects in phase; of a curved surface the square of its
                        straight length */
    float radius_m; /* larger radius of curvature; 0: flat or straight one way */
    dev_uint pad[2];
} dev_triangle; /* 80 bytes */

/* In the first of corner_normals: the facet is flat and its own normal holds everywhere. */
#define DEV_FLAT 0x80008000u

/* One mesh placed in the scene: what it is and how it scatters. */
typedef struct dev_part {
    dev_uint kind;     /* DEV_KIND_BOTTOM or DEV_KIND_OBJECT */
    dev_uint material; /* index of dev_material */
    float size_m2;     /* square of its largest extent */
    dev_uint pad;
} dev_part; /* 16 bytes */

#define DEV_LAW_BOTTOM 0
#define DEV_LAW_FACET 1

/* Coefficients of a scattering law at the sonar's frequency, computed on the host in double. */
typedef struct dev_material {
    dev_uint law;
    float bottom_type;      /* LAW_BOTTOM: bt */
    float bottom_gain;      /* LAW_BOTTOM: 3.03 f^(3.2 - 0.8 bt) 10^(2.8 bt - 12) */
    float bottom_peak;      /* LAW_BOTTOM: 125 exp(-2.64 (bt - 1.75)^2) */
    float reflection2;      /* LAW_FACET: R^2 */
    float roughness_g;      /* 4 k^2 s^2 */
    float slope_ms;         /* LAW_FACET: mean-square slope of the roughness */
    float coherent_area_m2; /* LAW_FACET: A_coh; 0: what the facet says */
    float density_ratio;    /* LAW_BOTTOM: over that of water */
    float index;            /* LAW_BOTTOM: sound speed of water over that of the bottom */
    dev_uint pad[2];
} dev_material; /* 48 bytes */

typedef struct dev_hit {
    float t_m;         /* INFINITY: none */
    dev_uint triangle; /* ~0u: none */
} dev_hit;

#endif
