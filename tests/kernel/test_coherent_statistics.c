/* Statistics of coherent pings: level, contrast and law of speckle, what elements, beams and pings share. */
#include "coherent_rig.h"

#include "base/sort.h"

static test_device t;
static bool full; /* as many samples as the goals of docs/coherent.md ask for */

static double sinc(double x) {
    return fabs(x) < 1e-9 ? 1.0 : sin(0.5 * TURN * x) / (0.5 * TURN * x);
}

/* Elements hear what one of them, as a receiver, is expected to hear. */
static void the_mean_is_that_of_intensities(void **state) {
    (void)state;
    enum { ELEMENTS = 16 };
    const uint64_t pings = full ? 160 : 24;
    ping_rig r = array_rig(&t);
    r.env.particle_strength_db = -60.0;
    r.env.max_depth_m = NAN;
    r.sonar.noise_enabled = true;
    r.sonar.source_level_db = 190.0;
    r.sonar.bandwidth_hz = 40e3;
    r.sonar.bin_length_m = 1.0;
    r.sonar.transmitter.length_h_m = 0.0075; /* elements then hear little in common */
    r.sonar.array.elements = ELEMENTS;
    r.sonar.array.spacing_m = WAVELENGTH_M;
    r.sampling.rays = 100000;
    asdic_ping *expected = NULL, *ping = NULL;
    double *mean = NULL;
    size_t each = 0;
    for (uint64_t seed = 1; seed <= pings; seed++) {
        r.sampling.seed = seed;
        asdic_simulator *sim = rig_simulator(&r);
        ping = array_shoot(&r, sim, seed);
        mean = mean ? mean : calloc(ping->bins, sizeof *mean);
        assert_non_null(mean);
        each = ping->samples / ping->bins;
        for (size_t e = 0; e < ELEMENTS; e++) {
            for (size_t n = 0; n < ping->samples; n++) {
                const float *p = array_at(ping, e, n);
                mean[n / each] +=
                    ((double)p[0] * p[0] + (double)p[1] * p[1]) / (double)(pings * ELEMENTS);
            }
        }
        if (!expected) {
            assert_ok(t.ctx, asdic_ping_create(t.ctx, 1, ping->bins, &expected));
        }
        asdic_ping_destroy(&ping);
        asdic_simulator_destroy(&sim);
    }
    asdic_sonar one = r.sonar;
    one.receivers = &r.sonar.array.element;
    asdic_flat_scene flat = rig_flat(&r);
    assert_ok(t.ctx, asdic_expected_compute(t.ctx, &flat, &r.env, &one, &r.pose, expected));
    double squares = 0.0, offset = 0.0, worst = 0.0, pulse = 1500.0 / (2.0 * 40e3);
    size_t count = 0;
    for (size_t n = 1; n < expected->bins; n++, count++) {     /* the blanking cuts the first */
        double level = mean[n] * (1.0 / (double)each) / pulse; /* energy of a bin of a metre */
        double db = 10.0 * log10(level / expected->intensity_lin[ASDIC_TOTAL][n]);
        squares += db * db;
        offset += db;
        worst = fabs(db) > fabs(worst) ? db : worst;
    }
    squares = sqrt(squares / (double)count);
    print_message("mean off by %.3f dB r.m.s. over %zu bins, %.3f dB on average, %.3f dB at most\n",
                  squares, count, offset / (double)count, worst);
    assert_true(squares < (full ? 0.05 : 0.12) && fabs(offset) < 0.05 * (double)count);
    free(mean);
    asdic_ping_destroy(&expected);
    rig_destroy(&r);
}

/* The water's echoes have the energy that is expected, however many there are. */
static void water_has_its_level(void **state) {
    (void)state;
    enum { PINGS = 20, NEAR = 5, FAR = 29 };
    static const uint32_t rays[] = {15000, 500000, 2000000};
    for (size_t k = 0; k < sizeof rays / sizeof *rays; k++) {
        ping_rig r = empty_array(&t);
        asdic_flat_scene flat = {.depth_m = 500.0};
        asdic_ping *expected = NULL;
        r.env.particle_strength_db = -50.0;
        r.sonar.max_range_m = FAR + 1;
        r.sonar.bin_length_m = 1.0;
        r.sonar.transmitter.length_h_m = 0.03;
        r.sampling.rays = rays[k]; /* of which a quarter is water's */
        asdic_simulator *sim = rig_simulator(&r);
        asdic_sonar one = r.sonar;
        one.receivers = &r.sonar.array.element;
        assert_ok(t.ctx, asdic_ping_create(t.ctx, 1, asdic_simulator_bin_count(sim), &expected));
        assert_ok(t.ctx, asdic_expected_compute(t.ctx, &flat, &r.env, &one, &r.pose, expected));
        double sum = 0.0;
        for (uint64_t index = 0; index < PINGS; index++) {
            dev_echo *echoes = NULL;
            size_t count = 0;
            asdic_ping *ping = array_shoot(&r, sim, index);
            asdic_ping_destroy(&ping);
            assert_ok(t.ctx, asdic_coherent_echoes(sim, &echoes, &count));
            for (size_t i = 0; i < count; i++) {
                double range_m = echoes[i].way_m, re = echoes[i].re, im = echoes[i].im;
                if (range_m > NEAR && range_m < FAR) {
                    sum +=
                        (re * re + im * im) / expected->intensity_lin[ASDIC_TOTAL][(size_t)range_m];
                }
            }
            free(echoes);
        }
        double off_db = 10.0 * log10(sum / (PINGS * (FAR - NEAR)));
        print_message("%u rays: water off by %+.3f dB\n", r.sampling.rays, off_db);
        assert_close(off_db, 0.0, 0.1);
        asdic_ping_destroy(&expected);
        asdic_simulator_destroy(&sim);
        rig_destroy(&r);
    }
}

/* Intensities of water alone over their mean: of contrast 1, however few rays are asked for, and in beams ahead and aside. */
static void speckle_of_water_is_rayleigh(void **state) {
    (void)state;
    enum { PINGS = 40, BEAMS = 5, FROM = 40 };
    ping_rig r = empty_array(&t);
    r.env.particle_strength_db = -50.0;
    r.sonar.max_range_m = 20.0;
    r.sonar.bin_length_m = 0.075;
    r.sonar.bandwidth_hz = 10e3;
    r.sonar.transmitter.length_h_m = 0.01;
    r.sonar.transmitter.length_v_m = 0.05;
    r.sonar.array.elements = 64;
    r.sonar.receiver_count = BEAMS;
    for (int b = 0; b < BEAMS; b++) {
        r.receivers[b] = r.receivers[0];
        r.receivers[b].yaw_rad = (b - 2) * 20.0 * RIG_DEGREE;
    }
    r.sampling.rays = 20000;
    asdic_simulator *sim = rig_simulator(&r);
    size_t bins = asdic_simulator_bin_count(sim), cells = BEAMS * bins;
    double *sum = calloc(2 * cells, sizeof *sum), contrast2 = 0.0;
    assert_non_null(sum);
    unsigned long long scatterers = 0;
    for (uint64_t index = 0; index < PINGS; index++) {
        asdic_ping *ping = array_shoot(&r, sim, index);
        scatterers = ping->rays;
        for (size_t i = 0; i < cells; i++) {
            double heard = ping->intensity_lin[ASDIC_TOTAL][i];
            sum[2 * i] += heard / PINGS;
            sum[2 * i + 1] += heard * heard / PINGS;
        }
        asdic_ping_destroy(&ping);
    }
    size_t count = 0;
    for (size_t i = 0; i < cells; i++) {
        if (i % bins >= FROM) {
            /* Of PINGS samples of an exponential, the mean's own variance makes it less. */
            contrast2 +=
                (sum[2 * i + 1] / (sum[2 * i] * sum[2 * i]) - 1.0) * (PINGS + 1.0) / (PINGS - 1.0);
            count++;
        }
    }
    double contrast = sqrt(contrast2 / (double)count);
    print_message("water, %llu scatterers: contrast %.4f\n", scatterers, contrast);
    assert_true(fabs(contrast - 1.0) < 0.03);
    free(sum);
    asdic_simulator_destroy(&sim);
    rig_destroy(&r);
}

/* Flat sand alone. */
static ping_rig sand_rig(void) {
    ping_rig r = array_rig(&t);
    asdic_scene_set_surface(r.scene, false);
    r.sonar.bin_length_m = 0.075;
    r.sonar.array.elements = 16;
    r.sonar.transmitter.length_h_m = 0.03;
    r.sampling.left_out = 1u << ASDIC_TERM_VOLUME; /* which is new in every ping */
    r.sampling.rays = 150000;
    return r;
}

/* Intensities over their mean at that range: exponential, of contrast 1. */
static void speckle_is_rayleigh(void **state) {
    (void)state;
    enum { ELEMENTS = 64, APART = 12, FROM = 2000 };
    const size_t pings = full ? 32 : 6;
    ping_rig r = sand_rig();
    r.sonar.transmitter.length_h_m = 0.0075;
    r.sonar.array.elements = ELEMENTS;
    r.sonar.array.spacing_m = 2.0 * WAVELENGTH_M;
    r.sampling.rays = full ? 1500000 : 400000;
    double *x = NULL;
    size_t rows = 0;
    for (uint64_t seed = 1; seed <= pings; seed++) {
        r.sampling.seed = seed;
        asdic_simulator *sim = rig_simulator(&r);
        asdic_ping *ping = array_shoot(&r, sim, 0);
        rows = (ping->samples - FROM) / APART;
        x = x ? x : calloc(rows * pings * ELEMENTS, sizeof *x);
        assert_non_null(x);
        for (size_t row = 0; row < rows; row++) {
            for (size_t e = 0; e < ELEMENTS; e++) {
                const float *p = array_at(ping, e, FROM + row * APART);
                x[(row * pings + seed - 1) * ELEMENTS + e] =
                    (double)p[0] * p[0] + (double)p[1] * p[1];
            }
        }
        asdic_ping_destroy(&ping);
        asdic_simulator_destroy(&sim);
    }
    size_t count = rows * pings * ELEMENTS;
    double squares = 0.0, most = 0.0;
    for (size_t row = 0; row < rows; row++) { /* the level falls with range */
        double *own = x + row * pings * ELEMENTS, sum = 0.0;
        for (size_t i = 0; i < pings * ELEMENTS; i++) {
            sum += own[i];
        }
        for (size_t i = 0; i < pings * ELEMENTS; i++) {
            own[i] *= pings * ELEMENTS / sum;
            squares += own[i] * own[i];
        }
    }
    double contrast = sqrt(squares / (double)count - 1.0);
    asdic_sort_doubles(x, count);
    for (size_t i = 0; i < count; i++) {
        most = fmax(most, fabs(1.0 - exp(-x[i]) - ((double)i + 0.5) / (double)count));
    }
    print_message("%zu samples: contrast %.4f, Kolmogorov-Smirnov %.2f [1.63]\n", count, contrast,
                  most * sqrt((double)count));
    assert_true(count >= (full ? 1000000 : 100000));
    assert_true(fabs(contrast - 1.0) < 0.01);
    assert_true(most * sqrt((double)count) <
                (full ? 1.63 : 1.95)); /* one in a hundred, a thousand */
    free(x);
    rig_destroy(&r);
}

/* The coherence of what arrives SHIFT wavelengths apart on the line, from a ring of bottom RANGE away, by
 * quadrature over azimuth: transmitter and element have the sides H_WL and OWN_WL. */
static double ring_coherence(double shift, double range, double depth, double h_wl, double own_wl) {
    double level = sqrt(1.0 - depth * depth / (range * range)), re = 0.0, all = 0.0;
    for (int i = -2000; i < 2000; i++) {
        double y = level * sin((i + 0.5) / 2000.0 * 0.25 * TURN);
        double weight = pow(sinc(h_wl * y) * sinc(own_wl * y), 2.0);
        re += weight * cos(TURN * shift * y);
        all += weight;
    }
    return re / all;
}

/* Products of two pressures that are correlated. */
typedef struct pair_sum {
    double aa, bb, re, im;
} pair_sum;

static void add_pair(pair_sum *s, const float *a, const float *b) {
    s->aa += (double)a[0] * a[0] + (double)a[1] * a[1];
    s->bb += (double)b[0] * b[0] + (double)b[1] * b[1];
    s->re += (double)a[0] * b[0] + (double)a[1] * b[1];
    s->im += (double)a[1] * b[0] - (double)a[0] * b[1];
}

/* A pair's coherence, less its EXPECTED one, which is real. */
static double pair_error(const pair_sum *s, double expected) {
    double size = sqrt(s->aa * s->bb);
    return hypot(s->re / size - expected, s->im / size);
}

#define NEAR_M 30.0
#define FAR_M 60.0

/* Van Cittert and Zernike: elements are as coherent as the arriving field's spectrum of angles says. */
static void elements_share_what_theory_says(void **state) {
    (void)state;
    enum { PINGS = 20, LAGS = 8 };
    ping_rig r = sand_rig();
    pair_sum sums[LAGS + 1] = {{0}};
    for (uint64_t seed = 1; seed <= PINGS; seed++) {
        r.sampling.seed = seed;
        asdic_simulator *sim = rig_simulator(&r);
        asdic_ping *ping = array_shoot(&r, sim, 0);
        for (size_t n = (size_t)(NEAR_M / ping->sample_m); n < FAR_M / ping->sample_m; n++) {
            for (size_t e = 0; e < ping->elements; e++) {
                for (size_t lag = 0; lag <= LAGS && e + lag < ping->elements; lag++) {
                    add_pair(&sums[lag], array_at(ping, e, n), array_at(ping, e + lag, n));
                }
            }
        }
        asdic_ping_destroy(&ping);
        asdic_simulator_destroy(&sim);
    }
    double worst = 0.0;
    for (int lag = 0; lag <= LAGS; lag++) {
        double theory = ring_coherence(0.5 * lag, 42.0, 5.0, 2.0, 0.5);
        double error = pair_error(&sums[lag], theory);
        print_message("%d half wavelengths: %.3f, theory %.3f\n", lag,
                      sums[lag].re / sqrt(sums[lag].aa * sums[lag].bb), theory);
        worst = fmax(worst, error);
    }
    assert_true(worst < 0.02);
    rig_destroy(&r);
}

/* A vehicle at rest hears the same speckle; sideways, it is lost as twice the way says, also from one of the pieces that
 * the bottom is cut into, which join at 0, into the next. */
static void speckle_stays_on_the_bottom(void **state) {
    (void)state;
    enum { SEEDS = 20, MOVES = 5 };
    static const double moved_wl[MOVES] = {0.0, 0.125, 0.25, 0.5, 1.0};
    ping_rig r = sand_rig();
    pair_sum sums[MOVES] = {{0}};
    for (uint64_t seed = 1; seed <= SEEDS; seed++) {
        r.sampling.seed = seed;
        r.pose.position_m.x = 0.37 * (double)seed;
        r.pose.position_m.y = -1e-6;
        asdic_simulator *sim = rig_simulator(&r);
        asdic_ping *first = array_shoot(&r, sim, 0);
        double from = r.pose.position_m.y;
        for (int m = 0; m < MOVES; m++) {
            r.pose.position_m.y = from + moved_wl[m] * WAVELENGTH_M;
            asdic_ping *ping = array_shoot(&r, sim, 7);
            if (m == 0) {
                size_t bytes = 2 * ping->elements * ping->samples * sizeof(float);
                assert_memory_equal(ping->pressure, first->pressure, bytes);
            }
            for (size_t n = (size_t)(NEAR_M / ping->sample_m); n < FAR_M / ping->sample_m; n++) {
                for (size_t e = 0; e < ping->elements; e++) {
                    add_pair(&sums[m], array_at(first, e, n), array_at(ping, e, n));
                }
            }
            asdic_ping_destroy(&ping);
        }
        asdic_ping_destroy(&first);
        asdic_simulator_destroy(&sim);
    }
    double worst = 0.0;
    for (int m = 0; m < MOVES; m++) {
        double theory = ring_coherence(2.0 * moved_wl[m], 42.0, 5.0, 2.0, 0.5);
        print_message("%.3f wavelengths sideways: %.3f, theory %.3f\n", moved_wl[m],
                      sums[m].re / sqrt(sums[m].aa * sums[m].bb), theory);
        worst = fmax(worst, pair_error(&sums[m], theory));
    }
    assert_true(worst < 0.05);
    rig_destroy(&r);
}

/* On the way ahead all echoes of a narrow beam come nearer by as much: the phase turns by twice the way, and nothing
 * else changes. */
static void speckle_turns_as_it_comes_nearer(void **state) {
    (void)state;
    enum { SEEDS = 4, MOVES = 3 };
    static const double moved_wl[MOVES] = {0.0625, 0.125, -0.25};
    ping_rig r = sand_rig();
    r.sonar.transmitter.length_h_m = 20.0 * WAVELENGTH_M;
    pair_sum sums[MOVES] = {{0}};
    for (uint64_t seed = 1; seed <= SEEDS; seed++) {
        r.sampling.seed = seed;
        r.pose.position_m.x = 0.0;
        asdic_simulator *sim = rig_simulator(&r);
        asdic_ping *first = array_shoot(&r, sim, 0);
        for (int m = 0; m < MOVES; m++) {
            r.pose.position_m.x = moved_wl[m] * WAVELENGTH_M;
            asdic_ping *ping = array_shoot(&r, sim, 0);
            for (size_t n = (size_t)(NEAR_M / ping->sample_m); n < FAR_M / ping->sample_m; n++) {
                for (size_t e = 0; e < ping->elements; e++) {
                    add_pair(&sums[m], array_at(first, e, n), array_at(ping, e, n));
                }
            }
            asdic_ping_destroy(&ping);
        }
        asdic_ping_destroy(&first);
        asdic_simulator_destroy(&sim);
    }
    for (int m = 0; m < MOVES; m++) {
        double size = sqrt(sums[m].aa * sums[m].bb), phase = -2.0 * TURN * moved_wl[m];
        double re = sums[m].re / size, im = sums[m].im / size;
        print_message("%.3f wavelengths ahead: %.3f %+.3f i, of %.3f %+.3f i\n", moved_wl[m], re,
                      im, cos(phase), sin(phase));
        assert_true(hypot(re - cos(phase), im - sin(phase)) < 0.05);
    }
    rig_destroy(&r);
}

/* docs/coherent.md: a pulse as long as a cell, with smooth edges, whose squares add up to 1. */
static double smooth_pulse(double x) {
    double u = fmin(fmax(1.5 - 2.0 * fabs(x), 0.0), 1.0);
    return sin(0.25 * TURN * u * u * (3.0 - 2.0 * u));
}

/* Noise in an empty sea, the second time also the elements' own: as loud at elements and in beams as in pings of intensities, and of the pulse's band, that
 * is, as coherent from sample to sample as the pulse with itself, whether this is longer than a metre or shorter. */
static void noise_has_the_band_and_level_of_the_pulse(void **state) {
    (void)state;
    enum { LAGS = 16, PINGS = 40, BESIDE = LAGS + 1 };
    static const double bands_hz[] = {300.0, 1875.0}; /* pulses of 2.5 and 0.4 m */
    for (size_t band = 0; band < 2; band++) {
        ping_rig r = empty_array(&t);
        double pulse_m = 1500.0 / (2.0 * bands_hz[band]), samples = 0.0, beams = 0.0;
        r.sonar.noise_enabled = true;
        r.sonar.self_noise_db = band == 0 ? -INFINITY : 60.0;
        r.sonar.bandwidth_hz = bands_hz[band];
        r.sonar.bin_length_m = 2.0 * pulse_m;
        r.sonar.max_range_m = 60.0 * pulse_m;
        r.receivers[1] = r.sonar.array.element;
        asdic_simulator *sim = rig_simulator(&r);
        asdic_flat_scene nothing = {.altitude_m = NAN};
        asdic_ping *expected = NULL;
        asdic_sonar one = r.sonar;
        one.receivers = &r.receivers[1];
        one.array.elements = 0;
        assert_ok(t.ctx, asdic_ping_create(t.ctx, 1, asdic_simulator_bin_count(sim), &expected));
        assert_ok(t.ctx, asdic_expected_compute(t.ctx, &nothing, &r.env, &one, &r.pose, expected));
        pair_sum sums[BESIDE + 1] = {{0}};
        for (uint64_t k = 0; k < PINGS; k++) {
            asdic_ping *ping = array_shoot(&r, sim, k);
            assert_close_relative(ping->sample_m, 0.125 * pulse_m, 1e-5);
            for (size_t e = 0; e + 1 < ping->elements; e++) {
                for (size_t n = 0; n + LAGS < ping->samples; n++) {
                    for (size_t lag = 0; lag <= LAGS; lag++) {
                        add_pair(&sums[lag], array_at(ping, e, n), array_at(ping, e, n + lag));
                    }
                    add_pair(&sums[BESIDE], array_at(ping, e, n), array_at(ping, e + 1, n));
                }
            }
            for (size_t n = 1; n < ping->bins; n++) { /* the blanking cuts the first */
                beams += ping->intensity_lin[ASDIC_TOTAL][n] / ping->intensity_lin[ASDIC_NOISE][n] /
                         (double)(PINGS * (ping->bins - 1));
            }
            samples += (double)(ping->elements - 1) * (double)(ping->samples - LAGS);
            asdic_ping_destroy(&ping);
        }
        double bin_lin = sums[0].aa / samples * 2.0; /* of two pulses */
        double level_db = 10.0 * log10(bin_lin / expected->intensity_lin[ASDIC_NOISE][5]);
        print_message("noise of %g Hz: %.3f dB off at elements, %.2f dB in beams\n", bands_hz[band],
                      level_db, 10.0 * log10(beams));
        assert_true(fabs(level_db) < 0.05 && fabs(10.0 * log10(beams)) < 0.3);
        for (size_t lag = 1; lag <= BESIDE; lag++) {
            double with = 0.0;
            for (int i = -800; lag < BESIDE && i < 800; i++) {
                with +=
                    1e-3 * smooth_pulse(1e-3 * i) * smooth_pulse(1e-3 * i + 0.125 * (double)lag);
            }
            double off = pair_error(&sums[lag], with);
            print_message("%zu: coherence %.3f, off by %.3f\n", lag, with, off);
            assert_true(off < 0.02);
        }
        asdic_ping_destroy(&expected);
        asdic_simulator_destroy(&sim);
        rig_destroy(&r);
    }
}

/* An element hears the noise of its band, however long bins are, and all of it where directivity is not taken off:
 * that beams then have more makes no element louder. 40 dB re 1 uPa^2 / Hz of 10 kHz are 80 dB of its own. */
static void elements_hear_their_band(void **state) {
    (void)state;
    enum { PINGS = 20 };
    static const double cells[] = {1.0, 1.47, 2.36};
    for (int k = 0; k < 6; k++) {
        ping_rig r = empty_array(&t);
        r.sonar.noise_enabled = true;
        r.sonar.noise_directivity = k < 3;
        r.sonar.bandwidth_hz = 1e4;
        r.sonar.self_noise_db = k < 3 ? 40.0 : -INFINITY;
        r.sonar.bin_length_m = 0.075 * cells[k % 3];
        r.sonar.max_range_m = 60.0;
        r.env.shipping_density = 0.5;
        r.env.wind_speed_kn = 10.0; /* `asdic model noise`: 69.09 dB */
        double directivity =
            4.0 * 180.0 * RIG_DEGREE * 0.0075 * 0.05 / (WAVELENGTH_M * WAVELENGTH_M);
        double band = pow(10.0, 6.909) / (k < 3 ? directivity : 1.0) + (k < 3 ? 1e8 : 0.0);
        asdic_simulator *sim = rig_simulator(&r);
        double sum = 0.0, samples = 0.0, beams = 0.0;
        for (uint64_t i = 0; i < PINGS; i++) {
            asdic_ping *ping = array_shoot(&r, sim, i);
            for (size_t e = 0; e < ping->elements; e++) {
                for (size_t n = 16; n < ping->samples; n++) {
                    const float *p = array_at(ping, e, n);
                    sum += (double)p[0] * p[0] + (double)p[1] * p[1];
                    samples += 1.0;
                }
            }
            for (size_t n = 4; n < ping->bins; n++) {
                beams += ping->intensity_lin[ASDIC_TOTAL][n] / ping->intensity_lin[ASDIC_NOISE][n] /
                         (double)(PINGS * (ping->bins - 4));
            }
            asdic_ping_destroy(&ping);
        }
        double off_db = 10.0 * log10(sum / samples / band), beam_db = 10.0 * log10(beams);
        print_message("bins of %.2f cells: elements off by %.3f dB, beams by %.2f\n", cells[k % 3],
                      off_db, beam_db);
        assert_true(fabs(off_db) < 0.1 && fabs(beam_db) < 0.3);
        asdic_simulator_destroy(&sim);
        rig_destroy(&r);
    }
}

int main(int argc, char **argv) {
    full = argc > 1 && strcmp(argv[1], "--full") == 0;
    t = test_device_open_or_skip();
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_mean_is_that_of_intensities),
        cmocka_unit_test(water_has_its_level),
        cmocka_unit_test(speckle_of_water_is_rayleigh),
        cmocka_unit_test(noise_has_the_band_and_level_of_the_pulse),
        cmocka_unit_test(elements_hear_their_band),
        cmocka_unit_test(speckle_is_rayleigh),
        cmocka_unit_test(elements_share_what_theory_says),
        cmocka_unit_test(speckle_stays_on_the_bottom),
        cmocka_unit_test(speckle_turns_as_it_comes_nearer),
    };
    return test_device_end(&t, cmocka_run_group_tests(tests, NULL, NULL));
}
