/*
 * Shares, their differences, and their bounds.
 */
#include <asdic/trial.h>

#include "detect/law.h"

#include <math.h>

/* Above this many discordant pairs the binomial law of McNemar's test is a normal one to all digits that
 * matter. */
#define MOST_EXACT 100000

asdic_trial_figure asdic_trial_share(uint64_t events, uint64_t trials, double level) {
    asdic_estimate e = asdic_estimate_within(events, trials, level);
    return (asdic_trial_figure){e.value, e.low, e.high};
}

/* Tango's score of the difference D: how many standard errors the pairs are off, where B and C of N
 * are discordant. The variance is that under D, with the probability q of the second kind at its
 * likeliest: 2 n q^2 + (2 n d - b - c - d (b - c) ... ) as there, (6) to (10). */
static double score(double b, double c, double n, double d) {
    double linear = -b - c + (2.0 * n - b + c) * d, rest = -c * d * (1.0 - d);
    double q = (sqrt(fmax(linear * linear - 8.0 * n * rest, 0.0)) - linear) / (4.0 * n);
    double variance = n * (2.0 * q + d * (1.0 - d));
    double off = b - c - n * d;
    return off == 0.0 ? 0.0 : off / sqrt(fmax(variance, 1e-300));
}

/* Where the score is WANTED, which falls as the difference grows. */
static double solve(double b, double c, double n, double wanted) {
    double low = -1.0, high = 1.0;
    for (int i = 0; i < 80; i++) {
        double middle = 0.5 * (low + high);
        *(score(b, c, n, middle) > wanted ? &low : &high) = middle;
    }
    return 0.5 * (low + high);
}

asdic_trial_figure asdic_trial_paired(uint64_t first, uint64_t second, uint64_t pairs,
                                      double level) {
    if (pairs == 0 || first > pairs || second > pairs - first) {
        return (asdic_trial_figure){NAN, -1.0, 1.0};
    }
    double b = (double)first, c = (double)second, n = (double)pairs, z = asdic_normal_bound(level);
    return (asdic_trial_figure){(b - c) / n, solve(b, c, n, z), solve(b, c, n, -z)};
}

double asdic_trial_mcnemar(uint64_t first, uint64_t second) {
    uint64_t n = first + second, least = first < second ? first : second;
    if (n == 0) {
        return 1.0;
    }
    if (n > MOST_EXACT) {
        return erfc((double)(n - 2 * least) / sqrt(2.0 * (double)n));
    }
    double sum = 0.0;
    for (uint64_t k = 0; k <= least; k++) {
        sum += exp(lgamma((double)n + 1.0) - lgamma((double)k + 1.0) -
                   lgamma((double)(n - k) + 1.0) - (double)n * M_LN2);
    }
    return fmin(2.0 * sum, 1.0);
}
