/*
 * Stated against true errors where things are elsewhere than when a block learnt: the r.m.s. of one over the other lies
 * within 0.7 and 1.3 where the vehicle has turned past a quay or climbed through layers; within 0.5 and 1.4 where it has
 * come nearer to objects since it learnt, or they to it (bins of few receivers that few rays may have missed state that
 * they are not known), within 0.4 and 1.3 of those bins that objects rule. And when a vehicle learns anew.
 */
#include "honesty_rig.h"

static void add_ruled(const honesty_rig *r, const asdic_ping *truth, size_t i, double square,
                      honesty_sum *sums) {
    (void)r;
    double rest = truth->intensity_lin[ASDIC_TOTAL][i] - truth->intensity_lin[ASDIC_OBJECT][i];
    if (truth->intensity_lin[ASDIC_OBJECT][i] > rest) {
        add_square(sums, square);
    }
}

/* Bins that objects rule, which others ruled when the block learnt: the vehicle has gone on, or an object has. */
static void objects_elsewhere(void **state) {
    (void)state;
    static const char text[] =
        "version: 1\n"
        "bottom: {depth_m: 20, type: sand}\n"
        "objects:\n"
        "  - {name: ball, sphere: {radius_m: 0.5}, %s,\n"
        "     material: {preset: steel, roughness_rms_mm: 1, slope_rms: 0.1}}\n"
        "%s"
        "sonar: {frequency_khz: 100, bandwidth_khz: 10, ping_rate_hz: 10, max_range_m: 40,\n"
        "  bin_length_m: 0.25, receivers: [{name: ahead, length_h_m: 0.06, length_v_m: 0.06}]}\n"
        "mission: {pose: {position_m: [0, 0, 11]}}\n";
    static const struct {
        double ahead_m, nearer_m;
    } cases[] = {{0.0, 0.0}, {1.5, 0.0}, {4.5, 0.0}, {0.0, 5.0}};
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        bool moves = cases[k].nearer_m > 0.0;
        const char *dome = "  - {name: dome, sphere: {radius_m: 2}, position_m: [22, 3, 20],"
                           " material: {type: rock}}\n";
        char whole[2048], place[1024];
        snprintf(place, sizeof place, "track: %s/tracks/fish.csv", DATA_DIR);
        snprintf(whole, sizeof whole, text, moves ? place : "position_m: [30, 0, 10]",
                 moves ? "" : dome);
        honesty_rig r = rig_of_text(whole);
        honesty_sum sum = {0};
        r.pose.position_m.x += cases[k].ahead_m;
        r.mover = moves ? "ball" : NULL;
        r.mover_learnt_at.position_m = r.mover_at.position_m = (asdic_vec3){30.0, 0.0, 10.0};
        r.mover_at.position_m.x -= cases[k].nearer_m;
        add_errors(&r, 4096, 12, add_ruled, &sum);
        print_message(
            "bins that objects rule, %3.1f m on, one %3.1f m nearer: true over stated %.2f "
            "of %.0f\n",
            cases[k].ahead_m, cases[k].nearer_m, rms_of(sum), sum.count);
        assert_true(sum.count > 0.0 && rms_of(sum) > 0.4 && rms_of(sum) < 1.3);
        rig_close(&r);
    }
}

/* As a mission or a caller's loop does; whether it did. */
static bool learn_where_due(asdic_simulator *sim, const asdic_pose *pose, uint64_t index) {
    bool is_due = asdic_simulator_learn_is_due(sim, pose, index);
    if (is_due) {
        assert_ok(t.ctx, asdic_simulator_learn(sim, pose, index));
    }
    return is_due;
}

/* A vehicle that pitches down, then dives, as a mission or a caller's loop simulates it. */
static void a_dive_learns_anew(void **state) {
    (void)state;
    enum { PINGS = 20, RAYS = 30000 };
    const honesty_case c = {.scene = "bench_fan", .beams = 32};
    honesty_rig r = rig_open(&c);
    asdic_simulator *sim = rig_simulator(&r, RAYS);
    asdic_ping *ping = new_ping(&r), *truth = new_ping(&r);
    asdic_flat_scene flat = asdic_mission_flat_scene(r.mission, 0);
    double squares = 0.0, count = 0.0;
    size_t lessons = 0;
    for (uint64_t k = 0; k < PINGS; k++) {
        double dived_m = 0.1 * fmax((double)k - 5.0, 0.0);
        asdic_pose pose = r.pose;
        pose.pitch_rad = -8.0 * DEGREE * (1.0 - exp(-(double)k / 4.0));
        pose.position_m.z += dived_m;
        flat.depth_m = r.pose.position_m.z + dived_m;
        flat.altitude_m = 5.0 - dived_m;
        lessons += learn_where_due(sim, &pose, k);
        assert_ok(t.ctx, asdic_simulator_ping(sim, &pose, k, ping));
        assert_ok(t.ctx, asdic_expected_compute(t.ctx, &flat, asdic_mission_environment(r.mission),
                                                &r.sonar, &pose, truth));
        for (size_t i = 0; i < ping->beams * ping->bins; i++) {
            if (i % ping->bins < 4 || !(ping->stderr_db[i] > 0.0f)) {
                continue;
            }
            double ratio = (asdic_level_db(ping->intensity_lin[ASDIC_TOTAL][i]) -
                            asdic_level_db(truth->intensity_lin[ASDIC_TOTAL][i])) /
                           ping->stderr_db[i];
            squares += ratio * ratio;
            count += 1.0;
        }
    }
    print_message("a dive of %d pings learns %zu times: true over stated %.2f\n", PINGS, lessons,
                  sqrt(squares / count));
    assert_true(lessons < PINGS);
    assert_close(sqrt(squares / count), 1.05, 0.25);
    asdic_ping_destroy(&ping);
    asdic_ping_destroy(&truth);
    asdic_simulator_destroy(&sim);
    rig_close(&r);
}

/* Over planes a yaw brings no lobe to other elevations. */
static void a_level_turn_does_not(void **state) {
    (void)state;
    const honesty_case c = {.scene = "bench_fan", .beams = 32};
    honesty_rig r = rig_open(&c);
    asdic_simulator *sim = rig_simulator(&r, 2000);
    asdic_pose pose = r.pose;
    assert_false(asdic_simulator_learn_is_due(NULL, &pose, 0));
    assert_false(asdic_simulator_learn_is_due(sim, NULL, 0));
    assert_true(asdic_simulator_learn_is_due(sim, &pose, ASDIC_LEARN_BLOCK));
    assert_false(asdic_simulator_learn_is_due(sim, &pose, 1)); /* whoever does not learn need not */
    assert_ok(t.ctx, asdic_simulator_learn(sim, &pose, 0));
    pose.yaw_rad = 2.0;
    pose.position_m = (asdic_vec3){50.0, -20.0, 7.49};
    assert_false(asdic_simulator_learn_is_due(sim, &pose, 1));
    pose.position_m.z = 7.51; /* a tenth of the 5 m to the bottom */
    assert_true(asdic_simulator_learn_is_due(sim, &pose, 1));
    pose.position_m.z = 6.49;
    assert_true(asdic_simulator_learn_is_due(sim, &pose, 1));
    pose.position_m.z = 7.0; /* beams are a fifth of a radian high */
    pose.roll_rad = 0.0159;
    assert_false(asdic_simulator_learn_is_due(sim, &pose, 1));
    pose.roll_rad = 0.0163;
    assert_true(asdic_simulator_learn_is_due(sim, &pose, 1));
    pose.roll_rad = 0.0;
    pose.pitch_rad = -0.0163;
    assert_true(asdic_simulator_learn_is_due(sim, &pose, 1));
    asdic_simulator_destroy(&sim);
    rig_close(&r);
}

static void add_ping(honesty_rig *r, asdic_simulator *sim, uint64_t index, uint32_t rays,
                     honesty_sum *sums) {
    asdic_ping *truth = truth_of(r, rays), *ping = new_ping(r);
    assert_ok(t.ctx, asdic_simulator_ping(sim, &r->pose, index, ping));
    add_ratios(r, ping, truth, add_far, sums);
    asdic_ping_destroy(&ping);
    asdic_ping_destroy(&truth);
}

enum { CLIMB_PINGS = 24 };

/* How often a vehicle learns that rises by STEP_M a ping from FROM_M; adds every fourth of its pings to SUMS, unless NULL. */
static size_t lessons_of_climb(honesty_rig *r, asdic_refraction refraction, uint32_t rays,
                               double from_m, double step_m, honesty_sum *sums) {
    asdic_mission_refract(r->mission, refraction);
    asdic_simulator *sim = rig_simulator(r, rays);
    size_t lessons = 0;
    for (uint64_t k = 0; k < CLIMB_PINGS; k++) {
        r->pose.position_m.z = from_m - step_m * (double)k;
        lessons += learn_where_due(sim, &r->pose, k);
        if (sums && k % 4 == 0) {
            add_ping(r, sim, k, rays, sums);
        }
    }
    asdic_simulator_destroy(&sim);
    return lessons;
}

/* A climb from below a channel's axis, at 8 m, to above it: rays that stay in the channel and reach the bottom far out leave
 * the vehicle at elevations at which none did before. Straight rays leave as they did. */
static void a_climb_through_layers_learns_anew(void **state) {
    (void)state;
    enum { RAYS = 4000 };
    honesty_rig r = rig_of_text(
        "{version: 1, environment: {sound_speed_profile: [[0, 1510], [8, 1490], [20, 1500]]}, "
        "bottom: {depth_m: 20, type: rock}, sonar: {frequency_khz: 100, ping_rate_hz: 1, "
        "max_range_m: 120, source_level_db: 190, receivers: [{name: ahead, length_h_m: 0.06, "
        "length_v_m: 0.06}, {name: down, pitch_deg: -10, length_h_m: 0.06, length_v_m: 0.06}]}, "
        "mission: {pose: {position_m: [0, 0, 9.5]}}}");
    honesty_sum sums[2] = {{0}};
    size_t bent = lessons_of_climb(&r, ASDIC_REFRACTION_FULL, RAYS, 9.5, 0.1, sums);
    size_t straight = lessons_of_climb(&r, ASDIC_REFRACTION_OFF, RAYS, 9.5, 0.1, NULL);
    double ratio = rms_of(sums[0]);
    print_message("a climb through layers learns %zu times, with straight rays %zu: true over "
                  "stated %.2f\n",
                  bent, straight, ratio);
    assert_true(ratio > 0.7 && ratio < 1.3);
    assert_true(bent < CLIMB_PINGS && straight == 1);
    rig_close(&r);
}

/* What ends above the surface, below the bottom or out of range is met by no ray. */
static void layers_out_of_reach_bend_nothing(void **state) {
    (void)state;
    static const char *const profiles[] = {"[0, 1500], [20.5, 1500], [30, 1450]",
                                           "[0, 1500], [60, 1512], [70, 1512]"};
    static const double bottom_m[] = {20.0, 400.0};
    for (size_t i = 0; i < 2; i++) {
        char text[640];
        snprintf(text, sizeof text,
                 "{version: 1, environment: {sound_speed_profile: [%s]}, bottom: {depth_m: %g, "
                 "type: sand}, sonar: {frequency_khz: 100, ping_rate_hz: 1, max_range_m: 40, "
                 "source_level_db: 190, receivers: [{name: ahead, length_h_m: 0.06, length_v_m: "
                 "0.06}]}, mission: {pose: {position_m: [0, 0, 15]}}}",
                 profiles[i], bottom_m[i]);
        honesty_rig r = rig_of_text(text);
        size_t bent = lessons_of_climb(&r, ASDIC_REFRACTION_FULL, 256, 15.0, 0.2, NULL);
        assert_int_equal(bent, lessons_of_climb(&r, ASDIC_REFRACTION_OFF, 256, 15.0, 0.2, NULL));
        rig_close(&r);
    }
}

/* Past a quay it brings other parts of it into a narrow beam, as the head of a scanning sonar does. */
static void a_turn_past_objects_learns_anew(void **state) {
    (void)state;
    enum { PINGS = 24, EVERY = 6, RAYS = 4096 };
    honesty_rig r = rig_of_text(
        "{version: 1, environment: {temperature_degc: 11, salinity_ppt: 33, wind_speed_kn: 4}, "
        "bottom: {depth_m: 8.2, type: sand}, objects: [{name: quay, box: {size_m: [1, 60, 8.2]}, "
        "position_m: [13.3, 4, 4.1], material: concrete}], sonar: {frequency_khz: 300, "
        "bandwidth_khz: 30, ping_rate_hz: 10, source_level_db: 204, bin_length_m: 0.1, "
        "max_range_m: 25, transmitter: {length_h_m: 0.1, length_v_m: 0.01}, receivers: [{name: "
        "head, length_h_m: 0.1, length_v_m: 0.01}]}, mission: {pose: {position_m: [0, 0, 3.7], "
        "yaw_deg: -66}}}");
    asdic_simulator *sim = rig_simulator(&r, RAYS);
    honesty_sum sums[2] = {{0}};
    double start_rad = r.pose.yaw_rad;
    for (uint64_t k = 0; k < PINGS; k++) {
        r.pose.yaw_rad = start_rad + 1.5 * DEGREE * (double)k;
        learn_where_due(sim, &r.pose, k);
        if (k % EVERY == EVERY - 1) {
            add_ping(&r, sim, k, RAYS, sums);
        }
    }
    double ratio = rms_of(sums[0]);
    print_message("a turn past a quay: true over stated %.2f\n", ratio);
    assert_true(ratio > 0.7 && ratio < 1.3);
    asdic_simulator_destroy(&sim);
    rig_close(&r);
}

/* Over terrain, half the way to the bottom with many beams, one and a half times it with few. */
static void a_way_over_terrain_learns_anew(void **state) {
    (void)state;
    static const struct {
        size_t beams;
        double ways;
    } cases[] = {{20, 0.5}, {3, 1.5}};
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        const honesty_case c = {.scene = "mission_fan", .beams = cases[k].beams};
        honesty_rig r = rig_open(&c);
        asdic_simulator *sim = rig_simulator(&r, 2000);
        asdic_pose pose = r.pose;
        double way_m =
            cases[k].ways * asdic_scene_altitude_m(asdic_mission_scene(r.mission), pose.position_m);
        assert_ok(t.ctx, asdic_simulator_learn(sim, &pose, 0));
        pose.position_m.x = r.pose.position_m.x + 0.99 * way_m * 0.6;
        pose.position_m.y = r.pose.position_m.y - 0.99 * way_m * 0.8;
        assert_false(asdic_simulator_learn_is_due(sim, &pose, 1));
        pose.position_m.y = r.pose.position_m.y - 1.01 * way_m * 0.81;
        assert_true(asdic_simulator_learn_is_due(sim, &pose, 1));
        asdic_simulator_destroy(&sim);
        rig_close(&r);
    }
}

/* Objects in open water. The vehicle has come nearer since it learnt, or one of them to it: an echo that few rays make
 * is in bins that held water then. */
static const char objects_text[] =
    "version: 1\n"
    "environment: {wind_speed_kn: 5}\n"
    "bottom: {none: true}\n"
    "objects:\n"
    "  - {name: buoy, sphere: {radius_m: 0.5}, position_m: [25, 3, 9]}\n"
    "  - {name: crate, box: {size_m: [1, 2, 3]}, position_m: [30, -8, 10.5], rotation_deg: [0, 0, "
    "25]}\n"
    "  - {name: pipe, cylinder: {radius_m: 0.3, length_m: 12}, position_m: [40, 0, 12], "
    "rotation_deg: [0, 0, "
    "80]}\n"
    "  - {name: diver, box: {size_m: [0.5, 1, 2]}, track: " DATA_DIR "/tracks/fish.csv}\n"
    "sonar:\n"
    "  frequency_khz: 300\n"
    "  bandwidth_khz: 15\n"
    "  max_range_m: 60\n"
    "  bin_length_m: 0.2\n"
    "  transmitter: {length_h_m: 0.003, length_v_m: 0.02}\n"
    "  receivers: {fan: {count: %zu, sector_deg: 90, length_h_m: %g, length_v_m: 0.02}}\n"
    "mission: {pose: {position_m: [0, 0, 10]}, pings: 1}\n"
    "model: {terms: all}\n";

static void objects_that_came_nearer(void **state) {
    (void)state;
    static const struct {
        size_t beams;
        double length_m, ahead_m, moved_m;
        int blocks;
    } cases[] = {{8, 0.03, 4.0, 0.0, 12},
                 {8, 0.03, 0.0, 6.0, 12},
                 {64, 0.1, 4.0, 0.0, 3},
                 {64, 0.1, 0.0, 6.0, 3}};
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        char text[sizeof objects_text + 64];
        snprintf(text, sizeof text, objects_text, cases[k].beams, cases[k].length_m);
        honesty_rig r = rig_of_text(text);
        honesty_sum sums[2] = {{0}};
        r.pose.position_m.x += cases[k].ahead_m;
        r.mover = "diver";
        r.mover_learnt_at.position_m = r.mover_at.position_m = (asdic_vec3){28.0, 0.0, 10.0};
        r.mover_at.position_m.x -= cases[k].moved_m;
        add_errors(&r, 40000, cases[k].blocks, add_far, sums);
        print_message(
            "objects before %2zu beams, %g m on, one %g m nearer: true over stated %.2f\n",
            cases[k].beams, cases[k].ahead_m, cases[k].moved_m, rms_of(sums[0]));
        assert_true(rms_of(sums[0]) > 0.5 && rms_of(sums[0]) < 1.4);
        rig_close(&r);
    }
}

int main(void) {
    t = test_device_open_or_skip();
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(objects_elsewhere),
        cmocka_unit_test(a_dive_learns_anew),
        cmocka_unit_test(a_level_turn_does_not),
        cmocka_unit_test(a_climb_through_layers_learns_anew),
        cmocka_unit_test(layers_out_of_reach_bend_nothing),
        cmocka_unit_test(a_turn_past_objects_learns_anew),
        cmocka_unit_test(a_way_over_terrain_learns_anew),
        cmocka_unit_test(objects_that_came_nearer),
    };
    return test_device_end(&t, cmocka_run_group_tests(tests, NULL, NULL));
}
