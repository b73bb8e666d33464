/*
 * Sums of a fan: what the lists of a few bins bring to one receiver, or to vectors of them.
 */
#ifndef ASDIC_KERNEL_FAN_SUMS_H
#define ASDIC_KERNEL_FAN_SUMS_H

#include "beam.h"
#include "fan_run.h"

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

/* SUM of this batch and BEFORE, that of those before. */
static inline real both_of(uint sum, real own, real before) {
    return ASDIC_HAS_MIRRORS && sum == LARGEST ? r_max(own, before) : own + before;
}

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
        sums->of[ASDIC_COMPONENTS] =
            r_fma(entry->quanta[c] * entry->down, gain, sums->of[ASDIC_COMPONENTS]);
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
#if ASDIC_HAS_MIRRORS
            if (is_mirrored(rows, c)) {
                sums->of[LARGEST] = r_max(sums->of[LARGEST], quanta * gain);
            }
#endif
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
        __global float *to = results + (size_t)(c)*DEV_FAN_ROW(ping->bins);
        *to = add != 0u ? both_of(c, sums.of[c], *to) : sums.of[c];
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

/* A run: its first ENTRY, how many there are, the SUMS of its list's bin, and the vector P. */
typedef struct fan_run {
    __global const fan_entry *entry;
    uint count, p;
    real (*sums)[PARTS];
#if ASDIC_TRUTH
    uint echoes;
    truth_cells cells[DEPOSITS]; /* that the echoes go to besides */
#endif
} fan_run;

/* The run that begins with ENTRY, whose list's bin is row AT of SUMS. */
static inline fan_run run_of(__global const dev_ping *ping, __global const fan_entry *entry,
                             uint at, fan_sums *sums) {
    fan_run run = {entry, in_run(entry), 0u, sums->of + at * SUMS};
#if ASDIC_TRUTH
    run.echoes = echoes_of(entry->truth);
    for (uint c = 0; c < DEPOSITS; c++) {
        uint bin = sums->truth.first + at + sum_at(entry->rows, c) / SUMS - (SPAN - 1u);
        run.cells[c] = c < run.echoes ? cells_of(ping, &sums->truth, entry, bin) : 0;
    }
#endif
    return run;
}

static inline real *sum_of(const fan_run *run, uint c) {
    return &run->sums[sum_at(run->entry->rows, c)][run->p];
}

/* What deposit C of RUN brought, which is not put yet: kept meanwhile, what was there takes registers of the loop. */
static inline real grown(const fan_run *run, uint c, real sum) {
    return sum - *sum_of(run, c);
}

/* Deposit C of RUN brought its sum to SUM and, where it is an echo, DOWN to that of depressions. */
static inline void put(const fan_run *run, uint c, real sum, real down) {
    real *to = sum_of(run, c);
#if ASDIC_TRUTH
    if (c < run->echoes) {
        to[behind_of(run->entry->truth) * PARTS] += down;
        if (run->cells[c]) {
            truth_cells cells = run->cells[c] + run->p * ASDIC_WIDTH;
            STORE_REAL(LOAD_REAL(cells) + grown(run, c, sum), cells);
        }
    }
#endif
    *to = sum;
}

/* A mirror's deposit C of RUN is one of SINGLE. */
static inline void put_largest(const fan_run *run, uint c, real single) {
    if (is_mirrored(run->entry->rows, c)) {
        real *to = sum_of(run, c) + (LARGEST - DEV_DEPOSIT_MULTIPATH) * PARTS;
        *to = r_max(*to, single);
    }
}

/* What multiplies the echoes of ENTRY for the sum of depressions. */
static inline real down_of(__global const fan_entry *entry) {
#if ASDIC_TRUTH
    return (real)(entry->down);
#else
    return R(0.0);
#endif
}

/* Entries of a run whose gains are found first, then used: either takes most of a processor's registers. */
#define TOGETHER 32u

/* Adds RUN, for one vector of receivers after the other. UNLIKE: each entry has its own depression. MIRRORED: deposits
 * came by way of mirrors. */
WITHIN void add_run(__global const dev_ping *ping, fan_run run, const receivers *r, uint parts,
                    const bool unlike, const bool mirrored) {
    for (fan_run to = run; to.p < parts; to.p++) {
        real s0 = *sum_of(&to, 0u), s1 = *sum_of(&to, 1u);
        real s2 = *sum_of(&to, 2u), s3 = *sum_of(&to, 3u);
        real d0 = R(0.0), d1 = R(0.0), d2 = R(0.0), d3 = R(0.0);
        real l0 = R(0.0), l1 = R(0.0), l2 = R(0.0), l3 = R(0.0);
        for (uint from = 0; from < to.count; from += TOGETHER) {
            __global const fan_entry *entries = to.entry + from;
            const uint count = min(to.count - from, TOGETHER);
            real gain[TOGETHER];
            for (uint k = 0; k < count; k++) {
                gain[k] = gains(r + to.p, entries + k, ping->rear_lin);
            }
            for (uint k = 0; k < count; k++) {
                __global const fan_entry *entry = entries + k;
                s0 = r_fma((real)(entry->quanta[0]), gain[k], s0);
                s1 = r_fma((real)(entry->quanta[1]), gain[k], s1);
                s2 = r_fma((real)(entry->quanta[2]), gain[k], s2);
                s3 = r_fma((real)(entry->quanta[3]), gain[k], s3);
                if (mirrored) {
                    l0 = r_max(l0, (real)(entry->quanta[0]) * gain[k]);
                    l1 = r_max(l1, (real)(entry->quanta[1]) * gain[k]);
                    l2 = r_max(l2, (real)(entry->quanta[2]) * gain[k]);
                    l3 = r_max(l3, (real)(entry->quanta[3]) * gain[k]);
                }
                if (unlike) {
                    real down = gain[k] * down_of(entry);
                    d0 = r_fma((real)(entry->quanta[0]), down, d0);
                    d1 = r_fma((real)(entry->quanta[1]), down, d1);
                    if (mirrored) { /* else they are no echoes */
                        d2 = r_fma((real)(entry->quanta[2]), down, d2);
                        d3 = r_fma((real)(entry->quanta[3]), down, d3);
                    }
                }
            }
        }
        const real down = down_of(to.entry);
        put(&to, 0u, s0, unlike ? d0 : grown(&to, 0u, s0) * down);
        put(&to, 1u, s1, unlike ? d1 : grown(&to, 1u, s1) * down);
        put(&to, 2u, s2, unlike ? d2 : grown(&to, 2u, s2) * down);
        put(&to, 3u, s3, unlike ? d3 : grown(&to, 3u, s3) * down);
        if (mirrored) {
            put_largest(&to, 0u, l0);
            put_largest(&to, 1u, l1);
            put_largest(&to, 2u, l2);
            put_largest(&to, 3u, l3);
        }
    }
}

/* Apart: else compilers make one loop of both. */
static APART void add_run_alike(__global const dev_ping *ping, fan_run run, const receivers *r,
                                uint parts) {
    add_run(ping, run, r, parts, false, false);
}

#if ASDIC_HAS_MIRRORS
static APART void add_run_mirrored(__global const dev_ping *ping, fan_run run, const receivers *r,
                                   uint parts) {
    add_run(ping, run, r, parts, false, true);
}
#endif

#if ASDIC_TRUTH
static APART void add_run_unlike(__global const dev_ping *ping, fan_run run, const receivers *r,
                                 uint parts) {
    add_run(ping, run, r, parts, true, false);
}
#endif

#if ASDIC_TRUTH && ASDIC_HAS_MIRRORS
static APART void add_run_unlike_mirrored(__global const dev_ping *ping, fan_run run,
                                          const receivers *r, uint parts) {
    add_run(ping, run, r, parts, true, true);
}
#endif

/* Adds RUN, of whose sums two are one: they are taken and put one by one. */
static APART void add_alone(__global const dev_ping *ping, fan_run run, const receivers *r,
                            uint parts) {
    for (fan_run to = run; to.p < parts; to.p++) {
        for (uint k = 0; k < to.count; k++) {
            __global const fan_entry *entry = to.entry + k;
            real gain = gains(r + to.p, entry, ping->rear_lin);
            for (uint c = 0; c < DEPOSITS; c++) {
                real quanta = (real)(entry->quanta[c]);
                put(&to, c, r_fma(quanta, gain, *sum_of(&to, c)), quanta * gain * down_of(entry));
                put_largest(&to, c, quanta * gain);
            }
        }
    }
}

/* Adds LIST, whose bin is row AT of the sums. */
static void add_list(__global const dev_ping *ping, __global const fan_entry *entries,
                     fan_list list, const receivers *r, uint at, fan_sums *sums) {
    const uint least = at < SPAN - 1u ? SPAN - 1u - at : 0u;
    __global const fan_entry *entry = entries + list.first, *end = entry + list.count;
    for (; entry < end; entry += in_run(entry)) {
        if (!reaches(entry->rows, least)) {
            continue;
        }
        fan_run run = run_of(ping, entry, at, sums);
        if ((entry->rows & ALONE) != 0u) {
            add_alone(ping, run, r, sums->parts);
            continue;
        }
#if ASDIC_TRUTH && ASDIC_HAS_MIRRORS
        if ((entry->truth & DEPTHS_UNLIKE) != 0u && is_mirrored(entry->rows, 0u)) {
            add_run_unlike_mirrored(ping, run, r, sums->parts);
            continue;
        }
#endif
#if ASDIC_TRUTH
        if ((entry->truth & DEPTHS_UNLIKE) != 0u) {
            add_run_unlike(ping, run, r, sums->parts);
            continue;
        }
#endif
#if ASDIC_HAS_MIRRORS
        if (is_mirrored(entry->rows, 0u)) {
            add_run_mirrored(ping, run, r, sums->parts);
            continue;
        }
#endif
        add_run_alike(ping, run, r, sums->parts);
    }
}

/* Of each four lanes of A and B the first two, or the last two, by turns; then the same two by two. */
static inline real low_of(real a, real b) {
    return (real)(a.s0, b.s0, a.s1, b.s1, a.s4, b.s4, a.s5, b.s5, a.s8, b.s8, a.s9, b.s9, a.sc, b.sc,
                  a.sd, b.sd);
}

static inline real high_of(real a, real b) {
    return (real)(a.s2, b.s2, a.s3, b.s3, a.s6, b.s6, a.s7, b.s7, a.sa, b.sa, a.sb, b.sb, a.se, b.se,
                  a.sf, b.sf);
}

static inline real low_pairs_of(real a, real b) {
    return (real)(a.s01, b.s01, a.s45, b.s45, a.s89, b.s89, a.scd, b.scd);
}

static inline real high_pairs_of(real a, real b) {
    return (real)(a.s23, b.s23, a.s67, b.s67, a.sab, b.sab, a.sef, b.sef);
}

/* Of four rows from V on: lane 4 L + I of row J becomes lane 4 L + J of row I. */
static inline void transpose_fours(real *v) {
    real low01 = low_of(v[0], v[1]), low23 = low_of(v[2], v[3]);
    real high01 = high_of(v[0], v[1]), high23 = high_of(v[2], v[3]);
    v[0] = low_pairs_of(low01, low23);
    v[1] = high_pairs_of(low01, low23);
    v[2] = low_pairs_of(high01, high23);
    v[3] = high_pairs_of(high01, high23);
}

/* Lane i of row k becomes lane k of row i: in blocks of four by four, which are what processors shuffle at once,
 * then block by block. */
static inline void transpose(real *v) {
#pragma unroll
    for (uint k = 0; k < 16u; k += 4u) {
        transpose_fours(v + k);
    }
#pragma unroll
    for (uint k = 0; k < 4u; k++) {
        real a = v[k], b = v[k + 4u], c = v[k + 8u], d = v[k + 12u];
        v[k] = (real)(a.s0123, b.s0123, c.s0123, d.s0123);
        v[k + 4u] = (real)(a.s4567, b.s4567, c.s4567, d.s4567);
        v[k + 8u] = (real)(a.s89ab, b.s89ab, c.s89ab, d.s89ab);
        v[k + 12u] = (real)(a.scdef, b.scdef, c.scdef, d.scdef);
    }
}

/* The first BINS sums of COMPONENT (the one behind the last: of depressions) and part P to the rows of RECEIVERS
 * receivers, STRIDE floats from each other, from TO on: rows have room for those behind their last bin. */
static void store_sums(const fan_sums *sums, uint component, uint p, uint receivers,
                       __global float *to, size_t stride, uint add) {
    real v[BINS];
#pragma unroll
    for (uint bin = 0; bin < BINS; bin++) {
        v[bin] = sums->of[(bin + SPAN - 1u) * SUMS + component][p];
    }
    transpose(v);
    for (uint k = 0; k < receivers; k++) {
        __global float *row = to + k * stride;
        STORE_REAL(add != 0u ? both_of(component, v[k], LOAD_REAL(row)) : v[k], row);
    }
}

/* The sums of the bins from BIN on and of the receivers of a tile from RECEIVER on, whose results begin
 * at RESULTS. */
static void project(__global const dev_ping *ping, __global const fan_entry *entries,
                    __global const fan_list *lists, __global float *results, uint receiver,
                    uint bin, uint add TRUTH_PARAMETER) {
    const uint end = min(receiver + RECEIVERS, ping->beams), bins = min(ping->bins - bin, BINS);
    const size_t row = DEV_FAN_ROW(ping->bins);
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
                store_sums(&sums, c, p, min(end - own, (uint)(ASDIC_WIDTH)),
                           results + ((own - receiver) * (size_t)(SUMS) + c) * row, SUMS * row,
                           add);
            }
        }
    }
}

#endif

#endif
