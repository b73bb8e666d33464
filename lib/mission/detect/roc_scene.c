/*
 * A target in a scene: its strength in a bin, and what else is in that bin.
 */
#include <asdic/roc.h>
#include <asdic/scan.h>

#include "base/context.h"
#include "base/memory_left.h"
#include "base/text.h"
#include "base/try.h"
#include "base/vec.h"
#include "detect/law.h"
#include "detect/roc_curve.h"
#include "detect_background.h"
#include "heard_range.h"
#include "mission/mission.h"
#include "mission/run/run_summary.h"
#include "scene/scene.h"
#include "sim/eigenray.h"
#include "sim/pulse.h"
#include "sim/ring.h"
#include "sim/environment.h"

#include "../../../kernels/ray.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Ranges at which P_D is computed; draws for each. */
#define MOST_RANGES 100
/* Draws at each, if as many are asked for. */
#define MOST_REACH_TRIALS 20000u
/* Steps to the distance of what is heard at a range; each leaves some hundredths of what is off. */
#define NEARER 2
/* Of a draw with the target and one without, while the area is found. */
#define TRIAL_BYTES 80u

/* Where the target is, from the sonar: bearings round AZIMUTH_RAD, which is from north, and depths
 * below it. A target of a given range is a point, level with the sonar. */
typedef struct extent {
    double azimuth_rad, port_rad, starboard_rad; /* -pi..0, 0..pi */
    double top_m, foot_m;
} extent;

typedef struct scene_job {
    asdic_context *ctx;
    const asdic_mission *mission;
    const asdic_roc_options *options;
    asdic_sonar sonar; /* with speckle */
    asdic_water_column water;
    asdic_heard_water heard;
    asdic_pose pose;
    extent target;
    double near_m, far_m; /* between which an object is heard */
    size_t object;        /* in the mission, where one is asked for */
    int number;           /* that of truth, where it has to be told from others; else 0 */
    size_t beams, bins;
    bool is_plane;        /* quadrature knows what is expected */
    asdic_ping *ping;     /* simulated, its total without speckle */
    asdic_ping *expected; /* the null hypothesis */
    asdic_uncertainty uncertainty;
    double *rest_lin;  /* simulated: all but the echoes of the object, or objects */
    double *fixed_lin; /* what of it K speckle gives no texture: noise, mirrors, other objects */
} scene_job;

asdic_roc_options asdic_roc_options_default(void) {
    return (asdic_roc_options){.range_m = NAN,
                               .target_strength_db = NAN,
                               .target = ASDIC_TARGET_SWERLING1,
                               .pfa = 1e-3,
                               .trials = 1000000,
                               .seed = 1};
}

/* Of the names that an error tells. */
#define MOST_NAMES 8

static asdic_status fail_object(const scene_job *job, const char *name) {
    const asdic_mission *m = job->mission;
    asdic_text names = {0};
    for (size_t i = 0, named = 0; i < m->object_count && named <= MOST_NAMES; i++) {
        if (m->objects[i].name[0] && named++ < MOST_NAMES) {
            asdic_text_format(&names, "%s '%s'", named > 1 ? "," : "; it has", m->objects[i].name);
        } else if (named > MOST_NAMES) {
            asdic_text_add(&names, ", ...");
        }
    }
    asdic_status status =
        asdic_fail(job->ctx, ASDIC_ERROR_ARGUMENT, "the scene has no object '%s'%s", name,
                   names.data ? names.data : "");
    asdic_text_finish(&names);
    return status;
}

/* The object asked for. Truth numbers objects from 1 on; a bottom that is listed with them has no name. */
static asdic_status find_object(scene_job *job) {
    const asdic_mission *m = job->mission;
    const char *name = job->options->object;
    int named = 0;
    bool is_there = !name;
    for (size_t i = 0; name && i < m->object_count; i++) {
        named += m->objects[i].name[0] != 0;
        if (name[0] && strcmp(m->objects[i].name, name) == 0) {
            job->object = i;
            job->number = named;
            job->uncertainty.db[ASDIC_OBJECT] = asdic_mission_object_uncertainty_db(m, i);
            is_there = true;
        }
    }
    job->number = named > 1 ? job->number : 0;
    return is_there ? ASDIC_OK : fail_object(job, name);
}

static asdic_status ping_with(scene_job *job, asdic_simulator *sim) {
    job->bins = asdic_simulator_bin_count(sim);
    TRY(asdic_ping_create(job->ctx, job->beams, job->bins, &job->ping));
    if (job->number) {
        TRY(asdic_ping_add_truth(job->ctx, job->ping));
    }
    TRY(asdic_mission_place(job->mission, sim, job->options->ping));
    TRY(asdic_simulator_learn(sim, &job->pose, job->options->ping));
    return asdic_simulator_ping(sim, &job->pose, job->options->ping, job->ping);
}

static asdic_status simulate(scene_job *job, asdic_device *device) {
    const asdic_mission *m = job->mission;
    asdic_simulator *sim = NULL;
    asdic_sonar quiet = job->sonar;
    asdic_sampling sampling = m->settings.sampling;
    quiet.speckle = ASDIC_SPECKLE_NONE;
    sampling.truth = job->number != 0;
    sampling.coherent = false; /* means are wanted, and what each component has of them */
    TRY(asdic_simulator_create(job->ctx, device, m->scene, &m->settings.environment, &quiet,
                               &sampling, asdic_mission_pose(m, 0, NULL).position_m.z, &sim));
    asdic_status status = ping_with(job, sim);
    asdic_simulator_destroy(&sim);
    return status;
}

/* Whether an object other than that asked for is the loudest in CELL: truth tells no more of the others. */
static bool is_of_another(const scene_job *job, size_t cell) {
    int loudest = job->number ? job->ping->truth->object[cell] : 0;
    return loudest != 0 && loudest != job->number;
}

/* The echo in CELL of the object asked for, without what is_of_another. */
static double object_lin(const scene_job *job, size_t cell) {
    double all_lin = job->ping->intensity_lin[ASDIC_OBJECT][cell];
    if (!job->number) {
        return all_lin;
    }
    double share = is_of_another(job, cell) ? 0.0 : (double)job->ping->truth->object_share[cell];
    return fmin(share * job->ping->intensity_lin[ASDIC_TOTAL][cell], all_lin);
}

static asdic_status expect(scene_job *job) {
    const asdic_mission *m = job->mission;
    asdic_flat_scene flat = asdic_mission_flat_scene(m, job->options->ping);
    asdic_scene_info info = asdic_scene_get_info(m->scene);
    bool is_mesh = flat.has_bottom && !info.has_bottom_plane;
    job->is_plane = !is_mesh && !asdic_flat_scene_mirrors(&flat, &m->settings.sampling);
    TRY(asdic_ping_create(job->ctx, job->beams, job->bins, &job->expected));
    job->rest_lin = calloc(2 * job->beams * job->bins, sizeof *job->rest_lin);
    if (!job->rest_lin) {
        return asdic_fail_memory(job->ctx, "a background");
    }
    job->fixed_lin = job->rest_lin + job->beams * job->bins;
    if (job->is_plane) {
        TRY(asdic_expected_compute(job->ctx, &flat, &m->settings.environment, &job->sonar,
                                   &job->pose, job->expected));
    }
    double *const *part = job->ping->intensity_lin;
    for (size_t i = 0; i < job->beams * job->bins; i++) {
        job->fixed_lin[i] = part[ASDIC_MULTIPATH][i] + part[ASDIC_NOISE][i];
        if (job->number) {
            job->fixed_lin[i] += part[ASDIC_OBJECT][i] - object_lin(job, i);
        }
        job->rest_lin[i] = part[ASDIC_BOTTOM][i] + part[ASDIC_SURFACE][i] + part[ASDIC_VOLUME][i] +
                           job->fixed_lin[i];
        if (!job->is_plane) {
            job->expected->intensity_lin[ASDIC_TOTAL][i] = job->rest_lin[i];
        }
    }
    return ASDIC_OK;
}

static double within(double value, double low, double high) {
    return fmin(fmax(value, low), high);
}

/* That part of the target, at RANGE_M, to which BEAM looks most directly; 0 where the target is deeper or
 * higher than far. */
static asdic_vec3 direction_of_target(const scene_job *job, size_t beam, double range_m) {
    const extent *t = &job->target;
    asdic_vec3 axis = asdic_beam_axis(&job->sonar.receivers[beam], &job->pose);
    double turn = remainder(atan2(axis.y, axis.x) - t->azimuth_rad, 2.0 * ASDIC_PI);
    double azimuth = t->azimuth_rad + within(turn, t->port_rad, t->starboard_rad);
    double depth = within(range_m * axis.z, t->top_m, t->foot_m);
    if (fabs(depth) > range_m + job->sonar.bin_length_m) {
        return (asdic_vec3){0};
    }
    double sine = within(depth / range_m, -1.0, 1.0), cosine = sqrt(1.0 - sine * sine);
    return (asdic_vec3){cosine * cos(azimuth), cosine * sin(azimuth), sine};
}

/* How far off the point of the target is that BEAM hears at RANGE_M: as far, but where rays bend. */
static double distance_m(const scene_job *job, size_t beam, double range_m) {
    double far_m = range_m;
    for (int i = 0; i < NEARER && job->heard.bends; i++) {
        asdic_vec3 to_m = asdic_vec3_scale(direction_of_target(job, beam, far_m), far_m);
        double heard_m = asdic_heard_range_m(&job->heard, to_m);
        far_m *= heard_m > 0.0 ? range_m / heard_m : 1.0;
    }
    return far_m;
}

/* Both patterns of BEAM in the direction U. */
static double gain_lin(const scene_job *job, size_t beam, asdic_vec3 u) {
    const asdic_beam *apertures[2] = {&job->sonar.transmitter, &job->sonar.receivers[beam]};
    double rear_lin = pow(10.0, 0.1 * job->sonar.rear_floor_db), gain = 1.0;
    for (int i = 0; i < 2; i++) {
        asdic_face face = asdic_face_aim(apertures[i], &job->pose, job->water.wavelength_m);
        gain *= asdic_face_gain(&face, u, rear_lin);
    }
    return gain;
}

/* What comes back to BEAM of a source of 1 at 1 m from a point of 0 dB at RANGE_M in the direction U, by the rays that
 * bend there: by the loudest, and none in their shadow. */
static double bent_echo_lin(const scene_job *job, size_t beam, double range_m, asdic_vec3 u) {
    const asdic_layers *layers = &job->heard.layers;
    double z = job->pose.position_m.z, level = hypot(u.x, u.y), loudest = 0.0;
    asdic_eigenray rays[ASDIC_MOST_EIGENRAYS];
    size_t count = asdic_eigenrays_find(layers, z, z + range_m * u.z, range_m * level, rays);
    for (size_t i = 0; i < count; i++) {
        double way_m = job->water.sound_speed_mps * rays[i].end.time_s;
        double spread = asdic_bent_ray_limited_m2(&rays[i].end, way_m);
        double cosine = cos(rays[i].elevation_rad) / level;
        asdic_vec3 leaves = {cosine * u.x, cosine * u.y, sin(rays[i].elevation_rad)};
        double loss = exp(-2.0 * job->water.absorption_np_per_m * (rays[i].end.length_m - 1.0));
        if (asdic_eigenray_keeps_between(layers, z, range_m * level, &rays[i], job->heard.top_m,
                                         job->heard.bottom_m)) {
            loudest = fmax(loudest, gain_lin(job, beam, leaves) * loss / (spread * spread));
        }
    }
    return loudest;
}

/* Echo in BEAM of a point of 0 dB where the target is that is heard at RANGE_M, in the bin of that range: the pulse may
 * be longer. 0 where that is no water. */
static double echo_lin(const scene_job *job, size_t beam, double range_m) {
    const asdic_scene *scene = job->mission->scene;
    const asdic_environment *env = &job->mission->settings.environment;
    const asdic_sonar *sonar = &job->sonar;
    double z = job->pose.position_m.z, far_m = distance_m(job, beam, range_m);
    asdic_vec3 u = direction_of_target(job, beam, far_m);
    if (asdic_vec3_length(u) == 0.0 || (scene->has_surface && z < 0.0) ||
        (scene->has_bottom_plane && z > scene->bottom_plane_depth_m)) {
        return 0.0;
    }
    size_t bin = (size_t)(range_m / sonar->bin_length_m);
    bool bends = job->heard.bends && hypot(u.x, u.y) > 0.0;
    double back =
        bends ? bent_echo_lin(job, beam, far_m, u)
              : gain_lin(job, beam, u) * ray_transmission(job->water.absorption_np_per_m, far_m);
    return back * asdic_pulse_share(sonar, job->water.sound_speed_mps, bin) *
           asdic_water_column_source_lin(&job->water, env, sonar);
}

/* How far the mean is off, dB, when the laws err by SIGN times what their sources state. */
static double background_error_db(const scene_job *job, size_t cell, double sign) {
    static const asdic_component parts[] = {ASDIC_BOTTOM, ASDIC_SURFACE};
    const asdic_ping *ping = job->is_plane ? job->expected : job->ping;
    double mean = job->expected->intensity_lin[ASDIC_TOTAL][cell], shift = 0.0;
    for (int i = 0; i < 2; i++) {
        double db = job->uncertainty.db[parts[i]];
        double factor = isnan(db) ? 1.0 : pow(10.0, 0.1 * sign * db);
        shift += ping->intensity_lin[parts[i]][cell] * (factor - 1.0);
    }
    return mean > 0.0 ? 10.0 * log10(1.0 + shift / mean) : 0.0;
}

static asdic_roc_case case_of(const scene_job *job, size_t cell) {
    double mean = job->expected->intensity_lin[ASDIC_TOTAL][cell];
    const double *fixed_lin =
        job->is_plane ? job->expected->intensity_lin[ASDIC_NOISE] : job->fixed_lin;
    asdic_roc_case c = {.none = asdic_background_of(&job->sonar, job->water.sound_speed_mps, mean,
                                                    fixed_lin[cell])};
    c.rest = c.none;
    c.background_most_db = background_error_db(job, cell, 1.0);
    c.background_least_db = background_error_db(job, cell, -1.0);
    return c;
}

/* Of what lies between the corners LOW and HIGH, from the sonar; the part in the water. */
static extent extent_of(const scene_job *job, asdic_vec3 low, asdic_vec3 high) {
    const asdic_scene *scene = job->mission->scene;
    double z = job->pose.position_m.z;
    extent e = {.azimuth_rad = atan2(0.5 * (low.y + high.y), 0.5 * (low.x + high.x)),
                .top_m = scene->has_surface ? fmax(low.z, -z) : low.z,
                .foot_m = scene->has_bottom_plane ? fmin(high.z, scene->bottom_plane_depth_m - z)
                                                  : high.z};
    bool is_round = low.x <= 0.0 && high.x >= 0.0 && low.y <= 0.0 && high.y >= 0.0;
    e.port_rad = is_round ? -ASDIC_PI : 0.0;
    e.starboard_rad = is_round ? ASDIC_PI : 0.0;
    for (int corner = 0; corner < 4; corner++) {
        double x = corner & 1 ? high.x : low.x, y = corner & 2 ? high.y : low.y;
        double turn = remainder(atan2(y, x) - e.azimuth_rad, 2.0 * ASDIC_PI);
        e.port_rad = fmin(e.port_rad, turn);
        e.starboard_rad = fmax(e.starboard_rad, turn);
    }
    return e;
}

/* The box round object O, from the sonar: round its first box, moved and turned as it is at the ping. */
static void box_of_object(const scene_job *job, const asdic_mission_object *o, asdic_vec3 *low,
                          asdic_vec3 *high) {
    asdic_pose now = asdic_mission_object_pose(job->mission, job->object, job->options->ping);
    asdic_move move = asdic_move_between(&o->pose, &now);
    *low = (asdic_vec3){INFINITY, INFINITY, INFINITY};
    *high = (asdic_vec3){-INFINITY, -INFINITY, -INFINITY};
    for (int corner = 0; corner < 8; corner++) {
        asdic_vec3 v = {corner & 1 ? o->max_m.x : o->min_m.x, corner & 2 ? o->max_m.y : o->min_m.y,
                        corner & 4 ? o->max_m.z : o->min_m.z};
        v = o->moves ? asdic_move_point(&move, v) : v;
        v = asdic_vec3_sub(v, job->pose.position_m);
        *low = (asdic_vec3){fmin(low->x, v.x), fmin(low->y, v.y), fmin(low->z, v.z)};
        *high = (asdic_vec3){fmax(high->x, v.x), fmax(high->y, v.y), fmax(high->z, v.z)};
    }
}

/* The ranges between which what lies between the corners LOW and HIGH is heard: those of its near and its far side, at
 * its top, its foot, and level with the sonar. */
static void hear_box(scene_job *job, asdic_vec3 low, asdic_vec3 high) {
    double across_m[2] = {hypot(fmax(fmax(low.x, -high.x), 0.0), fmax(fmax(low.y, -high.y), 0.0)),
                          hypot(fmax(fabs(low.x), fabs(high.x)), fmax(fabs(low.y), fabs(high.y)))};
    double down_m[3] = {low.z, high.z, within(0.0, low.z, high.z)};
    job->near_m = INFINITY;
    job->far_m = 0.0;
    for (int i = 0; i < 6; i++) {
        double range_m =
            asdic_heard_range_m(&job->heard, (asdic_vec3){across_m[i % 2], 0.0, down_m[i / 2]});
        job->near_m = fmin(job->near_m, range_m);
        job->far_m = fmax(job->far_m, range_m);
    }
}

/* The range bins between which the object is heard, by its box, and where it is. */
static asdic_status bins_of_object(scene_job *job, size_t *first, size_t *end) {
    const asdic_mission_object *o = &job->mission->objects[job->object];
    double bin_m = job->sonar.bin_length_m;
    asdic_vec3 low, high;
    box_of_object(job, o, &low, &high);
    hear_box(job, low, high);
    job->target = extent_of(job, low, high);
    double begin = floor(job->near_m / bin_m) - 1.0, last = ceil(job->far_m / bin_m) + 1.0;
    *first = (size_t)fmin(fmax(begin, 0.0), (double)job->bins);
    *end = (size_t)fmin(last, (double)job->bins);
    return *first < *end ? ASDIC_OK
                         : asdic_fail(job->ctx, ASDIC_ERROR_ARGUMENT,
                                      "object '%s' is beyond the sonar's range of %g m", o->name,
                                      (double)job->bins * bin_m);
}

/* Beams first <= beam < end. */
static asdic_status choose_beams(const scene_job *job, size_t *first, size_t *end) {
    *first = 0;
    *end = job->beams;
    if (job->options->beam) {
        TRY(asdic_find_beam(job->ctx, &job->sonar, job->options->beam, first));
        *end = *first + 1;
    }
    return ASDIC_OK;
}

/* The bins in which the target may be. */
static asdic_status find_bins(scene_job *job, size_t *first, size_t *end) {
    const asdic_roc_options *o = job->options;
    double bin = floor(o->range_m / job->sonar.bin_length_m);
    if (o->object) {
        return bins_of_object(job, first, end);
    }
    if (!(bin >= 0.0 && bin < (double)job->bins)) {
        return asdic_fail(job->ctx, ASDIC_ERROR_ARGUMENT,
                          "a range of %g m: the sonar's bins end at %g m", o->range_m,
                          (double)job->bins * job->sonar.bin_length_m);
    }
    if (o->range_m < job->sonar.blanking_m) {
        return asdic_fail(job->ctx, ASDIC_ERROR_ARGUMENT,
                          "a range of %g m: the sonar is blanked to %g m", o->range_m,
                          job->sonar.blanking_m);
    }
    *first = (size_t)bin;
    *end = *first + 1;
    return ASDIC_OK;
}

/* The target in CELL, a bin of BEAM. */
static asdic_roc_case target_in(const scene_job *job, size_t beam, size_t cell) {
    const asdic_roc_options *o = job->options;
    asdic_roc_case c = case_of(job, cell);
    if (o->object) {
        c.rest = asdic_background_of(&job->sonar, job->water.sound_speed_mps,
                                     fmax(job->rest_lin[cell], 1e-12 * c.none.mean_lin),
                                     job->fixed_lin[cell]);
        c.target_lin = object_lin(job, cell);
        double db = job->uncertainty.db[ASDIC_OBJECT];
        c.target_error_db = isnan(db) ? 0.0 : db;
    } else {
        c.target_lin = echo_lin(job, beam, o->range_m) * pow(10.0, 0.1 * o->target_strength_db);
    }
    return c;
}

/* The cell in which the target stands out most, and its case. */
static asdic_status find_cell(scene_job *job, size_t *cell, asdic_roc_case *found) {
    size_t beam, beam_end, first = 0, end = 0;
    double best = -1.0;
    bool is_hidden = false;
    TRY(choose_beams(job, &beam, &beam_end));
    TRY(find_bins(job, &first, &end));
    for (; beam < beam_end; beam++) {
        for (size_t at = beam * job->bins + first; at < beam * job->bins + end; at++) {
            if (is_of_another(job, at) || !(case_of(job, at).none.mean_lin > 0.0)) {
                is_hidden = is_hidden || is_of_another(job, at);
                continue;
            }
            asdic_roc_case c = target_in(job, beam, at);
            if (c.target_lin / c.none.mean_lin > best) {
                best = c.target_lin / c.none.mean_lin;
                *cell = at;
                *found = c;
            }
        }
    }
    if (is_hidden && best <= 0.0) {
        return asdic_fail(job->ctx, ASDIC_ERROR_ARGUMENT,
                          "other objects are louder than '%s' wherever it may be heard",
                          job->options->object);
    }
    if (best < 0.0) {
        return asdic_fail(job->ctx, ASDIC_ERROR_ARGUMENT,
                          "nothing is received from there: no background to detect against");
    }
    return ASDIC_OK;
}

static asdic_status fill_reach(const scene_job *job, size_t beam, asdic_roc *roc) {
    size_t step = (job->bins + MOST_RANGES - 1) / MOST_RANGES;
    uint64_t asked = job->options->trials;
    uint64_t trials = asked < MOST_REACH_TRIALS ? asked : MOST_REACH_TRIALS;
    roc->reach = calloc(job->bins / step + 1, sizeof *roc->reach);
    if (!roc->reach) {
        return asdic_fail_memory(job->ctx, "ranges");
    }
    for (size_t n = step / 2; n < job->bins; n += step) {
        TRY(asdic_step(job->ctx, "bins", n, job->bins));
        double range_m = ((double)n + 0.5) * job->sonar.bin_length_m, threshold;
        asdic_roc_case c = case_of(job, beam * job->bins + n);
        c.target_lin = echo_lin(job, beam, range_m) * pow(10.0, 0.1 * roc->target_strength_db);
        if (!(c.none.mean_lin > 0.0) || !(c.target_lin > 0.0) || range_m < job->sonar.blanking_m) {
            continue;
        }
        TRY(asdic_detect_threshold(job->ctx, &c.none, roc->pfa, &threshold));
        asdic_band model_pd;
        TRY(asdic_roc_band(job->ctx, &c, job->options->target, roc->pfa, &model_pd));
        roc->reach[roc->reach_count++] = (asdic_roc_reach){
            .range_m = range_m,
            .snr_db = asdic_level_db(c.target_lin / c.none.mean_lin),
            .pd = asdic_detect_simulate(&c.none, job->options->target, c.target_lin, threshold,
                                        trials, job->options->seed + n),
            .closed_pd = asdic_detect_pd(&c.none, job->options->target, c.target_lin, threshold),
            .model_pd = model_pd};
    }
    return ASDIC_OK;
}

static asdic_status check(asdic_context *ctx, const asdic_mission *mission,
                          const asdic_roc_options *o) {
    bool has_range = isfinite(o->range_m) && isfinite(o->target_strength_db);
    if (o->object ? isfinite(o->range_m) : !has_range) {
        return asdic_fail(ctx, ASDIC_ERROR_ARGUMENT,
                          "a target is an object of the scene, or a range with a target strength");
    }
    if (!asdic_target_is_known(o->target)) {
        return asdic_fail(ctx, ASDIC_ERROR_ARGUMENT, "a target of no kind, %d", (int)o->target);
    }
    if (!isfinite(o->bearing_rad)) {
        return asdic_fail(ctx, ASDIC_ERROR_ARGUMENT, "a target's bearing of %g rad is not finite",
                          o->bearing_rad);
    }
    if (o->ping >= asdic_mission_ping_count(mission)) {
        return asdic_fail(ctx, ASDIC_ERROR_ARGUMENT, "ping %zu of a mission of %zu", o->ping,
                          asdic_mission_ping_count(mission));
    }
    if (o->trials < 1000 || o->trials > 100000000 ||
        !(o->pfa >= ASDIC_DETECTOR_MIN_PFA && o->pfa <= ASDIC_DETECTOR_MAX_PFA)) {
        return asdic_fail(
            ctx, ASDIC_ERROR_ARGUMENT, "%llu trials (1000 to 1e8) at a P_FA of %g (in [%g, %g])",
            (unsigned long long)o->trials, o->pfa, ASDIC_DETECTOR_MIN_PFA, ASDIC_DETECTOR_MAX_PFA);
    }
    char what[64];
    snprintf(what, sizeof what, "%llu trials need", (unsigned long long)o->trials);
    return asdic_memory_check(ctx, o->trials * TRIAL_BYTES, asdic_memory_left(), what, "use fewer");
}

/* In the middle of what of the object BIN holds: it may be a point anywhere in the bin. */
static double object_range_m(const scene_job *job, size_t bin) {
    double begin_m = (double)bin * job->sonar.bin_length_m;
    double end_m = begin_m + job->sonar.bin_length_m;
    return 0.5 *
           (within(begin_m, job->near_m, job->far_m) + within(end_m, job->near_m, job->far_m));
}

static void describe(const scene_job *job, size_t cell, const asdic_roc_case *c, asdic_roc *roc) {
    size_t beam = cell / job->bins;
    roc->bin = cell % job->bins;
    memcpy(roc->beam, job->sonar.receivers[beam].name, sizeof roc->beam);
    roc->range_m = job->options->object ? ((double)roc->bin + 0.5) * job->sonar.bin_length_m
                                        : job->options->range_m;
    roc->background = c->none;
    roc->background_error_db = job->is_plane ? 0.0 : (double)job->ping->stderr_db[cell];
    bool is_stated = c->background_most_db != 0.0;
    roc->background_uncertainty_db = is_stated ? c->background_most_db : NAN;
    roc->target_uncertainty_db = c->target_error_db != 0.0 ? c->target_error_db : NAN;
    roc->background_db = asdic_level_db(c->none.mean_lin);
    roc->target_db = asdic_level_db(c->target_lin);
    roc->snr_db = asdic_level_db(c->target_lin / c->none.mean_lin);
    roc->target_strength_db = job->options->target_strength_db;
    if (job->options->object) { /* of the point that would be as strong */
        double range_m = object_range_m(job, roc->bin);
        roc->target_strength_db = asdic_level_db(c->target_lin / echo_lin(job, beam, range_m));
    }
}

/* An area under the curve up to this is chance. */
#define CHANCE 0.501

static void remark_chance(const asdic_roc_options *o, asdic_roc *roc) {
    char what[96], heard[40] = "is not heard by any beam";
    if (roc->closed_area > CHANCE) {
        return;
    }
    if (o->object) {
        snprintf(what, sizeof what, "object '%s'", o->object);
    } else {
        snprintf(what, sizeof what, "a target at %.4g m and a bearing of %.4g degrees", o->range_m,
                 o->bearing_rad * (180.0 / ASDIC_PI));
    }
    if (isfinite(roc->snr_db)) {
        snprintf(heard, sizeof heard, "is %.3g dB below its background", -roc->snr_db);
    }
    snprintf(roc->remark, sizeof roc->remark, "%s %s: it is detected as often as nothing is", what,
             heard);
}

static asdic_status compute(scene_job *job, asdic_device *device, asdic_roc *roc) {
    const asdic_roc_options *options = job->options;
    size_t cell = 0;
    asdic_roc_case c;
    TRY(find_object(job));
    TRY(simulate(job, device));
    TRY(expect(job));
    TRY(find_cell(job, &cell, &c));
    roc->trials = (size_t)options->trials;
    roc->pfa = options->pfa;
    describe(job, cell, &c, roc);
    TRY(asdic_roc_fill(job->ctx, &c, options, roc));
    remark_chance(options, roc);
    return isfinite(roc->target_strength_db) ? fill_reach(job, cell / job->bins, roc) : ASDIC_OK;
}

asdic_status asdic_roc_compute(asdic_context *ctx, const asdic_mission *mission,
                               asdic_device *device, const asdic_roc_options *options,
                               asdic_roc **out) {
    if (!ASDIC_PLACE(out) || !mission || !device || !options) {
        return asdic_fail_null(ctx, __func__);
    }
    TRY(check(ctx, mission, options));
    scene_job job = {.ctx = ctx,
                     .mission = mission,
                     .options = options,
                     .sonar = mission->settings.sonar,
                     .pose = asdic_mission_pose(mission, options->ping, NULL),
                     .uncertainty = asdic_mission_uncertainty(mission),
                     .beams = mission->settings.sonar.receiver_count};
    job.target.azimuth_rad =
        asdic_mission_vehicle_pose(mission, options->ping, NULL).yaw_rad + options->bearing_rad;
    if (job.sonar.speckle == ASDIC_SPECKLE_NONE) {
        job.sonar.speckle = ASDIC_SPECKLE_RAYLEIGH;
    }
    job.water =
        asdic_water_column_at(&mission->settings.environment, &job.sonar, job.pose.position_m.z);
    job.heard =
        asdic_heard_water_of(&mission->settings.environment, mission->scene, job.pose.position_m.z);
    asdic_roc *roc = calloc(1, sizeof *roc);
    asdic_status status = roc ? compute(&job, device, roc) : asdic_fail_memory(ctx, "a curve");
    if (status) {
        asdic_roc_destroy(&roc);
    }
    asdic_ping_destroy(&job.ping);
    asdic_ping_destroy(&job.expected);
    free(job.rest_lin);
    *out = roc;
    return status;
}
