/*
 * What the slips of the paper (Morency, Stilwell & Hess) change in its first scenario: the table in
 * kernels/README.md. The scenario is written out again here, right and with slips put back, from
 * the formulas alone; of the library only the right expected levels are taken, to compare with.
 *
 * What a third program found is checked, the table is printed.
 *
 * Both apertures are one square face that looks ahead, level, so that the pattern is
 * B = [sinc(L uy) sinc(L uz)]^2 for the unit vector u. It is the same in front and, where something
 * is heard from there, behind.
 */
#include "asserts.h"

#include "base/sort.h"

#include <asdic/asdic.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define PI 3.14159265358979323846
#define BINS 149
#define BIN_M 0.5
#define BLANKING_M 0.5
#define HEIGHT_M 5.0 /* above the bottom */
#define DEPTH_M 7.0  /* below the surface */
#define WATER_DEPTH_M 12.0
#define F_KHZ 100.0
#define BANDWIDTH_HZ 10e3
#define FACE_M 0.05
#define T_DEGC 10.0
#define S_PPT 35.0
#define PH 8.0
#define WIND_KN 10.0
#define SHIPPING 0.5
#define VOLUME_DB (-90.0)
#define BOTTOM_TYPE 2.0

enum { BOTTOM, SURFACE, VOLUME, NOISE, COMPONENTS };
static const char *const names[COMPONENTS] = {"bottom", "surface", "volume", "noise"};

/* A slip by its number in the table; 40 is the surface law without its cap. */
#define SLIP(number) (1ull << (number))
#define PRINTED                                                                                    \
    (SLIP(1) | SLIP(5) | SLIP(12) | SLIP(13) | SLIP(14) | SLIP(15) | SLIP(17) | SLIP(21) |         \
     SLIP(22) | SLIP(23) | SLIP(24) | SLIP(25) | SLIP(32) | SLIP(33) | SLIP(40))

static double lin(double db) {
    return pow(10.0, 0.1 * db);
}

/* ---- water, laws, noise: kernels/README.md names the sources ---------------------------- */

/* Medwin 1975. */
static double sound_speed(double z_m) {
    return 1449.2 + 4.6 * T_DEGC - 0.055 * pow(T_DEGC, 2) + 0.00029 * pow(T_DEGC, 3) +
           (1.34 - 0.01 * T_DEGC) * (S_PPT - 35.0) + 0.016 * z_m;
}

/* Francois & Garrison 1982, dB/km; slips 1 and 2: 8.696 for 8.86, and Medwin's sound speed. */
static double absorption(bool printed) {
    double z = WATER_DEPTH_M, f2 = F_KHZ * F_KHZ;
    double c = printed ? sound_speed(z) : 1412.0 + 3.21 * T_DEGC + 1.19 * S_PPT + 0.0167 * z;
    double a1 = (printed ? 8.696 : 8.86) / c * pow(10.0, 0.78 * PH - 5.0);
    double f1 = 2.8 * sqrt(S_PPT / 35.0) * pow(10.0, 4.0 - 1245.0 / (T_DEGC + 273.0));
    double a2 = 21.44 * S_PPT / c * (1.0 + 0.025 * T_DEGC);
    double p2 = 1.0 - 1.37e-4 * z + 6.2e-9 * z * z;
    double f2_khz =
        8.17 * pow(10.0, 8.0 - 1990.0 / (T_DEGC + 273.0)) / (1.0 + 0.0018 * (S_PPT - 35.0));
    double a3 = 4.937e-4 - 2.59e-5 * T_DEGC + 9.11e-7 * pow(T_DEGC, 2) - 1.5e-8 * pow(T_DEGC, 3);
    double p3 = 1.0 - 3.83e-5 * z + 4.9e-10 * z * z;
    return a1 * f1 * f2 / (f1 * f1 + f2) + a2 * p2 * f2_khz * f2 / (f2_khz * f2_khz + f2) +
           a3 * p3 * f2;
}

/* SEARAY. */
static double bottom_lin(double sine) {
    double bt = BOTTOM_TYPE, cos2 = 1.0 - sine * sine;
    double gamma = 1.0 + 125.0 * exp(-2.64 * pow(bt - 1.75, 2) - 50.0 / bt * cos2 / (sine * sine));
    double beta = gamma * pow(sine + 0.19, bt * pow(cos2, 8));
    return 3.03 * beta * pow(F_KHZ, 3.2 - 0.8 * bt) * pow(10.0, 2.8 * bt - 12.0) + pow(10.0, -4.42);
}

/* The course's surface law, and its cap of Cox & Munk. */
static double surface_lin(double sine, bool capped) {
    double v = WIND_KN, cosine = sqrt(fmax(1.0 - sine * sine, 1e-30));
    double beta =
        4.0 * (v + 2.0) / (v + 1.0) + (2.5 / cbrt(F_KHZ + 0.1) - 4.0) * pow(cosine, 0.125);
    double law =
        pow(10.0, -5.05) * pow(1.0 + v, 2) * pow(F_KHZ + 0.1, v / 150.0) * pow(sine / cosine, beta);
    double cap = 1.0 / (4.0 * PI * (0.003 + 0.00512 * v * 1852.0 / 3600.0));
    return capped ? fmin(law, cap) : law;
}

/* Coates 1990, in the band and in a bin, less the directivity of the face. */
static double noise_lin(unsigned long long slips) {
    double wind = slips & SLIP(31) ? WIND_KN * 1852.0 / 3600.0 : WIND_KN, f = F_KHZ;
    double c = sound_speed(DEPTH_M), cell_m = c / (2.0 * BANDWIDTH_HZ);
    double sum = lin(17.0 - 30.0 * log10(f)) +
                 lin(40.0 + 20.0 * (SHIPPING - 0.5) + 26.0 * log10(f) - 60.0 * log10(f + 0.03)) +
                 lin(50.0 + 5.38 * sqrt(wind) + 20.0 * log10(f) - 40.0 * log10(f + 0.4)) +
                 lin(-15.0 + 20.0 * log10(f));
    double cells = slips & SLIP(33) ? 1.0 : BIN_M / cell_m;
    double directivity = slips & SLIP(32) ? 1.0 : 4.0 * PI * pow(FACE_M / (1e-3 * c / F_KHZ), 2);
    return sum * BANDWIDTH_HZ * cells / directivity;
}

/* ---- patterns --------------------------------------------------------------------------- */

typedef struct model {
    unsigned long long slips;
    double alpha_db_per_km, length_wl;
    int turns;     /* points on a circle */
    double *below; /* over keys of the direction: the sum of the pattern up to it */
    int rows;
    double front; /* weight of the directions in front of the face */
} model;

static double sinc2(double x) {
    return fabs(x) < 1e-9 ? 1.0 : pow(sin(PI * x) / (PI * x), 2);
}

static double pattern(const model *m, double uy, double uz) {
    return sinc2(m->length_wl * uy) * sinc2(m->length_wl * uz);
}

/* What is averaged of one direction: the two-way pattern; slip 12, decibels of one way; slip 13,
 * one way. Behind the face nothing; slip 10, unity; slip 11, the mirror image. */
static double averaged(const model *m, bool front, double uy, double uz) {
    double one_way = pattern(m, uy, uz);
    if (m->slips & SLIP(12)) {
        return front ? 10.0 * log10(fmax(one_way, 1e-300)) : 0.0;
    }
    double there = m->slips & SLIP(13) ? one_way : one_way * one_way;
    return front || m->slips & SLIP(11) ? there : m->slips & SLIP(10) ? 1.0 : 0.0;
}

/* Mean around the ring of an elevation; the integrand has the period of the ring, whose points then
 * do as Gauss's. Slip 14: 1 / pi. */
static double ring_mean(const model *m, double elevation) {
    double sum = 0.0, sin_e = sin(elevation), cos_e = cos(elevation);
    for (int i = 0; i < m->turns; i++) {
        double phi = 2.0 * PI * (i + 0.5) / m->turns;
        sum += averaged(m, cos(phi) > 0.0, cos_e * sin(phi), sin_e) / m->turns;
    }
    double share = m->slips & SLIP(14) ? 2.0 : 1.0;
    if (m->slips & SLIP(12)) { /* of the front half, transmitter and receiver */
        return 0.5 * share * lin(4.0 * sum);
    }
    return m->slips & SLIP(13) ? share * sum * share * sum : share * sum;
}

/* Sums over directions, row by row of the angle at which boundaries cut. */
static void fill_sphere(model *m) {
    m->rows = 1080;
    m->below = calloc((size_t)m->rows + 1, sizeof *m->below);
    assert_non_null(m->below);
    for (int i = 0; i < m->rows; i++) {
        for (int j = 0; j < m->rows; j++) {
            double a = PI * ((i + 0.5) / m->rows - 0.5), b = 2.0 * PI * (j + 0.5) / m->rows;
            double weight = cos(a), x = cos(a) * cos(b), y = cos(a) * sin(b), z = sin(a);
            if (m->slips & SLIP(23)) { /* neither unit vectors nor a Jacobian */
                double length;
                a = 2.0 * a;
                x = cos(a) * cos(b), y = sin(a), z = sin(b);
                length = sqrt(x * x + y * y + z * z);
                x /= length, y /= length, z /= length;
                weight = 1.0;
            }
            double key = asin(z), uy = y, uz = z;
            if (m->slips & SLIP(24)) { /* psi = atan(vz / vx) */
                double psi = atan2(z, fabs(x));
                uy = sin(atan2(y, fabs(x))) * cos(psi);
                uz = sin(psi);
                key = m->slips & SLIP(22) ? psi : key;
            }
            /* Slip 22 cuts at the face's psi: the elevation, since the face is level, but for slip
             * 24. */
            int row = (int)((key / PI + 0.5) * m->rows);
            m->below[1 + (row < m->rows ? row : m->rows - 1)] +=
                weight * averaged(m, x > 0.0, uy, uz);
            m->front += x > 0.0 ? weight : 0.0;
        }
    }
    for (int i = 0; i < m->rows; i++) {
        m->below[i + 1] += m->below[i];
    }
}

static double sum_below(const model *m, double key) {
    double at = fmin(fmax((key / PI + 0.5) * m->rows, 0.0), m->rows);
    int i = at < m->rows ? (int)at : m->rows - 1;
    return m->below[i] + (at - i) * (m->below[i + 1] - m->below[i]);
}

/* Slip 21: no water is seen before a boundary is reached. */
static double cut(const model *m, double height_m, double d_m) {
    if (d_m <= height_m) {
        return m->slips & SLIP(21) ? 0.0 : 0.5 * PI;
    }
    return asin(height_m / d_m);
}

/* Mean over the whole sphere of what is seen between bottom and surface. Slip 25: the front half's
 * mean, twice. */
static double sphere_mean(const model *m, double d_m) {
    double low = cut(m, DEPTH_M, d_m), high = cut(m, HEIGHT_M, d_m);
    double sum = m->slips & SLIP(22) ? sum_below(m, low) - sum_below(m, -high)
                                     : sum_below(m, high) - sum_below(m, -low);
    double half = sum / m->front, share = m->slips & SLIP(25) ? 2.0 : 0.5;
    if (m->slips & SLIP(12)) {
        return (m->slips & SLIP(25) ? 1.0 : 0.5) * lin((m->slips & SLIP(25) ? 4.0 : 2.0) * half);
    }
    return m->slips & SLIP(13) ? share * half * share * half : share * half;
}

/* ---- bins ------------------------------------------------------------------------------- */

/* 40 log d + 2 (d - 1) alpha / 1000; slip 5: (2 d - 1). */
static double loss_lin(const model *m, double d) {
    double path_m = m->slips & SLIP(5) ? 2.0 * d - 1.0 : 2.0 * (d - 1.0);
    return lin(-40.0 * log10(d) - path_m * m->alpha_db_per_km / 1000.0);
}

static double strength(const model *m, int plane, double sine) {
    return plane == BOTTOM ? bottom_lin(sine) : surface_lin(sine, !(m->slips & SLIP(40)));
}

static double ring_area(double height_m, double begin, double end) {
    double inner = fmax(begin, height_m);
    return PI * (end - inner) * (end + inner);
}

/* Gauss's rule of three points in PANELS panels of t, d = HEIGHT + t^2: no root at the nadir. */
static double plane_lin(const model *m, int plane, double begin, double end) {
    static const double node[3] = {-0.77459666924148338, 0.0, 0.77459666924148338};
    static const double weight[3] = {5.0 / 9.0, 8.0 / 9.0, 5.0 / 9.0};
    double h = plane == BOTTOM ? HEIGHT_M : DEPTH_M, sum = 0.0;
    int panels = begin <= h ? 400 : 40; /* at the zenith the surface law has a cap */
    if (end <= h) {
        return 0.0;
    }
    if (m->slips &
        SLIP(17)) { /* pattern at the middle radius, the rest at the middle slant range */
        double inner = fmax(begin, h);
        double r = 0.5 * (sqrt(inner * inner - h * h) + sqrt(end * end - h * h));
        return loss_lin(m, 0.5 * (begin + end)) * strength(m, plane, 2.0 * h / (end + inner)) *
               ring_mean(m, atan2(h, r)) * ring_area(h, begin, end);
    }
    double from = sqrt(fmax(begin - h, 0.0)), half = 0.5 * (sqrt(end - h) - from) / panels;
    for (int i = 0; i < 3 * panels; i++) {
        double t = from + half * (2 * (i / 3) + 1 + node[i % 3]), d = h + t * t;
        sum += half * weight[i % 3] * 2.0 * t * d * loss_lin(m, d) * strength(m, plane, h / d) *
               2.0 * PI * ring_mean(m, atan2(h, t * sqrt(d + h)));
    }
    return sum;
}

static double volume_lin(const model *m, double begin, double end) {
    const int panels = 200;
    double s = lin(VOLUME_DB + 7.0 * log10(F_KHZ)), step = (end - begin) / panels, sum = 0.0;
    if (m->slips & SLIP(17)) {
        double middle = 0.5 * (begin + end);
        return s * loss_lin(m, middle) * 4.0 / 3.0 * PI * (pow(end, 3) - pow(begin, 3)) *
               sphere_mean(m, middle);
    }
    for (int i = 0; i < panels; i++) {
        double d = begin + (i + 0.5) * step;
        sum += step * d * d * loss_lin(m, d) * 4.0 * PI * sphere_mean(m, d);
    }
    return s * sum;
}

/* All bins of the scenario with SLIPS, linear. */
static void compute(unsigned long long slips, double out[COMPONENTS][BINS]) {
    double c = sound_speed(DEPTH_M), cell_m = c / (2.0 * BANDWIDTH_HZ), area[2] = {0.0, 0.0};
    double wavelength_m =
        c / (1000.0 * F_KHZ) * (slips & SLIP(7) ? 1000.0 : 1.0) * (slips & SLIP(9) ? PI : 1.0);
    model m = {.slips = slips,
               .alpha_db_per_km = absorption(slips & SLIP(1)),
               .length_wl = FACE_M / wavelength_m,
               .turns = !(slips & SLIP(12)) ? 128
                        : slips & SLIP(17)  ? 65536
                                            : 1024};
    fill_sphere(&m);
    memset(out, 0, COMPONENTS * sizeof *out);
    for (int n = 0; n < BINS; n++) {
        double begin = fmax(n * BIN_M, BLANKING_M), end = (n + 1) * BIN_M;
        end = slips & SLIP(26) ? n * BIN_M + floor(BIN_M / cell_m + 1e-9) * cell_m : end;
        out[NOISE][n] = noise_lin(slips);
        for (int plane = BOTTOM; plane <= SURFACE && end > begin; plane++) {
            double h = plane == BOTTOM ? HEIGHT_M : DEPTH_M;
            out[plane][n] = plane_lin(&m, plane, begin, end);
            if (end > h && slips & SLIP(15)) { /* A_n = pi r_n^2 - A_(n-1) */
                area[plane] = PI * (end - h) * (end + h) - area[plane];
                out[plane][n] *= area[plane] / ring_area(h, begin, end);
            }
        }
        out[VOLUME][n] = end > begin ? volume_lin(&m, begin, end) : 0.0;
    }
    free(m.below);
}

/* ---- the table -------------------------------------------------------------------------- */

/* Median, least and largest change over the bins that hold energy, dB. */
static void change(const double *right, const double *wrong, double found[3]) {
    double d[BINS];
    size_t count = 0;
    for (int n = 0; n < BINS; n++) {
        if (right[n] > 0.0) {
            d[count++] = 10.0 * log10(wrong[n] / right[n]);
        }
    }
    asdic_sort_doubles(d, count);
    found[0] = 0.5 * (d[(count - 1) / 2] + d[count / 2]);
    found[1] = d[0];
    found[2] = d[count - 1];
}

/* What a third, independent program found, to its printed digits; NAN: it states none. Number 0 is
 * all that is printed. */
static const struct {
    unsigned number;
    int component;
    double median, least, most, tolerance;
} published[] = {
    {1, BOTTOM, NAN, NAN, 0.013, 0.0006},
    {1, VOLUME, NAN, NAN, NAN, 0.0},
    {5, BOTTOM, -0.034, -0.034, -0.034, 0.0006},
    {5, VOLUME, -0.034, -0.034, -0.034, 0.0006},
    {7, BOTTOM, 17.4, 13.5, NAN, 0.06},
    {7, SURFACE, 22.7, NAN, NAN, 0.06},
    {7, VOLUME, 14.3, NAN, NAN, 0.06},
    {9, BOTTOM, 9.9, NAN, NAN, 0.06},
    {9, SURFACE, 14.4, NAN, NAN, 0.06},
    {9, VOLUME, 7.1, NAN, NAN, 0.06},
    {10, BOTTOM, 17.5, 13.6, NAN, 0.06},
    {10, SURFACE, 22.8, NAN, NAN, 0.06},
    {10, VOLUME, 14.4, NAN, NAN, 0.06},
    {11, BOTTOM, 3.01, 3.01, 3.01, 0.006},
    {11, VOLUME, 3.01, 3.01, 3.01, 0.006},
    {12, BOTTOM, -29.0, -33.0, NAN, 0.5},
    {12, SURFACE, -29.0, -33.0, NAN, 0.5},
    {12, VOLUME, NAN, NAN, NAN, 0.0},
    {13, BOTTOM, -11.5, -11.5, NAN, 0.06},
    {13, VOLUME, -19.9, -22.5, -18.1, 0.06},
    {14, BOTTOM, 3.01, 3.01, 3.01, 0.006},
    {15, BOTTOM, 13.0, 0.0, 15.7, 0.06},
    {17, BOTTOM, 0.0, -32.0, NAN, 0.5},
    {17, SURFACE, 0.0, -63.0, NAN, 0.5},
    {17, VOLUME, NAN, NAN, NAN, 0.0},
    {21, VOLUME, 0.0, -INFINITY, NAN, 0.006},
    {22, VOLUME, 0.0, 0.0, 0.0, 0.006},
    {23, VOLUME, -1.96, NAN, NAN, 0.02},
    {24, VOLUME, -0.013, NAN, NAN, 0.002},
    {25, VOLUME, 6.0206, 6.0206, 6.0206, 1e-4}, /* 10 lg 4: two averages, twice each */
    {26, BOTTOM, -0.49, NAN, NAN, 0.02},
    {26, VOLUME, -0.49, NAN, NAN, 0.02},
    {31, NOISE, -2.28, -2.28, -2.28, 0.01}, /* -4.8 of the wind's part */
    {32, NOISE, 21.5, 21.5, 21.5, 0.06},
    {33, NOISE, -8.2, -8.2, -8.2, 0.1},
    {0, BOTTOM, -13.0, NAN, NAN, 0.5},
    {0, SURFACE, -13.0, NAN, NAN, 0.5},
    {0, VOLUME, 20.8, -50.0, 25.0, 0.5},
};

static void check(const char *what, double found, double expected, double tolerance) {
    if (!isnan(expected)) {
        test_assert_close(found, expected, tolerance, what, __FILE__, __LINE__);
    }
}

static double right[COMPONENTS][BINS];

static void slips_have_their_published_size(void **state) {
    static double wrong[COMPONENTS][BINS];
    unsigned last = ~0u;
    (void)state;
    for (size_t i = 0; i < sizeof published / sizeof *published; i++) {
        unsigned number = published[i].number;
        int k = published[i].component;
        double found[3];
        if (number != last) {
            compute(number ? SLIP(number) : PRINTED, wrong);
            last = number;
        }
        change(right[k], wrong[k], found);
        print_message("slip %2u%s, %-7s %+8.3f [%+.3f, %+.3f] dB\n", number,
                      number ? "" : " (all of 'printed')", names[k], found[0], found[1], found[2]);
        check("median", found[0], published[i].median, published[i].tolerance);
        check("least", found[1], published[i].least, published[i].tolerance);
        check("most", found[2], published[i].most, published[i].tolerance);
    }
}

/* Without a slip this program and the library agree. */
static void right_levels_are_the_librarys(void **state) {
    static const asdic_component component[COMPONENTS] = {ASDIC_BOTTOM, ASDIC_SURFACE, ASDIC_VOLUME,
                                                          ASDIC_NOISE};
    (void)state;
    asdic_environment env = asdic_environment_default();
    asdic_sonar sonar = asdic_sonar_default();
    asdic_beam receiver = sonar.transmitter;
    asdic_flat_scene flat = {.has_surface = true,
                             .has_bottom = true,
                             .altitude_m = HEIGHT_M,
                             .depth_m = DEPTH_M,
                             .bottom = asdic_material_bottom(BOTTOM_TYPE)};
    asdic_pose pose = {{0.0, 0.0, 0.0}, 0.0, 0.0, 0.0};
    asdic_context *ctx = NULL;
    asdic_ping *ping = NULL;
    double worst[COMPONENTS] = {0.0};
    env.max_depth_m = WATER_DEPTH_M;
    sonar.receivers = &receiver;
    sonar.receiver_count = 1;
    assert_int_equal(asdic_context_create(&ctx), ASDIC_OK);
    assert_ok(ctx, asdic_ping_create(ctx, 1, BINS, &ping));
    assert_ok(ctx, asdic_expected_compute(ctx, &flat, &env, &sonar, &pose, ping));
    compute(0, right);
    for (int k = 0; k < COMPONENTS; k++) {
        for (int n = 0; n < BINS; n++) {
            double theirs = ping->intensity_lin[component[k]][n];
            assert_int_equal(theirs > 0.0, right[k][n] > 0.0);
            if (theirs > 0.0) {
                worst[k] = fmax(worst[k], fabs(10.0 * log10(right[k][n] / theirs)));
            }
        }
    }
    for (int k = 0; k < COMPONENTS; k++) {
        print_message("without slips: %s within %.1e dB of the library's levels\n", names[k],
                      worst[k]);
        assert_true(worst[k] < 1e-3);
    }
    asdic_ping_destroy(&ping);
    asdic_context_destroy(&ctx);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(right_levels_are_the_librarys),
        cmocka_unit_test(slips_have_their_published_size),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
