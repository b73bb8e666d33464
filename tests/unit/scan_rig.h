/*
 * A sonar in water of one sound speed, and normal variates.
 */
#ifndef ASDIC_TESTS_SCAN_RIG_H
#define ASDIC_TESTS_SCAN_RIG_H

#include "asserts.h"

#include <asdic/scan.h>

#include <stdlib.h>

#define DEGREE (3.14159265358979323846 / 180.0)
#define SPEED 1500.0

static inline asdic_sonar sonar_of(const asdic_beam *receivers, size_t count) {
    asdic_sonar sonar = asdic_sonar_default();
    sonar.receivers = receivers;
    sonar.receiver_count = count;
    return sonar;
}

/* A normal variate. */
static inline double noise(unsigned *seed) {
    double sum = 0.0;
    for (int i = 0; i < 12; i++) {
        sum += (double)(rand_r(seed) % 10000) / 10000.0;
    }
    return sum - 6.0;
}

#endif
