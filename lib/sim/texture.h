/*
 * The texture of K-distributed speckle: a unit exponential variate to a gamma variate of unit mean.
 */
#ifndef ASDIC_SIM_TEXTURE_H
#define ASDIC_SIM_TEXTURE_H

#include <asdic/common.h>

/* Shapes that the table is right for: spikier has no use, and higher is Rayleigh's. */
#define ASDIC_SHAPE_LEAST 0.05
#define ASDIC_SHAPE_MOST 1000.0

typedef struct asdic_texture {
    double *log_texture; /* at equal steps of ln of the exponential */
} asdic_texture;

/* For gamma variates of SHAPE. False: no memory. */
bool asdic_texture_init(asdic_texture *t, double shape);
void asdic_texture_finish(asdic_texture *t);

/* The texture that is exceeded as often as EXPONENTIAL: with probability e^-EXPONENTIAL. Right to
 * 1e-3; EXPONENTIAL is at most 50. */
double asdic_texture_of(const asdic_texture *t, double exponential);

#endif
