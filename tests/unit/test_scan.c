/* A detector at work: decisions of a ping, the map, the tracks. */
#include "asserts.h"
#include "test_context.h"

#include <asdic/scan.h>

#include <stdlib.h>

#define DEGREE (3.14159265358979323846 / 180.0)
#define SPEED 1500.0

static asdic_sonar sonar_of(const asdic_beam *receivers, size_t count) {
    asdic_sonar sonar = asdic_sonar_default();
    sonar.receivers = receivers;
    sonar.receiver_count = count;
    return sonar;
}

/* A normal variate. */
static double noise(unsigned *seed) {
    double sum = 0.0;
    for (int i = 0; i < 12; i++) {
        sum += (double)(rand_r(seed) % 10000) / 10000.0;
    }
    return sum - 6.0;
}

static void a_ping_is_decided(void **state) {
    (void)state;
    enum { BINS = 100 };
    asdic_sonar sonar = asdic_sonar_default();
    asdic_beam beams[2] = {sonar.transmitter, sonar.transmitter};
    double z[2 * BINS], mean[2 * BINS], noise[2 * BINS];
    for (int speckle = ASDIC_SPECKLE_RAYLEIGH; speckle <= ASDIC_SPECKLE_K; speckle++) {
        sonar = sonar_of(beams, 2);
        sonar.speckle = (asdic_speckle)speckle;
        sonar.speckle_shape = 2.0;
        asdic_detector detector = asdic_detector_default();
        asdic_scan *scan = NULL;
        assert_ok(ctx, asdic_scan_create(ctx, &sonar, SPEED, BINS, &detector, NULL, &scan));
        for (int i = 0; i < 2 * BINS; i++) {
            mean[i] = i ? 1e-9 / i : 0.0;
            z[i] = mean[i];
            noise[i] = 1e-12;
        }
        assert_ok(ctx, asdic_scan_ping(scan, z, mean, noise, NULL));
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
    assert_true(asdic_scan_get(scan).threshold_lin[50] > z[50]);
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
    detector.cost_ratio = -1.0;
    assert_status(ctx, asdic_scan_create(ctx, &sonar, SPEED, BINS, &detector, NULL, &scan),
                  ASDIC_ERROR_ARGUMENT);
    detector = asdic_detector_default();
    detector.pfa = 1.0;
    assert_status(ctx, asdic_scan_create(ctx, &sonar, SPEED, BINS, &detector, NULL, &scan),
                  ASDIC_ERROR_ARGUMENT);
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

/* One beam ahead, an echo at 20 m: occupied there, free before, unknown beside. */
static void the_map_remembers(void **state) {
    (void)state;
    enum { BINS = 100 };
    asdic_sonar sonar = asdic_sonar_default();
    asdic_beam beams[2] = {sonar.transmitter, sonar.transmitter};
    double llr[2 * BINS];
    beams[1].pitch_rad = 0.0;
    sonar = sonar_of(beams, 2);
    for (int i = 0; i < 2 * BINS; i++) {
        llr[i] = i % BINS == 0 ? NAN : i == 40 ? 3.0 : -2.0; /* the second beam misses it */
    }
    asdic_vec3 low = {-1.0, -20.0, 0.0}, high = {60.0, 20.0, 0.0};
    asdic_occupancy *map = NULL;
    assert_ok(ctx, asdic_occupancy_create(ctx, low, high, 0.25, 0.01, 10.0, &map));
    asdic_pose pose = {0};
    double prior = log(0.01 / 0.99);
#define AT(north, east)                                                                            \
    ((double)map->log_odds[(size_t)(((north) + 1.0) / 0.25) * map->columns +                       \
                           (size_t)(((east) + 20.0) / 0.25)])
    asdic_occupancy_add(map, &sonar, SPEED, &pose, BINS, llr);
    assert_close(AT(20.3, 0.1), prior + 3.0, 1e-6); /* of two that are alike, the first */
    assert_close(AT(10.3, 0.1), prior - 2.0, 1e-6);
    assert_true(isnan(AT(20.3, 15.0)) && isnan(AT(-0.5, 0.1)) && isnan(AT(55.0, 0.1)));
    for (int i = 0; i < 20; i++) {
        asdic_occupancy_add(map, &sonar, SPEED, &pose, BINS, llr);
    }
    assert_close(AT(20.3, 0.1), 10.0, 1e-6);
    assert_close(AT(10.3, 0.1), -10.0, 1e-6);
    /* Fixed in the world: from 5 m further on the echo lies 5 m further. */
    pose.position_m.x = 5.0;
    asdic_occupancy_add(map, &sonar, SPEED, &pose, BINS, llr);
    assert_close(AT(20.3, 0.1), 8.0, 1e-6);
    assert_close(AT(25.3, 0.1), -7.0, 1e-6);
    asdic_occupancy_destroy(&map);
    assert_status(ctx, asdic_occupancy_create(ctx, low, high, 1e-4, 0.01, 10.0, &map),
                  ASDIC_ERROR_ARGUMENT);
    assert_contains(asdic_context_error(ctx), "larger");
}

/* Of beams that overlap in bearing the nearest is asked; of elevations, all, and their ratios
 * averaged. */
static void the_map_asks_each_elevation_once(void **state) {
    (void)state;
    enum { BINS = 100, BEAMS = 5 };
    asdic_sonar sonar = asdic_sonar_default();
    asdic_beam beams[BEAMS];
    double llr[BEAMS * BINS];
    static const double say[BEAMS] = {1.0, 2.0, -1.0, 4.0, -3.0};
    for (int b = 0; b < BEAMS; b++) {
        beams[b] = sonar.transmitter;
        for (int i = 0; i < BINS; i++) {
            llr[b * BINS + i] = say[b];
        }
    }
    /* Widths are 10.9 degrees: beams 0 to 2 are one elevation, 3 another, 4 a third. */
    beams[0].yaw_rad = -4.0 * DEGREE;
    beams[1].yaw_rad = 4.0 * DEGREE;
    beams[1].pitch_rad = 1.0 * DEGREE;
    beams[3].pitch_rad = 15.0 * DEGREE;
    beams[4].pitch_rad = -30.0 * DEGREE;
    sonar = sonar_of(beams, BEAMS);
    asdic_vec3 low = {-1.0, -20.0, 0.0}, high = {60.0, 20.0, 0.0};
    asdic_occupancy *map = NULL;
    asdic_pose pose = {0};
    double prior = log(0.01 / 0.99), above = exp(4.0) + exp(-3.0);
    for (int turned = 0; turned < 2; turned++) { /* whatever the order of the receivers */
        assert_ok(ctx, asdic_occupancy_create(ctx, low, high, 0.25, 0.01, 10.0, &map));
        asdic_occupancy_add(map, &sonar, SPEED, &pose, BINS, llr);
        assert_close(AT(30.1, 0.1), prior + log((exp(-1.0) + above) / 3.0), 1e-5);
        assert_close(AT(30.1, 2.1), prior + log((exp(2.0) + above) / 3.0), 1e-5);
        assert_close(AT(30.1, -2.1), prior + log((exp(1.0) + above) / 3.0), 1e-5);
        assert_close(AT(30.1, 4.1), prior + 2.0, 1e-5); /* outside of all but one */
        asdic_occupancy_destroy(&map);
        for (int i = 0; i < BINS; i++) {
            double first = llr[i];
            llr[i] = llr[4 * BINS + i];
            llr[4 * BINS + i] = first;
        }
        asdic_beam first = beams[0];
        beams[0] = beams[4];
        beams[4] = first;
    }
    /* A bin of which nothing is known says nothing. */
    for (int i = 0; i < BINS; i++) {
        llr[2 * BINS + i] = NAN;
    }
    assert_ok(ctx, asdic_occupancy_create(ctx, low, high, 0.25, 0.01, 10.0, &map));
    asdic_occupancy_add(map, &sonar, SPEED, &pose, BINS, llr);
    assert_close(AT(30.1, 0.2), prior + log((exp(2.0) + above) / 3.0), 1e-5);
    asdic_occupancy_destroy(&map);
}

/* Two targets that pass each other, measured with 0.3 m, missed one time in five, among clutter. */
static void tracks_follow(void **state) {
    (void)state;
    asdic_tracker *tracker = NULL;
    asdic_tracker_options options = asdic_tracker_options_default();
    assert_ok(ctx, asdic_tracker_create(ctx, &options, &tracker));
    unsigned seed = 4;
    size_t count = 0, confirmed_clutter = 0;
    double square = 0.0, chi2 = 0.0;
    int errors = 0;
    for (int k = 0; k < 200; k++) {
        double t = 0.5 * k;
        asdic_plot_point plots[5];
        size_t n = 0;
        for (int i = 0; i < 2; i++) {
            if (k > 5 && rand_r(&seed) % 5 == 0) {
                continue;
            }
            double north = i ? 50.0 - 0.4 * t : 10.0 + 0.4 * t, east = i ? 4.0 : -4.0;
            plots[n++] = (asdic_plot_point){.north_m = north + 0.3 * noise(&seed),
                                            .east_m = east + 0.3 * noise(&seed),
                                            .variance_nn_m2 = 0.09,
                                            .variance_ee_m2 = 0.09,
                                            .label = i};
        }
        plots[n++] = (asdic_plot_point){.north_m = (double)(rand_r(&seed) % 100),
                                        .east_m = (double)(rand_r(&seed) % 100) - 50.0,
                                        .variance_nn_m2 = 0.09,
                                        .variance_ee_m2 = 0.09,
                                        .label = -1};
        assert_ok(ctx, asdic_tracker_update(tracker, t, plots, n));
        const asdic_track_state *tracks = asdic_tracker_get(tracker, &count);
        int seen = 0;
        for (size_t i = 0; i < count; i++) {
            const asdic_track_state *s = &tracks[i];
            confirmed_clutter += s->confirmed && s->id > 2 && s->label < 0;
            if (s->id > 2 || k < 20) {
                continue;
            }
            double north = s->id == 2 ? 50.0 - 0.4 * t : 10.0 + 0.4 * t;
            double off = s->north_m - north;
            seen++;
            square += off * off;
            chi2 += off * off / (s->sd_north_m * s->sd_north_m);
            errors++;
            assert_true(s->confirmed);
            assert_close(s->north_mps, s->id == 2 ? -0.4 : 0.4, 0.4);
        }
        assert_true(k < 20 || seen == 2); /* neither was lost nor changed its number */
    }
    print_message("r.m.s. error %.3f m, chi-squared per ping %.2f, clutter confirmed %zu\n",
                  sqrt(square / errors), chi2 / errors, confirmed_clutter);
    assert_true(sqrt(square / errors) < 0.25);               /* better than a single plot */
    assert_true(chi2 / errors > 0.4 && chi2 / errors < 1.6); /* and as good as it says */
    /* Without plots tracks end. */
    for (int k = 0; k < 6; k++) {
        assert_ok(ctx, asdic_tracker_update(tracker, 100.0 + k, NULL, 0));
    }
    asdic_tracker_get(tracker, &count);
    assert_int_equal(count, 0);
    assert_status(ctx, asdic_tracker_update(tracker, 3.0, NULL, 0), ASDIC_ERROR_ARGUMENT);
    asdic_tracker_destroy(&tracker);
    options.confirm = 6;
    assert_status(ctx, asdic_tracker_create(ctx, &options, &tracker), ASDIC_ERROR_ARGUMENT);
}

/* Clutter anywhere in a square, from nearly none to a plot in every gate: confirmed tracks per
 * plot. */
static void clutter_confirms_tracks_as_said(void **state) {
    (void)state;
    static const struct {
        double step_s, per_ping;
        int pings;
        double low, high; /* allowed of what is said */
    } cases[] = {
        {0.02, 100.0, 400, 0.8, 1.2}, {0.1, 60.0, 400, 0.75, 1.2}, {0.5, 40.0, 200, 0.5, 1.2}};
    enum { SIDE_M = 20 };
    for (size_t n = 0; n < sizeof cases / sizeof *cases; n++) {
        asdic_tracker *tracker = NULL;
        asdic_tracker_options options = asdic_tracker_options_default();
        assert_ok(ctx, asdic_tracker_create(ctx, &options, &tracker));
        asdic_plot_point plots[400];
        uint8_t *seen = calloc(400 * 400, 1);
        unsigned seed = 11;
        double total = 0.0, confirmed = 0.0;
        for (int k = 0; k < cases[n].pings; k++) {
            size_t count = 0; /* Poisson */
            for (double left = cases[n].per_ping; count < 400; count++) {
                left += log((rand_r(&seed) + 0.5) / (RAND_MAX + 1.0));
                if (left < 0.0) {
                    break;
                }
                plots[count] =
                    (asdic_plot_point){.north_m = SIDE_M * (rand_r(&seed) / (double)RAND_MAX),
                                       .east_m = SIDE_M * (rand_r(&seed) / (double)RAND_MAX),
                                       .variance_nn_m2 = 0.01,
                                       .variance_ee_m2 = 0.04,
                                       .label = -1};
            }
            total += (double)count;
            assert_ok(ctx, asdic_tracker_update(tracker, k * cases[n].step_s, plots, count));
            size_t alive = 0;
            const asdic_track_state *tracks = asdic_tracker_get(tracker, &alive);
            for (size_t i = 0; i < alive; i++) {
                confirmed += tracks[i].confirmed && !seen[tracks[i].id];
                seen[tracks[i].id] |= tracks[i].confirmed;
            }
        }
        double said = asdic_tracker_false_share(&options, cases[n].step_s, &plots[0],
                                                cases[n].per_ping / (SIDE_M * SIDE_M), SIDE_M);
        print_message("%g plots a ping, %g s apart: %.0f confirmed of %.0f, %.1f were said\n",
                      cases[n].per_ping, cases[n].step_s, confirmed, total, said * total);
        double spread = 2.6 * sqrt(said * total);
        assert_true(confirmed > cases[n].low * said * total - spread);
        assert_true(confirmed < cases[n].high * said * total + spread);
        free(seen);
        asdic_tracker_destroy(&tracker);
    }
    asdic_tracker_options at_once = asdic_tracker_options_default();
    asdic_plot_point plot = {.variance_nn_m2 = 1.0, .variance_ee_m2 = 1.0};
    assert_close(asdic_tracker_false_share(&at_once, 1.0, &plot, 0.0, INFINITY), 0.0, 0.0);
    at_once.confirm = 1;
    assert_close(asdic_tracker_false_share(&at_once, 1.0, &plot, 1.0, INFINITY), 1.0, 0.0);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_ping_is_decided),
        cmocka_unit_test(sampling_errors_are_allowed_for),
        cmocka_unit_test(beams_have_axes_and_widths),
        cmocka_unit_test(the_map_remembers),
        cmocka_unit_test(the_map_asks_each_elevation_once),
        cmocka_unit_test(tracks_follow),
        cmocka_unit_test(clutter_confirms_tracks_as_said),
    };
    return cmocka_run_group_tests(tests, context_begin, context_end);
}
