/* Many pings: what moves where. */
#include "asserts.h"
#include "test_context.h"
#include "scan_rig.h"

#include <math.h>

/* Two targets that pass each other, measured with 0.3 m, missed one time in five, among clutter. */
static void tracks_follow(void **state) {
    (void)state;
    asdic_tracker *tracker = NULL;
    asdic_tracker_options options = asdic_tracker_options_default();
    assert_ok(ctx, asdic_tracker_create(ctx, &options, &tracker));
    unsigned seed = 4;
    size_t count = 0, confirmed_clutter = 0;
    double square = 0.0, chi2 = 0.0;
    int errors = 0;
    for (int k = 0; k < 200; k++) {
        double t = 0.5 * k;
        asdic_plot_point plots[5];
        size_t n = 0;
        for (int i = 0; i < 2; i++) {
            if (k > 5 && rand_r(&seed) % 5 == 0) {
                continue;
            }
            double north = i ? 50.0 - 0.4 * t : 10.0 + 0.4 * t, east = i ? 4.0 : -4.0;
            plots[n++] = (asdic_plot_point){.north_m = north + 0.3 * noise(&seed),
                                            .east_m = east + 0.3 * noise(&seed),
                                            .variance_nn_m2 = 0.09,
                                            .variance_ee_m2 = 0.09,
                                            .label = i};
        }
        plots[n++] = (asdic_plot_point){.north_m = (double)(rand_r(&seed) % 100),
                                        .east_m = (double)(rand_r(&seed) % 100) - 50.0,
                                        .variance_nn_m2 = 0.09,
                                        .variance_ee_m2 = 0.09,
                                        .label = -1};
        assert_ok(ctx, asdic_tracker_update(tracker, t, plots, n));
        const asdic_track_state *tracks = asdic_tracker_get(tracker, &count);
        int seen = 0;
        for (size_t i = 0; i < count; i++) {
            const asdic_track_state *s = &tracks[i];
            confirmed_clutter += s->confirmed && s->id > 2 && s->label < 0;
            if (s->id > 2 || k < 20) {
                continue;
            }
            double north = s->id == 2 ? 50.0 - 0.4 * t : 10.0 + 0.4 * t;
            double off = s->north_m - north;
            seen++;
            square += off * off;
            chi2 += off * off / (s->sd_north_m * s->sd_north_m);
            errors++;
            assert_true(s->confirmed);
            assert_close(s->north_mps, s->id == 2 ? -0.4 : 0.4, 0.4);
        }
        assert_true(k < 20 || seen == 2); /* neither was lost nor changed its number */
    }
    print_message("r.m.s. error %.3f m, chi-squared per ping %.2f, clutter confirmed %zu\n",
                  sqrt(square / errors), chi2 / errors, confirmed_clutter);
    assert_true(sqrt(square / errors) < 0.25);               /* better than a single plot */
    assert_true(chi2 / errors > 0.4 && chi2 / errors < 1.6); /* and as good as it says */
    /* Without plots tracks end. */
    for (int k = 0; k < 6; k++) {
        assert_ok(ctx, asdic_tracker_update(tracker, 100.0 + k, NULL, 0));
    }
    asdic_tracker_get(tracker, &count);
    assert_int_equal(count, 0);
    assert_status(ctx, asdic_tracker_update(tracker, 3.0, NULL, 0), ASDIC_ERROR_ARGUMENT);
    asdic_tracker_destroy(&tracker);
    options.confirm = 6;
    assert_status(ctx, asdic_tracker_create(ctx, &options, &tracker), ASDIC_ERROR_ARGUMENT);
}

static asdic_tracker *tracker_of(unsigned confirm, unsigned of, unsigned misses) {
    asdic_tracker *tracker = NULL;
    asdic_tracker_options options = asdic_tracker_options_default();
    options.confirm = confirm;
    options.of = of;
    options.misses = misses;
    assert_ok(ctx, asdic_tracker_create(ctx, &options, &tracker));
    return tracker;
}

/* A ping a second with COUNT plots; the tracks then. */
static const asdic_track_state *track(asdic_tracker *tracker, int ping,
                                      const asdic_plot_point *plots, size_t count, size_t *alive) {
    assert_ok(ctx, asdic_tracker_update(tracker, ping, plots, count));
    return asdic_tracker_get(tracker, alive);
}

/* Where an object is and how fast, along each axis with its own error. */
static void tracks_say_where_and_how_fast(void **state) {
    (void)state;
    asdic_tracker *tracker = tracker_of(3, 5, 5);
    asdic_plot_point plot = {.north_m = 10.0,
                             .east_m = -20.0,
                             .variance_nn_m2 = 0.09,
                             .variance_ee_m2 = 0.25,
                             .label = 7};
    size_t alive = 0;
    const asdic_track_state *s = track(tracker, 0, &plot, 1, &alive);
    assert_int_equal(alive, 1);
    assert_true(s->id == 1 && s->hit && s->hits == 1 && s->age == 1 && !s->confirmed);
    assert_int_equal(s->label, 7);
    assert_close(s->north_m, 10.0, 0.0);
    assert_close(s->east_m, -20.0, 0.0);
    assert_close(s->north_mps, 0.0, 0.0);
    assert_close(s->east_mps, 0.0, 0.0);
    assert_close(s->sd_north_m, 0.3, 1e-12);
    assert_close(s->sd_east_m, 0.5, 1e-12);
    for (int k = 1; k < 60; k++) {
        plot.north_m = 10.0 - 0.25 * k;
        plot.east_m = -20.0 + 0.5 * k;
        plot.label = k;
        s = track(tracker, k, &plot, 1, &alive);
        assert_int_equal(alive, 1);
    }
    assert_true(s->confirmed && s->hit && s->hits == 60 && s->age == 60 && s->label == 59);
    assert_close(s->north_m, plot.north_m, 0.01);
    assert_close(s->east_m, plot.east_m, 0.01);
    assert_close(s->north_mps, -0.25, 0.01);
    assert_close(s->east_mps, 0.5, 0.01);
    assert_true(s->sd_north_m > 0.05 && s->sd_north_m < 0.3); /* many are better than one */
    assert_true(s->sd_east_m < 0.5);
    assert_true(s->sd_east_m > s->sd_north_m);
    s = track(tracker, 60, NULL, 0, &alive);
    assert_int_equal(alive, 1);
    assert_false(s->hit);
    assert_close(s->east_m, plot.east_m + 0.5, 0.02); /* it goes on */
    asdic_tracker_destroy(&tracker);
}

/* PINGS are X where the object is heard and - where not; the ping with which the track is confirmed, and with
 * which it ends; from 1, 0 for never. */
static void tracks_live_by_their_hits(void **state) {
    (void)state;
    static const struct {
        unsigned confirm, of, misses;
        const char *pings;
        int confirmed, ended;
    } cases[] = {{3, 5, 5, "XXX", 3, 0},
                 {3, 5, 5, "X-X-X", 5, 0},
                 {3, 5, 5, "XX--X", 5, 0},
                 {3, 5, 5, "X--XX", 5, 0},
                 {3, 5, 5, "X---", 0, 4}, /* two at most are left */
                 {3, 5, 5, "XX---", 0, 5},
                 {3, 5, 5, "X-X--", 0, 5},
                 {3, 5, 5, "XXX----X----", 3, 0},
                 {3, 5, 5, "XXX-----", 3, 8},
                 {1, 1, 2, "X-X-", 1, 0},
                 {1, 1, 2, "X--", 1, 3},
                 {2, 8, 3, "X---X", 5, 0},
                 {2, 8, 3, "X----", 0, 5},
                 {32, 32, 1, "XXXXXXXXXXXXXXXXXXXXXXXXXXXXXXXX", 32, 0},
                 {32, 32, 1, "XXXXXXXXXXXXXXXXXXXXXXXXXXXXXXX-", 0, 32}};
    const asdic_plot_point plot = {.north_m = 9.0, .variance_nn_m2 = 0.1, .variance_ee_m2 = 0.1};
    for (size_t n = 0; n < sizeof cases / sizeof *cases; n++) {
        asdic_tracker *tracker = tracker_of(cases[n].confirm, cases[n].of, cases[n].misses);
        int confirmed = 0, ended = 0;
        for (int k = 0; cases[n].pings[k] != '\0'; k++) {
            size_t alive = 0;
            const asdic_track_state *s =
                track(tracker, k, &plot, cases[n].pings[k] == 'X' ? 1 : 0, &alive);
            confirmed = confirmed == 0 && alive > 0 && s->confirmed ? k + 1 : confirmed;
            ended = ended == 0 && alive == 0 ? k + 1 : ended;
        }
        if (confirmed != cases[n].confirmed || ended != cases[n].ended) {
            fail_msg("%s: confirmed %d, ended %d", cases[n].pings, confirmed, ended);
        }
        asdic_tracker_destroy(&tracker);
    }
}

/* Nearest pairs go first; what is in no gate founds a track. */
static void plots_go_to_the_nearest_track(void **state) {
    (void)state;
    asdic_tracker *tracker = tracker_of(3, 5, 5);
    const asdic_plot_point first[] = {
        {.north_m = 10.0, .variance_nn_m2 = 0.09, .variance_ee_m2 = 0.09, .label = 1},
        {.north_m = 11.0, .variance_nn_m2 = 0.09, .variance_ee_m2 = 0.09, .label = 2}};
    const asdic_plot_point then[] = {
        {.north_m = 10.8, .variance_nn_m2 = 0.09, .variance_ee_m2 = 0.09, .label = 3},
        {.north_m = 10.3, .variance_nn_m2 = 0.09, .variance_ee_m2 = 0.09, .label = 4},
        {.north_m = 40.0, .variance_nn_m2 = 0.09, .variance_ee_m2 = 0.09, .label = 5}};
    size_t alive = 0;
    const asdic_track_state *s = track(tracker, 0, first, 2, &alive);
    assert_int_equal(alive, 2);
    s = track(tracker, 0, then, 3, &alive);
    assert_int_equal(alive, 3);
    assert_true(s[0].id == 1 && s[0].label == 4);
    assert_true(s[1].id == 2 && s[1].label == 3);
    assert_true(s[2].id == 3 && s[2].label == 5 && s[2].hits == 1);
    asdic_tracker_destroy(&tracker);
}

static void trackers_have_limits(void **state) {
    (void)state;
    const asdic_tracker_options good = asdic_tracker_options_default();
    asdic_tracker_options bad[8];
    for (int i = 0; i < 8; i++) {
        bad[i] = good;
    }
    bad[0].gate = 0.0;
    bad[1].acceleration = -1e-9;
    bad[2].speed_mps = 0.0;
    bad[3].confirm = 0;
    bad[4].confirm = good.of + 1;
    bad[5].of = 33;
    bad[6].misses = 0;
    bad[7].gate = NAN;
    asdic_tracker *tracker = NULL;
    for (int i = 0; i < 8; i++) {
        assert_status(ctx, asdic_tracker_create(ctx, &bad[i], &tracker), ASDIC_ERROR_ARGUMENT);
        assert_null(tracker);
    }
    asdic_tracker_options least = good;
    least.acceleration = 0.0;
    least.confirm = least.of = least.misses = 1;
    assert_ok(ctx, asdic_tracker_create(ctx, &least, &tracker));
    asdic_tracker_destroy(&tracker);
}

/* Of a ping at no time, or with a plot that is nowhere or known exactly, a tracker takes nothing. */
static void plots_have_limits(void **state) {
    (void)state;
    const asdic_tracker_options options = asdic_tracker_options_default();
    const asdic_plot_point good = {.variance_nn_m2 = 1.0, .variance_ee_m2 = 4.0};
    asdic_plot_point bad[6] = {good, good, good, good, good, good};
    bad[0].north_m = NAN;
    bad[1].east_m = INFINITY;
    bad[2].variance_nn_m2 = 0.0;
    bad[3].variance_ee_m2 = NAN;
    bad[4].variance_ne_m2 = 2.1; /* more than both variances allow */
    bad[5].variance_ne_m2 = NAN;
    asdic_tracker *tracker = NULL;
    size_t count;
    assert_ok(ctx, asdic_tracker_create(ctx, &options, &tracker));
    assert_status(ctx, asdic_tracker_update(tracker, NAN, &good, 1), ASDIC_ERROR_ARGUMENT);
    assert_status(ctx, asdic_tracker_update(tracker, INFINITY, &good, 1), ASDIC_ERROR_ARGUMENT);
    assert_ok(ctx, asdic_tracker_update(tracker, 1.0, &good, 1));
    for (int i = 0; i < 6; i++) {
        const asdic_plot_point plots[2] = {good, bad[i]};
        assert_status(ctx, asdic_tracker_update(tracker, 2.0, plots, 2), ASDIC_ERROR_ARGUMENT);
        const asdic_track_state *tracks = asdic_tracker_get(tracker, &count);
        assert_true(count == 1 && tracks->north_m == 0.0 && tracks->age == 1);
    }
    assert_ok(ctx, asdic_tracker_update(tracker, 1.5, &good, 1)); /* 2 s were none */
    assert_int_equal(asdic_tracker_get(tracker, &count)->hits, 2);
    asdic_tracker_destroy(&tracker);
}

/* Clutter anywhere in a square, from nearly none to a plot in every gate: confirmed tracks per
 * plot. */
static void clutter_confirms_tracks_as_said(void **state) {
    (void)state;
    static const struct {
        double step_s, per_ping;
        int pings;
        double low, high; /* allowed of what is said */
    } cases[] = {
        {0.02, 100.0, 400, 0.8, 1.2}, {0.1, 60.0, 400, 0.75, 1.2}, {0.5, 40.0, 200, 0.5, 1.2}};
    enum { SIDE_M = 20, LINES = 100 };
    double east_m[LINES];
    for (int i = 0; i < LINES; i++) {
        east_m[i] = SIDE_M * (i + 0.5) / LINES;
    }
    for (size_t n = 0; n < sizeof cases / sizeof *cases; n++) {
        asdic_tracker *tracker = NULL;
        asdic_tracker_options options = asdic_tracker_options_default();
        assert_ok(ctx, asdic_tracker_create(ctx, &options, &tracker));
        asdic_plot_point plots[400];
        uint8_t *seen = calloc(400 * 400, 1);
        unsigned seed = 11;
        double total = 0.0, confirmed = 0.0;
        for (int k = 0; k < cases[n].pings; k++) {
            size_t count = 0; /* Poisson */
            for (double left = cases[n].per_ping; count < 400; count++) {
                left += log((rand_r(&seed) + 0.5) / (RAND_MAX + 1.0));
                if (left < 0.0) {
                    break;
                }
                plots[count] =
                    (asdic_plot_point){.north_m = SIDE_M * (rand_r(&seed) / (double)RAND_MAX),
                                       .east_m = SIDE_M * (rand_r(&seed) / (double)RAND_MAX),
                                       .variance_nn_m2 = 0.01,
                                       .variance_ee_m2 = 0.04,
                                       .label = -1};
            }
            total += (double)count;
            assert_ok(ctx, asdic_tracker_update(tracker, k * cases[n].step_s, plots, count));
            size_t alive = 0;
            const asdic_track_state *tracks = asdic_tracker_get(tracker, &alive);
            for (size_t i = 0; i < alive; i++) {
                confirmed += tracks[i].confirmed && !seen[tracks[i].id];
                seen[tracks[i].id] |= tracks[i].confirmed;
            }
        }
        double said = asdic_tracker_false_share(&options, cases[n].step_s, &plots[0],
                                                cases[n].per_ping / (SIDE_M * LINES), east_m, LINES,
                                                INFINITY, 0.0);
        print_message("%g plots a ping, %g s apart: %.0f confirmed of %.0f, %.1f were said\n",
                      cases[n].per_ping, cases[n].step_s, confirmed, total, said * total);
        double spread = 2.6 * sqrt(said * total);
        assert_true(confirmed > cases[n].low * said * total - spread);
        assert_true(confirmed < cases[n].high * said * total + spread);
        free(seen);
        asdic_tracker_destroy(&tracker);
    }
    asdic_tracker_options at_once = asdic_tracker_options_default();
    asdic_plot_point plot = {.variance_nn_m2 = 1.0, .variance_ee_m2 = 1.0};
    assert_close(asdic_tracker_false_share(&at_once, 1.0, &plot, 0.0, east_m, 1, INFINITY, 0.0),
                 0.0, 0.0);
    at_once.confirm = 1;
    assert_close(asdic_tracker_false_share(&at_once, 1.0, &plot, 1.0, east_m, 1, INFINITY, 0.0),
                 1.0, 0.0);
}

/* A plot across the line at BEARING, RANGE_M from where lines meet. */
static asdic_plot_point plot_on(double bearing, double range_m, double along2, double across2) {
    double c = cos(bearing), s = sin(bearing);
    return (asdic_plot_point){.north_m = range_m * c,
                              .east_m = range_m * s,
                              .variance_nn_m2 = along2 * c * c + across2 * s * s,
                              .variance_ee_m2 = along2 * s * s + across2 * c * c,
                              .variance_ne_m2 = (along2 - across2) * c * s,
                              .label = -1};
}

/* Each of 64 lines twice, with half the plots on either: of as many lines only some are looked at. */
static void lines_that_are_many_say_the_same(void **state) {
    (void)state;
    enum { LINES = 64 };
    double once[LINES], twice[2 * LINES];
    for (size_t i = 0; i < LINES; i++) {
        once[i] = twice[2 * i] = twice[2 * i + 1] = 0.1 * (double)i + 0.02 * (double)(i % 3);
    }
    asdic_tracker_options options = asdic_tracker_options_default();
    const asdic_plot_point plot = {.variance_nn_m2 = 0.0075, .variance_ee_m2 = 0.05};
    for (int turns = 0; turns < 2; turns++) {
        double turn_rad = 0.01 * turns;
        double few =
            asdic_tracker_false_share(&options, 0.1, &plot, 0.02, once, LINES, 20.0, turn_rad);
        double many =
            asdic_tracker_false_share(&options, 0.1, &plot, 0.01, twice, 2 * LINES, 20.0, turn_rad);
        assert_true(few > 1e-4);
        assert_close(many, few, 1e-9 * few);
    }
}

/* Plots of beams as wide as they are apart lie aslant to each other: each hears farther along the next one's line than
 * along its own. Side by side, half as many tracks or fewer were said. Those that turn confirm fewer than at rest. */
static void beams_that_meet_confirm_more(void **state) {
    (void)state;
    enum { LINES = 3, PINGS = 60000 };
    static const double apart[] = {0.26, 0.38, 0.26, 0.26, 0.26}; /* rad */
    static const double turns[] = {0.0, 0.0, 0.02, -0.06, 0.26};  /* a ping */
    for (size_t n = 0; n < 5; n++) {
        const double mid_m = 20.0, half_m = 5.0, per_ping = 1.0, step_s = 0.1;
        double along2 = 0.0075, across2 = pow(apart[n] * mid_m, 2) / 12.0 / (n < 2 ? 1.0 : 9.0),
               east_m[LINES];
        asdic_tracker *tracker = NULL;
        asdic_tracker_options options = asdic_tracker_options_default();
        assert_ok(ctx, asdic_tracker_create(ctx, &options, &tracker));
        unsigned seed = 5;
        double total = 0.0, confirmed = 0.0;
        uint8_t *seen = calloc(4 * PINGS, 1);
        for (int k = 0; k < PINGS; k++) {
            asdic_plot_point plots[40];
            size_t count = 0, alive = 0; /* Poisson */
            for (double left = per_ping; count < 40; count++) {
                left += log((rand_r(&seed) + 0.5) / (RAND_MAX + 1.0));
                if (left < 0.0) {
                    break;
                }
                double range_m = mid_m + half_m * (2.0 * rand_r(&seed) / RAND_MAX - 1.0);
                plots[count] = plot_on(apart[n] * (rand_r(&seed) % LINES) + k * turns[n], range_m,
                                       along2, across2);
            }
            total += (double)count;
            assert_ok(ctx, asdic_tracker_update(tracker, k * step_s, plots, count));
            const asdic_track_state *tracks = asdic_tracker_get(tracker, &alive);
            for (size_t i = 0; i < alive; i++) {
                confirmed += tracks[i].confirmed && !seen[tracks[i].id];
                seen[tracks[i].id] |= tracks[i].confirmed;
            }
        }
        for (int i = 0; i < LINES; i++) {
            east_m[i] = apart[n] * mid_m * i;
        }
        asdic_plot_point plot = plot_on(0.0, mid_m, along2, across2);
        double per_m = per_ping / (2.0 * half_m * LINES), said[2];
        for (int k = 0; k < 2; k++) {
            said[k] =
                total * asdic_tracker_false_share(&options, step_s, &plot, per_m, east_m, LINES,
                                                  k ? mid_m : (double)INFINITY, turns[n]);
        }
        print_message(
            "%g rad, turned by %g: %.0f confirmed of %.0f, %.1f were said, side by side %.1f\n",
            apart[n], turns[n], confirmed, total, said[1], said[0]);
        double spread = 2.6 * sqrt(said[1]);
        assert_true(confirmed > 0.67 * said[1] - (n < 2 ? 0.0 : spread));
        assert_true(confirmed < 1.33 * said[1] + (n < 2 ? 0.0 : spread));
        free(seen);
        asdic_tracker_destroy(&tracker);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(tracks_follow),
        cmocka_unit_test(tracks_say_where_and_how_fast),
        cmocka_unit_test(tracks_live_by_their_hits),
        cmocka_unit_test(plots_go_to_the_nearest_track),
        cmocka_unit_test(trackers_have_limits),
        cmocka_unit_test(plots_have_limits),
        cmocka_unit_test(clutter_confirms_tracks_as_said),
        cmocka_unit_test(lines_that_are_many_say_the_same),
        cmocka_unit_test(beams_that_meet_confirm_more),
    };
    return cmocka_run_group_tests(tests, context_begin, context_end);
}
