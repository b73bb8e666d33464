/*
 * The accumulator: blocks of [component][bin][beam], 64-bit fixed point. Integer sums do not depend
 * on order, so that a ping has the same bytes whatever the device's scheduling.
 *
 * There are three ways to add, with one result. Many work-items may add to one group: by 64-bit atomics
 * (DEPOSIT_ATOMIC64), or by two 32-bit atomics with a carry (DEPOSIT_ATOMIC32); each group then has a block.
 * Or rays leave their arrivals in memory, and one work-item a group adds them without atomics
 * (DEPOSIT_COLLECT, collect.cl). Such a work-item takes its groups one after the other and has two blocks,
 * which stay in a processor's cache: the running sums of all its groups so far, and a copy of those sums
 * from before the current group, so that the difference is the current group's own.
 */
#ifndef ASDIC_KERNEL_DEPOSIT_H
#define ASDIC_KERNEL_DEPOSIT_H

#include "ping_types.h"
#include "real.h"

#define DEPOSIT_COLLECT 0
#define DEPOSIT_ATOMIC64 1
#define DEPOSIT_ATOMIC32 2

#ifndef ASDIC_DEPOSIT
#define ASDIC_DEPOSIT DEPOSIT_COLLECT
#endif

#if ASDIC_DEPOSIT == DEPOSIT_ATOMIC64
#pragma OPENCL EXTENSION cl_khr_int64_base_atomics : enable
#endif

/* Water is deposited in the bin where its ray ends, yet a ray crosses every bin before that. In one column of
 * a group's water, turns "rays that end in bin n" into "rays that cross bin n". */
static inline void deposit_sum_crossings(__global long *water, uint bins, uint columns) {
    long sum = 0;
    for (uint bin = bins; bin-- > 0u;) {
        sum += water[(size_t)(bin)*columns];
        water[(size_t)(bin)*columns] = sum;
    }
}

/* From 0 to 1, by a hash of BITS: what is added before a fraction is cut off, so that it is rounded up as often as it
 * says. Many rays of less than a quantum each then add up to what they are worth, and the bytes repeat. */
static inline real dithers(natural bits) {
    natural hash = bits * (natural)(2654435769u);
    hash = (hash ^ (hash >> 15)) * (natural)(2246822519u);
    hash ^= hash >> 13;
    return to_real(hash >> 8) * R(5.9604645e-8);
}

/* Energies to whole quanta from 0 to LIMIT. Below 65536 quanta an energy is dithered by its own bits. */
static inline real whole_quanta(real quanta, real limit) {
    real whole = r_rint(r_min(quanta, limit));
    whole = choose(quanta < R(65536.0), r_floor(quanta + dithers(as_natural(quanta))), whole);
    return choose(whole > R(0.0), whole, R(0.0));
}

/* Neighbouring cells as one vector. */
#if ASDIC_WIDTH == 1
typedef long wholes;
#define to_wholes convert_long
#define wholes_to_real convert_float
#define load_wholes(at, cells) ((cells)[at])
#define store_wholes(values, at, cells) ((cells)[at] = (values))
#else
typedef ASDIC_JOIN(long, ASDIC_WIDTH) wholes;
#define to_wholes ASDIC_JOIN(convert_long, ASDIC_WIDTH)
#define wholes_to_real ASDIC_JOIN(convert_float, ASDIC_WIDTH)
#define load_wholes ASDIC_JOIN(vload, ASDIC_WIDTH)
#define store_wholes ASDIC_JOIN(vstore, ASDIC_WIDTH)
#endif
#define load_reals load_wholes
#define store_reals store_wholes

static inline void deposit_add(__global long *cell, long quanta) {
#if ASDIC_DEPOSIT == DEPOSIT_COLLECT
    *cell += quanta;
#elif ASDIC_DEPOSIT == DEPOSIT_ATOMIC64
    atom_add(cell, quanta);
#elif ASDIC_DEPOSIT == DEPOSIT_ATOMIC32
    /* Little-endian words; the carry of the low word is known from its old value. */
    volatile __global uint *words = (volatile __global uint *)cell;
    uint low = (uint)(quanta & 0xffffffffL), high = (uint)((ulong)quanta >> 32);
    uint old = atomic_add(words, low);
    high += (uint)(old + low < old);
    if (high != 0u) {
        atomic_add(words + 1, high);
    }
#endif
}

#endif
