/*
 * Numbers in files: every float written reads back, as printf would have written it.
 */
#include "asserts.h"

#include "out/digits.h"

#include <locale.h>
#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static void same_as_printf(float value) {
    char mine[ASDIC_DIGITS_SIZE], theirs[64];
    size_t length = asdic_digits_float(mine, value);
    snprintf(theirs, sizeof theirs, "%.9g", (double)value);
    assert_string_equal(mine, theirs);
    assert_int_equal(length, strlen(theirs));
    assert_true(strtof(mine, NULL) == value);
}

static void float_is_printf_9g(void **state) {
    (void)state;
    const float corners[] = {0.0f,      -0.0f,       1.0f,          -1.0f,        0.1f,
                             -123.456f, 99999.9999f, 16777216.0f,   1e8f,         99999992.0f,
                             1e-4f,     9.9999e-5f,  -0.000123456f, 3.4e38f,      1e-45f,
                             -380.0f,   0.5f,        1e9f,          123456784.0f, 8388608.5f,
                             1000.25f,  262143.98f,  -59.9999f};
    for (size_t i = 0; i < sizeof corners / sizeof *corners; i++) {
        same_as_printf(corners[i]);
    }
    /* Every exponent and sign, mantissas by a full-period generator. */
    uint32_t bits = 12345;
    for (size_t i = 0; i < 300000; i++) {
        float value;
        bits = bits * 1664525u + 1013904223u;
        memcpy(&value, &bits, sizeof value);
        if (isfinite(value)) {
            same_as_printf(value);
        }
    }
    /* The range of levels. */
    for (size_t i = 0; i < 300000; i++) {
        bits = bits * 1664525u + 1013904223u;
        same_as_printf((float)(400.0 * (bits / 4294967296.0) - 380.0));
    }
}

static void nothing_is_an_empty_field(void **state) {
    (void)state;
    char text[ASDIC_DIGITS_SIZE];
    assert_int_equal(asdic_digits_float(text, -INFINITY), 0);
    assert_string_equal(text, "");
    assert_int_equal(asdic_digits_float(text, NAN), 0);
    assert_int_equal(asdic_digits_double(text, NAN), 0);
}

static void double_is_short_and_exact(void **state) {
    (void)state;
    char text[ASDIC_DIGITS_SIZE];
    asdic_digits_double(text, 0.1);
    assert_string_equal(text, "0.1");
    asdic_digits_double(text, 1719838800.125);
    assert_string_equal(text, "1719838800.125");
    const double values[] = {1.0 / 3.0, 0.1 + 0.2, 1e300, -2.5e-300, 37.25};
    for (size_t i = 0; i < sizeof values / sizeof *values; i++) {
        asdic_digits_double(text, values[i]);
        assert_true(strtod(text, NULL) == values[i]);
    }
    asdic_digits_natural(text, UINT64_MAX);
    assert_string_equal(text, "18446744073709551615");
}

static void thousands_stand_apart(void **state) {
    (void)state;
    const struct {
        uint64_t value;
        const char *text;
    } cases[] = {{0, "0"},
                 {999, "999"},
                 {1000, "1,000"},
                 {110000, "110,000"},
                 {1002003, "1,002,003"},
                 {UINT64_MAX, "18,446,744,073,709,551,615"}};
    char text[ASDIC_DIGITS_SIZE];
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        asdic_digits_grouped(text, cases[i].value);
        assert_string_equal(text, cases[i].text);
    }
}

static void times_have_milliseconds(void **state) {
    (void)state;
    const struct {
        double time_s;
        const char *text;
    } cases[] = {{0.30000000000000004, "0.3"},
                 {1234.5678, "1234.568"},
                 {12345.0, "12345"},
                 {1700000000.75, "1700000000.75"}};
    char text[ASDIC_DIGITS_SIZE];
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        asdic_digits_time(text, cases[i].time_s);
        assert_string_equal(text, cases[i].text);
    }
}

static void locale_does_not_matter(void **state) {
    (void)state;
    if (!setlocale(LC_NUMERIC, "de_DE.UTF-8") && !setlocale(LC_NUMERIC, "fr_FR.UTF-8")) {
        skip();
    }
    char text[ASDIC_DIGITS_SIZE];
    asdic_digits_float(text, 1.5e-7f);
    bool has_comma = strchr(text, ',') != NULL;
    asdic_digits_double(text, 0.25);
    has_comma = has_comma || strchr(text, ',');
    setlocale(LC_NUMERIC, "C");
    assert_false(has_comma);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(float_is_printf_9g),        cmocka_unit_test(nothing_is_an_empty_field),
        cmocka_unit_test(double_is_short_and_exact), cmocka_unit_test(times_have_milliseconds),
        cmocka_unit_test(thousands_stand_apart),     cmocka_unit_test(locale_does_not_matter),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
