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
 * Lengths are in metres, speeds n = c / c0 = 1 + k z without unit. Valid where n > 0.
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

/* ---- Along a ray ---- */

/* asin(v) / v, 1 at 0: an arc over its chord, v the sine of half its turn. */
FORMULA real lift_asin_ratio(real v) {
    real a = r_min(r_abs(v), R(1.0));
    real safe = r_max(a, R(1e-30));
    return choose(a < R(1e-30), R(1.0), asin(safe) / safe);
}

#endif
