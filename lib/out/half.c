#include "half.h"

#include "base/widest.h"

#include <string.h>

/* The bits of float32 and of binary16: 8 and 5 of exponent, biased by 127 and 15, 23 and 10 of fraction. */
#define FRACTION (23 - 10)
#define BIAS ((uint32_t)(127 - 15) << 23)
#define LEAST_NORMAL 0x38800000u /* 2^-14 */
#define OVERFLOW 0x477ff000u     /* 65520 rounds to the number after the largest, 65504 */
#define INFINITE 0x7f800000u
#define ONE_HALF 0x3f000000u

/* What is rounded up to the next power of 2 carries into the exponent, as it should. Numbers below the least
 * normal one are rounded by adding 0.5, whose last place is a step of theirs, 2^-24. */
WIDEST static void round_all(const float *restrict values, size_t count,
                             uint16_t *restrict halves) {
    for (size_t i = 0; i < count; i++) {
        uint32_t bits, small;
        memcpy(&bits, &values[i], sizeof bits);
        uint32_t size = bits & 0x7fffffffu, sign = bits >> 16 & 0x8000u;
        float size_value, shifted;
        memcpy(&size_value, &size, sizeof size_value);
        shifted = size_value + 0.5f;
        memcpy(&small, &shifted, sizeof small);
        uint32_t normal = (size - BIAS + 0xfffu + (size >> FRACTION & 1u)) >> FRACTION;
        uint32_t half = size < LEAST_NORMAL ? small - ONE_HALF : normal;
        half = size >= OVERFLOW ? 0x7c00u : half;
        halves[i] = (uint16_t)(size > INFINITE ? 0x7e00u : sign | half);
    }
}

/* Those below the least normal one: of 2^-14 (1 + fraction) 2^-14 is taken away. */
WIDEST static void widen_all(const uint16_t *restrict halves, size_t count,
                             float *restrict values) {
    for (size_t i = 0; i < count; i++) {
        uint32_t half = halves[i], size = half & 0x7fffu, sign = (half & 0x8000u) << 16;
        uint32_t shifted = (size << FRACTION) + LEAST_NORMAL, small;
        float value;
        memcpy(&value, &shifted, sizeof value);
        value -= 0x1p-14f;
        memcpy(&small, &value, sizeof small);
        uint32_t bits = size < 0x400u ? small : (size << FRACTION) + BIAS;
        bits = size >= 0x7c00u ? INFINITE : bits;
        bits = size > 0x7c00u ? 0x7fc00000u : bits;
        bits |= sign;
        memcpy(&values[i], &bits, sizeof bits);
    }
}

void asdic_halves_of(const float *values, size_t count, uint16_t *halves) {
    round_all(values, count, halves);
}

void asdic_half_values(const uint16_t *halves, size_t count, float *values) {
    widen_all(halves, count, values);
}
