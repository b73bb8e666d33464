/*
 * A curve from the laws of a bin without and with its target.
 */
#ifndef ASDIC_DETECT_ROC_CURVE_H
#define ASDIC_DETECT_ROC_CURVE_H

#include <asdic/roc.h>

typedef struct asdic_roc_case {
    asdic_background none; /* the null hypothesis, on which thresholds rest */
    asdic_background rest; /* what is there beside the target */
    double target_lin;
    /* What the scattering laws leave open: the background's mean at most and at least, and the
     * target's either way, in dB from what they are; all 0: nothing is stated. */
    double background_most_db, background_least_db, target_error_db;
} asdic_roc_case;

/* P_D in closed form at PFA with the laws' errors; NAN where none is stated. */
asdic_status asdic_roc_band(asdic_context *ctx, const asdic_roc_case *c, asdic_target target,
                            double pfa, asdic_band *out);

/* Draws, then fills points, area, P_D and times of ROC; its trials and pfa are set. */
asdic_status asdic_roc_fill(asdic_context *ctx, const asdic_roc_case *c,
                            const asdic_roc_options *options, asdic_roc *roc);

#endif
