/*
 * Coherence: what receivers hear in common.
 *
 * Scatterers that are many, small and independent make the pressure at a receiver a circular
 * complex Gaussian variate. Two receivers hear the same scatterers, each through its own pattern,
 * so that their pressures are correlated by
 *
 *     rho_ij = integral a_i a_j W dOmega / sqrt(integral a_i^2 W dOmega integral a_j^2 W dOmega),
 *
 * a_i the amplitude pattern of receiver i, sinc(L_H v_h) sinc(L_V v_v) with its sign, L in
 * wavelengths and v direction cosines along the sides, and W the intensity pattern of the
 * transmitter (van Cittert and Zernike: Goodman, Statistical Optics, 2000, 5.6; Mallart & Fink, J.
 * Acoust. Soc. Am. 90, 2718 (1991)). Intensities are correlated by rho^2. Two equal receivers D
 * apart in yaw, in a wide transmitter's beam: rho = sinc(L_H sin D).
 *
 * Along range bins shorter than a resolution cell c / (2 B) take in scatterers through the pulse s of
 * kernels/coherent.h, as coherent pings do. Pressures d apart are correlated by the integral of
 * s(x) s(x + d), and intensities by its square. Longer bins share nothing; of coherent pings,
 * where edges of pulses overlap, 0.016.
 *
 * Assumed: scatterers lie in all directions, and every bin has the same rho. In a bin whose echo
 * comes from one depression e alone, as from a level bottom, beams that are D apart in yaw are as
 * coherent as D cos(e), and receivers that differ in pitch hear the same stretch of bottom.
 * Ambient noise (W = 1) has a coherence of its own only where the transmitter's amplitude is below
 * 1e-3.
 */
#ifndef ASDIC_SIM_COHERENCE_H
#define ASDIC_SIM_COHERENCE_H

#include <asdic/sonar.h>

/* The integral as a sum over directions. The pressure of receiver i is the sum, over k from FIRST[i] up to
 * FIRST[i + 1], of WEIGHT[k] times an independent variate numbered SOURCE[k]. The squares of a receiver's
 * weights add up to 1; rho^2 is right to 0.04. */
typedef struct asdic_coherence {
    size_t receivers, sources;
    size_t *first;
    uint32_t *source;
    float *weight;
} asdic_coherence;

asdic_status asdic_coherence_init(asdic_coherence *c, asdic_context *ctx, const asdic_sonar *sonar,
                                  double wavelength_m);
void asdic_coherence_finish(asdic_coherence *c);

#endif
