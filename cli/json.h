/*
 * JSON on a stream, written as it comes: containers nest, commas and indentation are kept here.
 *
 *     json j = json_begin(stdout);
 *     json_open(&j, NULL, '{');
 *     json_number(&j, "alpha_db_per_km", 36.1);
 *     json_open(&j, "beams", '[');   json_text(&j, NULL, "forward");   json_close(&j);
 *     json_close(&j);
 */
#ifndef ASDIC_CLI_JSON_H
#define ASDIC_CLI_JSON_H

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>

#define JSON_DEPTH 16

typedef struct json {
    FILE *out;
    int depth;
    char closing[JSON_DEPTH];
    bool filled[JSON_DEPTH]; /* something was written at this level */
} json;

json json_begin(FILE *out);

/* KEY is NULL inside an array and at the top. BRACKET is '{' or '['. */
void json_open(json *j, const char *key, char bracket);
void json_close(json *j); /* the innermost; the outermost ends the line */
void json_text(json *j, const char *key, const char *value); /* NULL: null */
void json_number(json *j, const char *key, double value);    /* null when not finite */
void json_integer(json *j, const char *key, uint64_t value);
void json_bool(json *j, const char *key, bool value);

/* TEXT in quotes, as JSON wants it; U+FFFD for each byte that is no text in UTF-8. */
void json_string(FILE *out, const char *text);

#endif
