/* Areas under curves against what is known of them, and scenes with settings put into them. */
#include "asserts.h"
#include "test_context.h"

#include "detect/roc_curve.h"

#include <asdic/mission.h>

#include <stdlib.h>
#include <string.h>

/* Two against three by hand: of nine pairs six are in order, one is a tie. */
static void an_area_counts_pairs(void **state) {
    (void)state;
    const double none[3] = {1.0, 2.0, 3.0}, present[3] = {2.0, 5.0, 2.5};
    asdic_estimate area;
    assert_status(ctx, asdic_roc_area(ctx, NULL, present, 3, &area), ASDIC_ERROR_ARGUMENT);
    assert_status(ctx, asdic_roc_area(ctx, none, NULL, 3, &area), ASDIC_ERROR_ARGUMENT);
    assert_status(ctx, asdic_roc_area(ctx, none, present, 3, NULL), ASDIC_ERROR_ARGUMENT);
    assert_ok(ctx, asdic_roc_area(ctx, none, present, 3, &area));
    assert_close(area.value, (1.5 + 3.0 + 2.0) / 9.0, 1e-15);
    const double apart[3] = {10.0, 11.0, 12.0};
    assert_ok(ctx, asdic_roc_area(ctx, none, apart, 3, &area));
    assert_close(area.value, 1.0, 0.0);
    assert_close(area.low, pow(0.005, 1.0 / 3.0), 1e-9);        /* 3 draws say little */
    assert_ok(ctx, asdic_roc_area(ctx, apart, none, 3, &area)); /* nor the other way round */
    assert_close(area.value, 0.0, 0.0);
    assert_close(area.high, 1.0 - pow(0.005, 1.0 / 3.0), 1e-9);
    assert_status(ctx, asdic_roc_area(ctx, none, apart, 1, &area), ASDIC_ERROR_ARGUMENT);
}

/* The bounds by hand, of 99 %: the places of the draws with a target are 1/2, 1 and 2/3, those of the others 0, 1/6 and
 * 2/3. Their variances of 7/108 and 13/108, over 3 draws each, make 5/81. */
static void an_area_has_bounds_by_its_places(void **state) {
    (void)state;
    double none[3] = {1.0, 2.0, 3.0}, present[3] = {2.0, 5.0, 2.5}, apart[3] = {10.0, 11.0, 12.0};
    const double half = 2.5758293035489004 * sqrt(5.0 / 81.0);
    asdic_estimate area, difference;
    assert_ok(ctx, asdic_roc_area(ctx, none, present, 3, &area));
    assert_close(area.low, 6.5 / 9.0 - half, 1e-12);
    assert_close(area.high, 1.0, 0.0); /* not beyond */
    assert_ok(ctx, asdic_roc_area(ctx, present, none, 3, &area));
    assert_close(area.high, 2.5 / 9.0 + half, 1e-12);
    assert_close(area.low, 0.0, 0.0);
    /* All places of draws apart are alike: the difference varies as the one area does. */
    asdic_roc a = {.trials = 3, .none = none, .present = present}, b = a;
    b.present = apart;
    assert_ok(ctx, asdic_roc_compare(ctx, &a, &b, &difference));
    assert_close(difference.value, 2.5 / 9.0, 1e-12);
    assert_close(difference.low, 2.5 / 9.0 - half, 1e-12);
    assert_close(difference.high, 2.5 / 9.0 + half, 1e-12);
    /* Two curves without any overlap may differ by what 3 draws do not tell: an event in none of 3. */
    a.present = apart;
    assert_ok(ctx, asdic_roc_compare(ctx, &a, &b, &difference));
    const double least = asdic_estimate_of(0, 3).high;
    assert_true(least > 0.5);
    assert_close(difference.low, -least, 1e-12);
    assert_close(difference.high, least, 1e-12);
    a.present = present;
    b.trials = 2;
    assert_status(ctx, asdic_roc_compare(ctx, &a, &b, &difference), ASDIC_ERROR_ARGUMENT);
    assert_status(ctx, asdic_roc_compare(ctx, NULL, &a, &difference), ASDIC_ERROR_ARGUMENT);
    assert_status(ctx, asdic_roc_compare(ctx, &a, NULL, &difference), ASDIC_ERROR_ARGUMENT);
    assert_status(ctx, asdic_roc_compare(ctx, &a, &a, NULL), ASDIC_ERROR_ARGUMENT);
}

/* The same error moves both bands: its end, not the widest of ends. */
static void bands_compare_end_by_end(void **state) {
    (void)state;
    const asdic_roc a = {.model_pd = {0.2, 0.6}}, b = {.model_pd = {0.5, 0.7}};
    const asdic_roc none = {.model_pd = {NAN, NAN}};
    asdic_band band = asdic_roc_compare_model(&a, &b);
    assert_close(band.low, 0.1, 1e-15);
    assert_close(band.high, 0.3, 1e-15);
    band = asdic_roc_compare_model(&b, &a);
    assert_close(band.low, -0.3, 1e-15);
    assert_close(band.high, -0.1, 1e-15);
    assert_true(isnan(asdic_roc_compare_model(&a, &none).low));
    assert_true(isnan(asdic_roc_compare_model(&none, &b).high));
    assert_true(isnan(asdic_roc_compare_model(NULL, &b).low));
    assert_true(isnan(asdic_roc_compare_model(&a, NULL).low));
}

/* More draws than are sorted at a time, of few values: pairs in order and ties counted in whole
 * numbers. */
static void count_pairs(size_t draws) {
    enum { VALUES = 997 };
    double *none = malloc(2 * draws * sizeof *none), *present = none + draws;
    uint64_t seen[2][VALUES] = {{0}};
    uint64_t number = 1, twice = 0, below = 0;
    for (size_t i = 0; i < 2 * draws; i++) {
        number = number * 6364136223846793005u + 1442695040888963407u;
        uint64_t value = (number >> 40) % VALUES;
        value = i < draws ? value * value / VALUES : value; /* less often high without a target */
        seen[i >= draws][value]++;
        none[i] = (double)value;
    }
    for (size_t v = 0; v < VALUES; v++) {
        twice += seen[1][v] * (2 * below + seen[0][v]);
        below += seen[0][v];
    }
    asdic_estimate area;
    assert_ok(ctx, asdic_roc_area(ctx, none, present, draws, &area));
    assert_close(area.value, 0.5 * (double)twice / (double)draws / (double)draws, 1e-10);
    free(none);
}

static void an_area_of_many_draws_counts_pairs(void **state) {
    (void)state;
    count_pairs(100000); /* two blocks, merged once */
    count_pairs(200001); /* four, merged twice */
}

typedef struct stopper {
    asdic_context *ctx;
    const char *at;
    size_t calls;
} stopper;

static void stop_at(void *user, const char *what, size_t done, size_t total) {
    stopper *s = user;
    assert_true(done < total);
    s->calls++;
    if (s->at && strcmp(what, s->at) == 0) {
        asdic_context_interrupt(s->ctx);
    }
}

static void an_area_can_be_stopped(void **state) {
    (void)state;
    enum { DRAWS = 200000 };
    static const char *const parts[] = {"draws sorted", "draws merged", "draws placed"};
    double *draws = calloc(2 * DRAWS, sizeof *draws);
    for (size_t i = 0; i < sizeof parts / sizeof *parts; i++) {
        asdic_estimate area;
        stopper s = {.at = parts[i]};
        assert_int_equal(asdic_context_create(&s.ctx), ASDIC_OK);
        asdic_context_set_progress(s.ctx, stop_at, &s);
        assert_int_equal(asdic_roc_area(s.ctx, draws, draws + DRAWS, DRAWS, &area),
                         ASDIC_ERROR_INTERRUPTED);
        assert_non_null(strstr(asdic_context_error(s.ctx), parts[i]));
        asdic_context_destroy(&s.ctx);
    }
    /* Told now and then, not of each draw. */
    asdic_estimate area;
    stopper s = {.at = NULL};
    assert_int_equal(asdic_context_create(&s.ctx), ASDIC_OK);
    asdic_context_set_progress(s.ctx, stop_at, &s);
    assert_ok(s.ctx, asdic_roc_area(s.ctx, draws, draws + DRAWS, DRAWS, &area));
    assert_in_range(s.calls, 3, 100);
    asdic_context_destroy(&s.ctx);
    free(draws);
}

typedef struct parts {
    struct {
        const char *what;
        size_t calls, last, total;
    } part[8];
    size_t count;
    bool is_odd;
} parts;

/* No assertion: the context is locked meanwhile. */
static void follow(void *user, const char *what, size_t done, size_t total) {
    parts *p = user;
    size_t i = 0;
    while (i < p->count && strcmp(p->part[i].what, what) != 0) {
        i++;
    }
    if (i == 8) {
        p->is_odd = true;
        return;
    }
    p->is_odd |= done >= total || (i == p->count ? done > 0 : done <= p->part[i].last && done > 0);
    p->count += i == p->count;
    p->part[i].what = what;
    p->part[i].last = done;
    p->part[i].total = total;
    p->part[i].calls++;
}

/* Each part is told from nothing done to all but the last, and of as many as there are. */
static void progress_is_told_to_the_end(void **state) {
    (void)state;
    const struct {
        const char *what;
        size_t calls, last, total;
    } cases[] = {{"draws", 8, 3 << 16, 200000}, /* without a target, then with one */
                 {"draws sorted", 8, 3 << 16, 200000},
                 {"draws placed", 8, 3 << 16, 200000},
                 {"points", 0, 0, 0}, /* as many as the curve has */
                 {"steps of the closed form", 401, 400, 401}};
    asdic_roc_options options = asdic_roc_options_default();
    asdic_roc *roc = calloc(1, sizeof *roc);
    asdic_roc_case c = {.none = {1e-9, 5, INFINITY, 0.0}, .target_lin = 4e-9};
    roc->trials = 200000;
    roc->pfa = 1e-2;
    c.rest = c.none;
    parts p = {.count = 0};
    asdic_context_set_progress(ctx, follow, &p);
    assert_ok(ctx, asdic_roc_fill(ctx, &c, &options, roc));
    asdic_context_set_progress(ctx, NULL, NULL);
    assert_false(p.is_odd);
    for (size_t i = 0, k; i < sizeof cases / sizeof *cases; i++) {
        for (k = 0; k < p.count && strcmp(p.part[k].what, cases[i].what) != 0; k++) {
        }
        bool is_curve = cases[i].total == 0;
        assert_true(k < p.count);
        assert_int_equal(p.part[k].calls, is_curve ? roc->point_count : cases[i].calls);
        assert_int_equal(p.part[k].last, is_curve ? roc->point_count - 1 : cases[i].last);
        assert_int_equal(p.part[k].total, is_curve ? roc->point_count : cases[i].total);
    }
    asdic_roc_destroy(&roc);
}

static asdic_roc *compute(double snr, unsigned looks, asdic_target target, uint64_t seed) {
    asdic_roc_options options = asdic_roc_options_default();
    asdic_roc *roc = calloc(1, sizeof *roc);
    asdic_roc_case c = {.none = {1e-9, looks, INFINITY, 0.0}, .target_lin = snr * 1e-9};
    c.rest = c.none;
    options.target = target;
    options.seed = seed;
    roc->trials = 200000;
    roc->pfa = 1e-2;
    assert_ok(ctx, asdic_roc_fill(ctx, &c, &options, roc));
    return roc;
}

static void closed_forms_lie_in_the_bounds(void **state) {
    (void)state;
    for (int t = 0; t < 4; t++) {
        asdic_roc *roc = compute(4.0, t == 1 ? 1 : 5, (asdic_target)t, 5);
        if (t == 1) { /* exponentials of means 1 and 1 + snr: (1 + snr) / (2 + snr) */
            assert_close(roc->closed_area, 5.0 / 6.0, 1e-6);
        }
        print_message("target %d: area %.6f [%.6f, %.6f], closed form %.6f\n", t, roc->area.value,
                      roc->area.low, roc->area.high, roc->closed_area);
        assert_true(roc->closed_area >= roc->area.low && roc->closed_area <= roc->area.high);
        assert_true(roc->area.high - roc->area.low < 0.01);
        assert_true(roc->closed_pd >= roc->pd.low && roc->closed_pd <= roc->pd.high);
        assert_int_equal(roc->point_count, 49);
        int outside = 0;
        for (size_t i = 0; i < roc->point_count; i++) {
            const asdic_roc_point *p = &roc->points[i];
            outside += p->closed_pd < p->pd.low || p->closed_pd > p->pd.high;
            outside += p->design_pfa < p->pfa.low || p->design_pfa > p->pfa.high;
        }
        assert_true(outside <= 6); /* of 98 that hang together */
        for (size_t i = 0; t == 1 && i + 1 < roc->point_count; i++) {
            const asdic_roc_point *p = &roc->points[i]; /* eight a decade, e^-z and e^-(z / 5) */
            assert_close_relative(p->design_pfa, pow(10.0, (double)i / 8.0 - 6.0), 1e-12);
            assert_close(p->threshold_db, 10.0 * log10(-1e-9 * log(p->design_pfa)), 1e-9);
            assert_close_relative(p->closed_pd, pow(p->design_pfa, 0.2), 1e-9);
        }
        asdic_roc_destroy(&roc);
    }
    asdic_roc *chance = compute(0.0, 2, ASDIC_TARGET_SWERLING1, 1);
    assert_close(chance->closed_area, 0.5, 1e-7);
    assert_true(chance->area.low < 0.5 && chance->area.high > 0.5);
    for (size_t i = 0; i < chance->trials; i++) { /* each kind has its own random numbers */
        assert_true(chance->none[i] != chance->present[i]);
    }
    asdic_roc_destroy(&chance);
}

/* Of 99 %: also where some four draws of 400 lie among those of the other kind. */
static void few_overlaps_make_wide_bounds(void **state) {
    (void)state;
    enum { DRAWS = 200, SETS = 1000 };
    const double snr = 98.0, truth = (1.0 + snr) / (2.0 + snr);
    const asdic_background b = {1.0, 1, INFINITY, 0.0};
    double none[DRAWS], present[DRAWS];
    int outside = 0;
    for (uint64_t set = 0; set < SETS; set++) {
        asdic_estimate area;
        asdic_detect_draw(&b, ASDIC_TARGET_SWERLING1, 0.0, 1, set * DRAWS, DRAWS, none);
        asdic_detect_draw(&b, ASDIC_TARGET_SWERLING1, snr, 2, set * DRAWS, DRAWS, present);
        assert_ok(ctx, asdic_roc_area(ctx, none, present, DRAWS, &area));
        outside += truth < area.low || truth > area.high;
    }
    print_message("%d of %d bounds leave the area out\n", outside, SETS);
    assert_true(outside <= SETS / 100);
}

/* A tenth of a decibel is lost in the bounds of the areas, not in those of their difference. */
static void pairs_compare_better(void **state) {
    (void)state;
    asdic_roc *a = compute(4.0, 3, ASDIC_TARGET_SWERLING1, 9);
    asdic_roc *b = compute(4.0 * 1.023, 3, ASDIC_TARGET_SWERLING1, 9);
    asdic_roc *other = compute(4.0, 3, ASDIC_TARGET_SWERLING1, 10);
    asdic_estimate paired, unpaired;
    assert_ok(ctx, asdic_roc_compare(ctx, a, b, &paired));
    assert_ok(ctx, asdic_roc_compare(ctx, other, b, &unpaired));
    double truth = b->closed_area - a->closed_area;
    print_message("difference %.5f: paired %.5f..%.5f, unpaired %.5f..%.5f\n", truth, paired.low,
                  paired.high, unpaired.low, unpaired.high);
    assert_true(paired.low > 0.0 && truth >= paired.low && truth <= paired.high);
    assert_true(truth >= unpaired.low && truth <= unpaired.high);
    assert_true(paired.high - paired.low < 0.1 * (unpaired.high - unpaired.low));
    asdic_roc_destroy(&a);
    asdic_roc_destroy(&b);
    asdic_roc_destroy(&other);
}

static void load_with(const char *key, const char *value, asdic_mission **out) {
    asdic_setting setting = {key, value};
    assert_ok(ctx,
              asdic_mission_load_with(ctx, DATA_DIR "/scenes/scenario2.yaml", &setting, 1, out));
}

static void settings_replace_and_add(void **state) {
    (void)state;
    asdic_mission *m = NULL;
    load_with("sonar.receivers[1].pitch_deg", "45", &m);
    assert_close(asdic_mission_sonar(m)->receivers[1].pitch_rad, 0.78539816339744831, 1e-15);
    assert_close(asdic_mission_sonar(m)->receivers[2].pitch_rad, -0.3490658503988659, 1e-12);
    asdic_mission_destroy(&m);
    load_with("mission.pose.position_m[2]", "9", &m);
    assert_close(asdic_mission_pose(m, 0, NULL).position_m.z, 9.0, 0.0);
    asdic_mission_destroy(&m);
    load_with("objects[0].box.size_m[0]", "10", &m); /* its centre stays at 55 m */
    assert_close(asdic_mission_get_object(m, 0)->min_m.x, 50.0, 1e-5);
    asdic_mission_destroy(&m);
    load_with("detector.pfa", "0.25", &m); /* not in the file */
    assert_close(asdic_mission_detector(m)->pfa, 0.25, 0.0);
    asdic_run_options options = asdic_run_options_default();
    asdic_device *none = NULL;
    options.folder = "unused";
    assert_status(ctx, asdic_mission_run(ctx, m, &none, 1, &options), ASDIC_ERROR_UNSUPPORTED);
    asdic_mission_destroy(&m);
}

static void targets_without_a_bearing_are_refused(void **state) {
    (void)state;
    asdic_mission *m = NULL;
    asdic_roc *roc = NULL;
    asdic_device *unused = (asdic_device *)&roc;
    assert_ok(ctx, asdic_mission_load(ctx, DATA_DIR "/scenes/scenario2.yaml", &m));
    const double bad[] = {NAN, INFINITY, -INFINITY};
    for (size_t i = 0; i < 4; i++) {
        asdic_roc_options options = asdic_roc_options_default();
        options.range_m = 20.0;
        options.target_strength_db = -20.0;
        options.bearing_rad = i < 3 ? bad[i] : 0.0;
        options.target = i < 3 ? options.target : (asdic_target)7;
        assert_status(ctx, asdic_roc_compute(ctx, m, unused, &options, &roc), ASDIC_ERROR_ARGUMENT);
        assert_contains(asdic_context_error(ctx), i < 3 ? "bearing of " : "no kind, 7");
        assert_null(roc);
    }
    asdic_mission_destroy(&m);
}

static char last[1024];

static void remember(void *user, asdic_log_level level, const char *message) {
    (void)user;
    (void)level;
    snprintf(last, sizeof last, "%s", message);
}

static void wrong_settings_are_named(void **state) {
    (void)state;
    static const struct {
        const char *key, *value, *says;
    } wrong[] = {
        {"sonar.receivers[3].pitch_deg", "1", "there is no '[3]'"},
        {"sonar.receivers[x].pitch_deg", "1", "there is no '[x]'"},
        {"sonar.receivers.pitch_deg", "1", "not in a map"},
        {"sonar..frequency_khz", "1", "a key is missing"},
        {"", "1", "a key is missing"},
        {"sonar.frequenci_khz", "1", "did you mean 'frequency_khz'"},
        {"sonar.frequency_khz", "9000", "out of range"},
        {"sonar.frequency_khz", "loud", "loud"},
    };
    asdic_context_set_log(ctx, ASDIC_LOG_ERROR, remember, NULL);
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
        asdic_setting setting = {wrong[i].key, wrong[i].value};
        asdic_mission *m = NULL;
        assert_status(
            ctx, asdic_mission_load_with(ctx, DATA_DIR "/scenes/scenario2.yaml", &setting, 1, &m),
            ASDIC_ERROR_INPUT);
        assert_null(m);
        assert_contains(last, wrong[i].says);
    }
    asdic_context_set_log(ctx, ASDIC_LOG_ERROR, NULL, NULL);
}

/* P_D at a P_FA of 1e-3 over K-distributed reverberation of REVERBERATION_LIN and a NOISE_LIN that no law moves. */
static double pd_over(double reverberation_lin, double noise_lin, double target_lin) {
    double mean_lin = reverberation_lin + noise_lin, threshold_lin;
    asdic_background b = {
        .mean_lin = mean_lin, .looks = 1, .shape = 1.0, .noise_share = noise_lin / mean_lin};
    assert_ok(ctx, asdic_detect_threshold(ctx, &b, 1e-3, &threshold_lin));
    return asdic_detect_pd(&b, ASDIC_TARGET_SWERLING1, target_lin, threshold_lin);
}

/* What laws leave open moves the background's mean and the echo; ambient noise stays what it is. */
static void bands_hold_what_the_laws_leave_open(void **state) {
    (void)state;
    asdic_background b = {.mean_lin = 2.0, .looks = 1, .shape = 1.0, .noise_share = 0.25};
    asdic_roc_case c = {.none = b, .rest = b, .target_lin = 40.0};
    asdic_band band;
    assert_ok(ctx, asdic_roc_band(ctx, &c, ASDIC_TARGET_SWERLING1, 1e-3, &band));
    assert_true(isnan(band.low) && isnan(band.high)); /* nothing is stated */
    c.background_most_db = 10.0 * log10(2.0); /* a mean of 4 and of 1, of which noise is 0.5 */
    c.background_least_db = -c.background_most_db;
    c.target_error_db = 10.0 * log10(1.25);
    assert_ok(ctx, asdic_roc_band(ctx, &c, ASDIC_TARGET_SWERLING1, 1e-3, &band));
    assert_close(band.low, pd_over(3.5, 0.5, 32.0), 1e-9);
    assert_close(band.high, pd_over(0.5, 0.5, 50.0), 1e-9);
    assert_true(band.low > 0.05 && band.high < 0.95 && band.low + 0.1 < band.high);
    c.background_least_db = 10.0 * log10(0.125); /* all of it is noise */
    c.target_error_db = 0.0;
    assert_ok(ctx, asdic_roc_band(ctx, &c, ASDIC_TARGET_SWERLING1, 1e-3, &band));
    assert_true(band.high > pd_over(0.5, 0.5, 40.0));
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(progress_is_told_to_the_end),
        cmocka_unit_test(an_area_counts_pairs),
        cmocka_unit_test(an_area_has_bounds_by_its_places),
        cmocka_unit_test(bands_compare_end_by_end),
        cmocka_unit_test(an_area_of_many_draws_counts_pairs),
        cmocka_unit_test(an_area_can_be_stopped),
        cmocka_unit_test(closed_forms_lie_in_the_bounds),
        cmocka_unit_test(few_overlaps_make_wide_bounds),
        cmocka_unit_test(pairs_compare_better),
        cmocka_unit_test(bands_hold_what_the_laws_leave_open),
        cmocka_unit_test(settings_replace_and_add),
        cmocka_unit_test(targets_without_a_bearing_are_refused),
        cmocka_unit_test(wrong_settings_are_named),
    };
    return cmocka_run_group_tests(tests, context_begin, context_end);
}
