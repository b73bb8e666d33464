/*
 * Runs of a list: entries behind each other that go to the same sums. Rays lie in order, and their neighbours'
 * echoes mostly do. The first entry of a run tells how many it has.
 */
#ifndef ASDIC_KERNEL_FAN_RUN_H
#define ASDIC_KERNEL_FAN_RUN_H

#include "fan_entry.h"

/* Makes the run that begins with ENTRY, before END; the entry behind it. */
static inline __global fan_entry *make_run(__global fan_entry *entry,
                                           __global const fan_entry *end) {
    __global fan_entry *first = entry;
    const uint rows = first->rows;
    uint count = 0u;
    while (entry < end && entry->rows == rows && count < MOST_IN_RUN) {
#if ASDIC_TRUTH
        if (entry->truth != first->truth) {
            break;
        }
#endif
        entry++;
        count++;
    }
    first->rows = rows | count << RUN_SHIFT;
    return entry;
}

static inline uint in_run(__global const fan_entry *entry) {
    return entry->rows >> RUN_SHIFT;
}

#endif
