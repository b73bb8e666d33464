/*
 * A trial from the disk: every field of its rows, every fact and every figure, each against numbers
 * that differ from all others; and what it says of files that are not those of a trial.
 */
#include "asserts.h"
#include "dice.h"
#include "test_context.h"

#include "lib/base/context.h"
#include "lib/mission/run/team_message.h"
#include "lib/trial/trial_folder.h"
#include "lib/trial/trial_run.h"

#include <asdic/output.h>

#include <dirent.h>
#include <fcntl.h>
#include <math.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

static char folder[] = "/tmp/asdic-trial-folder-XXXXXX";

static const char facts[] =
    "{\n  \"scene\": \"reef\",\n  \"hash\": \"c0ffee\",\n  \"seed\": 11,\n"
    "  \"runs\": 40,\n  \"first\": 7,\n  \"count\": 4,\n  \"rays\": 2048,\n"
    "  \"rule\": \"program\",\n  \"command\": \"rule.py --quick\",\n  \"key\": \"sonar.beam\",\n"
    "  \"values\": [\"a\", \"b\"],\n  \"variants\": [\n";
static const char header[] = "run,variant,outcome,cause,what,time_s,distance_m,pings,clearance_m,"
                             "manoeuvres,needless,seen_m,depth_m\n";
/* Two variants of runs 7 to 10; behind the last field that is read, a draw. */
static const char rows[] = "7,0,hit,seen late,rock,10.5,100,21,0.25,3,1,12.5,30\n"
                           "7,1,clear,,,11.5,200,22,4.5,4,0,,30\n"
                           "8,0,clear,,,12.5,300,23,5.5,5,2,,31\n"
                           "8,1,hit,not seen,bottom,13.5,400,24,0.125,6,0,,31\n"
                           "9,0,hit,could not turn,rock,14.5,500,25,0.0625,7,0,2.5,\"a,b\"\n"
                           "9,1,clear,,,15.5,600,26,,8,0,,\"a,b\"\n"
                           "10,0,void,,rock,16.5,700,27,8.5,9,15,,33\n"
                           "10,1,late,,,17.5,800,28,9.5,10,0,,33\n";

static void write_file(const char *name, const char *text, const char *more) {
    char path[512];
    snprintf(path, sizeof path, "%s/%s", folder, name);
    FILE *file = fopen(path, "w");
    fprintf(file, "%s%s", text, more);
    assert_int_equal(fclose(file), 0);
}

static asdic_trial *open_trial(void) {
    asdic_trial *trial = NULL;
    write_file("trial.json", facts, "  ]\n}\n");
    write_file("trial.csv", header, rows);
    assert_ok(ctx, asdic_trial_open(ctx, folder, &trial));
    return trial;
}

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

/* WHOLE with WORD, where it is there, replaced by OTHER. */
static void replace(const char *whole, const char *word, const char *other, char text[1000]) {
    const char *found = strstr(whole, word);
    int length = snprintf(text, 1000, "%.*s%s%s", found ? (int)(found - whole) : 0, whole,
                          found ? other : "", found ? found + strlen(word) : whole);
    assert_true(length < 1000);
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

static void parts_of_one_trial(void **state) {
    (void)state;
    asdic_trial *a = open_trial(), *b = open_trial();
    b->facts.first++;
    b->facts.count++;
    assert_true(asdic_trial_is_same(&a->facts, &b->facts));
    trial_facts other[7];
    char rule[] = "rule.py --slow";
    for (int i = 0; i < 7; i++) {
        other[i] = a->facts;
    }
    other[0].hash[0]++;
    other[1].seed++;
    other[2].runs++;
    other[3].rays++;
    other[4].rule = NULL;
    other[5].variants--;
    other[6].rule = rule;
    for (int i = 0; i < 7; i++) {
        assert_false(asdic_trial_is_same(&a->facts, &other[i]));
    }
    asdic_trial_close(&a);
    asdic_trial_close(&b);
}

/* The same row for both variants of runs FIRST to END - 1. */
static size_t print_like_rows(char *text, size_t size, unsigned first, unsigned end) {
    size_t length = 0;
    for (unsigned i = 2 * first; i < 2 * end; i++) {
        length += (size_t)snprintf(text + length, size - length, "%u,%u,clear,,,1,2,3,4,0,0,,30\n",
                                   i / 2, i % 2);
    }
    return length;
}

/* All rows of the trial of 40 runs. */
static const char *all_rows(void) {
    static char text[4000];
    size_t length = print_like_rows(text, sizeof text, 0, 7);
    length += (size_t)snprintf(text + length, sizeof text - length, "%s", rows);
    print_like_rows(text + length, sizeof text - length, 11, 40);
    return text;
}

/* Runs FIRST and so on, COUNT of them, of the trial as a part in FOLDER/PART; WORD of what is in both files
 * replaced by OTHER. */
static void write_part(const char *part, unsigned first, unsigned count, const char *word,
                       const char *other) {
    char text[4000], some[1000], file[40], path[200], number[40];
    snprintf(path, sizeof path, "%s/%s", folder, part);
    mkdir(path, 0777);
    snprintf(number, sizeof number, "\"first\": %u", first);
    replace(facts, "\"first\": 7", number, some);
    snprintf(number, sizeof number, "\"count\": %u", count);
    replace(some, "\"count\": 4", number, text);
    replace(text, word, other, some);
    snprintf(file, sizeof file, "%s/trial.json", part);
    write_file(file, some, "  ]\n}\n");
    const char *begin = all_rows(), *end;
    for (unsigned i = 0; i < 2 * first; i++) {
        begin = strchr(begin, '\n') + 1;
    }
    end = begin;
    for (unsigned i = 0; i < 2 * count; i++) {
        end = strchr(end, '\n') + 1;
    }
    snprintf(text, sizeof text, "%.*s", (int)(end - begin), begin);
    replace(header, word, other, some);
    snprintf(file, sizeof file, "%s/trial.csv", part);
    write_file(file, some, text);
}

/* Parts NAMES joined in FOLDER/whole. */
static asdic_status merge(const char *const names[], size_t count, bool force) {
    char path[6][200];
    const char *parts[5] = {path[0], path[1], path[2], path[3], path[4]};
    for (size_t i = 0; i < count; i++) {
        snprintf(path[i], sizeof path[i], "%s/%s", folder, names[i]);
    }
    snprintf(path[5], sizeof path[5], "%s/whole", folder);
    return asdic_trial_merge(ctx, parts, count, path[5], force);
}

/* In whatever order they are named, parts join to the trial with all their rows. */
static void parts_join_to_the_whole(void **state) {
    (void)state;
    static const char *const orders[][5] = {{"before", "a", "b", "c", "after"},
                                            {"c", "after", "a", "b", "before"},
                                            {"after", "b", "c", "before", "a"}};
    char path[200];
    write_part("before", 0, 7, "", "");
    write_part("a", 7, 1, "", "");
    write_part("b", 8, 2, "", "");
    write_part("c", 10, 1, "", "");
    write_part("after", 11, 29, "", "");
    snprintf(path, sizeof path, "%s/whole", folder);
    for (int i = 0; i < 3; i++) {
        asdic_trial *t = NULL, *at_once = open_trial();
        assert_ok(ctx, merge(orders[i], 5, i > 0));
        assert_ok(ctx, asdic_trial_open(ctx, path, &t));
        assert_true(asdic_trial_is_same(&t->facts, &at_once->facts));
        assert_int_equal(t->facts.first, 0);
        assert_int_equal(t->facts.count, 40);
        assert_string_equal(t->header, header);
        assert_string_equal(t->body, all_rows());
        asdic_trial_close(&t);
        asdic_trial_close(&at_once);
    }
    assert_status(ctx, merge(orders[0], 5, false), ASDIC_ERROR_EXISTS);
    assert_contains(asdic_context_error(ctx), "holds a trial; --force replaces it");
    /* Nor is one given up that can go on. */
    static const char *const names[] = {"trial.json", "trial.csv", "trial.part.csv"};
    char name[sizeof path + 40];
    for (size_t i = 0; i < 2; i++) {
        snprintf(name, sizeof name, "%s/%s", path, names[i]);
        assert_int_equal(unlink(name), 0);
    }
    write_file("whole/trial.part.csv", header, "");
    assert_status(ctx, merge(orders[0], 5, false), ASDIC_ERROR_EXISTS);
    assert_contains(asdic_context_error(ctx), "holds a trial that was stopped; --force replaces");
    snprintf(name, sizeof name, "%s/%s", path, names[2]);
    assert_int_equal(access(name, F_OK), 0);
    assert_ok(ctx, merge(orders[0], 5, true));
}

static void parts_that_do_not_fit_are_refused(void **state) {
    (void)state;
    static const char *const names[] = {"before", "a", "b", "c", "after"};
    static const char other_trial[] = "parts of different trials";
    static const struct {
        unsigned first, count;
        const char *word, *other, *says;
    } wrong[] = {
        {8, 1, "", "", "runs 9 to 9 are in no part"},
        {8, 3, "", "", "runs 10 to 10 are in two parts"},
        {7, 3, "", "", "runs 7 to 7 are in two parts"},
        {8, 2, "\"seed\": 11", "\"seed\": 12", other_trial},
        {8, 2, "c0ffee", "c0ffed", other_trial},
        {8, 2, "depth_m", "width_m", other_trial},
        {8, 2, "\"scene\"", "[\"scene\"", "this is no trial.json"},
    };
    write_part("before", 0, 7, "", "");
    write_part("a", 7, 1, "", "");
    write_part("c", 10, 1, "", "");
    write_part("after", 11, 29, "", "");
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
        write_part("b", wrong[i].first, wrong[i].count, wrong[i].word, wrong[i].other);
        assert_status(ctx, merge(names, 5, true), ASDIC_ERROR_INPUT);
        assert_contains(asdic_context_error(ctx), wrong[i].says);
    }
    write_part("b", 8, 2, "", "");
    assert_status(ctx, merge(names + 1, 4, true), ASDIC_ERROR_INPUT);
    assert_contains(asdic_context_error(ctx), "runs 0 to 6 are in no part");
    assert_status(ctx, merge(names, 4, true), ASDIC_ERROR_INPUT);
    assert_contains(asdic_context_error(ctx), "runs 11 to 39 are in no part");
    const char *const parts[1] = {folder};
    assert_status(ctx, asdic_trial_merge(ctx, NULL, 1, folder, true), ASDIC_ERROR_ARGUMENT);
    assert_status(ctx, asdic_trial_merge(ctx, parts, 0, folder, true), ASDIC_ERROR_ARGUMENT);
    assert_status(ctx, asdic_trial_merge(ctx, parts, 1, NULL, true), ASDIC_ERROR_ARGUMENT);
    assert_true(asdic_trial_merge(ctx, parts, 1, "/nowhere/deep", true) != ASDIC_OK);
    assert_contains(asdic_context_error(ctx), "/nowhere/deep");
}

/* Two runs without a device, of a vehicle that meets nothing. */
static const char empty[] =
    "version: 1\nbottom: {depth_m: 20}\n"
    "sonar: {frequency_khz: 100, ping_rate_hz: 1, speckle: rayleigh, receivers: [{name: a}]}\n"
    "mission: {waypoints: {points_m: [[0, 0, 10], [9, 0, 10]], speed_mps: 3}}\n"
    "trial: {time_s: 3, ideal: {pd: 0.5}}\n";

static asdic_status note_result(void *user, unsigned to, const void *data, size_t bytes) {
    assert_int_equal(to, 0);
    assert_true(bytes >= sizeof(asdic_message));
    memcpy(user, data, sizeof(asdic_message));
    return ASDIC_OK;
}

/* One of several processes flies its own runs, and tells the first of them. */
static void a_team_has_parts(void **state) {
    (void)state;
    char scene[200], whole[200], part[200];
    asdic_message told = {.kind = 0};
    asdic_team team = {.rank = 1, .size = 2, .send = note_result, .user = &told};
    asdic_trial_options options = asdic_trial_options_default();
    asdic_trial *t = NULL;
    write_file("empty.yaml", empty, "");
    snprintf(scene, sizeof scene, "%s/empty.yaml", folder);
    snprintf(whole, sizeof whole, "%s/team", folder);
    snprintf(part, sizeof part, "%s/team/part_1_2", folder);
    options.scene = scene;
    options.folder = whole;
    options.runs = 2;
    options.team = &team;
    assert_ok(ctx, asdic_trial_fly(ctx, NULL, 0, &options));
    assert_int_equal(told.kind, ASDIC_MESSAGE_RESULT);
    assert_int_equal(told.status, ASDIC_OK);
    assert_ok(ctx, asdic_trial_open(ctx, part, &t));
    assert_int_equal(t->facts.first, 1);
    assert_int_equal(t->row_count, 1);
    asdic_trial_close(&t);
}

/* The rows in the folder "kept". */
static const char *kept_rows(void) {
    static char text[2000];
    char path[200];
    snprintf(path, sizeof path, "%s/kept/trial.csv", folder);
    FILE *file = fopen(path, "r");
    assert_non_null(file);
    text[fread(text, 1, sizeof text - 1, file)] = '\0';
    assert_int_equal(fclose(file), 0);
    return text;
}

/* A whole trial, or a part of one, is replaced by --force alone, gone on with by --resume alone, and then the same. */
static void a_trial_is_kept_or_gone_on_with(void **state) {
    (void)state;
    char scene[200], kept[200], path[240], first[2000], begun[2000];
    write_file("empty.yaml", empty, "");
    snprintf(scene, sizeof scene, "%s/empty.yaml", folder);
    snprintf(kept, sizeof kept, "%s/kept", folder);
    asdic_trial_options options = asdic_trial_options_default();
    options.scene = scene;
    options.folder = kept;
    options.runs = 3;
    options.variants.count = 2; /* of no key */
    assert_status(ctx, asdic_trial_fly(ctx, NULL, 0, &options), ASDIC_ERROR_ARGUMENT);
    options.variants = (asdic_trial_variants){.key = "seed", .count = 1};
    assert_status(ctx, asdic_trial_fly(ctx, NULL, 0, &options), ASDIC_ERROR_ARGUMENT);
    options.variants.key = NULL;
    assert_ok(ctx, asdic_trial_fly(ctx, NULL, 0, &options));
    snprintf(first, sizeof first, "%s", kept_rows());
    assert_status(ctx, asdic_trial_fly(ctx, NULL, 0, &options), ASDIC_ERROR_EXISTS);
    assert_contains(asdic_context_error(ctx), "/kept' holds a trial; --force replaces it");
    assert_string_equal(kept_rows(), first);
    options.resume = true;
    assert_ok(ctx, asdic_trial_fly(ctx, NULL, 0, &options));
    assert_string_equal(kept_rows(), first);
    options.seed++;
    assert_status(ctx, asdic_trial_fly(ctx, NULL, 0, &options), ASDIC_ERROR_EXISTS);
    assert_contains(asdic_context_error(ctx), "/kept holds another trial");
    assert_string_equal(kept_rows(), first);
    options.seed--;
    options.resume = false;
    options.force = true;
    for (int k = 0; k < 2; k++) { /* another, and the first again */
        options.runs = k ? 3 : 4;
        assert_ok(ctx, asdic_trial_fly(ctx, NULL, 0, &options));
        assert_int_equal(strcmp(kept_rows(), first) == 0, k);
    }
    options.force = false;
    /* As if stopped after its second row. */
    char *end_of_row = first;
    for (int line = 0; line < 3; line++) {
        end_of_row = strchr(end_of_row, '\n') + 1;
    }
    snprintf(begun, sizeof begun, "%.*s", (int)(end_of_row - first), first);
    for (int force = 0; force < 2; force++) {
        char json[240];
        snprintf(path, sizeof path, "%s/trial.json", kept);
        snprintf(json, sizeof json, "%s/trial.part.json", kept);
        assert_int_equal(rename(path, json), 0);
        snprintf(path, sizeof path, "%s/trial.csv", kept);
        assert_int_equal(unlink(path), 0);
        write_file("kept/trial.part.csv", begun, "");
        assert_status(ctx, asdic_trial_fly(ctx, NULL, 0, &options), ASDIC_ERROR_EXISTS);
        assert_contains(asdic_context_error(ctx), "/kept' holds a trial that was stopped; --resume "
                                                  "goes on, --force begins anew");
        options.force = force;
        options.resume = !force;
        assert_ok(ctx, asdic_trial_fly(ctx, NULL, 0, &options));
        assert_string_equal(kept_rows(), first);
        snprintf(path, sizeof path, "%s/trial.part.csv", kept);
        assert_int_not_equal(access(path, F_OK), 0);
        options.force = options.resume = false;
    }
}

/* What process 1 sent last, once. */
static asdic_status give_result(void *user, unsigned *from, const void **data, size_t *bytes) {
    asdic_message *told = user;
    static asdic_message last;
    *from = 1;
    *bytes = sizeof last;
    *data = told->kind ? &last : NULL;
    last = *told;
    told->kind = 0;
    return ASDIC_OK;
}

/* Processes 1 and 2 are through. */
static asdic_status give_both(void *user, unsigned *from, const void **data, size_t *bytes) {
    static const asdic_message good = {.kind = ASDIC_MESSAGE_RESULT, .status = ASDIC_OK};
    unsigned *told = user;
    *from = ++*told;
    *bytes = sizeof good;
    *data = &good;
    return ASDIC_OK;
}

static void assert_no_part(const char *path) {
    DIR *all = opendir(path);
    assert_non_null(all);
    for (struct dirent *entry; (entry = readdir(all));) {
        assert_null(strstr(entry->d_name, "part"));
    }
    closedir(all);
}

/* Makes the trial in FOLDER/NAME one that was stopped after its first row, which it marks: of 77 pings. */
static void stop_after_first_row(const char *name) {
    char from[240], to[240], header_line[400], row[400], marked[1000];
    snprintf(from, sizeof from, "%s/%s/trial.json", folder, name);
    snprintf(to, sizeof to, "%s/%s/trial.part.json", folder, name);
    assert_int_equal(rename(from, to), 0);
    snprintf(from, sizeof from, "%s/%s/trial.csv", folder, name);
    FILE *file = fopen(from, "r");
    assert_non_null(file);
    assert_non_null(fgets(header_line, sizeof header_line, file));
    assert_non_null(fgets(row, sizeof row, file));
    assert_int_equal(fclose(file), 0);
    assert_int_equal(unlink(from), 0);
    replace(row, ",9,3,", ",9,77,", marked);
    assert_string_not_equal(row, marked);
    snprintf(to, sizeof to, "%s/trial.part.csv", name);
    write_file(to, header_line, marked);
}

/* Process 0 joins the parts of all: in a new folder, in the place of a trial there, and of one that was stopped. */
static void a_team_joins_its_parts(void **state) {
    (void)state;
    static const char *const names[] = {"joined_new", "joined_forced", "joined_resumed"};
    char scene[200], whole[200], path[220];
    write_file("empty.yaml", empty, "");
    snprintf(scene, sizeof scene, "%s/empty.yaml", folder);
    for (int k = 0; k < 3; k++) {
        asdic_message told = {.kind = 0};
        asdic_team teams[] = {{.rank = 0, .size = 2, .receive = give_result, .user = &told},
                              {.rank = 1, .size = 2, .send = note_result, .user = &told}};
        asdic_trial_options options = asdic_trial_options_default();
        asdic_trial *t = NULL;
        snprintf(whole, sizeof whole, "%s/%s", folder, names[k]);
        assert_int_equal(mkdir(whole, 0777), 0);
        if (k == 1) {
            snprintf(path, sizeof path, "%s/trial.json", names[k]);
            write_file(path, facts, "  ]\n}\n");
            snprintf(path, sizeof path, "%s/trial.csv", names[k]);
            write_file(path, header, rows);
        }
        options.scene = scene;
        options.folder = whole;
        options.runs = 3;
        if (k == 2) {
            assert_ok(ctx, asdic_trial_fly(ctx, NULL, 0, &options));
            stop_after_first_row(names[k]);
        }
        options.force = k == 1;
        options.resume = k == 2;
        for (int rank = 1; rank >= 0; rank--) {
            options.team = &teams[rank];
            assert_ok(ctx, asdic_trial_fly(ctx, NULL, 0, &options));
        }
        assert_ok(ctx, asdic_trial_open(ctx, whole, &t));
        assert_int_equal(t->row_count, 3);
        assert_int_equal(t->facts.count, 3);
        assert_null(t->facts.rule);
        assert_int_equal(t->rows[0].flown.pings, k == 2 ? 77 : 3);
        asdic_trial_close(&t);
        assert_no_part(whole);
    }
}

/* What a team of two left, of one process or of three it goes on with the rows that are there. */
static void a_stopped_team_may_have_another_size(void **state) {
    (void)state;
    static const char *const names[] = {"resized_alone", "resized_team"};
    char scene[200], whole[200], path[220];
    write_file("empty.yaml", empty, "");
    snprintf(scene, sizeof scene, "%s/empty.yaml", folder);
    for (int k = 0; k < 2; k++) {
        asdic_message told = {.kind = 0};
        asdic_team second = {.rank = 1, .size = 2, .send = note_result, .user = &told};
        asdic_trial_options options = asdic_trial_options_default();
        asdic_trial *t = NULL;
        snprintf(whole, sizeof whole, "%s/%s", folder, names[k]);
        options.scene = scene;
        options.folder = whole;
        options.runs = 4;
        options.team = &second; /* runs 2 and 3 */
        assert_ok(ctx, asdic_trial_fly(ctx, NULL, 0, &options));
        snprintf(path, sizeof path, "%s/part_2_4", names[k]);
        stop_after_first_row(path);
        options.team = NULL;
        assert_status(ctx, asdic_trial_fly(ctx, NULL, 0, &options), ASDIC_ERROR_EXISTS);
        assert_contains(asdic_context_error(ctx), "holds a trial that was stopped; --resume goes");
        options.resume = true;
        options.seed++;
        assert_status(ctx, asdic_trial_fly(ctx, NULL, 0, &options), ASDIC_ERROR_EXISTS);
        assert_contains(asdic_context_error(ctx), "/part_2_4 holds another trial");
        options.seed--;
        for (unsigned rank = 3; k == 1 && rank-- > 0;) {
            asdic_team third = {.rank = rank, .size = 3, .send = note_result, .receive = give_both};
            third.user = rank > 0 ? &told : (void *)&(unsigned){0};
            options.team = &third;
            assert_ok(ctx, asdic_trial_fly(ctx, NULL, 0, &options));
        }
        if (k == 0) {
            assert_ok(ctx, asdic_trial_fly(ctx, NULL, 0, &options));
        }
        assert_ok(ctx, asdic_trial_open(ctx, whole, &t));
        assert_int_equal(t->row_count, 4);
        for (size_t i = 0; i < 4; i++) {
            assert_int_equal(t->rows[i].flown.pings, i == 2 ? 77 : 3);
        }
        asdic_trial_close(&t);
        assert_no_part(whole);
    }
}

/* The process 1 that cannot take part says so; what it says after that is no news. */
static asdic_status excuse(void *user, unsigned *from, const void **data, size_t *bytes) {
    static struct {
        asdic_message head;
        asdic_message_hello about;
    } said;
    unsigned *looks = user;
    said.head = (asdic_message){.kind = ASDIC_MESSAGE_HELLO, .status = ASDIC_ERROR_INPUT};
    snprintf(said.about.why, sizeof said.about.why, "the scene is not here");
    *from = 1;
    *bytes = sizeof said;
    *data = *looks < 3 ? &said : NULL;
    return ++*looks < 1000 ? ASDIC_OK : ASDIC_ERROR_IO;
}

static void one_that_stays_away_is_not_waited_for(void **state) {
    (void)state;
    char scene[200], whole[200];
    unsigned looks = 0;
    asdic_team team = {.rank = 0, .size = 2, .receive = excuse, .user = &looks};
    asdic_trial_options options = asdic_trial_options_default();
    write_file("empty.yaml", empty, "");
    snprintf(scene, sizeof scene, "%s/empty.yaml", folder);
    snprintf(whole, sizeof whole, "%s/team", folder);
    options.scene = scene;
    options.folder = whole;
    options.runs = 2;
    options.team = &team;
    assert_status(ctx, asdic_trial_fly(ctx, NULL, 0, &options), ASDIC_ERROR_INPUT);
    assert_string_equal(asdic_context_error(ctx), "process 1: the scene is not here");
    assert_int_equal(looks, 1);
}

/* Rows that another process is writing stay its own, and what it says they are. */
static void another_keeps_its_trial(void **state) {
    (void)state;
    char scene[200], whole[200], path[220], text[4000] = "";
    snprintf(scene, sizeof scene, "%s/empty.yaml", folder);
    snprintf(whole, sizeof whole, "%s/whole", folder);
    mkdir(whole, 0777);
    write_file("empty.yaml", empty, "");
    write_file("whole/trial.part.json", facts, "  ]\n}\n");
    write_file("whole/trial.part.csv", header, rows);
    snprintf(path, sizeof path, "%s/trial.part.csv", whole);
    int fd = open(path, O_RDONLY);
    assert_int_equal(flock(fd, LOCK_EX | LOCK_NB), 0);
    asdic_trial_options options = asdic_trial_options_default();
    options.scene = scene;
    options.folder = whole;
    options.runs = 2;
    options.force = true;
    assert_status(ctx, asdic_trial_fly(ctx, NULL, 0, &options), ASDIC_ERROR_IO);
    assert_contains(asdic_context_error(ctx), "another process is writing it just now");
    close(fd);
    snprintf(path, sizeof path, "%s/trial.part.json", whole);
    FILE *file = fopen(path, "r");
    text[fread(text, 1, sizeof text - 1, file)] = 0;
    fclose(file);
    assert_contains(text, "c0ffee");
}

/* Two runs of OPTIONS in the place of others: the second begins before the first fails, and fails after it. */
static bool both_fail;
static atomic_bool second_began, first_fails;
static atomic_uint by_others; /* runs of workers but the first */

static void wait_ms(long ms) {
    nanosleep(&(struct timespec){.tv_nsec = ms * 1000000}, NULL);
}

asdic_status __real_asdic_trial_run_one(asdic_eye *eye, const asdic_trial_job *job,
                                        asdic_trial_run *out, char why[ASDIC_TRIAL_WHY]);
asdic_status __wrap_asdic_trial_run_one(asdic_eye *eye, const asdic_trial_job *job,
                                        asdic_trial_run *out, char why[ASDIC_TRIAL_WHY]);
asdic_status __wrap_asdic_trial_run_one(asdic_eye *eye, const asdic_trial_job *job,
                                        asdic_trial_run *out, char why[ASDIC_TRIAL_WHY]) {
    by_others += job->worker > 0;
    if (!both_fail) {
        return __real_asdic_trial_run_one(eye, job, out, why);
    }
    if (job->run == 1) {
        second_began = true;
        for (int i = 0; i < 1000 && !first_fails; i++) {
            wait_ms(10);
        }
        wait_ms(200); /* until that is known */
        return asdic_fail(eye->ctx, ASDIC_ERROR_DEVICE, "the second");
    }
    for (int i = 0; i < 100 && !second_began; i++) { /* never on one processor */
        wait_ms(10);
    }
    first_fails = true;
    return asdic_fail(eye->ctx, ASDIC_ERROR_INPUT, "the first");
}

static asdic_trial_options two_runs(const char scene[], const char whole[]) {
    asdic_trial_options options = asdic_trial_options_default();
    write_file("empty.yaml", empty, "");
    options.scene = scene;
    options.folder = whole;
    options.runs = 2;
    return options;
}

/* What failed first ends a trial, and is told: others may fail because of it. */
static void the_first_failure_is_told(void **state) {
    (void)state;
    char scene[200], whole[200];
    snprintf(scene, sizeof scene, "%s/empty.yaml", folder);
    snprintf(whole, sizeof whole, "%s/whole", folder);
    asdic_trial_options options = two_runs(scene, whole);
    options.force = true;
    both_fail = true;
    assert_status(ctx, asdic_trial_fly(ctx, NULL, 0, &options), ASDIC_ERROR_INPUT);
    assert_string_equal(asdic_context_error(ctx), "the first");
    both_fail = false;
}

/* A sonar that is ideal flies as many runs at a time as there are devices, though it needs none. */
static void one_device_is_one_worker(void **state) {
    (void)state;
    char scene[200], whole[200];
    asdic_device *devices[1] = {NULL};
    snprintf(scene, sizeof scene, "%s/empty.yaml", folder);
    snprintf(whole, sizeof whole, "%s/whole", folder);
    asdic_trial_options options = two_runs(scene, whole);
    options.force = true;
    options.runs = 200;
    by_others = 0;
    assert_ok(ctx, asdic_trial_fly(ctx, devices, 1, &options));
    assert_int_equal(by_others, 0);
}

/* A run of a trial is flown again where everything that it needs is named. */
static void a_run_again_needs_all_it_asks_for(void **state) {
    (void)state;
    char scene[200], again[200];
    snprintf(scene, sizeof scene, "%s/empty.yaml", folder);
    snprintf(again, sizeof again, "%s/again", folder);
    asdic_trial_options options = two_runs(scene, again), none = options;
    asdic_trial_run flown = {.time_s = NAN};
    none.scene = NULL;
    const struct {
        const asdic_trial_options *options;
        size_t variant;
        const char *folder;
        asdic_trial_run *out;
    } wrong[] = {{NULL, 0, again, &flown},
                 {&none, 0, again, &flown},
                 {&options, 0, NULL, &flown},
                 {&options, 0, again, NULL},
                 {&options, 1, again, &flown}};
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
        assert_status(ctx,
                      asdic_trial_replay(ctx, NULL, wrong[i].options, 0, wrong[i].variant,
                                         wrong[i].folder, wrong[i].out),
                      ASDIC_ERROR_ARGUMENT);
        assert_contains(asdic_context_error(ctx), "needs its scene, one of its variants");
        assert_true(access(again, F_OK) != 0);
    }
    assert_ok(ctx, asdic_trial_replay(ctx, NULL, &options, 1, 0, again, &flown));
    assert_close(flown.time_s, 3.0, 1e-9);
    assert_close(flown.distance_m, 9.0, 1e-6);
}

/* Only a sonar that is ideal needs none, and no rule can ask for its pings. */
static void what_pings_needs_a_device(void **state) {
    (void)state;
    char scene[200], whole[200], heard[1000];
    snprintf(scene, sizeof scene, "%s/empty.yaml", folder);
    snprintf(whole, sizeof whole, "%s/again", folder);
    asdic_trial_options options = two_runs(scene, whole);
    const asdic_trial_rule rule = {.name = "never asked"};
    asdic_trial_run flown;
    options.force = true;
    for (int has_rule = 0; has_rule < 2; has_rule++) {
        for (int is_ideal = 0; is_ideal < 2; is_ideal++) {
            const char *at = strstr(empty, ", ideal");
            snprintf(heard, sizeof heard, "%.*s}\n", (int)(at - empty), empty);
            write_file("empty.yaml", is_ideal ? empty : heard, "");
            options.rule = has_rule ? &rule : NULL;
            const char *why = is_ideal ? "makes no pings" : "that pings needs a device";
            if (has_rule || !is_ideal) {
                assert_status(ctx, asdic_trial_fly(ctx, NULL, 0, &options), ASDIC_ERROR_ARGUMENT);
                assert_contains(asdic_context_error(ctx), why);
                assert_status(ctx, asdic_trial_replay(ctx, NULL, &options, 0, 0, whole, &flown),
                              ASDIC_ERROR_ARGUMENT);
                assert_contains(asdic_context_error(ctx), why);
            }
        }
    }
}

static int end(void **state) {
    static const char *const folders[] = {"joined_new",
                                          "joined_forced",
                                          "joined_resumed",
                                          "resized_alone",
                                          "resized_team",
                                          "before",
                                          "a",
                                          "b",
                                          "c",
                                          "after",
                                          "whole",
                                          "kept",
                                          "team/part_1_2",
                                          "team/part_0_1",
                                          "team",
                                          "again",
                                          "."};
    static const char *const names[] = {"trial.json",      "trial.csv",      "trial.png",
                                        "trial.part.json", "trial.part.csv", "empty.yaml",
                                        "scene.yaml",      "track.csv"};
    char path[200];
    for (size_t f = 0; f < sizeof folders / sizeof *folders; f++) {
        for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
            snprintf(path, sizeof path, "%s/%s/%s", folder, folders[f], names[i]);
            unlink(path);
        }
        snprintf(path, sizeof path, "%s/%s", folder, folders[f]);
        rmdir(path);
    }
    rmdir(folder);
    return context_end(state);
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
        cmocka_unit_test(parts_of_one_trial),
        cmocka_unit_test(parts_join_to_the_whole),
        cmocka_unit_test(parts_that_do_not_fit_are_refused),
        cmocka_unit_test(a_team_has_parts),
        cmocka_unit_test(a_team_joins_its_parts),
        cmocka_unit_test(a_stopped_team_may_have_another_size),
        cmocka_unit_test(one_that_stays_away_is_not_waited_for),
        cmocka_unit_test(another_keeps_its_trial),
        cmocka_unit_test(the_first_failure_is_told),
        cmocka_unit_test(a_trial_is_kept_or_gone_on_with),
        cmocka_unit_test(one_device_is_one_worker),
        cmocka_unit_test(a_run_again_needs_all_it_asks_for),
        cmocka_unit_test(what_pings_needs_a_device),
    };
    if (!mkdtemp(folder)) {
        return 1;
    }
    return cmocka_run_group_tests(tests, context_begin, end);
}
