#include <asdic/plan.h>

#include "base/context.h"
#include "base/number.h"
#include "base/try.h"
#include "base/vec.h"
#include "bent_ray.h"
#include "coherent.h"
#include "noise_level.h"
#include "plan_case.h"
#include "quadrature_ping.h"
#include "scene/scene.h"

#include "../../kernels/beam.h"
#include "../../kernels/ray.h"
#include "../../kernels/water.h"

#include <stdarg.h>

/* The greatest sound speed that rays from the poses may meet. */
static double fastest_mps(const asdic_plan_case *c) {
    const asdic_sound_profile *profile = &c->env->sound_speed_profile;
    double from_m = fmax(c->depth_least_m - c->range_m, 0.0), to_m = c->depth_most_m + c->range_m;
    double fastest = fmax(asdic_environment_sound_speed_mps(c->env, from_m),
                          asdic_environment_sound_speed_mps(c->env, to_m));
    for (size_t i = 0; i < profile->points; i++) {
        fastest = fmax(fastest, profile->sound_speed_mps[i]);
    }
    return fmin(fastest, ASDIC_SOUND_MOST_MPS);
}

static void span(asdic_plan_case *c) {
    c->depth_least_m = c->altitude_least_m = INFINITY;
    c->depth_most_m = -INFINITY;
    for (size_t i = 0; i < c->count; i++) {
        double z = c->poses[i].position_m.z;
        c->depth_least_m = fmin(c->depth_least_m, z);
        c->depth_most_m = fmax(c->depth_most_m, z);
        if (c->scene->has_bottom_plane) {
            c->altitude_least_m = fmin(c->altitude_least_m, c->scene->bottom_plane_depth_m - z);
        }
    }
    asdic_reach reach = asdic_reach_of(c->sonar, c->sampling, c->water.sound_speed_mps);
    c->range_m = reach.to_m;
    c->from_m = reach.from_m;
    c->bends = asdic_environment_bends(c->env);
    c->reach_m =
        c->bends ? c->range_m * fmax(fastest_mps(c) / c->water.sound_speed_mps, 1.0) : c->range_m;
}

void asdic_plan_row_set(asdic_plan *plan, asdic_term term, bool kept, double bound_db,
                        const char *format, ...) {
    asdic_plan_row *row = &plan->rows[term];
    row->kept = kept;
    row->bound_db = bound_db;
    va_list args;
    va_start(args, format);
    asdic_c_print(row->reason, sizeof row->reason, format, args);
    va_end(args);
    if (!kept) {
        plan->left_out |= 1u << term;
    }
}

/* Sides, in wavelengths, from which on the solid angle goes as one over the side: right to 2e-5. */
#define LONG_WL 256.0

/* Integral over the sphere of the transmitter's one-way pattern: no echo can use more solid angle,
 * since a receiver's gain is at most 1. Midpoint sums over a quarter of the front, generously many,
 * even in elevation: a narrow beam over all bearings lies in few steps of its sine. */
static double transmit_solid_angle(const asdic_sonar *sonar, double wavelength_m) {
    const asdic_beam *beam = &sonar->transmitter;
    double length_h = beam->length_h_m / wavelength_m, length_v = beam->length_v_m / wavelength_m;
    double h = fmin(length_h, LONG_WL), v = fmin(length_v, LONG_WL);
    double rear = pow(10.0, sonar->rear_floor_db / 10.0), sum = 0.0;
    int rows = 32 + (int)(8.0 * v + 2.0 * h), columns = 32 + (int)(2.0 * h);
    for (int i = 0; i < rows; i++) {
        double elevation_rad = 0.5 * ASDIC_PI * (i + 0.5) / rows;
        double vz = sin(elevation_rad), m = cos(elevation_rad);
        for (int k = 0; k < columns; k++) {
            double phi = 0.5 * ASDIC_PI * (k + 0.5) / columns;
            sum += beam_pattern_lin(m * cos(phi), m * sin(phi), vz, h, v, rear) * m;
        }
    }
    return (1.0 + rear) * sum * ASDIC_PI / rows * ASDIC_PI / columns * (h / length_h) *
           (v / length_v);
}

double asdic_plan_change_db(double energy, double noise) {
    return noise > 0.0 ? 10.0 * log10(1.0 + energy / noise) : INFINITY;
}

/* The largest change that the water can make in any bin: all of it, seen through the transmitter's
 * whole solid angle. */
static double volume_bound_db(const asdic_plan_case *c) {
    double strength = asdic_volume_strength_lin(c->env, c->sonar);
    double source = pow(10.0, c->sonar->source_level_db / 10.0), most = 0.0;
    double solid_angle = transmit_solid_angle(c->sonar, c->water.wavelength_m);
    size_t bins = (size_t)(c->range_m / c->sonar->bin_length_m + 0.5);
    for (size_t n = 0; n < bins; n++) {
        double part = asdic_water_column_volume(&c->water, c->sonar->bin_length_m, c->from_m, n);
        most = fmax(most, source * strength * solid_angle * part);
    }
    return asdic_plan_change_db(c->bends ? most / ASDIC_LEAST_SPREAD : most, c->noise_lin);
}

/* The same for the surface: whole rings at full gain, at the steepest angle the mission has. */
static double surface_bound_db(const asdic_plan_case *c) {
    asdic_law_water water = asdic_water_column_laws(&c->water, c->env, c->sonar);
    asdic_scatterer surface = asdic_scatterer_at(&c->scene->surface, &water);
    bool rises = surface.device.law == DEV_LAW_COURSE;
    double source = pow(10.0, c->sonar->source_level_db / 10.0), most = 0.0;
    double bin = c->sonar->bin_length_m;
    size_t bins = (size_t)(c->range_m / bin + 0.5);
    for (size_t n = (size_t)(fmax(c->depth_least_m, c->from_m) / bin); n < bins; n++) {
        double near = fmax((double)n * bin, 1e-3);
        double sin_grazing = fmin(1.0, ray_plane_grazing(fmax(c->depth_most_m, 0.0), near));
        double scatter = rises ? asdic_scatterer_strength(&surface, sin_grazing)
                               : asdic_scatterer_most(&surface, c->range_m);
        /* dA = 2 pi d dd, times TL at the near end, where it is least. */
        double area = 2.0 * ASDIC_PI * (near + 0.5 * bin) * bin;
        double loss = ray_transmission(c->water.absorption_np_per_m, near);
        most = fmax(most, source * scatter * area * loss);
    }
    return asdic_plan_change_db(most, c->noise_lin);
}

static void plan_surface(const asdic_plan_case *c, asdic_plan *plan) {
    if (!c->scene->has_surface) {
        asdic_plan_row_set(plan, ASDIC_TERM_SURFACE, false, 0.0, "the scene has no surface");
        return;
    }
    if (c->depth_least_m > c->reach_m) {
        asdic_plan_row_set(plan, ASDIC_TERM_SURFACE, false, 0.0,
                           "the surface is never nearer than %.1f m, the range ends at %.1f m",
                           c->depth_least_m, c->reach_m);
        return;
    }
    double bound = c->bends ? INFINITY : surface_bound_db(c);
    bool kept = !(bound <= ASDIC_PLAN_NEGLIGIBLE_DB);
    asdic_plan_row_set(plan, ASDIC_TERM_SURFACE, kept, bound, "from %.1f m on%s", c->depth_least_m,
                       kept ? "" : ", below the noise in every bin");
}

static void plan_bottom(const asdic_plan_case *c, asdic_plan *plan) {
    bool mesh = false;
    for (size_t i = 0; i < c->scene->part_count; i++) {
        mesh = mesh || c->scene->parts[i].kind == DEV_KIND_BOTTOM;
    }
    if (mesh) {
        asdic_plan_row_set(plan, ASDIC_TERM_BOTTOM, true, INFINITY, "a mesh, traced");
    } else if (!c->scene->has_bottom_plane) {
        asdic_plan_row_set(plan, ASDIC_TERM_BOTTOM, false, 0.0, "the scene has no bottom");
    } else if (c->altitude_least_m > c->reach_m) {
        asdic_plan_row_set(plan, ASDIC_TERM_BOTTOM, false, 0.0,
                           "the bottom is never nearer than %.1f m, the range ends at %.1f m",
                           c->altitude_least_m, c->reach_m);
    } else {
        asdic_plan_row_set(plan, ASDIC_TERM_BOTTOM, true, INFINITY, "a plane, from %.1f m",
                           c->altitude_least_m);
    }
}

/* Absorption less its boric acid: both ways over the whole range. */
static void plan_boric_acid(const asdic_plan_case *c, asdic_plan *plan) {
    double f_khz = c->sonar->frequency_hz / 1e3;
    double z = isnan(c->env->max_depth_m) ? c->depth_most_m : c->env->max_depth_m;
    double c_mps =
        sound_speed_francois_garrison_mps(c->env->temperature_degc, c->env->salinity_ppt, z);
    double boric = absorption_boric_db_per_km(8.86, f_khz, c->env->temperature_degc,
                                              c->env->salinity_ppt, c->env->ph, c_mps);
    /* Levels count from 1 m, to which absorption adds. */
    double bound = 2.0 * fmax(c->range_m, 1.0) / 1e3 * boric;
    bool kept = !(bound <= ASDIC_PLAN_NEGLIGIBLE_DB);
    asdic_plan_row_set(plan, ASDIC_TERM_BORIC_ACID, kept, bound, "%.3g dB/km at %.0f kHz%s", boric,
                       f_khz, kept ? "; costs nothing" : "");
}

static void plan_rest(const asdic_plan_case *c, asdic_plan *plan) {
    double volume = volume_bound_db(c);
    bool keep_volume = !(volume <= ASDIC_PLAN_NEGLIGIBLE_DB);
    asdic_plan_row_set(plan, ASDIC_TERM_VOLUME, keep_volume, volume, "particles at %.0f dB%s",
                       c->env->particle_strength_db,
                       keep_volume ? "" : ", below the noise in every bin");
    if (c->sonar->noise_enabled) {
        asdic_plan_row_set(plan, ASDIC_TERM_NOISE, true, INFINITY, "from %.1f dB in a bin",
                           asdic_level_db(c->noise_lin));
    } else {
        asdic_plan_row_set(plan, ASDIC_TERM_NOISE, false, INFINITY, "switched off in the scene");
    }
    if (isfinite(c->sonar->rear_floor_db)) {
        asdic_plan_row_set(plan, ASDIC_TERM_REAR, true, INFINITY, "faces leak %.0f dB backwards",
                           c->sonar->rear_floor_db);
    } else {
        asdic_plan_row_set(plan, ASDIC_TERM_REAR, false, 0.0, "nothing is sent or heard backwards");
    }
}

/* Whether rays are needed: a quadrature gives what a flat scene without objects holds, once for every depth
 * and attitude of the mission. It takes some ten milliseconds a beam and pays when many pings share it. */

/* Pings per beam that one quadrature must serve. */
#define PINGS_PER_BEAM 32

/* How many depths and attitudes there are, or one more than a simulator remembers. */
static size_t count_views(const asdic_plan_case *c) {
    const asdic_pose *views[ASDIC_QUADRATURE_VIEWS];
    size_t count = 0;
    for (size_t i = 0; i < c->count; i++) {
        size_t k = 0;
        while (k < count && !asdic_quadrature_same_view(views[k], &c->poses[i])) {
            k++;
        }
        if (k == count && count == ASDIC_QUADRATURE_VIEWS) {
            return ASDIC_QUADRATURE_VIEWS + 1;
        }
        views[k] = k == count ? &c->poses[i] : views[k];
        count += k == count;
    }
    return count;
}

static void plan_rays(const asdic_plan_case *c, asdic_plan *plan) {
    size_t views = count_views(c);
    if (!asdic_quadrature_knows(c->scene, c->env, c->sampling, c->depth_least_m,
                                c->altitude_least_m)) {
        asdic_plan_row_set(plan, ASDIC_TERM_RAYS, true, INFINITY, "%u a ping", c->sampling->rays);
    } else if (views > ASDIC_QUADRATURE_VIEWS ||
               c->count < PINGS_PER_BEAM * c->sonar->receiver_count * views) {
        asdic_plan_row_set(plan, ASDIC_TERM_RAYS, true, 0.0,
                           "%u a ping: a quadrature would serve too few pings", c->sampling->rays);
    } else {
        asdic_plan_row_set(plan, ASDIC_TERM_RAYS, false, 0.0,
                           "a flat scene without objects: %zu quadratures for %zu pings", views,
                           c->count);
    }
}

const char *asdic_term_name(asdic_term term) {
    static const char *const names[ASDIC_TERM_COUNT] = {"bottom",    "surface",    "volume",
                                                        "objects",   "multipath",  "noise",
                                                        "rear half", "boric acid", "rays"};
    return (unsigned)term < ASDIC_TERM_COUNT ? names[term] : "unknown term";
}

asdic_status asdic_plan_make(asdic_context *ctx, const asdic_scene *scene,
                             const asdic_environment *env, const asdic_sonar *sonar,
                             const asdic_sampling *sampling, const asdic_pose *poses, size_t count,
                             asdic_plan *out) {
    if (!scene || !env || !sonar || !sampling || !poses || count == 0 || !out) {
        return asdic_fail(ctx, ASDIC_ERROR_ARGUMENT, "asdic_plan_make: NULL or no pose");
    }
    if (!scene->committed) {
        return asdic_fail(ctx, ASDIC_ERROR_ARGUMENT, "asdic_plan_make: the scene is not committed");
    }
    TRY(asdic_environment_check(ctx, env));
    TRY(asdic_sonar_check(ctx, sonar));
    for (size_t i = 0; i < count; i++) {
        TRY(asdic_pose_check(ctx, &poses[i]));
    }
    *out = (asdic_plan){.left_out = 0};
    for (int t = 0; t < ASDIC_TERM_COUNT; t++) {
        out->rows[t].name = asdic_term_name((asdic_term)t);
    }
    asdic_plan_case c = {scene, env, sonar, sampling, poses, count, .water = {0}};
    c.water = asdic_water_column_at(env, sonar, poses[0].position_m.z);
    c.noise_lin = asdic_noise_least_lin(env, sonar, c.water.sound_speed_mps);
    span(&c);
    plan_bottom(&c, out);
    plan_surface(&c, out);
    asdic_plan_objects(&c, out);
    plan_rest(&c, out);
    plan_boric_acid(&c, out);
    plan_rays(&c, out);
    return ASDIC_OK;
}
