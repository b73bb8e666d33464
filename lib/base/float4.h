/*
 * Four floats at once, for the few loops on the host that need them: compilers leave "smaller of two"
 * in a loop over lanes scalar.
 */
#ifndef ASDIC_BASE_FLOAT4_H
#define ASDIC_BASE_FLOAT4_H

#include <stdint.h>
#include <string.h>

#ifdef __SSE2__
#include <emmintrin.h>
#endif

typedef float float4 __attribute__((vector_size(16)));
typedef int32_t int4 __attribute__((vector_size(16)));

/* Sixteen aligned bytes from memory of any type. */
static inline float4 float4_load(const void *from) {
    float4 v;
    memcpy(&v, from, sizeof v);
    return v;
}

static inline void float4_store(float4 v, void *to) {
    memcpy(to, &v, sizeof v);
}

static inline float4 float4_splat(float x) {
    return (float4){x, x, x, x};
}

/* A where MASK is all ones, B where it is zero. */
static inline float4 float4_choose(int4 mask, float4 a, float4 b) {
    return (float4)((mask & (int4)a) | (~mask & (int4)b));
}

/* Of NAN and a number: B. */
static inline float4 float4_min(float4 a, float4 b) {
#ifdef __SSE2__
    return _mm_min_ps(a, b);
#else
    return float4_choose(a < b, a, b);
#endif
}

static inline float4 float4_max(float4 a, float4 b) {
#ifdef __SSE2__
    return _mm_max_ps(a, b);
#else
    return float4_choose(a > b, a, b);
#endif
}

#endif
