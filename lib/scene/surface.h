/*
 * The surface of one part: which facets touch, and which way they face.
 */
#ifndef ASDIC_SCENE_SURFACE_H
#define ASDIC_SCENE_SURFACE_H

#include "scene.h"

/* A vertex with more corners than this is the tip of a cone, or of a broken mesh: it stays sharp. */
#define ASDIC_MOST_CORNERS 1024
/* Facets are coplanar when their normals agree to this, and their planes to this much of the part's extent. */
#define ASDIC_SAME_PLANE 1e-3
#define ASDIC_NO_FACET UINT32_MAX

typedef struct asdic_patch asdic_patch; /* patch.h */
typedef struct asdic_fold asdic_fold;   /* fold.h */

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
    uint32_t *first_fold; /* per patch, and one more: where its folds begin */
    asdic_fold *folds;
    double crease_cosine; /* of the angle from which on facets meet at an edge */
    asdic_vec3 *round;    /* 3 per facet: normals as if no patch were a face with a rounded edge */
} asdic_surface;

/* COUNT facets of a part: which touch, their sides and rims. Finish it even when this fails. */
asdic_status asdic_surface_init(asdic_context *ctx, const double *corners_m, dev_triangle *facets,
                                uint32_t count, asdic_surface *out);
void asdic_surface_finish(asdic_surface *surface);

/* The facet beyond the edge from A to B of FACET, and which WAY it has that edge; none where several have it. WAY, 0
 * before, stays so where none has it. */
uint32_t asdic_surface_beyond(const asdic_surface *surface, uint32_t facet, uint32_t a, uint32_t b,
                              int *way);

/* Two unit vectors across the unit vector N, and each other. */
void asdic_surface_axes(asdic_vec3 n, asdic_vec3 *u, asdic_vec3 *v);

double asdic_surface_area(const asdic_surface *surface, uint32_t facet);

/* How far FACET reaches along WAY, times the length of WAY. */
double asdic_surface_width(const asdic_surface *surface, uint32_t facet, asdic_vec3 way);

/* Corners that touch where one vertex is. */
typedef struct asdic_corners {
    const uint32_t *at;
    uint32_t count;
} asdic_corners;

/* Those of a vertex; none of one that stays sharp. */
static inline asdic_corners asdic_surface_around(const asdic_surface *s, uint32_t vertex) {
    uint32_t first = s->first[vertex], count = s->first[vertex + 1] - first;
    return (asdic_corners){s->touching + first, count > ASDIC_MOST_CORNERS ? 0 : count};
}

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

/* Fills NORMALS, three a facet, of a surface whose patches are found. */
asdic_status asdic_corner_normals_find(asdic_context *ctx, asdic_surface *surface,
                                       asdic_vec3 *normals);

/* Fills radii and in-phase areas of the facets of a part that stand for a curved surface, from the NORMALS of all
 * corners, three a facet. */
asdic_status asdic_surface_find_straight(asdic_context *ctx, asdic_surface *surface,
                                         const asdic_vec3 *normals);

/* Lets every facet whose open edge passes a vertex touch it with the edge's two corners: those of the two facets that
 * it would be, if cut there. OPEN has COUNT corners at which open edges begin. TOLERANCE: how far from an edge, by its
 * length. */
asdic_status asdic_surface_join(asdic_context *ctx, asdic_surface *surface, const uint32_t *open,
                                size_t count, double tolerance);

#endif
