/*
 * Truth: what each bin's energy comes from, before speckle. For labels, and for whoever checks a
 * detector. A simulator made with `truth` in its asdic_sampling fills it for pings that have it;
 * levels stay the same, byte for byte.
 */
#ifndef ASDIC_TRUTH_H
#define ASDIC_TRUTH_H

#include <asdic/common.h>

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* The ways that energy takes. Their shares of a bin sum to 1. */
typedef enum asdic_path {
    ASDIC_PATH_DIRECT,     /* echoes of bottom, surface, water and objects, once scattered */
    ASDIC_PATH_BY_SURFACE, /* multipath: reflected once by the surface, */
    ASDIC_PATH_BY_BOTTOM,  /* by the bottom, */
    ASDIC_PATH_BY_OBJECT,  /* by an object */
    ASDIC_PATH_NOISE,      /* none: noise */
    ASDIC_PATH_COUNT
} asdic_path;

ASDIC_API const char *asdic_path_name(asdic_path path); /* "direct"; never NULL */

/* Arrays [beam * bins + bin]. Objects have the numbers 1, 2, ... in the order in which the scene
 * got them, points included; in a mission, the order of the scene file. Only direct echoes count as
 * an object's: what it passes on as a mirror, or sends back by way of one, is multipath. */
typedef struct asdic_ping_truth {
    int16_t *strongest;  /* an object's number; -asdic_component for bottom, surface, volume,
                              multipath and noise; 0: the bin holds no energy */
    float *share;        /* of the strongest in the bin's energy, 0..1 */
    int16_t *object;     /* the strongest object's number, 0: none */
    float *object_share; /* its share */
    float *path[ASDIC_PATH_COUNT]; /* shares by path */
    float *depression_rad; /* from where the echo (all but water and noise) arrives: below the
                              horizontal at the sonar, by the mean sine over its energy; NAN where
                              there is no echo */
} asdic_ping_truth;

#ifdef __cplusplus
}
#endif

#endif
