#ifndef ASDIC_BASE_SORT_H
#define ASDIC_BASE_SORT_H

#include <stdbool.h>
#include <stddef.h>

/* Ascending; none may be NAN. */
void asdic_sort_doubles(double *values, size_t count);

/* Puts ITEM among the *COUNT items of SIZE bytes in LIST, which go FIRST to last: behind its equals. The list keeps MOST
 * of them, more than none; what comes behind those is forgotten. */
void asdic_sort_keep(void *list, size_t *count, size_t most, const void *item, size_t size,
                     bool (*first)(const void *a, const void *b));

#endif
