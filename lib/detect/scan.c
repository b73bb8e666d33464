#include <asdic/scan.h>

#include "law.h"

#include "base/context.h"
#include "base/try.h"
#include "sim/pulse.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Thresholds of K speckle depend on the noise's share of a bin; shares are rounded to this step. */
#define SHARE_STEPS 1000
/* Steps of the sampling error for which thresholds are computed, and their number. */
#define ERROR_STEP_DB 0.2
#define MOST_STEPS 80
/* Of coherent pings nothing is decided beside a bin of which so many times as much is expected. */
#define EDGE_LIN 10.0

struct asdic_scan {
    asdic_context *ctx;
    asdic_sonar sonar; /* without receivers */
    size_t beams, bins;
    asdic_detector detector;
    bool has_cfar, is_coherent;
    asdic_cfar cfar;
    asdic_cfar_scale scales[ASDIC_CFAR_SCALES];
    size_t apart;                /* bins between neighbours of its windows */
    asdic_background law;        /* its mean and noise share are those of each bin */
    double *factor;              /* threshold over mean by the noise's share; 0: not computed yet */
    double lift[MOST_STEPS + 1]; /* of a threshold, by the mean's error; the same */
    double *background_lin, *threshold_lin, *llr; /* one block */
};

/* Bins from one to the next whose speckle is independent: a pulse less a tenth, which moves a P_FA
 * of 1e-3 by 5 % at most. */
static size_t apart_of(const asdic_sonar *sonar, double sound_speed_mps) {
    double bins = asdic_pulse_bins(sonar, sound_speed_mps);
    return (size_t)fmin(fmax(ceil(bins - 0.1), 1.0), ASDIC_SONAR_MAX_BINS);
}

asdic_detector asdic_detector_default(void) {
    return (asdic_detector){.target = ASDIC_TARGET_SWERLING1,
                            .pfa = 1e-3,
                            .prior = 0.01,
                            .snr_db = 10.0,
                            .cost_ratio = NAN};
}

static asdic_status check_numbers(asdic_context *ctx, const asdic_detector *d) {
    const struct {
        const char *name;
        double value, least, most;
    } numbers[] = {{"pfa", d->pfa, ASDIC_DETECTOR_MIN_PFA, ASDIC_DETECTOR_MAX_PFA},
                   {"prior", d->prior, ASDIC_DETECTOR_MIN_PRIOR, ASDIC_DETECTOR_MAX_PRIOR},
                   {"snr_db", d->snr_db, ASDIC_DETECTOR_MIN_SNR_DB, ASDIC_DETECTOR_MAX_SNR_DB},
                   {"cost_ratio", isnan(d->cost_ratio) ? 1.0 : d->cost_ratio,
                    ASDIC_DETECTOR_MIN_COST, ASDIC_DETECTOR_MAX_COST}};
    for (size_t i = 0; i < sizeof numbers / sizeof *numbers; i++) {
        if (!(numbers[i].value >= numbers[i].least && numbers[i].value <= numbers[i].most)) {
            return asdic_fail(ctx, ASDIC_ERROR_ARGUMENT,
                              "detector: '%s' = %g is out of range [%g, %g]", numbers[i].name,
                              numbers[i].value, numbers[i].least, numbers[i].most);
        }
    }
    return ASDIC_OK;
}

asdic_status asdic_scan_create(asdic_context *ctx, const asdic_sonar *sonar, double sound_speed_mps,
                               size_t bins, const asdic_detector *detector, const asdic_cfar *cfar,
                               asdic_scan **out) {
    if (!ASDIC_PLACE(out) || !sonar || !detector || bins == 0 || sonar->receiver_count == 0) {
        return asdic_fail(ctx, ASDIC_ERROR_ARGUMENT,
                          "asdic_scan_create: a sonar, bins and a detector are needed");
    }
    if (bins > SIZE_MAX / (3 * sizeof(double)) / sonar->receiver_count) {
        return asdic_fail(ctx, ASDIC_ERROR_ARGUMENT, "a detector of %zu beams and %zu bins",
                          sonar->receiver_count, bins);
    }
    if (!asdic_target_is_known(detector->target)) {
        return asdic_fail(ctx, ASDIC_ERROR_ARGUMENT, "a detector for targets of no kind, %d",
                          (int)detector->target);
    }
    TRY(check_numbers(ctx, detector));
    asdic_scan *scan = calloc(1, sizeof *scan);
    if (!scan) {
        return asdic_fail_memory(ctx, "a detector");
    }
    scan->ctx = ctx;
    scan->sonar = *sonar;
    scan->sonar.receivers = NULL;
    scan->beams = sonar->receiver_count;
    scan->bins = bins;
    scan->detector = *detector;
    scan->has_cfar = cfar != NULL;
    scan->cfar = cfar ? *cfar : asdic_cfar_default();
    scan->law = asdic_background_of(sonar, sound_speed_mps, 1.0, 0.0);
    scan->apart = apart_of(sonar, sound_speed_mps);
    scan->factor = calloc(SHARE_STEPS + 1, sizeof *scan->factor);
    scan->background_lin = calloc(3 * scan->beams * bins, sizeof *scan->background_lin);
    if (!scan->factor || !scan->background_lin) {
        asdic_scan_destroy(&scan);
        return asdic_fail_memory(ctx, "a detector");
    }
    scan->threshold_lin = scan->background_lin + scan->beams * bins;
    scan->llr = scan->threshold_lin + scan->beams * bins;
    *out = scan;
    return ASDIC_OK;
}

void asdic_scan_destroy(asdic_scan **scan) {
    if (scan && *scan) {
        free((*scan)->factor);
        free((*scan)->background_lin);
        free(*scan);
        *scan = NULL;
    }
}

void asdic_scan_set_sound_speed(asdic_scan *scan, double sound_speed_mps) {
    if (!scan) {
        return;
    }
    asdic_background law = asdic_background_of(&scan->sonar, sound_speed_mps, 1.0, 0.0);
    scan->apart = apart_of(&scan->sonar, sound_speed_mps);
    if (law.looks != scan->law.looks) { /* what was computed is another law's */
        scan->law = law;
        memset(scan->factor, 0, (SHARE_STEPS + 1) * sizeof *scan->factor);
        memset(scan->lift, 0, sizeof scan->lift);
        memset(scan->scales, 0, sizeof scan->scales);
    }
}

void asdic_scan_set_coherent(asdic_scan *scan, bool is_coherent) {
    if (scan) {
        scan->is_coherent = is_coherent;
    }
}

/* The threshold of a bin over its background's mean: from P_FA, or from the costs of errors. */
static asdic_status find_factor(asdic_scan *scan, double noise_share, double *factor) {
    bool is_k = scan->law.shape <= ASDIC_SHAPE_MAX;
    size_t step = is_k ? (size_t)lround(noise_share * SHARE_STEPS) : 0;
    const asdic_detector *d = &scan->detector;
    asdic_background law = scan->law;
    law.noise_share = (double)step / SHARE_STEPS;
    asdic_status status = ASDIC_OK;
    if (scan->factor[step] == 0.0) {
        status =
            isnan(d->cost_ratio)
                ? asdic_detect_threshold(scan->ctx, &law, d->pfa, &scan->factor[step])
                : asdic_detect_threshold_llr(scan->ctx, &law, d->target, pow(10.0, 0.1 * d->snr_db),
                                             asdic_detect_cost_llr(d->prior, 1.0, d->cost_ratio),
                                             &scan->factor[step]);
    }
    *factor = scan->factor[step];
    return status;
}

/* The factor by which an uncertain mean raises the threshold, by step of its error. */
static asdic_status find_lift(asdic_scan *scan, size_t step, double *lift) {
    if (scan->lift[step] == 0.0) {
        asdic_background blurred =
            asdic_background_blurred(scan->law, ERROR_STEP_DB * (double)step);
        double before, after;
        TRY(asdic_detect_threshold(scan->ctx, &scan->law, scan->detector.pfa, &before));
        TRY(asdic_detect_threshold(scan->ctx, &blurred, scan->detector.pfa, &after));
        scan->lift[step] = after / before;
    }
    *lift = scan->lift[step];
    return ASDIC_OK;
}

/* Raises thresholds for the errors of the means. Between steps the factor is interpolated in the
 * squared error. */
static asdic_status lift_thresholds(asdic_scan *scan, const float *stderr_db) {
    for (size_t i = 0; i < scan->beams * scan->bins; i++) {
        double error_db =
            isnan(stderr_db[i]) ? 0.0 : (double)stderr_db[i]; /* a silent bin has none */
        double at = fmin(error_db / ERROR_STEP_DB, MOST_STEPS), low, high;
        double k = floor(fmin(at, MOST_STEPS - 1)), part = (at * at - k * k) / (2.0 * k + 1.0);
        if (at > 0.0) {
            TRY(find_lift(scan, (size_t)k, &low));
            TRY(find_lift(scan, (size_t)k + 1, &high));
            scan->threshold_lin[i] *= low + part * (high - low);
        }
    }
    return ASDIC_OK;
}

/* Whether bin I may hold more of a neighbour's edge than of its own. */
static bool is_edge(const asdic_scan *scan, const double *mean_lin, size_t i) {
    double before = i % scan->bins > 0 ? mean_lin[i - 1] : 0.0;
    double behind = (i + 1) % scan->bins > 0 ? mean_lin[i + 1] : 0.0;
    return scan->is_coherent && !scan->has_cfar && fmax(before, behind) > EDGE_LIN * mean_lin[i];
}

/* Thresholds over MEAN_LIN, which may be an estimate of CFAR. */
static asdic_status over_means(asdic_scan *scan, const double *mean_lin, const double *noise_lin) {
    for (size_t i = 0; i < scan->beams * scan->bins; i++) {
        double mean = mean_lin[i], factor = NAN;
        bool is_known = mean > 0.0 && isfinite(mean) && !is_edge(scan, mean_lin, i);
        if (is_known) {
            double share = noise_lin ? fmin(fmax(noise_lin[i] / mean, 0.0), 1.0) : 0.0;
            TRY(find_factor(scan, share, &factor));
        }
        scan->background_lin[i] = is_known ? mean : NAN;
        scan->threshold_lin[i] = factor * mean; /* NAN where nothing is known */
    }
    return ASDIC_OK;
}

/* Thresholds of a ping, over what is expected or over its neighbours. */
static asdic_status find_thresholds(asdic_scan *scan, const double *intensity_lin,
                                    const double *expected_lin, const double *noise_lin,
                                    const float *stderr_db) {
    if (!intensity_lin || (!scan->has_cfar && !expected_lin)) {
        return asdic_fail(scan->ctx, ASDIC_ERROR_ARGUMENT,
                          "asdic_scan_ping: intensities and, without CFAR, what is expected");
    }
    if (scan->has_cfar) {
        TRY(asdic_cfar_check(scan->ctx, &scan->cfar));
    }
    for (size_t b = 0; scan->has_cfar && b < scan->beams; b++) {
        size_t first = b * scan->bins;
        const asdic_cfar_bins row = {intensity_lin + first, scan->bins, scan->apart};
        TRY(asdic_cfar_row_scaled(scan->ctx, &scan->cfar, scan->law.looks, scan->detector.pfa, &row,
                                  scan->background_lin + first, scan->threshold_lin + first,
                                  scan->scales));
    }
    if (!scan->has_cfar || !isnan(scan->detector.cost_ratio)) {
        TRY(over_means(scan, scan->has_cfar ? scan->background_lin : expected_lin, noise_lin));
    }
    if (stderr_db && isnan(scan->detector.cost_ratio)) {
        TRY(lift_thresholds(scan, stderr_db));
    }
    return ASDIC_OK;
}

/* Likelihood ratios of all bins, or of those alone that exceed their threshold, and NAN of others. */
static void find_ratios(asdic_scan *scan, const double *intensity_lin, const double *noise_lin,
                        bool detected_alone) {
    double snr = pow(10.0, 0.1 * scan->detector.snr_db);
    for (size_t i = 0; i < scan->beams * scan->bins; i++) {
        asdic_background law = scan->law;
        law.mean_lin = scan->background_lin[i];
        law.noise_share = noise_lin && law.mean_lin > 0.0
                              ? fmin(fmax(noise_lin[i] / law.mean_lin, 0.0), 1.0)
                              : 0.0;
        bool is_asked =
            law.mean_lin > 0.0 && (!detected_alone || intensity_lin[i] > scan->threshold_lin[i]);
        scan->llr[i] = is_asked ? asdic_detect_llr(&law, scan->detector.target, snr * law.mean_lin,
                                                   intensity_lin[i])
                                : NAN;
    }
}

asdic_status asdic_scan_ping(asdic_scan *scan, const double *intensity_lin,
                             const double *expected_lin, const double *noise_lin,
                             const float *stderr_db) {
    if (!scan) {
        return asdic_fail_null(NULL, __func__);
    }
    TRY(find_thresholds(scan, intensity_lin, expected_lin, noise_lin, stderr_db));
    find_ratios(scan, intensity_lin, noise_lin, false);
    return ASDIC_OK;
}

asdic_status asdic_scan_detect(asdic_scan *scan, const double *intensity_lin,
                               const double *expected_lin, const double *noise_lin,
                               const float *stderr_db) {
    TRY(find_thresholds(scan, intensity_lin, expected_lin, noise_lin, stderr_db));
    find_ratios(scan, intensity_lin, noise_lin, true);
    return ASDIC_OK;
}

double asdic_scan_cfar_pfa(asdic_scan *scan, const double *intensity_lin, size_t cell) {
    size_t at = cell % scan->bins;
    const asdic_cfar_bins row = {intensity_lin + cell - at, scan->bins, scan->apart};
    double factor = scan->threshold_lin[cell] / scan->background_lin[cell];
    return scan->law.shape <= ASDIC_SHAPE_MAX
               ? NAN
               : asdic_cfar_rate(&scan->cfar, scan->law.looks, factor, &row, at, scan->scales);
}

asdic_scan_result asdic_scan_get(const asdic_scan *scan) {
    return scan ? (asdic_scan_result){scan->background_lin, scan->threshold_lin, scan->llr}
                : (asdic_scan_result){0};
}
