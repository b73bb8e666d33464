/*
 * The area of an outline on a chart.
 */
#ifndef ASDIC_TEST_AREA_H
#define ASDIC_TEST_AREA_H

#include <stddef.h>

static inline double area_of(const double *north_m, const double *east_m, size_t count) {
    double twice = 0.0;
    for (size_t i = 0; i < count; i++) {
        size_t k = (i + 1) % count;
        twice += north_m[i] * east_m[k] - north_m[k] * east_m[i];
    }
    return 0.5 * twice; /* positive clockwise, north up and east right */
}

#endif
