/*
 * How much memory the machine can still give.
 */
#ifndef ASDIC_BASE_MEMORY_LEFT_H
#define ASDIC_BASE_MEMORY_LEFT_H

#include <stdint.h>

/* Bytes that may be allocated without swapping, as the system estimates it; UINT64_MAX where it does
 * not say. */
uint64_t asdic_memory_left(void);

#endif
