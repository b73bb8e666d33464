/*
 * What a flat piece of a mirror sends where phase goes evenly over it: the form factor of a triangle.
 */
#ifndef ASDIC_KERNEL_FACET_FORM_H
#define ASDIC_KERNEL_FACET_FORM_H

#include "coherent.h"

/* The mean of exp(-2 pi i phase) over a triangle, re the phase in its centroid; A and B are the turns along its two edges
 * from one corner, within +-0.7, as along the third. It is twice the second divided difference of the exponential at the
 * phases i p of the corners (W. B. Gordon, "Far-field approximations to the Kirchhoff-Helmholtz representations of scattered
 * fields", IEEE Trans. Antennas Propag. 23, 590 (1975), has polygons), as a series, for which no edge is too short:
 *
 *     sum of t_m i^m,  t_m = (Q t_(m-2) + P t_(m-3) / m) / ((m + 1) (m + 2)),  t_0 = 1,
 *
 * Q = (p1^2 + p2^2 + p3^2) / 2 and P = p1 p2 p3, of 2 h_m / (m + 2)!, h_m the complete homogeneous symmetric polynomials of
 * phases whose sum is 0. What is left out is below 1e-6. */
FORMULA phasor triangle_form(real a, real b) {
    const real turn = R(-2.0) * R_PI;
    real p1 = turn * (a + b) / R(-3.0), p2 = p1 + turn * a, p3 = p1 + turn * b;
    real q = R(0.5) * (p1 * p1 + p2 * p2 + p3 * p3), p = p1 * p2 * p3;
    real third = R(1.0), second = R(0.0), last = q / R(12.0); /* t_0, t_1, t_2 */
    phasor sum = {R(1.0) - last, R(0.0)};
    for (int m = 3; m < 15; m += 2) {
        real n = (real)(m);
        real odd = (q * second + p * third / n) / ((n + R(1.0)) * (n + R(2.0)));
        real even = (q * last + p * second / (n + R(1.0))) / ((n + R(2.0)) * (n + R(3.0)));
        bool minus = (m & 2) != 0; /* i^3 = -i, i^4 = 1 */
        sum.im += minus ? -odd : odd;
        sum.re += minus ? even : -even;
        third = last;
        second = odd;
        last = even;
    }
    return sum;
}

#endif
