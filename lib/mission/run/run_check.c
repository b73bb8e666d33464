#include "run_check.h"

#include "base/context.h"
#include "base/try.h"
#include "out/format.h"
#include "out/png_file.h"
#include "run_folder.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* Read back by other commands. */
static const char *const small_names[] = {"track.csv", "terrain.asc", "objects.csv", "routes.csv"};
#define SMALL (sizeof small_names / sizeof *small_names)

_Static_assert(SMALL + 1 + ASDIC_FORMAT_COUNT <= ASDIC_RUN_FILES, "room for every file");

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
    char *path = asdic_folder_file(folder, name);
    if (!path) {
        return asdic_fail_memory(ctx, "a file name");
    }
    bool is_there = access(path, F_OK) == 0;
    asdic_status status = is_there ? asdic_file_sum(ctx, path, &file->sum) : ASDIC_OK;
    snprintf(file->name, sizeof file->name, "%s", name);
    facts->file_count += is_there;
    free(path);
    return status;
}

asdic_status asdic_run_check_note(asdic_context *ctx, const char *folder, asdic_arena *arena,
                                  asdic_run_facts *facts) {
    facts->file_count = 0;
    TRY(note(ctx, folder, "bins.csv", facts));
    for (size_t i = 0; i < SMALL; i++) {
        TRY(note(ctx, folder, small_names[i], facts));
    }
    for (size_t i = 0; i < ASDIC_FORMAT_COUNT; i++) {
        TRY(note(ctx, folder, asdic_formats[i]->file, facts));
    }
    return asdic_folder_pictures(ctx, folder, arena, &facts->pictures, &facts->picture_count);
}

/* What CHECKED means of the file NAME. */
static asdic_status judge(asdic_context *ctx, asdic_status checked, const char *folder,
                          const char *name) {
    return checked != ASDIC_ERROR_INPUT
               ? checked
               : asdic_fail(ctx, ASDIC_ERROR_INPUT,
                            "'%s/%s' is missing or damaged; 'asdic run' with --resume makes it "
                            "again",
                            folder, name);
}

static asdic_status check_file(asdic_context *ctx, const char *folder, const asdic_run_file *file) {
    asdic_sum now;
    char *path = asdic_folder_file(folder, file->name);
    if (!path) {
        return asdic_fail_memory(ctx, "a file name");
    }
    asdic_status status = asdic_file_sum(ctx, path, &now);
    free(path);
    if (now.bytes != file->sum.bytes || now.crc32 != file->sum.crc32) {
        status = ASDIC_ERROR_INPUT;
    }
    return judge(ctx, status, folder, file->name);
}

static asdic_status check_picture(asdic_context *ctx, const char *folder, const char *name) {
    char *path = asdic_folder_file(folder, name);
    if (!path) {
        return asdic_fail_memory(ctx, "a file name");
    }
    asdic_status status = asdic_png_check(ctx, path);
    free(path);
    return judge(ctx, status, folder, name);
}

asdic_status asdic_run_check_small(asdic_context *ctx, const char *folder,
                                   const asdic_run_facts *facts) {
    for (size_t i = 0; i < facts->file_count; i++) {
        if (is_small(facts->files[i].name)) {
            TRY(check_file(ctx, folder, &facts->files[i]));
        }
    }
    return ASDIC_OK;
}

asdic_status asdic_run_check_all(asdic_context *ctx, const char *folder,
                                 const asdic_run_facts *facts) {
    for (size_t i = 0; i < facts->file_count; i++) {
        TRY(check_file(ctx, folder, &facts->files[i]));
    }
    for (size_t i = 0; i < facts->picture_count; i++) {
        TRY(check_picture(ctx, folder, facts->pictures[i]));
    }
    return ASDIC_OK;
}
