#include "digits.h"

#include <locale.h>
#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#pragma GCC diagnostic ignored "-Wformat-nonliteral"

/* Switches this thread to the C locale; LC_NUMERIC of the process would print decimal commas. */
size_t asdic_digits_print(char text[ASDIC_DIGITS_SIZE], const char *format, double value) {
    locale_t c = newlocale(LC_ALL_MASK, "C", (locale_t)0);
    locale_t before = uselocale(c);
    int length = snprintf(text, ASDIC_DIGITS_SIZE, format, value);
    uselocale(before);
    freelocale(c);
    if (length < 0) {
        text[0] = 0;
        return 0;
    }
    return length < ASDIC_DIGITS_SIZE ? (size_t)length : ASDIC_DIGITS_SIZE - 1;
}

static double read_back(const char *text) {
    locale_t c = newlocale(LC_ALL_MASK, "C", (locale_t)0);
    double value = strtod_l(text, NULL, c);
    freelocale(c);
    return value;
}

size_t asdic_digits_double(char text[ASDIC_DIGITS_SIZE], double value) {
    static const char *const formats[] = {"%.15g", "%.16g", "%.17g"};
    text[0] = 0;
    if (!isfinite(value)) {
        return 0;
    }
    size_t length = 0;
    for (int i = 0; i < 3; i++) {
        length = asdic_digits_print(text, formats[i], value);
        if (read_back(text) == value) {
            break;
        }
    }
    return length;
}

size_t asdic_digits_natural(char text[ASDIC_DIGITS_SIZE], uint64_t value) {
    char digits[20];
    size_t count = 0;
    do {
        digits[count++] = (char)('0' + value % 10);
        value /= 10;
    } while (value);
    for (size_t i = 0; i < count; i++) {
        text[i] = digits[count - 1 - i];
    }
    text[count] = 0;
    return count;
}

/* 10^0 .. 10^12, all exact in double. */
static const double powers[] = {1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11, 1e12};

/* Writes DIGITS = value * 10^SHIFT, nine significant digits, without trailing zeros. */
static size_t place_point(char *text, uint64_t digits, int shift) {
    while (shift > 0 && digits % 10 == 0) {
        digits /= 10;
        shift--;
    }
    size_t length = 0;
    uint64_t scale = (uint64_t)powers[shift];
    length += asdic_digits_natural(text, digits / scale);
    if (shift > 0) {
        text[length++] = '.';
        uint64_t fraction = digits % scale;
        for (int i = shift - 1; i >= 0; i--) {
            text[length + (size_t)i] = (char)('0' + fraction % 10);
            fraction /= 10;
        }
        length += (size_t)shift;
    }
    text[length] = 0;
    return length;
}

/* Levels are 1e-4 .. 1e9 in magnitude but for rare exceptions. There a float (24 bits) times the
 * power of ten that leaves nine digits before the point (at most 10^12 = 5^12 2^12, 28 bits) is
 * exact in double, so that rounding it once gives printf's digits at a tenth of its cost. */
size_t asdic_digits_float(char text[ASDIC_DIGITS_SIZE], float value) {
    double magnitude = fabs((double)value);
    text[0] = 0;
    if (!isfinite(value)) {
        return 0;
    }
    if (value == 0.0f && !signbit(value)) {
        text[0] = '0';
        text[1] = 0;
        return 1;
    }
    if (magnitude < 1e-4 || magnitude >= 1e8) {
        return asdic_digits_print(text, "%.9g", value);
    }
    int shift = 8;
    while (shift > 0 && magnitude >= powers[9 - shift]) {
        shift--;
    }
    while (shift < 12 && magnitude * powers[shift] < 1e8) {
        shift++;
    }
    uint64_t digits = (uint64_t)llrint(magnitude * powers[shift]);
    size_t sign = value < 0.0f;
    text[0] = '-';
    return sign + place_point(text + sign, digits, shift);
}
