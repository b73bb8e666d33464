/*
 * The pulse of coherent pings and of drawn speckle, as docs/coherent.md has it, in a few lines of its own.
 */
#ifndef ASDIC_TEST_PULSE_H
#define ASDIC_TEST_PULSE_H

#include <math.h>

/* The amplitude X cells from the middle: 1 over half a cell, then edges of half a cell each whose energy is the
 * polynomial of order 7 with three vanishing derivatives at both ends. */
static inline double pulse_amplitude(double x) {
    double u = fmin(fmax(1.5 - 2.0 * fabs(x), 0.0), 1.0);
    return sqrt(pow(u, 4) * (35.0 - 84.0 * u + 70.0 * u * u - 20.0 * u * u * u));
}

/* What two bins APART cells from each other share of the pressure; of the intensity it is the square. */
static inline double pulse_share(double apart) {
    enum { STEPS = 3000 };
    double sum = 0.0;
    for (int i = 0; i < STEPS; i++) {
        double x = 1.5 * (i + 0.5) / STEPS - 0.75;
        sum += pulse_amplitude(x) * pulse_amplitude(x + apart) * 1.5 / STEPS;
    }
    return sum;
}

#endif
