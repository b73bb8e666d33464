/* Speckle of coherent pings and that drawn for pings of intensities, side by side: the same law, the same
 * correlations over beams, range and displacement, and the false alarms that detectors are designed for, of
 * single cells and of sums of cells that overlap. Both against closed forms. */
#include "coherent_rig.h"
#include "pulse.h"

static test_device t;
static bool full;

enum { ELEMENTS = 128, BEAMS = 24, LAGS = 8, LEVELS = 2 };

#define STEP                                                                                       \
    (0.004) /* of the direction cosine between neighbouring beams: 0.23 degrees, beams of 0.9 */
#define CELL_M 0.075
#define NEAR_M 20.0
#define MOVED_M 1.2 /* more than the array's length */

static const double designs[LEVELS] = {1e-2, 1e-3};

static double sinc(double x) {
    return fabs(x) < 1e-9 ? 1.0 : sin(0.5 * TURN * x) / (0.5 * TURN * x);
}

/* What pings of one kind show. */
typedef struct showing {
    double count, sum, squares;
    double beams[LAGS], bins[LAGS],
        moved; /* sums of products of two intensities, less the mean of 1 */
    double beam_pairs[LAGS], bin_pairs[LAGS], moved_pairs;
    double alarms[LEVELS], fused[LEVELS], cells, fused_cells;
} showing;

typedef struct fan {
    ping_rig r;
    asdic_beam receivers[BEAMS];
    double bin_length_m;
    unsigned looks;
    uint64_t pings;
    double factor[LEVELS], fused_factor[LEVELS]; /* thresholds over the mean */
    asdic_ping *expected;
} fan;

/* P(sum > x) of COUNT independent exponential variates of different means (Goodman, Statistical Optics, 2000, section
 * 6.1: what correlated intensities add up to, the means being the eigenvalues of the matrix of coherence). */
static double sum_pfa(double x, const double *mean, size_t count) {
    double p = 0.0;
    for (size_t i = 0; i < count; i++) {
        double share = exp(-x / mean[i]);
        for (size_t j = 0; j < count; j++) {
            share *= j == i ? 1.0 : mean[i] / (mean[i] - mean[j]);
        }
        p += share;
    }
    return p;
}

/* Of two beams x two bins of mean 1, A and B the coherence between beams and bins. */
static double fused_pfa(double x, double a, double b) {
    double mean[4] = {(1 + a) * (1 + b), (1 + a) * (1 - b), (1 - a) * (1 + b), (1 - a) * (1 - b)};
    return sum_pfa(x, mean, 4);
}

static double fused_threshold(double pfa, double a, double b) {
    double low = 0.0, high = 200.0;
    for (int i = 0; i < 100; i++) {
        double middle = 0.5 * (low + high);
        *(fused_pfa(middle, a, b) > pfa ? &low : &high) = middle;
    }
    return low;
}

static double across(size_t lag) {
    return sinc(0.5 * ELEMENTS * STEP * (double)lag);
}

/* What neighbouring looks of a coherent ping share of the pressure: their pulses overlap. */
static double look_share(void) {
    return pulse_share(1.0);
}

/* The variance of a bin of LOOKS, over that of as many independent ones. */
static double excess(bool coherent, unsigned looks) {
    return coherent ? 1.0 + 2.0 * (1.0 - 1.0 / looks) * pow(look_share(), 2.0) : 1.0;
}

/* What bins of LOOKS that are LAG bins apart share of the intensity. A coherent pulse is a look long, or a cell. */
static double along(bool coherent, size_t lag, double bin_length_m, unsigned looks) {
    double apart = (double)lag * bin_length_m / CELL_M;
    if (looks == 1 && bin_length_m < CELL_M) {
        return pow(pulse_share(apart), 2.0);
    }
    return coherent && lag == 1 ? pow(look_share(), 2.0) / looks : 0.0;
}

/* False alarms of coherent bins of LOOKS where independent ones are to have DESIGN, at X times the mean. */
static double look_pfa(double x, unsigned looks) {
    double mean[16];
    for (unsigned k = 0; k < looks; k++) {
        mean[k] = 1.0 + 2.0 * look_share() * cos(0.5 * TURN * (k + 1.0) / (looks + 1.0));
    }
    return sum_pfa(x * looks, mean, looks);
}

static void begin(fan *f, double bin_length_m) {
    f->r = array_rig(&t);
    ping_rig *r = &f->r;
    asdic_scene_set_surface(r->scene, false);
    r->sonar.bin_length_m = f->bin_length_m = bin_length_m;
    r->sonar.array.elements = ELEMENTS;
    r->sonar.transmitter.length_h_m = 0.015;
    r->sonar.max_range_m = 60.0;
    r->sonar.receivers = f->receivers;
    r->sonar.receiver_count = BEAMS;
    r->sampling.left_out = 1u << ASDIC_TERM_VOLUME;
    r->env.max_depth_m = NAN;
    for (int b = 0; b < BEAMS; b++) {
        f->receivers[b] = r->receivers[0];
        f->receivers[b].length_h_m = ELEMENTS * 0.5 * WAVELENGTH_M;
        f->receivers[b].yaw_rad = asin(STEP * (b - 0.5 * (BEAMS - 1)));
    }
    assert_ok(t.ctx, asdic_scene_commit(r->scene));
    f->looks = asdic_sonar_looks(&r->sonar, 1500.0);
    for (int k = 0; k < LEVELS; k++) {
        asdic_background unit = asdic_background_of(&r->sonar, 1500.0, 1.0, 0.0);
        assert_ok(t.ctx, asdic_detect_threshold(t.ctx, &unit, designs[k], &f->factor[k]));
        f->fused_factor[k] = fused_threshold(
            designs[k], across(1), fmax(sqrt(along(false, 1, bin_length_m, f->looks)), 1e-3));
    }
}

static asdic_simulator *simulator(fan *f) {
    asdic_simulator *sim = NULL;
    assert_ok(t.ctx, asdic_simulator_create(t.ctx, t.device, f->r.scene, &f->r.env, &f->r.sonar,
                                            &f->r.sampling, 7.0, &sim));
    if (!f->expected) {
        asdic_flat_scene flat = {.has_bottom = true,
                                 .altitude_m = 5.0,
                                 .depth_m = 7.0,
                                 .bottom = asdic_material_bottom(2.0)};
        asdic_environment env = f->r.env;
        assert_ok(t.ctx,
                  asdic_ping_create(t.ctx, BEAMS, asdic_simulator_bin_count(sim), &f->expected));
        assert_ok(t.ctx,
                  asdic_expected_compute(t.ctx, &flat, &env, &f->r.sonar, &f->r.pose, f->expected));
    }
    return sim;
}

/* Intensities over what is expected of the bottom. */
static double *shoot(fan *f, asdic_simulator *sim, uint64_t index) {
    size_t bins = f->expected->bins;
    asdic_ping *ping = NULL;
    double *x = malloc(BEAMS * bins * sizeof *x);
    assert_non_null(x);
    assert_ok(t.ctx, asdic_ping_create(t.ctx, BEAMS, bins, &ping));
    assert_ok(t.ctx, asdic_simulator_ping(sim, &f->r.pose, index, ping));
    for (size_t i = 0; i < BEAMS * bins; i++) {
        double mean = f->expected->intensity_lin[ASDIC_BOTTOM][i];
        x[i] = mean > 0.0 ? ping->intensity_lin[ASDIC_TOTAL][i] / mean : 0.0;
    }
    asdic_ping_destroy(&ping);
    return x;
}

static void take(const fan *f, const double *x, const double *later, showing *s) {
    size_t bins = f->expected->bins, first = (size_t)(NEAR_M / f->bin_length_m);
    for (size_t b = 0; b < BEAMS; b++) {
        for (size_t n = first; n + 1 < bins; n++) {
            const double *at = x + b * bins + n;
            s->count += 1.0;
            s->sum += *at;
            s->squares += *at * *at;
            for (size_t lag = 1; lag < LAGS; lag++) {
                if (b + lag < BEAMS) {
                    s->beams[lag] += (*at - 1.0) * (at[lag * bins] - 1.0);
                    s->beam_pairs[lag] += 1.0;
                }
                if (n + lag < bins) {
                    s->bins[lag] += (*at - 1.0) * (at[lag] - 1.0);
                    s->bin_pairs[lag] += 1.0;
                }
            }
            s->moved += (*at - 1.0) * (later[b * bins + n] - 1.0);
            double four = b + 1 < BEAMS ? at[0] + at[1] + at[bins] + at[bins + 1] : 0.0;
            s->fused_cells += b + 1 < BEAMS;
            for (int k = 0; k < LEVELS; k++) {
                s->alarms[k] += *at > f->factor[k];
                s->fused[k] += four > f->fused_factor[k];
            }
        }
    }
}

/* Pings at as many places, each again from MOVED_M to starboard. */
static showing show(fan *f, bool coherent) {
    showing s = {0};
    f->r.sampling.coherent = coherent;
    f->r.sampling.rays = coherent ? 20000 : 100000;
    f->r.sonar.speckle = coherent ? ASDIC_SPECKLE_NONE : ASDIC_SPECKLE_RAYLEIGH;
    asdic_simulator *sim = simulator(f);
    for (uint64_t k = 0; k < f->pings; k++) {
        double yaw = (double)k;
        f->r.pose.position_m = (asdic_vec3){31.7 * (double)k, 0.0, 7.0};
        f->r.pose.yaw_rad = yaw;
        double *x = shoot(f, sim, 2 * k);
        f->r.pose.position_m.x -= MOVED_M * sin(yaw);
        f->r.pose.position_m.y += MOVED_M * cos(yaw);
        double *later = shoot(f, sim, 2 * k + 1);
        take(f, x, later, &s);
        free(x);
        free(later);
    }
    f->r.pose = (asdic_pose){.position_m = {0.0, 0.0, 7.0}};
    asdic_simulator_destroy(&sim);
    return s;
}

/* From both kinds of pings to closed forms, and to each other, within BOUND. */
static void compare(double bin_length_m, uint64_t pings, double bound) {
    fan f = {.pings = pings};
    begin(&f, bin_length_m);
    showing s[2] = {show(&f, false), show(&f, true)};
    print_message("bins of %.3f m, %u looks, %.0f cells: drawn, coherent\n", bin_length_m, f.looks,
                  s[0].count);
    double variance = 1.0 / f.looks, worst = 0.0, apart = 0.0;
    double mean[2], contrast[2];
    for (int i = 0; i < 2; i++) {
        mean[i] = s[i].sum / s[i].count;
        contrast[i] = sqrt(s[i].squares / s[i].count / (mean[i] * mean[i]) - 1.0) * sqrt(f.looks);
    }
    print_message("mean %.3f %.3f, contrast %.3f (1) %.3f (%.3f)\n", mean[0], mean[1], contrast[0],
                  contrast[1], sqrt(excess(true, f.looks)));
    for (size_t lag = 1; lag < LAGS; lag++) {
        double theory[2][2], found[2][2]; /* beams, bins; drawn, coherent */
        for (int i = 0; i < 2; i++) {
            theory[0][i] = across(lag) * across(lag);
            theory[1][i] = along(i, lag, bin_length_m, f.looks);
            found[0][i] = s[i].beams[lag] / s[i].beam_pairs[lag] / variance;
            found[1][i] = s[i].bins[lag] / s[i].bin_pairs[lag] / variance;
            worst = fmax(worst, fabs(found[0][i] - theory[0][i]));
            worst = fmax(worst, fabs(found[1][i] - theory[1][i]));
        }
        apart = fmax(apart, fabs(found[0][1] - found[0][0]));
        apart = fmax(apart, fabs(found[1][1] - found[1][0]));
        print_message("  %zu: beams %.3f %.3f (%.3f)  bins %.3f (%.3f) %.3f (%.3f)\n", lag,
                      found[0][0], found[0][1], theory[0][0], found[1][0], theory[1][0],
                      found[1][1], theory[1][1]);
    }
    print_message("  after %.1f m: %.3f %.3f\n", MOVED_M, s[0].moved / s[0].count / variance,
                  s[1].moved / s[1].count / variance);
    for (int k = 0; k < LEVELS; k++) {
        print_message("P_FA %.0e: %.2e %.2e (%.2e)\n", designs[k], s[0].alarms[k] / s[0].count,
                      s[1].alarms[k] / s[1].count, look_pfa(f.factor[k], f.looks));
        if (f.looks == 1) {
            print_message("  sums of four cells: %.2e %.2e\n", s[0].fused[k] / s[0].fused_cells,
                          s[1].fused[k] / s[1].fused_cells);
        }
    }
    for (int i = 0; i < 2; i++) {
        worst = fmax(worst, fabs(s[i].moved / s[i].count / variance));
        assert_true(fabs(mean[i] - 1.0) < (pings > 16 ? 0.02 : 0.05));
        assert_true(fabs(contrast[i] - sqrt(excess(i, f.looks))) < (pings > 16 ? 0.01 : 0.04));
        for (int k = 0; k < LEVELS; k++) {
            /* Cells overlap: so many of them are as good as one. */
            double alone = s[i].count / (f.looks > 1 ? 4.0 : 10.0);
            double slack = 1.05 + 3.0 / sqrt(designs[k] * alone);
            double design = i == 0 ? designs[k] : look_pfa(f.factor[k], f.looks);
            double rates[2] = {s[i].alarms[k] / s[i].count / design,
                               s[i].fused[k] / s[i].fused_cells / designs[k]};
            assert_true(rates[0] < slack && rates[0] > 1.0 / slack);
            assert_true(f.looks > 1 || (rates[1] < slack && rates[1] > 1.0 / slack));
        }
    }
    print_message("off theory by %.3f, off each other by %.3f at worst\n", worst, apart);
    assert_true(worst < bound && apart < fmax(bound, 0.05));
    asdic_ping_destroy(&f.expected);
    rig_destroy(&f.r);
}

static void bins_shorter_than_a_cell(void **state) {
    (void)state;
    compare(0.03, full ? 64 : 4, full ? 0.03 : 0.06);
}

static void bins_of_four_looks(void **state) {
    (void)state;
    compare(0.3, full ? 64 : 4, full ? 0.03 : 0.06);
}

/* Looks of three quarters of a cell. */
static void bins_of_two_short_looks(void **state) {
    (void)state;
    compare(1.51 * CELL_M, full ? 32 : 4, full ? 0.04 : 0.06);
}

static void bins_of_other_lengths(void **state) {
    (void)state;
    static const double over_cells[] = {0.2, 0.7, 0.9, 1.0, 1.33, 2.2, 2.52};
    for (size_t i = 0; full && i < sizeof over_cells / sizeof *over_cells; i++) {
        compare(over_cells[i] * CELL_M, 16, 0.05);
    }
}

int main(int argc, char **argv) {
    full = argc > 1 && strcmp(argv[1], "--full") == 0;
    t = test_device_open_or_skip();
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(bins_shorter_than_a_cell),
        cmocka_unit_test(bins_of_four_looks),
        cmocka_unit_test(bins_of_two_short_looks),
        cmocka_unit_test(bins_of_other_lengths),
    };
    return test_device_end(&t, cmocka_run_group_tests(tests, NULL, NULL));
}
