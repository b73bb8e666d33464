/*
 * Many intensities to decibels at once: as 10 log10 has it, whatever the position in the array.
 */
#include "asserts.h"

#include "base/decibel.h"

#include <float.h>
#include <stdint.h>
#include <stdlib.h>

#define COUNT 100003 /* odd, so that vectors leave a rest */

static void is_ten_log10(void **state) {
    (void)state;
    double *intensity_lin = malloc(COUNT * sizeof *intensity_lin);
    float *level_db = malloc(COUNT * sizeof *level_db);
    uint64_t bits = 1;
    for (size_t i = 0; i < COUNT; i++) { /* -500 .. 500 dB, and many about 0 dB */
        bits = bits * 6364136223846793005u + 1442695040888963407u;
        double x = (double)(bits >> 11) * 0x1p-53;
        intensity_lin[i] = i % 2 ? pow(10.0, 100.0 * (x - 0.5)) : 1.0 + 1e-3 * (x - 0.5);
    }
    asdic_decibels(intensity_lin, COUNT, level_db);
    for (size_t i = 0; i < COUNT; i++) {
        double expected_db = 10.0 * log10(intensity_lin[i]);
        /* Half a unit in a float's last place: rounded once, and correctly but for ties. */
        assert_close((double)level_db[i], expected_db, 0x1.001p-25 * 2.0 * fabs(expected_db));
    }
    free(level_db);
    free(intensity_lin);
}

static void does_not_depend_on_the_place(void **state) {
    (void)state;
    double intensity_lin[40];
    float together_db[40], alone_db;
    for (size_t i = 0; i < 40; i++) {
        intensity_lin[i] = exp(0.37 * (double)i - 9.0);
    }
    for (size_t first = 0; first < 8; first++) {
        asdic_decibels(intensity_lin + first, 40 - first, together_db);
        for (size_t i = first; i < 40; i++) {
            asdic_decibels(intensity_lin + i, 1, &alone_db);
            assert_memory_equal(&together_db[i - first], &alone_db, sizeof alone_db);
        }
    }
}

static void nothing_is_nan(void **state) {
    (void)state;
    const double intensity_lin[] = {0.0,      -0.0,    -1.0, (double)NAN, 1e-310,
                                    INFINITY, DBL_MIN, 1.0,  1e10};
    float level_db[9];
    asdic_decibels(intensity_lin, 9, level_db);
    for (size_t i = 0; i < 5; i++) {
        assert_true(isnan(level_db[i]));
    }
    assert_true(isinf(level_db[5]) && level_db[5] > 0.0f);
    assert_close((double)level_db[6], -3076.5266, 1e-3);
    assert_close((double)level_db[7], 0.0, 0.0);
    assert_close((double)level_db[8], 100.0, 0.0);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(is_ten_log10),
        cmocka_unit_test(does_not_depend_on_the_place),
        cmocka_unit_test(nothing_is_nan),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
