/*
 * A cast from a file of its own: its points go into the scene's tree in place of the file's name, as
 * depths and sound speeds.
 */
#include "mission_build.h"

#include "base/columns.h"
#include "base/context.h"
#include "base/file_read.h"
#include "base/number.h"
#include "base/try.h"
#include "out/digits.h"
#include "sim/environment.h"

#include "../../kernels/water.h"

#include <stdlib.h>
#include <string.h>

#define MAX_CAST_BYTES ((size_t)1 << 20)

static const char *const column_names[] = {"depth_m,sound_speed_mps", "depth_m,temperature_degc",
                                           "depth_m,temperature_degc,salinity_ppt"};

/* Where to report on the row of the cast that is being read. */
typedef struct cast_reader {
    mission_builder *b;
    const char *path;
    bool is_speed;
    size_t width;        /* numbers in a row */
    double salinity_ppt; /* where the file has none */
} cast_reader;

/* Which columns the header of PATH, its first line that is no comment, has; of a file without one those of speeds. */
static asdic_status find_columns(asdic_context *ctx, const char *path, const char **columns) {
    char *text = NULL;
    size_t bytes, number = 1;
    TRY(asdic_file_read(ctx, path, MAX_CAST_BYTES, &text, &bytes));
    char *line = text + asdic_utf8_mark(text, bytes);
    while (line && (line[strspn(line, " \t\r")] == '\n' || *line == '#')) {
        line = strchr(line, '\n');
        line = line ? line + 1 : NULL;
        number++;
    }
    if (line) {
        line[strcspn(line, "\n")] = '\0';
    }
    bool has_temperature = line && strstr(line, "temperature_degc");
    bool has_speed = !line || !*line || strstr(line, "sound_speed_mps");
    *columns = column_names[has_speed ? 0 : strstr(line, "salinity_ppt") ? 2 : 1];
    free(text);
    if (!has_speed && !has_temperature) {
        return asdic_fail(
            ctx, ASDIC_ERROR_INPUT,
            "%s:%zu: neither a column 'sound_speed_mps' nor 'temperature_degc'; the header is "
            "depth_m,sound_speed_mps or depth_m,temperature_degc[,salinity_ppt], in any order",
            path, number);
    }
    return ASDIC_OK;
}

/* The value of a row, by NAME, within its range; reports one that is not. */
static bool within(const cast_reader *r, size_t line, const char *name, double value, double least,
                   double most, const char *unit) {
    bool good = value >= least && value <= most;
    if (!good) {
        asdic_problems_add(r->b->problems, (unsigned)line, 1,
                           "'%s' = %.15g is out of range [%g, %g] %s", name, value, least, most,
                           unit);
    }
    return good;
}

/* Depth and sound speed of ROW; BEFORE is the depth of the row above, -1 in the first. */
static bool read_row(const cast_reader *r, const double *row, size_t line, double before,
                     double pair[2]) {
    double salinity_ppt = r->width > 2 ? row[2] : r->salinity_ppt;
    if (!within(r, line, "depth_m", row[0], 0.0, 11000.0, "m")) {
        return false;
    }
    if (!(row[0] > before)) {
        asdic_problems_add(
            r->b->problems, (unsigned)line, 1,
            "'depth_m' = %.15g is not below the %.15g m of the row before; order the "
            "rows from the surface down, each depth once",
            row[0], before);
        return false;
    }
    pair[0] = row[0];
    pair[1] = row[1];
    if (!r->is_speed) {
        if (!within(r, line, "temperature_degc", row[1], -2.0, 40.0, "degC") ||
            !within(r, line, "salinity_ppt", salinity_ppt, 0.0, 45.0, "ppt")) {
            return false;
        }
        pair[1] = sound_speed_medwin_mps(row[1], salinity_ppt, row[0]);
    }
    return within(r, line, "sound_speed_mps", pair[1], ASDIC_SOUND_LEAST_MPS, ASDIC_SOUND_MOST_MPS,
                  "m/s");
}

static asdic_yaml_node *add_node(const cast_reader *r, asdic_yaml_node *list, size_t line,
                                 asdic_yaml_kind kind) {
    asdic_yaml_node *node = asdic_arena_alloc(r->b->arena, sizeof *node);
    if (node) {
        node->kind = kind;
        node->file = r->path;
        node->line = (unsigned)line;
        node->column = 1;
        asdic_yaml_append(list, node);
    }
    return node;
}

static bool add_point(const cast_reader *r, asdic_yaml_node *list, size_t line,
                      const double pair[2]) {
    asdic_yaml_node *point = add_node(r, list, line, ASDIC_YAML_LIST);
    for (int i = 0; point && i < 2; i++) {
        char digits[ASDIC_DIGITS_SIZE];
        asdic_yaml_node *number = add_node(r, point, line, ASDIC_YAML_SCALAR);
        size_t length = asdic_digits_double(digits, pair[i]);
        number = number && (number->text = asdic_arena_string(r->b->arena, digits, length)) ? number
                                                                                            : NULL;
        if (!number) {
            return false;
        }
        number->length = length;
    }
    return point != NULL;
}

/* The rows as points of LIST, until one is wrong. */
static asdic_status take_rows(cast_reader *r, const double *rows, const size_t *lines, size_t count,
                              asdic_yaml_node *list) {
    double pair[2] = {-1.0, 0.0};
    if (count < 2 || count > ASDIC_PROFILE_POINTS) {
        asdic_problems_add(r->b->problems, (unsigned)lines[count - 1], 1,
                           "%zu point%s; a cast has 2 to %d: %s", count, count == 1 ? "" : "s",
                           ASDIC_PROFILE_POINTS,
                           count == 1 ? "give 'sound_speed_mps' for water of one speed"
                                      : "keep those where its slope changes");
        return ASDIC_OK;
    }
    list->kind = ASDIC_YAML_LIST;
    list->first = list->last = NULL;
    list->count = list->length = 0;
    list->text = NULL;
    for (size_t i = 0; i < count; i++) {
        if (!read_row(r, rows + i * r->width, lines[i], pair[0], pair)) {
            return ASDIC_OK;
        }
        if (!add_point(r, list, lines[i], pair)) {
            return asdic_fail_memory(r->b->ctx, "a cast");
        }
    }
    return ASDIC_OK;
}

/* The number of MAP's KEY, or FALLBACK. */
static double number_of(const asdic_yaml_node *map, const char *key, double fallback) {
    const asdic_yaml_node *node = asdic_yaml_child(map, key);
    double value;
    bool good = node && node->kind == ASDIC_YAML_SCALAR && !node->quoted &&
                !asdic_number_parse(node->text, node->length, &value);
    return good ? value : fallback;
}

static asdic_status read_cast(cast_reader *r, asdic_yaml_node *named) {
    const char *columns = NULL, *scene = r->b->problems->name;
    double *rows = NULL;
    size_t *lines = NULL, count = 0;
    asdic_status status = find_columns(r->b->ctx, r->path, &columns);
    if (status == ASDIC_OK) {
        r->is_speed = columns == column_names[0];
        r->width = columns == column_names[2] ? 3 : 2;
        status = asdic_columns_read(r->b->ctx, r->path, columns, &rows, &lines, &count);
    }
    if (status) {
        return asdic_mission_file_problem(r->b, named, status);
    }
    r->b->problems->name = r->path;
    size_t before = r->b->problems->total;
    status = take_rows(r, rows, lines, count, named);
    for (asdic_yaml_node *node = named; node && r->b->problems->total > before;
         node = node->parent) {
        node->bad = true;
    }
    r->b->problems->name = scene;
    free(rows);
    free(lines);
    return status;
}

asdic_status asdic_mission_include_cast(mission_builder *b, asdic_yaml_node *root, bool *included) {
    asdic_yaml_node *environment = asdic_yaml_child(root, "environment");
    asdic_yaml_node *named = asdic_yaml_child(environment, "sound_speed_profile");
    if (!named || named->kind != ASDIC_YAML_SCALAR || named->length == 0) {
        return ASDIC_OK; /* points of its own; if something is wrong the table says so */
    }
    cast_reader r = {.b = b,
                     .path = asdic_mission_resolve(b, named->text),
                     .salinity_ppt = number_of(environment, "salinity_ppt", 35.0)};
    if (!r.path) {
        return asdic_fail_memory(b->ctx, "the name of the cast");
    }
    *included = true;
    return read_cast(&r, named);
}
