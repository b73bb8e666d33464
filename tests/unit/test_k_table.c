/* K speckle's table beside the integrals that it stands for. */
#include "asserts.h"
#include "test_context.h"

#include "detect/k_table.h"
#include "sim/variates.h"

#include <math.h>

#define MANY_BINS 1000000

static const struct {
    unsigned looks;
    double shape;
} laws[] = {{1, 0.05}, {1, 1.0}, {3, 2.0}, {10, 0.3}, {40, 5.0}};

static double between(asdic_variates *v, double low, double high) {
    return low + (high - low) * asdic_variates_uniform(v);
}

/* A background of LAW with any share of noise, the extremes included. */
static asdic_background background_of(size_t law, int index, double odds) {
    double share = index % 8 == 0 ? 0.0 : index % 8 == 1 ? 1.0 : 1.0 / (1.0 + exp(-odds));
    return (asdic_background){
        .mean_lin = 1e-7, .looks = laws[law].looks, .shape = laws[law].shape, .noise_share = share};
}

/* From far below the mean to where almost nothing exceeds it: looser laws reach further. */
static double intensity_of(const asdic_background *b, int index, asdic_variates *v) {
    double most = index % 2 ? 6.9 : 3.5 / sqrt((double)b->looks);
    return b->mean_lin * exp(between(v, -most, most));
}

static void tails_and_ratios_are_those_of_the_integrals(void **state) {
    (void)state;
    double least = 1.0;
    for (size_t k = 0; k < sizeof laws / sizeof *laws; k++) {
        asdic_k_table *table = NULL;
        asdic_background b = background_of(k, 0, 0.0);
        asdic_variates v = asdic_variates_begin(1, 7, k, 0);
        assert_ok(ctx, asdic_k_table_fit(ctx, &b, MANY_BINS, &table));
        assert_non_null(table);
        for (int i = 0; i < 150; i++) {
            b = background_of(k, i, between(&v, -23.0, 23.0));
            double z = intensity_of(&b, i, &v);
            double target = i % 3 ? b.mean_lin * exp(between(&v, -5.0, 5.0)) : 0.0;
            double pd = asdic_detect_pd(&b, ASDIC_TARGET_SWERLING2, target, z);
            double tabled = asdic_k_table_pd(table, &b, target, z);
            if (pd > 1e-12) {
                assert_close_relative(tabled, pd, 4e-5);
                least = fmin(least, pd);
            }
            assert_true(tabled >= 0.0 && tabled <= 1.0);
            double llr = asdic_detect_llr(&b, ASDIC_TARGET_SWERLING2, target, z);
            assert_close(asdic_k_table_llr(table, &b, target, z), llr, 1e-4 + 1e-5 * fabs(llr));
        }
        asdic_k_table_destroy(&table);
    }
    assert_true(least < 1e-10);
}

/* Outside the table, and without one, what is asked for is computed. */
static void elsewhere_the_integrals_are_taken(void **state) {
    (void)state;
    asdic_k_table *table = NULL;
    asdic_background b = background_of(2, 2, 0.5), rayleigh = b, many = b;
    rayleigh.shape = INFINITY;
    many.looks = 65;
    assert_ok(ctx, asdic_k_table_fit(ctx, &b, 100, &table));
    assert_null(table);
    assert_ok(ctx, asdic_k_table_fit(ctx, &rayleigh, MANY_BINS, &table));
    assert_null(table);
    assert_ok(ctx, asdic_k_table_fit(ctx, &many, MANY_BINS, &table));
    assert_null(table);
    assert_close(asdic_k_table_pd(NULL, &b, 1e-7, 3e-7),
                 asdic_detect_pd(&b, ASDIC_TARGET_SWERLING2, 1e-7, 3e-7), 0.0);
    assert_ok(ctx, asdic_k_table_fit(ctx, &b, MANY_BINS, &table));
    static const double far[] = {-1e-7, 0.0, 1e-11, 2e-4, INFINITY};
    for (size_t i = 0; i < sizeof far / sizeof *far; i++) {
        assert_close(asdic_k_table_pd(table, &b, 0.0, far[i]), asdic_detect_pfa(&b, far[i]), 0.0);
    }
    assert_true(isnan(asdic_k_table_pd(table, &b, 0.0, NAN)));
    /* The same number whatever was asked for before. */
    double first = asdic_k_table_pd(table, &b, 0.0, 5e-7);
    asdic_k_table_destroy(&table);
    assert_ok(ctx, asdic_k_table_fit(ctx, &b, MANY_BINS, &table));
    for (int i = 1; i < 40; i++) {
        asdic_k_table_pd(table, &b, 0.0, 4e-8 * i);
    }
    assert_close(asdic_k_table_pd(table, &b, 0.0, 5e-7), first, 0.0);
    /* One of another law takes its place. */
    b.looks = 4;
    assert_ok(ctx, asdic_k_table_fit(ctx, &b, MANY_BINS, &table));
    assert_close_relative(asdic_k_table_pd(table, &b, 0.0, 5e-7), asdic_detect_pfa(&b, 5e-7), 4e-5);
    assert_ok(ctx, asdic_k_table_fit(ctx, &rayleigh, MANY_BINS, &table));
    assert_null(table);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(tails_and_ratios_are_those_of_the_integrals),
        cmocka_unit_test(elsewhere_the_integrals_are_taken),
    };
    return cmocka_run_group_tests(tests, context_begin, context_end);
}
