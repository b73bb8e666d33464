/*
 * Tracks: what is refused with which words, and what lies between two points.
 */
#include "asserts.h"

#include "base/context.h"
#include "base/text.h"
#include "mission/track/track.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

#define HEADER "time_s,x_m,y_m,z_m,roll_deg,pitch_deg,yaw_deg\n"
#define DEG (3.14159265358979323846 / 180.0)

static void collect(void *user, asdic_log_level level, const char *message) {
    (void)level;
    asdic_text_add(user, message);
    asdic_text_add(user, "\n");
}

/* Loads SIZE bytes of CSV as a file; EXPECTED are the logged errors with the file's name as F. */
static asdic_track *load_bytes(const char *csv, size_t size, const char *expected) {
    char path[] = "/tmp/asdic-track-XXXXXX";
    int fd = mkstemp(path);
    assert_true(fd >= 0);
    assert_int_equal(write(fd, csv, size), (ssize_t)size);
    close(fd);
    asdic_context *ctx = NULL;
    asdic_text log = {0}, plain = {0};
    asdic_track *track = NULL;
    assert_int_equal(asdic_context_create(&ctx), ASDIC_OK);
    asdic_context_set_log(ctx, ASDIC_LOG_ERROR, collect, &log);
    asdic_problems problems = {.name = path};
    assert_int_equal(asdic_track_load(ctx, path, true, &problems, &track), ASDIC_OK);
    asdic_status status = asdic_problems_report(&problems, ctx);
    asdic_problems_finish(&problems);
    unlink(path);
    asdic_text_add(&plain, "");
    for (const char *at = log.data; at && *at;) {
        bool name = strncmp(at, path, strlen(path)) == 0;
        asdic_text_add_bytes(&plain, name ? "F" : at, 1);
        at += name ? strlen(path) : 1;
    }
    assert_string_equal(plain.data, expected);
    assert_int_equal(status, *expected ? ASDIC_ERROR_INPUT : ASDIC_OK);
    assert_int_equal(track != NULL, *expected == '\0');
    asdic_text_finish(&log);
    asdic_text_finish(&plain);
    asdic_context_destroy(&ctx);
    return track;
}

static asdic_track *load(const char *csv, const char *expected) {
    return load_bytes(csv, strlen(csv), expected);
}

static void points_are_joined_by_straight_lines(void **state) {
    (void)state;
    asdic_track *track = load(HEADER "10,0,0,5,0,0,0\n"
                                     "12,4,-2,7,10,-20,90\n",
                              "");
    assert_int_equal(asdic_track_point_count(track), 2);
    assert_close(asdic_track_start_s(track), 10, 0);
    assert_close(asdic_track_end_s(track), 12, 0);
    asdic_pose pose = asdic_track_pose(track, 10.5);
    assert_close(pose.position_m.x, 1, 1e-15);
    assert_close(pose.position_m.y, -0.5, 1e-15);
    assert_close(pose.position_m.z, 5.5, 1e-15);
    assert_close(pose.roll_rad, 2.5 * DEG, 1e-15);
    assert_close(pose.pitch_rad, -5 * DEG, 1e-15);
    assert_close(pose.yaw_rad, 22.5 * DEG, 1e-15);
    assert_close(asdic_track_pose(track, 0).position_m.x, 0, 0);
    assert_close(asdic_track_pose(track, 99).position_m.x, 4, 0);
    asdic_track_destroy(&track);
    assert_null(track);
}

static void angles_take_the_shorter_way(void **state) {
    (void)state;
    const struct {
        double from, to, middle;
    } cases[] = {{350, 10, 0}, {10, 350, 0}, {-170, 170, 180}, {90, -90, 0}, {0, 720, 0}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char csv[256];
        snprintf(csv, sizeof csv, HEADER "0,0,0,5,%g,0,%g\n1,0,0,5,%g,0,%g\n", cases[i].from,
                 cases[i].from, cases[i].to, cases[i].to);
        asdic_track *track = load(csv, "");
        asdic_pose pose = asdic_track_pose(track, 0.5);
        if (i != 3) { /* half a turn has two shorter ways */
            assert_close(cos(pose.yaw_rad), cos(cases[i].middle * DEG), 1e-12);
            assert_close(sin(pose.yaw_rad), sin(cases[i].middle * DEG), 1e-12);
            assert_close(cos(pose.roll_rad), cos(cases[i].middle * DEG), 1e-12);
        }
        assert_true(isfinite(pose.yaw_rad));
        asdic_track_destroy(&track);
    }
}

static void columns_come_in_any_order(void **state) {
    (void)state;
    asdic_track *track =
        load("\xef\xbb\xbf\"yaw_deg\", note ,z_m,time_s,x_m,y_m,pitch_deg,roll_deg\r\n"
             "90,deep,5,0,1,2,3,4\r\n"
             "\r\n"
             "91,\"\",6,1,1,2,3,4",
             "");
    assert_int_equal(asdic_track_point_count(track), 2);
    asdic_pose pose = asdic_track_pose(track, 0);
    assert_close(pose.position_m.x, 1, 0);
    assert_close(pose.position_m.y, 2, 0);
    assert_close(pose.position_m.z, 5, 0);
    assert_close(pose.roll_rad, 4 * DEG, 1e-15);
    assert_close(pose.pitch_rad, 3 * DEG, 1e-15);
    assert_close(pose.yaw_rad, 90 * DEG, 1e-15);
    asdic_track_destroy(&track);
}

static void headers_are_checked(void **state) {
    (void)state;
    load("", "F:1:1: error: the file is empty; its header is "
             "time_s,x_m,y_m,z_m,roll_deg,pitch_deg,yaw_deg\n");
    load(HEADER, "F:2:1: error: no rows below the header\n");
    load("time_s,x_m,y_m,z_m,roll_deg,yaw_dge,x_m\n0,0,0,0,0,0,0\n",
         "F:1:1: error: missing column 'pitch_deg'; the header is "
         "time_s,x_m,y_m,z_m,roll_deg,pitch_deg,yaw_deg in any order\n"
         "F:1:1: error: missing column 'yaw_deg', perhaps 'yaw_dge'; the header is "
         "time_s,x_m,y_m,z_m,roll_deg,pitch_deg,yaw_deg in any order\n"
         "F:1:37: error: column 'x_m' is there twice\n");
    load("time_s,x_m,y_m,z_m,roll_rad,pitch_rad,yaw_rad\n0,0,0,0,0,0,0\n",
         "F:1:1: error: missing column 'roll_deg', perhaps 'roll_rad'; the header is "
         "time_s,x_m,y_m,z_m,roll_deg,pitch_deg,yaw_deg in any order\n"
         "F:1:1: error: missing column 'pitch_deg', perhaps 'pitch_rad'; the header is "
         "time_s,x_m,y_m,z_m,roll_deg,pitch_deg,yaw_deg in any order\n"
         "F:1:1: error: missing column 'yaw_deg', perhaps 'yaw_rad'; the header is "
         "time_s,x_m,y_m,z_m,roll_deg,pitch_deg,yaw_deg in any order\n");
    load("0,0,0,5,0,0,0\n1,0,0,5,0,0,0\n",
         "F:1:1: error: there is no header; the first line must be "
         "time_s,x_m,y_m,z_m,roll_deg,pitch_deg,yaw_deg\n");
    load("time,lat,lon,depth,heading\n0,54.1,7.2,5,0\n",
         "F:1:1: error: none of the columns is known; the header is "
         "time_s,x_m,y_m,z_m,roll_deg,pitch_deg,yaw_deg in any order, in metres north, east and "
         "down\n");
    load("time_s;x_m;y_m;z_m;roll_deg;pitch_deg;yaw_deg\n0;0;0;0;0;0;0\n",
         "F:1:1: error: columns are separated by semicolons; they must be by commas\n");
    load("time_s,x_m,y_m,z_m,roll_deg,pitch_deg,yaw_deg\r0,0,0,0,0,0,0\r",
         "F:1:1: error: lines end in carriage returns alone; they must in line feeds\n");
}

/* 7 columns of a track and EXTRA more, of two points 3 m apart. */
static asdic_track *load_wide(size_t extra, const char *expected) {
    asdic_text csv = {0};
    asdic_text_add(&csv, "time_s,x_m,y_m,z_m,roll_deg,pitch_deg,yaw_deg");
    for (size_t i = 0; i < extra; i++) {
        asdic_text_format(&csv, ",extra%zu", i);
    }
    for (int row = 0; row < 2; row++) {
        asdic_text_format(&csv, "\n%d,%d,0,5,0,0,0", row, 3 * row);
        for (size_t i = 0; i < extra; i++) {
            asdic_text_add(&csv, ",1");
        }
    }
    asdic_text_add(&csv, "\n");
    asdic_track *track = load_bytes(csv.data, csv.length, expected);
    asdic_text_finish(&csv);
    return track;
}

static void files_have_256_columns_at_most(void **state) {
    (void)state;
    asdic_track *track = load_wide(249, "");
    assert_close(asdic_track_pose(track, 1.0).position_m.x, 3, 0);
    asdic_track_destroy(&track);
    assert_null(load_wide(250, "F:1:1: error: 257 columns, at most 256 are possible\n"));
}

#define FORTY "1234567890123456789012345678901234567890"
#define SMALL "-0.0000000000000000000000000000000000000"

static void every_bad_row_is_named(void **state) {
    (void)state;
    load(HEADER "0,0,0,5,0,0,0\n"
                "1,0,0,5,0,0\n"
                "2,abc,0,5,0,0,nan\n"
                "0,0,0,5,0,0,0\n"
                "3,0,0,-1,0,0,\n"
                "4,0,0,5,0,1e7,0\n"
                "5,0,0,0x5,0,0,0\n",
         "F:3:1: error: 6 fields, but the header has 7\n"
         "F:4:3: error: 'x_m' = abc is not a number\n"
         "F:4:15: error: 'yaw_deg' = nan is not a finite number\n"
         "F:5:1: error: 'time_s' = 0 is not later than 0 at line 2\n"
         "F:6:7: error: 'z_m' = -1 is out of range [0, 11000]; z is positive down\n"
         "F:6:14: error: 'yaw_deg' is empty\n"
         "F:7:11: error: 'pitch_deg' = 1e7 is out of range [-1000000, 1000000]\n"
         "F:8:7: error: 'z_m' = 0x5 is not a number\n");
    /* Of long values the first forty characters. */
    load(HEADER "0,0,0,5,0,0,0\n"
                "1," FORTY "00,0,5,0,0,0\n"
                "2,0," FORTY "x,5,0,0,0\n" SMALL "12,0,0,5,0,0,0\n",
         "F:3:3: error: 'x_m' = " FORTY " is out of range [-10000000, 10000000]\n"
         "F:4:5: error: 'y_m' = " FORTY " is not a number\n"
         "F:5:1: error: 'time_s' = " SMALL " is not later than 0 at line 2\n");
    load_bytes(HEADER "0,0,0,5,0,\0,0\n", sizeof HEADER "0,0,0,5,0,\0,0\n" - 1,
               "F:2:1: error: not a text file: a zero byte\n");
}

/* What each column holds at most, and what is told of the next float beyond: coordinates as UTM's,
 * times of any clock, depths of any sea, turns of any number. */
static void columns_reach_as_far_as_they_say(void **state) {
    (void)state;
    const struct {
        const char *name;
        double low, high;
        const char *hint;
    } columns[] = {{"time_s", -1e12, 1e12, ""}, {"x_m", -1e7, 1e7, ""},
                   {"y_m", -1e7, 1e7, ""},      {"z_m", 0, 11000, "; z is positive down"},
                   {"roll_deg", -1e6, 1e6, ""}, {"pitch_deg", -1e6, 1e6, ""},
                   {"yaw_deg", -1e6, 1e6, ""}};
    for (size_t c = 0; c < 7; c++) {
        for (int beyond = 0; beyond < 4; beyond++) {
            char csv[256] = HEADER, expected[160] = "";
            double bound = beyond & 2 ? columns[c].high : columns[c].low;
            double value =
                beyond & 1 ? nextafterf((float)bound, beyond & 2 ? INFINITY : -INFINITY) : bound;
            for (size_t k = 0; k < 7; k++) {
                size_t at = strlen(csv);
                snprintf(csv + at, sizeof csv - at, "%.17g%s", k == c ? value : 0.0,
                         k < 6 ? "," : "\n");
            }
            if (beyond & 1) {
                snprintf(expected, sizeof expected,
                         "F:2:%zu: error: '%s' = %.17g is out of range [%.15g, %.15g]%s\n",
                         2 * c + 1, columns[c].name, value, columns[c].low, columns[c].high,
                         beyond & 2 ? "" : columns[c].hint);
            }
            asdic_track *track = load(csv, expected);
            asdic_track_destroy(&track);
        }
    }
}

static void missing_files_are_named(void **state) {
    (void)state;
    asdic_context *ctx = NULL;
    asdic_track *track = NULL;
    asdic_problems problems = {.name = "scene"};
    assert_int_equal(asdic_context_create(&ctx), ASDIC_OK);
    assert_int_equal(asdic_track_load(ctx, "/nonexistent/t.csv", true, &problems, &track),
                     ASDIC_ERROR_INPUT);
    assert_string_equal(asdic_context_error(ctx),
                        "/nonexistent/t.csv: cannot open: No such file or directory");
    assert_int_equal(problems.total, 0);
    assert_null(track);
    asdic_context_destroy(&ctx);
}

static void long_tracks_are_read(void **state) {
    (void)state;
    asdic_text csv = {0};
    asdic_text_add(&csv, HEADER);
    for (int i = 0; i < 100000; i++) {
        asdic_text_format(&csv, "%d.%d,%d,0,5,0,0,%d\n", i / 10, i % 10, i, i % 360);
    }
    asdic_track *track = load(csv.data, "");
    assert_int_equal(asdic_track_point_count(track), 100000);
    for (int i = 0; i < 100000; i += 777) {
        assert_close(asdic_track_pose(track, i / 10.0).position_m.x, i, 1e-6);
    }
    assert_close(asdic_track_pose(track, 1234.55).position_m.x, 12345.5, 1e-6);
    asdic_track_destroy(&track);
    asdic_text_finish(&csv);
}

static void tracks_have_several_holders(void **state) {
    (void)state;
    asdic_track *track = load(HEADER "0,0,0,5,0,0,0\n1,1,0,6,0,0,0\n", "");
    asdic_track *other = asdic_track_share(track);
    asdic_track_destroy(&track);
    assert_null(track);
    assert_close(asdic_track_pose(other, 1.0).position_m.x, 1.0, 0.0);
    asdic_track_destroy(&other);
}

static void the_deepest_place_may_lie_between_points(void **state) {
    (void)state;
    asdic_track *track =
        load(HEADER "0,0,0,5,0,0,0\n1,0,0,7,0,0,0\n2,0,0,6,0,0,0\n4,0,0,10,0,0,0\n", "");
    assert_close(asdic_track_deepest_m(track, 0.0), 5.0, 0.0);
    assert_close(asdic_track_deepest_m(track, 0.5), 6.0, 1e-12);
    assert_close(asdic_track_deepest_m(track, 2.0), 7.0, 0.0);
    assert_close(asdic_track_deepest_m(track, 3.0), 8.0, 1e-12);
    assert_close(asdic_track_deepest_m(track, 9.0), 10.0, 0.0);
    asdic_track_destroy(&track);
}

/* Angles stay in the range of the track's: what is written of a turn through north has no jump but that one. */
static void angles_stay_in_the_tracks_range(void **state) {
    (void)state;
    static const struct {
        double from, early, late, to;
    } cases[] = {{350, 355, 5, 10},
                 {10, 5, 355, 350},
                 {170, 175, -175, -170},
                 {-170, -175, 175, 170},
                 {180, -177.5, -172.5, -170},
                 {360, 2.5, 7.5, 10},
                 {20, 25, 35, 40},
                 {-20, -5, 25, 40},
                 {350, 355, 365, 370},
                 {-190, -182.5, -167.5, -160}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char csv[256];
        snprintf(csv, sizeof csv, HEADER "0,0,0,5,%g,0,%g\n4,0,0,5,%g,0,%g\n", cases[i].from,
                 cases[i].from, cases[i].to, cases[i].to);
        asdic_track *track = load(csv, "");
        const double time_s[] = {0.0, 1.0, 3.0, 4.0};
        const double wanted_deg[] = {cases[i].from, cases[i].early, cases[i].late, cases[i].to};
        for (int k = 0; k < 4; k++) {
            asdic_pose pose = asdic_track_pose(track, time_s[k]);
            assert_close(pose.yaw_rad, wanted_deg[k] * DEG, 1e-12);
            assert_close(pose.roll_rad, wanted_deg[k] * DEG, 1e-12);
        }
        asdic_track_destroy(&track);
    }
}

/* What a file holds of an angle is read as that angle; none is -0. */
static void angles_are_whole_nanodegrees(void **state) {
    (void)state;
    assert_true(asdic_track_round(12.3456789012345 * DEG) == 12.345678901 * DEG);
    assert_true(asdic_track_round(-179.9999999996 * DEG) == -180.0 * DEG);
    assert_false(signbit(asdic_track_round(-0.0)));
    assert_false(signbit(asdic_track_round(-1e-12)));
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(points_are_joined_by_straight_lines),
        cmocka_unit_test(angles_take_the_shorter_way),
        cmocka_unit_test(columns_come_in_any_order),
        cmocka_unit_test(headers_are_checked),
        cmocka_unit_test(files_have_256_columns_at_most),
        cmocka_unit_test(every_bad_row_is_named),
        cmocka_unit_test(columns_reach_as_far_as_they_say),
        cmocka_unit_test(missing_files_are_named),
        cmocka_unit_test(long_tracks_are_read),
        cmocka_unit_test(tracks_have_several_holders),
        cmocka_unit_test(the_deepest_place_may_lie_between_points),
        cmocka_unit_test(angles_stay_in_the_tracks_range),
        cmocka_unit_test(angles_are_whole_nanodegrees),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
