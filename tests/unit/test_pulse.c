/* The pulse's length in range against the integral that it stands for. */
#include "asserts.h"

#include "base/share.h"
#include "sim/pulse.h"

#include <string.h>

#define BINS 40
#define ROW (4 * BINS) /* of scratch, more than a thread takes */

/* The thread that does all work. */
static unsigned worker;

void __wrap_asdic_share(unsigned threads, size_t count, size_t step,
                        void (*work)(void *, unsigned, size_t, size_t), void *user);
void __wrap_asdic_share(unsigned threads, size_t count, size_t step,
                        void (*work)(void *, unsigned, size_t, size_t), void *user) {
    (void)threads;
    (void)step;
    work(user, worker, 0, count);
}

typedef struct rig {
    asdic_context *ctx;
    asdic_ping *ping;
    asdic_sonar sonar;
    double scratch[ROW];
} rig;

static int set_up(void **state) {
    static rig r;
    r = (rig){.sonar = asdic_sonar_default()};
    r.sonar.blanking_m = 0.0;
    assert_int_equal(asdic_context_create(&r.ctx), ASDIC_OK);
    assert_ok(r.ctx, asdic_ping_create(r.ctx, 2, BINS, &r.ping));
    assert_true(asdic_pulse_scratch(BINS) <= sizeof r.scratch / sizeof *r.scratch);
    *state = &r;
    return 0;
}

static int tear_down(void **state) {
    rig *r = *state;
    asdic_ping_destroy(&r->ping);
    asdic_context_destroy(&r->ctx);
    return 0;
}

/* A resolution cell of LENGTH bins. */
static void smear(rig *r, double length) {
    r->sonar.bin_length_m = 0.1;
    r->sonar.bandwidth_hz = 1500.0 / (2.0 * length * r->sonar.bin_length_m);
    asdic_pulse_smear(&r->sonar, 1500.0, 1, r->scratch, r->ping, r->ping);
}

/* Energy of 1 in one bin spreads over five; a bin that holds nothing but its neighbour's energy errs as
 * much as that. */
static void pulse_keeps_energy_and_widens(void **state) {
    rig *r = *state;
    double *bottom = r->ping->intensity_lin[ASDIC_BOTTOM], sum = 0.0;
    bottom[20] = r->ping->intensity_lin[ASDIC_TOTAL][20] = 1.0;
    r->ping->stderr_db[20] = 0.5f;
    smear(r, 5.0);
    for (int n = 0; n < BINS; n++) {
        double expected = n >= 18 && n <= 22 ? 0.2 : 0.0;
        double share = asdic_pulse_share(&r->sonar, 1500.0, (size_t)n);
        sum += bottom[n];
        assert_close(bottom[n], expected, 1e-12);
        assert_close(r->ping->intensity_lin[ASDIC_TOTAL][n], expected, 1e-12);
        assert_close(r->ping->stderr_db[n], expected > 0.0 ? 0.5 : 0.0, 1e-6);
        assert_close(share, 0.2, 1e-12); /* what falls beyond the last bin is lost */
    }
    assert_close(sum, 1.0, 1e-12);
    smear(r, 0.99); /* shorter than a bin: untouched */
    assert_close(bottom[18], 0.2, 1e-12);
    assert_close(asdic_pulse_share(&r->sonar, 1500.0, 18), 1.0, 0.0);
}

/* What falls of BIN's energy, evenly spread over it, into a window of LENGTH round bin N's centre. */
static double part_of(int bin, int n, double length) {
    double from = fmax(bin - n, 0.5 - 0.5 * length);
    double to = fmin(bin - n + 1.0, 0.5 + 0.5 * length);
    return to > from ? to - from : 0.0;
}

/* Every component over 200 dB, of two beams, in windows of any length, longer than the ping, too (none
 * that ends with a bin, where rounding decides of a louder neighbour); noise stays, and the total is the
 * sum of all. Beyond the last bin there is nothing. */
static void pulse_is_a_window_s_mean(void **state) {
    rig *r = *state;
    double before[ASDIC_COMPONENT_COUNT][2 * BINS];
    static const double lengths[] = {1.001, 1.7, 2.0, 2.05, 3.1, 4.4, 17.2, 79.5, 81.2, 300.0};
    for (size_t i = 0; i < sizeof lengths / sizeof *lengths; i++) {
        for (int k = 0; k < ASDIC_COMPONENT_COUNT * 2 * BINS; k++) {
            int c = k / (2 * BINS), at = k % (2 * BINS);
            bool lacks = c == ASDIC_OBJECT || c == ASDIC_TOTAL;
            before[c][at] = lacks ? 0.0 : pow(10.0, -20.0 * fmod(0.618034 * k, 1.0));
            r->ping->intensity_lin[c][at] = before[c][at];
            r->ping->stderr_db[at] = 0.1f;
        }
        for (int k = 0; k < ASDIC_COMPONENT_COUNT * 2 * BINS; k++) {
            r->ping->intensity_lin[ASDIC_TOTAL][k % (2 * BINS)] +=
                k < 2 * BINS ? 0.0 : before[k / (2 * BINS)][k % (2 * BINS)];
        }
        smear(r, lengths[i]);
        for (int at = 0; at < 2 * BINS; at++) {
            int n = at % BINS, first = at - n;
            double total = 0.0;
            for (int c = ASDIC_TOTAL + 1; c < ASDIC_COMPONENT_COUNT; c++) {
                double sum = 0.0;
                for (int k = 0; k < BINS; k++) {
                    sum += before[c][first + k] * part_of(k, n, lengths[i]) / lengths[i];
                }
                sum = c == ASDIC_NOISE ? before[c][at] : sum;
                assert_close(r->ping->intensity_lin[c][at], sum, 1e-9 * sum);
                total += sum;
            }
            assert_close(r->ping->intensity_lin[ASDIC_TOTAL][at], total, 1e-9 * total);
            assert_true(r->ping->stderr_db[at] > 0.0f);
        }
    }
}

/* Of a ping with the margin that its pulse asks for, the first bins are what they are of any longer ping. */
static void what_lies_beyond_the_end_is_heard(void **state) {
    rig *r = *state;
    static const double lengths[] = {1.01, 3.1, 4.4, 9.9, 17.2};
    for (size_t i = 0; i < sizeof lengths / sizeof *lengths; i++) {
        r->sonar.bin_length_m = 0.1;
        r->sonar.bandwidth_hz = 1500.0 / (2.0 * lengths[i] * r->sonar.bin_length_m);
        size_t margin = asdic_pulse_margin(&r->sonar, 1500.0, BINS), bins = BINS - margin;
        assert_int_equal(margin, (size_t)ceil(0.5 * (lengths[i] - 1.0)));
        asdic_ping *out = NULL;
        assert_ok(r->ctx, asdic_ping_create(r->ctx, 2, bins, &out));
        for (int at = 0; at < 2 * BINS; at++) {
            double energy = 1.0 + at * at;
            r->ping->intensity_lin[ASDIC_BOTTOM][at] = energy;
            r->ping->intensity_lin[ASDIC_NOISE][at] = 0.5;
            r->ping->intensity_lin[ASDIC_TOTAL][at] = energy + 0.5;
            r->ping->stderr_db[at] = 0.2f;
        }
        r->ping->rays = 77;
        asdic_pulse_smear(&r->sonar, 1500.0, 1, r->scratch, r->ping, out);
        for (size_t at = 0; at < 2 * bins; at++) {
            int n = (int)(at % bins), first = at < bins ? 0 : BINS;
            double sum = 0.0, all = 0.0;
            for (int k = 0; k < BINS; k++) {
                double part = part_of(k, n, lengths[i]) / lengths[i];
                sum += (1.0 + (first + k) * (first + k)) * part;
                all += part;
            }
            assert_close(out->intensity_lin[ASDIC_BOTTOM][at], sum, 1e-9 * sum);
            assert_close(out->intensity_lin[ASDIC_NOISE][at], 0.5, 0.0);
            assert_close(out->intensity_lin[ASDIC_TOTAL][at], sum + 0.5, 1e-9 * sum);
            assert_close(out->stderr_db[at], 0.2 * (sum + 0.5 * all) / (sum + 0.5), 1e-6);
            assert_true(n < (int)margin || fabs(all - 1.0) < 1e-12);
        }
        assert_int_equal(out->rays, 77);
        asdic_ping_destroy(&out);
    }
    r->sonar.bandwidth_hz = 1500.0 / (2.0 * 0.9 * r->sonar.bin_length_m);
    assert_int_equal(asdic_pulse_margin(&r->sonar, 1500.0, BINS), 0);
    r->sonar.bandwidth_hz = 1.0; /* longer than the ping */
    assert_int_equal(asdic_pulse_margin(&r->sonar, 1500.0, BINS), BINS);
}

/* Where listening begins: by half a pulse, in whole bins, before the blanking's end, at half of it at the earliest. An end
 * that rounding parts from a bin's is the very number of that. */
static void what_reaches_over_the_blanking_is_heard(void **state) {
    rig *r = *state;
    static const struct {
        double blanking_m, length, from;
    } cases[] = {{2.0, 0.9, 20.0}, {2.0, 5.0, 18.0}, {2.04, 5.0, 18.0}, {2.0, 5.1, 17.0},
                 {0.3, 0.9, 3.0},  {0.3, 5.0, 1.5},  {0.7, 0.9, 7.0},   {1.23, 0.9, 12.3}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        r->sonar.bin_length_m = 0.1;
        r->sonar.blanking_m = cases[i].blanking_m;
        r->sonar.bandwidth_hz = 1500.0 / (2.0 * cases[i].length * r->sonar.bin_length_m);
        double from = cases[i].from * r->sonar.bin_length_m;
        assert_close(asdic_pulse_from_m(&r->sonar, 1500.0), from,
                     cases[i].from == 12.3 ? 1e-12 : 0.0);
    }
}

/* Nothing is heard before the end of the blanking, in the bin that it ends in as much as is behind it; noise is. */
static void nothing_is_heard_before_the_blanking_s_end(void **state) {
    rig *r = *state;
    static const double blanking_m[] = {0.01, 0.7, 0.73, 0.8, 3.99};
    for (size_t i = 0; i < sizeof blanking_m / sizeof *blanking_m; i++) {
        r->sonar.blanking_m = blanking_m[i];
        for (int c = 0; c < ASDIC_COMPONENT_COUNT; c++) {
            memset(r->ping->intensity_lin[c], 0, BINS * sizeof(double));
        }
        for (int n = 0; n < BINS; n++) {
            r->ping->intensity_lin[ASDIC_NOISE][n] = 1e-3;
            r->ping->stderr_db[n] = 0.1f;
        }
        r->ping->intensity_lin[ASDIC_OBJECT][9] = r->ping->intensity_lin[ASDIC_VOLUME][9] = 1.0;
        r->ping->intensity_lin[ASDIC_TOTAL][9] = 2.0;
        smear(r, 11.0); /* bins 4 to 14 */
        for (int n = 0; n < BINS; n++) {
            double behind = fmin(fmax((n + 1) * 0.1 - blanking_m[i], 0.0) / 0.1, 1.0);
            double heard = n >= 4 && n <= 14 ? behind / 11.0 : 0.0;
            assert_close(r->ping->intensity_lin[ASDIC_OBJECT][n], heard, 1e-12);
            assert_close(r->ping->intensity_lin[ASDIC_VOLUME][n], heard, 1e-12);
            assert_close(r->ping->intensity_lin[ASDIC_NOISE][n], 1e-3, 0.0);
            assert_close(r->ping->intensity_lin[ASDIC_TOTAL][n], 2.0 * heard + 1e-3, 1e-12);
            assert_true(heard > 1e-12 ? r->ping->stderr_db[n] > 0.0f
                                      : r->ping->stderr_db[n] < 1e-9f);
            assert_close(asdic_pulse_share(&r->sonar, 1500.0, (size_t)n), behind / 11.0, 1e-12);
        }
    }
}

/* Threads have room of their own: none writes where another one's is. */
static void threads_do_not_share_their_room(void **state) {
    rig *r = *state;
    size_t own = asdic_pulse_scratch(BINS);
    static double room[4 * ROW];
    asdic_sonar sonar = asdic_sonar_default();
    sonar.bin_length_m = 0.1;
    sonar.bandwidth_hz = 1500.0;
    for (worker = 0; worker < 4; worker++) {
        for (size_t i = 0; i < 4 * own; i++) {
            room[i] = -1.0;
        }
        asdic_pulse_smear(&sonar, 1500.0, 4, room, r->ping, r->ping);
        for (size_t i = 0; i < 4 * own; i++) {
            assert_true(i / own == worker || room[i] == -1.0);
        }
        assert_true(room[worker * own] != -1.0);
    }
    worker = 0;
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(pulse_keeps_energy_and_widens, set_up, tear_down),
        cmocka_unit_test_setup_teardown(pulse_is_a_window_s_mean, set_up, tear_down),
        cmocka_unit_test_setup_teardown(what_lies_beyond_the_end_is_heard, set_up, tear_down),
        cmocka_unit_test_setup_teardown(what_reaches_over_the_blanking_is_heard, set_up, tear_down),
        cmocka_unit_test_setup_teardown(nothing_is_heard_before_the_blanking_s_end, set_up,
                                        tear_down),
        cmocka_unit_test_setup_teardown(threads_do_not_share_their_room, set_up, tear_down),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
