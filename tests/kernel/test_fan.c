/* Many receivers through one map against every receiver by itself, on the same rays; and where no map
 * will do, against the quadrature. */
#include "ping_rig.h"

static test_device t;

enum { BEAMS = 64 };

static asdic_beam beams[BEAMS];

/* 40 wavelengths wide over +-45 degrees, and a steel ball. */
static ping_rig fan_rig(void) {
    ping_rig r = rig_create(&t);
    r.sonar.frequency_hz = 450e3;
    double wavelength_m = 1490.1 / 450e3;
    r.sonar.transmitter.length_h_m = wavelength_m;
    r.sonar.transmitter.length_v_m = 5.0 * wavelength_m;
    for (int b = 0; b < BEAMS; b++) {
        beams[b] = r.sonar.transmitter;
        beams[b].length_h_m = 40.0 * wavelength_m;
        beams[b].yaw_rad = (-45.0 + 90.0 * b / (BEAMS - 1)) * RIG_DEGREE;
    }
    asdic_mesh *mesh = NULL;
    assert_ok(t.ctx, asdic_mesh_sphere(t.ctx, 0.5, 24, &mesh));
    asdic_pose pose = {.position_m = {25.0, 8.0, 9.0}};
    asdic_material steel = asdic_material_facet(45.0, 1e-3, 0.2);
    assert_ok(t.ctx, asdic_scene_add_object(r.scene, "ball", mesh, pose, steel));
    asdic_mesh_destroy(&mesh);
    assert_ok(t.ctx, asdic_scene_commit(r.scene));
    r.sampling.rays = 200000; /* the map also smooths: leave little to smooth */
    return r;
}

static asdic_ping *shoot(ping_rig *r) {
    asdic_simulator *sim = NULL;
    r->sonar.receivers = beams;
    r->sonar.receiver_count = BEAMS;
    assert_ok(t.ctx, asdic_simulator_create_with(t.ctx, t.device, r->scene, &r->env, &r->sonar,
                                                 &r->sampling, 7.0, &r->layout, &sim));
    asdic_ping *ping = NULL;
    assert_ok(t.ctx, asdic_ping_create(t.ctx, BEAMS, asdic_simulator_bin_count(sim), &ping));
    assert_ok(t.ctx, asdic_simulator_ping(sim, &r->pose, 1, ping));
    assert_int_equal(ping->saturated, 0);
    asdic_simulator_destroy(&sim);
    return ping;
}

/* RMS and largest difference in dB over bins from 2 m and beams, of bins within 60 dB of the
 * component's loudest. */
static void compare(const asdic_ping *a, const asdic_ping *b, asdic_component c, double *rms,
                    double *most) {
    double loudest = 0.0, sum = 0.0, count = 0.0;
    for (size_t i = 0; i < a->beams * a->bins; i++) {
        loudest = fmax(loudest, a->intensity_lin[c][i]);
    }
    *most = 0.0;
    for (size_t i = 0; i < a->beams * a->bins; i++) {
        double x = a->intensity_lin[c][i], y = b->intensity_lin[c][i];
        if (i % a->bins >= 4 && x > 1e-6 * loudest) {
            double d = fabs(asdic_level_db(y) - asdic_level_db(x));
            sum += d * d;
            count += 1.0;
            *most = fmax(*most, d);
        }
    }
    *rms = sqrt(sum / count);
}

static void map_meets_every_beam(double pitch_deg, double roll_deg) {
    ping_rig r = fan_rig();
    r.pose.pitch_rad = pitch_deg * RIG_DEGREE;
    r.pose.roll_rad = roll_deg * RIG_DEGREE;
    asdic_ping *map = shoot(&r);
    r.layout.beam_by_beam = true;
    asdic_ping *each = shoot(&r);
    static const struct {
        asdic_component component;
        const char *name;
        double rms_db, most_db;
    } rows[] = {{ASDIC_TOTAL, "total", 0.1, 1.6},
                {ASDIC_BOTTOM, "bottom", 0.1, 0.8},
                {ASDIC_VOLUME, "volume", 0.01, 0.05}};
    for (size_t k = 0; k < sizeof rows / sizeof *rows; k++) {
        double rms, most;
        compare(each, map, rows[k].component, &rms, &most);
        print_message("pitch %g roll %g %s: RMS %.4f dB, most %.3f dB\n", pitch_deg, roll_deg,
                      rows[k].name, rms, most);
        assert_true(rms < rows[k].rms_db && most < rows[k].most_db);
    }
    /* The ball, in the beam that looks at it. */
    size_t best = 0;
    for (size_t i = 0; i < each->beams * each->bins; i++) {
        if (each->intensity_lin[ASDIC_OBJECT][i] > each->intensity_lin[ASDIC_OBJECT][best]) {
            best = i;
        }
    }
    double d = asdic_level_db(map->intensity_lin[ASDIC_OBJECT][best]) -
               asdic_level_db(each->intensity_lin[ASDIC_OBJECT][best]);
    print_message("ball in beam %zu: %.4f dB off\n", best / each->bins, d);
    assert_true(fabs(d) < 0.04);
    asdic_ping_destroy(&map);
    asdic_ping_destroy(&each);
    rig_destroy(&r);
}

static void level_fan(void **state) {
    (void)state;
    map_meets_every_beam(0.0, 0.0);
}

static void tilted_fan(void **state) {
    (void)state;
    map_meets_every_beam(-15.0, 10.0);
}

/* Receivers as wide as the transmitter, all on one aim or side by side: none lies between them, what
 * comes in is not even over a receiver's width, and near bins are steep. */
static void wide_receivers_are_no_map(void **state) {
    (void)state;
    enum { COUNT = 16 };
    static const struct {
        double sector_deg, pitch_deg, most_db;
    } cases[] = {{0.0, 0.0, 0.1}, {0.0, 20.0, 0.1}, {30.0, 0.0, 0.4}};
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        ping_rig r = rig_create(&t);
        asdic_beam many[COUNT];
        for (int b = 0; b < COUNT; b++) {
            many[b] = r.sonar.transmitter;
            many[b].pitch_rad = cases[k].pitch_deg * RIG_DEGREE;
            many[b].yaw_rad = cases[k].sector_deg * ((double)b / (COUNT - 1) - 0.5) * RIG_DEGREE;
        }
        r.sonar.receivers = many;
        r.sonar.receiver_count = COUNT;
        assert_ok(t.ctx, asdic_scene_commit(r.scene));
        asdic_simulator *sim = NULL;
        assert_ok(t.ctx, asdic_simulator_create(t.ctx, t.device, r.scene, &r.env, &r.sonar,
                                                &r.sampling, 7.0, &sim));
        size_t bins = asdic_simulator_bin_count(sim);
        asdic_ping *ping = NULL, *truth = NULL;
        assert_ok(t.ctx, asdic_ping_create(t.ctx, COUNT, bins, &ping));
        assert_ok(t.ctx, asdic_ping_create(t.ctx, COUNT, bins, &truth));
        assert_ok(t.ctx, asdic_simulator_learn(sim, &r.pose, 0));
        assert_ok(t.ctx, asdic_simulator_ping(sim, &r.pose, 0, ping));
        asdic_flat_scene flat = {true, true, 5.0, 7.0, 2.0};
        assert_ok(t.ctx, asdic_expected_compute(t.ctx, &flat, &r.env, &r.sonar, &r.pose, truth));
        double rms, most;
        compare(truth, ping, ASDIC_TOTAL, &rms, &most);
        print_message("%g degrees, pitch %g: RMS %.4f dB, most %.3f dB\n", cases[k].sector_deg,
                      cases[k].pitch_deg, rms, most);
        assert_true(most < cases[k].most_db);
        asdic_ping_destroy(&truth);
        asdic_ping_destroy(&ping);
        asdic_simulator_destroy(&sim);
        rig_destroy(&r);
    }
}

static void layout_never_changes_a_byte(void **state) {
    (void)state;
    ping_rig r = fan_rig();
    asdic_ping *plain = shoot(&r);
    r.layout.local = 8;
    r.layout.batch_slots = 16384;
    asdic_ping *other = shoot(&r);
    assert_true(rig_same(plain, other));
    asdic_ping_destroy(&plain);
    asdic_ping_destroy(&other);
    rig_destroy(&r);
}

int main(void) {
    t = test_device_open_or_skip();
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(level_fan),
        cmocka_unit_test(tilted_fan),
        cmocka_unit_test(wide_receivers_are_no_map),
        cmocka_unit_test(layout_never_changes_a_byte),
    };
    int failed = cmocka_run_group_tests(tests, NULL, NULL);
    test_device_close(&t);
    return failed;
}
