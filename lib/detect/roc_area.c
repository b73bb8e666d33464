/*
 * The area under a receiver operating characteristic, which is the chance that a draw with the target
 * exceeds one without (Mann & Whitney), with the variance of DeLong, DeLong & Clarke-Pearson,
 * Biometrics 44, 837 (1988): that of the placements of either kind of draw among the other.
 *
 * Where few draws overlap it is itself an estimate from few, and too small as often as they are too few. So bounds are
 * no narrower than those of a score test (R. G. Newcombe, Stat. Med. 25, 559 (2006), method 5), which takes the variance
 * that an area at the bound would have with exponential laws (Hanley & McNeil, Radiology 143, 29 (1982)).
 */
#include <asdic/roc.h>

#include "base/context.h"
#include "base/try.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define NORMAL_99 2.5758293035489004

typedef struct draw {
    double value;
    size_t index;
} draw;

static int ascending(const void *a, const void *b) {
    const draw *x = a, *y = b;
    return x->value < y->value ? -1 : x->value > y->value;
}

/* So many draws are sorted or counted between looks at whether to stop: some 10 ms of work. */
#define BLOCK ((size_t)1 << 16)

/* Merges the sorted A and B into OUT. */
static asdic_status merge(asdic_context *ctx, const draw *a, size_t a_count, const draw *b,
                          size_t b_count, draw *out) {
    size_t i = 0, k = 0;
    while (i + k < a_count + b_count) {
        if ((i + k) % BLOCK == 0) {
            TRY(asdic_step(ctx, "draws merged", i + k, a_count + b_count));
        }
        bool is_a = k == b_count || (i < a_count && a[i].value <= b[k].value);
        out[i + k] = is_a ? a[i] : b[k];
        i += is_a;
        k += !is_a;
    }
    return ASDIC_OK;
}

/* Sorts in blocks and merges them, for qsort cannot be stopped. SPARE has room for COUNT. */
static asdic_status sort(asdic_context *ctx, draw *values, draw *spare, size_t count) {
    draw *from = values, *to = spare;
    for (size_t i = 0; i < count; i += BLOCK) {
        TRY(asdic_step(ctx, "draws sorted", i, count));
        qsort(values + i, count - i < BLOCK ? count - i : BLOCK, sizeof *values, ascending);
    }
    for (size_t run = BLOCK; run < count; run *= 2) {
        for (size_t i = 0; i < count; i += 2 * run) {
            size_t middle = count - i < run ? count : i + run;
            size_t end = count - middle < run ? count : middle + run;
            TRY(merge(ctx, from + i, middle - i, from + middle, end - middle, to + i));
        }
        draw *other = from;
        from = to;
        to = other;
    }
    if (from != values) {
        memcpy(values, from, count * sizeof *values);
    }
    return ASDIC_OK;
}

/* PLACE[i]: the share of OTHERS below VALUES[i], ties counted half. Both are sorted. */
static asdic_status place(asdic_context *ctx, const draw *values, const draw *others, size_t count,
                          double *out) {
    size_t below = 0, upto = 0;
    for (size_t i = 0; i < count; i++) {
        if (i % BLOCK == 0) {
            TRY(asdic_step(ctx, "draws placed", i, count));
        }
        while (below < count && others[below].value < values[i].value) {
            below++;
        }
        while (upto < count && others[upto].value <= values[i].value) {
            upto++;
        }
        out[values[i].index] = 0.5 * ((double)below + (double)upto) / (double)count;
    }
    return ASDIC_OK;
}

static asdic_status fill_places(asdic_context *ctx, draw *sorted, size_t trials, double *out) {
    draw *spare = sorted + 2 * trials;
    TRY(sort(ctx, sorted, spare, trials));
    TRY(sort(ctx, sorted + trials, spare, trials));
    TRY(place(ctx, sorted, sorted + trials, trials, out));
    return place(ctx, sorted + trials, sorted, trials, out + trials);
}

/* Placements of the draws with the target among those without, and the reverse: 2 * TRIALS, the
 * caller's to free. */
static asdic_status placements(asdic_context *ctx, const double *none, const double *present,
                               size_t trials, double **out) {
    draw *sorted = malloc(3 * trials * sizeof *sorted);
    *out = malloc(2 * trials * sizeof **out);
    asdic_status status = sorted && *out ? ASDIC_OK : asdic_fail_memory(ctx, "places of draws");
    if (status == ASDIC_OK) {
        for (size_t i = 0; i < trials; i++) {
            sorted[i] = (draw){present[i], i};
            sorted[trials + i] = (draw){none[i], i};
        }
        status = fill_places(ctx, sorted, trials, *out);
    }
    free(sorted);
    return status;
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

/* The variance of an area from TRIALS draws of either kind, of exponential laws. */
static double exponential_variance(double area, double trials) {
    double either = (1.0 - area) / (2.0 - area) + area / (1.0 + area);
    return area * (1.0 - area) / (trials * trials) * (1.0 + (trials - 1.0) * either);
}

/* The area towards END, 0 or 1, that is as far from AREA as 99 % of the areas of its draws are from it. */
static double score_bound(double area, double end, double trials) {
    double near = area, far = end;
    for (int i = 0; i < 60; i++) {
        double middle = 0.5 * (near + far);
        bool is_within =
            fabs(middle - area) < NORMAL_99 * sqrt(exponential_variance(middle, trials));
        near = is_within ? middle : near;
        far = is_within ? far : middle;
    }
    return near;
}

asdic_status asdic_roc_area(asdic_context *ctx, const double *none, const double *present,
                            size_t trials, asdic_estimate *area) {
    double variance;
    if (!none || !present || !area) {
        return asdic_fail_null(ctx, __func__);
    }
    if (trials < 2) {
        return asdic_fail(ctx, ASDIC_ERROR_ARGUMENT, "an area from %zu draws", trials);
    }
    double *places = NULL;
    asdic_status status = placements(ctx, none, present, trials, &places);
    area->value = status == ASDIC_OK ? moments(places, trials, &variance) : NAN;
    free(places);
    TRY(status);
    double half = NORMAL_99 * sqrt(variance);
    area->low = fmax(fmin(area->value - half, score_bound(area->value, 0.0, (double)trials)), 0.0);
    area->high = fmin(fmax(area->value + half, score_bound(area->value, 1.0, (double)trials)), 1.0);
    if (variance == 0.0) { /* no overlap at all: an event seen in none of TRIALS */
        double most = asdic_estimate_of(0, trials).high;
        area->low = fmin(area->low, 1.0 - most);
        area->high = fmax(area->high, most);
    }
    return ASDIC_OK;
}

asdic_status asdic_roc_compare(asdic_context *ctx, const asdic_roc *a, const asdic_roc *b,
                               asdic_estimate *difference) {
    if (!a || !b || !difference) {
        return asdic_fail_null(ctx, __func__);
    }
    double variance, area = NAN;
    if (a->trials != b->trials) {
        return asdic_fail(ctx, ASDIC_ERROR_ARGUMENT, "curves of %zu and %zu draws are no pairs",
                          a->trials, b->trials);
    }
    double *first = NULL, *other = NULL;
    asdic_status status = placements(ctx, a->none, a->present, a->trials, &first);
    status = status ? status : placements(ctx, b->none, b->present, b->trials, &other);
    if (status == ASDIC_OK) {
        area = moments(first, a->trials, &variance);
        for (size_t i = 0; i < 2 * a->trials; i++) {
            other[i] -= first[i];
        }
        difference->value = moments(other, a->trials, &variance);
        difference->low = difference->value - NORMAL_99 * sqrt(variance);
        difference->high = difference->value + NORMAL_99 * sqrt(variance);
    }
    if (status == ASDIC_OK && variance == 0.0 && (area == 0.0 || area == 1.0)) {
        double most = asdic_estimate_of(0, a->trials).high; /* as of an area without any overlap */
        difference->low -= most;
        difference->high += most;
    }
    free(first);
    free(other);
    return status;
}
