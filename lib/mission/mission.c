/*
 * A mission: what it answers, and what may be changed in it without the scene file.
 */
#include "mission.h"

#include "base/context.h"
#include "base/try.h"
#include "laws/scatterer.h"
#include "mission/track/track.h"
#include "scene/scene.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

void asdic_mission_destroy(asdic_mission **mission) {
    if (!mission || !*mission) {
        return;
    }
    asdic_mission *m = *mission;
    if (!m->base) {
        asdic_scene_destroy(&m->scene);
    }
    asdic_track_destroy(&m->track);
    for (size_t i = 0; i < m->motion_count; i++) {
        asdic_track_destroy(&m->motions[i].track);
    }
    for (size_t i = 0; i < m->row_files; i++) {
        free((double *)m->rows[i]);
    }
    free(m->rows);
    for (asdic_setting *drawn = m->drawn; drawn && drawn->key; drawn++) {
        free((char *)drawn->key);
        free((char *)drawn->value);
    }
    free(m->drawn);
    free(m->classes);
    asdic_mission_forget_meshes(m);
    free(m->points_m);
    free(m->geometry);
    free(m->motions);
    free(m->objects);
    asdic_settings_finish(&m->settings);
    free(m->text);
    free(m->path);
    free(m);
    *mission = NULL;
}

/* --- what it is ------------------------------------------------------------------------------- */

const asdic_environment *asdic_mission_environment(const asdic_mission *mission) {
    return mission ? &mission->settings.environment : NULL;
}

const asdic_sonar *asdic_mission_sonar(const asdic_mission *mission) {
    return mission ? &mission->settings.sonar : NULL;
}

const asdic_scene *asdic_mission_scene(const asdic_mission *mission) {
    return mission ? mission->scene : NULL;
}

asdic_sampling *asdic_mission_sampling(asdic_mission *mission) {
    return mission ? &mission->settings.sampling : NULL;
}

const asdic_detector *asdic_mission_detector(const asdic_mission *mission) {
    return mission ? &mission->settings.detector : NULL;
}

const asdic_output_options *asdic_mission_output(const asdic_mission *mission) {
    return mission ? &mission->settings.output : NULL;
}

char *asdic_scene_name(const char *path) {
    if (!path) {
        return NULL;
    }
    const char *slash = strrchr(path, '/');
    const char *base = strcmp(path, "-") == 0 ? "scene" : slash ? slash + 1 : path;
    const char *dot = strrchr(base, '.');
    char *name = dot && dot != base ? strndup(base, (size_t)(dot - base)) : strdup(base);
    for (char *c = name, *end = name ? name + strlen(name) : NULL; c < end;) {
        size_t size = asdic_utf8_character(c, (size_t)(end - c));
        *c = size ? *c : '_';
        c += size ? size : 1;
    }
    return name;
}

const char *asdic_mission_path(const asdic_mission *mission) {
    return mission ? mission->path : NULL;
}

const char *asdic_mission_text(const asdic_mission *mission) {
    return mission ? mission->text : NULL;
}

const char *asdic_mission_hash(const asdic_mission *mission) {
    return mission ? mission->hash : NULL;
}

asdic_setting asdic_mission_drawn(const asdic_mission *mission, size_t index) {
    size_t count = 0;
    while (mission && mission->drawn && mission->drawn[count].key) {
        count++;
    }
    return index < count ? mission->drawn[index] : (asdic_setting){NULL, NULL};
}

size_t asdic_mission_object_count(const asdic_mission *mission) {
    return mission ? mission->object_count : 0;
}

const asdic_mission_object *asdic_mission_get_object(const asdic_mission *mission, size_t index) {
    return mission && index < mission->object_count ? &mission->objects[index] : NULL;
}

size_t asdic_mission_class(const asdic_mission *mission, const char *name) {
    for (size_t i = 0; i < mission->class_count; i++) {
        if (strcmp(mission->classes[i], name) == 0) {
            return i + 1;
        }
    }
    return 0;
}

const asdic_mission_object *asdic_mission_bottom_mesh(const asdic_mission *mission) {
    return mission->object_count && !mission->objects[0].name[0] ? mission->objects : NULL;
}

size_t asdic_mission_ping_count(const asdic_mission *mission) {
    return mission ? mission->ping_count : 0;
}

static asdic_pose pose_on_track(const asdic_track *track, double time_s) {
    asdic_pose pose = asdic_track_pose(track, time_s);
    pose.roll_rad = asdic_track_round(pose.roll_rad);
    pose.pitch_rad = asdic_track_round(pose.pitch_rad);
    pose.yaw_rad = asdic_track_round(pose.yaw_rad);
    return pose;
}

asdic_sweep asdic_mission_sweep(const asdic_mission *mission) {
    return mission ? mission->settings.sweep : (asdic_sweep){0};
}

asdic_pose asdic_mission_vehicle_pose(const asdic_mission *mission, size_t index, double *time_s) {
    if (!mission) {
        return (asdic_pose){0};
    }
    double elapsed_s = (double)index / mission->settings.sonar.ping_rate_hz;
    double start_s = mission->track ? asdic_track_start_s(mission->track) : 0.0;
    if (time_s) {
        *time_s = start_s + elapsed_s;
    }
    return mission->track ? pose_on_track(mission->track, start_s + elapsed_s) : mission->pose;
}

asdic_pose asdic_mission_pose(const asdic_mission *mission, size_t index, double *time_s) {
    asdic_pose vehicle = asdic_mission_vehicle_pose(mission, index, time_s);
    return mission ? asdic_sweep_sonar(&mission->settings.sweep, &vehicle, index) : vehicle;
}

double asdic_mission_speed_mps(const asdic_mission *mission) {
    return asdic_environment_sound_speed_mps(&mission->settings.environment,
                                             asdic_mission_pose(mission, 0, NULL).position_m.z);
}

/* Time of ping INDEX by the pings' clock. */
static double time_of(const asdic_mission *mission, size_t index) {
    double time_s;
    asdic_mission_pose(mission, index, &time_s);
    return time_s;
}

asdic_status asdic_mission_place(const asdic_mission *mission, asdic_simulator *simulator,
                                 size_t index) {
    if (!mission || !simulator) {
        return asdic_fail_null(NULL, __func__);
    }
    return asdic_mission_place_at(mission, simulator, time_of(mission, index));
}

asdic_status asdic_mission_place_at(const asdic_mission *mission, asdic_simulator *simulator,
                                    double time_s) {
    if (!mission || !simulator) {
        return asdic_fail_null(NULL, __func__);
    }
    for (size_t i = 0; i < mission->motion_count; i++) {
        const asdic_motion *motion = &mission->motions[i];
        asdic_pose pose = asdic_track_pose(motion->track, time_s);
        TRY(asdic_simulator_move(simulator, motion->name, &pose));
    }
    return ASDIC_OK;
}

static int by_name(const void *name, const void *motion) {
    return strcmp(name, ((const asdic_motion *)motion)->name);
}

const asdic_track *asdic_mission_track_of(const asdic_mission *mission, const char *name) {
    const asdic_motion *found = mission->motion_count
                                    ? bsearch(name, mission->motions, mission->motion_count,
                                              sizeof *mission->motions, by_name)
                                    : NULL;
    return found ? found->track : NULL;
}

asdic_pose asdic_mission_object_pose_at(const asdic_mission *mission,
                                        const asdic_mission_object *object, double time_s) {
    const asdic_track *track = object->moves ? asdic_mission_track_of(mission, object->name) : NULL;
    return track ? asdic_track_pose(track, time_s) : object->pose;
}

asdic_pose asdic_mission_object_pose(const asdic_mission *mission, size_t object, size_t index) {
    const asdic_mission_object *o = asdic_mission_get_object(mission, object);
    return o ? asdic_mission_object_pose_at(mission, o, time_of(mission, index)) : (asdic_pose){0};
}

asdic_flat_scene asdic_mission_flat_scene(const asdic_mission *mission, size_t index) {
    if (!mission) {
        return (asdic_flat_scene){0};
    }
    asdic_vec3 position_m = asdic_mission_pose(mission, index, NULL).position_m;
    double altitude_m = asdic_scene_altitude_m(mission->scene, position_m);
    return (asdic_flat_scene){
        .has_surface = asdic_scene_get_info(mission->scene).has_surface,
        .has_bottom = isfinite(altitude_m),
        .altitude_m = isfinite(altitude_m) ? altitude_m : 0.0,
        .depth_m = position_m.z,
        .bottom = mission->bottom,
        .surface = mission->scene->surface,
    };
}

/* --- what may be changed ---------------------------------------------------------------------- */

asdic_choices asdic_mission_get_choices(const asdic_mission *mission) {
    if (!mission) {
        return (asdic_choices){0};
    }
    return (asdic_choices){.wind_speed_kn = mission->settings.environment.wind_speed_kn,
                           .bottom = mission->bottom,
                           .source_level_db = mission->settings.sonar.source_level_db,
                           .rays = mission->settings.sampling.rays,
                           .seed = mission->settings.sampling.seed};
}

asdic_status asdic_mission_choose(asdic_context *ctx, asdic_mission *mission,
                                  const asdic_choices *choices) {
    if (!mission || !choices) {
        return asdic_fail(ctx, ASDIC_ERROR_ARGUMENT, "asdic_mission_choose: NULL argument");
    }
    asdic_environment environment = mission->settings.environment;
    asdic_sonar sonar = mission->settings.sonar;
    environment.wind_speed_kn = choices->wind_speed_kn;
    sonar.source_level_db = choices->source_level_db;
    TRY(asdic_environment_check(ctx, &environment));
    TRY(asdic_sonar_check(ctx, &sonar));
    if (choices->bottom.law || mission->bottom.law) {
        TRY(asdic_material_check_use(ctx, &choices->bottom, ASDIC_LAW_BOTTOM));
    }
    if (choices->rays < 64 || choices->rays > 1u << 28) {
        return asdic_fail(ctx, ASDIC_ERROR_ARGUMENT,
                          "%u rays per ping: out of range [64, 268435456]", choices->rays);
    }
    const asdic_choices *said = &mission->said;
    mission->is_chosen = choices->wind_speed_kn != said->wind_speed_kn ||
                         choices->source_level_db != said->source_level_db ||
                         !asdic_material_equal(&choices->bottom, &said->bottom);
    mission->settings.environment = environment;
    mission->settings.sonar = sonar;
    mission->settings.sampling.rays = choices->rays;
    mission->settings.sampling.seed = choices->seed;
    mission->bottom = choices->bottom;
    if (!choices->bottom.law) {
        return ASDIC_OK;
    }
    asdic_scene_set_bottom(mission->scene, &choices->bottom);
    if (asdic_mission_bottom_mesh(mission)) {
        mission->objects[0].material = choices->bottom;
    }
    return ASDIC_OK;
}
