#include "asserts.h"
#include "test_context.h"

#include "base/columns.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* Reads LENGTH bytes of TEXT as a file; its name becomes "F" in the error, which is "" when there is none. */
static size_t read_bytes(const char *text, size_t length, double **rows, size_t **lines,
                         char error[256]) {
    char path[] = "/tmp/asdic_columns_XXXXXX";
    int file = mkstemp(path);
    size_t count = 0;
    assert_true(file >= 0);
    assert_int_equal(write(file, text, length), (ssize_t)length);
    close(file);
    asdic_status status = asdic_columns_read(ctx, path, "deg,db", rows, lines, &count);
    const char *said = status ? asdic_context_error(ctx) : "";
    const char *named = strstr(said, path);
    snprintf(error, 256, "%s%s", named ? "F" : "", named ? named + strlen(path) : said);
    assert_int_equal(status, *said ? ASDIC_ERROR_INPUT : ASDIC_OK);
    unlink(path);
    return count;
}

static size_t read_text(const char *text, double **rows, size_t **lines, char error[256]) {
    return read_bytes(text, strlen(text), rows, lines, error);
}

static void columns_are_found_by_name(void **state) {
    (void)state;
    double *rows = NULL;
    size_t *lines = NULL;
    char error[256];
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
    char *text = malloc(40000), *at = text, error[256];
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
        {"", "F: no rows of deg,db"},
        {"deg,db\n", "F: no rows of deg,db"},
        {"deg;db\n5;-40\n", "F:1: columns are separated by semicolons; they must be by commas"},
        {"deg,db\r5,-40\r", "F:1: lines end in carriage returns alone; they must in line feeds"},
        {"deg,db\n5,-40,5\n", "F:2: 3 fields, but the header has 2"},
        {"# x\ndeg,level\n", "F:2: missing column 'db'; the header is deg,db in any order"},
        {"deg,db\n5\n", "F:2: 'db' is missing"},
        {"deg,db\n5,-40\n\n6, \n", "F:4: 'db' is empty"},
        {"deg,db\n5,-40x\n", "F:2: 'db' = -40x is not a number"},
        {"deg,db\nnan,-40\n", "F:2: 'deg' = nan is not a finite number"},
        {"deg,db\n5," FORTY "NO\n", "F:2: 'db' = " FORTY " is not a number"}, /* no more of it */
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        double *rows = NULL;
        size_t *lines = NULL;
        char error[256];
        read_text(cases[i][0], &rows, &lines, error);
        assert_string_equal(error, cases[i][1]);
        assert_null(rows);
        assert_null(lines);
    }
    static const char zero[] = "deg,db\n5,-40\n10,-3\0005\n";
    double *rows = NULL;
    size_t *lines = NULL;
    char error[256];
    read_bytes(zero, sizeof zero - 1, &rows, &lines, error);
    assert_string_equal(error, "F: not a text file: a zero byte");
}

static void spreadsheets_mark_what_they_write(void **state) {
    (void)state;
    double *rows = NULL;
    size_t *lines = NULL;
    char error[256];
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

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(columns_are_found_by_name),
        cmocka_unit_test(long_files_are_read),
        cmocka_unit_test(errors_name_file_and_line),
        cmocka_unit_test(spreadsheets_mark_what_they_write),
    };
    return cmocka_run_group_tests(tests, context_begin, context_end);
}
