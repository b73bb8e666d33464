/* Thresholds that follow the background: closed forms against draws. */
#include "asserts.h"
#include "test_context.h"

#include "base/quadrature.h"
#include "base/sort.h"
#include "detect/law.h"

#include <stdlib.h>

static size_t integrals; /* so many were asked for */

double __real_asdic_quadrature(asdic_integrand f, void *user, double a, double b, double tolerance);
double __wrap_asdic_quadrature(asdic_integrand f, void *user, double a, double b, double tolerance);

double __wrap_asdic_quadrature(asdic_integrand f, void *user, double a, double b,
                               double tolerance) {
    integrals++;
    return __real_asdic_quadrature(f, user, a, b, tolerance);
}

typedef struct scheme {
    asdic_cfar_kind kind;
    unsigned count, rank, looks;
} scheme;

/* Of TRIALS windows drawn, those whose cell exceeds FACTOR times the window's estimate. */
static asdic_estimate count_alarms(const scheme *s, double factor, asdic_target target, double snr,
                                   uint64_t trials) {
    asdic_background b = {1.0, s->looks, INFINITY, 0.0};
    double window[64], cell;
    uint64_t events = 0;
    for (uint64_t i = 0; i < trials; i++) {
        asdic_detect_draw(&b, target, 0.0, 11, i * s->count, s->count, window);
        asdic_detect_draw(&b, target, snr, 12, i, 1, &cell);
        double estimate = 0.0;
        for (unsigned k = 0; k < s->count; k++) {
            estimate += window[k] / s->count;
        }
        if (s->kind == ASDIC_CFAR_OS) {
            asdic_sort_doubles(window, s->count);
            estimate = window[s->rank - 1];
        }
        events += cell > factor * estimate;
    }
    return asdic_estimate_of(events, trials);
}

static void assert_inside(const char *what, double expected, asdic_estimate e) {
    if (!(expected >= e.low && expected <= e.high)) {
        fail_msg("%s: %.6g measured %.6g [%.6g, %.6g]", what, expected, e.value, e.low, e.high);
    }
}

static void rates_are_as_designed(void **state) {
    (void)state;
    static const scheme schemes[] = {
        {ASDIC_CFAR_CA, 16, 0, 1}, {ASDIC_CFAR_OS, 16, 12, 1}, {ASDIC_CFAR_CA, 8, 0, 3}};
    for (size_t i = 0; i < sizeof schemes / sizeof *schemes; i++) {
        const scheme *s = &schemes[i];
        double factor;
        assert_ok(ctx, asdic_cfar_factor(ctx, s->kind, s->count, s->rank, s->looks, 1e-2, &factor));
        assert_close_relative(asdic_cfar_pfa(s->kind, s->count, s->rank, s->looks, factor), 1e-2,
                              1e-9);
        assert_inside("P_FA", 1e-2, count_alarms(s, factor, ASDIC_TARGET_SWERLING1, 0.0, 1000000));
    }
    /* Several looks, ordered: by quadrature. */
    const scheme s = {ASDIC_CFAR_OS, 8, 6, 3};
    double factor;
    assert_ok(ctx, asdic_cfar_factor(ctx, s.kind, s.count, s.rank, s.looks, 1e-2, &factor));
    assert_inside("P_FA", 1e-2, count_alarms(&s, factor, ASDIC_TARGET_SWERLING1, 0.0, 300000));
    for (int t = 0; t < 4; t++) {
        double pd = asdic_cfar_pd(s.kind, s.count, s.rank, s.looks, factor, (asdic_target)t, 4.0);
        assert_inside("P_D", pd, count_alarms(&s, factor, (asdic_target)t, 4.0, 100000));
    }
}

/* The quadrature, where there is a closed form as well. */
static void quadrature_meets_closed_forms(void **state) {
    (void)state;
    const double factor = 20.0, snr = 30.0;
    for (int kind = 0; kind < 2; kind++) {
        double closed =
            asdic_cfar_pd((asdic_cfar_kind)kind, 16, 12, 1, factor, ASDIC_TARGET_SWERLING1, snr);
        assert_close_relative(
            closed, asdic_cfar_pfa((asdic_cfar_kind)kind, 16, 12, 1, factor / 31.0), 1e-12);
        /* without a target P_D is P_FA, by the other way */
        assert_close_relative(
            asdic_cfar_pd((asdic_cfar_kind)kind, 16, 12, 1, factor, ASDIC_TARGET_SWERLING3, 0.0),
            asdic_cfar_pfa((asdic_cfar_kind)kind, 16, 12, 1, factor), 1e-7);
    }
    assert_close_relative(asdic_cfar_pfa(ASDIC_CFAR_CA, 16, 0, 1, factor),
                          pow(1.0 + factor / 16.0, -16.0), 1e-12);
    assert_close_relative(asdic_cfar_pd(ASDIC_CFAR_CA, 8, 0, 5, 4.0, ASDIC_TARGET_SWERLING0, 0.0),
                          asdic_cfar_pfa(ASDIC_CFAR_CA, 8, 0, 5, 4.0), 1e-7);
    /* The estimate's density far from 0. */
    assert_close_relative(asdic_cfar_pd(ASDIC_CFAR_CA, 64, 0, 20, 1.5, ASDIC_TARGET_SWERLING0, 0.0),
                          asdic_cfar_pfa(ASDIC_CFAR_CA, 64, 0, 20, 1.5), 1e-7);
    /* Many bins know the background: the fixed threshold. */
    asdic_background b = {1.0, 2, INFINITY, 0.0};
    assert_close_relative(asdic_cfar_pfa(ASDIC_CFAR_CA, 512, 0, 2, 4.0), asdic_detect_pfa(&b, 4.0),
                          0.05);
}

/* Rates of one look take no integrals, which would last a thousand times as long. */
static void one_look_takes_the_closed_form(void **state) {
    (void)state;
    integrals = 0;
    for (double f = 0.5; f < 2e4; f *= 40.0) {
        assert_close_relative(asdic_cfar_pfa(ASDIC_CFAR_OS, 4, 3, 1, f),
                              4.0 / (4.0 + f) * 3.0 / (3.0 + f) * 2.0 / (2.0 + f), 1e-14);
    }
    assert_int_equal(integrals, 0);
    asdic_cfar_pfa(ASDIC_CFAR_OS, 4, 3, 2, 1.0);
    assert_true(integrals > 0);
}

/* Large factors leave a peak near 0, which integrals are to find, and soon. The only bin of a window is its mean and
 * its rank; without a target P_D is P_FA. */
static void large_factors_are_integrated(void **state) {
    (void)state;
    for (double f = 100.0; f < 1e15; f *= 3.0) {
        for (unsigned looks = 2; looks < 7; looks += 2) {
            assert_close_relative(asdic_cfar_pfa(ASDIC_CFAR_OS, 1, 1, looks, f),
                                  asdic_cfar_pfa(ASDIC_CFAR_CA, 1, 0, looks, f), 1e-8);
            assert_close_relative(
                asdic_cfar_pd(ASDIC_CFAR_CA, looks, 0, 2, f, ASDIC_TARGET_SWERLING0, 0.0),
                asdic_cfar_pfa(ASDIC_CFAR_CA, looks, 0, 2, f), 1e-8);
        }
    }
    double by_rank, by_mean;
    assert_ok(ctx, asdic_cfar_factor(ctx, ASDIC_CFAR_OS, 1, 1, 2, 1e-12, &by_rank));
    assert_ok(ctx, asdic_cfar_factor(ctx, ASDIC_CFAR_CA, 1, 0, 2, 1e-12, &by_mean));
    assert_close_relative(by_rank, by_mean, 1e-8);
}

/* P(Poisson(X) >= M), summed from its largest term on. */
static double poisson_from(unsigned m, double x) {
    double sum = 0.0;
    for (unsigned j = m; j < m + 600; j++) {
        sum += exp(j * log(x) - x - lgamma(j + 1.0));
    }
    return fmin(sum, 1.0);
}

/* P_FA of the RANK-th of COUNT bins of so many looks: the rank's bin at s, so many below it, the others
 * above, and the bin under test beyond FACTOR times it; by the midpoint rule. */
static double os_pfa(unsigned count, unsigned rank, unsigned looks, double factor) {
    enum { POINTS = 2000 };
    const double end = 4.0 * looks, step = end / POINTS;
    double sum = 0.0;
    for (int i = 0; i < POINTS; i++) {
        double s = (i + 0.5) * step, below = poisson_from(looks, s);
        double above = fmax(1.0 - below, 1e-300), beyond = 1.0 - poisson_from(looks, factor * s);
        double density = exp((looks - 1.0) * log(s) - s - lgamma(looks));
        double orders = lgamma(count + 1.0) - lgamma(rank) - lgamma(count - rank + 1.0);
        sum += step * density * beyond *
               exp(orders + (rank - 1.0) * log(below) + (count - rank) * log(above));
    }
    return sum;
}

/* Many looks make a chance near 0 of being below, whose powers are to be had without cancellation. */
static void order_statistics_of_many_looks(void **state) {
    (void)state;
    for (unsigned looks = 4; looks <= 64; looks *= 2) {
        assert_close_relative(asdic_cfar_pfa(ASDIC_CFAR_OS, 16, 12, looks, 1.3),
                              os_pfa(16, 12, looks, 1.3), 1e-5);
        double factor;
        assert_ok(ctx, asdic_cfar_factor(ctx, ASDIC_CFAR_OS, 16, 12, looks, 1e-3, &factor));
        assert_close_relative(os_pfa(16, 12, looks, factor), 1e-3, 1e-5);
    }
}

/* Of as many looks as a bin may have the closed form begins with a term that no number holds. */
static void means_of_many_looks(void **state) {
    (void)state;
    for (unsigned looks = 125; looks <= 1000; looks *= 2) {
        double factor;
        assert_close_relative(
            asdic_cfar_pfa(ASDIC_CFAR_CA, 16, 0, looks, 1.1),
            asdic_cfar_pd(ASDIC_CFAR_CA, 16, 0, looks, 1.1, ASDIC_TARGET_SWERLING0, 0.0), 1e-7);
        assert_ok(ctx, asdic_cfar_factor(ctx, ASDIC_CFAR_CA, 16, 0, looks, 1e-3, &factor));
        assert_close_relative(
            asdic_cfar_pd(ASDIC_CFAR_CA, 16, 0, looks, factor, ASDIC_TARGET_SWERLING0, 0.0), 1e-3,
            1e-7);
    }
}

/* Nothing is above a threshold of INFINITY. */
static void infinite_thresholds_are_not_exceeded(void **state) {
    (void)state;
    for (int kind = 0; kind < 2; kind++) {
        for (unsigned looks = 1; looks <= 3; looks++) {
            asdic_cfar_kind of = (asdic_cfar_kind)kind;
            assert_close(asdic_cfar_pfa(of, 16, 12, looks, INFINITY), 0.0, 0.0);
            for (int target = 0; target < 4; target++) {
                double pd = asdic_cfar_pd(of, 16, 12, looks, INFINITY, (asdic_target)target, 10.0);
                assert_close(pd, 0.0, 0.0);
            }
        }
    }
}

/* A threshold of 0 is always exceeded: with probability 1, not a rounding more. */
static void no_rate_is_above_one(void **state) {
    (void)state;
    for (unsigned looks = 2; looks <= 4; looks++) {
        for (unsigned count = 32; count <= 128; count *= 2) {
            double pfa = asdic_cfar_pfa(ASDIC_CFAR_OS, count, count * 3 / 4, looks, 0.0);
            assert_true(pfa <= 1.0 && pfa > 1.0 - 1e-9);
        }
    }
}

/* The window's bins round AT that have energy, sorted; returns how many. */
static unsigned window_round(const asdic_cfar *cfar, const double *z, int bins, int at,
                             double *near) {
    unsigned count = 0;
    for (int k = 0; k < bins; k++) {
        unsigned off = (unsigned)abs(k - at);
        if (off > cfar->guard && off <= cfar->guard + cfar->cells && z[k] > 0.0) {
            near[count++] = z[k];
        }
    }
    asdic_sort_doubles(near, count);
    return count;
}

static double mean_or_rank(const asdic_cfar *cfar, const double *near, unsigned count,
                           unsigned rank) {
    double sum = 0.0;
    for (unsigned k = 0; k < count; k++) {
        sum += near[k];
    }
    return cfar->kind == ASDIC_CFAR_CA ? sum / count : near[rank - 1];
}

/* What looking at every window anew gives, bins without energy left out. */
static void windows_bin_by_bin(const asdic_cfar *cfar, const double *z, int bins) {
    double background[300], threshold[300], near[300], factor;
    assert_ok(ctx, asdic_cfar_row(ctx, cfar, 1, 1e-2, z, bins, background, threshold));
    for (int i = 0; i < bins; i++) {
        unsigned count = window_round(cfar, z, bins, i, near);
        if (!(z[i] > 0.0) || count == 0) {
            assert_true(isnan(threshold[i]) && isnan(background[i]));
            continue;
        }
        unsigned rank = (unsigned)ceil(cfar->rank * count - 1e-9);
        assert_ok(ctx, asdic_cfar_factor(ctx, cfar->kind, count, rank, 1, 1e-2, &factor));
        assert_close_relative(threshold[i], mean_or_rank(cfar, near, count, rank) * factor, 1e-12);
    }
}

static void rows_are_those_of_every_window(void **state) {
    (void)state;
    enum { BINS = 300 };
    double z[BINS];
    asdic_background b = {1.0, 1, INFINITY, 0.0};
    asdic_detect_draw(&b, ASDIC_TARGET_SWERLING1, 0.0, 5, 0, BINS, z);
    for (int i = 0; i < BINS; i += 7) {
        z[i] = i % 2 ? 0.0 : z[1]; /* gaps, and equal values */
    }
    for (unsigned cells = 1; cells <= 256; cells = 3 * cells + 1) {
        for (unsigned guard = 0; guard <= 2; guard += 2) {
            windows_bin_by_bin(&(asdic_cfar){ASDIC_CFAR_OS, cells, guard, 0.75}, z, BINS);
            windows_bin_by_bin(&(asdic_cfar){ASDIC_CFAR_CA, cells, guard, 0.75}, z, BINS);
        }
    }
}

/* Factors are found once: those that are there are taken. */
static void factors_are_kept(void **state) {
    (void)state;
    static asdic_cfar_scale scales[ASDIC_CFAR_SCALES];
    enum { BINS = 20 };
    double z[BINS], background[BINS], threshold[BINS], near[BINS];
    const asdic_cfar cfar = {ASDIC_CFAR_OS, 3, 1, 0.75};
    for (size_t n = 0; n < ASDIC_CFAR_SCALES; n++) {
        scales[n] = (asdic_cfar_scale){.factor = 3.0, .bias = 2.0}; /* no window has these */
    }
    for (int i = 0; i < BINS; i++) {
        z[i] = 1.0 + 7 * i % 11;
    }
    const asdic_cfar_bins row = {z, BINS, 1};
    assert_ok(ctx, asdic_cfar_row_scaled(ctx, &cfar, 4, 1e-2, &row, background, threshold, scales));
    for (int i = 0; i < BINS; i++) {
        unsigned count = window_round(&cfar, z, BINS, i, near);
        double found = near[(unsigned)ceil(0.75 * count) - 1];
        assert_close_relative(threshold[i], 3.0 * found, 1e-12);
        assert_close_relative(background[i], found / 2.0, 1e-12);
    }
}

/* Windows of bins that are so many apart are those of rows of these alone. */
static void bins_apart_are_neighbours(void **state) {
    (void)state;
    enum { BINS = 101, MOST = 40 };
    double z[BINS], background[BINS], threshold[BINS], near[BINS], own[BINS], own_background[BINS],
        own_threshold[BINS];
    asdic_background b = {1.0, 1, INFINITY, 0.0};
    asdic_detect_draw(&b, ASDIC_TARGET_SWERLING1, 0.0, 5, 0, BINS, z);
    z[50] = 0.0;
    for (int kind = 0; kind < 2; kind++) {
        const asdic_cfar cfar = {(asdic_cfar_kind)kind, 4, 1, 0.75};
        for (size_t apart = 1; apart <= MOST; apart += 3) {
            asdic_cfar_scale scales[ASDIC_CFAR_SCALES] = {0};
            const asdic_cfar_bins row = {z, BINS, apart};
            assert_ok(ctx, asdic_cfar_row_scaled(ctx, &cfar, 1, 1e-2, &row, background, threshold,
                                                 scales));
            for (size_t first = 0; first < apart; first++) {
                size_t count = 0;
                for (size_t i = first; i < BINS; i += apart) {
                    own[count++] = z[i];
                }
                assert_ok(ctx, asdic_cfar_row(ctx, &cfar, 1, 1e-2, own, count, own_background,
                                              own_threshold));
                for (size_t i = 0; i < count; i++) {
                    size_t at = first + i * apart;
                    assert_int_equal(isnan(threshold[at]), isnan(own_threshold[i]));
                    if (!isnan(threshold[at])) {
                        assert_close(threshold[at], own_threshold[i], 0.0);
                        assert_close(background[at], own_background[i], 0.0);
                        unsigned known = window_round(&cfar, own, (int)count, (int)i, near);
                        assert_close(asdic_cfar_rate(&cfar, 1, 2.0, &row, at, scales),
                                     asdic_cfar_pfa(cfar.kind, known, (3 * known + 3) / 4, 1,
                                                    2.0 / scales[known].bias),
                                     0.0);
                    }
                }
            }
        }
    }
}

/* The limits of <asdic/detect.h>, from both sides. */
static void arguments_have_limits(void **state) {
    (void)state;
    static const struct {
        unsigned count, rank, looks;
        double pfa;
        bool is_good;
    } cases[] = {{1, 1, 1, 0.1, true},     {0, 1, 1, 0.1, false}, {512, 1, 1, 0.1, true},
                 {513, 1, 1, 0.1, false},  {4, 4, 1, 0.1, true},  {4, 5, 1, 0.1, false},
                 {4, 0, 1, 0.1, false},    {4, 1, 0, 0.1, false}, {4, 1, 1000, 0.1, true},
                 {4, 1, 1001, 0.1, false}, {4, 1, 1, 0.0, false}, {4, 1, 1, 1.0, false},
                 {4, 1, 1, 0.999, true},   {4, 1, 1, -0.1, false}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        double factor;
        asdic_status wanted = cases[i].is_good ? ASDIC_OK : ASDIC_ERROR_ARGUMENT;
        assert_status(ctx,
                      asdic_cfar_factor(ctx, ASDIC_CFAR_OS, cases[i].count, cases[i].rank,
                                        cases[i].looks, cases[i].pfa, &factor),
                      wanted);
    }
    const double snr = 4.0;
    assert_true(isnan(asdic_cfar_pfa(ASDIC_CFAR_OS, 4, 5, 1, 2.0)));
    assert_true(isnan(asdic_cfar_pfa(ASDIC_CFAR_CA, 4, 0, 1, -1.0)));
    assert_true(isnan(asdic_cfar_pd(ASDIC_CFAR_OS, 4, 5, 1, 2.0, ASDIC_TARGET_SWERLING1, snr)));
    assert_true(isnan(asdic_cfar_pd(ASDIC_CFAR_CA, 4, 0, 1, 2.0, ASDIC_TARGET_SWERLING1, -1.0)));
    assert_true(isnan(asdic_cfar_pd(ASDIC_CFAR_CA, 4, 0, 1, 2.0, (asdic_target)7, snr)));
    assert_true(isnan(asdic_cfar_pfa((asdic_cfar_kind)5, 4, 2, 1, 2.0)));
    assert_status(ctx, asdic_cfar_factor(ctx, ASDIC_CFAR_OS, 4, 4, 1, 0.1, NULL),
                  ASDIC_ERROR_ARGUMENT);
    double factor;
    assert_status(ctx, asdic_cfar_factor(ctx, (asdic_cfar_kind)5, 4, 4, 1, 0.1, &factor),
                  ASDIC_ERROR_ARGUMENT);
    assert_string_equal(asdic_context_error(ctx), "no CFAR of kind 5");
    double z[2] = {1.0, 2.0}, out[2];
    asdic_cfar of = asdic_cfar_default();
    assert_status(ctx, asdic_cfar_row(ctx, NULL, 1, 0.1, z, 2, out, out), ASDIC_ERROR_ARGUMENT);
    assert_status(ctx, asdic_cfar_row(ctx, &of, 1, 0.1, NULL, 2, out, out), ASDIC_ERROR_ARGUMENT);
    assert_status(ctx, asdic_cfar_row(ctx, &of, 1, 0.1, z, 2, NULL, out), ASDIC_ERROR_ARGUMENT);
    assert_status(ctx, asdic_cfar_row(ctx, &of, 1, 0.1, z, 2, out, NULL), ASDIC_ERROR_ARGUMENT);
    const asdic_cfar wrong[] = {{ASDIC_CFAR_CA, 0, 1, 1.0},
                                {ASDIC_CFAR_CA, 257, 1, 1.0},
                                {ASDIC_CFAR_CA, 8, ASDIC_SONAR_MAX_BINS + 1, 1.0},
                                {ASDIC_CFAR_OS, 8, ~0u, 1.0},
                                {ASDIC_CFAR_OS, 8, 1, 0.0},
                                {ASDIC_CFAR_OS, 8, 1, 1.01},
                                {(asdic_cfar_kind)5, 8, 1, 0.5}};
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
        assert_status(ctx, asdic_cfar_row(ctx, &wrong[i], 1, 0.1, z, 2, out, out),
                      ASDIC_ERROR_ARGUMENT);
    }
}

static void a_row(void **state) {
    (void)state;
    enum { BINS = 60000 };
    static double z[BINS], background[BINS], threshold[BINS];
    asdic_background b = {1e-10, 4, INFINITY, 0.0};
    for (int kind = 0; kind < 2; kind++) {
        asdic_cfar cfar = asdic_cfar_default();
        cfar.kind = (asdic_cfar_kind)kind;
        asdic_detect_draw(&b, ASDIC_TARGET_SWERLING1, 0.0, 3, 0, BINS, z);
        z[100] = 0.0;    /* blanked */
        z[30000] = 1e-6; /* a target, which its neighbours' thresholds see, not its own */
        assert_ok(ctx, asdic_cfar_row(ctx, &cfar, 4, 1e-2, z, BINS, background, threshold));
        uint64_t events = 0, count = 0;
        double sum = 0.0;
        for (int i = 0; i < BINS; i++) {
            if (i == 100 || abs(i - 30000) <= 10) {
                continue;
            }
            events += z[i] > threshold[i];
            sum += background[i];
            count++;
        }
        assert_true(isnan(threshold[100]));
        assert_true(z[30000] > threshold[30000]);
        assert_close_relative(sum / (double)count, 1e-10, 0.02);
        assert_inside("P_FA of a row", 1e-2, asdic_estimate_of(events, count));
    }
}

/* On the loud side of a step up of 60 dB half of a window is quiet: what is left decides as its own half would, CA with
 * (1 + t)^-8 where it was to be (1 + t)^-16. */
static void a_step_up_is_exceeded(void **state) {
    (void)state;
    enum { PERIOD = 40, STEPS = 4000, BINS = PERIOD * STEPS };
    const double pfa = 1e-2;
    static double z[BINS], background[BINS], threshold[BINS];
    asdic_background b = {1.0, 1, INFINITY, 0.0};
    asdic_detect_draw(&b, ASDIC_TARGET_SWERLING1, 0.0, 5, 0, BINS, z);
    for (size_t i = 0; i < BINS; i++) {
        z[i] *= i % PERIOD < PERIOD / 2 ? 1e-6 : 1.0;
    }
    for (int kind = 0; kind < 2; kind++) {
        double factor;
        uint64_t events = 0;
        asdic_cfar cfar = asdic_cfar_default();
        cfar.kind = (asdic_cfar_kind)kind;
        assert_ok(ctx, asdic_cfar_factor(ctx, cfar.kind, 16, 12, 1, pfa, &factor));
        assert_ok(ctx, asdic_cfar_row(ctx, &cfar, 1, pfa, z, BINS, background, threshold));
        for (size_t i = PERIOD / 2; i < BINS; i += PERIOD) {
            events += z[i] > threshold[i];
        }
        double expected =
            kind == ASDIC_CFAR_CA ? sqrt(pfa) : asdic_cfar_pfa(cfar.kind, 8, 4, 1, factor);
        assert_inside("P_FA beside a step", expected, asdic_estimate_of(events, STEPS));
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(rates_are_as_designed),
        cmocka_unit_test(quadrature_meets_closed_forms),
        cmocka_unit_test(one_look_takes_the_closed_form),
        cmocka_unit_test(large_factors_are_integrated),
        cmocka_unit_test(order_statistics_of_many_looks),
        cmocka_unit_test(means_of_many_looks),
        cmocka_unit_test(infinite_thresholds_are_not_exceeded),
        cmocka_unit_test(no_rate_is_above_one),
        cmocka_unit_test(rows_are_those_of_every_window),
        cmocka_unit_test(factors_are_kept),
        cmocka_unit_test(bins_apart_are_neighbours),
        cmocka_unit_test(arguments_have_limits),
        cmocka_unit_test(a_row),
        cmocka_unit_test(a_step_up_is_exceeded),
    };
    return cmocka_run_group_tests(tests, context_begin, context_end);
}
