/*
 * fused(a, b, c): a b + c, rounded once. One instruction where a device has it. Elsewhere fma() is a library
 * function hundreds of instructions long; this one has forty and gives the same bits, unless numbers are
 * below 1e-30 or beyond 1e30: S. Boldo, G. Melquiond, "Emulation of a FMA and Correctly Rounded Sums: Proved
 * Algorithms Using Rounding to Odd", IEEE Transactions on Computers 57(4), 2008; the error of the product
 * from halves of its factors, T. J. Dekker, Numerische Mathematik 18, 1971.
 *
 * In PoCL on a processor without the instruction products and sums round apart, which is quicker by far:
 * there a ray may pass an edge on its other side.
 */
#ifndef ASDIC_KERNEL_FUSED_H
#define ASDIC_KERNEL_FUSED_H

#ifdef __OPENCL_C_VERSION__

#pragma OPENCL FP_CONTRACT OFF

#ifdef __clang__
/* Vectors wider than the processor's are passed among functions of one program only. */
#pragma clang diagnostic ignored "-Wpsabi"
#endif

#if defined(__FMA__) || defined(FP_FAST_FMAF) || defined(__ARM_FEATURE_FMA)
#define ASDIC_FUSED
#define fused(a, b, c) fma((a), (b), (c))
#elif defined(POCL_DEVICE_ADDRESS_BITS)
#define fused(a, b, c) ((a) * (b) + (c))
#else
#define ASDIC_FUSED
#define DEFINE_FUSED(real, whole, as_real, as_whole)                                               \
    static inline real __attribute__((overloadable)) fused(real a, real b, real c) {               \
        real p = a * b, a1 = 4097.0f * a, b1 = 4097.0f * b;                                        \
        a1 = a1 - (a1 - a);                                                                        \
        b1 = b1 - (b1 - b);                                                                        \
        real a2 = a - a1, b2 = b - b1;                                                             \
        real p2 = ((a1 * b1 - p) + a1 * b2 + a2 * b1) + a2 * b2; /* p + p2 is the product */       \
        real t = c + p2, at = t - c;                                                               \
        real t2 = (c - (t - at)) + (p2 - at); /* t + t2 is c + p2 */                               \
        real v = p + t, av = v - p;                                                                \
        real v2 = (p - (v - av)) + (t - av); /* v + v2 is p + t */                                 \
        real z = t2 + v2, az = z - t2;                                                             \
        real z2 = (t2 - (z - az)) + (v2 - az);                                                     \
        whole bits = as_whole(z); /* to odd: an even one that is not exact goes towards z2 */      \
        whole step = select((whole)(-1), (whole)(1), (z2 > 0.0f) == (z > 0.0f));                   \
        bits += select((whole)(0), step, (z2 != 0.0f) & ((bits & 1) == 0));                        \
        real exact = v + as_real(bits), plain = p + c;                                             \
        return select(plain, exact, isfinite(exact) & isfinite(a1) & isfinite(b1));                \
    }
DEFINE_FUSED(float, int, as_float, as_int)
DEFINE_FUSED(float4, int4, as_float4, as_int4)
DEFINE_FUSED(float8, int8, as_float8, as_int8)
DEFINE_FUSED(float16, int16, as_float16, as_int16)
#endif

#endif

#endif
