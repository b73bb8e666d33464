/*
 * Where PoCL keeps compiled kernels. It cannot work without: of a folder that it may not write to it says
 * that there is no device, or that a kernel does not compile, and of an empty name it aborts. Containers,
 * cron jobs and service accounts have such folders. PoCL 3.1 looks at POCL_CACHE_DIR, then at
 * XDG_CACHE_HOME/pocl/kcache, then at HOME/.cache/pocl/kcache (pocl_cache.c, pocl_cache_init_topdir).
 */
#include "opencl.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/statvfs.h>
#include <unistd.h>

/* LLVM ends the process when it cannot write on. What a command compiles is 1 MB with PoCL 3.1. */
#define ROOM_BYTES 8000000u

/* Bytes of a path that are shown where it is too long to be one. */
#define SHOWN 60

/* A variable that is set and not empty, else NULL. */
static const char *variable(const char *name) {
    const char *value = getenv(name);
    return value && *value ? value : NULL;
}

bool asdic_cache_folder(char path[ASDIC_CACHE_SIZE]) {
    const char *folder = variable("POCL_CACHE_DIR"), *below = "";
    if (!folder && (folder = variable("XDG_CACHE_HOME"))) {
        below = "/pocl/kcache";
    } else if (!folder && (folder = variable("HOME"))) {
        below = "/.cache/pocl/kcache";
    }
    return folder && snprintf(path, ASDIC_CACHE_SIZE, "%s%s", folder, below) < ASDIC_CACHE_SIZE;
}

/* 0, or ENOSPC where compiled kernels have no room in FOLDER. Some file systems do not tell theirs. */
static int lack_of_room(const char *folder) {
    struct statvfs disk;
    bool is_told = statvfs(folder, &disk) == 0 && disk.f_blocks > 0;
    return is_told && (uint64_t)disk.f_bavail * disk.f_frsize < ROOM_BYTES ? ENOSPC : 0;
}

/* 0, or why PATH can neither be written to nor be made: not every folder that root may write to takes another, and
 * one that is not needed is not left behind. */
static int refusal_of(const char *path) {
    char there[ASDIC_CACHE_SIZE + 32], *slash; /* as much of it as there is */
    struct stat s;
    snprintf(there, ASDIC_CACHE_SIZE + 2, "%s%s", *path == '/' ? "" : "./", path);
    while (lstat(there, &s) != 0 && errno == ENOENT && (slash = strrchr(there, '/'))) {
        slash[slash == there] = '\0';
    }
    int lack = lack_of_room(there);
    strcat(there, "/asdic-XXXXXX");
    return mkdtemp(there) && rmdir(there) == 0 ? lack : errno;
}

asdic_status asdic_cache_check_room(asdic_context *ctx) {
    char path[ASDIC_CACHE_SIZE];
    int error = asdic_cache_folder(path) ? lack_of_room(path) : 0;
    return error ? asdic_fail(ctx, ASDIC_ERROR_IO,
                              "compiled kernels have no room in '%s' (%s); free 8 MB there, or set "
                              "POCL_CACHE_DIR to a folder that has them",
                              path, strerror(error))
                 : ASDIC_OK;
}

const char *asdic_cache_refusal(char path[ASDIC_CACHE_SIZE]) {
    *path = '\0';
    bool is_known = asdic_cache_folder(path);
    if (*path == '\0') { /* PoCL takes one below /tmp that all users share */
        snprintf(path, ASDIC_CACHE_SIZE, "~/.cache/pocl/kcache");
        return "HOME is not set";
    }
    if (!is_known) {
        snprintf(path + SHOWN, ASDIC_CACHE_SIZE - SHOWN, "...");
    }
    int error = is_known ? refusal_of(path) : ENAMETOOLONG;
    return error ? strerror(error) : NULL;
}

/* A folder of the user's own in TEMPORARY, which later runs find again: 0, or why there is none. */
static int private_folder(const char *temporary, char *path) {
    struct stat s;
    int lack = lack_of_room(temporary);
    snprintf(path, ASDIC_CACHE_SIZE, "%s/asdic-kernels-%lu", temporary, (unsigned long)geteuid());
    if (lack || mkdir(path, 0700) == 0) {
        return lack;
    }
    /* Nobody else may have made it: PoCL runs what lies there. */
    if (lstat(path, &s) == 0 && S_ISDIR(s.st_mode) && s.st_uid == geteuid() &&
        (s.st_mode & 077) == 0 && access(path, W_OK | X_OK) == 0) {
        return 0;
    }
    snprintf(path, ASDIC_CACHE_SIZE, "%s/asdic-kernels-XXXXXX", temporary);
    return mkdtemp(path) ? 0 : errno;
}

void asdic_kernel_cache_prepare(asdic_context *ctx) {
    const char *temporary = variable("TMPDIR") ? variable("TMPDIR") : "/tmp";
    const char *given = getenv("POCL_CACHE_DIR");
    static const char set[] = "set POCL_CACHE_DIR to a folder that can be written to";
    char wanted[ASDIC_CACHE_SIZE], instead[ASDIC_CACHE_SIZE];
    if (given && !*given) {
        unsetenv("POCL_CACHE_DIR"); /* as if it were not set, instead of an abort */
    }
    const char *why = asdic_cache_refusal(wanted);
    int error = why ? private_folder(temporary, instead) : 0;
    if (why && !error) {
        setenv("POCL_CACHE_DIR", instead, 1);
        asdic_log(ctx, ASDIC_LOG_WARNING,
                  "compiled kernels cannot be kept in '%s' (%s); they are kept in '%s'; %s", wanted,
                  why, instead, set);
    } else if (error && !lack_of_room(wanted)) { /* of that one opening a device tells */
        asdic_log(ctx, ASDIC_LOG_WARNING,
                  "compiled kernels cannot be kept in '%s' (%s), nor below '%s' (%s); %s", wanted,
                  why, temporary, strerror(error), set);
    }
}
