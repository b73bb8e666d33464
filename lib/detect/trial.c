/*
 * Monte Carlo detection: intensities drawn look by look, and probabilities counted.
 */
#include "law.h"

#include "base/vec.h"
#include "sim/variates.h"

#include "../../kernels/detection.h"
#include "../../kernels/random.h"

#include <math.h>

/* 99 % of a normal variate lie within so many standard deviations. */
#define NORMAL_99 2.5758293035489004

/* As many events, and trials without one, are normally distributed to all digits that matter. */
#define MANY 1e9

/* Events of K in N trials are rarer than TAIL at P: P(X <= k) or P(X >= k) of a binomial variate,
 * by the sum from the largest term on, relative to which the rest of the terms is below EPSILON. */
static double binomial_tail(double k, double n, double p, bool upper) {
    double step = upper ? 1.0 : -1.0, term = 1.0, sum = 0.0;
    for (double j = k; j >= 0.0 && j <= n && term > 1e-15 * sum; j += step) {
        sum += term;
        term *= upper ? (n - j) * p / ((j + 1.0) * (1.0 - p)) : j * (1.0 - p) / ((n - j + 1.0) * p);
    }
    /* Of n events of a Poisson process, which has no factorials of n to cancel, k are of the one kind. */
    return sum * poisson_pmf(k, n * p) * poisson_pmf(n - k, n * (1.0 - p)) / poisson_pmf(n, n);
}

/* The probability at which the tail beyond K is TAIL. */
static double bound(double k, double n, bool upper, double tail) {
    double low = upper ? 0.0 : k / n, high = upper ? k / n : 1.0;
    while (high - low > 1e-15 * high) {
        double middle = 0.5 * (low + high);
        bool is_rare = binomial_tail(k, n, middle, upper) < tail;
        if (is_rare == upper) {
            low = middle;
        } else {
            high = middle;
        }
    }
    return 0.5 * (low + high);
}

double asdic_normal_bound(double level) {
    double low = 0.0, high = 40.0;
    for (int i = 0; i < 80; i++) {
        double middle = 0.5 * (low + high);
        *(erfc(middle * M_SQRT1_2) > 1.0 - level ? &low : &high) = middle;
    }
    return 0.5 * (low + high);
}

asdic_estimate asdic_estimate_of(uint64_t events, uint64_t trials) {
    return asdic_estimate_within(events, trials, 0.99);
}

asdic_estimate asdic_estimate_within(uint64_t events, uint64_t trials, double level) {
    double k = (double)events, n = (double)trials, tail = 0.5 * (1.0 - level);
    if (trials == 0 || events > trials) {
        return (asdic_estimate){NAN, 0.0, 1.0};
    }
    if (fmin(k, n - k) > MANY) {
        double half = asdic_normal_bound(level) * sqrt(k / n * (1.0 - k / n) / n);
        return (asdic_estimate){k / n, k / n - half, k / n + half};
    }
    return (asdic_estimate){.value = k / n,
                            .low = events == 0 ? 0.0 : bound(k, n, true, tail),
                            .high = events == trials ? 1.0 : bound(k, n, false, tail)};
}

/* A target's power in all looks re its mean; 0 where IS_NOTHING. Takes two numbers, whichever it
 * needs. */
static double draw_fluctuation(asdic_target target, bool is_nothing, asdic_variates *v) {
    if (is_nothing) {
        asdic_variates_skip(v);
        return 0.0;
    }
    double first = asdic_variates_uniform(v), second = asdic_variates_uniform(v);
    return target == ASDIC_TARGET_SWERLING1   ? -log(first)
           : target == ASDIC_TARGET_SWERLING3 ? -0.5 * (log(first) + log(second))
                                              : 1.0;
}

/* One intensity re the background's mean. The order of the numbers is fixed: two for the target,
 * two a look, and the texture's, of which there may be any number, last but drawn from a cell of
 * their own. */
static double draw_one(const asdic_background *b, asdic_target target, double snr, uint64_t seed,
                       uint64_t index) {
    asdic_variates v = asdic_variates_begin(RANDOM_TRIAL, seed, index, 0);
    bool is_looks = target == ASDIC_TARGET_SWERLING2; /* one more part of every look's amplitude */
    double power = snr * draw_fluctuation(target, is_looks || !(snr > 0.0), &v);
    double mean = 1.0, sum = 0.0;
    if (b->shape <= ASDIC_SHAPE_MAX) {
        asdic_variates t = asdic_variates_begin(RANDOM_TRIAL, seed, index, 1);
        double texture = asdic_variates_gamma(&t, b->shape) / b->shape;
        mean = (1.0 - b->noise_share) * texture + b->noise_share;
    }
    if (is_looks) {
        mean += snr;
    }
    double amplitude = sqrt(power), scale = sqrt(mean);
    for (unsigned look = 0; look < b->looks; look++) {
        double radius2 = asdic_variates_exponential(&v), phase = asdic_variates_uniform(&v);
        sum += mean * radius2;
        if (power > 0.0) { /* |a + n|^2 = |n|^2 + 2 a Re n + a^2 */
            double in_phase = scale * sqrt(radius2) * cos(2.0 * ASDIC_PI * phase);
            sum += amplitude * (2.0 * in_phase + amplitude);
        }
    }
    return sum / (double)b->looks;
}

void asdic_detect_draw(const asdic_background *b, asdic_target target, double target_lin,
                       uint64_t seed, uint64_t first, size_t count, double *out) {
    double snr = target_lin / b->mean_lin;
    for (size_t i = 0; i < count; i++) {
        out[i] = b->mean_lin * draw_one(b, target, snr, seed, first + i);
    }
}

asdic_estimate asdic_detect_simulate(const asdic_background *b, asdic_target target,
                                     double target_lin, double threshold_lin, uint64_t trials,
                                     uint64_t seed) {
    uint64_t events = 0;
    double snr = target_lin / b->mean_lin, threshold = threshold_lin / b->mean_lin;
    for (uint64_t i = 0; i < trials; i++) {
        events += draw_one(b, target, snr, seed, i) > threshold;
    }
    return asdic_estimate_of(events, trials);
}

static bool is_k(const asdic_background *b) {
    return b->shape <= ASDIC_SHAPE_MAX && b->noise_share < 1.0;
}

asdic_rare_draw asdic_rare_draw_one(const asdic_background *b, uint64_t seed, uint64_t index) {
    asdic_variates v = asdic_variates_begin(RANDOM_TRIAL, seed, index, 2);
    double speckle = asdic_variates_gamma(&v, (double)b->looks);
    return (asdic_rare_draw){speckle, is_k(b) ? asdic_variates_gamma(&v, b->shape) : 0.0};
}

/* What the sums of WEIGHTS, their squares and their cubes bound at 99 %, which most of them being 0 skew: by the
 * monotone cubic that makes the studentised mean of N all but normal (Hall, J. R. Stat. Soc. B 54, 221 (1992), his g3;
 * error O(1/n)),
 *
 *     g(t) = t + skew t^2 / 3 + skew^2 t^3 / 27 + skew / (6 n),   t = (mean - true) / standard deviation. */
static asdic_estimate skewed_of(double sum, double squares, double cubes, double n) {
    double value = sum / n, variance = fmax(squares / n - value * value, 0.0);
    double sd = sqrt(variance), t[2];
    double third = cubes / n - 3.0 * value * squares / n + 2.0 * pow(value, 3);
    double skew = sd > 0.0 ? third / (variance * sd) : 0.0;
    for (int high = 0; high < 2; high++) {
        double g = (high ? -NORMAL_99 : NORMAL_99) / sqrt(n) - skew / (6.0 * n);
        t[high] = fabs(skew) > 1e-6 ? 3.0 / skew * (cbrt(1.0 + skew * g) - 1.0) : g;
    }
    return (asdic_estimate){value, fmax(value - t[0] * sd, 0.0), value - t[1] * sd};
}

/* Speckle from a gamma law wider by THETA and texture from one wider by BETA, whose means are where the
 * tail is largest: the least g + t - (m - shape) log t along g t = m shape threshold (detection_k).
 * The weight is the ratio of the true densities to these. */
static asdic_estimate rare_of(const asdic_background *b, double threshold_lin,
                              const asdic_rare_draw *draws, uint64_t trials, uint64_t seed) {
    double m = (double)b->looks, threshold = threshold_lin / b->mean_lin;
    bool has_texture = is_k(b);
    double share = has_texture ? b->noise_share : 1.0, beta = 1.0;
    if (has_texture) {
        double apart = 0.5 * (m - b->shape);
        beta = fmax((sqrt(apart * apart + m * b->shape * threshold) - apart) / b->shape, 1.0);
    }
    double theta = fmax(threshold / ((1.0 - share) * beta + share), 1.0);
    /* Of a draw at the means; weights are kept relative to it, since cubes of 1e-109 are none. */
    double log_scale = m * (log(theta) - theta + 1.0);
    if (has_texture) {
        log_scale += b->shape * (log(beta) - beta + 1.0);
    }
    double sum = 0.0, squares = 0.0, cubes = 0.0;
    for (uint64_t i = 0; i < trials; i++) {
        asdic_rare_draw draw = draws ? draws[i] : asdic_rare_draw_one(b, seed, i);
        double log_weight = (m - draw.speckle) * (theta - 1.0), mean = 1.0;
        if (has_texture) {
            log_weight += (b->shape - draw.texture) * (beta - 1.0);
            mean = (1.0 - share) * beta * draw.texture / b->shape + share;
        }
        if (mean * theta * draw.speckle / m > threshold) {
            double weight = exp(log_weight);
            sum += weight;
            squares += weight * weight;
            cubes += weight * weight * weight;
        }
    }
    asdic_estimate e = skewed_of(sum, squares, cubes, (double)trials);
    double scale = sum > 0.0 ? exp(log_scale) : 0.0; /* nothing is above INFINITY */
    return (asdic_estimate){scale * e.value, scale * e.low, scale * e.high};
}

asdic_estimate asdic_rare_estimate(const asdic_background *b, double threshold_lin,
                                   const asdic_rare_draw *draws, size_t count) {
    return rare_of(b, threshold_lin, draws, count, 0);
}

asdic_estimate asdic_detect_simulate_rare(const asdic_background *b, double threshold_lin,
                                          uint64_t trials, uint64_t seed) {
    return rare_of(b, threshold_lin, NULL, trials, seed);
}
