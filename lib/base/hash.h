/*
 * FNV-1a, 64 bits (Fowler, Noll, Vo; RFC 9923).
 */
#ifndef ASDIC_BASE_HASH_H
#define ASDIC_BASE_HASH_H

#include <stddef.h>
#include <stdint.h>
#include <string.h>

#define ASDIC_HASH_BEGIN 0xcbf29ce484222325u

/* Folds VALUE, a byte or a whole word, into HASH. */
static inline uint64_t asdic_hash_fold(uint64_t hash, uint64_t value) {
    return (hash ^ value) * 0x100000001b3u;
}

/* Which of COUNT slots NUMBERS, doubles without padding, belong to. Their low bits are often zero: high ones are
 * folded onto them. */
static inline size_t asdic_hash_slot(const void *numbers, size_t bytes, size_t count) {
    uint64_t hash = ASDIC_HASH_BEGIN, word;
    for (size_t i = 0; i + sizeof word <= bytes; i += sizeof word) {
        memcpy(&word, (const char *)numbers + i, sizeof word);
        hash = asdic_hash_fold(hash, word ^ word >> 29);
    }
    return (hash >> 32) % count;
}

#endif
