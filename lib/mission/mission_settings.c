/*
 * Settings, pings and files of a mission.
 */
#include "mission_build.h"

#include "../base/context.h"
#include "flight.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

const char *asdic_mission_resolve(const mission_builder *b, const char *name) {
    const char *scene = b->mission->path;
    const char *slash = strrchr(scene, '/');
    size_t folder = *name != '/' && slash ? (size_t)(slash - scene) + 1 : 0;
    size_t length = strlen(name);
    char *path = asdic_arena_alloc(b->arena, folder + length + 1);
    if (path) {
        memcpy(path, scene, folder);
        memcpy(path + folder, name, length + 1);
    }
    return path;
}

asdic_status asdic_mission_file_problem(mission_builder *b, asdic_yaml_node *node,
                                        asdic_status status) {
    if (status == ASDIC_ERROR_MEMORY) {
        return status;
    }
    asdic_yaml_problem(b->problems, node, "%s", asdic_context_error(b->ctx));
    return ASDIC_OK;
}

asdic_status asdic_mission_build_settings(mission_builder *b) {
    const asdic_scene_file *file = b->file;
    asdic_mission *m = b->mission;
    m->environment = asdic_scene_file_environment(file);
    m->sonar = asdic_scene_file_sonar(file);
    m->receivers = calloc(m->sonar.receiver_count + 1, sizeof *m->receivers);
    if (!m->receivers) {
        return asdic_fail_memory(b->ctx, "the receivers");
    }
    asdic_scene_file_receivers(file, m->receivers);
    m->sonar.receivers = m->receivers;
    m->sampling = (asdic_sampling){
        .rays = (uint32_t)file->sampling.rays,
        .sampler = (asdic_sampler)file->sampling.sampler,
        .multipath = (asdic_multipath)file->sampling.multipath,
        .seed = (uint64_t)file->sampling.seed,
    };
    m->detector = (asdic_detector){.target = (asdic_target)file->detector.target,
                                   .pfa = file->detector.pfa,
                                   .prior = file->detector.prior};
    m->output = (asdic_output_options){.csv = (asdic_csv_form)file->output.csv,
                                       .npy = file->output.npy,
                                       .netcdf = file->output.netcdf,
                                       .images = file->output.images};
    m->pose = asdic_scene_file_pose(file);
    return ASDIC_OK;
}

/* Pings that the track covers, the one at its start included. */
static double covered_pings(const mission_builder *b) {
    const asdic_track *track = b->mission->track;
    double length_s = asdic_track_end_s(track) - asdic_track_start_s(track);
    /* 5 s at 10 Hz are 51 pings, though 5 * 10 is 49.99999999 somewhere. */
    return floor(length_s * b->mission->sonar.ping_rate_hz * (1.0 + 1e-12) + 1e-9) + 1.0;
}

/* The number of pings of a moving vehicle. */
static void count_pings(mission_builder *b, asdic_yaml_node *path_node) {
    const file_mission *mission = &b->file->mission;
    double rate_hz = b->mission->sonar.ping_rate_hz;
    if (!(rate_hz > 0.0)) {
        return; /* reported already */
    }
    double covered = covered_pings(b);
    if (covered > 1e9 && mission->pings == 0) {
        asdic_yaml_problem(b->problems, path_node,
                           "'%s' covers %.15g pings, at most 1e9 are possible; give 'pings'",
                           path_node->key, covered);
    } else if (mission->pings == 0) {
        b->mission->ping_count = (size_t)covered;
    } else if ((double)mission->pings > covered) {
        asdic_yaml_problem(b->problems, asdic_yaml_child(mission->node, "pings"),
                           "'pings' = %lld is more than the %.15g that '%s' covers at "
                           "ping_rate_hz = %.15g; leave 'pings' out for all of it",
                           (long long)mission->pings, covered, path_node->key, rate_hz);
    }
}

static asdic_status fly(mission_builder *b) {
    const file_waypoints *w = &b->file->mission.waypoints;
    const asdic_flight flight = {.points_m = w->points.items,
                                 .count = w->points.count,
                                 .speed_mps = w->speed_mps,
                                 .turn_radius_m = w->turn_radius_m,
                                 .response_s = w->response_s,
                                 .dive_rate_mps = w->dive_rate_mps};
    return asdic_flight_fly(b->ctx, &flight, &b->mission->track);
}

asdic_status asdic_mission_build_pings(mission_builder *b) {
    const file_mission *mission = &b->file->mission;
    asdic_yaml_node *track = asdic_yaml_child(mission->node, "track");
    asdic_yaml_node *waypoints = mission->waypoints.node;
    asdic_status status = ASDIC_OK;
    b->mission->ping_count = mission->pings > 0 ? (size_t)mission->pings : 1;
    if (mission->track && asdic_scene_node_good(track)) {
        const char *path = asdic_mission_resolve(b, mission->track);
        status = path ? asdic_track_load(b->ctx, path, &b->mission->track)
                      : asdic_fail_memory(b->ctx, "a path");
    } else if (asdic_scene_node_good(waypoints)) {
        status = fly(b);
    }
    asdic_yaml_node *node = track ? track : waypoints;
    if (status != ASDIC_OK) {
        return asdic_mission_file_problem(b, node, status);
    }
    if (b->mission->track) {
        count_pings(b, node);
    }
    return ASDIC_OK;
}
