#include "arena.h"

#include <stdalign.h>
#include <stdlib.h>
#include <string.h>

#define BLOCK_BYTES ((size_t)32768)

struct asdic_arena_block {
    struct asdic_arena_block *next;
    size_t used, capacity;
    alignas(max_align_t) char bytes[];
};

static struct asdic_arena_block *add_block(asdic_arena *arena, size_t bytes) {
    size_t capacity = bytes > BLOCK_BYTES ? bytes : BLOCK_BYTES;
    if (capacity > (size_t)-1 - sizeof(struct asdic_arena_block)) {
        return NULL;
    }
    struct asdic_arena_block *block = calloc(1, sizeof *block + capacity);
    if (!block) {
        return NULL;
    }
    block->capacity = capacity;
    block->next = arena->blocks;
    arena->blocks = block;
    return block;
}

void *asdic_arena_alloc(asdic_arena *arena, size_t bytes) {
    const size_t align = alignof(max_align_t);
    if (bytes > (size_t)-1 - align) {
        arena->is_short = true;
        return NULL;
    }
    bytes = (bytes + align - 1) / align * align;
    struct asdic_arena_block *block = arena->blocks;
    if (!block || block->capacity - block->used < bytes) {
        block = add_block(arena, bytes);
        if (!block) {
            arena->is_short = true;
            return NULL;
        }
    }
    void *object = block->bytes + block->used;
    block->used += bytes;
    return object;
}

char *asdic_arena_string(asdic_arena *arena, const char *bytes, size_t length) {
    char *string = length < (size_t)-1 ? asdic_arena_alloc(arena, length + 1) : NULL;
    if (string) {
        memcpy(string, bytes, length);
    }
    return string;
}

void asdic_arena_finish(asdic_arena *arena) {
    while (arena->blocks) {
        struct asdic_arena_block *next = arena->blocks->next;
        free(arena->blocks);
        arena->blocks = next;
    }
}
