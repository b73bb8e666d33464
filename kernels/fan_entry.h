/*
 * Entries of a fan's lists: what an arrival (receive.h) brings to the bins of every receiver, and how arrivals are
 * sorted to the lists of their bins.
 */
#ifndef ASDIC_KERNEL_FAN_ENTRY_H
#define ASDIC_KERNEL_FAN_ENTRY_H

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

/* Sums of a bin: its components', then, where truth is wanted, that of depressions (truth.h). Behind them, where
 * there are mirrors, is no sum but the largest deposit of theirs. */
#define LARGEST (ASDIC_COMPONENTS + ASDIC_TRUTH)
#define SUMS (LARGEST + ASDIC_HAS_MIRRORS)

/* Up to four deposits from one direction. Their bins are KEY, the list's own bin, to KEY + SPAN - 1. */
typedef struct fan_entry {
    float direction[3]; /* as in the arrival */
    uint rows;          /* the sums that they go to; see below */
#if ASDIC_TRUTH
    uint truth; /* the row that they go to besides, 0: none; how far behind the echo's sum that of
                   depressions is; see below */
#endif
    float quanta[DEPOSITS];
#if ASDIC_TRUTH
    float down; /* what multiplies the echoes' quanta for the sum of depressions */
#endif
} fan_entry;

/* In `truth`: all deposits are echoes; else the first two are, and the others water or nothing. Of the first entry
 * of a run (fan_run.h): the sines of depression are unlike. */
#define ECHOES_ALONE 0x80000000u
#define DEPTHS_UNLIKE 0x40000000u
#define TRUTH_BEHIND_SHIFT 16u

static inline uint echoes_of(uint truth) {
    return (truth & ECHOES_ALONE) != 0u ? DEPOSITS : DEPOSITS / 2u;
}

static inline uint row_of(uint truth) {
    return truth & ((1u << TRUTH_BEHIND_SHIFT) - 1u);
}

static inline uint behind_of(uint truth) {
    return (truth & ~(ECHOES_ALONE | DEPTHS_UNLIKE)) >> TRUTH_BEHIND_SHIFT;
}

static inline uint component_of(uint truth) {
    return ASDIC_COMPONENTS - behind_of(truth);
}

/* `rows` are the sums, counted from those of KEY on, of the first deposit and of the third, seven bits each:
 * (bins beyond KEY) * SUMS + component. The second and fourth go to the next bin's. Then ALONE: of the four sums two
 * are one. And of how many entries this is the first of a run (fan_run.h). */
#define ROW_BITS 7u
#define ALONE (1u << 2u * ROW_BITS)
#define RUN_SHIFT (2u * ROW_BITS + 1u)
#define MOST_IN_RUN ((1u << (32u - RUN_SHIFT)) - 1u)

/* The sum that deposit C of ROWS goes to. */
static inline uint sum_at(uint rows, uint c) {
    return (rows >> c / 2u * ROW_BITS & ((1u << ROW_BITS) - 1u)) + c % 2u * SUMS;
}

/* Whether deposit C of ROWS came by way of a mirror. */
static inline bool is_mirrored(uint rows, uint c) {
    return ASDIC_HAS_MIRRORS && sum_at(rows, c) % SUMS == DEV_DEPOSIT_MULTIPATH;
}

/* Whether any deposit of ROWS lies BINS bins beyond KEY, or more. */
static inline bool reaches(uint rows, uint bins) {
    return max(sum_at(rows, 1u), sum_at(rows, 3u)) >= bins * SUMS;
}

typedef struct fan_list {
    uint first, count;
} fan_list;

/* An arrival's deposits. */
typedef struct landing {
    uint4 bin, component;
    float4 quanta;
} landing;

static inline landing landing_of(__global const dev_ping *ping,
                                 __global const dev_arrival *arrival) {
    landing l = {vload4(0, arrival->row), (uint4)(0u), vload4(0, arrival->quanta)};
    for (uint c = 1u; c < DEV_DEPOSIT_COUNT; c++) {
        uint4 beyond = as_uint4(l.bin >= (uint4)(ping->sums.component_rows));
        l.bin -= beyond & (uint4)(ping->sums.component_rows);
        l.component -= beyond;
    }
    return l;
}

/* The lowest and highest bins of deposits that hold anything; none: low > high. */
typedef struct bin_range {
    uint low, high;
} bin_range;

static inline bin_range bins_of(const landing *l) {
    uint4 none = as_uint4(l->quanta == (float4)(0.0f)), low = l->bin | none, high = l->bin & ~none;
    low.lo = min(low.lo, low.hi);
    high.lo = max(high.lo, high.hi);
    bin_range b = {min(low.s0, low.s1), max(high.s0, high.s1)};
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

/* An entry's two deposits at a time, for sum AT and for that of the next bin. */
typedef struct two_deposits {
    float2 quanta;
    uint at;
    bool any;
} two_deposits;

/* Where QUANTA of one COMPONENT go that lie in one BIN or two neighbours. The two sums are those of the list's own
 * bin, KEY, and the next wherever they can be: so neighbours' entries go to the same sums. */
static inline two_deposits place_two(uint2 bin, uint2 component, float2 quanta, uint key) {
    bool first = quanta.s0 != 0.0f, second = quanta.s1 != 0.0f;
    uint high = max(first ? bin.s0 : 0u, second ? bin.s1 : 0u);
    uint low = high <= key + 1u ? key : high - 1u;
    float2 lower = {bin.s0 == low ? quanta.s0 : 0.0f, bin.s1 == low ? quanta.s1 : 0.0f};
    float2 upper = quanta - lower;
    two_deposits two = {{lower.s0 + lower.s1, upper.s0 + upper.s1},
                        (low - key) * SUMS + component.s0,
                        first || second};
    return two;
}

static inline bool are_apart(uint rows) {
    uint a = sum_at(rows, 0u), b = sum_at(rows, 2u);
    return a != b && a + SUMS != b && a != b + SUMS;
}

/* The deposits L of ARRIVAL to the list of bin KEY. */
static inline void sort_deposits(const fan_sort *sort, __global const dev_arrival *arrival,
                                 const landing *l, uint key) {
    uint at = sort->counts[(size_t)(key)*sort->blocks + sort->block]++;
    if (!sort->entries) {
        return;
    }
    __global fan_entry *to = sort->entries + at;
    two_deposits lo = place_two(l->bin.lo, l->component.lo, l->quanta.lo, key);
    two_deposits hi = place_two(l->bin.hi, l->component.hi, l->quanta.hi, key);
    float4 quanta = {lo.quanta.s0, lo.quanta.s1, hi.quanta.s0, hi.quanta.s1};
    /* Where there are no others, nothing is added to sums that the first are not. */
    uint second = hi.any ? hi.at : (lo.at + 1u) % ASDIC_COMPONENTS;
    uint rows = lo.at | second << ROW_BITS;
    vstore4(quanta, 0, to->quanta);
    for (uint k = 0; k < 3u; k++) {
        to->direction[k] = arrival->direction[k];
    }
#if ASDIC_TRUTH
    uint component = l->component.s0;
    bool echoes_alone = component == DEV_DEPOSIT_MULTIPATH && hi.any;
    to->down = truth_weight(sort->ping, component, arrival->more);
    to->truth = truth_row(arrival->more) | (ASDIC_COMPONENTS - component) << TRUTH_BEHIND_SHIFT |
                (echoes_alone ? ECHOES_ALONE : 0u);
#endif
    to->rows = rows | (are_apart(rows) ? 0u : ALONE);
}

/* The part of an arrival that goes to one list. */
static inline void sort_part(const fan_sort *sort, __global const dev_arrival *arrival,
                             const landing *all, float4 quanta) {
    landing part = {all->bin, all->component, quanta};
    bin_range b = bins_of(&part);
    if (b.low <= b.high) {
        sort_deposits(sort, arrival, &part, b.low);
    }
}

/* An arrival is one entry where its deposits lie close together, else two. */
static inline void sort_arrival(const fan_sort *sort, __global const dev_arrival *arrival) {
    landing l = landing_of(sort->ping, arrival);
    bin_range all = bins_of(&l);
    if (all.low <= all.high && all.high - all.low < SPAN) {
        sort_deposits(sort, arrival, &l, all.low);
    } else if (all.low <= all.high) {
        sort_part(sort, arrival, &l, (float4)(l.quanta.lo, 0.0f, 0.0f));
        sort_part(sort, arrival, &l, (float4)(0.0f, 0.0f, l.quanta.hi));
    }
}

#if ASDIC_LAYERS
/* Water through layers: its deposits lie far apart. */
static inline void sort_water(const fan_sort *sort, __global const dev_arrival *arrival) {
    landing l = landing_of(sort->ping, arrival);
    for (uint turn = 0u; turn < 2u; turn++) {
        sort_part(sort, arrival, &l, (float4)(l.quanta.s0, 0.0f, 0.0f, 0.0f));
        sort_part(sort, arrival, &l, (float4)(0.0f, l.quanta.s1, 0.0f, 0.0f));
        landing turned = {l.bin.zwxy, l.component.zwxy, l.quanta.zwxy};
        l = turned;
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

#endif
