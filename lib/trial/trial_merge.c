/*
 * Parts of a trial, joined.
 */
#include "trial_folder.h"

#include "base/context.h"
#include "base/try.h"
#include "mission/run/run_folder.h"
#include "out/file.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static int by_first(const void *pa, const void *pb) {
    const asdic_trial *a = *(asdic_trial *const *)pa, *b = *(asdic_trial *const *)pb;
    return a->facts.first < b->facts.first ? -1 : a->facts.first > b->facts.first;
}

static asdic_status fail_missing(asdic_context *ctx, uint64_t first, uint64_t end) {
    return asdic_fail(ctx, ASDIC_ERROR_INPUT, "runs %llu to %llu are in no part",
                      (unsigned long long)first, (unsigned long long)(end - 1));
}

static asdic_status check_parts(asdic_context *ctx, asdic_trial **parts, size_t count) {
    for (size_t i = 1; i < count; i++) {
        const trial_facts *a = &parts[i - 1]->facts, *b = &parts[i]->facts;
        if (!asdic_trial_is_same(a, b) || strcmp(parts[i]->header, parts[i - 1]->header) != 0) {
            return asdic_fail(
                ctx, ASDIC_ERROR_INPUT,
                "these are parts of different trials: scene or its files, seed, runs, "
                "rays, rule or variants differ");
        }
        uint64_t end = a->first + a->count, own_end = b->first + b->count;
        if (b->first > end) {
            return fail_missing(ctx, end, b->first);
        }
        if (b->first < end) {
            uint64_t behind = end < own_end ? end : own_end;
            return asdic_fail(ctx, ASDIC_ERROR_INPUT, "runs %llu to %llu are in two parts",
                              (unsigned long long)b->first, (unsigned long long)(behind - 1));
        }
    }
    const trial_facts *first = &parts[0]->facts, *last = &parts[count - 1]->facts;
    uint64_t end = last->first + last->count;
    return first->first > 0   ? fail_missing(ctx, 0, first->first)
           : end < last->runs ? fail_missing(ctx, end, last->runs)
                              : ASDIC_OK;
}

static asdic_status write_parts(asdic_context *ctx, asdic_trial **parts, size_t count,
                                const char *folder) {
    asdic_text rows = {0}, header = {0};
    FILE *out = NULL;
    trial_facts whole = parts[0]->facts; /* borrowed */
    whole.count = 0;
    for (size_t i = 0; i < count; i++) {
        whole.count += parts[i]->facts.count;
        asdic_text_add(&rows, parts[i]->body);
    }
    asdic_text_add(&header, parts[0]->header);
    asdic_status status = rows.failed || header.failed
                              ? asdic_fail_memory(ctx, "a trial")
                              : asdic_trial_begin(ctx, folder, &whole, &header, &rows, false, &out);
    status = status ? status : asdic_trial_end(ctx, folder, &out);
    asdic_text_finish(&rows);
    asdic_text_finish(&header);
    return status ? status : asdic_trial_settle(ctx, folder);
}

asdic_status asdic_trial_merge(asdic_context *ctx, const char *const *folders, size_t folder_count,
                               const char *folder, bool force) {
    TRY(asdic_folder_check_parts(ctx, __func__, folders, folder_count, folder));
    bool is_new = mkdir(folder, 0777) == 0;
    if (!is_new && errno != EEXIST) {
        return asdic_file_fail(ctx, folder, errno);
    }
    bool is_stopped = asdic_trial_has(folder, "trial.part.csv");
    if (!force && (is_stopped || asdic_trial_has(folder, "trial.json"))) {
        return asdic_fail(ctx, ASDIC_ERROR_EXISTS, "'%s' holds a trial%s; --force replaces it",
                          folder, is_stopped ? " that was stopped" : "");
    }
    asdic_trial **parts = calloc(folder_count, sizeof *parts);
    asdic_status status = parts ? ASDIC_OK : asdic_fail_memory(ctx, "parts of a trial");
    for (size_t i = 0; !status && i < folder_count; i++) {
        status = asdic_trial_open(ctx, folders[i], &parts[i]);
    }
    if (!status) {
        qsort(parts, folder_count, sizeof *parts, by_first);
        status = check_parts(ctx, parts, folder_count);
    }
    status = status ? status : write_parts(ctx, parts, folder_count, folder);
    for (size_t i = 0; parts && i < folder_count; i++) {
        asdic_trial_close(&parts[i]);
    }
    free(parts);
    if (status && is_new) {
        rmdir(folder); /* unless parts of the whole are in it */
    }
    return status;
}
