#include "variates.h"

#include "base/vec.h"

#include "../../kernels/random.h"

#include <math.h>

/* Whole shapes up to here are sums of exponentials: one logarithm of a product. */
#define MOST_FACTORS 16.0

asdic_variates asdic_variates_begin(uint32_t purpose, uint64_t seed, uint64_t index,
                                    uint32_t cell) {
    return (asdic_variates){.purpose = purpose,
                            .seed = {(uint32_t)seed, (uint32_t)(seed >> 32)},
                            .index = {(uint32_t)index, (uint32_t)(index >> 32)},
                            .cell = cell,
                            .spare = -1.0};
}

static double to_unit(uint32_t high, uint32_t low) {
    return ((double)high + ((double)low + 0.5) * 0x1p-32) * 0x1p-32;
}

double asdic_variates_uniform(asdic_variates *v) {
    if (v->spare >= 0.0) {
        double out = v->spare;
        v->spare = -1.0;
        return out;
    }
    random4 r = random_draw(v->cell, v->index[0], v->index[1], v->purpose + (v->next++ << 4),
                            v->seed[0], v->seed[1]);
    v->spare = to_unit(r.v[2], r.v[3]);
    return to_unit(r.v[0], r.v[1]);
}

void asdic_variates_skip(asdic_variates *v) {
    v->next++;
}

double asdic_variates_exponential(asdic_variates *v) {
    return -log(asdic_variates_uniform(v));
}

void asdic_variates_normal(asdic_variates *v, double out[2]) {
    double radius = sqrt(2.0 * asdic_variates_exponential(v));
    double angle = 2.0 * ASDIC_PI * asdic_variates_uniform(v);
    out[0] = radius * cos(angle);
    out[1] = radius * sin(angle);
}

/* Marsaglia & Tsang, ACM TOMS 26, 363 (2000), SHAPE >= 1. */
static double gamma_by_rejection(asdic_variates *v, double shape) {
    double d = shape - 1.0 / 3.0, c = 1.0 / sqrt(9.0 * d);
    for (;;) {
        double x[2];
        asdic_variates_normal(v, x);
        double t = 1.0 + c * x[0];
        if (t <= 0.0) {
            continue;
        }
        t = t * t * t;
        if (log(asdic_variates_uniform(v)) < 0.5 * x[0] * x[0] + d - d * t + d * log(t)) {
            return d * t;
        }
    }
}

double asdic_variates_gamma(asdic_variates *v, double shape) {
    if (shape == floor(shape) && shape <= MOST_FACTORS) {
        double product = 1.0; /* of 16 factors above 2^-65: never 0 */
        for (double i = 0.0; i < shape; i += 1.0) {
            product *= asdic_variates_uniform(v);
        }
        return -log(product);
    }
    if (shape < 1.0) {
        double boost = pow(asdic_variates_uniform(v), 1.0 / shape);
        return gamma_by_rejection(v, shape + 1.0) * boost;
    }
    return gamma_by_rejection(v, shape);
}
