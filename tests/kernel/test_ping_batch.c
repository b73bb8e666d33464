/*
 * Pings that go to the device together give the bytes of pings one after the other: for any size of a
 * batch of pings, deposit and sampler, over changing depths, with mirrors, points and speckle.
 */
#include "ping_rig.h"

#define PINGS 11

static test_device t;

static ping_rig rig_with_everything(void) {
    ping_rig r = rig_create(&t);
    asdic_mesh *mesh = NULL;
    assert_ok(t.ctx, asdic_mesh_box(t.ctx, (asdic_vec3){1.0, 1.0, 1.0}, &mesh));
    asdic_pose pose = {.position_m = {20.0, 1.0, 9.0}};
    assert_ok(t.ctx, asdic_scene_add_object(r.scene, "box", mesh, pose,
                                            asdic_material_facet(45.0, 1e-3, 0.1)));
    assert_ok(t.ctx, asdic_scene_add_point(r.scene, "float", (asdic_vec3){30.0, 0.0, 8.0}, -20.0));
    asdic_mesh_destroy(&mesh);
    r.sampling.multipath = ASDIC_MULTIPATH_BOUNDARIES;
    r.sonar.noise_enabled = true;
    r.sonar.speckle = ASDIC_SPECKLE_RAYLEIGH;
    return r;
}

/* PINGS pings from number 5 on, handed over by AT_ONCE. */
static void shoot(ping_rig *r, size_t at_once, asdic_ping **pings, size_t *together_most) {
    asdic_simulator *sim = rig_simulator(r);
    asdic_pose poses[PINGS];
    *together_most = asdic_simulator_ping_batch(sim);
    assert_ok(t.ctx, asdic_simulator_learn(sim, &r->pose, 0));
    for (size_t k = 0; k < PINGS; k++) {
        poses[k] = r->pose;
        poses[k].position_m.x = 0.3 * (double)k;
        poses[k].position_m.z += k > 3 ? 0.1 * (double)k : 0.0;
        poses[k].pitch_rad = 0.01 * (double)k;
        assert_ok(t.ctx, asdic_ping_create(t.ctx, r->sonar.receiver_count,
                                           asdic_simulator_bin_count(sim), &pings[k]));
    }
    for (size_t k = 0; k < PINGS; k += at_once) {
        size_t count = PINGS - k < at_once ? PINGS - k : at_once;
        assert_ok(t.ctx, asdic_simulator_pings(sim, poses + k, 5 + k, count, pings + k));
    }
    asdic_simulator_destroy(&sim);
}

static void compare(ping_rig *r, size_t expected) {
    asdic_ping *single[PINGS], *together[PINGS];
    size_t together_most;
    shoot(r, 1, single, &together_most);
    shoot(r, PINGS, together, &together_most);
    assert_int_equal(together_most, expected);
    for (size_t k = 0; k < PINGS; k++) {
        assert_true(rig_same(single[k], together[k]));
        assert_true(k == 0 || !rig_same(together[0], together[k]));
    }
    for (size_t k = 0; k < PINGS; k++) {
        asdic_ping_destroy(&single[k]);
        asdic_ping_destroy(&together[k]);
    }
}

static void a_batch_changes_no_byte(void **state) {
    (void)state;
    static const struct {
        uint32_t rays;
        size_t ping_batch_slots, together_most;
        asdic_sampler sampler;
        asdic_deposit deposit;
        unsigned width;
    } cases[] = {
        {500, 16384, 14, ASDIC_SAMPLER_ADAPTIVE, ASDIC_DEPOSIT_COLLECT, 8},
        {500, 1600, 3, ASDIC_SAMPLER_ADAPTIVE, ASDIC_DEPOSIT_COLLECT, 8},
        {500, 1600, 3, ASDIC_SAMPLER_ADAPTIVE, ASDIC_DEPOSIT_ATOMIC32, 1},
        {500, 2048, 4, ASDIC_SAMPLER_UNIFORM_SPHERE, ASDIC_DEPOSIT_ATOMIC32, 8},
        {5000, 4096, 1, ASDIC_SAMPLER_BEAM, ASDIC_DEPOSIT_COLLECT, 8},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        ping_rig r = rig_with_everything();
        r.sampling.rays = cases[i].rays;
        r.sampling.sampler = cases[i].sampler;
        r.layout.deposit = cases[i].deposit;
        r.layout.width = cases[i].width;
        r.layout.ping_batch_slots = cases[i].ping_batch_slots;
        compare(&r, cases[i].together_most);
        rig_destroy(&r);
    }
}

/* In water of several layers each ping has legs of its own. */
static void a_batch_in_water_that_bends_changes_no_byte(void **state) {
    (void)state;
    ping_rig r = rig_with_everything();
    r.env.sound_speed_profile =
        (asdic_sound_profile){3, {0.0, 9.0, 12.0}, {1500.0, 1485.0, 1490.0}};
    r.sampling.rays = 500;
    r.layout.ping_batch_slots = 16384;
    compare(&r, 14);
    rig_destroy(&r);
}

/* Rays in several batches, and fans, go alone. */
static void large_pings_go_alone(void **state) {
    (void)state;
    ping_rig r = rig_create(&t);
    r.sampling.rays = 6000;
    r.layout.batch_slots = 4096;
    r.layout.ping_batch_slots = 1 << 20;
    compare(&r, 1);
    rig_destroy(&r);
}

static void arguments_are_checked(void **state) {
    (void)state;
    ping_rig r = rig_create(&t);
    r.sampling.rays = 64;
    asdic_simulator *sim = rig_simulator(&r);
    asdic_ping *pings[2] = {NULL, NULL};
    asdic_pose poses[2] = {r.pose, {.position_m = {0.0, 0.0, NAN}}};
    for (size_t k = 0; k < 2; k++) {
        assert_ok(t.ctx,
                  asdic_ping_create(t.ctx, RIG_BEAMS, asdic_simulator_bin_count(sim), &pings[k]));
    }
    assert_status(t.ctx, asdic_simulator_pings(sim, poses, 0, 2, pings), ASDIC_ERROR_ARGUMENT);
    assert_status(t.ctx, asdic_simulator_pings(sim, NULL, 0, 2, pings), ASDIC_ERROR_ARGUMENT);
    assert_status(t.ctx, asdic_simulator_pings(sim, poses, 0, 1, NULL), ASDIC_ERROR_ARGUMENT);
    assert_status(t.ctx, asdic_simulator_pings(NULL, poses, 0, 1, pings), ASDIC_ERROR_ARGUMENT);
    assert_ok(t.ctx, asdic_simulator_pings(sim, poses, 0, 0, pings));
    assert_ok(t.ctx, asdic_simulator_pings(sim, poses, 0, 1, pings));
    asdic_ping_destroy(&pings[0]);
    asdic_ping_destroy(&pings[1]);
    asdic_simulator_destroy(&sim);
    rig_destroy(&r);
}

/* Rays of a block of F neighbours, F a Fibonacci number, lie by azimuth: as order.h says, each once. */
static void blocks_are_stored_by_azimuth(void **state) {
    (void)state;
    static const uint32_t rays[] = {64, 100, 160, 300, 700, 2000, 5000, 12000, 30000};
    size_t odd = 0, even = 0;
    for (size_t i = 0; i < sizeof rays / sizeof *rays; i++) {
        ping_rig r = rig_create(&t);
        r.sampling.rays = rays[i];
        asdic_simulator *sim = rig_simulator(&r);
        asdic_ping *ping = rig_ping(&r, sim);
        assert_ok(t.ctx, asdic_simulator_ping(sim, &r.pose, 0, ping));
        const dev_ping *shot = sim->shots[0].ping;
        uint64_t slots = (uint64_t)shot->batch.groups * shot->batch.per_group, own = 1, before = 1;
        uint64_t block = shot->batch.order_block, inverse = shot->batch.order_inverse;
        size_t steps = 0;
        for (; own * own < 16 * slots; steps++) { /* the first that a packet of 16 spans evenly */
            uint64_t next = own + before;
            before = own;
            own = next;
        }
        assert_int_equal(block, own);
        assert_true(inverse < block);
        assert_int_equal(inverse * before % block, 1);
        for (uint64_t k = 0; k < 16; k++) {
            assert_int_equal(shot->batch.order_lanes[k], k * inverse % block);
        }
        odd += steps % 2;
        even += steps % 2 == 0;
        asdic_ping_destroy(&ping);
        asdic_simulator_destroy(&sim);
        rig_destroy(&r);
    }
    assert_true(odd > 1 && even > 1);
}

int main(void) {
    t = test_device_open_or_skip();
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_batch_changes_no_byte),
        cmocka_unit_test(a_batch_in_water_that_bends_changes_no_byte),
        cmocka_unit_test(large_pings_go_alone),
        cmocka_unit_test(arguments_are_checked),
        cmocka_unit_test(blocks_are_stored_by_azimuth),
    };
    return test_device_end(&t, cmocka_run_group_tests(tests, NULL, NULL));
}
