/*
 * From the units of the scene file to those of the library.
 */
#include "scene_file.h"
#include "scene_laws.h"

#include "base/vec.h"

#include <stdio.h>

static double radians(double deg) {
    return deg * (ASDIC_PI / 180.0);
}

static asdic_sound_profile convert_profile(const asdic_list *list) {
    asdic_sound_profile profile = {.points = list->count};
    const double *pair = list->items;
    for (size_t i = 0; i < list->count && i < ASDIC_PROFILE_POINTS; i++) {
        profile.depth_m[i] = pair[2 * i];
        profile.sound_speed_mps[i] = pair[2 * i + 1];
    }
    return profile;
}

asdic_environment asdic_scene_file_environment(const asdic_scene_file *file) {
    const file_environment *e = &file->environment;
    return (asdic_environment){
        .temperature_degc = e->temperature_degc,
        .salinity_ppt = e->salinity_ppt,
        .ph = e->ph,
        .wind_speed_kn = e->wind_speed_kn,
        .shipping_density = e->shipping_density,
        .particle_strength_db = e->particle_strength_db,
        .sound_speed_mps = e->sound_speed_mps,
        .max_depth_m = e->max_depth_m,
        .variant = (asdic_variant)file->model.variant,
        .sound_speed_gradient_per_s = e->sound_speed_gradient_per_s,
        .sound_speed_profile = convert_profile(&e->sound_speed_profile),
    };
}

static asdic_beam convert_beam(const file_beam *b, const char *name) {
    asdic_beam beam = {
        .pitch_rad = radians(b->pitch_deg),
        .yaw_rad = radians(b->yaw_deg),
        .roll_rad = radians(b->roll_deg),
        .length_h_m = b->length_h_m,
        .length_v_m = b->length_v_m,
    };
    snprintf(beam.name, sizeof beam.name, "%s", name);
    return beam;
}

static asdic_array convert_array(const asdic_scene_file *file) {
    const file_array *a = &file->sonar.array;
    asdic_environment env = asdic_scene_file_environment(file);
    double wavelength_m =
        asdic_environment_sound_speed_mps(&env, 0.0) / (1e3 * file->sonar.frequency_khz);
    double spacing_m = a->spacing_wl * wavelength_m;
    file_beam element = {.pitch_deg = a->pitch_deg,
                         .yaw_deg = a->yaw_deg,
                         .roll_deg = a->roll_deg,
                         .length_h_m =
                             isnan(a->element.length_h_m) ? spacing_m : a->element.length_h_m,
                         .length_v_m = a->element.length_v_m};
    return (asdic_array){.elements = (size_t)a->elements,
                         .spacing_m = spacing_m,
                         .shading = (asdic_shading)a->shading,
                         .side_lobe_db = isnan(a->side_lobe_db) ? -30.0 : a->side_lobe_db,
                         .element = convert_beam(&element, "element")};
}

asdic_sonar asdic_scene_file_sonar(const asdic_scene_file *file) {
    const file_sonar *s = &file->sonar;
    return (asdic_sonar){
        .frequency_hz = 1e3 * s->frequency_khz,
        .bandwidth_hz = 1e3 * s->bandwidth_khz,
        .ping_rate_hz = s->ping_rate_hz,
        .max_range_m = s->max_range_m,
        .source_level_db = s->source_level_db,
        .bin_length_m = s->bin_length_m,
        .blanking_m = s->blanking_m,
        .transmitter = convert_beam(&s->transmitter, "transmitter"),
        .array = s->array.node ? convert_array(file) : (asdic_array){0},
        .receiver_count = s->array.node          ? (size_t)s->array.beams.count
                          : s->receiver_fan.node ? (size_t)s->receiver_fan.fan.count
                                                 : s->receivers.count,
        .noise_enabled = s->noise.enabled,
        .noise_directivity = s->noise.directivity,
        .self_noise_db = s->noise.self_db,
        .speckle = (asdic_speckle)s->speckle,
        .speckle_shape = isnan(s->speckle_shape) ? INFINITY : s->speckle_shape,
        .rear_floor_db = s->rear_floor_db,
    };
}

asdic_sweep asdic_scene_file_sweep(const asdic_scene_file *file) {
    const file_sweep *scan = &file->sonar.scan;
    return scan->node ? asdic_sweep_of(radians(scan->sector_deg), radians(scan->step_deg))
                      : (asdic_sweep){0};
}

/* The beam of an array, aimed as FAN says, that looks BEARING_DEG to starboard of its front, in its
 * plane. */
static void turn_in_plane(const file_fan *fan, double bearing_deg, asdic_beam *beam) {
    asdic_mat3 array = asdic_mat3_attitude(radians(fan->roll_deg), -radians(fan->pitch_deg),
                                           radians(fan->yaw_deg));
    asdic_mat3 face =
        asdic_mat3_multiply(array, asdic_mat3_attitude(0.0, 0.0, radians(bearing_deg)));
    beam->pitch_rad = asin(fmax(fmin(face.m[2][0], 1.0), -1.0));
    /* Whole turns as the untilted beam has them: bearings go on astern. */
    double yaw_rad = radians(fan->yaw_deg + bearing_deg);
    beam->yaw_rad =
        yaw_rad + remainder(atan2(face.m[1][0], face.m[0][0]) - yaw_rad, 2.0 * ASDIC_PI);
    beam->roll_rad = atan2(face.m[2][1], face.m[2][2]);
}

/* The fan that an array's beams look along. */
static file_fan fan_of(const file_array *a) {
    return (file_fan){.count = a->beams.count,
                      .sector_deg = a->beams.sector_deg,
                      .shape = FILE_FAN_PLANE,
                      .pitch_deg = a->pitch_deg,
                      .yaw_deg = a->yaw_deg,
                      .roll_deg = a->roll_deg};
}

/* COUNT beams share the sector; each looks along the middle of its share, the first to port. */
static void convert_fan(const file_fan *fan, asdic_beam *beams) {
    bool level = fan->pitch_deg == 0.0 && fan->roll_deg == 0.0; /* a plane is a cone then */
    int digits = fan->count > 1000 ? 4 : 3;                     /* so that names sort as beams do */
    for (int64_t i = 0; i < fan->count; i++) {
        double share = ((double)i + 0.5) / (double)fan->count - 0.5;
        file_beam beam = {.pitch_deg = fan->pitch_deg,
                          .yaw_deg = fan->yaw_deg + share * fan->sector_deg,
                          .roll_deg = fan->roll_deg,
                          .length_h_m = fan->length_h_m,
                          .length_v_m = fan->length_v_m};
        char name[ASDIC_NAME_SIZE];
        snprintf(name, sizeof name, "%0*lld", digits, (long long)i);
        beams[i] = convert_beam(&beam, name);
        if (fan->shape == FILE_FAN_PLANE && !level) {
            turn_in_plane(fan, share * fan->sector_deg, &beams[i]);
        }
    }
}

void asdic_scene_file_receivers(const asdic_scene_file *file, asdic_beam *beams) {
    if (file->sonar.array.node) {
        asdic_array array = convert_array(file);
        file_fan fan = fan_of(&file->sonar.array);
        convert_fan(&fan, beams);
        asdic_array_form(&array, array.spacing_m / file->sonar.array.spacing_wl, beams,
                         (size_t)fan.count);
        return;
    }
    if (file->sonar.receiver_fan.node) {
        convert_fan(&file->sonar.receiver_fan.fan, beams);
        return;
    }
    const file_beam *list = file->sonar.receivers.items;
    for (size_t i = 0; i < file->sonar.receivers.count; i++) {
        beams[i] = convert_beam(&list[i], list[i].name);
    }
}

/* Turns of a trial's rule stay this short of half a turn, which could be made to either side. */
#define HAIR_RAD 1e-6

asdic_trial_plan asdic_scene_file_trial(const file_trial *t) {
    return (asdic_trial_plan){
        .hull_radius_m = t->hull_radius_m,
        .time_s = t->time_s,
        .background = (asdic_trial_background)t->background,
        .manoeuvre = (asdic_manoeuvre)t->rule.manoeuvre,
        .reach_m = t->rule.reach_m,
        .sector_rad = t->rule.sector_deg * ASDIC_PI / 180.0,
        .posterior =
            isnan(t->rule.loss_ratio) ? t->rule.posterior : 1.0 / (1.0 + t->rule.loss_ratio),
        .hits = (unsigned)t->rule.hits,
        .of = (unsigned)t->rule.of,
        .climb_m = t->rule.climb_m,
        .turn_rad = fmin(t->rule.turn_deg * ASDIC_PI / 180.0, ASDIC_PI - HAIR_RAD),
        .hold_s = t->rule.hold_s,
        .is_ideal = t->ideal.node != NULL,
        .pd = t->ideal.pd,
        .pfa = t->ideal.pfa,
    };
}

asdic_pose asdic_scene_file_place(const double position_m[3], const double rotation_deg[3]) {
    return (asdic_pose){
        .position_m = {position_m[0], position_m[1], position_m[2]},
        .roll_rad = radians(rotation_deg[0]),
        .pitch_rad = radians(rotation_deg[1]),
        .yaw_rad = radians(rotation_deg[2]),
    };
}

asdic_pose asdic_scene_file_pose(const asdic_scene_file *file) {
    const file_pose *p = &file->mission.pose;
    const double rotation_deg[3] = {p->roll_deg, p->pitch_deg, p->yaw_deg};
    return asdic_scene_file_place(p->position_m, rotation_deg);
}

asdic_material asdic_scene_file_surface(const asdic_scene_file *file, asdic_material_file *rows) {
    const file_surface *surface = &file->surface;
    return asdic_scene_laws_material(ASDIC_LAW_SURFACE, surface->node, &surface->law, rows);
}

asdic_material asdic_scene_file_bottom(const asdic_scene_file *file, asdic_material_file *rows) {
    const file_bottom *bottom = &file->bottom;
    return asdic_scene_laws_material(ASDIC_LAW_BOTTOM, bottom->node, &bottom->law, rows);
}

asdic_material asdic_scene_file_material(const file_object *object, asdic_material_file *rows) {
    const file_material *m = &object->material;
    return m->node ? asdic_scene_laws_material(ASDIC_LAW_OBJECT, m->node, &m->law, rows)
                   : asdic_scene_laws_material(ASDIC_LAW_OBJECT, object->node, &object->law, rows);
}
