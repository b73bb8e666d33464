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
} asdic_environment;

/* 10 degC, 35 ppt, pH 8, 10 kn, shipping 0.5, low particle density, derived speed and depth. */
ASDIC_API asdic_environment asdic_environment_default(void);

/* Checks every field against its range; the error names field, value and limit. */
ASDIC_API asdic_status asdic_environment_check(asdic_context *ctx, const asdic_environment *env);

/* Sound speed at DEPTH_M (Medwin 1975, or the fixed value), m/s. */
ASDIC_API double asdic_environment_sound_speed_mps(const asdic_environment *env, double depth_m);

/* Absorption at FREQUENCY_HZ for a sonar at DEPTH_M (Francois & Garrison 1982), dB/km one way. */
ASDIC_API double asdic_environment_absorption_db_per_km(const asdic_environment *env,
                                                        double frequency_hz, double depth_m);

#ifdef __cplusplus
}
#endif

#endif
