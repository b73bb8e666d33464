/* False alarms, detections, likelihoods and thresholds where a line of algebra tells them, and the limits of all. */
#include "asserts.h"
#include "test_context.h"

#include "detect/law.h"

#define MEAN 2.0

static const asdic_background one_look = {MEAN, 1, INFINITY, 0.0};
static const asdic_background three_looks = {MEAN, 3, INFINITY, 0.0};

static void backgrounds_have_limits(void **state) {
    (void)state;
    static const struct {
        asdic_background is;
        bool is_good;
    } cases[] = {
        {{1.0, 1, INFINITY, 0.0}, true},       {{1e-30, 1000, INFINITY, 1.0}, true},
        {{1.0, 1, 0.05, 0.5}, true},           {{1.0, 0, INFINITY, 0.0}, false},
        {{1.0, 1001, INFINITY, 0.0}, false},   {{1.0, 1, 0.0499, 0.0}, false},
        {{1.0, 1, NAN, 0.0}, false},           {{1.0, 1, INFINITY, -1e-9}, false},
        {{1.0, 1, INFINITY, 1.000001}, false}, {{0.0, 1, INFINITY, 0.0}, false},
        {{-1.0, 1, INFINITY, 0.0}, false},     {{INFINITY, 1, INFINITY, 0.0}, false},
        {{NAN, 1, INFINITY, 0.0}, false},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        const asdic_background *b = &cases[i].is;
        asdic_status right = cases[i].is_good ? ASDIC_OK : ASDIC_ERROR_ARGUMENT;
        double t;
        assert_int_equal(isnan(asdic_detect_pfa(b, 1.0)), !cases[i].is_good);
        for (int k = 0; k < 4; k++) {
            assert_int_equal(isnan(asdic_detect_pd(b, (asdic_target)k, 1.0, 1.0)),
                             !cases[i].is_good);
            assert_int_equal(isnan(asdic_detect_llr(b, (asdic_target)k, 1.0, 1.0)),
                             !cases[i].is_good);
        }
        assert_status(ctx, asdic_detect_threshold(ctx, b, 0.1, &t), right);
        assert_status(ctx, asdic_detect_threshold_llr(ctx, b, ASDIC_TARGET_SWERLING1, 1.0, 0.1, &t),
                      right);
    }
    assert_contains(asdic_context_error(ctx), "(must be above 0), 1 looks (1..1000)");
}

/* With x the intensity over the background's mean: e^-x; with a target of mean snr that is exponential,
 * e^(-x / (1 + snr)); with one of four degrees of freedom, e^(-x / w) (1 + x (w - 1) / w^2), w = 1 + snr / 2. */
static void one_look_is_exponential(void **state) {
    (void)state;
    for (double x = 0.25; x < 20.0; x *= 3.0) {
        for (double snr = 0.5; snr < 30.0; snr *= 4.0) {
            double z = MEAN * x, target = MEAN * snr, wide = 1.0 + 0.5 * snr;
            double first = exp(-x / (1.0 + snr)), gain = snr * x / (1.0 + snr) - log(1.0 + snr);
            double third = exp(-x / wide) * (1.0 + x * (wide - 1.0) / (wide * wide));
            double q = 1.0 - 1.0 / wide, third_gain = q * x + log1p(q * x) - 2.0 * log(wide);
            const struct {
                asdic_target target;
                double pd, llr;
            } right[] = {{ASDIC_TARGET_SWERLING1, first, gain},
                         {ASDIC_TARGET_SWERLING2, first, gain},
                         {ASDIC_TARGET_SWERLING3, third, third_gain}};
            assert_close_relative(asdic_detect_pfa(&one_look, z), exp(-x), 1e-6);
            for (int i = 0; i < 3; i++) {
                assert_close_relative(asdic_detect_pd(&one_look, right[i].target, target, z),
                                      right[i].pd, 1e-6);
                assert_close(asdic_detect_llr(&one_look, right[i].target, target, z), right[i].llr,
                             1e-9);
            }
        }
    }
}

/* x = 3 z / mean: e^-x (1 + x + x^2 / 2). A target that changes from look to look only raises the mean; one that does
 * not has 1F1(1; 3; c) = 2 (e^c - 1 - c) / c^2, c = x 3 snr / (1 + 3 snr). */
static void three_looks_are_gamma_distributed(void **state) {
    (void)state;
    for (double x = 0.5; x < 30.0; x *= 2.0) {
        double z = x * MEAN / 3.0, snr = 4.0, c = x * 12.0 / 13.0, low = x / 5.0;
        assert_close_relative(asdic_detect_pfa(&three_looks, z), exp(-x) * (1.0 + x + 0.5 * x * x),
                              1e-6);
        assert_close_relative(asdic_detect_pd(&three_looks, ASDIC_TARGET_SWERLING2, snr * MEAN, z),
                              exp(-low) * (1.0 + low + 0.5 * low * low), 1e-6);
        assert_close(asdic_detect_llr(&three_looks, ASDIC_TARGET_SWERLING2, snr * MEAN, z),
                     x * snr / (1.0 + snr) - 3.0 * log(1.0 + snr), 1e-9);
        assert_close(asdic_detect_llr(&three_looks, ASDIC_TARGET_SWERLING1, snr * MEAN, z),
                     log(2.0 * (exp(c) - 1.0 - c) / (c * c)) - log(13.0), 1e-9);
    }
}

/* 0F1(m; w), by its sum. */
static double hypergeometric(double m, double w) {
    double sum = 1.0, term = 1.0;
    for (double k = 0.0; k < 500.0; k += 1.0) {
        term *= w / ((k + 1.0) * (m + k));
        sum += term;
    }
    return sum;
}

/* e^-y 0F1(m; x y), y = m snr; far out by I2(t) = e^t / sqrt(2 pi t) (1 - 15 / (8 t) + 105 / (128 t^2)). */
static void a_steady_target_has_bessels_function(void **state) {
    (void)state;
    for (double x = 0.5; x < 300.0; x *= 4.0) {
        for (double y = 0.3; y < 100.0; y *= 5.0) {
            assert_close(asdic_detect_llr(&one_look, ASDIC_TARGET_SWERLING0, MEAN * y, MEAN * x),
                         log(hypergeometric(1.0, x * y)) - y, 1e-9);
            assert_close(asdic_detect_llr(&three_looks, ASDIC_TARGET_SWERLING0, MEAN * y / 3.0,
                                          MEAN * x / 3.0),
                         log(hypergeometric(3.0, x * y)) - y, 1e-9);
        }
    }
    const double far = 1e4, t = 2e4, lin = MEAN * far / 3.0;
    assert_close(asdic_detect_llr(&three_looks, ASDIC_TARGET_SWERLING0, lin, lin),
                 far + log(2.0) - 2.0 * log(far) - 0.5 * log(2.0 * acos(-1.0) * t) +
                     log(1.0 - 15.0 / (8.0 * t) + 105.0 / (128.0 * t * t)),
                 2e-10);
}

/* Noise alone has no texture; no target tells nothing; all intensities are above 0. */
static void ends_are_as_they_should_be(void **state) {
    (void)state;
    const asdic_background noise = {MEAN, 1, 0.5, 1.0};
    assert_close(asdic_detect_llr(&noise, ASDIC_TARGET_SWERLING1, 8.0, 5.0), 0.8 * 2.5 - log(5.0),
                 1e-9);
    for (int k = 0; k < 4; k++) {
        asdic_target target = (asdic_target)k;
        assert_close(asdic_detect_llr(&three_looks, target, 0.0, 5.0), 0.0, 1e-12);
        assert_close_relative(asdic_detect_pd(&three_looks, target, 0.0, 5.0),
                              asdic_detect_pfa(&three_looks, 5.0), 1e-9);
        assert_close(asdic_detect_pd(&one_look, target, 1.0, 0.0), 1.0, 0.0);
        assert_close(asdic_detect_pd(&one_look, target, 1.0, -1.0), 1.0, 0.0);
        assert_true(isnan(asdic_detect_pd(&one_look, target, 1.0, NAN)));
        assert_true(isnan(asdic_detect_pd(&one_look, target, -1e-9, 1.0)));
        assert_true(isnan(asdic_detect_pd(&one_look, target, NAN, 1.0)));
        assert_true(isnan(asdic_detect_llr(&one_look, target, -1e-9, 1.0)));
        assert_true(isnan(asdic_detect_llr(&one_look, target, 1.0, -1e-9)));
        assert_true(isfinite(asdic_detect_llr(&one_look, target, 1.0, 0.0)));
    }
    assert_close(asdic_detect_pfa(&one_look, 0.0), 1.0, 0.0);
    assert_true(isnan(asdic_detect_pfa(&one_look, NAN)));
}

/* Nothing is above a threshold of INFINITY, which costs may ask for, but a target that is as strong; what is stronger
 * than any number of textures can tell comes to an end. */
static void endless_numbers_come_to_an_end(void **state) {
    (void)state;
    const asdic_background k = {MEAN, 3, 2.0, 0.1}, *const both[2] = {&three_looks, &k};
    for (int i = 0; i < 8; i++) {
        const asdic_background *b = both[i / 4];
        asdic_target target = (asdic_target)(i % 4);
        assert_close(asdic_detect_pfa(b, INFINITY), 0.0, 0.0);
        assert_close(asdic_detect_pd(b, target, 3.0, INFINITY), 0.0, 0.0);
        assert_close(asdic_detect_pd(b, target, INFINITY, 3.0), 1.0, 0.0);
        assert_true(isnan(asdic_detect_llr(b, target, INFINITY, 3.0)));
        assert_true(isnan(asdic_detect_llr(b, target, 1e308, 3.0)));
    }
    double loud = asdic_detect_llr(&k, ASDIC_TARGET_SWERLING2, 8.0, MEAN * 1e12);
    assert_true(isfinite(loud));
    for (double more = 1e13; more < 1e300; more *= 1e60) {
        assert_close(asdic_detect_llr(&k, ASDIC_TARGET_SWERLING2, 8.0, MEAN * more), loud, 0.0);
    }
    assert_close(asdic_detect_llr(&k, ASDIC_TARGET_SWERLING2, 8.0, INFINITY), loud, 0.0);
    /* Beside such a target the background counts for nothing: Swerling I is exponential. */
    const asdic_background spiky = {MEAN, 1, 0.05, 0.0};
    for (double more = 1e13; more < 1e30; more *= 1e6) {
        assert_close(asdic_detect_pfa(&spiky, MEAN * more), 0.0, 0.0);
        assert_close(
            asdic_detect_pd(&spiky, ASDIC_TARGET_SWERLING1, 2.0 * MEAN * more, MEAN * more),
            exp(-0.5), 1e-6);
    }
}

/* ln of the sum over textures e^v of clutter of MEAN e^v, noise and a target that changes from look to look, by
 * 200,000 nodes from where nothing of it is left to where nothing is left. */
static double log_average(const asdic_background *b, double snr, double x) {
    enum { NODES = 200000 };
    static double part[NODES];
    double most = -INFINITY, sum = 0.0, m = (double)b->looks;
    for (int i = 0; i < NODES; i++) {
        double v = 8.0 - fmin(28.0 + 45.0 / b->shape, 700.0) * i / NODES;
        double mean = (1.0 - b->noise_share) * exp(v) + b->noise_share + snr;
        part[i] = b->shape * (v - exp(v)) - m * log(mean) - x / mean;
        most = fmax(most, part[i]);
    }
    for (int i = 0; i < NODES; i++) {
        sum += exp(part[i] - most);
    }
    return most + log(sum);
}

static void textures_are_averaged(void **state) {
    (void)state;
    static const struct {
        unsigned looks;
        double shape, snr, times; /* what is heard, over the clutter's mean */
    } cases[] = {{1, 0.5, 3.0, 2.0},     {1, 0.5, 3.0, 40.0},   {30, 2.0, 5.0, 0.5},
                 {400, 3.0, 10.0, 30.0}, {1000, 1.0, 4.0, 9.0}, {1000, 40.0, 0.5, 1.2},
                 {10, 0.1, 20.0, 300.0}, {1, 90.0, 1.0, 100.0}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        const asdic_background b = {MEAN, cases[i].looks, cases[i].shape, 0.0};
        double x = cases[i].looks * cases[i].times, snr = cases[i].snr;
        assert_close(
            asdic_detect_llr(&b, ASDIC_TARGET_SWERLING2, snr * MEAN, cases[i].times * MEAN),
            log_average(&b, snr, x) - log_average(&b, 0.0, x), 1e-8);
    }
}

/* Few textures tell what many do, within twice 3e-7, which the rule errs by in either density, in whatever of looks,
 * shape, intensity and noise makes the peaks narrow. */
static void few_textures_do(void **state) {
    (void)state;
    static const unsigned looks[] = {1, 4, 1000};
    static const double shape[] = {0.05, 2.0, 20.0}, times[] = {0.1, 1.0, 20.0},
                        snr[] = {0.06, 10.0};
    for (int i = 0; i < 54; i++) {
        const asdic_background b = {MEAN, looks[i % 3], shape[i / 3 % 3], i < 27 ? 0.0 : 0.5};
        double z = times[i / 9 % 3], x = b.looks * z, none = log_average(&b, 0.0, x);
        for (int k = 0; k < 2; k++) {
            assert_close(asdic_detect_llr(&b, ASDIC_TARGET_SWERLING2, snr[k] * MEAN, z * MEAN),
                         log_average(&b, snr[k], x) - none, 6e-7);
        }
    }
}

/* The greatest shape is one as all others are, though near that of none: 8 % more false alarms at least at 15 times
 * the mean. */
static void the_greatest_shape_is_one(void **state) {
    (void)state;
    const asdic_background b[] = {
        {MEAN, 1, 999.0, 0.0}, {MEAN, 1, 1000.0, 0.0}, {MEAN, 1, INFINITY, 0.0}};
    double below = asdic_detect_pfa(&b[0], 15.0 * MEAN),
           greatest = asdic_detect_pfa(&b[1], 15.0 * MEAN);
    assert_close_relative(greatest, below, 1e-3);
    assert_true(greatest > 1.08 * asdic_detect_pfa(&b[2], 15.0 * MEAN));
}

static void thresholds_invert_the_exponential(void **state) {
    (void)state;
    static const double good[] = {1e-300, 1e-6, 0.5, 0.999999, 1.0},
                        bad[] = {0.0, 1e-301, 1.000001, -0.1, NAN};
    double t;
    for (int i = 0; i < 5; i++) {
        assert_ok(ctx, asdic_detect_threshold(ctx, &one_look, good[i], &t));
        assert_close_relative(t, -MEAN * log(good[i]), 1e-6);
        assert_status(ctx, asdic_detect_threshold(ctx, &one_look, bad[i], &t),
                      ASDIC_ERROR_ARGUMENT);
    }
    assert_status(ctx, asdic_detect_threshold(ctx, NULL, 0.1, &t), ASDIC_ERROR_ARGUMENT);
    assert_status(ctx, asdic_detect_threshold(ctx, &one_look, 0.1, NULL), ASDIC_ERROR_ARGUMENT);
}

/* llr = 0.8 x - ln 5 for a snr of 4, which is -ln 5 where nothing is heard. */
static void thresholds_invert_the_likelihood(void **state) {
    (void)state;
    const asdic_target target = ASDIC_TARGET_SWERLING1;
    static const double llr[] = {-1.6, -1.0, 0.0, 3.0, 700.0};
    double t;
    for (int i = 0; i < 5; i++) {
        assert_ok(ctx, asdic_detect_threshold_llr(ctx, &one_look, target, 8.0, llr[i], &t));
        assert_close_relative(t, MEAN * (llr[i] + log(5.0)) / 0.8, 1e-9);
    }
    assert_ok(ctx, asdic_detect_threshold_llr(ctx, &one_look, target, 8.0, -1.7, &t));
    assert_close(t, 0.0, 0.0);
    /* Numbers so small that a millionth of them is none. */
    const asdic_background faint = {1e-318, 1, INFINITY, 0.0};
    assert_ok(ctx, asdic_detect_threshold_llr(ctx, &faint, target, 1e-310, 3.0, &t));
    assert_close_relative(t, 1e-318 * (3.0 + log1p(1e8)), 1e-5);
    /* Of 1000 times clutter and target, x = 5000, which is as good as never, none is reached. */
    assert_ok(ctx, asdic_detect_threshold_llr(ctx, &one_look, target, 8.0, 1e5, &t));
    assert_true(isinf(t));
    static const double bad[][2] = {
        {0.0, 1.0}, {-1.0, 1.0}, {INFINITY, 1.0}, {NAN, 1.0}, {1.0, NAN}};
    for (int i = 0; i < 5; i++) {
        assert_status(ctx,
                      asdic_detect_threshold_llr(ctx, &one_look, target, bad[i][0], bad[i][1], &t),
                      ASDIC_ERROR_ARGUMENT);
    }
    assert_status(ctx, asdic_detect_threshold_llr(ctx, NULL, target, 8.0, 1.0, &t),
                  ASDIC_ERROR_ARGUMENT);
    assert_status(ctx, asdic_detect_threshold_llr(ctx, &one_look, target, 8.0, 1.0, NULL),
                  ASDIC_ERROR_ARGUMENT);
}

static void odds_and_costs_multiply(void **state) {
    (void)state;
    assert_close(asdic_detect_posterior(log(3.0), 0.25), 0.5, 1e-12);
    assert_close(asdic_detect_posterior(log(2.0), 0.25), 0.4, 1e-12); /* odds of 2 to 3 */
    assert_close(asdic_detect_posterior(5.0, 0.0), 0.0, 0.0);
    assert_close(asdic_detect_posterior(-5.0, 1.0), 1.0, 0.0);
    assert_true(isnan(asdic_detect_posterior(0.0, -1e-9)));
    assert_true(isnan(asdic_detect_posterior(0.0, 1.000001)));
    assert_true(isnan(asdic_detect_posterior(NAN, 0.5)));
    /* 3 * 0.8 of false alarms against 2 * 0.2 of misses */
    assert_close(asdic_detect_cost_llr(0.2, 3.0, 2.0), log(6.0), 1e-12);
}

/* A relative error e of the mean, here 1/2, is a texture of variance 1/4: a shape of 4; with a texture of variance 1/2,
 * 1.5 * 1.25 - 1 = 0.875. */
static void an_error_of_the_mean_is_a_texture(void **state) {
    (void)state;
    const double half_db = 5.0 / log(10.0);
    asdic_background rayleigh = {MEAN, 3, INFINITY, 0.3}, k = {MEAN, 3, 2.0, 0.3};
    asdic_background b = asdic_background_blurred(rayleigh, half_db);
    assert_close(b.shape, 4.0, 1e-12);
    assert_close(b.noise_share, 0.0, 0.0); /* which errs as well */
    b = asdic_background_blurred(k, half_db);
    assert_close(b.shape, 1.0 / 0.875, 1e-12);
    assert_close(b.noise_share, 0.3, 0.0);
    assert_close(asdic_background_blurred(k, 100.0).shape, 0.05, 0.0); /* the least there is */
    b = asdic_background_blurred(rayleigh, 0.0);
    assert_true(isinf(b.shape) && b.noise_share == 0.3);
}

static void a_sonars_bin_is_a_background(void **state) {
    (void)state;
    static const double cases[][3] = {/* mean, noise, its share */
                                      {4.0, 1.0, 0.25},
                                      {4.0, 5.0, 1.0},
                                      {4.0, -1.0, 0.0},
                                      {0.0, 1.0, 0.0}};
    asdic_sonar sonar = asdic_sonar_default();
    sonar.speckle_shape = 1.5;
    for (int i = 0; i < 4; i++) {
        asdic_background b = asdic_background_of(&sonar, 1500.0, cases[i][0], cases[i][1]);
        assert_close(b.mean_lin, cases[i][0], 0.0);
        assert_close(b.noise_share, cases[i][2], 0.0);
    }
    sonar.speckle = ASDIC_SPECKLE_K;
    assert_close(asdic_background_of(&sonar, 1500.0, 1.0, 0.0).shape, 1.5, 0.0);
    sonar.speckle = ASDIC_SPECKLE_RAYLEIGH;
    assert_true(isinf(asdic_background_of(&sonar, 1500.0, 1.0, 0.0).shape));
}

/* Where the cubic of Hall (1992) that straightens a skewed mean's law, by bisection, is G. */
static double straightened(double g, double skew, double n) {
    double low = -50.0, high = 50.0;
    for (int i = 0; i < 100; i++) {
        double t = 0.5 * (low + high);
        double at = t + skew * t * t / 3.0 + skew * skew * t * t * t / 27.0 + skew / (6.0 * n);
        *(at < g ? &low : &high) = t;
    }
    return low;
}

/* Bounds of WEIGHTS at 99 %, which a normal variate is within by 2.5758 standard deviations. */
static asdic_estimate bounds_of(const double *weights, size_t count) {
    double n = (double)count, mean = 0.0, second = 0.0, third = 0.0;
    for (size_t i = 0; i < count; i++) {
        mean += weights[i] / n;
    }
    for (size_t i = 0; i < count; i++) {
        second += pow(weights[i] - mean, 2) / n;
        third += pow(weights[i] - mean, 3) / n;
    }
    double sd = sqrt(second), skew = third / pow(sd, 3), g = 2.5758293035489004 / sqrt(n);
    return (asdic_estimate){mean, mean - sd * straightened(g, skew, n),
                            mean - sd * straightened(-g, skew, n)};
}

/* Draws of one look with a mean of 2 and a threshold of 4: they are spread by theta = 2, and those above 1 count with
 * the weight 2 e^-draw each. */
static void rare_draws_are_weighed(void **state) {
    (void)state;
    const asdic_rare_draw draws[] = {{0.5, 0.0}, {1.25, 0.0}, {2.0, 0.0}, {0.999, 0.0}};
    const double w[] = {0.0, 2.0 * exp(-1.25), 2.0 * exp(-2.0), 0.0};
    asdic_estimate e = asdic_rare_estimate(&one_look, 4.0, draws, 4), own = bounds_of(w, 4);
    assert_close(e.value, own.value, 1e-12);
    assert_close(e.high, own.high, 1e-9);
    assert_true(own.low < 0.0); /* e is a probability, though the error is larger */
    assert_close(e.low, 0.0, 0.0);
    const asdic_rare_draw alike[] = {{1.25, 0.0}, {1.3, 0.0}, {1.36, 0.0}};
    double weights[3];
    for (size_t i = 0; i < 3; i++) {
        weights[i] = 2.0 * exp(-alike[i].speckle);
    }
    e = asdic_rare_estimate(&one_look, 4.0, alike, 3);
    own = bounds_of(weights, 3);
    assert_close(e.low, own.low, 1e-9);
    assert_close(e.high, own.high, 1e-9);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(backgrounds_have_limits),
        cmocka_unit_test(one_look_is_exponential),
        cmocka_unit_test(three_looks_are_gamma_distributed),
        cmocka_unit_test(a_steady_target_has_bessels_function),
        cmocka_unit_test(ends_are_as_they_should_be),
        cmocka_unit_test(endless_numbers_come_to_an_end),
        cmocka_unit_test(textures_are_averaged),
        cmocka_unit_test(few_textures_do),
        cmocka_unit_test(the_greatest_shape_is_one),
        cmocka_unit_test(thresholds_invert_the_exponential),
        cmocka_unit_test(thresholds_invert_the_likelihood),
        cmocka_unit_test(odds_and_costs_multiply),
        cmocka_unit_test(an_error_of_the_mean_is_a_texture),
        cmocka_unit_test(a_sonars_bin_is_a_background),
        cmocka_unit_test(rare_draws_are_weighed),
    };
    return cmocka_run_group_tests(tests, context_begin, context_end);
}
