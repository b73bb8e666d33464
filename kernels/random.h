/*
 * Counter-based random numbers: Philox4x32-10.
 *
 * Source: Salmon, Moraes, Dror, Shaw, "Parallel random numbers: as easy as 1, 2, 3", SC11. The
 * value depends on (key, counter) alone, so that a ray's numbers do not depend on which device,
 * work-item or order drew them. Known-answer vectors: tests/unit/test_speckle.c.
 */
#ifndef ASDIC_KERNEL_RANDOM_H
#define ASDIC_KERNEL_RANDOM_H

#include "real.h"

/* What a stream of numbers is for: the last counter word, so that streams never meet. */
#define RANDOM_SAMPLE 0u
#define RANDOM_SHIFT 1u
#define RANDOM_SPECKLE 2u
#define RANDOM_TRIAL 3u
#define RANDOM_DRAW 4u
#define RANDOM_SCATTERER 5u
#define RANDOM_ELEMENT 6u /* and eight times the upper half of the ping's number */

typedef struct random4 {
    natural v[4];
} random4;

#ifdef __OPENCL_C_VERSION__
#define r_mul_hi(a, b) mul_hi((natural)(a), (natural)(b))
#else
#define r_mul_hi(a, b) ((natural)(((uint64_t)(a) * (uint64_t)(b)) >> 32))
#endif

/* One round of the bijection; K0 and K1 are that round's key. */
FORMULA random4 philox_round(random4 c, uint k0, uint k1) {
    const uint m0 = 0xD2511F53u, m1 = 0xCD9E8D57u;
    random4 out;
    natural hi0 = r_mul_hi(c.v[0], m0), lo0 = c.v[0] * m0;
    natural hi1 = r_mul_hi(c.v[2], m1), lo1 = c.v[2] * m1;
    out.v[0] = hi1 ^ c.v[1] ^ k0;
    out.v[1] = lo1;
    out.v[2] = hi0 ^ c.v[3] ^ k1;
    out.v[3] = lo0;
    return out;
}

FORMULA random4 philox4x32(random4 counter, uint key0, uint key1) {
    random4 drawn = counter;
    for (int round = 0; round < 10; round++) {
        drawn = philox_round(drawn, key0, key1);
        key0 += 0x9E3779B9u;
        key1 += 0xBB67AE85u;
    }
    return drawn;
}

/* The numbers of ray INDEX (or cell, or shift) of ping (PING0, PING1) for PURPOSE. */
FORMULA random4 random_draw(natural index, uint ping0, uint ping1, uint purpose, uint key0,
                            uint key1) {
    random4 counter;
    counter.v[0] = index;
    counter.v[1] = (natural)(ping0);
    counter.v[2] = (natural)(ping1);
    counter.v[3] = (natural)(purpose);
    return philox4x32(counter, key0, key1);
}

/* 23 bits to the open interval (0, 1): exact in float, never 0 and never 1. */
#ifdef __OPENCL_C_VERSION__
#define random_uniform(n) ((to_real((n) >> 9) + R(0.5)) * R(1.1920928955078125e-7))
#else
#define random_uniform(n) (((real)((n) >> 9) + 0.5) * 1.1920928955078125e-7)
#endif

#endif
