/*
 * The geometry of a ray: where it comes to, how long it takes, how its energy spreads.
 *
 * This is the one place that knows whether rays are straight. A ray leaves a point in a direction of unit
 * length; T is what a tracer measures along it. The functions below say what T means:
 *
 *     range   c at the sonar times the travel time, one way; bins count it
 *     length  of the path; absorption takes it
 *     spread  the distance at which a straight ray has spread as much: intensity falls by its square
 *     width   root of the cross-section of a tube of one steradian: turns solid angle into area
 *
 * In water of one sound speed all four are T itself, and a ray keeps its direction: the functions that stand
 * here under !ASDIC_BENT. Where the sound speed changes with depth, ray_bent.h has them. Those for the host
 * alone, of rings and elevations, are of straight rays. All lengths are in metres, angles in radians,
 * elevations positive downwards, absorption K in nepers of intensity per metre (alpha ln 10 / 1e4 with alpha
 * in dB/km).
 *
 * Sources: spherical spreading and absorption, R. J. Urick, "Principles of underwater sound", 3rd ed.
 * 1983, ch. 5; spreading after a mirror, G. A. Deschamps, "Ray techniques in electromagnetics",
 * Proc. IEEE 60(9), 1972.
 */
#ifndef ASDIC_KERNEL_RAY_H
#define ASDIC_KERNEL_RAY_H

#include "lift.h"

/* 0: rays are straight; 1: they bend in one layer; 2: in several, which they cross leg by leg (advance.cl). */
#ifndef ASDIC_BENT
#define ASDIC_BENT 0
#endif
#define ASDIC_LAYERS (ASDIC_BENT == 2)

/* Rays that hardly leave the horizontal never meet a horizontal plane. */
#define RAY_LEVEL 1e-12f

/* The sound speed: c(z) = c(0) (1 + BEND z), z down; SONAR is c at the sonar over c(0). */
typedef struct ray_medium {
    real bend, sonar;
} ray_medium;

/* A ray: where it leaves, and in which direction. BEND and PACE are of bent rays: the bend of the water as
 * seen from there, g / c(from), and c at the sonar over c(from). */
typedef struct ray {
    triple from, u;
    real bend, pace;
#if ASDIC_BENT
    real range, arc, across, along, slope, fan; /* of the legs before, see ray_bent.h */
#endif
} ray;

/* A ray from a point to another, which it reaches at T. */
typedef struct ray_way {
    ray r;
    real t;
} ray_way;

#include "ray_bent.h"

#if !ASDIC_BENT

/* ---- A tracer's space, which is our own ---- */

FORMULA triple ray_lift(triple p, ray_medium water) {
    (void)water;
    return p;
}

FORMULA triple ray_unlift(triple p, ray_medium water) {
    (void)water;
    return p;
}

FORMULA ray ray_start(triple from, triple u, ray_medium water) {
    ray r = {from, u, R(0.0), R(1.0)};
    (void)water;
    return r;
}

/* Its direction as a tracer sees it, and the ray from that. */
FORMULA triple ray_traced(const ray *r, ray_medium water) {
    (void)water;
    return r->u;
}

FORMULA ray ray_of_traced(triple from, triple d, ray_medium water) {
    return ray_start(from, d, water);
}

/* ---- Along a ray ---- */

FORMULA triple ray_point(const ray *r, real t) {
    triple p = {r->from.x + t * r->u.x, r->from.y + t * r->u.y, r->from.z + t * r->u.z};
    return p;
}

FORMULA triple ray_direction(const ray *r, real t) {
    (void)t;
    return r->u;
}

FORMULA real ray_range(const ray *r, real t) {
    (void)r;
    return t;
}

FORMULA real ray_spread(const ray *r, real t) {
    (void)r;
    return t;
}

/* The T at which RANGE is reached. */
FORMULA real ray_at_range(const ray *r, real range) {
    (void)r;
    return range;
}

/* Density per steradian at the start of what has DENSITY per square metre at T, on a surface that the ray
 * meets with COSINE of its angle to the normal. */
FORMULA real ray_per_steradian(const ray *r, real t, real density, real cosine) {
    (void)r;
    return density * t * t / cosine;
}

/* Range that a step of SPLAT (ray_sample in sampler.h) in elevation covers on a surface with unit NORMAL,
 * met at T at a grazing angle with SIN_GRAZING; 0 where no splat meets nothing, which is 0 times infinity. */
FORMULA real ray_footprint(const ray *r, real t, real splat, triple normal, real sin_grazing) {
    real across = sqrt(r_max((R(1.0) - r->u.z) * (R(1.0) + r->u.z), R(1e-12)));
    real tangent = (-r->u.z * (r->u.x * normal.x + r->u.y * normal.y)) / across + across * normal.z;
    return splat * r_min(t, R(1.0e30)) * r_abs(tangent) / sin_grazing;
}

/* The loss on the way over that of a straight ray of RANGE. */
FORMULA real ray_bending(const ray *r, real t, real range, real minus_2k) {
    (void)r;
    (void)t;
    (void)range;
    (void)minus_2k;
    return R(1.0);
}

/* T at which it meets the plane through POINT with unit NORMAL, near T, where the tracer's triangle is not
 * flat. */
FORMULA real ray_onto(const ray *r, real t, triple point, triple normal) {
    (void)r;
    (void)point;
    (void)normal;
    return t;
}

/* ---- From one point to another ---- */

/* T is LEAST at least. */
FORMULA ray_way ray_between(triple from, triple to, ray_medium water, real least) {
    triple apart = {to.x - from.x, to.y - from.y, to.z - from.z};
    ray_way way;
    way.t = r_max(sqrt(dot3(apart, apart)), least);
    triple u = {apart.x / way.t, apart.y / way.t, apart.z / way.t};
    way.r = ray_start(from, u, water);
    return way;
}

/* Direction in which the reverse of a ray leaves its end at T. */
FORMULA triple ray_back(const ray *r, real t) {
    triple back = {-r->u.x, -r->u.y, -r->u.z};
    (void)t;
    return back;
}

/* ---- Horizontal planes ---- */

/* What the sine of a ray's grazing angle counts as at least, where rounding tells no less. */
FORMULA real ray_least_grazing(const ray *r) {
    (void)r;
    return R(0.0);
}

/* Sine with which a ray surely turns before a plane that one with SINE just meets. */
FORMULA real ray_short_of(real sine) {
    return sine;
}

/* T at which a ray with sine DOWN of its elevation meets a plane HEIGHT below its start; INFINITY: never.
 * BEND, here and below, is as seen from the start; for a plane above, DOWN and BEND change their signs. */
FORMULA real ray_to_plane(real height, real down, real bend) {
    (void)bend;
    return choose(down > (real)(RAY_LEVEL), height / r_max(down, (real)(RAY_LEVEL)),
                  (real)(INFINITY));
}

/* Sine of the elevation at which a ray leaves that meets a plane HEIGHT away at RANGE. */
FORMULA real ray_plane_sine(real height, real range, real bend) {
    (void)bend;
    return height / range;
}

/* The range at which a ray with SINE of its elevation meets it. */
FORMULA real ray_plane_range(real height, real sine, real bend) {
    (void)bend;
    return height / r_max(sine, R(1e-9));
}

/* Density over the elevation's sine of SHARE of all rays, when they meet the plane at ranges that are even
 * from NEAR to FAR; at RANGE. */
FORMULA real ray_plane_density(real share, real range, real height, real near, real far,
                               real bend) {
    (void)bend;
    return share * range * range / (height * (far - near));
}

/* Nearest to the sonar that anything of the facet's plane can be that is met at T: the foot of the
 * perpendicular. A nudge keeps rounding from crossing a bin's edge that lies there. */
FORMULA real ray_plane_nearest(const ray *r, real t, real range, triple normal, real sin_grazing) {
    (void)r;
    (void)t;
    (void)normal;
    return r_min(range * sin_grazing * R(1.0000005), range);
}

#endif

/* ---- Loss ---- */

/* TL(d), two ways, re 1 m: d^-4 exp(-2 K (d - 1)), at RANGE > 0. */
FORMULA real ray_transmission(real k_np_per_m, real range) {
    return exp(R(-2.0) * k_np_per_m * (range - R(1.0))) / (range * range * range * range);
}

/* TL(d) times the area of a tube of one steradian, d^-2 exp(-2 K (d - 1)), at RANGE > 0: the loss of what
 * fills a ray's whole tube. */
FORMULA real ray_tube_loss(real k_np_per_m, real range) {
    return exp(R(-2.0) * k_np_per_m * (range - R(1.0))) / (range * range);
}

/* Area across a tube of one steradian at RANGE. */
FORMULA real ray_tube_area(real range) {
    return range * range;
}

/* ray_tube_loss at RANGE over that at CENTER; MINUS_2K is -2 K. */
FORMULA real ray_relative_loss(real minus_2k, real range, real center) {
    real q = center / range;
    return q * q * exp(minus_2k * (range - center));
}

/* Integral of ray_tube_loss over ranges from BEGIN to END, 1/m, without its factor e^(-2 K (REFERENCE - 1)).
 * In y = 1/d the integrand is exp(-2 K (1/y - REFERENCE)): smooth enough for Gauss' rule of two points over
 * part of a bin. MINUS_2K is -2 K; BEGIN > 0. */
FORMULA real ray_water_part(real minus_2k, real begin, real end, real reference) {
    real length = r_max(end - begin, R(0.0));
    real total = length / (begin * r_max(end, begin));
    real y0 = R(1.0) / r_max(end, begin);
    real e1 = exp(minus_2k * (R(1.0) / (y0 + R(0.21132486540518712) * total) - reference));
    real e2 = exp(minus_2k * (R(1.0) / (y0 + R(0.78867513459481288) * total) - reference));
    return R(0.5) * (e1 + e2) * total;
}

#ifndef __OPENCL_C_VERSION__

/* The same integral, levels referred to 1 m, with five points: to 1e-12 where a bin is short beside its
 * range, to 5e-5 in one from 0.1 m to 5 m at 220 dB/km. */
FORMULA real ray_water(real k_np_per_m, real begin, real end) {
    static const real node[5] = {0.04691007703066800, 0.23076534494715845, 0.5, 0.76923465505284155,
                                 0.95308992296933200};
    static const real weight[5] = {0.11846344252809454, 0.23931433524968324, 0.28444444444444444,
                                   0.23931433524968324, 0.11846344252809454};
    real y0 = 1.0 / end, length = 1.0 / begin - 1.0 / end, sum = 0.0;
    for (int i = 0; i < 5; i++) {
        sum += weight[i] * exp(-2.0 * k_np_per_m * (1.0 / (y0 + node[i] * length) - 1.0));
    }
    return sum * length;
}

#endif

/* ---- Horizontal planes, straight rays ---- */

/* Sine of the grazing angle at which a straight ray meets a plane HEIGHT away at RANGE. */
FORMULA real ray_plane_grazing(real height, real range) {
    return height / range;
}

#ifndef __OPENCL_C_VERSION__

/* Elevation at which RANGE meets a plane HEIGHT away, from the horizontal; pi/2 before it is reached. */
FORMULA real ray_plane_elevation(real height, real range) {
    if (range <= height) {
        return 0.5 * R_PI;
    }
    return atan2(height, sqrt((range - height) * (range + height)));
}

/* A ring of a plane, by the coordinate S = root of (range - height), in which nothing is singular at the
 * nadir. */
typedef struct ray_ring {
    real range, elevation;
    real grazing; /* sine */
    real area;    /* per unit of S and radian of azimuth: dA / dS dphi */
} ray_ring;

FORMULA real ray_ring_coordinate(real height, real range) {
    return sqrt(r_max(range - height, 0.0));
}

FORMULA ray_ring ray_ring_at(real height, real s) {
    ray_ring ring;
    ring.range = height + s * s;
    ring.elevation = atan2(height, s * sqrt(ring.range + height));
    ring.grazing = height / ring.range;
    ring.area = 2.0 * s * ring.range; /* dA = d dd dphi */
    return ring;
}

#endif

/* ---- Mirrors ---- */

/* What ray_mirror_reach, which is of straight rays, may leave out where they bend. */
#if ASDIC_BENT
#define RAY_MIRROR_ROOM 1.05f
#else
#define RAY_MIRROR_ROOM 1.0f
#endif

/* What the water adds to the curvature of a mirror: as BEND and GAUSS below. */
typedef struct ray_turn {
    real trace, gauss;
} ray_turn;

/* Beside rays that curve towards it, a flat mirror is a convex one. NORMAL times SIDE points to where the ray R
 * came from; ALONG: of the ray to NORMAL. */
FORMULA ray_turn ray_mirror_turn(const ray *r, triple normal, real along, real side) {
    real cosine = r_max(r_abs(along), R(1e-3)), curvature = -r->bend * side * normal.z;
    ray_turn turn = {curvature * (R(1.0) / cosine + cosine), curvature * curvature};
    return turn;
}

/* The farthest T of a ray that leaves a mirror at T1 from the sonar for what it meets to be heard straight:
 * the way on and the way back make REST together. COSINE: between the ray before and after the mirror. */
FORMULA real ray_mirror_reach(real rest, real t1, real cosine) {
    return (rest * rest - t1 * t1) / (R(2.0) * r_max(rest + t1 * cosine, R(1e-3)));
}

/* What a mirror's curvature does to the echo that comes back over it: the spreading D^2 of a flat mirror
 * over that of a curved one,
 *
 *     J = D^2 + 2 D d1 d2 (kappa_t / cos i + kappa_s cos i) + 4 d1^2 d2^2 K,  D = d1 + d2
 *
 * BEND: the curvatures along and across the plane of incidence as above, GAUSS: their product K, positive
 * where convex. Near the focus of a concave mirror the gain is held to 20 dB. */
FORMULA real ray_mirror_gain(real d1, real d2, real bend, real gauss) {
    real d = d1 + d2, twice = R(2.0) * d1 * d2;
    real spread = r_abs(R(1.0) + twice * bend / d + twice * twice * gauss / (d * d));
    return R(1.0) / r_max(spread, R(1e-2));
}

#endif
