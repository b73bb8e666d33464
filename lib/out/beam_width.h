/*
 * How wide an aperture hears.
 */
#ifndef ASDIC_OUT_BEAM_WIDTH_H
#define ASDIC_OUT_BEAM_WIDTH_H

#include <math.h>

/* Full width between half-power points of a line of LENGTH_M, one way: the pattern sinc^2 u is a
 * half at u = 0.4429 (e.g. R. J. Urick, Principles of Underwater Sound, 3rd ed., 1983, table
 * 3.2). */
static inline double asdic_half_power_rad(double wavelength_m, double length_m) {
    return 2.0 * asin(fmin(0.442946 * wavelength_m / length_m, 1.0));
}

#endif
