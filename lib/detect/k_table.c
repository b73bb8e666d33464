#include "k_table.h"

#include "law.h"

#include "base/context.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>

/* The table spans ln(intensity / mean) to either side of 0, and ln(noise / clutter) from where noise makes no
 * difference to where clutter makes none. */
#define MOST_LN 7.0
#define LEAST_ODDS (-20.0)
#define MOST_ODDS 14.0
/* Nodes lie so far apart for one look. Laws of more looks change faster where noise prevails, of lower shapes where
 * clutter begins to. */
#define STEP 0.125
#define LOW_SHAPE 0.3
#define MOST_LOOKS 64u
#define LEAST_BINS ((size_t)1 << 15)
/* Nodes of a polynomial along either axis; so many of these lie before the place that is asked for. */
#define NODES 6
#define BEFORE 2

typedef enum quantity { TAIL, DENSITY } quantity;

struct asdic_k_table {
    asdic_background law; /* of unit mean; its noise share is that of a node */
    double step;
    size_t columns; /* along the intensity */
    double *ln[2];  /* by quantity, of nodes [row * columns + column]; 0: not computed yet */
};

static size_t nodes_over(double span, double step) {
    return (size_t)ceil(span / step) + NODES;
}

asdic_status asdic_k_table_fit(asdic_context *ctx, const asdic_background *law, size_t bins,
                               asdic_k_table **table) {
    asdic_k_table *t = *table;
    if (t && t->law.looks == law->looks && t->law.shape == law->shape) {
        return ASDIC_OK;
    }
    asdic_k_table_destroy(table);
    if (law->shape > ASDIC_SHAPE_MAX || law->looks > MOST_LOOKS || bins < LEAST_BINS) {
        return ASDIC_OK;
    }
    double step = STEP * sqrt(fmin(law->shape / LOW_SHAPE, 1.0) / sqrt((double)law->looks));
    size_t rows = nodes_over(MOST_ODDS - LEAST_ODDS, step),
           columns = nodes_over(2.0 * MOST_LN, step);
    t = malloc(sizeof *t);
    double *ln = calloc(2 * rows * columns, sizeof *ln);
    if (!t || !ln) {
        free(t);
        free(ln);
        return asdic_fail_memory(ctx, "a table of K speckle");
    }
    *t = (asdic_k_table){
        .law = *law, .step = step, .columns = columns, .ln = {ln, ln + rows * columns}};
    t->law.mean_lin = 1.0;
    *table = t;
    return ASDIC_OK;
}

void asdic_k_table_destroy(asdic_k_table **table) {
    if (table && *table) {
        free((*table)->ln[TAIL]);
        free(*table);
        *table = NULL;
    }
}

static double node(asdic_k_table *t, quantity what, size_t row, size_t column) {
    double *ln = &t->ln[what][row * t->columns + column];
    if (*ln == 0.0) {
        asdic_background b = t->law;
        double odds = LEAST_ODDS + t->step * ((double)row - BEFORE);
        double intensity = exp(-MOST_LN + t->step * ((double)column - BEFORE));
        b.noise_share = 1.0 / (1.0 + exp(-odds));
        *ln = what == TAIL ? fmin(log(asdic_detect_pfa(&b, intensity)), -DBL_MIN)
                           : asdic_detect_log_density(&b, intensity);
    }
    return *ln;
}

/* The first of the NODES round AT, which is in steps from the table's edge, and Lagrange's polynomials there. */
static size_t weigh(double at, double *weight) {
    static const double over[NODES] = {-1.0 / 120.0, 1.0 / 24.0,  -1.0 / 12.0,
                                       1.0 / 12.0,   -1.0 / 24.0, 1.0 / 120.0};
    double first = floor(at), x = at - first + BEFORE;
    for (int i = 0; i < NODES; i++) {
        weight[i] = over[i];
        for (int k = 0; k < NODES; k++) {
            weight[i] *= k == i ? 1.0 : x - k;
        }
    }
    return (size_t)first;
}

/* ln of WHAT at an INTENSITY re the mean. False outside the table, and where that is too little for a number. */
static bool look_up(asdic_k_table *t, quantity what, double intensity, double noise_share,
                    double *ln) {
    double at = log(intensity);
    if (!t || !(fabs(at) < MOST_LN)) {
        return false;
    }
    double odds = fmin(fmax(log(noise_share / (1.0 - noise_share)), LEAST_ODDS), MOST_ODDS);
    double across[NODES], along[NODES], sum = 0.0;
    size_t row = weigh((odds - LEAST_ODDS) / t->step, across);
    size_t column = weigh((at + MOST_LN) / t->step, along);
    for (size_t i = 0; i < NODES; i++) {
        for (size_t k = 0; k < NODES; k++) {
            sum += across[i] * along[k] * node(t, what, row + i, column + k);
        }
    }
    *ln = sum;
    return isfinite(sum);
}

double asdic_k_table_pd(asdic_k_table *t, const asdic_background *b, double target_lin,
                        double threshold_lin) {
    asdic_background both = asdic_background_with(b, target_lin);
    double ln;
    return look_up(t, TAIL, threshold_lin / both.mean_lin, both.noise_share, &ln)
               ? fmin(exp(ln), 1.0)
               : asdic_detect_pd(b, ASDIC_TARGET_SWERLING2, target_lin, threshold_lin);
}

/* asdic_k_table_ratio to LN; whether it is in the table. */
static bool look_up_ratio(asdic_k_table *t, const asdic_background *a, const asdic_background *b,
                          double intensity_lin, double *ln) {
    double own, other;
    bool is_tabled = look_up(t, DENSITY, intensity_lin / b->mean_lin, b->noise_share, &other) &&
                     look_up(t, DENSITY, intensity_lin / a->mean_lin, a->noise_share, &own);
    *ln = is_tabled ? own - other - (double)b->looks * log(a->mean_lin / b->mean_lin) : (double)NAN;
    return is_tabled;
}

double asdic_k_table_llr(asdic_k_table *t, const asdic_background *b, double target_lin,
                         double intensity_lin) {
    asdic_background both = asdic_background_with(b, target_lin);
    double ln;
    return look_up_ratio(t, &both, b, intensity_lin, &ln)
               ? ln
               : asdic_detect_llr(b, ASDIC_TARGET_SWERLING2, target_lin, intensity_lin);
}

double asdic_k_table_ratio(asdic_k_table *t, const asdic_background *a, const asdic_background *b,
                           double intensity_lin) {
    double looks = (double)b->looks, ln;
    if (b->shape > ASDIC_SHAPE_MAX) {
        return looks * (log(b->mean_lin / a->mean_lin) +
                        intensity_lin * (1.0 / b->mean_lin - 1.0 / a->mean_lin));
    }
    return look_up_ratio(t, a, b, intensity_lin, &ln)
               ? ln
               : asdic_detect_log_density(a, intensity_lin) -
                     asdic_detect_log_density(b, intensity_lin) -
                     looks * log(a->mean_lin / b->mean_lin);
}
