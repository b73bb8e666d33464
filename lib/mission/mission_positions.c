/*
 * Checks that sonar, bottom and objects are where they can meet.
 */
#include "mission_build.h"

#include "base/context.h"
#include "base/vec.h"
#include "out/digits.h"
#include "scene/scene.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* Poses tested against the bottom: some tenths of a second's work. Of longer missions every so many are
 * tested here, and each as it is run. */
#define MAX_TESTED_PINGS 1000000

/* Poses tested against objects, and triangles against poses: a second's work at most. */
#define MAX_TESTS 10000000

/* Places of a moving object tested against the bottom. */
#define MAX_TESTED_PLACES 10000

/* Two points of a track have a gap between them when they are this many times farther apart than
 * the others on average. */
#define GAP_RATIO 10.0
/* A track of fewer points is written by hand, at any times: it has no gaps. */
#define RECORDED_POINTS 20

/* TIME_S in TEXT, for a message. */
static const char *time_text(char text[ASDIC_DIGITS_SIZE], double time_s) {
    asdic_digits_time(text, time_s);
    return text;
}

/* A depth above which no bottom lies. */
#define ABOVE_ALL_M (-1e6)

double asdic_mission_bottom_m(const asdic_scene *scene, asdic_vec3 position_m) {
    position_m.z = ABOVE_ALL_M;
    return ABOVE_ALL_M + asdic_scene_altitude_m(scene, position_m);
}

/* asdic_mission_is_below_bottom, of a bottom at FLAT_M; NAN: of the scene's. */
static bool is_below(const asdic_mission *m, size_t ping, double flat_m,
                     char text[ASDIC_BELOW_BOTTOM_SIZE]) {
    double time_s;
    char time[ASDIC_DIGITS_SIZE];
    asdic_pose pose = asdic_mission_pose(m, ping, &time_s);
    double depth_m = isnan(flat_m) ? asdic_mission_bottom_m(m->scene, pose.position_m) : flat_m;
    /* A mesh in float is not exact to the last digit. */
    if (!(pose.position_m.z > depth_m + 1e-6 * fabs(depth_m))) {
        return false;
    }
    int used = m->track ? snprintf(text, ASDIC_BELOW_BOTTOM_SIZE, "ping %zu at %s s: ", ping,
                                   time_text(time, time_s))
                        : 0;
    snprintf(text + used, ASDIC_BELOW_BOTTOM_SIZE - (size_t)used,
             "the sonar is at z = %.6g m, below the bottom at %.6g m; raise it or lower the bottom",
             pose.position_m.z, depth_m);
    return true;
}

bool asdic_mission_is_below_bottom(const asdic_mission *m, size_t ping,
                                   char text[ASDIC_BELOW_BOTTOM_SIZE]) {
    return is_below(m, ping, NAN, text);
}

/* Pings from one that is tested against the bottom to the next. */
static size_t bottom_step(const asdic_mission *m) {
    return (m->ping_count - 1) / MAX_TESTED_PINGS + 1;
}

static bool has_any(const asdic_yaml_node *map, const char *const *keys) {
    while (*keys && !asdic_yaml_child(map, *keys)) {
        keys++;
    }
    return *keys;
}

/* Whether a flat bottom is meant, of a depth that is known. */
static bool is_flat(const asdic_scene_file *file) {
    static const char *const others[] = {"mesh", "grid", "none", NULL};
    const asdic_yaml_node *bottom = file->bottom.node;
    return asdic_scene_node_good(asdic_yaml_child(bottom, "depth_m")) && !has_any(bottom, others);
}

/* Whether it is known where the sonar is; of one that moves also at which ping. */
static bool knows_places(const mission_builder *b) {
    static const char *const others[] = {"track", "waypoints", NULL};
    const asdic_yaml_node *sonar = b->file->sonar.node, *mission = b->file->mission.node;
    if (b->mission->track) {
        return asdic_scene_node_good(mission) &&
               (asdic_scene_node_good(sonar) ||
                asdic_scene_node_good(asdic_yaml_child(sonar, "ping_rate_hz")));
    }
    const asdic_yaml_node *pose = asdic_yaml_child(mission, "pose");
    return asdic_scene_node_good(asdic_yaml_child(pose, "position_m")) && !has_any(mission, others);
}

/* Of a scene that is not there, as something is wrong with it, a flat bottom's depth may yet be known. */
static void check_depths(mission_builder *b) {
    char text[ASDIC_BELOW_BOTTOM_SIZE];
    bool is_sound = asdic_mission_is_sound(b);
    double flat_m = is_sound ? NAN : b->file->bottom.depth_m;
    const asdic_mission *m = b->mission;
    const asdic_yaml_node *mission = b->file->mission.node;
    const char *kind = !m->track ? "pose" : b->file->mission.track ? "track" : "waypoints";
    asdic_yaml_node *node = asdic_yaml_child(mission, kind);
    size_t step = bottom_step(m);
    size_t last = m->track ? m->ping_count : 1;
    asdic_yaml_node *position = asdic_yaml_child(node, "position_m");
    bool is_known = is_sound || (is_flat(b->file) && knows_places(b));
    node = !m->track && position ? position->last : node;
    for (size_t i = 0; is_known && i < last; i += step) {
        if (is_below(m, i, flat_m, text)) {
            asdic_yaml_problem(b->problems, node, "%s", text);
            return;
        }
    }
}

/* Of many runs one is spoken of at most, and none that cannot be: whoever flies them asks whether the sonar is below the
 * bottom. */
static bool is_told(const mission_builder *b) {
    char text[ASDIC_BELOW_BOTTOM_SIZE];
    return !b->many || (b->tells && !asdic_mission_is_below_bottom(b->mission, 0, text));
}

/* Where the water is not as deep as an altitude to be held, the vehicle is at the surface. */
static void check_altitude(mission_builder *b) {
    const asdic_mission *m = b->mission;
    asdic_yaml_node *node = asdic_yaml_child(b->file->mission.waypoints.node, "altitude_m");
    double altitude_m = m->flight.altitude_m, deepest_m = 0.0;
    size_t step = bottom_step(m), first = SIZE_MAX, tested = 0, shallow = 0;
    for (size_t i = 0; node && i < m->ping_count; i += step, tested++) {
        double depth_m =
            asdic_mission_bottom_m(m->scene, asdic_mission_pose(m, i, NULL).position_m);
        if (depth_m < altitude_m) {
            first = shallow++ ? first : i;
        }
        deepest_m = fmax(deepest_m, depth_m);
    }
    if (shallow > 0 && shallow == tested) {
        asdic_yaml_problem(b->problems, node,
                           "'altitude_m' = %.15g is more than the water is deep, at most %.6g m on "
                           "the way; lower it",
                           altitude_m, deepest_m);
    } else if (shallow > 0 && is_told(b)) {
        asdic_log(
            b->ctx, ASDIC_LOG_WARNING,
            "%s:%u:%u: warning: 'altitude_m' = %.15g is more than the water is deep at %zu of "
            "%zu pings, from ping %zu on; the vehicle is at the surface there  "
            "[mission.waypoints.altitude_m]",
            b->problems->name, node->line, node->column, altitude_m, shallow, tested, first);
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
                  "down; if its file has y up, give 'rotation_deg: [0, 90, 0]' beside 'mesh'  "
                  "[bottom.mesh]",
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

/* Pings from one that is tested against objects to the next: of few objects or pings, 1. */
static size_t ping_step(const asdic_mission *m) {
    return (size_t)((double)m->ping_count * (double)m->object_count / MAX_TESTS) + 1;
}

/* Pings at which the sonar may be elsewhere, seen from OBJECT. */
static size_t pings_of(const asdic_mission *m, const asdic_mission_object *object) {
    return m->track || object->moves ? m->ping_count : 1;
}

/* POSITION in the world at ping INDEX, as it lies to OBJECT where its box and mesh are, those of
 * its first pose; BACK: the reverse. */
static asdic_vec3 moved(const asdic_mission *m, const asdic_mission_object *object, size_t index,
                        asdic_vec3 position_m, bool back) {
    if (!object->moves) {
        return position_m;
    }
    asdic_pose now = asdic_mission_object_pose(m, (size_t)(object - m->objects), index);
    asdic_move move =
        back ? asdic_move_between(&object->pose, &now) : asdic_move_between(&now, &object->pose);
    return asdic_move_point(&move, position_m);
}

static asdic_vec3 sonar_at(const asdic_mission *m, const asdic_mission_object *object,
                           size_t index) {
    return moved(m, object, index, asdic_mission_pose(m, index, NULL).position_m, false);
}

/* OBJECT with the box round its box at ping INDEX. */
static asdic_mission_object placed(const asdic_mission *m, const asdic_mission_object *object,
                                   size_t index) {
    asdic_mission_object there = *object;
    there.min_m = (asdic_vec3){INFINITY, INFINITY, INFINITY};
    there.max_m = (asdic_vec3){-INFINITY, -INFINITY, -INFINITY};
    for (int corner = 0; corner < 8; corner++) {
        asdic_vec3 at_m = {corner & 1 ? object->min_m.x : object->max_m.x,
                           corner & 2 ? object->min_m.y : object->max_m.y,
                           corner & 4 ? object->min_m.z : object->max_m.z};
        at_m = moved(m, object, index, at_m, true);
        there.min_m.x = fmin(there.min_m.x, at_m.x);
        there.min_m.y = fmin(there.min_m.y, at_m.y);
        there.min_m.z = fmin(there.min_m.z, at_m.z);
        there.max_m.x = fmax(there.max_m.x, at_m.x);
        there.max_m.y = fmax(there.max_m.y, at_m.y);
        there.max_m.z = fmax(there.max_m.z, at_m.z);
    }
    return there;
}

/* The least distance from a ping's sonar to the box round OBJECT; any that is below ENOUGH_M does. */
static double nearest_m(const asdic_mission *m, const asdic_mission_object *object,
                        double enough_m) {
    double least_m = INFINITY;
    size_t step = ping_step(m), count = pings_of(m, object);
    for (size_t i = 0; i < count && !(least_m < enough_m); i += step) {
        least_m = fmin(least_m, distance_m(object, sonar_at(m, object, i)));
    }
    return least_m;
}

/* Whether the box round OBJECT is below the bottom, at its corners and its middle. */
static bool is_buried(const asdic_mission *m, const asdic_mission_object *object) {
    const asdic_vec3 *low = &object->min_m, *high = &object->max_m;
    const double x_m[] = {low->x, low->x, high->x, high->x, 0.5 * (low->x + high->x)};
    const double y_m[] = {low->y, high->y, low->y, high->y, 0.5 * (low->y + high->y)};
    for (size_t i = 0; i < sizeof x_m / sizeof *x_m; i++) {
        asdic_vec3 at_m = {x_m[i], y_m[i], low->z};
        if (!(low->z > asdic_mission_bottom_m(m->scene, at_m))) {
            return false;
        }
    }
    return true;
}

/* At every ping that is tested; else *SUNK is the first that it is after one at which it is not, SIZE_MAX: none. */
static bool is_always_buried(const asdic_mission *m, const asdic_mission_object *object,
                             size_t *sunk) {
    size_t step = m->ping_count / MAX_TESTED_PLACES + 1, count = object->moves ? m->ping_count : 1;
    bool always = true;
    *sunk = SIZE_MAX;
    for (size_t i = 0; i < count && *sunk == SIZE_MAX; i += step) {
        asdic_mission_object there = placed(m, object, i);
        bool now = is_buried(m, &there);
        *sunk = now && !always ? i : SIZE_MAX;
        always &= now;
    }
    return always;
}

static double turn(const float a[3], const float b[3], double x, double y) {
    return ((double)a[0] - x) * ((double)b[1] - y) - ((double)a[1] - y) * ((double)b[0] - x);
}

/* Whether POSITION is inside the closed mesh of PART: a line straight up leaves it once more than it
 * enters. */
static bool is_inside(const asdic_scene *scene, size_t part, asdic_vec3 position_m) {
    /* A little aside: where things are put by hand, the line would go through edges. */
    double x = position_m.x - scene->origin_m.x + 1.23e-4;
    double y = position_m.y - scene->origin_m.y + 2.71e-4, z = position_m.z - scene->origin_m.z;
    bool is_odd = false;
    for (size_t i = 0; i < scene->triangle_count; i++) {
        const dev_triangle *t = &scene->triangles[i];
        double u = turn(t->v1, t->v2, x, y), v = turn(t->v2, t->v0, x, y);
        double w = turn(t->v0, t->v1, x, y), area = u + v + w;
        if (t->part == part && area != 0.0 &&
            ((u >= 0.0 && v >= 0.0 && w >= 0.0) || (u <= 0.0 && v <= 0.0 && w <= 0.0)) &&
            (u * t->v0[2] + v * t->v1[2] + w * t->v2[2]) / area < z) {
            is_odd = !is_odd;
        }
    }
    return is_odd;
}

/* The first ping whose sonar is inside OBJECT, of those that are tested; SIZE_MAX: none. */
static size_t first_inside(const asdic_mission *m, const asdic_mission_object *object) {
    size_t part = 0, step = ping_step(m), count = pings_of(m, object);
    size_t tests = MAX_TESTS / (m->scene->triangle_count + 1) + 1;
    const asdic_pose none = {0};
    const asdic_move home = asdic_move_between(&object->pose, &none); /* where its triangles are */
    while (part < m->scene->part_count && strcmp(m->scene->parts[part].name, object->name) != 0) {
        part++;
    }
    if (object->mesh.triangles == 0 || object->mesh.open_edges > 0) {
        return SIZE_MAX;
    }
    for (size_t i = 0; i < count && tests > 0; i += step) {
        asdic_vec3 at_m = sonar_at(m, object, i);
        asdic_vec3 to_mesh_m = m->stands_anywhere ? asdic_move_point(&home, at_m) : at_m;
        if (distance_m(object, at_m) == 0.0 && tests-- > 0 &&
            is_inside(m->scene, part, to_mesh_m)) {
            return i;
        }
    }
    return SIZE_MAX;
}

static double range_of(const asdic_mission *m) {
    return asdic_sonar_max_range_m(&m->settings.sonar, asdic_mission_speed_mps(m));
}

bool asdic_mission_reaches(const asdic_mission *mission, const char *name) {
    double range_m = range_of(mission);
    for (size_t i = 0; i < mission->object_count; i++) {
        const asdic_mission_object *object = &mission->objects[i];
        if (strcmp(object->name, name) == 0) {
            return nearest_m(mission, object, range_m) <= range_m;
        }
    }
    return false;
}

static void remark_on_objects(mission_builder *b) {
    const asdic_mission *m = b->mission;
    size_t first = m->object_count - b->file->objects.count; /* the bottom may be before them */
    double range_m = range_of(m);
    for (size_t i = first; i < m->object_count; i++) {
        const asdic_mission_object *object = &m->objects[i];
        char text[160];
        double away_m = nearest_m(m, object, range_m);
        size_t inside = first_inside(m, object), sunk;
        bool always = is_always_buried(m, object, &sunk);
        if (object->max_m.z < 0.0) {
            remark(b, i - first, "lies above the sea surface; z is positive down");
        } else if (away_m > range_m) {
            snprintf(text, sizeof text, "is beyond the maximum range: %.4g m away, heard to %.4g m",
                     away_m, range_m);
            remark(b, i - first, text);
        } else if (always) {
            remark(b, i - first, "lies wholly below the bottom; z is positive down");
        } else if (inside != SIZE_MAX) {
            snprintf(text, sizeof text, "has the sonar inside it at ping %zu", inside);
            remark(b, i - first, text);
        } else if (sunk != SIZE_MAX) {
            snprintf(text, sizeof text, "sinks wholly below the bottom by ping %zu", sunk);
            remark(b, i - first, text);
        }
    }
}

/* A bottom in another place, or too deep to be heard. */
static void remark_on_reach(mission_builder *b) {
    const asdic_mission *m = b->mission;
    asdic_scene_info scene = asdic_scene_get_info(m->scene);
    asdic_mission_object bottom = {.min_m = {-INFINITY, -INFINITY, scene.bottom_plane_depth_m},
                                   .max_m = {INFINITY, INFINITY, scene.bottom_plane_depth_m}};
    if (m->object_count > b->file->objects.count) {
        bottom = m->objects[0];
    } else if (!scene.has_bottom_plane) {
        return;
    }
    double range_m = range_of(m), away_m = nearest_m(m, &bottom, range_m);
    if (away_m > range_m) {
        const asdic_yaml_node *node = b->file->bottom.node;
        asdic_log(b->ctx, ASDIC_LOG_WARNING,
                  "%s:%u:%u: warning: the bottom is never in range: %.4g m away, heard to %.4g m  "
                  "[bottom]",
                  b->problems->name, node->line, node->column, away_m, range_m);
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
        char from[ASDIC_DIGITS_SIZE];
        asdic_log(b->ctx, ASDIC_LOG_WARNING,
                  "%s:%u:%u: warning: the track has no point for %.3g s after %s s; the vehicle "
                  "goes straight on meanwhile  [mission.track]",
                  b->problems->name, node->line, node->column, gap_s, time_text(from, from_s));
    }
}

/* A vehicle turns and dives only so fast. */
static void remark_on_waypoints(mission_builder *b) {
    const asdic_flight_miss *m = &b->missed;
    const asdic_yaml_node *node = b->file->mission.waypoints.node;
    if (m->point > 0) {
        asdic_log(b->ctx, ASDIC_LOG_WARNING,
                  "%s:%u:%u: warning: the flight does not reach point %zu: it passes %.1f m aside "
                  "and %.1f m %s it; fly slower, or give points farther apart  "
                  "[mission.waypoints.points_m[%zu]]",
                  b->problems->name, node->line, node->column, m->point, m->aside_m,
                  fabs(m->deeper_m), m->deeper_m > 0.0 ? "below" : "above", m->point);
    }
}

/* An object whose track has another clock than the vehicle's rests at an end of it. */
static void remark_on_motions(mission_builder *b) {
    const asdic_mission *m = b->mission;
    const file_object *objects = b->file->objects.items;
    double first_s, last_s;
    asdic_mission_pose(m, 0, &first_s);
    asdic_mission_pose(m, m->ping_count - 1, &last_s);
    for (size_t i = 0; i < b->file->objects.count; i++) {
        char text[200], times[4][ASDIC_DIGITS_SIZE];
        if (!objects[i].track) {
            continue;
        }
        const asdic_track *track = asdic_mission_track_of(m, objects[i].name);
        double begin_s = asdic_track_start_s(track), end_s = asdic_track_end_s(track);
        if (end_s < first_s || begin_s > last_s) {
            snprintf(text, sizeof text,
                     "never moves: its track covers %s to %s s, the pings are from %s to %s s",
                     time_text(times[0], begin_s), time_text(times[1], end_s),
                     time_text(times[2], first_s), time_text(times[3], last_s));
            remark(b, i, text);
        }
    }
}

/* Facets round a smooth body of so many wavelengths of radius that leave its echo its level, found by physical optics of
 * spheres: so short that they reflect nowhere else in phase, or so flat, L^2 < a lambda / 100, that little does. */
static double facets_needed(double radius_wl) {
    return ceil(fmin(ASDIC_PI / 0.3 * radius_wl, 20.0 * ASDIC_PI * sqrt(radius_wl)));
}

/* In coherent pings facets of a smooth body are mirrors, each in phase with itself. */
static void remark_on_facets(mission_builder *b) {
    const asdic_mission *m = b->mission;
    const file_object *objects = b->file->objects.items;
    if (!m->settings.sampling.coherent) {
        return;
    }
    double wavelength_m = asdic_mission_speed_mps(m) / m->settings.sonar.frequency_hz;
    for (size_t i = 0; i < b->file->objects.count; i++) {
        const file_object *o = &objects[i];
        const file_round *round = o->sphere.node ? &o->sphere : &o->cylinder;
        asdic_material_file rows;
        asdic_material material = asdic_scene_file_material(o, &rows);
        double needed = facets_needed(round->radius_m / wavelength_m);
        if (round->node && asdic_material_get(&material, "slope_rms") == 0.0 &&
            (double)round->segments < fmin(needed, ASDIC_MOST_SEGMENTS)) {
            char text[240];
            snprintf(text, sizeof text,
                     "is smooth and has %d 'segments', each a flat mirror: in coherent pings its "
                     "level may be wrong by 10 dB; %s 'segments: %g'",
                     (int)round->segments, needed > ASDIC_MOST_SEGMENTS ? "closest comes" : "give",
                     fmin(needed, ASDIC_MOST_SEGMENTS));
            remark(b, i, text);
        }
    }
}

void asdic_mission_check_positions(mission_builder *b) {
    if (asdic_mission_is_sound(b)) {
        check_bottom_depth(b);
    }
    if (!b->many) {
        check_depths(b);
    }
    if (asdic_mission_is_sound(b)) {
        check_altitude(b);
    }
    if (b->problems->total == 0 && is_told(b)) {
        remark_on_bottom(b);
        remark_on_reach(b);
        remark_on_objects(b);
        remark_on_gap(b);
        remark_on_waypoints(b);
        remark_on_motions(b);
        remark_on_facets(b);
    }
}
