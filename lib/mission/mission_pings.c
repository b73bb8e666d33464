/*
 * Where the vehicle is, and for how many pings.
 */
#include "mission_build.h"

#include "base/context.h"
#include "base/try.h"
#include "mission/track/flight.h"

#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Files round times, most to milliseconds: at 3 Hz the eleventh ping comes 0.3 ms after a last point at 3.333 s. A
 * tenth of the time between pings is not rounding. */
#define ROUNDED_S 1e-3
#define ROUNDED_PINGS 0.1

/* Pings that the track covers, the one at its start included. */
static double covered_pings(const mission_builder *b) {
    const asdic_track *track = b->mission->track;
    double rate_hz = b->mission->settings.sonar.ping_rate_hz;
    double spare = b->file->mission.track ? fmin(ROUNDED_S * rate_hz, ROUNDED_PINGS) : 1e-9;
    double start_s = asdic_track_start_s(track), end_s = asdic_track_end_s(track);
    double length_s = end_s - start_s;
    /* Times of day since 1970 are rounded to 2.4e-7 s. */
    length_s += DBL_EPSILON * fmax(fabs(start_s), fabs(end_s));
    /* 5 s at 10 Hz are 51 pings, though 5 * 10 is 49.99999999 somewhere. */
    return floor(length_s * rate_hz * (1.0 + 1e-12) + spare) + 1.0;
}

/* The number of pings of a moving vehicle. */
static void count_pings(mission_builder *b, asdic_yaml_node *path_node) {
    const file_mission *mission = &b->file->mission;
    double rate_hz = b->mission->settings.sonar.ping_rate_hz;
    if (!(rate_hz > 0.0)) {
        return; /* reported already */
    }
    double covered = covered_pings(b);
    /* What is drawn may shorten the way, of which a trial flies its own and a frame has the first ping. */
    bool is_least = (b->leaves_positions || b->many) && (double)mission->pings > covered;
    if (covered > 1e9 && mission->pings == 0) {
        asdic_yaml_problem(b->problems, path_node,
                           "'%s' covers %.15g pings, at most 1e9 are possible; give 'pings'",
                           path_node->key, covered);
    } else if (mission->pings == 0 || is_least) {
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
    if (!isnan(w->altitude_m) && !asdic_mission_is_sound(b)) {
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
    b->mission->flight = flight;
    size_t bytes = 3 * w->points.count * sizeof(double); /* the file's are not kept */
    b->mission->points_m = malloc(bytes + 1);
    if (!b->mission->points_m) {
        return asdic_fail_memory(b->ctx, "waypoints");
    }
    memcpy(b->mission->points_m, w->points.items, bytes);
    b->mission->flight.points_m = b->mission->points_m;
    return asdic_flight_fly(b->ctx, &flight, &b->mission->track, &b->missed);
}

/* The track in the file NAME, which NODE gives; *OUT stays NULL when something is wrong with it. */
static asdic_status load_track(mission_builder *b, asdic_yaml_node *node, const char *name,
                               bool of_vehicle, asdic_track **out) {
    const char *path = asdic_mission_resolve(b, name);
    size_t before = b->problems->total;
    asdic_status status = path ? asdic_track_load(b->ctx, path, of_vehicle, b->problems, out)
                               : asdic_fail_memory(b->ctx, "a path");
    return asdic_mission_file_read(b, node, before, status);
}

/* The first object whose track is that of object I; I itself when no earlier one has it. */
static size_t first_with_track(const file_object *objects, size_t i) {
    for (size_t k = 0; k < i; k++) {
        if (objects[k].track && objects[k].name &&
            strcmp(objects[k].track, objects[i].track) == 0) {
            return k;
        }
    }
    return i;
}

static int by_name(const void *a, const void *b) {
    return strcmp(((const asdic_motion *)a)->name, ((const asdic_motion *)b)->name);
}

/* Many objects may share a track: each file is read, and its errors are reported, once. */
static asdic_status build_motions(mission_builder *b) {
    const file_object *objects = b->file->objects.items;
    asdic_mission *m = b->mission;
    asdic_track **tracks = calloc(b->file->objects.count + 1, sizeof *tracks); /* borrowed */
    asdic_status status = tracks ? ASDIC_OK : asdic_fail_memory(b->ctx, "the objects' tracks");
    for (size_t i = 0; !status && i < b->file->objects.count; i++) {
        const file_object *o = &objects[i];
        asdic_yaml_node *place = asdic_yaml_child(o->node, "track");
        if (!o->track || !o->name || !asdic_scene_node_good(place)) {
            continue;
        }
        asdic_motion *motion = &m->motions[m->motion_count];
        size_t first = first_with_track(objects, i);
        snprintf(motion->name, sizeof motion->name, "%s", o->name);
        if (first == i) {
            status = load_track(b, place, o->track, false, &motion->track);
            tracks[i] = motion->track;
        } else if (tracks[first]) {
            motion->track = asdic_track_share(tracks[first]);
        }
        m->motion_count += motion->track != NULL;
    }
    qsort(m->motions, m->motion_count, sizeof *m->motions, by_name);
    free(tracks);
    return status;
}

asdic_status asdic_mission_build_tracks(mission_builder *b) {
    const asdic_scene_file *file = b->file;
    asdic_mission *m = b->mission;
    asdic_yaml_node *node = asdic_yaml_child(file->mission.node, "track");
    m->motions = calloc(file->objects.count + 1, sizeof *m->motions);
    if (!m->motions) {
        return asdic_fail_memory(b->ctx, "the objects' tracks");
    }
    if (file->mission.track && asdic_scene_node_good(node)) {
        TRY(load_track(b, node, file->mission.track, true, &m->track));
    }
    return build_motions(b);
}

asdic_status asdic_mission_build_pings(mission_builder *b) {
    const file_mission *mission = &b->file->mission;
    asdic_yaml_node *track = asdic_yaml_child(mission->node, "track");
    asdic_yaml_node *waypoints = mission->waypoints.node;
    b->mission->flight = (asdic_flight){.vehicle = ASDIC_VEHICLE_NOMOTO,
                                        .speed_mps = 1.5,
                                        .turn_radius_m = 6.0,
                                        .response_s = 1.0,
                                        .dive_rate_mps = 0.5,
                                        .altitude_m = NAN};
    size_t turn = b->mission->settings.sweep.directions;
    b->mission->ping_count = mission->pings > 0 ? (size_t)mission->pings : turn > 1 ? turn : 1;
    if (asdic_scene_node_good(waypoints)) {
        TRY(asdic_mission_file_problem(b, waypoints, fly(b)));
    }
    if (b->mission->track) {
        const asdic_track *way = b->mission->track;
        double depth_m = asdic_track_pose(way, asdic_track_start_s(way)).position_m.z;
        asdic_scene_file_check_bins(b->file, depth_m, b->problems);
        count_pings(b, track ? track : waypoints);
    }
    return ASDIC_OK;
}
