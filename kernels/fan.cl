/*
 * Many receivers: every arrival is weighed by every receiver's own pattern.
 *
 * shade.cl and multipath.cl leave arrivals, one direction each, in the order of their rays (receive.h).
 * fan_count, fan_place and fan_scatter sort them by range: a list of entries for every bin. fan_project
 * sums each list for all receivers, which are the lanes of its vectors. A sort that keeps the order of
 * rays makes every sum a sum in the order of rays, so that its bytes do not depend on work-groups.
 */
#include "beam.h"
#include "order.h"
#include "truth.h"

#ifndef ASDIC_HAS_MIRRORS
#define ASDIC_HAS_MIRRORS 0
#endif
#ifndef ASDIC_LAYERS
#define ASDIC_LAYERS 0
#endif

/* Components of a row, see ping_types.h. */
#ifndef ASDIC_COMPONENTS
#define ASDIC_COMPONENTS DEV_DEPOSIT_COUNT
#endif

/* Deposits of an arrival, and bins that those of one entry span. */
#define DEPOSITS 4u
#define SPAN 4u

/* Sums of a bin: its components', then, where truth is wanted, that of depressions (truth.h). */
#define SUMS (ASDIC_COMPONENTS + ASDIC_TRUTH)

/* Up to four deposits from one direction. Their bins are KEY, the list's own bin, to KEY + SPAN - 1. */
typedef struct fan_entry {
    float direction[3]; /* as in the arrival */
    uint rows; /* a byte for each deposit: (bins beyond KEY) * SUMS + component; and NOT_PAIRED */
    float quanta[4];
#if ASDIC_TRUTH
    float depression; /* what multiplies the echo's quanta for the sum of depressions */
    uint truth; /* the row that they go to besides, 0: none; how far behind the echo's sum that of
                         depressions is; see below */
#endif
} fan_entry;

/* In `truth`: all deposits are echoes; else the first two are, and the others water. */
#define ECHOES_ALONE 0x80000000u
#define TRUTH_BEHIND_SHIFT 16u

static inline uint echoes_of(uint truth) {
    return (truth & ECHOES_ALONE) != 0u ? DEPOSITS : DEPOSITS / 2u;
}

static inline uint row_of(uint truth) {
    return truth & ((1u << TRUTH_BEHIND_SHIFT) - 1u);
}

static inline uint behind_of(uint truth) {
    return (truth & ~ECHOES_ALONE) >> TRUTH_BEHIND_SHIFT;
}

/* In `rows`: the entry goes to a row of truth, or all its deposits are echoes. */
#define NOT_PAIRED 0x80000000u

/* The sum, counted from those of KEY on, that deposit C of ROWS goes to. */
static inline uint sum_at(uint rows, uint c) {
    return rows >> 8u * c & 0x7fu;
}

typedef struct fan_list {
    uint first, count;
} fan_list;

/* Where a deposit goes. */
static inline uint bin_of_row(__global const dev_ping *ping, uint row) {
    return row % ping->sums.component_rows;
}

/* The lowest and highest bins of deposits FIRST to END of ARRIVAL that hold anything; none: low > high. */
typedef struct bin_range {
    uint low, high;
} bin_range;

static inline bin_range bins_of(__global const dev_ping *ping, __global const dev_arrival *arrival,
                                uint first, uint end) {
    bin_range b = {0xffffffffu, 0u};
    for (uint c = first; c < end; c++) {
        if (arrival->quanta[c] != 0.0f) {
            uint bin = bin_of_row(ping, arrival->row[c]);
            b.low = min(b.low, bin);
            b.high = max(b.high, bin);
        }
    }
    return b;
}

/* Lists of entries under way: COUNTS [bin][block] are, of each block of rays, how many entries it has
 * for a bin, then where the next of them goes. ENTRIES is NULL while they are only counted. */
typedef struct fan_sort {
    __global const dev_ping *ping;
    __global uint *counts;
    __global fan_entry *entries;
    uint blocks, block;
} fan_sort;

/* Deposits FIRST to END of ARRIVAL to the list of bin KEY. */
static inline void sort_deposits(const fan_sort *sort, __global const dev_arrival *arrival,
                                 uint key, uint first, uint end) {
    uint at = sort->counts[(size_t)(key)*sort->blocks + sort->block]++;
    if (!sort->entries) {
        return;
    }
    __global const dev_ping *ping = sort->ping;
    __global fan_entry *to = sort->entries + at;
    uint rows = 0u;
    for (uint c = 0; c < DEPOSITS; c++) {
        bool here = c >= first && c < end && arrival->quanta[c] != 0.0f;
        uint component = here ? arrival->row[c] / ping->sums.component_rows : 0u;
        uint beyond = here ? bin_of_row(ping, arrival->row[c]) - key : 0u;
        rows |= (SUMS * beyond + component) << 8u * c;
        to->quanta[c] = here ? arrival->quanta[c] : 0.0f;
    }
    for (uint k = 0; k < 3u; k++) {
        to->direction[k] = arrival->direction[k];
    }
#if ASDIC_TRUTH
    uint component = truth_component(ping, arrival->row[0]), row = truth_row(arrival->more);
    bool echoes_alone = component == DEV_DEPOSIT_MULTIPATH;
    rows |= row != 0u || echoes_alone ? NOT_PAIRED : 0u;
    to->depression = truth_weight(ping, component, arrival->more);
    to->truth = row | (ASDIC_COMPONENTS - component) << TRUTH_BEHIND_SHIFT |
                (echoes_alone ? ECHOES_ALONE : 0u);
#endif
    to->rows = rows;
}

/* An arrival is one entry where its deposits lie close together, else two. */
static inline void sort_arrival(const fan_sort *sort, __global const dev_arrival *arrival) {
    bin_range all = bins_of(sort->ping, arrival, 0u, DEPOSITS);
    if (all.low > all.high) {
        return;
    }
    if (all.high - all.low < SPAN) {
        sort_deposits(sort, arrival, all.low, 0u, DEPOSITS);
        return;
    }
    for (uint from = 0u; from < DEPOSITS; from += DEPOSITS / 2u) {
        bin_range own = bins_of(sort->ping, arrival, from, from + DEPOSITS / 2u);
        if (own.low <= own.high) {
            sort_deposits(sort, arrival, own.low, from, from + DEPOSITS / 2u);
        }
    }
}

#if ASDIC_LAYERS
/* Water through layers: its deposits lie far apart. */
static inline void sort_water(const fan_sort *sort, __global const dev_arrival *arrival) {
    for (uint c = 0u; c < DEPOSITS; c++) {
        if (arrival->quanta[c] != 0.0f) {
            sort_deposits(sort, arrival, bin_of_row(sort->ping, arrival->row[c]), c, c + 1u);
        }
    }
}
#endif

/* The arrivals of a block of rays, ray by ray. */
static inline void sort_block(const fan_sort *sort, __global const dev_arrival *arrivals) {
    uint slots = batch_slots(sort->ping), each = (slots + sort->blocks - 1u) / sort->blocks;
    uint end = min((sort->block + 1u) * each, slots);
    for (uint ray = sort->block * each; ray < end; ray++) {
        sort_arrival(sort, arrivals + ray);
#if ASDIC_HAS_MIRRORS
        if ((arrivals[ray].more & 1u) != 0u) {
            sort_arrival(sort, arrivals + DEV_ARRIVAL_ALONG * (size_t)(slots) + ray);
            sort_arrival(sort, arrivals + DEV_ARRIVAL_ACROSS * (size_t)(slots) + ray);
        }
#endif
#if ASDIC_LAYERS
        __global const dev_arrival *water =
            arrivals + DEV_ARRIVAL_WATER(ASDIC_HAS_MIRRORS) * (size_t)(slots) + ray;
        for (uint set = 0; set < water->more >> DEV_WATER_SHIFT; set++) {
            sort_water(sort, water + set * (size_t)(slots));
        }
#endif
    }
}

/* fan_count: COUNTS of one block of rays each work-item. */
__kernel void fan_count(__global const dev_ping *ping, __global const dev_arrival *arrivals,
                        __global uint *counts, __global uint *made, uint blocks) {
    uint block = (uint)(get_global_id(0));
    if (block >= blocks) {
        return;
    }
    if (block == 0u) {
        *made = 0u;
    }
    for (uint bin = 0; bin < ping->bins; bin++) {
        counts[(size_t)(bin)*blocks + block] = 0u;
    }
    fan_sort sort = {ping, counts, 0, blocks, block};
    sort_block(&sort, arrivals);
}

/* fan_place: room for the list of one bin each work-item, the blocks' parts one behind the other. Which
 * list comes first in memory is of no account. */
__kernel void fan_place(__global const dev_ping *ping, __global uint *counts,
                        __global fan_list *lists, __global uint *made, uint blocks) {
    uint bin = (uint)(get_global_id(0)), total = 0u;
    if (bin >= ping->bins) {
        return;
    }
    __global uint *own = counts + (size_t)(bin)*blocks;
    for (uint block = 0; block < blocks; block++) {
        total += own[block];
    }
    fan_list list = {atomic_add(made, total), total};
    lists[bin] = list;
    for (uint block = 0, next = list.first; block < blocks; block++) {
        uint count = own[block];
        own[block] = next;
        next += count;
    }
}

/* fan_scatter: the entries of one block of rays each work-item to their lists. */
__kernel void fan_scatter(__global const dev_ping *ping, __global const dev_arrival *arrivals,
                          __global uint *counts, __global fan_entry *entries, uint blocks) {
    uint block = (uint)(get_global_id(0));
    if (block < blocks) {
        fan_sort sort = {ping, counts, entries, blocks, block};
        sort_block(&sort, arrivals);
    }
}

/* A work-item sums RUN bins: of one receiver, or for vectors of a tile of them, PARTS vectors at a time. */
#if ASDIC_WIDTH == 1
#define PARTS 1u
#define RUN 1u
#define RECEIVERS 1u
#define LOAD_REAL(at) (*(at))
#define STORE_REAL(value, at) (*(at) = (value))
#else
#define PARTS 4u
#define RUN 16u
#define RECEIVERS ((uint)(DEV_FAN_TILE))
#define LOAD_REAL(at) ASDIC_JOIN(vload, ASDIC_WIDTH)(0, at)
#define STORE_REAL(value, at) ASDIC_JOIN(vstore, ASDIC_WIDTH)(value, 0, at)
#endif

/* Receivers from FIRST on, a lane each; behind the last one it stands again. With a common axis only the
 * direction of the horizontal side counts, in the plane across that axis. */
typedef struct receivers {
    real y[3], length_h_wl;
#if !ASDIC_COMMON_AXIS
    real x[3], z[3], length_v_wl;
#endif
} receivers;

static receivers receivers_from(__global const dev_ping *ping, uint first) {
    __global const dev_beam *beams = (__global const dev_beam *)(ping + 1) + 1;
    receivers r;
    for (uint lane = 0; lane < ASDIC_WIDTH; lane++) {
        __global const dev_beam *beam = beams + min(first + lane, ping->beams - 1u);
        ((float *)&r.length_h_wl)[lane] = beam->length_h_wl;
#if ASDIC_COMMON_AXIS
        for (uint k = 0; k < 2u; k++) {
            __global const float *axis = ping->fan_rows + 3u * k;
            ((float *)&r.y[k])[lane] =
                axis[0] * beam->rows[3] + axis[1] * beam->rows[4] + axis[2] * beam->rows[5];
        }
#else
        ((float *)&r.length_v_wl)[lane] = beam->length_v_wl;
        for (uint k = 0; k < 3u; k++) {
            ((float *)&r.x[k])[lane] = beam->rows[k];
            ((float *)&r.y[k])[lane] = beam->rows[3u + k];
            ((float *)&r.z[k])[lane] = beam->rows[6u + k];
        }
#endif
    }
    return r;
}

/* One-way gain of the receivers towards ARRIVAL; with a common axis without the vertical factor, which
 * the entry carries. */
static inline real gains(const receivers *r, __global const fan_entry *entry, float rear_lin) {
    real x = (real)(entry->direction[0]), y = (real)(entry->direction[1]);
#if ASDIC_COMMON_AXIS
    mask front = r->y[1] * x - r->y[0] * y > R(0.0);
    return sinc2(r->length_h_wl * (r->y[0] * x + r->y[1] * y)) *
           choose(front, R(1.0), (real)(rear_lin));
#else
    real z = (real)(entry->direction[2]);
    return beam_pattern_lin(
        r->x[0] * x + r->x[1] * y + r->x[2] * z, r->y[0] * x + r->y[1] * y + r->y[2] * z,
        r->z[0] * x + r->z[1] * y + r->z[2] * z, r->length_h_wl, r->length_v_wl, (real)(rear_lin));
#endif
}

#if ASDIC_TRUTH

/* What a work-item has of the truth: bins FIRST to END - 1, the receivers from COLUMN to LAST. */
typedef struct fan_truth {
    __global const dev_truth_row *rows; /* NULL: nobody asks */
    __global float *cells;
    uint first, end, column, last;
} fan_truth;

#define TRUTH_PARAMETER , fan_truth truth
#define TRUTH_ARGUMENT , truth

/* Adds GAIN times deposit C of ENTRY, of the list of bin KEY, to its row. */
static inline void add_to_row(__global const dev_ping *ping, const fan_truth *t,
                              __global const fan_entry *entry, uint key, uint c, const real *gain) {
    uint bin = key + (sum_at(entry->rows, c)) / SUMS;
    if (bin < t->first || bin >= t->end) {
        return;
    }
    size_t cell = truth_cell(ping, t->rows, row_of(entry->truth), bin);
    if (cell == TRUTH_NO_CELL) {
        return;
    }
    __global float *at = t->cells + cell + t->column % (uint)(DEV_FAN_TILE);
    for (uint p = 0; p < PARTS && t->column + p * ASDIC_WIDTH < t->last; p++) {
        real sum = r_fma((real)(entry->quanta[c]), gain[p], LOAD_REAL(at + p * ASDIC_WIDTH));
        STORE_REAL(sum, at + p * ASDIC_WIDTH);
    }
}

/* The same of all its echoes. */
static inline void add_to_rows(__global const dev_ping *ping, const fan_truth *t,
                               __global const fan_entry *entry, uint key, const real *gain) {
    for (uint c = 0; c < echoes_of(entry->truth); c++) {
        if (entry->quanta[c] > 0.0f) {
            add_to_row(ping, t, entry, key, c, gain);
        }
    }
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
static inline void add_depression(__global const fan_entry *entry, float gain, uint beyond,
                                  fan_sums *sums) {
    for (uint c = 0; c < echoes_of(entry->truth); c++) {
        uint row = sum_at(entry->rows, c);
        float quanta = row / SUMS == beyond ? entry->quanta[c] : 0.0f;
        sums->of[ASDIC_COMPONENTS] =
            r_fma(quanta * entry->depression, gain, sums->of[ASDIC_COMPONENTS]);
    }
}
#endif

/* Adds what LIST, whose bin lies BEYOND bins before the sums' own, has for that. */
static void add_list(__global const dev_ping *ping, __global const fan_entry *entries,
                     fan_list list, const receivers *r, uint beyond, fan_sums *sums) {
    for (uint k = list.first; k < list.first + list.count; k++) {
        float gain = gains(r, entries + k, ping->rear_lin);
        uint rows = entries[k].rows;
#if ASDIC_TRUTH
        add_depression(entries + k, gain, beyond, sums);
        if (row_of(entries[k].truth) != 0u && sums->truth.rows) {
            add_to_rows(ping, &sums->truth, entries + k, sums->truth.first - beyond, &gain);
        }
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
    sums.truth.last = ping->beams;
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

/* Of RUN bins, and of those before and behind that share entries with them. */
typedef struct fan_sums {
    real of[(RUN + 2u * (SPAN - 1u)) * SUMS][PARTS];
#if ASDIC_TRUTH
    fan_truth truth;
#endif
} fan_sums;

#if ASDIC_TRUTH
/* Adds to the sums of depressions what deposits FIRST and the next of ENTRY, whose list's bin is AT, bring with
 * GAIN. */
static inline void add_depressions(__global const fan_entry *entry, uint first, const real *gain,
                                   uint at, fan_sums *sums) {
    uint behind = at * SUMS + behind_of(entry->truth);
#pragma unroll
    for (uint c = first; c < first + 2u; c++) {
        real quanta = (real)(entry->quanta[c] * entry->depression);
        real *sum = sums->of[behind + (sum_at(entry->rows, c))];
#pragma unroll
        for (uint p = 0; p < PARTS; p++) {
            sum[p] = r_fma(quanta, gain[p], sum[p]);
        }
    }
}
#endif

/* Whether ENTRY and the next go to the same sums and nowhere else: most do, and each sum is then read and
 * written once for both. */
static inline bool go_together(__global const fan_entry *entry) {
    return entry[0].rows == entry[1].rows && (entry[0].rows & NOT_PAIRED) == 0u;
}

/* Adds ENTRY with GAIN and then the one behind it with NEXT. */
static inline void add_two(__global const fan_entry *entry, const real *gain, const real *next,
                           uint at, fan_sums *sums) {
    uint rows = entry->rows;
#pragma unroll
    for (uint c = 0; c < DEPOSITS; c++) {
        real one = (real)(entry[0].quanta[c]), two = (real)(entry[1].quanta[c]);
        real *sum = sums->of[at * SUMS + sum_at(rows, c)];
#pragma unroll
        for (uint p = 0; p < PARTS; p++) {
            sum[p] = r_fma(two, next[p], r_fma(one, gain[p], sum[p]));
        }
    }
#if ASDIC_TRUTH
    uint behind = at * SUMS + behind_of(entry->truth);
#pragma unroll
    for (uint c = 0; c < DEPOSITS / 2u; c++) {
        real one = (real)(entry[0].quanta[c] * entry[0].depression);
        real two = (real)(entry[1].quanta[c] * entry[1].depression);
        real *sum = sums->of[behind + sum_at(rows, c)];
#pragma unroll
        for (uint p = 0; p < PARTS; p++) {
            sum[p] = r_fma(two, next[p], r_fma(one, gain[p], sum[p]));
        }
    }
#endif
}

/* Adds LIST, whose bin is row AT of the sums. */
static void add_list(__global const dev_ping *ping, __global const fan_entry *entries,
                     fan_list list, const receivers *r, uint at, fan_sums *sums) {
    const uint end = list.first + list.count;
    for (uint k = list.first; k < end; k++) {
        real gain[PARTS];
#pragma unroll
        for (uint p = 0; p < PARTS; p++) {
            gain[p] = gains(r + p, entries + k, ping->rear_lin);
        }
        if (k + 1u < end && go_together(entries + k)) {
            real next[PARTS];
            k++;
#pragma unroll
            for (uint p = 0; p < PARTS; p++) {
                next[p] = gains(r + p, entries + k, ping->rear_lin);
            }
            add_two(entries + k - 1u, gain, next, at, sums);
            continue;
        }
        uint rows = entries[k].rows;
#if ASDIC_TRUTH
        add_depressions(entries + k, 0u, gain, at, sums);
        if (echoes_of(entries[k].truth) == DEPOSITS) {
            add_depressions(entries + k, DEPOSITS / 2u, gain, at, sums);
        }
        if (row_of(entries[k].truth) != 0u && sums->truth.rows) {
            add_to_rows(ping, &sums->truth, entries + k, sums->truth.first + at - (SPAN - 1u),
                        gain);
        }
#endif
#pragma unroll
        for (uint c = 0; c < DEPOSITS; c++) {
            real quanta = (real)(entries[k].quanta[c]);
            real *sum = sums->of[at * SUMS + sum_at(rows, c)];
#pragma unroll
            for (uint p = 0; p < PARTS; p++) {
                sum[p] = r_fma(quanta, gain[p], sum[p]);
            }
        }
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
    real w[RUN];
    interleave(v, w);
    interleave(w, v);
    interleave(v, w);
    interleave(w, v);
}

/* The first BINS sums of COMPONENT (the one behind the last: of depressions) and part P to the rows of RECEIVERS
 * receivers, STRIDE floats from each other, from TO on. */
static void store_sums(const fan_sums *sums, uint component, uint p, uint bins, uint receivers,
                       __global float *to, size_t stride, uint add) {
    real v[RUN];
#pragma unroll
    for (uint bin = 0; bin < RUN; bin++) {
        v[bin] = sums->of[(bin + SPAN - 1u) * SUMS + component][p];
    }
    transpose(v);
    for (uint k = 0; k < receivers; k++) {
        __global float *row = to + k * stride;
        if (bins == RUN) {
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
    const uint end = min(receiver + RECEIVERS, ping->beams), bins = min(ping->bins - bin, RUN);
    const size_t stride = (size_t)(SUMS)*ping->bins;
    for (uint first = receiver; first < end; first += PARTS * ASDIC_WIDTH) {
        receivers r[PARTS];
        fan_sums sums;
#if ASDIC_TRUTH
        sums.truth = truth;
        sums.truth.first = bin;
        sums.truth.end = bin + bins;
        sums.truth.column = first;
        sums.truth.last = end;
#endif
        for (uint p = 0; p < PARTS; p++) {
            r[p] = receivers_from(ping, first + p * ASDIC_WIDTH);
            for (uint k = 0; k < (RUN + 2u * (SPAN - 1u)) * SUMS; k++) {
                sums.of[k][p] = R(0.0);
            }
        }
        for (uint at = bin < SPAN - 1u ? SPAN - 1u - bin : 0u; at < bins + SPAN - 1u; at++) {
            add_list(ping, entries, lists[bin + at - (SPAN - 1u)], r, at, &sums);
        }
        for (uint p = 0; p < PARTS && first + p * ASDIC_WIDTH < end; p++) {
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

/* fan_project: tile TILE_AT of receivers. RESULTS: quanta as floats, [receiver][sum][bin]; ADD: to
 * those of the batches before. One work-item per RUN bins and RECEIVERS receivers. */
__kernel void fan_project(__global const dev_ping *ping, __global const fan_entry *entries,
                          __global const fan_list *lists, __global float *results, uint tile_at,
                          uint add, __global const dev_truth_row *rows, __global float *cells) {
    const uint parts = (uint)(DEV_FAN_TILE) / RECEIVERS, id = (uint)(get_global_id(0));
    uint receiver = tile_at * (uint)(DEV_FAN_TILE) + id % parts * RECEIVERS;
    uint bin = id / parts * RUN;
    if (receiver < ping->beams && bin < ping->bins) {
#if ASDIC_TRUTH
        size_t before = tile_at * (size_t)(ping->sums.truth_cells) * ping->sums.truth_columns;
        fan_truth truth = {ping->sums.truth_rows != 0u ? rows : 0, cells + before, 0u, 0u, 0u, 0u};
#endif
        project(ping, entries, lists, results + (size_t)(receiver)*SUMS * ping->bins + bin,
                receiver, bin, add TRUTH_ARGUMENT);
    }
}
