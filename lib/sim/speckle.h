/*
 * Speckle: from expected intensities to one random realisation, and the pulse's length in range.
 */
#ifndef ASDIC_SIM_SPECKLE_H
#define ASDIC_SIM_SPECKLE_H

#include <asdic/ping.h>

/* Spreads every component's energy over a resolution cell c / (2 B), centred, when that is longer
 * than a bin; nothing to do otherwise: a bin then holds whole cells, and what leaks over its edges
 * is at most half a cell's share. Stated errors follow the energy. Noise is the same in every bin.
 * SCRATCH: 3 * bins + 1. */
void asdic_pulse_smear(const asdic_sonar *sonar, double sound_speed_mps, double *scratch,
                       asdic_ping *ping);

/* Multiplies the total of every bin by a random factor of mean 1: the sum over the bin's resolution
 * cells of exponential intensities (Rayleigh amplitudes), with a gamma-distributed mean of shape nu
 * for K. Components stay expected values. The numbers depend on (seed, ping index, beam, bin). */
void asdic_speckle_apply(const asdic_sonar *sonar, double sound_speed_mps, uint64_t seed,
                         uint64_t index, asdic_ping *ping);

/* The factor itself, for statistics: CELLS >= 1 resolution cells in the bin. */
double asdic_speckle_factor(asdic_speckle kind, double shape, double cells, uint64_t seed,
                            uint64_t index, uint32_t cell);

#endif
