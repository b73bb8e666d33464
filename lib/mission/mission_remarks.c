/* Remarks on laws that a mission uses outside the validity that their sources state. */
#include "mission.h"

#include "../../kernels/model.h"
#include "sim/model.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* The quantities that the validity of laws is stated in, by the names of `asdic model`. */
typedef struct situation {
    double t_degc, s_ppt, z_m, ph, f_khz, wind_kn;
} situation;

static const struct {
    const char *key;
    size_t at;
} quantities[] = {
    {"t_degc", offsetof(situation, t_degc)}, {"s_ppt", offsetof(situation, s_ppt)},
    {"z_m", offsetof(situation, z_m)},       {"ph", offsetof(situation, ph)},
    {"f_khz", offsetof(situation, f_khz)},   {"wind_kn", offsetof(situation, wind_kn)}};

static bool computes_speed(const asdic_mission *m) {
    return isnan(m->settings.environment.sound_speed_mps);
}

static bool always(const asdic_mission *m) {
    (void)m;
    return true;
}

static bool has_surface(const asdic_mission *m) {
    return asdic_scene_get_info(m->scene).has_surface;
}

static bool has_bottom_law(const asdic_mission *m) {
    if (asdic_scene_get_info(m->scene).has_bottom_plane) {
        return true;
    }
    for (size_t i = 0; i < m->object_count; i++) {
        if (m->objects[i].mesh.triangles > 0 && m->objects[i].material.law == ASDIC_LAW_BOTTOM) {
            return true;
        }
    }
    return false;
}

/* The laws that are valid for less than a scene may ask for. */
static const struct {
    size_t model;
    bool (*is_used)(const asdic_mission *m);
} laws[ASDIC_MOST_REMARKS] = {{MODEL_SOUND_SPEED, computes_speed},
                              {MODEL_ABSORPTION, always},
                              {MODEL_BOTTOM_BACKSCATTER, has_bottom_law},
                              {MODEL_SURFACE_BACKSCATTER, has_surface}};

/* The greatest depth: validity ends there, never near the surface. A mission may have 1e9 pings,
 * so a track is asked for it. */
static double depth_of(const asdic_mission *m) {
    double last_s;
    double depth_m = asdic_mission_pose(m, asdic_mission_ping_count(m) - 1, &last_s).position_m.z;
    return m->track ? asdic_track_deepest_m(m->track, last_s) : depth_m;
}

asdic_remarks asdic_mission_remarks(const asdic_mission *mission) {
    asdic_remarks out = {0};
    if (!mission) {
        return out;
    }
    const asdic_environment *env = &mission->settings.environment;
    situation s = {.t_degc = env->temperature_degc,
                   .s_ppt = env->salinity_ppt,
                   .z_m = depth_of(mission),
                   .ph = env->ph,
                   .f_khz = 1e-3 * mission->settings.sonar.frequency_hz,
                   .wind_kn = env->wind_speed_kn};
    for (size_t l = 0; l < ASDIC_MOST_REMARKS; l++) {
        const asdic_model_info *info = asdic_model_get(laws[l].model);
        double values[ASDIC_MODEL_MAX_KEYS];
        char keys[ASDIC_REMARK_SIZE - 64]; /* the rest is for the words round them */
        for (size_t k = 0; k < info->key_count; k++) {
            values[k] = NAN; /* unknown: nothing to remark */
            for (size_t q = 0; q < sizeof quantities / sizeof *quantities; q++) {
                if (strcmp(info->keys[k].name, quantities[q].key) == 0) {
                    values[k] = *(const double *)((const char *)&s + quantities[q].at);
                }
            }
        }
        if (laws[l].is_used(mission) && asdic_model_outside(info, values, keys, sizeof keys)) {
            snprintf(out.text[out.count++], ASDIC_REMARK_SIZE,
                     "%s: outside the validity of its source, with %s", info->name, keys);
        }
    }
    return out;
}
