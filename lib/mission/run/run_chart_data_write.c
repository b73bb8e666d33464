#include "run_chart_data.h"

#include "base/context.h"
#include "base/file_name.h"
#include "base/file_read.h"
#include "base/try.h"
#include "base/vec.h"
#include "mission/mission.h"
#include "out/axis.h"
#include "out/digits.h"
#include "out/file.h"
#include "scene/chart.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* At most as many cells along a side of the terrain. */
#define MOST_CELLS 600
/* At most as many points of an object's route, and of all routes, and the last one of each. */
#define MOST_POINTS 512
#define MOST_POINTS_IN_ALL 262144
#define MAX_BYTES ((size_t)64 << 20)

typedef struct extent {
    double south_m, west_m, north_m, east_m;
} extent;

/* The area that the sonar reaches from any ping. */
static extent reach_of(const asdic_mission *mission) {
    extent e = {INFINITY, INFINITY, -INFINITY, -INFINITY};
    for (size_t i = 0; i < asdic_mission_ping_count(mission); i++) {
        asdic_vec3 at_m = asdic_mission_pose(mission, i, NULL).position_m;
        e.south_m = fmin(e.south_m, at_m.x);
        e.north_m = fmax(e.north_m, at_m.x);
        e.west_m = fmin(e.west_m, at_m.y);
        e.east_m = fmax(e.east_m, at_m.y);
    }
    double range_m =
        asdic_sonar_max_range_m(asdic_mission_sonar(mission), asdic_mission_speed_mps(mission));
    return (extent){e.south_m - range_m, e.west_m - range_m, e.north_m + range_m,
                    e.east_m + range_m};
}

/* Whole cells round the bottom within reach; false where there is none. */
static bool lay_out(const asdic_mission *mission, const asdic_mission_object *bottom,
                    asdic_relief *out) {
    extent e = reach_of(mission);
    e.south_m = fmax(e.south_m, bottom->min_m.x);
    e.north_m = fmin(e.north_m, bottom->max_m.x);
    e.west_m = fmax(e.west_m, bottom->min_m.y);
    e.east_m = fmin(e.east_m, bottom->max_m.y);
    double span_m = fmax(e.north_m - e.south_m, e.east_m - e.west_m);
    if (!(e.north_m > e.south_m) || !(e.east_m > e.west_m)) {
        return false;
    }
    double cell_m = asdic_axis_step(span_m, MOST_CELLS);
    double south = floor(e.south_m / cell_m), west = floor(e.west_m / cell_m);
    *out = (asdic_relief){.columns = (size_t)(ceil(e.east_m / cell_m) - west),
                          .rows = (size_t)(ceil(e.north_m / cell_m) - south),
                          .west_m = west * cell_m,
                          .south_m = south * cell_m,
                          .cell_m = cell_m};
    return true;
}

static void put_header(FILE *stream, const char *key, double value) {
    char digits[ASDIC_DIGITS_SIZE];
    asdic_digits_double(digits, value);
    fprintf(stream, "%-13s %s\n", key, digits);
}

/* As "%.3f", at a tenth of its cost. */
static void put_millimetres(FILE *stream, double depth_m) {
    char digits[ASDIC_DIGITS_SIZE];
    int64_t depth_mm = llrint(fabs(depth_m) * 1000.0), rest = depth_mm % 1000;
    asdic_digits_natural(digits, (uint64_t)(depth_mm / 1000));
    if (depth_m < 0.0 && depth_mm > 0) {
        fputc('-', stream);
    }
    fputs(digits, stream);
    fputc('.', stream);
    fputc('0' + (char)(rest / 100), stream);
    fputc('0' + (char)(rest / 10 % 10), stream);
    fputc('0' + (char)(rest % 10), stream);
}

static void put_relief(FILE *stream, const asdic_relief *r) {
    put_header(stream, "ncols", (double)r->columns);
    put_header(stream, "nrows", (double)r->rows);
    put_header(stream, "xllcorner", r->west_m);
    put_header(stream, "yllcorner", r->south_m);
    put_header(stream, "cellsize", r->cell_m);
    put_header(stream, "NODATA_value", -9999.0);
    for (size_t i = 0; i < r->rows * r->columns; i++) {
        if (isfinite(r->depth_m[i])) {
            put_millimetres(stream, (double)r->depth_m[i]);
        } else {
            fputs("-9999", stream);
        }
        fputc((i + 1) % r->columns == 0 ? '\n' : ' ', stream);
    }
}

static asdic_status write_terrain(asdic_context *ctx, const asdic_mission *mission,
                                  const char *path) {
    const asdic_mission_object *bottom = asdic_mission_bottom_mesh(mission);
    asdic_relief relief;
    asdic_file *file = NULL;
    if (!bottom || !lay_out(mission, bottom, &relief)) {
        return ASDIC_OK;
    }
    relief.depth_m = malloc(relief.columns * relief.rows * sizeof *relief.depth_m);
    if (!relief.depth_m) {
        return asdic_fail_memory(ctx, "the terrain's chart");
    }
    asdic_chart_relief(asdic_mission_scene(mission), &relief);
    asdic_status status = asdic_file_create(ctx, path, &file);
    if (!status) {
        put_relief(asdic_file_stream(file), &relief);
        status = asdic_file_commit(&file);
    }
    free(relief.depth_m);
    return status;
}

static void put_outlines(FILE *stream, const asdic_outline *outlines, size_t count) {
    fputs("object,outline,x_m,y_m\n", stream);
    for (size_t i = 0; i < count; i++) {
        for (size_t k = 0; k < outlines[i].count; k++) {
            char x[ASDIC_DIGITS_SIZE], y[ASDIC_DIGITS_SIZE];
            asdic_digits_print(x, "%.3f", outlines[i].north_m[k]);
            asdic_digits_print(y, "%.3f", outlines[i].east_m[k]);
            fprintf(stream, "%s,%zu,%s,%s\n", outlines[i].name, i, x, y);
        }
    }
}

static asdic_status write_objects(asdic_context *ctx, const asdic_mission *mission,
                                  const char *path) {
    asdic_outline *outlines = NULL;
    asdic_file *file = NULL;
    size_t count = 0;
    TRY(asdic_chart_outlines(ctx, asdic_mission_scene(mission), &outlines, &count));
    if (count == 0) {
        return ASDIC_OK;
    }
    asdic_status status = asdic_file_create(ctx, path, &file);
    if (!status) {
        put_outlines(asdic_file_stream(file), outlines, count);
        status = asdic_file_commit(&file);
    }
    free(outlines);
    return status;
}

static void put_route(FILE *stream, const asdic_mission *mission, size_t object) {
    size_t most = MOST_POINTS_IN_ALL / mission->motion_count;
    most = most < MOST_POINTS ? most : MOST_POINTS;
    size_t last = asdic_mission_ping_count(mission) - 1, every = last / most + 1;
    for (size_t i = 0; i <= last; i = i + every < last || i == last ? i + every : last) {
        double time_s;
        char time[ASDIC_DIGITS_SIZE], x[ASDIC_DIGITS_SIZE], y[ASDIC_DIGITS_SIZE];
        char yaw[ASDIC_DIGITS_SIZE];
        asdic_mission_pose(mission, i, &time_s);
        asdic_pose pose = asdic_mission_object_pose(mission, object, i);
        asdic_digits_double(time, time_s);
        asdic_digits_print(x, "%.3f", pose.position_m.x);
        asdic_digits_print(y, "%.3f", pose.position_m.y);
        asdic_digits_print(yaw, "%.3f", pose.yaw_rad * 180.0 / ASDIC_PI);
        fprintf(stream, "%s,%s,%s,%s,%s\n", asdic_mission_get_object(mission, object)->name, time,
                x, y, yaw);
    }
}

static asdic_status write_routes(asdic_context *ctx, const asdic_mission *mission,
                                 const char *path) {
    asdic_file *file = NULL;
    for (size_t i = 0; i < asdic_mission_object_count(mission); i++) {
        if (!asdic_mission_get_object(mission, i)->moves) {
            continue;
        }
        if (!file) {
            TRY(asdic_file_create(ctx, path, &file));
            fputs("object,time_s,x_m,y_m,yaw_deg\n", asdic_file_stream(file));
        }
        put_route(asdic_file_stream(file), mission, i);
    }
    return file ? asdic_file_commit(&file) : ASDIC_OK;
}

asdic_status asdic_chart_data_write(asdic_context *ctx, const asdic_mission *mission,
                                    const char *folder) {
    TRY(write_terrain(ctx, mission, asdic_file_in(folder, "terrain.asc").text));
    TRY(write_objects(ctx, mission, asdic_file_in(folder, "objects.csv").text));
    return write_routes(ctx, mission, asdic_file_in(folder, "routes.csv").text);
}

static asdic_status copy(asdic_context *ctx, const char *source, const char *target) {
    char *bytes = NULL;
    size_t length;
    if (access(source, F_OK) != 0) {
        return ASDIC_OK;
    }
    TRY(asdic_file_read(ctx, source, MAX_BYTES, &bytes, &length));
    asdic_status status = asdic_file_write_all(ctx, target, bytes, length);
    free(bytes);
    return status;
}

asdic_status asdic_chart_data_copy(asdic_context *ctx, const char *from, const char *to) {
    static const char *const parts[] = {"terrain.asc", "objects.csv", "routes.csv"};
    for (size_t i = 0; i < sizeof parts / sizeof *parts; i++) {
        TRY(copy(ctx, asdic_file_in(from, parts[i]).text, asdic_file_in(to, parts[i]).text));
    }
    return ASDIC_OK;
}
