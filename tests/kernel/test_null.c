/*
 * Rays against the null hypothesis: every component and bin of a flat scene, for turned vehicles
 * and turned beams, in units of the standard error of many experiments, and in dB after many rays.
 * With the argument "full", after sixteen times as many.
 */
#include "ping_rig.h"

static test_device t;

/* Experiments of BLOCK pings. */
enum { PINGS = 256, BLOCK = 4, COMPONENTS = 4 };

static int bias_pings = 8;
static uint32_t bias_rays = 1u << 19;

static const asdic_component component[COMPONENTS] = {ASDIC_TOTAL, ASDIC_BOTTOM, ASDIC_SURFACE,
                                                      ASDIC_VOLUME};
static const char *const component_name[COMPONENTS] = {"total", "bottom", "surface", "volume"};

/* By how much chi-squared per bin may differ from 1. The water's bins err together and count as one:
 * three standard deviations of as many squares as there are experiments. */
static double allowance(int c) {
    return component[c] == ASDIC_VOLUME ? 3.0 * sqrt(2.0 * BLOCK / PINGS) : 0.2;
}

static const struct attitude {
    const char *name;
    double roll_deg, pitch_deg, yaw_deg; /* vehicle */
    double beam_yaw_deg, beam_roll_deg;  /* receivers */
    double length_h_m, length_v_m;
    double depth_m;
} attitudes[] = {
    {"level", 0, 0, 0, 0, 0, 0.05, 0.05, 7.0},
    {"vehicle turned", 10, -8, 40, 0, 0, 0.05, 0.05, 6.3},
    {"beams yawed", 0, 0, 0, 25, 0, 0.06, 0.04, 7.0},
    {"beams rolled", 25, 0, 0, 0, 45, 0.12, 0.03, 7.0},
    {"looking down", 0, -60, 0, 0, 0, 0.05, 0.05, 7.0},
    {"near the bottom", 0, 5, 0, 10, 0, 0.05, 0.05, 11.0},
};

static ping_rig turned_rig(const struct attitude *a) {
    ping_rig r = rig_create(&t);
    r.pose.roll_rad = a->roll_deg * RIG_DEGREE;
    r.pose.pitch_rad = a->pitch_deg * RIG_DEGREE;
    r.pose.yaw_rad = a->yaw_deg * RIG_DEGREE;
    r.pose.position_m.z = a->depth_m;
    for (int b = 0; b < RIG_BEAMS; b++) {
        r.receivers[b].yaw_rad = a->beam_yaw_deg * RIG_DEGREE;
        r.receivers[b].roll_rad = a->beam_roll_deg * RIG_DEGREE;
        r.receivers[b].length_h_m = a->length_h_m;
        r.receivers[b].length_v_m = a->length_v_m;
    }
    return r;
}

static asdic_ping *expectation(ping_rig *r) {
    asdic_flat_scene flat = rig_flat(r);
    asdic_ping *ping = NULL;
    asdic_simulator *sim = rig_simulator(r);
    assert_ok(t.ctx, asdic_ping_create(t.ctx, RIG_BEAMS, asdic_simulator_bin_count(sim), &ping));
    asdic_simulator_destroy(&sim);
    assert_ok(t.ctx, asdic_expected_compute(t.ctx, &flat, &r->env, &r->sonar, &r->pose, ping));
    return ping;
}

/* Sums of experiments of BLOCK pings each. */
typedef struct tally {
    double *sum[COMPONENTS], *square[COMPONENTS]; /* over all pings */
    double *block[COMPONENTS];                    /* of the experiment under way */
    double *off2[COMPONENTS]; /* squared deviation of the experiments' means from the truth */
    size_t cells;
    int pings;
} tally;

static void tally_free(tally *m) {
    for (int c = 0; c < COMPONENTS; c++) {
        free(m->sum[c]);
        free(m->square[c]);
        free(m->block[c]);
        free(m->off2[c]);
    }
}

static void tally_ping(tally *m, const asdic_ping *ping, const asdic_ping *truth, int block) {
    bool complete = ++m->pings % block == 0;
    for (int c = 0; c < COMPONENTS; c++) {
        for (size_t i = 0; i < m->cells; i++) {
            double e = ping->intensity_lin[component[c]][i];
            m->sum[c][i] += e;
            m->square[c][i] += e * e;
            m->block[c][i] += e;
            if (complete) {
                double off = m->block[c][i] / block - truth->intensity_lin[component[c]][i];
                m->off2[c][i] += off * off;
                m->block[c][i] = 0.0;
            }
        }
    }
}

static tally shoot_many(ping_rig *r, const asdic_ping *truth, int pings, int block) {
    tally m = {.cells = truth->beams * truth->bins};
    asdic_simulator *sim = rig_simulator(r);
    asdic_ping *ping = NULL;
    for (int c = 0; c < COMPONENTS; c++) {
        m.sum[c] = calloc(m.cells, sizeof(double));
        m.square[c] = calloc(m.cells, sizeof(double));
        m.block[c] = calloc(m.cells, sizeof(double));
        m.off2[c] = calloc(m.cells, sizeof(double));
    }
    assert_ok(t.ctx, asdic_ping_create(t.ctx, truth->beams, truth->bins, &ping));
    assert_ok(t.ctx, asdic_simulator_learn(sim, &r->pose, 0));
    for (int k = 0; k < pings; k++) {
        assert_ok(t.ctx, asdic_simulator_ping(sim, &r->pose, (uint64_t)k, ping));
        tally_ping(&m, ping, truth, block);
    }
    asdic_ping_destroy(&ping);
    asdic_simulator_destroy(&sim);
    return m;
}

/* The splat of an echo over its footprint leaks into the deep nulls of bottom and surface: this share
 * of the bin's total. */
#define SPLAT_BIAS 2e-5

/* Chi-squared per bin of one component's experiments, whose standard error comes from the scatter of
 * all pings. Bins 60 dB below the total do not count. */
static double chi_squared(const tally *m, const asdic_ping *truth, int c, double bias) {
    double chi2 = 0.0, count = 0.0;
    for (size_t i = 0; i < m->cells; i++) {
        double e = truth->intensity_lin[component[c]][i];
        double allowed = bias * truth->intensity_lin[ASDIC_TOTAL][i];
        if (i % truth->bins < 4 || e < 1e-6 * truth->intensity_lin[ASDIC_TOTAL][i]) {
            continue;
        }
        double mean = m->sum[c][i] / m->pings;
        double variance = (m->square[c][i] - mean * m->sum[c][i]) / (m->pings - 1);
        chi2 += m->off2[c][i] * BLOCK / m->pings / (variance / BLOCK + allowed * allowed);
        count += 1.0;
    }
    return chi2 / count;
}

static void components_agree_in_standard_errors(void **state) {
    (void)state;
    static const struct {
        const char *name;
        asdic_sampler sampler;
        uint32_t rays;
        double bias;
    } samplers[] = {{"beam", ASDIC_SAMPLER_BEAM, 8192, 0.0},
                    {"adaptive", ASDIC_SAMPLER_ADAPTIVE, 20000, SPLAT_BIAS}};
    bool good = true;
    print_message("%d pings in %d experiments, chi-squared per bin\n", PINGS, PINGS / BLOCK);
    for (size_t k = 0; k < 2 * sizeof attitudes / sizeof *attitudes; k++) {
        size_t a = k / 2, s = k % 2;
        ping_rig r = turned_rig(&attitudes[a]);
        r.sampling.sampler = samplers[s].sampler;
        r.sampling.rays = samplers[s].rays;
        asdic_ping *truth = expectation(&r);
        tally m = shoot_many(&r, truth, PINGS, BLOCK);
        print_message("%-16s %-8s", attitudes[a].name, samplers[s].name);
        for (int c = 0; c < COMPONENTS; c++) {
            bool echo = component[c] == ASDIC_BOTTOM || component[c] == ASDIC_SURFACE;
            double chi2 = chi_squared(&m, truth, c, echo ? samplers[s].bias : 0.0);
            print_message("  %s %.2f", component_name[c], chi2);
            good = good && fabs(chi2 - 1.0) <= allowance(c);
        }
        print_message("\n");
        tally_free(&m);
        asdic_ping_destroy(&truth);
        rig_destroy(&r);
    }
    assert_true(good);
}

typedef struct bias {
    double rms_db, most_db;
    double proven_db; /* the most beyond three standard errors */
    double error_db;  /* the largest standard error */
} bias;

static bias bias_of(const tally *m, const asdic_ping *truth) {
    bias b = {0};
    double count = 0.0;
    for (size_t i = 0; i < m->cells; i++) {
        if (i % truth->bins < 4) {
            continue;
        }
        double e = truth->intensity_lin[ASDIC_TOTAL][i], mean = m->sum[0][i] / m->pings;
        double variance = (m->square[0][i] - mean * m->sum[0][i]) / (m->pings - 1) / m->pings;
        double off_db = fabs(asdic_level_db(mean / e));
        double error_db = 10.0 / log(10.0) * sqrt(fmax(variance, 0.0)) / e;
        b.rms_db += off_db * off_db;
        b.most_db = fmax(b.most_db, off_db);
        b.proven_db = fmax(b.proven_db, off_db - 3.0 * error_db);
        b.error_db = fmax(b.error_db, error_db);
        count += 1.0;
    }
    b.rms_db = sqrt(b.rms_db / count);
    return b;
}

static void no_bias_after_many_rays(void **state) {
    (void)state;
    bool good = true;
    for (size_t a = 0; a < sizeof attitudes / sizeof *attitudes; a++) {
        ping_rig r = turned_rig(&attitudes[a]);
        r.sampling.rays = bias_rays;
        asdic_ping *truth = expectation(&r);
        tally m = shoot_many(&r, truth, bias_pings, 1);
        bias b = bias_of(&m, truth);
        print_message("%-16s %d x %u rays: RMS %.4f dB, most %.4f dB, beyond three standard errors "
                      "%.4f dB (largest standard error %.4f dB)\n",
                      attitudes[a].name, bias_pings, r.sampling.rays, b.rms_db, b.most_db,
                      b.proven_db, b.error_db);
        good = good && b.rms_db < 0.01 && b.proven_db < 0.02;
        good = good && (bias_pings < 64 || b.most_db < 0.05);
        tally_free(&m);
        asdic_ping_destroy(&truth);
        rig_destroy(&r);
    }
    assert_true(good);
}

int main(int argc, char **argv) {
    if (argc == 2 && strcmp(argv[1], "full") == 0) {
        bias_pings = 64;
        bias_rays = 1u << 20;
    }
    t = test_device_open_or_skip();
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(components_agree_in_standard_errors),
        cmocka_unit_test(no_bias_after_many_rays),
    };
    return test_device_end(&t, cmocka_run_group_tests(tests, NULL, NULL));
}
