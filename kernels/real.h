/*
 * One formula text, three precisions: double on the host, float on the device, and a vector of
 * floats where a device build defines ASDIC_WIDTH as 8 or 16 (PoCL vectorises vectors, not
 * divergent work-items).
 *
 * Write formulas without branches: `choose(condition, a, b)` evaluates both sides. Literals that
 * meet a maths function carry R(): R(0.5). Comparisons of reals give a `mask`.
 */
#ifndef ASDIC_KERNEL_REAL_H
#define ASDIC_KERNEL_REAL_H

#include "fused.h"
#include "lanes.h"

#define R_PI R(3.14159265358979323846) /* R stands below, for either side */

#ifdef __OPENCL_C_VERSION__

#pragma OPENCL FP_CONTRACT OFF

#ifndef ASDIC_WIDTH
#define ASDIC_WIDTH 1
#endif

#define ASDIC_JOIN2(a, b) a##b
#define ASDIC_JOIN(a, b) ASDIC_JOIN2(a, b)

#if ASDIC_WIDTH == 1
typedef float real;
typedef int mask;
typedef uint natural;
typedef int whole;
#define as_real as_float
#define as_whole as_int
#define to_whole convert_int
#define as_natural as_uint
#define to_real convert_float
#define to_natural convert_uint
#define any_true(m) ((m) != 0)
#else
typedef ASDIC_JOIN(float, ASDIC_WIDTH) real;
typedef ASDIC_JOIN(int, ASDIC_WIDTH) mask;
typedef ASDIC_JOIN(uint, ASDIC_WIDTH) natural;
typedef mask whole;
#define as_whole ASDIC_JOIN(as_int, ASDIC_WIDTH)
#define to_whole ASDIC_JOIN(convert_int, ASDIC_WIDTH)
#define as_real ASDIC_JOIN(as_float, ASDIC_WIDTH)
#define as_natural ASDIC_JOIN(as_uint, ASDIC_WIDTH)
#define to_real ASDIC_JOIN(convert_float, ASDIC_WIDTH)
#define to_natural ASDIC_JOIN(convert_uint, ASDIC_WIDTH)
#define any_true ASDIC_JOIN(some, ASDIC_WIDTH)
#endif

/* What a kernel does for a vector of rays, as a function of its own: PoCL makes three copies of a kernel's body,
 * and takes as long for each. */
#if ASDIC_WIDTH > 1 && defined(__clang__)
#define APART __attribute__((noinline))
#else
#define APART
#endif

/* What has to become part of its callers: its constants choose what they do. */
#if defined(__clang__)
#define WITHIN static inline __attribute__((always_inline))
#else
#define WITHIN static inline
#endif

/* An AMD GPU's compiler takes all registers unless told how many groups of work-items shall run at a time
 * on a unit. */
#ifdef __AMDGCN__
#define LEAST_WAVES(n) __attribute__((amdgpu_waves_per_eu(n)))
#else
#define LEAST_WAVES(n)
#endif

#define R(x) ((real)(x##f))
#define choose(condition, a, b) select((real)(b), (real)(a), (condition))
#define choose_natural(condition, a, b) select((natural)(b), (natural)(a), (condition))
#define r_max(a, b) max((real)(a), (real)(b))
#define r_min(a, b) min((real)(a), (real)(b))
#define r_abs(x) fabs(x)
/* PoCL's own are a dozen instructions of vectors where x86 has one; without SSE4.1 the builtins are calls, and to
 * Oclgrind unknown. */
#if ASDIC_WIDTH > 1 && defined(__SSE4_1__) && defined(__has_builtin)
#if __has_builtin(__builtin_elementwise_floor) && __has_builtin(__builtin_elementwise_roundeven)
#define r_floor(x) __builtin_elementwise_floor((real)(x))
#define r_rint(x) __builtin_elementwise_roundeven((real)(x))
#endif
#endif
#ifndef r_rint
#define r_floor(x) floor((real)(x))
#define r_rint(x) rint((real)(x))
#endif
#define r_fma(a, b, c) fused((real)(a), (real)(b), (real)(c))
#define FORMULA static inline

#else /* host */

#include <math.h>
#include <stdint.h>

#ifndef ASDIC_WIDTH
#define ASDIC_WIDTH 1
#endif

typedef double real;
typedef int mask;
typedef uint32_t natural;
typedef uint32_t uint;

#define R(x) ((real)(x))
#define choose(condition, a, b) ((condition) ? (real)(a) : (real)(b))
#define r_max(a, b) ((a) > (b) ? (a) : (b))
#define r_min(a, b) ((a) < (b) ? (a) : (b))
#define r_abs(x) fabs(x)
#define r_floor(x) floor(x)
#define r_rint(x) rint(x)
#define r_exp10(x) pow(10.0, (x))
#define FORMULA static inline __attribute__((unused))

/* sin(pi x) with an exact argument reduction, as OpenCL's sinpi. */
static inline __attribute__((unused)) double r_sinpi(double x) {
    double r = x - 2.0 * floor(0.5 * x + 0.5); /* [-1, 1) */
    if (r > 0.5) {
        r = 1.0 - r;
    } else if (r < -0.5) {
        r = -1.0 - r;
    }
    return sin(R_PI * r);
}

#endif

#include "elementary.h"

#endif
