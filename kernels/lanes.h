/*
 * Comparisons of vectors: their lanes as bits, and whether any of them holds. OpenCL's any() and what is written in
 * OpenCL alone are a dozen instructions or more where processors have one or two.
 */
#ifndef ASDIC_KERNEL_LANES_H
#define ASDIC_KERNEL_LANES_H

#ifdef __OPENCL_C_VERSION__

/* Only in PoCL: Oclgrind's compiler knows them, Oclgrind itself does not. */
#if defined(POCL_DEVICE_ADDRESS_BITS) && defined(__has_builtin)
#if __has_builtin(__builtin_reduce_or)
#define LANES_REDUCE
#endif
#if defined(__AVX512DQ__) && defined(__AVX512VL__) && __has_builtin(__builtin_ia32_cvtd2mask512)
#define LANES_IN_MASKS
#elif defined(__AVX__) && __has_builtin(__builtin_ia32_movmskps256)
#define LANES_IN_SIGNS
#endif
#endif

/* Lanes of a comparison as bits: one instruction where there are mask registers or signs can be gathered, else folded
 * through bytes. */
#ifdef LANES_IN_MASKS
static inline uint bits4(int4 m) {
    return (uint)__builtin_ia32_cvtd2mask128(m) & 0xf;
}

static inline uint bits8(int8 m) {
    return (uint)__builtin_ia32_cvtd2mask256(m) & 0xff;
}

static inline uint bits16(int16 m) {
    return (uint)__builtin_ia32_cvtd2mask512(m) & 0xffff;
}
#else
#ifdef LANES_IN_SIGNS
static inline uint bits4(int4 m) {
    return (uint)__builtin_ia32_movmskps(as_float4(m));
}

static inline uint bits8(int8 m) {
    return (uint)__builtin_ia32_movmskps256(as_float8(m));
}
#else
static inline uint bits4(int4 m) {
    return ((as_uint(convert_char4(m)) & 0x08040201u) * 0x01010101u) >> 24;
}

static inline uint bits8(int8 m) {
    return (uint)(((as_ulong(convert_char8(m)) & 0x8040201008040201ul) * 0x0101010101010101ul) >>
                  56);
}
#endif

static inline uint bits16(int16 m) {
    return bits8(m.lo) | bits8(m.hi) << 8;
}
#endif

/* any() on wide vectors is slow in PoCL. */
#ifdef LANES_REDUCE
static inline bool some4(int4 m) {
    return __builtin_reduce_or(m) != 0;
}

static inline bool some8(int8 m) {
    return __builtin_reduce_or(m) != 0;
}

static inline bool some16(int16 m) {
    return __builtin_reduce_or(m) != 0;
}
#else
static inline bool some4(int4 m) {
    return as_uint(convert_char4(m)) != 0;
}

static inline bool some8(int8 m) {
    return as_ulong(convert_char8(m)) != 0;
}

static inline bool some16(int16 m) {
    ulong2 folded = as_ulong2(convert_char16(m));
    return (folded.x | folded.y) != 0;
}
#endif

#endif

#endif
