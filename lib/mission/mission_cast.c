/*
 * A cast from a file of its own: its points go into the scene's tree in place of the file's name, as
 * depths and sound speeds. Where the environment has no temperature or salinity, for absorption, those of the
 * cast go there, in the mean over the depths of the water.
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

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define MAX_CAST_BYTES ((size_t)1 << 20)

#define DEPTH                                                                                      \
    { "depth_m", 0.0, 11000.0, NULL }

static const asdic_column speeds[] = {
    DEPTH, {"sound_speed_mps", ASDIC_SOUND_LEAST_MPS, ASDIC_SOUND_MOST_MPS, NULL}};
static const asdic_column temperatures[] = {
    DEPTH, {"temperature_degc", -2.0, 40.0, NULL}, {"salinity_ppt", 0.0, 45.0, NULL}};

/* Where to report on the row of the cast that is being read. */
typedef struct cast_reader {
    mission_builder *b;
    const char *path;
    asdic_columns columns;
    asdic_yaml_node *environment;
    double depth_m;      /* of a flat bottom; NAN: none is given */
    double salinity_ppt; /* where the file has none */
} cast_reader;

/* Which columns the header of the file, its first line that is no comment, has; without one those of speeds. */
static asdic_status find_columns(cast_reader *r) {
    char *text = NULL;
    size_t bytes;
    TRY(asdic_file_read(r->b->ctx, r->path, MAX_CAST_BYTES, &text, &bytes));
    char *line = text + asdic_utf8_mark(text, bytes);
    while (line && (line[strspn(line, " \t\r")] == '\n' || *line == '#')) {
        line = strchr(line, '\n');
        line = line ? line + 1 : NULL;
    }
    if (line) {
        line[strcspn(line, "\n")] = '\0';
    }
    r->columns =
        (asdic_columns){speeds, 2, "deeper than", ", or depth_m,temperature_degc[,salinity_ppt]"};
    if (line && !strstr(line, "sound_speed_mps") && strstr(line, "temperature_degc")) {
        r->columns.items = temperatures;
        r->columns.count = strstr(line, "salinity_ppt") ? 3 : 2;
    }
    free(text);
    return ASDIC_OK;
}

/* Depth and sound speed of ROW. */
static void take_row(const cast_reader *r, const double *row, double pair[2]) {
    double salinity_ppt = r->columns.count > 2 ? row[2] : r->salinity_ppt;
    pair[0] = row[0];
    pair[1] =
        r->columns.items == speeds ? row[1] : sound_speed_medwin_mps(row[1], salinity_ppt, row[0]);
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

static bool add_number(const cast_reader *r, asdic_yaml_node *list, const char *key, size_t line,
                       double value) {
    char digits[ASDIC_DIGITS_SIZE];
    size_t length = asdic_digits_double(digits, value);
    char *text = asdic_arena_string(r->b->arena, digits, length);
    asdic_yaml_node *number = text ? add_node(r, list, line, ASDIC_YAML_SCALAR) : NULL;
    if (number) {
        number->text = text;
        number->length = length;
        number->key = key;
        number->key_length = key ? strlen(key) : 0;
    }
    return number != NULL;
}

static bool add_point(const cast_reader *r, asdic_yaml_node *list, size_t line,
                      const double pair[2]) {
    asdic_yaml_node *point = add_node(r, list, line, ASDIC_YAML_LIST);
    return point && add_number(r, point, NULL, line, pair[0]) &&
           add_number(r, point, NULL, line, pair[1]);
}

/* The mean of COLUMN from the surface to DEPTH_M: on straight lines between COUNT rows, constant outside. */
static double mean_of(const cast_reader *r, const double *rows, size_t count, size_t column,
                      double depth_m) {
    double above_m = 0.0, above = rows[column], sum = 0.0;
    for (size_t i = 0; i <= count && above_m < depth_m; i++) {
        const double *row = rows + (i < count ? i : count - 1) * r->columns.count;
        double below_m = i < count ? row[0] : depth_m, below = row[column];
        double share = below_m > depth_m ? (depth_m - above_m) / (below_m - above_m) : 1.0;
        below_m = fmin(below_m, depth_m);
        below = above + share * (below - above);
        sum += 0.5 * (above + below) * (below_m - above_m);
        above_m = below_m;
        above = below;
    }
    return sum / depth_m;
}

/* What absorption is to take of the cast, to a thousandth. */
static bool add_means(const cast_reader *r, const double *rows, size_t line, size_t count) {
    double last_m = rows[(count - 1) * r->columns.count];
    double depth_m = r->depth_m > 0.0 ? r->depth_m : last_m;
    bool good = true;
    for (size_t c = 1; r->columns.items == temperatures && c < r->columns.count; c++) {
        const char *key = temperatures[c].name;
        if (!asdic_yaml_child(r->environment, key)) {
            double mean = mean_of(r, rows, count, c, depth_m);
            good = good && add_number(r, r->environment, key, line, round(1e3 * mean) / 1e3);
        }
    }
    return good;
}

/* The rows as points of LIST. */
static asdic_status take_rows(const cast_reader *r, const double *rows, const size_t *lines,
                              size_t count, asdic_yaml_node *list) {
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
        double pair[2];
        take_row(r, rows + i * r->columns.count, pair);
        if (!add_point(r, list, lines[i], pair)) {
            return asdic_fail_memory(r->b->ctx, "a cast");
        }
    }
    return add_means(r, rows, lines[0], count) ? ASDIC_OK : asdic_fail_memory(r->b->ctx, "a cast");
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
    asdic_problems *problems = r->b->problems;
    const char *scene = problems->name;
    const size_t before = problems->total;
    double *rows = NULL;
    size_t *lines = NULL, count = 0;
    asdic_status status = find_columns(r);
    status = status ? status
                    : asdic_columns_read(r->b->ctx, r->path, &r->columns, problems, &rows, &lines,
                                         &count);
    if (rows) {
        problems->name = r->path;
        status = take_rows(r, rows, lines, count, named);
        problems->name = scene;
    }
    free(rows);
    free(lines);
    return asdic_mission_file_read(r->b, named, before, status);
}

asdic_status asdic_mission_include_cast(mission_builder *b, asdic_yaml_node *root, bool *included) {
    asdic_yaml_node *environment = asdic_yaml_child(root, "environment");
    asdic_yaml_node *named = asdic_yaml_child(environment, "sound_speed_profile");
    if (!named || named->kind != ASDIC_YAML_SCALAR || named->length == 0) {
        return ASDIC_OK; /* points of its own; if something is wrong the table says so */
    }
    cast_reader r = {.b = b,
                     .path = asdic_mission_resolve(b, named->text),
                     .environment = environment,
                     .depth_m = number_of(asdic_yaml_child(root, "bottom"), "depth_m", NAN),
                     .salinity_ppt = number_of(environment, "salinity_ppt", 35.0)};
    if (!r.path) {
        return asdic_fail_memory(b->ctx, "the name of the cast");
    }
    *included = true;
    return read_cast(&r, named);
}
