/*
 * One body alone in the water, seen by one beam: no surface, no bottom, no noise, so that what
 * comes back, less the transmission loss, is its target strength.
 */
#ifndef ASDIC_TEST_TARGET_RIG_H
#define ASDIC_TEST_TARGET_RIG_H

#include "asserts.h"
#include "test_device.h"

#include <asdic/asdic.h>

#include <stdlib.h>

typedef struct target_rig {
    test_device *device;
    asdic_environment env;
    asdic_sonar sonar;
    asdic_beam receiver;
    asdic_sampling sampling;
    asdic_pose pose; /* of the sonar: at 100 m depth, looking north */
    asdic_scene *scene;
} target_rig;

/* A sonar whose beam is flat to 0.1 dB over LOOK_RAD to each side of its axis. */
static inline target_rig target_rig_create(test_device *device, double frequency_hz, double range_m,
                                           double look_rad) {
    target_rig r = {.device = device};
    r.env = asdic_environment_default();
    r.env.sound_speed_mps = 1500.0;
    r.env.particle_strength_db = -200.0;
    r.sonar = asdic_sonar_default();
    r.sonar.frequency_hz = frequency_hz;
    r.sonar.noise_enabled = false;
    r.sonar.ping_rate_hz = 0.5 * 1500.0 / (range_m + 20.0);
    double side_m = fmin(0.06 / look_rad, 2000.0) * 1500.0 / frequency_hz;
    r.sonar.transmitter.length_h_m = r.sonar.transmitter.length_v_m = side_m;
    r.receiver = r.sonar.transmitter;
    r.sonar.receiver_count = 1;
    r.sampling = asdic_sampling_default();
    r.sampling.multipath = ASDIC_MULTIPATH_OFF;
    r.pose.position_m.z = 100.0;
    assert_ok(device->ctx, asdic_scene_create(device->ctx, &r.scene));
    asdic_scene_set_surface(r.scene, false);
    return r;
}

static inline void target_rig_destroy(target_rig *r) {
    asdic_scene_destroy(&r->scene);
}

/* Adds MESH (destroyed here) at RANGE_M ahead of the sonar. */
static inline void target_rig_add(target_rig *r, asdic_mesh *mesh, double range_m, double yaw_rad,
                                  asdic_material material) {
    asdic_pose pose = {.position_m = {range_m, 0.0, 100.0}, .yaw_rad = yaw_rad};
    assert_ok(r->device->ctx, asdic_scene_add_object(r->scene, "body", mesh, pose, material));
    asdic_mesh_destroy(&mesh);
}

/* A simulator of R's scene, and room for its pings; the caller destroys both. */
static inline asdic_simulator *target_rig_simulator(target_rig *r, asdic_ping **ping) {
    asdic_simulator *sim = NULL;
    asdic_context *ctx = r->device->ctx;
    r->sonar.receivers = &r->receiver;
    if (!asdic_scene_get_info(r->scene).bvh_nodes) {
        asdic_scene_commit(r->scene); /* a second commit is refused and changes nothing */
    }
    assert_ok(ctx, asdic_simulator_create(ctx, r->device->device, r->scene, &r->env, &r->sonar,
                                          &r->sampling, r->pose.position_m.z, &sim));
    assert_ok(ctx, asdic_ping_create(ctx, 1, asdic_simulator_bin_count(sim), ping));
    return sim;
}

/* Energy of ping INDEX, all of COMPONENT's bins. */
static inline double target_rig_shoot(target_rig *r, asdic_simulator *sim, int index,
                                      asdic_component component, asdic_ping *ping) {
    assert_ok(r->device->ctx, asdic_simulator_ping(sim, &r->pose, (uint64_t)index, ping));
    assert_int_equal(ping->saturated, 0);
    double energy = 0.0;
    for (size_t n = 0; n < ping->bins; n++) {
        energy += ping->intensity_lin[component][n];
    }
    return energy;
}

/* Mean of PINGS pings' energy, all of COMPONENT's bins; *DEVIATION: of that mean, relative. */
static inline double target_rig_energy(target_rig *r, asdic_component component, int pings,
                                       double *deviation) {
    asdic_ping *ping = NULL;
    asdic_simulator *sim = target_rig_simulator(r, &ping);
    double sum = 0.0, square = 0.0;
    for (int k = 0; k < pings; k++) {
        double energy = target_rig_shoot(r, sim, k, component, ping);
        sum += energy / pings;
        square += energy * energy / pings;
    }
    *deviation = pings > 1 ? sqrt(fmax(square / (sum * sum) - 1.0, 0.0) / (pings - 1)) : 0.0;
    asdic_ping_destroy(&ping);
    asdic_simulator_destroy(&sim);
    return sum;
}

/* Less the transmission loss at RANGE_M, dB: the target strength. */
static inline double target_rig_strength_db(const target_rig *r, double energy, double range_m) {
    double alpha = asdic_environment_absorption_db_per_km(&r->env, r->sonar.frequency_hz,
                                                          r->pose.position_m.z);
    return 10.0 * log10(energy) + 40.0 * log10(range_m) + 2.0 * (range_m - 1.0) * alpha / 1000.0;
}

#endif
