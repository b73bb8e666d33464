/*
 * Noise in a bin: the part of a ping that no ray brings.
 *
 * Ambient noise is less in a beam by its directivity index. What the sonar adds itself, mostly in its receivers'
 * electronics, is not (R. J. Urick, Principles of Underwater Sound (1983), chapters 3 and 11). What elements of an array
 * hear is independent: beams have the sum of their weights' squares of it, 1 / N of N even ones.
 */
#ifndef ASDIC_SIM_NOISE_LEVEL_H
#define ASDIC_SIM_NOISE_LEVEL_H

#include <asdic/ping.h>

/* RECEIVER's noise in a bin, ambient and the sonar's own: in the band, summed over the resolution cells of a bin as
 * the echoes are. Zero when switched off. */
double asdic_noise_lin(const asdic_environment *env, const asdic_sonar *sonar,
                       const asdic_beam *receiver, double sound_speed_mps);

/* An element's of the array, of which a beam holds a SHARE: the sum of its weights' squares. */
double asdic_noise_element_lin(const asdic_environment *env, const asdic_sonar *sonar, double share,
                               double sound_speed_mps);

/* Fills PING's noise component. */
void asdic_noise_levels(const asdic_environment *env, const asdic_sonar *sonar,
                        double sound_speed_mps, asdic_ping *ping);

/* The quietest receiver's noise in a bin, linear; 0 when switched off. */
double asdic_noise_least_lin(const asdic_environment *env, const asdic_sonar *sonar,
                             double sound_speed_mps);

#endif
