/*
 * cmocka with a comparison of doubles: its own assert_float_equal casts to float.
 */
#ifndef ASDIC_TESTS_ASSERT_CLOSE_H
#define ASDIC_TESTS_ASSERT_CLOSE_H

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

/* Passes when |ACTUAL - EXPECTED| <= ABSOLUTE + RELATIVE |EXPECTED|; infinities must be equal and
 * NAN never passes. */
#define assert_close(actual, expected, absolute, relative)                                         \
    assert_close_at((actual), (expected), (absolute), (relative), #actual, __FILE__, __LINE__)

static inline __attribute__((unused)) void assert_close_at(double actual, double expected,
                                                           double absolute, double relative,
                                                           const char *text, const char *file,
                                                           int line) {
    double allowed = absolute + relative * fabs(expected);
    if (actual == expected || (isfinite(expected) && fabs(actual - expected) <= allowed)) {
        return;
    }
    print_error("%s:%d: %s = %.17g, expected %.17g, off by %.3g, allowed %.3g\n", file, line, text,
                actual, expected, actual - expected, allowed);
    _fail(file, line);
}

#endif
