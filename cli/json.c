#include "json.h"

#include <inttypes.h>
#include <math.h>
#include <stdlib.h>

json json_begin(FILE *out) {
    return (json){.out = out};
}

static void print_string(FILE *out, const char *text) {
    fputc('"', out);
    for (const unsigned char *p = (const unsigned char *)text; *p; p++) {
        if (*p == '"' || *p == '\\') {
            fprintf(out, "\\%c", *p);
        } else if (*p < 0x20) {
            fprintf(out, "\\u%04x", *p);
        } else {
            fputc(*p, out);
        }
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
        print_string(j->out, key);
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
        print_string(j->out, value);
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
