/* The expected ping, and what the slips of the paper do to it, against an independent program. */
#include "asserts.h"

#include <asdic/asdic.h>

#include "flat_expected.h"

#include <stdlib.h>

#define BINS 149

/* The paper's first scenario. */
typedef struct setup {
    asdic_context *ctx;
    asdic_environment env;
    asdic_sonar sonar;
    asdic_beam receiver;
    asdic_flat_scene flat;
    asdic_pose pose;
    asdic_ping *ping;
} setup;

static setup *begin(size_t bins) {
    static setup s;
    s = (setup){.env = asdic_environment_default(), .sonar = asdic_sonar_default()};
    s.env.max_depth_m = 12.0;
    s.sonar.noise_enabled = false;
    s.sonar.receiver_count = 1;
    s.sonar.receivers = &s.receiver;
    s.receiver = s.sonar.transmitter;
    s.flat = (asdic_flat_scene){.has_surface = true,
                                .has_bottom = true,
                                .altitude_m = 5.0,
                                .depth_m = 7.0,
                                .bottom = asdic_material_bottom(2.0)};
    assert_int_equal(asdic_context_create(&s.ctx), ASDIC_OK);
    assert_ok(s.ctx, asdic_ping_create(s.ctx, 1, bins, &s.ping));
    return &s;
}

static void end(setup *s) {
    asdic_ping_destroy(&s->ping);
    asdic_context_destroy(&s->ctx);
}

static void compute(setup *s) {
    assert_ok(s->ctx,
              asdic_expected_compute(s->ctx, &s->flat, &s->env, &s->sonar, &s->pose, s->ping));
}

static double level(const setup *s, asdic_component c, size_t bin) {
    return asdic_level_db(s->ping->intensity_lin[c][bin]);
}

static void scenario_1_meets_independent_values(void **state) {
    (void)state;
    static const asdic_component component[4] = {ASDIC_TOTAL, ASDIC_BOTTOM, ASDIC_SURFACE,
                                                 ASDIC_VOLUME};
    setup *s = begin(BINS);
    double worst = 0.0;
    compute(s);
    for (size_t n = 0; n < BINS; n++) {
        for (int c = 0; c < 4; c++) {
            double expected = flat_expected_db[n][c];
            if (isnan(expected)) {
                assert_true(s->ping->intensity_lin[component[c]][n] == 0.0);
            } else {
                assert_close(level(s, component[c], n), expected, 1e-6);
                worst = fmax(worst, fabs(level(s, component[c], n) - expected));
            }
        }
    }
    print_message("worst of 149 bins x 4: %.2g dB\n", worst);
    end(s);
}

/* Band level (golden: 69.09 dB for 10 kHz at 100 kHz, 10 kn), less the face's directivity, over as
 * many cells as a bin holds: the sonar equation's noise, by hand. */
static void noise_is_the_band_level_less_directivity(void **state) {
    (void)state;
    const double c = 1490.102, band_db = 69.09000504272852, wavelength = c / 100e3;
    double directivity_db =
        asdic_level_db(4.0 * 3.14159265358979323846 * 0.05 * 0.05 / (wavelength * wavelength));
    double cells_db = asdic_level_db(0.5 / (c / (2.0 * 10e3)));
    setup *s = begin(BINS);
    s->sonar.noise_enabled = true;
    for (int directed = 0; directed < 2; directed++) {
        s->sonar.noise_directivity = directed;
        compute(s);
        for (size_t n = 0; n < BINS; n++) {
            assert_close(level(s, ASDIC_NOISE, n),
                         band_db + cells_db - (directed ? directivity_db : 0.0), 1e-6);
        }
    }
    print_message("noise %.2f dB, directivity %.2f dB\n", level(s, ASDIC_NOISE, 0), directivity_db);
    end(s);
}

/* The corrected model with erratum NUMBER, or with 0 everything that was printed. */
static void put_back(setup *s, unsigned number, asdic_ping *out) {
    asdic_environment env = s->env;
    size_t i = 0;
    if (number == 0) {
        env.variant = ASDIC_VARIANT_PRINTED;
        assert_ok(s->ctx, asdic_expected_compute(s->ctx, &s->flat, &env, &s->sonar, &s->pose, out));
        return;
    }
    while (i < asdic_erratum_count() && asdic_erratum_get(i)->number != number) {
        i++;
    }
    assert_ok(s->ctx, asdic_expected_erratum(s->ctx, i, &s->flat, &env, &s->sonar, &s->pose, out));
}

static int ascending(const void *a, const void *b) {
    double x = *(const double *)a, y = *(const double *)b;
    return x < y ? -1 : x > y;
}

/* Median and extremes over the bins of what changed between two pings, dB. */
static void change(const double *before, const double *after, double out[3]) {
    double d[BINS];
    size_t count = 0;
    for (size_t n = 0; n < BINS; n++) {
        if (before[n] > 0.0) {
            d[count++] = asdic_level_db(after[n] / before[n]);
        }
    }
    qsort(d, count, sizeof *d, ascending);
    out[0] = 0.5 * (d[(count - 1) / 2] + d[count / 2]);
    out[1] = d[0];
    out[2] = d[count - 1];
}

static void check_change(const char *what, double actual, double expected, double tolerance) {
    if (!isnan(expected)) {
        test_assert_close(actual, expected, tolerance, what, __FILE__, __LINE__);
    }
}

/* Effects on scenario 1 found by the independent program, to its printed digits; NAN: it states
 * none. Number 0 is everything printed. */
static void errata_have_their_published_size(void **state) {
    (void)state;
    static const struct {
        unsigned number;
        asdic_component component;
        double median, least, most, tolerance;
    } rows[] = {
        {1, ASDIC_BOTTOM, NAN, NAN, 0.013, 0.0006},
        {5, ASDIC_BOTTOM, -0.034, -0.034, -0.034, 0.0006},
        {7, ASDIC_BOTTOM, 17.4, 13.5, NAN, 0.06},
        {7, ASDIC_SURFACE, 22.7, NAN, NAN, 0.06},
        {7, ASDIC_VOLUME, 14.3, NAN, NAN, 0.06},
        {9, ASDIC_BOTTOM, 9.9, NAN, NAN, 0.06},
        {9, ASDIC_SURFACE, 14.4, NAN, NAN, 0.06},
        {9, ASDIC_VOLUME, 7.1, NAN, NAN, 0.06},
        {10, ASDIC_BOTTOM, 17.5, 13.6, NAN, 0.06},
        {10, ASDIC_SURFACE, 22.8, NAN, NAN, 0.06},
        {10, ASDIC_VOLUME, 14.4, NAN, NAN, 0.06},
        {11, ASDIC_BOTTOM, 3.01, 3.01, 3.01, 0.006},
        {11, ASDIC_VOLUME, 3.01, 3.01, 3.01, 0.006},
        {12, ASDIC_BOTTOM, -29.0, -33.0, NAN, 0.5},
        {12, ASDIC_SURFACE, -29.0, -33.0, NAN, 0.5},
        {13, ASDIC_BOTTOM, -11.5, -11.5, NAN, 0.06},
        {13, ASDIC_VOLUME, -19.9, -22.5, -18.1, 0.06},
        {14, ASDIC_BOTTOM, 3.01, 3.01, 3.01, 0.006},
        {15, ASDIC_BOTTOM, 13.0, 0.0, 15.7, 0.06},
        {17, ASDIC_BOTTOM, 0.0, -32.0, NAN, 0.5},
        {17, ASDIC_SURFACE, 0.0, -63.0, NAN, 0.5},
        {21, ASDIC_VOLUME, 0.0, -INFINITY, NAN, 0.006},
        {22, ASDIC_VOLUME, 0.0, 0.0, 0.0, 0.006},
        {23, ASDIC_VOLUME, -1.96, NAN, NAN, 0.02},
        {24, ASDIC_VOLUME, -0.013, NAN, NAN, 0.002},
        {26, ASDIC_BOTTOM, -0.49, NAN, NAN, 0.02},
        {26, ASDIC_VOLUME, -0.49, NAN, NAN, 0.02},
        {31, ASDIC_NOISE, -2.28, -2.28, -2.28, 0.01}, /* -4.8 of the wind's part */
        {32, ASDIC_NOISE, 21.5, 21.5, 21.5, 0.06},
        {33, ASDIC_NOISE, -8.2, -8.2, -8.2, 0.1},
        {0, ASDIC_BOTTOM, -13.0, NAN, NAN, 0.5},
        {0, ASDIC_SURFACE, -13.0, NAN, NAN, 0.5},
        {0, ASDIC_VOLUME, 20.8, -50.0, 25.0, 0.5},
    };
    setup *s = begin(BINS);
    asdic_ping *wrong = NULL;
    s->sonar.noise_enabled = true;
    assert_ok(s->ctx, asdic_ping_create(s->ctx, 1, BINS, &wrong));
    compute(s);
    unsigned last = ~0u;
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        if (rows[i].number != last) {
            put_back(s, rows[i].number, wrong);
            last = rows[i].number;
        }
        double found[3];
        change(s->ping->intensity_lin[rows[i].component], wrong->intensity_lin[rows[i].component],
               found);
        static const char *const names[ASDIC_COMPONENT_COUNT] = {[ASDIC_BOTTOM] = "bottom",
                                                                 [ASDIC_SURFACE] = "surface",
                                                                 [ASDIC_VOLUME] = "volume",
                                                                 [ASDIC_NOISE] = "noise"};
        print_message("slip %2u%s, %-7s %+8.3f [%+.3f, %+.3f] dB\n", rows[i].number,
                      rows[i].number ? "" : " (all of 'printed')", names[rows[i].component],
                      found[0], found[1], found[2]);
        check_change("median", found[0], rows[i].median, rows[i].tolerance);
        check_change("least", found[1], rows[i].least, rows[i].tolerance);
        check_change("most", found[2], rows[i].most, rows[i].tolerance);
    }
    asdic_ping_destroy(&wrong);
    end(s);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(scenario_1_meets_independent_values),
        cmocka_unit_test(noise_is_the_band_level_less_directivity),
        cmocka_unit_test(errata_have_their_published_size),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
