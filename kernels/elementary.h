/*
 * Elementary functions of the device, made of + - * / and square roots alone, which every device
 * rounds in the same way. OpenCL lets a driver's own sin() or exp() err by up to 4 units in the
 * last place, each in its own way: a ray would then leave the sonar a little differently on each
 * kind of device, and now and then pass an edge on its other side. With these, and without
 * contraction, kinds of devices agree in every bit.
 *
 * Polynomials and reductions: S. L. Moshier, "Methods and Programs for Mathematical Functions",
 * Ellis Horwood 1989, single precision (Cephes 2.2: sinf.c, atanf.c, asinf.c, expf.c, exp10f.c,
 * exp2f.c, logf.c). tests/kernel/test_elementary.c holds each to the stated units in the last place
 * over its range. NaN is not kept; results below 2^-126 may be 0.
 *
 * From here on kernels that write sin(x) get these.
 */
#ifndef ASDIC_KERNEL_ELEMENTARY_H
#define ASDIC_KERNEL_ELEMENTARY_H

#ifdef __OPENCL_C_VERSION__ /* the host has those of C */

/* Sine of QUARTERS + SHIFT quarter turns plus R radians, |R| <= pi / 4. */
FORMULA real quarter_sine(real quarters, real r, int shift) {
    whole turn = to_whole(quarters) + (whole)(shift);
    real z = r * r;
    real sine = R(-1.9515295891e-4) * z + R(8.3321608736e-3);
    sine = (sine * z - R(1.6666654611e-1)) * z * r + r;
    real cosine = R(2.443315711809948e-5) * z - R(1.388731625493765e-3);
    cosine = (cosine * z + R(4.166664568298827e-2)) * z * z - R(0.5) * z + R(1.0);
    real value = choose((turn & (whole)(1)) != (whole)(0), cosine, sine);
    return choose((turn & (whole)(2)) != (whole)(0), -value, value);
}

/* Sine of X radians and SHIFT quarter turns, |X| <= 8192; pi / 2 in three parts, so that its products with
 * whole numbers are exact. */
FORMULA real turned_sine(real x, int shift) {
    real quarters = r_rint(x * R(0.636619772367581));
    real r = x - quarters * R(1.5703125);
    r = (r - quarters * R(4.837512969970703e-4)) - quarters * R(7.549789954891882e-8);
    return quarter_sine(quarters, r, shift);
}

/* sin(pi x), exactly 0 at whole numbers. */
FORMULA real r_sinpi(real x) {
    real quarters = r_rint(R(2.0) * (x - R(2.0) * r_rint(R(0.5) * x)));
    real rest = (x - R(2.0) * r_rint(R(0.5) * x)) - R(0.5) * quarters;
    return quarter_sine(quarters, rest * R_PI, 0);
}

FORMULA real r_atan2(real y, real x) {
    real ax = fabs(x), ay = fabs(y);
    real a = r_min(ax, ay) / r_max(r_max(ax, ay), R(1.17549435e-38));
    mask upper = a > R(0.414213562373095);
    real b = choose(upper, (a - R(1.0)) / (a + R(1.0)), a), z = b * b;
    real angle = (R(8.05374449538e-2) * z - R(1.38776856032e-1)) * z + R(1.99777106478e-1);
    angle = (angle * z - R(3.33329491539e-1)) * z * b + b;
    angle = choose(upper, R(0.25) * R_PI + angle, angle);
    angle = choose(ay > ax, R(0.5) * R_PI - angle, angle);
    angle = choose(x < R(0.0), R_PI - angle, angle);
    return choose(y < R(0.0), -angle, angle);
}

/* asin |x|, or half of acos |x| where that is the smaller. */
typedef struct arc_of {
    real arc;
    mask is_half;
} arc_of;

FORMULA arc_of short_arc(real a) {
    arc_of s;
    s.is_half = a > R(0.5);
    real z = choose(s.is_half, R(0.5) * (R(1.0) - a), a * a);
    real v = choose(s.is_half, sqrt(r_max(z, R(0.0))), a);
    real p = (R(4.2163199048e-2) * z + R(2.4181311049e-2)) * z + R(4.5470025998e-2);
    p = (p * z + R(7.4953002686e-2)) * z + R(1.6666752422e-1);
    s.arc = p * z * v + v;
    return s;
}

FORMULA real r_asin(real x) {
    arc_of s = short_arc(fabs(x));
    real angle = choose(s.is_half, R(0.5) * R_PI - R(2.0) * s.arc, s.arc);
    return choose(x < R(0.0), -angle, angle);
}

FORMULA real r_acos(real x) {
    arc_of s = short_arc(fabs(x));
    mask below = x < R(0.0);
    real wide = R(0.5) * R_PI - choose(below, -s.arc, s.arc);
    real narrow = choose(below, R_PI - R(2.0) * s.arc, R(2.0) * s.arc);
    return choose(s.is_half, narrow, wide);
}

/* X times 2^N, N a whole number from -250 to 250: exact, but in two steps, since 2^128 is none. */
FORMULA real times_power(real x, real n) {
#if ASDIC_WIDTH == 1
    return ldexp(x, to_whole(n)); /* an instruction of GPUs */
#else
    whole power = to_whole(n), first = power >> 1;
    return x * as_real((first + 127) << 23) * as_real((power - first + 127) << 23);
#endif
}

/* exp(r) - 1 for |r| <= ln 2 / 2. */
FORMULA real small_expm1(real r) {
    real p = (R(1.9875691500e-4) * r + R(1.3981999507e-3)) * r + R(8.3334519073e-3);
    p = ((p * r + R(4.1665795894e-2)) * r + R(1.6666665459e-1)) * r + R(5.0000001201e-1);
    return p * r * r + r;
}

FORMULA real powers_in(real x) {
    return r_rint(x * R(1.44269504088896341));
}

FORMULA real rest_of(real x, real n) {
    return (x - n * R(0.693359375)) + n * R(2.12194440e-4);
}

/* INFINITY above 88.7, for X of at most 1e4. */
FORMULA real r_exp(real x) {
    x = r_max(x, R(-104.0));
#if ASDIC_WIDTH > 1 /* where the power is made of two */
    x = r_min(x, R(89.0));
#endif
    real n = powers_in(x);
    return times_power(small_expm1(rest_of(x, n)) + R(1.0), n);
}

FORMULA real r_expm1(real x) {
    x = r_min(r_max(x, R(-104.0)), R(89.0));
    real n = powers_in(x), small = small_expm1(rest_of(x, n));
    return choose(n == R(0.0), small, times_power(small + R(1.0), n) - R(1.0));
}

FORMULA real r_exp2(real x) {
    x = r_min(r_max(x, R(-150.0)), R(129.0));
    real n = r_rint(x), r = x - n;
    real p = (R(1.535336188319500e-4) * r + R(1.339887440266574e-3)) * r + R(9.618437357674640e-3);
    p = ((p * r + R(5.550332471162809e-2)) * r + R(2.402264791363012e-1)) * r;
    return times_power((p + R(6.931472028550421e-1)) * r + R(1.0), n);
}

FORMULA real r_exp10(real x) {
    x = r_min(r_max(x, R(-46.0)), R(39.0));
    real n = r_rint(x * R(3.32192809488736235));
    real r = (x - n * R(3.00781250e-1)) - n * R(2.48745663981195e-4);
    real p = (R(2.063216740311022e-1) * r + R(5.420251702225484e-1)) * r + R(1.171292686296281);
    p = ((p * r + R(2.034649854009453)) * r + R(2.650948748208892)) * r + R(2.302585167056758);
    return times_power(p * r + R(1.0), n);
}

/* Of what is not positive, -INFINITY. */
FORMULA real r_log(real x) {
    whole bits = as_whole(r_max(x, R(1.17549435e-38))), power = (bits - 0x3f3504f3) >> 23;
    real n = to_real(power), m = as_real(bits - (power << 23)) - R(1.0), z = m * m;
    real p = (R(7.0376836292e-2) * m - R(1.1514610310e-1)) * m + R(1.1676998740e-1);
    p = ((p * m - R(1.2420140846e-1)) * m + R(1.4249322787e-1)) * m - R(1.6668057665e-1);
    p = ((p * m + R(2.0000714765e-1)) * m - R(2.4999993993e-1)) * m + R(3.3333331174e-1);
    real y = p * m * z - n * R(2.12194440e-4) - R(0.5) * z;
    real log_x = (m + y) + n * R(0.693359375);
    log_x = choose(x > R(0.0), log_x, (real)(-INFINITY));
    return choose(x > R(3.4028234e38), x, log_x);
}

FORMULA real r_log10(real x) {
    return r_log(x) * R(0.434294481903251828);
}

/* Of positive X; a step of Newton makes up for what the exponential of a logarithm loses. */
FORMULA real r_cbrt(real x) {
    real y = r_exp(r_log(x) * R(0.333333333333333));
    return y - (y - x / (y * y)) * R(0.333333333333333);
}

/* PoCL's are macros as well. */
#undef sin
#undef cos
#undef atan2
#undef asin
#undef acos
#undef exp
#undef expm1
#undef exp2
#undef exp10
#undef log
#undef log10
#undef cbrt
#define sin(x) turned_sine(x, 0)
#define cos(x) turned_sine(x, 1)
#define atan2(y, x) r_atan2(y, x)
#define asin(x) r_asin(x)
#define acos(x) r_acos(x)
#define exp(x) r_exp(x)
#define expm1(x) r_expm1(x)
#define exp2(x) r_exp2(x)
#define exp10(x) r_exp10(x)
#define log(x) r_log(x)
#define log10(x) r_log10(x)
#define cbrt(x) r_cbrt(x)

#endif

#endif
