/*
 * The water: what the sound speed, absorption, scattering and noise depend on. Fields carry the
 * published units of the formulas they enter (degrees Celsius, parts per thousand, knots).
 */
#ifndef ASDIC_ENVIRONMENT_H
#define ASDIC_ENVIRONMENT_H

#include <asdic/context.h>

#ifdef __cplusplus
extern "C" {
#endif

/* The right form, or the form that the paper prints, of absorption and transmission loss: slips 1,
 * 2 and 5 in kernels/README.md. */
typedef enum asdic_variant { ASDIC_VARIANT_CORRECTED, ASDIC_VARIANT_PRINTED } asdic_variant;

/* Points of a sound-speed profile, at most. */
#define ASDIC_PROFILE_POINTS 64

/* Sound speed over depth: linear between points, constant above the first and below the last. */
typedef struct asdic_sound_profile {
    size_t points;                                /* 0: no profile; else 2..ASDIC_PROFILE_POINTS */
    double depth_m[ASDIC_PROFILE_POINTS];         /* 0..11000, 1e-3 apart or more */
    double sound_speed_mps[ASDIC_PROFILE_POINTS]; /* 1300..1700 */
} asdic_sound_profile;

/* How much of a profile rays follow: all its layers; the one layer, linear in depth, that fits it
 * best between two depths; none, so that rays are straight. */
typedef enum asdic_refraction {
    ASDIC_REFRACTION_FULL,
    ASDIC_REFRACTION_LAYER,
    ASDIC_REFRACTION_OFF
} asdic_refraction;

typedef struct asdic_environment {
    double temperature_degc;     /* 0..35 valid, -2..40 accepted */
    double salinity_ppt;         /* 0..45 */
    double ph;                   /* 7.0..8.5 */
    double wind_speed_kn;        /* 0..60 */
    double shipping_density;     /* 0 very light .. 1 heavy */
    double particle_strength_db; /* Sp: low -90, moderate -70, high -50 dB re 1/m at 1 kHz */
    double sound_speed_mps;      /* NAN: from temperature, salinity and the depth of the sonar */
    double max_depth_m;          /* depth used for absorption; NAN: depth of the sonar */
    asdic_variant variant;
    /* Change of the sound speed with depth, -30..30 1/s, 0: none. The speed at depth 0 is then
     * sound_speed_mps, or derived for that depth. Not together with a profile. */
    double sound_speed_gradient_per_s;
    asdic_sound_profile sound_speed_profile; /* in place of sound_speed_mps */
    asdic_refraction refraction;
    double layer_from_m, layer_to_m; /* of ASDIC_REFRACTION_LAYER: between them it is fitted */
} asdic_environment;

/* 10 degC, 35 ppt, pH 8, 10 kn, shipping 0.5, low particle density, derived speed and depth. */
ASDIC_API asdic_environment asdic_environment_default(void);

/* Checks every field against its range; the error names field, value and limit. */
ASDIC_API asdic_status asdic_environment_check(asdic_context *ctx, const asdic_environment *env);

/* Whether rays bend: whether the sound speed they meet changes with depth anywhere. The change by
 * pressure alone, 0.016 1/s, is left out where neither gradient nor profile is given. */
ASDIC_API bool asdic_environment_bends(const asdic_environment *env);

/* Checks that the sound speed stays within 1300..1700 m/s from FROM_M to TO_M, the depths that a
 * scene reaches; the error names the depth at which it does not. */
ASDIC_API asdic_status asdic_environment_check_depths(asdic_context *ctx,
                                                      const asdic_environment *env, double from_m,
                                                      double to_m);

/* Sound speed at DEPTH_M, m/s: of the profile or gradient; else the fixed value or Medwin's
 * (1975). */
ASDIC_API double asdic_environment_sound_speed_mps(const asdic_environment *env, double depth_m);

/* Absorption at FREQUENCY_HZ for a sonar at DEPTH_M (Francois & Garrison 1982), dB/km one way. */
ASDIC_API double asdic_environment_absorption_db_per_km(const asdic_environment *env,
                                                        double frequency_hz, double depth_m);

#ifdef __cplusplus
}
#endif

#endif
