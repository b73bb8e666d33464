/*
 * An image of levels too large for a page, averaged in energy (not in dB) to one that fits, row
 * by row, so that memory does not grow with the number of pings.
 */
#ifndef ASDIC_OUT_DECIMATE_H
#define ASDIC_OUT_DECIMATE_H

#include <asdic/output.h>

static inline size_t asdic_divide_up(size_t a, size_t b) {
    return a / b + (a % b != 0);
}

typedef struct asdic_decimator {
    size_t row_group, column_group; /* levels averaged into one; 1: none */
    size_t rows, columns;           /* of the result */
    size_t columns_in, rows_added;
    float *levels_db; /* rows * columns; NAN where there is no energy. Complete after _end */
    double *sum_lin;  /* of the current group of rows */
} asdic_decimator;

asdic_status asdic_decimator_init(asdic_context *ctx, size_t rows_in, size_t columns_in,
                                  size_t max_rows, size_t max_columns, asdic_decimator *out);
void asdic_decimator_finish(asdic_decimator *decimator);

/* The next row; at most rows_in of them. */
void asdic_decimator_add(asdic_decimator *decimator, const float *levels_db);

/* After the last row: completes a group that is not full. */
void asdic_decimator_end(asdic_decimator *decimator);

/* The result as a picture of bins that were BIN_LENGTH_M long. */
asdic_waterfall asdic_decimator_image(const asdic_decimator *decimator, double bin_length_m);

#endif
