/*
 * Checks that sonar, bottom and objects are where they can meet.
 */
#include "mission_build.h"

#include "base/context.h"

#include <math.h>
#include <stdio.h>

/* Poses tested against a bottom that is no plane. Of longer missions every so many are tested. */
#define MAX_TESTED_PINGS 10000

/* Two points of a track have a gap between them when they are this many times farther apart than
 * the others on average. */
#define GAP_RATIO 10.0
/* A track of fewer points is written by hand, at any times: it has no gaps. */
#define RECORDED_POINTS 20

/* A depth above which no bottom lies. */
#define ABOVE_ALL_M (-1e6)

double asdic_mission_bottom_m(const asdic_scene *scene, asdic_vec3 position_m) {
    position_m.z = ABOVE_ALL_M;
    return ABOVE_ALL_M + asdic_scene_altitude_m(scene, position_m);
}

static void check_depths(mission_builder *b) {
    const asdic_mission *m = b->mission;
    const asdic_yaml_node *mission = b->file->mission.node;
    const char *kind = !m->track ? "pose" : b->file->mission.track ? "track" : "waypoints";
    asdic_yaml_node *node = asdic_yaml_child(mission, kind);
    size_t step = m->ping_count / MAX_TESTED_PINGS + 1;
    size_t last = m->track ? m->ping_count : 1;
    for (size_t i = 0; i < last; i += step) {
        double time_s;
        asdic_pose pose = asdic_mission_pose(m, i, &time_s);
        double depth_m = asdic_mission_bottom_m(m->scene, pose.position_m);
        /* A mesh in float is not exact to the last digit. */
        if (pose.position_m.z > depth_m + 1e-6 * fabs(depth_m)) {
            asdic_yaml_problem(b->problems, node,
                               "ping %zu at %.15g s: the sonar is at z = %.6g m, below the bottom "
                               "at %.6g m; raise it or lower the bottom",
                               i, time_s, pose.position_m.z, depth_m);
            return;
        }
    }
}

/* The values of a bottom that is wholly above the surface have the wrong sign. */
static void check_bottom_depth(mission_builder *b) {
    const file_bottom *bottom = &b->file->bottom;
    asdic_yaml_node *node = bottom->grid.node ? bottom->grid.node : bottom->mesh.node;
    if (!node || b->mission->object_count == 0 || b->mission->objects[0].max_m.z >= 0.0) {
        return;
    }
    const char *remedy = bottom->mesh.node ? (bottom->mesh.z_up ? "z_up: false" : "z_up: true")
                         : bottom->grid.values == FILE_GRID_DEPTHS ? "values: heights"
                                                                   : "values: depths";
    asdic_yaml_problem(b->problems, asdic_yaml_child(node, "file"),
                       "the bottom lies above the sea surface, from z = %.6g to %.6g m; give '%s' "
                       "if it is upside down, or 'position_m'",
                       b->mission->objects[0].min_m.z, b->mission->objects[0].max_m.z, remedy);
}

/* Many programs for models have y up: such a bottom stands like a wall. */
static void remark_on_bottom(mission_builder *b) {
    const file_bottom *bottom = &b->file->bottom;
    const double *turn_deg = bottom->rotation_deg;
    if (!bottom->mesh.node || turn_deg[0] != 0.0 || turn_deg[1] != 0.0) {
        return;
    }
    const asdic_vec3 *low = &b->mission->objects[0].min_m, *high = &b->mission->objects[0].max_m;
    double north_m = high->x - low->x, east_m = high->y - low->y, down_m = high->z - low->z;
    if (down_m > 2.0 * fmin(north_m, east_m)) {
        asdic_log(b->ctx, ASDIC_LOG_WARNING,
                  "%s:%u:%u: warning: the bottom stands upright: %.4g m north, %.4g m east, %.4g m "
                  "down; if its file has y up, give 'rotation_deg: [0, 90, 0]'  [bottom.mesh]",
                  b->problems->name, bottom->mesh.node->line, bottom->mesh.node->column, north_m,
                  east_m, down_m);
    }
}

static void remark(mission_builder *b, size_t object, const char *text) {
    const file_object *objects = b->file->objects.items;
    const asdic_yaml_node *node = objects[object].node;
    asdic_log(b->ctx, ASDIC_LOG_WARNING, "%s:%u:%u: warning: object '%s' %s  [objects[%zu]]",
              b->problems->name, node->line, node->column, objects[object].name, text, object);
}

/* From POSITION to the nearest point of the box round OBJECT. */
static double distance_m(const asdic_mission_object *object, asdic_vec3 position_m) {
    const asdic_vec3 *low = &object->min_m, *high = &object->max_m;
    double x = fmax(fmax(low->x - position_m.x, position_m.x - high->x), 0.0);
    double y = fmax(fmax(low->y - position_m.y, position_m.y - high->y), 0.0);
    double z = fmax(fmax(low->z - position_m.z, position_m.z - high->z), 0.0);
    return sqrt(x * x + y * y + z * z);
}

static void remark_on_objects(mission_builder *b) {
    const asdic_mission *m = b->mission;
    size_t first = m->object_count - b->file->objects.count; /* the bottom may be before them */
    asdic_pose pose = asdic_mission_pose(m, 0, NULL);
    double range_m = asdic_sonar_max_range_m(
        &m->settings.sonar,
        asdic_environment_sound_speed_mps(&m->settings.environment, pose.position_m.z));
    for (size_t i = first; i < m->object_count; i++) {
        const asdic_mission_object *object = &m->objects[i];
        if (object->moves) {
            continue;
        }
        if (object->max_m.z < 0.0) {
            remark(b, i - first, "lies above the sea surface; z is positive down");
        } else if (!m->track && distance_m(object, pose.position_m) > range_m) {
            remark(b, i - first, "is beyond the maximum range");
        }
    }
}

/* A recorder may stop for a while: a simulation then flies a straight line. */
static void remark_on_gap(mission_builder *b) {
    const asdic_mission *m = b->mission;
    const asdic_yaml_node *node = asdic_yaml_child(b->file->mission.node, "track");
    size_t points = node && m->track ? asdic_track_point_count(m->track) : 0;
    if (points < RECORDED_POINTS) {
        return;
    }
    double from_s = 0.0, gap_s = asdic_track_gap_s(m->track, &from_s);
    double rest_s = asdic_track_end_s(m->track) - asdic_track_start_s(m->track) - gap_s;
    if (gap_s > GAP_RATIO * rest_s / (double)(points - 2) &&
        gap_s > 2.0 / m->settings.sonar.ping_rate_hz) {
        asdic_log(b->ctx, ASDIC_LOG_WARNING,
                  "%s:%u:%u: warning: the track has no point for %.3g s after %.15g s; the vehicle "
                  "goes straight on meanwhile  [mission.track]",
                  b->problems->name, node->line, node->column, gap_s, from_s);
    }
}

/* An object whose track has another clock than the vehicle's rests at an end of it. */
static void remark_on_motions(mission_builder *b) {
    const asdic_mission *m = b->mission;
    const file_object *objects = b->file->objects.items;
    double first_s, last_s;
    asdic_mission_pose(m, 0, &first_s);
    asdic_mission_pose(m, m->ping_count - 1, &last_s);
    for (size_t i = 0, k = 0; i < b->file->objects.count && k < m->motion_count; i++) {
        char text[160];
        if (!objects[i].track) {
            continue;
        }
        const asdic_track *track = m->motions[k++].track;
        double begin_s = asdic_track_start_s(track), end_s = asdic_track_end_s(track);
        if (end_s < first_s || begin_s > last_s) {
            snprintf(text, sizeof text,
                     "never moves: its track covers %.15g to %.15g s, the pings are from %.15g to "
                     "%.15g s",
                     begin_s, end_s, first_s, last_s);
            remark(b, i, text);
        }
    }
}

void asdic_mission_check_positions(mission_builder *b) {
    check_bottom_depth(b);
    if (b->problems->total == 0) {
        check_depths(b);
        remark_on_bottom(b);
        remark_on_objects(b);
        remark_on_gap(b);
        remark_on_motions(b);
    }
}
