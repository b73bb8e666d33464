#include "truth_shares.h"

#include "base/vec.h"
#include "base/widest.h"

#include <float.h>
#include <math.h>
#include <string.h>

/* Bins of a beam whose shares are told together: they stay in the nearest cache. */
#define BLOCK 256

/* arcsin to 2e-8 (Abramowitz & Stegun, Handbook of Mathematical Functions (1964), 4.4.46), for vectors. */
static inline float arcsine(float x) {
    static const float a[8] = {1.5707963050f, -0.2145988016f, 0.0889789874f, -0.0501743046f,
                               0.0308918810f, -0.0170881256f, 0.0066700901f, -0.0012624911f};
    float y = fabsf(x), sum = a[7];
    for (int k = 6; k >= 0; k--) {
        sum = sum * y + a[k];
    }
    float angle = (float)(0.5 * ASDIC_PI) - sqrtf(1.0f - y) * sum;
    return x < 0.0f ? -angle : angle; /* copysign keeps AVX-512's vectors out */
}

/* DEPRESSION from the energy-weighted MOMENT of (1 + sine) / 2 in the ECHO. */
WIDEST static void tell_depression(const double *restrict moment, const double *restrict echo,
                                   const double *restrict per_total, size_t bins,
                                   float *restrict depression) {
    for (size_t n = 0; n < bins; n++) {
        /* Shares, for floats: their quotients are quicker. */
        float all = (float)(ASDIC_TRUTH_MIDDLE * per_total[n] * echo[n]);
        float sine = (float)(moment[n] * per_total[n]) / (all > FLT_MIN ? all : FLT_MIN) - 1.0f;
        sine = sine > 1.0f ? 1.0f : sine;
        sine = sine < -1.0f ? -1.0f : sine;
        depression[n] = echo[n] > 0.0 ? arcsine(sine) : NAN;
    }
}

/* Of a block of bins. Arrays of one width: what loops are vectors of. */
typedef struct block {
    double echo[BLOCK], per_total[BLOCK]; /* all but water and noise; what makes energies shares */
    float share[4][BLOCK];                /* of components in the order of `compared`, but noise */
} block;

static const asdic_component compared[] = {ASDIC_BOTTOM, ASDIC_SURFACE, ASDIC_VOLUME,
                                           ASDIC_MULTIPATH, ASDIC_NOISE};

/* Shares of COUNT bins from FIRST on. */
WIDEST static void tell_shares(const asdic_holdings *h, size_t first, size_t count,
                               block *restrict k, float *restrict direct, float *restrict noisy,
                               float *restrict of_object) {
    const double *restrict bottom = h->part[ASDIC_BOTTOM] + first;
    const double *restrict surface = h->part[ASDIC_SURFACE] + first;
    const double *restrict volume = h->part[ASDIC_VOLUME] + first;
    const double *restrict object = h->part[ASDIC_OBJECT] + first;
    const double *restrict multipath = h->part[ASDIC_MULTIPATH] + first;
    const double *restrict noise = h->part[ASDIC_NOISE] + first;
    const double *restrict most = h->most + first;
    for (size_t n = 0; n < count; n++) {
        double echo = bottom[n] + surface[n] + object[n];
        double once = echo + volume[n];
        double total = once + multipath[n] + noise[n];
        double per_total = 1.0 / (total > 0.0 ? total : 1.0);
        k->echo[n] = echo + multipath[n];
        k->per_total[n] = per_total;
        k->share[0][n] = (float)(bottom[n] * per_total);
        k->share[1][n] = (float)(surface[n] * per_total);
        k->share[2][n] = (float)(volume[n] * per_total);
        k->share[3][n] = (float)(multipath[n] * per_total);
        direct[n] = (float)(once * per_total);
        noisy[n] = (float)(noise[n] * per_total);
        of_object[n] = (float)(most[n] * per_total);
    }
}

/* Objects come first: of equal shares theirs is the strongest. */
WIDEST static void tell_strongest(const block *restrict k, const float *restrict of_object,
                                  const float *restrict noisy, const int16_t *restrict object,
                                  size_t count, int16_t *restrict strongest,
                                  float *restrict share) {
    for (size_t n = 0; n < count; n++) {
        float best = of_object[n];
        int32_t who = object[n];
        for (int c = 0; c < 5; c++) {
            float own = c < 4 ? k->share[c][n] : noisy[n];
            who = own > best ? -(int32_t)compared[c] : who;
            best = own > best ? own : best;
        }
        strongest[n] = (int16_t)who;
        share[n] = best;
    }
}

WIDEST static void multiply(const double *restrict a, const double *restrict b, size_t count,
                            float *restrict product) {
    for (size_t n = 0; n < count; n++) {
        product[n] = (float)(a[n] * b[n]);
    }
}

/* The share of ALL that neither surface nor bottom passed on. */
WIDEST static void take_rest(const double *restrict all, const double *restrict by_surface,
                             const double *restrict by_bottom, const double *restrict per_total,
                             size_t count, float *restrict share) {
    for (size_t n = 0; n < count; n++) {
        double rest = all[n] - by_surface[n] - by_bottom[n];
        share[n] = (float)((rest > 0.0 ? rest : 0.0) * per_total[n]);
    }
}

/* The multipath of the bins from FIRST on, by what passed it on; in the truth they begin AT. */
static void tell_paths(const asdic_holdings *h, const block *k, size_t first, size_t count,
                       const asdic_ping_truth *truth, size_t at) {
    float *const *path = truth->path;
    if (h->by_surface) {
        multiply(h->by_surface + first, k->per_total, count, path[ASDIC_PATH_BY_SURFACE] + at);
        multiply(h->by_bottom + first, k->per_total, count, path[ASDIC_PATH_BY_BOTTOM] + at);
        take_rest(h->part[ASDIC_MULTIPATH] + first, h->by_surface + first, h->by_bottom + first,
                  k->per_total, count, path[ASDIC_PATH_BY_OBJECT] + at);
        return;
    }
    memset(path[ASDIC_PATH_BY_SURFACE] + at, 0, count * sizeof(float));
    memset(path[ASDIC_PATH_BY_BOTTOM] + at, 0, count * sizeof(float));
    memcpy(path[ASDIC_PATH_BY_OBJECT] + at, k->share[3], count * sizeof(float));
}

void asdic_truth_share(const asdic_holdings *h, size_t bins, const asdic_ping_truth *truth,
                       size_t first) {
    block k;
    for (size_t n = 0; n < bins; n += BLOCK) {
        size_t count = bins - n < BLOCK ? bins - n : BLOCK, at = first + n;
        tell_shares(h, n, count, &k, truth->path[ASDIC_PATH_DIRECT] + at,
                    truth->path[ASDIC_PATH_NOISE] + at, truth->object_share + at);
        tell_strongest(&k, truth->object_share + at, truth->path[ASDIC_PATH_NOISE] + at,
                       truth->object + at, count, truth->strongest + at, truth->share + at);
        tell_paths(h, &k, n, count, truth, at);
        tell_depression(h->moment + n, k.echo, k.per_total, count, truth->depression_rad + at);
    }
}
