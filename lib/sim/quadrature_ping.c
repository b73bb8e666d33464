#include "quadrature_ping.h"

#include "simulator.h"

#include "base/try.h"
#include "scene/scene.h"

#include <asdic/expected.h>

#include <string.h>

bool asdic_quadrature_knows(const asdic_scene *scene, const asdic_environment *env,
                            const asdic_sampling *sampling, double depth_m, double altitude_m) {
    bool plane_law = !scene->has_bottom_plane ||
                     scene->materials[scene->bottom_plane_material].law->formula != DEV_LAW_FACET;
    return scene->part_count == 0 && scene->point_count == 0 && plane_law &&
           sampling->sampler == ASDIC_SAMPLER_ADAPTIVE &&
           sampling->multipath != ASDIC_MULTIPATH_BOUNDARIES && !sampling->coherent &&
           !sampling->truth && env->variant == ASDIC_VARIANT_CORRECTED && altitude_m > 0.0 &&
           (!scene->has_surface || depth_m > 0.0);
}

bool asdic_quadrature_same_view(const asdic_pose *a, const asdic_pose *b) {
    return a->position_m.z == b->position_m.z && a->roll_rad == b->roll_rad &&
           a->pitch_rad == b->pitch_rad;
}

void asdic_quadrature_finish(asdic_quadrature_cache *cache) {
    for (size_t i = 0; i < ASDIC_QUADRATURE_VIEWS; i++) {
        asdic_ping_destroy(&cache->pings[i]);
    }
}

static asdic_status compute(asdic_simulator *sim, const asdic_pose *pose, size_t at) {
    asdic_quadrature_cache *cache = &sim->quadrature;
    const asdic_scene *scene = sim->setup.scene;
    double z = pose->position_m.z;
    asdic_flat_scene flat = {.has_surface = scene->has_surface,
                             .has_bottom = scene->has_bottom_plane,
                             .altitude_m = scene->bottom_plane_depth_m - z,
                             .depth_m = z,
                             .surface = scene->surface};
    if (scene->has_bottom_plane) {
        flat.bottom = scene->materials[scene->bottom_plane_material];
    }
    if (!cache->pings[at]) {
        TRY(asdic_ping_create(sim->ctx, sim->setup.sonar.receiver_count, sim->setup.bins,
                              &cache->pings[at]));
    }
    /* Always on one heading: pings on others must not differ by rounding. */
    cache->poses[at] = *pose;
    cache->poses[at].yaw_rad = 0.0;
    asdic_status status = asdic_expected_compute(
        sim->ctx, &flat, &sim->setup.env, &sim->setup.sonar, &cache->poses[at], cache->pings[at]);
    if (status) {
        asdic_ping_destroy(&cache->pings[at]);
    }
    return status;
}

asdic_status asdic_quadrature_ping(asdic_simulator *sim, const asdic_pose *pose, asdic_ping *out) {
    asdic_quadrature_cache *cache = &sim->quadrature;
    size_t at = 0;
    while (at < ASDIC_QUADRATURE_VIEWS &&
           !(cache->pings[at] && asdic_quadrature_same_view(&cache->poses[at], pose))) {
        at++;
    }
    if (at == ASDIC_QUADRATURE_VIEWS) {
        at = cache->next;
        cache->next = (at + 1) % ASDIC_QUADRATURE_VIEWS;
        TRY(compute(sim, pose, at));
    }
    for (int c = 0; c < ASDIC_COMPONENT_COUNT; c++) {
        memcpy(out->intensity_lin[c], cache->pings[at]->intensity_lin[c],
               sim->setup.cells * sizeof(double));
    }
    memset(out->stderr_db, 0, sim->setup.cells * sizeof *out->stderr_db);
    out->bin_length_m = sim->setup.sonar.bin_length_m;
    out->rays = out->saturated = 0;
    return ASDIC_OK;
}
