#include "columns.h"

#include "context.h"
#include "file_read.h"
#include "grow.h"
#include "number.h"
#include "try.h"
#include "words.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define BYTES_MOST ((size_t)1 << 30)
#define FIELDS_MOST 256
#define SHOWN_MOST 40 /* characters of a value that an error repeats */

typedef struct columns_reader {
    const asdic_columns *columns;
    asdic_problems *problems;
    char header[ASDIC_COLUMNS_MOST * 32]; /* as it should be */
    size_t place[ASDIC_COLUMNS_MOST];     /* the field that holds each column */
    size_t field_count;                   /* of the header; 0: not met yet */
    unsigned line;
    double *rows;
    size_t *lines;
    size_t count, capacity;
} columns_reader;

/* A field without the blanks and quotes round it. */
typedef struct field {
    const char *text;
    size_t length;
    unsigned column; /* from 1 */
} field;

/* Cuts LINE at its commas; returns the number of fields, of which at most FIELDS_MOST are kept. */
static size_t split(const char *line, field *fields) {
    size_t count = 0;
    for (const char *at = line;; at++) {
        const char *end = at + strcspn(at, ",");
        const char *from = at, *to = end;
        while (from < to && strchr(" \t\"", *from)) {
            from++;
        }
        while (to > from && strchr(" \t\"", to[-1])) {
            to--;
        }
        if (count < FIELDS_MOST) {
            fields[count] = (field){from, (size_t)(to - from), (unsigned)(from - line) + 1};
        }
        count++;
        at = end;
        if (*at == '\0') {
            return count;
        }
    }
}

static int shown(const field *f) {
    return f->length > SHOWN_MOST ? SHOWN_MOST : (int)f->length;
}

/* --- the header ------------------------------------------------------------------------------- */

static bool is_column(const field *f, const char *name) {
    return strlen(name) == f->length && memcmp(name, f->text, f->length) == 0;
}

static bool is_wanted(const columns_reader *r, const field *f) {
    for (size_t c = 0; c < r->columns->count; c++) {
        if (is_column(f, r->columns->items[c].name)) {
            return true;
        }
    }
    return false;
}

static void report_missing(columns_reader *r, const char *name, const field *fields) {
    char words[FIELDS_MOST][32];
    const char *others[FIELDS_MOST];
    size_t count = 0;
    for (size_t i = 0; i < r->field_count; i++) {
        if (!is_wanted(r, &fields[i])) {
            snprintf(words[i], sizeof words[i], "%.*s", (int)fields[i].length, fields[i].text);
            others[count++] = words[i];
        }
    }
    size_t nearest = asdic_words_nearest(name, others, count);
    const char *unit = strrchr(name, '_'); /* of "roll_deg", which may be there as "roll_rad" */
    for (size_t i = 0; i < count && nearest == count && unit; i++) {
        nearest = strncmp(others[i], name, (size_t)(unit - name) + 1) == 0 ? i : count;
    }
    bool found = nearest < count;
    asdic_problems_add(
        r->problems, r->line, 1, "missing column '%s'%s%s%s; the header is %s in any order", name,
        found ? ", perhaps '" : "", found ? others[nearest] : "", found ? "'" : "", r->header);
}

/* Where COLUMN stands in the header. */
static void find_column(columns_reader *r, size_t column, const field *fields) {
    const char *name = r->columns->items[column].name;
    size_t found = 0;
    for (size_t i = 0; i < r->field_count; i++) {
        if (!is_column(&fields[i], name)) {
            continue;
        }
        if (found++) {
            asdic_problems_add(r->problems, r->line, fields[i].column, "column '%s' is there twice",
                               name);
        }
        r->place[column] = i;
    }
    if (found == 0) {
        report_missing(r, name, fields);
    }
}

static void report_strange(columns_reader *r, const field *first) {
    double value;
    if (!asdic_number_parse(first->text, first->length, &value)) {
        asdic_problems_add(r->problems, r->line, 1, "there is no header; the first line must be %s",
                           r->header);
    } else {
        asdic_problems_add(r->problems, r->line, 1,
                           "none of the columns is known; the header is %s in any order%s",
                           r->header, r->columns->about);
    }
}

/* What other tables have between columns, where the only field ALL holds several; NULL: nothing. */
static const char *separator_of(const columns_reader *r, const field *all) {
    field first = *all;
    double value;
    first.length = strcspn(all->text, "; \t\"\r");
    if (memchr(all->text, ';', all->length)) {
        return "semicolons";
    }
    bool is_table = first.length < all->length &&
                    (is_wanted(r, &first) || !asdic_number_parse(first.text, first.length, &value));
    return !is_table ? NULL : memchr(all->text, '\t', all->length) ? "tabs" : "blanks";
}

static void read_header(columns_reader *r, const char *line) {
    field fields[FIELDS_MOST];
    bool any = false;
    r->field_count = split(line, fields);
    if (strchr(line, '\r')) {
        asdic_problems_add(r->problems, r->line, 1,
                           "lines end in carriage returns alone; they must in line feeds");
        return;
    }
    if (r->field_count > FIELDS_MOST) {
        asdic_problems_add(r->problems, r->line, 1, "%zu columns, at most %d are possible",
                           r->field_count, FIELDS_MOST);
        return;
    }
    if (r->field_count == 1 && separator_of(r, fields)) {
        asdic_problems_add(r->problems, r->line, 1,
                           "columns are separated by %s; they must be by commas",
                           separator_of(r, fields));
        return;
    }
    for (size_t i = 0; i < r->field_count; i++) {
        any |= is_wanted(r, &fields[i]);
    }
    if (!any) {
        report_strange(r, fields);
        return;
    }
    for (size_t c = 0; c < r->columns->count; c++) {
        find_column(r, c, fields);
    }
}

/* --- rows ------------------------------------------------------------------------------------- */

/* The value of COLUMN in its field F; false after a report. */
static bool read_field(columns_reader *r, const asdic_column *column, const field *f,
                       double *value) {
    const char *why = f->length == 0 ? "is empty" : asdic_number_parse(f->text, f->length, value);
    if (why) {
        asdic_problems_add(r->problems, r->line, f->column, "'%s'%s%.*s %s", column->name,
                           f->length ? " = " : "", shown(f), f->text, why);
        return false;
    }
    if (!(*value >= column->min && *value <= column->max)) {
        asdic_problems_add(r->problems, r->line, f->column,
                           "'%s' = %.*s is out of range [%.15g, %.15g]%s", column->name, shown(f),
                           f->text, column->min, column->max,
                           column->below && *value < column->min ? column->below : "");
        return false;
    }
    return true;
}

static bool make_room(columns_reader *r) {
    size_t rows = r->capacity, lines = r->capacity;
    if (!asdic_grow(&r->rows, r->count, &rows, r->columns->count * sizeof *r->rows) ||
        !asdic_grow(&r->lines, r->count, &lines, sizeof *r->lines)) {
        return false;
    }
    r->capacity = lines;
    return true;
}

static void read_row(columns_reader *r, const char *line) {
    field fields[FIELDS_MOST];
    double values[ASDIC_COLUMNS_MOST] = {0.0};
    const size_t width = r->columns->count, count = split(line, fields);
    bool good = true;
    if (count != r->field_count) { /* a decimal comma, perhaps */
        asdic_problems_add(r->problems, r->line, 1, "%zu field%s, but the header has %zu", count,
                           count == 1 ? "" : "s", r->field_count);
        return;
    }
    for (size_t c = 0; c < width; c++) {
        good &= read_field(r, &r->columns->items[c], &fields[r->place[c]], &values[c]);
    }
    if (!good) {
        return;
    }
    double before = r->count > 0 ? r->rows[(r->count - 1) * width] : -INFINITY;
    if (!(values[0] > before)) {
        const field *f = &fields[r->place[0]];
        asdic_problems_add(r->problems, r->line, f->column,
                           "'%s' = %.*s is not %s %.15g at line %zu", r->columns->items[0].name,
                           shown(f), f->text, r->columns->rises, before, r->lines[r->count - 1]);
        return;
    }
    if (!make_room(r)) {
        r->problems->out_of_memory = true;
        return;
    }
    memcpy(r->rows + r->count * width, values, width * sizeof *values);
    r->lines[r->count++] = r->line;
}

/* Header and rows of TEXT, SIZE bytes; goes on after a bad row, not after a bad header. */
static void read_lines(columns_reader *r, char *text, size_t size) {
    const size_t before = r->problems->total;
    const char *end = text + size;
    text += asdic_utf8_mark(text, size);
    while (text < end && !r->problems->out_of_memory) {
        char *next = memchr(text, '\n', (size_t)(end - text));
        size_t length = next ? (size_t)(next - text) : (size_t)(end - text);
        char *line = text;
        text += length + (next != NULL);
        r->line++;
        if (memchr(line, '\0', length)) {
            asdic_problems_add(r->problems, r->line, 1, "not a text file: a zero byte");
            return;
        }
        while (length > 0 && line[length - 1] == '\r') {
            length--;
        }
        line[length] = '\0';
        if (line[strspn(line, " \t")] == '\0' || *line == '#') {
            continue;
        }
        if (r->field_count > 0) {
            read_row(r, line);
            continue;
        }
        read_header(r, line);
        if (r->problems->total > before) {
            return;
        }
    }
    if (r->problems->total == before && r->count == 0) {
        asdic_problems_add(r->problems, r->line + 1, 1, "%s%s",
                           r->field_count > 0 ? "no rows below the header"
                                              : "the file is empty; its header is ",
                           r->field_count > 0 ? "" : r->header);
    }
}

asdic_status asdic_columns_read(asdic_context *ctx, const char *path, const asdic_columns *columns,
                                asdic_problems *problems, double **rows, size_t **lines,
                                size_t *count) {
    columns_reader r = {.columns = columns, .problems = problems};
    const char *name = problems->name;
    const size_t before = problems->total;
    char *text = NULL;
    size_t size = 0;
    *rows = NULL;
    *lines = NULL;
    *count = 0;
    TRY(asdic_file_read(ctx, path, BYTES_MOST, &text, &size));
    for (size_t c = 0; c < columns->count; c++) {
        size_t at = strlen(r.header);
        snprintf(r.header + at, sizeof r.header - at, "%s%s", c > 0 ? "," : "",
                 columns->items[c].name);
    }
    problems->name = path;
    read_lines(&r, text, size);
    problems->name = name;
    free(text);
    if (problems->out_of_memory || problems->total > before) {
        free(r.rows);
        free(r.lines);
        return problems->out_of_memory ? asdic_fail_memory(ctx, path) : ASDIC_OK;
    }
    *rows = r.rows;
    *lines = r.lines;
    *count = r.count;
    return ASDIC_OK;
}
