/*
 * A trial from the disk: every field of its rows, every fact and every figure, each against numbers
 * that differ from all others; and what it says of files that are not those of a trial.
 */
#include "dice.h"
#include "trial_rig.h"

#include <asdic/output.h>

#include <math.h>
#include <sys/stat.h>

static void rows_are_read(void **state) {
    (void)state;
    asdic_trial *t = open_trial();
    static const asdic_trial_run first = {.outcome = ASDIC_TRIAL_HIT,
                                          .cause = ASDIC_TRIAL_SEEN_LATE,
                                          .what = "rock",
                                          .time_s = 10.5,
                                          .distance_m = 100,
                                          .pings = 21,
                                          .clearance_m = 0.25,
                                          .manoeuvres = 3,
                                          .needless = 1,
                                          .seen_m = 12.5};
    assert_int_equal(t->row_count, 8);
    for (size_t i = 0; i < 8; i++) {
        const asdic_trial_run *r = &t->rows[i].flown;
        assert_int_equal(t->rows[i].run, 7 + i / 2);
        assert_int_equal(t->rows[i].variant, i % 2);
        assert_true(r->time_s == 10.5 + (double)i && r->distance_m == 100.0 * ((double)i + 1.0));
        assert_int_equal(r->pings, 21 + i);
        assert_int_equal(r->manoeuvres, 3 + i);
    }
    const asdic_trial_run *r = &t->rows[0].flown;
    assert_int_equal(r->outcome, first.outcome);
    assert_int_equal(r->cause, first.cause);
    assert_string_equal(r->what, first.what);
    assert_true(r->clearance_m == first.clearance_m && r->seen_m == first.seen_m);
    assert_int_equal(r->needless, first.needless);
    assert_int_equal(t->rows[6].flown.needless, 15);
    assert_true(isnan(t->rows[1].flown.seen_m) && isinf(t->rows[5].flown.clearance_m));
    assert_int_equal(t->rows[7].flown.outcome, ASDIC_TRIAL_LATE);
    assert_string_equal(t->header, header);
    assert_string_equal(t->body, rows);
    asdic_trial_close(&t);
    assert_null(t);
}

static void facts_are_read(void **state) {
    (void)state;
    asdic_trial *t = open_trial();
    const trial_facts *f = &t->facts;
    assert_string_equal(f->scene, "reef");
    assert_string_equal(f->hash, "c0ffee");
    assert_int_equal(f->seed, 11);
    assert_int_equal(f->runs, 40);
    assert_int_equal(f->first, 7);
    assert_int_equal(f->count, 4);
    assert_int_equal(f->rays, 2048);
    assert_string_equal(f->rule, "rule.py --quick");
    assert_int_equal(asdic_trial_variant_count(t), 2);
    assert_string_equal(asdic_trial_variant_name(t, 0), "sonar.beam = a");
    assert_string_equal(asdic_trial_variant_name(t, 1), "sonar.beam = b");
    assert_null(asdic_trial_variant_name(t, 2));
    assert_int_equal(asdic_trial_get(t, 2).runs, 0);
    asdic_trial_close(&t);
    assert_int_equal(asdic_trial_variant_count(NULL), 0);
    assert_true(asdic_trial_is_in(folder));
    assert_false(asdic_trial_is_in("/nowhere"));
    assert_false(asdic_trial_is_in(NULL));
}

static void assert_figure(asdic_trial_figure actual, asdic_trial_figure expected) {
    assert_close(actual.value, expected.value, 1e-12);
    assert_close(actual.low, expected.low, 1e-12);
    assert_close(actual.high, expected.high, 1e-12);
}

/* Of the first variant's 0.9 km with 1, 2 and 0 events in 0.1, 0.3 and 0.5 km: 2.1 times the variance of
 * independent ones (Cochran's (6.4)), of which there is then one: by a Poisson law it lies between
 * -ln(0.975) and the mean u for which (1 + u) exp(-u) = 0.025. */
static asdic_trial_figure first_rate(void) {
    double rate = 3.0 / 0.9, u = 5.57164339093889;
    assert_close((1.0 + u) * exp(-u), 0.025, 1e-14);
    return (asdic_trial_figure){rate, -rate * log(0.975), rate * u};
}

static void figures_are_those_of_the_rows(void **state) {
    (void)state;
    asdic_trial *t = open_trial();
    asdic_trial_result a = asdic_trial_get(t, 0), b = asdic_trial_get(t, 1);
    static const uint64_t outcomes[2][ASDIC_TRIAL_OUTCOMES] = {{1, 2, 0, 1, 0}, {2, 1, 1, 0, 0}};
    static const uint64_t causes[2][ASDIC_TRIAL_CAUSES] = {{2, 0, 1, 1}, {3, 1, 0, 0}};
    for (int i = 0; i < ASDIC_TRIAL_OUTCOMES; i++) {
        assert_int_equal(a.outcomes[i], outcomes[0][i]);
        assert_int_equal(b.outcomes[i], outcomes[1][i]);
    }
    for (int i = 0; i < ASDIC_TRIAL_CAUSES; i++) {
        assert_int_equal(a.causes[i], causes[0][i]);
        assert_int_equal(b.causes[i], causes[1][i]);
    }
    assert_int_equal(a.runs, 3); /* one is void */
    assert_int_equal(b.runs, 4);
    assert_int_equal(a.pings, 21 + 23 + 25);
    assert_int_equal(b.pings, 22 + 24 + 26 + 28);
    assert_close(a.km, 0.9, 1e-12);
    assert_close(b.km, 2.0, 1e-12);
    assert_true(a.least_clearance_m == 0.0625 && b.least_clearance_m == 0.125);
    assert_figure(a.collision, asdic_trial_share(2, 3, 0.95));
    assert_figure(b.collision, asdic_trial_share(1, 4, 0.95));
    assert_figure(a.needless, asdic_trial_share(2, 3, 0.95));
    assert_figure(b.needless, asdic_trial_share(0, 4, 0.95));
    assert_figure(a.needless_per_km, first_rate());
    /* No event in 2 km: exp(-2 rate) is 2.5 % at the upper bound. */
    assert_figure(b.needless_per_km, (asdic_trial_figure){0.0, 0.0, -log(0.025) / 2.0});
    /* Three pairs: hit by the first in two of them, by the second in another. */
    assert_figure(b.difference, asdic_trial_paired(1, 2, 3, 0.95));
    assert_close(b.mcnemar, asdic_trial_mcnemar(1, 2), 0.0);
    double p = 2.0 / 3.0, q = 1.0 / 3.0, d = -1.0 / 3.0;
    assert_close(b.paired_share, (1.0 - d * d) / (p * (1.0 - p) + q * (1.0 - q)), 1e-12);
    assert_true(isnan(a.mcnemar) && isnan(a.paired_share) && isnan(a.difference.value));
    asdic_trial_close(&t);
}

/* RUNS of 0.1 km each; NEEDLESS(RUN) says how often each gave way to nothing. */
static asdic_trial_figure rate_of(size_t runs, unsigned (*needless)(size_t run)) {
    static char text[100000];
    asdic_trial *t = NULL;
    size_t length = 0;
    for (size_t i = 0; i < runs; i++) {
        length += (size_t)snprintf(text + length, sizeof text - length,
                                   "%zu,0,clear,,,10,100,20,1,9,%u,,30\n", i, needless(i));
    }
    assert_true(length < sizeof text - 1);
    write_file("trial.csv", header, text);
    snprintf(text, sizeof text,
             "{\"scene\": \"reef\", \"hash\": \"c0ffee\", \"runs\": %zu, \"count\": %zu}", runs,
             runs);
    write_file("trial.json", text, "\n");
    assert_ok(ctx, asdic_trial_open(ctx, folder, &t));
    asdic_trial_figure rate = asdic_trial_get(t, 0).needless_per_km;
    asdic_trial_close(&t);
    return rate;
}

static double mean;    /* of a run */
static unsigned clump; /* manoeuvres that come together */
static uint64_t dice = 4;

static unsigned by_chance(size_t run) {
    (void)run;
    unsigned count = 0; /* Poisson */
    for (double left = mean / clump; (left += log(random_unit(&dice) + 1e-300)) > 0.0;) {
        count++;
    }
    return clump * count;
}

static unsigned once(size_t run) {
    (void)run;
    return 1;
}

/* Bounds of 95 % are missed to either side by 2.5 % at most, where there are few events as well (of 2 or 3 by
 * the spread alone, as if it were normal, by 15 %); and a few runs that are the same are not all there can be. */
static void few_events_have_wide_bounds(void **state) {
    (void)state;
    enum { TRIALS = 600 };
    static const struct {
        size_t runs;
        double mean;
        unsigned clump;
        double most; /* by which the bounds may be missed */
    } cases[] = {{100, 0.03, 1, 0.025},
                 {100, 0.1, 1, 0.025},
                 {2, 0.5, 1, 0.025},
                 {5, 0.5, 1, 0.025},
                 {100, 0.4, 2, 0.05}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        size_t above = 0, below = 0;
        mean = cases[i].mean;
        clump = cases[i].clump;
        for (int k = 0; k < TRIALS; k++) {
            asdic_trial_figure rate = rate_of(cases[i].runs, by_chance);
            above += mean / 0.1 > rate.high;
            below += mean / 0.1 < rate.low;
        }
        print_message("%zu runs of %g: missed by %zu and %zu of %d\n", cases[i].runs, mean, above,
                      below, TRIALS);
        double most = cases[i].most * TRIALS, spread = 2.6 * sqrt(most);
        assert_true((double)above < most + spread && (double)below < most + spread);
    }
    asdic_trial_figure few = rate_of(3, once), many = rate_of(1000, once);
    assert_close(few.value, 10.0, 1e-12);
    assert_true(few.low < 5.0 && few.high > 20.0);
    assert_true(many.low > 9.9 && many.high < 10.1);
}

/* Everything behind KEY in TEXT up to the line's end is VALUE. */
static void assert_value(const char **text, const char *key, const char *value) {
    char line[200];
    snprintf(line, sizeof line, "      \"%s\": %s,\n", key, value);
    if (strncmp(*text, line, strlen(line)) != 0) {
        fail_msg("'%s' missing, there is '%.80s'", line, *text);
    }
    *text += strlen(line);
}

static void assert_values(const char **text, const char *key, asdic_trial_figure f) {
    char value[150];
    snprintf(value, sizeof value, "[%.9g, %.9g, %.9g]", f.value, f.low, f.high);
    assert_value(text, key, value);
}

static void results_are_written(void **state) {
    (void)state;
    asdic_trial *t = open_trial();
    asdic_text text = {0};
    asdic_trial_print(&t->facts, t->results, (const char *const *)t->names, &text);
    assert_false(text.failed);
    const char *at = text.data;
    static const char begin[] = "    {\n", next[] = ",\n    {\n", end[] = "\n  ]\n}\n";
    assert_memory_equal(at, facts, strlen(facts));
    at += strlen(facts);
    static const char *const name[2] = {"\"sonar.beam = a\"", "\"sonar.beam = b\""};
    static const char *const counts[2][9] = {{"3", "1", "2", "0", "1", "0", "0", "1", "1"},
                                             {"4", "2", "1", "1", "0", "0", "1", "0", "0"}};
    static const char *const keys[9] = {"runs",   "clear",    "hit",       "late",          "void",
                                        "broken", "not seen", "seen late", "could not turn"};
    for (int v = 0; v < 2; v++) {
        const asdic_trial_result *r = &t->results[v];
        char value[40];
        assert_memory_equal(at, v ? next : begin, strlen(v ? next : begin));
        at += strlen(v ? next : begin);
        assert_value(&at, "name", name[v]);
        for (int k = 0; k < 9; k++) {
            assert_value(&at, keys[k], counts[v][k]);
        }
        assert_values(&at, "collision", r->collision);
        assert_values(&at, "needless", r->needless);
        assert_values(&at, "needless_per_km", r->needless_per_km);
        if (v == 1) {
            assert_values(&at, "difference", r->difference);
            snprintf(value, sizeof value, "%.9g", r->mcnemar);
            assert_value(&at, "mcnemar", value);
            snprintf(value, sizeof value, "%.9g", r->paired_share);
            assert_value(&at, "paired_share", value);
        }
        assert_value(&at, "km", v ? "2" : "0.9");
        assert_value(&at, "least_clearance_m", v ? "0.125" : "0.0625");
        const char *pings = v ? "      \"pings\": 100\n    }" : "      \"pings\": 69\n    }";
        assert_memory_equal(at, pings, strlen(pings));
        at += strlen(pings);
    }
    assert_string_equal(at, end);
    asdic_text_finish(&text);
    t->results[0].least_clearance_m = INFINITY;
    asdic_trial_print(&t->facts, t->results, (const char *const *)t->names, &text);
    assert_contains(text.data, "\"least_clearance_m\": null,\n");
    asdic_text_finish(&text);
    asdic_trial_close(&t);
}

/* Looks at plots in the place of drawing them; NULL: they are drawn. */
static void (*look)(const asdic_plot *plots);

asdic_status __real_asdic_picture_plot(asdic_context *context, const char *path,
                                       const asdic_plot *panels, size_t panel_count,
                                       const asdic_picture_options *options);
asdic_status __wrap_asdic_picture_plot(asdic_context *context, const char *path,
                                       const asdic_plot *panels, size_t panel_count,
                                       const asdic_picture_options *options);
asdic_status __wrap_asdic_picture_plot(asdic_context *context, const char *path,
                                       const asdic_plot *panels, size_t panel_count,
                                       const asdic_picture_options *options) {
    if (!look) {
        return __real_asdic_picture_plot(context, path, panels, panel_count, options);
    }
    assert_int_equal(panel_count, 3);
    look(panels);
    return ASDIC_OK;
}

/* Both ends of an interval, a line between them, its value. */
static void assert_drawn(const asdic_series *s, double at, asdic_trial_figure f) {
    assert_int_equal(s->count, 11);
    for (int i = 0; i < 11; i += 3) { /* gaps between */
        assert_close(0.5 * (s->x[i] + s->x[i + 1]), at, 1e-12);
        assert_true(i + 2 >= 11 || !isfinite(s->x[i + 2] + s->y[i + 2]));
    }
    assert_true(s->y[0] == f.low && s->y[1] == f.low && s->y[6] == f.high && s->y[7] == f.high);
    assert_true(s->y[3] == f.low && s->y[4] == f.high && s->x[3] == s->x[4]);
    assert_true(s->y[9] == f.value && s->y[10] == f.value);
}

static void look_at_plots(const asdic_plot *plots) {
    const asdic_trial_figure collision[2] = {asdic_trial_share(2, 3, 0.95),
                                             asdic_trial_share(1, 4, 0.95)};
    const asdic_trial_figure needless[2] = {asdic_trial_share(2, 3, 0.95),
                                            asdic_trial_share(0, 4, 0.95)};
    static const double clearance_m[2][3] = {{0.0625, 0.25, 5.5}, {0.125, 4.5, 9.5}};
    for (int v = 0; v < 2; v++) {
        assert_drawn(&plots[0].series[v], v + 1.0, collision[v]);
        assert_drawn(&plots[1].series[v], v + 1.0, needless[v]);
        /* Steps at the clearances: the run that is void is none, and the one that met nothing has none. */
        const asdic_series *s = &plots[2].series[v];
        assert_int_equal(s->count, 6);
        for (int i = 0; i < 3; i++) {
            assert_true(s->x[2 * i] == clearance_m[v][i] && s->x[2 * i + 1] == clearance_m[v][i]);
            assert_close(s->y[2 * i], i / (v ? 4.0 : 3.0), 1e-12);
            assert_close(s->y[2 * i + 1], (i + 1) / (v ? 4.0 : 3.0), 1e-12);
        }
    }
    for (int k = 0; k < 3; k++) {
        assert_int_equal(plots[k].series_count, 2);
    }
    /* Whatever is drawn has its place. */
    assert_true(plots[0].y.low == 0.0 && plots[0].y.high >= collision[0].high);
    assert_true(plots[1].y.low == 0.0 && plots[1].y.high >= needless[0].high);
    assert_true(plots[2].x.low == 0.0 && plots[2].x.high == 9.5);
    assert_true(plots[2].y.low == 0.0 && plots[2].y.high == 1.0);
    look = NULL;
}

static void figures_are_drawn(void **state) {
    (void)state;
    asdic_trial *t = open_trial();
    look = look_at_plots;
    assert_ok(ctx, asdic_trial_draw(ctx, t, "nowhere.png"));
    assert_null(look); /* it was called */
    asdic_trial_close(&t);
}

static size_t designs;

/* Up to eight designs have their values at the axis, more their numbers. */
static void look_at_names(const asdic_plot *plots) {
    for (int k = 0; k < 2; k++) {
        const asdic_plot_axis *x = &plots[k].x;
        assert_int_equal(x->name_count, designs);
        for (size_t v = 0; v < designs; v++) {
            char number[24];
            snprintf(number, sizeof number, "%zu", v + 1);
            assert_string_equal(x->names[v], designs > 8 ? number : "a value");
        }
        assert_string_equal(x->label,
                            designs > 8 ? "design, in the order of the legend" : "sonar.beam");
    }
    look = NULL;
}

static void many_designs_have_numbers(void **state) {
    (void)state;
    for (designs = 7; designs <= 9; designs++) {
        static char key[] = "sonar.beam", value[] = "a value", name[] = "sonar.beam = a value";
        asdic_trial t = {.facts = {.key = key, .variants = designs}};
        for (size_t v = 0; v < designs; v++) {
            t.facts.values[v] = value;
            t.names[v] = name;
        }
        look = look_at_names;
        assert_ok(ctx, asdic_trial_draw(ctx, &t, "nowhere.png"));
        assert_null(look);
    }
}

/* WORD of the facts or rows replaced by OTHER; what the error says. */
static void refuse(const char *word, const char *other, const char *says) {
    char text[2][1000];
    asdic_trial *t = NULL;
    replace(facts, word, other, text[0]);
    replace(rows, word, other, text[1]);
    write_file("trial.json", text[0], "  ]\n}\n");
    write_file("trial.csv", header, text[1]);
    assert_status(ctx, asdic_trial_open(ctx, folder, &t), ASDIC_ERROR_INPUT);
    assert_null(t);
    assert_contains(asdic_context_error(ctx), says);
    assert_contains(asdic_context_error(ctx), "--force");
}

static void damage_is_told(void **state) {
    (void)state;
    static const char json[] = "trial.json: this is no trial.json";
    static const char csv[] = "trial.csv: its rows are not those of the trial";
    refuse("c0ffee", "", json);
    refuse("\"runs\": 40", "\"runs\": 0", json);
    refuse("\"key\": \"sonar.beam\"", "\"key\": [1]", json);
    refuse("[\"a\", \"b\"]", "[]", json);
    refuse("\"scene\"", "[\"scene\"", json);
    refuse("\"first\": 7", "\"first\": 6", csv);
    refuse("8,0,clear", "9,0,clear", csv);
    refuse("8,0,clear", "8,1,clear", csv);
    refuse("8,0,clear", "8,0,well", csv);
    refuse("seen late", "unlucky", csv);
    refuse("\"count\": 4", "\"count\": 5", "trial.csv: rows are missing");
    refuse("10,1,late,,,17.5,800,28,9.5,10,0,,33\n", "", "trial.csv: rows are missing");
    refuse("33\n10,1,late,,,17.5,800,28,9.5,10,0,,33\n", "33\n10,1,la", "rows are missing");
    asdic_trial *t = NULL;
    assert_status(ctx, asdic_trial_open(ctx, NULL, &t), ASDIC_ERROR_ARGUMENT);
    assert_status(ctx, asdic_trial_open(ctx, folder, NULL), ASDIC_ERROR_ARGUMENT);
    assert_true(asdic_trial_open(ctx, "/nowhere", &t) != ASDIC_OK);
    assert_null(t);
}

/* Under way rows may be missing, and the last be cut. */
static void one_under_way_is_read(void **state) {
    (void)state;
    static const char whole[] = "7,0,hit,seen late,rock,10.5,100,21,0.25,3,1,12.5,30\n";
    asdic_trial *t = NULL;
    write_file("trial.part.json", facts, "  ]\n}\n");
    char some[200];
    snprintf(some, sizeof some, "%s7,1,cle", whole);
    write_file("trial.part.csv", header, some);
    assert_ok(ctx, asdic_trial_read(ctx, folder, true, &t));
    assert_int_equal(t->row_count, 1);
    assert_string_equal(t->body, whole);
    assert_int_equal(asdic_trial_get(t, 0).runs, 1);
    assert_int_equal(asdic_trial_get(t, 1).runs, 0);
    /* One run tells nothing of the spread. */
    assert_true(isinf(asdic_trial_get(t, 0).needless_per_km.high));
    asdic_trial_close(&t);
}

/* What was flown before is on the disk as soon as a trial goes on, and before that: a process that is killed
 * in its first run loses none. */
static void rows_stay_where_it_goes_on(void **state) {
    (void)state;
    asdic_trial *t = NULL;
    FILE *out = NULL, *other = NULL;
    char path[200], text[4000] = "";
    asdic_text head = {0}, body = {0};
    write_file("trial.part.json", facts, "  ]\n}\n");
    write_file("trial.part.csv", header, rows);
    assert_ok(ctx, asdic_trial_read(ctx, folder, true, &t));
    asdic_text_add(&head, t->header);
    asdic_text_add(&body, t->body);
    snprintf(path, sizeof path, "%s/trial.part.csv", folder);
    assert_ok(ctx, asdic_trial_begin(ctx, folder, &t->facts, &head, &body, true, &out));
    for (int i = 0; i < 2; i++) { /* the second one is refused, and changes nothing */
        FILE *file = fopen(path, "r");
        text[fread(text, 1, sizeof text - 1, file)] = 0;
        fclose(file);
        assert_int_equal(strncmp(text, header, strlen(header)), 0);
        assert_string_equal(text + strlen(header), rows);
        assert_status(ctx, asdic_trial_begin(ctx, folder, &t->facts, &head, &body, i == 1, &other),
                      ASDIC_ERROR_IO);
        assert_null(other);
    }
    assert_ok(ctx, asdic_trial_end(ctx, folder, &out));
    /* A place that cannot be written: what is there stays. */
    snprintf(path, sizeof path, "%s/trial.part.json.part", folder);
    assert_int_equal(mkdir(path, 0777), 0);
    assert_status(ctx, asdic_trial_begin(ctx, folder, &t->facts, &head, &body, true, &out),
                  ASDIC_ERROR_IO);
    assert_int_equal(rmdir(path), 0);
    asdic_trial_close(&t);
    assert_ok(ctx, asdic_trial_read(ctx, folder, true, &t));
    assert_int_equal(t->row_count, 8);
    asdic_trial_close(&t);
    asdic_text_finish(&head);
    asdic_text_finish(&body);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(rows_are_read),
        cmocka_unit_test(facts_are_read),
        cmocka_unit_test(figures_are_those_of_the_rows),
        cmocka_unit_test(few_events_have_wide_bounds),
        cmocka_unit_test(results_are_written),
        cmocka_unit_test(figures_are_drawn),
        cmocka_unit_test(many_designs_have_numbers),
        cmocka_unit_test(damage_is_told),
        cmocka_unit_test(one_under_way_is_read),
        cmocka_unit_test(rows_stay_where_it_goes_on),
    };
    return cmocka_run_group_tests(tests, begin, end);
}
