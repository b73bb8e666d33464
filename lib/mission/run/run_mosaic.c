/*
 * The fans of a mission laid on one map: the mean intensity of all that saw a place, with the gain that
 * lets far and near floor look alike.
 */
#include <asdic/run.h>

#include "base/context.h"
#include "base/sort.h"
#include "base/try.h"
#include "base/vec.h"
#include "out/digits.h"
#include "out/draw.h"
#include "out/file.h"
#include "out/raster.h"
#include "run_chart_data.h"
#include "run_footprint.h"
#include "run_picture.h"
#include "sim/ring.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Of the map, in cells. */
#define MOST_SIDE 8192
#define EMPTY_RGB 0xffffffu
/* A fan's floor falls as the sound spreads both ways, less the growth of what a bin covers. */
#define DB_PER_DECADE 30.0
/* Of uprights that are the same but for the digits of a file: a twentieth of a degree. */
#define SAME_UPRIGHT_COSINE (1.0 - 4e-7)

typedef struct mosaic {
    asdic_context *ctx;
    asdic_run *run;
    asdic_run_info info;
    asdic_chart_data data;
    asdic_seafloor ground; /* of DATA: the terrain; else without any */
    double bin_length_m, range_m, cell_m;
    double west_m, south_m;
    size_t columns, rows;
    double *sum;     /* [row * columns + column], rows from south to north: intensities with gain */
    uint32_t *count; /* of pings that saw the cell */
    bool is_line;    /* of elements, whose beams are cones about the fan's y axis */
    asdic_mat3 fan;  /* its axes in the sonar's */
    double *edges_rad; /* of the beams, bearings in the fan's axes */
    double db_per_decade, db_per_m;
    struct {
        size_t south, north, west, east; /* rows and columns; the last two are behind the last */
    } seen;                              /* what the picture shows: the box of all that was seen */
} mosaic;

/* Of what lies ALONG the fan's axes: by it a line of elements steers its beams, at any height. */
static double bearing_of(const mosaic *m, asdic_vec3 along) {
    if (!m->is_line) {
        return atan2(along.y, along.x);
    }
    /* Behind, nothing is heard as loudly. */
    return along.x > 0.0 ? asin(along.y / asdic_vec3_length(along)) : ASDIC_PI;
}

/* Adds what RECORD, whose fan has these AXES, heard from (NORTH_M, EAST_M) on the floor:
 * the terrain, beside which there is none, or a plane as deep as straight below the vehicle. */
static void add_cell(mosaic *m, const asdic_record *record, asdic_mat3 axes, size_t cell,
                     double north_m, double east_m) {
    asdic_vec3 at_m = record->pose.position_m;
    double depth_m = at_m.z + (isfinite(record->altitude_m) ? record->altitude_m : 0.0);
    if (m->ground.relief->columns > 0) {
        depth_m = asdic_seafloor_depth_m(&m->ground, north_m, east_m);
    }
    if (!isfinite(depth_m)) {
        return;
    }
    asdic_vec3 way_m = {north_m - at_m.x, east_m - at_m.y, depth_m - at_m.z};
    double range_m = asdic_vec3_length(way_m);
    size_t bin = (size_t)(range_m / m->bin_length_m);
    asdic_vec3 along = asdic_mat3_apply_inverse(axes, way_m);
    size_t beam = asdic_fan_beam(m->edges_rad, m->info.beams, bearing_of(m, along));
    if (bin >= m->info.bins || beam >= m->info.beams) {
        return;
    }
    double level_db = (double)record->level_db[ASDIC_TOTAL][beam * m->info.bins + bin];
    if (isfinite(level_db)) {
        double gain_db = m->db_per_decade * log10(range_m) + m->db_per_m * range_m;
        m->sum[cell] += pow(10.0, 0.1 * (level_db + gain_db));
        m->count[cell]++;
    }
}

static void add_record(mosaic *m, const asdic_record *record) {
    const asdic_pose *pose = &record->pose;
    double x = pose->position_m.x, y = pose->position_m.y;
    asdic_mat3 axes = asdic_mat3_multiply(asdic_mat3_of(pose), m->fan);
    double first_row = floor((x - m->range_m - m->south_m) / m->cell_m);
    double first_column = floor((y - m->range_m - m->west_m) / m->cell_m);
    size_t wide = (size_t)ceil(2.0 * m->range_m / m->cell_m) + 1;
    size_t row0 = (size_t)fmax(first_row, 0.0), column0 = (size_t)fmax(first_column, 0.0);
    for (size_t row = row0; row < row0 + wide && row < m->rows; row++) {
        double north_m = m->south_m + ((double)row + 0.5) * m->cell_m;
        for (size_t column = column0; column < column0 + wide && column < m->columns; column++) {
            double east_m = m->west_m + ((double)column + 0.5) * m->cell_m;
            add_cell(m, record, axes, row * m->columns + column, north_m, east_m);
        }
    }
}

/* The map holds every place within range of the track. */
static asdic_status find_extent(mosaic *m) {
    double north_m = -INFINITY, east_m = -INFINITY;
    m->west_m = m->south_m = INFINITY;
    for (size_t i = 0; i < m->info.pings; i++) {
        asdic_record record;
        TRY(asdic_run_read(m->run, i, &record));
        m->south_m = fmin(m->south_m, record.pose.position_m.x - m->range_m);
        north_m = fmax(north_m, record.pose.position_m.x + m->range_m);
        m->west_m = fmin(m->west_m, record.pose.position_m.y - m->range_m);
        east_m = fmax(east_m, record.pose.position_m.y + m->range_m);
    }
    double side_m = fmax(north_m - m->south_m, east_m - m->west_m);
    if (m->cell_m == 0.0) {
        m->cell_m = fmax(m->bin_length_m, side_m / 4096.0);
    }
    if (side_m / m->cell_m > MOST_SIDE) {
        return asdic_fail(m->ctx, ASDIC_ERROR_ARGUMENT,
                          "a mosaic of %g m in cells of %g m has more than %d a side; give larger "
                          "cells",
                          side_m, m->cell_m, MOST_SIDE);
    }
    m->rows = (size_t)ceil((north_m - m->south_m) / m->cell_m);
    m->columns = (size_t)ceil((east_m - m->west_m) / m->cell_m);
    m->sum = calloc(m->rows * m->columns, sizeof *m->sum);
    m->count = calloc(m->rows * m->columns, sizeof *m->count);
    return m->sum && m->count ? ASDIC_OK : asdic_fail_memory(m->ctx, "a mosaic");
}

/* Of a map of which nothing was seen a place is left. */
static void find_seen(mosaic *m) {
    size_t south = m->rows - 1, north = 0, west = m->columns - 1, east = 0;
    for (size_t row = 0; row < m->rows; row++) {
        for (size_t column = 0; column < m->columns; column++) {
            if (m->count[row * m->columns + column] > 0) {
                south = row < south ? row : south;
                north = row + 1;
                west = column < west ? column : west;
                east = column + 1 > east ? column + 1 : east;
            }
        }
    }
    m->seen.south = south;
    m->seen.north = north > 0 ? north : m->rows;
    m->seen.west = west;
    m->seen.east = east > 0 ? east : m->columns;
}

/* Turns sums into levels, NAN where no ping saw the cell, and finds their window. */
static asdic_status to_levels(mosaic *m, asdic_picture_options *look) {
    size_t cells = m->rows * m->columns, seen = 0;
    double *sorted = malloc(cells * sizeof *sorted);
    if (!sorted) {
        return asdic_fail_memory(m->ctx, "a mosaic");
    }
    for (size_t i = 0; i < cells; i++) {
        m->sum[i] = m->count[i] ? 10.0 * log10(m->sum[i] / m->count[i]) : NAN;
        if (isfinite(m->sum[i])) {
            sorted[seen++] = m->sum[i];
        }
    }
    asdic_sort_doubles(sorted, seen);
    double low_db = seen ? 10.0 * floor(0.1 * sorted[seen / 20]) : 0.0;
    double high_db = seen ? 10.0 * ceil(0.1 * sorted[seen * 995 / 1000]) : 10.0;
    look->db_low = isnan(look->db_low) ? low_db : look->db_low;
    look->db_high = isnan(look->db_high) ? fmax(high_db, look->db_low + 10.0) : look->db_high;
    free(sorted);
    return ASDIC_OK;
}

/* Six lines: a pixel's size east and north, and the centre of the north-western one. */
static asdic_status write_world(const mosaic *m, const char *path) {
    char name[4096], numbers[3][ASDIC_DIGITS_SIZE];
    asdic_file *file;
    const char *file_name = strrchr(path, '/'), *dot = strrchr(file_name ? file_name : path, '.');
    size_t stem = dot ? (size_t)(dot - path) : strlen(path);
    snprintf(name, sizeof name, "%.*s.pgw", (int)stem, path);
    asdic_digits_print(numbers[0], "%.10g", m->cell_m);
    asdic_digits_print(numbers[1], "%.10g", m->west_m + ((double)m->seen.west + 0.5) * m->cell_m);
    asdic_digits_print(numbers[2], "%.10g", m->south_m + ((double)m->seen.north - 0.5) * m->cell_m);
    TRY(asdic_file_create(m->ctx, name, &file));
    fprintf(asdic_file_stream(file), "%s\n0\n0\n-%s\n%s\n%s\n", numbers[0], numbers[0], numbers[1],
            numbers[2]);
    return asdic_file_commit(&file);
}

static asdic_status write(mosaic *m, const char *path, const asdic_picture_options *look) {
    asdic_raster raster;
    char low[ASDIC_DIGITS_SIZE], high[ASDIC_DIGITS_SIZE], facts[ASDIC_SUBTITLE_SIZE];
    char gain[ASDIC_GAIN_SIZE];
    asdic_digits_print(low, "%g", look->db_low);
    asdic_digits_print(high, "%g", look->db_high);
    asdic_draw_gain(gain, m->db_per_decade, m->db_per_m);
    asdic_picture_subtitle(m->info.sonar, m->bin_length_m, facts);
    const char *const texts[] = {"Software",    "asdic",
                                 "scene",       m->info.scene_name,
                                 "db_low",      low,
                                 "db_high",     high,
                                 "colormap",    asdic_colormap_name(look->colormap),
                                 "gain",        gain,
                                 "Description", facts,
                                 NULL};
    size_t width = m->seen.east - m->seen.west, height = m->seen.north - m->seen.south;
    TRY(asdic_raster_init(m->ctx, width, height, &raster));
    for (size_t row = 0; row < height; row++) {
        const double *from = m->sum + (m->seen.north - 1 - row) * m->columns; /* north up */
        for (size_t column = 0; column < width; column++) {
            double level_db = from[m->seen.west + column];
            asdic_raster_set(&raster, column, row,
                             asdic_raster_color(look, level_db, 1.0, EMPTY_RGB));
        }
    }
    asdic_status status = asdic_raster_write(m->ctx, path, &raster, texts);
    asdic_raster_finish(&raster);
    return status == ASDIC_OK ? write_world(m, path) : status;
}

/* A beam hears what lies upright to its aperture's horizontal side, at any height. The apertures of a fan
 * in one plane have their uprights in common: a beam is a bearing about these, which is not one about
 * the sonar's z axis if the plane is tilted. */
static asdic_mat3 find_axes(const asdic_sonar *sonar) {
    asdic_mat3 fan = asdic_face_mount(&sonar->receivers[sonar->receiver_count / 2]);
    for (size_t b = 0; b < sonar->receiver_count; b++) {
        asdic_mat3 beam = asdic_face_mount(&sonar->receivers[b]);
        double cosine =
            beam.m[0][2] * fan.m[0][2] + beam.m[1][2] * fan.m[1][2] + beam.m[2][2] * fan.m[2][2];
        if (cosine < SAME_UPRIGHT_COSINE || fan.m[2][2] <= 0.0) { /* or upside down */
            return asdic_mat3_attitude(0.0, 0.0, 0.0); /* a cone about the sonar's z axis */
        }
    }
    return fan;
}

static asdic_status find_edges(mosaic *m) {
    const asdic_sonar *sonar = m->info.sonar;
    double *bearing_rad = malloc(m->info.beams * sizeof *bearing_rad);
    m->edges_rad = malloc((m->info.beams + 1) * sizeof *m->edges_rad);
    bool good = bearing_rad && m->edges_rad;
    bool descends = asdic_beams_descend(sonar->receivers, m->info.beams);
    m->is_line = m->info.sampling.coherent;
    m->fan = m->is_line ? asdic_face_mount(&sonar->array.element) : find_axes(sonar);
    for (size_t b = 0; good && b < m->info.beams; b++) {
        asdic_mat3 beam = asdic_face_mount(&sonar->receivers[b]);
        asdic_vec3 ahead = {beam.m[0][0], beam.m[1][0], beam.m[2][0]};
        asdic_vec3 along = asdic_mat3_apply_inverse(m->fan, ahead);
        bearing_rad[b] = bearing_of(m, along);
        double step_rad = b > 0 ? bearing_rad[b] - bearing_rad[b - 1] : 0.0;
        if (descends ? step_rad > 0.0 : step_rad < 0.0) { /* past astern */
            bearing_rad[b] += descends ? -2.0 * ASDIC_PI : 2.0 * ASDIC_PI;
        }
    }
    if (good) {
        asdic_fan_edges(&(asdic_fan){.bearing_rad = bearing_rad, .beams = m->info.beams},
                        m->edges_rad);
    }
    free(bearing_rad);
    return good ? ASDIC_OK : asdic_fail_memory(m->ctx, "bearings");
}

static asdic_status lay(mosaic *m, const asdic_render_options *options) {
    asdic_picture_options look = {
        .db_low = options->db_low, .db_high = options->db_high, .colormap = options->colormap};
    asdic_record record;
    TRY(find_extent(m));
    TRY(asdic_chart_data_read(m->ctx, m->run->folder, &m->data));
    m->ground = (asdic_seafloor){.relief = &m->data.relief, .plane_depth_m = INFINITY};
    TRY(asdic_run_read(m->run, 0, &record));
    bool is_given = options->tvg_db_per_decade != 0.0 || options->tvg_db_per_m != 0.0;
    m->db_per_decade = is_given ? options->tvg_db_per_decade : DB_PER_DECADE;
    m->db_per_m = is_given
                      ? options->tvg_db_per_m
                      : 2e-3 * asdic_environment_absorption_db_per_km(m->info.environment,
                                                                      m->info.sonar->frequency_hz,
                                                                      record.pose.position_m.z);
    TRY(find_edges(m));
    for (size_t i = 0; i < m->info.pings; i++) {
        TRY(asdic_step(m->ctx, "pings", i, m->info.pings));
        TRY(asdic_run_read(m->run, i, &record));
        add_record(m, &record);
    }
    find_seen(m);
    TRY(to_levels(m, &look));
    TRY(asdic_picture_check(m->ctx, &look));
    return write(m, options->path, &look);
}

asdic_status asdic_run_mosaic(asdic_context *ctx, const char *folder, double cell_m,
                              const asdic_render_options *options) {
    mosaic m = {.ctx = ctx, .cell_m = cell_m};
    if (!folder || !options || !options->path) {
        return asdic_fail_null(ctx, __func__);
    }
    if (!(cell_m >= 0.0 && isfinite(cell_m))) {
        return asdic_fail(ctx, ASDIC_ERROR_ARGUMENT, "a mosaic in cells of %g m", cell_m);
    }
    asdic_status status = asdic_run_open(ctx, folder, &m.run);
    if (status == ASDIC_OK) {
        m.info = asdic_run_get_info(m.run);
        m.bin_length_m = m.run->facts.bin_length_m;
        m.range_m = (double)m.info.bins * m.bin_length_m;
        status = m.info.pings == 0 || !asdic_beams_make_fan(m.info.sonar)
                     ? asdic_fail(ctx, ASDIC_ERROR_ARGUMENT,
                                  "no mosaic of '%s': it needs a ping or more, and three beams or "
                                  "more in the order of their bearings",
                                  folder)
                     : lay(&m, options);
    }
    asdic_chart_data_finish(&m.data);
    free(m.edges_rad);
    free(m.sum);
    free(m.count);
    asdic_run_close(&m.run);
    return status;
}
