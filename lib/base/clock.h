/*
 * Time that passes, and time that is spent.
 */
#ifndef ASDIC_BASE_CLOCK_H
#define ASDIC_BASE_CLOCK_H

/* Seconds since some moment; never goes back. */
double asdic_clock_s(void);

/* Seconds that processors have spent on this process, all its threads together. */
double asdic_processor_s(void);

#endif
