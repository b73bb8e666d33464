/* Parts of the program without a device: poses from lines, words and numbers that are shown. */
#include "asserts.h"

#include "cli/cli_state.h"
#include "cli/progress.h"
#include "cli/serve.h"

#include <math.h>
#include <string.h>

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
    assert_bad("1,2,3,4,5,6", "7 values are expected: time_s,x_m");
    assert_bad("1,2,3,4,5,6,7,8", "more than 7 values");
    assert_bad("1,2,3,4,5,6,7,", "more than 7 values");
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
    assert_bad("7,1,fast", "4 values are expected by the header");
    assert_bad("7,1,fast,2,3", "more than 4 values are expected by the header");
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
    assert_bad("{\"a\":[1]}", "column 6: a number, string or word");
    assert_bad("{\"a\":\"b}", "column 6: a number, string or word");
    assert_bad("{\"x_m\":1 \"y_m\":2}", "column 10: a comma or }");
    assert_bad("{\"x_m\":1,}", "column 10: a name in double quotes");
    assert_bad("{\"x_m\":1} x", "column 11: the end of the line");
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
    } cases[] = {{0.0, "0 "},         {7.0, "7 "},         {999.0, "999 "},     {1000.0, "1.00 k"},
                 {9990.0, "9.99 k"},  {10000.0, "10.0 k"}, {99900.0, "99.9 k"}, {100000.0, "100 k"},
                 {999000.0, "999 k"}, {1e6, "1.00 M"},     {2.5e9, "2.50 G"},   {4e12, "4.00 T"},
                 {7.7e15, "7700 T"}};
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
                 {"r", "run"},
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

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(values_have_an_order),
        cmocka_unit_test(a_header_gives_the_order),
        cmocka_unit_test(objects_are_read),
        cmocka_unit_test(lines_are_text),
        cmocka_unit_test(long_numbers_are_shown_short),
        cmocka_unit_test(the_nearest_word_is_meant),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
