/* How long a program takes from its start to its first ping: with nothing compiled yet, and again. */
#include "bench_pings.h"

#include <ftw.h>
#include <math.h>
#include <spawn.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>

extern char **environ;

static int remove_entry(const char *path, const struct stat *status, int type, struct FTW *walk) {
    (void)status;
    (void)type;
    (void)walk;
    return remove(path);
}

/* This program again, for one ping; its wall time, or NAN. */
static double run_once(const cli *c) {
    char program[] = "/proc/self/exe", bench[] = "bench", pings[] = "pings", first[] = "--first";
    char option[] = "--device", device[256];
    const char *given = cli_text(c, "device");
    snprintf(device, sizeof device, "%s", given ? given : "");
    char *arguments[] = {program, bench, pings, first, given ? option : NULL, device, NULL};
    posix_spawn_file_actions_t actions;
    pid_t child;
    int status = -1;
    if (posix_spawn_file_actions_init(&actions) != 0) {
        return NAN;
    }
    posix_spawn_file_actions_addopen(&actions, 1, "/dev/null", 1 /* O_WRONLY */, 0);
    double began = bench_now_s();
    bool ran = posix_spawn(&child, program, &actions, NULL, arguments, environ) == 0 &&
               waitpid(child, &status, 0) == child;
    double seconds = bench_now_s() - began;
    posix_spawn_file_actions_destroy(&actions);
    return ran && status == 0 ? seconds : NAN;
}

bench_start bench_start_measure(const cli *c) {
    enum { WARM_RUNS = 3 };
    const char *tmp = getenv("TMPDIR"), *before = getenv("POCL_CACHE_DIR");
    char folder[4096], kept[4096];
    bench_start start = {NAN, NAN};
    snprintf(folder, sizeof folder, "%s/asdic-start-XXXXXX", tmp && tmp[0] ? tmp : "/tmp");
    if (!mkdtemp(folder)) {
        return start;
    }
    snprintf(kept, sizeof kept, "%s", before ? before : "");
    setenv("POCL_CACHE_DIR", folder, 1);
    start.cold_s = run_once(c);
    double warm_s[WARM_RUNS];
    for (int k = 0; k < WARM_RUNS; k++) {
        warm_s[k] = run_once(c);
    }
    start.warm_s = bench_median(warm_s, WARM_RUNS);
    if (before) {
        setenv("POCL_CACHE_DIR", kept, 1);
    } else {
        unsetenv("POCL_CACHE_DIR");
    }
    nftw(folder, remove_entry, 16, FTW_DEPTH | FTW_PHYS);
    return start;
}
