/*
 * Where PoCL keeps compiled kernels. It cannot work without: of a folder that it may not write to it says
 * that there is no device, or that a kernel does not compile, and of an empty name it aborts. Containers,
 * cron jobs and service accounts have such folders. PoCL 3.1 looks at POCL_CACHE_DIR, then at
 * XDG_CACHE_HOME/pocl/kcache, then at HOME/.cache/pocl/kcache (pocl_cache.c, pocl_cache_init_topdir).
 */
#include "cli.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#define PATH_SIZE 4096

/* A variable that is set and not empty, else NULL. */
static const char *variable(const char *name) {
    const char *value = getenv(name);
    return value && *value ? value : NULL;
}

/* The folder that PoCL would take into PATH; false: none by environment. */
static bool chosen_folder(char *path) {
    const char *folder = variable("POCL_CACHE_DIR"), *below = "";
    if (!folder && (folder = variable("XDG_CACHE_HOME"))) {
        below = "/pocl/kcache";
    } else if (!folder && (folder = variable("HOME"))) {
        below = "/.cache/pocl/kcache";
    }
    return folder && snprintf(path, PATH_SIZE, "%s%s", folder, below) < PATH_SIZE;
}

/* Makes PATH with all folders above it; 0, or errno where it cannot be written to. */
static int make_writable(char *path) {
    int first = 0;
    for (char *slash = strchr(path + 1, '/'); slash; slash = strchr(slash + 1, '/')) {
        *slash = '\0';
        bool made = mkdir(path, 0777) == 0 || errno == EEXIST;
        first = made || first ? first : errno;
        *slash = '/';
    }
    if (mkdir(path, 0777) != 0 && errno != EEXIST) {
        return first ? first : errno;
    }
    return access(path, W_OK | X_OK) == 0 ? 0 : errno;
}

/* A folder of the user's own among the temporary ones, which later runs find again; false: none. */
static bool private_folder(char *path) {
    const char *temporary = variable("TMPDIR") ? variable("TMPDIR") : "/tmp";
    struct stat s;
    snprintf(path, PATH_SIZE, "%s/asdic-kernels-%lu", temporary, (unsigned long)geteuid());
    if (mkdir(path, 0700) == 0) {
        return true;
    }
    /* Nobody else may have made it: PoCL runs what lies there. */
    if (lstat(path, &s) == 0 && S_ISDIR(s.st_mode) && s.st_uid == geteuid() &&
        (s.st_mode & 077) == 0 && access(path, W_OK | X_OK) == 0) {
        return true;
    }
    snprintf(path, PATH_SIZE, "%s/asdic-kernels-XXXXXX", temporary);
    return mkdtemp(path) != NULL;
}

void cli_prepare_kernel_cache(cli *c) {
    char wanted[PATH_SIZE], instead[PATH_SIZE];
    const char *given = getenv("POCL_CACHE_DIR");
    if (given && !*given) {
        unsetenv("POCL_CACHE_DIR"); /* as if it were not set, instead of an abort */
    }
    if (!chosen_folder(wanted)) {
        return;
    }
    int error = make_writable(wanted);
    if (error && private_folder(instead)) {
        setenv("POCL_CACHE_DIR", instead, 1);
        cli_warning(c,
                    "compiled kernels cannot be kept in '%s' (%s); they are kept in '%s'; set "
                    "POCL_CACHE_DIR to a folder that can be written to",
                    wanted, strerror(error), instead);
    }
}
