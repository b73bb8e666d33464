/*
 * Rays against the null hypothesis: every component and bin of a flat scene, for turned vehicles
 * and turned beams, in units of the standard error of the mean of many pings, and in dB after many
 * rays.
 */
#include "ping_rig.h"

static test_device t;

enum { PINGS = 32, COMPONENTS = 4 };

static const asdic_component component[COMPONENTS] = {ASDIC_TOTAL, ASDIC_BOTTOM, ASDIC_SURFACE,
                                                      ASDIC_VOLUME};

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

static asdic_ping *expectation(ping_rig *r, size_t bins) {
    asdic_flat_scene flat = {.has_surface = true,
                             .has_bottom = true,
                             .altitude_m = 12.0 - r->pose.position_m.z,
                             .depth_m = r->pose.position_m.z,
                             .bottom_type = 2.0};
    asdic_ping *ping = NULL;
    r->sonar.receivers = r->receivers;
    assert_ok(t.ctx, asdic_ping_create(t.ctx, RIG_BEAMS, bins, &ping));
    assert_ok(t.ctx, asdic_expected_compute(t.ctx, &flat, &r->env, &r->sonar, &r->pose, ping));
    return ping;
}

typedef struct tally {
    double *sum[COMPONENTS], *square[COMPONENTS];
    size_t cells;
} tally;

static tally shoot_many(ping_rig *r, asdic_simulator *sim, int pings) {
    tally m = {.cells = RIG_BEAMS * asdic_simulator_bin_count(sim)};
    for (int c = 0; c < COMPONENTS; c++) {
        m.sum[c] = calloc(m.cells, sizeof(double));
        m.square[c] = calloc(m.cells, sizeof(double));
    }
    asdic_ping *ping = NULL;
    assert_ok(t.ctx, asdic_ping_create(t.ctx, RIG_BEAMS, m.cells / RIG_BEAMS, &ping));
    assert_ok(t.ctx, asdic_simulator_learn(sim, &r->pose, 0));
    for (int k = 0; k < pings; k++) {
        assert_ok(t.ctx, asdic_simulator_ping(sim, &r->pose, (uint64_t)k, ping));
        for (int c = 0; c < COMPONENTS; c++) {
            for (size_t i = 0; i < m.cells; i++) {
                double e = ping->intensity_lin[component[c]][i];
                m.sum[c][i] += e / pings;
                m.square[c][i] += e * e / pings;
            }
        }
    }
    asdic_ping_destroy(&ping);
    return m;
}

static void tally_free(tally *m) {
    for (int c = 0; c < COMPONENTS; c++) {
        free(m->sum[c]);
        free(m->square[c]);
    }
}

/* Chi-squared per bin of one component; bins 60 dB below the total do not count. */
static double chi_squared(const tally *m, const asdic_ping *expected, int c, double bias) {
    double chi2 = 0.0, count = 0.0;
    size_t bins = m->cells / RIG_BEAMS;
    for (size_t i = 0; i < m->cells; i++) {
        double e = expected->intensity_lin[component[c]][i];
        double total = expected->intensity_lin[ASDIC_TOTAL][i];
        if (i % bins < 4 || e < 1e-6 * total) {
            continue;
        }
        double mean = m->sum[c][i];
        double variance = (m->square[c][i] - mean * mean) / (PINGS - 1);
        variance += bias * bias * total * total;
        chi2 += (mean - e) * (mean - e) / variance;
        count += 1.0;
    }
    return chi2 / count;
}

static void components_agree_in_standard_errors(void **state) {
    (void)state;
    static const struct {
        asdic_sampler sampler;
        uint32_t rays;
        double bias; /* of the splat, as a share of the bin's total */
        double low, high;
    } samplers[] = {{ASDIC_SAMPLER_BEAM, 65536, 0.0, 0.6, 1.4},
                    {ASDIC_SAMPLER_ADAPTIVE, 20000, 5e-4, 0.0, 1.4}};
    for (size_t a = 0; a < sizeof attitudes / sizeof *attitudes; a++) {
        for (size_t s = 0; s < 2; s++) {
            ping_rig r = turned_rig(&attitudes[a]);
            r.sampling.sampler = samplers[s].sampler;
            r.sampling.rays = samplers[s].rays;
            asdic_simulator *sim = rig_simulator(&r);
            asdic_ping *expected = expectation(&r, asdic_simulator_bin_count(sim));
            tally m = shoot_many(&r, sim, PINGS);
            double chi2[COMPONENTS];
            for (int c = 0; c < COMPONENTS; c++) {
                chi2[c] = chi_squared(&m, expected, c, samplers[s].bias);
            }
            print_message("%-16s %-8s chi-squared per bin: total %.2f bottom %.2f surface %.2f "
                          "volume %.2f\n",
                          attitudes[a].name, s ? "adaptive" : "beam", chi2[0], chi2[1], chi2[2],
                          chi2[3]);
            for (int c = 0; c < COMPONENTS; c++) {
                /* The water of all bins comes from the same rays: its bins err together. */
                bool alike = component[c] == ASDIC_VOLUME;
                assert_true(chi2[c] >= (alike ? 0.0 : samplers[s].low));
                assert_true(chi2[c] < (alike ? 6.0 : samplers[s].high));
            }
            tally_free(&m);
            asdic_ping_destroy(&expected);
            asdic_simulator_destroy(&sim);
            rig_destroy(&r);
        }
    }
}

static void no_bias_after_many_rays(void **state) {
    (void)state;
    for (size_t a = 0; a < sizeof attitudes / sizeof *attitudes; a++) {
        ping_rig r = turned_rig(&attitudes[a]);
        r.sampling.rays = 1u << 20;
        asdic_simulator *sim = rig_simulator(&r);
        size_t bins = asdic_simulator_bin_count(sim);
        asdic_ping *expected = expectation(&r, bins);
        tally m = shoot_many(&r, sim, 4);
        double most = 0.0, sum = 0.0, count = 0.0;
        for (size_t i = 0; i < m.cells; i++) {
            if (i % bins >= 4) {
                double d = fabs(asdic_level_db(m.sum[0][i]) -
                                asdic_level_db(expected->intensity_lin[ASDIC_TOTAL][i]));
                most = fmax(most, d);
                sum += d * d;
                count += 1.0;
            }
        }
        print_message("%-16s 4 x %u rays: RMS %.4f dB, most %.4f dB\n", attitudes[a].name,
                      r.sampling.rays, sqrt(sum / count), most);
        assert_true(sqrt(sum / count) < 0.01);
        assert_true(most < 0.15);
        tally_free(&m);
        asdic_ping_destroy(&expected);
        asdic_simulator_destroy(&sim);
        rig_destroy(&r);
    }
}

int main(void) {
    t = test_device_open_or_skip();
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(components_agree_in_standard_errors),
        cmocka_unit_test(no_bias_after_many_rays),
    };
    int failed = cmocka_run_group_tests(tests, NULL, NULL);
    test_device_close(&t);
    return failed;
}
