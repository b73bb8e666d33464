/*
 * The beam pattern of a rectangular aperture.
 */
#ifndef ASDIC_KERNEL_BEAM_H
#define ASDIC_KERNEL_BEAM_H

#include "real.h"

/* [sin(pi x) / (pi x)]^2, normalised: 1 at 0, exact zeros at whole numbers. Below 1e-9 it is 1 to 2e-18.
 * On a device sin(pi r) / (pi r) of the remainder |r| <= 1/2 is 1 plus four terms fitted to it for the least
 * relative error, 6e-9: a library's sine takes three times as long. */
FORMULA real sinc2(real x) {
    real safe = r_max(r_abs(x), R(1.0e-9));
#ifdef __OPENCL_C_VERSION__
    real r = safe - ((safe + R(12582912.0)) - R(12582912.0)), s = r * r; /* 1.5 2^23 rounds */
    real p = r_fma(s, R(0.0247250456), R(-0.190447388));
    p = r_fma(s, r_fma(s, r_fma(s, p, R(0.811716409)), R(-1.64493336)), R(1.0));
    real amplitude = r / safe * p;
#else
    real amplitude = r_sinpi(safe) / (R_PI * safe);
#endif
    return amplitude * amplitude;
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
