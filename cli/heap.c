#include "cli_state.h"

#include <stdint.h>
#include <stdlib.h>
#include <sys/mman.h>
#include <unistd.h>

#if defined(__GLIBC__) && defined(MADV_HUGEPAGE)

#include <malloc.h>

/* As much as compiling kernels takes, and most jobs; the system gives memory when it is first written to. */
#define HEAP_BYTES (128 << 20)
#define PAD_BYTES (1 << 20)
/* Larger blocks are mapped one by one and given back at once: glibc's own limit. */
#define MAPPED_BYTES (32 << 20)

/* For the linker that PoCL starts for every kernel. */
#define LINKER_TUNABLES "glibc.malloc.hugetlb=1:glibc.malloc.top_pad=16777216"

/* One heap for all threads, of huge pages, grown once. PoCL compiles on a thread of its own, whose heap would
 * grow by a few pages at a time: a tenth to a fifth of a cold start, a quarter of a warm one. Where memory is not
 * glibc's (sanitizers, valgrind), this changes nothing. */
void cli_heap_begin(void) {
    const uintptr_t huge = 2 << 20;
    mallopt(M_ARENA_MAX, 1);
    mallopt(M_MMAP_THRESHOLD, MAPPED_BYTES);
    mallopt(M_TRIM_THRESHOLD, 2 * HEAP_BYTES);
    mallopt(M_TOP_PAD, HEAP_BYTES);
    uintptr_t begin = ((uintptr_t)sbrk(0) + huge - 1) / huge * huge;
    /* A block for which the heap has no room, so that it grows, by the padding as well. */
    void *volatile block = malloc(PAD_BYTES);
    free(block);
    uintptr_t end = (uintptr_t)sbrk(0) / huge * huge;
    mallopt(M_TOP_PAD, PAD_BYTES);
    if (begin < end) {
        (void)madvise((void *)begin, end - begin, MADV_HUGEPAGE);
    }
    setenv("GLIBC_TUNABLES", LINKER_TUNABLES, 0);
}

#else

void cli_heap_begin(void) {
}

#endif
