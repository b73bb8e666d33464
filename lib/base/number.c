#include "number.h"

#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

static size_t count_digits(const char *text, size_t length, size_t at) {
    size_t n = 0;
    while (at + n < length && text[at + n] >= '0' && text[at + n] <= '9') {
        n++;
    }
    return n;
}

/* Why TEXT has not the form of a number. */
static const char *explain(const char *text, size_t length) {
    static const char *const not_finite[] = {"nan", "inf", "infinity"};
    size_t skip = length > 0 && (text[0] == '+' || text[0] == '-');
    skip += skip < length && text[skip] == '.';
    for (size_t i = 0; i < sizeof not_finite / sizeof *not_finite; i++) {
        if (length - skip == strlen(not_finite[i]) &&
            strncasecmp(text + skip, not_finite[i], length - skip) == 0) {
            return "is not a finite number";
        }
    }
    bool digits = false, comma = false, underscore = false, other = false;
    for (size_t i = 0; i < length; i++) {
        digits |= text[i] >= '0' && text[i] <= '9';
        comma |= text[i] == ',';
        underscore |= text[i] == '_';
        other |= !strchr("0123456789+-.,_eE", text[i]) || !text[i];
    }
    if (digits && comma && !other) {
        return "is not a number; the decimal separator is a point, digits are not grouped";
    }
    if (digits && underscore && !other) {
        return "is not a number; digits are not grouped";
    }
    return "is not a number";
}

const char *asdic_number_parse(const char *text, size_t length, double *value) {
    char copy[128];
    size_t at = length > 0 && (text[0] == '+' || text[0] == '-');
    size_t whole = count_digits(text, length, at);
    if (whole > 1 && text[at] == '0') {
        return "is not a decimal number; leave out leading zeros";
    }
    at += whole;
    size_t digits = whole;
    if (at < length && text[at] == '.') {
        size_t fraction = count_digits(text, length, at + 1);
        at += 1 + fraction;
        digits += fraction;
    }
    if (digits > 0 && at < length && (text[at] == 'e' || text[at] == 'E')) {
        size_t sign = at + 1 < length && (text[at + 1] == '+' || text[at + 1] == '-');
        size_t exponent = count_digits(text, length, at + 1 + sign);
        at += exponent > 0 ? 1 + sign + exponent : 0;
    }
    if (digits == 0 || at != length) {
        return explain(text, length);
    }
    if (length >= sizeof copy) {
        return "has too many digits";
    }
    memcpy(copy, text, length);
    copy[length] = '\0';
    locale_t before = asdic_c_locale_enter();
    *value = strtod(copy, NULL);
    asdic_c_locale_leave(before);
    return isfinite(*value) ? NULL : "is too large for a double";
}

/* The place of the last digit of TEXT, a number, that is not 0: 0 of units, -1 of tenths; and *DIGIT; of nought 0 and 0.
 * A double rounds: 2^53 + 0.5 is 2^53 in it. */
static double find_last_digit(const char *text, size_t length, char *digit) {
    size_t end = 0, last = 0, point = 0;
    for (bool behind = false; end < length && text[end] != 'e' && text[end] != 'E'; end++) {
        behind |= text[end] == '.';
        point += !behind;
        last = text[end] > '0' && text[end] <= '9' ? end + 1 : last;
    }
    *digit = '0';
    if (last == 0) {
        return 0.0;
    }
    *digit = text[last - 1];
    double exponent = end < length ? (double)strtol(text + end + 1, NULL, 10) : 0.0;
    return exponent + (double)point - (double)last + (last > point);
}

const char *asdic_integer_parse(const char *text, size_t length, int64_t *value) {
    double number;
    char last;
    const char *why = asdic_number_parse(text, length, &number);
    if (why) {
        return why;
    }
    if (find_last_digit(text, length, &last) < 0.0) {
        return "is not a whole number";
    }
    /* 2^53 + 1 is 2^53 in a double. */
    const double most = 9007199254740992.0;
    if (fabs(number) > most || (fabs(number) == most && last == '3')) {
        return "is too large: whole numbers go to 2^53 = 9007199254740992";
    }
    *value = (int64_t)number;
    return NULL;
}

locale_t asdic_c_locale_enter(void) {
    locale_t c = newlocale(LC_ALL_MASK, "C", (locale_t)0);
    return c ? uselocale(c) : (locale_t)0;
}

void asdic_c_locale_leave(locale_t before) {
    if (before) {
        freelocale(uselocale(before));
    }
}

void asdic_c_print(char *text, size_t size, const char *format, va_list args) {
    locale_t before = asdic_c_locale_enter();
    vsnprintf(text, size, format, args);
    asdic_c_locale_leave(before);
}
