/*
 * Many intensities to decibels at once.
 */
#ifndef ASDIC_BASE_DECIBEL_H
#define ASDIC_BASE_DECIBEL_H

#include <stddef.h>

/* LEVEL_DB[i] = 10 log10(INTENSITY_LIN[i]) for COUNT values, NAN for what is no energy: zero, negative,
 * NAN, or less than DBL_MIN. Within 2e-12 dB of the exact value before it is rounded to float, and the
 * same bytes on every machine: sums, products and a quotient in a fixed order, which compilers turn
 * into vector instructions. */
void asdic_decibels(const double *intensity_lin, size_t count, float *level_db);

#endif
