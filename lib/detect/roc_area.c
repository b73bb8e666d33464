/*
 * The area under a receiver operating characteristic, which is the chance that a draw with the target
 * exceeds one without (Mann & Whitney), with the variance of DeLong, DeLong & Clarke-Pearson,
 * Biometrics 44, 837 (1988): that of the placements of either kind of draw among the other.
 */
#include <asdic/roc.h>

#include "base/context.h"

#include <math.h>
#include <stdlib.h>

#define NORMAL_99 2.5758293035489004

typedef struct draw {
    double value;
    size_t index;
} draw;

static int ascending(const void *a, const void *b) {
    const draw *x = a, *y = b;
    return x->value < y->value ? -1 : x->value > y->value;
}

/* PLACE[i]: the share of OTHERS below VALUES[i], ties counted half. Both are sorted. */
static void place(const draw *values, const draw *others, size_t count, double *out) {
    size_t below = 0, upto = 0;
    for (size_t i = 0; i < count; i++) {
        while (below < count && others[below].value < values[i].value) {
            below++;
        }
        while (upto < count && others[upto].value <= values[i].value) {
            upto++;
        }
        out[values[i].index] = 0.5 * ((double)below + (double)upto) / (double)count;
    }
}

/* Placements of the draws with the target among those without, and the reverse: 2 * TRIALS. */
static double *placements(const double *none, const double *present, size_t trials) {
    draw *sorted = malloc(2 * trials * sizeof *sorted);
    double *out = malloc(2 * trials * sizeof *out);
    if (!sorted || !out) {
        free(sorted);
        free(out);
        return NULL;
    }
    for (size_t i = 0; i < trials; i++) {
        sorted[i] = (draw){present[i], i};
        sorted[trials + i] = (draw){none[i], i};
    }
    qsort(sorted, trials, sizeof *sorted, ascending);
    qsort(sorted + trials, trials, sizeof *sorted, ascending);
    place(sorted, sorted + trials, trials, out);
    place(sorted + trials, sorted, trials, out + trials);
    free(sorted);
    return out;
}

/* Mean of the first half and the variance that both halves give it. */
static double moments(const double *places, size_t trials, double *variance) {
    double mean[2] = {0.0, 0.0}, n = (double)trials;
    *variance = 0.0;
    for (int k = 0; k < 2; k++) {
        const double *v = places + (size_t)k * trials;
        double square = 0.0;
        for (size_t i = 0; i < trials; i++) {
            mean[k] += v[i] / n;
        }
        for (size_t i = 0; i < trials; i++) {
            square += (v[i] - mean[k]) * (v[i] - mean[k]);
        }
        *variance += square / (n - 1.0) / n;
    }
    return mean[0];
}

asdic_status asdic_roc_area(asdic_context *ctx, const double *none, const double *present,
                            size_t trials, asdic_estimate *area) {
    double variance;
    if (trials < 2) {
        return asdic_fail(ctx, ASDIC_ERROR_ARGUMENT, "an area from %zu draws", trials);
    }
    double *places = placements(none, present, trials);
    if (!places) {
        return asdic_fail_memory(ctx, "the area under a curve");
    }
    area->value = moments(places, trials, &variance);
    free(places);
    double half = NORMAL_99 * sqrt(variance);
    area->low = fmax(area->value - half, 0.0);
    area->high = fmin(area->value + half, 1.0);
    if (variance == 0.0) { /* no overlap at all: an event seen in none of TRIALS */
        area->low = fmin(area->low, 1.0 - asdic_estimate_of(0, trials).high);
    }
    return ASDIC_OK;
}

asdic_status asdic_roc_compare(asdic_context *ctx, const asdic_roc *a, const asdic_roc *b,
                               asdic_estimate *difference) {
    if (!a || !b || !difference) {
        return asdic_fail_null(ctx, __func__);
    }
    double variance;
    if (a->trials != b->trials) {
        return asdic_fail(ctx, ASDIC_ERROR_ARGUMENT, "curves of %zu and %zu draws are no pairs",
                          a->trials, b->trials);
    }
    double *first = placements(a->none, a->present, a->trials);
    double *other = placements(b->none, b->present, b->trials);
    asdic_status status = first && other ? ASDIC_OK : asdic_fail_memory(ctx, "a comparison");
    if (status == ASDIC_OK) {
        for (size_t i = 0; i < 2 * a->trials; i++) {
            other[i] -= first[i];
        }
        difference->value = moments(other, a->trials, &variance);
        difference->low = difference->value - NORMAL_99 * sqrt(variance);
        difference->high = difference->value + NORMAL_99 * sqrt(variance);
    }
    free(first);
    free(other);
    return status;
}
