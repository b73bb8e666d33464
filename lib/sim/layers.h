/*
 * The water as layers in which the sound speed is linear in depth: what rays bend in.
 */
#ifndef ASDIC_SIM_LAYERS_H
#define ASDIC_SIM_LAYERS_H

#include <asdic/expected.h>

#include <stdbool.h>

/* c = SPEED_MPS + GRADIENT_PER_S (z - ORIGIN_M), from TOP_M down to BOTTOM_M. */
typedef struct asdic_layer {
    double top_m, bottom_m; /* -INFINITY above the first, INFINITY below the last */
    double origin_m, speed_mps, gradient_per_s;
    size_t number; /* among the layers of ENV; of an image its original's */
    bool image;    /* asdic_layers_mirror */
} asdic_layer;

/* As many as a profile makes, and their images. */
#define ASDIC_MOST_LAYERS (2 * (ASDIC_PROFILE_POINTS + 1))

/* From the top down; each begins where the one before ends. Neighbours of one gradient are one, save at a mirror. */
typedef struct asdic_layers {
    size_t count; /* >= 1 */
    asdic_layer layer[ASDIC_MOST_LAYERS];
} asdic_layers;

/* What rays meet in ENV, which is checked: by env->refraction. A single layer of gradient 0 where
 * they are straight, with the speed at DEPTH_M, the sonar's. */
void asdic_layers_of(const asdic_environment *env, double depth_m, asdic_layers *out);

/* The same between the surface and the bottom of FLAT, as far as it has them: below the last layer
 * is the bottom, above the first the surface. */
void asdic_layers_between(const asdic_environment *env, const asdic_flat_scene *flat,
                          asdic_layers *out);

/* Leaves out the layers from BOTTOM_M on: the last one above it goes on without end. */
void asdic_layers_end(asdic_layers *layers, double bottom_m);

/* WATER on one side of a plane, below it or above, and its image on the other: what a ray sees that goes on straight
 * where the plane mirrors it. */
void asdic_layers_mirror(const asdic_layers *water, double plane_m, bool below, asdic_layers *out);

/* The layer that holds DEPTH_M; on a plane the upper. */
size_t asdic_layers_find(const asdic_layers *layers, double depth_m);

double asdic_layer_speed_mps(const asdic_layer *layer, double depth_m);
double asdic_layers_speed_mps(const asdic_layers *layers, double depth_m);

#endif
