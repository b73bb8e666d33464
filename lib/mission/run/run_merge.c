#include <asdic/run.h>

#include "base/context.h"
#include "out/csv.h"
#include "run_files.h"
#include "run_folder.h"
#include "run_open.h"
#include "run_render.h"
#include "run_scenery.h"
#include "mission/track/track.h"

#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

typedef struct merger {
    asdic_context *ctx;
    asdic_run **parts; /* by first ping */
    size_t count;
    const char *folder;
    asdic_run_facts facts; /* of the whole */
    asdic_store *store;
    asdic_csv *csv;
    asdic_files *files;
    asdic_file *track;
    asdic_digest *digest;
} merger;

static int by_first_ping(const void *a, const void *b) {
    size_t x = (*(asdic_run *const *)a)->facts.first_ping;
    size_t y = (*(asdic_run *const *)b)->facts.first_ping;
    return (x > y) - (x < y);
}

static asdic_status open_parts(merger *m, const char *const *folders) {
    for (size_t i = 0; i < m->count; i++) {
        asdic_status status = asdic_run_open(m->ctx, folders[i], &m->parts[i]);
        if (status != ASDIC_OK) {
            return status;
        }
    }
    qsort(m->parts, m->count, sizeof *m->parts, by_first_ping);
    return ASDIC_OK;
}

/* Results do not replace what they are made of. */
static asdic_status check_folder(const merger *m) {
    struct stat out, part;
    if (stat(m->folder, &out) != 0) {
        return ASDIC_OK; /* it will be created */
    }
    for (size_t i = 0; i < m->count; i++) {
        if (stat(m->parts[i]->folder, &part) == 0 && part.st_dev == out.st_dev &&
            part.st_ino == out.st_ino) {
            return asdic_fail(m->ctx, ASDIC_ERROR_ARGUMENT,
                              "'%s' is one of the runs to be joined; choose another folder",
                              m->folder);
        }
    }
    return ASDIC_OK;
}

/* The parts follow on each other without gaps and overlaps, and are of one mission. */
static asdic_status check_parts(const merger *m) {
    for (size_t i = 0; i < m->count; i++) {
        const asdic_run *part = m->parts[i], *before = i ? m->parts[i - 1] : NULL;
        asdic_run_info info = asdic_run_get_info(part);
        if (info.pings < info.pings_planned) {
            return asdic_fail(m->ctx, ASDIC_ERROR_INPUT,
                              "'%s' has %zu of %zu pings; finish it by --resume first",
                              part->folder, info.pings, info.pings_planned);
        }
        if (!before) {
            continue;
        }
        const char *difference = asdic_run_facts_differ(&before->facts, &part->facts);
        if (difference) {
            return asdic_fail(m->ctx, ASDIC_ERROR_INPUT, "'%s' and '%s' differ in their %s",
                              before->folder, part->folder, difference);
        }
        size_t next = before->facts.first_ping + before->facts.pings_planned;
        if (info.first_ping != next) {
            return asdic_fail(m->ctx, ASDIC_ERROR_INPUT,
                              "'%s' ends before ping %zu, but '%s' begins with ping %zu",
                              before->folder, next, part->folder, info.first_ping);
        }
    }
    return ASDIC_OK;
}

static asdic_status sum_up(merger *m, asdic_arena *arena) {
    asdic_run_facts *f = &m->facts;
    size_t device_count = 0;
    *f = m->parts[0]->facts;
    f->state = ASDIC_RUN_STOPPED;
    f->pings_planned = 0;
    for (size_t i = 0; i < m->count; i++) {
        f->pings_planned += m->parts[i]->facts.pings_planned;
        device_count += m->parts[i]->facts.device_count;
    }
    /* Times add up: what the whole took of one machine. */
    f->times = (asdic_run_times){0};
    f->devices = asdic_arena_alloc(arena, (device_count + 1) * sizeof *f->devices);
    f->device_count = 0;
    if (!f->devices) {
        return asdic_fail_memory(m->ctx, "device names");
    }
    for (size_t i = 0; i < m->count; i++) {
        const asdic_run_facts *part = &m->parts[i]->facts;
        f->times.setup_s += part->times.setup_s;
        f->times.simulate_s += part->times.simulate_s;
        f->times.devices_s += part->times.devices_s;
        f->times.write_s += part->times.write_s;
        f->times.pictures_s += part->times.pictures_s;
        f->times.whole_s += part->times.whole_s;
        for (size_t k = 0; k < part->device_count; k++) {
            bool is_listed = false;
            for (size_t n = 0; n < f->device_count; n++) {
                is_listed = is_listed || strcmp(f->devices[n], part->devices[k]) == 0;
            }
            if (!is_listed) {
                f->devices[f->device_count++] = part->devices[k];
            }
        }
    }
    return ASDIC_OK;
}

static asdic_status copy_records(merger *m) {
    asdic_status status = ASDIC_OK;
    for (size_t i = 0; i < m->count && status == ASDIC_OK; i++) {
        asdic_run *part = m->parts[i];
        for (size_t k = 0; k < part->facts.pings_planned && status == ASDIC_OK; k++) {
            asdic_record record; /* read as one, so that damage is noticed */
            status = asdic_run_read(part, k, &record);
            if (status == ASDIC_OK) {
                status = asdic_store_append(m->store, part->buffer);
            }
            if (status == ASDIC_OK) {
                asdic_track_file_add(m->track, record.time_s, &record.pose);
                status = asdic_csv_add(m->csv, &record);
            }
            if (status == ASDIC_OK) {
                status = asdic_files_add(m->files, &record);
                asdic_digest_add(m->digest, &record);
            }
        }
    }
    return status;
}

static asdic_status open_files(merger *m) {
    const asdic_mission *settings = m->parts[0]->settings;
    char *csv = asdic_folder_path(m->folder, "bins", "", "csv");
    char *track = asdic_folder_path(m->folder, "track", "", "csv");
    asdic_status status =
        csv && track ? asdic_csv_create(m->ctx, csv, asdic_mission_sonar(settings), m->facts.bins,
                                        asdic_mission_output(settings)->csv, &m->csv)
                     : asdic_fail_memory(m->ctx, "a file name");
    if (status == ASDIC_OK) {
        status = asdic_file_create(m->ctx, track, &m->track);
    }
    if (status == ASDIC_OK) {
        asdic_record first;
        status = asdic_run_read(m->parts[0], 0, &first);
        if (status == ASDIC_OK) {
            status = asdic_files_create(m->ctx, m->folder, settings, &m->facts,
                                        first.pose.position_m.z, &m->files);
        }
    }
    free(csv);
    free(track);
    return status;
}

static asdic_status write_run(merger *m) {
    const asdic_mission *settings = m->parts[0]->settings;
    asdic_status status = open_files(m);
    if (status == ASDIC_OK) {
        asdic_track_file_begin(m->track);
        status = asdic_store_open(m->ctx, m->folder, ASDIC_STORE_CREATE, m->facts.beams,
                                  m->facts.bins, &m->store);
    }
    if (status == ASDIC_OK) {
        status = asdic_digest_create_all(m->ctx, settings, &m->facts, &m->digest);
    }
    if (status == ASDIC_OK) {
        status = copy_records(m);
    }
    if (status == ASDIC_OK) {
        status = asdic_store_commit(m->store);
    }
    if (status == ASDIC_OK) {
        status = asdic_csv_commit(&m->csv);
    }
    if (status == ASDIC_OK) {
        status = asdic_file_commit(&m->track);
    }
    if (status == ASDIC_OK) {
        status = asdic_files_commit(&m->files);
    }
    if (status == ASDIC_OK) {
        status = asdic_scenery_copy(m->ctx, m->parts[0]->folder, m->folder);
    }
    return status;
}

static asdic_status conclude(merger *m) {
    asdic_run_facts *f = &m->facts;
    asdic_digest_end(m->digest);
    f->pings = asdic_store_count(m->store);
    asdic_run_facts_survey(f, &m->digest->survey);
    f->rays_per_s = (double)f->rays_traced / f->times.simulate_s;
    asdic_status status = asdic_run_facts_write(m->ctx, m->folder, f);
    if (status == ASDIC_OK && asdic_mission_output(m->parts[0]->settings)->images) {
        asdic_render_options options = asdic_render_options_default();
        status = asdic_run_render_digest(m->ctx, m->folder, &options, m->digest);
    }
    f->state = ASDIC_RUN_COMPLETE;
    return status == ASDIC_OK ? asdic_run_facts_write(m->ctx, m->folder, f) : status;
}

asdic_status asdic_run_merge(asdic_context *ctx, const char *const *folders, size_t count,
                             const char *out_folder, bool force) {
    if (count == 0 || !out_folder) {
        return asdic_fail(ctx, ASDIC_ERROR_ARGUMENT, "asdic_run_merge: nothing to join");
    }
    merger m = {.ctx = ctx, .count = count, .folder = out_folder};
    asdic_arena arena = {0};
    asdic_status status = ASDIC_OK;
    m.parts = calloc(count, sizeof *m.parts);
    if (!m.parts) {
        return asdic_fail_memory(ctx, "a list of runs");
    }
    status = open_parts(&m, folders);
    if (status == ASDIC_OK) {
        status = check_parts(&m);
    }
    if (status == ASDIC_OK) {
        status = check_folder(&m);
    }
    if (status == ASDIC_OK) {
        status = sum_up(&m, &arena);
    }
    /* Only now: a wrong part must not cost an earlier result. */
    if (status == ASDIC_OK) {
        status = asdic_folder_prepare(ctx, out_folder, force);
    }
    if (status == ASDIC_OK) {
        status = write_run(&m);
    }
    if (status == ASDIC_OK) {
        status = conclude(&m);
    }
    asdic_csv_discard(&m.csv);
    asdic_files_discard(&m.files);
    asdic_digest_destroy(&m.digest);
    asdic_file_discard(&m.track);
    asdic_store_close(&m.store);
    for (size_t i = 0; i < count; i++) {
        asdic_run_close(&m.parts[i]);
    }
    free(m.parts);
    asdic_arena_finish(&arena);
    return status;
}
