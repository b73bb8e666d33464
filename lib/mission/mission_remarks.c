/*
 * Remarks on laws that a mission uses outside the validity that their sources state, on a sonar that
 * is hardly meant, on rays that are too few, and on files that cannot be written here.
 */
#include "mission.h"

#include "../../kernels/formulas.h"
#include "scene/scene.h"
#include "sim/model_table.h"
#include "sim/ring.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

void asdic_remark_add(asdic_remarks *out, const char *format, ...) {
    va_list args;
    va_start(args, format);
    if (out->count < ASDIC_MOST_REMARKS) {
        vsnprintf(out->text[out->count++], ASDIC_REMARK_SIZE, format, args);
    }
    va_end(args);
}

/* The quantities that the validity of laws is stated in, by the names of `asdic model`. */
typedef struct situation {
    double t_degc, s_ppt, z_m, ph, f_khz, wind_kn, wind_mps;
} situation;

static const struct {
    const char *key;
    size_t at;
} quantities[] = {
    {"t_degc", offsetof(situation, t_degc)},    {"s_ppt", offsetof(situation, s_ppt)},
    {"z_m", offsetof(situation, z_m)},          {"ph", offsetof(situation, ph)},
    {"f_khz", offsetof(situation, f_khz)},      {"wind_kn", offsetof(situation, wind_kn)},
    {"wind_mps", offsetof(situation, wind_mps)}};

/* The greatest depth: validity ends there, never near the surface. A mission may have 1e9 pings,
 * so a track is asked for it. */
static double depth_of(const asdic_mission *m) {
    double last_s;
    double depth_m = asdic_mission_pose(m, asdic_mission_ping_count(m) - 1, &last_s).position_m.z;
    return m->track ? asdic_track_deepest_m(m->track, last_s) : depth_m;
}

/* Adds what INFO's source does not vouch for, of S and of what MATERIAL (NULL: none) gives. */
static void remark(const asdic_model_info *info, const asdic_material *material, const situation *s,
                   asdic_remarks *out) {
    double values[ASDIC_MODEL_MAX_KEYS];
    char keys[ASDIC_REMARK_SIZE - 64]; /* the rest is for the words round them */
    for (size_t k = 0; k < info->key_count; k++) {
        values[k] = material ? material->value[k] : NAN; /* unknown: nothing to remark */
        for (size_t q = 0; q < sizeof quantities / sizeof *quantities; q++) {
            if (strcmp(info->keys[k].name, quantities[q].key) == 0) {
                values[k] = *(const double *)((const char *)s + quantities[q].at);
            }
        }
    }
    if (out->count == ASDIC_MOST_REMARKS || !asdic_model_outside(info, values, keys, sizeof keys)) {
        return;
    }
    char *text = out->text[out->count];
    snprintf(text, ASDIC_REMARK_SIZE, "%s: outside the validity of its source, with %s", info->name,
             keys);
    bool is_new = true;
    for (size_t i = 0; i < out->count; i++) {
        is_new &= strcmp(out->text[i], text) != 0;
    }
    out->count += is_new;
}

/* Adds that rays are too few, where they are. */
static void remark_rays(const asdic_mission *m, asdic_remarks *out) {
    asdic_ray_forecast f = asdic_mission_ray_forecast(m);
    if (f.is_rough) {
        char more[64] = "";
        if (f.is_auto) { /* and few all the same: as many as it ever takes */
            snprintf(more, sizeof more, "; a number of your own, or a tolerance, takes more");
        } else if (f.auto_rays > f.rays) {
            snprintf(more, sizeof more, "; 'rays: auto' would take %u", f.auto_rays);
        }
        asdic_remark_add(
            out,
            "rays: %u a ping%s are few for this sonar and scene: expect a stated error of "
            "about %.1f dB r.m.s.%s",
            f.rays, f.is_auto ? ", the most that 'auto' takes," : "", f.stderr_db, more);
    }
}

/* Bins in a cell of the range resolution: of more a bin holds so little of an echo that it is to be said. */
#define MOST_BINS 2.0

/* Adds what of SETTINGS is hardly meant, or forgotten. */
static void remark_on_sonar(const asdic_settings *settings, double speed_mps, asdic_remarks *out) {
    const asdic_sonar *sonar = &settings->sonar;
    double cell_m = speed_mps / (2.0 * sonar->bandwidth_hz);
    if (cell_m > MOST_BINS * sonar->bin_length_m) {
        asdic_remark_add(
            out,
            "sonar: the range resolution c / (2 bandwidth) of %.4g m is %.3g bins, of which each "
            "holds its part of an echo, %.1f dB less than all; 'bandwidth_khz' is %g kHz",
            cell_m, cell_m / sonar->bin_length_m, 10.0 * log10(cell_m / sonar->bin_length_m),
            1e-3 * sonar->bandwidth_hz);
    }
    double wavelength_m = speed_mps / sonar->frequency_hz;
    size_t dark = asdic_receivers_in_the_dark(sonar, wavelength_m);
    if (2 * dark > sonar->receiver_count) {
        asdic_remark_add(
            out,
            "sonar: %zu of %zu receivers look where 'transmitter' sends less than a hundredth "
            "of what it sends ahead: it is %.3g wavelengths wide and %.3g high",
            dark, sonar->receiver_count, sonar->transmitter.length_h_m / wavelength_m,
            sonar->transmitter.length_v_m / wavelength_m);
    }
    if (!settings->has_source_level) {
        asdic_remark_add(
            out, "sonar: no 'source_level_db': %s are those of a source of 0 dB re 1 uPa at 1 m%s",
            sonar->noise_enabled ? "echoes" : "levels",
            sonar->noise_enabled ? ", far below the noise, which is absolute; give one, or "
                                   "'noise: {enabled: false}'"
                                 : "");
    }
}

/* Of bodies smaller than this, k times the radius about them, geometric optics is no guide (docs/model.md). */
#define LEAST_KA 5.0

static void remark_on_small_objects(const asdic_mission *m, double wavelength_m,
                                    asdic_remarks *out) {
    const asdic_part *least = NULL;
    size_t small = 0;
    for (size_t i = 0; i < m->scene->part_count; i++) {
        const asdic_part *part = &m->scene->parts[i];
        bool is_small = part->kind == DEV_KIND_OBJECT &&
                        2.0 * ASDIC_PI * part->radius_m / wavelength_m < LEAST_KA;
        small += is_small;
        least = is_small && (!least || part->radius_m < least->radius_m) ? part : least;
    }
    if (small > 0) {
        asdic_remark_add(
            out,
            "objects: of '%s' k a is %.2g, and %zu in all have less than %g: too small for rays "
            "and facets; a 'point' has the strength that is known of it",
            least->name, 2.0 * ASDIC_PI * least->radius_m / wavelength_m, small, LEAST_KA);
    }
}

/* Pings that are looked at for how the vehicle moves; in between it moves alike. */
#define MOVES 1000

/* How far the vehicle goes and turns from a ping's beginning to its last echo, at most: a ping is simulated as of one
 * instant. A scanned head is turned between pings. */
static void most_move(const asdic_mission *m, double ping_s, double *turn_rad, double *way_m) {
    uint64_t pings = asdic_mission_ping_count(m), step = pings / MOVES + 1;
    for (uint64_t i = 0; i + 1 < pings; i += step) {
        double at_s, next_s;
        asdic_pose a = asdic_mission_vehicle_pose(m, i, &at_s);
        asdic_pose b = asdic_mission_vehicle_pose(m, i + 1, &next_s);
        double share = next_s > at_s ? fmin(ping_s / (next_s - at_s), 1.0) : 0.0;
        double turns[3] = {b.yaw_rad - a.yaw_rad, b.pitch_rad - a.pitch_rad,
                           b.roll_rad - a.roll_rad};
        for (int k = 0; k < 3; k++) {
            *turn_rad = fmax(*turn_rad, share * fabs(remainder(turns[k], 2.0 * ASDIC_PI)));
        }
        asdic_vec3 way = asdic_vec3_sub(b.position_m, a.position_m);
        *way_m = fmax(*way_m, share * asdic_vec3_length(way));
    }
}

/* Bins that the vehicle may go in a ping unremarked. */
#define MOST_WAY 10.0

static void remark_on_motion(const asdic_mission *m, double speed_mps, asdic_remarks *out) {
    const asdic_sonar *sonar = &m->settings.sonar;
    double range_m = asdic_sonar_max_range_m(sonar, speed_mps), turn_rad = 0.0, way_m = 0.0;
    double width_rad = INFINITY;
    for (size_t b = 0; b < sonar->receiver_count; b++) {
        width_rad = fmin(width_rad, asdic_beam_width_rad(sonar, b, speed_mps));
    }
    most_move(m, 2.0 * range_m / speed_mps, &turn_rad, &way_m);
    if (turn_rad > width_rad || way_m > MOST_WAY * sonar->bin_length_m) {
        asdic_remark_add(
            out,
            "mission: until the last echo of a ping the vehicle goes up to %.2g m and turns up to "
            "%.2g degrees, of beams of %.2g; a ping is simulated as of one instant",
            way_m, turn_rad * (180.0 / ASDIC_PI), width_rad * (180.0 / ASDIC_PI));
    }
}

/* Puts all of REST behind what of OUT leaves room for it. */
static void append(asdic_remarks *out, const asdic_remarks *rest) {
    size_t room = ASDIC_MOST_REMARKS - rest->count;
    out->count = out->count < room ? out->count : room;
    memcpy(out->text[out->count], rest->text, rest->count * ASDIC_REMARK_SIZE);
    out->count += rest->count;
}

asdic_remarks asdic_mission_remarks(const asdic_mission *mission) {
    asdic_remarks out = {0}, rest = {0};
    if (!mission) {
        return out;
    }
    const asdic_environment *env = &mission->settings.environment;
    situation s = {.t_degc = env->temperature_degc,
                   .s_ppt = env->salinity_ppt,
                   .z_m = depth_of(mission),
                   .ph = env->ph,
                   .f_khz = 1e-3 * mission->settings.sonar.frequency_hz,
                   .wind_kn = env->wind_speed_kn,
                   .wind_mps = env->wind_speed_kn * (1852.0 / 3600.0)};
    if (isnan(env->sound_speed_mps)) { /* computed */
        remark(asdic_model_get(MODEL_SOUND_SPEED), NULL, &s, &out);
    }
    situation absorbing = s;
    absorbing.z_m = isnan(env->max_depth_m) ? s.z_m : env->max_depth_m;
    remark(asdic_model_get(MODEL_ABSORPTION), NULL, &absorbing, &out);
    remark(asdic_model_get(MODEL_VOLUME_BACKSCATTER), NULL, &s, &out);
    const asdic_scene *scene = mission->scene;
    for (size_t i = 0; i < scene->material_count; i++) {
        const asdic_material *material = &scene->materials[i];
        if (material->law) {
            remark(&material->law->model, material, &s, &out);
        }
    }
    if (scene->has_surface) {
        remark(&scene->surface.law->model, &scene->surface, &s, &out);
    }
    remark_rays(mission, &rest);
    asdic_mission_remark_water(mission, &rest);
    double speed_mps = asdic_environment_sound_speed_mps(env, s.z_m);
    remark_on_small_objects(mission, speed_mps / mission->settings.sonar.frequency_hz, &rest);
    asdic_mission_remark_ambiguity(mission, speed_mps, &rest);
    remark_on_motion(mission, speed_mps, &rest);
    remark_on_sonar(&mission->settings, speed_mps, &rest);
    if (rest.count < ASDIC_MOST_REMARKS) {
        out.lacks_format = asdic_settings_lack(&mission->settings, rest.text[rest.count]);
        rest.count += out.lacks_format;
    }
    append(&out, &rest);
    return out;
}
