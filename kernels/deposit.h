/*
 * The accumulator: 64-bit fixed point, [group][component][bin][beam]. Integer sums do not depend
 * on order, so that a ping has the same bytes whatever the device's scheduling.
 *
 * Three ways to add, one result: a work-item that owns a group adds plainly; many work-items on
 * one group use 64-bit atomics, or two 32-bit atomics with a carry.
 */
#ifndef ASDIC_KERNEL_DEPOSIT_H
#define ASDIC_KERNEL_DEPOSIT_H

#include "ping_types.h"
#include "real.h"

#define DEPOSIT_OWNED 0
#define DEPOSIT_ATOMIC64 1
#define DEPOSIT_ATOMIC32 2

#ifndef ASDIC_DEPOSIT
#define ASDIC_DEPOSIT DEPOSIT_OWNED
#endif

#if ASDIC_DEPOSIT == DEPOSIT_ATOMIC64
#pragma OPENCL EXTENSION cl_khr_int64_base_atomics : enable
#endif

/* Water is deposited where rays end, yet a ray crosses every bin before its last: turns "rays that
 * end in bin n" into "rays that cross bin n" in one column of a group's water. */
static inline void deposit_sum_crossings(__global long *water, uint bins, uint columns) {
    long sum = 0;
    for (uint bin = bins; bin-- > 0u;) {
        sum += water[(size_t)(bin)*columns];
        water[(size_t)(bin)*columns] = sum;
    }
}

static inline void deposit_add(__global long *cell, long quanta) {
#if ASDIC_DEPOSIT == DEPOSIT_OWNED
    *cell += quanta;
#elif ASDIC_DEPOSIT == DEPOSIT_ATOMIC64
    atom_add(cell, quanta);
#else
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
