/*
 * Numbers that are drawn, the same on every machine: Knuth's linear congruential generator modulo 2^64.
 */
#ifndef ASDIC_TESTS_DICE_H
#define ASDIC_TESTS_DICE_H

#include <stdint.h>

/* From [0, 1); STATE begins as any number. */
static inline double random_unit(uint64_t *state) {
    *state = *state * 6364136223846793005u + 1442695040888963407u;
    return (double)(*state >> 11) * 0x1p-53;
}

#endif
