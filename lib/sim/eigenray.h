/*
 * The rays between two places in layered water: found by launch elevation, since all else of a ray follows from it.
 *
 * At a fixed horizontal distance a ray's depth is a function of its launch elevation that is smooth between the
 * elevations at which rays graze a layer's plane, and has its extremes where the width of a tube of rays is 0.
 * Stretches between those are searched for a change of sign, which is then halved. Where depth jumps, at the edge
 * of a shadow, there is no ray.
 */
#ifndef ASDIC_SIM_EIGENRAY_H
#define ASDIC_SIM_EIGENRAY_H

#include "bent_ray.h"

/* Of more rays between two places those of the least spreading are kept. */
#define ASDIC_MOST_EIGENRAYS 128
/* Legs of one ray, at most. */
#define ASDIC_MOST_EIGENRAY_LEGS 256

typedef struct asdic_eigenray {
    double elevation_rad; /* at launch, positive down */
    asdic_bent_ray end;
} asdic_eigenray;

/* Rays from FROM_M deep to TO_M deep, ACROSS_M away horizontally, that of the least spreading first; returns how many. */
size_t asdic_eigenrays_find(const asdic_layers *layers, double from_m, double to_m, double across_m,
                            asdic_eigenray found[ASDIC_MOST_EIGENRAYS]);

/* The ray of ELEVATION_RAD where it is ACROSS_M away, more than a micrometre; NAN deep if it never comes there. */
asdic_bent_ray asdic_eigenray_end(const asdic_layers *layers, double from_m, double across_m,
                                  double elevation_rad);

/* Where a leg of a ray ends, in layer LAYER; it begins where the one before ends. */
typedef struct asdic_eigenray_leg {
    size_t layer;
    double across_m, z_m;
} asdic_eigenray_leg;

/* The legs of RAY, which asdic_eigenrays_find found; returns how many. */
size_t asdic_eigenray_legs(const asdic_layers *layers, double from_m, double across_m,
                           const asdic_eigenray *ray,
                           asdic_eigenray_leg legs[ASDIC_MOST_EIGENRAY_LEGS]);

/* Whether RAY keeps between TOP_M and BOTTOM_M on its way, its end included, which may lie on either: to within a
 * millimetre, as rays are found. */
bool asdic_eigenray_keeps_between(const asdic_layers *layers, double from_m, double across_m,
                                  const asdic_eigenray *ray, double top_m, double bottom_m);

/* From the highest to the deepest place of RAY; INFINITY where it turns less than twice. */
double asdic_eigenray_swing_m(const asdic_layers *layers, double from_m, double across_m,
                              const asdic_eigenray *ray);

#endif
