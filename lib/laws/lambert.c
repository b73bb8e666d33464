/*
 * Lambert's law: a surface that scatters the same intensity into every direction for each unit of
 * power that it receives,
 *
 *     S = 10 log10 mu + 20 log10 sin Theta,   dB re 1 m^2/m^2
 *
 * Theta grazing angle (J. H. Lambert, Photometria, 1760; R. J. Urick, Principles of Underwater Sound,
 * 3rd ed. 1983, chapter 8). -27 dB is what K. V. Mackenzie found in deep water, J. Acoust. Soc. Am.
 * 33, 1498 (1961), at 0.5 and 1 kHz; a surface that loses nothing has mu = 1/pi, -5 dB. It holds for rough bottoms
 * below 45 degrees, and knows no frequency and no mirror.
 */
#include "keys.h"

enum { LAMBERT_DB };

static double strength_lin(const asdic_scatterer *s, const asdic_incidence *at) {
    return pow(10.0, 0.1 * s->value[LAMBERT_DB]) * at->sine * at->sine;
}

const asdic_law asdic_law_lambert = {
    .name = "lambert",
    .uses = ASDIC_LAW_BOTTOM | ASDIC_LAW_OBJECT,
    .model = {"lambert",
              "dB",
              "Lambert's law of backscattering re 1 m^2/m^2",
              "Lambert, Photometria (1760); Urick, Principles of Underwater Sound (1983)",
              2,
              {[LAMBERT_DB] = {.name = "lambert_db",
                               .numeric = true,
                               .fallback = -27.0,
                               .min = -100.0,
                               .max = 0.0,
                               .valid_min = -100.0,
                               .valid_max = -4.9714987,
                               .chooses = true,
                               .unit = "dB",
                               .doc = "scatters by Lambert's law with this 10 log10 mu: deep-sea "
                                      "bottom -27, all that arrives -5"},
               LAW_GRAZING}},
    .strength_lin = strength_lin,
};
