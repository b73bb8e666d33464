/*
 * Detection: from intensities to decisions, with their probabilities.
 *
 * A bin's intensity z is the mean of `looks` independent looks at a background of mean mu0, each
 * exponential (Rayleigh amplitude) or, when the scatterers are few, K-distributed: exponential with
 * a mean that a gamma-distributed texture modulates, common to the bin's looks. A target of mean
 * intensity S adds its echo to every look. Everything is linear intensity; nothing is in dB.
 *
 * Closed forms: kernels/detection.h. Threads: pure functions, callable from any thread.
 */
#ifndef ASDIC_DETECT_H
#define ASDIC_DETECT_H

#include <asdic/ping.h>

#ifdef __cplusplus
extern "C" {
#endif

/* How the target's echo fluctuates: not at all; from bin to bin, exponential (Swerling I) or
 * chi-square with four degrees of freedom (III); from look to look, exponential (II), as objects do
 * in simulated speckle. With one look I and II are the same. */
typedef enum asdic_target {
    ASDIC_TARGET_SWERLING0,
    ASDIC_TARGET_SWERLING1,
    ASDIC_TARGET_SWERLING3,
    ASDIC_TARGET_SWERLING2,
} asdic_target;

typedef struct asdic_background {
    double mean_lin;    /* mu0: reverberation and noise, > 0 */
    unsigned looks;     /* 1..1000; a sum of m equal cells is m times a Gamma(m) mean */
    double shape;       /* of K-distributed reverberation, 0.05..1000; INFINITY: Rayleigh */
    double noise_share; /* of mean_lin, without texture: noise, and echoes by way of mirrors or of
                         * objects, as the simulator draws them; 0..1, read for K only */
} asdic_background;

/* Looks that SONAR has at a bin, its speckle's shape, and the share of a mean that NOISE_LIN is:
 * all of it that has no texture. */
ASDIC_API asdic_background asdic_background_of(const asdic_sonar *sonar, double sound_speed_mps,
                                               double mean_lin, double noise_lin);

/* P(z > THRESHOLD): false alarm, and detection of a target of mean intensity TARGET_LIN. Nothing is
 * above a threshold of INFINITY. NAN for values out of the ranges above. */
ASDIC_API double asdic_detect_pfa(const asdic_background *background, double threshold_lin);
ASDIC_API double asdic_detect_pd(const asdic_background *background, asdic_target target,
                                 double target_lin, double threshold_lin);

/* The natural logarithm of p(z | target) / p(z | none). In K-distributed clutter an intensity more
 * than 120 dB above the mean counts as one of 120 dB. NAN as above. */
ASDIC_API double asdic_detect_llr(const asdic_background *background, asdic_target target,
                                  double target_lin, double intensity_lin);

/* The probability of a target by Bayes' rule, from its prior probability. */
ASDIC_API double asdic_detect_posterior(double llr, double prior);

/* The llr from which on "target" is the cheaper answer: ln[C_f (1 - prior) / (C_m prior)]. */
ASDIC_API double asdic_detect_cost_llr(double prior, double cost_false_alarm, double cost_miss);

/* The threshold whose false-alarm probability is PFA (1e-300..1). */
ASDIC_API asdic_status asdic_detect_threshold(asdic_context *ctx,
                                              const asdic_background *background, double pfa,
                                              double *threshold_lin);

/* The least intensity whose log-likelihood ratio reaches LLR; INFINITY when none does, as can be in
 * K-distributed clutter, whose own spikes explain what is strong enough. */
ASDIC_API asdic_status asdic_detect_threshold_llr(asdic_context *ctx,
                                                  const asdic_background *background,
                                                  asdic_target target, double target_lin,
                                                  double llr, double *threshold_lin);

/* ---- by chance ------------------------------------------------------------------------------ */

/* A probability measured, and where it lies with 99 % confidence. */
typedef struct asdic_estimate {
    double value, low, high;
} asdic_estimate;

/* A P_D in closed form with the background as much louder and the target as much weaker as the
 * sources of the scattering laws leave open, and the other way round; thresholds follow the
 * background. NAN where no source says. */
typedef struct asdic_band {
    double low, high;
} asdic_band;

/* EVENTS in TRIALS: bounds of Clopper and Pearson, which hold for any number of trials. */
ASDIC_API asdic_estimate asdic_estimate_of(uint64_t events, uint64_t trials);

/* Draws COUNT intensities, look by look, from complex amplitudes. OUT[i] depends on SEED and
 * FIRST + i alone, and the same numbers serve every background and target: variants of a design,
 * drawn with one seed, differ by their design. TARGET_LIN 0: background. */
ASDIC_API void asdic_detect_draw(const asdic_background *background, asdic_target target,
                                 double target_lin, uint64_t seed, uint64_t first, size_t count,
                                 double *out);

/* P(z > THRESHOLD) counted in TRIALS draws. */
ASDIC_API asdic_estimate asdic_detect_simulate(const asdic_background *background,
                                               asdic_target target, double target_lin,
                                               double threshold_lin, uint64_t trials,
                                               uint64_t seed);

/* P(z > THRESHOLD) of the background by importance sampling: intensities are drawn round the
 * threshold and weighed with how much rarer they are in truth. Good for 1e-9 with a thousand
 * trials, of shapes below 0.1 with a few thousand: bounds hold as often as they say. */
ASDIC_API asdic_estimate asdic_detect_simulate_rare(const asdic_background *background,
                                                    double threshold_lin, uint64_t trials,
                                                    uint64_t seed);

/* ---- constant false-alarm rate -------------------------------------------------------------- */

typedef enum asdic_cfar_kind {
    ASDIC_CFAR_CA, /* cell averaging */
    ASDIC_CFAR_OS, /* order statistic: the k-th smallest */
} asdic_cfar_kind;

/* The background is estimated from CELLS bins on either side, beyond GUARD bins. */
typedef struct asdic_cfar {
    asdic_cfar_kind kind;
    unsigned cells; /* per side, 1..256 */
    unsigned guard; /* per side, at most ASDIC_SONAR_MAX_BINS */
    double rank;    /* OS: k over the number of bins in the window, (0, 1] */
} asdic_cfar;

/* Cell averaging over 8 + 8 bins, 2 guards a side; rank 0.75. */
ASDIC_API asdic_cfar asdic_cfar_default(void);

/* P(z > FACTOR times the estimate from COUNT bins), RANK counted from 1 (OS only): of a background
 * of LOOKS exponential looks (closed forms; in K clutter the rate is higher), and of a target of
 * mean intensity SNR in such a background. */
ASDIC_API double asdic_cfar_pfa(asdic_cfar_kind kind, unsigned count, unsigned rank, unsigned looks,
                                double factor);
ASDIC_API double asdic_cfar_pd(asdic_cfar_kind kind, unsigned count, unsigned rank, unsigned looks,
                               double factor, asdic_target target, double snr);
ASDIC_API asdic_status asdic_cfar_factor(asdic_context *ctx, asdic_cfar_kind kind, unsigned count,
                                         unsigned rank, unsigned looks, double pfa, double *factor);

/* The estimate and the threshold of every bin of a row. Near its ends the window has bins on one
 * side only, for which factors are computed as well; NAN where it has none. */
ASDIC_API asdic_status asdic_cfar_row(asdic_context *ctx, const asdic_cfar *cfar, unsigned looks,
                                      double pfa, const double *intensity_lin, size_t bins,
                                      double *background_lin, double *threshold_lin);

#ifdef __cplusplus
}
#endif

#endif
