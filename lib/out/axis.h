/*
 * Round ticks and their labels.
 */
#ifndef ASDIC_OUT_AXIS_H
#define ASDIC_OUT_AXIS_H

#include <asdic/output.h>

#define ASDIC_AXIS_MAX_TICKS 32

typedef struct asdic_tick {
    double value;
    char label[24]; /* UTF-8, with a true minus sign; "" for a minor tick */
} asdic_tick;

/* 1, 2 or 5 times a power of ten: the smallest step with at most MAX_COUNT steps in SPAN. */
double asdic_axis_step(double span, size_t max_count);

/* Ticks inside [low, high], about MAX_COUNT at most; decades when logarithmic, all that have names.
 * Returns how many. */
size_t asdic_axis_ticks(const asdic_plot_axis *axis, size_t max_count,
                        asdic_tick ticks[ASDIC_AXIS_MAX_TICKS]);

/* VALUE with as many decimals as STEP needs. */
void asdic_axis_label(char label[24], double value, double step);

/* Where VALUE lies between low (0) and high (1). */
double asdic_axis_share(const asdic_plot_axis *axis, double value);

#endif
