#ifndef ASDIC_BASE_SORT_H
#define ASDIC_BASE_SORT_H

#include <stddef.h>

/* Ascending; none may be NAN. */
void asdic_sort_doubles(double *values, size_t count);

#endif
