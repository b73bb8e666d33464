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

/* A ray in the scene frame; direction of unit length. t_max <= 0: skip, no hit. */
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
    dev_uint rims;  /* bit k: the mesh bends back at the edge from corner k on; 3 + k: forward */
    dev_uint pad;
} dev_triangle; /* 80 bytes */

/* In the first of corner_normals: the facet is flat and its own normal holds everywhere. */
#define DEV_FLAT 0x80008000u

/* One mesh placed in the scene: what it is and how it scatters. */
typedef struct dev_part {
    dev_uint kind;      /* DEV_KIND_BOTTOM or DEV_KIND_OBJECT */
    dev_uint material;  /* index of dev_material */
    float size_m2;      /* square of its largest extent */
    dev_uint truth_row; /* of an object, see truth.h */
} dev_part;             /* 16 bytes */

/* How the device computes a law: by one of three formulas, or from a table (law_table.h). */
#define DEV_LAW_TABLE 0
#define DEV_LAW_SEARAY 1 /* bottom of backscatter.h */
#define DEV_LAW_FACET 2  /* rough facet of target.h */
#define DEV_LAW_COURSE 3 /* surface of backscatter.h */

/* A scattering law at the sonar's frequency, computed on the host in double. Behind the materials, in
 * the same buffer, lie their tables. */
typedef struct dev_material {
    dev_uint law;
    float formula[4];    /* SEARAY: bt, gain, peak; FACET: mean-square slope, area that reflects in
                            phase (0: what the facet says); COURSE: gain, beta0, beta1, cap */
    float reflection2;   /* FACET, COURSE: R^2 */
    float roughness_g;   /* formulas: 4 k^2 s^2 */
    float density_ratio; /* of a fluid bottom: over that of water; else 0 */
    float index;         /* of a fluid bottom: sound speed of water over its own */
    dev_uint strength;   /* TABLE: where it begins, in words from the first material; 0: silent */
    dev_uint reflected;  /* the same of the share that is reflected; 0: nothing */
    float loss_ratio;    /* of a fluid bottom: imaginary over real wave number */
} dev_material;          /* 48 bytes */

/* Half the width that a ray has, relative to the largest coordinate in play: 8 units in the last
 * place, twice what the roundings in shear, box test and 1 / direction add up to (intersect.h). */
#define TRACE_SKIN 4.76837158e-7f /* 2^-21 */

typedef struct dev_hit {
    float t_m;         /* INFINITY: none */
    dev_uint triangle; /* ~0u: none */
} dev_hit;

#endif
