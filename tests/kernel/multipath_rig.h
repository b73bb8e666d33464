/*
 * Multipath in an empty sea: one sonar, plates and balls as mirrors and as what they show.
 */
#ifndef ASDIC_TEST_MULTIPATH_RIG_H
#define ASDIC_TEST_MULTIPATH_RIG_H

#include "target_rig.h"

#include "kernels/beam.h"

#define PI 3.14159265358979323846
#define DEGREE (PI / 180.0)
#define SIDE_WL 3.0 /* apertures in wavelengths: 17 degrees */
#define FREQUENCY_HZ 100e3
#define SPEED_MPS 1500.0

/* Of the test program. */
static test_device t;

/* A sonar of medium width in an empty sea; the beam sampler's rays do not depend on the scene. */
static inline target_rig open_sea(double range_m) {
    target_rig r = target_rig_create(&t, FREQUENCY_HZ, range_m, 0.06 / SIDE_WL);
    r.sampling.multipath = ASDIC_MULTIPATH_FIRST;
    r.sampling.sampler = ASDIC_SAMPLER_BEAM;
    r.sampling.rays = 1 << 19;
    return r;
}

static inline void add(target_rig *r, asdic_mesh *mesh, asdic_vec3 at, double yaw_deg,
                       double pitch_deg, asdic_material material) {
    asdic_pose pose = {.position_m = {at.x, at.y, 100.0 + at.z},
                       .yaw_rad = yaw_deg * DEGREE,
                       .pitch_rad = pitch_deg * DEGREE};
    char name[32];
    snprintf(name, sizeof name, "body%zu", asdic_scene_get_info(r->scene).triangles);
    assert_ok(t.ctx, asdic_scene_add_object(r->scene, name, mesh, pose, material));
    asdic_mesh_destroy(&mesh);
}

static inline void add_plate(target_rig *r, double width_m, double height_m, asdic_vec3 at,
                             double yaw_deg, asdic_material material) {
    asdic_mesh *mesh = NULL;
    assert_ok(t.ctx, asdic_mesh_plate(t.ctx, width_m, height_m, &mesh));
    add(r, mesh, at, yaw_deg, 0.0, material);
}

/* Air: R = 1; polished. */
static inline asdic_material mirror(void) {
    return asdic_material_facet(0.0, 0.0, 0.0);
}

static inline asdic_material sand(void) {
    return asdic_material_bottom(2.0);
}

/* The mean of PINGS pings, in the place of one. */
static inline asdic_ping *shoot_many(target_rig *r, int pings) {
    asdic_simulator *sim = NULL;
    asdic_ping *ping = NULL;
    r->sonar.receivers = &r->receiver;
    if (!asdic_scene_get_info(r->scene).bvh_nodes) {
        asdic_scene_commit(r->scene);
    }
    assert_ok(t.ctx, asdic_simulator_create(t.ctx, t.device, r->scene, &r->env, &r->sonar,
                                            &r->sampling, 100.0, &sim));
    if (r->sampling.sampler == ASDIC_SAMPLER_ADAPTIVE) {
        assert_ok(t.ctx, asdic_simulator_learn(sim, &r->pose, 0));
    }
    assert_ok(t.ctx, asdic_ping_create(t.ctx, 1, asdic_simulator_bin_count(sim), &ping));
    double *sums[ASDIC_COMPONENT_COUNT];
    for (int c = 0; c < ASDIC_COMPONENT_COUNT; c++) {
        sums[c] = calloc(ping->bins, sizeof *sums[c]);
    }
    for (int k = 0; k < pings; k++) {
        assert_ok(t.ctx, asdic_simulator_ping(sim, &r->pose, (uint64_t)k, ping));
        assert_int_equal(ping->saturated, 0);
        for (int c = 0; c < ASDIC_COMPONENT_COUNT; c++) {
            for (size_t n = 0; n < ping->bins; n++) {
                sums[c][n] += ping->intensity_lin[c][n] / pings;
            }
        }
    }
    for (int c = 0; c < ASDIC_COMPONENT_COUNT; c++) {
        memcpy(ping->intensity_lin[c], sums[c], ping->bins * sizeof *sums[c]);
        free(sums[c]);
    }
    asdic_simulator_destroy(&sim);
    return ping;
}

static inline asdic_ping *shoot(target_rig *r) {
    return shoot_many(r, 1);
}

/* Bins that begin from FROM on, before TO. */
static inline double energy(const asdic_ping *ping, asdic_component component, double from_m,
                            double to_m) {
    double sum = 0.0;
    size_t first = (size_t)ceil(from_m / ping->bin_length_m - 1e-9);
    size_t end = (size_t)ceil(fmin(to_m / ping->bin_length_m, (double)ping->bins) - 1e-9);
    for (size_t n = first; n < end; n++) {
        sum += ping->intensity_lin[component][n];
    }
    return sum;
}

static inline double db(double lin) {
    return 10.0 * log10(lin);
}

/* Two-way pattern towards (x, y, z) from the sonar. */
static inline double one_way(const asdic_beam *beam, double x, double y, double z) {
    double d = sqrt(x * x + y * y + z * z), side_wl = beam->length_h_m * FREQUENCY_HZ / SPEED_MPS;
    return beam_pattern_lin(x / d, y / d, z / d, side_wl, side_wl, 0.0);
}

#endif
