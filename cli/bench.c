#include "bench.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

double bench_now_s(void) {
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

double bench_processor_s(void) {
    struct timespec now;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

unsigned bench_limit_threads(const bench_options *options, unsigned otherwise) {
    char text[16];
    const char *limit = getenv("POCL_MAX_PTHREAD_COUNT");
    int before = limit ? atoi(limit) : 0;
    unsigned threads = options->threads ? (unsigned)options->threads
                       : before > 0     ? (unsigned)before
                                        : otherwise;
    if (threads > 0) {
        snprintf(text, sizeof text, "%u", threads);
        setenv("POCL_MAX_PTHREAD_COUNT", text, 1);
    }
    return threads;
}

static int compare(const void *a, const void *b) {
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

double bench_median(double *values, size_t count) {
    if (count == 0) {
        return NAN;
    }
    qsort(values, count, sizeof *values, compare);
    return 0.5 * (values[(count - 1) / 2] + values[count / 2]);
}

bool bench_find_data(const char *name, char *out, size_t size) {
    char program[1024];
    ssize_t length = readlink("/proc/self/exe", program, sizeof program - 1);
    program[length > 0 ? length : 0] = '\0';
    char *slash = strrchr(program, '/');
    if (slash) {
        *slash = '\0';
    }
    const char *given = getenv("ASDIC_DATA");
    if (given && given[0]) {
        snprintf(out, size, "%s/%s", given, name);
        return access(out, R_OK) == 0;
    }
    /* Beside bin/, beside build/cli/, and below the folder the user is in. */
    static const char *const places[] = {"/../share/asdic/", "/../../data/"};
    for (size_t i = 0; i < sizeof places / sizeof *places; i++) {
        snprintf(out, size, "%s%s%s", program, places[i], name);
        if (access(out, R_OK) == 0) {
            return true;
        }
    }
    snprintf(out, size, "data/%s", name);
    return access(out, R_OK) == 0;
}

static bool part_name(char *out, size_t size, const char *path) {
    return (size_t)snprintf(out, size, "%s.part", path) < size;
}

FILE *bench_begin_file(const cli *c, const char *path) {
    char part[4096];
    FILE *file = part_name(part, sizeof part, path) ? fopen(part, "w") : NULL;
    if (!file) {
        cli_error(c, "cannot write '%s': %s", path, strerror(errno ? errno : ENAMETOOLONG));
    }
    return file;
}

int bench_end_file(const cli *c, FILE *file, const char *path) {
    char part[4096];
    bool named = part_name(part, sizeof part, path);
    bool failed = ferror(file) != 0;
    failed = fclose(file) != 0 || failed;
    if (failed || !named || rename(part, path) != 0) {
        cli_error(c, "cannot write '%s': %s", path, strerror(errno));
        remove(part);
        return CLI_FAILED;
    }
    return CLI_OK;
}
