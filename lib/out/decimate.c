#include "decimate.h"

#include "base/context.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

asdic_status asdic_decimator_init(asdic_context *ctx, size_t rows_in, size_t columns_in,
                                  size_t max_rows, size_t max_columns, asdic_decimator *out) {
    *out = (asdic_decimator){.row_group = asdic_divide_up(rows_in, max_rows),
                             .column_group = asdic_divide_up(columns_in, max_columns),
                             .columns_in = columns_in};
    out->rows = asdic_divide_up(rows_in, out->row_group);
    out->columns = asdic_divide_up(columns_in, out->column_group);
    out->levels_db = malloc(out->rows * out->columns * sizeof *out->levels_db);
    out->sum_lin = calloc(out->columns, sizeof *out->sum_lin);
    if (!out->levels_db || !out->sum_lin) {
        asdic_decimator_finish(out);
        return asdic_fail_memory(ctx, "a picture");
    }
    for (size_t i = 0; i < out->rows * out->columns; i++) {
        out->levels_db[i] = NAN;
    }
    return ASDIC_OK;
}

void asdic_decimator_finish(asdic_decimator *decimator) {
    free(decimator->levels_db);
    free(decimator->sum_lin);
    *decimator = (asdic_decimator){0};
}

/* Turns the sums of ROWS_IN_GROUP rows into levels; the last column may be narrower. */
static void close_group(asdic_decimator *d, size_t row, size_t rows_in_group) {
    for (size_t column = 0; column < d->columns; column++) {
        size_t first = column * d->column_group;
        size_t wide =
            d->columns_in - first < d->column_group ? d->columns_in - first : d->column_group;
        double mean = d->sum_lin[column] / (double)(wide * rows_in_group);
        d->levels_db[row * d->columns + column] = mean > 0.0 ? (float)(10.0 * log10(mean)) : NAN;
    }
    memset(d->sum_lin, 0, d->columns * sizeof *d->sum_lin);
}

void asdic_decimator_add(asdic_decimator *d, const float *levels_db) {
    size_t row = d->rows_added / d->row_group;
    d->rows_added++;
    if (d->row_group == 1 && d->column_group == 1) {
        memcpy(d->levels_db + row * d->columns, levels_db, d->columns * sizeof *levels_db);
        return;
    }
    for (size_t i = 0; i < d->columns_in; i++) {
        if (isfinite(levels_db[i])) {
            d->sum_lin[i / d->column_group] += pow(10.0, 0.1 * (double)levels_db[i]);
        }
    }
    if (d->rows_added % d->row_group == 0) {
        close_group(d, row, d->row_group);
    }
}

void asdic_decimator_end(asdic_decimator *d) {
    size_t open = d->rows_added % d->row_group;
    if (open > 0) {
        close_group(d, d->rows_added / d->row_group, open);
    }
}

asdic_waterfall asdic_decimator_image(const asdic_decimator *d, double bin_length_m) {
    return (asdic_waterfall){.levels_db = d->levels_db,
                             .pings = d->rows,
                             .bins = d->columns,
                             .bin_length_m = bin_length_m * (double)d->column_group};
}
