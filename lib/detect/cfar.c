/*
 * Thresholds that follow the background. With t = factor / count and looks m:
 *
 *     CA  PFA = sum_{j < m} C(count m + j - 1, j) q^j (1 - q)^(count m), q = t / (1 + t)
 *         (m = 1: (1 + t)^-count; Finn & Johnson, RCA Review 29, 414 (1968))
 *     OS  PFA = prod_{i < k} (count - i) / (count - i + factor), m = 1
 *         (Rohling, IEEE Trans. AES-19, 608 (1983))
 *
 * For OS with several looks, and for detection, the fixed threshold's probability is averaged over
 * the estimate's distribution.
 */
#include "law.h"

#include "base/context.h"
#include "base/quadrature.h"
#include "base/try.h"

#include "../../kernels/detection.h"

#include <math.h>
#include <stdlib.h>

#define TOLERANCE 1e-10
#define MOST_CELLS 256u

asdic_cfar asdic_cfar_default(void) {
    return (asdic_cfar){.kind = ASDIC_CFAR_CA, .cells = 8, .guard = 2, .rank = 0.75};
}

typedef struct window {
    asdic_cfar_kind kind;
    double count, rank, looks, factor, snr;
    int target;
    double log_orders; /* OS: ln of count! / ((rank - 1)! (count - rank)!) */
} window;

static window window_of(asdic_cfar_kind kind, unsigned count, unsigned rank, unsigned looks,
                        double factor) {
    int sign;
    window w = {.kind = kind,
                .count = (double)count,
                .rank = (double)rank,
                .looks = (double)looks,
                .factor = factor};
    w.log_orders = lgamma_r(w.count + 1.0, &sign) - lgamma_r(fmax(w.rank, 1.0), &sign) -
                   lgamma_r(w.count - w.rank + 1.0, &sign);
    return w;
}

/* The density of the estimate at s = looks x estimate (OS), or looks x count x estimate (CA), times
 * the chance of exceeding factor x estimate. */
static double part(double s, void *user) {
    const window *w = user;
    if (w->kind == ASDIC_CFAR_CA) {
        double shape = w->count * w->looks;
        double estimate = s / shape;
        return poisson_pmf(shape - 1.0, s) *
               detection_exponential(w->factor * estimate, w->snr, w->looks, w->target);
    }
    double above = poisson_below(w->looks, s), below = 1.0 - above;
    if (s < 1e-3 * w->looks) { /* without cancellation: pmf(m) (1 + s / (m + 1) + ...) */
        below =
            poisson_pmf(w->looks, s) * (1.0 + s / (w->looks + 1.0) * (1.0 + s / (w->looks + 2.0)));
    }
    if (!(below > 0.0) || !(above > 0.0)) {
        return 0.0;
    }
    double order =
        exp(w->log_orders + (w->rank - 1.0) * log(below) + (w->count - w->rank) * log(above));
    return order * poisson_pmf(w->looks - 1.0, s) *
           detection_exponential(w->factor * s / w->looks, w->snr, w->looks, w->target);
}

/* In pieces, so that a narrow peak does not fall between the nodes of a wide one. */
static double average(window *w) {
    double shape = w->kind == ASDIC_CFAR_CA ? w->count * w->looks : w->looks;
    double end = shape + 12.0 * sqrt(shape) + 60.0, sum = 0.0;
    for (int i = 0; i < 32; i++) {
        sum += asdic_quadrature(part, w, end * i / 32.0, end * (i + 1) / 32.0, TOLERANCE);
    }
    return fmin(sum, 1.0);
}

static bool is_good(asdic_cfar_kind kind, unsigned count, unsigned rank, unsigned looks,
                    double factor) {
    return count >= 1 && count <= 2 * MOST_CELLS && looks >= 1 && looks <= 1000 && factor >= 0.0 &&
           (kind == ASDIC_CFAR_CA || (rank >= 1 && rank <= count));
}

double asdic_cfar_pfa(asdic_cfar_kind kind, unsigned count, unsigned rank, unsigned looks,
                      double factor) {
    if (!is_good(kind, count, rank, looks, factor)) {
        return NAN;
    }
    if (kind == ASDIC_CFAR_CA) {
        double t = factor / (double)count, trials = (double)count * (double)looks;
        double term = exp(-trials * log1p(t)), sum = 0.0;
        for (double j = 0.0; j < (double)looks; j += 1.0) {
            sum += term;
            term *= (trials + j) / (j + 1.0) * t / (1.0 + t);
        }
        return sum;
    }
    if (looks == 1) {
        double product = 1.0;
        for (unsigned i = 0; i < rank; i++) {
            product *= (double)(count - i) / ((double)(count - i) + factor);
        }
        return product;
    }
    window w = window_of(kind, count, rank, looks, factor);
    return average(&w);
}

double asdic_cfar_pd(asdic_cfar_kind kind, unsigned count, unsigned rank, unsigned looks,
                     double factor, asdic_target target, double snr) {
    if (!is_good(kind, count, rank, looks, factor) || !(snr >= 0.0)) {
        return NAN;
    }
    if (looks == 1 && target == ASDIC_TARGET_SWERLING1) {
        return asdic_cfar_pfa(kind, count, rank, 1, factor / (1.0 + snr));
    }
    if (target == ASDIC_TARGET_SWERLING2) {
        return asdic_cfar_pfa(kind, count, rank, looks, factor / (1.0 + snr));
    }
    window w = window_of(kind, count, rank, looks, factor);
    w.snr = snr;
    w.target = asdic_target_code(target);
    return average(&w);
}

asdic_status asdic_cfar_factor(asdic_context *ctx, asdic_cfar_kind kind, unsigned count,
                               unsigned rank, unsigned looks, double pfa, double *factor) {
    if (!is_good(kind, count, rank, looks, 0.0) || !(pfa > 0.0 && pfa < 1.0)) {
        return asdic_fail(ctx, ASDIC_ERROR_ARGUMENT,
                          "CFAR over %u bins (1..%u), rank %u, %u looks (1..1000), P_FA %g (0..1)",
                          count, 2 * MOST_CELLS, rank, looks, pfa);
    }
    double low = 0.0, high = 1.0;
    while (asdic_cfar_pfa(kind, count, rank, looks, high) > pfa) {
        low = high;
        high *= 4.0;
        if (high > 1e15) {
            return asdic_fail(ctx, ASDIC_ERROR_ARGUMENT,
                              "CFAR over %u bins cannot keep P_FA %g; give it more bins", count,
                              pfa);
        }
    }
    for (int i = 0; i < 60 && high - low > 1e-12 * high; i++) {
        double middle = 0.5 * (low + high);
        if (asdic_cfar_pfa(kind, count, rank, looks, middle) > pfa) {
            low = middle;
        } else {
            high = middle;
        }
    }
    *factor = high;
    return ASDIC_OK;
}

static int ascending(const void *a, const void *b) {
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* Rank of COUNT bins. */
static unsigned rank_of(const asdic_cfar *cfar, unsigned count) {
    double rank = ceil(cfar->rank * (double)count - 1e-9);
    return rank < 1.0 ? 1 : (unsigned)rank;
}

/* Copies the bins of the window round AT into WINDOW and returns how many. Bins without energy do
 * not count. */
static unsigned gather(const asdic_cfar *cfar, const double *row, size_t bins, size_t at,
                       double *out) {
    unsigned count = 0;
    for (size_t k = cfar->guard + 1; k <= cfar->guard + cfar->cells; k++) {
        if (at >= k && row[at - k] > 0.0) {
            out[count++] = row[at - k];
        }
        if (at + k < bins && row[at + k] > 0.0) {
            out[count++] = row[at + k];
        }
    }
    return count;
}

/* The window's estimate: the mean, or the order statistic. */
static double statistic(const asdic_cfar *cfar, double *bins, unsigned count) {
    if (cfar->kind == ASDIC_CFAR_OS) {
        qsort(bins, count, sizeof *bins, ascending);
        return bins[rank_of(cfar, count) - 1];
    }
    double sum = 0.0;
    for (unsigned i = 0; i < count; i++) {
        sum += bins[i];
    }
    return sum / (double)count;
}

/* Values that depend on the number of bins in a window: the factor, and the statistic over the
 * background's mean. */
typedef struct scale {
    double factor, bias;
} scale;

static asdic_status find_scale(asdic_context *ctx, const asdic_cfar *cfar, unsigned looks,
                               double pfa, unsigned count, scale *out) {
    unsigned rank = rank_of(cfar, count);
    asdic_background unit = {.mean_lin = 1.0, .looks = looks, .shape = INFINITY};
    asdic_status status = asdic_cfar_factor(ctx, cfar->kind, count, rank, looks, pfa, &out->factor);
    out->bias = 1.0;
    if (status == ASDIC_OK && cfar->kind == ASDIC_CFAR_OS) { /* the quantile that it estimates */
        status = asdic_detect_threshold(ctx, &unit, 1.0 - rank / (count + 1.0), &out->bias);
    }
    return status;
}

asdic_status asdic_cfar_row(asdic_context *ctx, const asdic_cfar *cfar, unsigned looks, double pfa,
                            const double *intensity_lin, size_t bins, double *background_lin,
                            double *threshold_lin) {
    if (!cfar || !intensity_lin || !background_lin || !threshold_lin) {
        return asdic_fail_null(ctx, __func__);
    }
    double near[2 * MOST_CELLS];
    scale scales[2 * MOST_CELLS + 1] = {0};
    if (cfar->cells < 1 || cfar->cells > MOST_CELLS || !(cfar->rank > 0.0 && cfar->rank <= 1.0)) {
        return asdic_fail(ctx, ASDIC_ERROR_ARGUMENT,
                          "CFAR of %u cells a side (1..%u), rank %g (0..1]", cfar->cells,
                          MOST_CELLS, cfar->rank);
    }
    for (size_t i = 0; i < bins; i++) {
        unsigned count = gather(cfar, intensity_lin, bins, i, near);
        background_lin[i] = threshold_lin[i] = NAN;
        if (count == 0 || !(intensity_lin[i] > 0.0)) {
            continue;
        }
        if (scales[count].factor == 0.0) {
            TRY(find_scale(ctx, cfar, looks, pfa, count, &scales[count]));
        }
        double found = statistic(cfar, near, count);
        background_lin[i] = found / scales[count].bias;
        threshold_lin[i] = found * scales[count].factor;
    }
    return ASDIC_OK;
}
