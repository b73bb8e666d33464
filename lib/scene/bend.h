/*
 * How a surface bends within a facet.
 */
#ifndef ASDIC_SCENE_BEND_H
#define ASDIC_SCENE_BEND_H

#include "surface.h"

/* The tensor (x0, x1; x1, x2), 1/m, on the axes U and V of the facet's plane. */
typedef struct asdic_bend {
    asdic_vec3 u, v;
    double x[3];
} asdic_bend;

/* From how the surface's NORMALS at the facet's corners differ along its edges; exact on a ball. */
asdic_bend asdic_bend_of(const asdic_surface *surface, uint32_t facet, const asdic_vec3 normals[3]);

/* Adds WEIGHT times the tensor of M, of a facet beside it. */
void asdic_bend_add(asdic_bend *sum, double weight, const asdic_bend *m);

/* Principal curvatures without their signs, 1/m, and where the surface bends least. */
typedef struct asdic_principal {
    double least, most;
    asdic_vec3 straightest;
} asdic_principal;

asdic_principal asdic_bend_principal(const asdic_bend *bend);

/* Turn by length along WAY. */
double asdic_bend_along(const asdic_bend *bend, asdic_vec3 way);

#endif
