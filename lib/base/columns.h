/*
 * Tables of numbers in CSV files: some of their columns, all rows.
 */
#ifndef ASDIC_BASE_COLUMNS_H
#define ASDIC_BASE_COLUMNS_H

#include "problems.h"

typedef struct asdic_column {
    const char *name;
    double min, max;
    const char *below; /* what is said besides of a value less than MIN; NULL: nothing */
} asdic_column;

#define ASDIC_COLUMNS_MOST 8

/* Columns that a header has in any order, among others. The first one's values rise from row to row. */
typedef struct asdic_columns {
    const asdic_column *items;
    size_t count;
    const char *rises; /* what a value is of the one before, as "later than" */
    const char *about; /* what is said besides of a header with none of them; "": nothing */
} asdic_columns;

/* Reads the COLUMNS of PATH into *ROWS: row after row, their numbers in the order of COLUMNS; free() them.
 * *LINES gets the line of each row, the same. Empty lines and lines that begin with # are skipped. All that
 * is wrong in the file goes to PROBLEMS, which keep PATH; the rows are NULL then. ASDIC_ERROR_INPUT: it
 * cannot be read. */
asdic_status asdic_columns_read(asdic_context *ctx, const char *path, const asdic_columns *columns,
                                asdic_problems *problems, double **rows, size_t **lines,
                                size_t *count);

#endif
