/*
 * An array of elements as a rig for tests of coherent pings: no noise, clear water, 1500 m/s.
 */
#ifndef ASDIC_TEST_COHERENT_RIG_H
#define ASDIC_TEST_COHERENT_RIG_H

#include "ping_rig.h"

#include "sim/coherent.h"

#define TURN (360.0 * RIG_DEGREE)
#define WAVELENGTH_M 0.015 /* at 100 kHz */

/* 32 elements half a wavelength apart, and one beam ahead, over the rig's sand. */
static inline ping_rig array_rig(test_device *device) {
    ping_rig r = rig_create(device);
    r.env.sound_speed_mps = 1500.0;
    r.env.particle_strength_db = -200.0;
    r.sonar.array = (asdic_array){
        .elements = 32,
        .spacing_m = 0.5 * WAVELENGTH_M,
        .element = {.length_h_m = 0.5 * WAVELENGTH_M, .length_v_m = 0.05},
    };
    r.sonar.receiver_count = 1;
    r.receivers[0].length_h_m = 0.24;
    r.sampling.coherent = true;
    r.sampling.rays = 20000;
    return r;
}

/* The same without bottom and surface. */
static inline ping_rig empty_array(test_device *device) {
    ping_rig r = array_rig(device);
    asdic_scene_destroy(&r.scene);
    assert_ok(device->ctx, asdic_scene_create(device->ctx, &r.scene));
    asdic_scene_set_surface(r.scene, false);
    return r;
}

/* Ping INDEX of SIM, with pressures. */
static inline asdic_ping *array_shoot(const ping_rig *r, asdic_simulator *sim, uint64_t index) {
    asdic_context *ctx = r->device->ctx;
    asdic_ping *ping = NULL;
    assert_ok(ctx, asdic_ping_create(ctx, r->sonar.receiver_count, asdic_simulator_bin_count(sim),
                                     &ping));
    assert_ok(ctx, asdic_ping_add_elements(ctx, ping, r->sonar.array.elements,
                                           asdic_simulator_sample_count(sim)));
    assert_ok(ctx, asdic_simulator_ping(sim, &r->pose, index, ping));
    return ping;
}

/* The real part of the pressure at an element and sample; the imaginary part follows. */
static inline const float *array_at(const asdic_ping *ping, size_t element, size_t sample) {
    return ping->pressure + 2 * (element * ping->samples + sample);
}

#endif
