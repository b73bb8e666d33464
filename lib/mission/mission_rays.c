/*
 * How many rays a ping of a mission takes, and what error they leave: expected without a device,
 * and found by simulating a few pings.
 */
#include "mission_build.h"

#include "base/clock.h"
#include "base/context.h"
#include "base/sort.h"
#include "base/try.h"
#include "sim/coherent.h"

#include <math.h>

static asdic_rays_over rays_over_of(const asdic_scene_file *file, asdic_multipath multipath) {
    const file_object *objects = file->objects.items;
    bool meshes = file->bottom.mesh.node || file->bottom.grid.node;
    for (size_t i = 0; i < file->objects.count; i++) {
        meshes |= objects[i].mesh.node != NULL;
    }
    return meshes                                    ? ASDIC_OVER_MESHES
           : multipath == ASDIC_MULTIPATH_BOUNDARIES ? ASDIC_OVER_MIRRORS
                                                     : ASDIC_OVER_PLANES;
}

void asdic_mission_build_rays(mission_builder *b) {
    asdic_settings *s = &b->mission->settings;
    s->rays_over = rays_over_of(b->file, s->sampling.multipath);
    if (b->file->sampling.rays == FILE_RAYS_AUTO) {
        s->auto_rays =
            asdic_rays_auto(&s->sonar, asdic_mission_speed_mps(b->mission), s->rays_over);
        s->sampling.rays = s->auto_rays;
    }
}

asdic_ray_forecast asdic_mission_ray_forecast(const asdic_mission *mission) {
    if (!mission) {
        return (asdic_ray_forecast){0};
    }
    const asdic_settings *s = &mission->settings;
    uint32_t rays = s->sampling.rays;
    double c_mps = asdic_mission_speed_mps(mission);
    bool is_known = !s->sampling.coherent && s->sampling.sampler == ASDIC_SAMPLER_ADAPTIVE;
    double error_db =
        is_known ? asdic_rays_error_db(&s->sonar, c_mps, s->rays_over, rays) : (double)NAN;
    return (asdic_ray_forecast){.rays = rays,
                                .is_auto = asdic_settings_rays_are_auto(s),
                                .auto_rays = asdic_rays_auto(&s->sonar, c_mps, s->rays_over),
                                .stderr_db = error_db,
                                .is_rough = error_db > ASDIC_ROUGH_DB};
}

/* --- found by looking for scatterers ---------------------------------------------------------- */

static asdic_status foresee(const asdic_mission *mission, asdic_simulator *sim,
                            asdic_coherent_forecast *out) {
    size_t last = asdic_mission_ping_count(mission) - 1;
    const size_t pings[] = {0, last / 2, last};
    for (size_t k = 0; k < 3; k++) {
        asdic_coherent_forecast one;
        asdic_pose pose = asdic_mission_pose(mission, pings[k], NULL);
        if (k > 0 && pings[k] == pings[k - 1]) {
            continue;
        }
        TRY(asdic_mission_place(mission, sim, pings[k]));
        TRY(asdic_coherent_foresee(sim, &pose, &one));
        *out = k == 0 || one.scatterers > out->scatterers ? one : *out;
    }
    return ASDIC_OK;
}

asdic_status asdic_mission_forecast_coherent(asdic_context *ctx, const asdic_mission *mission,
                                             asdic_coherent_forecast *out) {
    if (!mission || !out) {
        return asdic_fail_null(ctx, __func__);
    }
    const asdic_settings *s = &mission->settings;
    if (!s->sampling.coherent) {
        return asdic_fail(ctx, ASDIC_ERROR_ARGUMENT, "pings are of intensities, not coherent");
    }
    const asdic_device_info processor = {.kind = ASDIC_DEVICE_CPU, .compute_units = 1};
    asdic_layout layout = asdic_layout_default(&processor);
    asdic_sampling sampling = s->sampling;
    asdic_plan plan;
    TRY(asdic_mission_plan(ctx, mission, &plan));
    sampling.left_out = plan.left_out; /* as a run does */
    double depth_m = asdic_mission_pose(mission, 0, NULL).position_m.z;
    asdic_simulator *sim = NULL;
    TRY(asdic_simulator_create_with(ctx, NULL, mission->scene, &s->environment, &s->sonar,
                                    &sampling, depth_m, &layout, &sim));
    asdic_status status = foresee(mission, sim, out);
    asdic_simulator_destroy(&sim);
    return status;
}

/* --- found by simulating ---------------------------------------------------------------------- */

/* Pings looked at. Bins grow rough towards a target, and after their lesson: of five missions towards a hull and a reef, 16
 * pings found the share above a tolerance within 7 % of what all pings have, 4 within 84 %. */
#define MOST_PINGS 16

/* Energy that rays bring in: all but speckle and noise. */
static double echo_of(const asdic_ping *ping, size_t at) {
    double sum = 0.0;
    for (int c = ASDIC_BOTTOM; c < ASDIC_NOISE; c++) {
        sum += ping->intensity_lin[c][at];
    }
    return sum;
}

static bool is_rougher(const void *a, const void *b) {
    return ((const asdic_rough_bin *)a)->stderr_db > ((const asdic_rough_bin *)b)->stderr_db;
}

/* Keeps the roughest bins, roughest first. */
static void add_rough(asdic_ray_budget *out, asdic_rough_bin bin) {
    size_t kept = out->rough_count < ASDIC_ROUGH_BINS ? out->rough_count : ASDIC_ROUGH_BINS;
    asdic_sort_keep(out->rough, &kept, ASDIC_ROUGH_BINS, &bin, sizeof bin, is_rougher);
    out->rough_count++;
}

static void judge(const asdic_ping *ping, size_t number, double tolerance_db,
                  asdic_ray_budget *out) {
    for (size_t at = 0; at < ping->beams * ping->bins; at++) {
        double echo = echo_of(ping, at);
        if (!(echo > 0.0) || echo < ping->intensity_lin[ASDIC_NOISE][at]) {
            continue;
        }
        double stderr_db = ping->stderr_db[at];
        out->judged++;
        out->worst_db = stderr_db > out->worst_db ? stderr_db : out->worst_db;
        if (stderr_db > tolerance_db) {
            add_rough(out, (asdic_rough_bin){number, at / ping->bins, at % ping->bins, stderr_db});
        }
    }
}

/* Ping K of COUNT that are looked at among ALL: one in each of COUNT equal stretches, at places in them that go with no
 * number of pings, as that of a learning block; the first ping and the last among them. */
static size_t ping_of(size_t k, size_t count, size_t all) {
    const double golden = 0.6180339887498949;
    size_t first = k * all / count, next = (k + 1) * all / count;
    size_t in = (size_t)(fmod((double)k * golden, 1.0) * (double)(next - first));
    return k + 1 == count ? all - 1 : first + in;
}

/* Learns at the ping LESSON, as a run does that comes to it. */
static asdic_status learn(const asdic_mission *mission, asdic_simulator *sim, size_t lesson,
                          asdic_ray_budget *out) {
    asdic_pose pose = asdic_mission_pose(mission, lesson, NULL);
    TRY(asdic_mission_place(mission, sim, lesson));
    double began_s = asdic_clock_s();
    TRY(asdic_simulator_learn(sim, &pose, lesson));
    out->learn_s = fmin(out->learn_s, asdic_clock_s() - began_s);
    return ASDIC_OK;
}

/* Whether so many bins are rough that the LEFT bins to come cannot mend it. */
static bool is_lost(const asdic_ray_budget *budget, const asdic_tolerance *tolerance, size_t left) {
    return budget->rays < tolerance->most_rays &&
           (double)budget->rough_count > (1.0 - tolerance->share) * (double)(budget->judged + left);
}

/* Simulates pings as the mission's run makes them, and judges them; no more than tell that the rays do not do. */
static asdic_status look(asdic_context *ctx, const asdic_mission *mission, asdic_simulator *sim,
                         asdic_ping *ping, const asdic_tolerance *tolerance,
                         asdic_ray_budget *out) {
    size_t all = asdic_mission_ping_count(mission), learnt = SIZE_MAX;
    size_t count = all < MOST_PINGS ? all : MOST_PINGS, cells = ping->beams * ping->bins;
    char below[ASDIC_BELOW_BOTTOM_SIZE];
    out->worst_db = 0.0;
    out->ping_s = out->learn_s = INFINITY;
    out->rough_count = out->judged = out->pings = 0;
    for (size_t k = 0; k < count && !is_lost(out, tolerance, (count - k) * cells); k++) {
        size_t number = ping_of(k, count, all), together;
        size_t lesson = asdic_mission_lesson(mission, number, 1, &together);
        if (asdic_mission_is_below_bottom(mission, number, below) ||
            asdic_mission_is_below_bottom(mission, lesson, below)) {
            continue; /* of a trial, whose vehicle gives way before */
        }
        TRY(asdic_step(ctx, "pings to find how many rays are needed", k, count));
        if (lesson != learnt) {
            TRY(learn(mission, sim, lesson, out));
            learnt = lesson;
        }
        asdic_pose pose = asdic_mission_pose(mission, number, NULL);
        TRY(asdic_mission_place(mission, sim, number));
        double began_s = asdic_clock_s();
        TRY(asdic_simulator_ping(sim, &pose, number, ping));
        out->ping_s = fmin(out->ping_s, asdic_clock_s() - began_s);
        out->pings++;
        judge(ping, number, tolerance->stderr_db, out);
    }
    return ASDIC_OK;
}

static asdic_status look_with(asdic_context *ctx, const asdic_mission *mission,
                              asdic_simulator *sim, const asdic_tolerance *tolerance,
                              asdic_ray_budget *out) {
    asdic_ping *ping = NULL;
    TRY(asdic_ping_create(ctx, asdic_mission_sonar(mission)->receiver_count,
                          asdic_simulator_bin_count(sim), &ping));
    asdic_status status = look(ctx, mission, sim, ping, tolerance, out);
    asdic_ping_destroy(&ping);
    return status;
}

static asdic_status try_rays(asdic_context *ctx, asdic_mission *mission, asdic_device *device,
                             const asdic_tolerance *tolerance, asdic_ray_budget *out) {
    asdic_sampling sampling = *asdic_mission_sampling(mission);
    sampling.rays = out->rays;
    asdic_simulator *sim = NULL;
    double depth_m = asdic_mission_pose(mission, 0, NULL).position_m.z;
    TRY(asdic_simulator_create(ctx, device, asdic_mission_scene(mission),
                               asdic_mission_environment(mission), asdic_mission_sonar(mission),
                               &sampling, depth_m, &sim));
    asdic_status status = look_with(ctx, mission, sim, tolerance, out);
    asdic_simulator_destroy(&sim);
    return status;
}

/* Whether SHARE of the bins that count keep the tolerance; where none counts, nothing is known. */
static bool is_kept(const asdic_ray_budget *budget, double share) {
    return budget->judged > 0 &&
           (double)budget->rough_count <= (1.0 - share) * (double)budget->judged;
}

asdic_status asdic_mission_find_rays(asdic_context *ctx, asdic_mission *mission,
                                     asdic_device *device, const asdic_tolerance *tolerance,
                                     asdic_ray_budget *out) {
    if (!mission || !device || !tolerance || !out) {
        return asdic_fail_null(ctx, __func__);
    }
    if (!(tolerance->stderr_db > 0.0) || !(tolerance->share > 0.0 && tolerance->share <= 1.0)) {
        return asdic_fail(ctx, ASDIC_ERROR_ARGUMENT,
                          "a tolerance of %g dB for a share of %g: must be above 0, the share at "
                          "most 1",
                          tolerance->stderr_db, tolerance->share);
    }
    asdic_sampling *sampling = asdic_mission_sampling(mission);
    if (sampling->coherent) {
        return asdic_fail(ctx, ASDIC_ERROR_ARGUMENT,
                          "a tolerance of %g dB cannot be kept with 'sampling: {coherent: true}', "
                          "whose pings state no error; set the number of rays instead",
                          tolerance->stderr_db);
    }
    uint32_t most = tolerance->most_rays;
    *out = (asdic_ray_budget){.rays = sampling->rays};
    for (;;) {
        TRY(try_rays(ctx, mission, device, tolerance, out));
        out->is_kept = is_kept(out, tolerance->share);
        if (out->is_kept || out->judged == 0 || out->rays >= most) {
            break;
        }
        out->rays = out->rays > most / 2 ? most : 2 * out->rays;
    }
    sampling->rays = out->rays;
    return ASDIC_OK;
}
