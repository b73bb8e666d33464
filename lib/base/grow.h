/*
 * Lists that grow.
 */
#ifndef ASDIC_BASE_GROW_H
#define ASDIC_BASE_GROW_H

#include <stdbool.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

/* Room for NEEDED items, of EACH bytes, where the pointer at LIST leads to: as many again as there
 * was where there is too little. False when memory is short; the list stays then. */
static inline bool asdic_reserve(void *list, size_t needed, size_t *capacity, size_t each) {
    void *items;
    memcpy(&items, list, sizeof items);
    if (needed > *capacity) {
        size_t wanted = *capacity ? 2 * *capacity : 64;
        wanted = wanted < needed ? needed : wanted;
        items = realloc(items, wanted * each);
        if (!items) {
            return false;
        }
        memcpy(list, &items, sizeof items);
        *capacity = wanted;
    }
    return true;
}

/* The same for one more behind the COUNT that there are. */
static inline bool asdic_grow(void *list, size_t count, size_t *capacity, size_t each) {
    return asdic_reserve(list, count + 1, capacity, each);
}

#endif
