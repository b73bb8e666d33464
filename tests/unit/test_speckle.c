/* Random numbers against published vectors; speckle against its moments. */
#include "asserts.h"

#include "sim/speckle.h"

#include "../../kernels/random.h"

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

/* Mean, contrast and third moment of COUNT intensities, FIXED of whose mean of 1 has no texture. */
static void moments(double shape, unsigned looks, double fixed, double out[3]) {
    enum { COUNT = 200000 };
    asdic_background law = {.mean_lin = 1.0 - fixed, .looks = looks, .shape = shape};
    double m1 = 0.0, m2 = 0.0, m3 = 0.0;
    for (uint32_t i = 0; i < COUNT; i++) {
        double x = asdic_speckle_draw(&law, fixed, 42, i / 1000, i % 1000);
        m1 += x / COUNT;
        m2 += x * x / COUNT;
        m3 += x * x * x / COUNT;
    }
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

/* Exponential looks add up to Gamma(m): contrast 1 / sqrt(m). */
static void looks_average(void **state) {
    (void)state;
    double m[3];
    moments(INFINITY, 6, 0.0, m);
    assert_close(m[0], 1.0, 0.01);
    assert_close(m[1], 1.0 / sqrt(6.0), 0.01);
    moments(INFINITY, 40, 0.0, m); /* by rejection instead of products */
    assert_close(m[0], 1.0, 0.01);
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

/* Whole pings: PINGS of BEAMS x BINS bins of even intensity. */
enum { PINGS = 100, BEAMS = 2, BINS = 1000 };

typedef struct statistics {
    double mean, contrast, neighbours; /* correlation of neighbouring bins */
} statistics;

static statistics speckled(asdic_speckle kind, double shape, double bin_m, double cell_m) {
    asdic_context *ctx = NULL;
    asdic_ping *ping = NULL;
    assert_int_equal(asdic_context_create(&ctx), ASDIC_OK);
    assert_ok(ctx, asdic_ping_create(ctx, BEAMS, BINS, &ping));
    asdic_sonar sonar = asdic_sonar_default();
    sonar.speckle = kind;
    sonar.speckle_shape = shape;
    sonar.bin_length_m = bin_m;
    sonar.bandwidth_hz = 1500.0 / (2.0 * cell_m);
    double sum = 0.0, square = 0.0, product = 0.0, count = (double)PINGS * BEAMS * BINS;
    for (size_t i = 0; i < BEAMS * BINS; i++) {
        ping->intensity_lin[ASDIC_BOTTOM][i] = 1.0;
    }
    for (uint64_t k = 0; k < PINGS; k++) {
        const double *x = ping->intensity_lin[ASDIC_TOTAL];
        asdic_speckle_apply(&sonar, 1500.0, 7, k, ping);
        for (size_t i = 0; i < BEAMS * BINS; i++) {
            sum += x[i] / count;
            square += x[i] * x[i] / count;
            product += x[i] * x[(i + 1) % (BEAMS * BINS)] / count;
        }
    }
    asdic_ping_destroy(&ping);
    asdic_context_destroy(&ctx);
    double variance = square - sum * sum;
    return (statistics){sum, sqrt(variance) / sum, (product - sum * sum) / variance};
}

static void pings_have_speckle_per_resolution_cell(void **state) {
    (void)state;
    static const struct {
        asdic_speckle kind;
        double shape, bin_m, cell_m;
        double contrast, neighbours, tolerance;
    } cases[] = {
        {ASDIC_SPECKLE_RAYLEIGH, INFINITY, 0.5, 0.5, 1.0, 0.0, 0.02},
        {ASDIC_SPECKLE_RAYLEIGH, INFINITY, 0.5, 0.125, 0.5, 0.0, 0.02},
        {ASDIC_SPECKLE_RAYLEIGH, INFINITY, 0.1, 0.5, 1.0, 0.8, 0.02}, /* 4 of 5 share a cell */
        {ASDIC_SPECKLE_RAYLEIGH, INFINITY, 0.4, 0.5, 1.0, 0.2, 0.02},
        {ASDIC_SPECKLE_K, 2.0, 0.5, 0.5, 1.4142, 0.0, 0.04}, /* sqrt(1 + 2 / shape) */
        {ASDIC_SPECKLE_K, 2.0, 0.1, 0.5, 1.4142, 0.8, 0.04},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        statistics s = speckled(cases[i].kind, cases[i].shape, cases[i].bin_m, cases[i].cell_m);
        print_message("%s, bins %.1f m, cells %.3f m: mean %.3f, contrast %.3f, neighbours %.3f\n",
                      cases[i].kind == ASDIC_SPECKLE_K ? "K, shape 2" : "Rayleigh", cases[i].bin_m,
                      cases[i].cell_m, s.mean, s.contrast, s.neighbours);
        assert_close(s.mean, 1.0, 0.02);
        assert_close(s.contrast, cases[i].contrast, cases[i].tolerance);
        assert_close(s.neighbours, cases[i].neighbours, 0.03);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(philox_gives_the_published_answers),
        cmocka_unit_test(uniforms_stay_inside),
        cmocka_unit_test(rayleigh_has_contrast_one),
        cmocka_unit_test(looks_average),
        cmocka_unit_test(k_shape_is_recovered),
        cmocka_unit_test(looks_are_cells),
        cmocka_unit_test(pings_have_speckle_per_resolution_cell),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
