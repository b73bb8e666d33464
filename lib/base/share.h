/*
 * Work shared among the host's processors.
 */
#ifndef ASDIC_BASE_SHARE_H
#define ASDIC_BASE_SHARE_H

#include <stddef.h>

/* Threads of a share, at most. */
#define ASDIC_SHARE_MOST 64u

/* The processors that this process may use; 1 where that is not known. */
unsigned asdic_processors(void);

/* Calls WORK(USER, worker, first, end) for parts of 0 .. COUNT, STEP long but the last, which are taken in this
 * order by up to THREADS threads. The caller's is one of them, WORKER 0; no two of them have one number. Where a
 * thread cannot be started, the others do its work. */
void asdic_share(unsigned threads, size_t count, size_t step,
                 void (*work)(void *user, unsigned worker, size_t first, size_t end), void *user);

#endif
