/* Receivers that hear less on their axis hear every echo less by as much, be it of rays or of points, in single beams
 * and in fans, simulated or expected; the noise, the stated error and the truth stay as they are. */
#include "ping_rig.h"

#define MOST_BEAMS 20

static test_device device;

static asdic_ping *shoot(ping_rig *r, const asdic_beam *receivers, size_t count) {
    asdic_context *ctx = device.ctx;
    asdic_simulator *sim = NULL;
    asdic_ping *ping = NULL;
    r->sonar.receivers = receivers;
    r->sonar.receiver_count = count;
    assert_ok(ctx, asdic_simulator_create(ctx, device.device, r->scene, &r->env, &r->sonar,
                                          &r->sampling, 7.0, &sim));
    assert_ok(ctx, asdic_ping_create(ctx, count, asdic_simulator_bin_count(sim), &ping));
    assert_ok(ctx, asdic_ping_add_truth(ctx, ping));
    assert_ok(ctx, asdic_simulator_learn(sim, &r->pose, 0));
    assert_ok(ctx, asdic_simulator_ping(sim, &r->pose, 0, ping));
    asdic_simulator_destroy(&sim);
    return ping;
}

static asdic_ping *expect(ping_rig *r, const asdic_ping *like) {
    asdic_flat_scene flat = rig_flat(r);
    asdic_ping *ping = NULL;
    assert_ok(device.ctx, asdic_ping_create(device.ctx, like->beams, like->bins, &ping));
    assert_ok(device.ctx,
              asdic_expected_compute(device.ctx, &flat, &r->env, &r->sonar, &r->pose, ping));
    return ping;
}

static void assert_less(const asdic_beam *receivers, const asdic_ping *ping,
                        const asdic_ping *all) {
    for (size_t i = 0; i < ping->beams * ping->bins; i++) {
        double gain = pow(10.0, 0.1 * receivers[i / ping->bins].sensitivity_db);
        for (int c = ASDIC_TOTAL + 1; c < ASDIC_COMPONENT_COUNT; c++) {
            double to = all->intensity_lin[c][i] * (c == ASDIC_NOISE ? 1.0 : gain);
            assert_close(ping->intensity_lin[c][i], to, 1e-9 * to);
        }
    }
}

static void echoes_are_less_and_noise_is_not(void **state) {
    (void)state;
    static const size_t counts[] = {3, MOST_BEAMS};
    for (size_t k = 0; k < 2; k++) {
        ping_rig r = rig_create(&device);
        asdic_beam receivers[MOST_BEAMS];
        size_t heard = 0;
        for (size_t b = 0; b < counts[k]; b++) {
            receivers[b] = r.receivers[0];
            receivers[b].yaw_rad = ((double)b - 0.5 * (double)counts[k]) * RIG_DEGREE;
        }
        assert_ok(device.ctx,
                  asdic_scene_add_point(r.scene, "ball", (asdic_vec3){20.0, 0.0, 7.0}, 10.0));
        assert_ok(device.ctx, asdic_scene_commit(r.scene));
        r.sampling.rays = 5000;
        r.sampling.truth = true;
        asdic_ping *all = shoot(&r, receivers, counts[k]), *all_expected = expect(&r, all);
        for (size_t b = 0; b < counts[k]; b++) {
            receivers[b].sensitivity_db = -3.0 * (double)b;
        }
        asdic_ping *ping = shoot(&r, receivers, counts[k]), *expected = expect(&r, all);
        assert_less(receivers, ping, all);
        assert_less(receivers, expected, all_expected);
        for (size_t i = 0; i < ping->beams * ping->bins; i++) {
            heard += ping->truth->object[i] > 0;
            assert_close(ping->stderr_db[i], all->stderr_db[i], 1e-4);
            assert_int_equal(ping->truth->object[i], all->truth->object[i]);
            assert_close(ping->truth->object_share[i], all->truth->object_share[i], 1e-6);
            float down = ping->truth->depression_rad[i], then = all->truth->depression_rad[i];
            assert_true(isnan(down) ? isnan(then) : fabsf(down - then) < 1e-5f);
        }
        assert_int_equal(heard, counts[k]);
        asdic_ping_destroy(&all);
        asdic_ping_destroy(&ping);
        asdic_ping_destroy(&all_expected);
        asdic_ping_destroy(&expected);
        rig_destroy(&r);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(echoes_are_less_and_noise_is_not)};
    device = test_device_open_or_skip();
    return test_device_end(&device, cmocka_run_group_tests(tests, NULL, NULL));
}
