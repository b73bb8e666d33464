/*
 * How much memory the machine can still give.
 */
#ifndef ASDIC_BASE_MEMORY_LEFT_H
#define ASDIC_BASE_MEMORY_LEFT_H

#include <asdic/context.h>

#include <stdint.h>

/* Bytes that may be allocated without swapping, as the system estimates it; UINT64_MAX where it does
 * not say. */
uint64_t asdic_memory_left(void);

/* Whether NEEDED bytes are LEFT; else ASDIC_ERROR_MEMORY, "WHAT NEEDED bytes of memory, LEFT are
 * available; REMEDY", before the system ends whom it likes. WHAT has the verb: "2 pings need". */
asdic_status asdic_memory_check(asdic_context *ctx, uint64_t needed, uint64_t left,
                                const char *what, const char *remedy);

#endif
