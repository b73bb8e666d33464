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
#include <string.h>

#define TOLERANCE 1e-10
/* A sum of terms that rise by many powers of ten is counted in larger units from here on. */
#define MOST_SUM 1e200

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

/* The chance that the mean of M looks, times M, is below S, without the cancellation of one minus a
 * number close to it: what powers of it carry into an integrand no quadrature can resolve. */
static double gamma_below(double m, double s) {
    if (s >= m) {
        return 1.0 - poisson_below(m, s);
    }
    double sum = 0.0, term = poisson_pmf(m, s);
    for (double j = m; term > 0.0 && term > 1e-17 * sum; j += 1.0) {
        sum += term;
        term *= s / (j + 1.0);
    }
    return sum;
}

/* The density of the estimate at s = looks x estimate (OS), or looks x count x estimate (CA), times the
 * chance of exceeding factor x estimate. */
static double part(double s, void *user) {
    const window *w = user;
    if (w->kind == ASDIC_CFAR_CA) {
        double shape = w->count * w->looks;
        double estimate = s / shape;
        return poisson_pmf(shape - 1.0, s) *
               detection_exponential(w->factor * estimate, w->snr, w->looks, w->target);
    }
    double below = gamma_below(w->looks, s), above = poisson_below(w->looks, s);
    if (!(below > 0.0) || !(above > 0.0)) {
        return 0.0;
    }
    double order =
        exp(w->log_orders + (w->rank - 1.0) * log(below) + (w->count - w->rank) * log(above));
    return order * poisson_pmf(w->looks - 1.0, s) *
           detection_exponential(w->factor * s / w->looks, w->snr, w->looks, w->target);
}

/* In pieces, lest a narrow peak lies between the nodes of a wide one; ever shorter ones towards 0, where a
 * large factor leaves no chance farther off. */
static double average(window *w) {
    double shape = w->kind == ASDIC_CFAR_CA ? w->count * w->looks : w->looks;
    double end = shape + 12.0 * sqrt(shape) + 60.0, sum = 0.0, first = end / 32.0;
    double rate = w->kind == ASDIC_CFAR_CA ? w->factor / w->count : w->factor;
    for (; first * rate > 1000.0; first *= 0.5) {
        sum += asdic_quadrature(part, w, 0.5 * first, first, TOLERANCE);
    }
    sum += asdic_quadrature(part, w, 0.0, first, TOLERANCE);
    for (int i = 1; i < 32; i++) {
        sum += asdic_quadrature(part, w, end * i / 32.0, end * (i + 1) / 32.0, TOLERANCE);
    }
    return fmin(sum, 1.0);
}

static bool is_good(asdic_cfar_kind kind, unsigned count, unsigned rank, unsigned looks,
                    double factor) {
    return (unsigned)kind <= ASDIC_CFAR_OS && count >= 1 && count <= 2 * ASDIC_CFAR_MOST_CELLS &&
           looks >= 1 && looks <= 1000 && factor >= 0.0 &&
           (kind == ASDIC_CFAR_CA || (rank >= 1 && rank <= count));
}

static asdic_status check_kind(asdic_context *ctx, asdic_cfar_kind kind) {
    return (unsigned)kind <= ASDIC_CFAR_OS
               ? ASDIC_OK
               : asdic_fail(ctx, ASDIC_ERROR_ARGUMENT, "no CFAR of kind %d", (int)kind);
}

double asdic_cfar_pfa(asdic_cfar_kind kind, unsigned count, unsigned rank, unsigned looks,
                      double factor) {
    if (!is_good(kind, count, rank, looks, factor)) {
        return NAN;
    }
    if (isinf(factor)) { /* as of costs that nothing is worth */
        return 0.0;
    }
    if (kind == ASDIC_CFAR_CA) {
        double t = factor / (double)count, trials = (double)count * (double)looks;
        /* By itself the first term of many looks underflows. */
        double log_unit = -trials * log1p(t), term = 1.0, sum = 0.0;
        for (double j = 0.0; j < (double)looks; j += 1.0) {
            sum += term;
            term *= (trials + j) / (j + 1.0) * t / (1.0 + t);
            if (sum > MOST_SUM) {
                log_unit += log(MOST_SUM);
                term /= MOST_SUM;
                sum /= MOST_SUM;
            }
        }
        return fmin(exp(log_unit + log(sum)), 1.0);
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
    if (!is_good(kind, count, rank, looks, factor) || !asdic_target_is_known(target) ||
        !(snr >= 0.0)) {
        return NAN;
    }
    if (isinf(factor)) {
        return 0.0;
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
    if (!factor) {
        return asdic_fail_null(ctx, __func__);
    }
    TRY(check_kind(ctx, kind));
    if (!is_good(kind, count, rank, looks, 0.0) || !(pfa > 0.0 && pfa < 1.0)) {
        return asdic_fail(ctx, ASDIC_ERROR_ARGUMENT,
                          "CFAR over %u bins (1..%u), rank %u, %u looks (1..1000), P_FA %g (0..1)",
                          count, 2 * ASDIC_CFAR_MOST_CELLS, rank, looks, pfa);
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

/* Rank of COUNT bins. */
static unsigned rank_of(const asdic_cfar *cfar, unsigned count) {
    double rank = ceil(cfar->rank * (double)count - 1e-9);
    return rank < 1.0 ? 1 : (unsigned)rank;
}

/* The window's bins in ascending order, kept from bin to bin: a step adds and removes two. */
typedef struct ordered {
    double values[2 * ASDIC_CFAR_MOST_CELLS];
    unsigned count;
} ordered;

/* How many values are below VALUE. */
static unsigned place_of(const ordered *o, double value) {
    unsigned low = 0, high = o->count;
    while (low < high) {
        unsigned middle = (low + high) / 2;
        if (o->values[middle] < value) {
            low = middle + 1;
        } else {
            high = middle;
        }
    }
    return low;
}

/* Every APART-th bin of a row. */
typedef struct lane {
    const double *first;
    size_t count, apart;
} lane;

/* That which begins with bin FIRST. */
static lane lane_of(const asdic_cfar_bins *row, size_t first) {
    return (lane){row->intensity_lin + first, (row->count - first + row->apart - 1) / row->apart,
                  row->apart};
}

static double value_at(const lane *l, size_t at) {
    return l->first[at * l->apart];
}

/* Bins without energy do not count; nor do those before the first and after the last. */
static bool counts(const lane *l, size_t at) {
    return at < l->count && value_at(l, at) > 0.0;
}

static void add(ordered *o, const lane *l, size_t at) {
    if (counts(l, at)) {
        double value = value_at(l, at);
        unsigned place = place_of(o, value);
        memmove(o->values + place + 1, o->values + place, (o->count - place) * sizeof(double));
        o->values[place] = value;
        o->count++;
    }
}

static void take(ordered *o, const lane *l, size_t at) {
    if (counts(l, at)) {
        unsigned place = place_of(o, value_at(l, at));
        o->count--;
        memmove(o->values + place, o->values + place + 1, (o->count - place) * sizeof(double));
    }
}

/* From the window of bin AT - 1 to that of bin AT. An index before the first wraps round to one beyond the
 * last. */
static void step(ordered *o, const asdic_cfar *cfar, const lane *l, size_t at) {
    size_t guard = cfar->guard, cells = cfar->cells;
    take(o, l, at - 1 - guard - cells);
    take(o, l, at + guard);
    add(o, l, at - 1 - guard);
    add(o, l, at + guard + cells);
}

/* The mean of the window's bins round AT, and how many there are. */
static double mean_of(const asdic_cfar *cfar, const lane *l, size_t at, unsigned *count) {
    double sum = 0.0;
    *count = 0;
    for (size_t k = cfar->guard + 1; k <= cfar->guard + cfar->cells; k++) {
        if (counts(l, at - k)) {
            sum += value_at(l, at - k);
            ++*count;
        }
        if (counts(l, at + k)) {
            sum += value_at(l, at + k);
            ++*count;
        }
    }
    return sum / (double)*count;
}

static asdic_status find_scale(asdic_context *ctx, const asdic_cfar *cfar, unsigned looks,
                               double pfa, unsigned count, asdic_cfar_scale *out) {
    if (out->factor > 0.0) {
        return ASDIC_OK;
    }
    unsigned rank = rank_of(cfar, count);
    asdic_background unit = {.mean_lin = 1.0, .looks = looks, .shape = INFINITY};
    TRY(asdic_cfar_factor(ctx, cfar->kind, count, rank, looks, pfa, &out->factor));
    out->bias = 1.0;
    if (cfar->kind == ASDIC_CFAR_OS) { /* the quantile that it estimates */
        TRY(asdic_detect_threshold(ctx, &unit, 1.0 - rank / (count + 1.0), &out->bias));
    }
    return ASDIC_OK;
}

asdic_status asdic_cfar_check(asdic_context *ctx, const asdic_cfar *cfar) {
    TRY(check_kind(ctx, cfar->kind));
    if (cfar->cells < 1 || cfar->cells > ASDIC_CFAR_MOST_CELLS ||
        cfar->guard > ASDIC_SONAR_MAX_BINS || !(cfar->rank > 0.0 && cfar->rank <= 1.0)) {
        return asdic_fail(ctx, ASDIC_ERROR_ARGUMENT,
                          "CFAR of %u cells a side (1..%u), %u guards (0..%d), rank %g (0..1]",
                          cfar->cells, ASDIC_CFAR_MOST_CELLS, cfar->guard, ASDIC_SONAR_MAX_BINS,
                          cfar->rank);
    }
    return ASDIC_OK;
}

/* Estimate and threshold of the bins of lane L, which go to where these are in the row. */
static asdic_status scale_lane(asdic_context *ctx, const asdic_cfar *cfar, unsigned looks,
                               double pfa, const lane *l, double *background_lin,
                               double *threshold_lin, asdic_cfar_scale *scales) {
    bool orders = cfar->kind == ASDIC_CFAR_OS;
    ordered near = {.count = 0};
    for (size_t k = cfar->guard; orders && k < cfar->guard + cfar->cells; k++) {
        add(&near, l, k); /* of the bin before the first */
    }
    for (size_t i = 0; i < l->count; i++) {
        unsigned count = 0;
        double found = 0.0;
        if (orders) {
            step(&near, cfar, l, i);
            count = near.count;
            found = count ? near.values[rank_of(cfar, count) - 1] : 0.0;
        } else {
            found = mean_of(cfar, l, i, &count);
        }
        size_t at = i * l->apart;
        background_lin[at] = threshold_lin[at] = NAN;
        if (count > 0 && value_at(l, i) > 0.0) {
            TRY(find_scale(ctx, cfar, looks, pfa, count, &scales[count]));
            background_lin[at] = found / scales[count].bias;
            threshold_lin[at] = found * scales[count].factor;
        }
    }
    return ASDIC_OK;
}

asdic_status asdic_cfar_row_scaled(asdic_context *ctx, const asdic_cfar *cfar, unsigned looks,
                                   double pfa, const asdic_cfar_bins *row, double *background_lin,
                                   double *threshold_lin, asdic_cfar_scale *scales) {
    for (size_t first = 0; first < row->apart && first < row->count; first++) {
        lane l = lane_of(row, first);
        TRY(scale_lane(ctx, cfar, looks, pfa, &l, background_lin + first, threshold_lin + first,
                       scales));
    }
    return ASDIC_OK;
}

double asdic_cfar_rate(const asdic_cfar *cfar, unsigned looks, double factor,
                       const asdic_cfar_bins *row, size_t at, asdic_cfar_scale *scales) {
    unsigned count;
    lane l = lane_of(row, at % row->apart);
    mean_of(cfar, &l, at / row->apart, &count);
    asdic_cfar_scale *s = &scales[count];
    if (s->rate == 0.0) {
        s->rate = asdic_cfar_pfa(cfar->kind, count, rank_of(cfar, count), looks, factor / s->bias);
    }
    return s->rate;
}

asdic_status asdic_cfar_row(asdic_context *ctx, const asdic_cfar *cfar, unsigned looks, double pfa,
                            const double *intensity_lin, size_t bins, double *background_lin,
                            double *threshold_lin) {
    if (!cfar || !intensity_lin || !background_lin || !threshold_lin) {
        return asdic_fail_null(ctx, __func__);
    }
    asdic_cfar_scale scales[ASDIC_CFAR_SCALES] = {0};
    const asdic_cfar_bins row = {intensity_lin, bins, 1};
    TRY(asdic_cfar_check(ctx, cfar));
    return asdic_cfar_row_scaled(ctx, cfar, looks, pfa, &row, background_lin, threshold_lin,
                                 scales);
}
