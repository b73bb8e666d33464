/*
 * Speckle: from expected intensities to one random realisation.
 */
#ifndef ASDIC_SIM_SPECKLE_H
#define ASDIC_SIM_SPECKLE_H

#include <asdic/ping.h>

typedef struct asdic_speckle_field asdic_speckle_field;

/* For pings of BINS bins, by THREADS threads at most; the receivers' coherence is that at SOUND_SPEED_MPS. A sonar
 * without speckle gives *OUT NULL, which asdic_speckle_apply accepts. */
asdic_status asdic_speckle_create(asdic_context *ctx, const asdic_sonar *sonar,
                                  double sound_speed_mps, size_t bins, unsigned threads,
                                  asdic_speckle_field **out);
void asdic_speckle_destroy(asdic_speckle_field **field);

/* Replaces the total of every bin by one realisation: the mean of as many exponential intensities
 * (Rayleigh amplitudes) as the bin has looks, coherent over beams and range as coherence.h has it.
 * For K a gamma-distributed texture of shape nu, common to the looks, modulates what bottom,
 * surface and water scatter; objects, multipath and noise have none (Ward, Tough & Watts, Sea
 * Clutter, 2006). Beams that share speckle share the texture: it is a further look, its intensity
 * mapped to the gamma law. Components stay expected values. The numbers depend on sonar, bins,
 * seed and ping index, not on threads. */
void asdic_speckle_apply(asdic_speckle_field *field, double sound_speed_mps, uint64_t seed,
                         uint64_t index, asdic_ping *ping);

#endif
