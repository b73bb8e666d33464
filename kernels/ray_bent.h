/*
 * The functions of ray.h in water whose sound speed changes evenly with depth, c = c0 + g z: a program that
 * defines ASDIC_BENT as 1 has these.
 *
 * The lift of lift.h turns every ray into a straight line, whatever point depth is counted from. A tracer that
 * is given lifted triangles, origins and directions therefore needs to know nothing of it.
 *
 * Lifted about its own start, with b = g / c there (ray.bend, 1/m), a ray in direction u of unit length is
 * T u. T is also what a tracer measures along a direction lifted elsewhere, which is not made a unit again.
 * With q = c(T) / c(start), m^2 = 1 - u_z^2, and sources as in lift.h:
 *
 *     q^2       = 1 + 2 b w,  w = T u_z - b m^2 T^2 / 2
 *     depth     = 2 w / (1 + q), below the start
 *     direction = (q u_x, q u_y, u_z - b m^2 T)
 *     range     = atanh(b T / (1 + b T u_z)) / b, at the sound speed of the start
 *     width     = T, and T / q what 1 / r^2 asks for: sinh(b range) / b
 *
 * Through layers a ray has legs, and T is along the last of them. Those before leave their range and arc, and
 * the widths of a tube of one steradian at the leg's start: ACROSS the plane of the ray, a sum of T c, and ALONG
 * it, which grows by SLOPE per T (dynamic ray tracing: V. Cerveny, "Seismic ray theory", 2001, section 4.1; both
 * are T on the first leg). FAN: c at the leg's start over that at the path's start.
 *
 * b = 0 gives the straight ray and b -> 0 loses nothing; |b| range up to 0.8. Where no sign is stated, a plane
 * lies below the start.
 */
#ifndef ASDIC_KERNEL_RAY_BENT_H
#define ASDIC_KERNEL_RAY_BENT_H

#include "lift.h"

/* What is farther than this, m, counts as never met. */
#define BENT_FAR 1e5f
/* q is not followed below this, towards the plane where c would be 0. */
#define BENT_SLOW 1e-2f

/* atanh(x) / x, tanh(x) / x, sinh(x) / x and cosh(x) from V = x^2. */
#ifdef __OPENCL_C_VERSION__

/* Continued fractions (M. Abramowitz, I. A. Stegun, "Handbook of mathematical functions", 4.5.70 and
 * 4.6.33), cut off and multiplied out, and series: to 1e-7 for |x| up to 0.6, 1e-6 up to 0.7. */
FORMULA real bent_atanh(real v) {
    real over = R(1.0) + v * (R(-1.5333333) + v * (R(0.65470085) - v * R(0.067306027)));
    real under = R(-1.8666667) + v * (R(1.0769231) + v * (R(-0.19580420) + v * R(0.0054390054)));
    return over / (R(1.0) + v * under);
}

FORMULA real bent_tanh(real v) {
    real over = R(1.0) + v * (R(0.11111111) + v * R(0.0010582011));
    return over / (R(1.0) + v * (R(0.44444444) + v * R(0.015873016)));
}

FORMULA real bent_sinh(real v) {
    real high = R(1.9841270e-4) + v * R(2.7557319e-6);
    return R(1.0) + v * (R(1.6666667e-1) + v * (R(8.3333333e-3) + v * high));
}

FORMULA real bent_cosh(real v) {
    real high = R(1.3888889e-3) + v * R(2.4801587e-5);
    return R(1.0) + v * (R(0.5) + v * (R(4.1666667e-2) + v * high));
}

#else

FORMULA real bent_atanh(real v) {
    return v < 1e-4 ? 1.0 + v * (1.0 / 3.0 + v * (0.2 + v / 7.0)) : atanh(sqrt(v)) / sqrt(v);
}

FORMULA real bent_tanh(real v) {
    return v < 1e-8 ? 1.0 - v / 3.0 : tanh(sqrt(v)) / sqrt(v);
}

FORMULA real bent_sinh(real v) {
    return v < 1e-8 ? 1.0 + v / 6.0 : sinh(sqrt(v)) / sqrt(v);
}

FORMULA real bent_cosh(real v) {
    return cosh(sqrt(v));
}

#endif

#if ASDIC_BENT

/* ---- The lift ---- */

FORMULA triple ray_lift(triple p, ray_medium water) {
    return lift_point(water.bend, p);
}

FORMULA triple ray_unlift(triple p, ray_medium water) {
    return lift_back(water.bend, p);
}

/* The bend of the water as seen from depth Z. */
FORMULA real ray_bend(real z, ray_medium water) {
    return water.bend / (R(1.0) + water.bend * z);
}

FORMULA ray ray_start(triple from, triple u, ray_medium water) {
    real speed = R(1.0) + water.bend * from.z;
    ray r = {from,   u,     water.bend / speed, water.sonar / speed, R(0.0), R(0.0), R(0.0), R(0.0),
             R(1.0), R(1.0)};
    return r;
}

/* Its direction as a tracer sees it, and the ray from that. */
FORMULA triple ray_traced(const ray *r, ray_medium water) {
    return lift_direction(water.bend, r->from, r->u);
}

FORMULA ray ray_of_traced(triple from, triple d, ray_medium water) {
    real level = from.x * d.x + from.y * d.y;
    triple u = {d.x, d.y, (d.z - water.bend * level) / (R(1.0) + water.bend * from.z)};
    return ray_start(from, u, water);
}

/* ---- Along a ray ---- */

/* What all functions of a place on a ray begin with. */
typedef struct bent_place {
    real t, w, q, level; /* level: m^2 */
} bent_place;

FORMULA bent_place bent_at(const ray *r, real t) {
    bent_place at;
    at.t = r_min(t, (real)(BENT_FAR));
    at.level = r->u.x * r->u.x + r->u.y * r->u.y;
    at.w = at.t * (r->u.z - R(0.5) * r->bend * at.level * at.t);
    at.q = sqrt(r_max(R(1.0) + R(2.0) * r->bend * at.w, (real)(BENT_SLOW * BENT_SLOW)));
    return at;
}

FORMULA triple ray_point(const ray *r, real t) {
    bent_place at = bent_at(r, t);
    triple p = {r->from.x + at.t * r->u.x, r->from.y + at.t * r->u.y,
                r->from.z + R(2.0) * at.w / (R(1.0) + at.q)};
    return p;
}

FORMULA triple ray_direction(const ray *r, real t) {
    bent_place at = bent_at(r, t);
    triple u = {at.q * r->u.x, at.q * r->u.y, r->u.z - r->bend * at.level * at.t};
    return u;
}

FORMULA real ray_range(const ray *r, real t) {
    real far = r_min(t, (real)(BENT_FAR)), ahead = R(1.0) + r->bend * far * r->u.z;
    real x = r_min(r_abs(r->bend * far / ahead), R(0.99));
    real range = far / ahead * bent_atanh(x * x);
    return choose(t < (real)(BENT_FAR), r->range + r->pace * range, (real)(INFINITY));
}

/* Widths of a tube of one steradian. Near a caustic, where rays cross, that in their plane is held to this
 * share of the other: what a bin collects is an integral, which hardly depends on it. */
#define BENT_CAUSTIC 1e-2f

FORMULA real bent_across(const ray *r, real t) {
    return r->across + r->fan * t;
}

FORMULA real bent_along(const ray *r, real t) {
    return r_max(r_abs(r->along + r->slope * t), (real)(BENT_CAUSTIC)*bent_across(r, t));
}

FORMULA real ray_spread(const ray *r, real t) {
    return bent_across(r, t);
}

FORMULA real ray_per_steradian(const ray *r, real t, real density, real cosine) {
    return density * bent_across(r, t) * bent_along(r, t) / cosine;
}

/* The fraction exceeds a tanh from |x| = 3.9 on, where a ray has left its layer long before. */
FORMULA real ray_at_range(const ray *r, real range) {
    real own = (range - r->range) / r->pace, x = r->bend * own;
    real y = own * r_min(bent_tanh(x * x), R(1.0) / r_max(r_abs(x), R(1.0)));
    return y / r_max(R(1.0) - r->bend * y * r->u.z, R(1e-6));
}

/* A displacement by a ray in its direction takes 1 / q of range. */
FORMULA real ray_footprint(const ray *r, real t, real splat, triple normal, real sin_grazing) {
    bent_place at = bent_at(r, t);
    real across = sqrt(r_max(at.level, R(1e-12)));
    real down = r->u.z - r->bend * at.level * at.t;
    real tangent =
        (-down * (r->u.x * normal.x + r->u.y * normal.y)) / across + at.q * across * normal.z;
    return r->pace * splat * bent_along(r, t) * r_abs(tangent) / (sin_grazing * at.q);
}

/* The length of the leg. */
FORMULA real bent_arc(const ray *r, const bent_place *at) {
    real depth = R(2.0) * at->w / (R(1.0) + at->q);
    real chord = sqrt(at->level * at->t * at->t + depth * depth);
    real v = R(0.5) * r->bend * chord; /* over cos of the elevation: the sine of half the turn */
    v = r_min(v * v * at->level, R(0.5));
    return chord * (R(1.0) + v * (R(1.0) / R(6.0) +
                                  v * (R(0.075) + v * (R(15.0) / R(336.0) + v * R(0.0303819)))));
}

/* How much less it spreads than a straight ray of RANGE: (range b / sinh(b range))^2 in one layer. */
FORMULA real ray_focus(const ray *r, real t, real range) {
    bent_place at = bent_at(r, t);
    real spread = range / r->pace * at.q;
    real tube = bent_across(r, at.t) * r_abs(r->along + r->slope * at.t);
    tube = r_max(tube, r_max((real)(BENT_CAUSTIC)*range * range * at.q / r->pace, R(1e-12)));
    return spread * spread / tube;
}

/* The loss on the way over that of a straight ray of RANGE: by its focus, and by the absorption of an arc that is longer
 * or shorter than the range. MINUS_2K is -2 K. */
FORMULA real ray_bending(const ray *r, real t, real range, real minus_2k) {
    bent_place at = bent_at(r, t);
    real loss = ray_focus(r, t, range) * exp(minus_2k * (r->arc + bent_arc(r, &at) - range));
    mask bends = (r->bend != R(0.0)) | (r->across > R(0.0));
    return choose((t < (real)(BENT_FAR)) & bends, loss, R(1.0));
}

/* T at which it meets the plane through POINT with unit NORMAL, near T: a lifted triangle is flat where it
 * should be curved, by L^2 |b| / 8 for an edge of L. */
FORMULA real ray_onto(const ray *r, real t, triple point, triple normal) {
    triple at = ray_point(r, t), u = ray_direction(r, t);
    triple apart = {point.x - at.x, point.y - at.y, point.z - at.z};
    real along = dot3(u, normal), size = r_max(r_abs(along), R(1e-2));
    return t +
           bent_at(r, t).q * dot3(apart, normal) * choose(along < R(0.0), R(-1.0), R(1.0)) / size;
}

/* ---- From one point to another ---- */

FORMULA ray_way ray_between(triple from, triple to, ray_medium water, real least) {
    triple apart = {to.x - from.x, to.y - from.y, to.z - from.z};
    ray_way way;
    apart.z += R(0.5) * ray_bend(from.z, water) * dot3(apart, apart);
    way.t = r_max(sqrt(dot3(apart, apart)), least);
    triple u = {apart.x / way.t, apart.y / way.t, apart.z / way.t};
    way.r = ray_start(from, u, water);
    return way;
}

FORMULA triple ray_back(const ray *r, real t) {
    triple u = ray_direction(r, t), back = {-u.x, -u.y, -u.z};
    return back;
}

/* ---- Horizontal planes ---- */

/* Of a ray that bends away from a plane the sine of the grazing angle is the root of a small difference, which
 * single precision does not know below this share of the sine at the start. Weight and density of such rays are
 * both held there, so that a ray that was drawn by ray_plane_density counts as much as its neighbours; one that
 * turns before the plane by no more than that meets it. */
#define RAY_GRAZE 1e-3f

FORMULA real ray_least_grazing(const ray *r) {
    return (real)(RAY_GRAZE)*r_abs(r->u.z);
}

FORMULA real ray_short_of(real sine) {
    return sine - (real)(RAY_GRAZE * RAY_GRAZE) * r_abs(sine);
}

/* With depth down for planes below; for planes above the caller turns the signs of DOWN and BEND. */

/* The nearer root of b m^2 T^2 / 2 - T u_z + h (1 + b h / 2) = 0, where both are not behind. A plane beyond that of
 * c = 0, as a layer's water going on has it, is never met: the equation takes it for its image on this side. */
FORMULA real ray_to_plane(real height, real down, real bend) {
    real level = (R(1.0) - down) * (R(1.0) + down);
    real w = height * (R(1.0) + R(0.5) * bend * height);
    real grazing2 = down * down - R(2.0) * bend * level * w;
    real grazing = sqrt(r_max(grazing2, R(0.0)));
    real curl = bend * level;
    /* Of a ray that sets out away from the plane and turns, the sum below cancels. */
    real direct = R(2.0) * w / r_max(down + grazing, (real)(RAY_LEVEL));
    real turned = (down - grazing) / r_min(curl, (real)(-RAY_LEVEL));
    real t = choose(down > R(0.0), direct, turned);
    real rounded = (real)(-RAY_GRAZE * RAY_GRAZE) * down * down;
    mask meets = (grazing2 >= rounded) & ((down > R(0.0)) | (curl < (real)(-RAY_LEVEL)));
    meets &= R(1.0) + bend * height > R(0.0);
    return choose(meets, t, (real)(INFINITY));
}

/* c at the plane over c at the start. */
FORMULA real bent_plane_speed(real height, real bend) {
    return R(1.0) + bend * height;
}

/* u_z = (h / q) b / sinh(b d) + tanh(b d / 2), from the chord D = 2 sqrt(q) sinh(b d / 2) / b. */
FORMULA real ray_plane_sine(real height, real range, real bend) {
    real x = bend * range, v = x * x;
    return height / (bent_plane_speed(height, bend) * range * bent_sinh(v)) +
           R(0.5) * x * bent_tanh(R(0.25) * v);
}

FORMULA real ray_plane_range(real height, real sine, real bend) {
    triple from = {R(0.0), R(0.0), R(0.0)}, u = {R(0.0), R(0.0), sine};
    ray_medium water = {bend, R(1.0)};
    ray r = ray_start(from, u, water);
    return ray_range(&r, ray_to_plane(height, sine, bend));
}

FORMULA real ray_plane_density(real share, real range, real height, real near, real far,
                               real bend) {
    real x = bend * range, v = x * x, sinh_x = bent_sinh(v), cosh_half = bent_cosh(R(0.25) * v);
    real over = R(1.0) / (bent_plane_speed(height, bend) * range * sinh_x); /* slope by grazing */
    real slope =
        height * bent_cosh(v) * over / (range * sinh_x) - R(0.5) * bend / (cosh_half * cosh_half);
    real least = (real)(RAY_GRAZE)*over * r_abs(ray_plane_sine(height, range, bend));
    return share / (r_max(r_abs(slope), least) * (far - near));
}

/* A nudge keeps rounding from crossing a bin's edge that lies there. */
FORMULA real ray_plane_nearest(const ray *r, real t, real range, triple normal, real sin_grazing) {
    triple at = ray_point(r, t);
    triple apart = {at.x - r->from.x, at.y - r->from.y, at.z - r->from.z};
    real off = dot3(apart, normal), v = R(0.5) * r->bend * off;
    real speed = r_max(R(1.0) + r->bend * off * normal.z, (real)(BENT_SLOW));
    real near = r_abs(off) / sqrt(speed) * (R(1.0) - v * v / (R(6.0) * speed));
    real layered = range * sin_grazing; /* a steep ray, the only one that asks, hardly bends */
    near = choose(r->across > R(0.0), layered, r->pace * near);
    return r_min(near * R(1.0000005), range);
}

#endif

#endif
