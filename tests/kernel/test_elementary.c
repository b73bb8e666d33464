/*
 * Elementary functions of the device (kernels/elementary.h), and those of bent rays (kernels/ray_bent.h), against those
 * of C in double, in units in the last place over the ranges that kernels use, and at their ends; the same bits in lanes
 * of any width.
 * Quotients, square roots and fused products, on which they rest, are those of IEEE 754 to the last bit.
 * 77 without a device.
 */
#include "asserts.h"
#include "test_device.h"

#include "ocl/ocl.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define POINTS 65536

static test_device place;

static double sine_of_pi(double x, double y) {
    (void)y;
    return sin(3.14159265358979323846 * (x - 2.0 * nearbyint(0.5 * x)));
}
static double quotient(double x, double y) {
    return (float)(x / y);
}
static double fused(double x, double y) {
    return fmaf((float)x, (float)y, (float)x);
}
static double root(double x, double y) {
    (void)y;
    return sqrtf((float)x);
}
static double angle(double x, double y) {
    return atan2(y, x);
}
static double power_of_ten(double x, double y) {
    (void)y;
    return pow(10.0, x);
}
/* Of the square of their argument, V. */
#define OF_SQUARE(name, ratio, series)                                                             \
    static double name(double v, double y) {                                                       \
        double x = sqrt(v);                                                                        \
        (void)y;                                                                                   \
        return v < 1e-6 ? 1.0 + (series)*v : (ratio);                                              \
    }
OF_SQUARE(bent_atanh, atanh(x) / x, 1.0 / 3.0)
OF_SQUARE(bent_tanh, tanh(x) / x, -1.0 / 3.0)
OF_SQUARE(bent_sinh, sinh(x) / x, 1.0 / 6.0)
OF_SQUARE(bent_cosh, cosh(x), 0.5)
#define OF_ONE(name, function)                                                                     \
    static double name(double x, double y) {                                                       \
        (void)y;                                                                                   \
        return function(x);                                                                        \
    }
OF_ONE(of_sin, sin)
OF_ONE(of_cos, cos)
OF_ONE(of_asin, asin)
OF_ONE(of_acos, acos)
OF_ONE(of_exp, exp)
OF_ONE(of_expm1, expm1)
OF_ONE(of_exp2, exp2)
OF_ONE(of_log, log)
OF_ONE(of_log10, log10)
OF_ONE(of_cbrt, cbrt)

/* In the order of kernels/elementary.cl. X runs from LOW to HIGH, in equal ratios where told. Errors count in
 * units in the last place of the result, but not of one smaller than LEAST: near a root of sine or cosine the
 * argument itself is less exact. */
static const struct function {
    const char *name;
    double (*right)(double x, double y);
    double low, high;
    bool by_ratio;
    double least, allowed_ulp;
} functions[] = {
    {"sin", of_sin, -20.0, 20.0, false, 1e-2, 2.0},
    {"cos", of_cos, -20.0, 20.0, false, 1e-2, 2.0},
    {"sinpi", sine_of_pi, -40.0, 40.0, false, 1e-30, 3.0},
    {"atan2", angle, -3.0, 3.0, false, 1e-30, 3.0},
    {"asin", of_asin, -1.0, 1.0, false, 1e-30, 3.0},
    {"acos", of_acos, -1.0, 1.0, false, 1e-30, 3.0},
    {"exp", of_exp, -87.0, 88.7, false, 1e-37, 2.0},
    {"expm1", of_expm1, -20.0, 20.0, false, 1e-30, 3.0},
    {"exp2", of_exp2, -125.9, 127.9, false, 1e-37, 2.0},
    {"exp10", power_of_ten, -37.8, 38.5, false, 1e-37, 2.0},
    {"log", of_log, 1.2e-38, 3.4e38, true, 1e-30, 2.0},
    {"log10", of_log10, 1.2e-38, 3.4e38, true, 1e-30, 3.0},
    {"cbrt", of_cbrt, 1e-30, 1e30, true, 1e-30, 2.0},
    {"quotient", quotient, 1e-15, 1e15, true, 1e-37, 0.0},
    {"root", root, 1e-30, 1e30, true, 1e-37, 0.0},
    {"fma", fused, -5.0, 5.0, false, 1e-37, 0.0},
    {"bent_atanh", bent_atanh, 0.0, 0.36, false, 1e-30, 4.0},
    {"bent_tanh", bent_tanh, 0.0, 0.36, false, 1e-30, 4.0},
    {"bent_sinh", bent_sinh, 0.0, 0.36, false, 1e-30, 4.0},
    {"bent_cosh", bent_cosh, 0.0, 0.36, false, 1e-30, 4.0},
};
#define FUNCTIONS (sizeof functions / sizeof *functions)

static double fraction(size_t i, double step) {
    double u = (double)(i + 1) * step;
    return u - floor(u);
}

/* A quarter of the points lies in the middle hundredth of the range, where small arguments are. */
static void place_points(const struct function *f, float *x, float *y) {
    for (size_t i = 0; i < POINTS; i++) {
        double u = fraction(i, 0.61803398874989485);
        u = i % 4 ? u : 0.5 + 0.01 * (u - 0.5);
        x[i] = (float)(f->by_ratio ? f->low * pow(f->high / f->low, u)
                                   : f->low + (f->high - f->low) * u);
        y[i] = (float)(6.0 * fraction(i, 0.41421356237309505) - 3.0);
    }
}

static void evaluate(size_t which, unsigned width, const float *x, const float *y, float *out,
                     size_t count) {
    asdic_buffer *xs = NULL, *ys = NULL, *values = NULL;
    asdic_kernel *kernel = NULL;
    char options[64];
    uint32_t number = (uint32_t)which;
    snprintf(options, sizeof options, "-D ASDIC_WIDTH=%u", width);
    assert_ok(place.ctx,
              asdic_kernel_create(place.device, "elementary.cl", options, "evaluate", &kernel));
    assert_ok(place.ctx, asdic_buffer_create(place.device, count * sizeof *x, x, &xs));
    assert_ok(place.ctx, asdic_buffer_create(place.device, count * sizeof *y, y, &ys));
    assert_ok(place.ctx, asdic_buffer_create(place.device, count * sizeof *out, NULL, &values));
    asdic_kernel_arg args[] = {ASDIC_ARG_BUFFER(xs), ASDIC_ARG_BUFFER(ys), ASDIC_ARG_BUFFER(values),
                               ASDIC_ARG_VALUE(number)};
    assert_ok(place.ctx, asdic_kernel_run(kernel, args, 4, count / width, 0));
    assert_ok(place.ctx, asdic_buffer_read(values, 0, count * sizeof *out, out));
    asdic_kernel_destroy(&kernel);
    asdic_buffer_destroy(&xs);
    asdic_buffer_destroy(&ys);
    asdic_buffer_destroy(&values);
}

static double error_ulp(const struct function *f, float got, double right) {
    int exponent;
    frexp(fmax(fabs(right), f->least), &exponent);
    return fabs(got - right) / ldexp(1.0, exponent - 24);
}

static void errors_are_as_stated(void **state) {
    (void)state;
    static float x[POINTS], y[POINTS], got[POINTS], wide[POINTS];
    for (size_t k = 0; k < FUNCTIONS; k++) {
        const struct function *f = &functions[k];
        double worst = 0.0;
        size_t at = 0;
        place_points(f, x, y);
        evaluate(k, 1, x, y, got, POINTS);
        for (size_t i = 0; i < POINTS; i++) {
            double off = error_ulp(f, got[i], f->right(x[i], y[i]));
            if (!(off <= worst)) {
                worst = off;
                at = i;
            }
        }
        print_message("%s: at most %.2f ulp, at %.9g\n", f->name, worst, (double)x[at]);
        assert_true(worst <= f->allowed_ulp);
        for (unsigned width = 8; width <= 16; width += 8) {
            evaluate(k, width, x, y, wide, POINTS);
            assert_memory_equal(wide, got, sizeof got);
        }
    }
}

/* Where ranges end, exactly; NAN stands for what is not asked. */
static void ends_are_exact(void **state) {
    (void)state;
    static const struct {
        const char *name;
        float x, y, right;
    } ends[] = {
        {"sin", 0.0f, 0.0f, 0.0f},           {"cos", 0.0f, 0.0f, 1.0f},
        {"sinpi", 1.0f, 0.0f, 0.0f},         {"sinpi", -7.0f, 0.0f, 0.0f},
        {"sinpi", 0.5f, 0.0f, 1.0f},         {"sinpi", 1.5f, 0.0f, -1.0f},
        {"sinpi", 2e6f, 0.0f, 0.0f},         {"atan2", 0.0f, 0.0f, 0.0f},
        {"atan2", 0.0f, 2.0f, 1.57079637f},  {"atan2", 0.0f, -2.0f, -1.57079637f},
        {"atan2", -1.0f, 0.0f, 3.14159274f}, {"asin", 1.0f, 0.0f, 1.57079637f},
        {"asin", -1.0f, 0.0f, -1.57079637f}, {"acos", 1.0f, 0.0f, 0.0f},
        {"acos", -1.0f, 0.0f, 3.14159274f},  {"exp", 0.0f, 0.0f, 1.0f},
        {"exp", -INFINITY, 0.0f, 0.0f},      {"exp", 90.0f, 0.0f, INFINITY},
        {"exp", 1e4f, 0.0f, INFINITY},       {"expm1", 0.0f, 0.0f, 0.0f},
        {"expm1", -INFINITY, 0.0f, -1.0f},   {"exp2", -INFINITY, 0.0f, 0.0f},
        {"exp2", 10.0f, 0.0f, 1024.0f},      {"exp2", 200.0f, 0.0f, INFINITY},
        {"exp10", -INFINITY, 0.0f, 0.0f},    {"exp10", 40.0f, 0.0f, INFINITY},
        {"log", 1.0f, 0.0f, 0.0f},           {"log", 0.0f, 0.0f, -INFINITY},
        {"log", INFINITY, 0.0f, INFINITY},   {"log10", 0.0f, 0.0f, -INFINITY},
    };
    for (size_t i = 0; i < sizeof ends / sizeof *ends; i++) {
        size_t which = 0;
        float got;
        while (strcmp(functions[which].name, ends[i].name) != 0) {
            which++;
        }
        evaluate(which, 1, &ends[i].x, &ends[i].y, &got, 1);
        if (got != ends[i].right) {
            print_message("%s(%g, %g) is %.9g, expected %.9g\n", ends[i].name, (double)ends[i].x,
                          (double)ends[i].y, (double)got, (double)ends[i].right);
        }
        assert_true(got == ends[i].right);
    }
}

int main(void) {
    place = test_device_open_or_skip();
    setenv("ASDIC_KERNEL_DIR", TEST_DIR "/kernel/kernels", 1);
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(errors_are_as_stated),
        cmocka_unit_test(ends_are_exact),
    };
    return test_device_end(&place, cmocka_run_group_tests(tests, NULL, NULL));
}
