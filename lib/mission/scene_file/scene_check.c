/*
 * Checks of several keys of a scene file together. Only values that are good one by one are judged
 * together, so that one mistake makes one error.
 */
#include "scene_draw.h"
#include "scene_file.h"
#include "scene_laws.h"

#include "mission/track/flight.h"
#include "sim/environment.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

bool asdic_scene_node_good(const asdic_yaml_node *node) {
    return node && !node->bad;
}

/* Where to report on KEY of MAP: at its value, or at the map when the default is meant. */
static asdic_yaml_node *at(asdic_yaml_node *map, const char *key) {
    asdic_yaml_node *child = asdic_yaml_child(map, key);
    return child ? child : map;
}

static bool is_bad(const asdic_yaml_node *map, const char *key) {
    const asdic_yaml_node *child = asdic_yaml_child(map, key);
    return child && child->bad;
}

/* Whether none of KEYS, which end with NULL, is bad in MAP. */
static bool are_read(const asdic_yaml_node *map, const char *const *keys) {
    while (*keys && !is_bad(map, *keys)) {
        keys++;
    }
    return !*keys;
}

/* Whether what sound speeds are made from is good. */
static bool knows_speed(const asdic_scene_file *file) {
    static const char *const keys[] = {"temperature_degc",
                                       "salinity_ppt",
                                       "sound_speed_mps",
                                       "sound_speed_profile",
                                       "sound_speed_gradient_per_s",
                                       NULL};
    const asdic_yaml_node *node = asdic_yaml_child(file->node, "environment");
    return !node || (file->environment.node && are_read(file->environment.node, keys));
}

/* KEY, if MAP has it, changes nothing WHY. */
static void refuse_idle(asdic_problems *problems, const asdic_yaml_node *map, const char *key,
                        const char *why) {
    asdic_yaml_node *child = asdic_yaml_child(map, key);
    if (child) {
        asdic_yaml_key_problem(problems, child, "'%s' has no effect %s", key, why);
    }
}

typedef struct named_node {
    const char *name;
    asdic_yaml_node *node;
} named_node;

static int compare_names(const void *pa, const void *pb) {
    const named_node *a = pa, *b = pb;
    int order = strcmp(a->name, b->name);
    return order ? order : (a->node->index < b->node->index ? -1 : 1);
}

/* Names unnamed items by PREFIX and their number, then looks for equal names. The items of LIST
 * have SIZE bytes, begin with their node, and hold their name at OFFSET. */
static void check_names(asdic_list list, size_t size, size_t offset, const char *prefix,
                        asdic_arena *arena, asdic_problems *problems) {
    named_node *names = asdic_arena_alloc(arena, (list.count + 1) * sizeof *names);
    size_t count = 0;
    for (size_t i = 0; names && i < list.count; i++) {
        char *item = (char *)list.items + i * size;
        asdic_yaml_node *node = *(asdic_yaml_node **)item;
        const char **name = (const char **)(item + offset);
        char automatic[32];
        int length = snprintf(automatic, sizeof automatic, "%s%0*zu", prefix, *prefix ? 0 : 3, i);
        if (!*name) {
            *name = asdic_arena_string(arena, automatic, (size_t)length);
        }
        if (*name && node && !is_bad(node, "name")) {
            names[count++] = (named_node){*name, node};
        }
    }
    if (!names) {
        problems->out_of_memory = true;
        return;
    }
    qsort(names, count, sizeof *names, compare_names);
    for (size_t i = 1; i < count; i++) {
        if (strcmp(names[i].name, names[i - 1].name) == 0) {
            asdic_yaml_problem(problems, at(names[i].node, "name"),
                               "'name' = %s is the name of the entry at line %u already",
                               names[i].name, names[i - 1].node->line);
        }
    }
}

static void check_profile(const asdic_scene_file *file, asdic_problems *problems) {
    asdic_yaml_node *node = asdic_yaml_child(file->environment.node, "sound_speed_profile");
    const asdic_sound_profile given = asdic_scene_file_environment(file).sound_speed_profile;
    asdic_sound_profile good = {0}; /* the points whose depths are in order */
    if (!node) {
        return;
    }
    refuse_idle(problems, file->environment.node, "sound_speed_mps",
                "beside 'sound_speed_profile'; give only one of them");
    for (asdic_yaml_node *item = given.points ? node->first : NULL; item; item = item->next) {
        char why[256];
        if (item->kind != ASDIC_YAML_LIST || item->count != 2 || item->first->bad) {
            continue;
        }
        good.depth_m[good.points] = given.depth_m[item->index];
        good.sound_speed_mps[good.points] = ASDIC_SOUND_LEAST_MPS; /* its key judges speeds */
        if (asdic_sound_profile_flaw(&good, good.points, why, sizeof why)) {
            asdic_yaml_problem(problems, item, "%s", why);
        } else {
            good.points++;
        }
    }
}

static bool knows_pose(const asdic_scene_file *file) {
    return asdic_scene_node_good(asdic_yaml_child(file->mission.pose.node, "position_m"));
}

/* How far down rays go: to a flat bottom, or without one to the range, of the sonar of a mission at rest or, of
 * others, one at the surface. NAN: not known, as meshes are not read yet. */
static double deepest_m(const asdic_scene_file *file, const asdic_environment *env) {
    static const char *const keys[] = {"ping_rate_hz", "max_range_m", "bin_length_m", NULL};
    const file_sonar *s = &file->sonar;
    if (!file->bottom.none) {
        return file->bottom.depth_m;
    }
    if (!s->node || !are_read(s->node, keys)) {
        return NAN;
    }
    const file_pose *pose = &file->mission.pose;
    double depth_m = knows_pose(file) ? fmax(pose->position_m[2], 0.0) : 0.0;
    asdic_sonar sonar = asdic_scene_file_sonar(file);
    double sound_speed_mps = asdic_environment_sound_speed_mps(env, depth_m);
    return depth_m + (double)asdic_sonar_bin_count(&sonar, sound_speed_mps) * s->bin_length_m;
}

/* The sound speed stays that of water as far down as rays go. */
static void check_gradient(const asdic_scene_file *file, asdic_problems *problems) {
    asdic_yaml_node *node = asdic_yaml_child(file->environment.node, "sound_speed_gradient_per_s");
    double surface_mps, gradient = file->environment.sound_speed_gradient_per_s;
    static const char *const depths[] = {"depth_m", "none", "mesh", "grid", NULL};
    if (!asdic_scene_node_good(node) || !knows_speed(file) || !file->bottom.node ||
        !are_read(file->bottom.node, depths)) {
        return;
    }
    asdic_environment env = asdic_scene_file_environment(file);
    double most_m = deepest_m(file, &env);
    if (!(most_m > 0.0)) {
        return;
    }
    surface_mps = asdic_environment_sound_speed_mps(&env, 0.0);
    double bottom_mps = surface_mps + gradient * most_m;
    double limit = gradient < 0.0 ? ASDIC_SOUND_LEAST_MPS : ASDIC_SOUND_MOST_MPS;
    if (bottom_mps >= ASDIC_SOUND_LEAST_MPS && bottom_mps <= ASDIC_SOUND_MOST_MPS) {
        return;
    }
    asdic_yaml_problem(problems, node,
                       "'sound_speed_gradient_per_s' = %.15g takes the sound speed of %.6g m/s at "
                       "the surface to %g m/s at a depth of %.4g m%s; %s %.6g m: give "
                       "a 'sound_speed_profile' that ends where the gradient does",
                       gradient, surface_mps, limit, (limit - surface_mps) / gradient,
                       bottom_mps <= 0.0 ? " and on to 0" : "",
                       file->bottom.none ? "without a bottom rays go down to" : "the bottom is at",
                       most_m);
}

void asdic_scene_file_check_bins(const asdic_scene_file *file, double depth_m,
                                 asdic_problems *problems) {
    const file_sonar *s = &file->sonar;
    static const char *const keys[] = {"ping_rate_hz", "max_range_m", NULL};
    if (!s->node || !are_read(s->node, keys) || !knows_speed(file)) {
        return;
    }
    asdic_environment env = asdic_scene_file_environment(file);
    asdic_sonar sonar = asdic_scene_file_sonar(file);
    double sound_speed_mps = asdic_environment_sound_speed_mps(&env, fmax(depth_m, 0.0));
    double range_m = asdic_sonar_max_range_m(&sonar, sound_speed_mps);
    size_t bins = asdic_sonar_bin_count(&sonar, sound_speed_mps);
    bool is_set = !isnan(s->max_range_m);
    const char *which = is_set ? "" : ", which is c / (2 ping_rate_hz)";
    const char *key = is_set ? "raise 'max_range_m'" : "'ping_rate_hz'";
    sonar.max_range_m = NAN;
    double most_m = asdic_sonar_max_range_m(&sonar, sound_speed_mps);
    if (s->max_range_m > most_m) {
        asdic_yaml_problem(problems, at(s->node, "max_range_m"),
                           "'max_range_m' = %.15g is more than the %.5g m that echoes come from "
                           "before the next ping, c / (2 ping_rate_hz); lower it or 'ping_rate_hz'",
                           s->max_range_m, most_m);
        return;
    }
    if (s->blanking_m >= range_m) {
        asdic_yaml_problem(problems, at(s->node, "blanking_m"),
                           "'blanking_m' = %.15g is not below the maximum range of %.4g m%s; "
                           "lower it or %s",
                           s->blanking_m, range_m, which, key);
    } else if (s->blanking_m >= (double)bins * s->bin_length_m && s->bin_length_m <= range_m) {
        asdic_yaml_problem(problems, at(s->node, "blanking_m"),
                           "'blanking_m' = %.15g leaves no bin, as the last ends at %.15g m; lower "
                           "it or 'bin_length_m'",
                           s->blanking_m, (double)bins * s->bin_length_m);
    }
    if (s->bin_length_m > range_m) {
        asdic_yaml_problem(problems, at(s->node, "bin_length_m"),
                           "'bin_length_m' = %.15g is more than the maximum range of %.4g m%s; "
                           "lower it or %s",
                           s->bin_length_m, range_m, which, key);
    }
    if (bins > ASDIC_SONAR_MAX_BINS) {
        asdic_yaml_problem(problems, at(s->node, "bin_length_m"),
                           "'bin_length_m' = %.15g makes %zu bins of the maximum range of %.4g m, "
                           "at most %d are possible; lengthen it or %s",
                           s->bin_length_m, bins, range_m, ASDIC_SONAR_MAX_BINS,
                           is_set ? "lower 'max_range_m'" : "raise 'ping_rate_hz'");
    }
}

/* Steps must fill the sector: on a circle the last direction's neighbour is the first. */
static void check_scan(const file_sweep *scan, asdic_problems *problems) {
    static const char *const keys[] = {"sector_deg", "step_deg", NULL};
    if (!scan->node || !are_read(scan->node, keys)) {
        return;
    }
    double steps = scan->sector_deg / scan->step_deg;
    if (fabs(steps - rint(steps)) > 1e-6 * steps || steps < 0.5) {
        double whole = fmax(rint(steps), 1.0);
        double sector_deg = scan->step_deg * (scan->step_deg * whole < 360.0 ? whole : whole - 1.0);
        asdic_yaml_problem(problems, at(scan->node, "step_deg"),
                           "'step_deg' = %.15g goes %.4g times into 'sector_deg' = %.15g; it must "
                           "be a whole number of times, as with %.9g, or as with 'sector_deg' = "
                           "%.9g%s",
                           scan->step_deg, steps, scan->sector_deg, scan->sector_deg / whole,
                           sector_deg,
                           scan->sector_deg < 360.0 ? "" : ", which is gone back and forth");
    }
}

static void check_array(const file_array *array, asdic_problems *problems) {
    bool levels =
        array->shading == ASDIC_SHADING_TAYLOR || array->shading == ASDIC_SHADING_CHEBYSHEV;
    if (!levels && !is_bad(array->node, "shading")) {
        refuse_idle(problems, array->node, "side_lobe_db",
                    "without 'shading: taylor' or 'shading: chebyshev'; leave it out");
    }
}

/* What pings with phase need, and what they cannot honour. */
static void check_coherent(const asdic_scene_file *file, asdic_problems *problems) {
    const file_sonar *s = &file->sonar;
    const file_environment *e = &file->environment;
    asdic_yaml_node *here = asdic_yaml_child(file->sampling.node, "coherent");
    asdic_yaml_node *elements = asdic_yaml_child(file->output.node, "elements");
    if (elements && !elements->bad && file->output.elements && !file->sampling.coherent) {
        asdic_yaml_problem(problems, elements,
                           "'elements' = true needs pressures: add 'sampling: {coherent: true}'");
    }
    if (!here || here->bad || !file->sampling.coherent) {
        return;
    }
    if (s->node && !s->array.node && !asdic_yaml_child(s->node, "array") &&
        !asdic_yaml_child(s->node, "file")) {
        asdic_yaml_problem(problems, here,
                           "'coherent' = true needs the elements of an array: give 'array' in "
                           "'sonar' in place of 'receivers'");
    }
    if (!is_bad(s->node, "speckle") && s->speckle != ASDIC_SPECKLE_NONE) {
        refuse_idle(problems, s->node, "speckle",
                    "on coherent pings, which have their own; leave it out");
    }
    asdic_yaml_node *truth = asdic_yaml_child(file->output.node, "truth");
    if (truth && !truth->bad && file->output.truth) {
        asdic_yaml_problem(problems, truth,
                           "'truth' = true is not known of coherent pings: leave 'truth' or "
                           "'coherent' out");
    }
    bool bends = e->sound_speed_profile.count > 0 || e->sound_speed_gradient_per_s != 0.0;
    if (bends && file->model.refraction != ASDIC_REFRACTION_OFF) {
        asdic_yaml_problem(problems, here,
                           "'coherent' = true needs one sound speed at all depths; add 'model: "
                           "{refraction: off}' or leave the profile or gradient out");
    }
}

static void check_sonar(const asdic_scene_file *file, asdic_arena *arena,
                        asdic_problems *problems) {
    const file_sonar *s = &file->sonar;
    if (!s->node) {
        return;
    }
    if (!is_bad(s->node, "frequency_khz") && !is_bad(s->node, "bandwidth_khz") &&
        s->bandwidth_khz > 2.0 * s->frequency_khz) {
        asdic_yaml_problem(problems, at(s->node, "bandwidth_khz"),
                           "'bandwidth_khz' = %.15g is more than twice 'frequency_khz' = %.15g; "
                           "the band would begin below zero",
                           s->bandwidth_khz, s->frequency_khz);
    }
    if (!is_bad(s->node, "speckle") && s->speckle != ASDIC_SPECKLE_K) {
        refuse_idle(problems, s->node, "speckle_shape", "without 'speckle: k'; leave it out");
    } else if (s->speckle == ASDIC_SPECKLE_K && !asdic_yaml_child(s->node, "speckle_shape")) {
        asdic_yaml_problem(problems, at(s->node, "speckle"),
                           "'speckle' = k needs a 'speckle_shape': 0.5 is spiky, 50 nearly "
                           "Rayleigh");
    }
    check_array(&s->array, problems);
    check_scan(&s->scan, problems);
    check_names(s->receivers, sizeof(file_beam), offsetof(file_beam, name), "", arena, problems);
    const file_mission *mission = &file->mission;
    if (!asdic_scene_node_good(asdic_yaml_child(mission->node, "track")) &&
        !asdic_scene_node_good(mission->waypoints.node)) {
        asdic_scene_file_check_bins(file, knows_pose(file) ? mission->pose.position_m[2] : 0.0,
                                    problems);
    }
}

/* Keys that the chosen kind of bottom cannot honour. */
static void check_bottom(const file_bottom *bottom, asdic_problems *problems) {
    static const char *const placing[] = {"position_m", "rotation_deg"};
    asdic_yaml_node *node = bottom->node;
    asdic_yaml_node *none = asdic_yaml_child(node, "none");
    if (asdic_scene_node_good(none) && !bottom->none) {
        asdic_yaml_problem(problems, none,
                           "'none' = false does not say what the bottom is; give 'depth_m', 'mesh' "
                           "or 'grid'");
    }
    bool is_flat = bottom->none || asdic_yaml_child(node, "depth_m");
    bool placed = asdic_yaml_child(node, "mesh") || asdic_yaml_child(node, "grid") || !is_flat;
    for (size_t i = 0; !placed && i < sizeof placing / sizeof *placing; i++) {
        refuse_idle(problems, node, placing[i],
                    bottom->none ? "without a bottom; leave it out"
                                 : "on a flat bottom; leave it out");
    }
    asdic_yaml_node *law = asdic_scene_laws_given(ASDIC_LAW_BOTTOM, node);
    if (law && bottom->none) {
        refuse_idle(problems, node, law->key, "without a bottom; leave it out");
    }
    asdic_scene_laws_check(ASDIC_LAW_BOTTOM, node, problems);
}

/* Keys of OBJECT that only a shape can honour. */
static void check_point(const file_object *object, asdic_problems *problems) {
    static const char *const shaped[] = {"rotation_deg", "crease_deg", "material", "type"};
    for (size_t i = 0; asdic_yaml_child(object->node, "point") && i < 4; i++) {
        refuse_idle(problems, object->node, shaped[i], "on a point; leave it out");
    }
}

/* A track excludes the keys that place an object. */
static void check_object_track(const file_object *object, asdic_problems *problems) {
    static const char *const places[] = {"position_m", "rotation_deg"};
    for (size_t i = 0; asdic_yaml_child(object->node, "track") && i < 2; i++) {
        refuse_idle(problems, object->node, places[i], "beside 'track'; give only one of them");
    }
}

/* Detections name what is no object by words that no object may have. */
static void check_object_name(const file_object *object, asdic_problems *problems) {
    static const char *const words[] = {"none", "ghost", "faint"};
    asdic_yaml_node *name = asdic_yaml_child(object->node, "name");
    for (size_t i = 0; object->name && asdic_scene_node_good(name) && i < 3; i++) {
        if (strcmp(object->name, words[i]) == 0) {
            asdic_yaml_problem(problems, name,
                               "'name' = %s is what detections that are no object's are called; "
                               "give another",
                               words[i]);
        }
    }
}

static void check_objects(const asdic_scene_file *file, asdic_arena *arena,
                          asdic_problems *problems) {
    const file_object *objects = file->objects.items;
    check_names(file->objects, sizeof *objects, offsetof(file_object, name), "object", arena,
                problems);
    for (size_t i = 0; i < file->objects.count; i++) {
        asdic_scene_laws_check(ASDIC_LAW_OBJECT, objects[i].material.node, problems);
        check_object_name(&objects[i], problems);
        check_point(&objects[i], problems);
        check_object_track(&objects[i], problems);
    }
}

/* Checks that the sonar is in the water. Whether it is above the bottom is asked when that is there. */
static void check_pose(const asdic_scene_file *file, asdic_problems *problems) {
    const file_pose *pose = &file->mission.pose;
    if (!knows_pose(file)) {
        return;
    }
    double z_m = pose->position_m[2];
    asdic_yaml_node *position = asdic_yaml_child(pose->node, "position_m");
    if (z_m < 0.0) {
        asdic_yaml_problem(problems, position->last,
                           "the sonar is %.15g m above the sea surface; z is positive down", -z_m);
    }
}

/* Keys that the vehicle's model does not know, and speeds at which it is not valid. */
static void check_remus(const file_waypoints *w, asdic_problems *problems) {
    static const char *const general[] = {"turn_radius_m", "response_s", "dive_rate_mps"};
    for (size_t i = 0; i < sizeof general / sizeof *general; i++) {
        refuse_idle(problems, w->node, general[i],
                    "on 'vehicle: remus100', which has its own; leave it out");
    }
    if (w->speed_mps < ASDIC_REMUS100_MIN_MPS || w->speed_mps > ASDIC_REMUS100_MAX_MPS) {
        asdic_yaml_problem(problems, at(w->node, "speed_mps"),
                           "'speed_mps' = %.15g is outside the %g to %g m/s for which "
                           "'vehicle: remus100' is valid; change it or give 'vehicle: nomoto'",
                           w->speed_mps, ASDIC_REMUS100_MIN_MPS, ASDIC_REMUS100_MAX_MPS);
    }
}

/* Checks speeds, and the keys of the vehicle's model. */
static void check_vehicle(const file_waypoints *w, asdic_problems *problems) {
    static const char *const keys[] = {"vehicle", "speed_mps", "dive_rate_mps", NULL};
    if (!are_read(w->node, keys)) {
        return;
    }
    if (w->vehicle == ASDIC_VEHICLE_REMUS100) {
        check_remus(w, problems);
    } else if (w->dive_rate_mps >= w->speed_mps) {
        asdic_yaml_problem(problems, at(w->node, "dive_rate_mps"),
                           "'dive_rate_mps' = %.15g is not below 'speed_mps' = %.15g",
                           w->dive_rate_mps, w->speed_mps);
    }
}

/* Whether the vehicle makes headway along the line to point INDEX. */
static bool check_current(const file_waypoints *w, size_t index, asdic_problems *problems) {
    const double *to_m = (const double *)w->points.items + 3 * index, *from_m = to_m - 3;
    double course_rad = atan2(to_m[1] - from_m[1], to_m[0] - from_m[0]), across_mps;
    double headway_mps =
        asdic_flight_headway_mps(w->speed_mps, w->current_mps, course_rad, &across_mps);
    bool is_held = fabs(across_mps) < w->speed_mps;
    if (is_held && headway_mps > 0.0) {
        return true;
    }
    asdic_yaml_problem(problems, at(w->node, "current_mps"),
                       "'current_mps' runs at %.4g m/s %s the line to point %zu, which a vehicle "
                       "of 'speed_mps' = %.15g %s; raise 'speed_mps', or give the way as 'track'",
                       is_held ? w->speed_mps - headway_mps : fabs(across_mps),
                       is_held ? "against" : "across", index, w->speed_mps,
                       is_held ? "makes no headway on" : "cannot hold");
    return false;
}

/* Checks that the vehicle can fly from point to point through water. */
static void check_waypoints(const asdic_scene_file *file, asdic_problems *problems) {
    static const char *const speeds[] = {"speed_mps", "current_mps", NULL};
    const file_waypoints *w = &file->mission.waypoints;
    asdic_yaml_node *points = asdic_yaml_child(w->node, "points_m");
    if (!w->node) {
        return;
    }
    bool makes_way = are_read(w->node, speeds); /* said once */
    check_vehicle(w, problems);
    if (!isnan(w->altitude_m) && file->bottom.none) {
        asdic_yaml_problem(problems, at(w->node, "altitude_m"),
                           "'altitude_m' has no effect with 'bottom: none', below which there is "
                           "nothing to keep above; leave it out or give a bottom");
    }
    asdic_yaml_node *node = asdic_scene_node_good(points) ? points->first : NULL;
    const double *last_m = NULL, *m = w->points.items;
    for (size_t i = 0; node; node = node->next, last_m = m, m += 3, i++) {
        if (m[2] < 0.0) {
            asdic_yaml_problem(problems, node->last,
                               "the waypoint is %.15g m above the sea surface; z is positive down",
                               -m[2]);
        }
        if (last_m && hypot(m[0] - last_m[0], m[1] - last_m[1]) < 1e-3) {
            asdic_yaml_problem(problems, node,
                               "the waypoint is at the same place as the one before, or straight "
                               "above or below it; the vehicle needs a way to fly");
        } else if (last_m && makes_way) {
            makes_way = check_current(w, i, problems);
        }
    }
}

void asdic_scene_file_check(asdic_scene_file *file, asdic_arena *arena, asdic_problems *problems) {
    if (file->sonar.file && problems->total == 0) { /* nothing read it: only text was given */
        asdic_yaml_problem(problems, at(file->sonar.node, "file"),
                           "the sonar's 'file' = %.200s is not here to be read", file->sonar.file);
    }
    check_profile(file, problems);
    check_gradient(file, problems);
    check_sonar(file, arena, problems);
    check_coherent(file, problems);
    asdic_scene_laws_check(ASDIC_LAW_SURFACE, file->surface.node, problems);
    check_bottom(&file->bottom, problems);
    check_objects(file, arena, problems);
    check_pose(file, problems);
    check_waypoints(file, problems);
    asdic_scene_draw_check(&file->trial, arena, problems);
    asdic_scene_draw_check_values(&file->trial, file->node, arena, problems);
}
