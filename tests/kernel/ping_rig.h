/*
 * The paper's first scenario as a rig for tests: change what a test is about, then shoot.
 */
#ifndef ASDIC_TEST_PING_RIG_H
#define ASDIC_TEST_PING_RIG_H

#include "asserts.h"
#include "test_device.h"

#include "sim/simulator.h"

#include <asdic/asdic.h>

#include <stdlib.h>

#define RIG_BEAMS 3
#define RIG_MOST_BEAMS 9
#define RIG_DEGREE (3.14159265358979323846 / 180.0)

typedef struct ping_rig {
    test_device *device;
    asdic_environment env;
    asdic_sonar sonar;
    asdic_beam receivers[RIG_MOST_BEAMS]; /* forward, 20 degrees down, 20 degrees up; round about */
    asdic_sampling sampling;
    asdic_pose pose;
    asdic_scene *scene; /* surface, sand at 12 m; objects may be added before rig_commit */
    asdic_layout layout;
} ping_rig;

static inline ping_rig rig_create(test_device *device) {
    ping_rig r = {.device = device};
    r.env = asdic_environment_default();
    r.env.max_depth_m = 12.0;
    r.sonar = asdic_sonar_default();
    r.sonar.noise_enabled = false;
    static const double pitch_deg[RIG_BEAMS] = {0.0, 20.0, -20.0};
    for (int b = 0; b < RIG_MOST_BEAMS; b++) {
        r.receivers[b] = r.sonar.transmitter;
        r.receivers[b].pitch_rad = pitch_deg[b % RIG_BEAMS] * RIG_DEGREE;
        r.receivers[b].yaw_rad = b / RIG_BEAMS * 15.0 * RIG_DEGREE;
    }
    r.sonar.receiver_count = RIG_BEAMS;
    r.sampling = asdic_sampling_default();
    r.pose.position_m.z = 7.0;
    r.layout = asdic_layout_default(asdic_device_get_info(device->device));
    assert_ok(device->ctx, asdic_scene_create(device->ctx, &r.scene));
    assert_ok(device->ctx, asdic_scene_set_bottom_plane(r.scene, 12.0, asdic_material_bottom(2.0)));
    return r;
}

static inline void rig_destroy(ping_rig *r) {
    asdic_scene_destroy(&r->scene);
}

static inline asdic_simulator *rig_simulator(ping_rig *r) {
    asdic_simulator *sim = NULL;
    r->sonar.receivers = r->receivers;
    if (!asdic_scene_get_info(r->scene).bvh_nodes) {
        asdic_scene_commit(r->scene); /* a second commit is refused and changes nothing */
    }
    assert_ok(r->device->ctx, asdic_simulator_create_with(
                                  r->device->ctx, r->device->device, r->scene, &r->env, &r->sonar,
                                  &r->sampling, r->pose.position_m.z, &r->layout, &sim));
    return sim;
}

/* An empty scene with a surface, instead of what there was. */
static inline void rig_empty(ping_rig *r) {
    asdic_scene_destroy(&r->scene);
    assert_ok(r->device->ctx, asdic_scene_create(r->device->ctx, &r->scene));
}

/* The first scenario as quadrature takes it. */
static inline asdic_flat_scene rig_flat(const ping_rig *r) {
    return (asdic_flat_scene){.has_surface = true,
                              .has_bottom = true,
                              .altitude_m = 12.0 - r->pose.position_m.z,
                              .depth_m = r->pose.position_m.z,
                              .bottom = asdic_material_bottom(2.0)};
}

/* As SIM fills it. */
static inline asdic_ping *rig_ping(const ping_rig *r, const asdic_simulator *sim) {
    asdic_ping *ping = NULL;
    assert_ok(r->device->ctx, asdic_ping_create(r->device->ctx, r->sonar.receiver_count,
                                                asdic_simulator_bin_count(sim), &ping));
    return ping;
}

/* A ping of a new simulator, learnt when LEARN. */
static inline asdic_ping *rig_shoot(ping_rig *r, uint64_t index, bool learn) {
    asdic_simulator *sim = rig_simulator(r);
    asdic_ping *ping = rig_ping(r, sim);
    if (learn) {
        assert_ok(r->device->ctx, asdic_simulator_learn(sim, &r->pose, index));
    }
    assert_ok(r->device->ctx, asdic_simulator_ping(sim, &r->pose, index, ping));
    assert_int_equal(ping->saturated, 0);
    asdic_simulator_destroy(&sim);
    return ping;
}

static inline bool rig_same(const asdic_ping *a, const asdic_ping *b) {
    size_t cells = a->beams * a->bins;
    for (int c = 0; c < ASDIC_COMPONENT_COUNT; c++) {
        if (memcmp(a->intensity_lin[c], b->intensity_lin[c], cells * sizeof(double)) != 0) {
            return false;
        }
    }
    return memcmp(a->stderr_db, b->stderr_db, cells * sizeof(float)) == 0;
}

#endif
