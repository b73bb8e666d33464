/* What a run says of all its levels together: the window that shows them, their errors, rays and times. */
#include "asserts.h"
#include "test_context.h"

#include "mission/run/run_statistics.h"

#include <asdic/asdic.h>

#include <math.h>

enum { CELLS = 1000 };

/* Levels of the total and of each part, all NAN at first. */
typedef struct levels {
    float level_db[ASDIC_COMPONENT_COUNT][CELLS], stderr_db[CELLS];
} levels;

static asdic_record record_of(levels *l) {
    asdic_record record = {.stderr_db = l->stderr_db};
    for (int c = 0; c < ASDIC_COMPONENT_COUNT; c++) {
        record.level_db[c] = l->level_db[c];
    }
    return record;
}

static void silence(levels *l) {
    for (size_t i = 0; i < CELLS; i++) {
        l->stderr_db[i] = NAN;
        for (int c = 0; c < ASDIC_COMPONENT_COUNT; c++) {
            l->level_db[c][i] = NAN;
        }
    }
}

static levels all;

static asdic_statistics begun(void) {
    asdic_statistics s;
    silence(&all);
    assert_ok(ctx, asdic_statistics_begin(ctx, &s));
    return s;
}

static void add(asdic_statistics *s, size_t cells) {
    asdic_record record = record_of(&all);
    asdic_statistics_add(s, &record, cells);
}

static void nothing_is_heard_in_silence(void **state) {
    (void)state;
    asdic_statistics s = begun();
    add(&s, CELLS);
    asdic_statistics_end(&s);
    assert_true(isnan(s.errors.median_db) && isnan(s.errors.worst_db) && isnan(s.errors.rms_db));
    assert_close(s.low_db, -160.0, 0.0);
    assert_close(s.high_db, -60.0, 0.0);
    asdic_statistics_finish(&s);
}

/* A twentieth of the levels may lie below the window, a two-hundredth above. */
static void windows_leave_spikes_out(void **state) {
    (void)state;
    static const struct {
        size_t faint, loud;
        double low_db, high_db;
    } cases[] = {{0, 0, -130.0, -70.0}, {49, 0, -130.0, -70.0}, {51, 0, -200.0, -70.0},
                 {0, 5, -130.0, -70.0}, {0, 6, -130.0, -10.0},  {51, 6, -200.0, -10.0}};
    for (size_t n = 0; n < sizeof cases / sizeof *cases; n++) {
        asdic_statistics s = begun();
        float *level_db = all.level_db[ASDIC_TOTAL];
        for (size_t i = 0; i < CELLS; i++) {
            bool faint = i < cases[n].faint, loud = i >= CELLS - cases[n].loud;
            level_db[i] = faint ? -192.5f : loud ? -14.5f : i < 500 ? -123.5f : -76.5f;
        }
        add(&s, CELLS);
        asdic_statistics_end(&s);
        assert_close(s.low_db, cases[n].low_db, 0.0);
        assert_close(s.high_db, cases[n].high_db, 0.0);
        assert_close(s.shown_low_db, s.low_db, 0.0); /* nothing is added for display */
        assert_close(s.shown_high_db, s.high_db, 0.0);
        asdic_statistics_finish(&s);
    }
}

/* Of one level alone, and of such as no histogram has room for, there is a window all the same. */
static void windows_are_10_db_at_least(void **state) {
    (void)state;
    static const struct {
        float level_db;
        double low_db, high_db;
    } cases[] = {{-55.5f, -60.0, -50.0}, {-900.0f, -500.0, -490.0}, {900.0f, 290.0, 300.0}};
    for (size_t n = 0; n < sizeof cases / sizeof *cases; n++) {
        asdic_statistics s = begun();
        all.level_db[ASDIC_TOTAL][3] = cases[n].level_db;
        add(&s, CELLS);
        asdic_statistics_end(&s);
        assert_close(s.low_db, cases[n].low_db, 0.0);
        assert_close(s.high_db, cases[n].high_db, 0.0);
        asdic_statistics_finish(&s);
    }
}

/* Pictures that make up for spreading show levels by what they add: 20 lg of a bin's range here. */
static void gains_move_what_is_shown(void **state) {
    (void)state;
    enum { BINS = 100 };
    asdic_statistics s = begun();
    asdic_picture_options options = asdic_picture_options_default();
    options.tvg_db_per_decade = 20.0;
    assert_ok(ctx, asdic_statistics_set_gain(ctx, &s, BINS, 2.0, &options));
    for (size_t beam = 0; beam < 3; beam++) {
        all.level_db[ASDIC_TOTAL][beam * BINS + 50] = -100.5f; /* at 101 m: 40.1 dB more */
    }
    all.level_db[ASDIC_TOTAL][3 * BINS] = 0.0f; /* of no bin */
    add(&s, 3 * BINS);
    asdic_statistics_end(&s);
    assert_close(s.low_db, -110.0, 0.0);
    assert_close(s.high_db, -100.0, 0.0);
    assert_close(s.shown_low_db, -70.0, 0.0); /* -60.41 dB */
    assert_close(s.shown_high_db, -60.0, 0.0);
    asdic_statistics_finish(&s);
}

/* What is no gain leaves the window of the lowest levels; pictures refuse it. */
static void no_gain_shows_nothing(void **state) {
    (void)state;
    asdic_statistics s = begun();
    asdic_picture_options options = asdic_picture_options_default();
    options.tvg_db_per_m = NAN;
    assert_ok(ctx, asdic_statistics_set_gain(ctx, &s, CELLS, 2.0, &options));
    all.level_db[ASDIC_TOTAL][0] = -50.0f;
    add(&s, CELLS);
    asdic_statistics_end(&s);
    assert_true(s.shown_low_db < s.low_db && isfinite(s.shown_low_db));
    asdic_statistics_finish(&s);
}

static void errors_have_a_middle_and_a_worst(void **state) {
    (void)state;
    static const float error_db[] = {0.5f, 8.0f, NAN, 2.0f, 0.25f, 1.0f};
    asdic_statistics s = begun();
    for (size_t i = 0; i < 6; i++) {
        all.stderr_db[i] = error_db[i];
    }
    all.stderr_db[6] = 99.0f; /* of no bin */
    add(&s, 6);
    asdic_statistics_end(&s);
    assert_close(s.errors.median_db, 1.0, 0.004);
    assert_close(s.errors.worst_db, 8.0, 0.0);
    assert_true(isnan(s.errors.rms_db)); /* no mechanism is above the noise */
    asdic_statistics_finish(&s);

    s = begun(); /* 1, 2 .. 101 dB */
    for (size_t i = 0; i < 101; i++) {
        all.stderr_db[i] = (float)(i + 1);
    }
    add(&s, 101);
    asdic_statistics_end(&s);
    assert_close(s.errors.median_db, 51.0, 0.2);
    asdic_statistics_finish(&s);

    s = begun();
    for (size_t i = 0; i < 5; i++) {
        all.stderr_db[i] = i < 3 ? 0.0f : 4.0f;
    }
    add(&s, 5);
    asdic_statistics_end(&s);
    assert_close(s.errors.median_db, 0.0, 0.0); /* exact */
    assert_close(s.errors.worst_db, 4.0, 0.0);
    asdic_statistics_finish(&s);
}

/* The r.m.s. error counts bins in which a part, whichever, is at least as strong as the noise. */
static void errors_count_where_something_is_heard(void **state) {
    (void)state;
    asdic_statistics s = begun();
    for (size_t i = 0; i < 8; i++) {
        all.level_db[ASDIC_NOISE][i] = -100.0f;
        all.stderr_db[i] = 50.0f;
    }
    static const asdic_component parts[] = {ASDIC_BOTTOM, ASDIC_SURFACE, ASDIC_VOLUME, ASDIC_OBJECT,
                                            ASDIC_MULTIPATH};
    for (size_t i = 0; i < 5; i++) {
        all.level_db[parts[i]][i] = i == 0 ? -100.0f : -99.0f;
        all.stderr_db[i] = i == 4 ? 3.0f : 1.0f;
    }
    all.level_db[ASDIC_BOTTOM][5] = -101.0f; /* below the noise */
    all.level_db[ASDIC_TOTAL][6] = -90.0f;   /* is no part */
    all.level_db[ASDIC_BOTTOM][7] = -90.0f;
    all.stderr_db[7] = NAN;
    all.level_db[ASDIC_NOISE][8] = -100.0f; /* of no bin */
    all.level_db[ASDIC_BOTTOM][8] = -90.0f;
    all.stderr_db[8] = 7.0f;
    add(&s, 8);
    asdic_statistics_end(&s);
    assert_close(s.errors.rms_db, sqrt((4.0 * 1.0 + 9.0) / 5.0), 1e-12);
    asdic_statistics_finish(&s);
}

static void pings_add_up(void **state) {
    (void)state;
    asdic_statistics s = begun();
    for (int k = 0; k < 3; k++) {
        asdic_record record = record_of(&all);
        record.time_s = 7.0 + 0.5 * k;
        record.rays = 1000 + (uint64_t)k;
        record.saturated = k == 1 ? 5 : 1;
        asdic_statistics_add(&s, &record, CELLS);
    }
    assert_int_equal(s.rays, 3003);
    assert_int_equal(s.saturated, 7);
    assert_close(s.first_time_s, 7.0, 0.0);
    assert_close(s.last_time_s, 8.0, 0.0);
    asdic_statistics_finish(&s);
}

/* As a run of it: bins without energy state none, however small their error. */
static void a_ping_states_its_errors(void **state) {
    (void)state;
    asdic_ping *ping = NULL;
    asdic_run_errors e;
    assert_ok(ctx, asdic_ping_create(ctx, 1, 7, &ping));
    for (size_t i = 4; i < 7; i++) {
        ping->intensity_lin[ASDIC_TOTAL][i] = ping->intensity_lin[ASDIC_VOLUME][i] = 1.0;
        ping->stderr_db[i] = (float)(i - 3); /* 1, 2, 3 dB */
    }
    ping->intensity_lin[ASDIC_NOISE][6] = 2.0;
    assert_ok(ctx, asdic_ping_get_errors(ctx, ping, &e));
    assert_close(e.median_db, 2.0, 0.004 * 2.0);
    assert_close(e.worst_db, 3.0, 0.0);
    assert_close(e.rms_db, sqrt((1.0 + 4.0) / 2.0), 1e-12);
    asdic_ping_destroy(&ping);
    assert_ok(ctx, asdic_ping_create(ctx, 1, 7, &ping));
    assert_ok(ctx, asdic_ping_get_errors(ctx, ping, &e));
    assert_true(isnan(e.median_db) && isnan(e.worst_db) && isnan(e.rms_db));
    asdic_ping_destroy(&ping);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(nothing_is_heard_in_silence),
        cmocka_unit_test(windows_leave_spikes_out),
        cmocka_unit_test(windows_are_10_db_at_least),
        cmocka_unit_test(gains_move_what_is_shown),
        cmocka_unit_test(no_gain_shows_nothing),
        cmocka_unit_test(errors_have_a_middle_and_a_worst),
        cmocka_unit_test(errors_count_where_something_is_heard),
        cmocka_unit_test(pings_add_up),
        cmocka_unit_test(a_ping_states_its_errors),
    };
    return cmocka_run_group_tests(tests, context_begin, context_end);
}
