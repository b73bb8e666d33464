#include "texture.h"

#include <math.h>
#include <stdlib.h>

/* The table's steps in ln of the exponential variate, and where it ends. Below, the texture is a
 * power. */
#define STEPS_PER_UNIT 64
#define LOWEST (-32)
#define HIGHEST 4
#define STEPS ((HIGHEST - LOWEST) * STEPS_PER_UNIT)

/* ln(-ln Q(a, x)) and its derivative by ln x, Q the regularised upper incomplete gamma function:
 * by the series of P = 1 - Q and by Lentz's continued fraction (Abramowitz & Stegun 6.5.29,
 * 6.5.31). */
static double log_exponent(double a, double log_x, double *slope) {
    int sign;
    double x = exp(log_x);
    double log_density = a * log_x - x - lgamma_r(a, &sign); /* of ln x */
    if (x < a + 1.0) {
        double sum = 1.0 / a, term = sum;
        for (double k = a + 1.0; term > 1e-16 * sum; k += 1.0) {
            term *= x / k;
            sum += term;
        }
        double p = sum * exp(log_density), exponent = -log1p(-p);
        *slope = p < 1e-8 ? 1.0 / sum : exp(log_density) / ((1.0 - p) * exponent);
        return p < 1e-8 ? log_density + log(sum) : log(exponent);
    }
    double b = x + 1.0 - a, c = 1e300, d = 1.0 / b, h = d, change = 0.0;
    for (double k = 1.0; fabs(change - 1.0) > 1e-15; k += 1.0) {
        double numerator = k * (a - k);
        b += 2.0;
        d = 1.0 / (b + numerator * d);
        c = b + numerator / c;
        change = c * d;
        h *= change;
    }
    double exponent = -(log_density + log(h));
    *slope = 1.0 / (h * exponent);
    return log(exponent);
}

bool asdic_texture_init(asdic_texture *t, double shape) {
    int sign;
    t->log_texture = malloc((STEPS + 1) * sizeof *t->log_texture);
    if (!t->log_texture) {
        return false;
    }
    double log_x = (LOWEST + lgamma_r(shape + 1.0, &sign)) / shape;
    for (int k = 0; k <= STEPS; k++) {
        double wanted = LOWEST + (double)k / STEPS_PER_UNIT, off = 1.0, slope;
        /* The function is concave: from below, Newton's steps do not pass the root. */
        for (int i = 0; i < 50 && fabs(off) > 1e-12; i++) {
            off = wanted - log_exponent(shape, log_x, &slope);
            log_x += off / slope;
        }
        t->log_texture[k] = log_x - log(shape);
    }
    return true;
}

void asdic_texture_finish(asdic_texture *t) {
    free(t->log_texture);
    t->log_texture = NULL;
}

double asdic_texture_of(const asdic_texture *t, double exponential) {
    double at = (log(fmax(exponential, 1e-300)) - LOWEST) * STEPS_PER_UNIT;
    int k = (int)fmin(fmax(floor(at), 0.0), STEPS - 1);
    double low = t->log_texture[k], high = t->log_texture[k + 1];
    return exp(low + (at - k) * (high - low));
}
