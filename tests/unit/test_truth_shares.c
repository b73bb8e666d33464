/*
 * The truth of a beam from the energies in its bins: each figure against the sentence that defines it,
 * in double precision, bin by bin.
 */
#include "asserts.h"

#include "lib/sim/truth_shares.h"

#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

/* More than two blocks of those that are told together, the last one short; what lies before and
 * behind them in the truth's arrays stays. */
#define BINS 601
#define FIRST 7
#define ROOM (FIRST + BINS + 9)
#define UNTOUCHED 77

typedef struct rig {
    double part[ASDIC_COMPONENT_COUNT][BINS], by_surface[BINS], by_bottom[BINS], most[BINS];
    double moment[BINS], sine[BINS], none[BINS];
    int16_t strongest[ROOM], object[ROOM];
    float share[ROOM], object_share[ROOM], path[ASDIC_PATH_COUNT][ROOM], depression[ROOM];
} rig;

static double drawn(uint32_t *state) {
    *state = *state * 1664525u + 1013904223u;
    return (double)(*state >> 8) / 16777216.0;
}

/* Any part may be missing from a bin; every eleventh bin is empty. */
static void fill(rig *r) {
    uint32_t state = 5;
    for (size_t n = 0; n < BINS; n++) {
        r->part[ASDIC_TOTAL][n] = 0.0;
        for (int c = ASDIC_BOTTOM; c < ASDIC_COMPONENT_COUNT; c++) {
            double energy = pow(10.0, 3.0 * drawn(&state) - 9.0);
            r->part[c][n] = n % 11 == 10 || drawn(&state) < 0.3 ? 0.0 : energy;
            r->part[ASDIC_TOTAL][n] += r->part[c][n];
        }
        r->most[n] = r->part[ASDIC_OBJECT][n] * (0.5 + 0.5 * drawn(&state));
        r->by_surface[n] = 0.6 * drawn(&state) * r->part[ASDIC_MULTIPATH][n];
        r->by_bottom[n] = 0.6 * drawn(&state) * r->part[ASDIC_MULTIPATH][n];
        r->sine[n] = n == 0 ? 1.0 : n == 1 ? -1.0 : 2.0 * drawn(&state) - 1.0;
        r->moment[n] = 0.5 * (1.0 + r->sine[n]) *
                       (r->part[ASDIC_BOTTOM][n] + r->part[ASDIC_SURFACE][n] +
                        r->part[ASDIC_OBJECT][n] + r->part[ASDIC_MULTIPATH][n]);
    }
    for (size_t i = 0; i < ROOM; i++) {
        r->strongest[i] = UNTOUCHED;
        r->share[i] = r->object_share[i] = r->depression[i] = UNTOUCHED;
        for (int p = 0; p < ASDIC_PATH_COUNT; p++) {
            r->path[p][i] = UNTOUCHED;
        }
        size_t n = i - FIRST;
        r->object[i] = i < FIRST || n >= BINS ? UNTOUCHED
                       : r->most[n] > 0.0     ? (int16_t)(1 + n % 5)
                                              : 0;
    }
}

static void tell(rig *r, bool has_ways) {
    asdic_holdings h = {.by_surface = has_ways ? r->by_surface : NULL,
                        .by_bottom = has_ways ? r->by_bottom : NULL,
                        .most = r->most,
                        .moment = r->moment,
                        .none = r->none};
    asdic_ping_truth truth = {.strongest = r->strongest,
                              .share = r->share,
                              .object = r->object,
                              .object_share = r->object_share,
                              .depression_rad = r->depression};
    for (int c = 0; c < ASDIC_COMPONENT_COUNT; c++) {
        h.part[c] = r->part[c];
    }
    for (int p = 0; p < ASDIC_PATH_COUNT; p++) {
        truth.path[p] = r->path[p];
    }
    asdic_truth_share(&h, BINS, &truth, FIRST);
}

/* The strongest of the object and five components, the former first of equals. */
static void assert_strongest(const rig *r, size_t n, double total) {
    static const int others[] = {ASDIC_BOTTOM, ASDIC_SURFACE, ASDIC_VOLUME, ASDIC_MULTIPATH,
                                 ASDIC_NOISE};
    double best = r->most[n];
    int who = r->object[FIRST + n];
    for (size_t i = 0; i < 5; i++) {
        if (r->part[others[i]][n] > best) {
            best = r->part[others[i]][n];
            who = -others[i];
        }
    }
    assert_int_equal(r->strongest[FIRST + n], who);
    assert_close(r->share[FIRST + n], best / total, 1e-6);
}

static void assert_bin(const rig *r, size_t n, bool has_ways) {
    double echo = r->part[ASDIC_BOTTOM][n] + r->part[ASDIC_SURFACE][n] + r->part[ASDIC_OBJECT][n];
    double often = r->part[ASDIC_MULTIPATH][n], noise = r->part[ASDIC_NOISE][n];
    double once = echo + r->part[ASDIC_VOLUME][n], total = once + often + noise;
    double by_surface = has_ways ? r->by_surface[n] : 0.0,
           by_bottom = has_ways ? r->by_bottom[n] : 0.0;
    size_t at = FIRST + n;
    total = total > 0.0 ? total : 1.0;
    assert_strongest(r, n, total);
    assert_close(r->object_share[at], r->most[n] / total, 1e-6);
    assert_close(r->path[ASDIC_PATH_DIRECT][at], once / total, 1e-6);
    assert_close(r->path[ASDIC_PATH_NOISE][at], noise / total, 1e-6);
    assert_close(r->path[ASDIC_PATH_BY_SURFACE][at], by_surface / total, 1e-6);
    assert_close(r->path[ASDIC_PATH_BY_BOTTOM][at], by_bottom / total, 1e-6);
    assert_close(r->path[ASDIC_PATH_BY_OBJECT][at],
                 fmax(often - by_surface - by_bottom, 0.0) / total, 1e-6);
    if (echo + often > 0.0) {
        /* Single precision in the sine, 2e-7, is more of an angle near the vertical. */
        assert_close(r->depression[at], asin(r->sine[n]), fabs(r->sine[n]) < 0.9 ? 1e-6 : 1e-3);
    } else {
        assert_true(isnan(r->depression[at]));
    }
}

static void every_bin_is_told(void **state) {
    (void)state;
    rig *r = calloc(1, sizeof *r);
    assert_non_null(r);
    for (int has_ways = 0; has_ways < 2; has_ways++) {
        fill(r);
        tell(r, has_ways);
        for (size_t n = 0; n < BINS; n++) {
            assert_bin(r, n, has_ways);
        }
        for (size_t i = 0; i < ROOM; i = i + 1 == FIRST ? FIRST + BINS : i + 1) {
            assert_int_equal(r->strongest[i], UNTOUCHED);
            assert_true(r->share[i] == UNTOUCHED && r->object_share[i] == UNTOUCHED);
            assert_true(r->depression[i] == UNTOUCHED);
            for (int p = 0; p < ASDIC_PATH_COUNT; p++) {
                assert_true(r->path[p][i] == UNTOUCHED);
            }
        }
    }
    free(r);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(every_bin_is_told)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
