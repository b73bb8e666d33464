#include "half.h"

#include <math.h>

#define LEAST_NORMAL 0x1p-14f
#define LEAST_STEP 0x1p-24f
#define OVERFLOW 65520.0f /* rounds to the number after the largest, 65504 */

/* A significand that rounds up to 2 carries into the exponent, as it should. */
uint16_t asdic_half_of(float value) {
    uint16_t sign = signbit(value) ? 0x8000 : 0;
    float size = fabsf(value);
    int exponent;
    if (isnan(value)) {
        return 0x7e00;
    }
    if (size >= OVERFLOW) {
        return sign | 0x7c00;
    }
    if (size < LEAST_NORMAL) {
        return (uint16_t)(sign | lrintf(size / LEAST_STEP));
    }
    float significand = 2.0f * frexpf(size, &exponent); /* 1..2 */
    return (uint16_t)(sign | (((exponent + 14) << 10) + lrintf(1024.0f * (significand - 1.0f))));
}

float asdic_half_value(uint16_t half) {
    int exponent = half >> 10 & 31, fraction = half & 1023;
    float size = exponent == 31  ? (fraction ? NAN : INFINITY)
                 : exponent == 0 ? (float)fraction * LEAST_STEP
                                 : ldexpf((float)(1024 + fraction), exponent - 25);
    return half & 0x8000 ? -size : size;
}
