/* Random numbers against published vectors; speckle against its moments. */
#include "asserts.h"
#include "pulse.h"

#include <asdic/detect.h>

#include "sim/speckle.h"
#include "sim/texture.h"
#include "sim/variates.h"

#include "../../kernels/random.h"

/* Streams never meet: each has a word of its own, below the eight that elements add to theirs. */
static void streams_have_words_of_their_own(void **state) {
    static const uint32_t words[] = {RANDOM_SAMPLE, RANDOM_SHIFT,     RANDOM_SPECKLE, RANDOM_TRIAL,
                                     RANDOM_DRAW,   RANDOM_SCATTERER, RANDOM_ELEMENT};
    (void)state;
    for (size_t i = 0; i < sizeof words / sizeof *words; i++) {
        assert_true(words[i] < 8);
        for (size_t k = 0; k < i; k++) {
            assert_int_not_equal(words[i], words[k]);
        }
    }
}

/* Known-answer vectors of Random123 (kat_vectors, philox4x32 10). */
static void philox_gives_the_published_answers(void **state) {
    (void)state;
    static const struct {
        uint32_t counter[4], key[2], expected[4];
    } vectors[] = {
        {{0, 0, 0, 0}, {0, 0}, {0x6627e8d5, 0xe169c58d, 0xbc57ac4c, 0x9b00dbd8}},
        {{0xffffffff, 0xffffffff, 0xffffffff, 0xffffffff},
         {0xffffffff, 0xffffffff},
         {0x408f276d, 0x41c83b0e, 0xa20bc7c6, 0x6d5451fd}},
        {{0x243f6a88, 0x85a308d3, 0x13198a2e, 0x03707344},
         {0xa4093822, 0x299f31d0},
         {0xd16cfe09, 0x94fdcceb, 0x5001e420, 0x24126ea1}},
    };
    for (size_t k = 0; k < sizeof vectors / sizeof *vectors; k++) {
        random4 counter;
        memcpy(counter.v, vectors[k].counter, sizeof counter.v);
        random4 out = philox4x32(counter, vectors[k].key[0], vectors[k].key[1]);
        assert_memory_equal(out.v, vectors[k].expected, sizeof out.v);
    }
}

static void uniforms_stay_inside(void **state) {
    (void)state;
    assert_true(random_uniform(0u) > 0.0);
    assert_true(random_uniform(0xffffffffu) < 1.0);
    assert_true((float)random_uniform(0xffffffffu) < 1.0f);
}

/* Speckle of a sonar over BINS bins of even intensity, FIXED of which has no texture, in PINGS
 * pings. */
typedef struct drawing {
    asdic_context *ctx;
    asdic_speckle_field *field;
    asdic_ping *ping;
    uint64_t index;
} drawing;

#define SPEED 1500.0

static drawing drawing_by_threads(const asdic_sonar *sonar, size_t bins, double fixed,
                                  unsigned threads) {
    drawing d = {0};
    assert_int_equal(asdic_context_create(&d.ctx), ASDIC_OK);
    assert_ok(d.ctx, asdic_ping_create(d.ctx, sonar->receiver_count, bins, &d.ping));
    assert_ok(d.ctx, asdic_speckle_create(d.ctx, sonar, SPEED, bins, threads, &d.field));
    for (size_t i = 0; i < sonar->receiver_count * bins; i++) {
        d.ping->intensity_lin[ASDIC_BOTTOM][i] = 1.0 - fixed;
        d.ping->intensity_lin[ASDIC_OBJECT][i] = fixed;
    }
    return d;
}

static drawing drawing_begin(const asdic_sonar *sonar, size_t bins, double fixed) {
    return drawing_by_threads(sonar, bins, fixed, 1);
}

/* Intensities of the next ping, [beam * bins + bin]. */
static const double *drawing_next(drawing *d) {
    asdic_speckle_apply(d->field, SPEED, 7, d->index++, d->ping);
    return d->ping->intensity_lin[ASDIC_TOTAL];
}

static void drawing_end(drawing *d) {
    asdic_speckle_destroy(&d->field);
    asdic_ping_destroy(&d->ping);
    asdic_context_destroy(&d->ctx);
}

/* A sonar whose resolution cells are CELL_M long. */
static asdic_sonar sonar_of(const asdic_beam *receivers, size_t count, double bin_m,
                            double cell_m) {
    asdic_sonar sonar = asdic_sonar_default();
    sonar.speckle = ASDIC_SPECKLE_RAYLEIGH;
    sonar.receivers = receivers;
    sonar.receiver_count = count;
    sonar.bin_length_m = bin_m;
    sonar.bandwidth_hz = SPEED / (2.0 * cell_m);
    return sonar;
}

/* Mean, contrast and third moment of a beam's intensities, FIXED of whose mean of 1 has no
 * texture. */
static void moments(double shape, unsigned looks, double fixed, double out[3]) {
    enum { BINS = 1000, PINGS = 400 };
    asdic_beam beam = asdic_sonar_default().transmitter;
    asdic_sonar sonar = sonar_of(&beam, 1, 0.5, 0.5 / looks);
    sonar.speckle = isinf(shape) ? ASDIC_SPECKLE_RAYLEIGH : ASDIC_SPECKLE_K;
    sonar.speckle_shape = shape;
    drawing d = drawing_begin(&sonar, BINS, fixed);
    double m1 = 0.0, m2 = 0.0, m3 = 0.0, count = (double)PINGS * BINS;
    for (int k = 0; k < PINGS; k++) {
        const double *x = drawing_next(&d);
        for (int i = 0; i < BINS; i++) {
            m1 += x[i] / count;
            m2 += x[i] * x[i] / count;
            m3 += x[i] * x[i] * x[i] / count;
        }
    }
    drawing_end(&d);
    out[0] = m1;
    out[1] = sqrt(m2 - m1 * m1) / m1;
    out[2] = m3;
}

static void rayleigh_has_contrast_one(void **state) {
    (void)state;
    double m[3];
    moments(INFINITY, 1, 0.5, m);
    print_message("mean %.4f contrast %.4f third moment %.3f\n", m[0], m[1], m[2]);
    assert_close(m[0], 1.0, 0.01);
    assert_close(m[1], 1.0, 0.02);
    assert_close(m[2], 6.0, 0.3);
}

/* Exponential looks add up to Gamma(m): contrast 1 / sqrt(m). The mean of 1.6e7 looks is good to 0.00025: sine and
 * cosine leave every intensity as it is, to the last bits of a float. */
static void looks_average(void **state) {
    (void)state;
    double m[3];
    moments(INFINITY, 6, 0.0, m);
    assert_close(m[0], 1.0, 0.01);
    assert_close(m[1], 1.0 / sqrt(6.0), 0.01);
    moments(INFINITY, 40, 0.0, m);
    assert_close(m[0], 1.0, 0.001);
    assert_close(m[1], 1.0 / sqrt(40.0), 0.003);
}

/* K: second moment (1 + 1 / looks) (1 + 1 / nu), hence the shape from the contrast; what is fixed
 * has no texture. */
static void k_shape_is_recovered(void **state) {
    (void)state;
    static const double shapes[] = {0.5, 1.0, 3.0, 10.0};
    for (int k = 0; k < 8; k++) {
        double m[3], looks = k < 4 ? 1.0 : 3.0;
        moments(shapes[k % 4], (unsigned)looks, 0.0, m);
        double shape = 1.0 / ((m[1] * m[1] + 1.0) / (1.0 + 1.0 / looks) - 1.0);
        print_message("shape %.2f recovered as %.3f\n", shapes[k % 4], shape);
        assert_close(m[0], 1.0, 0.02);
        assert_close_relative(shape, shapes[k % 4], 0.10);
    }
    double m[3];
    moments(0.5, 1, 1.0, m);
    assert_close(m[1], 1.0, 0.02);
}

/* A bin holds whole looks. */
static void looks_are_cells(void **state) {
    (void)state;
    asdic_sonar sonar = asdic_sonar_default(); /* 0.5 m, 10 kHz */
    assert_int_equal(asdic_sonar_looks(&sonar, 1500.0), 7);
    sonar.bin_length_m = 0.01;
    assert_int_equal(asdic_sonar_looks(&sonar, 1500.0), 1);
    sonar.bin_length_m = 1000.0;
    assert_int_equal(asdic_sonar_looks(&sonar, 1500.0), 1000);
}

/* How often intensities exceed what one bin in 10, 100, ... does: their law far out, one beam
 * among many that share its speckle. */
static void rare_intensities_are_as_rare_as_they_should_be(void **state) {
    (void)state;
    enum { BINS = 1000, PINGS = 1500, BEAMS = 5 };
    asdic_beam beams[BEAMS] = {{.length_h_m = 0.0}};
    for (int b = 0; b < BEAMS; b++) {
        beams[b] = asdic_sonar_default().transmitter;
        beams[b].yaw_rad = 0.05 * b;
    }
    for (int kind = 0; kind < 3; kind++) { /* one look, three, bins of a third of a cell */
        asdic_sonar sonar = sonar_of(beams, BEAMS, 0.5,
                                     kind == 1   ? 0.5 / 3
                                     : kind == 2 ? 1.6
                                                 : 0.5);
        drawing d = drawing_begin(&sonar, BINS, 0.0);
        asdic_background law = asdic_background_of(&sonar, SPEED, 1.0, 0.0);
        assert_int_equal(law.looks, kind == 1 ? 3 : 1);
        double thresholds[5];
        unsigned counts[5] = {0}, trials = 0;
        for (int k = 0; k < 5; k++) {
            assert_ok(d.ctx, asdic_detect_threshold(d.ctx, &law, pow(0.1, k + 1), &thresholds[k]));
        }
        for (int p = 0; p < PINGS; p++) {
            const double *x = drawing_next(&d) + 3 * BINS;
            for (int i = 0; i < BINS; i += kind == 2 ? 5 : 1) { /* bins that share nothing */
                trials++;
                for (int k = 0; k < 5; k++) {
                    counts[k] += x[i] > thresholds[k];
                }
            }
        }
        for (int k = 0; k < 5; k++) {
            double expected = trials * pow(0.1, k + 1);
            print_message("%.0e: %u of %u\n", pow(0.1, k + 1), counts[k], trials);
            assert_close(counts[k], expected, 4.0 * sqrt(expected) + 2.0);
        }
        drawing_end(&d);
    }
}

/* How small an intensity is, down to 2^-33: of those below 2^-13 every binary digit of their distribution function is
 * set as often as not. */
static void small_intensities_are_finely_divided(void **state) {
    (void)state;
    enum { BINS = 1000, PINGS = 4000, FIRST = 14, LAST = 33 };
    asdic_beam beam = asdic_sonar_default().transmitter;
    asdic_sonar sonar = sonar_of(&beam, 1, 0.5, 0.5);
    drawing d = drawing_begin(&sonar, BINS, 0.0);
    double set[LAST + 1] = {0.0}, count = 0.0;
    for (int p = 0; p < PINGS; p++) {
        const double *x = drawing_next(&d);
        for (int i = 0; i < BINS; i++) {
            double below = -expm1(-x[i]);
            count += below < ldexp(1.0, 1 - FIRST);
            for (int k = FIRST; k <= LAST && below < ldexp(1.0, 1 - FIRST); k++) {
                set[k] += fmod(floor(ldexp(below, k)), 2.0);
            }
        }
    }
    assert_close(count, (double)BINS * PINGS * ldexp(1.0, 1 - FIRST), 4.0 * sqrt(count));
    for (int k = FIRST; k <= LAST; k++) {
        assert_close(set[k] / count, 0.5, 2.0 / sqrt(count));
    }
    drawing_end(&d);
}

/* Correlation of a beam's intensities over so many bins. */
typedef struct correlations {
    double lags[8], contrast;
} correlations;

static correlations correlate(const asdic_sonar *sonar, size_t bins, int pings) {
    correlations c = {.contrast = 0.0};
    double count = 0.0, mean = 0.0;
    drawing d = drawing_begin(sonar, bins, 0.0);
    for (int p = 0; p < pings; p++) {
        const double *x = drawing_next(&d);
        for (size_t i = 0; i + 8 < bins; i++) {
            count += 1.0;
            mean += x[i];
            for (size_t k = 0; k < 8; k++) {
                c.lags[k] += (x[i] - 1.0) * (x[i + k] - 1.0);
            }
        }
    }
    drawing_end(&d);
    assert_close(mean / count, 1.0, 0.02);
    double variance = c.lags[0];
    c.contrast = sqrt(variance / count);
    for (size_t k = 0; k < 8; k++) {
        c.lags[k] /= variance;
    }
    return c;
}

/* Pressures by what two pulses have in common, intensities by its square: bins of all lengths. */
static void range_bins_share_what_their_cells_do(void **state) {
    (void)state;
    static const struct {
        double shape, bin_m, cell_m, contrast;
    } cases[] = {
        {INFINITY, 0.5, 0.5, 1.0},  {INFINITY, 0.5, 0.125, 0.5}, {INFINITY, 0.1, 0.5, 1.0},
        {INFINITY, 0.4, 0.5, 1.0},  {INFINITY, 0.4, 0.6, 1.0},   {INFINITY, 0.1, 0.77, 1.0},
        {INFINITY, 0.1, 1.57, 1.0}, {INFINITY, 0.1, 3.7, 1.0},   {2.0, 0.5, 0.5, 1.4142136},
        {2.0, 0.1, 0.5, 1.4142136}, /* sqrt(1 + 2 / shape) */
    };
    asdic_beam beam = asdic_sonar_default().transmitter;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        asdic_sonar sonar = sonar_of(&beam, 1, cases[i].bin_m, cases[i].cell_m);
        sonar.speckle = isinf(cases[i].shape) ? ASDIC_SPECKLE_RAYLEIGH : ASDIC_SPECKLE_K;
        sonar.speckle_shape = cases[i].shape;
        correlations c = correlate(&sonar, 1000, 400);
        print_message("shape %g, bins %.1f m, cells %.3f m: contrast %.3f, neighbours",
                      cases[i].shape, cases[i].bin_m, cases[i].cell_m, c.contrast);
        assert_close(c.contrast, cases[i].contrast, isinf(cases[i].shape) ? 0.02 : 0.04);
        for (int k = 1; k < 8; k++) {
            double apart = k * cases[i].bin_m / cases[i].cell_m;
            bool is_short = cases[i].bin_m < cases[i].cell_m;
            double rho2 = is_short ? pow(pulse_share(apart), 2) : 0.0;
            /* Of a product of speckle and texture, each with that correlation, nearly. */
            double nu = cases[i].shape;
            double both =
                isinf(nu) ? rho2 : ((1.0 + rho2) * (1.0 + rho2 / nu) - 1.0) / (1.0 + 2.0 / nu);
            print_message(" %.3f (%.3f)", c.lags[k], both);
            assert_close(c.lags[k], both, 0.03);
        }
        print_message("\n");
    }
}

/* A cell longer than all bins, and bins without number, are drawn as well. */
static void long_pulses_are_one_cell(void **state) {
    (void)state;
    asdic_beam beam = asdic_sonar_default().transmitter;
    for (size_t bins = 1; bins < 2000; bins = 7 * bins + 3) {
        asdic_sonar sonar = sonar_of(&beam, 1, 0.01, 1e5);
        drawing d = drawing_begin(&sonar, bins, 0.0);
        double sum = 0.0;
        for (int p = 0; p < 4000; p++) {
            const double *x = drawing_next(&d);
            sum += x[0] / 4000.0;
            assert_close_relative(sqrt(x[bins - 1]), sqrt(x[0]), 0.05 / fmin(sqrt(x[0]), 1.0));
        }
        assert_close(sum, 1.0, 0.07);
        drawing_end(&d);
    }
}

/* The texture's law against the gamma density integrated by steps, for shapes of both kinds. */
static void textures_are_gamma_variates(void **state) {
    (void)state;
    static const double shapes[] = {0.05, 0.3, 1.0, 1.5, 12.0, 1000.0};
    for (size_t s = 0; s < sizeof shapes / sizeof *shapes; s++) {
        asdic_texture t;
        int sign;
        double nu = shapes[s], below = 0.0, step = 1e-4;
        assert_true(asdic_texture_init(&t, nu));
        /* of ln of the variate, by the midpoint rule, from where nothing is below */
        for (double v = -30.0 / fmin(nu, 1.0); v < log(nu + 12.0 * sqrt(nu) + 60.0); v += step) {
            double x = exp(v + 0.5 * step);
            below += step * exp(nu * log(x) - x - lgamma_r(nu, &sign));
            if (below > 1e-6 && below < 1.0 - 1e-6 && fmod(v, 0.1) > -step) {
                double exponential = -log1p(-below);
                assert_close_relative(asdic_texture_of(&t, exponential), exp(v + step) / nu, 2e-3);
            }
        }
        assert_close(below, 1.0, 1e-6);
        asdic_texture_finish(&t);
    }
}

/* Threads share blocks of bins, and where these are few groups of beams, which draw sources twice. */
static void threads_change_nothing(void **state) {
    (void)state;
    enum { BEAMS = 203 };
    static const struct {
        size_t bins;
        double cell_m;
        asdic_speckle speckle;
    } kinds[] = {{77, 0.02, ASDIC_SPECKLE_K},
                 {77, 0.5, ASDIC_SPECKLE_RAYLEIGH},
                 {391, 0.4, ASDIC_SPECKLE_K},
                 {391, 0.1, ASDIC_SPECKLE_RAYLEIGH}};
    asdic_beam receivers[BEAMS];
    for (int b = 0; b < BEAMS; b++) {
        receivers[b] = asdic_sonar_default().transmitter;
        receivers[b].yaw_rad = 0.01 * (double)(b - BEAMS / 2);
    }
    for (size_t k = 0; k < sizeof kinds / sizeof *kinds; k++) {
        asdic_sonar sonar = sonar_of(receivers, BEAMS, 0.1, kinds[k].cell_m);
        sonar.speckle = kinds[k].speckle;
        sonar.speckle_shape = 2.0;
        drawing one = drawing_begin(&sonar, kinds[k].bins, 0.3);
        drawing_next(&one);
        for (unsigned threads = 2; threads < 9; threads += 3) {
            drawing many = drawing_by_threads(&sonar, kinds[k].bins, 0.3, threads);
            assert_memory_equal(drawing_next(&many), one.ping->intensity_lin[ASDIC_TOTAL],
                                BEAMS * kinds[k].bins * sizeof(double));
            drawing_end(&many);
        }
        drawing_end(&one);
    }
}

/* Numbers are by the whole seed, index and cell of their stream. */
static void streams_differ_by_every_bit(void **state) {
    (void)state;
    asdic_variates first = asdic_variates_begin(0, 7, 5, 3);
    const double number = asdic_variates_uniform(&first);
    for (int bit = 0; bit < 64; bit++) {
        uint64_t on = 1ull << bit;
        asdic_variates others[] = {asdic_variates_begin(0, 7 ^ on, 5, 3),
                                   asdic_variates_begin(0, 7, 5 ^ on, 3),
                                   asdic_variates_begin(0, 7, 5, 3 ^ (1u << bit % 32))};
        for (size_t i = 0; i < 3; i++) {
            assert_true(asdic_variates_uniform(&others[i]) != number);
        }
    }
}

/* A ping's speckle is by its whole index and seed, the highest bits included. */
static void pings_far_apart_differ(void **state) {
    (void)state;
    enum { BINS = 16 };
    asdic_beam beam = asdic_sonar_default().transmitter;
    asdic_sonar sonar = sonar_of(&beam, 1, 0.5, 0.5);
    drawing one = drawing_begin(&sonar, BINS, 0.5), other = drawing_begin(&sonar, BINS, 0.5);
    one.index = 1;
    drawing_next(&one);
    for (int bit = 31; bit < 64; bit++) {
        other.index = 1 + (1ull << bit);
        assert_memory_not_equal(drawing_next(&other), one.ping->intensity_lin[ASDIC_TOTAL],
                                BINS * sizeof(double));
    }
    for (int bit = 0; bit < 64; bit++) {
        asdic_speckle_apply(other.field, SPEED, 7 ^ (1ull << bit), 1, other.ping);
        assert_memory_not_equal(other.ping->intensity_lin[ASDIC_TOTAL],
                                one.ping->intensity_lin[ASDIC_TOTAL], BINS * sizeof(double));
    }
    asdic_speckle_apply(other.field, SPEED, 7, 1, other.ping);
    assert_memory_equal(other.ping->intensity_lin[ASDIC_TOTAL],
                        one.ping->intensity_lin[ASDIC_TOTAL], BINS * sizeof(double));
    drawing_end(&other);
    drawing_end(&one);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(streams_have_words_of_their_own),
        cmocka_unit_test(philox_gives_the_published_answers),
        cmocka_unit_test(uniforms_stay_inside),
        cmocka_unit_test(rayleigh_has_contrast_one),
        cmocka_unit_test(looks_average),
        cmocka_unit_test(k_shape_is_recovered),
        cmocka_unit_test(looks_are_cells),
        cmocka_unit_test(rare_intensities_are_as_rare_as_they_should_be),
        cmocka_unit_test(small_intensities_are_finely_divided),
        cmocka_unit_test(range_bins_share_what_their_cells_do),
        cmocka_unit_test(long_pulses_are_one_cell),
        cmocka_unit_test(textures_are_gamma_variates),
        cmocka_unit_test(threads_change_nothing),
        cmocka_unit_test(streams_differ_by_every_bit),
        cmocka_unit_test(pings_far_apart_differ),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
