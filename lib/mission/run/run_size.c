#include "run_size.h"

#include "base/clock.h"
#include "base/context.h"
#include "base/try.h"
#include "mission/mission.h"
#include "out/format.h"
#include "run_files.h"
#include "run_folder.h"
#include "run_store.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/statvfs.h>

/* As measured, of three to five digits of bins and pings: a row of the long CSV, a level of the
 * wide one. */
#define LONG_ROW_BYTES 95
#define WIDE_LEVEL_BYTES 11

/* --- how much --------------------------------------------------------------------------------- */

static size_t bins_of(const asdic_mission *m) {
    double depth_m = asdic_mission_pose(m, 0, NULL).position_m.z;
    return asdic_sonar_bin_count(
        &m->settings.sonar, asdic_environment_sound_speed_mps(&m->settings.environment, depth_m));
}

uint64_t asdic_mission_ping_bytes(const asdic_mission *mission) {
    if (!mission) {
        return 0;
    }
    asdic_plan plan;
    const asdic_output_options *output = &mission->settings.output;
    size_t beams = mission->settings.sonar.receiver_count, bins = bins_of(mission), each = 0;
    each += output->csv == ASDIC_CSV_LONG ? LONG_ROW_BYTES : 0;
    each += output->csv == ASDIC_CSV_WIDE ? WIDE_LEVEL_BYTES : 0;
    for (size_t i = 0; i < ASDIC_FORMAT_COUNT; i++) {
        each += output->formats & 1u << i ? asdic_formats[i]->level_bytes : 0;
    }
    unsigned left_out = 0;
    if (mission->settings.records == ASDIC_RECORD_COMPACT &&
        asdic_mission_plan(NULL, mission, &plan) == ASDIC_OK) {
        left_out = plan.left_out;
    }
    const asdic_record_layout layout =
        asdic_store_layout(&mission->settings, beams, bins, left_out);
    return asdic_record_stored_bytes(&layout) + (uint64_t)beams * bins * each;
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

/* What an earlier call left of FOLDER/NAME. */
static uint64_t bytes_there(const char *folder, const char *name) {
    struct stat st;
    char *path = asdic_folder_file(folder, name);
    uint64_t bytes = path && stat(path, &st) == 0 ? (uint64_t)st.st_size : 0;
    free(path);
    return bytes;
}

asdic_status asdic_run_check_room(asdic_context *ctx, const asdic_mission *mission,
                                  const asdic_run_options *o) {
    size_t pings = asdic_mission_ping_count(mission);
    if (!o->folder || o->force || o->first >= pings) {
        return ASDIC_OK;
    }
    size_t count = o->count < pings - o->first ? o->count : pings - o->first;
    uint64_t each = asdic_mission_ping_bytes(mission), needed = count * each;
    uint64_t left = asdic_disk_free_bytes(o->folder);
    uint64_t there =
        !o->resume ? 0
                   : bytes_there(o->folder, "pings.npy.part") + bytes_there(o->folder, "pings.npy");
    if (needed <= there || needed - there <= left) {
        return ASDIC_OK;
    }
    return asdic_fail(ctx, ASDIC_ERROR_IO,
                      "'%s' has room for %.3g GB, but %zu pings of %.3g MB take %.3g GB; choose "
                      "another disk by --output, fewer pings by --pings, less under 'output' in "
                      "the scene, or --force",
                      o->folder, 1e-9 * (double)left, count, 1e-6 * (double)each,
                      1e-9 * (double)(needed - there));
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
    void *bytes = malloc(asdic_record_bytes(ping->beams, ping->bins));
    asdic_status status = bytes ? asdic_store_open(ctx, folder, ASDIC_STORE_CREATE, &shape, &store)
                                : asdic_fail_memory(ctx, "a record");
    if (!status) {
        double depth_m = asdic_mission_pose(m, 0, NULL).position_m.z;
        status = asdic_files_create(ctx, folder, &m->settings, &facts, depth_m, &files);
    }
    if (!status) {
        status = time_files(store, files, ping->beams, ping->bins, ping, bytes, seconds);
    }
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
    asdic_folder_remove(ctx, folder);
    return status;
}
