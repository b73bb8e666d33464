#include "environment.h"

#include "base/context.h"
#include "base/try.h"

#include "../../kernels/backscatter.h"
#include "../../kernels/ray.h"
#include "../../kernels/water.h"

#include <math.h>
#include <stdio.h>

asdic_environment asdic_environment_default(void) {
    return (asdic_environment){
        .temperature_degc = 10.0,
        .salinity_ppt = 35.0,
        .ph = 8.0,
        .wind_speed_kn = 10.0,
        .shipping_density = 0.5,
        .particle_strength_db = -90.0,
        .sound_speed_mps = NAN,
        .max_depth_m = NAN,
        .variant = ASDIC_VARIANT_CORRECTED,
    };
}

/* One numeric field: its range, and whether NAN ("derive it") is a value. */
typedef struct environment_field {
    const char *name, *unit;
    double value, min, max;
    bool may_be_derived;
} environment_field;

/* Planes nearer than this, and than this part of their depth, are one to single precision: over a step of 20 m/s in so
 * little a bottom is right to 0.05 dB r.m.s. down to 10 km, where one in a millimetre errs by 0.4. */
#define NEAREST_M 1e-3
#define NEAREST 1e-5

bool asdic_sound_profile_flaw(const asdic_sound_profile *p, size_t i, char *why, size_t size) {
    double depth = p->depth_m[i], speed = p->sound_speed_mps[i];
    double before = i > 0 ? p->depth_m[i - 1] : -INFINITY;
    double nearest = fmax(NEAREST_M, NEAREST * depth);
    if (!(depth >= 0.0 && depth <= 11000.0)) {
        snprintf(why, size, "a depth of %.15g m is out of range [0, 11000] m", depth);
    } else if (!(depth > before)) {
        snprintf(why, size,
                 "a depth of %.15g m is not below the %.15g m before; order the points from the "
                 "surface down, each depth once",
                 depth, before);
    } else if (depth - before < (1.0 - 1e-6) * nearest) {
        snprintf(why, size,
                 "a depth of %.15g m is less than %g m below the %.15g m before; leave one of the "
                 "two out, or for a step put them that far apart",
                 depth, nearest, before);
    } else if (!(speed >= ASDIC_SOUND_LEAST_MPS && speed <= ASDIC_SOUND_MOST_MPS)) {
        snprintf(why, size, "a sound speed of %.15g m/s is out of range [%g, %g] m/s", speed,
                 ASDIC_SOUND_LEAST_MPS, ASDIC_SOUND_MOST_MPS);
    } else {
        return false;
    }
    return true;
}

static asdic_status check_profile(asdic_context *ctx, const asdic_environment *env) {
    const asdic_sound_profile *p = &env->sound_speed_profile;
    if (p->points == 0) {
        return ASDIC_OK;
    }
    if (p->points < 2 || p->points > ASDIC_PROFILE_POINTS) {
        return asdic_fail(
            ctx, ASDIC_ERROR_ARGUMENT,
            "environment: 'sound_speed_profile' has %zu points, which is out of range "
            "[2, %d]",
            p->points, ASDIC_PROFILE_POINTS);
    }
    if (env->sound_speed_gradient_per_s != 0.0) {
        return asdic_fail(ctx, ASDIC_ERROR_ARGUMENT,
                          "environment: 'sound_speed_gradient_per_s' and 'sound_speed_profile' "
                          "exclude each other; give only one of them");
    }
    for (size_t i = 0; i < p->points; i++) {
        char why[256];
        if (asdic_sound_profile_flaw(p, i, why, sizeof why)) {
            return asdic_fail(ctx, ASDIC_ERROR_ARGUMENT,
                              "environment: 'sound_speed_profile', point %zu: %s", i + 1, why);
        }
    }
    return ASDIC_OK;
}

static asdic_status check_refraction(asdic_context *ctx, const asdic_environment *env) {
    if ((unsigned)env->refraction > ASDIC_REFRACTION_OFF) {
        return asdic_fail(ctx, ASDIC_ERROR_ARGUMENT, "environment: unknown refraction %d",
                          (int)env->refraction);
    }
    if (env->refraction == ASDIC_REFRACTION_LAYER &&
        !(env->layer_from_m >= 0.0 && env->layer_to_m >= env->layer_from_m &&
          env->layer_to_m <= 11000.0)) {
        return asdic_fail(
            ctx, ASDIC_ERROR_ARGUMENT,
            "environment: a layer fitted from %.15g m to %.15g m: depths ascend within "
            "[0, 11000] m",
            env->layer_from_m, env->layer_to_m);
    }
    return ASDIC_OK;
}

asdic_status asdic_environment_check(asdic_context *ctx, const asdic_environment *env) {
    if (!env) {
        return asdic_fail_null(ctx, __func__);
    }
    const environment_field fields[] = {
        {"temperature_degc", "degC", env->temperature_degc, -2.0, 40.0, false},
        {"salinity_ppt", "ppt", env->salinity_ppt, 0.0, 45.0, false},
        {"ph", "", env->ph, 7.0, 8.5, false},
        {"wind_speed_kn", "kn", env->wind_speed_kn, 0.0, 60.0, false},
        {"shipping_density", "", env->shipping_density, 0.0, 1.0, false},
        {"particle_strength_db", "dB", env->particle_strength_db, -200.0, 0.0, false},
        {"sound_speed_mps", "m/s", env->sound_speed_mps, ASDIC_SOUND_LEAST_MPS,
         ASDIC_SOUND_MOST_MPS, true},
        {"max_depth_m", "m", env->max_depth_m, 0.0, 11000.0, true},
        {"sound_speed_gradient_per_s", "1/s", env->sound_speed_gradient_per_s, -30.0, 30.0, false},
    };
    for (size_t i = 0; i < sizeof fields / sizeof *fields; i++) {
        const environment_field *f = &fields[i];
        if (f->may_be_derived && isnan(f->value)) {
            continue;
        }
        if (!(f->value >= f->min && f->value <= f->max)) {
            return asdic_fail(ctx, ASDIC_ERROR_ARGUMENT,
                              "environment: '%s' = %g is out of range [%g, %g] %s", f->name,
                              f->value, f->min, f->max, f->unit);
        }
    }
    if (env->variant != ASDIC_VARIANT_CORRECTED && env->variant != ASDIC_VARIANT_PRINTED) {
        return asdic_fail(ctx, ASDIC_ERROR_ARGUMENT, "environment: unknown variant %d",
                          (int)env->variant);
    }
    TRY(check_profile(ctx, env));
    return check_refraction(ctx, env);
}

asdic_status asdic_environment_check_depths(asdic_context *ctx, const asdic_environment *env,
                                            double from_m, double to_m) {
    double gradient = env ? env->sound_speed_gradient_per_s : 0.0;
    if (!env) {
        return asdic_fail_null(ctx, __func__);
    }
    if (gradient == 0.0 || env->sound_speed_profile.points) {
        return ASDIC_OK; /* every speed is a field, or lies between two */
    }
    double surface = asdic_environment_sound_speed_mps(env, 0.0);
    for (int i = 0; i < 2; i++) {
        double depth = i ? to_m : from_m, speed = surface + gradient * depth;
        if (speed >= ASDIC_SOUND_LEAST_MPS && speed <= ASDIC_SOUND_MOST_MPS) {
            continue;
        }
        double limit = speed < ASDIC_SOUND_LEAST_MPS ? ASDIC_SOUND_LEAST_MPS : ASDIC_SOUND_MOST_MPS;
        char zero[64] = "";
        if (speed <= 0.0) {
            snprintf(zero, sizeof zero, " and 0 at %.4g m", -surface / gradient);
        }
        return asdic_fail(ctx, ASDIC_ERROR_ARGUMENT,
                          "environment: 'sound_speed_gradient_per_s' = %.15g takes the sound speed "
                          "from %.6g m/s at the surface to %g m/s at a depth of %.4g m%s, and the "
                          "scene reaches %.4g m; the range is [%g, %g] m/s: give a profile that "
                          "ends where the gradient does",
                          gradient, surface, limit, (limit - surface) / gradient, zero, depth,
                          ASDIC_SOUND_LEAST_MPS, ASDIC_SOUND_MOST_MPS);
    }
    return ASDIC_OK;
}

double asdic_environment_absorption_db_per_km(const asdic_environment *env, double frequency_hz,
                                              double depth_m) {
    if (!env) {
        return NAN;
    }
    double z_m = isnan(env->max_depth_m) ? depth_m : env->max_depth_m;
    double f_khz = 1e-3 * frequency_hz;
    if (env->variant == ASDIC_VARIANT_PRINTED) {
        return absorption_printed_db_per_km(f_khz, env->temperature_degc, env->salinity_ppt, z_m,
                                            env->ph);
    }
    return absorption_db_per_km(f_khz, env->temperature_degc, env->salinity_ppt, z_m, env->ph);
}

asdic_water_column asdic_water_column_at(const asdic_environment *env, const asdic_sonar *sonar,
                                         double depth_m) {
    asdic_water_column water;
    water.sound_speed_mps = asdic_environment_sound_speed_mps(env, depth_m);
    water.wavelength_m = water.sound_speed_mps / sonar->frequency_hz;
    double alpha = asdic_environment_absorption_db_per_km(env, sonar->frequency_hz, depth_m);
    water.absorption_np_per_m = alpha * log(10.0) / 1e4;
    return water;
}

asdic_law_water asdic_water_column_laws(const asdic_water_column *water,
                                        const asdic_environment *env, const asdic_sonar *sonar) {
    return (asdic_law_water){.frequency_hz = sonar->frequency_hz,
                             .sound_speed_mps = water->sound_speed_mps,
                             .wavelength_m = water->wavelength_m,
                             .wind_speed_kn = env->wind_speed_kn};
}

double asdic_water_column_source_lin(const asdic_water_column *water, const asdic_environment *env,
                                     const asdic_sonar *sonar) {
    double source = pow(10.0, sonar->source_level_db / 10.0);
    return env->variant == ASDIC_VARIANT_PRINTED ? source * exp(-water->absorption_np_per_m)
                                                 : source;
}

double asdic_water_column_loss(const asdic_water_column *water, double bin_m, size_t bin) {
    return ray_tube_loss(water->absorption_np_per_m, ((double)bin + 0.5) * bin_m);
}

double asdic_water_column_volume(const asdic_water_column *water, double bin_m, double blanking_m,
                                 size_t bin) {
    double begin = fmax((double)bin * bin_m, blanking_m), end = (double)(bin + 1) * bin_m;
    if (end <= begin) {
        return 0.0;
    }
    /* Infinite from the sonar itself on. */
    return begin > 0.0 ? ray_water(water->absorption_np_per_m, begin, end) : INFINITY;
}

double asdic_volume_strength_lin(const asdic_environment *env, const asdic_sonar *sonar) {
    return pow(10.0,
               0.1 * volume_backscatter_db(env->particle_strength_db, sonar->frequency_hz / 1e3));
}
