/* Parts of the program without a device: poses from lines, words and numbers that are shown, rules in other
 * programs. */
#include "asserts.h"
#include "told.h"

#include "cli/bench_error.h"
#include "cli/bench_pings.h"
#include "cli/bench_rays.h"
#include "cli/cli_state.h"
#include "cli/progress.h"
#include "cli/serve.h"
#include "cli/trial_rule.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define DEGREE (3.14159265358979323846 / 180.0)

static serve_reader reader;
static serve_request got;
static char why[SERVE_WHY_SIZE];

static serve_line read_line(const char *line) {
    why[0] = '\0';
    return serve_read_line(&reader, line, strlen(line), &got, why);
}

static void assert_pose(const char *line, double x, double y, double z, double roll_deg,
                        double pitch_deg, double yaw_deg) {
    serve_line kind = read_line(line);
    if (kind != SERVE_POSE) {
        print_error("'%s': %s\n", line, why);
    }
    assert_int_equal(kind, SERVE_POSE);
    assert_true(got.pose.position_m.x == x && got.pose.position_m.y == y &&
                got.pose.position_m.z == z);
    assert_close(got.pose.roll_rad, roll_deg * DEGREE, 1e-12);
    assert_close(got.pose.pitch_rad, pitch_deg * DEGREE, 1e-12);
    assert_close(got.pose.yaw_rad, yaw_deg * DEGREE, 1e-12);
}

static void assert_bad(const char *line, const char *reason) {
    serve_line kind = read_line(line);
    if (kind != SERVE_BAD || !strstr(why, reason)) {
        print_error("'%s': %d, %s\n", line, (int)kind, why);
    }
    assert_int_equal(kind, SERVE_BAD);
    assert_non_null(strstr(why, reason));
}

static void values_have_an_order(void **state) {
    (void)state;
    reader = serve_reader_begin();
    assert_pose("1,2,3,4,5,6,7", 2.0, 3.0, 4.0, 5.0, 6.0, 7.0);
    assert_true(got.value[SERVE_TIME] == 1.0);
    assert_pose(" 1 ,\t-2 , +3, .5,-5,6e0,7 ", -2.0, 3.0, 0.5, -5.0, 6.0, 7.0);
    assert_bad("1,2,3,4,5,6", "6 values where 7 are expected: time_s,x_m");
    assert_bad("1,2,3,4,5,6,7,8", "8 values where 7 are expected: time_s,x_m");
    assert_bad("1,2,3,4,5,6,7,", "8 values where 7 are");
    assert_bad("1,2,,4,5,6,7", "'y_m' = '' is not a number");
    assert_bad("1,2,3x,4,5,6,7", "'y_m' = '3x' is not a number");
    assert_bad("1,2,-,4,5,6,7", "'y_m' = '-' is not a number");
    assert_bad("1,2,1e999,4,5,6,7", "'y_m' = '1e999' is not a number");
    assert_bad("1,2,3,4,5,6,0123456789012345678901234567890123456789x",
               "'yaw_deg' = '0123456789012345678901234567890123456789' is not");
    assert_int_equal(read_line(""), SERVE_NOTHING);
    assert_int_equal(read_line(" \t"), SERVE_NOTHING);
}

static void a_header_gives_the_order(void **state) {
    (void)state;
    reader = serve_reader_begin();
    assert_int_equal(read_line("time_s,x_m,y_m,z_m,yaw_deg,roll_deg,pitch_deg"), SERVE_NOTHING);
    assert_pose("1,2,3,4,5,6,7", 2.0, 3.0, 4.0, 6.0, 7.0, 5.0);
    assert_int_equal(read_line(" \"z_m\" , x_m,speed,y_m\t"), SERVE_NOTHING);
    assert_pose("7,1,fast,2", 1.0, 2.0, 7.0, 0.0, 0.0, 0.0);
    assert_true(isnan(got.value[SERVE_TIME]));
    assert_bad("7,1,fast", "3 values where 4 are expected by the header");
    assert_bad("7,1,fast,2,3", "5 values where 4 are expected by the header");
    assert_bad("x_m,y_m", "the header lacks");
    assert_bad("x_m,z_m", "the header lacks");
    assert_bad("y_m,z_m", "the header lacks");
    assert_bad("x_m,y_m,z_m,x_m", "there twice in the header");
    assert_bad("time_s,x_m,y_m,z_m,time_s", "there twice in the header");
    assert_pose("7,1,fast,2", 1.0, 2.0, 7.0, 0.0, 0.0, 0.0);         /* a bad one changes nothing */
    assert_int_equal(read_line("_a,_a,x_m,y_m,z_m"), SERVE_NOTHING); /* unknown ones may be */

    char header[256] = "x_m,y_m,z_m";
    for (int i = 3; i < SERVE_MAX_FIELDS; i++) {
        strcat(header, ",a");
    }
    assert_int_equal(read_line(header), SERVE_NOTHING);
    strcat(header, ",a");
    assert_bad(header, "more than 32 columns");
}

static void objects_are_read(void **state) {
    (void)state;
    reader = serve_reader_begin();
    assert_pose("{\"x_m\":1,\"y_m\":2,\"z_m\":3}", 1.0, 2.0, 3.0, 0.0, 0.0, 0.0);
    assert_pose(
        " { \"yaw_deg\" : 90 , \"z_m\":3,\"y_m\" :2,\"x_m\": 1 ,\"roll_deg\":-4,\"pitch_deg\":5} ",
        1.0, 2.0, 3.0, -4.0, 5.0, 90.0);
    assert_pose(
        "{\"a\":\"}\",\"b\":true,\"c\":false,\"d\":null,\"e\":-1,\"x_m\":1,\"y_m\":2,\"z_m\":3}",
        1.0, 2.0, 3.0, 0.0, 0.0, 0.0);
    assert_bad("{\"x_m\":1,\"y_m\":2}", "'z_m' is missing");
    assert_bad("{\"y_m\":1,\"z_m\":2}", "'x_m' is missing");
    assert_bad("{}", "'x_m' is missing");
    assert_bad("{\"x_m\":1,\"x_m\":2}", "'x_m' is there twice");
    assert_bad("{x_m:1}", "column 2: a name in double quotes");
    assert_bad("{\"x_m}", "column 2: a name in double quotes");
    assert_bad("{\"x_m\" 1}", "column 8: a colon");
    assert_bad("{\"x_m\":true}", "column 8: a number expected");
    assert_bad("{\"a\":\"b}", "column 6: a value, at most 32 levels deep, expected");
    assert_bad("{\"x_m\":1 \"y_m\":2}", "column 10: a comma or }");
    assert_bad("{\"x_m\":1,}", "column 10: a name in double quotes");
    assert_bad("{\"x_m\":1} x", "column 11: the end of the line");
}

/* Any value of RFC 8259 under another name, and null for what is not known. */
static void other_values_are_passed_over(void **state) {
    (void)state;
    static const char *const values[] = {"[]",
                                         "{}",
                                         "[ ]",
                                         "{ }",
                                         "[1, \"]\" ,{\"x_m\":5}]",
                                         "{\"stamp\":{\"sec\":1},\"a\":[[]]}",
                                         "\"a \\\"quoted\\\" word \\\\\"",
                                         "\"\\u005c\"",
                                         "1e999",
                                         "-0.5E+3"};
    static const struct {
        const char *value, *column;
    } broken[] = {{"[1,]", "9"},    {"[1 2]", "9"}, {"{\"b\"}", "10"}, {"{1:2}", "7"},
                  {"\"a\\\"", "6"}, {"[1", "8"},    {"nul", "6"},      {"{\"b\":1,}", "13"},
                  {"[1}", "8"},     {"", "6"},      {"tru", "6"}};
    char line[256];
    reader = serve_reader_begin();
    for (size_t i = 0; i < sizeof values / sizeof *values; i++) {
        snprintf(line, sizeof line, "{\"\\\"a\":%s ,\"x_m\":1,\"y_m\":2,\"z_m\":3}", values[i]);
        assert_pose(line, 1.0, 2.0, 3.0, 0.0, 0.0, 0.0);
    }
    for (size_t i = 0; i < sizeof broken / sizeof *broken; i++) {
        char reason[64];
        snprintf(line, sizeof line, "{\"a\":%s", broken[i].value);
        snprintf(reason, sizeof reason, "column %s: ", broken[i].column);
        assert_bad(line, reason);
    }
    for (int levels = 32; levels <= 33; levels++) {
        snprintf(line, sizeof line, "{\"x_m\":1,\"y_m\":2,\"z_m\":3,\"a\":%.*s%.*s}", levels,
                 "[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[", levels, "]]]]]]]]]]]]]]]]]]]]]]]]]]]]]]]]]");
        if (levels == 32) {
            assert_pose(line, 1.0, 2.0, 3.0, 0.0, 0.0, 0.0);
        } else {
            assert_bad(line, "a value, at most 32 levels deep, expected");
        }
    }
    assert_pose("{\"roll_deg\":null,\"x_m\":1,\"y_m\":2,\"z_m\":3,\"yaw_deg\":4,\"time_s\":null}",
                1.0, 2.0, 3.0, 0.0, 0.0, 4.0);
    assert_true(isnan(got.value[SERVE_TIME]));
    assert_bad("{\"x_m\":null,\"y_m\":2,\"z_m\":3}", "'x_m' is missing");
}

/* RFC 3629: the least and greatest of each length, what lies between and beyond. */
static void lines_are_text(void **state) {
    (void)state;
    static const struct {
        const char *bytes;
        bool is_text;
    } cases[] = {
        {"\x7e", true},
        {"\t", true},
        {"\x1f", false},
        {"\x7f", false},
        {"\x80", false},
        {"\xc1\xbf", false},
        {"\xc2\x80", true},
        {"\xdf\xbf", true},
        {"\xc2", false},
        {"\xc2\x7f", false},
        {"\xc2\xc0", false},
        {"\xe0\x9f\xbf", false},
        {"\xe0\xa0\x80", true},
        {"\xed\x9f\xbf", true},
        {"\xed\xa0\x80", false},
        {"\xed\xbf\xbf", false},
        {"\xee\x80\x80", true},
        {"\xef\xbf\xbd", true},
        {"\xef\xbf", false},
        {"\xf0\x8f\xbf\xbf", false},
        {"\xf0\x90\x80", false},
        {"\xf0\x90\x80\x80", true},
        {"\xf4\x8f\xbf\xbf", true},
        {"\xf4\x90\x80\x80", false},
        {"\xf5\x80\x80\x80", false},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char line[64];
        reader = serve_reader_begin();
        snprintf(line, sizeof line, "x_m,y_m,z_m,a%s", cases[i].bytes);
        serve_line kind = read_line(line);
        if (cases[i].is_text != (kind == SERVE_NOTHING)) {
            print_error("case %zu: %d, %s\n", i, (int)kind, why);
        }
        assert_int_equal(kind, cases[i].is_text ? SERVE_NOTHING : SERVE_BAD);
        if (kind == SERVE_BAD) {
            assert_non_null(strstr(why, "column 14: the byte 0x"));
        }
    }
}

static void long_numbers_are_shown_short(void **state) {
    (void)state;
    static const struct {
        double value;
        const char *text;
    } cases[] = {
        {0.0, "0 "},         {7.0, "7 "},         {999.0, "999 "},      {1000.0, "1.00 k"},
        {9990.0, "9.99 k"},  {10000.0, "10.0 k"}, {99900.0, "99.9 k"},  {100000.0, "100 k"},
        {999000.0, "999 k"}, {1e6, "1.00 M"},     {2.5e9, "2.50 G"},    {4e12, "4.00 T"},
        {7.7e15, "7700 T"},  {9996.0, "10.0 k"},  {999600.0, "1.00 M"}, {999.7, "1.00 k"}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char text[16];
        cli_progress_short(text, cases[i].value);
        assert_string_equal(text, cases[i].text);
    }
}

/* One letter and a third of a word may be wrong, three at most. */
static void the_nearest_word_is_meant(void **state) {
    (void)state;
    static const char *const words[] = {"run", "render", "tolerance-percent", "rays"};
    static const struct {
        const char *text, *nearest;
    } cases[] = {{"run", "run"},
                 {"rum", "run"},
                 {"rnu", "run"},
                 {"xyz", NULL},
                 {"mux", NULL}, /* of three letters two are wrong */
                 {"rxxxer", "render"},
                 {"rxxxxr", NULL},
                 {"render", "render"},
                 {"endre", "render"},
                 {"rayz", "rays"},
                 {"tolerancepercent", "tolerance-percent"},
                 {"tolerance-perxxxt", "tolerance-percent"},
                 {"tolerance-pexxxxt", NULL},
                 {"", NULL},
                 {"ru", "run"},
                 {"r", NULL},
                 {"ras", "rays"}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        const char *near = cli_nearest(cases[i].text, words, 4);
        if (near != cases[i].nearest &&
            !(near && cases[i].nearest && strcmp(near, cases[i].nearest) == 0)) {
            print_error("'%s': '%s'\n", cases[i].text, near ? near : "none");
            fail();
        }
    }
    static const char *const two[] = {"abcd", "abce"};
    assert_ptr_equal(cli_nearest("abcf", two, 2), two[0]); /* the first of equals */
    assert_ptr_equal(cli_nearest("abce", two, 2), two[1]);
    char longest[] = "01234567890123456789012345678901234567890";
    const char *const one[] = {longest};
    assert_null(cli_nearest(longest, one, 1)); /* 41 letters */
    assert_null(cli_nearest(longest + 1, one, 1));
    longest[40] = '\0';
    assert_ptr_equal(cli_nearest(longest, one, 1), longest);
}

/* Two beams of two bins of half a metre: a's bins and the second of b are above their thresholds. No echo reaches
 * the first bin of b. */
static const asdic_beam two_beams[] = {{.name = "a\"\\\x1f "}, {.name = "b"}};
static const asdic_sonar two = {.receivers = two_beams, .receiver_count = 2};
static double total_lin[] = {1.0, 3.0, 2.0, 5.0}, limit_lin[] = {0.5, 2.0, 2.0, 4.0},
              llr[] = {-1.0, 2.5, (double)NAN, 1.0 / 3.0};
static const float level_db[] = {1.5f, 60.1f, NAN, -3.0f};
static const float expected_db[] = {-INFINITY, 7.0f, 8.0f, 9.0f};

static asdic_ping parts = {.intensity_lin = {[ASDIC_TOTAL] = total_lin}};
static asdic_loop_ping ping = {.ping = 7,
                               .time_s = 0.1,
                               .altitude_m = INFINITY,
                               .bin_length_m = 0.5,
                               .level_db = level_db,
                               .parts = &parts};
static const asdic_scan_result detection = {.threshold_lin = limit_lin, .llr = llr};

/* What is written of a ping and of an error on line 3, with its length. */
static char written[1024];

static size_t write_both(serve_format format, bool is_full, double time_s) {
    serve_writer w = {
        fmemopen(written, sizeof written, "w"), format, &two, 2, 0.5, is_full, is_full};
    serve_request request = {.value = {time_s, 1.0, -0.1, 1.0 / 3.0, 0.0, -5.0, 90.0}};
    serve_answer answer = {&ping, is_full ? expected_db : NULL, is_full ? &detection : NULL};
    assert_non_null(w.out);
    serve_write_head(&w);
    serve_write_ping(&w, 2, &request, &answer);
    serve_write_error(&w, 3, "no \"z\"");
    long length = ftell(w.out);
    assert_int_equal(fclose(w.out), 0);
    return (size_t)length;
}

#define POSE_JSON                                                                                  \
    "\"x_m\":1,\"y_m\":-0.1,\"z_m\":0.33333333333333331,\"roll_deg\":0,\"pitch_deg\":-5,"          \
    "\"yaw_deg\":90,\"altitude_m\":null,\"bin_length_m\":0.5,"
#define LEVELS_JSON "\"level_db\":{\"a\\\"\\\\\\u001f \":[1.5,60.0999985],\"b\":[null,-3]}"
#define ERROR_JSON "{\"error\":\"no \\\"z\\\"\",\"line\":3}\n"

/* Of a sonar that scans 30 degrees in steps of 7.5, back and forth: ping 7 is next to the port end. */
static const asdic_sweep swing = {.directions = 5, .step_rad = 7.5 * DEGREE};

static void answers_are_json(void **state) {
    (void)state;
    write_both(SERVE_JSON, false, 12.5);
    assert_string_equal(written,
                        "{\"ping\":7,\"time_s\":12.5," POSE_JSON LEVELS_JSON "}\n" ERROR_JSON);
    write_both(SERVE_JSON, true, 0.1);
    assert_string_equal(written,
                        "{\"ping\":7,\"time_s\":0.1," POSE_JSON LEVELS_JSON
                        ",\"expected_db\":{\"a\\\"\\\\\\u001f \":[null,7],\"b\":[8,9]}"
                        ",\"detections\":[{\"beam\":\"a\\\"\\\\\\u001f "
                        "\",\"range_m\":0.25,\"llr\":-1},{\"beam\":\"a\\\"\\\\\\u001f "
                        "\",\"range_m\":0.75,\"llr\":2.5},"
                        "{\"beam\":\"b\",\"range_m\":0.75,\"llr\":0.333333333}]}\n" ERROR_JSON);
    ping.sweep = swing;
    write_both(SERVE_JSON, false, 12.5);
    ping.sweep = (asdic_sweep){0};
    assert_non_null(strstr(written, "\"yaw_deg\":90,\"head_deg\":-7.5,\"altitude_m\":null,"));
}

#define HEAD_CSV "ping,time_s,x_m,y_m,z_m,roll_deg,pitch_deg,yaw_deg,altitude_m,error"
#define LEVELS_CSV ",1,-0.1,0.33333333333333331,0,-5,90,,,1.5,60.0999985,,-3"
#define A "a\"\\\x1f "

static void answers_are_csv(void **state) {
    (void)state;
    write_both(SERVE_CSV, false, 12.5);
    assert_string_equal(written, HEAD_CSV "," A "_0," A "_1,b_0,b_1\n"
                                          "7,12.5" LEVELS_CSV "\n"
                                          ",,,,,,,,,\"no \"\"z\"\"\",,,,\n");
    write_both(SERVE_CSV, true, 0.1);
    assert_string_equal(written,
                        HEAD_CSV "," A "_0," A "_1,b_0,b_1,expected_" A "_0,expected_" A
                                 "_1,expected_b_0,expected_b_1,detections\n"
                                 "7,0.1" LEVELS_CSV ",,7,8,9,\"" A ":0.25 " A ":0.75 b:0.75\"\n"
                                 ",,,,,,,,,\"no \"\"z\"\"\",,,,,,,,,\"\"\n");
}

/* The frame of a ping or of an error, and behind it what ARRAYS of 4 floats there are. */
static void assert_frame(const char *at, uint32_t status, uint32_t line, size_t arrays,
                         const float *const want[]) {
    serve_frame frame;
    float got_floats[4];
    memcpy(&frame, at, sizeof frame);
    assert_memory_equal(frame.magic, "ASDP", 4);
    assert_true(frame.status == status && frame.line == line && frame.arrays == arrays);
    assert_true(frame.beams == 2 && frame.bins == 2 && frame.bin_length_m == 0.5);
    assert_true(frame.ping == (status ? 0 : 7));
    assert_true(status ? isnan(frame.time_s) : frame.time_s == 0.1);
    assert_true(status ? isnan(frame.altitude_m) : isinf(frame.altitude_m));
    for (size_t i = 0; i < arrays; i++) {
        memcpy(got_floats, at + sizeof frame + i * sizeof got_floats, sizeof got_floats);
        for (size_t k = 0; k < 4; k++) {
            float wanted = status ? NAN : want[i][k];
            assert_true(got_floats[k] == wanted || (isnan(got_floats[k]) && isnan(wanted)));
        }
    }
}

static void answers_are_frames(void **state) {
    (void)state;
    static const float found[] = {-1.0f, 2.5f, NAN, 1.0f / 3.0f};
    static const float *const want[] = {level_db, expected_db, found};
    for (size_t arrays = 1; arrays <= 3; arrays += 2) {
        size_t size = sizeof(serve_frame) + arrays * sizeof level_db;
        assert_int_equal(write_both(SERVE_RAW, arrays == 3, 0.1), 2 * size);
        assert_frame(written, 0, 2, arrays, want);
        assert_frame(written + size, 1, 3, arrays, NULL);
    }
}

/* No process is ended from here, whatever a slip would signal; fork fails when told to. */
static int kills;
static bool fork_fails;

int __wrap_kill(pid_t pid, int number);
pid_t __real_fork(void);
pid_t __wrap_fork(void);

int __wrap_kill(pid_t pid, int number) {
    (void)pid;
    (void)number;
    kills++;
    return 0;
}

pid_t __wrap_fork(void) {
    errno = EAGAIN;
    return fork_fails ? -1 : __real_fork();
}

/* The rule orders as its heading what it is told of the pose, and ends by itself. */
static void a_rule_is_told_the_pose(void **state) {
    (void)state;
    static const struct {
        const char *key;
        double told;
    } values[] = {{"x_m", 100.5},       {"y_m", -30.25},   {"z_m", 12.75},    {"roll_deg", 7.5},
                  {"pitch_deg", -30.0}, {"yaw_deg", 90.0}, {"head_deg", -7.5}};
    asdic_loop_ping turned = ping;
    turned.sweep = swing;
    turned.pose = (asdic_pose){.position_m = {100.5, -30.25, 12.75},
                               .roll_rad = 7.5 * DEGREE,
                               .pitch_rad = -30.0 * DEGREE,
                               .yaw_rad = 90.0 * DEGREE};
    const asdic_trial_look look = {.sonar = &two, .ping = &turned, .found = &detection};
    for (size_t i = 0; i < sizeof values / sizeof *values; i++) {
        char command[128];
        snprintf(command, sizeof command,
                 "read -r p; y=${p#*'\"%s\":'}; echo '{\"yaw_deg\":'${y%%%%,*}'}'", values[i].key);
        trial_programs *rule = trial_programs_begin(command, 1, 60.0);
        asdic_trial_order order = {.turns = false};
        char wrong[ASDIC_TRIAL_WHY] = "";
        bool good = trial_programs_decide(rule, &look, &order, wrong);
        assert_string_equal(wrong, "");
        assert_true(good && order.turns && !order.dives);
        assert_close(order.yaw_rad, values[i].told * DEGREE, 1e-12);
        kills = 0;
        trial_programs_end(&rule);
        assert_int_equal(kills, 1);
        assert_null(rule);
    }
}

/* A rule gets lines of any length whole, also one that is a byte longer than what a pipe takes at once. */
static void a_rule_is_told_whole_lines(void **state) {
    (void)state;
    enum { PIECE = 4096 };
    static float quiet_db[PIECE];
    static double quiet_lin[PIECE], likely[PIECE];
    const asdic_beam beams[] = {{.name = "a"},
                                {.name = "ab"}}; /* either makes an odd number of bytes */
    asdic_ping empty = {.intensity_lin = {[ASDIC_TOTAL] = quiet_lin}};
    asdic_loop_ping quiet = ping;
    const asdic_scan_result nothing = {.threshold_lin = quiet_lin, .llr = likely};
    quiet.level_db = quiet_db;
    quiet.parts = &empty;
    size_t whole = 0;
    for (int i = 0; i < 2; i++) {
        const asdic_sonar one = {.receivers = &beams[i], .receiver_count = 1};
        const asdic_trial_look look = {.sonar = &one, .ping = &quiet, .found = &nothing};
        double length = 0.0;
        quiet.bins = 0;
        for (int k = 0; k < 2; k++) { /* each bin is a 0 and, but for the last, a comma */
            asdic_trial_order order = {.turns = false};
            char wrong[ASDIC_TRIAL_WHY] = "";
            trial_programs *rule = trial_programs_begin(
                "read -r p; echo '{\"yaw_deg\":'${#p}'}'; cat >/dev/null", 1, 20.0);
            bool good = trial_programs_decide(rule, &look, &order, wrong);
            trial_programs_end(&rule);
            assert_string_equal(wrong, "");
            assert_true(good && order.turns);
            length = rint(order.yaw_rad / DEGREE);
            whole += length == PIECE;
            quiet.bins = (size_t)(PIECE + 1 - length) / 2;
        }
        assert_in_range((size_t)length, PIECE - 1, PIECE);
    }
    assert_int_equal(whole, 1);
}

/* None was started, so that none is to be ended: -1 would be every process. */
static void a_rule_without_a_process_ends_none(void **state) {
    (void)state;
    trial_programs *rule = trial_programs_begin("cat", 1, 60.0);
    const asdic_trial_look look = {.sonar = &two, .ping = &ping, .found = &detection};
    asdic_trial_order order = {.turns = false};
    char wrong[ASDIC_TRIAL_WHY] = "";
    fork_fails = true;
    bool good = trial_programs_decide(rule, &look, &order, wrong);
    fork_fails = false;
    assert_false(good);
    assert_contains(wrong, "cannot start the rule: ");
    kills = 0;
    trial_programs_end(&rule);
    assert_int_equal(kills, 0);
}

/* The shell knows what it runs; what only it can read, it is asked at the run. */
static void programs_of_rules_are_looked_for(void **state) {
    (void)state;
    assert_true(trial_program_exists("cat"));
    assert_true(trial_program_exists(" cat -u"));
    assert_true(trial_program_exists("$RULE"));
    assert_false(trial_program_exists("no_such_rule"));
    assert_false(trial_program_exists("no_such_rule --fast"));
}

/* The panels that would be drawn, with their curves. */
static asdic_plot drawn[2];
static asdic_series curves_drawn[2][64];

asdic_status __wrap_asdic_picture_plot(asdic_context *ctx, const char *path,
                                       const asdic_plot *panels, size_t panel_count,
                                       const asdic_picture_options *options);
asdic_status __wrap_asdic_picture_plot(asdic_context *ctx, const char *path,
                                       const asdic_plot *panels, size_t panel_count,
                                       const asdic_picture_options *options) {
    (void)ctx;
    (void)path;
    (void)options;
    assert_in_range(panel_count, 1, 2);
    for (size_t i = 0; i < panel_count; i++) {
        drawn[i] = panels[i];
        assert_in_range(panels[i].series_count, 0, 64);
        memcpy(curves_drawn[i], panels[i].series, panels[i].series_count * sizeof(asdic_series));
    }
    return ASDIC_OK;
}

/* Whole decades, with marks at both ends, round all times. */
static void times_have_decades(void **state) {
    (void)state;
    static const struct {
        double times_ms[2], low_ms, high_ms;
    } cases[] = {{{115, 300}, 100, 1000},
                 {{2, 30}, 1, 100},
                 {{0.02, 0.5}, 0.01, 1},
                 {{5000, 9000}, 1000, 1e4}};
    const double rays[] = {1, 10};
    cli c = {0};
    const bench b = {.c = &c, .picture = "p.svg"};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        asdic_series curve = {.label = "scene", .x = rays, .y = cases[i].times_ms, .count = 2};
        assert_int_equal(bench_scaling_picture(&b, "title", "rays", &curve, 1), ASDIC_OK);
        assert_close_relative(drawn[0].y.low, cases[i].low_ms, 1e-12);
        assert_close_relative(drawn[0].y.high, cases[i].high_ms, 1e-12);
        assert_true(drawn[0].y.logarithmic && drawn[0].x.low < 1 && drawn[0].x.high > 10);
    }
}

asdic_status __wrap_bench_scene_open(const bench *b, size_t index, const bench_effort *effort,
                                     bench_scene *out);
asdic_status __wrap_bench_curve_measure(const bench *b, const bench_scene *scene,
                                        const bench_effort *effort, bench_curve *out);
void __wrap_bench_add(bench *b, const bench_cell *cells);

asdic_status __wrap_bench_scene_open(const bench *b, size_t index, const bench_effort *effort,
                                     bench_scene *out) {
    (void)b;
    (void)effort;
    *out = (bench_scene){.sonar = asdic_sonar_default(),
                         .beams = 1,
                         .bins = 5,
                         .first_bin = 1,
                         .reference_lin = calloc(5, sizeof(double)),
                         .spread_lin = calloc(5, sizeof(double)),
                         .spread_db = 0.25};
    snprintf(out->name, sizeof out->name, "scene %zu", index);
    for (size_t i = 0; i < 5; i++) {
        out->reference_lin[i] = 1.0;
    }
    out->spread_lin[1] = 0.1;
    return ASDIC_OK;
}

static double measured_db = 0.7, measured_s = 0.02;

asdic_status __wrap_bench_curve_measure(const bench *b, const bench_scene *scene,
                                        const bench_effort *effort, bench_curve *out) {
    (void)b;
    (void)scene;
    (void)effort;
    out->count = 1;
    out->points[0] =
        (bench_point){.rays = 64u << out->sampler, .rms_db = measured_db, .ping_s = measured_s};
    return ASDIC_OK;
}

/* The last rows, of as many numbers as a bench of pings has. */
static bench_cell added[3][11 + ASDIC_PHASE_COUNT];
static size_t added_columns, added_rows;

void __wrap_bench_add(bench *b, const bench_cell *cells) {
    (void)b;
    memcpy(added[added_rows++ % 3], cells, added_columns * sizeof *cells);
}

/* A colour for each sampler, a line for each scene, of which there are four: the fifth has the first one's. The
 * legend, after all curves of the panel on the left, shows both. */
static void curves_have_their_colours_and_lines(void **state) {
    (void)state;
    enum { SCENES = 5, CURVES = SCENES * BENCH_SAMPLERS };
    cli c = {.operand_count = 1 + SCENES}; /* "error" and the scenes */
    bench b = {.c = &c, .picture = "p.svg", .json = true};
    assert_int_equal(bench_error(&b), ASDIC_OK);
    assert_int_equal(drawn[0].series_count, CURVES + BENCH_SAMPLERS + SCENES);
    assert_int_equal(drawn[1].series_count, CURVES);
    const asdic_series *legend = curves_drawn[0] + CURVES;
    for (size_t i = 0; i < CURVES; i++) {
        size_t scene = i / BENCH_SAMPLERS, sampler = i % BENCH_SAMPLERS;
        for (size_t panel = 0; panel < 2; panel++) {
            assert_int_equal(curves_drawn[panel][i].rgb, legend[sampler].rgb);
            assert_int_equal(curves_drawn[panel][i].style, legend[BENCH_SAMPLERS + scene].style);
            assert_int_equal(curves_drawn[panel][i].count, 1);
            assert_null(curves_drawn[panel][i].label);
        }
    }
    for (size_t i = 0; i < BENCH_SAMPLERS; i++) {
        assert_int_not_equal(legend[i].rgb, legend[(i + 1) % BENCH_SAMPLERS].rgb);
        assert_int_equal(legend[i].style, ASDIC_LINE_SOLID);
    }
    assert_string_equal(legend[0].label, "adaptive");
    assert_string_equal(legend[2].label, "uniform-sphere");
    for (size_t i = 0; i < 4; i++) {
        for (size_t k = 0; k < i; k++) {
            assert_int_not_equal(legend[BENCH_SAMPLERS + i].style,
                                 legend[BENCH_SAMPLERS + k].style);
        }
    }
    assert_int_equal(legend[BENCH_SAMPLERS + 4].style, legend[BENCH_SAMPLERS].style);
    assert_int_equal(legend[BENCH_SAMPLERS].style, ASDIC_LINE_SOLID);
}

/* Errors from 0.001 to 100 dB and times from 0.02 ms to 1 s are compared in one window; what is beyond widens it. */
static void no_point_is_cut_off(void **state) {
    (void)state;
    static const struct {
        double db, s, error[2], time_ms[2];
    } cases[] = {{0.7, 0.02, {1e-3, 100.0}, {0.02, 1e3}},
                 {4e-5, 1.5, {1e-5, 100.0}, {0.02, 1e4}},
                 {130.0, 3e-6, {1e-3, 1e3}, {1e-3, 1e3}},
                 {0.0, 0.5, {1e-3, 100.0}, {0.02, 1e3}}};
    cli c = {.operand_count = 2};
    bench b = {.c = &c, .picture = "p.svg", .json = true};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        measured_db = cases[i].db;
        measured_s = cases[i].s;
        assert_int_equal(bench_error(&b), ASDIC_OK);
        for (int panel = 0; panel < 2; panel++) {
            assert_close_relative(drawn[panel].y.low, cases[i].error[0], 1e-12);
            assert_close_relative(drawn[panel].y.high, cases[i].error[1], 1e-12);
        }
        assert_close_relative(drawn[1].x.low, cases[i].time_ms[0], 1e-12);
        assert_close_relative(drawn[1].x.high, cases[i].time_ms[1], 1e-12);
    }
}

/* In log-log, where errors cross 1 dB for the last time; nowhere when they end above. */
static void one_decibel_is_crossed_last(void **state) {
    (void)state;
    const struct {
        double rms_db[4], rays, seconds;
    } cases[] = {{{3.0, 1.05, 1.05, 1.05}, NAN, NAN},
                 {{0.9, 0.8, 0.7, 0.6}, NAN, NAN},
                 {{8.0, 4.0, 0.5, 0.25}, 400.0 * pow(2.0, 2.0 / 3.0), 0.04 * pow(1.5, 2.0 / 3.0)},
                 {{4.0, 1.05, 1.05 / 8.0, 0.1}, /* log2(1.05) of three octaves */
                  400.0 * pow(2.0, log2(1.05) / 3.0),
                  0.04 * pow(1.5, log2(1.05) / 3.0)},
                 {{2.0, 0.5, 4.0, 0.25}, 800.0 * sqrt(2.0), 0.06 * sqrt(0.08 / 0.06)},
                 {{4.0, 2.0, 1.0, 0.5}, 800.0, 0.06}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        bench_curve curve = {.count = 4};
        for (size_t k = 0; k < 4; k++) {
            curve.points[k] = (bench_point){
                .rays = 200u << k, .ping_s = 0.02 * (double)(k + 1), .rms_db = cases[i].rms_db[k]};
        }
        bench_find_1db(&curve);
        if (isnan(cases[i].rays)) {
            assert_true(isnan(curve.rays_1db) && isnan(curve.seconds_1db));
        } else {
            assert_close_relative(curve.rays_1db, cases[i].rays, 1e-9);
            assert_close_relative(curve.seconds_1db, cases[i].seconds, 1e-9);
        }
    }
}

/* docs/accuracy.md: the mean of pings with 1e8 rays in all. */
static void references_have_the_rays_that_are_promised(void **state) {
    (void)state;
    const bench_effort whole = bench_effort_of(false);
    assert_close_relative((double)whole.reference_pings * whole.reference_rays, 1e8, 0.02);
}

/* 20 degrees across, as many to a steradian everywhere: half of them in its inner half, none to one side. */
static void rays_of_a_cone_fill_it(void **state) {
    (void)state;
    enum { RAYS = 4096 };
    static const float axes[][3] = {{1, 0, 0}, {0, 0.6f, 0.8f}, {0, 0, -1}, {-0.48f, 0.6f, 0.64f}};
    static asdic_ray rays[RAYS];
    const double edge = cos(10.0 * DEGREE);
    for (size_t i = 0; i < sizeof axes / sizeof *axes; i++) {
        bench_ray_scene s = {.from_m = {1, 2, 3}};
        double mean[3] = {0, 0, 0}, inner = 0.0;
        memcpy(s.towards, axes[i], sizeof s.towards);
        bench_rays_fill(BENCH_CONE, &s, rays, RAYS);
        for (size_t n = 0; n < RAYS; n++) {
            double cosine = 0.0;
            for (int k = 0; k < 3; k++) {
                cosine += (double)rays[n].direction[k] * (double)s.towards[k];
                mean[k] += (double)rays[n].direction[k] / RAYS;
            }
            assert_true(cosine > edge - 1e-6 && cosine < 1.0 + 1e-6);
            inner += cosine > 0.5 * (1.0 + edge);
        }
        for (int k = 0; k < 3; k++) { /* the middle of a cap is (1 + edge) / 2 along its axis */
            assert_close(mean[k], 0.5 * (1.0 + edge) * (double)s.towards[k], 1e-3);
        }
        assert_close(inner / RAYS, 0.5, 0.01);
    }
}

/* Bits of x, y and z in turn, the highest first (Morton 1966), of 16 each. */
static uint64_t order_of(const asdic_ray *ray) {
    uint64_t order = 0;
    for (int bit = 16; bit-- > 0;) {
        for (int k = 2; k >= 0; k--) {
            uint64_t cell = (uint64_t)((0.5 * (double)ray->direction[k] + 0.5) * 65535.0);
            order = order << 1 | (cell >> bit & 1);
        }
    }
    return order;
}

static void rays_have_an_order_of_directions(void **state) {
    (void)state;
    enum { RAYS = 4096 };
    static asdic_ray rays[RAYS];
    const bench_ray_scene s = {.towards = {0.48f, 0.6f, 0.64f}};
    for (int set = 0; set < BENCH_RAY_SETS; set++) {
        size_t steps_back = 0;
        bench_rays_fill((bench_ray_set)set, &s, rays, RAYS);
        for (size_t i = 1; i < RAYS; i++) {
            steps_back += order_of(&rays[i]) < order_of(&rays[i - 1]);
        }
        assert_true(set == BENCH_SPHERE_RANDOM ? steps_back > RAYS / 3 : steps_back == 0);
    }
}

/* 1 km to a side, rows of vertices from west to east, 200 m deep where the first ping is; h(0, 0) is the sum over k < 9
 * of 12 sin(k) / 2^k, from a geometric series. */
static void a_floor_is_a_square_kilometre(void **state) {
    (void)state;
    asdic_context *ctx;
    asdic_scene *scene;
    assert_int_equal(asdic_context_create(&ctx), ASDIC_OK);
    assert_int_equal(bench_terrain(ctx, 200, 1, &scene), ASDIC_OK);
    assert_int_equal(asdic_scene_get_info(scene).triangles, 200);
    double at_first = bench_height_m(-400.0, 0.0);
    for (int i = -5; i <= 5; i++) {
        for (int k = -5; k <= 5; k++) {
            double x = 99.9999 * i, y = 99.9999 * k; /* vertices, but for what meets no edge */
            double depth = asdic_scene_altitude_m(scene, (asdic_vec3){x, y, 0.0});
            assert_close(depth, 200.0 - bench_height_m(x, y) + at_first, 1e-3);
        }
    }
    for (int k = 0; k < 4; k++) {
        double x = k < 2 ? 501.0 - 1002.0 * k : 0.0, y = k < 2 ? 0.0 : 501.0 - 1002.0 * (k - 2);
        assert_false(isfinite(asdic_scene_altitude_m(scene, (asdic_vec3){x, y, 0.0})));
    }
    double half_9 = pow(0.5, 9.0), real = 1.0 - 0.5 * cos(1.0), imaginary = -0.5 * sin(1.0);
    double top_real = 1.0 - half_9 * cos(9.0), top_imaginary = -half_9 * sin(9.0);
    double sum =
        (top_imaginary * real - top_real * imaginary) / (real * real + imaginary * imaginary);
    assert_close(bench_height_m(0.0, 0.0), 12.0 * sum, 1e-9);
    asdic_scene_destroy(&scene);
    asdic_context_destroy(&ctx);
}

/* A mission learns once a block of pings. */
static void a_rate_is_told_as_measured(void **state) {
    (void)state;
    bench b = {.json = true};
    bench_rate rate = {.triangles = 2,
                       .beams = 3,
                       .bins = 4,
                       .rays = 5,
                       .units = 6,
                       .build_s = 7,
                       .create_s = 8,
                       .first_s = 9,
                       .ping_s = 0.25};
    const double want[] = {0, 2, 3, 4, 5, 6, 4, 2, 8, 9, 7, 10, 11, 12, 13, 14, 15, 16};
    rate.learn_s = 0.25 * ASDIC_LEARN_BLOCK;
    for (int p = 0; p < ASDIC_PHASE_COUNT; p++) {
        rate.phase_s[p] = 10 + p;
    }
    added_columns = sizeof *added / sizeof **added;
    added_rows = 0;
    bench_pings_add(&b, "floor", &rate);
    assert_int_equal(added_rows, 1);
    assert_string_equal(added[0][0].text, "floor");
    for (size_t i = 1; i < sizeof want / sizeof *want; i++) {
        assert_null(added[0][i].text);
        assert_close_relative(added[0][i].number, want[i], 1e-12);
    }
    size_t columns = 0;
    while (bench_pings_columns[columns].key) {
        columns++;
    }
    assert_int_equal(columns, sizeof want / sizeof *want);
}

static asdic_sampling sampling;
static uint64_t pings_shot;

asdic_sampling *__wrap_asdic_mission_sampling(asdic_mission *mission);
asdic_status __wrap_bench_scene_simulator(const bench *b, const bench_scene *s,
                                          const asdic_sampling *of, asdic_simulator **sim,
                                          asdic_ping **out);
asdic_status __wrap_asdic_simulator_learn(asdic_simulator *sim, const asdic_pose *pose,
                                          uint64_t index);
asdic_status __wrap_asdic_simulator_ping(asdic_simulator *sim, const asdic_pose *pose,
                                         uint64_t index, asdic_ping *out);

asdic_sampling *__wrap_asdic_mission_sampling(asdic_mission *mission) {
    (void)mission;
    return &sampling;
}

/* Errors are stated by the seed. */
asdic_status __wrap_bench_scene_simulator(const bench *b, const bench_scene *s,
                                          const asdic_sampling *of, asdic_simulator **sim,
                                          asdic_ping **out) {
    *sim = NULL;
    assert_int_equal(of->sampler, ASDIC_SAMPLER_ADAPTIVE);
    assert_int_equal(asdic_ping_create(cli_context(b->c), s->beams, s->bins, out), ASDIC_OK);
    for (size_t i = 0; i < s->bins; i++) {
        (*out)->stderr_db[i] = (float)(of->seed - 6);
    }
    return ASDIC_OK;
}

asdic_status __wrap_asdic_simulator_learn(asdic_simulator *sim, const asdic_pose *pose,
                                          uint64_t index) {
    (void)sim;
    (void)pose;
    assert_int_equal(index, 0);
    return ASDIC_OK;
}

/* A bin too near, one of objects 10 dB too high, one 10 dB too low, one of which half is, an empty one. */
asdic_status __wrap_asdic_simulator_ping(asdic_simulator *sim, const asdic_pose *pose,
                                         uint64_t index, asdic_ping *out) {
    static const double total[] = {50, 10, 0.1, 1, 0}, object[] = {50, 4, 0.03, 0.5, 0},
                        multipath[] = {0, 3, 0.03, 0, 0};
    (void)sim;
    (void)pose;
    assert_int_equal(index, pings_shot++ % 8);
    memcpy(out->intensity_lin[ASDIC_TOTAL], total, sizeof total);
    memcpy(out->intensity_lin[ASDIC_OBJECT], object, sizeof object);
    memcpy(out->intensity_lin[ASDIC_MULTIPATH], multipath, sizeof multipath);
    return ASDIC_OK;
}

/* Errors of 10, 10 and 0 dB beside 1, 2 and 3 dB by seed; the truth of the first bin is known to 10 lg(e) 0.1 dB. */
static void stated_errors_are_compared_with_true_ones(void **state) {
    (void)state;
    const double known2 = pow(1.0 / log(10.0), 2.0);
    cli c = {.operand_count = 2};
    bench b = {.c = &c, .json = true};
    double all = 0.0, objects = 0.0;
    assert_int_equal(asdic_context_create(&c.ctx), ASDIC_OK);
    sampling = (asdic_sampling){.rays = 77, .seed = 7};
    added_columns = 12;
    added_rows = pings_shot = 0;
    assert_int_equal(bench_honest(&b), ASDIC_OK);
    assert_int_equal(added_rows, 3);
    assert_int_equal(pings_shot, 3 * 8);
    for (int seed = 0; seed < 3; seed++) {
        double stated = 1.0 + seed,
               ruled = 100 / (stated * stated + known2) + 100 / (stated * stated);
        all += ruled / 9;
        objects += ruled / 6;
    }
    for (int seed = 0; seed < 3; seed++) {
        double stated = 1.0 + seed,
               ruled = 100 / (stated * stated + known2) + 100 / (stated * stated);
        int beyond = (100 > 25 * (stated * stated + known2)) + (100 > 25 * stated * stated);
        const double want[] = {0,
                               1,
                               5,
                               77,
                               seed,
                               sqrt(ruled / 3),
                               sqrt(all),
                               sqrt(objects),
                               beyond / 3.0,
                               sqrt(200.0 / 3),
                               stated,
                               0.25};
        assert_string_equal(added[seed][0].text, "scene 0");
        for (size_t i = 1; i < sizeof want / sizeof *want; i++) {
            assert_close(added[seed][i].number, want[i], 1e-9);
        }
    }
    asdic_context_destroy(&c.ctx);
}

void __real_bench_add(bench *b, const bench_cell *cells);

/* What two rows and a line say on the screen. */
static const char *shown_of(bench *b, const bench_cell rows[2][4]) {
    told_begin_on(stdout);
    __real_bench_add(b, rows[0]);
    __real_bench_add(b, rows[1]);
    bench_say(b, "%d rows\n", 2);
    return told_end();
}

/* Texts on the left, cut off at their column's end; numbers on the right, as the screen's unit has them. */
static void rows_are_shown_in_columns(void **state) {
    (void)state;
    const bench_column columns[] = {{"name", "scene", 6, 0, 0.0},
                                    {"hidden", NULL, 0, 0, 0.0},
                                    {"time_s", "ms", 8, 2, 1e3},
                                    {"n", "n", 3, 0, 0.0},
                                    {NULL, NULL, 0, 0, 0.0}};
    const bench_cell rows[2][4] = {
        {BENCH_TEXT("a long name"), BENCH_NUMBER(1), BENCH_NUMBER(0.0123456), BENCH_NUMBER(NAN)},
        {BENCH_TEXT("b"), BENCH_NUMBER(2), BENCH_NUMBER(-1), BENCH_NUMBER(41.6)}};
    bench b = {.table = bench_table_create(columns)};
    assert_non_null(b.table);
    assert_string_equal(shown_of(&b, rows), "scene        ms   n\n"
                                            "a long    12.35   -\n"
                                            "b      -1000.00  42\n"
                                            "2 rows\n");
    b.is_silent = true;
    assert_string_equal(shown_of(&b, rows), "");
    assert_true(bench_table_is_complete(b.table));
    bench_table_destroy(b.table);
}

/* For the linkers of kernels, unless somebody has other wishes. */
static void tunables_of_others_are_kept(void **state) {
    (void)state;
    setenv("GLIBC_TUNABLES", "glibc.malloc.check=1", 1);
    cli_heap_begin();
    assert_string_equal(getenv("GLIBC_TUNABLES"), "glibc.malloc.check=1");
    unsetenv("GLIBC_TUNABLES");
    cli_heap_begin();
    assert_contains(getenv("GLIBC_TUNABLES"), "glibc.malloc.hugetlb=1");
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(values_have_an_order),
        cmocka_unit_test(a_header_gives_the_order),
        cmocka_unit_test(objects_are_read),
        cmocka_unit_test(other_values_are_passed_over),
        cmocka_unit_test(lines_are_text),
        cmocka_unit_test(long_numbers_are_shown_short),
        cmocka_unit_test(the_nearest_word_is_meant),
        cmocka_unit_test(answers_are_json),
        cmocka_unit_test(answers_are_csv),
        cmocka_unit_test(answers_are_frames),
        cmocka_unit_test(a_rule_is_told_the_pose),
        cmocka_unit_test(a_rule_is_told_whole_lines),
        cmocka_unit_test(a_rule_without_a_process_ends_none),
        cmocka_unit_test(programs_of_rules_are_looked_for),
        cmocka_unit_test(times_have_decades),
        cmocka_unit_test(curves_have_their_colours_and_lines),
        cmocka_unit_test(no_point_is_cut_off),
        cmocka_unit_test(one_decibel_is_crossed_last),
        cmocka_unit_test(references_have_the_rays_that_are_promised),
        cmocka_unit_test(rays_of_a_cone_fill_it),
        cmocka_unit_test(rays_have_an_order_of_directions),
        cmocka_unit_test(a_floor_is_a_square_kilometre),
        cmocka_unit_test(a_rate_is_told_as_measured),
        cmocka_unit_test(stated_errors_are_compared_with_true_ones),
        cmocka_unit_test(rows_are_shown_in_columns),
        cmocka_unit_test(tunables_of_others_are_kept),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
