/*
 * The beam pattern of a rectangular aperture.
 */
#ifndef ASDIC_KERNEL_BEAM_H
#define ASDIC_KERNEL_BEAM_H

#include "real.h"

/* sin(pi x) / (pi x), normalised: 1 at 0, exact zeros at whole numbers. Below 1e-9 the series'
 * second term is under 2e-18, and a flushed denormal cannot make 0/0. */
FORMULA real sinc(real x) {
    mask tiny = r_abs(x) < R(1.0e-9);
    real safe = choose(tiny, R(1.0), x);
    return choose(tiny, R(1.0), r_sinpi(safe) / (R_PI * safe));
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
    real amplitude = sinc(length_h_wl * vy) * sinc(length_v_wl * vz);
    return amplitude * amplitude * choose(vx > R(0.0), R(1.0), rear_lin);
}

#endif
