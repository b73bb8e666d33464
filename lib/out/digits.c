#include "digits.h"

#include <locale.h>
#include <math.h>
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

size_t asdic_digits_time(char text[ASDIC_DIGITS_SIZE], double time_s) {
    return asdic_digits_print(text, "%.13g", 1e-3 * rint(1e3 * time_s));
}

/* 10^0 .. 10^12, all exact in double. */
static const double powers[] = {1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11, 1e12};

/* "00", "01", ... "99" */
static void put_pair(char *text, uint32_t value) {
    static const char pairs[] = "00010203040506070809101112131415161718192021222324"
                                "25262728293031323334353637383940414243444546474849"
                                "50515253545556575859606162636465666768697071727374"
                                "75767778798081828384858687888990919293949596979899";
    memcpy(text, pairs + 2 * value, 2);
}

#define NINE 9 /* digits that identify a float */

/* Writes DIGITS = value * 10^SHIFT, which has NINE digits, without trailing zeros. */
static size_t place_point(char *text, uint32_t digits, int shift) {
    char all[NINE];
    uint32_t high = digits / 10000, low = digits % 10000; /* five and four */
    all[0] = (char)('0' + high / 10000);
    put_pair(all + 1, high / 100 % 100);
    put_pair(all + 3, high % 100);
    put_pair(all + 5, low / 100);
    put_pair(all + 7, low % 100);
    size_t length = 0;
    int whole = NINE - shift, end = NINE; /* digits before the point, and in all */
    while (end > whole && end > 1 && all[end - 1] == '0') {
        end--;
    }
    if (whole > 0) {
        memcpy(text, all, (size_t)whole);
        length = (size_t)whole;
    } else {
        text[length++] = '0';
    }
    if (end > whole) {
        text[length++] = '.';
        for (int zeros = whole; zeros < 0; zeros++) {
            text[length++] = '0';
        }
        int first = whole > 0 ? whole : 0;
        memcpy(text + length, all + first, (size_t)(end - first));
        length += (size_t)(end - first);
    }
    text[length] = 0;
    return length;
}

/* Almost all levels are 1e-4 .. 1e9 in magnitude. There a float (24 bits) times the power of ten
 * that leaves nine digits before the point (at most 10^12 = 5^12 2^12, 28 bits) is exact in double:
 * rounding it once gives printf's digits at a tenth of the cost. */
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
    uint32_t digits = (uint32_t)lrint(magnitude * powers[shift]);
    if (digits >= 1000000000u) { /* rounded up to a tenth digit */
        return asdic_digits_print(text, "%.9g", value);
    }
    size_t sign = value < 0.0f;
    text[0] = '-';
    return sign + place_point(text + sign, digits, shift);
}

void asdic_digits_grouped(char text[ASDIC_DIGITS_SIZE], uint64_t value) {
    char digits[ASDIC_DIGITS_SIZE];
    size_t length = asdic_digits_natural(digits, value), n = 0;
    for (size_t i = 0; i < length; i++) {
        text[n++] = digits[i];
        if (i + 1 < length && (length - i - 1) % 3 == 0) {
            text[n++] = ',';
        }
    }
    text[n] = 0;
}
