/* What the program says: errors, warnings and notes by verbosity, exit codes, progress, JSON, help. */
#include "asserts.h"
#include "test_context.h"
#include "told.h"

#include "cli/cli_state.h"
#include "cli/json.h"
#include "cli/progress.h"
#include "base/context.h"

#include <asdic/mesh.h>

#include <time.h>

static const cli_option options[] = {{"output", 'o', "FILE", "where it goes"}, {0}};
static const cli_command command = {
    .name = "try",
    .operands = "SCENE.yaml",
    .summary = "a try",
    .details =
        "One two three four five six seven eight nine ten eleven twelve thirteen fourteen.\n\nEnd.",
    .examples = "asdic try a\nasdic try b",
    .options = options};
static cli c;

static void begin(int verbosity, bool colour) {
    cli_begin(&c, ctx, &command);
    c.verbosity = verbosity;
    c.colour = colour;
}

static const char *say_all(int verbosity) {
    begin(verbosity, false);
    told_begin();
    cli_error(&c, "e%d", 1);
    cli_warning(&c, "w%d", 2);
    cli_note(&c, "n%d", 3);
    return told_end();
}

static void verbosity_says_what_is_said(void **state) {
    (void)state;
    for (int verbosity = 0; verbosity <= 2; verbosity++) {
        assert_string_equal(say_all(verbosity), "error: e1\nwarning: w2\nn3\n");
        assert_false(cli_quiet(&c));
    }
    assert_string_equal(say_all(-1), "error: e1\n");
    assert_true(cli_quiet(&c));
    assert_string_equal(say_all(CLI_MUTE), "");
    begin(CLI_MUTE, false);
    told_begin();
    assert_int_equal(cli_usage(&c, "no"), CLI_USAGE);
    assert_string_equal(told_end(), "");
    assert_true(cli_bad_usage(&c));
    begin(-1, false);
    told_begin();
    assert_int_equal(cli_usage(&c, "no %s", "x"), CLI_USAGE);
    assert_string_equal(told_end(), "error: no x\n'asdic try --help' shows how it is used\n");
}

static void a_place_stands_before_the_severity(void **state) {
    (void)state;
    begin(0, true);
    assert_true(c.colour);
    told_begin();
    cli_error(&c, "a.yaml:5:3: error: text");
    cli_error(&c, "text");
    cli_warning(&c, "a.yaml:5: warning: text");
    cli_warning(&c, "a: error: text");
    assert_string_equal(told_end(), "a.yaml:5:3: \033[1;31merror:\033[0m text\n"
                                    "\033[1;31merror:\033[0m text\n"
                                    "a.yaml:5: \033[1;33mwarning:\033[0m text\n"
                                    "\033[1;33mwarning:\033[0m a: error: text\n");
    begin(0, false);
    told_begin();
    cli_error(&c, "a.yaml:5:3: error: text");
    assert_string_equal(told_end(), "a.yaml:5:3: error: text\n");
}

/* The library's messages, of the level that verbosity asks for; stderr is no terminal. */
static void the_library_is_heard(void **state) {
    (void)state;
    static const char *const heard[] = {"e", "eW", "eWI", "eWID"};
    for (int verbosity = CLI_MUTE; verbosity <= 2; verbosity++) {
        begin(verbosity, true);
        told_begin();
        cli_report_begin(&c);
        asdic_log(ctx, ASDIC_LOG_WARNING, "%s", "W");
        asdic_log(ctx, ASDIC_LOG_NOTE, "%s", "N");
        asdic_log(ctx, ASDIC_LOG_INFO, "%s", "I");
        asdic_log(ctx, ASDIC_LOG_DEBUG, "%s", "D");
        const char *said = told_end();
        const char *wanted = verbosity < 0 ? "" : heard[verbosity + 1];
        assert_false(c.colour);
        assert_int_equal(strstr(said, "warning: W\n") != NULL, strchr(wanted, 'W') != NULL);
        assert_int_equal(strstr(said, "N\n") != NULL, verbosity > 0);
        assert_int_equal(strstr(said, "I\n") != NULL, strchr(wanted, 'I') != NULL);
        assert_int_equal(strstr(said, "D\n") != NULL, strchr(wanted, 'D') != NULL);
    }
    asdic_context_set_log(ctx, ASDIC_LOG_ERROR, NULL, NULL);
}

static void a_status_is_an_exit_code(void **state) {
    (void)state;
    static const struct {
        asdic_status status;
        int code;
    } cases[] = {{ASDIC_OK, 0},
                 {ASDIC_ERROR_ARGUMENT, 2},
                 {ASDIC_ERROR_INPUT, 3},
                 {ASDIC_ERROR_DEVICE, 4},
                 {ASDIC_ERROR_DEVICE_LOST, 1},
                 {ASDIC_ERROR_MEMORY, 1},
                 {ASDIC_ERROR_IO, 1},
                 {ASDIC_ERROR_EXISTS, 1},
                 {ASDIC_ERROR_UNSUPPORTED, 1},
                 {ASDIC_ERROR_INTERRUPTED, 1}}; /* by no signal */
    begin(0, false);
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        char expected[256] = "";
        told_begin();
        int code = cli_end(&c, cases[k].status);
        const char *said = told_end();
        assert_int_equal(code, cases[k].code);
        if (cases[k].status == ASDIC_ERROR_INTERRUPTED) {
            snprintf(expected, sizeof expected, "interrupted\n");
        } else if (cases[k].status) {
            snprintf(expected, sizeof expected, "error: %s\n", asdic_status_text(cases[k].status));
        }
        assert_string_equal(said, expected);
    }
    assert_int_equal(asdic_mesh_box(ctx, (asdic_vec3){-1.0, 1.0, 1.0}, NULL), ASDIC_ERROR_ARGUMENT);
    told_begin(); /* the context's own sentence */
    cli_end(&c, ASDIC_ERROR_INPUT);
    const char *said = told_end();
    assert_contains(said, asdic_context_error(ctx));
    assert_null(strstr(said, asdic_status_text(ASDIC_ERROR_INPUT)));
}

static void one_thing_has_no_s(void **state) {
    (void)state;
    assert_string_equal(cli_plural(0), "s");
    assert_string_equal(cli_plural(1), "");
    assert_string_equal(cli_plural(2), "s");
}

/* A report of DONE of 90 pings at ELAPSED_S, after RAYS, where a line is due. */
static const char *report(cli_progress *p, size_t done, double elapsed_s, uint64_t rays) {
    p->last_s -= 10.0;
    told_begin();
    cli_progress_report(
        p, &(asdic_run_progress){
               .pings_done = done, .pings_total = 90, .elapsed_s = elapsed_s, .rays = rays});
    return told_end();
}

/* What came before the first new ping, as compiling, is no part of the rate. */
static void progress_counts_from_the_first_ping(void **state) {
    (void)state;
    begin(0, false);
    cli_progress p = cli_progress_begin(&c);
    assert_true(p.is_shown && !p.is_terminal);
    assert_string_equal(report(&p, 0, 1.0, 0), "0 of 90 pings\n");
    assert_string_equal(report(&p, 0, 5.0, 0), "0 of 90 pings\n");
    assert_string_equal(report(&p, 10, 6.0, 50000), "10 of 90 pings\n");
    assert_string_equal(report(&p, 30, 15.0, 2000000),
                        "30 of 90 pings  217 krays/s  0:00:27 left\n");
    assert_close(cli_progress_rays_per_s(&p), 1950e3 / 9.0, 1e-6);
    told_begin(); /* the next line is not due yet */
    cli_progress_report(&p, &(asdic_run_progress){31, 90, .elapsed_s = 15.5, .rays = 2100000});
    assert_string_equal(told_end(), "");
    assert_string_equal(report(&p, 1, 2.0, 1000), "1 of 90 pings\n"); /* another part begins */
    assert_string_equal(report(&p, 2, 3.0, 1000), "2 of 90 pings  0:01:28 left\n");
    assert_string_equal(report(&p, 3, 3602.0, 2000), "3 of 90 pings  0 rays/s  43:30:00 left\n");
    cli_progress_end(&p);

    p = cli_progress_begin(&c); /* what was there before is no part of it */
    assert_string_equal(report(&p, 50, 2.0, 0), "50 of 90 pings\n");
    assert_string_equal(report(&p, 51, 3.0, 100), "51 of 90 pings\n");
    assert_string_equal(report(&p, 53, 7.0, 12100), "53 of 90 pings  3.00 krays/s  0:01:14 left\n");
    c.verbosity = -1;
    p = cli_progress_begin(&c);
    assert_false(p.is_shown);
    assert_string_equal(report(&p, 50, 2.0, 0), "");
}

/* Loops within loops, each with its own time. */
static void loops_are_told_apart(void **state) {
    (void)state;
    begin(0, false);
    cli_progress p = cli_progress_begin(&c);
    cli_progress_step(&p, "beams", 0, 10);
    cli_progress_step(&p, "layers", 0, 4);
    assert_string_equal(p.loops[0].what, "beams");
    assert_string_equal(p.loops[1].what, "layers");
    assert_null(p.loops[2].what);
    p.loops[0].begun_s -= 30.0;
    p.loops[1].begun_s -= 7.0;
    p.last_s -= 10.0;
    told_begin();
    cli_progress_step(&p, "beams", 5, 10);
    assert_string_equal(told_end(), "5 of 10 beams  0:00:30 left\n");
    p.last_s -= 10.0;
    told_begin();
    cli_progress_step(&p, "layers", 1, 4);
    assert_string_equal(told_end(), "1 of 4 layers  0:00:21 left\n");
    p.last_s -= 10.0;
    told_begin(); /* begins again */
    cli_progress_step(&p, "layers", 0, 4);
    assert_string_equal(told_end(), "0 of 4 layers\n");
    assert_true(p.loops[1].begun_s > p.loops[0].begun_s + 20.0);
    char names[CLI_PROGRESS_LOOPS][2];
    for (int i = 2; i < CLI_PROGRESS_LOOPS; i++) {
        snprintf(names[i], sizeof names[i], "%d", i);
        cli_progress_step(&p, names[i], 0, 2);
        assert_ptr_equal(p.loops[i].what, names[i]);
    }
    p.last_s -= 10.0;
    told_begin(); /* one too many is not shown */
    cli_progress_step(&p, "more", 1, 2);
    assert_string_equal(told_end(), "");
    cli_progress_end(&p);
}

/* What lies behind the last loop is left alone when there is one too many. */
static void loops_have_a_limit(void **state) {
    (void)state;
    begin(0, false);
    struct {
        cli_progress p;
        cli_progress_loop behind;
    } s = {.p = cli_progress_begin(&c)};
    char names[CLI_PROGRESS_LOOPS + 1][2];
    for (int i = 0; i <= CLI_PROGRESS_LOOPS; i++) {
        snprintf(names[i], sizeof names[i], "%d", i);
        cli_progress_step(&s.p, names[i], 0, 2);
    }
    assert_ptr_equal(s.p.loops[CLI_PROGRESS_LOOPS - 1].what, names[CLI_PROGRESS_LOOPS - 1]);
    assert_null(s.behind.what);
    cli_progress_end(&s.p);
}

/* A bar of 24 places, drawn at most ten times a second over the last one, and wiped away once. */
static void a_terminal_has_a_bar(void **state) {
    (void)state;
    begin(0, false);
    cli_progress p = cli_progress_begin(&c);
    p.is_terminal = true;
    p.last_s = 0.0;
    told_begin();
    cli_progress_step(&p, "beams", 3, 8);
    assert_string_equal(told_end(), "\r\033[K[#########...............] 3/8 beams  0:00:00 left");
    told_begin();
    cli_progress_step(&p, "beams", 4, 8);
    assert_string_equal(told_end(), "");
    p.last_s -= 0.1;
    told_begin();
    cli_progress_step(&p, "beams", 8, 8);
    assert_string_equal(told_end(), "\r\033[K[########################] 8/8 beams  0:00:00 left");
    told_begin();
    cli_progress_end(&p);
    cli_progress_end(&p);
    assert_string_equal(told_end(), "\r\033[K");
}

/* What FUNCTION writes to a stream. */
static const char *written(void (*function)(FILE *out)) {
    static char text[4096];
    memset(text, 0, sizeof text);
    FILE *out = fmemopen(text, sizeof text, "w");
    assert_non_null(out);
    function(out);
    assert_int_equal(fclose(out), 0);
    return text;
}

static void write_json(FILE *out) {
    json j = json_begin(out);
    json_open(&j, NULL, '{');
    json_number(&j, "a", 0.1);
    json_number(&j, "b", (double)INFINITY);
    json_open(&j, "c", '[');
    json_integer(&j, NULL, UINT64_MAX);
    json_bool(&j, NULL, true);
    json_bool(&j, NULL, false);
    json_open(&j, NULL, '{');
    json_close(&j);
    json_close(&j);
    json_text(&j, "d\"", "q\"b\\n\nu\x1f \xc3\xa9");
    json_text(&j, "e", NULL);
    json_open(&j, "f", '[');
    json_close(&j);
    json_close(&j);
}

static void json_nests(void **state) {
    (void)state;
    assert_string_equal(written(write_json),
                        "{\n"
                        "  \"a\": 0.10000000000000001,\n"
                        "  \"b\": null,\n"
                        "  \"c\": [\n"
                        "    18446744073709551615,\n"
                        "    true,\n"
                        "    false,\n"
                        "    {}\n"
                        "  ],\n"
                        "  \"d\\\"\": \"q\\\"b\\\\n\\u000au\\u001f \xc3\xa9\",\n"
                        "  \"e\": null,\n"
                        "  \"f\": []\n"
                        "}\n");
}

static void write_help(FILE *out) {
    cli_help_on(out, &command);
}

static void write_short_help(FILE *out) {
    static const cli_option two[] = {
        {"sixteen-letters-", 0, NULL, "beside"}, {"seventeen-letters", 0, NULL, "below"}, {0}};
    static const cli_command none = {.name = "alone",
                                     .operands = "",
                                     .summary = "one",
                                     .details = "Two.",
                                     .examples = "",
                                     .options = two};
    cli_help_on(out, &none);
}

static void help_is_wrapped(void **state) {
    (void)state;
    assert_string_equal(
        written(write_help),
        "usage: asdic try [OPTION...] SCENE.yaml\n\na try.\n\n"
        "One two three four five six seven eight nine ten eleven twelve "
        "thirteen\nfourteen.\n\nEnd.\n\n"
        "options:\n"
        "  -o, --output FILE       where it goes\n"
        "  -q, --quiet             print errors only, and where results are others than\n"
        "                          asked for\n"
        "  -v, --verbose           tell more; twice: what helps to find faults\n"
        "  -h, --help              show this help and exit\n\n"
        "examples:\n  asdic try a\n  asdic try b\n");
    assert_contains(written(write_short_help),
                    "usage: asdic alone [OPTION...]\n\none.\n\nTwo.\n\noptions:\n"
                    "      --sixteen-letters-  beside\n"
                    "      --seventeen-letters\n                          below\n");
}

static int64_t ns_of(clockid_t clock) {
    struct timespec t;
    clock_gettime(clock, &t);
    return INT64_C(1000000000) * t.tv_sec + t.tv_nsec;
}

static void clocks_run_in_seconds(void **state) {
    (void)state;
    const struct timespec moment = {.tv_nsec = 70000000};
    for (int i = 0; i < 3; i++) {
        int64_t from = ns_of(CLOCK_MONOTONIC), own_from = ns_of(CLOCK_PROCESS_CPUTIME_ID);
        double now_ns = 1e9 * cli_clock_s(), own_ns = 1e9 * cli_processor_s();
        int64_t end = ns_of(CLOCK_MONOTONIC), own_end = ns_of(CLOCK_PROCESS_CPUTIME_ID);
        assert_true(now_ns > (double)from - 1e3 && now_ns < (double)end + 1e3);
        assert_true(own_ns > (double)own_from - 1e3 && own_ns < (double)own_end + 1e3);
        nanosleep(&moment, NULL);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(verbosity_says_what_is_said),
        cmocka_unit_test(a_place_stands_before_the_severity),
        cmocka_unit_test(the_library_is_heard),
        cmocka_unit_test(a_status_is_an_exit_code),
        cmocka_unit_test(one_thing_has_no_s),
        cmocka_unit_test(progress_counts_from_the_first_ping),
        cmocka_unit_test(loops_are_told_apart),
        cmocka_unit_test(loops_have_a_limit),
        cmocka_unit_test(a_terminal_has_a_bar),
        cmocka_unit_test(json_nests),
        cmocka_unit_test(help_is_wrapped),
        cmocka_unit_test(clocks_run_in_seconds),
    };
    return cmocka_run_group_tests(tests, context_begin, context_end);
}
