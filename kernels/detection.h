/*
 * Detection and false-alarm probabilities of an intensity z averaged over LOOKS independent looks.
 *
 * Null: exponential intensity of mean mu0 (Rayleigh envelope), or K-distributed with SHAPE nu, that
 * is an exponential whose mean is modulated by a unit-mean gamma texture common to the looks
 * (Abraham & Lyons, IEEE J. Oceanic Eng. 27, 800 (2002)). Target of mean intensity snr * mu0:
 * steady (Swerling 0, Marcum's Q), Swerling I or Swerling III, constant over the looks (Swerling,
 * IRE Trans. IT-6, 269 (1960)).
 *
 * Everything is one identity: with x = looks * threshold / mu0, P(z > threshold) is the chance that
 * a Poisson variate of mean x stays below looks + K, where K is Poisson of mean looks * snr for a
 * steady target and negative binomial for a fluctuating one. Sums of positive terms only, so tails
 * keep their relative accuracy.
 *
 * These loop, so REAL must be scalar here (host, or a device build of width 1).
 */
#ifndef ASDIC_KERNEL_DETECTION_H
#define ASDIC_KERNEL_DETECTION_H

#include "real.h"

/* Terms smaller than this share of their sum are left out; standard deviations below the mean of a
 * Poisson variate that this share needs (a float could not hold the terms any further down); and a
 * term so small that recursion from it would have lost its digits. LOUD: above this a steady
 * target's sum is long, and the envelope normal. */
#ifdef __OPENCL_C_VERSION__
#define DETECTION_EPSILON R(1.0e-9)
#define DETECTION_WIDTH R(6.5)
#define DETECTION_TINY R(1.0e-30)
#define DETECTION_LOUD R(1.0e5)
#else
#define DETECTION_EPSILON 1.0e-18
#define DETECTION_WIDTH 9.0
#define DETECTION_TINY 1.0e-280
#define DETECTION_LOUD 1.0e6
#endif

/* Steady target; the others carry the number of degrees of freedom over two. */
#define TARGET_STEADY 0
#define TARGET_SWERLING1 1
#define TARGET_SWERLING3 2

/* n ln(n / x) + x - n without cancellation; Loader, Fast and accurate computation of binomial
 * probabilities (2000). */
FORMULA real poisson_deviance(real n, real x) {
    real v = (n - x) / (n + x);
    if (r_abs(v) > R(0.1)) {
        return n * log(n / x) + x - n;
    }
    real sum = (n - x) * v, term = R(2.0) * n * v;
    for (int j = 1; j < 100; j++) {
        term *= v * v;
        real next = sum + term / (real)(2 * j + 1);
        if (next == sum) {
            break;
        }
        sum = next;
    }
    return sum;
}

/* e^-x x^n / n! for a whole N >= 0 and X >= 0. */
FORMULA real poisson_pmf(real n, real x) {
    if (x <= R(0.0)) {
        return choose(n == R(0.0), R(1.0), R(0.0));
    }
    if (n < R(16.0)) { /* the exponential in equal parts, since exp(-x) alone may underflow */
        real part = exp(-x / (n + R(1.0)));
        real term = part;
        for (real j = R(1.0); j <= n; j += R(1.0)) {
            term *= part * x / j;
        }
        return term;
    }
    real i = R(1.0) / n, i2 = i * i;
    real stirling = i * (R(1.0) / R(12.0) - i2 * (R(1.0) / R(360.0) - i2 * R(1.0) / R(1260.0)));
    return exp(-stirling - poisson_deviance(n, x)) / sqrt(R(2.0) * R_PI * n);
}

/* The chance that a Poisson variate of mean X stays below the whole number M >= 1: the regularised
 * upper incomplete gamma function Q(M, X). */
FORMULA real poisson_below(real m, real x) {
    real sum = R(0.0);
    if (m <= x) {
        real term = poisson_pmf(m - R(1.0), x);
        for (real j = m - R(1.0); j >= R(0.0) && term > DETECTION_EPSILON * sum; j -= R(1.0)) {
            sum += term;
            term *= j / x;
        }
        return sum;
    }
    real term = poisson_pmf(m, x);
    for (real j = m; term > DETECTION_EPSILON * sum; j += R(1.0)) {
        sum += term;
        term *= x / (j + R(1.0));
    }
    return R(1.0) - sum;
}

/* A whole number below which a Poisson variate of mean X hardly ever falls. */
FORMULA real poisson_low(real x) {
    return floor(r_max(x - DETECTION_WIDTH * sqrt(x) - R(20.0), R(0.0)));
}

/* Steady target, Y = looks * snr: sum over k of poisson(k; y) * P(poisson(x) < looks + k). The terms
 * that matter lie between y and, for small probabilities, the k beyond it where both tails meet. */
FORMULA real detection_steady(real x, real looks, real y) {
    if (x > DETECTION_LOUD || y > DETECTION_LOUD) {
        return R(0.5) * erfc(sqrt(x) - sqrt(y + looks - R(0.5)));
    }
    /* Chernoff: a miss is rarer than exp(-(sqrt y - sqrt x)^2) */
    if (sqrt(y) - sqrt(x) > R(7.0)) {
        return R(1.0);
    }
    real meet = R(0.5) * (sqrt(looks * looks + R(4.0) * x * y) - looks);
    if (x > y && poisson_pmf(floor(meet), y) * poisson_pmf(looks + floor(meet), x) <= R(0.0)) {
        return R(0.0);
    }
    real k = poisson_low(y), high = r_max(meet, y);
    real weight = poisson_pmf(k, y), step = poisson_pmf(looks + k, x);
    real below = poisson_below(looks + k, x);
    real sum = R(0.0);
    for (;; k += R(1.0)) {
        real term = weight * below;
        sum += term;
        if (k > high && term <= DETECTION_EPSILON * sum) {
            return r_min(sum, R(1.0));
        }
        below += step;
        step *= x / (looks + k + R(1.0));
        weight *= y / (k + R(1.0));
        if (step < DETECTION_TINY && k < x) {
            step = poisson_pmf(looks + k + R(1.0), x);
        }
    }
}

/* Gamma-distributed target of shape 1 (Swerling I) or 2 (Swerling III), Y = looks * snr / shape:
 * P(poisson(x) < looks) + sum over n >= 1 of poisson(looks + n - 1; x) q^n (1 [+ n (1 - q)]),
 * q = y / (1 + y). */
FORMULA real detection_fluctuating(real x, real looks, real y, int shape) {
    real rest = R(1.0) / (R(1.0) + y), q = y * rest;
    real mean = x * q;
    real extra = shape == TARGET_SWERLING3 ? rest : R(0.0);
    /* poisson(j; x) q^j = exp(-x (1 - q)) poisson(j; x q) */
    real loud = exp(-x * rest + (looks - R(1.0)) * log1p(R(1.0) / y));
    if (poisson_low(mean) > looks) { /* both Poisson sums are complete */
        return loud * (R(1.0) + extra * (mean - looks + R(1.0)));
    }
    real j = looks;
    real term = mean > looks ? loud * poisson_pmf(looks, mean) : poisson_pmf(looks, x) * q;
    real sum = R(0.0);
    for (;; j += R(1.0)) {
        real add = term * (R(1.0) + extra * (j - looks + R(1.0)));
        sum += add;
        if (j > mean && add <= DETECTION_EPSILON * sum) {
            break;
        }
        term *= mean / (j + R(1.0));
    }
    return r_min(poisson_below(looks, x) + sum, R(1.0));
}

/* P(z > THRESHOLD) for a null of unit mean, exponential per look; SNR 0: false alarm. The
 * threshold is at most 1e32, SNR at most 1e26. */
FORMULA real detection_exponential(real threshold, real snr, real looks, int target) {
    real x = looks * threshold;
    if (snr <= R(0.0)) {
        return x > DETECTION_LOUD ? R(0.0) : poisson_below(looks, x);
    }
    if (target == TARGET_STEADY) {
        return detection_steady(x, looks, looks * snr);
    }
    return detection_fluctuating(x, looks, looks * snr / (real)target, target);
}

/* The same averaged over the texture tau = e^v of the K distribution, weight
 * exp(nu (v - (e^v - 1))), by the trapezoidal rule: the integrand decays doubly exponentially above
 * and exponentially below, so the rule converges faster than any power of the step. Dividing by the
 * sum of the weights spares the gamma function. NOISE_SHARE of the mean is not modulated.
 * Threshold at most 1e12, SNR 1e6, since textures down to 1e-20 divide them. */
FORMULA real detection_k(real threshold, real snr, real looks, int target, real shape,
                         real noise_share) {
    real x = looks * threshold;
    real meet = r_max(R(0.5) * log(x / shape), R(0.0)); /* texture that dominates the tail */
    if (x <= R(0.0)) {
        return R(1.0);
    }
    real depth = R(45.0) + shape * (expm1(meet) - meet) + x * exp(-meet);
    real ratio = R(2.0) * depth / shape;
    real high = r_min(sqrt(ratio), log(R(1.0) + ratio) + R(1.0));
    real low = shape >= R(135.0) ? -sqrt(R(135.0) / shape) : -(R(45.0) / shape + R(1.0));
    real curvature = shape * exp(meet) + x * exp(-meet);
    real step = r_min(R(0.2), R(0.4) / sqrt(curvature));
    int first = (int)floor(low / step), last = (int)ceil(high / step);
    real sum = R(0.0), weights = R(0.0);
    for (int i = first; i <= last; i++) {
        real v = step * (real)i;
        real weight = exp(shape * (v - expm1(v)));
        real mean = r_max((R(1.0) - noise_share) * exp(v) + noise_share, R(1.0e-20));
        weights += weight;
        if (weight > R(0.0)) {
            sum += weight * detection_exponential(threshold / mean, snr / mean, looks, target);
        }
    }
    return r_min(sum / weights, R(1.0));
}

#endif
