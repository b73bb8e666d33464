/*
 * What a function writes to stderr.
 *
 *     told_begin();
 *     cli_error(&c, "no");
 *     assert_string_equal(told_end(), "error: no\n");
 */
#ifndef ASDIC_TEST_TOLD_H
#define ASDIC_TEST_TOLD_H

#include "asserts.h"

#include <stdlib.h>
#include <unistd.h>

static char told_text[8192];
static int told_fd = -1;
static FILE *told_file;

static void told_begin(void) {
    fflush(stderr);
    told_fd = dup(STDERR_FILENO);
    told_file = tmpfile();
    assert_non_null(told_file);
    dup2(fileno(told_file), STDERR_FILENO);
}

static const char *told_end(void) {
    fflush(stderr);
    dup2(told_fd, STDERR_FILENO);
    close(told_fd);
    rewind(told_file);
    size_t length = fread(told_text, 1, sizeof told_text - 1, told_file);
    told_text[length] = '\0';
    fclose(told_file);
    return told_text;
}

#endif
