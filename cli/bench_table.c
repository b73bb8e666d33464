/* The rows of a bench: on the screen as they come, as JSON and CSV at the end. */
#include "bench.h"
#include "json.h"

#include <math.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

struct bench_table {
    const bench_column *columns;
    size_t column_count, row_count;
    bench_cell *cells; /* with texts of their own */
    bool complete;     /* no row was lost for want of memory */
};

bench_table *bench_table_create(const bench_column *columns) {
    bench_table *t = calloc(1, sizeof *t);
    if (t) {
        t->columns = columns;
        t->complete = true;
        while (columns[t->column_count].key) {
            t->column_count++;
        }
    }
    return t;
}

void bench_table_destroy(bench_table *t) {
    for (size_t i = 0; t && i < t->row_count * t->column_count; i++) {
        free((char *)t->cells[i].text);
    }
    if (t) {
        free(t->cells);
    }
    free(t);
}

static void keep(bench_table *t, const bench_cell *cells) {
    size_t size = (t->row_count + 1) * t->column_count * sizeof *cells;
    bench_cell *grown = realloc(t->cells, size);
    if (!grown) {
        t->complete = false;
        return;
    }
    t->cells = grown;
    bench_cell *row = &grown[t->row_count++ * t->column_count];
    for (size_t i = 0; i < t->column_count; i++) {
        row[i] = cells[i];
        row[i].text = cells[i].text ? strdup(cells[i].text) : NULL;
        t->complete = t->complete && (row[i].text || !cells[i].text);
    }
}

/* Headings stand above their numbers, and above the beginning of texts. */
static void print_headings(const bench_table *t, const bench_cell *cells) {
    for (size_t i = 0; i < t->column_count; i++) {
        const bench_column *column = &t->columns[i];
        if (column->heading) {
            int width = cells[i].text ? -column->width : column->width;
            printf("%s%*s", i > 0 ? " " : "", width, column->heading);
        }
    }
    printf("\n");
}

static void print_row(const bench_table *t, const bench_cell *cells) {
    for (size_t i = 0; i < t->column_count; i++) {
        const bench_column *column = &t->columns[i];
        if (!column->heading) {
            continue;
        }
        printf("%s", i > 0 ? " " : "");
        if (cells[i].text) {
            printf("%-*.*s", column->width, column->width, cells[i].text);
        } else if (isfinite(cells[i].number)) {
            double scale = column->scale != 0.0 ? column->scale : 1.0;
            printf("%*.*f", column->width, column->digits, scale * cells[i].number);
        } else {
            printf("%*s", column->width, "-");
        }
    }
    printf("\n");
    fflush(stdout);
}

void bench_add(bench *b, const bench_cell *cells) {
    if (!b->is_silent) {
        if (b->table->row_count == 0) {
            print_headings(b->table, cells);
        }
        print_row(b->table, cells);
    }
    keep(b->table, cells);
}

void bench_say(const bench *b, const char *format, ...) {
    va_list arguments;
    va_start(arguments, format);
    if (!b->is_silent) {
        vprintf(format, arguments);
        fflush(stdout);
    }
    va_end(arguments);
}

void bench_table_json(const bench *b) {
    const bench_table *t = b->table;
    const asdic_device_info *device = asdic_device_get_info(b->device);
    json j = json_begin(stdout);
    json_open(&j, NULL, '{');
    json_text(&j, "version", asdic_version());
    json_text(&j, "device", device->name);
    json_integer(&j, "compute_units", device->compute_units);
    json_integer(&j, "threads", b->threads);
    json_open(&j, "rows", '[');
    for (size_t i = 0; i < t->row_count * t->column_count; i++) {
        const char *key = t->columns[i % t->column_count].key;
        if (i % t->column_count == 0) {
            json_open(&j, NULL, '{');
        }
        if (t->cells[i].text) {
            json_text(&j, key, t->cells[i].text);
        } else {
            json_number(&j, key, t->cells[i].number);
        }
        if ((i + 1) % t->column_count == 0) {
            json_close(&j);
        }
    }
    json_close(&j);
    json_close(&j);
}

/* A field is empty where there is no number. */
/* Quoted where it has a comma, a quote or a line end (RFC 4180). */
static void put_text(const char *text, FILE *file) {
    bool is_plain = text[strcspn(text, ",\"\r\n")] == '\0';
    fputs(is_plain ? "" : "\"", file);
    for (; *text; text++) {
        fputs(*text == '"' ? "\"" : "", file);
        fputc(*text, file);
    }
    fputs(is_plain ? "" : "\"", file);
}

static void put_rows(const bench_table *t, FILE *file) {
    for (size_t i = 0; i < t->column_count; i++) {
        fprintf(file, "%s%s", i > 0 ? "," : "", t->columns[i].key);
    }
    for (size_t i = 0; i < t->row_count * t->column_count; i++) {
        fputs(i % t->column_count ? "," : "\n", file);
        if (t->cells[i].text) {
            put_text(t->cells[i].text, file);
        } else if (isfinite(t->cells[i].number)) {
            fprintf(file, "%.10g", t->cells[i].number);
        }
    }
    fputs("\n", file);
}

int bench_table_csv(const bench *b, const char *path) {
    cli_file file;
    if (!cli_file_open(b->c, path, &file)) {
        return CLI_FAILED;
    }
    put_rows(b->table, file.stream);
    return cli_file_close(b->c, &file, true) ? CLI_OK : CLI_FAILED;
}

bool bench_table_is_complete(const bench_table *t) {
    return t->complete;
}
