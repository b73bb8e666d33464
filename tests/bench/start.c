/* How long a program takes from its start to its first ping: with nothing compiled yet, and
 * again. */
#include "bench_pings.h"
#include "kinds.h"

#include <ftw.h>
#include <math.h>
#include <spawn.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>

extern char **environ;

const bench_column start_columns[] = {{"cold_start_s", "cold s", 8, 2, 0.0},
                                      {"warm_start_s", "warm s", 8, 2, 0.0},
                                      {NULL, NULL, 0, 0, 0.0}};
const bench_column first_columns[] = {{"first_ping_s", "first ping s", 12, 3, 0.0},
                                      {NULL, NULL, 0, 0, 0.0}};

static int remove_entry(const char *path, const struct stat *status, int type, struct FTW *walk) {
    (void)status;
    (void)type;
    (void)walk;
    return remove(path);
}

/* This program again, for one ping; its wall time, or NAN. */
static double run_once(const cli *c) {
    char program[] = "/proc/self/exe", kind[] = "first";
    char option[] = "--device", device[256];
    const char *given = cli_text(c, "device");
    snprintf(device, sizeof device, "%s", given ? given : "");
    char *arguments[] = {program, kind, given ? option : NULL, device, NULL};
    posix_spawn_file_actions_t actions;
    pid_t child;
    int status = -1;
    if (posix_spawn_file_actions_init(&actions) != 0) {
        return NAN;
    }
    posix_spawn_file_actions_addopen(&actions, 1, "/dev/null", 1 /* O_WRONLY */, 0);
    double began = cli_clock_s();
    bool ran = posix_spawn(&child, program, &actions, NULL, arguments, environ) == 0 &&
               waitpid(child, &status, 0) == child;
    double seconds = cli_clock_s() - began;
    posix_spawn_file_actions_destroy(&actions);
    return ran && status == 0 ? seconds : NAN;
}

asdic_status start(bench *b) {
    enum { WARM_RUNS = 3 };
    const char *tmp = getenv("TMPDIR"), *before = getenv("POCL_CACHE_DIR");
    char folder[4096], kept[4096];
    snprintf(folder, sizeof folder, "%s/asdic-start-XXXXXX", tmp && tmp[0] ? tmp : "/tmp");
    if (!mkdtemp(folder)) {
        return ASDIC_ERROR_IO;
    }
    snprintf(kept, sizeof kept, "%s", before ? before : "");
    setenv("POCL_CACHE_DIR", folder, 1);
    double cold_s = run_once(b->c), warm_s[WARM_RUNS];
    for (int k = 0; k < WARM_RUNS; k++) {
        warm_s[k] = run_once(b->c);
    }
    if (before) {
        setenv("POCL_CACHE_DIR", kept, 1);
    } else {
        unsetenv("POCL_CACHE_DIR");
    }
    nftw(folder, remove_entry, 16, FTW_DEPTH | FTW_PHYS);
    const bench_cell cells[] = {BENCH_NUMBER(cold_s),
                                BENCH_NUMBER(bench_median(warm_s, WARM_RUNS))};
    bench_add(b, cells);
    return ASDIC_OK;
}

asdic_status first(bench *b) {
    asdic_scene *scene = NULL;
    bench_rate rate;
    TRY(bench_terrain(cli_context(b->c), bench_floors[0], 0, &scene));
    bench_case of = {.scene = scene, .bins = bench_bin_counts[1]};
    asdic_status status = bench_pings_measure(b, b->device, &of, &rate);
    asdic_scene_destroy(&scene);
    const bench_cell cells[] = {BENCH_NUMBER(rate.first_s)};
    bench_add(b, cells);
    return status;
}
