/*
 * Stated against true errors of bins that few rays meet: the r.m.s. of one over the other lies within 0.7 and 1.3 of the
 * bins of first echoes, of fans' within 0.8 and 1.2, of which at most 0.4 % err by more than five stated errors, where
 * a fan's beams meet 0.6 %. Of bins
 * with noise that the rays of some pings miss at most 0.2 % do, of those that single rays meet by way of a body 0.07 %, of
 * those over a terrain whose edges have moved since 1 %.
 */
#include "honesty_rig.h"

/* The first two bins in which a beam hears the bottom, or the surface, and the rest. */
static void add_first(const honesty_rig *r, const asdic_ping *truth, size_t i, double square,
                      honesty_sum *sums) {
    static const asdic_component boundaries[] = {ASDIC_BOTTOM, ASDIC_SURFACE};
    (void)r;
    bool is_first = false;
    for (size_t k = 0; k < 2; k++) {
        const double *energy = truth->intensity_lin[boundaries[k]];
        bool rules = energy[i] > 0.5 * truth->intensity_lin[ASDIC_TOTAL][i];
        is_first = is_first || (rules && (!(energy[i - 1] > 0.0) || !(energy[i - 2] > 0.0)));
    }
    add_square(&sums[is_first], square);
}

static void first_echoes(void **state) {
    (void)state;
    static const char text[] =
        "version: 1\n"
        "environment: {wind_speed_kn: 8}\n"
        "bottom: {depth_m: %g, type: sand}\n"
        "sonar:\n"
        "  frequency_khz: 150\n"
        "  bandwidth_khz: 10\n"
        "  max_range_m: 30\n"
        "  bin_length_m: 0.2\n"
        "  transmitter: {pitch_deg: 8, length_h_m: 0.01, length_v_m: 0.02}\n"
        "  receivers: {fan: {count: %zu, sector_deg: 60, length_h_m: 0.05, length_v_m: 0.015}}\n"
        "mission: {pose: {position_m: [0, 0, %g], roll_deg: 5}, pings: 1}\n";
    static const double depths_m[] = {9.0, 12.1, 14.2};
    static const struct {
        size_t beams;
        double deeper_m; /* than where the block was learnt */
    } cases[] = {{3, 0.0}, {24, 0.0}, {3, 0.4}, {24, 0.4}};
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        honesty_sum sums[2] = {{0}};
        for (size_t i = 0; i < 3; i++) {
            char whole[sizeof text + 128];
            snprintf(whole, sizeof whole, text, depths_m[i], cases[k].beams, 0.45 * depths_m[i]);
            honesty_rig r = rig_of_text(whole);
            r.pose.position_m.z += cases[k].deeper_m;
            add_errors(&r, 20000, 8, add_first, sums);
            rig_close(&r);
        }
        print_message(
            "%2zu beams, %g m deeper, bins of first echoes: true over stated %.2f of %.0f, "
            "rest %.2f\n",
            cases[k].beams, cases[k].deeper_m, rms_of(sums[1]), sums[1].count, rms_of(sums[0]));
        assert_true(rms_of(sums[1]) > 0.7 && rms_of(sums[1]) < 1.3);
        assert_true(rms_of(sums[0]) > 0.7 && rms_of(sums[0]) < 1.3);
    }
}

/* Of add_first: those that err by more than five stated errors, too. */
static void add_first_beyond(const honesty_rig *r, const asdic_ping *truth, size_t i, double square,
                             honesty_sum *sums) {
    honesty_sum own[2] = {{0}};
    add_first(r, truth, i, square, own);
    if (own[1].count > 0.0) {
        add_square(&sums[0], square);
        add_square(&sums[1], square > 25.0);
    }
}

/* The few rays that bring a first echo bring it to many beams at once. */
static void first_echoes_of_fans(void **state) {
    (void)state;
    static const char text[] =
        "version: 1\n"
        "bottom: {depth_m: 12, type: sand}\n"
        "sonar:\n"
        "  frequency_khz: %g\n"
        "  bandwidth_khz: 20\n"
        "  max_range_m: %g\n"
        "  bin_length_m: 0.2\n"
        "  transmitter: {length_h_m: %g, length_v_m: %g}\n"
        "  receivers: {fan: {count: %d, sector_deg: %g, length_h_m: %g, length_v_m: %g}}\n"
        "mission: {pose: {position_m: [0, 0, %g]}, pings: 1}\n";
    static const struct {
        double khz, range_m, sender_m, high_m;
        int beams;
        double sector_deg, receiver_m, depth_m;
    } cases[] = {{450, 42, 0.00166, 0.0208, 256, 60, 0.729, 6.18},
                 {200, 40.6, 0.00373, 0.0231, 128, 90, 0.546, 6.48}};
    honesty_sum sums[2] = {{0}};
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        char whole[sizeof text + 128];
        snprintf(whole, sizeof whole, text, cases[k].khz, cases[k].range_m, cases[k].sender_m,
                 cases[k].high_m, cases[k].beams, cases[k].sector_deg, cases[k].receiver_m,
                 cases[k].high_m, cases[k].depth_m);
        honesty_rig r = rig_of_text(whole);
        add_errors(&r, 20000, 16, add_first_beyond, sums);
        rig_close(&r);
    }
    double beyond = sums[1].squares / sums[1].count;
    print_message("first echoes of fans: true over stated %.2f of %.0f, beyond five %.3f %%\n",
                  rms_of(sums[0]), sums[0].count, 100.0 * beyond);
    assert_true(rms_of(sums[0]) > 0.8 && rms_of(sums[0]) < 1.2 && beyond < 4e-3);
}

/* The bottom where the axis that the beams turn about meets it, 2.3 m below the vehicle and 11 degrees from the nadir, and
 * the bin behind. */
static void add_where_beams_meet(const honesty_rig *r, const asdic_ping *truth, size_t i,
                                 double square, honesty_sum *sums) {
    size_t bin = (size_t)(2.3 / cos(11.0 * DEGREE) / r->sonar.bin_length_m);
    if (i % truth->bins - bin < 2) {
        add_square(&sums[0], square);
        add_square(&sums[1], square > 25.0);
    }
}

/* All beams of a fan hear it by the same few rays. */
static void bins_where_beams_meet(void **state) {
    (void)state;
    static const char text[] =
        "version: 1\n"
        "environment: {wind_speed_kn: 4}\n"
        "bottom: {depth_m: 7.4, lambert_db: -22}\n"
        "sonar:\n"
        "  frequency_khz: 2100\n"
        "  bandwidth_khz: 150\n"
        "  max_range_m: 4\n"
        "  bin_length_m: 0.0203\n"
        "  transmitter: {length_h_m: 0.00052, length_v_m: 0.00301}\n"
        "  receivers: {fan: {count: 128, sector_deg: 60, length_h_m: 0.086, length_v_m: 0.003}}\n"
        "mission: {pose: {position_m: [0, 0, 5.1], pitch_deg: -11}, pings: 1}\n";
    honesty_rig r = rig_of_text(text);
    honesty_sum sums[2] = {{0}};
    add_errors(&r, 60000, 16, add_where_beams_meet, sums);
    double beyond = sums[1].squares / sums[1].count;
    print_message("bins where beams meet: true over stated %.2f of %.0f, beyond five %.3f %%\n",
                  rms_of(sums[0]), sums[0].count, 100.0 * beyond);
    assert_true(rms_of(sums[0]) > 0.8 && rms_of(sums[0]) < 1.2 && beyond < 0.006);
    rig_close(&r);
}

/* How many err by more than five times what they state. */
static void add_off(const honesty_rig *r, const asdic_ping *truth, size_t i, double square,
                    honesty_sum *sums) {
    (void)r;
    (void)truth;
    (void)i;
    add_square(sums, square > 25.0);
}

/* A side-scan sonar's narrow beams: their bins have few rays, of which some pings have none. What is left is noise, or
 * water, and knows nothing of what was missed. */
static void bins_that_rays_miss(void **state) {
    (void)state;
    static const char text[] =
        "version: 1\n"
        "environment: {wind_speed_kn: 5}\n"
        "bottom: {depth_m: 20, lambert_db: -22}\n"
        "sonar:\n"
        "  frequency_khz: 450\n"
        "  bandwidth_khz: 25\n"
        "  max_range_m: 40\n"
        "  bin_length_m: 0.03\n"
        "  source_level_db: 215\n"
        "  transmitter: {length_h_m: 0.003, length_v_m: 0.003, pitch_deg: 90}\n"
        "  receivers: %s\n"
        "mission: {pose: {position_m: [0, 0, 12]}, pings: 1}\n";
    static const struct {
        const char *receivers;
        uint32_t rays;
    } cases[] = {
        {"[{yaw_deg: -90, pitch_deg: 35, length_h_m: 1, length_v_m: 0.004}, {yaw_deg: 90, "
         "pitch_deg: 35, length_h_m: 1, length_v_m: 0.004}]",
         4000},
        {"{fan: {count: 24, sector_deg: 120, length_h_m: 0.3, length_v_m: 0.004, pitch_deg: 35}}",
         15000}};
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        char whole[sizeof text + 256];
        snprintf(whole, sizeof whole, text, cases[k].receivers);
        honesty_rig r = rig_of_text(whole);
        honesty_sum sum = {0};
        r.sonar.noise_enabled = true;
        add_errors(&r, cases[k].rays, 4, add_off, &sum);
        print_message("bins that rays miss: of %.0f %.3f %% err by more than five stated errors\n",
                      sum.count, 100.0 * sum.squares / sum.count);
        assert_true(sum.squares < 0.002 * sum.count);
        rig_close(&r);
    }
}

/* Of those too, then all. */
static void add_off_and_all(const honesty_rig *r, const asdic_ping *truth, size_t i, double square,
                            honesty_sum *sums) {
    add_off(r, truth, i, square, &sums[0]);
    add_square(&sums[1], square);
}

/* A smooth body sends rays all over the bottom, single ones to a bin. Under a calm surface, where echoes by way of it
 * come by many rays, errors are stated no larger for that. */
static void bins_that_single_rays_meet(void **state) {
    (void)state;
    static const char text[] =
        "version: 1\n"
        "environment: {wind_speed_kn: %d}\n"
        "bottom: {depth_m: 12, %s}\n"
        "objects: [{name: body, %s, position_m: [16, 3, 10], rotation_deg: [0, 0, 75], material: "
        "{impedance_mrayl: 45, roughness_rms_mm: 0.1, slope_rms: 0.05}}]\n"
        "sonar:\n"
        "  frequency_khz: %d\n"
        "  bandwidth_khz: 10\n"
        "  max_range_m: 46\n"
        "  bin_length_m: 0.25\n"
        "  transmitter: {length_h_m: 0.007, length_v_m: 0.02}\n"
        "  receivers: {fan: {count: 64, sector_deg: 100, length_h_m: 0.15, length_v_m: 0.02}}\n"
        "mission: {pose: {position_m: [0, 0, 7], pitch_deg: 3}, pings: 1}\n"
        "sampling: {multipath: boundaries}\n";
    static const struct {
        int wind_kn, frequency_khz;
        const char *bottom, *body;
    } cases[] = {{4, 200, "type: sand", "sphere: {radius_m: 0.8}"},
                 {0, 100, "sediment: medium_sand", "cylinder: {radius_m: 0.4, length_m: 6}"}};
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        char whole[sizeof text + 128];
        snprintf(whole, sizeof whole, text, cases[k].wind_kn, cases[k].bottom, cases[k].body,
                 cases[k].frequency_khz);
        honesty_rig r = rig_of_text(whole);
        honesty_sum sums[2] = {{0}};
        add_errors(&r, 50000, 4, add_off_and_all, sums);
        double off = sums[0].squares / sums[0].count, all = rms_of(sums[1]);
        print_message("bins that single rays meet, wind %d kn: true over stated %.2f, by more than "
                      "five %.3f %%\n",
                      cases[k].wind_kn, all, 100.0 * off);
        assert_true(off < 7e-4 && all > 0.75 && all < 1.1);
        rig_close(&r);
    }
}

/* Over terrain, where edges have moved since the lesson. */
static void bins_that_edges_left(void **state) {
    (void)state;
    static const honesty_case c = {"mission_fan", 60000, 0.0, 0.0, 128, 2.7, 2, 0.0};
    honesty_rig r = rig_open(&c);
    honesty_sum sums[2] = {{0}};
    add_errors(&r, c.rays, c.blocks, add_off_and_all, sums);
    double off = sums[0].squares / sums[0].count, all = rms_of(sums[1]);
    print_message("bins that edges left: true over stated %.2f, by more than five %.3f %%\n", all,
                  100.0 * off);
    assert_true(off < 0.01 && all > 0.7 && all < 1.3);
    rig_close(&r);
}

int main(void) {
    t = test_device_open_or_skip();
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(first_echoes),
        cmocka_unit_test(first_echoes_of_fans),
        cmocka_unit_test(bins_where_beams_meet),
        cmocka_unit_test(bins_that_rays_miss),
        cmocka_unit_test(bins_that_single_rays_meet),
        cmocka_unit_test(bins_that_edges_left),
    };
    return test_device_end(&t, cmocka_run_group_tests(tests, NULL, NULL));
}
