/*
 * A function of the grazing angle as a table: the backscattering strength of a law that has no formula
 * here, or the share that it reflects.
 *
 * The angle becomes a whole number, its key: the bits of the sine's float as far as 3/4, then those of
 * the squared cosine backwards, so that both ends, where laws vary by the logarithm of the angle and
 * where peaks at normal incidence are narrow, have keys enough. The keys' upper bits number the
 * buckets, 8 an octave. Each bucket is cut into leaves; of each the table has its first key and three
 * coefficients of log2 of the function in the keys from there on:
 *
 *     log2 f = c0 + d (c1 + d c2),   d = key - first key
 *
 * The host halves leaves until a parabola through both ends and the middle meets the function. Below
 * 2^-20, about 1e-6 rad, the value there holds, and so does that at 2^-40 above it.
 */
#ifndef ASDIC_KERNEL_LAW_TABLE_H
#define ASDIC_KERNEL_LAW_TABLE_H

#include "real.h"
#include "types.h"

#define LAW_SINE_LEAST 0x35800000u /* 2^-20 */
#define LAW_SINE_TURN 0x3f400000u  /* 3/4 */
#define LAW_COS2_TURN 0x3ee00000u  /* 7/16: of the same angle */
#define LAW_COS2_LEAST 0x2b800000u /* 2^-40 */
#define LAW_KEY_TURN (LAW_SINE_TURN - LAW_SINE_LEAST)
#define LAW_KEYS (LAW_KEY_TURN + (LAW_COS2_TURN - LAW_COS2_LEAST))
#define LAW_BUCKET_BITS 20
#define LAW_BUCKETS (LAW_KEYS >> LAW_BUCKET_BITS)

/* In words: first the number of the first leaf of every bucket and of one more, then the leaves, their
 * key and their coefficients. */
#define LAW_LEAF_WORDS 4u
#define LAW_LEAVES_AT (LAW_BUCKETS + 1u)

#ifdef __OPENCL_C_VERSION__

/* Tables from the words TABLES + AT on, a lane each; 0 where AT is 0. SINE in (0, 1], COS2 in [0, 1]. */
static real law_table_lin(__global const uint *tables, natural at, real sine, real cos2) {
    real c2 = r_max(r_min(cos2, R(0.4375)), (real)(as_float(LAW_COS2_LEAST)));
    natural low = as_natural(r_max(sine, (real)(as_float(LAW_SINE_LEAST)))) - LAW_SINE_LEAST;
    natural high = LAW_KEY_TURN + LAW_COS2_TURN - as_natural(c2);
    natural key = min(choose_natural(sine < R(0.75), low, high), (natural)(LAW_KEYS - 1u));
    real a = (real)(-INFINITY), b = R(0.0), c = R(0.0);
    natural d = key;
    for (uint lane = 0; lane < ASDIC_WIDTH; lane++) {
        uint table = ((const uint *)&at)[lane], k = ((const uint *)&key)[lane];
        if (table != 0u) {
            __global const uint *leaves = tables + table + LAW_LEAVES_AT;
            uint first = tables[table + (k >> LAW_BUCKET_BITS)];
            uint end = tables[table + (k >> LAW_BUCKET_BITS) + 1u];
            while (end - first > 1u) {
                uint middle = (first + end) / 2u;
                bool below = leaves[LAW_LEAF_WORDS * middle] <= k;
                first = below ? middle : first;
                end = below ? end : middle;
            }
            uint4 leaf = vload4(first, leaves);
            ((uint *)&d)[lane] = k - leaf.x;
            ((float *)&a)[lane] = as_float(leaf.y);
            ((float *)&b)[lane] = as_float(leaf.z);
            ((float *)&c)[lane] = as_float(leaf.w);
        }
    }
    real t = to_real(d);
    return exp2(a + t * (b + t * c));
}

#endif

#endif
