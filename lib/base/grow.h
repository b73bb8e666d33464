/*
 * Lists that grow.
 */
#ifndef ASDIC_BASE_GROW_H
#define ASDIC_BASE_GROW_H

#include <stdbool.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

/* Room for one more behind the COUNT items, of EACH bytes, that the pointer at LIST leads to: as many again where there
 * is none. False when memory is short; the list stays then. */
static inline bool asdic_grow(void *list, size_t count, size_t *capacity, size_t each) {
    void *items;
    memcpy(&items, list, sizeof items);
    if (count == *capacity) {
        size_t wanted = *capacity ? 2 * *capacity : 64;
        items = realloc(items, wanted * each);
        if (!items) {
            return false;
        }
        memcpy(list, &items, sizeof items);
        *capacity = wanted;
    }
    return true;
}

#endif
