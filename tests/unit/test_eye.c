/*
 * What a vehicle sees: one eye that is opened for mission after mission, against a detector of its own for each,
 * over levels computed for each place.
 */
#include "asserts.h"
#include "test_device.h"

#include "sim/expected.h"
#include "trial/trial_eye.h"

#include <asdic/asdic.h>

#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define DEGREE (3.14159265358979323846 / 180.0)
#define DEPTH_M 7.0

static test_device t;
static asdic_eye eye;
static char grid[] = "/tmp/asdic-eye-XXXXXX.asc";

/* How the background is found. */
typedef enum source { FLAT, CA, OS } source;

typedef struct sight {
    const char *bottom, *sonar, *receivers, *more;
    double reach_m;
    asdic_trial_background asked;
    source source;
} sight;

#define TWO "{name: a, yaw_deg: -10}, {name: b, pitch_deg: 10}"

static asdic_mission *load(const sight *s) {
    char path[] = "/tmp/asdic-eye-XXXXXX";
    asdic_mission *mission = NULL;
    int fd = mkstemp(path);
    assert_true(fd >= 0);
    assert_true(dprintf(fd,
                        "version: 1\nbottom: %s\n%s\nsampling: {rays: 4096}\n"
                        "mission: {pose: {position_m: [0, 0, %g]}}\n"
                        "sonar: {frequency_khz: 100, ping_rate_hz: 40, bin_length_m: 0.25, "
                        "receivers: [%s], %s}\n",
                        s->bottom, s->more, DEPTH_M, s->receivers, s->sonar) > 0);
    close(fd);
    assert_ok(t.ctx, asdic_mission_load(t.ctx, path, &mission));
    unlink(path);
    mission->trial.background = s->asked; /* else only of a trial */
    return mission;
}

static asdic_scan *new_scan(const sight *s, const asdic_mission *m) {
    const asdic_sonar *sonar = asdic_mission_sonar(m);
    double speed_mps = asdic_environment_sound_speed_mps(asdic_mission_environment(m), DEPTH_M);
    asdic_cfar cfar = asdic_cfar_default();
    asdic_scan *scan = NULL;
    cfar.kind = s->source == CA ? ASDIC_CFAR_CA : ASDIC_CFAR_OS;
    assert_ok(t.ctx, asdic_scan_create(t.ctx, sonar, speed_mps, asdic_loop_bin_count(eye.loop),
                                       asdic_mission_detector(m), s->source == FLAT ? NULL : &cfar,
                                       &scan));
    return scan;
}

/* What the eye finds at POSE is what SCAN finds in the same ping over the levels expected there, of which
 * there are none behind the eye's reach. */
static void assert_seen(const sight *s, const asdic_mission *m, asdic_scan *scan,
                        const asdic_pose *pose) {
    const asdic_sonar *sonar = asdic_mission_sonar(m);
    const asdic_environment *env = asdic_mission_environment(m);
    asdic_loop_ping ping;
    asdic_scan_result seen;
    assert_ok(t.ctx, asdic_eye_look(&eye, pose, &ping, &seen));
    size_t cells = ping.beams * ping.bins;
    asdic_ping *expected = NULL;
    assert_ok(t.ctx, asdic_ping_create(t.ctx, ping.beams, ping.bins, &expected));
    double *total = expected->intensity_lin[ASDIC_TOTAL];
    if (s->source == FLAT) {
        struct asdic_ring_shelf *shelf = NULL;
        asdic_expected_place place = {asdic_mission_flat_scene(m, 0), *pose};
        place.flat.altitude_m += DEPTH_M - pose->position_m.z;
        place.flat.depth_m = pose->position_m.z;
        assert_ok(t.ctx, asdic_ring_shelf_create(t.ctx, 2, &shelf));
        assert_ok(t.ctx,
                  asdic_expected_compute_among(t.ctx, shelf, &place, 0.0, env, sonar, expected));
        asdic_ring_shelf_destroy(&shelf);
        double end_m = s->reach_m + sonar->bin_length_m; /* one bin more */
        for (size_t i = 0; i < cells; i++) {
            total[i] =
                (double)(i % ping.bins) * sonar->bin_length_m < end_m ? total[i] : (double)NAN;
        }
    }
    asdic_scan_set_sound_speed(scan, asdic_environment_sound_speed_mps(env, pose->position_m.z));
    assert_ok(t.ctx,
              asdic_scan_ping(
                  scan, ping.parts->intensity_lin[ASDIC_TOTAL], s->source == FLAT ? total : NULL,
                  (s->source == FLAT ? expected : ping.parts)->intensity_lin[ASDIC_NOISE],
                  ping.parts->stderr_db));
    asdic_scan_result right = asdic_scan_get(scan);
    size_t decided = 0;
    for (size_t i = 0; i < cells; i++) {
        assert_int_equal(isnan(seen.threshold_lin[i]), isnan(right.threshold_lin[i]));
        if (!isnan(right.threshold_lin[i])) {
            assert_close_relative(seen.background_lin[i], right.background_lin[i], 1e-6);
            assert_close_relative(seen.threshold_lin[i], right.threshold_lin[i], 1e-6);
            assert_close(seen.llr[i], right.llr[i], 1e-6 + 1e-6 * fabs(right.llr[i]));
            decided++;
        }
    }
    assert_true(decided > 50);
    asdic_ping_destroy(&expected);
}

static void an_eye_sees_what_a_new_one_would(void **state) {
    (void)state;
    char on_grid[128];
    snprintf(on_grid, sizeof on_grid, "{grid: %s, type: sand}", grid);
    const char *flat = "{depth_m: 12, type: sand}", *loud = "source_level_db: 200";
    const char *k = "source_level_db: 120, speckle: k, speckle_shape: 0.5";
    const char *turned = "{name: a, yaw_deg: -10}, {name: b, pitch_deg: 20}";
    const char *three = TWO ", {name: c, pitch_deg: 5}";
    const sight sights[] = {
        {flat, loud, TWO, "", 12.0, ASDIC_TRIAL_AUTO, FLAT},
        {flat, loud, TWO, "", 9.1, ASDIC_TRIAL_AUTO, FLAT},
        {flat, loud, turned, "", 9.1, ASDIC_TRIAL_AUTO, FLAT},
        {flat, loud, three, "", 12.0, ASDIC_TRIAL_AUTO, FLAT},
        {flat, loud, TWO, "environment: {temperature_degc: 25}", 12.0, ASDIC_TRIAL_AUTO, FLAT},
        {flat, loud, TWO, "environment: {wind_speed_kn: 30}", 12.0, ASDIC_TRIAL_AUTO, FLAT},
        {flat, k, TWO, "", 12.0, ASDIC_TRIAL_AUTO, FLAT},
        {flat, loud, TWO, "detector: {pfa: 1.0e-5}", 12.0, ASDIC_TRIAL_AUTO, FLAT},
        {flat, loud, TWO, "detector: {pfa: 1.0e-5}", 12.0, ASDIC_TRIAL_CA, CA},
        {flat, loud, TWO, "detector: {pfa: 1.0e-5}", 12.0, ASDIC_TRIAL_OS, OS},
        {flat, loud, TWO, "detector: {pfa: 1.0e-5}", 1e3, ASDIC_TRIAL_FLAT, FLAT},
        {flat, loud, TWO, "", 1e3, ASDIC_TRIAL_FLAT, FLAT},
        {on_grid, loud, TWO, "", 12.0, ASDIC_TRIAL_AUTO, OS},
        {"none", loud, TWO, "", 12.0, ASDIC_TRIAL_AUTO, FLAT},
        {"{depth_m: 12, type: rock}", loud, TWO, "", 12.0, ASDIC_TRIAL_AUTO, FLAT},
        {flat, loud, TWO, "surface: {enabled: false}", 12.0, ASDIC_TRIAL_AUTO, FLAT},
        {flat, loud, TWO, "", 12.0, ASDIC_TRIAL_AUTO, FLAT}};
    eye = (asdic_eye){.device = t.device, .lookout.ctx = t.ctx};
    for (size_t i = 0; i < sizeof sights / sizeof *sights; i++) {
        asdic_mission *m = load(&sights[i]);
        assert_ok(t.ctx, asdic_eye_open(&eye, m, DEPTH_M, sights[i].reach_m));
        asdic_scan *scan = new_scan(&sights[i], m);
        /* North, east and heading do not matter to what is expected; attitude, depth and altitude do. */
        const asdic_pose poses[] = {{.position_m = {0, 0, DEPTH_M}},
                                    {.position_m = {2, 5, DEPTH_M}, .yaw_rad = 1.0},
                                    {.position_m = {0, 0, DEPTH_M}, .pitch_rad = 5.0 * DEGREE},
                                    {.position_m = {0, 0, DEPTH_M}, .roll_rad = 30.0 * DEGREE},
                                    {.position_m = {0, 0, DEPTH_M + 0.3}},
                                    {.position_m = {0, 0, DEPTH_M}}};
        for (size_t p = 0; p < (i ? 3 : sizeof poses / sizeof *poses); p++) {
            assert_seen(&sights[i], m, scan, &poses[p]);
        }
        /* More than a few of so many places share what an eye keeps them in. */
        for (int p = 0; i == 0 && p < 50; p++) {
            const asdic_pose pose = {.position_m = {0, 0, DEPTH_M - 0.08 * p}};
            assert_seen(&sights[i], m, scan, &pose);
        }
        asdic_scan_destroy(&scan);
        asdic_eye_close(&eye);
        asdic_mission_destroy(&m);
    }
}

/* Places within half a millimetre and a twentieth of a thousandth of a degree of one on the grid are that. */
static void places_are_on_a_grid(void **state) {
    (void)state;
    static const struct {
        double deeper_m, pitch_deg, roll_deg;
        bool is_same;
    } cases[] = {{0.0004, 0.0, 0.0, true}, {-0.0004, 0.0, 0.0, true}, {0.0006, 0.0, 0.0, false},
                 {0.0, 4e-5, 0.0, true},   {0.0, -4e-5, 0.0, true},   {0.0, 6e-5, 0.0, false},
                 {0.0, 0.0, 4e-5, true},   {0.0, 0.0, 6e-5, false}};
    const sight s = {
        "{depth_m: 12, type: sand}", "source_level_db: 200", TWO, "", 12.0, ASDIC_TRIAL_AUTO, FLAT};
    asdic_mission *m = load(&s);
    eye = (asdic_eye){.device = t.device, .lookout.ctx = t.ctx};
    assert_ok(t.ctx, asdic_eye_open(&eye, m, DEPTH_M, s.reach_m));
    asdic_pose pose = {.position_m = {0, 0, DEPTH_M + 0.0005}}; /* between two depths of the grid */
    asdic_loop_ping ping;
    asdic_scan_result seen;
    assert_ok(t.ctx, asdic_eye_look(&eye, &pose, &ping, &seen));
    assert_true(ping.ping == 0 && ping.time_s == 0.0);
    size_t bytes = ping.beams * ping.bins * sizeof(double);
    double *first = malloc(bytes);
    assert_non_null(first);
    memcpy(first, seen.background_lin, bytes);
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        pose = (asdic_pose){.position_m = {0, 0, DEPTH_M + 0.0005 + cases[i].deeper_m},
                            .pitch_rad = cases[i].pitch_deg * DEGREE,
                            .roll_rad = cases[i].roll_deg * DEGREE};
        assert_ok(t.ctx, asdic_eye_look(&eye, &pose, &ping, &seen));
        assert_int_equal(memcmp(seen.background_lin, first, bytes) == 0, cases[i].is_same);
    }
    free(first);
    ping.bins++; /* another loop's */
    const double *total_lin;
    assert_status(t.ctx, asdic_lookout_expect(&eye.lookout, &ping, &total_lin),
                  ASDIC_ERROR_ARGUMENT);
    assert_status(t.ctx, asdic_lookout_detect(&eye.lookout, &ping, &seen), ASDIC_ERROR_ARGUMENT);
    assert_contains(asdic_context_error(t.ctx), "the lookout is for 2 and");
    asdic_eye_close(&eye);
    asdic_mission_destroy(&m);
}

/* A bin that holds the first part of a millimetre of the bottom's echo, or a few of them, is expected to hold it: by no
 * less than 0.1 dB. Bins are 0.25 m, altitudes that or a little more below a multiple. */
static void first_echoes_are_not_expected_late(void **state) {
    (void)state;
    static const double deeper_m[] = {0.0001, 0.0003, 0.0005, 0.0009, 0.0023};
    const sight s = {
        "{depth_m: 12, type: sand}", "source_level_db: 200", TWO, "", 12.0, ASDIC_TRIAL_AUTO, FLAT};
    asdic_mission *m = load(&s);
    eye = (asdic_eye){.device = t.device, .lookout.ctx = t.ctx};
    assert_ok(t.ctx, asdic_eye_open(&eye, m, DEPTH_M, s.reach_m));
    for (size_t i = 0; i < sizeof deeper_m / sizeof *deeper_m; i++) {
        const asdic_pose pose = {.position_m = {0, 0, DEPTH_M + deeper_m[i]}};
        asdic_flat_scene flat = asdic_mission_flat_scene(m, 0);
        asdic_loop_ping ping;
        asdic_scan_result seen;
        asdic_ping *right = NULL;
        flat.altitude_m -= deeper_m[i];
        flat.depth_m += deeper_m[i];
        assert_ok(t.ctx, asdic_eye_look(&eye, &pose, &ping, &seen));
        assert_ok(t.ctx, asdic_ping_create(t.ctx, ping.beams, ping.bins, &right));
        assert_ok(t.ctx, asdic_expected_compute(t.ctx, &flat, asdic_mission_environment(m),
                                                asdic_mission_sonar(m), &pose, right));
        size_t bin = (size_t)(flat.altitude_m / 0.25);
        for (size_t b = 0; b < ping.beams; b++) {
            double right_lin = right->intensity_lin[ASDIC_TOTAL][b * ping.bins + bin];
            double off_db = 10.0 * log10(seen.background_lin[b * ping.bins + bin] / right_lin);
            print_message("%.1f mm of the first echo: %.2f dB\n", 1e3 * deeper_m[i], off_db);
            assert_true(bin == 19 && off_db > -0.1);
        }
        asdic_ping_destroy(&right);
    }
    asdic_eye_finish(&eye);
    asdic_mission_destroy(&m);
}

/* In attitudes between those of which profiles are kept, against the quadrature of that very attitude: within 0.1 dB,
 * where a P_FA of 1e-3 is off by a sixth, wherever a beam is not 40 dB below its loudest bin; in more than LEAST bins. */
static void compare_turned(const sight *s, size_t least) {
    static const double turned_deg[][2] = {/* pitch, roll */
                                           {0.0, 0.0},   {0.04, 0.0},   {-0.04, 0.0},
                                           {0.02, 0.0},  {0.0, 0.04},   {0.0, -0.04},
                                           {3.03, 2.96}, {-5.04, 0.03}, {-2.97, -4.04}};
    asdic_mission *m = load(s);
    const asdic_sonar *sonar = asdic_mission_sonar(m);
    eye = (asdic_eye){.device = t.device, .lookout.ctx = t.ctx};
    assert_ok(t.ctx, asdic_eye_open(&eye, m, DEPTH_M, s->reach_m));
    for (size_t i = 0; i < sizeof turned_deg / sizeof *turned_deg; i++) {
        const asdic_pose pose = {.position_m = {0, 0, DEPTH_M},
                                 .pitch_rad = turned_deg[i][0] * DEGREE,
                                 .roll_rad = turned_deg[i][1] * DEGREE};
        asdic_flat_scene flat = asdic_mission_flat_scene(m, 0);
        asdic_loop_ping ping;
        asdic_scan_result seen;
        asdic_ping *right = NULL;
        assert_ok(t.ctx, asdic_eye_look(&eye, &pose, &ping, &seen));
        assert_ok(t.ctx, asdic_ping_create(t.ctx, ping.beams, ping.bins, &right));
        assert_ok(t.ctx, asdic_expected_compute(t.ctx, &flat, asdic_mission_environment(m), sonar,
                                                &pose, right));
        double worst_db = 0.0;
        size_t compared = 0;
        for (size_t at = 0; at < ping.beams * ping.bins; at += ping.bins) {
            const double *total = right->intensity_lin[ASDIC_TOTAL] + at;
            double loudest = 0.0;
            for (size_t n = 0; n < ping.bins; n++) {
                loudest = fmax(loudest, total[n]);
            }
            for (size_t n = 0; n < ping.bins; n++) {
                if (total[n] > 1e-4 * loudest) {
                    double off_db = 10.0 * log10(seen.background_lin[at + n] / total[n]);
                    worst_db = fmax(worst_db, fabs(off_db));
                    compared++;
                }
            }
        }
        print_message("pitch %5.2f, roll %5.2f degrees: within %.3f dB in %zu bins\n",
                      turned_deg[i][0], turned_deg[i][1], worst_db, compared);
        assert_true(compared > least && worst_db < 0.1);
        asdic_ping_destroy(&right);
    }
    asdic_eye_finish(&eye); /* another mission's is next */
    asdic_mission_destroy(&m);
}

/* Beams of one degree between their half-power points in the vertical. Looking down they turn across the circles of one
 * elevation. */
static void narrow_beams_are_seen_as_they_are_turned(void **state) {
    (void)state;
    static const sight sights[] = {
        {"{depth_m: 12, type: sand}",
         "source_level_db: 200, transmitter: {length_h_m: 0.02, length_v_m: 0.54, pitch_deg: 30}",
         "{name: ahead, length_h_m: 0.07, length_v_m: 0.54, pitch_deg: 30}, "
         "{name: aside, yaw_deg: 40, length_h_m: 0.2, length_v_m: 0.54, pitch_deg: 30}",
         "", 18.0, ASDIC_TRIAL_AUTO, FLAT},
        {"{depth_m: 12, type: sand}",
         "source_level_db: 200, transmitter: {length_h_m: 0.54, length_v_m: 0.54, pitch_deg: 90}",
         "{name: down, length_h_m: 0.54, length_v_m: 0.54, pitch_deg: 90}, "
         "{name: aslant, length_h_m: 0.54, length_v_m: 0.54, pitch_deg: 70}",
         "", 18.0, ASDIC_TRIAL_AUTO, FLAT}};
    compare_turned(&sights[0], 30);
    compare_turned(&sights[1], 2);
}

/* After a failure, too: its loop would hold the device. */
static int finish(void **state) {
    (void)state;
    asdic_eye_finish(&eye);
    return 0;
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_teardown(an_eye_sees_what_a_new_one_would, finish),
        cmocka_unit_test_teardown(places_are_on_a_grid, finish),
        cmocka_unit_test_teardown(first_echoes_are_not_expected_late, finish),
        cmocka_unit_test_teardown(narrow_beams_are_seen_as_they_are_turned, finish),
    };
    t = test_device_open_or_skip();
    int fd = mkstemps(grid, 4);
    if (fd < 0 || dprintf(fd, "ncols 2\nnrows 2\nxllcorner -200\nyllcorner -200\ncellsize 200\n"
                              "12 12\n12 12\n") < 0) {
        return 1;
    }
    close(fd);
    int failed = cmocka_run_group_tests(tests, NULL, NULL);
    unlink(grid);
    test_device_close(&t);
    return failed;
}
