/*
 * From what a beam's bins hold, the truth that users get: shares, the strongest, depressions (asdic/truth.h).
 */
#ifndef ASDIC_SIM_TRUTH_SHARES_H
#define ASDIC_SIM_TRUTH_SHARES_H

#include <asdic/ping.h>

/* Where the sines of depression begin: they are summed as (1 + sine) / 2. */
#define ASDIC_TRUTH_MIDDLE 0.5

/* What a beam holds, by arrays over its bins. */
typedef struct asdic_holdings {
    const double *part[ASDIC_COMPONENT_COUNT];
    const double *by_surface, *by_bottom; /* of the multipath; NULL: none of either */
    const double *most;                   /* the strongest object's energy */
    const double *moment; /* (1 + sine of depression) / 2 of the echo, summed by its energy */
    const double *none;   /* zeros, which stand for a part that is not there */
} asdic_holdings;

/* Fills the truth of a beam of BINS, which begins at FIRST, but the numbers of objects, which are there. */
void asdic_truth_share(const asdic_holdings *h, size_t bins, const asdic_ping_truth *truth,
                       size_t first);

#endif
