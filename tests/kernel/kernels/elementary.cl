/* From the folder of this file, whatever folder the test runs in. */
#include <../../../kernels/real.h>
#define ASDIC_BENT 1
#include <../../../kernels/ray.h>

/* OUT[i] = function WHICH of X[i], Y[i]: as listed in test_elementary.c. */
kernel void evaluate(global const float *xs, global const float *ys, global float *out,
                     const uint which) {
    const size_t first = get_global_id(0) * ASDIC_WIDTH;
    real x, y, v = R(0.0);
    for (uint lane = 0; lane < ASDIC_WIDTH; lane++) {
        ((float *)&x)[lane] = xs[first + lane];
        ((float *)&y)[lane] = ys[first + lane];
    }
    switch (which) {
    case 0:
        v = sin(x);
        break;
    case 1:
        v = cos(x);
        break;
    case 2:
        v = r_sinpi(x);
        break;
    case 3:
        v = atan2(y, x);
        break;
    case 4:
        v = asin(x);
        break;
    case 5:
        v = acos(x);
        break;
    case 6:
        v = exp(x);
        break;
    case 7:
        v = expm1(x);
        break;
    case 8:
        v = exp2(x);
        break;
    case 9:
        v = r_exp10(x);
        break;
    case 10:
        v = log(x);
        break;
    case 11:
        v = log10(x);
        break;
    case 12:
        v = cbrt(x);
        break;
    case 13:
        v = x / y;
        break;
    case 14:
        v = sqrt(x);
        break;
    case 15:
        v = r_fma(x, y, x);
        break;
    case 16:
        v = bent_atanh(x);
        break;
    case 17:
        v = bent_tanh(x);
        break;
    case 18:
        v = bent_sinh(x);
        break;
    case 19:
        v = bent_cosh(x);
        break;
    }
    for (uint lane = 0; lane < ASDIC_WIDTH; lane++) {
        out[first + lane] = ((float *)&v)[lane];
    }
}
