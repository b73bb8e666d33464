/*
 * The corpora without the fuzzer: every file of CORPUS/<target>/ goes through its target, as it is
 * and with some damage, each in less than 2 s, all in less than 1 GiB. TAP on stdout.
 */
#include "targets.h"

#include "damage.h"

#include <dirent.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <time.h>
#include <unistd.h>

#define MOST_S 2.0
#define MOST_KIB (1L << 20)
#define COPIES 20 /* damaged ones of each file */

static double now_s(void) {
    struct timespec now;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

static char *read_file(const char *path, size_t *size) {
    FILE *file = fopen(path, "rb");
    char *bytes = malloc(1 << 20);
    if (!file || !bytes) {
        perror(path);
        exit(1);
    }
    *size = fread(bytes, 1, 1 << 20, file);
    fclose(file);
    return bytes;
}

/* The longest time that one input took. */
static double replay_file(const fuzz_target *target, const char *path, size_t *runs) {
    size_t size = 0;
    double longest_s = 0.0;
    uint32_t state = 0x2545f491u;
    char *bytes = read_file(path, &size), *copy = malloc(2 * size + 128);
    for (int i = 0; copy && i <= COPIES; i++) {
        size_t length = size;
        memcpy(copy, bytes, size);
        if (i > 0) {
            length = damage(bytes, size, &state, copy);
        }
        double begin_s = now_s();
        target->run((const uint8_t *)copy, length);
        double took_s = now_s() - begin_s;
        longest_s = took_s > longest_s ? took_s : longest_s;
        ++*runs;
    }
    free(bytes);
    free(copy);
    return longest_s;
}

static int replay(const fuzz_target *target, const char *corpus, int number) {
    char path[4096];
    size_t files = 0, runs = 0;
    double longest_s = 0.0;
    snprintf(path, sizeof path, "%s/%s", corpus, target->name);
    DIR *dir = opendir(path);
    for (struct dirent *entry; dir && (entry = readdir(dir));) {
        if (entry->d_name[0] != '.') {
            snprintf(path, sizeof path, "%s/%s/%s", corpus, target->name, entry->d_name);
            fprintf(stderr, "%s\n", path); /* the last one named is the one that crashed */
            double took_s = replay_file(target, path, &runs);
            longest_s = took_s > longest_s ? took_s : longest_s;
            files++;
        }
    }
    if (dir) {
        closedir(dir);
    }
    struct rusage usage;
    getrusage(RUSAGE_SELF, &usage);
    int is_good = files > 0 && longest_s < MOST_S && usage.ru_maxrss < MOST_KIB;
    printf("%sok %d - %s: %zu files, %zu runs, %.3f s at most, %ld MiB\n", is_good ? "" : "not ",
           number, target->name, files, runs, longest_s, usage.ru_maxrss >> 10);
    fflush(stdout);
    return is_good;
}

/* What the targets say about their input is of no interest here. */
static void silence(const char *log) {
    int fd = open(log, O_WRONLY | O_CREAT | O_TRUNC, 0666);
    if (fd >= 0) {
        dup2(fd, STDERR_FILENO);
        close(fd);
    }
}

int main(int argc, char **argv) {
    int good = 1, number = 0;
    if (argc != 3) {
        fputs("usage: replay CORPUS LOG\n", stderr);
        return 2;
    }
    silence(argv[2]);
    for (const fuzz_target *t = fuzz_targets; t->name; t++) {
        good &= replay(t, argv[1], ++number);
    }
    printf("1..%d\n", number);
    return good ? 0 : 1;
}
