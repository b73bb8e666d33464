/*
 * Speckle: from expected intensities to one random realisation.
 */
#ifndef ASDIC_SIM_SPECKLE_H
#define ASDIC_SIM_SPECKLE_H

#include <asdic/detect.h>

/* Replaces the total of every bin by one realisation: the mean of as many exponential intensities
 * (Rayleigh amplitudes) as the bin has looks. For K a gamma-distributed texture of shape nu, common
 * to the looks, modulates what bottom, surface and water scatter; objects and noise have none (Ward,
 * Tough & Watts, Sea Clutter, 2006). Bins shorter than a resolution cell share what it draws.
 * Components stay expected values. The numbers depend on (seed, ping index, beam, bin or cell). */
void asdic_speckle_apply(const asdic_sonar *sonar, double sound_speed_mps, uint64_t seed,
                         uint64_t index, asdic_ping *ping);

/* One bin of LAW, whose mean_lin has texture, and FIXED_LIN, which has none; noise_share is not
 * read. */
double asdic_speckle_draw(const asdic_background *law, double fixed_lin, uint64_t seed,
                          uint64_t index, uint32_t cell);

#endif
