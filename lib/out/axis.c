#include "axis.h"

#include "digits.h"

#include "base/words.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

double asdic_axis_step(double span, size_t max_count) {
    double least = span / (double)(max_count < 1 ? 1 : max_count);
    double decade = pow(10.0, floor(log10(least)));
    static const double steps[] = {1.0, 2.0, 5.0, 10.0};
    for (size_t i = 0; i < 4; i++) {
        /* The slack lets 100 / 10 be 10 in spite of rounding. */
        if (steps[i] * decade >= least * (1.0 - 1e-9)) {
            return steps[i] * decade;
        }
    }
    return 10.0 * decade;
}

void asdic_axis_label(char label[24], double value, double step) {
    char number[ASDIC_DIGITS_SIZE];
    char format[16] = "%.0f";
    int decimals = step > 0.0 ? (int)ceil(-log10(step) - 1e-9) : 0;
    if (decimals > 0) {
        snprintf(format, sizeof format, "%%.%df", decimals > 9 ? 9 : decimals);
    }
    if (fabs(value) < 1e-9 * step) {
        value = 0.0;
    }
    /* Of large values as many digits as tell neighbours apart, as of Unix time; beyond 1e15 a double has none. */
    if (fabs(value) >= 1e15 || (fabs(value) >= 1e7 && step >= 1e6)) {
        double digits = floor(log10(fabs(value))) - floor(log10(step) + 1e-9) + 1.0;
        snprintf(format, sizeof format, "%%.%dg", (int)fmin(fmax(digits, 1.0), 9.0));
    }
    asdic_digits_print(number, format, fabs(value));
    snprintf(label, 24, "%s%.18s", value < 0.0 ? "\u2212" : "", number);
}

double asdic_axis_share(const asdic_plot_axis *axis, double value) {
    if (axis->logarithmic) {
        return log10(value / axis->low) / log10(axis->high / axis->low);
    }
    return (value - axis->low) / (axis->high - axis->low);
}

/* Superscript digits for "10^n". */
static void decade_label(char label[24], int exponent) {
    static const char *const digits[] = {"\u2070", "\u00b9", "\u00b2", "\u00b3", "\u2074",
                                         "\u2075", "\u2076", "\u2077", "\u2078", "\u2079"};
    int n = exponent < 0 ? -exponent : exponent;
    snprintf(label, 24, "10%s%s%s", exponent < 0 ? "\u207b" : "",
             n >= 10 ? digits[n / 10 % 10] : "", digits[n % 10]);
}

static size_t decade_ticks(const asdic_plot_axis *axis, size_t max_count,
                           asdic_tick ticks[ASDIC_AXIS_MAX_TICKS]) {
    int first = (int)ceil(log10(axis->low) - 1e-9), last = (int)floor(log10(axis->high) + 1e-9);
    int decades = last - first + 1;
    int every = decades > (int)max_count ? (decades + (int)max_count - 1) / (int)max_count : 1;
    size_t count = 0;
    for (int e = first; e <= last && count < ASDIC_AXIS_MAX_TICKS; e += every) {
        ticks[count].value = pow(10.0, e);
        decade_label(ticks[count++].label, e);
    }
    return count;
}

/* As much of NAME as there is room for, in whole characters of UTF-8. */
static void name_label(char label[24], const char *name) {
    static const char more[] = "\u2026";
    size_t length = strlen(name);
    if (length < 24) {
        memcpy(label, name, length + 1);
        return;
    }
    size_t most = asdic_words_cut(name, length, 24 - sizeof more);
    memcpy(label, name, most);
    memcpy(label + most, more, sizeof more);
}

static size_t named_ticks(const asdic_plot_axis *axis, asdic_tick ticks[ASDIC_AXIS_MAX_TICKS]) {
    size_t count = 0;
    for (size_t i = 0; i < axis->name_count && count < ASDIC_AXIS_MAX_TICKS; i++) {
        double value = (double)i + 1.0;
        if (value >= axis->low && value <= axis->high) {
            ticks[count].value = value;
            name_label(ticks[count++].label, axis->names[i]);
        }
    }
    return count;
}

size_t asdic_axis_ticks(const asdic_plot_axis *axis, size_t max_count,
                        asdic_tick ticks[ASDIC_AXIS_MAX_TICKS]) {
    max_count = max_count > ASDIC_AXIS_MAX_TICKS - 2 ? ASDIC_AXIS_MAX_TICKS - 2 : max_count;
    if (axis->names) {
        return named_ticks(axis, ticks);
    }
    if (axis->logarithmic) {
        return decade_ticks(axis, max_count, ticks);
    }
    double step = asdic_axis_step(axis->high - axis->low, max_count);
    double first = ceil(axis->low / step - 1e-9);
    size_t count = 0;
    while (count < ASDIC_AXIS_MAX_TICKS) {
        double value = (first + (double)count) * step;
        if (value > axis->high + 1e-9 * step) {
            break;
        }
        ticks[count].value = value;
        asdic_axis_label(ticks[count++].label, value, step);
    }
    return count;
}
