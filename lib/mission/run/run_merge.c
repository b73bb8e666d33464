#include <asdic/run.h>

#include "base/context.h"
#include "base/file_name.h"
#include "base/try.h"
#include "run_elements.h"
#include "run_check.h"
#include "run_files.h"
#include "run_folder.h"
#include "run_open.h"
#include "run_picture.h"
#include "run_chart_data.h"
#include "mission/track/track.h"
#include "out/file.h"

#include <stdlib.h>
#include <string.h>

typedef struct merger {
    asdic_context *ctx;
    asdic_run **parts; /* by first ping */
    size_t count;
    const char *folder;
    asdic_arena arena;
    asdic_run_facts facts; /* of the whole */
    DIR *lock;             /* of FOLDER */
    asdic_store *store;
    asdic_files *files;
    asdic_file *track;
    asdic_summary *summary;
} merger;

static int by_first_ping(const void *a, const void *b) {
    size_t x = (*(asdic_run *const *)a)->facts.first_ping;
    size_t y = (*(asdic_run *const *)b)->facts.first_ping;
    return (x > y) - (x < y);
}

static asdic_status open_parts(merger *m, const char *const *folders) {
    for (size_t i = 0; i < m->count; i++) {
        TRY(asdic_run_open(m->ctx, folders[i], &m->parts[i]));
    }
    qsort(m->parts, m->count, sizeof *m->parts, by_first_ping);
    return ASDIC_OK;
}

/* The result must not replace a part. */
static asdic_status check_folder(const merger *m) {
    for (size_t i = 0; i < m->count; i++) {
        if (asdic_file_is_same(m->parts[i]->folder, m->folder)) {
            return asdic_fail(m->ctx, ASDIC_ERROR_ARGUMENT,
                              "'%s' is one of the runs to be joined; choose another folder",
                              m->folder);
        }
    }
    return ASDIC_OK;
}

/* Checks that no part, as one made with --shard, is of more pings than the parts have together. */
static asdic_status check_whole(const merger *m) {
    const asdic_run_facts *last = &m->parts[m->count - 1]->facts;
    size_t first = m->parts[0]->facts.first_ping, end = last->first_ping + last->pings_planned;
    for (size_t i = 0; i < m->count; i++) {
        const asdic_run_facts *part = &m->parts[i]->facts;
        size_t whole_end = part->whole_first_ping + part->whole_pings;
        bool lacks_begin = part->whole_first_ping < first;
        if (lacks_begin || whole_end > end) {
            return asdic_fail(m->ctx, ASDIC_ERROR_INPUT,
                              "pings %zu to %zu are in none of the parts; '%s' is a part of pings "
                              "%zu to %zu",
                              lacks_begin ? part->whole_first_ping : end,
                              (lacks_begin ? first : whole_end) - 1, m->parts[i]->folder,
                              part->whole_first_ping, whole_end - 1);
        }
    }
    return ASDIC_OK;
}

/* Checks that the parts follow each other without gaps or overlaps and belong to one mission. */
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
        if (asdic_file_is_same(part->folder, before->folder)) {
            return asdic_fail(m->ctx, ASDIC_ERROR_INPUT, "'%s' is named twice", part->folder);
        }
        size_t next = before->facts.first_ping + before->facts.pings_planned;
        if (info.first_ping != next) {
            return asdic_fail(m->ctx, ASDIC_ERROR_INPUT,
                              "'%s' ends before ping %zu, but '%s' begins with ping %zu",
                              before->folder, next, part->folder, info.first_ping);
        }
    }
    return check_whole(m);
}

static asdic_status check_elements(const merger *m, const asdic_run *part) {
    return asdic_run_advise(
        m->ctx, asdic_run_check(m->ctx, part->folder, &part->facts, ASDIC_RUN_ELEMENTS));
}

/* Reads all that the parts are joined from, before what is in the result's folder is given up. */
static asdic_status check_records(const merger *m) {
    for (size_t i = 0; i < m->count; i++) {
        asdic_run *part = m->parts[i];
        TRY(check_elements(m, part));
        for (size_t k = 0; k < part->facts.pings_planned; k++) {
            asdic_record record;
            TRY(asdic_run_read(part, k, &record));
        }
    }
    return ASDIC_OK;
}

static asdic_status sum_up(merger *m) {
    asdic_run_facts *f = &m->facts;
    *f = m->parts[0]->facts;
    f->state = ASDIC_RUN_STOPPED;
    f->pings_planned = 0;
    f->times = (asdic_run_times){0};
    f->device_count = 0;
    for (size_t i = 0; i < m->count; i++) {
        const asdic_run_facts *part = &m->parts[i]->facts;
        f->pings_planned += part->pings_planned;
        /* what the whole run costs on one machine */
        for (size_t k = 0; k < ASDIC_RUN_TIME_COUNT; k++) {
            *asdic_run_time(&f->times, k) += *asdic_run_time(&m->parts[i]->facts.times, k);
        }
        for (size_t k = 0; k < part->device_count; k++) {
            if (!asdic_run_facts_add_device(f, &m->arena, part->devices[k])) {
                return asdic_fail_memory(m->ctx, "device names");
            }
        }
    }
    f->whole_first_ping = f->first_ping;
    f->whole_pings = f->pings_planned;
    return ASDIC_OK;
}

static asdic_status copy_records(merger *m) {
    for (size_t i = 0; i < m->count; i++) {
        asdic_run *part = m->parts[i];
        TRY(asdic_track_file_append(m->ctx, m->track,
                                    asdic_file_in(part->folder, "track.csv").text));
        for (size_t k = 0; k < part->facts.pings_planned; k++) {
            asdic_record record;
            TRY(asdic_run_read(part, k, &record));
            TRY(asdic_store_write(m->store, record.ping - m->facts.first_ping, part->buffer));
            TRY(asdic_files_add(m->files, &record));
            asdic_summary_add(m->summary, &record);
        }
    }
    return ASDIC_OK;
}

/* The pressures of all parts in one file. */
static asdic_status copy_elements(merger *m, asdic_records *to, asdic_elements_shape shape,
                                  float *pressure) {
    for (size_t i = 0; i < m->count; i++) {
        const asdic_run *part = m->parts[i];
        asdic_records *from = NULL;
        TRY(check_elements(m, part));
        shape.pings = part->facts.pings_planned;
        asdic_status status =
            asdic_elements_open(m->ctx, part->folder, ASDIC_STORE_READ, &shape, &from);
        for (size_t k = 0; !status && k < shape.pings; k++) {
            size_t at = part->facts.first_ping + k - m->facts.first_ping;
            status = asdic_records_read(from, k, pressure);
            status = status ? status : asdic_records_write(to, at, pressure);
        }
        asdic_records_close(&from);
        TRY(status);
    }
    return asdic_records_commit(to);
}

static asdic_status join_elements(merger *m) {
    const asdic_run *part = m->parts[0];
    asdic_elements_shape shape;
    TRY(check_elements(m, part));
    TRY(asdic_elements_shape_read(m->ctx, part->folder, &part->settings, &shape));
    shape.pings = m->facts.pings_planned;
    if (shape.elements == 0) {
        return ASDIC_OK;
    }
    asdic_records *to = NULL;
    float *pressure = malloc((size_t)asdic_elements_bytes(&shape));
    asdic_status status =
        pressure ? asdic_elements_open(m->ctx, m->folder, ASDIC_STORE_CREATE, &shape, &to)
                 : asdic_fail_memory(m->ctx, ASDIC_ELEMENTS_NAME);
    status = status ? status : copy_elements(m, to, shape, pressure);
    asdic_records_close(&to);
    free(pressure);
    return status;
}

static asdic_status open_files(merger *m) {
    asdic_record first;
    TRY(asdic_file_create(m->ctx, asdic_file_in(m->folder, "track.csv").text, &m->track));
    asdic_track_file_begin(m->track, &m->parts[0]->settings.sweep);
    TRY(asdic_run_read(m->parts[0], 0, &first));
    return asdic_files_create(m->ctx, m->folder, &m->parts[0]->settings, &m->facts,
                              first.pose.position_m.z, &m->files);
}

static asdic_status write_run(merger *m) {
    const asdic_run_facts *f = &m->facts;
    const asdic_store_shape shape = {
        .first_ping = f->first_ping,
        .layout = asdic_store_layout(&m->parts[0]->settings, f->beams, f->bins, f->plan.left_out)};
    TRY(open_files(m));
    TRY(asdic_store_open(m->ctx, m->folder, ASDIC_STORE_CREATE, &shape, &m->store));
    TRY(asdic_summary_create_all(m->ctx, &m->parts[0]->settings, &m->facts, &m->summary));
    TRY(copy_records(m));
    TRY(join_elements(m));
    TRY(asdic_store_commit(m->store));
    TRY(asdic_file_commit(&m->track));
    TRY(asdic_files_commit(m->files, true));
    return asdic_chart_data_copy(m->ctx, m->parts[0]->folder, m->folder);
}

static asdic_status conclude(merger *m) {
    asdic_run_facts *f = &m->facts;
    asdic_summary_end(m->summary);
    f->pings = asdic_store_count(m->store);
    asdic_run_facts_statistics(f, &m->summary->statistics);
    f->rays_per_s = (double)f->rays_traced / f->times.simulate_s;
    TRY(asdic_run_check_note(m->ctx, m->folder, &m->arena, f));
    TRY(asdic_run_facts_write(m->ctx, m->folder, f));
    if (m->parts[0]->settings.output.images) {
        asdic_render_options options = asdic_render_options_default();
        TRY(asdic_run_render_summary(m->ctx, m->folder, &options, m->summary));
    }
    TRY(asdic_folder_pictures(m->ctx, m->folder, &m->arena, &f->pictures, &f->picture_count));
    f->state = ASDIC_RUN_COMPLETE;
    return asdic_run_facts_write(m->ctx, m->folder, f);
}

static asdic_status join(merger *m, const char *const *folders, bool force) {
    TRY(open_parts(m, folders));
    TRY(check_parts(m));
    TRY(check_folder(m));
    TRY(sum_up(m));
    TRY(asdic_files_check(m->ctx, &m->parts[0]->settings));
    if (force) {
        TRY(asdic_folder_spare(m->ctx, m->folder, m->facts.scene_path, m->facts.scene_text, ""));
    }
    if (force && asdic_folder_has_run(m->folder)) {
        TRY(check_records(m));
    }
    /* Only now: a wrong part must not cost an earlier result. */
    TRY(asdic_folder_hold(m->ctx, m->folder, &m->lock));
    TRY(asdic_folder_prepare(m->ctx, m->folder, force, false));
    asdic_status status = write_run(m);
    if (status != ASDIC_OK) { /* the parts have it all: half of it is no use */
        asdic_folder_remove(m->folder);
        return status;
    }
    return conclude(m);
}

asdic_status asdic_run_merge(asdic_context *ctx, const char *const *folders, size_t count,
                             const char *out_folder, bool force) {
    TRY(asdic_folder_check_parts(ctx, __func__, folders, count, out_folder));
    merger m = {.ctx = ctx, .count = count, .folder = out_folder};
    m.parts = calloc(count, sizeof *m.parts);
    if (!m.parts) {
        return asdic_fail_memory(ctx, "a list of runs");
    }
    asdic_status status = join(&m, folders, force);
    asdic_files_destroy(&m.files);
    asdic_summary_destroy(&m.summary);
    asdic_file_discard(&m.track);
    asdic_store_close(&m.store);
    if (m.lock) {
        closedir(m.lock);
    }
    for (size_t i = 0; i < count; i++) {
        asdic_run_close(&m.parts[i]);
    }
    free(m.parts);
    asdic_arena_finish(&m.arena);
    return status;
}
