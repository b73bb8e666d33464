/* A sea that holds nothing, looked at by fans whose beams overlap more and more: a map fills as
 * one beam alone would fill it. */
#include "ping_rig.h"

static test_device device;

enum { MOST_PINGS = 4, MAPS = 50 };

/* Share of cells above even odds after each of MOST_PINGS, of single beams with Rayleigh speckle
 * and one look: likelihood ratio e^(snr x / (1 + snr)) / (1 + snr) of an intensity x, by chance. */
static void design(const asdic_detector *d, double limit, double share[MOST_PINGS]) {
    enum { WALKS = 2000000 };
    uint64_t state = 12345;
    double snr = pow(10.0, 0.1 * d->snr_db);
    for (int i = 0; i < WALKS; i++) {
        double odds = log(d->prior / (1.0 - d->prior));
        for (int n = 0; n < MOST_PINGS; n++) {
            state = state * 6364136223846793005u + 1442695040888963407u;
            double x = -log(((double)(state >> 12) + 0.5) * 0x1p-52);
            odds = fmin(fmax(odds + x * snr / (1.0 + snr) - log1p(snr), -limit), limit);
            share[n] += (odds > 0.0) / (double)WALKS;
        }
    }
}

/* BEAMS in as many fans as there are ELEVATIONS. */
static asdic_simulator *fan_simulator(ping_rig *r, asdic_beam *receivers, size_t beams,
                                      size_t elevations) {
    asdic_simulator *sim = NULL;
    for (size_t b = 0; b < beams; b++) {
        size_t fan = beams / elevations;
        double share = (double)(b % fan) / (double)(fan - 1) - 0.5;
        receivers[b] = r->receivers[b / fan]; /* ahead, 20 degrees down, 20 degrees up */
        receivers[b].length_h_m = 0.75;
        receivers[b].yaw_rad = share * 32.0 * RIG_DEGREE;
    }
    r->sonar.receivers = receivers;
    r->sonar.receiver_count = beams;
    r->sonar.speckle = ASDIC_SPECKLE_RAYLEIGH;
    r->sonar.bin_length_m = 0.0745;
    r->sonar.ping_rate_hz = 40.0;
    r->sampling.rays = 1024;
    assert_ok(device.ctx, asdic_scene_commit(r->scene));
    assert_ok(device.ctx, asdic_simulator_create(device.ctx, device.device, r->scene, &r->env,
                                                 &r->sonar, &r->sampling, 7.0, &sim));
    return sim;
}

/* The same of maps of what BEAMS beams see; means are the ping's own expected parts. */
static void measure(size_t beams, size_t elevations, const asdic_detector *d, double limit,
                    double share[MOST_PINGS]) {
    asdic_context *ctx = device.ctx;
    ping_rig r = rig_create(&device);
    asdic_beam *receivers = calloc(beams, sizeof *receivers);
    asdic_simulator *sim = fan_simulator(&r, receivers, beams, elevations);
    double speed = asdic_environment_sound_speed_mps(&r.env, 7.0), cells = 0.0;
    size_t bins = asdic_simulator_bin_count(sim);
    asdic_ping *ping = NULL;
    asdic_scan *scan = NULL;
    double *mean = calloc(beams * bins, sizeof *mean);
    assert_ok(ctx, asdic_ping_create(ctx, beams, bins, &ping));
    assert_ok(ctx, asdic_scan_create(ctx, &r.sonar, speed, bins, d, NULL, &scan));
    for (uint64_t m = 0; m < MAPS; m++) {
        asdic_occupancy *map = NULL;
        asdic_vec3 low = {0.0, -6.0, 0.0}, high = {19.0, 6.0, 0.0};
        assert_ok(ctx, asdic_occupancy_create(ctx, low, high, 0.2, d->prior, limit, &map));
        for (uint64_t n = 0; n < MOST_PINGS; n++) {
            assert_ok(ctx, asdic_simulator_ping(sim, &r.pose, m * MOST_PINGS + n, ping));
            memset(mean, 0, beams * bins * sizeof *mean);
            for (size_t i = 0; i < beams * bins; i++) {
                for (int c = ASDIC_TOTAL + 1; c < ASDIC_COMPONENT_COUNT; c++) {
                    mean[i] += ping->intensity_lin[c][i];
                }
            }
            assert_ok(ctx, asdic_scan_ping(scan, ping->intensity_lin[ASDIC_TOTAL], mean, NULL));
            asdic_occupancy_add(map, &r.sonar, speed, &r.pose, bins, asdic_scan_get(scan).llr);
            for (size_t i = 0; i < map->rows * map->columns; i++) {
                cells += n == 0 && !isnan(map->log_odds[i]);
                share[n] += map->log_odds[i] > 0.0f;
            }
        }
        asdic_occupancy_destroy(&map);
    }
    for (int n = 0; n < MOST_PINGS; n++) {
        share[n] /= cells;
    }
    free(mean);
    free(receivers);
    asdic_scan_destroy(&scan);
    asdic_ping_destroy(&ping);
    asdic_simulator_destroy(&sim);
    rig_destroy(&r);
}

static void maps_fill_as_designed(void **state) {
    (void)state;
    asdic_detector d = asdic_detector_default();
    double limit = 10.0, designed[MOST_PINGS] = {0.0};
    bool good = true;
    design(&d, limit, designed);
    print_message("%-24s", "cells above even odds:");
    for (int n = 0; n < MOST_PINGS; n++) {
        print_message("  %.2e", designed[n]);
    }
    for (int k = 0; k < 6; k++) { /* 1.02 degrees wide, in 32 degrees */
        size_t overlap = k < 5 ? (size_t)1 << k : 2, elevations = k < 5 ? 1 : 3;
        double share[MOST_PINGS] = {0.0}, sum = 0.0, expected = 0.0;
        measure(32 * overlap * elevations, elevations, &d, limit, share);
        print_message("\n%2zu-fold, %zu elevation%s   ", overlap, elevations, k < 5 ? " " : "s");
        for (int n = 0; n < MOST_PINGS; n++) {
            print_message("  %.2e", share[n]);
            sum += share[n];
            expected += designed[n];
        }
        good = good && sum > 0.5 * expected && sum < 2.0 * expected;
    }
    print_message("\n");
    assert_true(good);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(maps_fill_as_designed),
    };
    device = test_device_open_or_skip();
    int failed = cmocka_run_group_tests(tests, NULL, NULL);
    test_device_close(&device);
    return failed;
}
