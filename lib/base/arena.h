/*
 * Memory that is freed all at once, for many small objects of one structure.
 */
#ifndef ASDIC_BASE_ARENA_H
#define ASDIC_BASE_ARENA_H

#include <stdbool.h>
#include <stddef.h>

/* Zero-initialised is empty. */
typedef struct asdic_arena {
    struct asdic_arena_block *blocks;
    bool is_short; /* of memory: something that was asked for is NULL */
} asdic_arena;

/* BYTES zeroed bytes, aligned for any object; NULL when memory is short. */
void *asdic_arena_alloc(asdic_arena *arena, size_t bytes);

/* A copy of LENGTH bytes with a zero byte behind them; NULL when memory is short. */
char *asdic_arena_string(asdic_arena *arena, const char *bytes, size_t length);

void asdic_arena_finish(asdic_arena *arena);

#endif
