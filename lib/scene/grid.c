/*
 * ESRI ASCII grid: six header lines (GDAL writes dx and dy where cells are not square), then rows
 * of values from north to south. Values stand at the centres of the cells, which become vertices.
 */
#include "mesh_build.h"

#include "base/try.h"
#include "base/words.h"
#include "mesh_scan.h"

#include "../base/context.h"

#include <ctype.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#define NO_VERTEX UINT32_MAX
/* Marks cells without data where the header says nothing of them. */
#define ESRI_NO_DATA (-9999.0)

typedef struct grid {
    asdic_mesh_scan *scan;
    asdic_line line;
    double columns, rows;
    double west_m, south_m; /* of the corner, or of the first centre */
    bool west_is_centre, south_is_centre;
    double cell_x_m, cell_y_m;
    double no_data;
    bool has_no_data;
    double *values;   /* rows x columns, NAN where there is no data */
    uint32_t *vertex; /* index of the vertex of each cell */
} grid;

static bool take_key(asdic_line *line, const char *key) {
    size_t length = strlen(key);
    asdic_line_skip_blanks(line);
    if ((size_t)(line->end - line->at) <= length || strncasecmp(line->at, key, length) != 0 ||
        (line->at[length] != ' ' && line->at[length] != '\t')) {
        return false;
    }
    line->at += length;
    return true;
}

/* "nan" as programs write it: with a sign, in any case. */
static bool take_nan(asdic_line *line) {
    asdic_line_skip_blanks(line);
    const char *at = line->at + (line->at < line->end && *line->at == '-');
    if (line->end - at < 3 || strncasecmp(at, "nan", 3) != 0 ||
        (at + 3 < line->end && !isspace((unsigned char)at[3]))) {
        return false;
    }
    line->at = at + 3;
    return true;
}

/* Reads one header line; *KNOWN is false for the first line that is none. */
static asdic_status header_line(grid *g, asdic_line *line, bool *known) {
    struct {
        const char *key;
        double *value;
        bool *flag;
    } keys[] = {
        {"ncols", &g->columns, NULL},
        {"nrows", &g->rows, NULL},
        {"xllcorner", &g->west_m, NULL},
        {"yllcorner", &g->south_m, NULL},
        {"xllcenter", &g->west_m, &g->west_is_centre},
        {"yllcenter", &g->south_m, &g->south_is_centre},
        {"cellsize", &g->cell_x_m, NULL},
        {"dx", &g->cell_x_m, NULL},
        {"dy", &g->cell_y_m, NULL},
        {"nodata_value", &g->no_data, &g->has_no_data},
    };
    *known = false;
    for (size_t i = 0; i < sizeof keys / sizeof *keys; i++) {
        if (!take_key(line, keys[i].key)) {
            continue;
        }
        *known = true;
        bool nan_no_data = keys[i].value == &g->no_data && take_nan(line);
        if (!nan_no_data && !asdic_line_take_number(g->scan, line, keys[i].value)) {
            return asdic_mesh_scan_fail(g->scan, line->number, "'%s' has no finite number",
                                        keys[i].key);
        }
        if (keys[i].flag) {
            *keys[i].flag = !nan_no_data; /* NAN cells are holes anyway */
        }
    }
    return ASDIC_OK;
}

static asdic_status check_header(const grid *g) {
    double limit = (double)g->scan->size / 2.0 + 1.0; /* a digit and a blank for each value */
    if (!(g->columns >= 2.0) || !(g->rows >= 2.0) || g->columns != floor(g->columns) ||
        g->rows != floor(g->rows)) {
        return asdic_mesh_scan_fail(g->scan, 0,
                                    "ncols %g and nrows %g must be whole numbers of at least 2",
                                    g->columns, g->rows);
    }
    if (g->columns * g->rows > limit) {
        return asdic_mesh_scan_fail(g->scan, 0, "%.9g x %.9g values do not fit %zu bytes",
                                    g->columns, g->rows, g->scan->size);
    }
    if (!(g->cell_x_m > 0.0) || !(g->cell_y_m > 0.0)) {
        return asdic_mesh_scan_fail(g->scan, 0,
                                    "a cell of %g x %g is no cell; cellsize is missing "
                                    "or not positive",
                                    g->cell_x_m, g->cell_y_m);
    }
    if (!isfinite(g->west_m) || !isfinite(g->south_m)) {
        return asdic_mesh_scan_fail(g->scan, 0,
                                    "xllcorner and yllcorner (or xllcenter, yllcenter) "
                                    "are missing");
    }
    return ASDIC_OK;
}

static asdic_status read_header(grid *g) {
    bool known = true, is_first = true;
    g->west_m = g->south_m = g->cell_x_m = g->cell_y_m = NAN;
    g->no_data = ESRI_NO_DATA;
    g->has_no_data = true;
    while (known) {
        asdic_line before = g->line;
        if (!asdic_line_next(g->scan, &g->line)) {
            return asdic_mesh_scan_fail(g->scan, g->line.number, "ends within its header");
        }
        TRY(header_line(g, &g->line, &known));
        if (!known && is_first) {
            return asdic_mesh_scan_fail(g->scan, g->line.number,
                                        "no header of an ESRI ASCII grid (ncols, nrows, ...); "
                                        "'gdal_translate -of AAIGrid IN OUT.asc' makes one of "
                                        "other grids, XYZ included");
        }
        is_first = false;
        g->line = known ? g->line : before;
    }
    if (isnan(g->cell_y_m)) {
        g->cell_y_m = g->cell_x_m;
    }
    return check_header(g);
}

/* The next value, from this line or the next; false at a word that is no number. */
static bool take_value(grid *g, double *out) {
    asdic_line_skip_blanks(&g->line);
    while (g->line.number == 0 || g->line.at >= g->line.end) {
        if (!asdic_line_next(g->scan, &g->line)) {
            return false;
        }
        asdic_line_skip_blanks(&g->line);
    }
    if (take_nan(&g->line)) {
        *out = NAN;
        return true;
    }
    if (!asdic_line_take_number(g->scan, &g->line, out)) {
        return false;
    }
    /* GDAL writes the marker with other digits than the values: equal in single precision. */
    if (g->has_no_data && fabs(*out - g->no_data) <= 1e-6 * fabs(g->no_data)) {
        *out = NAN;
    }
    return true;
}

static asdic_status read_values(grid *g) {
    size_t columns = (size_t)g->columns, count = columns * (size_t)g->rows;
    g->values = malloc(count * sizeof *g->values);
    g->vertex = malloc(count * sizeof *g->vertex);
    if (!g->values || !g->vertex) {
        return asdic_fail(g->scan->ctx, ASDIC_ERROR_MEMORY, "%s: out of memory for %zu cells",
                          g->scan->path, count);
    }
    for (size_t i = 0; i < count; i++) {
        if (!take_value(g, &g->values[i])) {
            size_t length = strcspn(g->line.at, " \t\r\n");
            bool has_comma = memchr(g->line.at, ',', length);
            return asdic_mesh_scan_fail(g->scan, g->line.number, "row %zu, column %zu %s%.*s%s",
                                        i / columns, i % columns,
                                        length ? "is no finite number: " : "is missing",
                                        (int)asdic_words_cut(g->line.at, length, 40), g->line.at,
                                        has_comma ? "; decimals stand behind a point" : "");
        }
    }
    asdic_line_skip_blanks(&g->line);
    while (g->line.at == g->line.end && asdic_line_next(g->scan, &g->line)) {
        asdic_line_skip_blanks(&g->line);
    }
    if (g->line.at < g->line.end) {
        return asdic_mesh_scan_fail(g->scan, g->line.number, "more than %zu values", count);
    }
    return ASDIC_OK;
}

static size_t place_vertices(grid *g, bool values_are_depth, double *vertices_m) {
    size_t columns = (size_t)g->columns, rows = (size_t)g->rows, count = 0;
    double east = g->west_m + (g->west_is_centre ? 0.0 : 0.5 * g->cell_x_m);
    double north = g->south_m + (g->south_is_centre ? 0.0 : 0.5 * g->cell_y_m);
    for (size_t i = 0; i < rows * columns; i++) {
        if (isnan(g->values[i])) {
            g->vertex[i] = NO_VERTEX;
            continue;
        }
        double *v = &vertices_m[3 * count];
        v[0] = north + (double)(rows - 1 - i / columns) * g->cell_y_m;
        v[1] = east + (double)(i % columns) * g->cell_x_m;
        v[2] = values_are_depth ? g->values[i] : -g->values[i];
        g->vertex[i] = (uint32_t)count++;
    }
    return count;
}

static size_t put_facet(uint32_t *out, uint32_t a, uint32_t b, uint32_t c) {
    if (a == NO_VERTEX || b == NO_VERTEX || c == NO_VERTEX) {
        return 0;
    }
    out[0] = a;
    out[1] = b;
    out[2] = c;
    return 1;
}

/* Two facets between four centres, one where a corner has no data; normals point up. */
static size_t connect(const grid *g, uint32_t *indices) {
    size_t columns = (size_t)g->columns, rows = (size_t)g->rows, count = 0;
    for (size_t row = 0; row + 1 < rows; row++) {
        for (size_t column = 0; column + 1 < columns; column++) {
            const uint32_t *v = &g->vertex[row * columns + column];
            uint32_t nw = v[0], ne = v[1], sw = v[columns], se = v[columns + 1];
            bool other_diagonal = nw == NO_VERTEX || se == NO_VERTEX;
            if (other_diagonal) {
                count += put_facet(&indices[3 * count], nw, sw, ne);
                count += put_facet(&indices[3 * count], ne, sw, se);
            } else {
                count += put_facet(&indices[3 * count], nw, sw, se);
                count += put_facet(&indices[3 * count], nw, se, ne);
            }
        }
    }
    return count;
}

static asdic_status build(grid *g, bool values_are_depth, asdic_mesh **out) {
    size_t cells = (size_t)g->columns * (size_t)g->rows;
    TRY(asdic_mesh_allocate(g->scan->ctx, cells, 2 * cells, out));
    (*out)->is_grid = true;
    (*out)->vertex_count = place_vertices(g, values_are_depth, (*out)->vertices_m);
    (*out)->triangle_count = connect(g, (*out)->indices);
    if ((*out)->triangle_count == 0) {
        return asdic_mesh_scan_fail(g->scan, 0,
                                    "%zu of %zu cells have a value, and no three that meet: there "
                                    "is no bottom between them",
                                    (*out)->vertex_count, cells);
    }
    return asdic_mesh_complete(g->scan->ctx, *out, g->scan->path);
}

/* Other formats of grids, by their first bytes. */
static asdic_status refuse_other_grids(const asdic_mesh_scan *scan) {
    static const struct {
        const char *name, *bytes;
        size_t length;
    } formats[] = {{"netCDF", "CDF", 3},
                   {"netCDF-4 or HDF5", "\x89HDF", 4},
                   {"TIFF", "II*", 4},
                   {"TIFF", "MM\0*", 4}};
    for (size_t i = 0; i < sizeof formats / sizeof *formats; i++) {
        if (scan->size >= formats[i].length &&
            memcmp(scan->text, formats[i].bytes, formats[i].length) == 0) {
            return asdic_mesh_scan_fail(scan, 0,
                                        "%s grids are not supported yet in this version; "
                                        "'gdal_translate -of AAIGrid IN OUT.asc' converts them",
                                        formats[i].name);
        }
    }
    return ASDIC_OK;
}

static asdic_status read_grid(grid *g, bool values_are_depth, asdic_mesh **mesh) {
    TRY(refuse_other_grids(g->scan));
    TRY(asdic_mesh_scan_take_text(g->scan));
    TRY(read_header(g));
    TRY(read_values(g));
    return build(g, values_are_depth, mesh);
}

asdic_status asdic_mesh_load_grid(asdic_context *ctx, const char *path, bool values_are_depth,
                                  asdic_mesh **out) {
    if (!ASDIC_PLACE(out) || !path) {
        return asdic_fail(ctx, ASDIC_ERROR_ARGUMENT, "a grid needs a path and a place");
    }
    asdic_mesh_scan scan;
    grid g = {.scan = &scan};
    asdic_mesh *mesh = NULL;
    asdic_status status = asdic_mesh_scan_open(ctx, path, &scan);
    status = status ? status : read_grid(&g, values_are_depth, &mesh);
    if (status) {
        asdic_mesh_destroy(&mesh);
    }
    free(g.values);
    free(g.vertex);
    asdic_mesh_scan_finish(&scan);
    *out = mesh;
    return status;
}
