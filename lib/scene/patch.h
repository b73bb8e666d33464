/*
 * The surface of one part: which facets touch, and the flat patches they form.
 */
#ifndef ASDIC_SCENE_PATCH_H
#define ASDIC_SCENE_PATCH_H

#include "scene.h"

/* A vertex with more corners than this is the tip of a cone, or of a broken mesh: it stays sharp. */
#define ASDIC_MOST_CORNERS 1024

/* Facets that meet at a sharper angle than 35 degrees meet at an edge; below it they stand for one
 * curved surface. A round body of 16 facets turns by 32 from one to the next but one. */
#define ASDIC_CREASE_COSINE 0.819

/* Touching facets in one plane, or so nearly that rounded coordinates tell the difference. */
typedef struct asdic_patch {
    double area_m2;
    double length2_m2;  /* square of its length: of a rectangle's longer side */
    double breadth2_m2; /* of the shorter one */
    asdic_vec3 along;   /* unit, along its length */
    asdic_vec3 normal;  /* of what is nearly in a plane; 0: each facet's own */
} asdic_patch;

typedef struct asdic_surface {
    const double *corners_m; /* 9 per facet, world */
    dev_triangle *facets;
    uint32_t count;
    uint32_t *vertex; /* 3 per facet: the lowest corner where this one is */
    uint32_t *first;  /* 3 * count + 1: where a vertex' corners begin in touching */
    uint32_t *
        touching; /* corners by vertex; then both ends of every open edge on which the vertex lies */
    int8_t *side;    /* per facet: 1 as it is wound, -1 the other way; neighbours then agree */
    uint32_t *patch; /* per facet */
    asdic_patch *patches;
    const asdic_vec3
        *round;        /* 3 per facet: normals as if no patch were a face with a rounded edge */
    const bool *whole; /* by vertex: all facets there are of one curved surface */
} asdic_surface;

/* COUNT facets of a part: which touch, their sides and rims. Finish it even when this fails. */
asdic_status asdic_surface_init(asdic_context *ctx, const double *corners_m, dev_triangle *facets,
                                uint32_t count, asdic_surface *out);

/* The patches, of a part whose extent is SIZE_M. */
asdic_status asdic_surface_find_patches(asdic_context *ctx, double size_m, asdic_surface *surface);
void asdic_surface_finish(asdic_surface *surface);

/* How far it reaches along WAY, in its plane, times the length of WAY. */
double asdic_patch_width(const asdic_patch *patch, asdic_vec3 way);

/* Two unit vectors across the unit vector N, and each other. */
void asdic_surface_axes(asdic_vec3 n, asdic_vec3 *u, asdic_vec3 *v);

double asdic_surface_area(const asdic_surface *surface, uint32_t facet);

static inline asdic_vec3 asdic_surface_corner(const asdic_surface *s, size_t corner) {
    const double *v = &s->corners_m[3 * corner];
    return (asdic_vec3){v[0], v[1], v[2]};
}

/* To the same side as its neighbours', however it is wound. */
static inline asdic_vec3 asdic_surface_normal(const asdic_surface *s, size_t facet) {
    const float *n = s->facets[facet].normal;
    float side = (float)s->side[facet];
    return (asdic_vec3){side * n[0], side * n[1], side * n[2]};
}

#endif
