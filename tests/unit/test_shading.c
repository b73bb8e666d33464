/*
 * Weights of a line array against what defines them: Chebyshev's side lobes are all as high, Taylor's pattern is zero
 * where his paper puts its zeros, Hann's weights are a raised cosine.
 */
#include "asserts.h"

#include <asdic/sonar.h>

#include <complex.h>

#define PI 3.14159265358979323846

static double weights[ASDIC_ARRAY_MAX_ELEMENTS + 1];

static void weigh(asdic_shading shading, size_t elements, double side_lobe_db) {
    asdic_array array = {.elements = elements, .shading = shading, .side_lobe_db = side_lobe_db};
    weights[elements] = 2.0;
    asdic_array_weights(&array, weights);
    assert_true(weights[elements] == 2.0); /* not theirs */
}

/* The far field where the phase turns by PSI from one of COUNT elements to the next; on the axis it is 1. */
static double far_field(size_t count, double psi) {
    double complex sum = 0.0;
    for (size_t e = 0; e < count; e++) {
        sum += weights[e] * cexp(I * psi * (double)e);
    }
    return cabs(sum);
}

static void weights_are_even_and_add_up_to_one(void **state) {
    (void)state;
    static const size_t counts[] = {2, 3, 16, 45, ASDIC_ARRAY_MAX_ELEMENTS};
    for (int shading = ASDIC_SHADING_NONE; shading <= ASDIC_SHADING_CHEBYSHEV; shading++) {
        for (size_t i = 0; i < sizeof counts / sizeof *counts; i++) {
            weigh((asdic_shading)shading, counts[i], -30.0);
            double sum = 0.0;
            for (size_t e = 0; e < counts[i]; e++) {
                sum += weights[e];
                assert_close(weights[e], weights[counts[i] - 1 - e], 1e-12);
            }
            assert_close(sum, 1.0, 1e-12);
        }
    }
}

static void plain_and_hann_are_as_by_hand(void **state) {
    (void)state;
    weigh(ASDIC_SHADING_NONE, 5, NAN);
    assert_close(weights[0], 0.2, 1e-15);
    assert_close(weights[3], 0.2, 1e-15);
    weigh(ASDIC_SHADING_HANN, 4, NAN); /* sin^2 of 22.5 and 67.5 degrees, of a sum of 2 */
    assert_close(weights[0], 0.25 - 0.25 * sqrt(0.5), 1e-15);
    assert_close(weights[1], 0.25 + 0.25 * sqrt(0.5), 1e-15);
}

/* T_(N-1)(x0 cos(psi / 2)), which swings between the same bounds from the first zero on. */
static void chebyshevs_side_lobes_are_level(void **state) {
    (void)state;
    static const struct {
        size_t elements;
        double db;
    } cases[] = {{3, -20.0}, {8, -25.0}, {16, -30.0}, {17, -40.0}, {64, -60.0}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        size_t count = cases[i].elements, lobes = 0;
        double level = pow(10.0, cases[i].db / 20.0), step = 1e-4 * PI;
        weigh(ASDIC_SHADING_CHEBYSHEV, count, cases[i].db);
        for (double psi = step; psi < PI + 0.5 * step; psi += step) {
            double here = far_field(count, psi);
            if (here >= far_field(count, psi - step) && here > far_field(count, psi + step)) {
                assert_close_relative(here, level, 1e-4);
                lobes++;
            }
        }
        assert_int_equal(lobes, (count - 1) / 2);
    }
}

/* Taylor's zeros, by widths c / L of the aperture: sigma sqrt(A^2 + (n - 1/2)^2) before n-bar, then n. Of so many
 * elements those of his line. n-bar is the least whole number, from 2 on, not below 2 A^2 + 1/2. */
static void taylors_pattern_has_his_zeros(void **state) {
    (void)state;
    static const struct {
        double db;
        int level;
    } cases[] = {{-6.0, 2}, {-20.0, 3}, {-30.0, 4}, {-40.0, 7}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        double a = acosh(pow(10.0, -cases[i].db / 20.0)) / PI, level = cases[i].level;
        double sigma = level / sqrt(a * a + (level - 0.5) * (level - 0.5));
        weigh(ASDIC_SHADING_TAYLOR, ASDIC_ARRAY_MAX_ELEMENTS, cases[i].db);
        for (int n = 1; n < 12; n++) {
            double zero = n < cases[i].level ? sigma * sqrt(a * a + (n - 0.5) * (n - 0.5)) : n;
            assert_close(
                far_field(ASDIC_ARRAY_MAX_ELEMENTS, 2.0 * PI * zero / ASDIC_ARRAY_MAX_ELEMENTS),
                0.0, 1e-6);
        }
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(weights_are_even_and_add_up_to_one),
        cmocka_unit_test(plain_and_hann_are_as_by_hand),
        cmocka_unit_test(chebyshevs_side_lobes_are_level),
        cmocka_unit_test(taylors_pattern_has_his_zeros),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
