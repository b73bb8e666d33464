/* A sea that holds nothing, looked at by fans whose beams overlap more and more: a map has
 * fewer false cells than one beam alone would make, and clutter makes as many plots and tracks as theory says. With the
 * argument "full" up to 16-fold, else 4-fold. */
#include "ping_rig.h"

#include "mission/detect/detect_job.h"

#include <string.h>

static test_device device;
static bool full;

/* Beams of 1.02 degrees in 32. */
#define SECTOR_RAD (32.0 * RIG_DEGREE)
#define BEAMS_1_FOLD 32
#define LENGTH_M 0.75

/* A ping and what a detector says of it; means are the ping's own expected parts. */
typedef struct sea {
    ping_rig rig;
    asdic_beam *receivers;
    asdic_simulator *sim;
    asdic_ping *ping;
    asdic_scan *scan;
    double *mean, speed_mps;
    size_t beams, bins;
} sea;

/* BEAMS in as many fans as there are ELEVATIONS: ahead, 20 degrees down, 20 degrees up. */
static void sea_begin(sea *s, size_t beams, size_t elevations, const asdic_detector *d) {
    asdic_context *ctx = device.ctx;
    *s = (sea){.rig = rig_create(&device), .beams = beams};
    s->receivers = calloc(beams, sizeof *s->receivers);
    for (size_t b = 0; b < beams; b++) {
        size_t fan = beams / elevations;
        s->receivers[b] = s->rig.receivers[b / fan];
        s->receivers[b].length_h_m = LENGTH_M;
        s->receivers[b].yaw_rad = SECTOR_RAD * ((double)(b % fan) / (double)(fan - 1) - 0.5);
    }
    asdic_sonar *sonar = &s->rig.sonar;
    sonar->transmitter.length_h_m = 0.01;
    sonar->receivers = s->receivers;
    sonar->receiver_count = beams;
    sonar->speckle = ASDIC_SPECKLE_RAYLEIGH;
    sonar->bin_length_m = 0.0745;
    sonar->ping_rate_hz = 40.0;
    s->rig.sampling.rays = 1024;
    s->speed_mps = asdic_environment_sound_speed_mps(&s->rig.env, 7.0);
    assert_ok(ctx, asdic_scene_commit(s->rig.scene));
    assert_ok(ctx, asdic_simulator_create(ctx, device.device, s->rig.scene, &s->rig.env, sonar,
                                          &s->rig.sampling, 7.0, &s->sim));
    s->bins = asdic_simulator_bin_count(s->sim);
    s->mean = calloc(beams * s->bins, sizeof *s->mean);
    assert_ok(ctx, asdic_ping_create(ctx, beams, s->bins, &s->ping));
    assert_ok(ctx, asdic_scan_create(ctx, sonar, s->speed_mps, s->bins, d, NULL, &s->scan));
}

static asdic_scan_result sea_next(sea *s, uint64_t index) {
    assert_ok(device.ctx, asdic_simulator_ping(s->sim, &s->rig.pose, index, s->ping));
    double *const *part = s->ping->intensity_lin;
    memset(s->mean, 0, s->beams * s->bins * sizeof *s->mean);
    for (int c = ASDIC_TOTAL + 1; c < ASDIC_COMPONENT_COUNT; c++) {
        for (size_t i = 0; i < s->beams * s->bins; i++) {
            s->mean[i] += part[c][i];
        }
    }
    assert_ok(device.ctx, asdic_scan_ping(s->scan, part[ASDIC_TOTAL], s->mean, NULL, NULL));
    return asdic_scan_get(s->scan);
}

static void sea_end(sea *s) {
    free(s->mean);
    free(s->receivers);
    asdic_scan_destroy(&s->scan);
    asdic_ping_destroy(&s->ping);
    asdic_simulator_destroy(&s->sim);
    rig_destroy(&s->rig);
}

/* ---- the map -------------------------------------------------------------------------------- */

enum { MAP_PINGS = 4, MAPS = 20 };

/* Share of cells above even odds after each of MAP_PINGS, of single beams with Rayleigh speckle and
 * one look: likelihood ratio e^(snr x / (1 + snr)) / (1 + snr) of an intensity x, by chance. */
static void design_map(const asdic_detector *d, double limit, double share[MAP_PINGS]) {
    enum { WALKS = 2000000 };
    uint64_t state = 12345;
    double snr = pow(10.0, 0.1 * d->snr_db);
    for (int i = 0; i < WALKS; i++) {
        double odds = log(d->prior / (1.0 - d->prior));
        for (int n = 0; n < MAP_PINGS; n++) {
            state = state * 6364136223846793005u + 1442695040888963407u;
            double x = -log(((double)(state >> 12) + 0.5) * 0x1p-52);
            odds = fmin(fmax(odds + x * snr / (1.0 + snr) - log1p(snr), -limit), limit);
            share[n] += (odds > 0.0) / (double)WALKS;
        }
    }
}

static void measure_map(size_t beams, size_t elevations, const asdic_detector *d, double limit,
                        double share[MAP_PINGS]) {
    sea s;
    sea_begin(&s, beams, elevations, d);
    double cells = 0.0;
    for (uint64_t m = 0; m < MAPS; m++) {
        asdic_occupancy *map = NULL;
        asdic_vec3 low = {0.0, -6.0, 0.0}, high = {19.0, 6.0, 0.0};
        assert_ok(device.ctx,
                  asdic_occupancy_create(device.ctx, low, high, 0.2, d->prior, limit, &map));
        for (uint64_t n = 0; n < MAP_PINGS; n++) {
            asdic_scan_result r = sea_next(&s, m * MAP_PINGS + n);
            const asdic_look look = {.sonar = &s.rig.sonar,
                                     .sound_speed_mps = s.speed_mps,
                                     .pose = s.rig.pose,
                                     .depth_m = INFINITY,
                                     .bins = s.bins,
                                     .intensity_lin = s.ping->intensity_lin[ASDIC_TOTAL],
                                     .background_lin = r.background_lin,
                                     .snr_db = d->snr_db};
            assert_ok(device.ctx, asdic_occupancy_add(device.ctx, map, &look));
            for (size_t i = 0; i < map->rows * map->columns; i++) {
                cells += n == 0 && !isnan(map->log_odds[i]);
                share[n] += map->log_odds[i] > 0.0f;
            }
        }
        asdic_occupancy_destroy(&map);
    }
    for (int n = 0; n < MAP_PINGS; n++) {
        share[n] /= cells;
    }
    sea_end(&s);
}

static void maps_have_no_more_false_cells_than_a_beam(void **state) {
    (void)state;
    asdic_detector d = asdic_detector_default();
    double limit = 10.0, designed[MAP_PINGS] = {0.0}, all = 0.0;
    bool good = true;
    design_map(&d, limit, designed);
    print_message("cells above even odds: ");
    for (int n = 0; n < MAP_PINGS; n++) {
        print_message("  %.2e", designed[n]);
    }
    for (int k = 0; k < 6; k++) {
        if (!full && (k == 3 || k == 4)) {
            continue;
        }
        size_t overlap = k < 5 ? (size_t)1 << k : 2, elevations = k < 5 ? 1 : 3;
        double share[MAP_PINGS] = {0.0}, sum = 0.0, expected = 0.0;
        measure_map(BEAMS_1_FOLD * overlap * elevations, elevations, &d, limit, share);
        print_message("\n%2zu-fold, %zu elevation%s", overlap, elevations, k < 5 ? " " : "s");
        for (int n = 0; n < MAP_PINGS; n++) {
            print_message("   %.2e", share[n]);
            sum += share[n];
            expected += designed[n];
        }
        /* Several beams are asked at once, and cells share echoes: fewer than of one beam alone. */
        good = good && sum < 0.6 * expected;
        all += sum;
    }
    print_message("\n");
    assert_true(good && all > 0.0); /* many beams have next to none */
}

/* ---- plots and tracks ----------------------------------------------------------------------- */

/* P(both of two exponential intensities of mean 1, correlated by RHO2, exceed THRESHOLD): given the
 * one, the other is that of a steady target in a background, which is Marcum's Q. */
static double both_exceed(double threshold, double rho2) {
    asdic_background rest = {.mean_lin = 1.0 - rho2, .looks = 1, .shape = INFINITY};
    double sum = 0.0, step = 0.02;
    for (double x = threshold + 0.5 * step; x < threshold + 30.0; x += step) {
        double one = asdic_detect_pd(&rest, ASDIC_TARGET_SWERLING0, rho2 * x, threshold);
        sum += step * exp(-x) * one;
    }
    return sum;
}

/* Runs of false alarms that begin in a row of beams, which share as theory says, for each bin: one at
 * the first beam, and at others where the beam before has none. */
static double runs_of(size_t beams, double wavelength_m, double pfa) {
    double apart = SECTOR_RAD / (double)(beams - 1);
    double x = RIG_DEGREE * 180.0 * LENGTH_M / wavelength_m * sin(apart);
    double both = both_exceed(-log(pfa), pow(sin(x) / x, 2));
    return pfa + (double)(beams - 1) * (pfa - both);
}

/* A ping's detection as asdic_run_detect does it. */
static void job_begin(asdic_detect_job *job, const sea *s) {
    size_t cells = s->beams * s->bins;
    *job = (asdic_detect_job){.scan = s->scan, .sound_speed_mps = s->speed_mps};
    job->info = (asdic_run_info){.beams = s->beams, .bins = s->bins, .sonar = &s->rig.sonar};
    job->label = malloc(cells * sizeof *job->label);
    job->truth = calloc(cells, sizeof *job->truth);
    job->detected = calloc(cells, sizeof *job->detected);
    job->plots = calloc(cells, sizeof *job->plots);
    job->plot_cell = calloc(2 * cells, sizeof *job->plot_cell);
    job->plot_bins = job->plot_cell + cells;
    for (size_t i = 0; i < cells; i++) {
        job->label[i] = -1;
    }
}

static void job_end(asdic_detect_job *job) {
    free(job->label);
    free(job->truth);
    free(job->detected);
    free(job->plots);
    free(job->plot_cell);
}

typedef struct counts {
    double alarms, plots, tracks; /* tracks: confirmed */
} counts;

static counts count_tracks(sea *s, asdic_detect_job *job, int pings, double ping_s) {
    asdic_tracker_options options = asdic_tracker_options_default();
    asdic_tracker *tracker = NULL;
    const asdic_record record = {.pose = s->rig.pose};
    counts sum = {0};
    uint8_t *confirmed = calloc((size_t)pings * s->bins * 8, 1);
    assert_ok(device.ctx, asdic_tracker_create(device.ctx, &options, &tracker));
    for (int k = 0; k < pings; k++) {
        asdic_scan_result r = sea_next(s, (uint64_t)k);
        for (size_t i = 0; i < s->beams * s->bins; i++) {
            job->detected[i] = s->ping->intensity_lin[ASDIC_TOTAL][i] > r.threshold_lin[i];
            sum.alarms += job->detected[i];
        }
        asdic_detect_find_plots(job, &record);
        sum.plots += (double)job->plot_count;
        assert_ok(device.ctx,
                  asdic_tracker_update(tracker, k * ping_s, job->plots, job->plot_count));
        size_t alive = 0;
        const asdic_track_state *tracks = asdic_tracker_get(tracker, &alive);
        for (size_t i = 0; i < alive; i++) {
            sum.tracks += tracks[i].confirmed && !confirmed[tracks[i].id];
            confirmed[tracks[i].id] |= tracks[i].confirmed;
        }
    }
    free(confirmed);
    asdic_tracker_destroy(&tracker);
    return sum;
}

/* Confirmed tracks of PLOTS plots a ping, as many in each of the BINS_HEARD last bins. */
static double expected_tracks(const sea *s, const asdic_detect_job *job, int pings, double ping_s,
                              double plots, size_t bins_heard) {
    asdic_tracker_options options = asdic_tracker_options_default();
    double sum = 0.0, per_bin = plots / (double)bins_heard;
    size_t beams = s->rig.sonar.receiver_count;
    double *east_m = calloc(beams, sizeof *east_m);
    for (size_t n = s->bins - bins_heard; n < s->bins; n++) {
        double range_m = ((double)n + 0.5) * s->rig.sonar.bin_length_m, along, across;
        asdic_detect_spread(job, asdic_beam_width_rad(&s->rig.sonar, 0, s->speed_mps), range_m,
                            &along, &across);
        asdic_plot_point plot = {.variance_nn_m2 = along * along,
                                 .variance_ee_m2 = across * across};
        for (size_t b = 0; b < beams; b++) {
            east_m[b] = range_m * SECTOR_RAD / (double)beams * (double)b;
        }
        double per_m = per_bin / s->rig.sonar.bin_length_m / (double)beams;
        sum += per_bin * asdic_tracker_false_share(&options, ping_s, &plot, per_m, east_m, beams,
                                                   range_m, 0.0);
    }
    free(east_m);
    return sum * (pings - 3);
}

static void clutter_makes_as_many_tracks_as_designed(void **state) {
    (void)state;
    const int pings = full ? 400 : 1000; /* as many tracks in all */
    asdic_detector d = asdic_detector_default();
    double all = 0.0, all_expected = 0.0;
    bool good = true;
    for (size_t overlap = 1; overlap <= (full ? 16 : 4); overlap *= 2) {
        sea s;
        asdic_detect_job job;
        sea_begin(&s, BEAMS_1_FOLD * overlap, 1, &d);
        job_begin(&job, &s);
        double ping_s = 1.0 / s.rig.sonar.ping_rate_hz;
        size_t blank = (size_t)(s.rig.sonar.blanking_m / s.rig.sonar.bin_length_m);
        size_t heard = s.bins - blank;
        double wavelength_m = s.speed_mps / s.rig.sonar.frequency_hz;
        double alarms = d.pfa * (double)(s.beams * heard);
        double plots = (double)heard * runs_of(s.beams, wavelength_m, d.pfa);
        double tracks = expected_tracks(&s, &job, pings, ping_s, plots, heard);
        counts c = count_tracks(&s, &job, pings, ping_s);
        print_message(
            "%2zu-fold: alarms %.2f a ping (%.2f), plots %.2f (%.2f), tracks %.0f (%.1f)\n",
            overlap, c.alarms / pings, alarms, c.plots / pings, plots, c.tracks, tracks);
        good = good && fabs(c.alarms / pings / alarms - 1.0) < 0.05;
        good = good && fabs(c.plots / pings / plots - 1.0) < 0.1;
        good = good && fabs(c.tracks - tracks) < 3.3 * sqrt(tracks) + 0.2 * tracks + 1.0;
        all += c.tracks;
        all_expected += tracks;
        job_end(&job);
        sea_end(&s);
    }
    assert_true(good);
    assert_true(fabs(all - all_expected) < 2.6 * sqrt(all_expected) + 0.2 * all_expected);
}

int main(int argc, char **argv) {
    full = argc == 2 && strcmp(argv[1], "full") == 0;
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(maps_have_no_more_false_cells_than_a_beam),
        cmocka_unit_test(clutter_makes_as_many_tracks_as_designed),
    };
    device = test_device_open_or_skip();
    return test_device_end(&device, cmocka_run_group_tests(tests, NULL, NULL));
}
