#include "model_table.h"

#include "laws/keys.h"

#include "../../kernels/formulas.h"

#include <string.h>

/* A number with a fallback: name, domain. */
#define OPTIONAL(key, value, lo, hi)                                                               \
    {                                                                                              \
        .name = key, .numeric = true, .fallback = value, .min = lo, .max = hi, .valid_min = lo,    \
        .valid_max = hi                                                                            \
    }
/* One of WORDS, COUNT of them, the first standing for 0. */
#define CHOICE(key, list, count, must)                                                             \
    { .name = key, .words = list, .required = must, .max = count - 1, .valid_max = count - 1 }

#define WIND_KN OPTIONAL("wind_kn", 10.0, 0.0, 60.0)
#define SHIPPING OPTIONAL("shipping", 0.5, 0.0, 1.0)
#define COATES "Coates, Underwater Acoustic Systems (1990), after Wenz (1962) and Mellen (1952)"
#define KRAUS "lecture course of D. Kraus (Hochschule Bremen), printed in Morency et al."
#define DETECTION_MODEL CHOICE("model", "exponential|k|swerling0|swerling1|swerling3", 5, true)
#define THRESHOLD LAW_SITUATION("threshold", 0.0, 1e12, 0.0, 1e12)
#define MU0 LAW_SITUATION("mu0", 1e-30, 1e12, 1e-30, 1e12)
#define LOOKS OPTIONAL("looks", 1.0, 1.0, 1000.0)
#define SHAPE OPTIONAL("shape", NAN, 0.05, 1000.0)

static const asdic_model_info formulas[] = {
    [MODEL_SOUND_SPEED] = {"sound-speed",
                           "m/s",
                           "speed of sound in sea water",
                           "Medwin, J. Acoust. Soc. Am. 58, 1318 (1975)",
                           3,
                           {LAW_SITUATION("t_degc", -2.0, 40.0, 0.0, 35.0),
                            LAW_SITUATION("s_ppt", 0.0, 45.0, 0.0, 45.0),
                            LAW_SITUATION("z_m", 0.0, 11000.0, 0.0, 1000.0)}},
    [MODEL_ABSORPTION] = {"absorption",
                          "dB/km",
                          "absorption of sea water, one way",
                          "Francois & Garrison, J. Acoust. Soc. Am. 72, 1879 (1982)",
                          6,
                          {LAW_F_KHZ(0.2, 1000.0), LAW_SITUATION("t_degc", -2.0, 40.0, -2.0, 22.0),
                           LAW_SITUATION("s_ppt", 0.0, 45.0, 30.0, 35.0),
                           LAW_SITUATION("z_m", 0.0, 11000.0, 0.0, 3500.0),
                           LAW_SITUATION("ph", 7.0, 8.5, 7.7, 8.3),
                           CHOICE("variant", "corrected|printed", 2, false)}},
    [MODEL_TRANSMISSION_LOSS] = {"transmission-loss",
                                 "dB",
                                 "two-way spreading and absorption re 1 m",
                                 "Urick, Principles of Underwater Sound (1983); printed: Morency "
                                 "et al., eq. (2)",
                                 3,
                                 {LAW_SITUATION("d_m", 1e-3, 1e6, 1e-3, 1e6),
                                  LAW_SITUATION("alpha_db_per_km", 0.0, 1e4, 0.0, 1e4),
                                  CHOICE("variant", "corrected|printed|two-way", 3, false)}},
    [MODEL_BEAM_PATTERN] = {"beam-pattern",
                            "dB",
                            "one-way pattern of a rectangular aperture re on-axis; -inf behind",
                            "Marage & Mori, Sonar and Underwater Acoustics (2010)",
                            5,
                            {LAW_SITUATION("theta_deg", -180.0, 180.0, -180.0, 180.0),
                             LAW_SITUATION("psi_deg", -90.0, 90.0, -90.0, 90.0),
                             LAW_SITUATION("length_h_m", 1e-6, 100.0, 1e-6, 100.0),
                             LAW_SITUATION("length_v_m", 1e-6, 100.0, 1e-6, 100.0),
                             LAW_SITUATION("wavelength_m", 1e-4, 100.0, 1e-4, 100.0)}},
    [MODEL_BOTTOM_BACKSCATTER] = {.name = "bottom-backscatter"},   /* the rest in lib/laws */
    [MODEL_SURFACE_BACKSCATTER] = {.name = "surface-backscatter"}, /* the rest in lib/laws */
    [MODEL_VOLUME_BACKSCATTER] = {"volume-backscatter",
                                  "dB",
                                  "volume backscattering strength re 1/m; sp_db low -90, moderate "
                                  "-70, high -50",
                                  KRAUS,
                                  2,
                                  {LAW_SITUATION("sp_db", -200.0, 0.0, -200.0, 0.0),
                                   LAW_F_KHZ(0.1, 1000.0)}},
    [MODEL_NOISE_TURBULENCE] = {"noise-turbulence",
                                "dB",
                                "turbulence noise re 1 uPa^2/Hz",
                                COATES,
                                1,
                                {LAW_F_KHZ(0.1, 1000.0)}},
    [MODEL_NOISE_TRAFFIC] = {"noise-traffic",
                             "dB",
                             "shipping noise re 1 uPa^2/Hz",
                             COATES,
                             2,
                             {LAW_F_KHZ(0.1, 1000.0), SHIPPING}},
    [MODEL_NOISE_SEA_STATE] = {"noise-sea-state",
                               "dB",
                               "wind noise re 1 uPa^2/Hz",
                               COATES,
                               2,
                               {LAW_F_KHZ(0.1, 1000.0), WIND_KN}},
    [MODEL_NOISE_THERMAL] = {"noise-thermal",
                             "dB",
                             "thermal noise re 1 uPa^2/Hz",
                             COATES,
                             1,
                             {LAW_F_KHZ(0.1, ASDIC_MOST_KHZ)}},
    [MODEL_NOISE] = {"noise",
                     "dB",
                     "ambient noise in a band re 1 uPa^2 (per hertz without bandwidth_hz)",
                     COATES,
                     4,
                     {LAW_F_KHZ(0.1, ASDIC_MOST_KHZ), SHIPPING, WIND_KN,
                      OPTIONAL("bandwidth_hz", 1.0, 1e-3, 1e6)}},
    [MODEL_RANGE_RESOLUTION] = {"range-resolution",
                                "m",
                                "length of a resolution cell, c / (2 B)",
                                "Medwin & Clay, Fundamentals of Acoustical Oceanography (1998)",
                                2,
                                {LAW_C_MPS, LAW_SITUATION("bandwidth_hz", 1.0, 1e6, 1.0, 1e6)}},
    [MODEL_MAX_RANGE] = {"max-range",
                         "m",
                         "range of the last echo before the next ping, c / (2 f_p)",
                         "definition",
                         2,
                         {LAW_C_MPS, LAW_SITUATION("ping_rate_hz", 1e-2, 1e3, 1e-2, 1e3)}},
    [MODEL_TARGET_STRENGTH] =
        {"target-strength",
         "dB",
         "rigid smooth body in the far field re 1 m^2: cylinder broadside, "
         "plate and disc at normal incidence; ka > 10",
         "Urick, Principles of Underwater Sound (1983), table 9.1",
         7,
         {CHOICE("shape", "sphere|cylinder|plate|disc", 4, true),
          OPTIONAL("radius_m", NAN, 1e-4, 1e4), OPTIONAL("length_m", NAN, 1e-4, 1e4),
          OPTIONAL("width_m", NAN, 1e-4, 1e4), OPTIONAL("height_m", NAN, 1e-4, 1e4),
          OPTIONAL("f_khz", NAN, 0.1, ASDIC_MOST_KHZ), OPTIONAL("c_mps", 1500.0, 1300.0, 1700.0)}},
    [MODEL_FACET_STRENGTH] =
        {"facet-strength",
         "dB",
         "scattering strength of a rough facet re 1 m^2/m^2; reflection is "
         "the amplitude coefficient, slope_ms the mean-square slope",
         "Kirchhoff lobe for the coherent share exp(-4 k^2 s^2 cos^2), Lambert "
         "for the rest",
         6,
         {LAW_SITUATION("incidence_deg", 0.0, 90.0, 0.0, 90.0), LAW_F_KHZ(0.1, ASDIC_MOST_KHZ),
          LAW_C_MPS, LAW_SITUATION("roughness_rms_m", 0.0, 1.0, 0.0, 1.0),
          LAW_SITUATION("slope_ms", 1e-9, 1.0, 1e-9, 0.1),
          LAW_SITUATION("reflection", -1.0, 1.0, -1.0, 1.0)}},
    [MODEL_PFA] = {"pfa",
                   "1",
                   "chance that the mean intensity of the looks exceeds the threshold without a "
                   "target; a shape makes the null K-distributed",
                   "exponential (Rayleigh envelope); K: Abraham & Lyons, IEEE J. Oceanic Eng. 27, "
                   "800 (2002)",
                   5,
                   {DETECTION_MODEL, THRESHOLD, MU0, LOOKS, SHAPE}},
    [MODEL_PD] = {"pd",
                  "1",
                  "the same with a target of snr * mu0: exponential and k mean Swerling I",
                  "Swerling, IRE Trans. IT-6, 269 (1960); steady: Marcum's Q",
                  6,
                  {DETECTION_MODEL, THRESHOLD, MU0, LAW_SITUATION("snr", 0.0, 1e6, 0.0, 1e6), LOOKS,
                   SHAPE}},
};

const asdic_law *asdic_model_law(size_t index, bool *mirror) {
    *mirror = false;
    const char *name = index < MODEL_COUNT ? formulas[index].name : NULL;
    for (size_t l = 0, next = MODEL_COUNT; l < asdic_law_count(); l++) {
        const asdic_law *law = asdic_law_get(l);
        bool has_formula = false;
        for (size_t i = 0; i < MODEL_COUNT; i++) {
            has_formula |= strcmp(formulas[i].name, law->model.name) == 0;
        }
        if (name ? strcmp(name, law->model.name) == 0 : !has_formula && next++ == index) {
            return law;
        }
        if (!name && law->mirror_model && next++ == index) {
            *mirror = true;
            return law;
        }
    }
    return NULL;
}

size_t asdic_model_count(void) {
    size_t count = MODEL_COUNT;
    bool mirror;
    while (asdic_model_law(count, &mirror)) {
        count++;
    }
    return count;
}

const asdic_model_info *asdic_model_get(size_t index) {
    bool mirror;
    const asdic_law *law = asdic_model_law(index, &mirror);
    return law                   ? mirror ? law->mirror_model : &law->model
           : index < MODEL_COUNT ? &formulas[index]
                                 : NULL;
}
