/* The shape of the formulas: finite everywhere, monotone and continuous where they must be. */
#include "asserts.h"

#include "../../kernels/backscatter.h"
#include "../../kernels/beam.h"
#include "../../kernels/detection.h"
#include "../../kernels/noise.h"
#include "../../kernels/target.h"
#include "../../kernels/water.h"

/* Sine of the grazing angle at step I of 9000, both ends included. */
static double sine(int i) {
    return i == 9000 ? 1.0 : sin(i * (3.14159265358979323846 / 18000.0));
}

/* SEARAY falls by up to 1e-3 dB on its plateau; the surface law never falls. */
static void backscatter_rises_with_the_grazing_angle(void **state) {
    (void)state;
    for (double bt = 1.0; bt <= 4.0; bt += 0.25) {
        for (double wind = 0.0; wind <= 60.0; wind += 15.0) {
            double f = 100.0, bottom = 0.0, surface = 0.0, cap = surface_cap_lin(wind);
            for (int i = 0; i <= 9000; i++) {
                double b = bottom_backscatter_lin(bottom_gain(bt, f), bottom_peak(bt), bt, sine(i));
                double s = surface_backscatter_lin(surface_gain(wind, f), surface_beta0(wind),
                                                   surface_beta1(f), cap, sine(i));
                assert_true(isfinite(b) && b > 0.0 && isfinite(s) && s >= 0.0 && s <= cap);
                assert_true(b >= bottom * (1.0 - 3e-4) && s >= surface * (1.0 - 1e-12));
                bottom = b;
                surface = s;
            }
        }
    }
}

/* Chapman & Harris, JASA 34, 1592 (1962), a fit to explosives at 400..6400 Hz in up to 30 kn:
 * 3.3 b log10(theta / 30) - 42.4 log10 b + 2.6 dB, b = 158 (v f^(1/3))^-0.58, v in knots, f in Hz. */
static double chapman_harris_db(double wind_kn, double f_hz, double grazing_deg) {
    double b = 158.0 * pow(wind_kn * cbrt(f_hz), -0.58);
    return 3.3 * b * log10(grazing_deg / 30.0) - 42.4 * log10(b) + 2.6;
}

/* Another measurement of what the course's law says of the surface, at the low end of its band. */
static void the_surface_is_near_chapman_and_harris(void **state) {
    (void)state;
    for (double f_khz = 1.0; f_khz <= 6.4; f_khz += 0.6) {
        for (int degrees = 5; degrees <= 40; degrees++) {
            double law = surface_backscatter_lin(surface_gain(20.0, f_khz), surface_beta0(20.0),
                                                 surface_beta1(f_khz), surface_cap_lin(20.0),
                                                 sine(100 * degrees));
            double off_db = 10.0 * log10(law) - chapman_harris_db(20.0, 1000.0 * f_khz, degrees);
            assert_true(off_db > 0.0 && off_db < (degrees <= 20 ? 2.9 : 5.1));
        }
    }
}

static void rounding_beyond_the_ends_is_harmless(void **state) {
    (void)state;
    static const double beyond[] = {-1e-7, -0.0, 0.0, 1e-300, 1.0, 1.0 + 1e-7};
    for (size_t i = 0; i < sizeof beyond / sizeof *beyond; i++) {
        double s = surface_backscatter_lin(surface_gain(10, 100), surface_beta0(10),
                                           surface_beta1(100), surface_cap_lin(10), beyond[i]);
        assert_true(isfinite(s) && s >= 0.0);
        assert_true(
            isfinite(bottom_backscatter_lin(bottom_gain(2, 100), bottom_peak(2), 2.0, beyond[i])));
        assert_true(isfinite(facet_strength_lin(beyond[i], 1.0, 0.1, 1e-5)));
    }
}

static void absorption_rises_with_frequency_and_hardly_jumps_at_20_degrees(void **state) {
    (void)state;
    for (double t = -2.0; t <= 40.0; t += 3.0) {
        double last = 0.0;
        for (double f = 0.1; f <= 3000.0; f *= 1.05) {
            double a = absorption_db_per_km(f, t, 35.0, 10.0, 8.0);
            assert_true(isfinite(a) && a > last);
            last = a;
        }
        assert_true(isfinite(absorption_db_per_km(100.0, t, 0.0, 10.0, 8.0)));
    }
    double below = absorption_db_per_km(1000.0, 20.0, 35.0, 0.0, 8.0);
    assert_close_relative(absorption_db_per_km(1000.0, 20.0 + 1e-9, 35.0, 0.0, 8.0), below, 1e-3);
}

static void sinc2_is_even_bounded_and_zero_at_whole_numbers(void **state) {
    (void)state;
    assert_true(sinc2(0.0) == 1.0 && sinc2(1e-300) == 1.0);
    for (int i = 1; i <= 40; i++) {
        assert_true(sinc2(i) == 0.0);
    }
    for (double x = 0.0; x < 40.0; x += 0.0137) {
        assert_true(sinc2(x) == sinc2(-x) && sinc2(x) <= 1.0);
        assert_true(sinc_sign(x) == ((int)x % 2 == 1 ? -1.0 : 1.0) &&
                    sinc_sign(-x) == sinc_sign(x));
    }
}

/* sigma = cos^2 / pi: 2/3 sr over the hemisphere. */
static void very_rough_facet_is_a_lambert_surface(void **state) {
    (void)state;
    double sum =
        0.0; /* integral of sigma over projected hemisphere for pure Lambert is 2/3 pi/pi */
    for (int i = 0; i < 10000; i++) {
        double c = (i + 0.5) / 10000.0;
        sum += facet_strength_lin(c, 1.0, 1e6, 1e-3) * 2.0 / 10000.0;
    }
    assert_close(sum * 3.14159265358979323846, 2.0 / 3.0, 1e-3);
}

/* What a facet of gentle slopes sends into all directions is what arrives, whole and halved, from steep and slanting
 * ways; what it sends from A to B it sends from B to A. */
static void a_facet_sends_on_what_arrives(void **state) {
    (void)state;
    const double pi = 3.14159265358979323846, slope_ms = 0.003;
    for (double in_deg = 0.0; in_deg < 61.0; in_deg += 15.0) {
        double c = cos(in_deg * pi / 180.0), s = sin(in_deg * pi / 180.0);
        enum { TURNS = 720, SINES = 2000 };
        double sum[2] = {0.0, 0.0};
        for (int i = 0; i < TURNS * SINES; i++) {
            double turn = (i % TURNS + 0.5) * 2.0 * pi / TURNS, co = (i / TURNS + 0.5) / SINES;
            double so = sqrt(1.0 - co * co), x = s + so * cos(turn), y = so * sin(turn);
            double middle = sqrt(x * x + y * y + (c + co) * (c + co));
            double cos_middle = (c + co) / middle, sin2 = (x * x + y * y) / (middle * middle);
            for (int rough = 0; rough < 2; rough++) {
                double f = facet_strength_between_lin(c, co, cos_middle, sin2, 0.5,
                                                      rough ? 1e6 : 0.0, slope_ms);
                sum[rough] += f * 2.0 * pi / TURNS / SINES;
                assert_true(f == facet_strength_between_lin(co, c, cos_middle, sin2, 0.5,
                                                            rough ? 1e6 : 0.0, slope_ms));
            }
        }
        print_message("from %g degrees: %.4f and %.4f of what arrives\n", in_deg, sum[0] / c,
                      sum[1] / c);
        assert_close(sum[0] / c, 0.5, 0.005);
        assert_close(sum[1] / c, 0.5, 1e-6);
    }
}

static void water_is_monotone(void **state) {
    (void)state;
    for (double s = 0.0; s <= 45.0; s += 5.0) {
        for (double z = 0.0; z <= 1000.0; z += 100.0) {
            for (double t = 0.0; t < 35.0; t += 0.5) {
                double c = sound_speed_medwin_mps(t, s, z);
                assert_true(sound_speed_medwin_mps(t + 0.5, s, z) > c);
                assert_true(sound_speed_medwin_mps(t, s + 1.0, z) > c);
                assert_true(sound_speed_medwin_mps(t, s, z + 1.0) > c);
            }
        }
    }
    for (double d = 1e-3; d < 1e5; d *= 1.1) {
        double loss = transmission_loss_db(d, 30.0);
        assert_true(transmission_loss_db(1.1 * d, 30.0) > loss);
        assert_true((transmission_loss_db(d, 40.0) > loss) == (d > 1.0) || d == 1.0);
        assert_close(10.0 * log10(transmission_lin(d, 1.0)), -transmission_loss_db(d, 1.0), 1e-9);
    }
}

static void noise_is_the_sum_of_its_parts(void **state) {
    (void)state;
    for (double f = 0.1; f < 1000.0; f *= 1.1) {
        assert_true(noise_turbulence_db(1.1 * f) < noise_turbulence_db(f));
        assert_true(noise_traffic_db(1.1 * f, 0.5) < noise_traffic_db(f, 0.5));
        assert_true(noise_thermal_db(1.1 * f) > noise_thermal_db(f));
        for (double wind = 0.0; wind < 40.0; wind += 5.0) {
            double sea = noise_sea_state_db(f, wind), all = noise_db(f, 0.5, wind);
            double most = fmax(fmax(noise_turbulence_db(f), noise_traffic_db(f, 0.5)),
                               fmax(sea, noise_thermal_db(f)));
            assert_true(all >= most && all <= most + 10.0 * log10(4.0));
            assert_true(noise_sea_state_db(f, wind + 5.0) > sea);
            assert_true(noise_db(f, 0.6, wind) > all);
        }
    }
}

/* Between 0 and 1, falling with the threshold, rising with the target, without a jump where one way of
 * summing gives over to another. */
static void check_chances(double looks, int target, double snr, double shape) {
    double last = 1.0;
    for (double x = 1e-3; x < 300.0; x *= 1.07) {
        double chance[3];
        for (int i = 0; i < 3; i++) { /* here, a hair beyond, and for a louder target */
            double threshold = i == 1 ? x * (1.0 + 1e-9) : x, level = i == 2 ? 1.1 * snr : snr;
            chance[i] = isinf(shape) ? detection_exponential(threshold, level, looks, target)
                                     : detection_k(threshold, level, looks, target, shape, 0.0);
        }
        assert_true(chance[0] >= 0.0 && chance[0] <= last * (1.0 + 1e-10));
        assert_true(chance[2] >= chance[0] * (1.0 - 1e-10));
        assert_true(fabs(chance[1] - chance[0]) <= chance[0] * (1e-9 + 2e-9 * looks * x));
        last = chance[0];
    }
}

static void chances_are_monotone_and_continuous(void **state) {
    (void)state;
    static const double looks[] = {1, 4, 15, 16, 17, 100}, snrs[] = {0.0, 0.1, 3.0, 50.0, 1000.0};
    static const int targets[] = {TARGET_STEADY, TARGET_SWERLING1, TARGET_SWERLING3};
    for (int l = 0; l < 6; l++) {
        for (int s = 0; s < 5; s++) {
            for (int k = 0; k < 3; k++) {
                check_chances(looks[l], targets[k], snrs[s], INFINITY);
            }
        }
    }
    check_chances(1, TARGET_SWERLING1, 0.0, 0.05);
    check_chances(1, TARGET_SWERLING1, 10.0, 1.0);
    check_chances(4, TARGET_SWERLING1, 10.0, 50.0);
    check_chances(1, TARGET_STEADY, 3.0, 1000.0);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(backscatter_rises_with_the_grazing_angle),
        cmocka_unit_test(the_surface_is_near_chapman_and_harris),
        cmocka_unit_test(rounding_beyond_the_ends_is_harmless),
        cmocka_unit_test(absorption_rises_with_frequency_and_hardly_jumps_at_20_degrees),
        cmocka_unit_test(sinc2_is_even_bounded_and_zero_at_whole_numbers),
        cmocka_unit_test(very_rough_facet_is_a_lambert_surface),
        cmocka_unit_test(a_facet_sends_on_what_arrives),
        cmocka_unit_test(water_is_monotone),
        cmocka_unit_test(noise_is_the_sum_of_its_parts),
        cmocka_unit_test(chances_are_monotone_and_continuous),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
