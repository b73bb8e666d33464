/*
 * Rays of one layer by their ends: what kernels/ray_bent.h says along a ray, in forms of its own. The
 * conventions and the sources are those of kernels/lift.h; D is the true distance between the ends, n0 and
 * n1 are the speeds there. tests/unit/test_lift.c holds these forms against a Runge-Kutta integrator.
 */
#ifndef ASDIC_TEST_ONE_LAYER_H
#define ASDIC_TEST_ONE_LAYER_H

#include "../../kernels/lift.h"

/* ---- Directions at the true point P ---- */

/* The true direction, of unit length, of a lifted one of any length. */
FORMULA triple lift_direction_back(real k, triple p, triple lifted) {
    real down = (lifted.z - k * (p.x * lifted.x + p.y * lifted.y)) / (R(1.0) + k * p.z);
    real by = R(1.0) / sqrt(lifted.x * lifted.x + lifted.y * lifted.y + down * down);
    triple u = {lifted.x * by, lifted.y * by, down * by};
    return u;
}

/* The true normal, of unit length, of a lifted surface with NORMAL of any length. */
FORMULA triple lift_normal_back(real k, triple p, triple normal) {
    triple n = {normal.x + k * p.x * normal.z, normal.y + k * p.y * normal.z,
                normal.z * (R(1.0) + k * p.z)};
    real by = R(1.0) / sqrt(dot3(n, n));
    triple unit = {n.x * by, n.y * by, n.z * by};
    return unit;
}

/* ---- Along a ray ---- */

/* u = k D / (2 sqrt(n0 n1)): sinh of half the travel time times g. */
FORMULA real lift_half(real k, real distance, real n0, real n1) {
    return R(0.5) * k * distance / sqrt(n0 * n1);
}

/* asinh(u) / u, 1 at 0. */
FORMULA real lift_asinh_ratio(real u) {
    real a = r_abs(u);
    real safe = r_max(a, R(1e-30));
    return choose(a < R(1e-30), R(1.0), asinh(safe) / safe);
}

/* c0 times the travel time, c0 tau = 2 asinh(|u|) / |k|. */
FORMULA real lift_time(real k, real distance, real n0, real n1) {
    return distance / sqrt(n0 * n1) * lift_asinh_ratio(lift_half(k, distance, n0, n1));
}

/* The distance D at which the travel time is TIME / c0: the inverse. */
FORMULA real lift_distance(real k, real time, real n0, real n1) {
    real turn = R(0.5) * k * time; /* `half` is a type in OpenCL */
    real safe = r_max(r_abs(turn), R(1e-30));
    real ratio = choose(r_abs(turn) < R(1e-30), R(1.0), sinh(safe) / safe);
    return time * sqrt(n0 * n1) * ratio;
}

/* Root of the spreading S = D^2 (1 + u^2): the straight distance at which intensity has fallen as
 * much, the same both ways. No caustic lies inside one layer. */
FORMULA real lift_spread(real k, real distance, real n0, real n1) {
    real u = lift_half(k, distance, n0, n1);
    return distance * sqrt(R(1.0) + u * u);
}

/* Cross-section, m^2, at the end with n1 of a tube of one steradian at the end with n0,
 * S n1 / n0. */
FORMULA real lift_tube_area(real k, real distance, real n0, real n1) {
    real u = lift_half(k, distance, n0, n1);
    return distance * distance * (R(1.0) + u * u) * n1 / n0;
}

/* Length of the arc over the chord D of a ray that leaves n0 with horizontal part LEVEL of its
 * direction: the circle's curvature is k LEVEL / n0. */
FORMULA real lift_length(real k, real distance, real n0, real level) {
    return distance * lift_asin_ratio(R(0.5) * k * level / n0 * distance);
}

#endif
