#include "run_folder.h"

#include "base/context.h"
#include "base/try.h"
#include "out/format.h"

#include <ctype.h>
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

/* Everything a run, detect or render may have written there, beside the formats' files. */
static const char *const names[] = {
    "run.json",    "pings.npy",      "bins.csv",      "terrain.asc", "track.csv",
    "objects.csv", "detections.csv", "roc.csv",       "roc.png",     "occupancy.png",
    "tracks.csv",  "routes.csv",     "background.npy"};
static const char *const stems[] = {"waterfall_", "ascope_", "fan_", "raw_", "overview.", "plan."};
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
    bool is_picture = false, has_stem = false;
    for (size_t i = 0; i < sizeof picture_ends / sizeof *picture_ends; i++) {
        is_picture = is_picture || ends_in(bare, picture_ends[i]);
    }
    for (size_t i = 0; i < sizeof stems / sizeof *stems; i++) {
        has_stem = has_stem || strncmp(bare, stems[i], strlen(stems[i])) == 0;
    }
    return is_picture && has_stem;
}

/* Fails when another process holds the lock that a run's store has on FOLDER/NAME. */
static asdic_status check_unlocked(asdic_context *ctx, const char *folder, const char *name) {
    char *path = asdic_folder_file(folder, name);
    if (!path) {
        return asdic_fail_memory(ctx, "a file name");
    }
    int fd = open(path, O_RDONLY | O_CLOEXEC);
    bool locked = fd >= 0 && flock(fd, LOCK_SH | LOCK_NB) != 0 && errno == EWOULDBLOCK;
    if (fd >= 0) {
        close(fd);
    }
    free(path);
    return locked ? asdic_fail(ctx, ASDIC_ERROR_EXISTS,
                               "another process is writing a run to '%s' just now; wait for it, or "
                               "choose another folder",
                               folder)
                  : ASDIC_OK;
}

asdic_status asdic_folder_check_idle(asdic_context *ctx, const char *folder) {
    TRY(check_unlocked(ctx, folder, "pings.npy.part"));
    return check_unlocked(ctx, folder, "pings.npy");
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

asdic_status asdic_folder_prepare(asdic_context *ctx, const char *folder, bool force) {
    struct stat st;
    if (mkdir(folder, 0777) == 0) {
        return ASDIC_OK;
    }
    int error = errno;
    if (error != EEXIST) {
        return asdic_fail(ctx, ASDIC_ERROR_IO, "cannot create folder '%s': %s", folder,
                          strerror(error));
    }
    if (stat(folder, &st) != 0 || !S_ISDIR(st.st_mode)) {
        return asdic_fail(ctx, ASDIC_ERROR_EXISTS, "'%s' exists and is not a folder", folder);
    }
    if (!asdic_folder_has_run(folder)) {
        return ASDIC_OK;
    }
    if (!force) {
        return asdic_fail(ctx, ASDIC_ERROR_EXISTS,
                          "'%s' holds a run already; use --force to replace it, --resume to "
                          "continue it, or another folder",
                          folder);
    }
    TRY(asdic_folder_check_idle(ctx, folder));
    return clear(ctx, folder);
}

void asdic_folder_remove(asdic_context *ctx, const char *folder) {
    if (clear(ctx, folder) == ASDIC_OK) {
        rmdir(folder); /* fails, as it should, when there is something else */
    }
}

char *asdic_folder_file(const char *folder, const char *name) {
    char *path = NULL;
    return asprintf(&path, "%s/%s", folder, name) < 0 ? NULL : path;
}

char *asdic_folder_path(const char *folder, const char *stem, const char *name,
                        const char *extension) {
    char *path = NULL;
    if (asprintf(&path, "%s/%s%s.%s", folder, stem, name, extension) < 0) {
        return NULL;
    }
    /* A beam's name may hold any character: those that are not plain become underscores. */
    for (char *c = path + strlen(folder) + 1 + strlen(stem); *c; c++) {
        bool is_plain = isalnum((unsigned char)*c) || strchr("._-", *c) || (*c & 0x80);
        *c = is_plain ? *c : '_';
    }
    return path;
}
