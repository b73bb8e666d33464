/*
 * Sums of a fan: what the lists of a few bins bring to one receiver, or to vectors of them.
 */
#ifndef ASDIC_KERNEL_FAN_SUMS_H
#define ASDIC_KERNEL_FAN_SUMS_H

#include "beam.h"
#include "fan_entry.h"

/* A work-item sums BINS bins: of one receiver, or for vectors of a tile of them, PARTS vectors at a time. */
#if ASDIC_WIDTH == 1
#define PARTS 1u
#define BINS 1u
#define RECEIVERS 1u
#define LOAD_REAL(at) (*(at))
#define STORE_REAL(value, at) (*(at) = (value))
#else
#define PARTS 4u
#define BINS 16u
#define RECEIVERS ((uint)(DEV_FAN_TILE))
#define LOAD_REAL(at) ASDIC_JOIN(vload, ASDIC_WIDTH)(0, at)
#define STORE_REAL(value, at) ASDIC_JOIN(vstore, ASDIC_WIDTH)(value, 0, at)
#endif

/* Receivers from FIRST on, a lane each; behind the last one it stands again. Directions of their sides are
 * times the side's length in wavelengths. With a common axis only that of the horizontal side counts, in the
 * plane across that axis. */
typedef struct receivers {
    real y_wl[3];
#if !ASDIC_COMMON_AXIS
    real x[3], z_wl[3];
#endif
} receivers;

static receivers receivers_from(__global const dev_ping *ping, uint first) {
    __global const dev_beam *beams = (__global const dev_beam *)(ping + 1) + 1;
    receivers r;
    for (uint lane = 0; lane < ASDIC_WIDTH; lane++) {
        __global const dev_beam *beam = beams + min(first + lane, ping->beams - 1u);
#if ASDIC_COMMON_AXIS
        for (uint k = 0; k < 2u; k++) {
            __global const float *axis = ping->fan_rows + 3u * k;
            float y = axis[0] * beam->rows[3] + axis[1] * beam->rows[4] + axis[2] * beam->rows[5];
            ((float *)&r.y_wl[k])[lane] = y * beam->length_h_wl;
        }
#else
        for (uint k = 0; k < 3u; k++) {
            ((float *)&r.x[k])[lane] = beam->rows[k];
            ((float *)&r.y_wl[k])[lane] = beam->rows[3u + k] * beam->length_h_wl;
            ((float *)&r.z_wl[k])[lane] = beam->rows[6u + k] * beam->length_v_wl;
        }
#endif
    }
    return r;
}

/* One-way gain of the receivers towards ENTRY; with a common axis without the vertical factor, which the entry
 * carries. */
static inline real gains(const receivers *r, __global const fan_entry *entry, float rear_lin) {
    real x = (real)(entry->direction[0]), y = (real)(entry->direction[1]);
#if ASDIC_COMMON_AXIS
    mask front = r->y_wl[1] * x > r->y_wl[0] * y;
    return sinc2(r_fma(r->y_wl[0], x, r->y_wl[1] * y)) * choose(front, R(1.0), (real)(rear_lin));
#else
    real z = (real)(entry->direction[2]);
    return beam_pattern_lin(
        r->x[0] * x + r->x[1] * y + r->x[2] * z, r->y_wl[0] * x + r->y_wl[1] * y + r->y_wl[2] * z,
        r->z_wl[0] * x + r->z_wl[1] * y + r->z_wl[2] * z, R(1.0), R(1.0), (real)(rear_lin));
#endif
}

#if ASDIC_TRUTH

/* What a work-item has of the truth: bins FIRST to END - 1, the receivers from COLUMN on. */
typedef struct fan_truth {
    __global const dev_truth_row *rows; /* NULL: nobody asks */
    __global float *cells;
    uint first, end, column;
} fan_truth;

#define TRUTH_PARAMETER , fan_truth truth
#define TRUTH_ARGUMENT , truth

/* A receiver's cells, or those of a vector of them; NULL: none. */
typedef __global float *truth_cells;

/* The cells that an echo of ENTRY in BIN goes to besides, of the work-item's first receivers. */
static inline truth_cells cells_of(__global const dev_ping *ping, const fan_truth *t,
                                   __global const fan_entry *entry, uint bin) {
    uint row = row_of(entry->truth);
    if (row == 0u || !t->rows || bin < t->first || bin >= t->end) {
        return 0;
    }
    size_t cell = truth_cell(ping, t->rows, row, bin);
    return cell == TRUTH_NO_CELL ? 0 : t->cells + cell + t->column % (uint)(DEV_FAN_TILE);
}

#else
#define TRUTH_PARAMETER
#define TRUTH_ARGUMENT
#endif

#if ASDIC_WIDTH == 1

/* Of one bin and receiver. */
typedef struct fan_sums {
    float of[SUMS];
#if ASDIC_TRUTH
    fan_truth truth;
#endif
} fan_sums;

#if ASDIC_TRUTH
static inline void add_truth(__global const dev_ping *ping, __global const fan_entry *entry,
                             float gain, uint beyond, fan_sums *sums) {
    for (uint c = 0; c < echoes_of(entry->truth); c++) {
        if (sum_at(entry->rows, c) / SUMS != beyond) {
            continue;
        }
        sums->of[ASDIC_COMPONENTS] = r_fma(entry->down[c], gain, sums->of[ASDIC_COMPONENTS]);
        truth_cells cell = cells_of(ping, &sums->truth, entry, sums->truth.first);
        if (cell) {
            *cell = r_fma(entry->quanta[c], gain, *cell);
        }
    }
}
#endif

/* Adds what LIST, whose bin lies BEYOND bins before the sums' own, has for that. */
static void add_list(__global const dev_ping *ping, __global const fan_entry *entries,
                     fan_list list, const receivers *r, uint beyond, fan_sums *sums) {
    for (uint k = list.first; k < list.first + list.count; k++) {
        uint rows = entries[k].rows;
        if (!reaches(rows, beyond)) {
            continue;
        }
        float gain = gains(r, entries + k, ping->rear_lin);
#if ASDIC_TRUTH
        add_truth(ping, entries + k, gain, beyond, sums);
#endif
        for (uint c = 0; c < DEPOSITS; c++) {
            uint row = sum_at(rows, c);
            float quanta = row / SUMS == beyond ? entries[k].quanta[c] : 0.0f;
            float sum = 0.0f;
#pragma unroll
            for (uint component = 0; component < ASDIC_COMPONENTS; component++) {
                sum = row % SUMS == component ? sums->of[component] : sum;
            }
            sum = r_fma(quanta, gain, sum);
#pragma unroll
            for (uint component = 0; component < ASDIC_COMPONENTS; component++) {
                sums->of[component] = row % SUMS == component ? sum : sums->of[component];
            }
        }
    }
}

/* The sums of bin FIRST and the receiver from RESULTS on, whose components lie BINS apart. */
static void project(__global const dev_ping *ping, __global const fan_entry *entries,
                    __global const fan_list *lists, __global float *results, uint receiver,
                    uint bin, uint add TRUTH_PARAMETER) {
    receivers r = receivers_from(ping, receiver);
    fan_sums sums;
#if ASDIC_TRUTH
    sums.truth = truth;
    sums.truth.first = bin;
    sums.truth.end = bin + 1u;
    sums.truth.column = receiver;
#endif
#pragma unroll
    for (uint c = 0; c < SUMS; c++) {
        sums.of[c] = 0.0f;
    }
    for (uint beyond = min(bin, SPAN - 1u) + 1u; beyond-- > 0u;) {
        add_list(ping, entries, lists[bin - beyond], &r, beyond, &sums);
    }
#pragma unroll
    for (uint c = 0; c < SUMS; c++) {
        __global float *to = results + (size_t)(c)*ping->bins;
        *to = sums.of[c] + (add != 0u ? *to : 0.0f);
    }
}

#else

/* Of BINS bins, and of those before and behind that share entries with them. Of `parts` vectors of
 * receivers. */
typedef struct fan_sums {
    real of[(BINS + 2u * (SPAN - 1u)) * SUMS][PARTS];
    uint parts;
#if ASDIC_TRUTH
    fan_truth truth;
#endif
} fan_sums;

/* The entry behind the last one from K on, before END, that goes to the same sums as K: rays lie in order, and
 * their neighbours' echoes mostly do. */
static inline uint end_of_run(__global const fan_entry *entries, uint k, uint end) {
    uint rows = entries[k].rows, next = k + 1u;
#if ASDIC_TRUTH
    uint truth = entries[k].truth;
    while (next < end && entries[next].rows == rows && entries[next].truth == truth) {
        next++;
    }
#else
    while (next < end && entries[next].rows == rows) {
        next++;
    }
#endif
    return next;
}

/* A run: its first ENTRY, how many there are, the row AT of the sums that its list's bin is, and the vector P. */
typedef struct fan_run {
    __global const fan_entry *entry;
    uint count, at, p;
} fan_run;

static inline real *sum_of(fan_sums *sums, const fan_run *run, uint behind, uint c) {
    return &sums->of[run->at * SUMS + behind + sum_at(run->entry->rows, c)][run->p];
}

#if ASDIC_TRUTH
/* The cells that deposit C goes to besides. */
static inline truth_cells cells_of_run(__global const dev_ping *ping, const fan_sums *sums,
                                       const fan_run *run, uint c) {
    uint beyond = sum_at(run->entry->rows, c) / SUMS;
    truth_cells cells = cells_of(ping, &sums->truth, run->entry,
                                 sums->truth.first + run->at + beyond - (SPAN - 1u));
    return cells ? cells + run->p * ASDIC_WIDTH : 0;
}
#endif

/* What deposit C of a run adds to, for one vector of receivers, while it waits in registers: its sum; that of
 * depressions where it is an ECHO; what it goes to besides, IN_ROW. */
typedef struct waiting {
    real sum;
#if ASDIC_TRUTH
    real down, in_row;
    truth_cells cells;
#endif
} waiting;

WITHIN waiting take(__global const dev_ping *ping, fan_sums *sums, const fan_run *run, uint c,
                    const bool echo, const bool in_row) {
    waiting w = {*sum_of(sums, run, 0u, c)};
#if ASDIC_TRUTH
    if (echo) {
        w.down = *sum_of(sums, run, behind_of(run->entry->truth), c);
    }
    if (in_row) {
        w.cells = cells_of_run(ping, sums, run, c);
        w.in_row = w.cells ? LOAD_REAL(w.cells) : R(0.0);
    }
#endif
    return w;
}

/* Adds deposit C of ENTRY with GAIN. */
WITHIN void add(__global const fan_entry *entry, real gain, uint c, const bool echo,
                const bool in_row, waiting *w) {
    w->sum = r_fma((real)(entry->quanta[c]), gain, w->sum);
#if ASDIC_TRUTH
    if (echo) {
        w->down = r_fma((real)(entry->down[c]), gain, w->down);
    }
    if (in_row) {
        w->in_row = r_fma((real)(entry->quanta[c]), gain, w->in_row);
    }
#endif
}

WITHIN void put(fan_sums *sums, const fan_run *run, uint c, const bool echo, const bool in_row,
                const waiting *w) {
    *sum_of(sums, run, 0u, c) = w->sum;
#if ASDIC_TRUTH
    if (echo) {
        *sum_of(sums, run, behind_of(run->entry->truth), c) = w->down;
    }
    if (in_row && w->cells) {
        STORE_REAL(w->in_row, w->cells);
    }
#endif
}

/* Adds RUN to SUMS, with truth of the first two deposits or of ALL, and IN_ROW: for the row that it goes to. */
WITHIN void add_run(__global const dev_ping *ping, fan_run run, const receivers *r, const bool all,
                    const bool in_row, fan_sums *sums) {
    const bool all_in_row = all && in_row;
    for (run.p = 0; run.p < sums->parts; run.p++) {
        waiting w0 = take(ping, sums, &run, 0u, true, in_row);
        waiting w1 = take(ping, sums, &run, 1u, true, in_row);
        waiting w2 = take(ping, sums, &run, 2u, all, all_in_row);
        waiting w3 = take(ping, sums, &run, 3u, all, all_in_row);
        for (uint k = 0; k < run.count; k++) {
            __global const fan_entry *entry = run.entry + k;
            real gain = gains(r + run.p, entry, ping->rear_lin);
            add(entry, gain, 0u, true, in_row, &w0);
            add(entry, gain, 1u, true, in_row, &w1);
            add(entry, gain, 2u, all, all_in_row, &w2);
            add(entry, gain, 3u, all, all_in_row, &w3);
        }
        put(sums, &run, 0u, true, in_row, &w0);
        put(sums, &run, 1u, true, in_row, &w1);
        put(sums, &run, 2u, all, all_in_row, &w2);
        put(sums, &run, 3u, all, all_in_row, &w3);
    }
}

#if ASDIC_TRUTH
/* Runs of each kind. Apart: else compilers make one loop of all. */
static APART void add_run_in_row(__global const dev_ping *ping, fan_run run, const receivers *r,
                                 fan_sums *sums) {
    add_run(ping, run, r, false, true, sums);
}

#if ASDIC_HAS_MIRRORS
static APART void add_run_of_echoes(__global const dev_ping *ping, fan_run run, const receivers *r,
                                    fan_sums *sums) {
    add_run(ping, run, r, true, true, sums);
}
#endif
#endif

/* Adds the one entry of RUN, of whose sums two are one: they are taken and put one by one. */
static inline void add_alone(__global const dev_ping *ping, fan_run run, const receivers *r,
                             fan_sums *sums) {
    for (run.p = 0; run.p < sums->parts; run.p++) {
        real gain = gains(r + run.p, run.entry, ping->rear_lin);
        for (uint c = 0; c < DEPOSITS; c++) {
#if ASDIC_TRUTH
            bool echo = c < echoes_of(run.entry->truth);
#else
            bool echo = false;
#endif
            waiting w = take(ping, sums, &run, c, echo, echo);
            add(run.entry, gain, c, echo, echo, &w);
            put(sums, &run, c, echo, echo, &w);
        }
    }
}

/* Adds LIST, whose bin is row AT of the sums. */
static void add_list(__global const dev_ping *ping, __global const fan_entry *entries,
                     fan_list list, const receivers *r, uint at, fan_sums *sums) {
    const uint end = list.first + list.count, least = at < SPAN - 1u ? SPAN - 1u - at : 0u;
    for (uint k = list.first, next; k < end; k = next) {
        bool alone = (entries[k].rows & ALONE) != 0u;
        next = alone ? k + 1u : end_of_run(entries, k, end);
        fan_run run = {entries + k, next - k, at, 0u};
        if (!reaches(entries[k].rows, least)) {
            continue;
        }
        if (alone) {
            add_alone(ping, run, r, sums);
            continue;
        }
#if ASDIC_TRUTH
#if ASDIC_HAS_MIRRORS
        if (echoes_of(entries[k].truth) == DEPOSITS) {
            add_run_of_echoes(ping, run, r, sums);
            continue;
        }
#endif
        if (row_of(entries[k].truth) != 0u) {
            add_run_in_row(ping, run, r, sums);
            continue;
        }
#endif
        add_run(ping, run, r, false, false, sums);
    }
}

/* Row 2 i becomes the first halves of rows i and i + 8, lane by lane, row 2 i + 1 their second halves. */
static inline void interleave(const real *v, real *w) {
#pragma unroll
    for (uint i = 0; i < 8u; i++) {
        w[2u * i].even = v[i].lo;
        w[2u * i].odd = v[i + 8u].lo;
        w[2u * i + 1u].even = v[i].hi;
        w[2u * i + 1u].odd = v[i + 8u].hi;
    }
}

/* Lane i of row k becomes lane k of row i: a row's number and a lane's are four bits each, and an interleaving
 * turns all eight by one. */
static inline void transpose(real *v) {
    real w[BINS];
    interleave(v, w);
    interleave(w, v);
    interleave(v, w);
    interleave(w, v);
}

/* The first BINS sums of COMPONENT (the one behind the last: of depressions) and part P to the rows of RECEIVERS
 * receivers, STRIDE floats from each other, from TO on. */
static void store_sums(const fan_sums *sums, uint component, uint p, uint bins, uint receivers,
                       __global float *to, size_t stride, uint add) {
    real v[BINS];
#pragma unroll
    for (uint bin = 0; bin < BINS; bin++) {
        v[bin] = sums->of[(bin + SPAN - 1u) * SUMS + component][p];
    }
    transpose(v);
    for (uint k = 0; k < receivers; k++) {
        __global float *row = to + k * stride;
        if (bins == BINS) {
            vstore16(add != 0u ? v[k] + vload16(0, row) : v[k], 0, row);
            continue;
        }
        for (uint bin = 0; bin < bins; bin++) {
            row[bin] = ((float *)&v[k])[bin] + (add != 0u ? row[bin] : 0.0f);
        }
    }
}

/* The sums of the bins from BIN on and of the receivers of a tile from RECEIVER on, whose results begin
 * at RESULTS. */
static void project(__global const dev_ping *ping, __global const fan_entry *entries,
                    __global const fan_list *lists, __global float *results, uint receiver,
                    uint bin, uint add TRUTH_PARAMETER) {
    const uint end = min(receiver + RECEIVERS, ping->beams), bins = min(ping->bins - bin, BINS);
    const size_t stride = (size_t)(SUMS)*ping->bins;
    for (uint first = receiver; first < end; first += PARTS * ASDIC_WIDTH) {
        receivers r[PARTS];
        fan_sums sums;
        sums.parts = min((end - first + ASDIC_WIDTH - 1u) / ASDIC_WIDTH, PARTS);
#if ASDIC_TRUTH
        sums.truth = truth;
        sums.truth.first = bin;
        sums.truth.end = bin + bins;
        sums.truth.column = first;
#endif
        for (uint p = 0; p < sums.parts; p++) {
            r[p] = receivers_from(ping, first + p * ASDIC_WIDTH);
            for (uint k = 0; k < (BINS + 2u * (SPAN - 1u)) * SUMS; k++) {
                sums.of[k][p] = R(0.0);
            }
        }
        for (uint at = bin < SPAN - 1u ? SPAN - 1u - bin : 0u; at < bins + SPAN - 1u; at++) {
            add_list(ping, entries, lists[bin + at - (SPAN - 1u)], r, at, &sums);
        }
        for (uint p = 0; p < sums.parts; p++) {
            uint own = first + p * ASDIC_WIDTH;
            for (uint c = 0; c < SUMS; c++) {
                if (c < ASDIC_COMPONENTS && (ping->sums.present & 1u << c) == 0u) {
                    continue; /* nobody reads it */
                }
                store_sums(&sums, c, p, bins, min(end - own, (uint)(ASDIC_WIDTH)),
                           results + (own - receiver) * stride + c * (size_t)(ping->bins), stride,
                           add);
            }
        }
    }
}

#endif

#endif
