/*
 * What a mission needs: the terms that no ping would miss, and the rays that a tolerance takes.
 */
#include "mission.h"

#include "base/clock.h"
#include "base/context.h"
#include "base/memory_left.h"
#include "base/try.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

/* --- terms ------------------------------------------------------------------------------------ */

/* Keeps every term: a vehicle that is steered by hand may come where a term matters. */
static void keep_all(const asdic_mission *mission, asdic_plan *plan) {
    const bool is_there[ASDIC_TERM_COUNT] = {
        [ASDIC_TERM_SURFACE] = asdic_scene_get_info(mission->scene).has_surface,
        [ASDIC_TERM_VOLUME] = true,
        [ASDIC_TERM_OBJECTS] = asdic_mission_object_count(mission) > 0,
        [ASDIC_TERM_BORIC_ACID] = true,
        [ASDIC_TERM_RAYS] = true,
        [ASDIC_TERM_MULTIPATH] = mission->settings.sampling.multipath != ASDIC_MULTIPATH_OFF};
    for (int t = 0; t < ASDIC_TERM_COUNT; t++) {
        asdic_plan_row *row = &plan->rows[t];
        if (is_there[t] && !row->kept) {
            row->kept = true;
            snprintf(row->reason, sizeof row->reason, "the scene keeps all terms");
        }
    }
    plan->left_out = 0;
}

/* Room for the poses of COUNT pings, to be freed. More than the memory that is left is refused
 * here, before the system kills a process for it. */
static asdic_status make_poses(asdic_context *ctx, size_t count, asdic_pose **out) {
    char what[64];
    snprintf(what, sizeof what, "the plan of %zu pings needs", count);
    TRY(asdic_memory_check(ctx, (uint64_t)count * sizeof **out, asdic_memory_left(), what,
                           "use fewer pings"));
    *out = malloc(count * sizeof **out);
    return *out ? ASDIC_OK : asdic_fail_memory(ctx, "the poses of a mission");
}

asdic_status asdic_mission_plan(asdic_context *ctx, const asdic_mission *mission, asdic_plan *out) {
    if (!mission || !out) {
        return asdic_fail(ctx, ASDIC_ERROR_ARGUMENT, "asdic_mission_plan: NULL argument");
    }
    size_t count = asdic_mission_ping_count(mission);
    asdic_pose *poses = NULL;
    TRY(make_poses(ctx, count, &poses));
    for (size_t i = 0; i < count; i++) {
        poses[i] = asdic_mission_pose(mission, i, NULL);
    }
    asdic_status status =
        asdic_plan_make(ctx, asdic_mission_scene(mission), asdic_mission_environment(mission),
                        asdic_mission_sonar(mission),
                        asdic_mission_sampling((asdic_mission *)mission), poses, count, out);
    free(poses);
    if (!status && mission->settings.keeps_all_terms) {
        keep_all(mission, out);
    }
    return status;
}

/* --- rays ------------------------------------------------------------------------------------- */

/* Pings looked at, spread over the mission. */
#define MOST_PINGS 4

/* Energy that rays bring in: all but speckle and noise. */
static double echo_of(const asdic_ping *ping, size_t at) {
    double sum = 0.0;
    for (int c = ASDIC_BOTTOM; c < ASDIC_NOISE; c++) {
        sum += ping->intensity_lin[c][at];
    }
    return sum;
}

/* Keeps the roughest bins, roughest first. */
static void add_rough(asdic_ray_budget *out, asdic_rough_bin bin) {
    size_t at = out->rough_count < ASDIC_ROUGH_BINS ? out->rough_count : ASDIC_ROUGH_BINS - 1;
    if (out->rough_count++ >= ASDIC_ROUGH_BINS && out->rough[at].stderr_db >= bin.stderr_db) {
        return;
    }
    while (at > 0 && out->rough[at - 1].stderr_db < bin.stderr_db) {
        out->rough[at] = out->rough[at - 1];
        at--;
    }
    out->rough[at] = bin;
}

static void judge(const asdic_ping *ping, size_t number, double tolerance_db,
                  asdic_ray_budget *out) {
    for (size_t at = 0; at < ping->beams * ping->bins; at++) {
        double echo = echo_of(ping, at);
        if (!(echo > 0.0) || echo < ping->intensity_lin[ASDIC_NOISE][at]) {
            continue;
        }
        double stderr_db = ping->stderr_db[at];
        out->worst_db = stderr_db > out->worst_db ? stderr_db : out->worst_db;
        if (stderr_db > tolerance_db) {
            add_rough(out, (asdic_rough_bin){number, at / ping->bins, at % ping->bins, stderr_db});
        }
    }
}

/* Simulates OUT->pings pings, the first ones of evenly spread learning blocks, and judges them. */
static asdic_status look(asdic_context *ctx, const asdic_mission *mission, asdic_simulator *sim,
                         asdic_ping *ping, double tolerance_db, asdic_ray_budget *out) {
    size_t blocks = (asdic_mission_ping_count(mission) + ASDIC_LEARN_BLOCK - 1) / ASDIC_LEARN_BLOCK;
    out->pings = blocks < MOST_PINGS ? blocks : MOST_PINGS;
    out->worst_db = 0.0;
    out->ping_s = INFINITY;
    out->rough_count = 0;
    for (size_t k = 0; k < out->pings; k++) {
        size_t last = out->pings - 1;
        size_t number = (last ? k * (blocks - 1) / last : 0) * ASDIC_LEARN_BLOCK;
        asdic_pose pose = asdic_mission_pose(mission, number, NULL);
        if (asdic_context_interrupted(ctx)) {
            return asdic_fail(ctx, ASDIC_ERROR_INTERRUPTED, "interrupted while looking for rays");
        }
        TRY(asdic_mission_place(mission, sim, number));
        TRY(asdic_simulator_learn(sim, &pose, number));
        double began_s = asdic_clock_s();
        TRY(asdic_simulator_ping(sim, &pose, number, ping));
        out->ping_s = fmin(out->ping_s, asdic_clock_s() - began_s);
        judge(ping, number, tolerance_db, out);
    }
    return ASDIC_OK;
}

static asdic_status look_with(asdic_context *ctx, const asdic_mission *mission,
                              asdic_simulator *sim, double tolerance_db, asdic_ray_budget *out) {
    asdic_ping *ping = NULL;
    TRY(asdic_ping_create(ctx, asdic_mission_sonar(mission)->receiver_count,
                          asdic_simulator_bin_count(sim), &ping));
    asdic_status status = look(ctx, mission, sim, ping, tolerance_db, out);
    asdic_ping_destroy(&ping);
    return status;
}

static asdic_status try_rays(asdic_context *ctx, asdic_mission *mission, asdic_device *device,
                             double tolerance_db, asdic_ray_budget *out) {
    asdic_sampling sampling = *asdic_mission_sampling(mission);
    sampling.rays = out->rays;
    asdic_simulator *sim = NULL;
    double depth_m = asdic_mission_pose(mission, 0, NULL).position_m.z;
    TRY(asdic_simulator_create(ctx, device, asdic_mission_scene(mission),
                               asdic_mission_environment(mission), asdic_mission_sonar(mission),
                               &sampling, depth_m, &sim));
    asdic_status status = look_with(ctx, mission, sim, tolerance_db, out);
    asdic_simulator_destroy(&sim);
    return status;
}

asdic_status asdic_mission_find_rays(asdic_context *ctx, asdic_mission *mission,
                                     asdic_device *device, double tolerance_db, uint32_t most_rays,
                                     asdic_ray_budget *out) {
    if (!mission || !device || !out) {
        return asdic_fail(ctx, ASDIC_ERROR_ARGUMENT, "asdic_mission_find_rays: NULL argument");
    }
    if (!(tolerance_db > 0.0)) {
        return asdic_fail(ctx, ASDIC_ERROR_ARGUMENT, "a tolerance of %g dB: must be above 0",
                          tolerance_db);
    }
    asdic_sampling *sampling = asdic_mission_sampling(mission);
    *out = (asdic_ray_budget){.rays = sampling->rays};
    for (;;) {
        TRY(try_rays(ctx, mission, device, tolerance_db, out));
        if (out->rough_count == 0 || out->rays >= most_rays) {
            break;
        }
        out->rays = out->rays > most_rays / 2 ? most_rays : 2 * out->rays;
    }
    sampling->rays = out->rays;
    return ASDIC_OK;
}
