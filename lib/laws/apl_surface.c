/*
 * The sea surface of APL-UW TR 9407, "APL-UW High-Frequency Ocean Environmental Acoustic Models
 * Handbook" (Applied Physics Laboratory, University of Washington, 1994), part II: bubbles, facets and
 * small-scale roughness. The handbook states 10..100 kHz. The equations were transcribed from published
 * ones, not from the report itself. Bubbles depend on the wind's history, too, which the wind speed U
 * alone, m/s at 10 m, does not tell.
 *
 *     bubbles      bv = 10^(-5.2577 + .4701 U) (f / 25)^.85 up to U = 11, above by (U / 11)^3.5 more
 *                  d = .0255 f^(1/3), b = bv / sin theta, f in kHz
 *                  s_b = bv / (4 pi) (.0136 / d) (1 + 8 b e^-2b - e^-4b) / (2 b)
 *     small scale  s_sc = 1.3e-5 U^2 tan^4 theta, up to 85 degrees
 *     facets       s^2 = 4.6e-3 ln(2.1 U^2), .0034 below 1 m/s; g = 90 degrees - theta
 *                  s_f = exp(-tan^2 g / s^2) / (4 pi s^2 cos^4 g)
 *     joined       f = 1 / (1 + exp(.524 (thf - theta))), degrees; thf: s_f 15 dB below its value at 90
 *     loss         1.26e-3 / sin theta f^.85 U^1.57 dB there and back; below 6 m/s 6^1.57 e^(1.2 (U - 6))
 *                  stands for U^1.57
 *     strength     (f s_f + (1 - f) s_sc) 10^(-loss / 10) + s_b
 *
 * As a mirror it is the rough face of a wind sea (kernels/mirror.h) under the bubbles' loss.
 */
#include "keys.h"

#include "base/vec.h"

#include "../../kernels/mirror.h"

enum { BUBBLES, BUBBLE_GAIN, LOSS_DB, SMALL_SCALE, FACET_SLOPE2, FACET_DEG, ROUGHNESS_G };

#define DEG (180.0 / ASDIC_PI)
#define MPS_PER_KN (1852.0 / 3600.0)
/* The strength at 0 is that at 1e-6 rad, where the device's tables begin. */
#define LEAST_RAD 1e-6

/* Where exp(-T / s^2) (1 + T)^2, T = tan^2 g, has fallen by 15 dB. */
static double facet_deg(double slope2) {
    double t = 0.0;
    for (int i = 0; i < 60; i++) { /* a contraction by 2 s^2 < 0.1 */
        t = slope2 * (1.5 * log(10.0) + 2.0 * log1p(t));
    }
    return 90.0 - atan(sqrt(t)) * DEG;
}

static void prepare(asdic_scatterer *s) {
    double wind = s->water.wind_speed_kn * MPS_PER_KN, f_khz = 1e-3 * s->water.frequency_hz;
    double grown = wind < 11.0 ? 1.0 : pow(wind / 11.0, 3.5);
    double power = wind < 6.0 ? pow(6.0, 1.57) * exp(1.2 * (wind - 6.0)) : pow(wind, 1.57);
    double *made = s->made;
    made[BUBBLES] =
        pow(10.0, -5.2577 + 0.4701 * fmin(wind, 11.0)) * grown * pow(f_khz / 25.0, 0.85);
    made[BUBBLE_GAIN] = made[BUBBLES] / (4.0 * ASDIC_PI) * 0.0136 / (0.0255 * cbrt(f_khz));
    made[LOSS_DB] = 1.26e-3 * pow(f_khz, 0.85) * power;
    made[SMALL_SCALE] = 1.3e-5 * wind * wind;
    made[FACET_SLOPE2] = wind < 1.0 ? 0.0034 : 4.6e-3 * log(2.1 * wind * wind);
    made[FACET_DEG] = facet_deg(made[FACET_SLOPE2]);
    made[ROUGHNESS_G] =
        roughness_parameter(s->water.wavelength_m, sea_height_rms_m(s->water.wind_speed_kn));
}

/* Of what the bubbles let through there and back. */
static double through_bubbles(const asdic_scatterer *s, double sine) {
    return pow(10.0, -0.1 * s->made[LOSS_DB] / fmax(sine, LEAST_RAD));
}

static double of_bubbles(const asdic_scatterer *s, double sine) {
    double b = s->made[BUBBLES] / sine;
    return s->made[BUBBLE_GAIN] * (8.0 * b * exp(-2.0 * b) - expm1(-4.0 * b)) / (2.0 * b);
}

static double strength_lin(const asdic_scatterer *s, const asdic_incidence *at) {
    const double *m = s->made;
    double sine = fmax(at->sine, LEAST_RAD),
           theta = fmax(atan2(at->sine, sqrt(at->cos2)), LEAST_RAD);
    double t = tan(fmin(theta, 85.0 / DEG)), cotangent2 = at->cos2 / (sine * sine);
    double small_scale = m[SMALL_SCALE] * t * t * t * t;
    double facets = exp(-cotangent2 / m[FACET_SLOPE2]) /
                    (4.0 * ASDIC_PI * m[FACET_SLOPE2] * sine * sine * sine * sine);
    double share = 1.0 / (1.0 + exp(0.524 * (m[FACET_DEG] - theta * DEG)));
    double face = share * facets + (1.0 - share) * small_scale;
    return face * through_bubbles(s, sine) + of_bubbles(s, sine);
}

static double reflected(const asdic_scatterer *s, double sine) {
    return mirror_share(sine, 1.0, s->made[ROUGHNESS_G]) * through_bubbles(s, sine);
}

/* The handbook's, for winds above and below 8 m/s. */
static double uncertainty_db(const asdic_scatterer *s) {
    return s->water.wind_speed_kn * MPS_PER_KN > 8.0 ? 4.0 : 5.0;
}

const asdic_law asdic_law_apl_surface = {
    .name = "apl-surface",
    .surface_word = "apl",
    .uses = ASDIC_LAW_SURFACE,
    .model = {"apl-surface",
              "dB",
              "backscattering strength of the sea surface with bubbles re 1 m^2/m^2",
              "APL-UW TR 9407, High-Frequency Ocean Environmental Acoustic Models Handbook (1994), "
              "part II",
              3,
              {LAW_SITUATION("wind_mps", 0.0, 31.0, 0.0, 31.0), LAW_F_KHZ(10.0, 100.0),
               LAW_GRAZING}},
    .prepare = prepare,
    .strength_lin = strength_lin,
    .reflected = reflected,
    .uncertainty_db = uncertainty_db,
};
