#include "truth_shares.h"

#include "base/clear.h"
#include "base/vec.h"
#include "base/widest.h"

#include <float.h>
#include <math.h>

/* Bins of a beam whose shares are told together: they stay in the nearest cache. */
#define BLOCK 256

/* arcsin to 2e-8 (Abramowitz & Stegun, Handbook of Mathematical Functions (1964), 4.4.46), for vectors. */
static inline float arcsine(float x) {
    static const float a[8] = {1.5707963050f, -0.2145988016f, 0.0889789874f, -0.0501743046f,
                               0.0308918810f, -0.0170881256f, 0.0066700901f, -0.0012624911f};
    float y = fabsf(x) < 1.0f ? fabsf(x) : 1.0f, y2 = y * y; /* rounding may lead beyond 1 */
    float low = a[0] + a[1] * y + (a[2] + a[3] * y) * y2;
    float high = a[4] + a[5] * y + (a[6] + a[7] * y) * y2;
    float sum = low + high * (y2 * y2);
    float angle = (float)(0.5 * ASDIC_PI) - sqrtf(1.0f - y) * sum;
    return (x < 0.0f ? -1.0f : 1.0f) * angle; /* copysign keeps AVX-512's vectors out */
}

/* Of a block of bins: what makes energies shares, and shares. */
typedef struct block {
    double per_total[BLOCK];
    float bottom[BLOCK], surface[BLOCK], volume[BLOCK], object[BLOCK];
    float moment[BLOCK]; /* asdic_holdings' */
} block;

/* Shares of COUNT bins from FIRST on. */
WIDEST static void tell_shares(const asdic_holdings *h, size_t first, size_t count,
                               block *restrict k, float *restrict multiple, float *restrict noisy,
                               float *restrict strongest_object) {
    const double *restrict total = h->part[ASDIC_TOTAL] + first;
    const double *restrict bottom = h->part[ASDIC_BOTTOM] + first;
    const double *restrict surface = h->part[ASDIC_SURFACE] + first;
    const double *restrict volume = h->part[ASDIC_VOLUME] + first;
    const double *restrict object = h->part[ASDIC_OBJECT] + first;
    const double *restrict multipath = h->part[ASDIC_MULTIPATH] + first;
    const double *restrict noise = h->part[ASDIC_NOISE] + first;
    const double *restrict most = h->most + first, *restrict moment = h->moment + first;
    for (size_t n = 0; n < count; n++) {
        /* A sum, not a choice: compilers would choose again for every share. */
        double per_total = 1.0 / (total[n] + DBL_MIN);
        k->per_total[n] = per_total;
        k->bottom[n] = (float)(bottom[n] * per_total);
        k->surface[n] = (float)(surface[n] * per_total);
        k->volume[n] = (float)(volume[n] * per_total);
        k->object[n] = (float)(object[n] * per_total);
        k->moment[n] = (float)(moment[n] * per_total);
        multiple[n] = (float)(multipath[n] * per_total);
        noisy[n] = (float)(noise[n] * per_total);
        strongest_object[n] = (float)(most[n] * per_total);
    }
}

static inline void pick(float own, asdic_component component, float *best, int32_t *who) {
    *who = own > *best ? -(int32_t)component : *who;
    *best = own > *best ? own : *best;
}

/* Objects come first: of equal shares theirs is the strongest. */
WIDEST static void tell_strongest(const block *restrict k, const float *restrict multiple,
                                  const float *restrict noisy,
                                  const float *restrict strongest_object,
                                  const int16_t *restrict object, size_t count,
                                  int16_t *restrict strongest, float *restrict share) {
    for (size_t n = 0; n < count; n++) {
        float best = strongest_object[n];
        int32_t who = object[n];
        pick(k->bottom[n], ASDIC_BOTTOM, &best, &who);
        pick(k->surface[n], ASDIC_SURFACE, &best, &who);
        pick(k->volume[n], ASDIC_VOLUME, &best, &who);
        pick(multiple[n], ASDIC_MULTIPATH, &best, &who);
        pick(noisy[n], ASDIC_NOISE, &best, &who);
        strongest[n] = (int16_t)who;
        share[n] = best;
    }
}

/* What came directly, and from where the echo did. */
WIDEST static void tell_arrival(const block *restrict k, const float *restrict multiple,
                                size_t count, float *restrict direct, float *restrict depression) {
    for (size_t n = 0; n < count; n++) {
        float echo = k->bottom[n] + k->surface[n] + k->object[n];
        float all = (float)ASDIC_TRUTH_MIDDLE * (echo + multiple[n]);
        float sine = k->moment[n] / all - 1.0f;
        direct[n] = echo + k->volume[n];
        depression[n] = all > 0.0f ? arcsine(sine) : NAN;
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

/* The multipath of the bins from FIRST on, by what passed it on; in the truth they begin AT, where all of it is an
 * object's so far. */
static void tell_paths(const asdic_holdings *h, const block *k, size_t first, size_t count,
                       const asdic_ping_truth *truth, size_t at) {
    float *by_surface = truth->path[ASDIC_PATH_BY_SURFACE] + at;
    float *by_bottom = truth->path[ASDIC_PATH_BY_BOTTOM] + at;
    if (h->by_surface) {
        multiply(h->by_surface + first, k->per_total, count, by_surface);
        multiply(h->by_bottom + first, k->per_total, count, by_bottom);
        take_rest(h->part[ASDIC_MULTIPATH] + first, h->by_surface + first, h->by_bottom + first,
                  k->per_total, count, truth->path[ASDIC_PATH_BY_OBJECT] + at);
    } else {
        asdic_clear(by_surface, count * sizeof *by_surface);
        asdic_clear(by_bottom, count * sizeof *by_bottom);
    }
}

void asdic_truth_share(const asdic_holdings *h, size_t bins, const asdic_ping_truth *truth,
                       size_t first) {
    block k;
    for (size_t n = 0; n < bins; n += BLOCK) {
        size_t count = bins - n < BLOCK ? bins - n : BLOCK, at = first + n;
        float *multiple = truth->path[ASDIC_PATH_BY_OBJECT] + at;
        float *noisy = truth->path[ASDIC_PATH_NOISE] + at;
        tell_shares(h, n, count, &k, multiple, noisy, truth->object_share + at);
        tell_strongest(&k, multiple, noisy, truth->object_share + at, truth->object + at, count,
                       truth->strongest + at, truth->share + at);
        tell_arrival(&k, multiple, count, truth->path[ASDIC_PATH_DIRECT] + at,
                     truth->depression_rad + at);
        tell_paths(h, &k, n, count, truth, at);
    }
}
