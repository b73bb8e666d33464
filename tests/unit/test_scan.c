/* A detector at work: decisions of a ping, the map, the tracks. */
#include "asserts.h"
#include "test_context.h"

#include "detect/evidence.h"

#include <asdic/scan.h>

#include <math.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

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
        {offsetof(asdic_detector, pfa), {0.0, 1.0, -0.1, 1.1, NAN}, {1e-12, 0.5, 0.999999}},
        {offsetof(asdic_detector, prior), {0.0, 1.0, -0.1, 1.1, NAN}, {1e-12, 0.5, 0.999999}},
        {offsetof(asdic_detector, snr_db),
         {INFINITY, -INFINITY, NAN, NAN, NAN},
         {-30.0, 0.0, 60.0}},
        {offsetof(asdic_detector, cost_ratio),
         {0.0, -1e-9, -1.0, -1e9, -INFINITY},
         {1e-9, 1e9, NAN}},
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

/* ---- the map: beams of 10.9 degrees, one look, a background of 1 ------------------------------ */

enum { MAP_BINS = 100, MAP_BEAMS = 5 };
static const double MAP_PRIOR = -4.59511985; /* ln(0.01 / 0.99) */

typedef struct map_rig {
    asdic_sonar sonar;
    asdic_beam beams[MAP_BEAMS];
    double intensity[MAP_BEAMS * MAP_BINS], background[MAP_BEAMS * MAP_BINS];
    asdic_occupancy *map;
    asdic_pose pose;
    double depth_m;
} map_rig;

static void map_begin(map_rig *r, size_t beams) {
    *r = (map_rig){.sonar = asdic_sonar_default(), .depth_m = INFINITY};
    for (size_t b = 0; b < beams; b++) {
        r->beams[b] = r->sonar.transmitter;
    }
    r->sonar = sonar_of(r->beams, beams);
    r->sonar.bandwidth_hz = 0.5 * SPEED / r->sonar.bin_length_m;
    for (size_t i = 0; i < MAP_BEAMS * MAP_BINS; i++) {
        r->intensity[i] = 0.3;
        r->background[i] = i % MAP_BINS == 0 ? (double)NAN : 1.0;
    }
    asdic_vec3 low = {-1.0, -30.0, 0.0}, high = {60.0, 30.0, 0.0};
    assert_ok(ctx, asdic_occupancy_create(ctx, low, high, 0.25, 0.01, 10.0, &r->map));
}

static asdic_look look_of(const map_rig *r) {
    return (asdic_look){.sonar = &r->sonar,
                        .sound_speed_mps = SPEED,
                        .pose = r->pose,
                        .depth_m = r->depth_m,
                        .bins = MAP_BINS,
                        .intensity_lin = r->intensity,
                        .background_lin = r->background,
                        .snr_db = 10.0};
}

static void map_look(map_rig *r) {
    const asdic_look look = look_of(r);
    assert_ok(ctx, asdic_occupancy_add(ctx, r->map, &look));
}

static double map_at(const map_rig *r, double north_m, double east_m) {
    size_t row = (size_t)((north_m + 1.0) / 0.25), column = (size_t)((east_m + 30.0) / 0.25);
    return (double)r->map->log_odds[row * r->map->columns + column];
}

/* A quiet bin clears a cell on the axis by the likelihood ratio of 10 dB, and a cell where the
 * two-way pattern is lower by that of as much less. */
static void quiet_bins_clear_by_what_would_be_heard(void **state) {
    (void)state;
    map_rig r;
    map_begin(&r, 2); /* two beams that are one: half the evidence from each */
    map_look(&r);
    for (int k = 0; k < 2; k++) {
        double aside = k * 5.0 * DEGREE, x = 0.05 * 100e3 / SPEED * sin(aside) * acos(-1.0);
        double gain = k ? pow(sin(x) / x, 4) : 1.0, snr = 10.0 * gain;
        double ratio = 0.3 * snr / (1.0 + snr) - log1p(snr);
        assert_close(map_at(&r, 30.1 * cos(aside), 30.1 * sin(aside)), MAP_PRIOR + ratio, 0.1);
    }
    assert_true(isnan(map_at(&r, 20.3, 15.0)) && isnan(map_at(&r, -0.5, 0.1)));
    assert_true(isnan(map_at(&r, 55.0, 0.1)));
    for (int i = 0; i < 20; i++) {
        map_look(&r);
    }
    assert_close(map_at(&r, 10.3, 0.1), -10.0, 1e-6);
    asdic_occupancy_destroy(&r.map);
}

/* An echo is shared by the arc it may come from: seen from one place alone, no cell is above even
 * odds, however often; seen from another as well, the cell where the arcs cross is. */
static void poses_tell_cells_apart(void **state) {
    (void)state;
    map_rig r;
    map_begin(&r, 1);
    r.intensity[40] = 40.0;
    for (int i = 0; i < 5; i++) {
        map_look(&r);
    }
    double shared = map_at(&r, 20.3, 0.1);
    assert_true(shared > MAP_PRIOR + 1.0 && shared < 0.0);
    double aside = map_at(&r, 20.3, 0.9);
    assert_true(aside > MAP_PRIOR + 1.0 && aside < 0.0);
    assert_true(map_at(&r, 18.3, 0.1) < -9.0);
    r.pose = (asdic_pose){.position_m = {20.3, -20.2, 0.0}, .yaw_rad = 90.0 * DEGREE};
    for (int i = 0; i < 5; i++) {
        map_look(&r);
    }
    assert_true(map_at(&r, 20.3, 0.1) > 0.0);
    assert_true(map_at(&r, 20.3, 1.6) < MAP_PRIOR);
    assert_true(map_at(&r, 21.9, 0.1) < MAP_PRIOR); /* on the second arc, off the first */
    asdic_occupancy_destroy(&r.map);
}

/* Cells of two bins' length, whose centres ahead lie in every other bin: an echo in one of those between is in the
 * cell round it. */
static void long_cells_hear_all_their_bins(void **state) {
    (void)state;
    map_rig r;
    map_begin(&r, 1);
    asdic_occupancy_destroy(&r.map);
    asdic_vec3 low = {-1.0, -30.0, 0.0}, high = {60.0, 30.0, 0.0};
    assert_ok(ctx, asdic_occupancy_create(ctx, low, high, 1.0, 0.01, 10.0, &r.map));
    r.intensity[40] = 40.0; /* 20 to 20.5 m; centres are at 19.5 and 20.5 m */
    for (int i = 0; i < 5; i++) {
        map_look(&r);
    }
    const float *cell = r.map->log_odds + 21 * r.map->columns + 30; /* [20, 21) m */
    assert_true((double)cell[0] > MAP_PRIOR + 1.0);
    assert_true((double)cell[2 * r.map->columns] < MAP_PRIOR - 2.0);
    assert_true((double)cell[-2 * (ptrdiff_t)r.map->columns] < MAP_PRIOR - 2.0);
    asdic_occupancy_destroy(&r.map);
}

/* A strong echo ahead comes in by the side lobes of the beams at its sides: no arc there, while an
 * object of its own at the same range is seen. */
static void side_lobes_are_explained(void **state) {
    (void)state;
    for (int has_other = 0; has_other < 2; has_other++) {
        map_rig r;
        map_begin(&r, 3);
        static const double yaw_deg[] = {-40.0, 0.0, 40.0};
        for (int b = 0; b < 3; b++) {
            r.beams[b].yaw_rad = yaw_deg[b] * DEGREE;
            double x = 0.05 * 100e3 / SPEED * sin(yaw_deg[b] * DEGREE) * acos(-1.0);
            double lobe = b == 1 ? 1.0 : pow(sin(x) / x, 2);
            r.sonar.transmitter.length_h_m = 0.005; /* all are heard alike */
            r.intensity[b * MAP_BINS + 40] = 1.0 + 1e4 * lobe;
        }
        assert_true(r.intensity[40] > 30.0); /* 15 dB above the background */
        r.intensity[2 * MAP_BINS + 40] += has_other ? 2e4 : 0.0;
        map_look(&r);
        double side = 20.2 * sin(40.0 * DEGREE), ahead = 20.2 * cos(40.0 * DEGREE);
        /* Some sixty cells share the echo: each is 1 - 0.99^60 re the rest. */
        assert_true(map_at(&r, 20.4, 0.1) > MAP_PRIOR + 0.5);
        assert_true(map_at(&r, ahead, -side) < MAP_PRIOR);
        assert_int_equal(map_at(&r, ahead, side) > MAP_PRIOR + 0.5, has_other);
        asdic_occupancy_destroy(&r.map);
    }
}

/* Faces that hear 20 dB less from behind: an echo from ahead is no object astern of a beam that looks there. */
static void echoes_through_the_rear_are_explained(void **state) {
    (void)state;
    map_rig r;
    map_begin(&r, 2);
    r.beams[1].yaw_rad = 180.0 * DEGREE;
    r.sonar.rear_floor_db = -20.0;
    r.pose.position_m.x = 30.0;
    r.intensity[40] = 1.0 + 1e5;
    r.intensity[MAP_BINS + 40] = 1.0 + 1e3;
    map_look(&r);
    assert_true(map_at(&r, 50.4, 0.1) > MAP_PRIOR + 0.5);
    assert_true(map_at(&r, 9.9, 0.1) < MAP_PRIOR);
    asdic_occupancy_destroy(&r.map);
}

/* On a floor that is known, 8 m below a beam that looks 30 degrees down, an echo at 16.25 m lies
 * 14.1 m away and nowhere else; what is above the beam's height stays as it was. */
static void echoes_lie_on_the_floor_that_is_known(void **state) {
    (void)state;
    map_rig r;
    map_begin(&r, 1);
    r.beams[0].pitch_rad = 30.0 * DEGREE;
    r.sonar.transmitter.pitch_rad = 30.0 * DEGREE;
    r.pose.position_m.z = r.depth_m = 4.0;
    for (size_t i = 0; i < r.map->rows * r.map->columns; i++) {
        r.map->floor_depth_m[i] = 12.0f;
    }
    r.intensity[32] = 40.0;
    for (int i = 0; i < 5; i++) {
        map_look(&r);
    }
    size_t row = (size_t)((14.1 + 1.0) / 0.25), column = (size_t)(30.1 / 0.25);
    const float *floor_odds = r.map->part[ASDIC_OCCUPANCY_FLOOR] + row * r.map->columns + column;
    assert_true((double)floor_odds[0] > MAP_PRIOR);
    for (size_t off = 4; off < 12; off++) { /* a metre and more from there */
        assert_true((double)floor_odds[off * r.map->columns] < MAP_PRIOR - 3.0);
        assert_true((double)floor_odds[-(ptrdiff_t)(off * r.map->columns)] < MAP_PRIOR - 3.0);
    }
    /* Far off the beam is in the floor. */
    assert_true(isnan(map_at(&r, 40.0, 0.1)));
    asdic_occupancy_destroy(&r.map);
}

/* Cells are heard whose centres lie within the range: to the north, south, east and west of the sonar the
 * farthest one 5 mm nearer than that, the next one a side farther. */
static void cells_lie_at_their_centres(void **state) {
    (void)state;
    const double cell_m = 0.25, range_m = MAP_BINS * 0.5;
    for (int k = 0; k < 4; k++) {
        map_rig r;
        map_begin(&r, 1);
        asdic_occupancy_destroy(&r.map);
        asdic_vec3 low = {-60.0, -60.0, 0.0}, high = {60.0, 60.0, 0.0};
        assert_ok(ctx, asdic_occupancy_create(ctx, low, high, cell_m, 0.01, 10.0, &r.map));
        r.sonar.bin_length_m = 0.5;
        r.sonar.transmitter.length_v_m = r.beams[0].length_v_m =
            1.0; /* flat: slant is no farther */
        /* The centre of [row][column] is at -60 + 0.125 + 0.25 row. */
        const double centre_m = -60.0 + (440 + 0.5) * cell_m; /* 50.125 */
        double shift = centre_m - range_m + 0.005;
        double c = cos(k * 90.0 * DEGREE), s = sin(k * 90.0 * DEGREE);
        r.pose = (asdic_pose){
            .position_m = {shift * c + 0.125 * fabs(s), shift * s + 0.125 * fabs(c), 0.0},
            .yaw_rad = k * 90.0 * DEGREE};
        map_look(&r);
        for (int step = 0; step < 2; step++) {
            size_t there = (size_t)(k < 2 ? 440 + step : 39 - step), here = 240;
            size_t row = k % 2 ? here : there, column = k % 2 ? there : here;
            assert_int_equal(isnan(r.map->log_odds[row * r.map->columns + column]), step);
        }
        asdic_occupancy_destroy(&r.map);
    }
}

/* Where hardly anything is expected, a quiet look at a cell multiplies its odds by the mean of the ratios of
 * its heights: that of the beam where it hears, 1 elsewhere. The share heard is the beam's height of that of
 * all the water, cut off at the surface; unknown floors leave what is heard. */
static void water_that_is_not_heard_says_nothing(void **state) {
    (void)state;
    static const double depth_m[] = {6.0, 1.0, 6.0, INFINITY};
    static const float floor_m[] = {15.0f, 10.0f, NAN, 15.0f};
    for (int i = 0; i < 4; i++) {
        map_rig r;
        asdic_evidence seen = {0};
        map_begin(&r, 1);
        asdic_occupancy_destroy(&r.map);
        asdic_vec3 low = {-1.0, -30.0, 0.0}, high = {60.0, 30.0, 0.0};
        assert_ok(ctx, asdic_occupancy_create(ctx, low, high, 0.25, 1e-9, 100.0, &r.map));
        r.sonar.bin_length_m = 0.5;
        r.depth_m = depth_m[i];
        r.pose.position_m.z = isinf(depth_m[i]) ? 6.0 : depth_m[i];
        for (size_t k = 0; k < r.map->rows * r.map->columns; k++) {
            r.map->floor_depth_m[k] = floor_m[i];
        }
        const asdic_look look = look_of(&r);
        assert_ok(ctx, asdic_evidence_create(ctx, &look, &seen));
        assert_int_equal(seen.arcs, 1);
        double ratio = seen.ratio[60], away_m = 30.125;
        double above = fmin(-away_m * seen.headings[0].slope_low, depth_m[i]);
        double heard = above + away_m * seen.headings[0].slope_high;
        double all = isnan(floor_m[i]) || isinf(depth_m[i])
                         ? heard
                         : floor_m[i] - r.pose.position_m.z + depth_m[i];
        assert_true(heard > 3.0 && heard <= all);
        map_look(&r);
        size_t row = (size_t)(31.1 / 0.25), column = (size_t)(30.1 / 0.25);
        double prior = isnan(floor_m[i]) ? log(1e-9) : log(0.5e-9); /* half of it on the floor */
        double got = (double)r.map->part[ASDIC_OCCUPANCY_WATER][row * r.map->columns + column];
        assert_close(got, prior + log(1.0 + heard / all * (ratio - 1.0)), 1e-4);
        asdic_evidence_finish(&seen);
        asdic_occupancy_destroy(&r.map);
    }
}

/* The pattern in the horizontal of a face LENGTH_M wide, ASIDE_RAD off its axis. */
static double face_gain(const asdic_sonar *sonar, double length_m, double aside_rad) {
    double x = acos(-1.0) * length_m * sonar->frequency_hz / SPEED * sin(aside_rad);
    return fabs(x) < 1e-9 ? 1.0 : pow(sin(x) / x, 2);
}

/* Directions a quarter of the narrowest width apart; beams hear them within 1.5 of their own widths and 0.03 of what
 * they hear on their axes, the best in this first, whose axis all gains refer to. Beams that hear the same share
 * its weight. */
static void headings_know_who_hears_them(void **state) {
    (void)state;
    static const double yaw_rad[] = {0.2, 0.0, 0.08, 0.85, 0.21},
                        wide_m[] = {0.1, 0.05, 0.1, 0.2, 0.05};
    map_rig r;
    asdic_evidence seen = {0};
    double width_rad[5], axis_lin[5], weight[5], narrowest_rad = 7.0;
    map_begin(&r, 5);
    r.sonar.transmitter.length_h_m = 0.01;
    for (size_t b = 0; b < 5; b++) {
        r.beams[b].yaw_rad = yaw_rad[b];
        r.beams[b].length_h_m = wide_m[b];
    }
    for (size_t b = 0; b < 5; b++) {
        width_rad[b] = asdic_beam_width_rad(&r.sonar, b, SPEED);
        narrowest_rad = fmin(narrowest_rad, width_rad[b]);
        axis_lin[b] = face_gain(&r.sonar, 0.01, yaw_rad[b]);
        double sum = 0.0;
        for (size_t k = 0; k < 5; k++) {
            double aside = yaw_rad[k] - yaw_rad[b];
            sum += fabs(aside) < 4.0 * width_rad[b] ? face_gain(&r.sonar, wide_m[b], aside) : 0.0;
        }
        weight[b] = 1.0 / sum;
    }
    const asdic_look look = look_of(&r);
    assert_ok(ctx, asdic_evidence_create(ctx, &look, &seen));
    assert_int_equal(seen.arcs, 1);
    assert_int_equal(seen.azimuths, (size_t)ceil(8.0 * acos(-1.0) / narrowest_rad));
    size_t several = 0;
    for (size_t k = 0; k < seen.azimuths; k++) {
        const asdic_heading *h = &seen.headings[k];
        const asdic_hearing *heard = seen.hearings + h->hearing;
        double at = remainder((double)k * seen.step_rad, 2.0 * acos(-1.0));
        double lin[5], best = 0.0;
        size_t count = 0;
        for (size_t b = 0; b < 5; b++) {
            double aside = fabs(at - yaw_rad[b]);
            lin[b] = face_gain(&r.sonar, 0.01, at) * face_gain(&r.sonar, wide_m[b], aside);
            bool hears = aside <= 1.5 * width_rad[b] && lin[b] / axis_lin[b] >= 0.03;
            lin[b] = hears ? lin[b] : 0.0;
            best = fmax(best, lin[b] / axis_lin[b]);
            count += hears;
        }
        assert_int_equal(h->hearing_count, count);
        for (size_t i = 0; i < count; i++) {
            size_t b = heard[i].beam;
            assert_true(b < 5 && lin[b] > 0.0);
            assert_close(heard[i].gain_lin, lin[b] / axis_lin[heard[0].beam], 1e-6);
            assert_close(heard[i].weight, weight[b], 1e-6);
            lin[b] = i == 0 ? lin[b] : 0.0; /* each once */
        }
        if (count > 0) {
            size_t first = heard[0].beam;
            assert_close(lin[first] / axis_lin[first], best, 1e-9);
        }
        several += count > 1;
    }
    assert_true(several > 10);
    asdic_evidence_finish(&seen);
    asdic_occupancy_destroy(&r.map);
}

/* A beam that looks 80 degrees down, 56 degrees tall, is asked up to 80 - 0.75 x 56 = 38 degrees down, and no heading is
 * heard farther aside or flatter; one that looks straight down is not asked. */
static void beams_are_asked_within_their_range(void **state) {
    (void)state;
    map_rig r;
    asdic_evidence seen = {0};
    map_begin(&r, 2);
    r.sonar.transmitter.pitch_rad = r.beams[0].pitch_rad = 80.0 * DEGREE;
    r.beams[1].pitch_rad = 90.0 * DEGREE;
    double height_m = 0.443 * SPEED / 100e3 / sin(28.0 * DEGREE) / sqrt(2.0);
    r.sonar.transmitter.length_v_m = r.beams[0].length_v_m = height_m;
    asdic_vec3 axis = asdic_beam_axis(&r.beams[0], &r.pose);
    asdic_hearing_range range = asdic_evidence_range(&r.sonar, 0, axis, SPEED);
    assert_close(range.plane_share, cos(38.0 * DEGREE), 1e-6);
    /* Headings are a quarter of a width apart: those within 1.5 widths reach half as far beyond. */
    assert_close(range.aside_rad, 1.625 * asdic_beam_width_rad(&r.sonar, 0, SPEED), 1e-12);
    axis = asdic_beam_axis(&r.beams[1], &r.pose);
    assert_close(asdic_evidence_range(&r.sonar, 1, axis, SPEED).plane_share, 0.0, 0.0);
    const asdic_look look = look_of(&r);
    assert_ok(ctx, asdic_evidence_create(ctx, &look, &seen));
    size_t heard = 0;
    for (size_t i = 0; i < seen.arcs * seen.azimuths; i++) {
        const asdic_heading *h = &seen.headings[i];
        double at = remainder((double)(i % seen.azimuths) * seen.step_rad, 2.0 * acos(-1.0));
        if (h->hearing_count > 0) {
            assert_true(fabs(at) + 0.5 * seen.step_rad <= range.aside_rad + 1e-9);
            assert_true(cos(atan(h->slope_low)) <= range.plane_share + 1e-9);
            heard++;
        }
    }
    assert_true(heard > 4);
    asdic_evidence_finish(&seen);
    asdic_occupancy_destroy(&r.map);
}

/* A transmitter of two wavelengths sends nothing 30 degrees aside, where a receiver looks: it is not the one by
 * which directions beside its axis are heard best. */
static void a_beam_in_a_null_is_no_better_than_others(void **state) {
    (void)state;
    map_rig r;
    asdic_evidence seen = {0};
    map_begin(&r, 2);
    r.sonar.transmitter.length_h_m = 2.0 * SPEED / r.sonar.frequency_hz;
    r.beams[0].yaw_rad = 22.0 * DEGREE;
    r.beams[1].yaw_rad = 30.0 * DEGREE;
    r.beams[0].length_h_m = r.beams[1].length_h_m = 5.0 * SPEED / r.sonar.frequency_hz;
    const asdic_look look = look_of(&r);
    assert_ok(ctx, asdic_evidence_create(ctx, &look, &seen));
    size_t heard = 0;
    for (size_t k = 0; k < seen.azimuths; k++) {
        const asdic_heading *h = &seen.headings[k];
        double at = remainder((double)k * seen.step_rad, 2.0 * acos(-1.0));
        for (size_t i = 0; i < h->hearing_count; i++) {
            assert_true(seen.hearings[h->hearing + i].gain_lin < 20.0);
        }
        if (h->hearing_count > 0 && at < 22.5 * DEGREE) {
            assert_int_equal(seen.hearings[h->hearing].beam, 0);
            heard++;
        }
    }
    assert_true(heard > 2);
    asdic_evidence_finish(&seen);
    asdic_occupancy_destroy(&r.map);
}

/* Straight ahead of one beam: of the detector's strength, 10 dB over a background of 1, and of the loudest, what is there
 * less the background, which is as much rarer as it is louder, the mean. */
static void strengths_are_averaged(void **state) {
    (void)state;
    map_rig r;
    asdic_evidence seen = {0};
    map_begin(&r, 1);
    r.intensity[50] = 25.0;
    const asdic_look look = look_of(&r);
    assert_ok(ctx, asdic_evidence_create(ctx, &look, &seen));
    double faint = 25.0 * 10.0 / 11.0 - log(11.0), loud = 25.0 * 24.0 / 25.0 - log(25.0);
    assert_close(log(seen.ratio[50]), log(0.5 * (exp(faint) + exp(loud) * 10.0 / 24.0)), 1e-6);
    assert_close(log(seen.ratio[49]), 0.3 * 10.0 / 11.0 - log(11.0), 1e-6);
    asdic_evidence_finish(&seen);
    asdic_occupancy_destroy(&r.map);
}

/* K speckle of a shape so large that it is all but Rayleigh's says what that says, by its tables of strengths; of a
 * small one, in which high values are common without an object, an echo says less. */
static void k_speckle_is_weighed_by_its_shape(void **state) {
    (void)state;
    map_rig r;
    static const double shapes[] = {0.0, 999.0, 1.5,
                                    1000.0}; /* the last is the greatest there is */
    double on_axis[4], loud[4], worst = 0.0;
    asdic_evidence rayleigh = {0};
    map_begin(&r, 2);
    r.beams[1].yaw_rad = 9.0 * DEGREE;
    r.intensity[40] = 1e4; /* cut at the greatest that a ratio can be */
    r.intensity[50] = 25.0;
    r.intensity[MAP_BINS + 60] = 8.0;
    for (int k = 0; k < 4; k++) {
        asdic_evidence seen = {0};
        r.sonar.speckle = k == 0 ? ASDIC_SPECKLE_RAYLEIGH : ASDIC_SPECKLE_K;
        r.sonar.speckle_shape = k == 0 ? 1.5 : shapes[k];
        const asdic_look look = look_of(&r);
        assert_ok(ctx, asdic_evidence_create(ctx, &look, &seen));
        on_axis[k] = seen.ratio[50]; /* straight ahead */
        loud[k] = seen.ratio[40];
        for (size_t i = 0; k == 1 && i < seen.arcs * seen.azimuths * MAP_BINS; i++) {
            if (seen.headings[i / MAP_BINS].hearing_count > 0 && i % MAP_BINS > 0) {
                double a = log(rayleigh.ratio[i]), b = log(seen.ratio[i]);
                worst = fmax(worst, fabs(a - b) / (1.0 + fabs(a)));
            }
        }
        if (k == 0) {
            rayleigh = seen;
        } else {
            asdic_evidence_finish(&seen);
        }
    }
    assert_true(worst < 0.05);
    assert_close(log(on_axis[3]), log(on_axis[1]), 2e-4 * fabs(log(on_axis[1])));
    assert_close(log(loud[3]), log(loud[1]), 2e-4 * fabs(log(loud[1])));
    assert_true(on_axis[0] > 10.0 && on_axis[2] > 2.0 && on_axis[2] < 0.6 * on_axis[1]);
    asdic_evidence_finish(&rayleigh);
    asdic_occupancy_destroy(&r.map);
}

/* Over cells that are as far to all sides the same ping draws the same map whichever way the sonar looks, where a
 * quarter turn is a number of whole headings. North is the first of these, and its neighbour the last. */
static void maps_do_not_depend_on_the_compass(void **state) {
    (void)state;
    enum { SIDE = 81, MIDDLE = SIDE / 2, REACH = 30 };
    float ahead[SIDE][SIDE] = {{0}};
    for (int quarter = 0; quarter < 4; quarter++) {
        map_rig r;
        map_begin(&r, 1);
        asdic_occupancy_destroy(&r.map);
        const asdic_vec3 low = {-10.125, -10.125, 0.0}, high = {10.125, 10.125, 0.0};
        assert_ok(ctx, asdic_occupancy_create(ctx, low, high, 0.25, 0.3, 10.0, &r.map));
        assert_true(r.map->rows == SIDE && r.map->columns == SIDE);
        r.beams[0].length_h_m = r.sonar.transmitter.length_h_m = 0.0507; /* 136 headings */
        r.sonar.bin_length_m = 2.0;
        r.sonar.bandwidth_hz = 0.5 * SPEED / r.sonar.bin_length_m;
        r.background[0] = 1.0;
        r.intensity[0] = r.intensity[2] = 40.0;
        r.pose.yaw_rad = 90.0 * quarter * DEGREE;
        map_look(&r);
        const int to_north[] = {1, 0, -1, 0}, to_east[] = {0, 1, 0, -1};
        size_t known = 0;
        for (int along = 1; along < REACH; along++) {
            for (int aside = -along; aside <= along; aside++) {
                int row = MIDDLE + along * to_north[quarter] - aside * to_east[quarter];
                int column = MIDDLE + along * to_east[quarter] + aside * to_north[quarter];
                float now = r.map->log_odds[row * SIDE + column];
                float *first = &ahead[along][MIDDLE + aside];
                *first = quarter == 0 ? now : *first;
                known += !isnan(now);
                assert_int_equal(isnan(now), isnan(*first));
                assert_true(isnan(now) || fabs((double)now - (double)*first) < 1e-4);
            }
        }
        assert_true(known > 100);
        asdic_occupancy_destroy(&r.map);
    }
}

/* Fixed in the world, clipped, and no larger than memory. */
static void maps_have_limits(void **state) {
    (void)state;
    map_rig r;
    asdic_occupancy *map = NULL;
    map_begin(&r, 1);
    r.intensity[40] = 1e9;
    map_look(&r);
    double before = map_at(&r, 25.3, 0.1);
    r.pose.position_m.x = 5.0;
    map_look(&r);
    assert_true(map_at(&r, 25.3, 0.1) > before);
    assert_true(map_at(&r, 20.3, 0.1) < map_at(&r, 25.3, 0.1) + 3.0);
    for (size_t i = 0; i < r.map->rows * r.map->columns; i++) {
        double odds = (double)r.map->log_odds[i];
        assert_true(isnan(odds) || fabs(odds) <= 10.0);
    }
    asdic_occupancy_destroy(&r.map);
    asdic_vec3 low = {-1.0, -20.0, 0.0}, high = {60.0, 20.0, 0.0};
    assert_status(ctx, asdic_occupancy_create(ctx, low, high, 1e-4, 0.01, 10.0, &map),
                  ASDIC_ERROR_ARGUMENT);
    assert_contains(asdic_context_error(ctx), "larger");
}

/* A look from nowhere, at nothing or through no water is none, and leaves the map as it was. */
static void looks_have_limits(void **state) {
    (void)state;
    map_rig r;
    map_begin(&r, 1);
    map_look(&r);
    float before = r.map->log_odds[100];
    asdic_look good = look_of(&r), bad[6];
    for (int i = 0; i < 6; i++) {
        bad[i] = good;
    }
    bad[0].sound_speed_mps = 0.0;
    bad[1].sound_speed_mps = NAN;
    bad[2].pose.position_m.x = NAN;
    bad[3].bins = 0;
    bad[4].snr_db = NAN;
    bad[5].depth_m = NAN;
    for (int i = 0; i < 6; i++) {
        assert_status(ctx, asdic_occupancy_add(ctx, r.map, &bad[i]), ASDIC_ERROR_ARGUMENT);
        assert_memory_equal(&r.map->log_odds[100], &before, sizeof before);
    }
    assert_ok(ctx, asdic_occupancy_add(ctx, r.map, &good));
    asdic_occupancy_destroy(&r.map);
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

static asdic_tracker *tracker_of(unsigned confirm, unsigned of, unsigned misses) {
    asdic_tracker *tracker = NULL;
    asdic_tracker_options options = asdic_tracker_options_default();
    options.confirm = confirm;
    options.of = of;
    options.misses = misses;
    assert_ok(ctx, asdic_tracker_create(ctx, &options, &tracker));
    return tracker;
}

/* A ping a second with COUNT plots; the tracks then. */
static const asdic_track_state *track(asdic_tracker *tracker, int ping,
                                      const asdic_plot_point *plots, size_t count, size_t *alive) {
    assert_ok(ctx, asdic_tracker_update(tracker, ping, plots, count));
    return asdic_tracker_get(tracker, alive);
}

/* Where an object is and how fast, along each axis with its own error. */
static void tracks_say_where_and_how_fast(void **state) {
    (void)state;
    asdic_tracker *tracker = tracker_of(3, 5, 5);
    asdic_plot_point plot = {.north_m = 10.0,
                             .east_m = -20.0,
                             .variance_nn_m2 = 0.09,
                             .variance_ee_m2 = 0.25,
                             .label = 7};
    size_t alive = 0;
    const asdic_track_state *s = track(tracker, 0, &plot, 1, &alive);
    assert_int_equal(alive, 1);
    assert_true(s->id == 1 && s->hit && s->hits == 1 && s->age == 1 && !s->confirmed);
    assert_int_equal(s->label, 7);
    assert_close(s->north_m, 10.0, 0.0);
    assert_close(s->east_m, -20.0, 0.0);
    assert_close(s->north_mps, 0.0, 0.0);
    assert_close(s->east_mps, 0.0, 0.0);
    assert_close(s->sd_north_m, 0.3, 1e-12);
    assert_close(s->sd_east_m, 0.5, 1e-12);
    for (int k = 1; k < 60; k++) {
        plot.north_m = 10.0 - 0.25 * k;
        plot.east_m = -20.0 + 0.5 * k;
        plot.label = k;
        s = track(tracker, k, &plot, 1, &alive);
        assert_int_equal(alive, 1);
    }
    assert_true(s->confirmed && s->hit && s->hits == 60 && s->age == 60 && s->label == 59);
    assert_close(s->north_m, plot.north_m, 0.01);
    assert_close(s->east_m, plot.east_m, 0.01);
    assert_close(s->north_mps, -0.25, 0.01);
    assert_close(s->east_mps, 0.5, 0.01);
    assert_true(s->sd_north_m > 0.05 && s->sd_north_m < 0.3); /* many are better than one */
    assert_true(s->sd_east_m < 0.5);
    assert_true(s->sd_east_m > s->sd_north_m);
    s = track(tracker, 60, NULL, 0, &alive);
    assert_int_equal(alive, 1);
    assert_false(s->hit);
    assert_close(s->east_m, plot.east_m + 0.5, 0.02); /* it goes on */
    asdic_tracker_destroy(&tracker);
}

/* PINGS are X where the object is heard and - where not; the ping with which the track is confirmed, and with
 * which it ends; from 1, 0 for never. */
static void tracks_live_by_their_hits(void **state) {
    (void)state;
    static const struct {
        unsigned confirm, of, misses;
        const char *pings;
        int confirmed, ended;
    } cases[] = {{3, 5, 5, "XXX", 3, 0},
                 {3, 5, 5, "X-X-X", 5, 0},
                 {3, 5, 5, "XX--X", 5, 0},
                 {3, 5, 5, "X--XX", 5, 0},
                 {3, 5, 5, "X---", 0, 4}, /* two at most are left */
                 {3, 5, 5, "XX---", 0, 5},
                 {3, 5, 5, "X-X--", 0, 5},
                 {3, 5, 5, "XXX----X----", 3, 0},
                 {3, 5, 5, "XXX-----", 3, 8},
                 {1, 1, 2, "X-X-", 1, 0},
                 {1, 1, 2, "X--", 1, 3},
                 {2, 8, 3, "X---X", 5, 0},
                 {2, 8, 3, "X----", 0, 5},
                 {32, 32, 1, "XXXXXXXXXXXXXXXXXXXXXXXXXXXXXXXX", 32, 0},
                 {32, 32, 1, "XXXXXXXXXXXXXXXXXXXXXXXXXXXXXXX-", 0, 32}};
    const asdic_plot_point plot = {.north_m = 9.0, .variance_nn_m2 = 0.1, .variance_ee_m2 = 0.1};
    for (size_t n = 0; n < sizeof cases / sizeof *cases; n++) {
        asdic_tracker *tracker = tracker_of(cases[n].confirm, cases[n].of, cases[n].misses);
        int confirmed = 0, ended = 0;
        for (int k = 0; cases[n].pings[k] != '\0'; k++) {
            size_t alive = 0;
            const asdic_track_state *s =
                track(tracker, k, &plot, cases[n].pings[k] == 'X' ? 1 : 0, &alive);
            confirmed = confirmed == 0 && alive > 0 && s->confirmed ? k + 1 : confirmed;
            ended = ended == 0 && alive == 0 ? k + 1 : ended;
        }
        if (confirmed != cases[n].confirmed || ended != cases[n].ended) {
            fail_msg("%s: confirmed %d, ended %d", cases[n].pings, confirmed, ended);
        }
        asdic_tracker_destroy(&tracker);
    }
}

/* Nearest pairs go first; what is in no gate founds a track. */
static void plots_go_to_the_nearest_track(void **state) {
    (void)state;
    asdic_tracker *tracker = tracker_of(3, 5, 5);
    const asdic_plot_point first[] = {
        {.north_m = 10.0, .variance_nn_m2 = 0.09, .variance_ee_m2 = 0.09, .label = 1},
        {.north_m = 11.0, .variance_nn_m2 = 0.09, .variance_ee_m2 = 0.09, .label = 2}};
    const asdic_plot_point then[] = {
        {.north_m = 10.8, .variance_nn_m2 = 0.09, .variance_ee_m2 = 0.09, .label = 3},
        {.north_m = 10.3, .variance_nn_m2 = 0.09, .variance_ee_m2 = 0.09, .label = 4},
        {.north_m = 40.0, .variance_nn_m2 = 0.09, .variance_ee_m2 = 0.09, .label = 5}};
    size_t alive = 0;
    const asdic_track_state *s = track(tracker, 0, first, 2, &alive);
    assert_int_equal(alive, 2);
    s = track(tracker, 0, then, 3, &alive);
    assert_int_equal(alive, 3);
    assert_true(s[0].id == 1 && s[0].label == 4);
    assert_true(s[1].id == 2 && s[1].label == 3);
    assert_true(s[2].id == 3 && s[2].label == 5 && s[2].hits == 1);
    asdic_tracker_destroy(&tracker);
}

static void trackers_have_limits(void **state) {
    (void)state;
    const asdic_tracker_options good = asdic_tracker_options_default();
    asdic_tracker_options bad[8];
    for (int i = 0; i < 8; i++) {
        bad[i] = good;
    }
    bad[0].gate = 0.0;
    bad[1].acceleration = -1e-9;
    bad[2].speed_mps = 0.0;
    bad[3].confirm = 0;
    bad[4].confirm = good.of + 1;
    bad[5].of = 33;
    bad[6].misses = 0;
    bad[7].gate = NAN;
    asdic_tracker *tracker = NULL;
    for (int i = 0; i < 8; i++) {
        assert_status(ctx, asdic_tracker_create(ctx, &bad[i], &tracker), ASDIC_ERROR_ARGUMENT);
        assert_null(tracker);
    }
    asdic_tracker_options least = good;
    least.acceleration = 0.0;
    least.confirm = least.of = least.misses = 1;
    assert_ok(ctx, asdic_tracker_create(ctx, &least, &tracker));
    asdic_tracker_destroy(&tracker);
}

/* Of a ping at no time, or with a plot that is nowhere or known exactly, a tracker takes nothing. */
static void plots_have_limits(void **state) {
    (void)state;
    const asdic_tracker_options options = asdic_tracker_options_default();
    const asdic_plot_point good = {.variance_nn_m2 = 1.0, .variance_ee_m2 = 4.0};
    asdic_plot_point bad[6] = {good, good, good, good, good, good};
    bad[0].north_m = NAN;
    bad[1].east_m = INFINITY;
    bad[2].variance_nn_m2 = 0.0;
    bad[3].variance_ee_m2 = NAN;
    bad[4].variance_ne_m2 = 2.1; /* more than both variances allow */
    bad[5].variance_ne_m2 = NAN;
    asdic_tracker *tracker = NULL;
    size_t count;
    assert_ok(ctx, asdic_tracker_create(ctx, &options, &tracker));
    assert_status(ctx, asdic_tracker_update(tracker, NAN, &good, 1), ASDIC_ERROR_ARGUMENT);
    assert_status(ctx, asdic_tracker_update(tracker, INFINITY, &good, 1), ASDIC_ERROR_ARGUMENT);
    assert_ok(ctx, asdic_tracker_update(tracker, 1.0, &good, 1));
    for (int i = 0; i < 6; i++) {
        const asdic_plot_point plots[2] = {good, bad[i]};
        assert_status(ctx, asdic_tracker_update(tracker, 2.0, plots, 2), ASDIC_ERROR_ARGUMENT);
        const asdic_track_state *tracks = asdic_tracker_get(tracker, &count);
        assert_true(count == 1 && tracks->north_m == 0.0 && tracks->age == 1);
    }
    assert_ok(ctx, asdic_tracker_update(tracker, 1.5, &good, 1)); /* 2 s were none */
    assert_int_equal(asdic_tracker_get(tracker, &count)->hits, 2);
    asdic_tracker_destroy(&tracker);
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
        cmocka_unit_test(detectors_have_limits),
        cmocka_unit_test(sampling_errors_are_allowed_for),
        cmocka_unit_test(bins_without_an_error_keep_their_threshold),
        cmocka_unit_test(looks_follow_the_sound_speed),
        cmocka_unit_test(beams_have_axes_and_widths),
        cmocka_unit_test(quiet_bins_clear_by_what_would_be_heard),
        cmocka_unit_test(poses_tell_cells_apart),
        cmocka_unit_test(long_cells_hear_all_their_bins),
        cmocka_unit_test(side_lobes_are_explained),
        cmocka_unit_test(echoes_through_the_rear_are_explained),
        cmocka_unit_test(echoes_lie_on_the_floor_that_is_known),
        cmocka_unit_test(cells_lie_at_their_centres),
        cmocka_unit_test(water_that_is_not_heard_says_nothing),
        cmocka_unit_test(headings_know_who_hears_them),
        cmocka_unit_test(beams_are_asked_within_their_range),
        cmocka_unit_test(a_beam_in_a_null_is_no_better_than_others),
        cmocka_unit_test(strengths_are_averaged),
        cmocka_unit_test(k_speckle_is_weighed_by_its_shape),
        cmocka_unit_test(maps_do_not_depend_on_the_compass),
        cmocka_unit_test(maps_have_limits),
        cmocka_unit_test(looks_have_limits),
        cmocka_unit_test(tracks_follow),
        cmocka_unit_test(tracks_say_where_and_how_fast),
        cmocka_unit_test(tracks_live_by_their_hits),
        cmocka_unit_test(plots_go_to_the_nearest_track),
        cmocka_unit_test(trackers_have_limits),
        cmocka_unit_test(plots_have_limits),
        cmocka_unit_test(clutter_confirms_tracks_as_said),
    };
    return cmocka_run_group_tests(tests, context_begin, context_end);
}
