#include "columns.h"

#include "context.h"
#include "file_read.h"
#include "number.h"
#include "try.h"

#include <stdlib.h>
#include <string.h>

#define BYTES_MOST ((size_t)16 << 20)
#define COLUMNS_MOST 8

typedef struct columns_reader {
    asdic_context *ctx;
    const char *path, *columns;
    size_t width, fields[COLUMNS_MOST]; /* how many, and which field of a line each is */
    size_t field_count;                 /* of the header */
    size_t line;
    double *rows;
    size_t *lines;
    size_t count, capacity;
} columns_reader;

typedef struct span {
    const char *text;
    size_t length;
} span;

/* Field INDEX of LINE without blanks and quotes round it; text NULL: there is none. */
static span field(const char *line, size_t index) {
    for (; index > 0; index--) {
        line = strchr(line, ',');
        if (!line++) {
            return (span){NULL, 0};
        }
    }
    const char *end = line + strcspn(line, ",");
    while (line < end && strchr(" \t\"", *line)) {
        line++;
    }
    while (end > line && strchr(" \t\"\r", end[-1])) {
        end--;
    }
    return (span){line, (size_t)(end - line)};
}

static size_t count_fields(const char *line) {
    size_t count = 1;
    for (; *line; line++) {
        count += *line == ',';
    }
    return count;
}

static asdic_status read_header(columns_reader *r, const char *line) {
    const char *end = strchr(line, '\r');
    r->field_count = count_fields(line);
    if (end && end[strspn(end, "\r")]) {
        return asdic_fail(r->ctx, ASDIC_ERROR_INPUT,
                          "%s:%zu: lines end in carriage returns alone; they must in line feeds",
                          r->path, r->line);
    }
    if (r->field_count == 1 && strchr(line, ';')) {
        return asdic_fail(r->ctx, ASDIC_ERROR_INPUT,
                          "%s:%zu: columns are separated by semicolons; they must be by commas",
                          r->path, r->line);
    }
    for (span wanted = field(r->columns, 0); wanted.text; wanted = field(r->columns, ++r->width)) {
        size_t at = 0;
        span found = field(line, 0);
        while (found.text && (found.length != wanted.length ||
                              memcmp(found.text, wanted.text, wanted.length) != 0)) {
            found = field(line, ++at);
        }
        if (!found.text) {
            return asdic_fail(r->ctx, ASDIC_ERROR_INPUT,
                              "%s:%zu: missing column '%.*s'; the header is %s in any order",
                              r->path, r->line, (int)wanted.length, wanted.text, r->columns);
        }
        r->fields[r->width] = at;
    }
    return ASDIC_OK;
}

static asdic_status make_room(columns_reader *r) {
    if (r->count < r->capacity) {
        return ASDIC_OK;
    }
    size_t capacity = r->capacity ? 2 * r->capacity : 256;
    double *rows = realloc(r->rows, capacity * r->width * sizeof *rows);
    r->rows = rows ? rows : r->rows;
    size_t *lines = rows ? realloc(r->lines, capacity * sizeof *lines) : NULL;
    r->lines = lines ? lines : r->lines;
    if (!rows || !lines) {
        return asdic_fail_memory(r->ctx, r->path);
    }
    r->capacity = capacity;
    return ASDIC_OK;
}

static asdic_status read_row(columns_reader *r, const char *line) {
    size_t field_count = count_fields(line);
    TRY(make_room(r));
    if (field_count > r->field_count) { /* a decimal comma, perhaps */
        return asdic_fail(r->ctx, ASDIC_ERROR_INPUT, "%s:%zu: %zu fields, but the header has %zu",
                          r->path, r->line, field_count, r->field_count);
    }
    for (size_t i = 0; i < r->width; i++) {
        span name = field(r->columns, i), value = field(line, r->fields[i]);
        double *out = &r->rows[r->count * r->width + i];
        const char *why = !value.text         ? "is missing"
                          : value.length == 0 ? "is empty"
                                              : asdic_number_parse(value.text, value.length, out);
        if (why) {
            int shown = value.length > 40 ? 40 : (int)value.length;
            return asdic_fail(r->ctx, ASDIC_ERROR_INPUT, "%s:%zu: '%.*s'%s%.*s %s", r->path,
                              r->line, (int)name.length, name.text, shown ? " = " : "", shown,
                              value.text ? value.text : "", why);
        }
    }
    r->lines[r->count++] = r->line;
    return ASDIC_OK;
}

static asdic_status read_lines(columns_reader *r, char *text) {
    text += asdic_utf8_mark(text, strlen(text));
    for (char *line = text, *next; line; line = next) {
        next = strchr(line, '\n');
        if (next) {
            *next++ = '\0';
        }
        r->line++;
        if (line[strspn(line, " \t\r")] == '\0' || *line == '#') {
            continue;
        }
        TRY(r->width == 0 ? read_header(r, line) : read_row(r, line));
    }
    if (r->count == 0) {
        return asdic_fail(r->ctx, ASDIC_ERROR_INPUT, "%s: no rows of %s", r->path, r->columns);
    }
    return ASDIC_OK;
}

asdic_status asdic_columns_read(asdic_context *ctx, const char *path, const char *columns,
                                double **rows, size_t **lines, size_t *count) {
    columns_reader r = {.ctx = ctx, .path = path, .columns = columns};
    char *text = NULL;
    size_t bytes = 0;
    TRY(asdic_file_read(ctx, path, BYTES_MOST, &text, &bytes));
    asdic_status status =
        memchr(text, '\0', bytes)
            ? asdic_fail(ctx, ASDIC_ERROR_INPUT, "%s: not a text file: a zero byte", path)
            : read_lines(&r, text);
    free(text);
    if (status) {
        free(r.rows);
        free(r.lines);
        return status;
    }
    *rows = r.rows;
    *lines = r.lines;
    *count = r.count;
    return ASDIC_OK;
}
