#include <asdic/plan.h>

#include "aim.h"
#include "base/context.h"
#include "base/vec.h"
#include "materials.h"
#include "noise_level.h"
#include "scene/moving.h"
#include "scene/scene.h"
#include "water_column.h"

#include "../../kernels/backscatter.h"
#include "../../kernels/beam.h"
#include "../../kernels/water.h"

#include <stdarg.h>
#include <stdio.h>

/* What the poses of a mission span. */
typedef struct span {
    double depth_least_m, depth_most_m;
    double altitude_least_m; /* above a bottom plane; INFINITY without one */
    double range_m;
} span;

static span span_of(const asdic_scene *scene, const asdic_sonar *sonar, double sound_speed_mps,
                    const asdic_pose *poses, size_t count) {
    span s = {INFINITY, -INFINITY, INFINITY, 0.0};
    for (size_t i = 0; i < count; i++) {
        double z = poses[i].position_m.z;
        s.depth_least_m = fmin(s.depth_least_m, z);
        s.depth_most_m = fmax(s.depth_most_m, z);
        if (scene->has_bottom_plane) {
            s.altitude_least_m = fmin(s.altitude_least_m, scene->bottom_plane_depth_m - z);
        }
    }
    s.range_m = (double)asdic_sonar_bin_count(sonar, sound_speed_mps) * sonar->bin_length_m;
    return s;
}

static void row_set(asdic_plan *plan, asdic_term term, bool kept, double bound_db,
                    const char *format, ...) __attribute__((format(printf, 5, 6)));

static void row_set(asdic_plan *plan, asdic_term term, bool kept, double bound_db,
                    const char *format, ...) {
    asdic_plan_row *row = &plan->rows[term];
    row->kept = kept;
    row->bound_db = bound_db;
    va_list args;
    va_start(args, format);
    vsnprintf(row->reason, sizeof row->reason, format, args);
    va_end(args);
    if (!kept) {
        plan->left_out |= 1u << term;
    }
}

/* Integral over the sphere of the transmitter's one-way pattern: no echo can use more solid angle,
 * since a receiver's gain is at most 1. Midpoint sums, generously many. */
static double transmit_solid_angle(const asdic_sonar *sonar, double wavelength_m) {
    const asdic_beam *beam = &sonar->transmitter;
    double h = beam->length_h_m / wavelength_m, v = beam->length_v_m / wavelength_m;
    double rear = pow(10.0, sonar->rear_floor_db / 10.0), sum = 0.0;
    int rows = 64 + (int)(16.0 * v), columns = 64 + (int)(16.0 * h);
    for (int i = 0; i < rows; i++) {
        double vz = -1.0 + 2.0 * (i + 0.5) / rows, m = sqrt((1.0 - vz) * (1.0 + vz));
        for (int k = 0; k < columns; k++) {
            double phi = ASDIC_PI * ((k + 0.5) / columns - 0.5);
            sum += beam_pattern_lin(m * cos(phi), m * sin(phi), vz, h, v, rear);
        }
    }
    return (1.0 + rear) * sum * 2.0 / rows * ASDIC_PI / columns;
}

/* How much an energy E added to a bin of noise N changes its level, dB; INFINITY without noise. */
static double change_db(double energy, double noise) {
    return noise > 0.0 ? 10.0 * log10(1.0 + energy / noise) : INFINITY;
}

/* The largest change that the water can make in any bin: all of it, seen through the transmitter's
 * whole solid angle. */
static double volume_bound_db(const asdic_environment *env, const asdic_sonar *sonar,
                              const asdic_water_column *water, double noise, double range_m) {
    double strength = pow(
        10.0, 0.1 * volume_backscatter_db(env->particle_strength_db, sonar->frequency_hz / 1e3));
    double source = pow(10.0, sonar->source_level_db / 10.0), most = 0.0;
    double solid_angle = transmit_solid_angle(sonar, water->wavelength_m);
    size_t bins = (size_t)(range_m / sonar->bin_length_m + 0.5);
    for (size_t n = 0; n < bins; n++) {
        double part = asdic_water_column_volume(water, sonar->bin_length_m, sonar->blanking_m, n);
        most = fmax(most, source * strength * solid_angle * part);
    }
    return change_db(most, noise);
}

/* The same for the surface: whole rings at full gain, at the steepest angle the mission has. */
static double surface_bound_db(const asdic_environment *env, const asdic_sonar *sonar,
                               const asdic_water_column *water, double noise, const span *s) {
    double f_khz = sonar->frequency_hz / 1e3, wind = env->wind_speed_kn;
    double source = pow(10.0, sonar->source_level_db / 10.0), most = 0.0;
    double bin = sonar->bin_length_m;
    size_t bins = (size_t)(s->range_m / bin + 0.5);
    for (size_t n = (size_t)(fmax(s->depth_least_m, sonar->blanking_m) / bin); n < bins; n++) {
        double near = fmax((double)n * bin, 1e-3);
        double sin_grazing = fmin(1.0, fmax(s->depth_most_m, 0.0) / near);
        double scatter =
            surface_backscatter_lin(surface_gain(wind, f_khz), surface_beta0(wind),
                                    surface_beta1(f_khz), surface_cap_lin(wind), sin_grazing);
        /* dA = 2 pi d dd, times TL at the near end, where it is least. */
        double area = 2.0 * ASDIC_PI * (near + 0.5 * bin) * bin;
        double loss = exp(-2.0 * water->absorption_np_per_m * (near - 1.0)) / pow(near, 4.0);
        most = fmax(most, source * scatter * area * loss);
    }
    return change_db(most, noise);
}

static void plan_surface(asdic_plan *plan, const asdic_scene *scene, const asdic_environment *env,
                         const asdic_sonar *sonar, const asdic_water_column *water, double noise,
                         const span *s) {
    if (!scene->has_surface) {
        row_set(plan, ASDIC_TERM_SURFACE, false, 0.0, "the scene has no surface");
        return;
    }
    if (s->depth_least_m > s->range_m) {
        row_set(plan, ASDIC_TERM_SURFACE, false, 0.0,
                "the surface is never nearer than %.1f m, the range ends at %.1f m",
                s->depth_least_m, s->range_m);
        return;
    }
    double bound = surface_bound_db(env, sonar, water, noise, s);
    bool kept = !(bound <= ASDIC_PLAN_NEGLIGIBLE_DB);
    row_set(plan, ASDIC_TERM_SURFACE, kept, bound, "from %.1f m on%s", s->depth_least_m,
            kept ? "" : ", below the noise in every bin");
}

static void plan_bottom(asdic_plan *plan, const asdic_scene *scene, const span *s) {
    bool mesh = false;
    for (size_t i = 0; i < scene->part_count; i++) {
        mesh = mesh || scene->parts[i].kind == DEV_KIND_BOTTOM;
    }
    if (mesh) {
        row_set(plan, ASDIC_TERM_BOTTOM, true, INFINITY, "a mesh, traced");
    } else if (!scene->has_bottom_plane) {
        row_set(plan, ASDIC_TERM_BOTTOM, false, 0.0, "the scene has no bottom");
    } else if (s->altitude_least_m > s->range_m) {
        row_set(plan, ASDIC_TERM_BOTTOM, false, 0.0,
                "the bottom is never nearer than %.1f m, the range ends at %.1f m",
                s->altitude_least_m, s->range_m);
    } else {
        row_set(plan, ASDIC_TERM_BOTTOM, true, INFINITY, "a plane, from %.1f m",
                s->altitude_least_m);
    }
}

static bool part_in_reach(const asdic_part *part, const asdic_pose *poses, size_t count,
                          double range_m) {
    if (part->moves) { /* anywhere */
        return true;
    }
    for (size_t i = 0; i < count; i++) {
        asdic_vec3 d = asdic_vec3_sub(part->center_m, poses[i].position_m);
        if (asdic_vec3_length(d) - part->radius_m <= range_m) {
            return true;
        }
    }
    return false;
}

/* Where an object moves to is not known here. */
static bool moves(const asdic_scene *scene, size_t part) {
    for (size_t i = 0; i < scene->movable_count; i++) {
        if (scene->movables[i].part == part) {
            return true;
        }
    }
    return false;
}

/* Objects, and whether one within reach passes mirror rays on. */
static void plan_objects(asdic_plan *plan, const asdic_scene *scene, const asdic_sonar *sonar,
                         const asdic_sampling *sampling, double sound_speed_mps,
                         const asdic_pose *poses, size_t count, double range_m) {
    size_t objects = 0, reached = 0, mirrors = 0;
    for (size_t i = 0; i < scene->part_count; i++) {
        const asdic_part *part = &scene->parts[i];
        if (part->kind != DEV_KIND_OBJECT) {
            continue;
        }
        objects++;
        if (!moves(scene, i) && !part_in_reach(part, poses, count, range_m)) {
            continue;
        }
        reached++;
        dev_material m = asdic_material_coefficients(&scene->materials[part->material],
                                                     sonar->frequency_hz, sound_speed_mps);
        mirrors += m.law == DEV_LAW_FACET && m.reflection2 > DEV_MIN_MIRROR;
    }
    for (size_t i = 0; i < scene->point_count; i++) {
        asdic_part point = {.center_m = scene->points[i].position_m};
        objects++;
        reached += part_in_reach(&point, poses, count, range_m);
    }
    if (reached > 0) {
        row_set(plan, ASDIC_TERM_OBJECTS, true, INFINITY, "%zu of %zu come within range", reached,
                objects);
    } else {
        row_set(plan, ASDIC_TERM_OBJECTS, false, 0.0, "none of %zu comes within range", objects);
    }
    if (sampling->multipath == ASDIC_MULTIPATH_OFF) {
        row_set(plan, ASDIC_TERM_MULTIPATH, false, INFINITY, "switched off in the scene");
    } else if (sampling->multipath == ASDIC_MULTIPATH_BOUNDARIES) {
        row_set(plan, ASDIC_TERM_MULTIPATH, true, INFINITY,
                "%zu objects and the boundaries reflect", mirrors);
    } else if (mirrors > 0) {
        row_set(plan, ASDIC_TERM_MULTIPATH, true, INFINITY, "%zu objects reflect", mirrors);
    } else {
        row_set(plan, ASDIC_TERM_MULTIPATH, false, 0.0, "nothing within range reflects");
    }
}

static void plan_boric_acid(asdic_plan *plan, const asdic_environment *env,
                            const asdic_sonar *sonar, double depth_m, double range_m) {
    double f_khz = sonar->frequency_hz / 1e3;
    double z = isnan(env->max_depth_m) ? depth_m : env->max_depth_m;
    double c_mps = sound_speed_francois_garrison_mps(env->temperature_degc, env->salinity_ppt, z);
    double boric = absorption_boric_db_per_km(8.86, f_khz, env->temperature_degc, env->salinity_ppt,
                                              env->ph, c_mps);
    double bound = 2.0 * range_m / 1e3 * boric;
    row_set(plan, ASDIC_TERM_BORIC_ACID, true, bound, "%.3g dB/km at %.0f kHz; costs nothing",
            boric, f_khz);
}

const char *asdic_term_name(asdic_term term) {
    static const char *const names[ASDIC_TERM_COUNT] = {
        "bottom", "surface", "volume", "objects", "multipath", "noise", "rear half", "boric acid"};
    return (unsigned)term < ASDIC_TERM_COUNT ? names[term] : "unknown term";
}

asdic_status asdic_plan_make(asdic_context *ctx, const asdic_scene *scene,
                             const asdic_environment *env, const asdic_sonar *sonar,
                             const asdic_sampling *sampling, const asdic_pose *poses, size_t count,
                             asdic_plan *out) {
    if (!scene || !env || !sonar || !sampling || !poses || count == 0 || !out) {
        return asdic_fail(ctx, ASDIC_ERROR_ARGUMENT, "asdic_plan_make: NULL or no pose");
    }
    asdic_status status = asdic_environment_check(ctx, env);
    if (status || (status = asdic_sonar_check(ctx, sonar))) {
        return status;
    }
    *out = (asdic_plan){.left_out = 0};
    for (int t = 0; t < ASDIC_TERM_COUNT; t++) {
        out->rows[t].name = asdic_term_name((asdic_term)t);
    }
    asdic_water_column water = asdic_water_column_at(env, sonar, poses[0].position_m.z);
    span s = span_of(scene, sonar, water.sound_speed_mps, poses, count);
    double noise = asdic_noise_least_lin(env, sonar, water.sound_speed_mps);
    plan_bottom(out, scene, &s);
    plan_surface(out, scene, env, sonar, &water, noise, &s);
    double volume = volume_bound_db(env, sonar, &water, noise, s.range_m);
    bool keep_volume = !(volume <= ASDIC_PLAN_NEGLIGIBLE_DB);
    row_set(out, ASDIC_TERM_VOLUME, keep_volume, volume, "particles at %.0f dB%s",
            env->particle_strength_db, keep_volume ? "" : ", below the noise in every bin");
    plan_objects(out, scene, sonar, sampling, water.sound_speed_mps, poses, count, s.range_m);
    if (sonar->noise_enabled) {
        row_set(out, ASDIC_TERM_NOISE, true, INFINITY, "from %.1f dB in a bin",
                asdic_level_db(noise));
    } else {
        row_set(out, ASDIC_TERM_NOISE, false, INFINITY, "switched off in the scene");
    }
    if (isfinite(sonar->rear_floor_db)) {
        row_set(out, ASDIC_TERM_REAR, true, INFINITY, "faces leak %.0f dB backwards",
                sonar->rear_floor_db);
    } else {
        row_set(out, ASDIC_TERM_REAR, false, 0.0, "nothing is sent or heard backwards");
    }
    plan_boric_acid(out, env, sonar, s.depth_most_m, s.range_m);
    return ASDIC_OK;
}
