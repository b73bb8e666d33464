/*
 * The sea surface of the course, kernels/backscatter.h, a formula of the device. As a mirror it is the
 * rough face of a wind sea that reflects all (kernels/mirror.h).
 */
#include "keys.h"

#include "../../kernels/backscatter.h"
#include "../../kernels/mirror.h"

enum { WIND, FREQUENCY, GRAZING, CAP }; /* keys of the model */
enum { GAIN, BETA0, BETA1, CAP_LIN, ROUGHNESS_G };

static void prepare(asdic_scatterer *s) {
    double wind_kn = s->water.wind_speed_kn, f_khz = s->water.frequency_hz / 1e3;
    s->made[GAIN] = surface_gain(wind_kn, f_khz);
    s->made[BETA0] = surface_beta0(wind_kn);
    s->made[BETA1] = surface_beta1(f_khz);
    s->made[CAP_LIN] = s->value[CAP] > 0.5 ? INFINITY : surface_cap_lin(wind_kn);
    s->made[ROUGHNESS_G] = roughness_parameter(s->water.wavelength_m, sea_height_rms_m(wind_kn));
    for (int i = 0; i < 4; i++) {
        s->device.formula[i] = (float)s->made[i];
    }
    s->device.reflection2 = 1.0f;
    s->device.roughness_g = (float)s->made[ROUGHNESS_G];
}

static double strength_lin(const asdic_scatterer *s, const asdic_incidence *at) {
    return surface_backscatter_angle_lin(s->made[GAIN], s->made[BETA0], s->made[BETA1],
                                         s->made[CAP_LIN], at->sine, at->cos2);
}

static double reflected(const asdic_scatterer *s, double sine) {
    return mirror_share(sine, 1.0, s->made[ROUGHNESS_G]);
}

const asdic_law asdic_law_course_surface = {
    .name = "course",
    .surface_word = "course",
    .uses = ASDIC_LAW_SURFACE,
    .formula = DEV_LAW_COURSE,
    .model =
        {"surface-backscatter",
         "dB",
         "surface backscattering strength re 1 m^2/m^2, capped at the return of a rough mirror "
         "(Cox & Munk 1954)",
         "lecture course of D. Kraus (Hochschule Bremen), printed in Morency et al.",
         4,
         {[WIND] = LAW_SITUATION("wind_kn", 0.0, 60.0, 0.0, 40.0),
          [FREQUENCY] = LAW_F_KHZ(1.0, 400.0),
          [GRAZING] = LAW_GRAZING,
          [CAP] = {.name = "cap", .words = "on|off", .max = 1.0, .valid_max = 1.0}}},
    .prepare = prepare,
    .strength_lin = strength_lin,
    .reflected = reflected,
};
