/* Pings against quadrature, in decibels and in their own standard errors. */
#include "ping_rig.h"

#include "golden/flat_expected.h"

static test_device t;

/* RMS and largest difference of component levels from the golden ones, from 2 m on. */
static void golden_error(const asdic_ping *ping, asdic_component component, int column, double *rms,
                         double *most) {
    double sum = 0.0;
    int count = 0;
    *most = 0.0;
    for (size_t n = 4; n < ping->bins; n++) {
        double expected = flat_expected_db[n][column];
        if (isnan(expected)) {
            assert_true(ping->intensity_lin[component][n] == 0.0);
            continue;
        }
        double d = fabs(asdic_level_db(ping->intensity_lin[component][n]) - expected);
        sum += d * d;
        count++;
        *most = fmax(*most, d);
    }
    *rms = sqrt(sum / count);
}

static void adaptive_meets_quadrature(void **state) {
    (void)state;
    static const struct {
        uint32_t rays;
        double rms_db, most_db;
    } cases[] = {{1024, 0.35, 2.0}, {4096, 0.07, 0.5}, {20000, 0.015, 0.1}};
    ping_rig r = rig_create(&t);
    r.sonar.receiver_count = 1;
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        r.sampling.rays = cases[k].rays;
        asdic_ping *ping = rig_shoot(&r, 0, true);
        assert_int_equal(ping->bins, 149);
        double rms, most;
        golden_error(ping, ASDIC_TOTAL, 0, &rms, &most);
        print_message("%u rays: RMS %.4f dB, most %.4f dB\n", cases[k].rays, rms, most);
        assert_true(rms < cases[k].rms_db && most < cases[k].most_db);
        asdic_ping_destroy(&ping);
    }
    rig_destroy(&r);
}

/* One learnt ping against the quadrature, from bin FIRST on. */
static void assert_meets_quadrature(ping_rig *r, size_t first, double rms_db, double most_db) {
    asdic_ping *ping = rig_shoot(r, 0, true), *truth = NULL;
    assert_ok(t.ctx, asdic_ping_create(t.ctx, ping->beams, ping->bins, &truth));
    asdic_flat_scene flat = rig_flat(r);
    assert_ok(t.ctx, asdic_expected_compute(t.ctx, &flat, &r->env, &r->sonar, &r->pose, truth));
    double sum = 0.0, most = 0.0;
    for (size_t b = 0; b < ping->beams; b++) {
        for (size_t n = first; n < ping->bins; n++) {
            size_t at = b * ping->bins + n;
            double d = fabs(asdic_level_db(ping->intensity_lin[ASDIC_TOTAL][at]) -
                            asdic_level_db(truth->intensity_lin[ASDIC_TOTAL][at]));
            sum += d * d;
            most = fmax(most, d);
        }
    }
    double rms = sqrt(sum / (double)(ping->beams * (ping->bins - first)));
    print_message("%zu beams of %zu bins: RMS %.4f dB, most %.3f dB\n", ping->beams, ping->bins,
                  rms, most);
    assert_true(rms < rms_db && most < most_db);
    asdic_ping_destroy(&truth);
    asdic_ping_destroy(&ping);
}

/* Narrow beams that look up and down share the rays of the forward one: their bins in deep vertical
 * nulls get all their echo from far off the beams' azimuth. */
static void nulls_meet_quadrature(void **state) {
    (void)state;
    ping_rig r = rig_create(&t);
    r.sonar.frequency_hz = 450e3;
    r.sonar.transmitter.length_h_m = 0.0331134;
    r.sonar.transmitter.length_v_m = 0.0165567;
    for (int b = 0; b < RIG_BEAMS; b++) {
        r.receivers[b].length_h_m = r.sonar.transmitter.length_h_m;
        r.receivers[b].length_v_m = r.sonar.transmitter.length_v_m;
    }
    r.sampling.rays = 20000;
    assert_meets_quadrature(&r, 4, 0.04, 0.6);
    rig_destroy(&r);
}

/* Bins of half a pulse: the quadrature knows of it, too, at the onset of the bottom (5 m), where the
 * noise takes over, and in the last bin. */
static void short_bins_meet_quadrature(void **state) {
    (void)state;
    ping_rig r = rig_create(&t);
    r.sonar.receiver_count = 1;
    r.sonar.bin_length_m = 0.0364;
    r.sonar.source_level_db = 200.0;
    r.sonar.noise_enabled = true;
    r.sampling.rays = 65536;
    assert_meets_quadrature(&r, 14, 0.04, 0.6);
    rig_destroy(&r);
}

/* Every component of the mean of many pings, in units of the error of that mean. */
static void every_sampler_is_unbiased(void **state) {
    (void)state;
    enum { PINGS = 64 };
    static const asdic_component component[4] = {ASDIC_TOTAL, ASDIC_BOTTOM, ASDIC_SURFACE,
                                                 ASDIC_VOLUME};
    static const uint32_t rays[3] = {20000, 4096, 1u << 16}; /* adaptive, beam, uniform sphere */
    for (int sampler = 0; sampler < 3; sampler++) {
        ping_rig r = rig_create(&t);
        r.sonar.receiver_count = 1;
        r.sampling.sampler = (asdic_sampler)sampler;
        r.sampling.rays = rays[sampler];
        asdic_simulator *sim = rig_simulator(&r);
        asdic_ping *ping = NULL;
        assert_ok(t.ctx, asdic_ping_create(t.ctx, 1, 149, &ping));
        double sum[4][149] = {{0}}, square[4][149] = {{0}};
        for (int k = 0; k < PINGS; k++) {
            assert_ok(t.ctx, asdic_simulator_ping(sim, &r.pose, (uint64_t)k, ping));
            for (int c = 0; c < 4; c++) {
                for (int n = 0; n < 149; n++) {
                    double e = ping->intensity_lin[component[c]][n];
                    sum[c][n] += e / PINGS;
                    square[c][n] += e * e / PINGS;
                }
            }
        }
        for (int c = 0; c < 4; c++) {
            double chi2 = 0.0;
            int count = 0;
            for (int n = 4; n < 149; n++) {
                if (isnan(flat_expected_db[n][c])) {
                    continue;
                }
                double expected = pow(10.0, flat_expected_db[n][c] / 10.0);
                double variance = (square[c][n] - sum[c][n] * sum[c][n]) / (PINGS - 1);
                /* The footprint splat's bias is 2e-4 of the total, RMS over bins, at this many rays. */
                double total = pow(10.0, flat_expected_db[n][0] / 10.0);
                variance += 4e-8 * total * total;
                chi2 += (sum[c][n] - expected) * (sum[c][n] - expected) / variance;
                count++;
            }
            print_message("sampler %d component %d: chi-squared per bin %.3f\n", sampler, c,
                          chi2 / count);
            assert_true(chi2 / count < 1.6);
        }
        asdic_ping_destroy(&ping);
        asdic_simulator_destroy(&sim);
        rig_destroy(&r);
    }
}

/* True error over stated error, over many shifts; of the sampler that needs no calibration by groups alone. */
static void stated_error_is_honest(void **state) {
    (void)state;
    enum { PINGS = 48 };
    static const uint32_t rays[2] = {4096, 20000};
    for (int sampler = 0; sampler < 2; sampler++) {
        ping_rig r = rig_create(&t);
        r.sonar.receiver_count = 1;
        r.sampling.sampler = (asdic_sampler)sampler;
        r.sampling.rays = rays[sampler];
        asdic_simulator *sim = rig_simulator(&r);
        asdic_ping *ping = NULL;
        assert_ok(t.ctx, asdic_ping_create(t.ctx, 1, 149, &ping));
        double all = 0.0, far = 0.0;
        int count = 0, far_count = 0;
        for (int k = 0; k < PINGS; k++) {
            if (sampler == ASDIC_SAMPLER_ADAPTIVE && k % 4 == 0) {
                assert_ok(t.ctx, asdic_simulator_learn(sim, &r.pose, (uint64_t)k));
            }
            assert_ok(t.ctx, asdic_simulator_ping(sim, &r.pose, (uint64_t)k, ping));
            for (size_t n = 4; n < 149; n++) {
                double off =
                    asdic_level_db(ping->intensity_lin[ASDIC_TOTAL][n]) - flat_expected_db[n][0];
                assert_true(ping->stderr_db[n] > 0.0f);
                double ratio = off / ping->stderr_db[n];
                all += ratio * ratio;
                count++;
                if (n >= 100) {
                    far += ratio * ratio;
                    far_count++;
                }
            }
        }
        all = sqrt(all / count);
        far = sqrt(far / far_count);
        print_message("sampler %d: true over stated error RMS %.3f, from 50 m %.3f\n", sampler, all,
                      far);
        assert_true(all > 0.8 && all < 1.3);
        assert_true(far > 0.8 && far < 1.3);
        asdic_ping_destroy(&ping);
        asdic_simulator_destroy(&sim);
        rig_destroy(&r);
    }
}

/* Whatever stood there: until a calibration, a cell knows no error but its groups', and rays go out evenly. */
static void what_was_learnt_is_forgotten(void **state) {
    (void)state;
    enum { CELLS = DEV_TABLE_CELLS, AZIMUTHS = DEV_AZIMUTH_CELLS };
    ping_rig r = rig_create(&t);
    asdic_simulator *sim = rig_simulator(&r);
    for (int i = 0; i < DEV_TABLE_FLOATS; i++) {
        sim->learnt.table[i] = 7.0f;
    }
    sim->learnt.zone_altitude = sim->learnt.object_ratio = 7.0f;
    sim->learnt.faces.count = sim->learnt.glints.own.count = sim->learnt.glints.between.count = 7;
    sim->learnt.azimuths = sim->learnt.table_uploaded = true;
    for (size_t cell = 0; cell < sim->setup.cells; cell++) {
        sim->learnt.stated[cell] = (asdic_stated_error){7.0f, 7.0f, 7.0f, 7.0f};
    }
    asdic_simulator_forget(sim);
    for (size_t cell = 0; cell < sim->setup.cells; cell++) {
        asdic_stated_error e = sim->learnt.stated[cell];
        assert_true(e.of_groups == 1.0f && e.of_block == 0.0f && e.mean_lin == 0.0f &&
                    e.rare == 0.0f);
    }
    for (int i = 0; i < DEV_TABLE_FLOATS; i++) {
        int k = (i - CELLS - 1) % (AZIMUTHS + 1);
        double even = i <= CELLS ? (double)i / CELLS : (double)k / AZIMUTHS;
        assert_close((double)sim->learnt.table[i], even, 1e-7);
    }
    assert_true(sim->learnt.zone_altitude == ASDIC_ZONE_ALTITUDE &&
                sim->learnt.object_ratio == 1.0f);
    assert_int_equal(sim->learnt.faces.count + sim->learnt.glints.own.count +
                         sim->learnt.glints.between.count,
                     0);
    assert_false(sim->learnt.azimuths || sim->learnt.table_uploaded);
    asdic_simulator_destroy(&sim);
    rig_destroy(&r);
}

enum { BIN = 60 };

/* What one bin of a ping states, of a STATED error that holds for pings with FACTOR times its echo, in echoes: the
 * noise takes nothing of that. */
static double stated_by(asdic_simulator *sim, const ping_rig *r, asdic_stated_error stated,
                        double factor, asdic_ping *ping) {
    double echo = ping->intensity_lin[ASDIC_TOTAL][BIN] - ping->intensity_lin[ASDIC_NOISE][BIN];
    stated.mean_lin = (float)(factor * echo);
    sim->learnt.stated[BIN] = stated;
    assert_ok(t.ctx, asdic_simulator_ping(sim, &r->pose, 0, ping)); /* the same again */
    double total = ping->intensity_lin[ASDIC_TOTAL][BIN];
    return ping->stderr_db[BIN] * log(10.0) / 10.0 * total / echo;
}

/* The law in simulator.h and levels.c; a ping of less than the block's knows less, up to the root of five times its
 * total, but a quarter of the block's where chance may miss that much, and no level is known worse than twice itself. */
static void errors_are_stated_by_their_law(void **state) {
    (void)state;
    ping_rig r = rig_create(&t);
    asdic_ping *ping = NULL;
    r.sonar.receiver_count = 1;
    r.sonar.noise_enabled = true;
    r.sonar.source_level_db = 156.0; /* echoes about as loud as the noise */
    r.sampling.rays = 4096;
    asdic_simulator *sim = rig_simulator(&r);
    assert_ok(t.ctx, asdic_ping_create(t.ctx, 1, asdic_simulator_bin_count(sim), &ping));
    assert_ok(t.ctx, asdic_simulator_ping(sim, &r.pose, 0, ping));
    double groups = stated_by(sim, &r, (asdic_stated_error){.of_groups = 1.0f}, 1.0, ping);
    double own = groups * groups, noise = ping->intensity_lin[ASDIC_NOISE][BIN];
    double total = ping->intensity_lin[ASDIC_TOTAL][BIN], all = total / (total - noise);
    double all2 = all * all; /* the total in echoes, squared */
    assert_true(all2 > 2.0 && all2 < 8.0);
    const struct {
        double of_groups, of_block, rare, factor, variance;
    } cases[] = {
        {2.0, 0.0, 0.0, 1.0, 2.0 * own},
        {2.0, 0.5 * own, 0.0, 1.0, 2.0 * own}, /* more than 0.4 of it and the block's */
        {2.0, 3.0 * own, 0.0, 1.0, 3.8 * own},
        {0.0, 0.01, 0.0, 0.5, 0.01},
        {0.0, 0.01, 0.0, 2.0, 0.04},
        {0.0, 0.01, 0.0, 3.0, 0.09},
        {0.0, 0.01, 0.0, 8.0, 0.05 * all2},
        {0.0, 0.01, 0.02, 1.0, 0.03},
        {0.0, 0.01, 0.02, 0.5, 0.015},
        {0.0, 0.01, 0.02, 8.0, 0.15 * all2},
        {0.0, 0.05, 0.0, 40.0, 5.0},         /* a quarter of 40 is 10 */
        {0.0, 0.03, 0.0, 40.0, 0.15 * all2}, /* more than five standard errors are missing */
        {0.0, 3.9, 0.0, 1.0, 3.9},
        {0.0, 1.0, 7.0, 1.0, 8.0},
        {0.0, 30.0, 7.0, 1.0, 4.0 * all2},
    };
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        const asdic_stated_error e = {.of_groups = (float)cases[k].of_groups,
                                      .of_block = (float)cases[k].of_block,
                                      .rare = (float)cases[k].rare};
        assert_close_relative(stated_by(sim, &r, e, cases[k].factor, ping), sqrt(cases[k].variance),
                              1e-4);
    }
    asdic_ping_destroy(&ping);
    asdic_simulator_destroy(&sim);
    rig_destroy(&r);
}

/* A calibration keeps the energies that its pings had, which a ping of less is told by; over a flat bottom no
 * echo is rare, not even by the least float. */
static void calibrations_know_a_ping(void **state) {
    (void)state;
    ping_rig r = rig_create(&t);
    r.sonar.receiver_count = 1;
    r.sampling.rays = 65536;
    asdic_simulator *sim = rig_simulator(&r);
    asdic_ping *ping = NULL;
    assert_ok(t.ctx, asdic_ping_create(t.ctx, 1, asdic_simulator_bin_count(sim), &ping));
    assert_ok(t.ctx, asdic_simulator_learn(sim, &r.pose, 0));
    assert_ok(t.ctx, asdic_simulator_ping(sim, &r.pose, 0, ping));
    for (size_t n = 4; n < ping->bins; n++) {
        asdic_stated_error e = sim->learnt.stated[n];
        double level_db = asdic_level_db(ping->intensity_lin[ASDIC_TOTAL][n]);
        assert_close(asdic_level_db((double)e.mean_lin), level_db, 1.0);
        assert_true(e.rare == 0.0f);
    }
    asdic_ping_destroy(&ping);
    asdic_simulator_destroy(&sim);
    rig_destroy(&r);
}

/* A rolled, yawed vehicle with counter-turned beams sees what a level one sees. */
static void attitude_and_aim_cancel(void **state) {
    (void)state;
    ping_rig r = rig_create(&t);
    r.sampling.rays = 20000;
    asdic_ping *level = rig_shoot(&r, 0, true);
    r.pose.yaw_rad = 0.7;
    r.sonar.transmitter.yaw_rad = -0.7;
    for (int b = 0; b < RIG_BEAMS; b++) {
        r.receivers[b].yaw_rad = -0.7;
    }
    asdic_ping *turned = rig_shoot(&r, 0, true);
    for (size_t n = 4; n < level->bins; n++) {
        double d = asdic_level_db(turned->intensity_lin[ASDIC_TOTAL][n]) -
                   asdic_level_db(level->intensity_lin[ASDIC_TOTAL][n]);
        assert_true(fabs(d) < 0.3);
    }
    asdic_ping_destroy(&level);
    asdic_ping_destroy(&turned);
    rig_destroy(&r);
}

/* A sonar at the edge of the bounding boxes of a ramp's triangles, 5.257 m from their plane z = 13 m -
 * 0.55 x: 6 m / sqrt(1 + 0.55^2). */
static void nothing_echoes_before_the_nearest_surface(void **state) {
    (void)state;
    static const double v[18] = {-20, -30, 24, 20,  -30, 2,  -20, 0,  24,
                                 20,  0,   2,  -20, 30,  24, 20,  30, 2};
    static const uint32_t corners[12] = {0, 1, 2, 1, 3, 2, 2, 3, 4, 3, 5, 4};
    ping_rig r = rig_create(&t);
    r.sonar.receiver_count = 1;
    r.sonar.transmitter.pitch_rad = r.receivers[0].pitch_rad = 30.0 * RIG_DEGREE;
    r.sampling.rays = 20000;
    asdic_mesh *mesh = NULL;
    assert_ok(t.ctx, asdic_mesh_from_triangles(t.ctx, v, 6, corners, 4, &mesh));
    assert_ok(t.ctx, asdic_scene_add_object(r.scene, "ramp", mesh, (asdic_pose){.yaw_rad = 0.0},
                                            asdic_material_facet(8.0, 0.01, 0.1)));
    asdic_simulator *sim = rig_simulator(&r);
    asdic_ping *ping = NULL;
    assert_ok(t.ctx, asdic_ping_create(t.ctx, 1, asdic_simulator_bin_count(sim), &ping));
    double echo = 0.0;
    for (uint64_t k = 0; k < 16; k++) {
        assert_ok(t.ctx, asdic_simulator_ping(sim, &r.pose, k, ping));
        for (size_t n = 0; n < ping->bins; n++) {
            bool before = (double)(n + 1) * ping->bin_length_m < 6.0 / hypot(1.0, 0.55);
            assert_true(!before || ping->intensity_lin[ASDIC_OBJECT][n] == 0.0);
            echo += ping->intensity_lin[ASDIC_OBJECT][n];
        }
    }
    assert_true(echo > 0.0);
    asdic_ping_destroy(&ping);
    asdic_simulator_destroy(&sim);
    asdic_mesh_destroy(&mesh);
    rig_destroy(&r);
}

/* Planes that mirror on another part of the globe, whole steps of the frame away (scene/placement.h). */
static void planes_are_the_same_everywhere(void **state) {
    (void)state;
    asdic_ping *pings[2];
    for (int far = 0; far < 2; far++) {
        ping_rig r = rig_create(&t);
        r.sampling.rays = 4096;
        r.sampling.multipath = ASDIC_MULTIPATH_BOUNDARIES;
        r.pose.position_m.x = far ? 600 * 8192.0 : 0.0;
        pings[far] = rig_shoot(&r, 0, true);
        rig_destroy(&r);
    }
    assert_true(rig_same(pings[0], pings[1]));
    asdic_ping_destroy(&pings[0]);
    asdic_ping_destroy(&pings[1]);
}

/* Rays are by the whole seed and index of a ping, the highest bits included. */
static void pings_far_apart_differ(void **state) {
    (void)state;
    static const int bits[] = {0, 31, 32, 33, 63};
    ping_rig r = rig_create(&t);
    r.sampling.rays = 256;
    asdic_ping *first = rig_shoot(&r, 1, false), *again = rig_shoot(&r, 1, false);
    const uint64_t seed = r.sampling.seed;
    assert_true(rig_same(first, again));
    asdic_ping_destroy(&again);
    for (size_t i = 0; i < 2 * sizeof bits / sizeof *bits; i++) {
        uint64_t on = 1ull << bits[i / 2];
        r.sampling.seed = i % 2 ? seed ^ on : seed;
        again = rig_shoot(&r, i % 2 ? 1 : 1 ^ on, false);
        assert_false(rig_same(first, again));
        asdic_ping_destroy(&again);
    }
    asdic_ping_destroy(&first);
    rig_destroy(&r);
}

static void wrong_use_is_refused(void **state) {
    (void)state;
    ping_rig r = rig_create(&t);
    asdic_simulator *sim = rig_simulator(&r);
    asdic_ping *ping = NULL;
    assert_ok(t.ctx, asdic_ping_create(t.ctx, 1, 10, &ping));
    assert_status(t.ctx, asdic_simulator_ping(sim, &r.pose, 0, ping), ASDIC_ERROR_ARGUMENT);
    assert_contains(asdic_context_error(t.ctx), "1 beams x 10 bins");
    assert_status(t.ctx, asdic_simulator_ping(sim, NULL, 0, ping), ASDIC_ERROR_ARGUMENT);
    assert_status(t.ctx, asdic_simulator_ping(NULL, &r.pose, 0, ping), ASDIC_ERROR_ARGUMENT);
    asdic_simulator_destroy(&sim);
    asdic_simulator_destroy(&sim);
    r.sampling.rays = 63;
    assert_status(
        t.ctx,
        asdic_simulator_create(t.ctx, t.device, r.scene, &r.env, &r.sonar, &r.sampling, 7.0, &sim),
        ASDIC_ERROR_ARGUMENT);
    assert_contains(asdic_context_error(t.ctx), "63 rays");
    const asdic_sampling good = asdic_sampling_default();
    for (int i = 0; i < 3; i++) {
        r.sampling = good;
        r.sampling.sampler = i == 0 ? (asdic_sampler)99 : good.sampler;
        r.sampling.multipath = i == 1 ? (asdic_multipath)99 : good.multipath;
        r.sampling.kernel = i == 2 ? (asdic_ray_kernel)99 : good.kernel;
        assert_status(t.ctx,
                      asdic_simulator_create(t.ctx, t.device, r.scene, &r.env, &r.sonar,
                                             &r.sampling, 7.0, &sim),
                      ASDIC_ERROR_ARGUMENT);
        assert_contains(asdic_context_error(t.ctx), "99");
    }
    r.sampling = good;
    r.sonar.ping_rate_hz = 1.0;
    r.sonar.bin_length_m = 0.01; /* 65,000 bins in the slowest water */
    assert_ok(t.ctx, asdic_sonar_check(t.ctx, &r.sonar));
    assert_status(
        t.ctx,
        asdic_simulator_create(t.ctx, t.device, r.scene, &r.env, &r.sonar, &r.sampling, 7.0, &sim),
        ASDIC_ERROR_ARGUMENT);
    assert_contains(asdic_context_error(t.ctx), "bins, more than 65536");
    asdic_ping_destroy(&ping);
    rig_destroy(&r);
}

int main(void) {
    t = test_device_open_or_skip();
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(adaptive_meets_quadrature),
        cmocka_unit_test(nulls_meet_quadrature),
        cmocka_unit_test(short_bins_meet_quadrature),
        cmocka_unit_test(every_sampler_is_unbiased),
        cmocka_unit_test(stated_error_is_honest),
        cmocka_unit_test(what_was_learnt_is_forgotten),
        cmocka_unit_test(errors_are_stated_by_their_law),
        cmocka_unit_test(calibrations_know_a_ping),
        cmocka_unit_test(attitude_and_aim_cancel),
        cmocka_unit_test(nothing_echoes_before_the_nearest_surface),
        cmocka_unit_test(planes_are_the_same_everywhere),
        cmocka_unit_test(pings_far_apart_differ),
        cmocka_unit_test(wrong_use_is_refused),
    };
    return test_device_end(&t, cmocka_run_group_tests(tests, NULL, NULL));
}
