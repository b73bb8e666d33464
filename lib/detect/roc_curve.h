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
} asdic_roc_case;

/* Draws, then fills points, area, P_D and times of ROC; its trials and pfa are set. */
asdic_status asdic_roc_fill(asdic_context *ctx, const asdic_roc_case *c,
                            const asdic_roc_options *options, asdic_roc *roc);

#endif
