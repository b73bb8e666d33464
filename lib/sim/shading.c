/*
 * Shading: weights of the elements of a line array.
 */
#include <asdic/sonar.h>

#include "base/vec.h"

#include <math.h>

/* Chebyshev's polynomial of the first kind, also beyond 1. */
static double chebyshev(double order, double x) {
    double a = fabs(x), sign = x < 0.0 && fmod(order, 2.0) != 0.0 ? -1.0 : 1.0;
    return sign * (a <= 1.0 ? cos(order * acos(a)) : cosh(order * acosh(a)));
}

/* The far field of N elements is T_(N-1)(x0 cos(psi / 2)), psi the phase from one to the next; its samples at
 * N phases give the weights (C. L. Dolph, Proc. IRE 34, 335 (1946)). */
static double dolph(size_t count, double ratio, size_t at) {
    double order = (double)count - 1.0, x0 = cosh(acosh(ratio) / order);
    double place = (double)at - 0.5 * order, sum = 0.0;
    for (size_t k = 0; k < count; k++) {
        double half = ASDIC_PI * (double)k / (double)count;
        sum += chebyshev(order, x0 * cos(half)) * cos(2.0 * half * place);
    }
    return sum;
}

/* Side lobes stay level for as long as the main lobe then is narrowest without the weights rising towards the
 * ends: n-bar, of T. T. Taylor, IRE Trans. AP-3, 16 (1955). */
static int level_lobes(double a) {
    return (int)fmax(ceil(2.0 * a * a + 0.5), 2.0);
}

/* Taylor's coefficient F_m: the pattern at its m-th sample. */
static double taylor_sample(int m, int level, double a) {
    double spread = (double)level * (double)level / (a * a + (level - 0.5) * (level - 0.5));
    double above = 1.0, below = 1.0;
    for (int i = 1; i < level; i++) {
        above *= 1.0 - (double)m * m / (spread * (a * a + (i - 0.5) * (i - 0.5)));
        below *= i == m ? 1.0 : 1.0 - (double)m * m / ((double)i * i);
    }
    return (m % 2 ? 0.5 : -0.5) * above / below;
}

static double taylor(size_t count, double ratio, size_t at) {
    double a = acosh(ratio) / ASDIC_PI;
    int level = level_lobes(a);
    double place = ((double)at + 0.5) / (double)count - 0.5, weight = 1.0;
    for (int m = 1; m < level; m++) {
        weight += 2.0 * taylor_sample(m, level, a) * cos(2.0 * ASDIC_PI * m * place);
    }
    return weight;
}

void asdic_array_weights(const asdic_array *array, double *weights) {
    size_t count = array->elements;
    double ratio = pow(10.0, -array->side_lobe_db / 20.0), sum = 0.0;
    for (size_t e = 0; e < count; e++) {
        double turn = 2.0 * ASDIC_PI * ((double)e + 0.5) / (double)count;
        weights[e] = array->shading == ASDIC_SHADING_HANN        ? 0.5 - 0.5 * cos(turn)
                     : array->shading == ASDIC_SHADING_TAYLOR    ? taylor(count, ratio, e)
                     : array->shading == ASDIC_SHADING_CHEBYSHEV ? dolph(count, ratio, e)
                                                                 : 1.0;
        sum += weights[e];
    }
    for (size_t e = 0; e < count; e++) {
        weights[e] /= sum;
    }
}
