/*
 * Points or directions of ASDIC_WIDTH rays.
 */
#ifndef ASDIC_KERNEL_TRIPLE_H
#define ASDIC_KERNEL_TRIPLE_H

#include "real.h"

typedef struct triple {
    real x, y, z;
} triple;

FORMULA real dot3(triple a, triple b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

FORMULA triple cross3(triple a, triple b) {
    triple c = {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
    return c;
}

#endif
