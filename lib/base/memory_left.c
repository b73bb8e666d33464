#include "memory_left.h"

#include "context.h"

#include <limits.h>
#include <stdio.h>
#include <string.h>
#include <sys/resource.h>
#include <unistd.h>

/* From /proc/meminfo, Linux; not known elsewhere. */
static uint64_t system_left(void) {
    unsigned long long kib = 0;
    char line[128];
    uint64_t bytes = UINT64_MAX;
    FILE *file = fopen("/proc/meminfo", "re");
    while (file && fgets(line, sizeof line, file)) {
        if (sscanf(line, "MemAvailable: %llu kB", &kib) == 1) {
            bytes = (uint64_t)kib << 10;
            break;
        }
    }
    if (file) {
        fclose(file);
    }
    return bytes;
}

/* The process's address space; 0 where the system does not tell. */
static uint64_t used(void) {
    unsigned long long pages = 0;
    FILE *file = fopen("/proc/self/statm", "re");
    if (file && fscanf(file, "%llu", &pages) != 1) {
        pages = 0;
    }
    if (file) {
        fclose(file);
    }
    return (uint64_t)pages * (uint64_t)sysconf(_SC_PAGESIZE);
}

/* What a control group's files are called, by version of the kernel's interface. */
static const struct group_files {
    const char *below, *limit, *usage, *inactive, *active; /* the last two of memory.stat */
} group_files[] = {
    {"", "memory.max", "memory.current", "inactive_file ", "active_file "},
    {"/memory", "memory.limit_in_bytes", "memory.usage_in_bytes", "total_inactive_file ",
     "total_active_file "},
};

/* The number behind KEY in FOLDER/NAME; NONE: there is no such file, or no number, as of "max". */
static uint64_t group_number(const char *folder, const char *name, const char *key, uint64_t none) {
    char path[PATH_MAX + 32], line[128];
    unsigned long long number = 0;
    bool is_there = false;
    snprintf(path, sizeof path, "%s/%s", folder, name);
    FILE *file = fopen(path, "re");
    while (file && !is_there && fgets(line, sizeof line, file)) {
        is_there = strncmp(line, key, strlen(key)) == 0 &&
                   sscanf(line + strlen(key), "%llu", &number) == 1;
    }
    if (file) {
        fclose(file);
    }
    return is_there ? number : none;
}

/* Files in the cache count as used, but make room when there is need. */
static uint64_t group_left(const char *folder, const struct group_files *f) {
    uint64_t limit = group_number(folder, f->limit, "", UINT64_MAX);
    uint64_t usage = group_number(folder, f->usage, "", 0);
    uint64_t cache = group_number(folder, "memory.stat", f->inactive, 0) +
                     group_number(folder, "memory.stat", f->active, 0);
    uint64_t held = usage > cache ? usage - cache : 0;
    return limit == UINT64_MAX ? limit : limit > held ? limit - held : 0;
}

/* The files of a line of TABLE, "ID:CONTROLLERS:PATH", and where PATH begins; NULL: not of memory. */
static const struct group_files *files_of(const char *line, const char **path) {
    const char *first = strchr(line, ':'), *second = first ? strchr(first + 1, ':') : NULL;
    if (!second) {
        return NULL;
    }
    *path = second + 1;
    const char *memory = strstr(first, "memory");
    return second == first + 1                                                    ? &group_files[0]
           : memory && memory < second && strpbrk(memory + 6, ",:") == memory + 6 ? &group_files[1]
                                                                                  : NULL;
}

uint64_t asdic_memory_groups_left(const char *table, const char *root) {
    char line[PATH_MAX], folder[PATH_MAX];
    uint64_t left = UINT64_MAX;
    FILE *file = fopen(table, "re");
    while (file && fgets(line, sizeof line, file)) {
        const char *path = NULL;
        const struct group_files *files = files_of(line, &path);
        if (!files) {
            continue;
        }
        int length = snprintf(folder, sizeof folder, "%s%s", root, files->below);
        snprintf(folder + length, sizeof folder - (size_t)length, "%.*s", (int)strcspn(path, "\n"),
                 path);
        /* In a container PATH may be the host's, of which only the root is seen. */
        for (char *end = folder + strlen(folder); end; end = strrchr(folder + length, '/')) {
            *end = '\0';
            uint64_t here = group_left(folder, files);
            left = here < left ? here : left;
        }
    }
    if (file) {
        fclose(file);
    }
    return left;
}

uint64_t asdic_memory_left(void) {
    struct rlimit limit;
    uint64_t left = system_left();
    uint64_t groups = asdic_memory_groups_left("/proc/self/cgroup", "/sys/fs/cgroup");
    left = groups < left ? groups : left;
    if (getrlimit(RLIMIT_AS, &limit) == 0 && limit.rlim_cur != RLIM_INFINITY) {
        uint64_t has = used(), most = (uint64_t)limit.rlim_cur;
        uint64_t rest = most > has ? most - has : 0;
        left = rest < left ? rest : left;
    }
    return left;
}

asdic_status asdic_memory_check(asdic_context *ctx, uint64_t needed, uint64_t left,
                                const char *what, const char *remedy) {
    return needed <= left
               ? ASDIC_OK
               : asdic_fail(ctx, ASDIC_ERROR_MEMORY,
                            "%s %llu bytes of memory, %llu are available; %s", what,
                            (unsigned long long)needed, (unsigned long long)left, remedy);
}
