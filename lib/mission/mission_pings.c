/*
 * Where the vehicle is, and for how many pings.
 */
#include "mission_build.h"

#include "../base/context.h"
#include "flight.h"

#include <math.h>

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

static double bottom_below_m(const void *user, double north_m, double east_m) {
    return asdic_mission_bottom_m(user, (asdic_vec3){north_m, east_m, 0.0});
}

static asdic_status fly(mission_builder *b) {
    const file_waypoints *w = &b->file->mission.waypoints;
    if (!isnan(w->altitude_m) && b->problems->total > 0) {
        return ASDIC_OK; /* there may be no bottom yet to be followed */
    }
    const asdic_flight flight = {.points_m = w->points.items,
                                 .count = w->points.count,
                                 .speed_mps = w->speed_mps,
                                 .turn_radius_m = w->turn_radius_m,
                                 .response_s = w->response_s,
                                 .dive_rate_mps = w->dive_rate_mps,
                                 .vehicle = (asdic_vehicle)w->vehicle,
                                 .current_mps = {w->current_mps[0], w->current_mps[1]},
                                 .altitude_m = w->altitude_m,
                                 .bottom_m = bottom_below_m,
                                 .user = b->mission->scene};
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
