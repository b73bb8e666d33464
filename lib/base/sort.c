#include "sort.h"

#include <stdlib.h>
#include <string.h>

static int compare(const void *a, const void *b) {
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

void asdic_sort_doubles(double *values, size_t count) {
    qsort(values, count, sizeof *values, compare);
}

void asdic_sort_keep(void *list, size_t *count, size_t most, const void *item, size_t size,
                     bool (*first)(const void *a, const void *b)) {
    char *items = list;
    size_t at = *count;
    while (at > 0 && first(item, items + (at - 1) * size)) {
        at--;
    }
    if (at < most) {
        *count += *count < most ? 1 : 0;
        memmove(items + (at + 1) * size, items + at * size, (*count - 1 - at) * size);
        memcpy(items + at * size, item, size);
    }
}
