/*
 * Boundaries as mirrors: how much of what arrives at the bottom or the surface goes on in the mirror
 * direction. Objects: mirror_share in target.h.
 */
#ifndef ASDIC_KERNEL_MIRROR_H
#define ASDIC_KERNEL_MIRROR_H

#include "target.h"

/* Energy reflection of a smooth fluid bottom, |R|^2 of Rayleigh's coefficient
 *
 *     R = (m sin Theta - sqrt(n^2 - cos^2 Theta)) / (m sin Theta + sqrt(n^2 - cos^2 Theta))
 *
 * m density over that of water, n sound speed of water over that of the bottom; 1 below the critical
 * angle cos Theta = n (L. M. Brekhovskikh, Yu. P. Lysanov, "Fundamentals of Ocean Acoustics", 3rd ed.
 * 2003, eq. 3.1.13). Losses and shear in the bottom are left out: an upper bound. */
FORMULA real fluid_reflection2(real sin_grazing, real density_ratio, real index) {
    real s = r_min(r_max(sin_grazing, R(1.0e-6)), R(1.0));
    real under = index * index - (R(1.0) - s) * (R(1.0) + s);
    real through = sqrt(r_max(under, R(0.0)));
    real r = (density_ratio * s - through) / (density_ratio * s + through);
    return choose(under > R(0.0), r * r, R(1.0));
}

/* R.m.s. height of a wind sea, a quarter of the significant height 0.21 U^2 / g of W. J. Pierson and
 * L. Moskowitz, J. Geophys. Res. 69, 5181 (1964); U in m/s, here from knots. Fully developed: a young
 * or sheltered sea is lower. */
FORMULA real sea_height_rms_m(real wind_kn) {
    real wind_mps = wind_kn * R(0.514444444444444);
    return R(0.25) * R(0.21) / R(9.81) * wind_mps * wind_mps;
}

#endif
