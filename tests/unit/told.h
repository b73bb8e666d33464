/*
 * What a function writes to stderr, or to another stream of the system.
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
static FILE *told_file, *told_stream;

static inline void told_begin_on(FILE *stream) {
    fflush(stream);
    told_stream = stream;
    told_fd = dup(fileno(stream));
    told_file = tmpfile();
    assert_non_null(told_file);
    dup2(fileno(told_file), fileno(stream));
}

static inline void told_begin(void) {
    told_begin_on(stderr);
}

static const char *told_end(void) {
    fflush(told_stream);
    dup2(told_fd, fileno(told_stream));
    close(told_fd);
    rewind(told_file);
    size_t length = fread(told_text, 1, sizeof told_text - 1, told_file);
    told_text[length] = '\0';
    fclose(told_file);
    return told_text;
}

#endif
