#include "run_scenery.h"

#include "base/context.h"
#include "base/file_read.h"
#include "base/number.h"
#include "base/vec.h"
#include "run_folder.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define MAX_BYTES ((size_t)64 << 20)
/* Far more than a run writes. */
#define MOST_CELLS ((size_t)1 << 24)

/* Words and lines of a text in turn. */
typedef struct scan {
    const char *at, *end;
} scan;

/* The next word, ended by a byte of SEPARATORS, which is skipped; NULL at the end. */
static const char *next_word(scan *s, const char *separators, size_t *length) {
    while (s->at < s->end && strchr(separators, *s->at)) {
        s->at++;
    }
    const char *word = s->at;
    while (s->at < s->end && !strchr(separators, *s->at)) {
        s->at++;
    }
    *length = (size_t)(s->at - word);
    return *length > 0 ? word : NULL;
}

static bool next_number(scan *s, const char *separators, double *out) {
    size_t length;
    const char *word = next_word(s, separators, &length);
    return word && asdic_number_parse(word, length, out) == NULL;
}

/* "KEY VALUE" */
static bool header(scan *s, const char *key, double *out) {
    size_t length;
    const char *word = next_word(s, " \n", &length);
    return word && length == strlen(key) && memcmp(word, key, length) == 0 &&
           next_number(s, " \n", out);
}

static bool parse_relief(scan *s, asdic_scenery *out) {
    asdic_relief *r = &out->relief;
    double columns, rows, no_data;
    if (!header(s, "ncols", &columns) || !header(s, "nrows", &rows) ||
        !header(s, "xllcorner", &r->west_m) || !header(s, "yllcorner", &r->south_m) ||
        !header(s, "cellsize", &r->cell_m) || !header(s, "NODATA_value", &no_data) ||
        !(columns >= 1.0 && rows >= 1.0 && columns * rows <= (double)MOST_CELLS) ||
        !(r->cell_m > 0.0)) {
        return false;
    }
    r->columns = (size_t)columns;
    r->rows = (size_t)rows;
    r->depth_m = malloc(r->columns * r->rows * sizeof *r->depth_m);
    for (size_t i = 0; i < r->columns * r->rows && r->depth_m; i++) {
        double value;
        if (!next_number(s, " \n", &value)) {
            return false;
        }
        r->depth_m[i] = value == no_data ? NAN : (float)value;
    }
    return r->depth_m != NULL;
}

/* One corner a line; a new number in the second field begins an outline. */
static bool parse_outlines(scan *s, asdic_scenery *out) {
    size_t length, capacity = 0;
    double number, last = -1.0, x_m, y_m;
    next_word(s, "\n", &length); /* the names of the columns */
    for (const char *name; (name = next_word(s, ",\n", &length));) {
        if (length >= ASDIC_NAME_SIZE || !next_number(s, ",\n", &number) ||
            !next_number(s, ",\n", &x_m) || !next_number(s, ",\n", &y_m)) {
            return false;
        }
        if (number != last) {
            if (out->outline_count == capacity) {
                capacity = capacity ? 2 * capacity : 16;
                asdic_outline *more = realloc(out->outlines, capacity * sizeof *more);
                if (!more) {
                    return false;
                }
                out->outlines = more;
            }
            asdic_outline *o = &out->outlines[out->outline_count++];
            *o = (asdic_outline){0};
            memcpy(o->name, name, length);
            last = number;
        }
        asdic_outline *o = &out->outlines[out->outline_count - 1];
        if (o->count == ASDIC_OUTLINE_SIDES) {
            return false;
        }
        o->north_m[o->count] = x_m;
        o->east_m[o->count++] = y_m;
    }
    return true;
}

/* One point a line; a new name begins a route. */
static bool parse_routes(scan *s, asdic_scenery *out) {
    size_t length, lines = 0, point = 0;
    for (const char *at = s->at; at < s->end; at++) {
        lines += *at == '\n';
    }
    next_word(s, "\n", &length); /* the names of the columns */
    out->points = calloc(lines + 1, sizeof *out->points);
    out->routes = calloc(lines + 1, sizeof *out->routes);
    for (const char *name; out->points && out->routes && (name = next_word(s, ",\n", &length));) {
        asdic_route *r = out->route_count ? &out->routes[out->route_count - 1] : NULL;
        asdic_route_point *p = &out->points[point++];
        double yaw_deg;
        if (length >= ASDIC_NAME_SIZE || !next_number(s, ",\n", &p->time_s) ||
            !next_number(s, ",\n", &p->north_m) || !next_number(s, ",\n", &p->east_m) ||
            !next_number(s, ",\n", &yaw_deg)) {
            return false;
        }
        p->yaw_rad = yaw_deg * ASDIC_PI / 180.0;
        if (!r || strlen(r->name) != length || memcmp(r->name, name, length) != 0) {
            r = &out->routes[out->route_count++];
            memcpy(r->name, name, length);
            r->points = p;
        }
        r->count++;
    }
    return out->points && out->routes;
}

/* The file's text, or NULL when there is no such file. */
static asdic_status load(asdic_context *ctx, const char *path, char **text, scan *s) {
    size_t length = 0;
    *text = NULL;
    if (access(path, F_OK) != 0) {
        return ASDIC_OK;
    }
    asdic_status status = asdic_file_read(ctx, path, MAX_BYTES, text, &length);
    *s = (scan){*text, *text + length};
    return status;
}

/* NAME.EXTENSION of FOLDER by PARSE, if there is such a file. */
static asdic_status read_part(asdic_context *ctx, const char *folder, const char *name,
                              const char *extension, bool (*parse)(scan *, asdic_scenery *),
                              asdic_scenery *out) {
    char *path = asdic_folder_path(folder, name, "", extension), *text = NULL;
    scan s;
    asdic_status status = path ? load(ctx, path, &text, &s) : asdic_fail_memory(ctx, "a file name");
    if (status == ASDIC_OK && text && !parse(&s, out)) {
        status = asdic_fail(ctx, ASDIC_ERROR_INPUT,
                            "'%s' is damaged; the chart cannot be drawn from it, run again with "
                            "--force",
                            path);
    }
    free(text);
    free(path);
    return status;
}

asdic_status asdic_scenery_read(asdic_context *ctx, const char *folder, asdic_scenery *out) {
    *out = (asdic_scenery){0};
    asdic_status status = read_part(ctx, folder, "terrain", "asc", parse_relief, out);
    if (status == ASDIC_OK) {
        status = read_part(ctx, folder, "objects", "csv", parse_outlines, out);
    }
    if (status == ASDIC_OK) {
        status = read_part(ctx, folder, "routes", "csv", parse_routes, out);
    }
    if (status != ASDIC_OK) {
        asdic_scenery_finish(out);
    }
    return status;
}

void asdic_scenery_finish(asdic_scenery *scenery) {
    free(scenery->relief.depth_m);
    free(scenery->outlines);
    free(scenery->routes);
    free(scenery->points);
    *scenery = (asdic_scenery){0};
}
