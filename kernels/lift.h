/*
 * Water whose sound speed is linear in depth, lifted so that every ray of it is straight.
 *
 *     c(z) = c0 (1 + k z),  k = g / c0    z down from the origin, g in 1/s, k in 1/m
 *     (x, y, z) -> (x, y, Z),  Z = z + k (x^2 + y^2 + z^2) / 2
 *
 * Rays are arcs of circles centred on the plane in which c would be 0, z = -1/k. Along each of them
 * x^2 + y^2 + (z + 1/k)^2 is linear in the horizontal coordinate, and so is Z: the lift takes every
 * ray, whatever point it leaves in whatever direction, to a straight line. It is one to one where
 * c > 0, the identity at k = 0, and no formula loses digits as k -> 0 with either sign.
 *
 * Lengths are in metres, speeds n = c / c0 = 1 + k z without unit; D is the true distance between
 * the ends of a ray, n0 and n1 are the speeds there. Valid where n > 0 at both ends.
 *
 * Sources: circular rays, C. B. Officer, "Introduction to the theory of sound transmission", 1958,
 * ch. 2; the half-space with the metric |dx| / c as hyperbolic space, whose geodesics are straight
 * in Klein's picture, and its distances: J. W. Anderson, "Hyperbolic geometry", 2nd ed. 2005;
 * intensity in a tube of rays: L. M. Brekhovskikh, Yu. P. Lysanov, "Fundamentals of ocean
 * acoustics", 3rd ed. 2003, ch. 2.
 */
#ifndef ASDIC_KERNEL_LIFT_H
#define ASDIC_KERNEL_LIFT_H

#include "triple.h"

/* ---- Points ---- */

/* Z - z. */
FORMULA real lift_height(real k, triple p) {
    return R(0.5) * k * dot3(p, p);
}

FORMULA triple lift_point(real k, triple p) {
    triple lifted = {p.x, p.y, p.z + lift_height(k, p)};
    return lifted;
}

/* n at a lifted point: n^2 = 1 + 2 k Z - k^2 (x^2 + y^2). */
FORMULA real lift_speed(real k, triple lifted) {
    real across = lifted.x * lifted.x + lifted.y * lifted.y;
    return sqrt(r_max(R(1.0) + k * (R(2.0) * lifted.z - k * across), R(0.0)));
}

/* The point that is lifted to LIFTED. */
FORMULA triple lift_back(real k, triple lifted) {
    real across = lifted.x * lifted.x + lifted.y * lifted.y;
    triple p = {lifted.x, lifted.y,
                (R(2.0) * lifted.z - k * across) / (R(1.0) + lift_speed(k, lifted))};
    return p;
}

/* ---- Directions at the true point P ---- */

/* What the lift makes of a direction U: not of unit length, but a step of T along U is one of T. */
FORMULA triple lift_direction(real k, triple p, triple u) {
    triple lifted = {u.x, u.y, u.z * (R(1.0) + k * p.z) + k * (p.x * u.x + p.y * u.y)};
    return lifted;
}

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

/* ---- Along a ray, by its ends ---- */

/* u = k D / (2 sqrt(n0 n1)): sinh of half the travel time times g. */
FORMULA real lift_half(real k, real distance, real n0, real n1) {
    return R(0.5) * k * distance / sqrt(n0 * n1);
}

/* asinh(u) / u and asin(v) / v, 1 at 0. */
FORMULA real lift_asinh_ratio(real u) {
    real a = r_abs(u);
    real safe = r_max(a, R(1e-30));
    return choose(a < R(1e-30), R(1.0), asinh(safe) / safe);
}

FORMULA real lift_asin_ratio(real v) {
    real a = r_min(r_abs(v), R(1.0));
    real safe = r_max(a, R(1e-30));
    return choose(a < R(1e-30), R(1.0), asin(safe) / safe);
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
