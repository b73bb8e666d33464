/*
 * WIDEST before a static function: the function is also compiled for wider vectors, and the loader
 * picks the widest that the processor has. The operations are the same, so the bytes are the same.
 */
#ifndef ASDIC_BASE_WIDEST_H
#define ASDIC_BASE_WIDEST_H

#if defined(__x86_64__) && defined(__linux__) && defined(__GNUC__) && !defined(__clang__)
#define WIDEST __attribute__((target_clones("avx512f", "avx2", "default")))
#else
#define WIDEST
#endif

#endif
