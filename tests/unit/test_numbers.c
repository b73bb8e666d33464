/* Small parts that only count and measure, against arithmetic of another kind. */
#include "asserts.h"
#include "test_context.h"

#include "base/quadrature.h"
#include "detect/kalman.h"
#include "mission/dataset/outline.h"
#include "out/axis.h"
#include "out/decimate.h"
#include "out/half.h"
#include "out/polar.h"
#include "out/raster.h"
#include "sim/variates.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

/* ---- The filter, by matrices ---- */

typedef struct square {
    double m[4][4];
} square;

static square times(const square *a, const square *b) {
    square out = {0};
    for (int i = 0; i < 4; i++) {
        for (int j = 0; j < 4; j++) {
            for (int k = 0; k < 4; k++) {
                out.m[i][j] += a->m[i][k] * b->m[k][j];
            }
        }
    }
    return out;
}

static square turned(const square *a) {
    square out;
    for (int i = 0; i < 4; i++) {
        for (int j = 0; j < 4; j++) {
            out.m[i][j] = a->m[j][i];
        }
    }
    return out;
}

/* Gauss and Jordan, of a positive definite matrix. */
static square inverse(square a) {
    square out = {0};
    for (int i = 0; i < 4; i++) {
        out.m[i][i] = 1.0;
    }
    for (int i = 0; i < 4; i++) {
        double pivot = a.m[i][i];
        for (int j = 0; j < 4; j++) {
            a.m[i][j] /= pivot;
            out.m[i][j] /= pivot;
        }
        for (int k = 0; k < 4; k++) {
            double factor = a.m[k][i];
            for (int j = 0; j < 4 && k != i; j++) {
                a.m[k][j] -= factor * a.m[i][j];
                out.m[k][j] -= factor * out.m[i][j];
            }
        }
    }
    return out;
}

static asdic_kalman some_state(void) {
    asdic_kalman k = {.mean = {{3.0, -0.5}, {-7.0, 1.25}},
                      .covariance = {{4.0, 0.5, 0.3, 0.2},
                                     {0.5, 1.0, 0.1, 0.4},
                                     {0.3, 0.1, 6.0, 0.7},
                                     {0.2, 0.4, 0.7, 2.0}}};
    return k;
}

static void check_state(const asdic_kalman *k, const double mean[4], const square *covariance) {
    for (int i = 0; i < 4; i++) {
        assert_close(k->mean[i / 2][i % 2], mean[i], 1e-12);
        for (int j = 0; j < 4; j++) {
            assert_close(k->covariance[i][j], covariance->m[i][j], 1e-12);
        }
    }
}

/* F P F^T + Q; white acceleration (Bar-Shalom, Li & Kirubarajan 2001, equation 6.2.2-12). */
static void a_filter_predicts(void **state) {
    (void)state;
    const double t = 0.75, q = 0.3;
    asdic_kalman k = some_state();
    square p, f = {{{1, t, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, t}, {0, 0, 0, 1}}}, back = turned(&f);
    memcpy(p.m, k.covariance, sizeof p.m);
    p = times(&f, &p);
    p = times(&p, &back);
    for (int axis = 0; axis < 4; axis += 2) {
        p.m[axis][axis] += q * t * t * t / 3.0;
        p.m[axis][axis + 1] += q * t * t / 2.0;
        p.m[axis + 1][axis] += q * t * t / 2.0;
        p.m[axis + 1][axis + 1] += q * t;
    }
    asdic_kalman_predict(&k, t, q);
    const double mean[4] = {3.0 - 0.5 * t, -0.5, -7.0 + 1.25 * t, 1.25};
    check_state(&k, mean, &p);
}

/* In the form of information: P'^-1 = P^-1 + H^T R^-1 H. */
static void a_filter_takes_a_plot(void **state) {
    (void)state;
    const asdic_plot_point plot = {.north_m = 4.5,
                                   .east_m = -8.0,
                                   .variance_nn_m2 = 0.9,
                                   .variance_ee_m2 = 1.6,
                                   .variance_ne_m2 = 0.35};
    asdic_kalman k = some_state();
    square before, more;
    memcpy(before.m, k.covariance, sizeof before.m);
    more = inverse(before);
    double det = 0.9 * 1.6 - 0.35 * 0.35;
    const double r[2][2] = {{1.6 / det, -0.35 / det}, {-0.35 / det, 0.9 / det}};
    const double off[2] = {4.5 - 3.0, -8.0 + 7.0};
    double pull[4] = {0}, mean[4] = {3.0, -0.5, -7.0, 1.25};
    for (int i = 0; i < 2; i++) {
        for (int j = 0; j < 2; j++) {
            more.m[2 * i][2 * j] += r[i][j];
            pull[2 * i] += r[i][j] * off[j];
        }
    }
    square after = inverse(more);
    for (int i = 0; i < 4; i++) {
        for (int j = 0; j < 4; j++) {
            mean[i] += after.m[i][j] * pull[j];
        }
    }
    /* (P + R)^-1 of the positions. */
    double nn = 4.9, ne = 0.65, ee = 7.6, s = nn * ee - ne * ne;
    double distance2 =
        (ee * off[0] * off[0] - 2.0 * ne * off[0] * off[1] + nn * off[1] * off[1]) / s;
    assert_close(asdic_kalman_distance2(&k, &plot), distance2, 1e-12);
    asdic_kalman_update(&k, &plot);
    check_state(&k, mean, &after);
    k = asdic_kalman_begin(&plot, 1.5);
    const double first[4] = {4.5, 0.0, -8.0, 0.0};
    const square start = {{{0.9, 0, 0.35, 0}, {0, 2.25, 0, 0}, {0.35, 0, 1.6, 0}, {0, 0, 0, 2.25}}};
    check_state(&k, first, &start);
}

/* ---- Integrals ---- */

static int calls;

static double power(double x, void *user) {
    calls++;
    return pow(x, *(const int *)user);
}

static double peak(double x, void *user) {
    (void)user;
    return 1e-4 / (x * x + 1e-8);
}

/* Falls by 180 decibels within a thousandth, to a foot that is no polynomial. */
static double cliff(double x, void *user) {
    (void)user;
    calls++;
    return pow(10.0, -18.0 * fmin(fmax(1e3 * x, 0.0), 1.0)) * (1.0 + fabs(x - 0.01));
}

/* The first look sees the foot alone, a share of which is less than rounding above. */
static void a_first_look_may_miss_all_but_a_trifle(void **state) {
    (void)state;
    calls = 0;
    double fall = 1e-3 / (18.0 * log(10.0));
    assert_close_relative(asdic_quadrature(cliff, NULL, -1e-3, 1.0, 1e-7),
                          1.01e-3 + 0.5e-6 + fall * (1.01 - fall), 1e-7);
    assert_true(calls < 10000);
}

/* Area pi millionths, of which the middle node of the first look makes a fifth. */
static double spike(double x, void *user) {
    (void)user;
    return 1.0 / (1.0 + 1e12 * x * x);
}

static void a_first_look_may_be_too_bright(void **state) {
    (void)state;
    assert_close_relative(asdic_quadrature(spike, NULL, -1.0, 1.0, 1e-7), 2e-6 * atan(1e6), 1e-7);
}

/* The rule of 15 points is exact to the degree 22, Gauss's to 31 with 16. */
static void rules_are_exact_for_polynomials(void **state) {
    (void)state;
    for (int degree = 0; degree <= 22; degree++) {
        double whole = (pow(3.0, degree + 1) - pow(0.5, degree + 1)) / (degree + 1);
        calls = 0;
        assert_close_relative(asdic_quadrature(power, &degree, 0.5, 3.0, 1e-3), whole, 2e-14);
        assert_true(degree > 13 || calls == 15); /* both rules exact: no halving */
    }
    for (int degree = 0; degree <= 31; degree++) {
        double sum = 0.0;
        for (int i = 0; i < ASDIC_GAUSS16_HALF; i++) {
            double x = asdic_gauss16_node[i];
            sum += asdic_gauss16_weight[i] * (pow(x, degree) + pow(-x, degree));
        }
        assert_close(sum, degree % 2 ? 0.0 : 2.0 / (degree + 1), 1e-14);
    }
    assert_close_relative(asdic_quadrature(peak, NULL, -1.0, 2.0, 1e-10), atan(2e4) + atan(1e4),
                          1e-10);
    assert_true(asdic_quadrature(peak, NULL, 1.0, 1.0, 1e-6) == 0.0);
    assert_true(asdic_quadrature(peak, NULL, 2.0, 1.0, 1e-6) == 0.0);
}

/* ---- Half precision ---- */

/* Several at once, as vectors of every width take them, with some left over. */
#define MANY 67

static uint16_t half_of(float value) {
    float values[MANY];
    uint16_t halves[MANY];
    for (int i = 0; i < MANY; i++) {
        values[i] = value;
    }
    asdic_halves_of(values, MANY, halves);
    for (int i = 1; i < MANY; i++) {
        assert_int_equal(halves[i], halves[0]);
    }
    return halves[0];
}

static float value_of(uint16_t half) {
    uint16_t halves[MANY];
    float values[MANY];
    for (int i = 0; i < MANY; i++) {
        halves[i] = half;
    }
    asdic_half_values(halves, MANY, values);
    assert_memory_equal(values, values + 1, (MANY - 1) * sizeof *values);
    return values[0];
}

static void halves_are_the_nearest(void **state) {
    (void)state;
    for (unsigned bits = 0; bits < 0x7c00; bits++) {
        int exponent = (int)(bits >> 10);
        double value = exponent ? ldexp(1.0 + (bits & 1023) / 1024.0, exponent - 15)
                                : ldexp((double)bits, -24);
        assert_true((double)value_of((uint16_t)bits) == value);
        assert_true((double)value_of((uint16_t)(bits | 0x8000)) == -value);
        assert_int_equal(half_of((float)value), bits);
        assert_int_equal(half_of((float)-value), bits | 0x8000);
        double next = bits == 0x7bff ? 65536.0 : (double)value_of((uint16_t)(bits + 1));
        float middle = (float)(0.5 * (value + next)); /* ties go to even */
        assert_int_equal(half_of(middle), bits + bits % 2);
        assert_int_equal(half_of(nextafterf(middle, 0.0f)), bits);
        assert_int_equal(half_of(nextafterf(middle, INFINITY)), bits + 1);
    }
    assert_int_equal(half_of(INFINITY), 0x7c00);
    assert_int_equal(half_of(-INFINITY), 0xfc00);
    assert_int_equal(half_of(NAN), 0x7e00);
    assert_true(isinf(value_of(0x7c00)) && value_of(0xfc00) < 0.0f);
    assert_true(isnan(value_of(0x7e00)) && isnan(value_of(0x7c01)));
}

/* ---- Axes ---- */

static void steps_are_1_2_or_5(void **state) {
    (void)state;
    static const double cases[][3] = {
        /* span, most, step */
        {10.0, 10, 1.0},   {10.0, 5, 2.0},  {10.0, 9, 2.0},   {10.0, 4, 5.0},
        {10.0, 2, 5.0},    {10.0, 1, 10.0}, {10.0, 0, 10.0},  {100.0, 10, 10.0},
        {101.0, 10, 20.0}, {0.3, 3, 0.1},   {0.31, 3, 0.2},   {7e-4, 7, 1e-4},
        {51.0, 10, 10.0},  {50.0, 10, 5.0}, {2001.0, 1, 5e3}, {5001.0, 1, 1e4}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        assert_close_relative(asdic_axis_step(cases[i][0], (size_t)cases[i][1]), cases[i][2],
                              1e-12);
    }
}

static asdic_plot_axis axis_of(double low, double high, bool logarithmic) {
    return (asdic_plot_axis){.label = "", .low = low, .high = high, .logarithmic = logarithmic};
}

static void check_ticks(asdic_plot_axis axis, size_t most, const char *expected) {
    asdic_tick ticks[ASDIC_AXIS_MAX_TICKS];
    size_t count = asdic_axis_ticks(&axis, most, ticks);
    char text[512] = "";
    for (size_t i = 0; i < count; i++) {
        strcat(strcat(text, i ? " " : ""), ticks[i].label);
        double share = asdic_axis_share(&axis, ticks[i].value);
        double least = axis.logarithmic ? log10(axis.low) : axis.low;
        double most_at = axis.logarithmic ? log10(axis.high) : axis.high;
        double at = axis.logarithmic ? log10(ticks[i].value) : ticks[i].value;
        assert_close(share, (at - least) / (most_at - least), 1e-12);
    }
    assert_string_equal(text, expected);
}

static void ticks_lie_within(void **state) {
    (void)state;
    check_ticks(axis_of(0.0, 10.0, false), 5, "0 2 4 6 8 10");
    check_ticks(axis_of(-0.25, 0.25, false), 5, "\u22120.2 \u22120.1 0.0 0.1 0.2");
    check_ticks(axis_of(0.11, 0.149, false), 4, "0.11 0.12 0.13 0.14");
    check_ticks(axis_of(1e7, 3e7, false), 2, "1e+07 2e+07 3e+07");
    check_ticks(axis_of(1.699e9, 1.7015e9, false), 3, "1.699e+09 1.7e+09 1.701e+09");
    check_ticks(axis_of(9999990.0, 9999999.0, false), 2, "9999990 9999995");
    check_ticks(axis_of(1.7e9, 1.7e9 + 11.0, false), 5, "1700000000 1700000005 1700000010");
    check_ticks(axis_of(1.7e9, 1.7e9 + 1.0, false), 2, "1700000000.0 1700000000.5 1700000001.0");
    check_ticks(axis_of(0.01, 1000.0, true), 8,
                "10\u207b\u00b2 10\u207b\u00b9 10\u2070 10\u00b9 10\u00b2 10\u00b3");
    check_ticks(axis_of(0.01, 1000.0, true), 3, "10\u207b\u00b2 10\u2070 10\u00b2");
    check_ticks(axis_of(0.02, 999.0, true), 5, "10\u207b\u00b9 10\u2070 10\u00b9 10\u00b2");
    check_ticks(axis_of(1e9, 1e12, true), 4,
                "10\u2079 10\u00b9\u2070 10\u00b9\u00b9 10\u00b9\u00b2");
    asdic_tick ticks[ASDIC_AXIS_MAX_TICKS];
    asdic_plot_axis fine = axis_of(0.0, 30.0, false);
    assert_int_equal(asdic_axis_ticks(&fine, 1000, ticks), 31);
}

/* Names stand at 1, 2, ..., and nowhere between; long ones are cut at a whole character. */
static void ticks_with_names(void **state) {
    (void)state;
    const char *const names[] = {"one", "", "a name of twenty \u03b1\u03b2\u03b3\u03b4", "outside"};
    const asdic_plot_axis axis = {.low = 0.5, .high = 3.5, .names = names, .name_count = 4};
    asdic_tick ticks[ASDIC_AXIS_MAX_TICKS];
    assert_int_equal(asdic_axis_ticks(&axis, 12, ticks), 3);
    for (size_t i = 0; i < 3; i++) {
        assert_true(ticks[i].value == (double)i + 1.0);
    }
    assert_string_equal(ticks[0].label, "one");
    assert_string_equal(ticks[1].label, "");
    assert_string_equal(ticks[2].label, "a name of twenty \u03b1\u2026");
}

/* ---- Fewer rows and columns ---- */

static void groups_are_means_of_energy(void **state) {
    (void)state;
    enum { ROWS = 7, COLUMNS = 11 };
    float levels[ROWS][COLUMNS];
    for (int i = 0; i < ROWS * COLUMNS; i++) {
        levels[i / COLUMNS][i % COLUMNS] = i % 5 == 3 ? NAN : (float)(i * 37 % 60);
    }
    for (size_t most_rows = 1; most_rows <= ROWS + 1; most_rows++) {
        for (size_t most_columns = 1; most_columns <= COLUMNS + 1; most_columns++) {
            asdic_decimator d;
            assert_ok(ctx, asdic_decimator_init(ctx, ROWS, COLUMNS, most_rows, most_columns, &d));
            for (int row = 0; row < ROWS; row++) {
                asdic_decimator_add(&d, levels[row]);
            }
            asdic_decimator_end(&d);
            size_t high = (size_t)ceil(ROWS / (double)most_rows);
            size_t wide = (size_t)ceil(COLUMNS / (double)most_columns);
            assert_int_equal(d.rows, (size_t)ceil(ROWS / (double)high));
            assert_int_equal(d.columns, (size_t)ceil(COLUMNS / (double)wide));
            for (size_t r = 0; r < d.rows; r++) {
                for (size_t c = 0; c < d.columns; c++) {
                    double sum = 0.0;
                    int count = 0;
                    for (size_t i = r * high; i < (r + 1) * high && i < ROWS; i++) {
                        for (size_t j = c * wide; j < (c + 1) * wide && j < COLUMNS; j++, count++) {
                            sum +=
                                isnan(levels[i][j]) ? 0.0 : pow(10.0, (double)levels[i][j] / 10.0);
                        }
                    }
                    double got = (double)d.levels_db[r * d.columns + c];
                    if (sum == 0.0) {
                        assert_true(isnan(got));
                    } else {
                        assert_close(got, 10.0 * log10(sum / count), 1e-5);
                    }
                }
            }
            asdic_decimator_finish(&d);
        }
    }
}

/* ---- Masks ---- */

enum { WIDE = 9, HIGH = 7, OBJECTS = 3 };

/* Twice the area within polygons "[x,y,...],[...]"; pixels lie to the right of their edges. */
static long doubled_area(const char *text, int *parts) {
    long sum = 0;
    *parts = 0;
    while (*text) {
        long x[256], y[256];
        int count = 0;
        text += strcspn(text, "[");
        if (!*text) {
            break;
        }
        for (text++; *text != ']'; count++) {
            char *end;
            x[count] = strtol(text, &end, 10);
            y[count] = strtol(end + 1, &end, 10);
            text = *end == ',' ? end + 1 : end;
        }
        for (int i = 0; i < count; i++) {
            int next = (i + 1) % count, after = (i + 2) % count;
            sum += x[i] * y[next] - x[next] * y[i];
            /* Corners alone: each edge is along one axis, the next along the other. */
            assert_int_equal((x[i] == x[next]) + (y[i] == y[next]), 1);
            assert_int_equal((x[i] == x[next]) + (x[next] == x[after]), 1);
        }
        (*parts)++;
    }
    return sum;
}

/* Pixels that hang together with (X, Y) by their sides. */
static int fill_part(uint16_t pixels[HIGH][WIDE], int x, int y, uint16_t number) {
    if (x < 0 || y < 0 || x >= WIDE || y >= HIGH || pixels[y][x] != number) {
        return 0;
    }
    pixels[y][x] = 0;
    return 1 + fill_part(pixels, x + 1, y, number) + fill_part(pixels, x - 1, y, number) +
           fill_part(pixels, x, y + 1, number) + fill_part(pixels, x, y - 1, number);
}

/* Pixels of other numbers that NUMBER's parts enclose belong to no outer edge: these masks have none. */
static void polygons_enclose_their_pixels(void **state) {
    (void)state;
    unsigned seed = 5;
    for (int trial = 0; trial < 300; trial++) {
        uint16_t pixels[HIGH][WIDE], left[HIGH][WIDE];
        uint8_t seen[HIGH * WIDE] = {0};
        asdic_box boxes[OBJECTS + 1];
        for (int i = 0; i < HIGH * WIDE; i++) { /* no pixel within but at the border: no holes */
            int x = i % WIDE, y = i / WIDE;
            bool solid = x % 4 != 3 || y == 0;
            int value = rand_r(&seed) % (OBJECTS + 3);
            pixels[y][x] =
                (uint16_t)(solid && (y == 0 || pixels[y - 1][x]) && value ? 1 + trial % OBJECTS
                                                                          : 0);
        }
        memcpy(left, pixels, sizeof left);
        const asdic_mask mask = {WIDE, HIGH, &pixels[0][0]};
        asdic_mask_boxes(&mask, OBJECTS, boxes);
        for (uint16_t number = 1; number <= OBJECTS; number++) {
            int parts = 0, pixel_count = 0, got_parts;
            size_t x0 = WIDE, y0 = HIGH, x1 = 0, y1 = 0;
            for (int i = 0; i < HIGH * WIDE; i++) {
                size_t x = (size_t)(i % WIDE), y = (size_t)(i / WIDE);
                if (pixels[y][x] == number) {
                    x0 = x < x0 ? x : x0;
                    y0 = y < y0 ? y : y0;
                    x1 = x + 1 > x1 ? x + 1 : x1;
                    y1 = y + 1 > y1 ? y + 1 : y1;
                }
                int grown = fill_part(left, (int)x, (int)y, number);
                pixel_count += grown;
                parts += grown > 0;
            }
            const asdic_box *box = &boxes[number];
            assert_int_equal(box->pixels, pixel_count);
            if (pixel_count == 0) {
                continue;
            }
            assert_true(box->left == x0 && box->top == y0 && box->right == x1 && box->bottom == y1);
            asdic_text text = {0};
            asdic_mask_polygons(&mask, box, number, seen, &text);
            char *polygons = asdic_text_take(&text);
            assert_int_equal(doubled_area(polygons, &got_parts), 2 * pixel_count);
            assert_int_equal(got_parts, parts);
            free(polygons);
            for (int i = 0; i < HIGH * WIDE; i++) {
                assert_int_equal(seen[i], 0);
            }
        }
    }
}

/* As where rough sand just covers a reef: in a frame, rings one in the other; within, each second
 * pixel of each second row alone. The work is that of the parts' boxes, not of parts times the box of
 * all, which here would be 300 times as much. */
static void masks_may_be_of_many_parts(void **state) {
    (void)state;
    enum { SIDE = 256, RINGS = 10 };
    uint16_t *pixels = calloc(SIDE * SIDE, sizeof *pixels);
    uint8_t *seen = calloc(SIDE * SIDE, 1);
    int alone = 0, got_parts;
    long area = 0; /* that the outer edges enclose */
    for (int ring = 0; ring < RINGS; ring++) {
        int wide = SIDE - 4 * ring;
        area += (long)wide * wide;
        for (int k = 2 * ring; k < SIDE - 2 * ring; k++) {
            int low = 2 * ring, high = SIDE - 1 - 2 * ring;
            pixels[low * SIDE + k] = pixels[high * SIDE + k] = 1;
            pixels[k * SIDE + low] = pixels[k * SIDE + high] = 1;
        }
    }
    for (int y = 2 * RINGS; y < SIDE - 2 * RINGS; y += 2) {
        for (int x = 2 * RINGS; x < SIDE - 2 * RINGS; x += 2, alone++) {
            pixels[y * SIDE + x] = 1;
        }
    }
    const asdic_mask mask = {SIDE, SIDE, pixels};
    asdic_box boxes[2];
    asdic_text text = {0};
    clock_t start = clock();
    asdic_mask_boxes(&mask, 1, boxes);
    asdic_mask_polygons(&mask, &boxes[1], 1, seen, &text);
    assert_true((double)(clock() - start) / CLOCKS_PER_SEC < 1.0);
    char *polygons = asdic_text_take(&text);
    assert_int_equal(doubled_area(polygons, &got_parts), 2 * (area + alone));
    assert_int_equal(got_parts, RINGS + alone);
    for (int i = 0; i < SIDE * SIDE; i++) {
        assert_int_equal(seen[i], 0);
    }
    free(polygons);
    free(seen);
    free(pixels);
}

/* ---- Fans ---- */

#define DEGREE (3.14159265358979323846 / 180.0)

/* Every pixel's centre by its own range and bearing; the picture is no larger than the sector. */
static void check_sector(const double *bearing_deg, size_t beams, double radius_px) {
    enum { BINS = 20 };
    double bearing[8], edges[9], x0 = 0.0, x1 = 0.0, y0 = 0.0, y1 = 0.0;
    for (size_t b = 0; b < beams; b++) {
        bearing[b] = bearing_deg[b] * DEGREE;
    }
    for (size_t b = 1; b < beams; b++) {
        edges[b] = 0.5 * (bearing[b - 1] + bearing[b]);
    }
    edges[0] = beams > 1 ? 2.0 * bearing[0] - edges[1] : bearing[0] - DEGREE;
    edges[beams] = beams > 1 ? 2.0 * bearing[beams - 1] - edges[beams - 1] : bearing[0] + DEGREE;
    /* Over the seam, too, no farther than half-way. */
    double seam = 0.5 * (bearing[beams - 1] + bearing[0] + 360.0 * DEGREE);
    edges[0] = fmax(edges[0], seam - 360.0 * DEGREE);
    edges[beams] = fmin(edges[beams], seam);
    double low = edges[0], high = edges[beams];
    if (high - low > 360.0 * DEGREE) {
        low = 0.5 * (low + high) - 180.0 * DEGREE;
        high = low + 360.0 * DEGREE;
    }
    for (int i = 0; i <= 3600; i++) { /* along the arc */
        double at = low + (high - low) * i / 3600.0;
        x0 = fmin(x0, radius_px * sin(at));
        x1 = fmax(x1, radius_px * sin(at));
        y0 = fmin(y0, -radius_px * cos(at));
        y1 = fmax(y1, -radius_px * cos(at));
    }
    const asdic_fan fan = {
        .bearing_rad = bearing, .beams = beams, .bins = BINS, .bin_length_m = 0.5};
    asdic_sector s = asdic_sector_of(&fan, radius_px);
    uint32_t *cells = NULL;
    assert_ok(ctx, asdic_sector_cells(ctx, &fan, &s, &cells));
    assert_true(s.apex_x_px >= -x0 - 1e-3 && s.apex_x_px < 1.001 - x0);
    assert_true(s.apex_y_px >= -y0 - 1e-3 && s.apex_y_px < 1.001 - y0);
    double right = (double)s.width - s.apex_x_px, below = (double)s.height - s.apex_y_px;
    assert_true(right >= x1 - 1e-3 && right < x1 + 1.001 + (x1 - x0 < 1.0));
    assert_true(below >= y1 - 1e-3 && below < y1 + 1.001 + (y1 - y0 < 1.0));
    size_t inside = 0;
    for (size_t i = 0; i < s.width * s.height; i++) {
        double x = (double)(i % s.width) + 0.5 - s.apex_x_px;
        double y = s.apex_y_px - (double)(i / s.width) - 0.5;
        double range = sqrt(x * x + y * y) / radius_px * BINS, at = atan2(x, y);
        uint32_t expected = UINT32_MAX;
        bool is_edge = fabs(range - rint(range)) < 1e-9;
        for (size_t k = 0; k < 3 * beams;
             k++) { /* of the same bearings, those of atan2 come first */
            static const double turns[] = {360.0, -360.0, 0.0};
            double there = at + turns[k / beams] * DEGREE;
            size_t b = k % beams;
            is_edge = is_edge || fabs(there - edges[b]) < 1e-9 || fabs(there - edges[b + 1]) < 1e-9;
            if (there >= edges[b] && there < edges[b + 1] && range < BINS) {
                expected = (uint32_t)(b * BINS + (size_t)range);
            }
        }
        inside += expected != UINT32_MAX;
        assert_true(is_edge || cells[i] == expected);
    }
    assert_true(inside > 0);
    free(cells);
}

static void pixels_belong_to_beams(void **state) {
    (void)state;
    check_sector((const double[]){-30.0, -11.0, 1.0, 40.0}, 4, 37.3);
    check_sector((const double[]){20.0, 25.0, 70.0}, 3, 25.0);
    check_sector((const double[]){-120.0, -100.0}, 2, 30.0);
    check_sector((const double[]){-140.0, -60.0, 10.0, 80.0, 150.0}, 5, 21.7);
    check_sector((const double[]){-180.0, -90.0, 0.0, 90.0, 180.0}, 5, 16.0);
    check_sector((const double[]){3.0}, 1, 60.0);
    check_sector((const double[]){0.0, 90.0, 270.0}, 3, 30.0);
    /* Astern, aside all round, and turned a whole turn. */
    check_sector((const double[]){120.0, 150.0, 180.0, 210.0, 240.0}, 5, 31.3);
    check_sector((const double[]){-90.0, 0.0, 90.0, 180.0, 270.0}, 5, 16.0);
    check_sector((const double[]){-250.0, -200.0, -170.0}, 3, 22.9);
    check_sector((const double[]){340.0, 350.0, 360.0}, 3, 41.0);
}

/* Of more bins than there are pixels the loudest are shown, with the gain of where they are. */
static void thinned_fans_keep_their_ranges(void **state) {
    (void)state;
    enum { BEAMS = 3, BINS = 1200, GROUP = 4 };
    static float levels_db[BEAMS * BINS];
    const double bearing_rad[BEAMS] = {-0.4, 0.0, 0.4};
    asdic_picture_options options = asdic_picture_options_default();
    options.db_low = 0.0;
    options.db_high = 100.0;
    options.tvg_db_per_decade = 30.0;
    options.tvg_db_per_m = 0.1;
    asdic_raster pictures[2];
    for (int k = 0; k < 2; k++) { /* the same, of bins a quarter as long */
        const asdic_fan fan = {.levels_db = levels_db,
                               .bearing_rad = bearing_rad,
                               .beams = BEAMS,
                               .bins = k ? BINS : BINS / GROUP,
                               .bin_length_m = k ? 0.25 : 0.25 * GROUP};
        asdic_sector sector = asdic_sector_of(&fan, BINS / GROUP);
        assert_ok(ctx, asdic_raster_fan(ctx, &fan, &sector, &options, 0xffffff, &pictures[k]));
    }
    assert_int_equal(pictures[0].width, pictures[1].width);
    assert_memory_equal(pictures[0].rgb, pictures[1].rgb,
                        3 * pictures[0].width * pictures[0].height);
    asdic_raster_finish(&pictures[0]);
    asdic_raster_finish(&pictures[1]);
}

/* A head that turns round, beside one that goes back and forth; beams to starboard of it. */
static void a_scan_fills_its_directions(void **state) {
    (void)state;
    const asdic_sweep circle = {.directions = 8, .step_rad = 45.0 * DEGREE, .is_circle = true};
    const asdic_sweep sector = {.directions = 3, .step_rad = 10.0 * DEGREE};
    static const double yaw_deg[] = {0.0, 50.0, -100.0, 400.0};
    for (size_t i = 0; i < 8; i++) {
        const asdic_sweep *sweep = i < 4 ? &circle : &sector;
        double yaw = yaw_deg[i % 4] * DEGREE;
        asdic_polar polar;
        assert_ok(ctx, asdic_polar_init(ctx, sweep, yaw, 2, &polar));
        assert_int_equal(polar.columns, sweep->directions + sweep->is_circle);
        for (uint64_t ping = 0; ping < 8; ping++) {
            const float levels[2] = {(float)ping, (float)ping + 0.5f};
            asdic_polar_add(&polar, ping, levels);
            /* It lies where the beam looked, at both ends of a circle. */
            double looked =
                yaw + asdic_sweep_bearing_rad(sweep, asdic_sweep_direction(sweep, ping));
            int found = 0;
            for (size_t c = 0; c < polar.columns; c++) {
                double off = polar.bearing_rad[c] - looked;
                if (fabs(sweep->is_circle ? remainder(off, 360.0 * DEGREE) : off) < 1e-9) {
                    assert_memory_equal(polar.levels_db + 2 * c, levels, sizeof levels);
                    found++;
                } else {
                    assert_true(memcmp(polar.levels_db + 2 * c, levels, sizeof levels) != 0);
                }
            }
            assert_in_range(found, 1, 2);
        }
        for (size_t c = 1; c < polar.columns; c++) {
            assert_close(polar.bearing_rad[c] - polar.bearing_rad[c - 1], sweep->step_rad, 1e-12);
        }
        if (sweep->is_circle) { /* the seam stays astern, within half a step */
            assert_close(polar.bearing_rad[0], -180.0 * DEGREE, 0.5001 * sweep->step_rad);
            assert_memory_equal(polar.levels_db, polar.levels_db + 16, 2 * sizeof(float));
        }
        asdic_fan fan = asdic_polar_fan(&polar, 0.25);
        assert_true(fan.beams == polar.columns && fan.bins == 2 && fan.bin_length_m == 0.25);
        asdic_polar_finish(&polar);
    }
}

/* ---- Windows of levels ---- */

/* LOW levels of -205 dB, HIGH of 25 dB, the rest of COUNT -55 dB, the highest first, and cells without. */
static void check_window(size_t count, size_t low, size_t high, double low_db, double high_db) {
    float levels_db[1003];
    double got_low_db, got_high_db;
    for (size_t i = 0; i < count; i++) {
        levels_db[i] = i < high ? 25.0f : i < count - low ? -55.0f : -205.0f;
    }
    levels_db[count] = NAN;
    levels_db[count + 1] = -INFINITY;
    levels_db[count + 2] = NAN;
    assert_ok(ctx, asdic_raster_window(ctx, levels_db, count + 3, &got_low_db, &got_high_db));
    assert_true(got_low_db == low_db && got_high_db == high_db);
}

/* From the 5th to the 99.5th percentile, outwards to 10 dB, and at least 30 dB. */
static void windows_leave_out_the_rarest(void **state) {
    (void)state;
    check_window(1000, 50, 5, -60, 30);
    check_window(1000, 51, 4, -210, -50);
    check_window(1, 0, 0, -60, -30);
    check_window(0, 0, 0, -70, 0);
}

/* ---- Random variates ---- */

/* All 64 bits of a seed and of an index count. */
static void variates_know_whole_seeds(void **state) {
    (void)state;
    static const uint64_t pairs[][2] = {{11, 12}, {11 + (1ull << 32), 12}, {11, 12 + (1ull << 32)}};
    double first[3];
    for (size_t i = 0; i < 3; i++) {
        asdic_variates v = asdic_variates_begin(3, pairs[i][0], pairs[i][1], 13);
        first[i] = asdic_variates_uniform(&v);
    }
    assert_true(first[0] != first[1] && first[0] != first[2] && first[1] != first[2]);
}

/* Means of COUNT: of the values, their squares and cubes. */
static void moments(double shape, double out[3]) {
    enum { COUNT = 200000 };
    asdic_variates v = asdic_variates_begin(3, 11, 12, 13);
    out[0] = out[1] = out[2] = 0.0;
    for (int i = 0; i < COUNT; i++) {
        double x = asdic_variates_gamma(&v, shape);
        assert_true(x >= 0.0 && isfinite(x));
        out[0] += x / COUNT;
        out[1] += x * x / COUNT;
        out[2] += x * x * x / COUNT;
    }
}

/* Within five standard deviations of what the distribution's own moments say. */
static void gammas_have_their_moments(void **state) {
    (void)state;
    static const double shapes[] = {0.3, 1.0, 1.5, 3.0, 16.0, 17.0, 40.0};
    for (size_t i = 0; i < sizeof shapes / sizeof *shapes; i++) {
        double got[3], k = shapes[i], raw[7] = {1.0};
        for (int n = 1; n <= 6; n++) {
            raw[n] = raw[n - 1] * (k + n - 1);
        }
        moments(k, got);
        for (int n = 1; n <= 3; n++) {
            double deviation = sqrt((raw[2 * n] - raw[n] * raw[n]) / 200000.0);
            assert_close(got[n - 1], raw[n], 5.0 * deviation);
        }
    }
    asdic_variates v = asdic_variates_begin(3, 11, 12, 13);
    double sum[5] = {0};
    enum { PAIRS = 100000 };
    for (int i = 0; i < PAIRS; i++) {
        double x[2];
        asdic_variates_normal(&v, x);
        sum[0] += x[0];
        sum[1] += x[1];
        sum[2] += x[0] * x[0];
        sum[3] += x[1] * x[1];
        sum[4] += x[0] * x[1];
    }
    assert_close(sum[0] / PAIRS, 0.0, 5.0 / sqrt(PAIRS));
    assert_close(sum[1] / PAIRS, 0.0, 5.0 / sqrt(PAIRS));
    assert_close(sum[2] / PAIRS, 1.0, 5.0 * sqrt(2.0 / PAIRS));
    assert_close(sum[3] / PAIRS, 1.0, 5.0 * sqrt(2.0 / PAIRS));
    assert_close(sum[4] / PAIRS, 0.0, 5.0 / sqrt(PAIRS));
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_filter_predicts),
        cmocka_unit_test(a_filter_takes_a_plot),
        cmocka_unit_test(rules_are_exact_for_polynomials),
        cmocka_unit_test(a_first_look_may_miss_all_but_a_trifle),
        cmocka_unit_test(a_first_look_may_be_too_bright),
        cmocka_unit_test(halves_are_the_nearest),
        cmocka_unit_test(steps_are_1_2_or_5),
        cmocka_unit_test(ticks_lie_within),
        cmocka_unit_test(ticks_with_names),
        cmocka_unit_test(groups_are_means_of_energy),
        cmocka_unit_test(polygons_enclose_their_pixels),
        cmocka_unit_test(pixels_belong_to_beams),
        cmocka_unit_test(thinned_fans_keep_their_ranges),
        cmocka_unit_test(masks_may_be_of_many_parts),
        cmocka_unit_test(a_scan_fills_its_directions),
        cmocka_unit_test(windows_leave_out_the_rarest),
        cmocka_unit_test(gammas_have_their_moments),
        cmocka_unit_test(variates_know_whole_seeds),
    };
    return cmocka_run_group_tests(tests, context_begin, context_end);
}
