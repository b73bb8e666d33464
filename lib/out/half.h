/*
 * IEEE 754 binary16: dB of 64 to 128 within 0.03 dB.
 */
#ifndef ASDIC_OUT_HALF_H
#define ASDIC_OUT_HALF_H

#include <stddef.h>
#include <stdint.h>

/* The nearest of each; NAN stays NAN. */
void asdic_halves_of(const float *values, size_t count, uint16_t *halves);
void asdic_half_values(const uint16_t *halves, size_t count, float *values);

#endif
