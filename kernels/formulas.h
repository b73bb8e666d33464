/*
 * The formulas by number, for `asdic model` on host and device. KEY holds the values of the keys in
 * the order of the table in lib/sim/model_table.c, which says their units and sources.
 */
#ifndef ASDIC_KERNEL_FORMULAS_H
#define ASDIC_KERNEL_FORMULAS_H

#include "real.h"
#include "water.h"
#include "beam.h"
#include "backscatter.h"
#include "noise.h"
#include "target.h"
#include "detection.h"

#define MODEL_KEYS 12
#define MODEL_REST 11 /* no formula has so many: degrees that single precision lost of its angle */

#define MODEL_SOUND_SPEED 0
#define MODEL_ABSORPTION 1
#define MODEL_TRANSMISSION_LOSS 2
#define MODEL_BEAM_PATTERN 3
#define MODEL_BOTTOM_BACKSCATTER 4
#define MODEL_SURFACE_BACKSCATTER 5
#define MODEL_VOLUME_BACKSCATTER 6
#define MODEL_NOISE_TURBULENCE 7
#define MODEL_NOISE_TRAFFIC 8
#define MODEL_NOISE_SEA_STATE 9
#define MODEL_NOISE_THERMAL 10
#define MODEL_NOISE 11
#define MODEL_RANGE_RESOLUTION 12
#define MODEL_MAX_RANGE 13
#define MODEL_TARGET_STRENGTH 14
#define MODEL_FACET_STRENGTH 15
#define MODEL_PFA 16
#define MODEL_PD 17
#define MODEL_COUNT 18

#define MODEL_SHAPE_SPHERE 0
#define MODEL_SHAPE_CYLINDER 1
#define MODEL_SHAPE_PLATE 2

/* 0 gives -INFINITY. */
FORMULA real model_db(real lin) {
    return R(10.0) * log10(lin);
}

/* Sine and cosine of degrees, exact at multiples of 90. */
FORMULA real model_sin_deg(real a_deg) {
    return r_sinpi(a_deg / R(180.0));
}

FORMULA real model_cos_deg(real a_deg) {
    return r_sinpi((R(90.0) - r_abs(a_deg)) / R(180.0));
}

/* The cosine of A_DEG + REST_DEG within 0..90, to full precision close to 90: the difference is exact. */
FORMULA real model_steep_cos_deg(real a_deg, real rest_deg) {
    return r_sinpi((R(90.0) - a_deg - rest_deg) / R(180.0));
}

FORMULA real model_absorption(const real *key) {
    real right = absorption_db_per_km(key[0], key[1], key[2], key[3], key[4]);
    real printed = absorption_printed_db_per_km(key[0], key[1], key[2], key[3], key[4]);
    return choose(key[5] > R(0.5), printed, right);
}

FORMULA real model_transmission_loss(const real *key) {
    real right = transmission_loss_db(key[0], key[1]);
    real printed = transmission_loss_printed_db(key[0], key[1]);
    real two_way = transmission_loss_two_way_db(key[0], key[1]);
    return choose(key[2] > R(1.5), two_way, choose(key[2] > R(0.5), printed, right));
}

FORMULA real model_beam_pattern(const real *key) {
    real cos_psi = model_cos_deg(key[1]);
    real vx = model_cos_deg(key[0]) * cos_psi, vy = model_sin_deg(key[0]) * cos_psi;
    return model_db(
        beam_pattern_lin(vx, vy, model_sin_deg(key[1]), key[2] / key[4], key[3] / key[4], R(0.0)));
}

FORMULA real model_bottom_backscatter(const real *key) {
    return model_db(bottom_backscatter_lin(bottom_gain(key[0], key[1]), bottom_peak(key[0]), key[0],
                                           model_sin_deg(key[2])));
}

/* The cosine comes from the angle: close to 90 degrees a single-precision sine cannot tell it. */
FORMULA real model_surface_backscatter(const real *key) {
    real cosine = model_steep_cos_deg(key[2], key[MODEL_REST]);
    real cap = choose(key[3] > R(0.5), INFINITY, surface_cap_lin(key[0]));
    return model_db(surface_backscatter_angle_lin(surface_gain(key[0], key[1]),
                                                  surface_beta0(key[0]), surface_beta1(key[1]), cap,
                                                  model_sin_deg(key[2]), cosine * cosine));
}

FORMULA real model_target_strength(const real *key) {
    real wavelength_m = key[6] / (R(1000.0) * key[5]);
    real sphere = sphere_strength_lin(key[1]);
    real cylinder = cylinder_strength_lin(key[1], key[2], wavelength_m);
    real plate = plate_strength_lin(key[3] * key[4], wavelength_m);
    real disc = disc_strength_lin(key[1], wavelength_m);
    real flat = choose(key[0] > R(MODEL_SHAPE_PLATE + 0.5), disc, plate);
    real round = choose(key[0] > R(MODEL_SHAPE_SPHERE + 0.5), cylinder, sphere);
    return model_db(choose(key[0] > R(MODEL_SHAPE_CYLINDER + 0.5), flat, round));
}

FORMULA real model_facet_strength(const real *key) {
    real g = roughness_parameter(key[2] / (R(1000.0) * key[1]), key[3]);
    real sine = model_sin_deg(key[0]);
    return model_db(facet_strength_angle_lin(model_steep_cos_deg(key[0], key[MODEL_REST]),
                                             sine * sine, key[5] * key[5], g, key[4]));
}

/* MODEL words 0 exponential, 1 k, 2..4 swerling0, 1, 3; a null of finite shape is K-distributed. */
FORMULA real model_detection(const real *key, real snr, real looks, real shape) {
    int target = key[0] < R(1.5) ? TARGET_SWERLING1 : (int)key[0] - 2;
    real threshold = r_min(key[1] / key[2], R(1.0e12)); /* beyond it every chance is 0 */
    if (shape > R(1000.0)) {
        return detection_exponential(threshold, snr, looks, target);
    }
    return detection_k(threshold, snr, looks, target, shape, R(0.0));
}

FORMULA real model_value(int model, const real *key) {
    switch (model) {
    case MODEL_SOUND_SPEED:
        return sound_speed_medwin_mps(key[0], key[1], key[2]);
    case MODEL_ABSORPTION:
        return model_absorption(key);
    case MODEL_TRANSMISSION_LOSS:
        return model_transmission_loss(key);
    case MODEL_BEAM_PATTERN:
        return model_beam_pattern(key);
    case MODEL_BOTTOM_BACKSCATTER:
        return model_bottom_backscatter(key);
    case MODEL_SURFACE_BACKSCATTER:
        return model_surface_backscatter(key);
    case MODEL_VOLUME_BACKSCATTER:
        return volume_backscatter_db(key[0], key[1]);
    case MODEL_NOISE_TURBULENCE:
        return noise_turbulence_db(key[0]);
    case MODEL_NOISE_TRAFFIC:
        return noise_traffic_db(key[0], key[1]);
    case MODEL_NOISE_SEA_STATE:
        return noise_sea_state_db(key[0], key[1]);
    case MODEL_NOISE_THERMAL:
        return noise_thermal_db(key[0]);
    case MODEL_NOISE:
        return noise_band_db(noise_db(key[0], key[1], key[2]), key[3]);
    case MODEL_RANGE_RESOLUTION:
        return range_resolution_m(key[0], key[1]);
    case MODEL_MAX_RANGE:
        return max_range_m(key[0], key[1]);
    case MODEL_TARGET_STRENGTH:
        return model_target_strength(key);
    case MODEL_FACET_STRENGTH:
        return model_facet_strength(key);
    case MODEL_PFA:
        return model_detection(key, R(0.0), key[3], key[4]);
    default:
        return model_detection(key, key[3], key[4], key[5]);
    }
}

#endif
