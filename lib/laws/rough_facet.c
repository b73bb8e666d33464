/*
 * The rough facet of kernels/target.h, a formula of the device: solid bodies by their impedance and
 * the roughness of their skin. It alone asks how much of a body's surface reflects in phase.
 */
#include "keys.h"
#include "material_presets.h"

#include "base/context.h"

#include "../../kernels/target.h"

#include <string.h>

enum { PRESET, IMPEDANCE, ROUGHNESS, SLOPE, AREA };
enum { REFLECTION2, ROUGHNESS_G, SLOPE_MS };

#define WATER_DENSITY_KGPM3 1025.0

#define ROW(word, value) {#word, value},
static const struct {
    const char *name;
    double impedance_mrayl;
} presets[] = {ASDIC_MATERIAL_PRESETS(ROW)};
#undef ROW
#define PRESET_COUNT (sizeof presets / sizeof *presets)

#define WORD(word, value) "|" #word
static const char preset_words[] = ASDIC_MATERIAL_PRESETS(WORD);
#undef WORD

asdic_status asdic_material_find_impedance(asdic_context *ctx, const char *name,
                                           double *impedance_mrayl) {
    if (!impedance_mrayl) {
        return asdic_fail_null(ctx, __func__);
    }
    for (size_t i = 0; name && i < PRESET_COUNT; i++) {
        if (strcmp(presets[i].name, name) == 0) {
            *impedance_mrayl = presets[i].impedance_mrayl;
            return ASDIC_OK;
        }
    }
#define WORD(word, value) " " #word
    return asdic_fail(ctx, ASDIC_ERROR_ARGUMENT, "no material '%s'; known are%s",
                      name ? name : "(none)", ASDIC_MATERIAL_PRESETS(WORD) "");
#undef WORD
}

static void prepare(asdic_scatterer *s) {
    double water_mrayl = 1e-6 * WATER_DENSITY_KGPM3 * s->water.sound_speed_mps;
    double preset = s->value[PRESET], slope = s->value[SLOPE], area_m2 = s->value[AREA];
    double impedance_mrayl =
        isnan(preset) ? s->value[IMPEDANCE] : presets[(size_t)preset - 1].impedance_mrayl;
    s->made[REFLECTION2] = impedance_reflection2(impedance_mrayl, water_mrayl);
    s->made[ROUGHNESS_G] = roughness_parameter(s->water.wavelength_m, 1e-3 * s->value[ROUGHNESS]);
    s->made[SLOPE_MS] = slope * slope;
    s->device.formula[0] = (float)s->made[SLOPE_MS];
    s->device.formula[1] = isnan(area_m2) ? 0.0f : (float)area_m2;
    s->device.reflection2 = (float)s->made[REFLECTION2];
    s->device.roughness_g = (float)s->made[ROUGHNESS_G];
}

static double strength_lin(const asdic_scatterer *s, const asdic_incidence *at) {
    double area_m2 = isnan(s->value[AREA]) ? at->coherent_m2 : s->value[AREA];
    double slope_ms =
        facet_slope_ms(s->made[SLOPE_MS], area_m2, s->water.wavelength_m, at->range_m);
    return facet_strength_angle_lin(at->sine, at->cos2, s->made[REFLECTION2], s->made[ROUGHNESS_G],
                                    slope_ms);
}

/* The lobe is highest at normal incidence while its slope is at most 1/2, which it is; the narrowest
 * lobe belongs to the largest area in phase, lambda d (see facet_slope_ms). */
static double most_lin(const asdic_scatterer *s, double range_m) {
    double diffraction = s->water.wavelength_m / (4.0 * R_PI * range_m);
    double narrowest = fmin(s->made[SLOPE_MS] + diffraction, FACET_MOST_SLOPE_MS);
    return s->made[REFLECTION2] * (1.0 / (4.0 * R_PI * narrowest) + 1.0 / R_PI);
}

static double reflected(const asdic_scatterer *s, double sine) {
    return mirror_share(sine, s->made[REFLECTION2], s->made[ROUGHNESS_G]);
}

const asdic_law asdic_law_rough_facet = {
    .name = "rough-facet",
    .uses = ASDIC_LAW_OBJECT,
    .formula = DEV_LAW_FACET,
    .model = {"rough-facet",
              "dB",
              "scattering strength of a rough solid facet re 1 m^2/m^2, by the scene file's keys",
              "Kirchhoff lobe for the coherent share exp(-4 k^2 s^2 cos^2), Lambert for the rest",
              8,
              {[PRESET] = {.name = "preset",
                           .words = preset_words + 1,
                           .fallback = NAN,
                           .min = 1.0,
                           .max = PRESET_COUNT,
                           .valid_min = 1.0,
                           .valid_max = PRESET_COUNT,
                           .chooses = true,
                           .doc = "acoustic impedance by name, of a body many wavelengths thick"},
               [IMPEDANCE] = {.name = "impedance_mrayl",
                              .numeric = true,
                              .fallback = 45.0,
                              .max = 200.0,
                              .valid_max = 200.0,
                              .chooses = true,
                              .unit = "MRayl",
                              .doc = "acoustic impedance: steel 45, water 1.54, air 0"},
               [ROUGHNESS] = {.name = "roughness_rms_mm",
                              .numeric = true,
                              .fallback = 1.0,
                              .max = 1000.0,
                              .valid_max = 1000.0,
                              .unit = "mm",
                              .doc = "r.m.s. height of the roughness"},
               [SLOPE] = {.name = "slope_rms",
                          .numeric = true,
                          .fallback = 0.1,
                          .max = 2.0,
                          .valid_max = 0.31622777, /* as far as a facet's strength: 0.1 squared */
                          .doc = "r.m.s. slope of the roughness; beyond 0.7071 as there"},
               [AREA] = {.name = "coherent_area_m2",
                         .numeric = true,
                         .fallback = NAN,
                         .min = 1e-8,
                         .max = 1e8,
                         .valid_min = 1e-8,
                         .valid_max = 1e8,
                         .unit = "m2",
                         .doc = "flat area that reflects in phase; else of each flat patch of the "
                                "mesh its own"},
               LAW_F_KHZ(0.1, ASDIC_MOST_KHZ),
               LAW_C_MPS,
               LAW_GRAZING}},
    .prepare = prepare,
    .strength_lin = strength_lin,
    .most_lin = most_lin,
    .reflected = reflected,
};
