/* A scene file as JSON: for whoever goes on from one in a program of their own. */
#include "mission_build.h"

#include "base/context.h"
#include "base/file_read.h"
#include "base/number.h"
#include "base/text.h"
#include "base/try.h"
#include "out/digits.h"

#include <stdlib.h>
#include <string.h>
#include <strings.h>

/* Whether TEXT is a whole number as JSON writes it: without zeros before it. */
static bool is_whole(const char *text) {
    text += *text == '-';
    size_t digits = strspn(text, "0123456789");
    return digits > 0 && !text[digits] && (digits == 1 || *text != '0');
}

/* What a plain word says in YAML 1.1 and JSON has a word for; NULL: text. */
static const char *word_of(const asdic_yaml_node *node) {
    static const char *const words[][2] = {{"", "null"},    {"true", "true"}, {"yes", "true"},
                                           {"on", "true"},  {"y", "true"},    {"false", "false"},
                                           {"no", "false"}, {"off", "false"}, {"n", "false"}};
    for (size_t i = 0; i < sizeof words / sizeof *words; i++) {
        if (strcasecmp(node->text, words[i][0]) == 0) {
            return words[i][1];
        }
    }
    return NULL;
}

/* Whether NODE is a name, or that of a file: text, even where it reads as a word or a number. */
static bool is_name(const asdic_yaml_node *node) {
    static const char *const keys[] = {
        "name", "file", "track", "curve", "grid", "mesh", "sound_speed_profile"};
    for (size_t i = 0; node->key && node->text[0] && i < sizeof keys / sizeof *keys; i++) {
        if (strcmp(node->key, keys[i]) == 0) {
            return true;
        }
    }
    return false;
}

static void print_scalar(const asdic_yaml_node *node, asdic_text *text) {
    char digits[ASDIC_DIGITS_SIZE];
    double value;
    bool is_text = node->quoted || is_name(node);
    const char *word = is_text ? NULL : word_of(node);
    if (word) {
        asdic_text_add(text, word);
    } else if (!is_text && is_whole(node->text)) {
        asdic_text_add(text, node->text);
    } else if (!is_text && !asdic_number_parse(node->text, node->length, &value)) {
        asdic_text_add_bytes(text, digits, asdic_digits_double(digits, value));
    } else {
        asdic_text_add_json(text, node->text);
    }
}

static asdic_status print_file(asdic_context *ctx, const char *path, asdic_arena *arena,
                               asdic_problems *problems, asdic_text *out) {
    char *bytes = NULL;
    size_t size = 0, length = 0;
    asdic_yaml_node *root = NULL;
    TRY(asdic_file_read_piped(ctx, path, ASDIC_MOST_SCENE_BYTES, &bytes, &size));
    char *text = asdic_text_to_utf8(bytes, size, &length);
    free(bytes);
    bool has_memory = text && asdic_yaml_read(text, length, arena, problems, &root);
    asdic_status status =
        has_memory ? asdic_problems_report(problems, ctx) : asdic_fail_memory(ctx, "a scene");
    if (!status) {
        asdic_yaml_print_flow(root, true, print_scalar, out);
    }
    free(text);
    return status;
}

asdic_status asdic_mission_file_json(asdic_context *ctx, const char *path, char **out) {
    if (!ASDIC_PLACE(out) || !path) {
        return asdic_fail_null(ctx, __func__);
    }
    asdic_arena arena = {0};
    asdic_problems problems = {.name = path};
    asdic_text text = {0};
    asdic_status status = print_file(ctx, path, &arena, &problems, &text);
    asdic_problems_finish(&problems);
    asdic_arena_finish(&arena);
    *out = asdic_text_take(&text);
    if (!status && !*out) {
        status = asdic_fail_memory(ctx, "a scene");
    }
    if (status) {
        free(*out);
        *out = NULL;
    }
    return status;
}
