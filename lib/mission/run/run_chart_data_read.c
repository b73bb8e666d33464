#include "run_chart_data.h"

#include "base/context.h"
#include "base/file_name.h"
#include "base/file_read.h"
#include "base/grow.h"
#include "base/number.h"
#include "base/try.h"
#include "base/vec.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* --- reading ---------------------------------------------------------------------------------- */

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

static asdic_status parse_relief(scan *s, asdic_chart_data *out) {
    asdic_relief *r = &out->relief;
    double columns, rows, no_data;
    if (!header(s, "ncols", &columns) || !header(s, "nrows", &rows) ||
        !header(s, "xllcorner", &r->west_m) || !header(s, "yllcorner", &r->south_m) ||
        !header(s, "cellsize", &r->cell_m) || !header(s, "NODATA_value", &no_data) ||
        !(columns >= 1.0 && rows >= 1.0 && columns * rows <= (double)MOST_CELLS) ||
        !(r->cell_m > 0.0)) {
        return ASDIC_ERROR_INPUT;
    }
    r->columns = (size_t)columns;
    r->rows = (size_t)rows;
    r->depth_m = malloc(r->columns * r->rows * sizeof *r->depth_m);
    if (!r->depth_m) {
        return ASDIC_ERROR_MEMORY;
    }
    for (size_t i = 0; i < r->columns * r->rows; i++) {
        double value;
        if (!next_number(s, " \n", &value)) {
            return ASDIC_ERROR_INPUT;
        }
        r->depth_m[i] = value == no_data ? NAN : (float)value;
    }
    return ASDIC_OK;
}

/* One corner a line; a new number in the second field begins an outline. */
static asdic_status parse_outlines(scan *s, asdic_chart_data *out) {
    size_t length, capacity = 0;
    double number, last = NAN, x_m, y_m;
    next_word(s, "\n", &length); /* the names of the columns */
    for (const char *name; (name = next_word(s, ",\n", &length));) {
        if (length >= ASDIC_NAME_SIZE || !next_number(s, ",\n", &number) ||
            !next_number(s, ",\n", &x_m) || !next_number(s, ",\n", &y_m)) {
            return ASDIC_ERROR_INPUT;
        }
        if (number != last) {
            if (!asdic_grow(&out->outlines, out->outline_count, &capacity, sizeof *out->outlines)) {
                return ASDIC_ERROR_MEMORY;
            }
            asdic_outline *o = &out->outlines[out->outline_count++];
            *o = (asdic_outline){0};
            memcpy(o->name, name, length);
            last = number;
        }
        asdic_outline *o = &out->outlines[out->outline_count - 1];
        if (o->count == ASDIC_OUTLINE_SIDES) {
            return ASDIC_ERROR_INPUT;
        }
        o->north_m[o->count] = x_m;
        o->east_m[o->count++] = y_m;
    }
    return ASDIC_OK;
}

/* One point a line; a new name begins a route. */
static asdic_status parse_routes(scan *s, asdic_chart_data *out) {
    size_t length, lines = 0, point = 0;
    for (const char *at = s->at; at < s->end; at++) {
        lines += *at == '\n';
    }
    next_word(s, "\n", &length); /* the names of the columns */
    out->points = calloc(lines + 1, sizeof *out->points);
    out->routes = calloc(lines + 1, sizeof *out->routes);
    if (!out->points || !out->routes) {
        return ASDIC_ERROR_MEMORY;
    }
    for (const char *name; (name = next_word(s, ",\n", &length));) {
        asdic_route *r = out->route_count ? &out->routes[out->route_count - 1] : NULL;
        if (point > lines) {
            return ASDIC_ERROR_INPUT; /* several on a line */
        }
        asdic_route_point *p = &out->points[point++];
        double yaw_deg;
        if (length >= ASDIC_NAME_SIZE || !next_number(s, ",\n", &p->time_s) ||
            !next_number(s, ",\n", &p->north_m) || !next_number(s, ",\n", &p->east_m) ||
            !next_number(s, ",\n", &yaw_deg)) {
            return ASDIC_ERROR_INPUT;
        }
        p->yaw_rad = yaw_deg * ASDIC_PI / 180.0;
        if (!r || strlen(r->name) != length || memcmp(r->name, name, length) != 0) {
            r = &out->routes[out->route_count++];
            memcpy(r->name, name, length);
            r->points = p;
        }
        r->count++;
    }
    return ASDIC_OK;
}

/* Reads the file NAME of FOLDER by PARSE; does nothing when there is no such file. */
static asdic_status read_part(asdic_context *ctx, const char *folder, const char *name,
                              asdic_status (*parse)(scan *, asdic_chart_data *),
                              asdic_chart_data *out) {
    const asdic_file_name file = asdic_file_in(folder, name);
    const char *path = file.text;
    char *text = NULL;
    size_t length = 0;
    if (access(path, F_OK) != 0) {
        return ASDIC_OK;
    }
    TRY(asdic_file_read(ctx, path, MAX_BYTES, &text, &length));
    scan s = {text, text + length};
    asdic_status status = parse(&s, out);
    free(text);
    if (status == ASDIC_ERROR_INPUT) {
        return asdic_fail(ctx, status,
                          "'%s' is damaged; the chart cannot be drawn from it, run again with "
                          "--force",
                          path);
    }
    return status ? asdic_fail_memory(ctx, path) : ASDIC_OK;
}

static asdic_status read_parts(asdic_context *ctx, const char *folder, asdic_chart_data *out) {
    TRY(read_part(ctx, folder, "terrain.asc", parse_relief, out));
    TRY(read_part(ctx, folder, "objects.csv", parse_outlines, out));
    return read_part(ctx, folder, "routes.csv", parse_routes, out);
}

asdic_status asdic_chart_data_read(asdic_context *ctx, const char *folder, asdic_chart_data *out) {
    *out = (asdic_chart_data){0};
    asdic_status status = read_parts(ctx, folder, out);
    if (status) {
        asdic_chart_data_finish(out);
    }
    return status;
}

void asdic_chart_data_finish(asdic_chart_data *data) {
    free(data->relief.depth_m);
    free(data->outlines);
    free(data->routes);
    free(data->points);
    *data = (asdic_chart_data){0};
}

/* --- routes ----------------------------------------------------------------------------------- */

/* ROUTE at TIME_S, between its points; before and behind them, its nearest end. */
static asdic_route_point at(const asdic_route *route, double time_s) {
    const asdic_route_point *p = route->points;
    size_t next = 0;
    while (next < route->count && p[next].time_s < time_s) {
        next++;
    }
    if (next == 0 || next == route->count) {
        asdic_route_point end = p[next == 0 ? 0 : route->count - 1];
        end.time_s = time_s;
        return end;
    }
    const asdic_route_point *a = &p[next - 1], *b = &p[next];
    double share = (time_s - a->time_s) / (b->time_s - a->time_s);
    double turn_rad =
        remainder(b->yaw_rad - a->yaw_rad, 2.0 * ASDIC_PI); /* the shorter way round */
    return (asdic_route_point){.time_s = time_s,
                               .north_m = a->north_m + share * (b->north_m - a->north_m),
                               .east_m = a->east_m + share * (b->east_m - a->east_m),
                               .yaw_rad = a->yaw_rad + share * turn_rad};
}

/* Moves OUTLINE, drawn with the object at A, to B: turns it about the object's position and shifts
 * it. */
static void move(asdic_outline *outline, const asdic_route_point *a, const asdic_route_point *b) {
    double cosine = cos(b->yaw_rad - a->yaw_rad), sine = sin(b->yaw_rad - a->yaw_rad);
    for (size_t k = 0; k < outline->count; k++) {
        double north_m = outline->north_m[k] - a->north_m, east_m = outline->east_m[k] - a->east_m;
        outline->north_m[k] = b->north_m + cosine * north_m - sine * east_m;
        outline->east_m[k] = b->east_m + sine * north_m + cosine * east_m;
    }
}

/* Cuts COUNT POINTS of a route in place to FIRST, LAST and the points between them; returns their
 * number. The route begins not after FIRST and ends not before LAST. */
static size_t cut(asdic_route_point *points, size_t count, asdic_route_point first,
                  asdic_route_point last) {
    size_t kept = 0;
    points[kept++] = first;
    for (size_t i = 1; i + 1 < count; i++) {
        if (points[i].time_s > first.time_s && points[i].time_s < last.time_s) {
            points[kept++] = points[i];
        }
    }
    points[kept++] = last;
    return kept;
}

void asdic_chart_data_cut(asdic_chart_data *data, double first_time_s, double last_time_s) {
    size_t kept = 0;
    for (size_t i = 0; i < data->route_count; i++) {
        asdic_route route = data->routes[i];
        asdic_route_point *points = data->points + (route.points - data->points);
        asdic_route_point start = points[0], first = at(&route, first_time_s),
                          last = at(&route, last_time_s);
        for (size_t k = 0; k < data->outline_count; k++) {
            if (strcmp(data->outlines[k].name, route.name) == 0) {
                move(&data->outlines[k], &start, &last);
            }
        }
        if (route.count > 1 && last_time_s > first_time_s) {
            route.count = cut(points, route.count, first, last);
            data->routes[kept++] = route;
        }
    }
    data->route_count = kept;
}
