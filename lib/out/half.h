/*
 * IEEE 754 binary16: dB of 64 to 128 within 0.03 dB.
 */
#ifndef ASDIC_OUT_HALF_H
#define ASDIC_OUT_HALF_H

#include <stdint.h>

/* The nearest; NAN stays NAN. */
uint16_t asdic_half_of(float value);
float asdic_half_value(uint16_t half);

#endif
