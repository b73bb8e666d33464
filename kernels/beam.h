/*
 * The beam pattern of a rectangular aperture.
 */
#ifndef ASDIC_KERNEL_BEAM_H
#define ASDIC_KERNEL_BEAM_H

#include "real.h"

/* sin(pi r) / (pi r) of |r| <= 1/2 from S = r^2, without a library's sine, which takes three times as long
 * and stands in the way of vectors: on a device 1 plus four terms fitted to it for the least relative error,
 * 6e-9; on the host Taylor's series, whose next term is below 1e-18. */
FORMULA real near_sinc(real s) {
#ifdef __OPENCL_C_VERSION__
    real p = r_fma(s, R(0.0247250456), R(-0.190447388));
    return r_fma(s, r_fma(s, r_fma(s, p, R(0.811716409)), R(-1.64493336)), R(1.0));
#else
    real p = (1.7165384749821432e-10 * s - 7.304711822217775e-9) * s + 2.5312174041370274e-7;
    p = ((p * s - 6.9758736616563807e-6) * s + 1.48428793031071e-4) * s - 2.3460810354558235e-3;
    p = ((p * s + 2.61478478176548e-2) * s - 0.19075182412208422) * s + 0.81174242528335361;
    return (p * s - 1.6449340668482264) * s + 1.0;
#endif
}

#ifdef __OPENCL_C_VERSION__
#define ROUNDER R(12582912.0) /* 1.5 2^23: added and taken off again it rounds a float */
#else
#define ROUNDER 0x1.8p52 /* a double */
#endif

/* [sin(pi x) / (pi x)]^2, normalised: 1 at 0, exact zeros at whole numbers. Below 1e-9 it is 1 to 2e-18. */
FORMULA real sinc2(real x) {
    real safe = r_max(r_abs(x), R(1.0e-9));
    real r = safe - ((safe + ROUNDER) - ROUNDER);
    real amplitude = r / safe * near_sinc(r * r);
    return amplitude * amplitude;
}

/* -1 where sin(pi x) / (pi x) is negative, in every other side lobe; else 1. */
FORMULA real sinc_sign(real x) {
    real turns = R(0.5) * r_abs(x);
    return choose(turns < (turns + ROUNDER) - ROUNDER, R(-1.0), R(1.0));
}

/* One-way intensity re on-axis in the direction of the unit vector (VX, VY, VZ) of the face's own
 * frame: x out of the face, y along LENGTH_H, z along LENGTH_V, lengths in wavelengths.
 *
 *     [sinc(L_H vy) sinc(L_V vz)]^2 for vx > 0, REAR_LIN times that behind the face
 *
 * The paper's angles (Marage & Mori 2010) satisfy sin(theta) cos(psi) = vy and sin(psi) = vz for a
 * unit vector, so no angle is formed. REAR_LIN 0 means no energy, where the paper's "0 otherwise"
 * is 0 dB, and its arctangent cannot tell the front from the back. Far field: d > L^2 / lambda. */
FORMULA real beam_pattern_lin(real vx, real vy, real vz, real length_h_wl, real length_v_wl,
                              real rear_lin) {
    real front = sinc2(length_h_wl * vy) * sinc2(length_v_wl * vz);
    return front * choose(vx > R(0.0), R(1.0), rear_lin);
}

#endif
