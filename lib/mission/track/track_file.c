/*
 * The file of a track: read, and written row by row so that it can be read again.
 */
#include "track.h"

#include "base/columns.h"
#include "base/context.h"
#include "base/file_read.h"
#include "base/try.h"
#include "base/vec.h"
#include "out/digits.h"

#include <stdint.h>
#include <stdlib.h>
#include <string.h>

/* --- reading ---------------------------------------------------------------------------------- */

#define RADIANS (ASDIC_PI / 180.0)

static const asdic_column COLUMNS[] = {
    {"time_s", -1e12, 1e12, NULL}, {"x_m", -1e7, 1e7, NULL},
    {"y_m", -1e7, 1e7, NULL},      {"z_m", 0.0, 11000.0, "; z is positive down"},
    {"roll_deg", -1e6, 1e6, NULL}, {"pitch_deg", -1e6, 1e6, NULL},
    {"yaw_deg", -1e6, 1e6, NULL},
};
#define COLUMN_COUNT (sizeof COLUMNS / sizeof *COLUMNS)
#define Z_COLUMN 3
#define HEADER "time_s,x_m,y_m,z_m,roll_deg,pitch_deg,yaw_deg"

static asdic_track *track_of(const double *rows, size_t count) {
    asdic_track *track = calloc(1, sizeof *track);
    for (size_t i = 0; track && i < count; i++) {
        const double *row = rows + i * COLUMN_COUNT;
        const track_point point = {row[0],           row[1],           row[2],          row[3],
                                   row[4] * RADIANS, row[5] * RADIANS, row[6] * RADIANS};
        if (!asdic_track_append(track, &point)) {
            asdic_track_destroy(&track);
        }
    }
    return track;
}

asdic_status asdic_track_load(asdic_context *ctx, const char *path, bool of_vehicle,
                              asdic_problems *problems, asdic_track **out) {
    asdic_column items[COLUMN_COUNT];
    memcpy(items, COLUMNS, sizeof items);
    if (!of_vehicle) { /* the middle of what floats may lie above the surface */
        items[Z_COLUMN] = (asdic_column){"z_m", -1e7, 1e7, NULL};
    }
    const asdic_columns columns = {items, COLUMN_COUNT, "later than",
                                   ", in metres north, east and down"};
    double *rows = NULL;
    size_t *lines = NULL, count = 0;
    *out = NULL;
    TRY(asdic_columns_read(ctx, path, &columns, problems, &rows, &lines, &count));
    *out = rows ? track_of(rows, count) : NULL;
    asdic_status status = rows && !*out ? asdic_fail_memory(ctx, "a track") : ASDIC_OK;
    free(rows);
    free(lines);
    return status;
}

/* --- writing ---------------------------------------------------------------------------------- */

/* Not more digits than an attitude has, and few enough to be exact in text. A sum with 0 is never -0,
 * which a scanned head that is turned back may leave of a vehicle's roll of 0. */
static double nanodegrees(double angle_rad) {
    return rint(angle_rad / RADIANS * 1e9) / 1e9 + 0.0;
}

double asdic_track_round(double angle_rad) {
    return nanodegrees(angle_rad) * RADIANS;
}

void asdic_track_file_begin(asdic_file *file, const asdic_sweep *sweep) {
    fprintf(asdic_file_stream(file), HEADER "%s\n", sweep->directions ? ",head_deg" : "");
}

void asdic_track_file_add(asdic_file *file, const asdic_sweep *sweep, uint64_t ping, double time_s,
                          const asdic_pose *vehicle) {
    FILE *out = asdic_file_stream(file);
    double head_rad = asdic_sweep_bearing_rad(sweep, asdic_sweep_direction(sweep, ping));
    const double values[] = {time_s,
                             vehicle->position_m.x,
                             vehicle->position_m.y,
                             vehicle->position_m.z,
                             nanodegrees(vehicle->roll_rad),
                             nanodegrees(vehicle->pitch_rad),
                             nanodegrees(vehicle->yaw_rad),
                             nanodegrees(head_rad)};
    size_t count = sweep->directions ? 8 : 7;
    for (size_t k = 0; k < count; k++) {
        char digits[ASDIC_DIGITS_SIZE];
        asdic_digits_double(digits, values[k]);
        fputs(digits, out);
        fputc(k + 1 < count ? ',' : '\n', out);
    }
}

asdic_status asdic_track_file_append(asdic_context *ctx, asdic_file *file, const char *path) {
    char *text = NULL;
    size_t length;
    TRY(asdic_file_read(ctx, path, SIZE_MAX, &text, &length));
    const char *points = strchr(text, '\n');
    if (points) {
        fputs(points + 1, asdic_file_stream(file));
    }
    free(text);
    return ASDIC_OK;
}
