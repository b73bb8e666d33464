#include "run_check.h"

#include "base/context.h"
#include "base/file_name.h"
#include "base/text.h"
#include "base/try.h"
#include "out/format.h"
#include "out/png_file.h"
#include "run_elements.h"
#include "run_folder.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* Read back by other commands. */
static const char *const small_names[] = {"track.csv", "terrain.asc", "objects.csv", "routes.csv"};
#define SMALL (sizeof small_names / sizeof *small_names)

_Static_assert(SMALL + 2 + ASDIC_FORMAT_COUNT <= ASDIC_RUN_FILES, "room for every file");

static bool is_small(const char *name) {
    bool is = false;
    for (size_t i = 0; i < SMALL; i++) {
        is = is || strcmp(name, small_names[i]) == 0;
    }
    return is;
}

/* Adds the file NAME to FACTS if it is there. */
static asdic_status note(asdic_context *ctx, const char *folder, const char *name,
                         asdic_run_facts *facts) {
    asdic_run_file *file = &facts->files[facts->file_count];
    asdic_file_name path = asdic_file_in(folder, name);
    if (access(path.text, F_OK) != 0) {
        return ASDIC_OK;
    }
    snprintf(file->name, sizeof file->name, "%s", name);
    facts->file_count++;
    return asdic_file_sum(ctx, path.text, &file->sum);
}

asdic_status asdic_run_check_note(asdic_context *ctx, const char *folder, asdic_arena *arena,
                                  asdic_run_facts *facts) {
    facts->file_count = 0;
    TRY(note(ctx, folder, "bins.csv", facts));
    TRY(note(ctx, folder, ASDIC_ELEMENTS_NAME, facts));
    for (size_t i = 0; i < SMALL; i++) {
        TRY(note(ctx, folder, small_names[i], facts));
    }
    for (size_t i = 0; i < ASDIC_FORMAT_COUNT; i++) {
        TRY(note(ctx, folder, asdic_formats[i]->file, facts));
    }
    return asdic_folder_pictures(ctx, folder, arena, &facts->pictures, &facts->picture_count);
}

/* The files that are not as they were left. */
typedef struct lost_files {
    asdic_text names;
    size_t count;
} lost_files;

#define MOST_NAMED 5

static void lose(lost_files *lost, const char *folder, const char *name) {
    if (lost->count < MOST_NAMED) {
        asdic_text_format(&lost->names, "%s'%s/%s'", lost->count ? ", " : "", folder, name);
    }
    lost->count++;
}

static void check_file(asdic_context *ctx, const char *folder, const asdic_run_file *file,
                       lost_files *lost) {
    asdic_sum now;
    if (asdic_file_sum(ctx, asdic_file_in(folder, file->name).text, &now) ||
        now.bytes != file->sum.bytes || now.crc32 != file->sum.crc32) {
        lose(lost, folder, file->name);
    }
}

static asdic_status check_picture(asdic_context *ctx, const char *folder, const char *name,
                                  lost_files *lost) {
    asdic_status status = asdic_png_check(ctx, asdic_file_in(folder, name).text);
    if (status == ASDIC_ERROR_INPUT) {
        lose(lost, folder, name);
        return ASDIC_OK;
    }
    return status;
}

/* One error that names those that LOST has, unless STATUS is one already. */
static asdic_status tell(asdic_context *ctx, asdic_status status, lost_files *lost) {
    if (status == ASDIC_OK && lost->count > 0) {
        if (lost->count > MOST_NAMED) {
            asdic_text_format(&lost->names, " and %zu more", lost->count - MOST_NAMED);
        }
        char *names = asdic_text_take(&lost->names);
        status = names ? asdic_fail(ctx, ASDIC_ERROR_INPUT, "%s %s missing or damaged", names,
                                    lost->count == 1 ? "is" : "are")
                       : asdic_fail_memory(ctx, "file names");
        free(names);
    }
    asdic_text_finish(&lost->names);
    return status;
}

asdic_status asdic_run_check(asdic_context *ctx, const char *folder, const asdic_run_facts *facts,
                             asdic_run_checked what) {
    lost_files lost = {0};
    asdic_status status = ASDIC_OK;
    for (size_t i = 0; i < facts->file_count; i++) {
        const char *name = facts->files[i].name;
        if (what == ASDIC_RUN_ALL || (what == ASDIC_RUN_SMALL && is_small(name)) ||
            (what == ASDIC_RUN_ELEMENTS && strcmp(name, ASDIC_ELEMENTS_NAME) == 0)) {
            check_file(ctx, folder, &facts->files[i], &lost);
        }
    }
    for (size_t i = 0; what == ASDIC_RUN_ALL && i < facts->picture_count && !status; i++) {
        status = check_picture(ctx, folder, facts->pictures[i], &lost);
    }
    return tell(ctx, status, &lost);
}

asdic_status asdic_run_advise(asdic_context *ctx, asdic_status status) {
    return status == ASDIC_ERROR_INPUT
               ? asdic_fail(ctx, status, "%s; 'asdic run' with --resume mends the run",
                            asdic_context_error(ctx))
               : status;
}
