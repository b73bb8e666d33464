/*
 * The bottom of APL-UW TR 9407, "APL-UW High-Frequency Ocean Environmental Acoustic Models Handbook"
 * (Applied Physics Laboratory, University of Washington, 1994), part IV: a fluid sediment with a rough
 * face and a scattering volume, by the name of the sediment, its mean grain size or its single
 * geoacoustic numbers. The handbook states 10..100 kHz. The equations were transcribed from published
 * ones, not from the report itself, and meet its table 3 within 0.3 dB (rough rock and rock 0.6).
 *
 *     rho  density of the sediment over that of water      nu  sound speed over that of water
 *     delta  loss: imaginary over real wave number         sigma2  volume: cross-section over loss
 *     W2(K) = w2 K^-gamma  spectrum of the relief, K in 1/cm, w2 in cm^4
 *     theta  grazing angle; k  wave number in water, 1/cm; al = gamma / 2 - 1
 *
 * Near normal incidence the roughness scatters by Kirchhoff's approximation, elsewhere by composite
 * roughness, and where the large-scale slope exceeds 7 degrees by an empirical law. A volume part adds.
 *
 * The numbers of a grain size step by a little at Mz = 1 and 5.3 phi, where the handbook's fits meet,
 * and sigma2 by a factor of 2 at 5.5 phi: 3 dB of the volume part. The steps are the handbook's.
 */
#include "keys.h"

#include "base/vec.h"

#include "../../kernels/mirror.h"

#include <complex.h>

enum { SEDIMENT, PHI, DENSITY, SPEED, LOSS, STRENGTH, EXPONENT, VOLUME };
enum {
    RHO,
    NU,
    SIGMA2,
    KAPPA2_RE, /* ((1 + i delta) / nu)^2 */
    KAPPA2_IM,
    K_CM,
    W2,
    GAMMA,
    SLOPE, /* r.m.s., of the large scale */
    NORMAL_R2,
    QC,
    KR_A,
    KR_B,
    KR_COSINE, /* of the angle where Kirchhoff and composite roughness are joined */
    LR_GAIN,
    LR_EXPONENT,
    LR_CRITICAL_DEG,
    LR_WEIGHT,
    ROUGHNESS_G
};

#define DEG (180.0 / ASDIC_PI)
/* The strength at 0 is that at 1e-6 rad, where the device's tables begin. */
#define LEAST_RAD 1e-6

/* What a sediment is: table 2 of the handbook. */
typedef struct sediment {
    double density_ratio, speed_ratio, loss_ratio, volume_ratio, exponent, strength_cm4;
} sediment;

static const sediment stones[] = {
    {2.5, 2.5, 0.01374, 0.002, 3.25, 0.20693}, /* rough rock */
    {2.5, 2.5, 0.01374, 0.002, 3.25, 0.01862}, /* rock */
    {2.5, 1.8, 0.01374, 0.002, 3.25, 0.01560}, /* cobble, gravel, pebble */
};
#define STONES (sizeof stones / sizeof *stones)

/* Mean grain size of the sediments that follow the stones in the list of names, phi. */
static const double grain_phi[] = {-1.0, -0.5, 0.5, 1.5, 2.5, 3.5, 4.0, 4.5,
                                   5.0,  5.5,  6.0, 6.5, 7.0, 7.5, 8.0, 9.0};
#define NAMES                                                                                      \
    "rough_rock|rock|cobble|sandy_gravel|very_coarse_sand|coarse_sand|medium_sand|fine_sand|"      \
    "very_fine_sand|clayey_sand|coarse_silt|sandy_silt|medium_silt|sandy_mud|fine_silt|"           \
    "sandy_clay|very_fine_silt|silty_clay|clay"
#define NAME_COUNT (STONES + sizeof grain_phi / sizeof *grain_phi)

/* --- what a grain size says --------------------------------------------------------------------- */

static double density_of(double m) {
    return m < 1.0   ? 0.007797 * m * m - 0.17057 * m + 2.3139
           : m < 5.3 ? -0.0165406 * m * m * m + 0.2290201 * m * m - 1.1069031 * m + 3.0455
                     : -0.0012973 * m + 1.1565;
}

static double speed_of(double m) {
    return m < 1.0   ? 0.002709 * m * m - 0.056452 * m + 1.2778
           : m < 5.3 ? -0.0014881 * m * m * m + 0.0213937 * m * m - 0.1382798 * m + 1.3425
                     : -0.0024324 * m + 1.0019;
}

/* Absorption over frequency, dB/m/kHz. */
static double absorption_of(double m) {
    return m < 0.0   ? 0.4556
           : m < 2.6 ? 0.4556 + 0.0245 * m
           : m < 4.5 ? 0.1978 + 0.1245 * m
           : m < 6.0 ? 8.0399 - 2.5228 * m + 0.20098 * m * m
           : m < 9.5 ? 0.9431 - 0.2041 * m + 0.0117 * m * m
                     : 0.0601;
}

static sediment sediment_of(double m) {
    double height_cm = m < 5.0 ? (2.03846 - 0.26923 * m) / (1.0 + 0.076923 * m) : 0.5;
    return (sediment){.density_ratio = density_of(m),
                      .speed_ratio = speed_of(m),
                      .loss_ratio =
                          absorption_of(m) * speed_of(m) * 1.528 * log(10.0) / (40.0 * ASDIC_PI),
                      .volume_ratio = m < 5.5 ? 0.002 : 0.001,
                      .exponent = 3.25,
                      .strength_cm4 = 0.00207 * height_cm * height_cm};
}

/* A number that is given stands in place of the sediment's. */
static sediment sediment_in(const asdic_scatterer *s) {
    const double *v = s->value;
    size_t name = isnan(v[SEDIMENT]) ? NAME_COUNT : (size_t)v[SEDIMENT] - 1;
    sediment it = name < STONES       ? stones[name]
                  : name < NAME_COUNT ? sediment_of(grain_phi[name - STONES])
                                      : sediment_of(v[PHI]);
    it.density_ratio = isnan(v[DENSITY]) ? it.density_ratio : v[DENSITY];
    it.speed_ratio = isnan(v[SPEED]) ? it.speed_ratio : v[SPEED];
    it.loss_ratio = isnan(v[LOSS]) ? it.loss_ratio : v[LOSS];
    it.strength_cm4 = isnan(v[STRENGTH]) ? it.strength_cm4 : v[STRENGTH];
    it.exponent = isnan(v[EXPONENT]) ? it.exponent : v[EXPONENT];
    it.volume_ratio = isnan(v[VOLUME]) ? it.volume_ratio : v[VOLUME];
    return it;
}

/* --- reflection --------------------------------------------------------------------------------- */

/* P = sqrt(kappa^2 - cos^2 theta). */
static double complex through(const asdic_scatterer *s, double cos2) {
    return csqrt(s->made[KAPPA2_RE] - cos2 + I * s->made[KAPPA2_IM]);
}

static double abs2(double complex z) {
    return creal(z) * creal(z) + cimag(z) * cimag(z);
}

/* |R|^2 of R = (y - 1) / (y + 1), y = rho sin theta / P: a smooth face. */
static double reflection2(const asdic_scatterer *s, double sine) {
    double from = fmax(sine, LEAST_RAD);
    double complex p = through(s, (1.0 - from) * (1.0 + from));
    return abs2((s->made[RHO] * from - p) / (s->made[RHO] * from + p));
}

/* In the mirror direction goes what keeps its phase, as with every other bottom (kernels/mirror.h). */
static double reflected(const asdic_scatterer *s, double sine) {
    return mirror_share(sine, reflection2(s, sine), s->made[ROUGHNESS_G]);
}

/* --- what is the same for all angles ------------------------------------------------------------- */

static void prepare_kirchhoff(double *made) {
    double al = 0.5 * made[GAMMA] - 1.0, k = made[K_CM];
    double ch2 = 2.0 * ASDIC_PI * made[W2] * tgamma(2.0 - al) * pow(2.0, -2.0 * al) /
                 (al * (1.0 - al) * tgamma(1.0 + al));
    made[QC] = ch2 * pow(2.0, 1.0 - 2.0 * al) * pow(k, 2.0 * (1.0 - al));
    double a = pow(8.0 * al * al * tgamma(0.5 / al + 0.5) /
                       (tgamma(0.5) * tgamma(1.0 / al) * tgamma(0.5 / al)),
                   2.0 * al);
    made[KR_A] = a;
    /* So that it is Kirchhoff's integral at normal incidence, R^2 Gamma(1 / al) qc^(-1 / al) / (16 pi al), for any
     * gamma (D. R. Jackson, D. P. Winebrenner and A. Ishimaru, J. Acoust. Soc. Am. 79, 1410 (1986)). */
    made[KR_B] = pow(a, 0.5 + 0.5 / al) * tgamma(1.0 / al) / (2.0 * al);
    double c4 = pow(1000.0, 1.0 / (1.0 + al)) * pow(a * made[QC] * made[QC], 1.0 / al);
    made[KR_COSINE] = pow(1.0 / c4 + 4.0, -0.25);
}

/* f(x) = 1 / (1 + e^x). */
static double join(double x) {
    return 1.0 / (1.0 + exp(x));
}

static void prepare_large(double *made) {
    double rho = made[RHO], nu = made[NU], slope = made[SLOPE], slope_deg = slope * DEG;
    double critical_deg = nu < 1.001 ? 2.5613 : acos(1.0 / nu) * DEG;
    double impedance = (1.0 - 2.0 / rho) / (nu * nu) + 1.0;
    made[LR_GAIN] = 0.04682 * pow(slope, 1.25) * pow(nu, 3.25) * impedance * impedance /
                    (1.0 + 3.54 * slope_deg / critical_deg);
    made[LR_EXPONENT] = 0.7263 * pow(slope, -1.0 / 3.0);
    made[LR_CRITICAL_DEG] = critical_deg;
    made[LR_WEIGHT] = 1.0 - join((atan(slope) * DEG - 7.0) / 0.5);
}

/* R.m.s. height, m, of the waves of the relief up to 1 m: what of it a pulse's mirror image sees. */
static double height_rms_m(const double *made) {
    double longest = 2.0 * ASDIC_PI / 100.0;
    double cm2 = 2.0 * ASDIC_PI * made[W2] * pow(longest, 2.0 - made[GAMMA]) / (made[GAMMA] - 2.0);
    return 0.01 * sqrt(cm2);
}

static void prepare(asdic_scatterer *s) {
    sediment it = sediment_in(s);
    double *made = s->made;
    double complex kappa = (1.0 + I * it.loss_ratio) / it.speed_ratio;
    made[RHO] = it.density_ratio;
    made[NU] = it.speed_ratio;
    made[SIGMA2] = it.volume_ratio;
    made[W2] = it.strength_cm4;
    made[GAMMA] = it.exponent;
    made[KAPPA2_RE] = creal(kappa * kappa);
    made[KAPPA2_IM] = cimag(kappa * kappa);
    made[K_CM] = 0.01 * 2.0 * ASDIC_PI / s->water.wavelength_m;
    double al = 0.5 * made[GAMMA] - 1.0;
    made[SLOPE] = sqrt(pow(2.0 * ASDIC_PI * made[W2], 1.0 / al) / (2.0 * (1.0 - al)) *
                       pow(made[K_CM] * made[K_CM] / al, (1.0 - al) / al));
    made[NORMAL_R2] = reflection2(s, 1.0);
    prepare_kirchhoff(made);
    prepare_large(made);
    made[ROUGHNESS_G] = roughness_parameter(s->water.wavelength_m, height_rms_m(made));
    s->device.density_ratio = (float)it.density_ratio; /* for the phase of what is reflected */
    s->device.index = (float)(1.0 / it.speed_ratio);
    s->device.loss_ratio = (float)it.loss_ratio;
}

/* --- strength ------------------------------------------------------------------------------------ */

static double kirchhoff(const asdic_scatterer *s, double theta) {
    const double *m = s->made;
    double al = 0.5 * m[GAMMA] - 1.0, sine = sin(theta), cosine = cos(theta);
    double sum =
        pow(cosine * cosine, 2.0 * al) + m[KR_A] * m[QC] * m[QC] * sine * sine * sine * sine;
    return m[KR_B] * m[QC] * m[NORMAL_R2] / (8.0 * ASDIC_PI * pow(sum, (1.0 + al) / (2.0 * al)));
}

/* Small-scale roughness, by perturbation:
 *     4 k^4 sin^4 |Y|^2 W2(K),  Y = ((rho - 1)^2 cos^2 + rho^2 - kappa^2) / (rho sin + P)^2
 *     K = sqrt(4 k^2 cos^2 + (k / 10)^2) */
static double small_scale(const asdic_scatterer *s, double theta) {
    const double *m = s->made;
    double sine = sin(theta), cos2 = cos(theta) * cos(theta), rho = m[RHO], k = m[K_CM];
    double complex denominator = rho * sine + through(s, cos2);
    double complex y = (rho - 1.0) * (rho - 1.0) * cos2 + rho * rho - m[KAPPA2_RE];
    double y2 = abs2(y - I * m[KAPPA2_IM]) / (abs2(denominator) * abs2(denominator));
    double wave = k * sqrt(4.0 * cos2 + 0.01);
    return 4.0 * pow(k * sine, 4.0) * y2 * m[W2] * pow(wave, -m[GAMMA]);
}

/* Volume of the sediment:
 *     5 delta sigma2 |1 - R^2|^2 sin^2 / (nu ln 10 |P|^2 Im P)
 * with 1 - R^2 = 4 rho sin P / (rho sin + P)^2 and delta / Im P = nu^2 Re P put in, which leaves no
 * quotient of small numbers where the loss is small. */
static double volume(const asdic_scatterer *s, double theta) {
    const double *m = s->made;
    double sine = sin(theta), cosine = cos(theta);
    double complex p = through(s, cosine * cosine);
    double sum2 = abs2(m[RHO] * sine + p);
    return 80.0 / log(10.0) * m[SIGMA2] * m[NU] * m[RHO] * m[RHO] * pow(sine, 4.0) * creal(p) /
           (sum2 * sum2);
}

/* Share of a slope's face that no other hides; above t = 6 it is 1 (the handbook: above 2, where
 * 5e-4 dB are missing). */
static double unshadowed(double theta, double slope) {
    double t = tan(theta) / slope;
    if (!(t > 0.0 && t < 6.0)) {
        return 1.0;
    }
    double q = (exp(-t * t) / sqrt(ASDIC_PI) - t * erfc(t)) / (4.0 * t);
    return q > 0.0 ? -expm1(-2.0 * q) / (2.0 * q) : 1.0;
}

/* A part of small scale over the slopes of the large one. Of a slope that is turned away nothing is seen, where the parts
 * are 0 / 0 in a sediment without contrast of sound speed or loss. */
static double averaged(const asdic_scatterer *s, double theta,
                       double (*part)(const asdic_scatterer *, double)) {
    static const double node[] = {1.224745, 0.0, -1.224745};
    static const double weight[] = {0.295410, 1.181636, 0.295410};
    double sum = 0.0, slope = s->made[SLOPE];
    for (int i = 0; i < 3; i++) {
        double tilted = fmin(theta - node[i] * slope, 0.5 * ASDIC_PI);
        sum += tilted > 0.0 ? weight[i] * part(s, tilted) : 0.0;
    }
    return unshadowed(theta, slope) * sum / sqrt(ASDIC_PI);
}

static double large_roughness(const asdic_scatterer *s, double theta) {
    const double *m = s->made;
    double deg = theta * DEG, slope_deg = m[SLOPE] * DEG;
    double ratio = m[LR_CRITICAL_DEG] / deg, critical = 1.0 + 0.81 * ratio * ratio;
    double off = (deg - 90.0) / slope_deg;
    return m[LR_GAIN] * pow(sin(ASDIC_PI / critical), m[LR_EXPONENT]) +
           0.0260 * m[NORMAL_R2] /
               (m[SLOPE] * m[SLOPE] * pow(1.0 + off * off / 2.6, 1.9) * critical);
}

static double strength_lin(const asdic_scatterer *s, const asdic_incidence *at) {
    const double *m = s->made;
    double theta = fmax(atan2(at->sine, sqrt(at->cos2)), LEAST_RAD);
    double near_normal = join((cos(theta) - m[KR_COSINE]) / 0.0125);
    double moderate =
        near_normal * kirchhoff(s, theta) + (1.0 - near_normal) * averaged(s, theta, small_scale);
    double rough = (1.0 - m[LR_WEIGHT]) * moderate + m[LR_WEIGHT] * large_roughness(s, theta);
    return rough + averaged(s, theta, volume);
}

/* The handbook: 3 dB above 5 degrees where sand and silt are well characterised, 5 to 10 dB where they
 * are not, 10 dB for rock. Here a sediment is well characterised where the numbers that rule its
 * roughness and its volume are given, and 5 dB stand for a name or a grain size alone. */
static double uncertainty_db(const asdic_scatterer *s) {
    const double *v = s->value;
    bool is_stone = !isnan(v[SEDIMENT]) && v[SEDIMENT] <= (double)STONES;
    return is_stone ? 10.0 : isnan(v[STRENGTH]) || isnan(v[VOLUME]) ? 5.0 : 3.0;
}

/* --- the law ------------------------------------------------------------------------------------- */

/* A number of the sediment that may be given in place of its own. */
#define OWN(key, lo, hi, valid_lo, valid_hi, unit_text, text)                                      \
    {                                                                                              \
        .name = key, .numeric = true, .fallback = NAN, .min = lo, .max = hi,                       \
        .valid_min = valid_lo, .valid_max = valid_hi, .unit = unit_text, .doc = text               \
    }
#define SOURCE                                                                                     \
    "APL-UW TR 9407, High-Frequency Ocean Environmental Acoustic Models Handbook (1994), part IV"
#define KEYS                                                                                       \
    {                                                                                              \
        [SEDIMENT] = {.name = "sediment",                                                          \
                      .words = NAMES,                                                              \
                      .fallback = NAN,                                                             \
                      .min = 1.0,                                                                  \
                      .max = NAME_COUNT,                                                           \
                      .valid_min = 1.0,                                                            \
                      .valid_max = NAME_COUNT,                                                     \
                      .chooses = true,                                                             \
                      .doc = "scatters as this sediment of APL-UW TR 9407"},                       \
        [PHI] = {.name = "grain_size_phi",                                                         \
                 .numeric = true,                                                                  \
                 .fallback = 1.5,                                                                  \
                 .min = -1.0,                                                                      \
                 .max = 9.0,                                                                       \
                 .valid_min = -1.0,                                                                \
                 .valid_max = 9.0,                                                                 \
                 .chooses = true,                                                                  \
                 .unit = "phi",                                                                    \
                 .doc = "scatters as the sediment of APL-UW TR 9407 with this mean grain size: "   \
                        "gravel -1, medium sand 1.5, clay 9"},                                     \
        [DENSITY] = OWN("density_ratio", 1.0, 5.0, 1.0, 3.0, NULL,                                 \
                        "density of the sediment over that of water; else the sediment's"),        \
        [SPEED] = OWN("sound_speed_ratio", 0.5, 5.0, 0.8, 3.0, NULL,                               \
                      "sound speed of the sediment over that of water; else the sediment's"),      \
        [LOSS] = OWN("loss_ratio", 0.0, 1.0, 0.0, 0.1, NULL,                                       \
                     "loss of the sediment, imaginary over real wave number; else the "            \
                     "sediment's"),                                                                \
        [STRENGTH] = OWN("spectral_strength_cm4", 1e-6, 10.0, 1e-6, 1.0, "cm4",                    \
                         "spectral strength of the relief; else the sediment's"),                  \
        [EXPONENT] = OWN("spectral_exponent", 2.1, 3.9, 2.4, 3.9, NULL,                            \
                         "spectral exponent of the relief; else the sediment's"),                  \
        [VOLUME] = OWN("volume_ratio", 0.0, 1.0, 0.0, 0.004, NULL,                                 \
                       "volume scattering of the sediment, cross-section over absorption; "        \
                       "else the sediment's"),                                                     \
        LAW_F_KHZ(10.0, 100.0), LAW_GRAZING, LAW_C_MPS                                             \
    }
#define KEY_COUNT 11

static const asdic_model_info mirror_model = {
    "apl-bottom-loss", "dB", "loss of one reflection by the smooth face of a sediment", SOURCE,
    KEY_COUNT,         KEYS};

const asdic_law asdic_law_apl_bottom = {
    .name = "apl-bottom",
    .uses = ASDIC_LAW_BOTTOM | ASDIC_LAW_OBJECT,
    .model = {"apl-bottom", "dB", "backscattering strength of a sediment re 1 m^2/m^2", SOURCE,
              KEY_COUNT, KEYS},
    .mirror_model = &mirror_model,
    .prepare = prepare,
    .strength_lin = strength_lin,
    .reflected = reflected,
    .smooth_reflected = reflection2,
    .uncertainty_db = uncertainty_db,
};
