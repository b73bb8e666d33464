/*
 * Random variates from a counter: a stream's numbers depend on what it was begun with, and on
 * nothing else.
 */
#ifndef ASDIC_SIM_VARIATES_H
#define ASDIC_SIM_VARIATES_H

#include <stdint.h>

typedef struct asdic_variates {
    uint32_t purpose, seed[2], index[2], cell, next;
    double spare; /* second half of the last draw; < 0: none */
} asdic_variates;

/* PURPOSE: RANDOM_... of kernels/random.h. */
asdic_variates asdic_variates_begin(uint32_t purpose, uint64_t seed, uint64_t index, uint32_t cell);

/* In (0, 1), 64 bits, so that rare events have their true probability. */
double asdic_variates_uniform(asdic_variates *v);
/* Takes two of those, unseen, where an even number of them was taken. */
void asdic_variates_skip(asdic_variates *v);
double asdic_variates_exponential(asdic_variates *v);
/* Two independent normal variates. */
void asdic_variates_normal(asdic_variates *v, double out[2]);
/* Gamma of SHAPE > 0 and mean SHAPE. */
double asdic_variates_gamma(asdic_variates *v, double shape);

/* The seed of another sequence, for what must not be drawn by the same numbers. */
static inline uint64_t asdic_other_seed(uint64_t seed) {
    return seed ^ 0x9E3779B97F4A7C15u;
}

#endif
