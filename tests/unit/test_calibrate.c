/*
 * What calibrations make of pings: in the place of the simulator's, whose error is known. Constants are those at the
 * head of calibrate.c, where their reasons are.
 */
#include "asserts.h"
#include "test_context.h"

#include "sim/simulator.h"

#include <stdlib.h>

#define BINS 40
#define MOST_BEAMS 24
#define NOISE 0.3
#define MEDIAN_SQUARE 0.693
#define LARGER_OF_SEVERAL 1.25

/* A cell of all pings: the mean of its energies, the relative variance of a ping's, that which the ping's groups
 * suggest, and what came off objects and water. */
typedef struct cell {
    double mean, variance, suggested, objects, water;
} cell;

static cell cells[MOST_BEAMS * BINS];
static asdic_beam receivers[MOST_BEAMS + 1]; /* the last is none of them */
static asdic_stated_error stated[MOST_BEAMS * BINS];
static uint32_t streams[16], aimed, simulated, pings; /* of a calibration */

void __wrap_asdic_shot_aim(const asdic_simulator *sim, asdic_ping_shot *shot,
                           const asdic_pose *pose, uint64_t index, uint32_t stream, uint32_t rays);
asdic_status __wrap_asdic_simulator_simulate(asdic_simulator *sim, size_t count,
                                             asdic_ping *const *out);

void __wrap_asdic_shot_aim(const asdic_simulator *sim, asdic_ping_shot *shot,
                           const asdic_pose *pose, uint64_t index, uint32_t stream, uint32_t rays) {
    (void)pose;
    assert_int_equal(index, 77);
    assert_int_equal(rays, sim->setup.sampling.rays);
    assert_true(aimed < 16);
    streams[aimed++] = stream;
    shot->water.sound_speed_mps = 1500.0;
}

/* Numbers with a mean of 0 and a variance of 1, as estimated from PINGS of them. */
static double deviate(uint32_t k) {
    return pings == 3 ? (double)k - 1.0 : (k % 2 ? -1.0 : 1.0) * sqrt((pings - 1.0) / pings);
}

asdic_status __wrap_asdic_simulator_simulate(asdic_simulator *sim, size_t count,
                                             asdic_ping *const *out) {
    for (size_t i = 0; i < count; i++, simulated++) {
        double *const *part = out[i]->intensity_lin;
        for (size_t n = 0; n < sim->setup.cells; n++) {
            const cell *c = &cells[n];
            double energy = c->mean * (1.0 + sqrt(c->variance) * deviate(simulated));
            part[ASDIC_NOISE][n] = NOISE;
            part[ASDIC_TOTAL][n] = energy + NOISE;
            part[ASDIC_OBJECT][n] = c->objects * energy;
            part[ASDIC_VOLUME][n] = c->water * energy;
            out[i]->stderr_db[n] =
                (float)(10.0 / log(10.0) * sqrt(c->suggested) * energy / (energy + NOISE));
        }
    }
    return ASDIC_OK;
}

/* All cells alike, without a difference between pings. */
static void fill(double suggested) {
    for (size_t i = 0; i < MOST_BEAMS * BINS; i++) {
        cells[i] = (cell){.mean = 0.5, .suggested = suggested};
    }
}

static void set_ratio(size_t i, double ratio) {
    cells[i].variance = ratio * cells[i].suggested;
}

/* Calibrates, which must take EXPECTED pings, TOGETHER at once. */
static void calibrate(size_t beams, uint32_t expected, size_t together) {
    asdic_ping_shot shots[16] = {{.ping = NULL}};
    asdic_simulator *sim = calloc(1, sizeof *sim);
    const asdic_pose pose = {.yaw_rad = 0.0};
    assert_non_null(sim);
    sim->ctx = ctx;
    sim->setup.sonar = (asdic_sonar){.receivers = receivers,
                                     .receiver_count = beams,
                                     .frequency_hz = 150e3,
                                     .bandwidth_hz = 1000.0, /* a cell is shorter than a bin */
                                     .bin_length_m = 1.0};
    sim->setup.bins = BINS;
    sim->setup.cells = beams * BINS;
    sim->setup.sampling.rays = 1000;
    sim->setup.threads = 1;
    sim->setup.groups = 16;
    sim->setup.ping_batch = together;
    sim->fan.many = beams >= 16;
    sim->shots = shots;
    sim->learnt.stated = stated;
    sim->learnt.lesson = asdic_lesson_none(); /* nothing drifts */
    for (int turn = 0; turn < 2; turn++) {    /* the second time in the memory of the first */
        memset(stated, 0, sizeof stated);
        aimed = simulated = 0;
        pings = expected;
        assert_ok(ctx, asdic_simulator_calibrate(sim, &pose, 77));
        assert_int_equal(simulated, expected);
        assert_int_equal(aimed, expected);
    }
    for (uint32_t k = 0; k < aimed; k++) {
        assert_int_equal(streams[k], ASDIC_STREAM_CALIBRATION(k));
    }
    asdic_calibration_destroy(&sim->learnt.calibration);
    free(sim);
}

/* The mean of a beam's ratios, which begin at bin FIRST and end before END, within 16 bins of N; its TYPICAL one
 * counts as six bins. */
static double mean_near(size_t n, size_t first, size_t end, double typical) {
    double sum = 6.0 * typical, count = 6.0;
    for (size_t k = first; k < end; k++) {
        bool near = k <= n + 16 && n <= k + 16;
        sum += near ? cells[k].variance / cells[k].suggested : 0.0;
        count += near;
    }
    return sum / count;
}

/* The typical ratio is by the median, whatever the ratios' order is. */
static void bins_share_a_ratio(void **state) {
    (void)state;
    fill(1e-4);
    for (size_t n = 0; n < BINS; n++) {
        cells[n].water = 0.3; /* it rules no bin, and so its variance is not known */
        set_ratio(n, 1.0 + (double)((7 * n + 3) % BINS) / 10.0);
    }
    for (size_t together = 1; together <= 4; together++) {
        calibrate(1, 3, together);
        for (size_t n = 0; n < BINS; n++) {
            double ratio = mean_near(n, 0, BINS, 3.0 / MEDIAN_SQUARE) / LARGER_OF_SEVERAL;
            double own = 0.1 * cells[n].variance / LARGER_OF_SEVERAL;
            assert_close_relative(stated[n].of_groups, ratio, 1e-5);
            assert_close_relative(stated[n].of_block, ratio * 0.6e-4 + own, 1e-5);
            assert_close_relative(stated[n].mean_lin, 0.5, 1e-6);
            assert_close(stated[n].rare, 0.0, 0.0);
        }
    }
}

/* A bin's own suggestion counts as 0.4, the mean of it and those beside it as 0.2; outside it goes on as it is. */
static void bins_share_what_groups_suggest(void **state) {
    (void)state;
    fill(1e-4);
    for (size_t n = 0; n < BINS; n++) {
        cells[n].suggested = 1e-4 * (double)(1 + n * n % 7);
        set_ratio(n, 1.0);
    }
    calibrate(1, 3, 3);
    for (size_t n = 0; n < BINS; n++) {
        double here = cells[n].suggested;
        double before = n > 0 ? cells[n - 1].suggested : here;
        double after = n + 1 < BINS ? cells[n + 1].suggested : here;
        double block = 0.4 * here + 0.2 * (before + here + after) / 3.0;
        double own = 0.1 * cells[n].variance / LARGER_OF_SEVERAL;
        assert_close_relative(stated[n].of_block, (double)stated[n].of_groups * block + own, 1e-5);
    }
}

/* Rare bright rays count as twenty at most; of them there are three in a window of 33. */
static void bright_rays_do_not_rule_a_window(void **state) {
    (void)state;
    fill(1e-4);
    for (size_t n = 0; n < BINS; n++) {
        set_ratio(n, n >= 18 && n < 21 ? 1000.0 : 1.0);
    }
    calibrate(1, 3, 3);
    double expected = (30.0 + 3.0 * 20.0 + 6.0 / MEDIAN_SQUARE) / 39.0 / LARGER_OF_SEVERAL;
    assert_close_relative(stated[19].of_groups, expected, 1e-5);
}

/* Bins that objects rule share a ratio among themselves, over all beams; without one to compare it is 1. */
static void objects_have_ratios_of_their_own(void **state) {
    (void)state;
    fill(1e-4);
    for (size_t n = 0; n < 2 * BINS; n++) {
        bool object = n < 10 || (n >= BINS + 30 && n < BINS + 33);
        cells[n].objects = object ? 0.51 : 0.49;
        set_ratio(n, object ? (n < BINS ? 0.5 : 9.0) : 0.1);
    }
    calibrate(2, 3, 3);
    const double objects = (10.0 * 0.5 + 3.0 * 9.0) / 13.0, others = 0.1 / MEDIAN_SQUARE;
    for (size_t n = 0; n < BINS; n++) {
        double ratio = n < 10 ? mean_near(n, 0, 10, objects) : mean_near(n, 10, BINS, others);
        assert_close_relative(stated[n].of_groups, ratio / LARGER_OF_SEVERAL, 1e-5);
    }
    double second = (3.0 * 9.0 + 6.0 * objects) / 9.0 / LARGER_OF_SEVERAL;
    assert_close_relative(stated[BINS + 31].of_groups, second, 1e-5);
    /* echoes without an error, and a beam without any: nothing to compare */
    fill(0.0);
    for (size_t n = 0; n < BINS; n++) {
        cells[n].objects = 1.0;
        cells[BINS + n].mean = 0.0;
    }
    calibrate(2, 3, 3);
    for (size_t n = 0; n < 2 * BINS; n++) {
        assert_close_relative(stated[n].of_groups, 1.0 / LARGER_OF_SEVERAL, 1e-6);
        assert_close(stated[n].of_block, 0.0, 0.0);
    }
}

/* Of what few rays bring off an object the ratio is at least three times the variance that a block suggests, 0.6 of
 * which are here, or 1. */
static void few_rays_on_an_edge_know_no_lattice(void **state) {
    (void)state;
    static const double suggested[] = {0.1, 0.5, 0.65}, expected[] = {0.18, 0.9, 1.0};
    for (int k = 0; k < 3; k++) {
        fill(suggested[k]);
        for (size_t n = 0; n < BINS; n++) {
            cells[n].objects = 1.0;
            set_ratio(n, 0.01);
        }
        calibrate(1, 3, 3);
        assert_close_relative(stated[20].of_groups, expected[k], 1e-5);
    }
}

/* Water has one variance in all of a beam, here that of its last ten bins: a bin has at least its share of it. */
static void water_errs_alike_in_all_bins(void **state) {
    (void)state;
    fill(1e-4);
    for (size_t n = 0; n < BINS; n++) {
        cells[n].water = n < 30 ? 0.49 : 0.51;
        set_ratio(n, n < 30 ? 0.1 : 4.0);
    }
    calibrate(1, 3, 3);
    const double water =
        (4.0 + 0.5 / 16.0) / LARGER_OF_SEVERAL * 1e-4; /* half of what a lattice has */
    for (size_t n = 0; n < BINS; n++) {
        double own = 0.1 * cells[n].variance / LARGER_OF_SEVERAL;
        double ratio = mean_near(n, 0, BINS, 0.1 / MEDIAN_SQUARE) / LARGER_OF_SEVERAL;
        double least = cells[n].water * cells[n].water * water;
        assert_close_relative(stated[n].of_block, fmax(ratio * 0.6e-4, least) + own, 1e-5);
    }
}

/* Echoes of one ray: any of the thirteen bins about might have had it, weaker as range^-2. The error's variance
 * is half of theirs. */
static void rare_echoes_count_in_bins_around(void **state) {
    (void)state;
    static const size_t at[] = {20, 2, 38};
    for (size_t i = 0; i < sizeof at / sizeof *at; i++) {
        double r = (double)at[i] + 0.5;
        fill(1e-4);
        cells[at[i]].suggested = 1.0;
        calibrate(1, 3, 3);
        for (size_t n = 0; n < BINS; n++) {
            bool near = n <= at[i] + 6 && at[i] <= n + 6;
            double expected = near ? 0.5 / 13.0 * pow(r / ((double)n + 0.5), 4.0) : 0.0;
            assert_close_relative(stated[n].rare, expected, 1e-5);
        }
        for (int rare = 0; rare < 2; rare++) { /* which is above 0.7 */
            cells[at[i]].suggested = rare ? 0.71 : 0.69;
            calibrate(1, 3, 3);
            assert_close(stated[at[i]].rare, rare ? 0.5 / 13.0 * 0.71 : 0.0, 1e-6);
        }
    }
}

/* Of many receivers those from LOW to HIGH share an error with B, in bins within REACH of each: the mean over beams of
 * their means over bins, relative to the square of the true mean, which the pings' own exceeds by their error. What holds nothing says nothing; where all do, nothing is known. */
static void check_many(size_t b, size_t low, size_t high, size_t reach) {
    for (size_t n = 0; n < BINS; n++) {
        double sum = 0.0, count = 0.0;
        for (size_t beam = low; beam <= high; beam++) {
            double own = 0.0, bins = 0.0;
            for (size_t k = n > reach ? n - reach : 0; k <= n + reach && k < BINS; k++) {
                bool holds = cells[beam * BINS + k].mean > 0.0;
                own += holds ? cells[beam * BINS + k].variance : 0.0;
                bins += holds;
            }
            sum += bins > 0.0 ? own / bins : 0.0;
            count += bins > 0.0;
        }
        bool holds = cells[b * BINS + n].mean > 0.0;
        double own = holds ? 0.1 * cells[b * BINS + n].variance : 0.0;
        double mean = sum / fmax(count, 1.0);
        assert_close_relative(stated[b * BINS + n].of_block,
                              (count > 0.0 ? mean / (1.0 - mean / pings) : 1.0) + own, 1e-5);
    }
}

/* Beams differ less than 1.1 in size, and than half a beam's width of 0.1 rad in pitch. */
static void many_receivers_share_with_those_like_them(void **state) {
    (void)state;
    fill(1.0);
    for (size_t b = 0; b <= MOST_BEAMS; b++) {
        receivers[b] = (asdic_beam){.length_h_m = b % 2 ? 0.1 : 0.109,
                                    .length_v_m = b % 3 ? 0.1 : 0.092,
                                    .pitch_rad = b % 4 ? 0.0 : 0.048};
    }
    for (size_t i = 0; i < MOST_BEAMS * BINS; i++) {
        size_t b = i / BINS, n = i % BINS;
        cells[i].variance = 1e-4 * (double)((1 + b * b % 7) * (1 + n));
    }
    calibrate(MOST_BEAMS, 3, 2);
    for (size_t b = 0; b < MOST_BEAMS; b++) {
        check_many(b, b > 8 ? b - 8 : 0, b + 8 < MOST_BEAMS ? b + 8 : MOST_BEAMS - 1, 1);
    }
    /* One that is unlike them is alone, and so are four behind it; five are not. */
    for (size_t b = 0; b <= MOST_BEAMS; b++) {
        receivers[b] = (asdic_beam){.length_h_m = 0.1, .length_v_m = 0.1};
    }
    for (int odd = 0; odd < 3; odd++) {
        for (size_t last = 4; last <= 5; last++) {
            size_t at = MOST_BEAMS - 1 - last;
            const asdic_beam before = receivers[at];
            asdic_beam *b = &receivers[at];
            *(odd == 0   ? &b->length_h_m
              : odd == 1 ? &b->length_v_m
                         : &b->pitch_rad) += odd == 2 ? 0.052 : 0.0111;
            calibrate(MOST_BEAMS, 8, 3);
            check_many(at, at, at, 4);
            check_many(at + 2, at + 1, MOST_BEAMS - 1, last == 4 ? 4 : 1);
            check_many(at - 2, at - 10, at - 1, 1);
            *b = before;
        }
    }
}

/* Echoes that one ping in three alone holds: their error is not known, and may be many times the echo. */
static void what_one_ping_holds_is_not_known(void **state) {
    (void)state;
    fill(1.0);
    for (size_t b = 0; b <= MOST_BEAMS; b++) {
        receivers[b] = (asdic_beam){.length_h_m = 0.1, .length_v_m = 0.1};
    }
    for (size_t i = 0; i < MOST_BEAMS * BINS; i++) {
        cells[i].variance = 1.0; /* 0, 1 and 2 times the mean */
    }
    calibrate(MOST_BEAMS, 3, 2);
    assert_close_relative(stated[100].of_block, 1.0 / (1.0 - 1.0 / 3.0) + 0.1, 1e-5);
    for (size_t i = 0; i < MOST_BEAMS * BINS; i++) {
        cells[i].variance = 3.0;
    }
    calibrate(MOST_BEAMS, 3, 2);
    assert_true(stated[100].of_block > 1000.0f);
}

/* Blanked bins, a beam that heard nothing, and bins that no beam heard anything in; one that heard the same in every ping
 * is known. */
static void what_is_silent_says_nothing(void **state) {
    (void)state;
    fill(1.0);
    for (size_t b = 0; b <= MOST_BEAMS; b++) {
        receivers[b] = (asdic_beam){.length_h_m = 0.1, .length_v_m = 0.1};
    }
    for (size_t i = 0; i < MOST_BEAMS * BINS; i++) {
        size_t b = i / BINS, n = i % BINS;
        cells[i].variance = b == 14 ? 0.0 : 1e-4 * (double)((1 + b * b % 7) * (1 + n));
        cells[i].mean *= n < 3 || (n > 20 && n < 25) || b == 4 || (b < 12 && n == 33) ? 0.0 : 1.0;
    }
    calibrate(MOST_BEAMS, 3, 2);
    for (size_t b = 0; b < MOST_BEAMS; b++) {
        check_many(b, b > 8 ? b - 8 : 0, b + 8 < MOST_BEAMS ? b + 8 : MOST_BEAMS - 1, 1);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(bins_share_a_ratio),
        cmocka_unit_test(bins_share_what_groups_suggest),
        cmocka_unit_test(bright_rays_do_not_rule_a_window),
        cmocka_unit_test(objects_have_ratios_of_their_own),
        cmocka_unit_test(few_rays_on_an_edge_know_no_lattice),
        cmocka_unit_test(water_errs_alike_in_all_bins),
        cmocka_unit_test(rare_echoes_count_in_bins_around),
        cmocka_unit_test(many_receivers_share_with_those_like_them),
        cmocka_unit_test(what_one_ping_holds_is_not_known),
        cmocka_unit_test(what_is_silent_says_nothing),
    };
    return cmocka_run_group_tests(tests, context_begin, context_end);
}
