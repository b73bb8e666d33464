/*
 * WIDEST before a static function: also compiled for the wider vectors that a processor may have, and chosen
 * when the library is loaded. The same operations, so the same bytes.
 */
#ifndef ASDIC_BASE_WIDEST_H
#define ASDIC_BASE_WIDEST_H

#if defined(__x86_64__) && defined(__linux__) && defined(__GNUC__) && !defined(__clang__)
#define WIDEST __attribute__((target_clones("avx512f", "avx2", "default")))
#else
#define WIDEST
#endif

#endif
