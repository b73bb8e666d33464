/* False alarms, detections and likelihoods: closed forms against draws, and against each other. */
#include "asserts.h"
#include "test_context.h"

#include <asdic/detect.h>

#define TRIALS 1000000u

static const asdic_background backgrounds[] = {
    {1.0, 1, INFINITY, 0.0}, {2e-11, 4, INFINITY, 0.0}, {3.0, 7, INFINITY, 0.3},
    {1.0, 1, 0.7, 0.0},      {5.0, 1, 4.0, 0.5},        {1e-9, 6, 1.5, 0.1},
};
#define BACKGROUNDS (sizeof backgrounds / sizeof *backgrounds)

static void assert_inside(const char *what, double expected, asdic_estimate e) {
    if (!(expected >= e.low && expected <= e.high)) {
        fail_msg("%s: %.6g measured %.6g [%.6g, %.6g]", what, expected, e.value, e.low, e.high);
    }
}

/* P_FA counted within its binomial bounds of 99 % at 1e6 draws, from 1e-1 to 1e-5. */
static void false_alarms_are_as_designed(void **state) {
    (void)state;
    for (size_t i = 0; i < BACKGROUNDS; i++) {
        const asdic_background *b = &backgrounds[i];
        static double z[TRIALS];
        asdic_detect_draw(b, ASDIC_TARGET_SWERLING1, 0.0, 20 + i, 0, TRIALS, z);
        for (double pfa = 0.1; pfa > 0.9e-5; pfa *= 0.1) {
            double threshold;
            uint64_t events = 0;
            assert_ok(ctx, asdic_detect_threshold(ctx, b, pfa, &threshold));
            assert_close_relative(asdic_detect_pfa(b, threshold), pfa, 1e-9);
            for (size_t k = 0; k < TRIALS; k++) {
                events += z[k] > threshold;
            }
            assert_inside("P_FA", pfa, asdic_estimate_of(events, TRIALS));
        }
    }
}

/* Down to 1e-9 by importance sampling, with less error than counting 1e5 events would have. */
static void rare_false_alarms(void **state) {
    (void)state;
    for (size_t i = 0; i < BACKGROUNDS; i++) {
        const asdic_background *b = &backgrounds[i];
        for (double pfa = 1e-3; pfa > 0.9e-9; pfa *= 1e-3) {
            double threshold;
            assert_ok(ctx, asdic_detect_threshold(ctx, b, pfa, &threshold));
            asdic_estimate e = asdic_detect_simulate_rare(b, threshold, 100000, 40 + i);
            assert_inside("rare P_FA", pfa, e);
            assert_true(e.high - e.low < 0.2 * pfa);
        }
    }
}

/* As rare as numbers go, and rarer: exp(-threshold) of one look. */
static void the_rarest_have_bounds(void **state) {
    (void)state;
    const asdic_background one_look = {1.0, 1, INFINITY, 0.0};
    for (double threshold = 240.0; threshold < 710.0; threshold += 10.0) {
        asdic_estimate e = asdic_detect_simulate_rare(&one_look, threshold, 10000, 7);
        assert_inside("rarest P_FA", exp(-threshold), e);
        assert_true(e.low > 0.0 && e.high < 10.0 * e.low);
    }
    asdic_estimate none = asdic_detect_simulate_rare(&one_look, INFINITY, 100, 7);
    assert_close(none.value, 0.0, 0.0);
    assert_close(none.high, 0.0, 0.0);
}

/* Bounds of few trials hold what they should, though most weights are 0 and few are large. Symmetrical bounds did in 123
 * to 195 of 200, of 30 looks in the fewest, where draws were not round the largest part of the tail. */
static void few_trials_have_bounds(void **state) {
    (void)state;
    enum { SEEDS = 200 };
    const asdic_background spiky[] = {{1.0, 1, 0.3, 0.0}, {1.0, 7, 0.3, 0.2}, {1.0, 30, 0.3, 0.0}};
    for (size_t i = 0; i < sizeof spiky / sizeof *spiky; i++) {
        for (double pfa = 1e-3; pfa > 0.9e-9; pfa *= 1e-3) {
            double threshold;
            unsigned held = 0;
            assert_ok(ctx, asdic_detect_threshold(ctx, &spiky[i], pfa, &threshold));
            for (uint64_t seed = 1; seed <= SEEDS; seed++) {
                asdic_estimate e = asdic_detect_simulate_rare(&spiky[i], threshold, 1000, seed);
                held += e.low <= pfa && pfa <= e.high;
            }
            print_message("%u looks, noise %g, P_FA %.0e: %u of %d\n", spiky[i].looks,
                          spiky[i].noise_share, pfa, held, SEEDS);
            assert_true(held >= 194); /* 99 %, less three standard deviations */
        }
    }
}

static void detections_are_as_predicted(void **state) {
    (void)state;
    for (size_t i = 0; i < BACKGROUNDS; i++) {
        const asdic_background *b = &backgrounds[i];
        for (int t = 0; t < 4; t++) {
            double threshold, target = (t % 3 + 1) * 3.0 * b->mean_lin;
            assert_ok(ctx, asdic_detect_threshold(ctx, b, 1e-2, &threshold));
            double pd = asdic_detect_pd(b, (asdic_target)t, target, threshold);
            assert_true(pd > 0.04 && pd < 1.0);
            assert_inside("P_D", pd,
                          asdic_detect_simulate(b, (asdic_target)t, target, threshold, TRIALS,
                                                700 + 4 * i + (size_t)t));
        }
    }
}

/* The densities' ratio by differences of the tails. */
static double ratio_of_tails(const asdic_background *b, asdic_target target, double s, double z) {
    double h = 1e-4 * z;
    double none = asdic_detect_pfa(b, z - h) - asdic_detect_pfa(b, z + h);
    return log((asdic_detect_pd(b, target, s, z - h) - asdic_detect_pd(b, target, s, z + h)) /
               none);
}

static void likelihood_is_the_densities_ratio(void **state) {
    (void)state;
    for (size_t i = 0; i < BACKGROUNDS; i++) {
        const asdic_background *b = &backgrounds[i];
        for (int t = 0; t < 4; t++) {
            for (double snr = 0.1; snr < 200.0; snr *= 10.0) {
                for (double x = 0.05; x < 9.0; x *= 2.0) {
                    double s = snr * b->mean_lin, z = x * b->mean_lin;
                    double llr = asdic_detect_llr(b, (asdic_target)t, s, z);
                    assert_true(isfinite(llr));
                    /* Above what differences resolve; where a steady target alone would be, the
                     * density of K clutter has a cusp, which they cut. */
                    bool is_cusp = t == 0 && isfinite(b->shape) && fabs(x - snr) < 1e-3 * x;
                    if (llr > -12.0 && !is_cusp) {
                        assert_close(llr, ratio_of_tails(b, (asdic_target)t, s, z),
                                     3e-6 * fmax(1.0, exp(-llr)));
                    }
                }
            }
        }
    }
}

static void known_likelihoods(void **state) {
    (void)state;
    asdic_background b = {2.0, 1, INFINITY, 0.0};
    /* -ln(1 + snr) + z S / (mu0 (mu0 + S)); -S / mu0 + ln I0(2 sqrt(z S) / mu0), I0(4) = 11.30192 */
    assert_close(asdic_detect_llr(&b, ASDIC_TARGET_SWERLING1, 6.0, 5.0),
                 -log(4.0) + 5.0 * 6.0 / (2.0 * 8.0), 1e-13);
    assert_close(asdic_detect_llr(&b, ASDIC_TARGET_SWERLING0, 8.0, 2.0),
                 -4.0 + log(11.301921952136330), 1e-13);
    /* far out: I0(x) -> e^x / sqrt(2 pi x) (1 + 1 / (8 x)) */
    double x = 2.0 * sqrt(1e4 * 1e4);
    b.mean_lin = 1.0;
    assert_close(asdic_detect_llr(&b, ASDIC_TARGET_SWERLING0, 1e4, 1e4),
                 x - 1e4 - 0.5 * log(2.0 * 3.14159265358979 * x) + 0.125 / x, 1e-7);
    /* A large shape is Rayleigh. */
    asdic_background k = {1.0, 3, 1000.0, 0.0}, r = {1.0, 3, INFINITY, 0.0};
    assert_close(asdic_detect_llr(&k, ASDIC_TARGET_SWERLING3, 4.0, 3.0),
                 asdic_detect_llr(&r, ASDIC_TARGET_SWERLING3, 4.0, 3.0), 0.015);
    /* Strong clutter explains strong returns: the ratio saturates. */
    asdic_background spiky = {1.0, 1, 0.2, 0.0};
    assert_true(asdic_detect_llr(&spiky, ASDIC_TARGET_SWERLING1, 10.0, 1e4) < 5.0);
    assert_true(isfinite(asdic_detect_llr(&spiky, ASDIC_TARGET_SWERLING0, 1e3, 0.0)));
    assert_true(isfinite(asdic_detect_llr(&spiky, ASDIC_TARGET_SWERLING0, 1e-3, 1e9)));
    b.looks = 0;
    assert_true(isnan(asdic_detect_llr(&b, ASDIC_TARGET_SWERLING1, 6.0, 5.0)));
    assert_true(isnan(asdic_detect_pfa(&b, 1.0)));
}

static void bayes_and_costs(void **state) {
    (void)state;
    assert_close(asdic_detect_posterior(0.0, 0.01), 0.01, 1e-15);
    assert_close(asdic_detect_posterior(log(99.0), 0.01), 0.5, 1e-14);
    assert_close(asdic_detect_posterior(800.0, 1e-9), 1.0, 0.0);
    assert_close(asdic_detect_posterior(-800.0, 0.9), 0.0, 1e-300);
    /* Equal costs: where the posterior is one half. */
    double llr = asdic_detect_cost_llr(0.01, 1.0, 1.0);
    assert_close(asdic_detect_posterior(llr, 0.01), 0.5, 1e-14);
    asdic_background b = {2.0, 3, INFINITY, 0.0};
    double threshold;
    llr = asdic_detect_cost_llr(0.01, 1.0, 20.0);
    assert_ok(ctx,
              asdic_detect_threshold_llr(ctx, &b, ASDIC_TARGET_SWERLING1, 9.0, llr, &threshold));
    assert_close(asdic_detect_llr(&b, ASDIC_TARGET_SWERLING1, 9.0, threshold), llr, 1e-10);
    /* No threshold costs less than that of the costs. */
    for (double factor = 0.8; factor < 1.3; factor += 0.05) {
        double cost[2];
        for (int i = 0; i < 2; i++) {
            double g = i ? factor * threshold : threshold;
            cost[i] = 0.99 * asdic_detect_pfa(&b, g) +
                      20.0 * 0.01 * (1.0 - asdic_detect_pd(&b, ASDIC_TARGET_SWERLING1, 9.0, g));
        }
        assert_true(cost[0] <= cost[1] * (1.0 + 1e-9));
    }
    asdic_background spiky = {1.0, 1, 0.2, 0.0};
    assert_ok(ctx, asdic_detect_threshold_llr(ctx, &spiky, ASDIC_TARGET_SWERLING1, 10.0, 30.0,
                                              &threshold));
    assert_true(isinf(threshold));
}

/* Clopper & Pearson, Biometrika 26, 404 (1934): 0 of n gives 1 - (alpha/2)^(1/n); others from the beta
 * quantiles of R's binom.test. */
static void bounds_of_counts(void **state) {
    (void)state;
    asdic_estimate e = asdic_estimate_of(0, 100);
    assert_close(e.low, 0.0, 0.0);
    assert_close(e.high, 1.0 - pow(0.005, 0.01), 1e-12);
    e = asdic_estimate_of(100, 100);
    assert_close(e.low, pow(0.005, 0.01), 1e-12);
    assert_close(e.high, 1.0, 0.0);
    /* Far from the ends nearly normal: 2.5758 sqrt(p q / n). */
    e = asdic_estimate_of(300000, 1000000);
    assert_close(e.high - e.low, 2.0 * 2.5758293 * sqrt(0.21 / 1e6), 5e-6);
    assert_close(e.value, 0.3, 1e-15);
    assert_true(isnan(asdic_estimate_of(0, 0).value));
    /* Of ever more trials the law of ten events is Poisson's: 3.7169 and 21.398 events (Garwood, Biometrika 28, 437
     * (1936)); of as many others the law of half of them a normal one. */
    for (double n = 1e9; n < 1e19; n *= 10.0) {
        e = asdic_estimate_of(10, (uint64_t)n);
        assert_close(e.low * n, 3.7169, 1e-4);
        assert_close(e.high * n, 21.398, 1e-3);
        e = asdic_estimate_of((uint64_t)n / 2, (uint64_t)n);
        assert_close_relative(e.high - 0.5, 2.5758293 * sqrt(0.25 / n), 2e-5);
        assert_close_relative(0.5 - e.low, 2.5758293 * sqrt(0.25 / n), 2e-5);
    }
}

/* One seed, two targets: what differs is the target. */
static void draws_are_paired(void **state) {
    (void)state;
    enum { COUNT = 4000 };
    static double a[COUNT], b[COUNT], c[COUNT];
    asdic_background k = {1.0, 3, 0.8, 0.2};
    asdic_detect_draw(&k, ASDIC_TARGET_SWERLING1, 1.00, 5, 0, COUNT, a);
    asdic_detect_draw(&k, ASDIC_TARGET_SWERLING1, 1.01, 5, 0, COUNT, b);
    asdic_detect_draw(&k, ASDIC_TARGET_SWERLING1, 1.00, 5, 1000, COUNT - 1000, c);
    for (int i = 0; i < COUNT; i++) {
        assert_true(fabs(a[i] - b[i]) < 0.02 * (a[i] + 10.0));
        assert_true(i < 1000 || a[i] == c[i - 1000]);
    }
}

static void wrong_arguments(void **state) {
    (void)state;
    double threshold;
    asdic_background b = {1.0, 1, INFINITY, 0.0}, no_looks = {1.0, 0, INFINITY, 0.0};
    assert_status(ctx, asdic_detect_threshold(ctx, &no_looks, 0.1, &threshold),
                  ASDIC_ERROR_ARGUMENT);
    assert_status(ctx, asdic_detect_threshold(ctx, &b, 0.0, &threshold), ASDIC_ERROR_ARGUMENT);
    assert_contains(asdic_context_error(ctx), "probability of 0");
    assert_status(ctx,
                  asdic_detect_threshold_llr(ctx, &b, ASDIC_TARGET_SWERLING1, 0.0, 1.0, &threshold),
                  ASDIC_ERROR_ARGUMENT);
    for (int kind = -1; kind <= 7; kind += 8) {
        assert_true(isnan(asdic_detect_pd(&b, (asdic_target)kind, 10.0, 2.0)));
        assert_true(isnan(asdic_detect_llr(&b, (asdic_target)kind, 10.0, 2.0)));
        assert_status(ctx,
                      asdic_detect_threshold_llr(ctx, &b, (asdic_target)kind, 1.0, 1.0, &threshold),
                      ASDIC_ERROR_ARGUMENT);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(false_alarms_are_as_designed),
        cmocka_unit_test(rare_false_alarms),
        cmocka_unit_test(the_rarest_have_bounds),
        cmocka_unit_test(few_trials_have_bounds),
        cmocka_unit_test(detections_are_as_predicted),
        cmocka_unit_test(likelihood_is_the_densities_ratio),
        cmocka_unit_test(known_likelihoods),
        cmocka_unit_test(bayes_and_costs),
        cmocka_unit_test(bounds_of_counts),
        cmocka_unit_test(draws_are_paired),
        cmocka_unit_test(wrong_arguments),
    };
    return cmocka_run_group_tests(tests, context_begin, context_end);
}
