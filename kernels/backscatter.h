/*
 * Backscattering strengths of bottom, surface and volume, linear per steradian (1/sr; the volume's
 * 1/(sr m)). What depends on the scene alone (gain, peak, beta, cap) is computed once on the host;
 * what is left per ray takes the sine of the grazing angle, never the angle: tan(asin(s)) in single
 * precision is negative at 90 degrees. Every function is finite for SIN_GRAZING in [0, 1], ends
 * included, and clamps what rounding put outside.
 */
#ifndef ASDIC_KERNEL_BACKSCATTER_H
#define ASDIC_KERNEL_BACKSCATTER_H

#include "real.h"

/* Bottom: SEARAY model, as taught by D. Kraus (Hochschule Bremen) and printed in the paper:
 *
 *     S_B = 10 log10(3.03 beta f^(3.2 - 0.8 bt) 10^(2.8 bt - 12) + 10^-4.42)  dB re 1 m^2/m^2
 *     beta = gamma (sin Theta + 0.19)^(bt cos^16 Theta)
 *     gamma = 1 + 125 exp(-2.64 (bt - 1.75)^2 - (50 / bt) cot^2 Theta)
 *
 * bt 1 mud, 2 sand, 3 gravel, 4 rock, fractions allowed; f in kHz. No range is published: 50..400
 * kHz are plotted in the course, the four types meet at 3162 kHz. Rock exceeds a white Lambert
 * surface by 7 dB at 20..30 degrees; kept as published. */
FORMULA real bottom_gain(real bt, real f_khz) {
    return R(3.03) * r_exp10((R(3.2) - R(0.8) * bt) * log10(f_khz) + R(2.8) * bt - R(12.0));
}

FORMULA real bottom_peak(real bt) {
    return R(125.0) * exp(R(-2.64) * (bt - R(1.75)) * (bt - R(1.75)));
}

/* 10^-4.42: what is left at grazing incidence. */
#define BOTTOM_FLOOR R(3.80189396320561e-5)

FORMULA real bottom_backscatter_lin(real gain, real peak, real bt, real sin_grazing) {
    real s = r_min(r_max(sin_grazing, R(1.0e-9)), R(1.0));
    real cos2 = (R(1.0) - s) * (R(1.0) + s);
    real gamma = R(1.0) + peak * exp(R(-50.0) / bt * (cos2 / (s * s)));
    real cos4 = cos2 * cos2;
    real cos8 = cos4 * cos4;
    real beta = gamma * exp(bt * cos8 * cos8 * log(s + R(0.19)));
    return gain * beta + BOTTOM_FLOOR;
}

/* Surface: course of D. Kraus, as printed in the paper; wind v in knots, f in kHz:
 *
 *     S_S = 10 log10(10^-5.05 (1 + v)^2 (f + 0.1)^(v / 150) tan^beta Theta)  dB re 1 m^2/m^2
 *     beta = 4 (v + 2) / (v + 1) + (2.5 (f + 0.1)^(-1/3) - 4) cos^(1/8) Theta
 *
 * It grows without bound towards 90 degrees (its integral over a bin that holds the zenith is
 * infinite), so it is capped by the geometric-optics return of a rough mirror at normal incidence,
 * 1 / (4 pi m), with the mean-square slope m = 0.003 + 0.00512 U of Cox & Munk, J. Opt. Soc. Am.
 * 44, 838 (1954), U in m/s. The cap acts above 88.3 degrees at 10 kn, 81.7 at 40 kn. Agrees with
 * Chapman & Harris, JASA 34, 1592 (1962), to 0..2.9 dB at 20 kn, 1..6.4 kHz and 5..20 degrees, to
 * 5.1 dB up to 40. */
FORMULA real surface_gain(real wind_kn, real f_khz) {
    real v1 = R(1.0) + wind_kn;
    return R(8.91250938133746e-6) * v1 * v1 * r_exp10(wind_kn / R(150.0) * log10(f_khz + R(0.1)));
}

FORMULA real surface_beta0(real wind_kn) {
    return R(4.0) * (wind_kn + R(2.0)) / (wind_kn + R(1.0));
}

FORMULA real surface_beta1(real f_khz) {
    return R(2.5) / cbrt(f_khz + R(0.1)) - R(4.0);
}

#ifdef __OPENCL_C_VERSION__
#define LARGEST_EXPONENT R(80.0)
#else
#define LARGEST_EXPONENT 700.0
#endif

/* 1 kn = 1852/3600 m/s. */
FORMULA real surface_cap_lin(real wind_kn) {
    real slope_ms = R(0.003) + R(0.00512) * (wind_kn * R(0.514444444444444));
    return R(1.0) / (R(4.0) * R_PI * slope_ms);
}

/* COS2 is the squared cosine of the grazing angle. CAP_LIN INFINITY: uncapped, as printed, short
 * of what overflows. */
FORMULA real surface_backscatter_angle_lin(real gain, real beta0, real beta1, real cap_lin,
                                           real sin_grazing, real cos2) {
    real s = r_min(r_max(sin_grazing, R(1.0e-30)), R(1.0));
    real c2 = r_max(cos2, R(1.0e-30));
    real cos_eighth = sqrt(sqrt(sqrt(sqrt(c2)))); /* cos^(1/8), from the squared cosine */
    real log_tan = log(s) - R(0.5) * log(c2);
    real uncapped = gain * exp(r_min((beta0 + beta1 * cos_eighth) * log_tan, LARGEST_EXPONENT));
    return choose(sin_grazing > R(0.0), r_min(uncapped, cap_lin), R(0.0));
}

FORMULA real surface_backscatter_lin(real gain, real beta0, real beta1, real cap_lin,
                                     real sin_grazing) {
    real cos2 = (R(1.0) - sin_grazing) * (R(1.0) + sin_grazing);
    return surface_backscatter_angle_lin(gain, beta0, beta1, cap_lin, sin_grazing, cos2);
}

/* Volume: S_V = S_p + 7 log10 f, dB re 1/m (course of D. Kraus, as printed in the paper); S_p is
 * -90 (low), -70 (moderate) or -50 (high particle density), f in kHz. */
FORMULA real volume_backscatter_db(real sp_db, real f_khz) {
    return sp_db + R(7.0) * log10(f_khz);
}

#endif
