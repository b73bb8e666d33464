/* From a command line to values: options as they are written, numbers, ranges and words at their limits. */
#include "asserts.h"
#include "told.h"

#include "cli/cli_state.h"
#include "cli/commands.h"

#include <asdic/asdic.h>

#include <ctype.h>

#define USAGE "'asdic try --help' shows how it is used\n"

static const cli_option options[] = {
    {"number", 'n', "X", "a number"},   {"whole", 0, "N", "whole"},
    {"range", 'r', "LO:HI", "a range"}, {"pings", 0, "A:B", "some"},
    {"shard", 0, "K/N", "a part"},      {"word", 'w', "WORD", "one"},
    {"vary", 0, "KEY=A,B", "several"},  {"force", 'f', NULL, "flag"},
    {"forced", 0, NULL, "another"},     {0}};
static const cli_command command = {.name = "try", .options = options};
static const cli_command full = {
    .name = "full", .options = options, .traits = CLI_HAS_DEVICE | CLI_HAS_JSON};
static cli c;

/* Reads WORDS, which end with NULL; returns what is said. */
static const char *parse(bool good, const char *const *words) {
    static char *argv[16];
    int argc = 0;
    argv[argc++] = (char *)(uintptr_t) "try";
    for (; *words; words++) {
        argv[argc++] = (char *)(uintptr_t)*words;
    }
    argv[argc] = NULL;
    cli_begin(&c, NULL, &command);
    told_begin();
    bool is_good = cli_parse(&c, argc, argv);
    const char *said = told_end();
    assert_int_equal(is_good, good);
    assert_int_equal(cli_bad_usage(&c), !good);
    return said;
}

#define PARSE(good, ...) parse(good, (const char *const[]){__VA_ARGS__, NULL})

static void options_are_those_of_the_command(void **state) {
    (void)state;
    cli_begin(&c, NULL, &command);
    assert_int_equal(c.option_count, 9 + 3);
    assert_string_equal(c.options[9]->name, "quiet");
    assert_string_equal(c.options[10]->name, "verbose");
    assert_string_equal(c.options[11]->name, "help");
    cli_begin(&c, NULL, &full);
    assert_int_equal(c.option_count, 9 + 5);
    assert_string_equal(c.options[9]->name, "device");
    assert_string_equal(c.options[10]->name, "json");
    assert_int_equal(c.options[11]->letter, 'q');
    assert_int_equal(c.options[12]->letter, 'v');
    assert_int_equal(c.options[13]->letter, 'h');
}

static void words_are_options_and_operands(void **state) {
    (void)state;
    assert_string_equal(PARSE(true, "a", "-n", "1", "--whole=2", "b", "-fw", "red", "--", "-q"),
                        "");
    assert_string_equal(cli_text(&c, "number"), "1");
    assert_string_equal(cli_text(&c, "whole"), "2");
    assert_string_equal(cli_text(&c, "word"), "red");
    assert_string_equal(cli_text(&c, "force"), "");
    assert_true(cli_given(&c, "force"));
    assert_false(cli_given(&c, "forced"));
    assert_false(cli_given(&c, "quiet"));
    assert_null(cli_text(&c, "range"));
    assert_int_equal(cli_operand_count(&c), 3);
    assert_string_equal(cli_operand(&c, 0), "a");
    assert_string_equal(cli_operand(&c, 1), "b");
    assert_string_equal(cli_operand(&c, 2), "-q");
    assert_null(cli_operand(&c, 3));
    assert_string_equal(PARSE(true, "--number", "1", "-n2", "--num=3"), ""); /* the last counts */
    assert_string_equal(cli_text(&c, "number"), "3");
    assert_int_equal(cli_operand_count(&c), 0);
}

static void verbosity_has_four_steps(void **state) {
    (void)state;
    static const struct {
        const char *words[4];
        int verbosity;
    } cases[] = {{{"-q"}, -1},
                 {{"-v"}, 1},
                 {{"-vv"}, 2},
                 {{"-vvv"}, 2},
                 {{"-v", "-q"}, -1},
                 {{"-q", "-v"}, 1},
                 {{"--verbose"}, 1},
                 {{"--quiet"}, -1},
                 {{"a"}, 0},
                 {{"-qvv"}, 2},
                 {{"-v", "-v", "-q"}, -1}};
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        assert_string_equal(parse(true, cases[k].words), "");
        assert_int_equal(c.verbosity, cases[k].verbosity);
        assert_true(cli_quiet(&c) == (cases[k].verbosity < 0));
    }
}

static void mistakes_are_named(void **state) {
    (void)state;
    assert_string_equal(PARSE(false, "--nmber", "1"),
                        "error: unknown option '--nmber'; did you mean '--number'?\n" USAGE);
    assert_string_equal(PARSE(false, "a", "--xyzzy=5"), "error: unknown option '--xyzzy'\n" USAGE);
    assert_string_equal(PARSE(false, "--for"), "error: option '--for' is ambiguous\n" USAGE);
    assert_string_equal(PARSE(false, "-f", "-x"), "error: unknown option '-x'\n" USAGE);
    assert_string_equal(PARSE(false, "--number"),
                        "error: option '--number' needs a value: X\n" USAGE);
    assert_string_equal(PARSE(false, "b", "-r"),
                        "error: option '--range' needs a value: LO:HI\n" USAGE);
    assert_string_equal(PARSE(false, "-w"), "error: option '--word' needs a value: WORD\n" USAGE);
    assert_string_equal(PARSE(false, "--forced=yes"),
                        "error: option '--forced' takes no value\n" USAGE);
    assert_string_equal(PARSE(false, "--force=yes"),
                        "error: option '--force' takes no value\n" USAGE);
    assert_string_equal(PARSE(false, "a", "b", "--wole"),
                        "error: unknown option '--wole'; did you mean '--whole'?\n" USAGE);
}

/* What is said of OPTION with VALUE by TAKE, "" where it is taken. */
static const char *say(const char *option, const char *value, void (*take)(void)) {
    const char *const words[] = {option, value, NULL};
    assert_string_equal(parse(true, words), "");
    told_begin();
    take();
    const char *said = told_end();
    assert_int_equal(cli_bad_usage(&c), *said != '\0');
    return said;
}

static double number, low, high;
static uint64_t whole, first, end;
static cli_part part;
static int choice;

static void take_number(void) {
    number = 7.0;
    cli_number(&c, "number", -1.5, 20.0, &number);
}

static void numbers_have_limits(void **state) {
    (void)state;
    static const struct {
        const char *text;
        double value;
    } good[] = {{"-1.5", -1.5}, {"20", 20.0}, {"2e1", 20.0},
                {".5", 0.5},    {"+3", 3.0},  {"0x10", 16.0}};
    static const char *const bad[] = {"-1.51", "20.1", "",  " 1",  "1 ",    "1x",
                                      "nan",   "inf",  "x", "\t1", "1e999", "-inf"};
    for (size_t k = 0; k < sizeof good / sizeof *good; k++) {
        assert_string_equal(say("-n", good[k].text, take_number), "");
        assert_true(number == good[k].value);
    }
    for (size_t k = 0; k < sizeof bad / sizeof *bad; k++) {
        char expected[128];
        snprintf(expected, sizeof expected,
                 "error: option '--number': '%s' is not a number in [-1.5, 20]\n", bad[k]);
        assert_string_equal(say("-n", bad[k], take_number), expected);
        assert_true(number == 7.0);
    }
    PARSE(true, "a");
    take_number();
    assert_true(number == 7.0);
    assert_false(cli_bad_usage(&c));
}

static void take_whole(void) {
    whole = 7;
    cli_integer(&c, "whole", 2, 1u << 20, &whole);
}

static void take_any(void) {
    whole = 7;
    cli_integer(&c, "whole", 0, UINT64_MAX, &whole);
}

static void whole_numbers_have_limits(void **state) {
    (void)state;
    static const char *const bad[] = {"1", "1048577", "-3", "+3",  "3.0",
                                      "",  " 3",      "3 ", "0x3", "3k"};
    assert_string_equal(say("--whole", "2", take_whole), "");
    assert_true(whole == 2);
    assert_string_equal(say("--whole", "1048576", take_whole), "");
    assert_true(whole == 1u << 20);
    for (size_t k = 0; k < sizeof bad / sizeof *bad; k++) {
        char expected[128];
        snprintf(expected, sizeof expected,
                 "error: option '--whole': '%s' is not a whole number in [2, 1048576]\n", bad[k]);
        assert_string_equal(say("--whole", bad[k], take_whole), expected);
        assert_true(whole == 7);
    }
    assert_string_equal(say("--whole", "18446744073709551615", take_any), "");
    assert_true(whole == UINT64_MAX);
    assert_string_equal(say("--whole", "18446744073709551616", take_any),
                        "error: option '--whole': '18446744073709551616' is not a whole number in "
                        "[0, 18446744073709551615]\n");
}

static void take_range(void) {
    low = high = 7.0;
    cli_number_range(&c, "range", -100.0, 50.0, &low, &high);
}

static void ranges_ascend_within_limits(void **state) {
    (void)state;
    static const char *const bad[] = {"1",     "1:",  ":2",  "2:2", "3:2",  "-100.1:0", "0:50.1",
                                      "1:2:3", "a:2", "1:a", "1,2", "1: 2", "1:2 ",     "nan:2"};
    assert_string_equal(say("-r", "-100:50", take_range), "");
    assert_true(low == -100.0 && high == 50.0);
    assert_string_equal(say("-r", "1.5:2", take_range), "");
    assert_true(low == 1.5 && high == 2.0);
    for (size_t k = 0; k < sizeof bad / sizeof *bad; k++) {
        char expected[128];
        snprintf(expected, sizeof expected,
                 "error: option '--range': '%s' is not LOW:HIGH with -100 <= LOW < HIGH <= 50\n",
                 bad[k]);
        assert_string_equal(say("-r", bad[k], take_range), expected);
        assert_true(low == 7.0 && high == 7.0);
    }
}

static void take_pings(void) {
    first = 3;
    end = 90;
    cli_index_range(&c, "pings", &first, &end);
}

static void pings_are_counted_as_in_python(void **state) {
    (void)state;
    static const struct {
        const char *text;
        uint64_t first, end;
    } good[] = {{"5", 5, 6},   {"0", 0, 1},  {"4:8", 4, 8}, {":8", 3, 8},
                {"4:", 4, 90}, {":", 3, 90}, {"0:1", 0, 1}, {"90:91", 90, 91}};
    static const char *const bad[] = {
        "8:8", "9:8", "", "x", "4:8:9", "4-8", "-4", "4:x", "90:", ":3", "99999999999999999999"};
    for (size_t k = 0; k < sizeof good / sizeof *good; k++) {
        assert_string_equal(say("--pings", good[k].text, take_pings), "");
        assert_true(first == good[k].first && end == good[k].end);
    }
    for (size_t k = 0; k < sizeof bad / sizeof *bad; k++) {
        char expected[160];
        snprintf(expected, sizeof expected,
                 "error: option '--pings': '%s' is not FIRST:END with FIRST < END, counted from 0, "
                 "END left "
                 "out\n",
                 bad[k]);
        assert_string_equal(say("--pings", bad[k], take_pings), expected);
        assert_true(first == 3 && end == 90);
    }
}

static void take_share(void) {
    part = cli_share(&c, "shard");
}

static void a_share_is_one_of_several(void **state) {
    (void)state;
    static const char *const bad[] = {"0/3",
                                      "4/3",
                                      "1",
                                      "1/",
                                      "/3",
                                      "1/3/",
                                      "1:3",
                                      "a/3",
                                      "1/b",
                                      "1/1000000001",
                                      "18446744073709551615/18446744073709551615",
                                      ""};
    assert_string_equal(say("--shard", "1/1", take_share), "");
    assert_true(part.k == 1 && part.n == 1);
    assert_string_equal(say("--shard", "2/3", take_share), "");
    assert_true(part.k == 2 && part.n == 3);
    assert_string_equal(say("--shard", "3/3", take_share), "");
    assert_true(part.k == 3 && part.n == 3);
    assert_string_equal(say("--shard", "1000000000/1000000000", take_share), "");
    assert_true(part.k == 1000000000 && part.n == 1000000000);
    for (size_t k = 0; k < sizeof bad / sizeof *bad; k++) {
        char expected[128];
        snprintf(expected, sizeof expected,
                 "error: option '--shard': '%s' is not K/N with 1 <= K <= N <= 1000000000\n",
                 bad[k]);
        assert_string_equal(say("--shard", bad[k], take_share), expected);
        assert_true(part.k == 1 && part.n == 1);
    }
}

static void take_word(void) {
    static const char *const words[] = {"red", "green", "blue", NULL};
    choice = 7;
    cli_choice(&c, "word", words, &choice);
}

static void a_word_is_one_of_a_list(void **state) {
    (void)state;
    assert_string_equal(say("-w", "red", take_word), "");
    assert_int_equal(choice, 0);
    assert_string_equal(say("-w", "blue", take_word), "");
    assert_int_equal(choice, 2);
    assert_string_equal(say("-w", "mauve", take_word),
                        "error: option '--word': 'mauve' is not one of red, green, blue\n");
    assert_int_equal(choice, 7);
    assert_string_equal(
        say("-w", "gren", take_word),
        "error: option '--word': 'gren' is not one of red, green, blue; did you mean 'green'?\n");
    for (int i = 0; i < 4; i++) { /* as asdic_target has them */
        static const asdic_target kinds[] = {ASDIC_TARGET_SWERLING0, ASDIC_TARGET_SWERLING1,
                                             ASDIC_TARGET_SWERLING3, ASDIC_TARGET_SWERLING2};
        static const char *const names[] = {"swerling0", "swerling1", "swerling3", "swerling2"};
        assert_string_equal(cli_target_names[kinds[i]], names[i]);
    }
    assert_null(cli_target_names[4]);
}

static char *key;
static const char *values[3];
static size_t count;
static bool is_varied;

static void take_vary(void) {
    is_varied = cli_vary(&c, 3, &key, values, &count);
}

static void a_key_has_several_values(void **state) {
    (void)state;
    static const char *const forms[] = {"key", "=1", "key=", ""};
    static const char *const lists[] = {"key=1,", "key=,1", "key=1,,2", "key=1,2,3,4"};
    assert_string_equal(say("--vary", "a.b=1,2 x,=", take_vary), "");
    assert_true(is_varied && count == 3);
    assert_string_equal(key, "a.b");
    assert_string_equal(values[0], "1");
    assert_string_equal(values[1], "2 x");
    assert_string_equal(values[2], "=");
    free(key);
    assert_string_equal(say("--vary", "k=[0,[1]],{a: 1, b: [2,3]}", take_vary), "");
    assert_true(is_varied && count == 2);
    assert_string_equal(values[0], "[0,[1]]");
    assert_string_equal(values[1], "{a: 1, b: [2,3]}");
    free(key);
    assert_string_equal(say("--vary", "k=a],[b,c", take_vary), ""); /* names of files */
    assert_true(is_varied && count == 3);
    assert_string_equal(values[0], "a]");
    assert_string_equal(values[1], "[b");
    free(key);
    assert_string_equal(say("--vary", "k=5", take_vary), "");
    assert_true(is_varied && count == 1);
    assert_string_equal(values[0], "5");
    free(key);
    for (size_t k = 0; k < 4; k++) {
        char expected[160];
        snprintf(expected, sizeof expected,
                 "error: option '--vary': '%s' is not KEY=VALUE,VALUE,...\n" USAGE, forms[k]);
        assert_string_equal(say("--vary", forms[k], take_vary), expected);
        assert_false(is_varied);
        free(key);
        assert_string_equal(say("--vary", lists[k], take_vary),
                            "error: option '--vary': 1 to 3 values, none of them empty\n" USAGE);
        assert_false(is_varied);
        free(key);
    }
    PARSE(true, "a");
    take_vary();
    assert_true(is_varied && count == 1);
    assert_null(key);
}

static void the_device_is_of_option_or_environment(void **state) {
    (void)state;
    static char *argv[] = {(char *)(uintptr_t) "full", (char *)(uintptr_t) "--device",
                           (char *)(uintptr_t) "cpu", NULL};
    setenv("ASDIC_DEVICE", "name:x", 1);
    cli_begin(&c, NULL, &full);
    assert_true(cli_parse(&c, 3, argv));
    assert_string_equal(cli_device(&c), "cpu");
    cli_begin(&c, NULL, &full);
    assert_true(cli_parse(&c, 1, argv));
    assert_string_equal(cli_device(&c), "name:x");
    unsetenv("ASDIC_DEVICE");
    assert_null(cli_device(&c));
}

/* Whether the help of an option says that it is VALUE where it is not given. */
static bool tells(const cli_command *of, const char *option, const char *value) {
    static const char *const words[] = {"default ", "else "};
    const cli_option *o = of->options;
    while (o->name && strcmp(o->name, option) != 0) {
        o++;
    }
    for (size_t i = 0; o->name && i < sizeof words / sizeof *words; i++) {
        for (const char *at = o->help; (at = strstr(at, words[i])); at++) {
            const char *said = at + strlen(words[i]), *behind = said + strlen(value);
            if (strncmp(said, value, strlen(value)) == 0 && !isalnum((unsigned char)*behind) &&
                !(*behind == '.' && isalnum((unsigned char)behind[1]))) {
                return true;
            }
        }
    }
    return false;
}

/* What a program gets from the library that sets nothing. */
static void help_tells_the_defaults(void **state) {
    (void)state;
    const asdic_dataset_options set = asdic_dataset_options_default();
    const asdic_detect_options detect = asdic_detect_options_default();
    const asdic_roc_options roc = asdic_roc_options_default();
    const asdic_trial_options trial = asdic_trial_options_default();
    const asdic_view_options view = asdic_view_options_default();
    const struct {
        const cli_command *command;
        const char *option;
        double value;
    } rows[] = {{&cli_dataset_command, "number", (double)set.frames},
                {&cli_dataset_command, "seed", (double)set.seed},
                {&cli_dataset_command, "threshold", set.threshold},
                {&cli_dataset_command, "radius", set.radius_px},
                {&cli_detect_command, "cfar-cells", detect.cfar.cells},
                {&cli_detect_command, "cfar-guard", detect.cfar.guard},
                {&cli_detect_command, "truth", detect.truth_snr_db},
                {&cli_detect_command, "speed", detect.tracker.speed_mps},
                {&cli_roc_command, "bearing", roc.bearing_rad},
                {&cli_roc_command, "ping", (double)roc.ping},
                {&cli_roc_command, "trials", (double)roc.trials},
                {&cli_roc_command, "seed", (double)roc.seed},
                {&cli_trial_command, "runs", (double)trial.runs},
                {&cli_trial_command, "seed", (double)trial.seed}};
    char value[64];
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        snprintf(value, sizeof value, "%.15g", rows[i].value);
        if (!tells(rows[i].command, rows[i].option, value)) {
            print_error("--%s of '%s' is %s where it is not given\n", rows[i].option,
                        rows[i].command->name, value);
            fail();
        }
    }
    snprintf(value, sizeof value, "%ux%u", (unsigned)view.width, (unsigned)view.height);
    assert_true(tells(&cli_view_command, "size", value));
    assert_int_equal(view.colormap, ASDIC_COLORMAP_INFERNO);
    assert_true(tells(&cli_view_command, "colormap", "inferno"));
    assert_false(tells(&cli_roc_command, "trials", "1") || tells(&cli_detect_command, "cell", "0"));
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(options_are_those_of_the_command),
        cmocka_unit_test(words_are_options_and_operands),
        cmocka_unit_test(help_tells_the_defaults),
        cmocka_unit_test(verbosity_has_four_steps),
        cmocka_unit_test(mistakes_are_named),
        cmocka_unit_test(numbers_have_limits),
        cmocka_unit_test(whole_numbers_have_limits),
        cmocka_unit_test(ranges_ascend_within_limits),
        cmocka_unit_test(pings_are_counted_as_in_python),
        cmocka_unit_test(a_share_is_one_of_several),
        cmocka_unit_test(a_word_is_one_of_a_list),
        cmocka_unit_test(a_key_has_several_values),
        cmocka_unit_test(the_device_is_of_option_or_environment),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
