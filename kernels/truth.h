/*
 * Truth: what each bin's energy comes from, where somebody asks for it (ASDIC_TRUTH). Levels do not depend on it.
 *
 * Beside the accumulator a ping then has rows of its own: the echoes' sines of depression, weighed by energy;
 * what came by way of the surface and of the bottom; and what each object sent back directly. An object's row
 * spans the bins that it can be heard in and no others. Cells lie [row][bin][receiver]: sums of whole quanta,
 * as the accumulator's, or, of many receivers (fan.cl), floats added in the order of rays, tile by tile of
 * receivers; there the depressions lie behind the components of their bin.
 */
#ifndef ASDIC_KERNEL_TRUTH_H
#define ASDIC_KERNEL_TRUTH_H

#include "ping_types.h"
#include "real.h"

#ifndef ASDIC_TRUTH
#define ASDIC_TRUTH 0
#endif

/* The word `more` of an arrival: bit 0 says whether others follow, 11 bits the row that its energy goes to
 * besides (0: none), 20 bits the sine of its depression. */
#define TRUTH_SINE_SHIFT (DEV_TRUTH_ROW_BITS + 1u)
#define TRUTH_SINE_MOST 1048575.0f

static inline uint truth_row(uint word) {
    return word >> 1u & ((1u << DEV_TRUTH_ROW_BITS) - 1u);
}

/* What multiplies the quanta of COMPONENT for the row of depressions, whose scale is one for all: (1 + sine of
 * depression) / 2; 0: the water, which has no place. */
static inline float truth_weight(__global const dev_ping *ping, uint component, uint word) {
    return ping->sums.truth_ratio[component] *
           ((float)(word >> TRUTH_SINE_SHIFT) * (1.0f / TRUTH_SINE_MOST));
}

/* --- of the rays of a vector ---------------------------------------------------------------------- */

/* The words for arrivals from directions with DOWN as their sine of depression. */
static inline natural truth_words(natural row, real down) {
    real part = r_min(r_max(R(0.5) + R(0.5) * down, R(0.0)), R(1.0));
    natural sine = as_natural(to_whole(part * (real)(TRUTH_SINE_MOST) + R(0.5)));
    return sine << TRUTH_SINE_SHIFT | row << 1u;
}

/* truth_weight. */
static inline real truth_weights(__global const dev_ping *ping, natural component, natural words) {
    real ratio, sine = to_real(words >> TRUTH_SINE_SHIFT) * (real)(1.0f / TRUTH_SINE_MOST);
    for (uint lane = 0; lane < ASDIC_WIDTH; lane++) {
        ((float *)&ratio)[lane] = ping->sums.truth_ratio[((const uint *)&component)[lane]];
    }
    return ratio * sine;
}

/* What tells the dithers of arrivals with WORDS from those of their quanta: by the bits but that which says whether others
 * follow. */
static inline natural truth_salts(natural words) {
    return (words | 1u) * 2654435769u;
}

/* A row of sums holds components behind each other, see ping_types.h. */
static inline natural truth_components(__global const dev_ping *ping, natural row) {
    natural component = (natural)(0u);
    for (uint c = 1u; c < DEV_DEPOSIT_COUNT; c++) {
        natural beyond = as_natural(row >= (natural)(c * ping->sums.component_rows));
        component += beyond & 1u;
    }
    return component;
}

/* --- cells ------------------------------------------------------------------------------------------ */

/* The first receiver's cell of BIN in ROW; bins beyond the row have none. */
#define TRUTH_NO_CELL ((size_t)(-1))

static inline size_t truth_cell(__global const dev_ping *ping, __global const dev_truth_row *rows,
                                uint row, uint bin) {
    dev_truth_row r = rows[row];
    return bin >= r.low && bin < r.high
               ? (size_t)(r.cell + (bin - r.low)) * ping->sums.truth_columns
               : TRUTH_NO_CELL;
}

/* The same of the row of depressions, which is the first and holds all bins. */
static inline size_t truth_depression_cell(__global const dev_ping *ping, uint bin) {
    return (size_t)(bin)*ping->sums.truth_columns;
}

/* This launch's row of pings (ping_batch.h). */
static inline __global const dev_truth_row *truth_rows(__global const dev_ping *ping,
                                                       __global const dev_truth_row *rows) {
    return rows + get_group_id(1) * (size_t)(ping->sums.truth_rows);
}

#endif
