/* The loop: the simulator's bytes, one ping at a time. */
#include "ping_rig.h"

#include "mission/track/track.h"

static test_device t;

static asdic_loop *make_loop(ping_rig *r) {
    asdic_loop *loop = NULL;
    r->sonar.receivers = r->receivers;
    assert_ok(t.ctx, asdic_scene_commit(r->scene));
    assert_ok(t.ctx, asdic_loop_create(t.ctx, t.device, r->scene, &r->env, &r->sonar, &r->sampling,
                                       r->pose.position_m.z, &loop));
    return loop;
}

static asdic_pose pose_of(const ping_rig *r, uint64_t k) {
    asdic_pose pose = r->pose;
    pose.position_m.x += 0.2 * (double)k;
    pose.position_m.z += 0.01 * (double)k;
    pose.yaw_rad = asdic_track_round(0.01 * (double)k);
    return pose;
}

static void pings_are_the_simulators(void **state) {
    (void)state;
    ping_rig r = rig_create(&t);
    r.sampling.rays = 1024;
    r.sonar.noise_enabled = true;
    r.sonar.speckle = ASDIC_SPECKLE_RAYLEIGH;
    asdic_loop *loop = make_loop(&r);
    asdic_simulator *sim = rig_simulator(&r);
    asdic_ping *ping = NULL;
    asdic_loop_ping previous = {0};
    assert_ok(t.ctx, asdic_ping_create(t.ctx, RIG_BEAMS, asdic_loop_bin_count(loop), &ping));
    for (uint64_t k = 0; k < ASDIC_LEARN_BLOCK + 2; k++) {
        asdic_pose pose = pose_of(&r, k);
        asdic_loop_ping got;
        assert_ok(t.ctx, asdic_loop_submit(loop, &pose));
        if (k > 0) { /* what was collected may be read while the next ping is made */
            assert_int_equal(previous.ping, k - 1);
            assert_true(rig_same(previous.parts, ping));
        }
        if (k % ASDIC_LEARN_BLOCK == 0) {
            assert_ok(t.ctx, asdic_loop_collect(loop, &got)); /* the device is ours again */
            assert_ok(t.ctx, asdic_simulator_learn(sim, &pose, k));
        } else {
            assert_ok(t.ctx, asdic_loop_collect(loop, &got));
        }
        assert_ok(t.ctx, asdic_simulator_ping(sim, &pose, k, ping));
        assert_int_equal(got.ping, k);
        assert_close(got.time_s, 0.1 * (double)k, 1e-9);
        assert_close(got.altitude_m, 12.0 - pose.position_m.z, 1e-12);
        assert_true(got.latency_s > 0.0 && got.latency_s < 100.0);
        assert_memory_equal(&got.pose, &pose, sizeof pose);
        assert_true(rig_same(got.parts, ping));
        for (size_t i = 0; i < ping->beams * ping->bins; i++) {
            double level_db = asdic_level_db(ping->intensity_lin[ASDIC_TOTAL][i]);
            assert_true(got.level_db[i] == (float)level_db);
        }
        previous = got;
    }
    asdic_ping_destroy(&ping);
    asdic_simulator_destroy(&sim);
    asdic_loop_destroy(&loop);
    rig_destroy(&r);
}

static void misuse_is_refused(void **state) {
    (void)state;
    ping_rig r = rig_create(&t);
    r.sampling.rays = 1024;
    asdic_loop *loop = make_loop(&r);
    asdic_loop_ping got;
    asdic_pose bad = r.pose;
    assert_int_equal(asdic_loop_collect(loop, &got), ASDIC_ERROR_ARGUMENT);
    bad.position_m.z = -0.1;
    assert_int_equal(asdic_loop_submit(loop, &bad), ASDIC_ERROR_ARGUMENT);
    bad.position_m.z = NAN;
    assert_int_equal(asdic_loop_submit(loop, &bad), ASDIC_ERROR_ARGUMENT);
    assert_false(asdic_loop_ready(loop));
    assert_ok(t.ctx, asdic_loop_submit(loop, &r.pose));
    assert_int_equal(asdic_loop_submit(loop, &r.pose), ASDIC_ERROR_ARGUMENT);
    assert_ok(t.ctx, asdic_loop_collect(loop, &got));
    assert_int_equal(got.ping, 0); /* what was refused is not counted */
    assert_int_equal(asdic_loop_collect(loop, &got), ASDIC_ERROR_ARGUMENT);
    assert_ok(t.ctx, asdic_loop_submit(loop, &r.pose));
    while (!asdic_loop_ready(loop)) {
    }
    assert_ok(t.ctx, asdic_loop_submit(loop, &r.pose) ? ASDIC_OK : ASDIC_ERROR_ARGUMENT);
    asdic_loop_destroy(&loop); /* with a ping that nobody collects */
    asdic_loop_destroy(&loop);
    rig_destroy(&r);
}

int main(void) {
    t = test_device_open_or_skip();
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(pings_are_the_simulators),
        cmocka_unit_test(misuse_is_refused),
    };
    return test_device_end(&t, cmocka_run_group_tests(tests, NULL, NULL));
}
