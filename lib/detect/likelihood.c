/*
 * The log-likelihood ratio. With m looks, x = m z / mean and y = m snr, an intensity is gamma
 * distributed with shape m + K, K Poisson of mean y for a steady target and negative binomial of
 * order a = 1 (Swerling I) or 2 (III) for one that fluctuates (Swerling, IRE Trans. IT-6, 269
 * (1960)). But for a factor x^(m - 1) / Gamma(m) common to all, the densities are
 *
 *     none     e^-x
 *     steady   e^(-x - y) 0F1(m; x y)
 *     other    e^-x (1 - q)^a 1F1(a; m; q x),   q = (y / a) / (1 + y / a)
 *
 *
 * and, with a target that changes from look to look (Swerling II), e^(-x / (1 + snr)) (1 + snr)^-m;
 * hence for one look p1 / p0 = I0(2 sqrt(x y)) e^-y and, for Swerling I, e^(q x) / (1 + snr). The
 * series have positive terms and are summed from the largest one; far out their asymptotic forms
 * take over (Abramowitz & Stegun 9.7.1, 13.1.4). For K both densities are averaged over the texture
 * (Abraham & Lyons, IEEE J. Oceanic Eng. 27, 800 (2002)).
 */
#include "law.h"

#include "base/vec.h"

#include <math.h>

/* Terms below this share of their sum are left out. */
#define EPSILON 1e-18
/* ln of the share below which textures are left out, and how far apart they are: see texture_step. */
#define LOG_EPSILON (-24.0)
#define STEP 0.8
#define MOST_STEP 0.4
/* Textures are cut where nothing but the target is heard any more. */
#define LEAST_MEAN 1e-8
#define STEADY (double)INFINITY /* order of a target that does not fluctuate */

static double log_gamma(double x) {
    int sign;
    return lgamma_r(x, &sign);
}

/* ln of the sum over k of (a)_k c^k / (k! (m)_k); a STEADY: without (a)_k. */
static double log_series(double a, double m, double c) {
    /* Where the ratio of neighbours, (a + k) c / ((k + 1) (m + k)), is one. */
    bool is_steady = isinf(a);
    double half = 0.5 * (m + 1.0 - (is_steady ? 0.0 : c));
    double square = half * half - m + (is_steady ? c : a * c);
    double peak = square > 0.0 ? fmax(floor(sqrt(square) - half), 0.0) : 0.0;
    double log_peak = 0.0;
    if (peak > 0.0) {
        log_peak = log_gamma(m) - log_gamma(m + peak) - log_gamma(peak + 1.0) + peak * log(c);
        log_peak += is_steady ? 0.0 : log_gamma(a + peak) - log_gamma(a);
    }
    double sum = 1.0, term = 1.0;
    for (double k = peak; term > EPSILON * sum; k += 1.0) {
        term *= (is_steady ? 1.0 : a + k) * c / ((k + 1.0) * (m + k));
        sum += term;
    }
    term = 1.0;
    for (double k = peak - 1.0; k >= 0.0 && term > EPSILON * sum; k -= 1.0) {
        term *= (k + 1.0) * (m + k) / ((is_steady ? 1.0 : a + k) * c);
        sum += term;
    }
    return log_peak + log(sum);
}

/* ln 0F1(m; root^2) - 2 root. */
static double log_bessel(double m, double root) {
    double mu = 4.0 * (m - 1.0) * (m - 1.0), t = 2.0 * root;
    if (t < 1e4 + 30.0 * mu) {
        return log_series(STEADY, m, root * root) - t;
    }
    double e = 0.125 / t;
    double rest =
        1.0 - (mu - 1.0) * e * (1.0 - 0.5 * (mu - 9.0) * e * (1.0 - (mu - 25.0) * e / 3.0));
    return log_gamma(m) + (1.0 - m) * log(root) - 0.5 * log(2.0 * ASDIC_PI * t) + log(rest);
}

/* ln 1F1(a; m; c) - c for a = 1 or 2, whose asymptotic series end. */
static double log_kummer(double a, double m, double c) {
    if (a == m || c <= 0.0) {
        return 0.0;
    }
    if (c < m + 12.0 * sqrt(m) + 50.0) {
        return log_series(a, m, c) - c;
    }
    return log_gamma(m) + (a - m) * log(c) + log1p((1.0 - a) * (m - a) / c);
}

/* ln of the density of X with a target of mean SNR, less what is common to all. */
static double log_density(asdic_target target, double m, double x, double snr) {
    double y = m * snr;
    if (snr <= 0.0) {
        return -x;
    }
    if (target == ASDIC_TARGET_SWERLING2) {
        return -x / (1.0 + snr) - m * log(1.0 + snr);
    }
    if (target == ASDIC_TARGET_SWERLING0) {
        double apart = sqrt(x) - sqrt(y);
        return log_bessel(m, sqrt(x * y)) - apart * apart;
    }
    double a = target == ASDIC_TARGET_SWERLING1 ? 1.0 : 2.0, wide = 1.0 + y / a;
    return log_kummer(a, m, x * (y / a) / wide) - x / wide - a * log(wide);
}

/* A sum of exponentials, as its largest part and the sum re that. */
typedef struct log_sum {
    double largest, sum, last;
} log_sum;

/* Adds e^PART; false when it was negligible and less than the one before. */
static bool add(log_sum *s, double part) {
    bool is_rising = part >= s->last; /* false for NAN */
    s->last = part;
    if (part > s->largest) {
        s->sum = s->sum * exp(s->largest - part) + 1.0;
        s->largest = part;
        return true;
    }
    if (part - s->largest > LOG_EPSILON) {
        s->sum += exp(part - s->largest);
        return true;
    }
    return is_rising;
}

/* Densities without a target and with one, at one intensity. */
typedef struct averages {
    log_sum none, with;
} averages;

/* Adds the textures e^V from V on in steps of STEP until they matter for neither hypothesis. SNR 0: there is but one. */
static void add_textures(const asdic_background *b, asdic_target target, double x, double snr,
                         double v, double step, averages *to) {
    double m = (double)b->looks;
    to->none.last = to->with.last = -INFINITY;
    for (bool matters = true; matters; v += step) {
        double texture = exp(v);
        /* Rounded, where a kink would cost accuracy. */
        double heard = (1.0 - b->noise_share) * texture + b->noise_share;
        double mean = sqrt(heard * heard + LEAST_MEAN * LEAST_MEAN);
        double weight = b->shape * (v - texture) - m * log(mean);
        matters = add(&to->none, weight - x / mean);
        if (snr > 0.0) {
            matters |= add(&to->with, weight + log_density(target, m, x / mean, snr / mean));
        }
    }
}

/* The trapezoidal rule errs by the integrand's Fourier transform at 2 pi / step: of a normal peak
 * 2 exp(-2 pi^2 / STEP^2) = 8e-14, of the e^(-m v - x e^-v) that x gives 2 |gamma(m + 2 pi i / step)| / gamma(m): at
 * most 3e-7, for four looks, and likewise of shape. STEP is in standard deviations of the narrowest peak. Where
 * textured clutter is the share u of what is heard, a peak at e^v bends by m u^2 + shape (1 + 2 u (e^v - 1)), with
 * e^v at most what it is for u = 1, or 1: no noise and no target make it bend most, but for a steady target, which
 * takes its part of X or leaves textures to make up for it. As u (1 - u) is at most 1 / 4, noise keeps e^v below
 * 1 + x / (4 shape noise). */
static double texture_step(const asdic_background *b, asdic_target target, double x, double snr) {
    double m = (double)b->looks, most = x;
    if (target == ASDIC_TARGET_SWERLING0) {
        double apart = sqrt(x) - sqrt(m * snr);
        most = fmax(most, apart * apart);
    }
    most = fmin(most, m * ASDIC_DETECT_MOST);
    /* The root of shape (t - 1) = most / (share t) - m, of two forms that which subtracts no equals. */
    double clutter = most / fmax(1.0 - b->noise_share, LEAST_MEAN), half = 0.5 * (b->shape - m);
    double root = sqrt(half * half + b->shape * clutter);
    double peak = half > 0.0 ? (half + root) / b->shape : clutter / (root - half);
    peak = fmin(peak, 1.0 + 0.25 * most / (b->shape * fmax(b->noise_share, LEAST_MEAN)));
    return fmin(MOST_STEP, STEP / sqrt(m + b->shape * (2.0 * fmax(peak, 1.0) - 1.0)));
}

/* Both densities in K speckle, at an intensity of X; sums over textures STEP apart. */
static averages average_textures(const asdic_background *b, asdic_target target, double x,
                                 double snr, double *step) {
    const log_sum nothing = {-INFINITY, 0.0, 0.0};
    averages sums = {nothing, nothing};
    x = fmin(x, (double)b->looks * ASDIC_DETECT_MOST);
    *step = texture_step(b, target, x, snr);
    add_textures(b, target, x, snr, 0.0, *step, &sums);
    add_textures(b, target, x, snr, -*step, -*step, &sums);
    return sums;
}

double asdic_detect_log_density(const asdic_background *b, double intensity_lin) {
    double x = (double)b->looks * intensity_lin / b->mean_lin, step;
    averages sums = average_textures(b, ASDIC_TARGET_SWERLING2, x, 0.0, &step);
    return sums.none.largest + log(step * sums.none.sum);
}

double asdic_detect_llr(const asdic_background *b, asdic_target target, double target_lin,
                        double intensity_lin) {
    double m = (double)b->looks, x = m * intensity_lin / b->mean_lin,
           snr = target_lin / b->mean_lin, step;
    if (!asdic_background_is_good(b) || !asdic_target_is_known(target) || !(intensity_lin >= 0.0) ||
        !(target_lin >= 0.0) || isinf(m * snr / LEAST_MEAN)) {
        return NAN;
    }
    if (!(snr > 0.0)) {
        return 0.0;
    }
    if (b->shape > ASDIC_SHAPE_MAX || b->noise_share == 1.0) {
        return log_density(target, m, x, snr) + x;
    }
    averages sums = average_textures(b, target, x, snr, &step);
    return sums.with.largest - sums.none.largest + log(sums.with.sum / sums.none.sum);
}

double asdic_detect_posterior(double llr, double prior) {
    if (!(prior >= 0.0) || !(prior <= 1.0) || isnan(llr)) {
        return NAN;
    }
    return 1.0 / (1.0 + exp(-llr) * (1.0 - prior) / prior);
}

double asdic_detect_cost_llr(double prior, double cost_false_alarm, double cost_miss) {
    return log(cost_false_alarm * (1.0 - prior)) - log(cost_miss * prior);
}
