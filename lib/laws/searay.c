/*
 * The bottom of the SEARAY model, kernels/backscatter.h, a formula of the device. As a mirror it is a
 * smooth fluid with the roughness of its kind (kernels/mirror.h).
 */
#include "keys.h"

#include "../../kernels/backscatter.h"
#include "../../kernels/mirror.h"

enum { TYPE };
enum { GAIN, PEAK, DENSITY_RATIO, INDEX, ROUGHNESS_G };

/* Density and sound speed of mud (clay), sand, gravel and rock (limestone) over those of water: F. B.
 * Jensen, W. A. Kuperman, M. B. Porter, H. Schmidt, "Computational Ocean Acoustics", table 1.3. */
static const double density_ratio[4] = {1.5, 1.9, 2.0, 2.4};
static const double speed_ratio[4] = {1.0, 1.1, 1.2, 2.0};
/* R.m.s. height over a metre of the relief spectra of APL-UW TR 9407 (1994) for mud, medium sand,
 * gravel and rough rock. */
static const double height_rms_m[4] = {0.003, 0.008, 0.016, 0.05};

/* TABLE at a bottom type from 1 to 4, fractions in between. */
static double at_type(const double table[4], double type) {
    int low = type < 1.0 ? 1 : type < 4.0 ? (int)type : 3;
    return table[low - 1] + (table[low < 3 ? low : 3] - table[low - 1]) * (type - low);
}

static void prepare(asdic_scatterer *s) {
    double type = s->value[TYPE];
    s->made[GAIN] = bottom_gain(type, 1e-3 * s->water.frequency_hz);
    s->made[PEAK] = bottom_peak(type);
    s->made[DENSITY_RATIO] = at_type(density_ratio, type);
    s->made[INDEX] = 1.0 / at_type(speed_ratio, type);
    s->made[ROUGHNESS_G] = roughness_parameter(s->water.wavelength_m, at_type(height_rms_m, type));
    s->device.formula[0] = (float)type;
    s->device.formula[1] = (float)s->made[GAIN];
    s->device.formula[2] = (float)s->made[PEAK];
    s->device.density_ratio = (float)s->made[DENSITY_RATIO];
    s->device.index = (float)s->made[INDEX];
    s->device.roughness_g = (float)s->made[ROUGHNESS_G];
}

static double strength_lin(const asdic_scatterer *s, const asdic_incidence *at) {
    return bottom_backscatter_lin(s->made[GAIN], s->made[PEAK], s->value[TYPE], at->sine);
}

/* It rises with the angle. */
static double most_lin(const asdic_scatterer *s, double range_m) {
    (void)range_m;
    return bottom_backscatter_lin(s->made[GAIN], s->made[PEAK], s->value[TYPE], 1.0);
}

static double reflected(const asdic_scatterer *s, double sine) {
    double smooth = fluid_reflection2(sine, s->made[DENSITY_RATIO], s->made[INDEX]);
    return mirror_share(sine, smooth, s->made[ROUGHNESS_G]);
}

const asdic_law asdic_law_searay = {
    .name = "searay",
    .uses = ASDIC_LAW_BOTTOM | ASDIC_LAW_OBJECT | ASDIC_LAW_BRIEF,
    .formula = DEV_LAW_SEARAY,
    .model = {"bottom-backscatter",
              "dB",
              "bottom backscattering strength re 1 m^2/m^2",
              "SEARAY model, lecture course of D. Kraus (Hochschule Bremen), printed in Morency et "
              "al.",
              3,
              {[TYPE] = {.name = "type",
                         .words = "mud|sand|gravel|rock",
                         .numeric = true,
                         .required = true,
                         .chooses = true,
                         .fallback = 2.0,
                         .min = 1.0,
                         .max = 4.0,
                         .valid_min = 1.0,
                         .valid_max = 4.0,
                         .doc = "scatters as this bottom: mud 1, sand 2, gravel 3, rock 4"},
               LAW_F_KHZ(50.0, 400.0),
               LAW_GRAZING}},
    .prepare = prepare,
    .strength_lin = strength_lin,
    .most_lin = most_lin,
    .reflected = reflected,
};
