#include "run_folder.h"

#include "base/context.h"
#include "base/file_name.h"
#include "base/try.h"
#include "mission/scene_inputs.h"
#include "out/file.h"
#include "out/format.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

/* What makes a folder a run folder. */
static const char *const marks[] = {"run.json", "pings.npy", "pings.npy.part", "bins.csv"};

/* Everything a run, detect or render may have written there, beside the formats' files. The first are what detect found
 * in the run's pings. */
#define FOUND_COUNT 4
static const char *const names[] = {
    "detections.csv", "detections.mcap", "tracks.csv",   "occupancy.png", "run.json",
    "pings.npy",      "bins.csv",        "terrain.asc",  "track.csv",     "objects.csv",
    "routes.csv",     "background.npy",  "elements.npy", "parts.npy",     "truth.npy"};
static const char *const stems[] = {"waterfall_", "ascope_", "fan_", "raw_", "overview.", "plan."};
#define MOST_PICTURES 256 /* that run.json lists */
static const char *const picture_ends[] = {".png", ".pdf", ".svg"};

bool asdic_folder_has_run(const char *folder) {
    struct stat st;
    bool has_run = false;
    int fd = open(folder, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    for (size_t i = 0; fd >= 0 && i < sizeof marks / sizeof *marks; i++) {
        has_run = has_run || fstatat(fd, marks[i], &st, AT_SYMLINK_NOFOLLOW) == 0;
    }
    if (fd >= 0) {
        close(fd);
    }
    return has_run;
}

static bool ends_in(const char *name, const char *suffix) {
    size_t n = strlen(name), m = strlen(suffix);
    return n > m && strcmp(name + n - m, suffix) == 0;
}

static bool has_stem(const char *name) {
    for (size_t i = 0; i < sizeof stems / sizeof *stems; i++) {
        if (strncmp(name, stems[i], strlen(stems[i])) == 0) {
            return true;
        }
    }
    return false;
}

/* NAME, or NAME.part, is one that a run writes. */
static bool is_ours(const char *name) {
    char bare[256];
    snprintf(bare, sizeof bare, "%s", name);
    if (ends_in(bare, ".part")) {
        bare[strlen(bare) - 5] = 0;
    }
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        if (strcmp(bare, names[i]) == 0) {
            return true;
        }
    }
    for (size_t i = 0; i < ASDIC_FORMAT_COUNT; i++) {
        if (strcmp(bare, asdic_formats[i]->file) == 0) {
            return true;
        }
    }
    bool is_picture = false;
    for (size_t i = 0; i < sizeof picture_ends / sizeof *picture_ends; i++) {
        is_picture = is_picture || ends_in(bare, picture_ends[i]);
    }
    return is_picture && has_stem(bare);
}

/* A process that found nothing to keep may have removed the folder since it was opened. */
static bool is_still_there(DIR *opened, const char *folder) {
    struct stat own, named;
    return fstat(dirfd(opened), &own) == 0 && stat(folder, &named) == 0 &&
           own.st_dev == named.st_dev && own.st_ino == named.st_ino;
}

static asdic_status fail_open(asdic_context *ctx, const char *folder) {
    return errno == ENOMEM
               ? asdic_fail_memory(ctx, "a folder")
               : asdic_fail(ctx, ASDIC_ERROR_IO, "cannot read '%s': %s", folder, strerror(errno));
}

static asdic_status open_folder(asdic_context *ctx, const char *folder, DIR **out) {
    TRY(asdic_folder_make(ctx, folder));
    *out = opendir(folder);
    if (!*out && errno == ENOTDIR) {
        return asdic_fail(ctx, ASDIC_ERROR_EXISTS, "'%s' exists and is not a folder", folder);
    }
    return *out ? ASDIC_OK : fail_open(ctx, folder);
}

asdic_status asdic_folder_check_mode(asdic_context *ctx, bool force, bool resume) {
    return force && resume
               ? asdic_fail(ctx, ASDIC_ERROR_ARGUMENT,
                            "--force starts afresh and --resume goes on; give one of them")
               : ASDIC_OK;
}

asdic_status asdic_folder_check_parts(asdic_context *ctx, const char *function,
                                      const char *const *parts, size_t count,
                                      const char *out_folder) {
    bool are_there = parts && count > 0 && out_folder;
    for (size_t i = 0; are_there && i < count; i++) {
        are_there = parts[i] != NULL;
    }
    return are_there
               ? ASDIC_OK
               : asdic_fail(ctx, ASDIC_ERROR_ARGUMENT,
                            "%s: parts to join and a folder to join them in are needed", function);
}

/* On NFS a folder has no lock, but the file of the records has. */
asdic_status asdic_folder_hold(asdic_context *ctx, const char *folder, DIR **out) {
    bool is_busy = false, is_there = false;
    while (!is_there) {
        TRY(open_folder(ctx, folder, out));
        is_busy = (flock(dirfd(*out), LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK) ||
                  asdic_file_is_being_written(asdic_file_in(folder, "pings.npy.part").text) ||
                  asdic_file_is_being_written(asdic_file_in(folder, "pings.npy").text);
        is_there = is_busy || is_still_there(*out, folder);
        if (is_busy || !is_there) {
            closedir(*out);
            *out = NULL;
        }
    }
    return is_busy ? asdic_fail(ctx, ASDIC_ERROR_EXISTS,
                                "another process is writing to '%s' just now; wait for it, or "
                                "choose another folder",
                                folder)
                   : ASDIC_OK;
}

typedef struct sparing {
    asdic_context *ctx;
    const char *folder, *own;
} sparing;

static asdic_status spare(void *user, const char *path) {
    const sparing *s = user;
    DIR *dir = opendir(s->folder);
    bool is_lost = false;
    for (struct dirent *entry; dir && !is_lost && (entry = readdir(dir));) {
        is_lost = is_ours(entry->d_name) && strcmp(entry->d_name, s->own) != 0 &&
                  asdic_file_is_same(asdic_file_in(s->folder, entry->d_name).text, path);
    }
    if (dir) {
        closedir(dir);
    }
    return is_lost ? asdic_fail(s->ctx, ASDIC_ERROR_EXISTS,
                                "'%s', which the scene reads, is in '%s' and has a name that a run "
                                "writes there; rename it, or use another folder",
                                path, s->folder)
                   : ASDIC_OK;
}

asdic_status asdic_folder_spare(asdic_context *ctx, const char *folder, const char *scene,
                                const char *text, const char *own) {
    sparing s = {ctx, folder, own};
    return asdic_scene_visit_files(ctx, scene, text, spare, &s);
}

static asdic_status clear(asdic_context *ctx, const char *folder) {
    asdic_status status = ASDIC_OK;
    DIR *dir = opendir(folder);
    if (!dir) {
        return asdic_fail(ctx, ASDIC_ERROR_IO, "cannot read '%s': %s", folder, strerror(errno));
    }
    for (struct dirent *entry; status == ASDIC_OK && (entry = readdir(dir));) {
        if (is_ours(entry->d_name) && unlinkat(dirfd(dir), entry->d_name, 0) != 0) {
            status = asdic_fail(ctx, ASDIC_ERROR_IO, "cannot remove '%s/%s': %s", folder,
                                entry->d_name, strerror(errno));
        }
    }
    closedir(dir);
    return status;
}

asdic_status asdic_folder_drop_found(asdic_context *ctx, const char *folder, DIR *dir) {
    size_t count = 0;
    for (size_t i = 0; i < FOUND_COUNT; i++) {
        if (unlinkat(dirfd(dir), names[i], 0) == 0) {
            count++;
        } else if (errno != ENOENT) {
            return asdic_fail(ctx, ASDIC_ERROR_IO, "cannot remove '%s/%s': %s", folder, names[i],
                              strerror(errno));
        }
    }
    if (count > 0) {
        asdic_log(ctx, ASDIC_LOG_WARNING,
                  "'%s' gets more pings: what 'asdic detect' found in those before is removed; run "
                  "it again",
                  folder);
    }
    return ASDIC_OK;
}

/* Where there is no run, a file of a name that runs write is somebody's own, a scene's track perhaps. */
static asdic_status check_foreign(asdic_context *ctx, const char *folder) {
    asdic_status status = ASDIC_OK;
    DIR *dir = opendir(folder);
    if (!dir) {
        return fail_open(ctx, folder);
    }
    for (struct dirent *entry; status == ASDIC_OK && (entry = readdir(dir));) {
        if (is_ours(entry->d_name) && !ends_in(entry->d_name, ".part")) {
            status =
                asdic_fail(ctx, ASDIC_ERROR_EXISTS,
                           "'%s' holds '%s', which a run may write there; use another folder, or "
                           "--force to lose it",
                           folder, entry->d_name);
        }
    }
    closedir(dir);
    return status;
}

asdic_status asdic_folder_prepare(asdic_context *ctx, const char *folder, bool force,
                                  bool can_resume) {
    if (force && asdic_context_interrupted(ctx)) { /* the run would end before it began */
        return asdic_fail(ctx, ASDIC_ERROR_INTERRUPTED, "interrupted before '%s' was changed",
                          folder);
    }
    if (force) { /* what is left of an earlier run, its terrain perhaps, must not be this one's */
        return clear(ctx, folder);
    }
    return asdic_folder_has_run(folder)
               ? asdic_fail(ctx, ASDIC_ERROR_EXISTS,
                            "'%s' holds a run already; use --force to replace it,%s or another "
                            "folder",
                            folder, can_resume ? " --resume to continue it," : "")
               : check_foreign(ctx, folder);
}

static int by_name(const void *a, const void *b) {
    return strcmp(*(const char *const *)a, *(const char *const *)b);
}

static asdic_status list_pictures(asdic_context *ctx, DIR *dir, asdic_arena *arena,
                                  const char **list, size_t *count) {
    for (struct dirent *entry; (entry = readdir(dir)) && *count < MOST_PICTURES;) {
        const char *name = entry->d_name;
        if (!ends_in(name, ".png") || !has_stem(name)) {
            continue;
        }
        list[*count] = asdic_arena_string(arena, name, strlen(name));
        if (!list[(*count)++]) {
            return asdic_fail_memory(ctx, "names of pictures");
        }
    }
    qsort(list, *count, sizeof *list, by_name);
    return ASDIC_OK;
}

asdic_status asdic_folder_pictures(asdic_context *ctx, const char *folder, asdic_arena *arena,
                                   const char ***out, size_t *count) {
    *count = 0;
    *out = asdic_arena_alloc(arena, MOST_PICTURES * sizeof **out);
    if (!*out) {
        return asdic_fail_memory(ctx, "names of pictures");
    }
    DIR *dir = opendir(folder);
    if (!dir) {
        return fail_open(ctx, folder);
    }
    asdic_status status = list_pictures(ctx, dir, arena, *out, count);
    closedir(dir);
    return status;
}

void asdic_folder_remove(const char *folder) {
    if (clear(NULL, folder) == ASDIC_OK) {
        rmdir(folder); /* fails, as it should, when there is something else */
    }
}
