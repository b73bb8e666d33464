/*
 * Echoes of a coherent ping in the order of gates of range, and in each in that of slots: a count by blocks of slots, where
 * each begins, and the move there.
 */
#include "coherent.h"

/* One work-item per block of slots; COUNTS [gate][block]. */
__kernel void coherent_count(__global const dev_coherent *c, __global const uint *gates,
                             __global uint *counts) {
    uint block = (uint)(get_global_id(0));
    if (block >= c->blocks) {
        return;
    }
    uint step = (c->slots + c->blocks - 1u) / c->blocks, end = min((block + 1u) * step, c->slots);
    for (uint gate = 0; gate < c->gates; gate++) {
        counts[(size_t)(gate)*c->blocks + block] = 0u;
    }
    for (uint slot = block * step; slot < end; slot++) {
        if (gates[slot] != NO_GATE) {
            counts[(size_t)(gates[slot]) * c->blocks + block]++;
        }
    }
}

/* One work-item per gate: counts to places within the gate; FIRST, one more than gates, how many each has.
 * No work-item goes through all counts: llvmpipe leaves a work-item's loops after 65,535 rounds. */
__kernel void coherent_offset(__global const dev_coherent *c, __global uint *counts,
                              __global uint *first) {
    uint gate = (uint)(get_global_id(0));
    if (gate >= c->gates) {
        return;
    }
    uint sum = 0u;
    for (uint block = 0; block < c->blocks; block++) {
        size_t at = (size_t)(gate)*c->blocks + block;
        uint count = counts[at];
        counts[at] = sum;
        sum += count;
    }
    first[gate] = sum;
}

/* One work-item: FIRST, how many each gate has, to where each begins. */
__kernel void coherent_first(__global const dev_coherent *c, __global uint *first) {
    if (get_global_id(0) != 0) {
        return;
    }
    uint sum = 0u;
    for (uint gate = 0; gate < c->gates; gate++) {
        uint count = first[gate];
        first[gate] = sum;
        sum += count;
    }
    first[c->gates] = sum;
}

__kernel void coherent_sort(__global const dev_coherent *c, __global const uint *gates,
                            __global uint *counts, __global const uint *first,
                            __global const dev_echo *echoes, __global dev_echo *sorted) {
    uint block = (uint)(get_global_id(0));
    if (block >= c->blocks) {
        return;
    }
    uint step = (c->slots + c->blocks - 1u) / c->blocks, end = min((block + 1u) * step, c->slots);
    for (uint slot = block * step; slot < end; slot++) {
        if (gates[slot] != NO_GATE) {
            uint place = counts[(size_t)(gates[slot]) * c->blocks + block]++;
            sorted[first[gates[slot]] + place] = echoes[slot];
        }
    }
}
