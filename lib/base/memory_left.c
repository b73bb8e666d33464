#include "memory_left.h"

#include "context.h"

#include <stdio.h>
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

uint64_t asdic_memory_left(void) {
    struct rlimit limit;
    uint64_t left = system_left();
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
