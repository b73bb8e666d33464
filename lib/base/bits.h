/*
 * A double and the bits that it is made of, for functions that take exponents and mantissas apart.
 */
#ifndef ASDIC_BASE_BITS_H
#define ASDIC_BASE_BITS_H

#include <stdint.h>
#include <string.h>

static inline uint64_t asdic_bits_of(double x) {
    uint64_t bits;
    memcpy(&bits, &x, sizeof bits);
    return bits;
}

static inline double asdic_double_of(uint64_t bits) {
    double x;
    memcpy(&x, &bits, sizeof x);
    return x;
}

#endif
