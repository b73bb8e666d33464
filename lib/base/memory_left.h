/*
 * How much memory the machine can still give.
 */
#ifndef ASDIC_BASE_MEMORY_LEFT_H
#define ASDIC_BASE_MEMORY_LEFT_H

#include <asdic/context.h>

#include <stdint.h>

/* Bytes that can be allocated without swapping, as the system estimates; UINT64_MAX where it does
 * not tell. */
uint64_t asdic_memory_left(void);

/* Succeeds when NEEDED bytes are LEFT, else fails with ASDIC_ERROR_MEMORY and "WHAT NEEDED bytes of
 * memory, LEFT are available; REMEDY". Asked before allocation, because Linux kills a process that
 * uses more than there is. WHAT includes the verb: "2 pings need". */
asdic_status asdic_memory_check(asdic_context *ctx, uint64_t needed, uint64_t left,
                                const char *what, const char *remedy);

#endif
