/*
 * What cmocka 1.1.5 lacks: comparison in double (its own casts to float), and a status with the
 * sentence behind it.
 */
#ifndef ASDIC_TEST_ASSERTS_H
#define ASDIC_TEST_ASSERTS_H

#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>

#include <math.h>
#include <stdio.h>
#include <string.h>

#include <asdic/context.h>

/* |ACTUAL - EXPECTED| <= TOLERANCE; a NaN is never close, equal infinities are. */
#define assert_close(actual, expected, tolerance)                                                  \
    test_assert_close((actual), (expected), (tolerance), #actual, __FILE__, __LINE__)

static inline void test_assert_close(double actual, double expected, double tolerance,
                                     const char *what, const char *file, int line) {
    if (actual != expected && !(fabs(actual - expected) <= tolerance)) {
        print_error("%s is %.17g, expected %.17g +- %.3g (off by %.3g)\n", what, actual, expected,
                    tolerance, actual - expected);
        _fail(file, line);
    }
}

/* ACTUAL within FRACTION of EXPECTED. */
#define assert_close_relative(actual, expected, fraction)                                          \
    test_assert_close((actual), (expected), fabs((expected) * (fraction)), #actual, __FILE__,      \
                      __LINE__)

/* The call succeeds; else its sentence is shown. */
#define assert_ok(ctx, call) test_assert_status((ctx), (call), ASDIC_OK, #call, __FILE__, __LINE__)
#define assert_status(ctx, call, status)                                                           \
    test_assert_status((ctx), (call), (status), #call, __FILE__, __LINE__)

static inline void test_assert_status(const asdic_context *ctx, asdic_status actual,
                                      asdic_status expected, const char *what, const char *file,
                                      int line) {
    if (actual != expected) {
        print_error("%s: '%s', expected '%s': %s\n", what, asdic_status_text(actual),
                    asdic_status_text(expected), asdic_context_error(ctx));
        _fail(file, line);
    }
}

/* TEXT contains PART. */
#define assert_contains(text, part) test_assert_contains((text), (part), __FILE__, __LINE__)

static inline void test_assert_contains(const char *text, const char *part, const char *file,
                                        int line) {
    if (!strstr(text, part)) {
        print_error("'%s' does not contain '%s'\n", text, part);
        _fail(file, line);
    }
}

#endif
