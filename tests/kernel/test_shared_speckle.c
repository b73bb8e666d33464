/* Simulated pings of overlapping beams and short bins: what neighbours share is what theory
 * says. */
#include "ping_rig.h"
#include "pulse.h"

static test_device device;

static double sinc(double x) {
    return fabs(x) < 1e-9 ? 1.0 : sin(RIG_DEGREE * 180.0 * x) / (RIG_DEGREE * 180.0 * x);
}

typedef struct fan {
    size_t beams;
    double sector_deg, length_h_m, bin_length_m;
    asdic_speckle speckle;
    int pings;
} fan;

/* A ping's total over its expected parts, less 1: speckle alone. */
static void take(const asdic_ping *ping, double *x) {
    for (size_t i = 0; i < ping->beams * ping->bins; i++) {
        double sum = 0.0;
        for (int c = ASDIC_TOTAL + 1; c < ASDIC_COMPONENT_COUNT; c++) {
            sum += ping->intensity_lin[c][i];
        }
        x[i] = sum > 0.0 ? ping->intensity_lin[ASDIC_TOTAL][i] / sum - 1.0 : 0.0;
    }
}

/* The correlation of x[at] and x[at + step]. */
typedef struct pair_sum {
    double aa, bb, ab;
} pair_sum;

static void add(pair_sum *s, double a, double b) {
    s->aa += a * a;
    s->bb += b * b;
    s->ab += a * b;
}

static double correlation(const pair_sum *s) {
    return s->ab / sqrt(s->aa * s->bb);
}

enum { LAGS = 12 };

/* What beams 1, 2, ... apart and bins 1, 2, ... apart have in common. */
static void measure(const fan *f, pair_sum beams[LAGS], pair_sum bins[LAGS]) {
    asdic_context *ctx = device.ctx;
    ping_rig r = rig_create(&device);
    asdic_beam *receivers = calloc(f->beams, sizeof *receivers);
    asdic_simulator *sim = NULL;
    asdic_ping *ping = NULL;
    for (size_t b = 0; b < f->beams; b++) {
        double share = (double)b / (double)(f->beams - 1) - 0.5;
        receivers[b] = r.receivers[0];
        receivers[b].length_h_m = f->length_h_m;
        receivers[b].yaw_rad = share * f->sector_deg * RIG_DEGREE;
    }
    r.sonar.transmitter.length_h_m = 0.005; /* wide, as the closed form has it */
    r.sonar.receivers = receivers;
    r.sonar.receiver_count = f->beams;
    r.sonar.speckle = f->speckle;
    r.sonar.speckle_shape = f->speckle == ASDIC_SPECKLE_K ? 4.0 : (double)INFINITY;
    r.sonar.bin_length_m = f->bin_length_m;
    r.sonar.ping_rate_hz = 40.0;
    r.sampling.rays = 2048;
    assert_ok(ctx, asdic_scene_commit(r.scene));
    assert_ok(ctx, asdic_simulator_create(ctx, device.device, r.scene, &r.env, &r.sonar,
                                          &r.sampling, 7.0, &sim));
    size_t count = asdic_simulator_bin_count(sim);
    assert_ok(ctx, asdic_ping_create(ctx, f->beams, count, &ping));
    double *x = calloc(f->beams * count, sizeof *x);
    for (int index = 0; index < f->pings; index++) {
        assert_ok(ctx, asdic_simulator_ping(sim, &r.pose, (uint64_t)index, ping));
        take(ping, x);
        for (size_t i = 0; i < f->beams * count; i++) {
            for (size_t k = 0; k < LAGS; k++) {
                if (i / count + k < f->beams) {
                    add(&beams[k], x[i], x[i + k * count]);
                }
                if (i % count + k < count) {
                    add(&bins[k], x[i], x[i + k]);
                }
            }
        }
    }
    free(x);
    free(receivers);
    asdic_ping_destroy(&ping);
    asdic_simulator_destroy(&sim);
    rig_destroy(&r);
}

static void neighbours_share_what_theory_says(void **state) {
    (void)state;
    static const fan fans[] = {
        {64, 16.0, 0.75, 0.0745, ASDIC_SPECKLE_RAYLEIGH, 40},
        {64, 16.0, 0.75, 0.03, ASDIC_SPECKLE_RAYLEIGH, 60},
        {32, 30.0, 0.613, 0.1, ASDIC_SPECKLE_RAYLEIGH, 80},
        {128, 8.0, 1.37, 0.05, ASDIC_SPECKLE_RAYLEIGH, 60},
        {5, 6.0, 0.31, 0.0745, ASDIC_SPECKLE_RAYLEIGH, 400},
        {64, 16.0, 0.75, 0.04, ASDIC_SPECKLE_K, 160},
    };
    asdic_environment env = asdic_environment_default();
    double c = asdic_environment_sound_speed_mps(&env, 7.0), worst = 0.0;
    for (size_t n = 0; n < sizeof fans / sizeof *fans; n++) {
        const fan *f = &fans[n];
        pair_sum beams[LAGS] = {{0}}, bins[LAGS] = {{0}};
        measure(f, beams, bins);
        double step = f->sector_deg * RIG_DEGREE / (double)(f->beams - 1);
        double length = f->length_h_m * 100e3 / c, cell = c / 20e3;
        print_message("%zu beams %.3f degrees apart, L %.1f; bins of %.3f cells\n", f->beams,
                      step / RIG_DEGREE, length, f->bin_length_m / cell);
        for (size_t k = 1; k < LAGS; k++) {
            double across = pow(sinc(length * sin((double)k * step)), 2);
            double along = pow(pulse_share((double)k * f->bin_length_m / cell), 2);
            if (f->speckle == ASDIC_SPECKLE_K) { /* speckle and texture are correlated alike */
                across = ((1.0 + across) * (1.0 + across / 4.0) - 1.0) / 1.5;
                along = ((1.0 + along) * (1.0 + along / 4.0) - 1.0) / 1.5;
            }
            along = f->bin_length_m < cell ? along : 0.0;
            if (k < f->beams) {
                worst = fmax(worst, fabs(correlation(&beams[k]) - across));
                print_message("  %zu: beams %.3f (%.3f)", k, correlation(&beams[k]), across);
            }
            worst = fmax(worst, fabs(correlation(&bins[k]) - along));
            print_message("  bins %.3f (%.3f)\n", correlation(&bins[k]), along);
        }
    }
    print_message("worst %.3f\n", worst);
    assert_true(worst < 0.05);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(neighbours_share_what_theory_says),
    };
    device = test_device_open_or_skip();
    return test_device_end(&device, cmocka_run_group_tests(tests, NULL, NULL));
}
