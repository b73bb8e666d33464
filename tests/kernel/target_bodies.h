/*
 * Bodies as meshes of their own, made without the library's primitives: discs, ellipsoids without
 * poles, cylinders and plates cut unevenly. Facets share no vertices, as an STL file gives them.
 */
#ifndef ASDIC_TEST_TARGET_BODIES_H
#define ASDIC_TEST_TARGET_BODIES_H

#include "asserts.h"

#include <asdic/asdic.h>

#include <stdlib.h>

#define BODY_PI 3.14159265358979323846

/* Triangles with vertices of their own. */
typedef struct soup {
    double *v;
    uint32_t *f;
    size_t vertices, facets;
    const double *size_m;
} soup;

static inline soup soup_create(size_t most_facets, const double *size_m) {
    return (soup){malloc(9 * most_facets * sizeof(double)),
                  malloc(3 * most_facets * sizeof(uint32_t)), 0, 0, size_m};
}

static inline asdic_mesh *soup_mesh(asdic_context *ctx, soup *s) {
    asdic_mesh *mesh = NULL;
    assert_ok(ctx, asdic_mesh_from_triangles(ctx, s->v, s->vertices, s->f, s->facets, &mesh));
    free(s->v);
    free(s->f);
    return mesh;
}

static inline void soup_facet(soup *s, const double a[3], const double b[3], const double c[3]) {
    const double *corner[3] = {a, b, c};
    for (int i = 0; i < 3; i++) {
        memcpy(s->v + 3 * s->vertices, corner[i], 3 * sizeof(double));
        s->f[3 * s->facets + i] = (uint32_t)s->vertices++;
    }
    s->facets++;
}

/* A regular polygon of SEGMENTS corners with the area of a disc, its normal along x. */
static inline asdic_mesh *body_disc(asdic_context *ctx, double radius_m, unsigned segments) {
    soup s = soup_create(segments, NULL);
    double corner_m = radius_m * sqrt(BODY_PI / (0.5 * segments * sin(2.0 * BODY_PI / segments)));
    const double middle[3] = {0.0, 0.0, 0.0};
    for (unsigned i = 0; i < segments; i++) {
        double at = 2.0 * BODY_PI * i / segments, next = 2.0 * BODY_PI * (i + 1) / segments;
        double a[3] = {0.0, corner_m * cos(at), corner_m * sin(at)};
        double b[3] = {0.0, corner_m * cos(next), corner_m * sin(next)};
        soup_facet(&s, middle, a, b);
    }
    return soup_mesh(ctx, &s);
}

/* A point of the unit sphere, stretched. */
static inline void soup_round(const soup *s, const double p[3], double out[3]) {
    double length = sqrt(p[0] * p[0] + p[1] * p[1] + p[2] * p[2]);
    for (int k = 0; k < 3; k++) {
        out[k] = s->size_m[k] * p[k] / length;
    }
}

static inline void soup_split(soup *s, const double a[3], const double b[3], const double c[3],
                              unsigned levels) {
    double ab[3], bc[3], ca[3];
    if (levels == 0) {
        soup_round(s, a, ab);
        soup_round(s, b, bc);
        soup_round(s, c, ca);
        soup_facet(s, ab, bc, ca);
        return;
    }
    for (int k = 0; k < 3; k++) {
        ab[k] = 0.5 * (a[k] + b[k]);
        bc[k] = 0.5 * (b[k] + c[k]);
        ca[k] = 0.5 * (c[k] + a[k]);
    }
    soup_split(s, a, ab, ca, levels - 1);
    soup_split(s, b, bc, ab, levels - 1);
    soup_split(s, c, ca, bc, levels - 1);
    soup_split(s, ab, bc, ca, levels - 1);
}

/* Half-axes along x, y, z; from the octahedron by halving edges LEVELS times. */
static inline asdic_mesh *body_ellipsoid(asdic_context *ctx, const double size_m[3],
                                         unsigned levels) {
    soup s = soup_create((size_t)8 << (2 * levels), size_m);
    for (int octant = 0; octant < 8; octant++) {
        double x[3] = {octant & 1 ? -1.0 : 1.0, 0.0, 0.0};
        double y[3] = {0.0, octant & 2 ? -1.0 : 1.0, 0.0};
        double z[3] = {0.0, 0.0, octant & 4 ? -1.0 : 1.0};
        bool flipped = (octant & 1) ^ (octant >> 1 & 1) ^ (octant >> 2 & 1);
        soup_split(&s, x, flipped ? z : y, flipped ? y : z, levels);
    }
    return soup_mesh(ctx, &s);
}

/* The half of a ball that is farther along x, or nearer: a bowl or a dome for whoever looks along it. */
static inline asdic_mesh *body_half_ball(asdic_context *ctx, double radius_m, unsigned levels,
                                         bool is_bowl) {
    const double size_m[3] = {radius_m, radius_m, radius_m};
    soup s = soup_create((size_t)4 << (2 * levels), size_m);
    for (int quarter = 0; quarter < 4; quarter++) {
        double x[3] = {is_bowl ? 1.0 : -1.0, 0.0, 0.0};
        double y[3] = {0.0, quarter & 1 ? -1.0 : 1.0, 0.0};
        double z[3] = {0.0, 0.0, quarter & 2 ? -1.0 : 1.0};
        soup_split(&s, x, y, z, levels);
    }
    return soup_mesh(ctx, &s);
}

/* Uneven division of [-1/2, 1/2] into STEPS. */
static inline double uneven(unsigned i, unsigned steps) {
    double x = (double)i / steps;
    return x - 0.5 + 0.08 * sin(2.0 * BODY_PI * x) + 0.3 / steps * sin(12.0 * BODY_PI * x);
}

/* Two triangles of a curved or flat cell. */
static inline void soup_cell(soup *s, double corner[2][2][3], bool other) {
    if (other) {
        soup_facet(s, corner[0][0], corner[1][0], corner[1][1]);
        soup_facet(s, corner[0][0], corner[1][1], corner[0][1]);
    } else {
        soup_facet(s, corner[0][0], corner[1][0], corner[0][1]);
        soup_facet(s, corner[1][0], corner[1][1], corner[0][1]);
    }
}

/* WIDTH along y, HEIGHT along z, STEPS x STEPS uneven cells, the normal along x. */
static inline asdic_mesh *body_plate(asdic_context *ctx, double width_m, double height_m,
                                     unsigned steps) {
    soup s = soup_create((size_t)2 * steps * steps, NULL);
    for (unsigned i = 0; i < steps; i++) {
        for (unsigned j = 0; j < steps; j++) {
            double corner[2][2][3];
            for (unsigned k = 0; k < 4; k++) {
                double *p = corner[k / 2][k % 2];
                p[0] = 0.0;
                p[1] = width_m * uneven(i + k / 2, steps);
                p[2] = height_m * uneven(j + k % 2, steps);
            }
            soup_cell(&s, corner, (i + j) % 2);
        }
    }
    return soup_mesh(ctx, &s);
}

/* An open tube along y, SEGMENTS round, cut unevenly into STEPS lengths. */
static inline asdic_mesh *body_tube(asdic_context *ctx, double radius_m, double length_m,
                                    unsigned segments, unsigned steps) {
    soup s = soup_create((size_t)2 * segments * steps, NULL);
    for (unsigned i = 0; i < segments; i++) {
        for (unsigned j = 0; j < steps; j++) {
            double corner[2][2][3];
            for (unsigned k = 0; k < 4; k++) {
                double at = 2.0 * BODY_PI * (i + k / 2) / segments, *p = corner[k / 2][k % 2];
                p[0] = radius_m * cos(at);
                p[1] = length_m * uneven(j + k % 2, steps);
                p[2] = radius_m * sin(at);
            }
            soup_cell(&s, corner, (i + j) % 2);
        }
    }
    return soup_mesh(ctx, &s);
}

#endif
