/*
 * Runs of a list: entries behind each other that go to the same sums. Rays lie in order, and their neighbours'
 * echoes mostly do. The first entry of a run tells how many it has.
 */
#ifndef ASDIC_KERNEL_FAN_RUN_H
#define ASDIC_KERNEL_FAN_RUN_H

#include "fan_entry.h"

#if ASDIC_TRUTH
/* In short runs sines are alike more often. */
#define LONGEST_RUN 64u
/* Sines of depression this close to each other are alike: their run has their mean, weighed by its quanta. */
#define ALIKE 0.003f

/* What multiplies the quanta of a run under way for the sum of depressions. */
typedef struct run_down {
    float least, most, sum, quanta;
} run_down;

static inline void take_down(__global const fan_entry *entry, run_down *d) {
    float2 quanta = vload2(0, entry->quanta);
    if (echoes_of(entry->truth) == DEPOSITS) {
        quanta += vload2(1, entry->quanta);
    }
    float both = quanta.s0 + quanta.s1;
    d->least = fmin(d->least, entry->down);
    d->most = fmax(d->most, entry->down);
    d->sum += entry->down * both;
    d->quanta += both;
}

/* Notes D in FIRST, where sines are alike: else every entry has its own. A weight is half a sine (truth_weight). */
static inline void end_down(__global const dev_ping *ping, __global fan_entry *first,
                            const run_down *d) {
    float ratio = ping->sums.truth_ratio[component_of(first->truth)];
    if (d->most - d->least > 0.5f * ALIKE * ratio) {
        first->truth |= DEPTHS_UNLIKE;
    } else if (d->quanta > 0.0f) {
        first->down = d->sum / d->quanta;
    }
}
#else
#define LONGEST_RUN MOST_IN_RUN
#endif

/* Makes the run that begins with ENTRY, before END; the entry behind it. */
static inline __global fan_entry *make_run(__global const dev_ping *ping, __global fan_entry *entry,
                                           __global const fan_entry *end) {
    __global fan_entry *first = entry;
    const uint rows = first->rows;
    uint count = 0u;
#if ASDIC_TRUTH
    const uint truth = first->truth;
    run_down down = {FLT_MAX, -FLT_MAX, 0.0f, 0.0f};
#endif
    while (entry < end && entry->rows == rows && count < LONGEST_RUN) {
#if ASDIC_TRUTH
        if (entry->truth != truth) {
            break;
        }
        take_down(entry, &down);
#endif
        entry++;
        count++;
    }
#if ASDIC_TRUTH
    end_down(ping, first, &down);
#endif
    first->rows = rows | count << RUN_SHIFT;
    return entry;
}

static inline uint in_run(__global const fan_entry *entry) {
    return entry->rows >> RUN_SHIFT;
}

#endif
