/*
 * Stated against true errors of boundaries and water: the r.m.s. of one over the other lies within 0.8 and 1.3 over all
 * bins from 2 m on and over the far third of them, within 0.75 and 1.3 where far bins lie in deep nulls, within 0.7 and
 * 1.3 where the vehicle has gone on over terrain; within
 * 0.8 and 1.25 of each of many unlike beams, within 0.7 and 1.25 of the bins that open water rules.
 */
#include "honesty_rig.h"

static void stated_errors_are_honest(const honesty_case *c) {
    honesty_rig r = rig_open(c);
    honesty_sum sums[2] = {{0}};
    add_errors(&r, c->rays, c->blocks, add_far, sums);
    double all = rms_of(sums[0]), last = rms_of(sums[1]);
    print_message("%-13s %6u rays, pitch %3g, bins of %3g m, %2.1f m on: true over stated %.2f, "
                  "far %.2f\n",
                  c->scene, c->rays, c->pitch_deg, r.sonar.bin_length_m, c->ahead_m, all, last);
    double least = c->ahead_m > 0.0     ? 0.7 /* which bins hold the spikes by then nobody knows */
                   : c->pitch_deg > 0.0 ? 0.75
                                        : 0.8;
    assert_true(all > least && all < c->most && last > least && last < c->most);
    rig_close(&r);
}

static void flat_bottoms(void **state) {
    (void)state;
    static const honesty_case cases[] = {
        {"bench_flat", 4096, 0.0, 0.0, 0, 0.0, 16, 1.3},
        {"bench_flat", 65536, 0.0, 0.0, 0, 0.0, 8, 1.3},
        {"bench_flat", 65536, 20.0, 0.0, 0, 0.0, 12, 1.3}, /* far bins in deep nulls */
        {"bench_flat", 4096, -20.0, 0.0, 0, 0.0, 16, 1.3},
    };
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        stated_errors_are_honest(&cases[k]);
    }
}

/* The pulse is 75 mm long: two bins, one and a half, less than one. */
static void short_bins(void **state) {
    (void)state;
    static const double bins_m[] = {0.0364, 0.05, 0.1, 0.2};
    for (size_t k = 0; k < sizeof bins_m / sizeof *bins_m; k++) {
        honesty_case c = {"bench_flat", 4096, 0.0, bins_m[k], 0, 0.0, 8, 1.3};
        stated_errors_are_honest(&c);
    }
}

static void rough_bottoms(void **state) {
    (void)state;
    static const honesty_case cases[] = {
        {"bench_terrain", 4096, 0.0, 0.0, 0, 0.0, 24, 1.3},
        {"bench_terrain", 20000, 0.0, 0.0, 0, 0.0, 12, 1.3},
        {"bench_terrain", 4096, 0.0, 0.0, 0, 1.5, 24, 1.3}, /* other bins hold the spikes by then */
        {"mission_fan", 40000, 0.0, 0.0, 64, 2.5, 3, 1.3},
    };
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        stated_errors_are_honest(&cases[k]);
    }
}

/* What a pulse brings from beyond the last bin: by a truth of more bins. */
static void the_range_s_end(void **state) {
    (void)state;
    static const char text[] =
        "version: 1\n"
        "bottom: {depth_m: %g}\n"
        "sonar: {frequency_khz: 100, bandwidth_khz: %g, max_range_m: 30, bin_length_m: 0.1,\n"
        "  receivers: [{name: a, length_h_m: 0.1, length_v_m: 0.05, pitch_deg: %g}]}\n"
        "mission: {pose: {position_m: [0, 0, 10]}}\n";
    static const struct {
        double depth_m, bandwidth_khz, pitch_deg;
    } cases[] = {{20, 1.5, 20}, {20, 0.75, 20}, {20, 2.5, 20}, {40.2, 1.5, 90}, {39.8, 1.5, 90}};
    enum { BEYOND = 20 };
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        char whole[1024];
        snprintf(whole, sizeof whole, text, cases[k].depth_m, cases[k].bandwidth_khz,
                 cases[k].pitch_deg);
        honesty_rig r = rig_of_text(whole);
        honesty_sum sum = {0};
        double worst = 0.0;
        asdic_flat_scene flat = asdic_mission_flat_scene(r.mission, 0);
        for (uint64_t block = 0; block < 32; block++) {
            asdic_simulator *sim = rig_simulator(&r, 4096);
            asdic_ping *ping = new_ping(&r), *truth = NULL;
            assert_ok(t.ctx, asdic_ping_create(t.ctx, 1, r.bins + BEYOND, &truth));
            assert_ok(t.ctx,
                      asdic_expected_compute(t.ctx, &flat, asdic_mission_environment(r.mission),
                                             &r.sonar, &r.pose, truth));
            uint64_t index = block * ASDIC_LEARN_BLOCK;
            assert_ok(t.ctx, asdic_simulator_learn(sim, &r.pose, index));
            assert_ok(t.ctx, asdic_simulator_ping(sim, &r.pose, index, ping));
            size_t half = (size_t)(3.75 / cases[k].bandwidth_khz);
            for (size_t n = r.bins - half; n < r.bins; n++) {
                double off = asdic_level_db(ping->intensity_lin[ASDIC_TOTAL][n]) -
                             asdic_level_db(truth->intensity_lin[ASDIC_TOTAL][n]);
                double ratio = off / (double)ping->stderr_db[n];
                worst = fmax(worst, fabs(off));
                add_square(&sum, ratio * ratio);
            }
            asdic_ping_destroy(&ping);
            asdic_ping_destroy(&truth);
            asdic_simulator_destroy(&sim);
        }
        print_message("last bins, %g kHz, bottom at %g m: off by %.3f dB at most, true over stated "
                      "%.2f\n",
                      cases[k].bandwidth_khz, cases[k].depth_m, worst, rms_of(sum));
        assert_true(worst < 0.15 && rms_of(sum) < 2.0);
        rig_close(&r);
    }
}

/* Of the bins that a pulse reaches from within a blanking of 5 m. */
static void add_behind(const honesty_rig *r, const asdic_ping *truth, size_t i, double square,
                       honesty_sum *sum) {
    double from_m = (double)(i % truth->bins) * r->sonar.bin_length_m - r->sonar.blanking_m;
    if (from_m > -1e-9 && from_m < 1.0) { /* half a pulse */
        add_square(sum, square);
    }
}

static void the_blanking_s_end(void **state) {
    (void)state;
    static const char text[] =
        "version: 1\n"
        "environment: {wind_speed_kn: 8}\n"
        "bottom: {depth_m: 13, type: sand}\n"
        "sonar:\n"
        "  frequency_khz: 100\n"
        "  bandwidth_khz: 0.375\n"
        "  max_range_m: 30\n"
        "  bin_length_m: 0.1\n"
        "  blanking_m: 5\n"
        "  transmitter: {length_h_m: 0.01, length_v_m: 0.03, pitch_deg: 30}\n"
        "  receivers: {fan: {count: 24, sector_deg: 90, length_h_m: 0.1, length_v_m: 0.03, "
        "pitch_deg: 30}}\n"
        "mission: {pose: {position_m: [0, 0, 10]}}\n";
    honesty_rig r = rig_of_text(text);
    honesty_sum sum = {0};
    add_errors(&r, 20000, 4, add_behind, &sum);
    print_message("first bins behind the blanking: true over stated %.2f of %.0f\n", rms_of(sum),
                  sum.count);
    assert_true(rms_of(sum) > 0.7 && rms_of(sum) < 1.3);
    rig_close(&r);
}

static void several_beams(void **state) {
    (void)state;
    static const honesty_case cases[] = {
        {"bench_step", 4096, 0.0, 0.0, 0, 0.0, 12, 1.3},
        {"bench_fan", 20000, 0.0, 0.0, 64, 0.0, 4, 1.3},
        {"bench_fan", 65536, -10.0, 0.0, 64, 0.0, 4, 1.3},
    };
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        stated_errors_are_honest(&cases[k]);
    }
}

/* Rays that are drawn each by itself. Of many beams, which have no groups, only a calibration knows their error; of
 * few, groups that all miss an echo agree. */
static void samplers_that_do_not_learn(void **state) {
    (void)state;
    static const honesty_case cases[] = {{"bench_fan", 160000, 0.0, 0.0, 32, 0.0, 3, 1.3},
                                         {"bench_flat", 4096, 0.0, 0.0, 0, 0.0, 16, 1.3}};
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        honesty_rig r = rig_open(&cases[k]);
        honesty_sum sums[2] = {{0}};
        asdic_mission_sampling(r.mission)->sampler = ASDIC_SAMPLER_BEAM;
        add_errors(&r, cases[k].rays, cases[k].blocks, add_far, sums);
        double all = rms_of(sums[0]), last = rms_of(sums[1]);
        print_message("beam sampler, %6u rays: true over stated %.2f, far %.2f\n", cases[k].rays,
                      all, last);
        assert_true(all > 0.8 && all < cases[k].most && last > 0.8 && last < cases[k].most);
        rig_close(&r);
    }
}

static void add_to_beam(const honesty_rig *r, const asdic_ping *truth, size_t i, double square,
                        honesty_sum *sums) {
    (void)r;
    add_square(&sums[i / truth->bins], square);
}

/* Beams that differ in aperture and aim, beside each other in no order, as of several heads: a narrow one has
 * few of the rays, and errs more than its neighbours. */
static void unlike_beams(void **state) {
    (void)state;
    enum { BEAMS = 20 };
    honesty_case c = {"bench_flat", 40000, 0.0, 0.2, 0, 0.0, 6, 0.0};
    honesty_rig r = rig_open(&c);
    honesty_sum sums[BEAMS] = {{0}};
    double wavelength_m = 1500.0 / r.sonar.frequency_hz;
    r.beams = calloc(BEAMS, sizeof *r.beams);
    for (unsigned b = 0; b < BEAMS; b++) {
        unsigned u = b * 7 % BEAMS, v = b * 13 % BEAMS, w = b * 3 % BEAMS; /* orders of their own */
        r.beams[b] = (asdic_beam){.yaw_rad = (5.0 * u - 48.0) * DEGREE,
                                  .pitch_rad = (2.0 * v - 10.0) * DEGREE,
                                  .length_h_m = wavelength_m * (1.3 + 0.9 * w),
                                  .length_v_m = wavelength_m * (1.1 + 0.3 * v)};
    }
    r.sonar.receivers = r.beams;
    r.sonar.receiver_count = BEAMS;
    add_errors(&r, c.rays, c.blocks, add_to_beam, sums);
    for (size_t b = 0; b < BEAMS; b++) {
        double ratio = rms_of(sums[b]);
        print_message("unlike beam %2zu: true over stated %.2f\n", b, ratio);
        assert_true(ratio > 0.8 && ratio < 1.25);
    }
    rig_close(&r);
}

/* Open water, through which few of the rays go, and bins that the surface rules beside it. */
static void add_water(const honesty_rig *r, const asdic_ping *truth, size_t i, double square,
                      honesty_sum *sums) {
    (void)r;
    bool rules = truth->intensity_lin[ASDIC_VOLUME][i] > 0.5 * truth->intensity_lin[ASDIC_TOTAL][i];
    add_square(&sums[rules], square);
}

static void open_water(void **state) {
    (void)state;
    static const char text[] =
        "version: 1\n"
        "environment: {wind_speed_kn: 9.2, sound_speed_profile: [[0, 1490], [1.2, 1496], [2, "
        "1495.6], [4.4, "
        "1499.6], [4.8, 1499.3], [13.2, 1501], [20.6, 1496.8]]}\n"
        "bottom: {none: true}\n"
        "sonar:\n"
        "  frequency_khz: 282\n"
        "  bandwidth_khz: 6.1\n"
        "  max_range_m: 42.7\n"
        "  bin_length_m: 0.25\n"
        "  transmitter: {pitch_deg: -6.4, yaw_deg: 2.1, length_h_m: 0.009, length_v_m: 0.0132}\n"
        "  receivers:\n"
        "    - {name: a, yaw_deg: -29, pitch_deg: 13.6, length_h_m: 0.084, length_v_m: 0.037}\n"
        "    - {name: b, yaw_deg: -11.1, pitch_deg: -8.4, length_h_m: 0.0394, length_v_m: 0.0395}\n"
        "    - {name: c, yaw_deg: 23.8, pitch_deg: -3.7, length_h_m: 0.06, length_v_m: 0.0266}\n"
        "    - {name: d, yaw_deg: -2, pitch_deg: -2.8, length_h_m: 0.0121, length_v_m: 0.0388}\n"
        "mission: {pose: {position_m: [0, 0, 8.4], roll_deg: -4.9, pitch_deg: 3.5}, pings: 1}\n"
        "model: {refraction: full}\n";
    honesty_rig r = rig_of_text(text);
    honesty_sum sums[2] = {{0}};
    add_errors(&r, 8000, 16, add_water, sums);
    for (int k = 0; k < 2; k++) {
        print_message("bins that %s: true over stated %.2f of %.0f\n",
                      k ? "water rules" : "the surface rules", rms_of(sums[k]), sums[k].count);
        assert_true(rms_of(sums[k]) > 0.7 && rms_of(sums[k]) < 1.25);
    }
    rig_close(&r);
}

/* All bins of a beam through straight water share one error, of which the pings that calibrate it tell little. */
static void straight_water(void **state) {
    (void)state;
    static const char text[] =
        "version: 1\n"
        "environment: {wind_speed_kn: 15, particle_density: moderate}\n"
        "bottom: {none: true}\n"
        "sonar:\n"
        "  frequency_khz: 200\n"
        "  bandwidth_khz: 12\n"
        "  max_range_m: 60\n"
        "  bin_length_m: 0.5\n"
        "  source_level_db: 215\n"
        "  transmitter: {length_h_m: 0.06, length_v_m: 0.06, pitch_deg: 90}\n"
        "  receivers: [{name: down, length_h_m: 0.06, length_v_m: 0.06, pitch_deg: 90}]\n"
        "mission: {pose: {position_m: [0, 0, 0.9], pitch_deg: 2.1, roll_deg: -1.7}, pings: 1}\n";
    honesty_rig r = rig_of_text(text);
    honesty_sum sums[2] = {{0}};
    add_errors(&r, 40000, 16, add_water, sums);
    print_message("straight water: true over stated %.2f of %.0f\n", rms_of(sums[1]),
                  sums[1].count);
    assert_true(rms_of(sums[1]) > 0.5 && rms_of(sums[1]) < 1.25);
    rig_close(&r);
}

int main(void) {
    t = test_device_open_or_skip();
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(flat_bottoms),       cmocka_unit_test(short_bins),
        cmocka_unit_test(rough_bottoms),      cmocka_unit_test(the_range_s_end),
        cmocka_unit_test(the_blanking_s_end), cmocka_unit_test(several_beams),
        cmocka_unit_test(unlike_beams),       cmocka_unit_test(open_water),
        cmocka_unit_test(straight_water),     cmocka_unit_test(samplers_that_do_not_learn),
    };
    return test_device_end(&t, cmocka_run_group_tests(tests, NULL, NULL));
}
