/*
 * What the sampler was not tuned on: tilted vehicles, wrong altitudes, other apertures. Against the
 * quadrature.
 */
#include "ping_rig.h"

static test_device t;

/* The flat benchmark scene with an aperture of H x V wavelengths. */
static ping_rig narrow_rig(double h_wl, double v_wl) {
    ping_rig r = rig_create(&t);
    double wavelength_m = 1490.1 / 450e3;
    r.sonar.frequency_hz = 450e3;
    r.sonar.receiver_count = 1;
    r.sonar.transmitter.length_h_m = r.receivers[0].length_h_m = h_wl * wavelength_m;
    r.sonar.transmitter.length_v_m = r.receivers[0].length_v_m = v_wl * wavelength_m;
    return r;
}

/* RMS over bins from 2 m and pings of the error, dB. ALTITUDE: what the sampler is told, of the true
 * one; 0: it finds out by itself. */
static double rms_db(ping_rig *r, double altitude, int pings) {
    asdic_simulator *sim = rig_simulator(r);
    size_t bins = asdic_simulator_bin_count(sim);
    asdic_ping *ping = NULL, *truth = NULL;
    assert_ok(t.ctx, asdic_ping_create(t.ctx, 1, bins, &ping));
    assert_ok(t.ctx, asdic_ping_create(t.ctx, 1, bins, &truth));
    asdic_flat_scene flat = {.has_surface = true,
                             .has_bottom = true,
                             .altitude_m = 5.0,
                             .depth_m = 7.0,
                             .bottom = asdic_material_bottom(2.0)};
    assert_ok(t.ctx, asdic_expected_compute(t.ctx, &flat, &r->env, &r->sonar, &r->pose, truth));
    double sum = 0.0, count = 0.0;
    if (altitude > 0.0) {
        sim->learnt.zone_altitude = altitude * ASDIC_ZONE_ALTITUDE;
    }
    for (int k = 0; k < pings; k++) {
        if (altitude <= 0.0 && k % 4 == 0) {
            assert_ok(t.ctx, asdic_simulator_learn(sim, &r->pose, (uint64_t)k));
        }
        assert_ok(t.ctx, asdic_simulator_ping(sim, &r->pose, (uint64_t)k, ping));
        for (size_t n = (size_t)(2.0 / r->sonar.bin_length_m); n < bins; n++) {
            double off = asdic_level_db(ping->intensity_lin[ASDIC_TOTAL][n]) -
                         asdic_level_db(truth->intensity_lin[ASDIC_TOTAL][n]);
            sum += off * off;
            count += 1.0;
        }
    }
    asdic_ping_destroy(&truth);
    asdic_ping_destroy(&ping);
    asdic_simulator_destroy(&sim);
    return sqrt(sum / count);
}

static void errors_stay_small(void **state) {
    (void)state;
    static const struct {
        const char *name;
        double h_wl, v_wl, pitch_deg, altitude;
    } cases[] = {
        {"as tuned", 10.0, 5.0, 0.0, 0.0},         {"pitch +10", 10.0, 5.0, 10.0, 0.0},
        {"pitch -10", 10.0, 5.0, -10.0, 0.0},      {"altitude -10 %", 10.0, 5.0, 0.0, 0.9},
        {"altitude +10 %", 10.0, 5.0, 0.0, 1.1},   {"40 x 2 wavelengths", 40.0, 2.0, 0.0, 0.0},
        {"4 x 4 wavelengths", 4.0, 4.0, 0.0, 0.0},
    };
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        ping_rig r = narrow_rig(cases[k].h_wl, cases[k].v_wl);
        r.sampling.rays = 4096;
        r.pose.pitch_rad = cases[k].pitch_deg * RIG_DEGREE;
        double error_db = rms_db(&r, cases[k].altitude, 16);
        print_message("%-20s RMS %.4f dB at 4096 rays\n", cases[k].name, error_db);
        assert_true(error_db < 0.2);
        rig_destroy(&r);
    }
}

int main(void) {
    t = test_device_open_or_skip();
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(errors_stay_small),
    };
    int failed = cmocka_run_group_tests(tests, NULL, NULL);
    test_device_close(&t);
    return failed;
}
