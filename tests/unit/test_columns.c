#include "asserts.h"
#include "test_context.h"

#include "base/columns.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static const asdic_column items[] = {{"deg", -1e4, 1e4, "; a hint"}, {"db", -1e6, 60, NULL}};
static const asdic_columns deg_db = {items, 2, "more than", ", measured in spring"};

#define ERROR_ROOM 1024

/* Reads LENGTH bytes of TEXT as a file; ERROR becomes "LINE:COLUMN: MESSAGE\n" for each problem. */
static size_t read_bytes(const char *text, size_t length, double **rows, size_t **lines,
                         char error[ERROR_ROOM]) {
    char path[] = "/tmp/asdic_columns_XXXXXX";
    int file = mkstemp(path);
    size_t count = 0;
    asdic_problems problems = {.name = "scene"};
    assert_true(file >= 0);
    assert_int_equal(write(file, text, length), (ssize_t)length);
    close(file);
    assert_ok(ctx, asdic_columns_read(ctx, path, &deg_db, &problems, rows, lines, &count));
    error[0] = '\0';
    for (size_t i = 0; i < problems.count; i++) {
        const asdic_problem *p = &problems.items[i];
        size_t at = strlen(error);
        assert_ptr_equal(p->name, path);
        snprintf(error + at, ERROR_ROOM - at, "%u:%u: %s\n", p->line, p->column, p->message);
    }
    assert_string_equal(problems.name, "scene");
    asdic_problems_finish(&problems);
    unlink(path);
    return count;
}

static size_t read_text(const char *text, double **rows, size_t **lines, char error[ERROR_ROOM]) {
    return read_bytes(text, strlen(text), rows, lines, error);
}

static void columns_are_found_by_name(void **state) {
    (void)state;
    double *rows = NULL;
    size_t *lines = NULL;
    char error[ERROR_ROOM];
    size_t count =
        read_text("# measured in spring\n\n\"db\" , note, deg\r\n-40,a,5\r\n\n-3e1,,10\n", &rows,
                  &lines, error);
    assert_string_equal(error, "");
    assert_int_equal(count, 2);
    const double right[] = {5, -40, 10, -30};
    for (size_t i = 0; i < 4; i++) {
        assert_close(rows[i], right[i], 0);
    }
    assert_int_equal(lines[0], 4);
    assert_int_equal(lines[1], 6);
    free(rows);
    free(lines);
}

static void long_files_are_read(void **state) {
    (void)state;
    char *text = malloc(40000), *at = text, error[ERROR_ROOM];
    double *rows = NULL;
    size_t *lines = NULL;
    assert_non_null(text);
    at += sprintf(at, "deg,db\n");
    for (int i = 0; i < 3000; i++) {
        at += sprintf(at, "%d,%d\n", i, -i);
    }
    assert_int_equal(read_text(text, &rows, &lines, error), 3000);
    for (size_t i = 0; i < 3000; i++) {
        assert_close(rows[2 * i], (double)i, 0);
        assert_close(rows[2 * i + 1], -(double)i, 0);
    }
    free(rows);
    free(lines);
    free(text);
}

#define FORTY "abcdefghijklmnopqrstuvwxyz-ABCDEFGHIJKLM"

static void errors_name_file_and_line(void **state) {
    (void)state;
    static const char *const cases[][2] = {
        {"", "1:1: the file is empty; its header is deg,db\n"},
        {"deg,db\n", "2:1: no rows below the header\n"},
        {"deg;db\n5;-40\n", "1:1: columns are separated by semicolons; they must be by commas\n"},
        {"deg\tdb\n5\t-40\n", "1:1: columns are separated by tabs; they must be by commas\n"},
        {" deg  db\n5 -40\n", "1:1: columns are separated by blanks; they must be by commas\n"},
        {"5 -40\n", "1:1: columns are separated by blanks; they must be by commas\n"},
        {"a b\n",
         "1:1: none of the columns is known; the header is deg,db in any order, measured in "
         "spring\n"},
        {"deg,db\r5,-40\r", "1:1: lines end in carriage returns alone; they must in line feeds\n"},
        {"deg,db\n5,-40,5\n6\n", "2:1: 3 fields, but the header has 2\n"
                                 "3:1: 1 field, but the header has 2\n"},
        {"# x\ndeg,level\n", "2:1: missing column 'db'; the header is deg,db in any order\n"},
        {"degs,db\n", "1:1: missing column 'deg', perhaps 'degs'; the header is deg,db in any "
                      "order\n"},
        {"deg,db,deg\n", "1:8: column 'deg' is there twice\n"},
        {"a,b\n",
         "1:1: none of the columns is known; the header is deg,db in any order, measured in "
         "spring\n"},
        {"5,-40\n", "1:1: there is no header; the first line must be deg,db\n"},
        {"deg,db\n5,-40\n\n6, \n", "4:4: 'db' is empty\n"},
        {"deg,db\n5,-40x\nnan,-40\n6,7\n6,8\n5,61\n",
         "2:3: 'db' = -40x is not a number\n3:1: 'deg' = nan is not a finite number\n"
         "5:1: 'deg' = 6 is not more than 6 at line 4\n"
         "6:3: 'db' = 61 is out of range [-1000000, 60]\n"},
        {"deg,db\n-10001,\n",
         "2:1: 'deg' = -10001 is out of range [-10000, 10000]; a hint\n2:8: 'db' is empty\n"},
        {"deg,db\n10001,0\n", "2:1: 'deg' = 10001 is out of range [-10000, 10000]\n"},
        {"deg,db\n5," FORTY "NO\n", "2:3: 'db' = " FORTY " is not a number\n"}, /* no more of it */
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        double *rows = NULL;
        size_t *lines = NULL;
        char error[ERROR_ROOM];
        read_text(cases[i][0], &rows, &lines, error);
        assert_string_equal(error, cases[i][1]);
        assert_null(rows);
        assert_null(lines);
    }
    static const char zero[] = "deg,db\n5,-40\n10,-3\0005\n";
    double *rows = NULL;
    size_t *lines = NULL;
    char error[ERROR_ROOM];
    read_bytes(zero, sizeof zero - 1, &rows, &lines, error);
    assert_string_equal(error, "3:1: not a text file: a zero byte\n");
}

static void files_that_cannot_be_read_are_told_of(void **state) {
    (void)state;
    double row = 0.0, *rows = &row;
    size_t line = 0, *lines = &line, count = 1;
    asdic_problems problems = {.name = "scene"};
    assert_int_equal(
        asdic_columns_read(ctx, "/nonexistent/t.csv", &deg_db, &problems, &rows, &lines, &count),
        ASDIC_ERROR_INPUT);
    assert_string_equal(asdic_context_error(ctx),
                        "/nonexistent/t.csv: cannot open: No such file or directory");
    assert_int_equal(asdic_columns_read(ctx, "/tmp", &deg_db, &problems, &rows, &lines, &count),
                     ASDIC_ERROR_INPUT);
    assert_string_equal(asdic_context_error(ctx), "/tmp: cannot read: Is a directory");
    assert_null(rows);
    assert_null(lines);
    assert_int_equal(count, 0);
    assert_int_equal(problems.total, 0);
}

static void spreadsheets_mark_what_they_write(void **state) {
    (void)state;
    double *rows = NULL;
    size_t *lines = NULL;
    char error[ERROR_ROOM];
    assert_int_equal(read_text("\xef\xbb\xbf"
                               "deg,db\r\n5,-40\r\n",
                               &rows, &lines, error),
                     1);
    assert_string_equal(error, "");
    assert_close(rows[1], -40.0, 0);
    assert_int_equal(lines[0], 2);
    free(rows);
    free(lines);
}

/* For a caller who is told one thing: the first problem, and how many there are besides. */
static void problems_are_counted(void **state) {
    (void)state;
    static const char *const ends[] = {NULL, "s.csv:7: no number",
                                       "s.csv:7: no number; and 1 more error",
                                       "s.csv:7: no number; and 2 more errors"};
    for (unsigned count = 0; count < 4; count++) {
        asdic_problems problems = {.name = "s.csv"};
        for (unsigned k = 0; k < count; k++) {
            asdic_problems_add(&problems, 7 + k, 1, k == 0 ? "no number" : "too many");
        }
        assert_status(ctx, asdic_problems_fail(&problems, ctx),
                      count == 0 ? ASDIC_OK : ASDIC_ERROR_INPUT);
        if (count > 0) {
            assert_string_equal(asdic_context_error(ctx), ends[count]);
        }
        asdic_problems_finish(&problems);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(columns_are_found_by_name),
        cmocka_unit_test(long_files_are_read),
        cmocka_unit_test(errors_name_file_and_line),
        cmocka_unit_test(files_that_cannot_be_read_are_told_of),
        cmocka_unit_test(problems_are_counted),
        cmocka_unit_test(spreadsheets_mark_what_they_write),
    };
    return cmocka_run_group_tests(tests, context_begin, context_end);
}
