/*
 * Scene texts for tests: the example with an edit, and what the reader says about it.
 */
#ifndef ASDIC_TESTS_SCENE_TEXT_H
#define ASDIC_TESTS_SCENE_TEXT_H

#include "asserts.h"

#include "base/context.h"
#include "mission/scene_file/scene_file.h"

#include <stdio.h>
#include <stdlib.h>

/* The smallest scene there is; tests edit it. */
static const char MINIMAL[] = "version: 1\n"                       /* 1 */
                              "bottom: {depth_m: 12}\n"            /* 2 */
                              "sonar:\n"                           /* 3 */
                              "  frequency_khz: 100\n"             /* 4 */
                              "  receivers:\n"                     /* 5 */
                              "    - name: forward\n"              /* 6 */
                              "mission:\n"                         /* 7 */
                              "  pose: {position_m: [0, 0, 7]}\n"; /* 8 */

/* TEXT with the first FROM replaced by TO, to be freed; FROM must be there. */
static inline char *edited(const char *text, const char *from, const char *to) {
    const char *at = strstr(text, from);
    assert_non_null(at);
    asdic_text out = {0};
    asdic_text_add_bytes(&out, text, (size_t)(at - text));
    asdic_text_add(&out, to);
    asdic_text_add(&out, at + strlen(from));
    return asdic_text_take(&out);
}

static inline void collect_log(void *user, asdic_log_level level, const char *message) {
    (void)level;
    asdic_text_add(user, message);
    asdic_text_add(user, "\n");
}

/* Reads TEXT as "scene.yaml". Returns the errors, a line each, to be freed; the status and its
 * sentence are checked against their number. FILE (may be NULL) keeps what was read, in ARENA. */
static inline char *read_errors(const char *text, size_t size, asdic_arena *arena,
                                asdic_scene_file *file) {
    asdic_context *ctx = NULL;
    asdic_text log = {0};
    asdic_problems problems = {.name = "scene.yaml"};
    assert_int_equal(asdic_context_create(&ctx), ASDIC_OK);
    asdic_context_set_log(ctx, ASDIC_LOG_ERROR, collect_log, &log);
    assert_true(asdic_scene_file_parse(text, size, arena, &problems, file));
    asdic_status status = asdic_problems_report(&problems, ctx);
    char *errors = asdic_text_take(&log);
    size_t lines = 0;
    for (const char *c = errors; *c; c++) {
        lines += *c == '\n';
    }
    if (lines == 0) {
        assert_int_equal(status, ASDIC_OK);
    } else if (lines <= 100) {
        char sentence[64];
        snprintf(sentence, sizeof sentence, "scene.yaml: %zu error%s", lines,
                 lines == 1 ? "" : "s");
        assert_int_equal(status, ASDIC_ERROR_INPUT);
        assert_string_equal(asdic_context_error(ctx), sentence);
    }
    asdic_problems_finish(&problems);
    asdic_context_destroy(&ctx);
    return errors;
}

/* The errors of TEXT are exactly EXPECTED, lines with "scene.yaml:" taken off. */
static inline void expect_errors(const char *text, const char *expected) {
    asdic_arena arena = {0};
    asdic_scene_file file;
    char *errors = read_errors(text, strlen(text), &arena, &file);
    asdic_text plain = {0};
    asdic_text_add(&plain, "");
    for (const char *line = errors; *line; line = strchr(line, '\n') + 1) {
        assert_int_equal(strncmp(line, "scene.yaml:", 11), 0);
        asdic_text_add_bytes(&plain, line + 11, (size_t)(strchr(line, '\n') - line) - 10);
    }
    assert_string_equal(plain.data, expected);
    asdic_text_finish(&plain);
    free(errors);
    asdic_arena_finish(&arena);
}

/* The same for the minimal scene with FROM replaced by TO. */
static inline void expect_edit(const char *from, const char *to, const char *expected) {
    char *text = edited(MINIMAL, from, to);
    expect_errors(text, expected);
    free(text);
}

#endif
