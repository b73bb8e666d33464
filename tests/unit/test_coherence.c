/* What receivers hear in common against an integral over the sphere, and drawn speckle against
 * both. */
#include "asserts.h"
#include "test_context.h"

#include "sim/coherence.h"
#include "sim/speckle.h"

#include "../../kernels/coherent.h"

#include <stdlib.h>

#define PI 3.14159265358979323846
#define DEGREE (PI / 180.0)
#define SPEED 1500.0
#define WAVELENGTH 0.015 /* at 100 kHz */
#define MOST 8

static double sinc(double x) {
    return fabs(x) < 1e-9 ? 1.0 : sin(PI * x) / (PI * x);
}

/* Amplitude towards (X, Y, Z): x ahead, y starboard, z down; yaw, then pitch, then roll, by
 * hand. */
static double amplitude(const asdic_beam *b, double x, double y, double z) {
    double ahead = x * cos(b->yaw_rad) + y * sin(b->yaw_rad);
    double side = y * cos(b->yaw_rad) - x * sin(b->yaw_rad);
    double out = ahead * cos(b->pitch_rad) + z * sin(b->pitch_rad);
    double down = z * cos(b->pitch_rad) - ahead * sin(b->pitch_rad);
    double h = side * cos(b->roll_rad) + down * sin(b->roll_rad);
    double v = down * cos(b->roll_rad) - side * sin(b->roll_rad);
    return out <= 0.0 ? 0.0
                      : sinc(b->length_h_m / WAVELENGTH * h) * sinc(b->length_v_m / WAVELENGTH * v);
}

/* rho of all pairs by the midpoint rule over the front, in thousandths of the sphere's
 * circumference. */
static void integrate(const asdic_sonar *s, double rho[MOST][MOST]) {
    enum { AZIMUTHS = 2000, ELEVATIONS = 500 };
    double sum[MOST][MOST] = {{0.0}}, a[MOST];
    for (int e = 0; e < ELEVATIONS; e++) {
        double el = PI * ((e + 0.5) / ELEVATIONS - 0.5);
        for (int k = 0; k < AZIMUTHS; k++) {
            double az = 2.0 * PI * (k + 0.5) / AZIMUTHS;
            double x = cos(el) * cos(az), y = cos(el) * sin(az), z = sin(el);
            double sent = amplitude(&s->transmitter, x, y, z);
            if (fabs(sent) < 1e-4) {
                continue;
            }
            for (size_t i = 0; i < s->receiver_count; i++) {
                a[i] = sent * amplitude(&s->receivers[i], x, y, z);
                for (size_t j = 0; j <= i; j++) {
                    sum[i][j] += a[i] * a[j] * cos(el);
                }
            }
        }
    }
    for (size_t i = 0; i < s->receiver_count; i++) {
        for (size_t j = 0; j <= i; j++) {
            rho[i][j] = rho[j][i] = sum[i][j] / sqrt(sum[i][i] * sum[j][j]);
        }
    }
}

/* The same from the lists of sources. */
static void add_up(const asdic_sonar *s, double rho[MOST][MOST]) {
    asdic_coherence c;
    assert_ok(ctx, asdic_coherence_init(&c, ctx, s, WAVELENGTH));
    double *weight = calloc(c.sources, sizeof *weight);
    for (size_t i = 0; i < c.receivers; i++) {
        for (size_t k = c.first[i]; k < c.first[i + 1]; k++) {
            weight[c.source[k]] = (double)c.weight[k];
        }
        for (size_t j = 0; j < c.receivers; j++) {
            rho[i][j] = 0.0;
            for (size_t k = c.first[j]; k < c.first[j + 1]; k++) {
                rho[i][j] += weight[c.source[k]] * (double)c.weight[k];
            }
        }
        for (size_t k = c.first[i]; k < c.first[i + 1]; k++) {
            weight[c.source[k]] = 0.0;
        }
        assert_close(rho[i][i], 1.0, 1e-5);
    }
    free(weight);
    asdic_coherence_finish(&c);
}

/* The correlation of intensities as drawn. */
static void draw(const asdic_sonar *s, double rho2[MOST][MOST]) {
    enum { BINS = 1000, PINGS = 60 };
    asdic_speckle_field *field = NULL;
    asdic_ping *ping = NULL;
    assert_ok(ctx, asdic_speckle_create(ctx, s, SPEED, BINS, 1, &field));
    assert_ok(ctx, asdic_ping_create(ctx, s->receiver_count, BINS, &ping));
    const double *x = ping->intensity_lin[ASDIC_TOTAL];
    double sum[MOST][MOST] = {{0.0}};
    for (size_t i = 0; i < s->receiver_count * BINS; i++) {
        ping->intensity_lin[ASDIC_SURFACE][i] = 1.0;
    }
    for (uint64_t p = 0; p < PINGS; p++) {
        asdic_speckle_apply(field, SPEED, 3, p, ping);
        for (size_t n = 0; n < BINS; n++) {
            for (size_t i = 0; i < s->receiver_count; i++) {
                for (size_t j = 0; j < s->receiver_count; j++) {
                    sum[i][j] += (x[i * BINS + n] - 1.0) * (x[j * BINS + n] - 1.0);
                }
            }
        }
    }
    for (size_t i = 0; i < s->receiver_count; i++) {
        assert_close(sum[i][i] / (PINGS * BINS), 1.0, 0.05);
        for (size_t j = 0; j < s->receiver_count; j++) {
            rho2[i][j] = sum[i][j] / sqrt(sum[i][i] * sum[j][j]);
        }
    }
    asdic_ping_destroy(&ping);
    asdic_speckle_destroy(&field);
}

static asdic_sonar sonar_of(const asdic_beam *receivers, size_t count, double sent_h_m,
                            double sent_v_m) {
    asdic_sonar s = asdic_sonar_default();
    s.speckle = ASDIC_SPECKLE_RAYLEIGH;
    s.bandwidth_hz = SPEED / (2.0 * s.bin_length_m);
    s.transmitter.length_h_m = sent_h_m;
    s.transmitter.length_v_m = sent_v_m;
    s.receivers = receivers;
    s.receiver_count = count;
    return s;
}

static void check(const char *name, const asdic_sonar *s) {
    double theory[MOST][MOST], summed[MOST][MOST], drawn[MOST][MOST], worst = 0.0, off = 0.0;
    integrate(s, theory);
    add_up(s, summed);
    draw(s, drawn);
    for (size_t i = 0; i < s->receiver_count; i++) {
        for (size_t j = 0; j < i; j++) {
            double rho2 = theory[i][j] * theory[i][j];
            worst = fmax(worst, fabs(summed[i][j] * summed[i][j] - rho2));
            off = fmax(off, fabs(drawn[i][j] - rho2));
        }
    }
    print_message("%-28s first pair %.3f, off by %.3f; as drawn %.3f\n", name,
                  theory[1][0] * theory[1][0], worst, off);
    assert_true(worst < 0.04);
    assert_true(off < 0.05);
}

/* Equal receivers in a wide transmitter's beam: sinc(L sin D)^2. */
static void equal_receivers_have_the_closed_form(void **state) {
    (void)state;
    static const double lengths_wl[] = {9.7, 25.2, 50.3, 131.0};
    for (int k = 0; k < 4; k++) {
        double length = lengths_wl[k], drawn[MOST][MOST];
        asdic_beam beams[MOST] = {{.length_h_m = 0.0}};
        for (int i = 0; i < MOST; i++) {
            beams[i].length_h_m = length * WAVELENGTH;
            beams[i].length_v_m = 5.0 * WAVELENGTH;
            beams[i].yaw_rad = 0.1 + (i * i * 0.03 + 0.2 * i) / length;
        }
        asdic_sonar s = sonar_of(beams, MOST, 0.1 * WAVELENGTH, 5.0 * WAVELENGTH);
        draw(&s, drawn);
        for (int i = 0; i < MOST; i++) {
            for (int j = 0; j < i; j++) {
                double apart = sin(beams[i].yaw_rad - beams[j].yaw_rad);
                assert_close(drawn[i][j], pow(sinc(length * apart), 2), 0.05);
            }
        }
    }
}

static void all_receivers_have_the_integral(void **state) {
    (void)state;
    asdic_beam b[MOST] = {{.length_h_m = 0.0}};
    for (int i = 0; i < MOST; i++) {
        b[i] = (asdic_beam){.length_h_m = 0.2, .length_v_m = 0.05, .yaw_rad = 1.0 * i * DEGREE};
    }
    asdic_sonar s = sonar_of(b, MOST, 0.05, 0.05);
    check("fan", &s);
    s.transmitter.length_h_m = 0.4;
    check("fan in a narrower beam", &s);
    for (int i = 0; i < MOST; i++) {
        b[i].pitch_rad = 25.0 * DEGREE;
    }
    s.transmitter = b[4];
    s.transmitter.length_h_m = 0.02;
    check("fan that looks down", &s);
    for (int i = 0; i < MOST; i++) {
        b[i] = (asdic_beam){.length_h_m = 0.05, .length_v_m = 0.05, .pitch_rad = 10.0 * i * DEGREE};
    }
    s = sonar_of(b, MOST, 0.05, 0.05);
    check("stack in a narrow beam", &s);
    s = sonar_of(b, MOST, 0.05, 0.01);
    check("stack in a wide one", &s);
    for (int i = 0; i < MOST; i++) {
        b[i] = (asdic_beam){.length_h_m = 0.03 * (i + 1),
                            .length_v_m = 0.21 - 0.02 * i,
                            .roll_rad = 0.7 * i,
                            .yaw_rad = 0.03 * i,
                            .pitch_rad = -0.02 * i};
    }
    s = sonar_of(b, MOST, 0.05, 0.02);
    check("unequal ones, rolled", &s);
    for (int i = 0; i < MOST; i++) {
        b[i] = (asdic_beam){.length_h_m = 0.01, .length_v_m = 0.006, .yaw_rad = 0.5 * (i - 3.5)};
    }
    s = sonar_of(b, MOST, 0.004, 0.03);
    check("small ones all round", &s);
    /* Whose sides are seen foreshortened; that share one direction. */
    for (int i = 0; i < MOST; i++) {
        b[i] = (asdic_beam){.length_h_m = 0.4,
                            .length_v_m = 0.05,
                            .pitch_rad = 60.0 * DEGREE,
                            .yaw_rad = 0.02625 * i};
    }
    s = sonar_of(b, 4, 0.01, 0.01);
    check("long ones, steep", &s);
    for (int i = 0; i < 3; i++) {
        b[i] = (asdic_beam){
            .length_h_m = 0.03, .length_v_m = 0.2, .pitch_rad = (1.0 + 6.2 * i) * DEGREE};
    }
    s = sonar_of(b, 3, 0.05, 0.02);
    check("three above each other", &s);
}

/* Beams that are one and the same have the same speckle; those that share nothing have none in
 * common, the one behind hears noise. */
static void the_same_and_the_different(void **state) {
    (void)state;
    asdic_beam b[4] = {{.length_h_m = 0.0}};
    for (int i = 0; i < 4; i++) {
        b[i] = asdic_sonar_default().transmitter;
    }
    b[2].yaw_rad = PI;
    b[3].yaw_rad = 60.0 * DEGREE;
    b[3].length_h_m = 0.3;
    asdic_sonar s = sonar_of(b, 4, 0.05, 0.05);
    double drawn[MOST][MOST];
    draw(&s, drawn);
    assert_close(drawn[0][1], 1.0, 1e-12);
    assert_close(drawn[0][2], 0.0, 0.02);
    assert_close(drawn[0][3], 0.0, 0.05);
}

/* Of a patch's first 2^n scatterers each has a 2^n-th of either edge to itself, wherever the lattice starts. */
static void scatterers_share_a_patch_evenly(void **state) {
    static const uint32_t starts[] = {0u, 1u, 0x12345678u, 0x7fffffffu, 0xfedcba98u};
    (void)state;
    for (size_t i = 0; i < sizeof starts / sizeof *starts; i++) {
        for (uint32_t n = 0; 1u << n <= DEV_PATCH_SCATTERERS; n++) {
            uint64_t first = 0, second = 0, all = n == 6 ? ~0ull : (1ull << (1u << n)) - 1;
            for (uint32_t k = 0; k < 1u << n; k++) {
                uint64_t one = lattice_first(starts[i], k) - starts[i];
                uint64_t other = (uint32_t)(lattice_second(starts[i], k) - starts[i]);
                first |= 1ull << ((one << n) >> 32);
                second |= 1ull << ((other << n) >> 32);
            }
            assert_true(first == all && second == all);
        }
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(equal_receivers_have_the_closed_form),
        cmocka_unit_test(all_receivers_have_the_integral),
        cmocka_unit_test(the_same_and_the_different),
        cmocka_unit_test(scatterers_share_a_patch_evenly),
    };
    return cmocka_run_group_tests(tests, context_begin, context_end);
}
