/* The paper's first scenario, simulated with speckle: a detector against the expected levels has the
 * false-alarm rate that it was designed for, within binomial bounds of 99 % over a million bins. */
#include "ping_rig.h"

#define BINS_WANTED 1000000u

static test_device device;

typedef struct tally {
    double pfa;
    uint64_t events;
} tally;

static void simulate(const char *name, asdic_speckle speckle, double shape, double bandwidth_hz,
                     unsigned looks) {
    asdic_context *ctx = device.ctx;
    ping_rig r = rig_create(&device);
    asdic_simulator *sim = NULL;
    asdic_ping *ping = NULL, *expected = NULL;
    asdic_flat_scene flat = rig_flat(&r);
    tally tallies[4] = {{1e-2, 0}, {1e-3, 0}, {1e-4, 0}, {1e-5, 0}};
    uint64_t bins = 0;
    r.sonar.receivers = r.receivers;
    r.sonar.receiver_count = 1;
    r.sonar.speckle = speckle;
    r.sonar.speckle_shape = shape;
    r.sonar.bandwidth_hz = bandwidth_hz;
    r.sonar.bin_length_m = 0.075;
    r.sampling.rays = looks == 1 ? 8192 : 16384; /* of several looks thresholds are nearer */
    assert_ok(ctx, asdic_scene_commit(r.scene));
    assert_ok(ctx, asdic_simulator_create(ctx, device.device, r.scene, &r.env, &r.sonar,
                                          &r.sampling, 7.0, &sim));
    size_t count = asdic_simulator_bin_count(sim);
    assert_ok(ctx, asdic_ping_create(ctx, 1, count, &ping));
    assert_ok(ctx, asdic_ping_create(ctx, 1, count, &expected));
    assert_ok(ctx, asdic_expected_compute(ctx, &flat, &r.env, &r.sonar, &r.pose, expected));
    double c = asdic_environment_sound_speed_mps(&r.env, 7.0);
    assert_int_equal(asdic_sonar_looks(&r.sonar, c), looks);
    double factor[4];
    for (int k = 0; k < 4; k++) {
        asdic_background unit = asdic_background_of(&r.sonar, c, 1.0, 0.0);
        assert_ok(ctx, asdic_detect_threshold(ctx, &unit, tallies[k].pfa, &factor[k]));
    }
    for (uint64_t index = 0; bins < BINS_WANTED; index++) {
        if (index % ASDIC_LEARN_BLOCK == 0) {
            assert_ok(ctx, asdic_simulator_learn(sim, &r.pose, index));
        }
        assert_ok(ctx, asdic_simulator_ping(sim, &r.pose, index, ping));
        for (size_t i = 0; i < count; i++) {
            double mean = expected->intensity_lin[ASDIC_TOTAL][i];
            bins += mean > 0.0;
            for (int k = 0; k < 4 && mean > 0.0; k++) {
                tallies[k].events += ping->intensity_lin[ASDIC_TOTAL][i] > factor[k] * mean;
            }
        }
    }
    for (int k = 0; k < 4; k++) {
        asdic_estimate e = asdic_estimate_of(tallies[k].events, bins);
        print_message("%-9s %u look%s  P_FA %.0e: %.3e [%.3e, %.3e] in %llu bins\n", name, looks,
                      looks == 1 ? " " : "s", tallies[k].pfa, e.value, e.low, e.high,
                      (unsigned long long)bins);
        assert_true(tallies[k].pfa >= e.low && tallies[k].pfa <= e.high);
    }
    asdic_ping_destroy(&expected);
    asdic_ping_destroy(&ping);
    asdic_simulator_destroy(&sim);
    rig_destroy(&r);
}

static void rayleigh_of_one_look(void **state) {
    (void)state;
    simulate("rayleigh", ASDIC_SPECKLE_RAYLEIGH, NAN, 10e3, 1);
}

static void rayleigh_of_several_looks(void **state) {
    (void)state;
    simulate("rayleigh", ASDIC_SPECKLE_RAYLEIGH, NAN, 70e3, 7);
}

static void k_of_one_look(void **state) {
    (void)state;
    simulate("k 1.5", ASDIC_SPECKLE_K, 1.5, 10e3, 1);
}

static void k_of_several_looks(void **state) {
    (void)state;
    simulate("k 1.5", ASDIC_SPECKLE_K, 1.5, 70e3, 7);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(rayleigh_of_one_look),
        cmocka_unit_test(rayleigh_of_several_looks),
        cmocka_unit_test(k_of_one_look),
        cmocka_unit_test(k_of_several_looks),
    };
    device = test_device_open_or_skip();
    return test_device_end(&device, cmocka_run_group_tests(tests, NULL, NULL));
}
