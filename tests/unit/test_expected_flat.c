/* The expected ping for any aim and geometry: against a plain sum over the scene, against what
 * symmetry and geometry demand, and in every hard case that can be thought of. */
#include "asserts.h"

#include <asdic/asdic.h>

#include "../../kernels/backscatter.h"
#include "../../kernels/water.h"

#include <stdlib.h>
#include <time.h>

#define PI 3.14159265358979323846
#define DEGREE (PI / 180.0)
/* The plain sum converges as 1 / steps where a face's edge crosses it: 0.06 dB are left at 600 steps
 * in the worst of these cases, 0.02 at 2400. */
#define TOLERANCE_DB 0.1

typedef struct setup {
    asdic_context *ctx;
    asdic_environment env;
    asdic_sonar sonar;
    asdic_beam receiver;
    asdic_flat_scene flat;
    asdic_pose pose;
} setup;

static setup begin(void) {
    setup s = {.env = asdic_environment_default(), .sonar = asdic_sonar_default()};
    s.sonar.noise_enabled = false;
    s.sonar.receiver_count = 1;
    s.receiver = s.sonar.transmitter;
    s.flat = (asdic_flat_scene){.has_surface = true,
                                .has_bottom = true,
                                .altitude_m = 5.0,
                                .depth_m = 7.0,
                                .bottom = asdic_material_bottom(2.0)};
    assert_int_equal(asdic_context_create(&s.ctx), ASDIC_OK);
    return s;
}

static asdic_ping *compute(setup *s, size_t bins) {
    asdic_ping *ping = NULL;
    s->sonar.receivers = &s->receiver;
    assert_ok(s->ctx, asdic_ping_create(s->ctx, 1, bins, &ping));
    assert_ok(s->ctx, asdic_expected_compute(s->ctx, &s->flat, &s->env, &s->sonar, &s->pose, ping));
    for (int c = 0; c < ASDIC_COMPONENT_COUNT; c++) {
        for (size_t n = 0; n < bins; n++) {
            double x = ping->intensity_lin[c][n];
            if (!(isfinite(x) && x >= 0.0)) {
                print_error("component %d, bin %zu: %g\n", c, n, x);
                fail();
            }
        }
    }
    return ping;
}

static void end(setup *s) {
    asdic_context_destroy(&s->ctx);
}

/* ---- a plain sum, written without the library's geometry ---- */

static asdic_vec3 turn(asdic_vec3 v, double angle, int axis) {
    double c = cos(angle), s = sin(angle);
    switch (axis) {
    case 0:
        return (asdic_vec3){v.x, c * v.y + s * v.z, -s * v.y + c * v.z};
    case 1:
        return (asdic_vec3){c * v.x - s * v.z, v.y, s * v.x + c * v.z};
    default:
        return (asdic_vec3){c * v.x + s * v.y, -s * v.x + c * v.y, v.z};
    }
}

/* sin(pi x) / (pi x) */
static double plain_sinc(double x) {
    return fabs(x) < 1e-9 ? 1.0 : sin(PI * x) / (PI * x);
}

/* One-way gain towards the world direction V: yaw, pitch, roll of the vehicle, then of the beam. */
static double plain_gain(const setup *s, const asdic_beam *beam, double wavelength_m,
                         asdic_vec3 v) {
    v = turn(v, s->pose.yaw_rad, 2);
    v = turn(v, s->pose.pitch_rad, 1);
    v = turn(v, s->pose.roll_rad, 0);
    v = turn(v, beam->yaw_rad, 2);
    v = turn(v, -beam->pitch_rad, 1);
    v = turn(v, beam->roll_rad, 0);
    double a = plain_sinc(beam->length_h_m / wavelength_m * v.y) *
               plain_sinc(beam->length_v_m / wavelength_m * v.z);
    return v.x > 0.0 ? a * a : a * a * pow(10.0, 0.1 * s->sonar.rear_floor_db);
}

/* Where sample I of STEPS of component K (bottom, surface, volume) of the bin [D0, D1] is: the sine
 * of its elevation, its range, and its share of the area or volume times scattering strength. */
typedef struct plain_row {
    double z, d_m, weight;
} plain_row;

static plain_row plain_boundary(const setup *s, bool surface, double d0, double d1, int i,
                                int steps) {
    double h = surface ? s->flat.depth_m : s->flat.altitude_m, inner = fmax(d0, h);
    double step2 = (d1 * d1 - inner * inner) / steps; /* equal areas */
    double d = sqrt(inner * inner + (i + 0.5) * step2), f_khz = s->sonar.frequency_hz / 1e3;
    double wind = s->env.wind_speed_kn, bt = asdic_material_get(&s->flat.bottom, "type");
    double strength =
        surface ? surface_backscatter_lin(surface_gain(wind, f_khz), surface_beta0(wind),
                                          surface_beta1(f_khz), surface_cap_lin(wind), h / d)
                : bottom_backscatter_lin(bottom_gain(bt, f_khz), bottom_peak(bt), bt, h / d);
    double area = d1 > h ? 0.5 * step2 * 2.0 * PI : 0.0;
    return (plain_row){d1 > h ? (surface ? -h : h) / d : 0.0, d, area * strength};
}

/* Four shells take turns. */
static plain_row plain_volume(const setup *s, double d0, double d1, int i, int steps) {
    double d = d0 + (i % 4 + 0.5) / 4.0 * (d1 - d0);
    double low = -fmin(s->flat.depth_m / d, 1.0), high = fmin(s->flat.altitude_m / d, 1.0);
    double strength = pow(10.0, 0.1 * volume_backscatter_db(s->env.particle_strength_db,
                                                            s->sonar.frequency_hz / 1e3));
    return (plain_row){low + (high - low) * (i + 0.5) / steps, d,
                       (high - low) / steps * 2.0 * PI * d * d * (d1 - d0) * strength};
}

/* The energies of BIN by the midpoint rule on STEPS^2 directions each. */
static void plain_bin(const setup *s, size_t bin, int steps, double out[3]) {
    double c =
        sound_speed_medwin_mps(s->env.temperature_degc, s->env.salinity_ppt, s->flat.depth_m);
    double wavelength_m = c / s->sonar.frequency_hz;
    double alpha = absorption_db_per_km(s->sonar.frequency_hz / 1e3, s->env.temperature_degc,
                                        s->env.salinity_ppt, s->flat.depth_m, s->env.ph);
    double d0 = (double)bin * s->sonar.bin_length_m, d1 = d0 + s->sonar.bin_length_m;
    for (int k = 0; k < 3; k++) {
        out[k] = 0.0;
        for (int i = 0; i < steps; i++) {
            plain_row row = k == 2 ? plain_volume(s, d0, d1, i, steps)
                                   : plain_boundary(s, k == 1, d0, d1, i, steps);
            double m = sqrt((1.0 - row.z) * (1.0 + row.z)), sum = 0.0;
            for (int j = 0; j < steps && row.weight > 0.0; j++) {
                double phi = 2.0 * PI * (j + 0.5) / steps;
                asdic_vec3 v = {m * cos(phi), m * sin(phi), row.z};
                sum += plain_gain(s, &s->sonar.transmitter, wavelength_m, v) *
                       plain_gain(s, &s->receiver, wavelength_m, v);
            }
            out[k] += row.weight * transmission_lin(row.d_m, alpha) * sum / steps;
        }
    }
}

static void any_aim_agrees_with_a_plain_sum(void **state) {
    (void)state;
    static const struct {
        double tx[3], rx[3], vehicle[3]; /* pitch, yaw, roll, degrees */
        double lengths_m[4], altitude_m, depth_m, rear_db;
    } cases[] = {
        {{0, 0, 0}, {20, 0, 0}, {0, 0, 0}, {0.05, 0.05, 0.05, 0.05}, 5, 7, -INFINITY},
        {{0, 0, 0}, {-20, 0, 0}, {0, 0, 0}, {0.05, 0.05, 0.05, 0.05}, 5, 7, -INFINITY},
        {{5, 10, 0}, {-8, -25, 30}, {4, 130, -7}, {0.05, 0.08, 0.03, 0.06}, 5.3, 6.1, -INFINITY},
        {{80, 0, 0}, {85, 20, 10}, {0, 0, 20}, {0.05, 0.08, 0.03, 0.06}, 5.3, 6.1, -INFINITY},
        {{-70, 15, 5}, {-60, -15, 0}, {-25, 45, 170}, {0.04, 0.02, 0.03, 0.06}, 8, 3, -INFINITY},
        {{0, 0, 45}, {10, 90, 45}, {10, 0, 0}, {0.1, 0.02, 0.1, 0.02}, 5, 7, -20.0},
    };
    static const size_t bins[] = {6, 10, 14, 24, 120};
    static const asdic_component component[3] = {ASDIC_BOTTOM, ASDIC_SURFACE, ASDIC_VOLUME};
    double worst = 0.0;
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        setup s = begin();
        asdic_beam *beams[2] = {&s.sonar.transmitter, &s.receiver};
        for (int b = 0; b < 2; b++) {
            const double *aim = b ? cases[k].rx : cases[k].tx;
            beams[b]->pitch_rad = aim[0] * DEGREE;
            beams[b]->yaw_rad = aim[1] * DEGREE;
            beams[b]->roll_rad = aim[2] * DEGREE;
            beams[b]->length_h_m = cases[k].lengths_m[2 * b];
            beams[b]->length_v_m = cases[k].lengths_m[2 * b + 1];
        }
        s.pose.pitch_rad = cases[k].vehicle[0] * DEGREE;
        s.pose.yaw_rad = cases[k].vehicle[1] * DEGREE;
        s.pose.roll_rad = cases[k].vehicle[2] * DEGREE;
        s.flat.altitude_m = cases[k].altitude_m;
        s.flat.depth_m = cases[k].depth_m;
        s.sonar.rear_floor_db = cases[k].rear_db;
        asdic_ping *ping = compute(&s, 130);
        for (size_t i = 0; i < sizeof bins / sizeof *bins; i++) {
            double sum[3];
            plain_bin(&s, bins[i], 400, sum);
            for (int c = 0; c < 3; c++) {
                double found = ping->intensity_lin[component[c]][bins[i]];
                assert_true((sum[c] > 0.0) == (found > 0.0));
                if (sum[c] > 0.0) {
                    double off = fabs(asdic_level_db(found / sum[c]));
                    worst = fmax(worst, off);
                    if (off > TOLERANCE_DB) {
                        print_message("case %zu bin %zu component %d: %.4f dB, plain %.4f dB\n", k,
                                      bins[i], c, asdic_level_db(found), asdic_level_db(sum[c]));
                    }
                    assert_true(off <= TOLERANCE_DB);
                }
            }
        }
        asdic_ping_destroy(&ping);
        end(&s);
    }
    print_message("worst of 6 aims x 5 bins x 3: %.4f dB\n", worst);
}

/* ---- what must come out ---- */

/* Ten bins of 0.05 m, longer than a pulse, hold together what one of 0.5 m holds, edges at 5 m and 7 m
 * included. */
static void bins_add_up(void **state) {
    (void)state;
    setup s = begin();
    s.receiver.pitch_rad = 13.0 * DEGREE;
    s.sonar.bandwidth_hz = 20e3;
    asdic_ping *coarse = compute(&s, 40);
    s.sonar.bin_length_m = 0.05;
    asdic_ping *fine = compute(&s, 400);
    for (int c = ASDIC_TOTAL; c <= ASDIC_VOLUME; c++) {
        for (size_t n = 0; n < 40; n++) {
            double sum = 0.0;
            for (size_t k = 0; k < 10; k++) {
                sum += fine->intensity_lin[c][10 * n + k];
            }
            assert_close_relative(coarse->intensity_lin[c][n], sum, 1e-8);
        }
    }
    asdic_ping_destroy(&coarse);
    asdic_ping_destroy(&fine);
    end(&s);
}

/* Turning everything about the vertical, swapping transmitter and receiver, looking up at one plane
 * or down at the same: nothing changes. */
static void symmetries_hold(void **state) {
    (void)state;
    setup s = begin();
    s.receiver.pitch_rad = 17.0 * DEGREE;
    s.receiver.yaw_rad = -9.0 * DEGREE;
    s.receiver.length_v_m = 0.08;
    asdic_ping *first = compute(&s, 60);
    s.pose.yaw_rad = 2.5;
    asdic_ping *turned = compute(&s, 60);
    asdic_beam swap = s.receiver;
    s.receiver = s.sonar.transmitter;
    s.sonar.transmitter = swap;
    asdic_ping *swapped = compute(&s, 60);
    for (int c = ASDIC_TOTAL; c <= ASDIC_VOLUME; c++) {
        for (size_t n = 0; n < 60; n++) {
            assert_close_relative(turned->intensity_lin[c][n], first->intensity_lin[c][n], 1e-8);
            assert_close_relative(swapped->intensity_lin[c][n], first->intensity_lin[c][n], 1e-8);
        }
    }
    asdic_ping_destroy(&first);
    asdic_ping_destroy(&turned);
    asdic_ping_destroy(&swapped);
    end(&s);
}

/* Without boundaries a shell returns s_V times the two-way solid angle: 0.039738 sr for apertures of
 * 0.05 m at 100 kHz and 1490.102 m/s, from an independent program. */
static void open_water_is_the_beam_times_the_shell(void **state) {
    (void)state;
    setup s = begin();
    s.env.sound_speed_mps = 1490.102;
    s.flat.has_bottom = s.flat.has_surface = false;
    s.pose = (asdic_pose){.roll_rad = 0.3, .pitch_rad = 1.2, .yaw_rad = -2.0};
    asdic_ping *ping = compute(&s, 20);
    double alpha =
        asdic_environment_absorption_db_per_km(&s.env, s.sonar.frequency_hz, s.flat.depth_m);
    for (size_t n = 1; n < 20; n++) {
        double sum = 0.0;
        for (int i = 0; i < 1000; i++) {
            double d = 0.5 * ((double)n + (i + 0.5) / 1000.0);
            sum += 5e-4 * d * d * transmission_lin(d, alpha);
        }
        double sv = pow(10.0, 0.1 * volume_backscatter_db(-90.0, 100.0));
        assert_close_relative(ping->intensity_lin[ASDIC_VOLUME][n], sv * 0.03973770119980863 * sum,
                              1e-6);
        assert_true(ping->intensity_lin[ASDIC_BOTTOM][n] == 0.0);
        assert_true(ping->intensity_lin[ASDIC_SURFACE][n] == 0.0);
    }
    asdic_ping_destroy(&ping);
    end(&s);
}

/* Without a surface the height of the scene is nothing to its levels, those above 0 included. */
static void without_a_surface_any_height_is_one(void **state) {
    (void)state;
    setup s = begin();
    s.flat.has_surface = false;
    s.env.sound_speed_mps = 1490.0;
    s.env.max_depth_m = 12.0; /* of the absorption */
    asdic_ping *below = compute(&s, 40);
    s.flat.depth_m = -5.0;
    asdic_ping *above = compute(&s, 40);
    for (int c = 0; c < ASDIC_COMPONENT_COUNT; c++) {
        for (size_t n = 0; n < 40; n++) {
            assert_close_relative(above->intensity_lin[c][n], below->intensity_lin[c][n], 1e-12);
        }
    }
    asdic_ping_destroy(&below);
    asdic_ping_destroy(&above);
    end(&s);
}

/* The energy of a bin is continuous in the altitude across its edge, where the bottom's nadir enters
 * or leaves the bin. */
static void energy_is_continuous_at_bin_edges(void **state) {
    (void)state;
    static const double nudge_m[] = {-1e-9, 0.0, 1e-9};
    double level[3][2];
    for (int i = 0; i < 3; i++) {
        setup s = begin();
        s.flat.altitude_m = 5.0 + nudge_m[i];
        s.flat.depth_m = 7.0 + nudge_m[i];
        asdic_ping *ping = compute(&s, 20);
        level[i][0] = asdic_level_db(ping->intensity_lin[ASDIC_BOTTOM][10]);
        level[i][1] = asdic_level_db(ping->intensity_lin[ASDIC_SURFACE][14]);
        asdic_ping_destroy(&ping);
        end(&s);
    }
    for (int c = 0; c < 2; c++) {
        assert_close(level[0][c], level[1][c], 1e-4);
        assert_close(level[2][c], level[1][c], 1e-4);
    }
}

/* ---- hard cases: finite, not negative, and quick ---- */

static void hard_cases_stay_finite(void **state) {
    (void)state;
    static const struct {
        const char *what;
        double altitude_m, depth_m, pitch_deg, length_m, frequency_hz, wind_kn, type, bin_m;
    } cases[] = {
        {"sonar on the bottom", 0, 7, 0, 0.05, 100e3, 10, 2, 0.5},
        {"sonar in the surface", 5, 0, 0, 0.05, 100e3, 10, 2, 0.5},
        {"no water at all", 0, 0, 0, 0.05, 100e3, 10, 2, 0.5},
        {"zenith just inside a bin", 5, 7.2499, -90, 0.05, 100e3, 10, 2, 0.5},
        {"straight down on a bin's edge", 5, 7, 90, 0.05, 100e3, 10, 2, 0.5},
        {"straight up, calm", 5, 7, -90, 0.05, 100e3, 0, 2, 0.5},
        {"40 wavelengths", 5, 7, 3, 0.6, 100e3, 10, 4, 0.5},
        {"a tenth of a wavelength", 5, 7, 0, 0.0015, 100e3, 40, 1, 0.5},
        {"1 MHz", 5, 7, 0, 0.05, 1e6, 60, 4, 0.5},
        {"100 Hz", 5, 7, 0, 0.05, 100.0, 60, 1.5, 0.5},
        {"bins of a centimetre", 5, 7, 0, 0.05, 100e3, 10, 3, 0.01},
        {"bins of 100 m", 5, 7, 0, 0.05, 100e3, 10, 3, 100.0},
        {"a kilometre of water", 600, 400, 5, 0.05, 100e3, 10, 2, 10.0},
    };
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        setup s = begin();
        s.flat.altitude_m = cases[k].altitude_m;
        s.flat.depth_m = cases[k].depth_m;
        s.flat.bottom = asdic_material_bottom(cases[k].type);
        s.receiver.pitch_rad = s.sonar.transmitter.pitch_rad = cases[k].pitch_deg * DEGREE;
        s.receiver.length_h_m = s.sonar.transmitter.length_h_m = cases[k].length_m;
        s.receiver.length_v_m = s.sonar.transmitter.length_v_m = cases[k].length_m;
        s.sonar.frequency_hz = cases[k].frequency_hz;
        s.sonar.bin_length_m = cases[k].bin_m;
        s.env.wind_speed_kn = cases[k].wind_kn;
        clock_t start = clock();
        asdic_ping *ping = compute(&s, 150);
        double seconds = (double)(clock() - start) / CLOCKS_PER_SEC;
        double most = 0.0;
        for (size_t n = 0; n < 150; n++) {
            most = fmax(most, ping->intensity_lin[ASDIC_TOTAL][n]);
        }
        print_message("%s: up to %.1f dB, %.3f s\n", cases[k].what, asdic_level_db(most), seconds);
        assert_true(most > 0.0);
        assert_true(seconds < 60.0);           /* it ends; emulated machines are slow */
        s.env.variant = ASDIC_VARIANT_PRINTED; /* finite as well, whatever it means */
        if (cases[k].length_m < 0.1) {
            asdic_ping_destroy(&ping);
            ping = compute(&s, 20);
        }
        asdic_ping_destroy(&ping);
        end(&s);
    }
}

/* Rounding gave their fronts arcs of 1e-16 rad in common, whose sums took a quadrature for ever. */
static void faces_that_look_opposite_ways_hear_nothing(void **state) {
    (void)state;
    for (int k = 0; k < 8; k++) {
        setup s = begin();
        s.receiver = s.sonar.transmitter;
        s.receiver.yaw_rad = s.sonar.transmitter.yaw_rad + 180.0 * DEGREE;
        s.pose.roll_rad = (7.0 + k) * DEGREE;
        s.pose.pitch_rad = (20.0 - 5.0 * k) * DEGREE;
        asdic_ping *ping = compute(&s, 60);
        for (size_t n = 0; n < 60; n++) {
            for (int c = ASDIC_BOTTOM; c <= ASDIC_VOLUME; c++) {
                assert_true(ping->intensity_lin[c][n] == 0.0);
            }
        }
        asdic_ping_destroy(&ping);
        end(&s);
    }
}

static void wrong_scenes_are_refused(void **state) {
    (void)state;
    setup s = begin();
    asdic_ping *ping = NULL;
    s.sonar.receivers = &s.receiver;
    assert_ok(s.ctx, asdic_ping_create(s.ctx, 1, 10, &ping));
    asdic_flat_scene wrong[] = {{.has_surface = true,
                                 .has_bottom = true,
                                 .altitude_m = -0.1,
                                 .depth_m = 7.0,
                                 .bottom = asdic_material_bottom(2.0)},
                                {.has_surface = true,
                                 .has_bottom = true,
                                 .altitude_m = 5.0,
                                 .depth_m = -0.1,
                                 .bottom = asdic_material_bottom(2.0)},
                                {.has_surface = true,
                                 .has_bottom = true,
                                 .altitude_m = NAN,
                                 .depth_m = 7.0,
                                 .bottom = asdic_material_bottom(2.0)},
                                {.has_surface = true,
                                 .has_bottom = true,
                                 .altitude_m = 5.0,
                                 .depth_m = NAN,
                                 .bottom = asdic_material_bottom(2.0)},
                                {.has_surface = true,
                                 .has_bottom = true,
                                 .altitude_m = 5.0,
                                 .depth_m = 7.0,
                                 .bottom = asdic_material_bottom(0.9)},
                                {.has_surface = true,
                                 .has_bottom = true,
                                 .altitude_m = 5.0,
                                 .depth_m = 7.0,
                                 .bottom = asdic_material_bottom(4.1)},
                                {.has_surface = true,
                                 .has_bottom = true,
                                 .altitude_m = INFINITY,
                                 .depth_m = 7,
                                 .bottom = asdic_material_bottom(2.0)}};
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
        assert_status(s.ctx,
                      asdic_expected_compute(s.ctx, &wrong[i], &s.env, &s.sonar, &s.pose, ping),
                      ASDIC_ERROR_ARGUMENT);
        assert_contains(asdic_context_error(s.ctx), "flat scene");
    }
    double *const angles[3] = {&s.pose.roll_rad, &s.pose.pitch_rad, &s.pose.yaw_rad};
    for (size_t i = 0; i < 6; i++) { /* of a place only FLAT tells */
        s.pose = (asdic_pose){.position_m = {NAN, INFINITY, NAN}};
        *angles[i / 2] = i % 2 ? INFINITY : NAN;
        assert_status(s.ctx,
                      asdic_expected_compute(s.ctx, &s.flat, &s.env, &s.sonar, &s.pose, ping),
                      ASDIC_ERROR_ARGUMENT);
        *angles[i / 2] = 0.0;
        assert_ok(s.ctx, asdic_expected_compute(s.ctx, &s.flat, &s.env, &s.sonar, &s.pose, ping));
    }
    asdic_ping *two = NULL;
    assert_ok(s.ctx, asdic_ping_create(s.ctx, 2, 10, &two));
    assert_status(s.ctx, asdic_expected_write_csv(s.ctx, "/dev/null", &s.sonar, two),
                  ASDIC_ERROR_ARGUMENT);
    assert_contains(asdic_context_error(s.ctx), "2 beams for 1 receivers");
    asdic_ping_destroy(&two);
    asdic_ping_destroy(&ping);
    end(&s);
}

/* A range of 650 m in the slowest water, c / (2 ping_rate_hz), in more bins than the limit that scene files
 * have, and in fewer. */
static void too_many_bins_are_refused(void **state) {
    (void)state;
    setup s = begin();
    s.sonar.receivers = &s.receiver;
    s.sonar.ping_rate_hz = 1.0;
    s.sonar.bin_length_m = 650.0 / 70000.0;
    assert_status(s.ctx, asdic_sonar_check(s.ctx, &s.sonar), ASDIC_ERROR_ARGUMENT);
    assert_contains(asdic_context_error(s.ctx), "bins, more than 65536");
    s.sonar.bin_length_m = 650.0 / 60000.0;
    assert_ok(s.ctx, asdic_sonar_check(s.ctx, &s.sonar));
    end(&s);
}

/* The part of bin BIN that a window of LENGTH bins round bin N's middle takes. */
static double part_of(int bin, int n, double length) {
    double from = fmax(bin - n, 0.5 - 0.5 * length), to = fmin(bin - n + 1.0, 0.5 + 0.5 * length);
    return fmax(to - from, 0.0);
}

/* A pulse longer than a bin takes the mean over its length of bins that are sharp, of those beyond the last and before the
 * blanking's end, too; before that nothing is heard, not even in a bin that ends there within rounding. */
static void pulses_reach_over_both_ends(void **state) {
    (void)state;
    enum { BINS = 100, BEYOND = 10 };
    static const double blanking_m[] = {3.0, 0.3, 0.6, 1.2}, altitude_m[] = {9.9, 10.08, 2.0};
    for (int i = 0; i < 4 * 3; i++) {
        setup s = begin();
        s.sonar.bin_length_m = 0.1;
        s.sonar.bandwidth_hz = 50e3;
        s.sonar.blanking_m = 0.01;
        s.receiver.pitch_rad = 40.0 * DEGREE;
        s.flat.altitude_m = altitude_m[i / 4];
        asdic_ping *sharp = compute(&s, BINS + BEYOND);
        double c = sound_speed_medwin_mps(s.env.temperature_degc, s.env.salinity_ppt, 7.0);
        double length = fmin(5.3, blanking_m[i % 4] / 0.2), worst = 0.0; /* from half of it on */
        s.sonar.blanking_m = blanking_m[i % 4];
        s.sonar.bandwidth_hz = c / (2.0 * length * 0.1);
        asdic_ping *ping = compute(&s, BINS);
        for (int n = 0; n < BINS; n++) {
            double sum = 0.0, total = ping->intensity_lin[ASDIC_TOTAL][n];
            for (int k = 0; k < BINS + BEYOND; k++) {
                sum += sharp->intensity_lin[ASDIC_TOTAL][k] * part_of(k, n, length) / length;
            }
            if ((n + 0.5) * 0.1 < blanking_m[i % 4]) {
                assert_true(total == 0.0);
            } else {
                worst = fmax(worst, fabs(10.0 * log10(total / sum)));
            }
        }
        print_message("blanked to %g m, bottom %g m below: off by %.2g dB at most\n",
                      blanking_m[i % 4], altitude_m[i / 4], worst);
        assert_true(worst < 1e-3);
        asdic_ping_destroy(&sharp);
        asdic_ping_destroy(&ping);
        end(&s);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(pulses_reach_over_both_ends),
        cmocka_unit_test(any_aim_agrees_with_a_plain_sum),
        cmocka_unit_test(bins_add_up),
        cmocka_unit_test(symmetries_hold),
        cmocka_unit_test(open_water_is_the_beam_times_the_shell),
        cmocka_unit_test(without_a_surface_any_height_is_one),
        cmocka_unit_test(energy_is_continuous_at_bin_edges),
        cmocka_unit_test(hard_cases_stay_finite),
        cmocka_unit_test(faces_that_look_opposite_ways_hear_nothing),
        cmocka_unit_test(wrong_scenes_are_refused),
        cmocka_unit_test(too_many_bins_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
