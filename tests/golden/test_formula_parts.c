/*
 * Values of an independent program for what has no name in `asdic model`: parts of formulas, and what
 * the detector is made of.
 */
#include "asserts.h"

#include <asdic/detect.h>

#include "../../kernels/backscatter.h"
#include "../../kernels/beam.h"
#include "../../kernels/coherent.h"
#include "../../kernels/detection.h"
#include "../../kernels/facet_form.h"
#include "../../kernels/target.h"
#include "../../kernels/water.h"

#include <complex.h>

typedef struct part {
    const char *name;
    double actual, expected, absolute, relative;
} part;

static void check(const part *parts, size_t count) {
    double worst = 0.0;
    for (size_t i = 0; i < count; i++) {
        const part *p = &parts[i];
        double off = fabs(p->actual - p->expected);
        worst = fmax(worst, off / fabs(p->expected));
        test_assert_close(p->actual, p->expected, p->absolute + p->relative * fabs(p->expected),
                          p->name, __FILE__, __LINE__);
    }
    print_message("%zu values, worst relative error %.2g\n", count, worst);
}

static double mirror_share_at(double grazing_deg, double roughness_m) {
    double sine = sin(grazing_deg * 3.14159265358979323846 / 180.0);
    return mirror_share(sine, 1.0, roughness_parameter(1500.0 / 100e3, roughness_m));
}

/* Integral of the facet law over the visible half of a sphere of radius 1 m, dB. */
static double facet_sphere_db(double slope_ms) {
    enum { STEPS = 200000 };
    double sum = 0.0;
    for (int i = 0; i < STEPS; i++) {
        sum += facet_strength_lin((i + 0.5) / STEPS, 1.0, 0.0, slope_ms) / STEPS;
    }
    return 10.0 * log10(2.0 * 3.14159265358979323846 * sum);
}

/* dB/km in distilled water of which alpha / f^2 is so many 1e-17 s^2/cm. J. M. M. Pinkerton, Proc. Phys. Soc. B 62,
 * 129 (1949), measured it from 7 to 70 MHz; numbers are those of the polynomial that k-Wave fits to his. */
static double distilled_db_per_km(double f_khz, double per_f2) {
    double np_per_m = 100.0 * 1e-17 * per_f2 * (1e3 * f_khz) * (1e3 * f_khz);
    return 1e3 * np_per_m * 20.0 / log(10.0);
}

static void parts_of_formulas(void **state) {
    (void)state;
    const double c = sound_speed_francois_garrison_mps(10.0, 35.0, 12.0), l = 10.0 / 3.0;
    const part parts[] = {
        {"boric acid", absorption_boric_db_per_km(8.86, 100, 10, 35, 8, c), 0.11567513571981158, 0,
         1e-9},
        {"magnesium sulphate", absorption_magnesium_db_per_km(100, 10, 35, 12, c),
         30.35257033778568, 0, 1e-9},
        {"viscosity", absorption_viscosity_db_per_km(100, 10, 12), 3.10657178250048, 0, 1e-9},
        {"water at 3 MHz, 0 degC", absorption_viscosity_db_per_km(3000, 0, 0),
         distilled_db_per_km(3000, 56.72), 0, 0.01},
        {"water at 3 MHz, 10 degC", absorption_viscosity_db_per_km(3000, 10, 0),
         distilled_db_per_km(3000, 35.80), 0, 0.01},
        {"water at 3 MHz, 20 degC", absorption_viscosity_db_per_km(3000, 20, 0),
         distilled_db_per_km(3000, 25.16), 0, 0.01},
        {"water at 3 MHz, 30 degC", absorption_viscosity_db_per_km(3000, 30, 0),
         distilled_db_per_km(3000, 19.09), 0, 0.01},
        {"pattern on the axis", beam_pattern_lin(1, 0, 0, l, l, 0), 1.0, 1e-15, 1e-9},
        {"pattern at 53 degrees", beam_pattern_lin(0.6, 0.8, 0, l, l, 0), 0.010686218587277797,
         1e-15, 1e-9},
        {"pattern in the face", beam_pattern_lin(1e-6, 1, 0, l, l, 0), 0.006839179895823285, 1e-15,
         1e-9},
        {"cap of the surface", 10 * log10(surface_cap_lin(0)), 14.236688812582415, 1e-9, 1e-9},
        {"coherent share, 1 mm", mirror_share_at(5, 0.001), 0.9946829337181282, 0, 1e-9},
        {"coherent share, 0.5 mm", mirror_share_at(90, 0.0005), 0.8390712666108275, 0, 1e-9},
        {"facets on a sphere", facet_sphere_db(0.01), -5.999045749125747, 1e-6, 1e-9},
        {"K clutter in noise", detection_k(5, 0, 1, TARGET_STEADY, 1, 0.3), 0.02263427136342417,
         1e-12, 1e-7},
    };
    check(parts, sizeof parts / sizeof *parts);
}

static void parts_of_the_detector(void **state) {
    (void)state;
    const asdic_background one = {.mean_lin = 1.0, .looks = 1, .shape = INFINITY};
    const asdic_background four = {.mean_lin = 1.0, .looks = 4, .shape = INFINITY};
    const asdic_background noisy = {.mean_lin = 1.0, .looks = 1, .shape = 1.0, .noise_share = 0.3};
    asdic_context *ctx = NULL;
    double factor = 0.0;
    assert_int_equal(asdic_context_create(&ctx), ASDIC_OK);
    assert_ok(ctx, asdic_cfar_factor(ctx, ASDIC_CFAR_CA, 16, 0, 1, 1e-4, &factor));
    asdic_context_destroy(&ctx);
    const part parts[] = {
        {"CA-CFAR factor", factor, 12.452470560622764, 0, 1e-9},
        {"CA-CFAR P_D", asdic_cfar_pd(ASDIC_CFAR_CA, 16, 0, 1, 12.4525, ASDIC_TARGET_SWERLING1, 10),
         0.33494402479401175, 0, 1e-9},
        {"log-likelihood ratio, Swerling I, silence",
         asdic_detect_llr(&one, ASDIC_TARGET_SWERLING1, 8, 0), -2.197224577336219, 0, 1e-9},
        {"log-likelihood ratio, steady, silence",
         asdic_detect_llr(&one, ASDIC_TARGET_SWERLING0, 8, 0), -8.0, 1e-12, 1e-9},
        {"log-likelihood ratio, steady, 60 dB",
         asdic_detect_llr(&one, ASDIC_TARGET_SWERLING0, 8, 1e6), 5643.615021443025, 1e-6, 1e-9},
        {"P_D, Swerling II, 4 looks", asdic_detect_pd(&four, ASDIC_TARGET_SWERLING2, 2, 2),
         0.7214269441774828, 1e-14, 1e-8},
        {"P_FA, K clutter in noise", asdic_detect_pfa(&noisy, 5), 0.02263427136342417, 1e-12, 1e-7},
        {"posterior", asdic_detect_posterior(3, 0.01), 0.1686647887068201, 0, 1e-9},
    };
    check(parts, sizeof parts / sizeof *parts);
}

/* A triangle's mean phasor against the sum over a fine grid of rows, each in closed form. */
static void a_triangle_sums_its_phases(void **state) {
    (void)state;
    enum { ROWS = 20000 };
    static const double turns[][2] = {{0.0, 0.0},  {1e-4, 0.0}, {0.7, 0.0},  {0.7, 0.7},
                                      {0.3, -0.4}, {0.1, 0.65}, {0.0, -0.5}, {-0.6, -0.1}};
    const double turn = 2.0 * 3.14159265358979323846;
    double worst = 0.0;
    for (size_t i = 0; i < sizeof turns / sizeof *turns; i++) {
        double a = turns[i][0], b = turns[i][1], re = 0.0, im = 0.0;
        for (int row = 0; row < ROWS; row++) {
            double v = (row + 0.5) / ROWS, wide = 1.0 - v, x = 0.5 * turn * a * wide;
            double weight = 2.0 * wide / ROWS * (fabs(x) < 1e-9 ? 1.0 : sin(x) / x);
            double phase = turn * (a * (0.5 * wide - 1.0 / 3.0) + b * (v - 1.0 / 3.0));
            re += weight * cos(phase);
            im -= weight * sin(phase);
        }
        phasor form = triangle_form(a, b);
        worst = fmax(worst, hypot(form.re - re, form.im - im));
    }
    print_message("off by %.2g\n", worst);
    assert_true(worst < 1e-6);
}

/* R / |R| of Rayleigh's coefficient in complex numbers, of mud slower than water to rock, with and without losses. */
static void mirrored_waves_turn_as_their_coefficient(void **state) {
    (void)state;
    static const double bottoms[][3] = {/* of density, of index, of loss */
                                        {1.15, 1.02, 0.005},
                                        {1.9, 0.85, 0.017},
                                        {2.5, 0.4, 0.01},
                                        {1.9, 0.85, 0.0},
                                        {0.9, 1.2, 0.3}};
    for (size_t i = 0; i < sizeof bottoms / sizeof *bottoms; i++) {
        for (int degrees = 1; degrees <= 90; degrees++) {
            double sine = sin(degrees * 3.14159265358979323846 / 180.0), m = bottoms[i][0] * sine;
            double complex n = bottoms[i][1] * (1.0 - I * bottoms[i][2]);
            double complex root = csqrt(n * n - (1.0 - sine * sine));
            root = cimag(root) > 0.0 ? -root : root;
            double complex r = (m - root) / (m + root);
            phasor got = fluid_reflection_phase(sine, bottoms[i][0], bottoms[i][1], bottoms[i][2]);
            assert_close(got.re, creal(r) / cabs(r), 1e-9);
            assert_close(got.im, cimag(r) / cabs(r), 1e-9);
        }
    }
    phasor nothing = fluid_reflection_phase(1.0, 1.0, 1.0, 0.0);
    assert_true(nothing.re == 1.0 && nothing.im == 0.0);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(parts_of_formulas),
        cmocka_unit_test(parts_of_the_detector),
        cmocka_unit_test(a_triangle_sums_its_phases),
        cmocka_unit_test(mirrored_waves_turn_as_their_coefficient),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
