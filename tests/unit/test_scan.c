/* A detector at work: decisions of a ping. */
#include "asserts.h"
#include "test_context.h"
#include "scan_rig.h"

#include <math.h>
#include <stddef.h>
#include <string.h>

static void a_ping_is_decided(void **state) {
    (void)state;
    enum { BINS = 25 };
    asdic_sonar sonar = asdic_sonar_default();
    asdic_beam beams[2] = {sonar.transmitter, sonar.transmitter};
    double z[2 * BINS], mean[2 * BINS], noise[2 * BINS];
    for (int k = 0; k < 4; k++) {
        bool is_silent = k / 2;
        sonar = sonar_of(beams, 2);
        sonar.speckle = k % 2 ? ASDIC_SPECKLE_K : ASDIC_SPECKLE_RAYLEIGH;
        sonar.speckle_shape = 2.0;
        asdic_detector detector = asdic_detector_default();
        asdic_scan *scan = NULL;
        assert_ok(ctx, asdic_scan_create(ctx, &sonar, SPEED, BINS, &detector, NULL, &scan));
        for (int i = 0; i < 2 * BINS; i++) {
            mean[i] = i ? 0.25e-9 / i : 0.0; /* with a share of noise from 0.004 to 0.2 */
            z[i] = mean[i];
            noise[i] = is_silent ? 0.0 : 1e-12;
        }
        assert_ok(ctx, asdic_scan_ping(scan, z, mean, is_silent ? NULL : noise, NULL));
        asdic_scan_result r = asdic_scan_get(scan);
        assert_true(isnan(r.threshold_lin[0]) && isnan(r.llr[0]));
        for (int i = 1; i < 2 * BINS; i++) {
            asdic_background b = asdic_background_of(&sonar, SPEED, mean[i], noise[i]);
            assert_int_equal(b.looks, 7);
            assert_true(z[i] < r.threshold_lin[i]);
            /* The noise's share is told to a thousandth. */
            assert_close_relative(asdic_detect_pfa(&b, r.threshold_lin[i]), 1e-3, 0.01);
            assert_close(r.llr[i],
                         asdic_detect_llr(&b, ASDIC_TARGET_SWERLING1, 10.0 * mean[i], z[i]), 1e-9);
        }
        asdic_scan_destroy(&scan);
    }
    asdic_scan *scan = NULL;
    asdic_cfar cfar = asdic_cfar_default();
    asdic_detector detector = asdic_detector_default();
    assert_ok(ctx, asdic_scan_create(ctx, &sonar, SPEED, BINS, &detector, &cfar, &scan));
    assert_ok(ctx, asdic_scan_ping(scan, z, NULL, NULL, NULL));
    assert_true(asdic_scan_get(scan).threshold_lin[12] > z[12]);
    asdic_scan_destroy(&scan);
    /* By cost: as much P_FA as misses are dear. */
    double before = 0.0;
    for (double cost = 1.0; cost < 1e4; cost *= 10.0) {
        detector.cost_ratio = cost;
        assert_ok(ctx, asdic_scan_create(ctx, &sonar, SPEED, BINS, &detector, NULL, &scan));
        assert_ok(ctx, asdic_scan_ping(scan, z, mean, noise, NULL));
        asdic_scan_result r = asdic_scan_get(scan);
        asdic_background b = asdic_background_of(&sonar, SPEED, mean[7], noise[7]);
        assert_close(
            asdic_detect_llr(&b, ASDIC_TARGET_SWERLING1, 10.0 * mean[7], r.threshold_lin[7]),
            asdic_detect_cost_llr(0.01, 1.0, cost), 0.01);
        assert_true(asdic_detect_pfa(&b, r.threshold_lin[7]) > before);
        before = asdic_detect_pfa(&b, r.threshold_lin[7]);
        asdic_scan_destroy(&scan);
    }
}

/* Beside a bin of which more than ten times as much is expected, of the same beam; not of intensities, nor with CFAR. */
static void nothing_is_decided_beside_loud_bins_of_coherent_pings(void **state) {
    (void)state;
    enum { BINS = 25, CELLS = 2 * BINS };
    static const int edges[] = {6, 8, BINS - 2};
    asdic_sonar sonar = asdic_sonar_default();
    asdic_beam beams[2] = {sonar.transmitter, sonar.transmitter};
    double mean[CELLS];
    for (int i = 0; i < CELLS; i++) {
        mean[i] = i == 7 || i == BINS - 1 ? 11.0 : i == 15 ? 9.0 : 1.0;
    }
    sonar = sonar_of(beams, 2);
    for (int k = 0; k < 4; k++) {
        bool is_coherent = k % 2, has_cfar = k / 2;
        asdic_cfar cfar = asdic_cfar_default();
        asdic_detector detector = asdic_detector_default();
        detector.cost_ratio = 10.0; /* by which CFAR's means are judged as those expected are */
        asdic_scan *scan = NULL;
        assert_ok(ctx, asdic_scan_create(ctx, &sonar, SPEED, BINS, &detector,
                                         has_cfar ? &cfar : NULL, &scan));
        asdic_scan_set_coherent(scan, is_coherent);
        assert_ok(ctx, asdic_scan_ping(scan, mean, has_cfar ? NULL : mean, NULL, NULL));
        asdic_scan_result r = asdic_scan_get(scan);
        for (int i = 0; i < CELLS; i++) {
            bool is_edge = i == edges[0] || i == edges[1] || i == edges[2];
            bool is_open = is_edge && is_coherent && !has_cfar;
            assert_int_equal(isnan(r.threshold_lin[i]), is_open);
            assert_int_equal(isnan(r.background_lin[i]), is_open);
            assert_int_equal(isnan(r.llr[i]), is_open);
        }
        asdic_scan_destroy(&scan);
    }
}

/* Whether a detector is taken that has VALUE in the number at OFFSET. */
static bool is_taken(size_t offset, double value) {
    asdic_sonar sonar = asdic_sonar_default();
    asdic_beam beam = sonar.transmitter;
    sonar = sonar_of(&beam, 1);
    asdic_detector detector = asdic_detector_default();
    asdic_scan *scan = NULL;
    memcpy((char *)&detector + offset, &value, sizeof value);
    asdic_status status = asdic_scan_create(ctx, &sonar, SPEED, 10, &detector, NULL, &scan);
    assert_int_equal(status == ASDIC_OK, scan != NULL);
    assert_true(status == ASDIC_OK || status == ASDIC_ERROR_ARGUMENT);
    asdic_scan_destroy(&scan);
    return status == ASDIC_OK;
}

static void detectors_have_limits(void **state) {
    (void)state;
    static const struct {
        size_t offset;
        double refused[5], taken[3];
    } limits[] = {
        {offsetof(asdic_detector, pfa), {0.0, 0.9, -0.1, 1.1, NAN}, {1e-12, 1e-3, 0.5}},
        {offsetof(asdic_detector, prior), {0.0, 0.9999, -0.1, 1.1, NAN}, {1e-9, 0.5, 0.999}},
        {offsetof(asdic_detector, snr_db),
         {INFINITY, -INFINITY, NAN, -30.0, 60.1},
         {-20.0, 0.0, 60.0}},
        {offsetof(asdic_detector, cost_ratio), {0.0, 1e-9, -1.0, -1e9, INFINITY}, {1e-6, 1e9, NAN}},
    };
    for (size_t i = 0; i < sizeof limits / sizeof *limits; i++) {
        for (size_t k = 0; k < 5; k++) {
            assert_false(is_taken(limits[i].offset, limits[i].refused[k]));
        }
        for (size_t k = 0; k < 3; k++) {
            assert_true(is_taken(limits[i].offset, limits[i].taken[k]));
        }
    }
}

/* Intensities whose means err by normal variates: thresholds that know the error keep P_FA. */
static void sampling_errors_are_allowed_for(void **state) {
    (void)state;
    enum { BINS = 1000, PINGS = 300 };
    static const struct {
        double error_db, bin_m, shape;
    } cases[] = {{0.1, 0.075, INFINITY}, {0.3, 0.075, INFINITY}, {0.6, 0.075, INFINITY},
                 {1.3, 0.075, INFINITY}, {0.3, 0.5, INFINITY},   {0.6, 0.075, 2.0}};
    for (size_t n = 0; n < sizeof cases / sizeof *cases; n++) {
        asdic_sonar sonar = asdic_sonar_default();
        asdic_beam beam = sonar.transmitter;
        asdic_detector detector = asdic_detector_default();
        asdic_scan *scan = NULL;
        double mean[BINS], z[BINS], exact = 0.0, lifted = 0.0;
        float stderr_db[BINS];
        unsigned seed = 3;
        detector.pfa = 3e-3;
        sonar = sonar_of(&beam, 1);
        sonar.bin_length_m = cases[n].bin_m;
        sonar.speckle = isinf(cases[n].shape) ? ASDIC_SPECKLE_RAYLEIGH : ASDIC_SPECKLE_K;
        sonar.speckle_shape = cases[n].shape;
        assert_ok(ctx, asdic_scan_create(ctx, &sonar, SPEED, BINS, &detector, NULL, &scan));
        for (uint64_t p = 0; p < PINGS; p++) {
            asdic_background law = asdic_background_of(&sonar, SPEED, 1.0, 0.0);
            asdic_detect_draw(&law, ASDIC_TARGET_SWERLING1, 0.0, 5, p * BINS, BINS, z);
            for (int i = 0; i < BINS; i++) {
                mean[i] = 1.0;
                stderr_db[i] = (float)cases[n].error_db;
                z[i] *= fmax(1.0 + cases[n].error_db * log(10.0) / 10.0 * noise(&seed), 0.0);
            }
            for (int k = 0; k < 2; k++) {
                assert_ok(ctx, asdic_scan_ping(scan, z, mean, NULL, k ? stderr_db : NULL));
                for (int i = 0; i < BINS; i++) {
                    *(k ? &lifted : &exact) += z[i] > asdic_scan_get(scan).threshold_lin[i];
                }
            }
        }
        print_message("%.1f dB, bins of %.3f m, shape %g: P_FA %.2e, with the error %.2e\n",
                      cases[n].error_db, cases[n].bin_m, cases[n].shape, exact / (PINGS * BINS),
                      lifted / (PINGS * BINS));
        assert_close_relative(lifted / (PINGS * BINS), detector.pfa, 0.1);
        asdic_scan_destroy(&scan);
    }
}

/* Where nothing is heard, a ping states NAN. */
static void bins_without_an_error_keep_their_threshold(void **state) {
    (void)state;
    enum { BINS = 20 };
    asdic_beam beam = asdic_sonar_default().transmitter;
    asdic_sonar sonar = sonar_of(&beam, 1);
    asdic_detector detector = asdic_detector_default();
    asdic_scan *scan = NULL;
    double mean[BINS], z[BINS], before[BINS];
    float stderr_db[BINS];
    assert_ok(ctx, asdic_scan_create(ctx, &sonar, SPEED, BINS, &detector, NULL, &scan));
    for (int i = 0; i < BINS; i++) {
        mean[i] = z[i] = 1.0;
        stderr_db[i] = i % 3 == 1 ? 1.0f : NAN;
    }
    assert_ok(ctx, asdic_scan_ping(scan, z, mean, NULL, NULL));
    memcpy(before, asdic_scan_get(scan).threshold_lin, sizeof before);
    assert_ok(ctx, asdic_scan_ping(scan, z, mean, NULL, stderr_db));
    for (int i = 0; i < BINS; i++) {
        double after = asdic_scan_get(scan).threshold_lin[i];
        assert_true(i % 3 == 1 ? after > 1.01 * before[i] : after == before[i]);
    }
    asdic_scan_destroy(&scan);
}

/* Bins of two looks (0.5 m, 2.24 kHz: 1.503 cells) have one in faster water (1.493): the threshold of a
 * scan is then that of an exponential, the mean times ln(1 / P_FA), and what one made there says. */
static void looks_follow_the_sound_speed(void **state) {
    (void)state;
    enum { BINS = 80 };
    asdic_beam beam = asdic_sonar_default().transmitter;
    asdic_sonar sonar = sonar_of(&beam, 1);
    asdic_detector detector = asdic_detector_default();
    asdic_cfar cfar = asdic_cfar_default();
    double mean[BINS], z[BINS];
    float stderr_db[BINS];
    sonar.speckle = ASDIC_SPECKLE_RAYLEIGH;
    sonar.bin_length_m = 0.5;
    sonar.bandwidth_hz = 2240.0;
    for (int i = 0; i < BINS; i++) {
        mean[i] = 3.0;
        z[i] = 3.0 + i % 3;
        stderr_db[i] = i % 2 ? 0.5f : 0.0f;
    }
    for (int k = 0; k < 2; k++) {
        asdic_scan *moved = NULL, *made = NULL;
        const asdic_cfar *by = k ? &cfar : NULL;
        assert_ok(ctx, asdic_scan_create(ctx, &sonar, 1490.0, BINS, &detector, by, &moved));
        assert_ok(ctx, asdic_scan_create(ctx, &sonar, 1500.0, BINS, &detector, by, &made));
        assert_ok(ctx, asdic_scan_ping(moved, z, mean, NULL, stderr_db));
        double two_looks = asdic_scan_get(moved).threshold_lin[40];
        asdic_scan_set_sound_speed(moved, 1500.0);
        assert_ok(ctx, asdic_scan_ping(moved, z, mean, NULL, stderr_db));
        assert_ok(ctx, asdic_scan_ping(made, z, mean, NULL, stderr_db));
        asdic_scan_result r = asdic_scan_get(moved), right = asdic_scan_get(made);
        for (int i = 0; i < BINS; i++) {
            assert_close(r.threshold_lin[i], right.threshold_lin[i], 0.0);
            assert_close(r.llr[i], right.llr[i], 0.0);
        }
        if (k == 0) {
            assert_close_relative(r.threshold_lin[40], 3.0 * log(1e3), 1e-6);
        }
        assert_true(two_looks < 0.8 * r.threshold_lin[40]);
        asdic_scan_destroy(&moved);
        asdic_scan_destroy(&made);
    }
}

static void beams_have_axes_and_widths(void **state) {
    (void)state;
    asdic_sonar sonar = asdic_sonar_default();
    asdic_beam beam = sonar.transmitter;
    beam.pitch_rad = 30.0 * DEGREE;
    asdic_pose east = {.yaw_rad = 90.0 * DEGREE};
    asdic_vec3 axis = asdic_beam_axis(&beam, &east);
    assert_close(axis.x, 0.0, 1e-12);
    assert_close(axis.y, cos(30.0 * DEGREE), 1e-12);
    assert_close(axis.z, 0.5, 1e-12); /* positive pitch looks down */
    sonar = sonar_of(&beam, 1);
    /* Two equal apertures of 3.33 wavelengths: sinc^4 is 1/2 at L sin / lambda = 0.3189. */
    assert_close(asdic_beam_width_rad(&sonar, 0, SPEED), 2.0 * asin(0.3189 * 0.3), 0.004);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_ping_is_decided),
        cmocka_unit_test(nothing_is_decided_beside_loud_bins_of_coherent_pings),
        cmocka_unit_test(detectors_have_limits),
        cmocka_unit_test(sampling_errors_are_allowed_for),
        cmocka_unit_test(bins_without_an_error_keep_their_threshold),
        cmocka_unit_test(looks_follow_the_sound_speed),
        cmocka_unit_test(beams_have_axes_and_widths),
    };
    return cmocka_run_group_tests(tests, context_begin, context_end);
}
