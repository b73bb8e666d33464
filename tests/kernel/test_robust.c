/*
 * What the sampler was not tuned on: tilted vehicles, wrong altitudes, other apertures. Against the
 * quadrature.
 */
#include "dice.h"
#include "ping_rig.h"

static test_device t;
enum { MANY = 24 };
static asdic_beam many[MANY];

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
    asdic_flat_scene flat = rig_flat(r);
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

/* Faces much smaller than a wavelength hear all azimuths before them alike: no ray may go beyond their front, where it
 * hears nothing. */
static void rays_stay_before_small_faces(void **state) {
    (void)state;
    ping_rig r = narrow_rig(0.05, 0.05);
    r.sampling.rays = 16384;
    double error_db = rms_db(&r, 0.0, 16);
    print_message("0.05 x 0.05 wavelengths RMS %.5f dB at 16,384 rays\n", error_db);
    assert_true(error_db < 0.006);
    rig_destroy(&r);
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

/* The largest solid angle of R's rays, sr, where every ray in turn is drawn at either end of its lobe's azimuths. */
static float heaviest_at_ends(ping_rig *r, size_t beams) {
    enum { RAYS = 1024, STEP = 8 };
    asdic_simulator *sim = NULL;
    float weights[2 * RAYS], most = 0.0f;
    r->sampling.rays = RAYS;
    r->sonar.receivers = many;
    r->sonar.receiver_count = beams;
    asdic_scene_commit(r->scene); /* a second time it changes nothing */
    assert_ok(t.ctx,
              asdic_simulator_create_with(t.ctx, t.device, r->scene, &r->env, &r->sonar,
                                          &r->sampling, r->pose.position_m.z, &r->layout, &sim));
    assert_ok(t.ctx, asdic_simulator_learn(sim, &r->pose, 0));
    asdic_shot_aim(sim, &sim->shots[0], &r->pose, 0, ASDIC_STREAM_PING, RAYS);
    dev_ping *ping = sim->shots[0].ping;
    size_t slots = (size_t)ping->batch.groups * ping->batch.per_group;
    assert_in_range(slots, RAYS, 2 * RAYS);
    ping->batch.last = 1;
    for (uint32_t ray = 0; ray < RAYS; ray += STEP) {
        for (uint32_t end = 0; end < 2; end++) {
            ping->sampling.lattice_shift = (end ? ~0u : 0u) - ray * 2654435769u; /* as sample.cl */
            assert_ok(t.ctx, asdic_simulator_draw(sim, 1));
            assert_ok(t.ctx, asdic_buffer_read(sim->buffers.solid_angles, 0, slots * sizeof(float),
                                               weights));
            for (size_t i = 0; i < slots; i++) {
                most = fmaxf(most, isnan(weights[i]) ? INFINITY : weights[i]);
            }
        }
    }
    asdic_simulator_destroy(&sim);
    return most;
}

/* A window may go all round, or end behind the faces: a ray at its end has a weight like any other. Of fans, of many
 * beams broad and narrow, of few, with faces that leak and without. */
static void no_ray_weighs_without_end(void **state) {
    (void)state;
    enum { CASES = 12 };
    uint64_t dice = 1;
    float most = 0.0f;
    for (size_t k = 0; k < CASES; k++) {
        ping_rig r = rig_create(&t);
        size_t beams = k % 3 ? MANY : 5;
        r.pose.pitch_rad = 1.4 * random_unit(&dice) - 0.7;
        r.pose.roll_rad = 2.4 * random_unit(&dice) - 1.2;
        r.pose.yaw_rad = 6.0 * random_unit(&dice);
        r.sonar.rear_floor_db = k % 4 ? -INFINITY : -20.0;
        for (size_t b = 0; b < beams; b++) {
            many[b] = r.sonar.transmitter;
            many[b].length_h_m = k % 3 == 1 && b % 2 ? 0.01 : 0.2;
            many[b].yaw_rad = ((double)b + 0.5) / (double)beams - 0.5;
        }
        most = fmaxf(most, heaviest_at_ends(&r, beams));
        rig_destroy(&r);
    }
    print_message("%.3g sr at most\n", (double)most);
    assert_true(most > 0.0f && most < 50.0f);
}

/* Narrow faces that leak, pitched away from the only plane: it is loudest where it lies behind them. The worst of some
 * pings there. */
static void what_leaks_backwards_is_heard(void **state) {
    (void)state;
    enum { PINGS = 8 };
    static const double pitch_deg[] = {20.0, 30.0, 45.0, -20.0, -30.0, -45.0};
    for (size_t k = 0; k < sizeof pitch_deg / sizeof *pitch_deg; k++) {
        bool down = pitch_deg[k] > 0.0;
        ping_rig r = rig_create(&t);
        rig_empty(&r);
        asdic_scene_set_surface(r.scene, down);
        if (!down) {
            assert_ok(t.ctx,
                      asdic_scene_set_bottom_plane(r.scene, 12.0, asdic_material_bottom(2.0)));
        }
        r.pose.position_m.z = 6.0;
        r.env.particle_strength_db = -200.0;
        r.sonar.frequency_hz = 120e3;
        r.sonar.rear_floor_db = -20.0;
        r.sonar.receiver_count = 1;
        r.sonar.transmitter.length_h_m = 0.3;
        r.sonar.transmitter.length_v_m = 0.1;
        r.sonar.transmitter.pitch_rad = pitch_deg[k] * RIG_DEGREE;
        r.receivers[0] = r.sonar.transmitter;
        asdic_simulator *sim = rig_simulator(&r);
        size_t bins = asdic_simulator_bin_count(sim), loudest = 0;
        asdic_ping *ping = NULL, *truth = NULL;
        asdic_flat_scene flat = {.has_surface = down,
                                 .has_bottom = !down,
                                 .altitude_m = 6.0,
                                 .depth_m = 6.0,
                                 .bottom = asdic_material_bottom(2.0)};
        assert_ok(t.ctx, asdic_ping_create(t.ctx, 1, bins, &ping));
        assert_ok(t.ctx, asdic_ping_create(t.ctx, 1, bins, &truth));
        assert_ok(t.ctx, asdic_expected_compute(t.ctx, &flat, &r.env, &r.sonar, &r.pose, truth));
        for (size_t n = 1; n < bins; n++) {
            const double *lin = truth->intensity_lin[ASDIC_TOTAL];
            loudest = lin[n] > lin[loudest] ? n : loudest;
        }
        double most = 0.0, want = asdic_level_db(truth->intensity_lin[ASDIC_TOTAL][loudest]);
        assert_ok(t.ctx, asdic_simulator_learn(sim, &r.pose, 0));
        for (uint64_t p = 0; p < PINGS; p++) {
            assert_ok(t.ctx, asdic_simulator_ping(sim, &r.pose, p, ping));
            double off = asdic_level_db(ping->intensity_lin[ASDIC_TOTAL][loudest]) - want;
            most = fmax(most, fabs(off));
        }
        print_message("pitched %.0f degrees: %.1f dB in bin %zu, %.2f dB off at most\n",
                      pitch_deg[k], want, loudest, most);
        assert_true(most < 1.0);
        asdic_ping_destroy(&ping);
        asdic_ping_destroy(&truth);
        asdic_simulator_destroy(&sim);
        rig_destroy(&r);
    }
}

int main(void) {
    t = test_device_open_or_skip();
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(errors_stay_small),
        cmocka_unit_test(rays_stay_before_small_faces),
        cmocka_unit_test(no_ray_weighs_without_end),
        cmocka_unit_test(what_leaks_backwards_is_heard),
    };
    return test_device_end(&t, cmocka_run_group_tests(tests, NULL, NULL));
}
