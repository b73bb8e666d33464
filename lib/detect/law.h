/*
 * The laws of a bin's intensity, inside.
 */
#ifndef ASDIC_DETECT_LAW_H
#define ASDIC_DETECT_LAW_H

#include <asdic/scan.h>

/* Above this shape, K speckle counts as Rayleigh speckle. */
#define ASDIC_SHAPE_MAX 1000.0
/* Intensities re the mean are at most this: K speckle's textures lie the closer, the stronger they are. */
#define ASDIC_DETECT_MOST 1e12

/* Everything in the range that detect.h states. */
bool asdic_background_is_good(const asdic_background *background);
asdic_status asdic_background_check(asdic_context *ctx, const asdic_background *background);

/* The law of intensities over BACKGROUND when its mean has an error. An error of relative variance
 * e^2 acts as a texture of shape 1 / e^2; with a texture, the variances of both add, whatever the
 * texture modulates. */
asdic_background asdic_background_blurred(asdic_background background, double stderr_db);

/* Background plus a target, where both are exponential per look. */
asdic_background asdic_background_with(const asdic_background *background, double target_lin);

/* In K speckle, ln of the density of an intensity, but for what the background's looks and shape alone decide. */
double asdic_detect_log_density(const asdic_background *background, double intensity_lin);

/* What CFAR needs to know of a window of so many bins: threshold over statistic, and the statistic over
 * the background's mean; the P_FA of a threshold by cost. 0: not computed yet. */
typedef struct asdic_cfar_scale {
    double factor, bias, rate;
} asdic_cfar_scale;

#define ASDIC_CFAR_MOST_CELLS 256u /* on either side */
#define ASDIC_CFAR_SCALES (2 * ASDIC_CFAR_MOST_CELLS + 1)

asdic_status asdic_cfar_check(asdic_context *ctx, const asdic_cfar *cfar);

/* A row's bins as windows see them: those APART, whose speckle is independent, are neighbours. */
typedef struct asdic_cfar_bins {
    const double *intensity_lin;
    size_t count, apart;
} asdic_cfar_bins;

/* asdic_cfar_row of a CFAR that was checked, with SCALES[ASDIC_CFAR_SCALES] kept from row to row:
 * of several looks each takes thousands of integrals. */
asdic_status asdic_cfar_row_scaled(asdic_context *ctx, const asdic_cfar *cfar, unsigned looks,
                                   double pfa, const asdic_cfar_bins *row, double *background_lin,
                                   double *threshold_lin, asdic_cfar_scale *scales);

/* P_FA of a threshold FACTOR times the background estimated of bin AT of the row that was scaled last. FACTOR is the
 * same at every call. */
double asdic_cfar_rate(const asdic_cfar *cfar, unsigned looks, double factor,
                       const asdic_cfar_bins *row, size_t at, asdic_cfar_scale *scales);

/* asdic_scan_ping with the likelihood ratios of detected bins alone, and NAN for others. */
asdic_status asdic_scan_detect(asdic_scan *scan, const double *intensity_lin,
                               const double *expected_lin, const double *noise_lin,
                               const float *stderr_db);

/* P_FA of the threshold by cost of CELL of the ping that was scanned last, over a background that CFAR estimates. NAN
 * in K clutter, for which there is no closed form. */
double asdic_scan_cfar_pfa(asdic_scan *scan, const double *intensity_lin, size_t cell);

/* As asdic_estimate_of, with a confidence of LEVEL. */
asdic_estimate asdic_estimate_within(uint64_t events, uint64_t trials, double level);

/* The z below which a normal variate lies with probability 0.5 + LEVEL / 2. */
double asdic_normal_bound(double level);

bool asdic_target_is_known(asdic_target target);

/* TARGET_... of kernels/detection.h. */
int asdic_target_code(asdic_target target);

/* What asdic_detect_simulate_rare draws, which is the same for every threshold: gamma variates of mean LOOKS and SHAPE. */
typedef struct asdic_rare_draw {
    double speckle, texture;
} asdic_rare_draw;

asdic_rare_draw asdic_rare_draw_one(const asdic_background *b, uint64_t seed, uint64_t index);

/* The same as asdic_detect_simulate_rare from COUNT draws of indices 0, 1, ... */
asdic_estimate asdic_rare_estimate(const asdic_background *b, double threshold_lin,
                                   const asdic_rare_draw *draws, size_t count);

#endif
