
#include "base/clock.h"
#include "base/context.h"
#include "base/file_name.h"
#include "base/number.h"
#include "base/try.h"
#include "mission/mission.h"
#include "out/format.h"
#include "run_elements.h"
#include "run_files.h"
#include "out/digits.h"
#include "run_folder.h"
#include "run_picture.h"
#include "run_store.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/statvfs.h>

/* As measured, of data/scenes: the digits of "%.9g" of a level of 10 to 100 dB and of an error; how
 * much of a part's fields is filled where the scene has it. */
#define LEVEL_DIGITS 9.89
#define ERROR_DIGITS 10.5
static const double filled[ASDIC_COMPONENT_COUNT] = {
    [ASDIC_TOTAL] = 1.0,   [ASDIC_BOTTOM] = 0.75, [ASDIC_SURFACE] = 0.85,  [ASDIC_VOLUME] = 0.99,
    [ASDIC_OBJECT] = 0.15, [ASDIC_NOISE] = 1.0,   [ASDIC_MULTIPATH] = 0.35};

/* Of the pictures, and of the charts of a bottom from a mesh or grid. */
static const struct {
    asdic_image image;
    uint64_t bytes;
    bool needs_two; /* pings */
} picture_sizes[] = {{ASDIC_IMAGE_WATERFALL, 100000, true},
                     {ASDIC_IMAGE_ASCOPE, 250000, false},
                     {ASDIC_IMAGE_FAN, 340000, false},
                     {ASDIC_IMAGE_OVERVIEW, 110000, true},
                     {ASDIC_IMAGE_PLAN, 300000, false}};
#define TERRAIN_BYTES 800000

/* Pings and bins whose numbers are printed to count their digits. */
#define MOST_SAMPLES 1000

/* --- how much --------------------------------------------------------------------------------- */

static size_t bins_of(const asdic_mission *m) {
    return asdic_sonar_bin_count(&m->settings.sonar, asdic_mission_speed_mps(m));
}

/* Mean length of COUNT numbers, that of number I being FIRST + I * STEP. */
static double mean_digits(double first, double step, size_t count) {
    char digits[ASDIC_DIGITS_SIZE];
    size_t every = count / MOST_SAMPLES + 1, length = 0, samples = 0;
    for (size_t i = 0; i < count; i += every, samples++) {
        length += asdic_digits_double(digits, first + (double)i * step);
    }
    return samples ? (double)length / (double)samples : 0.0;
}

/* "PING,TIME,BEAM," */
static double prefix_bytes(const asdic_mission *m) {
    size_t pings = asdic_mission_ping_count(m), every = pings / MOST_SAMPLES + 1;
    double times = 0.0, names = 0.0;
    char digits[ASDIC_DIGITS_SIZE];
    for (size_t i = 0; i < pings; i += every) {
        double time_s;
        asdic_mission_pose(m, i, &time_s);
        times += (double)asdic_digits_double(digits, time_s);
    }
    for (size_t i = 0; i < m->settings.sonar.receiver_count; i++) {
        names += (double)strlen(m->settings.sonar.receivers[i].name);
    }
    return mean_digits(0.0, 1.0, pings) + times / (double)((pings - 1) / every + 1) +
           names / (double)m->settings.sonar.receiver_count + 3.0;
}

/* Of bins.csv for each bin of each beam. */
static double csv_bytes(const asdic_mission *m, size_t bins, unsigned parts) {
    const asdic_sonar *sonar = &m->settings.sonar;
    double sign = isnan(sonar->source_level_db) || sonar->source_level_db == 0.0 ? 1.0 : 0.0;
    double level = LEVEL_DIGITS + sign, prefix = prefix_bytes(m), row = 0.0;
    if (m->settings.output.csv == ASDIC_CSV_NONE) {
        return 0.0;
    }
    if (m->settings.output.csv == ASDIC_CSV_WIDE) {
        return level + 1.0 + prefix / (double)bins;
    }
    for (int c = 0; c < ASDIC_COMPONENT_COUNT; c++) {
        bool is_there = c == ASDIC_TOTAL || (parts & 1u << c);
        row += is_there ? filled[c] * level : 0.0;
    }
    return prefix + mean_digits(0.0, 1.0, bins) +
           mean_digits(0.5 * sonar->bin_length_m, sonar->bin_length_m, bins) + 2.0 + row +
           ERROR_DIGITS + ASDIC_RECORD_ARRAYS;
}

uint64_t asdic_mission_ping_bytes(const asdic_mission *mission) {
    if (!mission) {
        return 0;
    }
    const asdic_settings *s = &mission->settings;
    size_t beams = s->sonar.receiver_count, bins = bins_of(mission), each = 0, beside = 0;
    asdic_plan plan = {.left_out = 0};
    bool needs_parts = s->records == ASDIC_RECORD_COMPACT || s->output.csv == ASDIC_CSV_LONG;
    if (needs_parts && asdic_mission_plan(NULL, mission, &plan) != ASDIC_OK) {
        plan.left_out = 0;
    }
    const asdic_record_layout layout = asdic_store_layout(s, beams, bins, plan.left_out);
    for (size_t i = 0; i < ASDIC_FORMAT_COUNT; i++) {
        const asdic_format *format = asdic_formats[i];
        if (s->output.formats & 1u << i) {
            each += format->level_bytes;
            beside += format->ping_bytes ? format->ping_bytes(&s->sonar, &s->sweep) : 0;
        }
    }
    double cells = (double)beams * (double)bins;
    asdic_elements_shape elements =
        asdic_elements_shape_of(s, 1, bins, asdic_mission_speed_mps(mission));
    return asdic_record_stored_bytes(&layout) + asdic_record_truth_bytes(&layout) + beside +
           asdic_elements_bytes(&elements) +
           (uint64_t)(cells * ((double)each + csv_bytes(mission, bins, layout.parts)));
}

/* Bytes that do not grow with the number of pings. */
static uint64_t fixed_bytes(const asdic_mission *m, size_t pings) {
    size_t beams = m->settings.sonar.receiver_count;
    bool is_fan = asdic_render_can_fan(&m->settings);
    uint64_t bytes = 0;
    for (size_t i = 0; i < sizeof picture_sizes / sizeof *picture_sizes; i++) {
        asdic_image image = picture_sizes[i].image;
        size_t count = image == ASDIC_IMAGE_WATERFALL ? (beams > ASDIC_SUMMARY_BEAMS ? 1 : beams)
                       : image == ASDIC_IMAGE_ASCOPE  ? (pings > 1 ? 2 : 1)
                       : image == ASDIC_IMAGE_FAN     ? (is_fan ? (pings > 1 ? 2 : 1) : 0)
                                                      : 1;
        bool is_drawn =
            (m->settings.output.images & 1u << image) && (pings > 1 || !picture_sizes[i].needs_two);
        bytes += is_drawn ? count * picture_sizes[i].bytes : 0;
    }
    bytes += asdic_mission_bottom_mesh(m) ? TERRAIN_BYTES : 0;
    return bytes;
}

uint64_t asdic_mission_run_bytes(const asdic_mission *mission, size_t pings) {
    size_t all = asdic_mission_ping_count(mission);
    pings = pings < all ? pings : all;
    return mission ? pings * asdic_mission_ping_bytes(mission) + fixed_bytes(mission, pings) : 0;
}

bool asdic_mission_leaves_csv_out(const asdic_mission *mission) {
    return mission && mission->settings.leaves_csv_out;
}

/* --- how much there is ------------------------------------------------------------------------ */

uint64_t asdic_disk_free_bytes(const char *folder) {
    struct statvfs disk;
    char *path = folder && *folder ? strdup(folder) : NULL;
    uint64_t bytes = UINT64_MAX;
    while (path && statvfs(path, &disk) != 0) { /* not made yet: its parent's */
        char *slash = strrchr(path, '/');
        if (strcmp(path, ".") == 0 || strcmp(path, "/") == 0) {
            free(path);
            return UINT64_MAX;
        }
        strcpy(slash == path ? path + 1 : slash ? slash : path, slash ? "" : ".");
    }
    if (path) {
        bytes = (uint64_t)disk.f_bavail * disk.f_frsize;
    }
    free(path);
    return bytes;
}

const char *asdic_bytes_text(uint64_t bytes, char text[ASDIC_BYTES_TEXT]) {
    static const char *const units[] = {"kB", "MB", "GB", "TB", "PB"};
    double value = 1e-3 * (double)bytes;
    size_t unit = 0;
    while (value >= 999.5 && unit + 1 < sizeof units / sizeof *units) {
        value *= 1e-3;
        unit++;
    }
    locale_t before = asdic_c_locale_enter();
    snprintf(text, ASDIC_BYTES_TEXT, "%.3g %s", value, units[unit]);
    asdic_c_locale_leave(before);
    return text;
}

/* What an earlier call left of FOLDER/NAME. */
static uint64_t bytes_there(const char *folder, const char *name) {
    struct stat st;
    return stat(asdic_file_in(folder, name).text, &st) == 0 ? (uint64_t)st.st_size : 0;
}

asdic_status asdic_run_check_room(asdic_context *ctx, const asdic_mission *mission,
                                  const asdic_run_options *o) {
    size_t pings = asdic_mission_ping_count(mission);
    if (!o->folder || o->force || o->first >= pings) {
        return ASDIC_OK;
    }
    size_t count = o->count < pings - o->first ? o->count : pings - o->first;
    uint64_t each = asdic_mission_ping_bytes(mission);
    uint64_t needed = asdic_mission_run_bytes(mission, count);
    uint64_t left = asdic_disk_free_bytes(o->folder);
    bool goes_on = o->resume && asdic_folder_has_run(o->folder);
    uint64_t there = goes_on ? bytes_there(o->folder, "pings.npy.part") +
                                   bytes_there(o->folder, "pings.npy") +
                                   bytes_there(o->folder, ASDIC_TRUTH_NAME ".part") +
                                   bytes_there(o->folder, ASDIC_TRUTH_NAME) +
                                   bytes_there(o->folder, ASDIC_ELEMENTS_NAME ".part") +
                                   bytes_there(o->folder, ASDIC_ELEMENTS_NAME)
                             : 0;
    if (needed <= there || needed - there <= left) {
        return ASDIC_OK;
    }
    char room[ASDIC_BYTES_TEXT], one[ASDIC_BYTES_TEXT], rest[ASDIC_BYTES_TEXT];
    asdic_bytes_text(left, room);
    asdic_bytes_text(needed - there, rest);
    if (goes_on) { /* nothing is lost when the disk is full */
        asdic_log(ctx, ASDIC_LOG_WARNING,
                  "'%s' has room for %s, but what is still to be written takes about %s", o->folder,
                  room, rest);
        return ASDIC_OK;
    }
    return asdic_fail(ctx, ASDIC_ERROR_IO,
                      "'%s' has room for %s, but %zu ping%s of %s take%s %s; choose another disk, "
                      "fewer pings, less under 'output' in the scene, or --force",
                      o->folder, room, count, count == 1 ? "" : "s", asdic_bytes_text(each, one),
                      count == 1 ? "s" : "", rest);
}

/* --- how long --------------------------------------------------------------------------------- */

/* Times a ping's way into the files, the better of two. */
static asdic_status time_files(asdic_store *store, asdic_files *files, size_t beams, size_t bins,
                               const asdic_ping *ping, void *bytes, double *seconds) {
    asdic_record_head head = {0};
    *seconds = INFINITY;
    for (int i = 0; i < 2; i++) {
        asdic_record record;
        double begin_s = asdic_clock_s();
        asdic_record_pack(&head, ping, bytes);
        TRY(asdic_store_write(store, 0, bytes));
        asdic_record_view(bytes, beams, bins, &record);
        TRY(asdic_files_add(files, &record));
        *seconds = fmin(*seconds, asdic_clock_s() - begin_s);
    }
    return ASDIC_OK;
}

static asdic_status time_in(asdic_context *ctx, const asdic_mission *m, const asdic_ping *ping,
                            const char *folder, double *seconds) {
    asdic_run_facts facts = {.scene_path = m->path,
                             .scene_hash = m->hash,
                             .version = asdic_version(),
                             .pings_planned = 2,
                             .beams = ping->beams,
                             .bins = ping->bins};
    asdic_store *store = NULL;
    asdic_files *files = NULL;
    const asdic_store_shape shape = {
        .layout = asdic_store_layout(&m->settings, ping->beams, ping->bins, 0)};
    void *bytes = calloc(1, asdic_record_bytes(ping->beams, ping->bins));
    asdic_status status = bytes ? asdic_store_open(ctx, folder, ASDIC_STORE_CREATE, &shape, &store)
                                : asdic_fail_memory(ctx, "a record");
    if (!status) {
        double depth_m = asdic_mission_pose(m, 0, NULL).position_m.z;
        status = asdic_files_create(ctx, folder, &m->settings, &facts, depth_m, &files);
    }
    status =
        status ? status : time_files(store, files, ping->beams, ping->bins, ping, bytes, seconds);
    asdic_files_destroy(&files);
    asdic_store_close(&store);
    free(bytes);
    return status;
}

asdic_status asdic_mission_time_writing(asdic_context *ctx, const asdic_mission *mission,
                                        const asdic_ping *ping, double *seconds) {
    if (!mission || !ping || !seconds) {
        return asdic_fail_null(ctx, __func__);
    }
    TRY(asdic_files_check(ctx, &mission->settings));
    const char *place = getenv("TMPDIR");
    char folder[4096];
    snprintf(folder, sizeof folder, "%s/asdic-XXXXXX", place && *place ? place : "/tmp");
    if (!mkdtemp(folder)) {
        return asdic_fail(ctx, ASDIC_ERROR_IO,
                          "cannot make a folder '%s' to time writing; set TMPDIR to one that can "
                          "be written to",
                          folder);
    }
    asdic_status status = time_in(ctx, mission, ping, folder, seconds);
    asdic_folder_remove(folder);
    return status;
}
