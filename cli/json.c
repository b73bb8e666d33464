#include "json.h"

#include <asdic/common.h>

#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

json json_begin(FILE *out) {
    return (json){.out = out};
}

void json_string(FILE *out, const char *text) {
    const char *end = text + strlen(text);
    fputc('"', out);
    while (text < end) {
        size_t size = asdic_utf8_character(text, (size_t)(end - text));
        if (size == 0) {
            fputs("\\ufffd", out);
        } else if (*text == '"' || *text == '\\') {
            fprintf(out, "\\%c", *text);
        } else if ((unsigned char)*text < 0x20) {
            fprintf(out, "\\u%04x", (unsigned)*text);
        } else {
            fwrite(text, 1, size, out);
        }
        text += size ? size : 1;
    }
    fputc('"', out);
}

/* Writes comma, new line, indentation and key before a value. */
static void begin_value(json *j, const char *key) {
    if (j->depth > 0) {
        fputs(j->filled[j->depth] ? ",\n" : "\n", j->out);
        fprintf(j->out, "%*s", 2 * j->depth, "");
    }
    j->filled[j->depth] = true;
    if (key) {
        json_string(j->out, key);
        fputs(": ", j->out);
    }
}

void json_open(json *j, const char *key, char bracket) {
    begin_value(j, key);
    fputc(bracket, j->out);
    if (++j->depth >= JSON_DEPTH) {
        abort(); /* a command nests deeper than this file allows */
    }
    j->closing[j->depth] = bracket == '{' ? '}' : ']';
    j->filled[j->depth] = false;
}

void json_close(json *j) {
    bool filled = j->filled[j->depth];
    char closing = j->closing[j->depth--];
    if (filled) {
        fprintf(j->out, "\n%*s", 2 * j->depth, "");
    }
    fputc(closing, j->out);
    if (j->depth == 0) {
        fputc('\n', j->out);
    }
}

void json_text(json *j, const char *key, const char *value) {
    begin_value(j, key);
    if (value) {
        json_string(j->out, value);
    } else {
        fputs("null", j->out);
    }
}

void json_number(json *j, const char *key, double value) {
    begin_value(j, key);
    if (isfinite(value)) {
        fprintf(j->out, "%.17g", value);
    } else {
        fputs("null", j->out);
    }
}

void json_integer(json *j, const char *key, uint64_t value) {
    begin_value(j, key);
    fprintf(j->out, "%" PRIu64, value);
}

void json_bool(json *j, const char *key, bool value) {
    begin_value(j, key);
    fputs(value ? "true" : "false", j->out);
}
