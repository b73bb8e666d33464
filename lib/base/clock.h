/*
 * Time that passes.
 */
#ifndef ASDIC_BASE_CLOCK_H
#define ASDIC_BASE_CLOCK_H

/* Seconds since some moment; never goes back. */
double asdic_clock_s(void);

#endif
