/*
 * The file of a track: read, and written row by row so that it can be read again.
 */
#include "track.h"

#include "base/context.h"
#include "base/number.h"
#include "base/problems.h"
#include "base/vec.h"
#include "base/words.h"
#include "out/digits.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* --- reading ---------------------------------------------------------------------------------- */

#define MAX_FIELDS 64

typedef struct track_column {
    const char *name;
    size_t offset; /* in track_point */
    double min, max, factor;
} track_column;

#define AT(member) offsetof(track_point, member)
#define RADIANS (ASDIC_PI / 180.0)
static const track_column COLUMNS[] = {
    {"time_s", AT(time_s), -1e12, 1e12, 1.0},
    {"x_m", AT(x_m), -1e7, 1e7, 1.0},
    {"y_m", AT(y_m), -1e7, 1e7, 1.0},
    {"z_m", AT(z_m), 0.0, 11000.0, 1.0},
    {"roll_deg", AT(roll_rad), -1e6, 1e6, RADIANS},
    {"pitch_deg", AT(pitch_rad), -1e6, 1e6, RADIANS},
    {"yaw_deg", AT(yaw_rad), -1e6, 1e6, RADIANS},
};
#define COLUMN_COUNT (sizeof COLUMNS / sizeof *COLUMNS)
#define HEADER "time_s,x_m,y_m,z_m,roll_deg,pitch_deg,yaw_deg"

typedef struct track_reader {
    asdic_problems problems;
    asdic_track *track;
    unsigned line, last_line;   /* this one, and that of the point before it */
    size_t field_count;         /* of the header */
    size_t place[COLUMN_COUNT]; /* the field that holds each column */
} track_reader;

/* A field without the blanks and quotes round it. */
typedef struct field {
    const char *text;
    size_t length;
    unsigned column; /* from 1 */
} field;

/* Cuts LINE at its commas; returns the number of fields, of which at most MAX_FIELDS are kept. */
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
        if (count < MAX_FIELDS) {
            fields[count] = (field){from, (size_t)(to - from), (unsigned)(from - line) + 1};
        }
        count++;
        at = end;
        if (*at == '\0') {
            return count;
        }
    }
}

static void report_missing_column(track_reader *r, const char *name, const field *fields) {
    char words[MAX_FIELDS][32];
    const char *others[MAX_FIELDS];
    size_t count = 0;
    for (size_t i = 0; i < r->field_count; i++) {
        bool known = false;
        snprintf(words[i], sizeof words[i], "%.*s", (int)fields[i].length, fields[i].text);
        for (size_t c = 0; c < COLUMN_COUNT; c++) {
            known |= strcmp(words[i], COLUMNS[c].name) == 0;
        }
        if (!known) {
            others[count++] = words[i];
        }
    }
    size_t nearest = asdic_words_nearest(name, others, count);
    bool found = nearest < count;
    asdic_problems_add(&r->problems, r->line, 1,
                       "missing column '%s'%s%s%s; the header is " HEADER " in any order", name,
                       found ? ", perhaps '" : "", found ? others[nearest] : "", found ? "'" : "");
}

static bool is_column(const field *f, const char *name) {
    return strlen(name) == f->length && memcmp(name, f->text, f->length) == 0;
}

static bool has_any_column(const track_reader *r, const field *fields) {
    for (size_t i = 0; i < r->field_count; i++) {
        for (size_t c = 0; c < COLUMN_COUNT; c++) {
            if (is_column(&fields[i], COLUMNS[c].name)) {
                return true;
            }
        }
    }
    return false;
}

static void read_header(track_reader *r, const char *line) {
    field fields[MAX_FIELDS];
    r->field_count = split(line, fields);
    if (strchr(line, '\r')) {
        asdic_problems_add(&r->problems, r->line, 1,
                           "lines end in carriage returns alone; they must in line feeds");
        return;
    }
    if (r->field_count > MAX_FIELDS) {
        asdic_problems_add(&r->problems, r->line, 1, "%zu columns, at most %d are possible",
                           r->field_count, MAX_FIELDS);
        return;
    }
    if (r->field_count == 1 && strchr(line, ';')) {
        asdic_problems_add(&r->problems, r->line, 1,
                           "columns are separated by semicolons; they must be by commas");
        return;
    }
    if (!has_any_column(r, fields)) {
        double value;
        bool is_data = asdic_number_parse(fields[0].text, fields[0].length, &value) == NULL;
        asdic_problems_add(&r->problems, r->line, 1,
                           is_data ? "there is no header; the first line must be " HEADER
                                   : "no column of a track; the header is " HEADER " in any order, "
                                     "in metres north, east and down");
        return;
    }
    for (size_t c = 0; c < COLUMN_COUNT; c++) {
        size_t found = 0;
        for (size_t i = 0; i < r->field_count; i++) {
            if (!is_column(&fields[i], COLUMNS[c].name)) {
                continue;
            }
            if (found++) {
                asdic_problems_add(&r->problems, r->line, fields[i].column,
                                   "column '%s' is there twice", COLUMNS[c].name);
            }
            r->place[c] = i;
        }
        if (found == 0) {
            report_missing_column(r, COLUMNS[c].name, fields);
        }
    }
}

/* One value into POINT; false after a report. */
static bool read_field(track_reader *r, const track_column *column, const field *f,
                       track_point *point) {
    double value = 0.0;
    const char *why = f->length == 0 ? "is empty" : asdic_number_parse(f->text, f->length, &value);
    int shown = f->length > 40 ? 40 : (int)f->length;
    if (why) {
        asdic_problems_add(&r->problems, r->line, f->column, "'%s'%s%.*s %s", column->name,
                           shown ? " = " : "", shown, f->text, why);
        return false;
    }
    if (!(value >= column->min && value <= column->max)) {
        asdic_problems_add(&r->problems, r->line, f->column,
                           "'%s' = %.*s is out of range [%.15g, %.15g]%s", column->name, shown,
                           f->text, column->min, column->max,
                           column->offset == AT(z_m) && value < 0 ? "; z is positive down" : "");
        return false;
    }
    *(double *)((char *)point + column->offset) = value * column->factor;
    return true;
}

static void read_row(track_reader *r, const char *line) {
    field fields[MAX_FIELDS];
    size_t count = split(line, fields);
    if (count != r->field_count) {
        asdic_problems_add(&r->problems, r->line, 1, "%zu fields, but the header has %zu", count,
                           r->field_count);
        return;
    }
    track_point point;
    bool good = true;
    for (size_t c = 0; c < COLUMN_COUNT; c++) {
        good &= read_field(r, &COLUMNS[c], &fields[r->place[c]], &point);
    }
    if (!good) {
        return;
    }
    asdic_track *track = r->track;
    if (track->count > 0 && !(point.time_s > track->points[track->count - 1].time_s)) {
        const field *f = &fields[r->place[0]];
        asdic_problems_add(&r->problems, r->line, f->column,
                           "'time_s' = %.*s is not later than %.15g at line %u",
                           f->length > 40 ? 40 : (int)f->length, f->text,
                           track->points[track->count - 1].time_s, r->last_line);
        return;
    }
    r->last_line = r->line;
    if (!asdic_track_append(track, &point)) {
        r->problems.out_of_memory = true;
    }
}

/* Header and rows of FILE; goes on after a bad row, not after a bad header. */
static void read_lines(track_reader *r, FILE *file) {
    char *line = NULL;
    size_t capacity = 0;
    ssize_t length;
    while (!r->problems.out_of_memory && (length = getline(&line, &capacity, file)) >= 0) {
        char *text = line;
        r->line++;
        if (memchr(line, '\0', (size_t)length)) {
            asdic_problems_add(&r->problems, r->line, 1, "not a text file: a zero byte");
            break;
        }
        while (length > 0 && (line[length - 1] == '\n' || line[length - 1] == '\r')) {
            line[--length] = '\0';
        }
        text += r->line == 1 ? asdic_utf8_mark(text, (size_t)length) : 0;
        if (text[strspn(text, " \t")] == '\0') {
            continue;
        }
        if (r->field_count > 0) {
            read_row(r, text);
            continue;
        }
        read_header(r, text);
        if (r->problems.total > 0) {
            break;
        }
    }
    if (ferror(file)) {
        asdic_problems_add(&r->problems, 0, 0, "cannot read: %s", strerror(errno));
    } else if (r->problems.total == 0 && r->track->count == 0) {
        asdic_problems_add(&r->problems, r->line + 1, 1,
                           r->field_count > 0 ? "no points below the header"
                                              : "the file is empty; its header is " HEADER);
    }
    free(line);
}

asdic_status asdic_track_load(asdic_context *ctx, const char *path, asdic_track **out) {
    track_reader r = {.problems = {.name = path}};
    *out = NULL;
    asdic_status status = ASDIC_OK;
    FILE *file = fopen(path, "rb");
    if (!file) {
        return asdic_fail(ctx, ASDIC_ERROR_INPUT, "%s: cannot open: %s", path, strerror(errno));
    }
    r.track = calloc(1, sizeof *r.track);
    if (!r.track) {
        status = asdic_fail_memory(ctx, "a track");
        goto fail;
    }
    read_lines(&r, file);
    status = asdic_problems_report(&r.problems, ctx);
    if (status != ASDIC_OK) {
        goto fail;
    }
    *out = r.track;
    r.track = NULL;
fail:
    asdic_track_destroy(&r.track);
    asdic_problems_finish(&r.problems);
    fclose(file);
    return status;
}

/* --- writing ---------------------------------------------------------------------------------- */

#define RADIANS (ASDIC_PI / 180.0)

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
