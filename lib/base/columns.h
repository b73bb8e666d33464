/*
 * A few columns of numbers from a CSV file.
 */
#ifndef ASDIC_BASE_COLUMNS_H
#define ASDIC_BASE_COLUMNS_H

#include <asdic/context.h>

/* Reads the COLUMNS ("a,b"), which the header of PATH has in any order among others, into *ROWS: row
 * after row, their numbers in the order of COLUMNS; free() them. LINES gets the line of each row, the
 * same. Empty lines and lines that begin with # are skipped. ASDIC_ERROR_INPUT names file and line. */
asdic_status asdic_columns_read(asdic_context *ctx, const char *path, const char *columns,
                                double **rows, size_t **lines, size_t *count);

#endif
