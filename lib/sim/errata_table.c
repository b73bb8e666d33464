#include "errata.h"

static const asdic_erratum rows[] = {
    {1, "absorption, A1 and c", "8.696 / c, c of eq. (1)",
     "8.86 / c, c = 1412 + 3.21 T + 1.19 S + 0.0167 z"},
    {5, "transmission loss, eq. (2)", "(2d - 1) alpha / 1000", "2 (d - 1) alpha / 1000"},
    {7, "wavelength", "c / f, f in kHz", "c / (1000 f)"},
    {9, "sinc", "sin(x) / x", "sin(pi x) / (pi x)"},
    {10, "beam pattern \"0 otherwise\"", "0 dB behind the face", "no energy"},
    {11, "theta = atan(vy / vx)", "mirror beam", "atan2, or direction cosines"},
    {12, "average over a ring", "of decibels", "of energies"},
    {13, "average over a ring", "of transmitter and receiver apart", "of their product"},
    {14, "average over a ring", "1 / pi", "1 / (2 pi)"},
    {15, "ring area A_n", "pi r_n^2 - A_(n-1)", "pi (r_n^2 - r_(n-1)^2)"},
    {17, "ring direction and angle", "one point per bin", "integral over the bin"},
    {21, "theta_ha, theta_hd \"0 otherwise\"", "0", "pi / 2: no cut before the boundary"},
    {22, "limits of BP_2", "psi of the beam, z up", "elevation in the world"},
    {23, "directions v_v", "no unit vectors, no Jacobian", "cos e de dphi"},
    {24, "psi of the volume", "atan(vz / vx)", "atan2(vz, hypot(vx, vy))"},
    {25, "average over the sphere", "1 / pi^2", "1 / (4 pi^2)"},
    {26, "resolution cells", "whole cells only", "integral over the bin"},
    {31, "wind noise", "m/s in the formula for knots", "knots"},
    {32, "noise", "omnidirectional", "less the receiver's directivity"},
    {33, "noise of a bin", "of one resolution cell", "of as many cells as the echo"},
};

_Static_assert(1u << (sizeof rows / sizeof *rows - 1) == ASDIC_ERRATUM_NOISE_CELLS,
               "one row for each switch");

size_t asdic_erratum_count(void) {
    return sizeof rows / sizeof *rows;
}

const asdic_erratum *asdic_erratum_get(size_t index) {
    return index < asdic_erratum_count() ? &rows[index] : NULL;
}
