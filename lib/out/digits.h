/*
 * Numbers as text that reads back to the same bits, whatever the process's locale.
 */
#ifndef ASDIC_OUT_DIGITS_H
#define ASDIC_OUT_DIGITS_H

#include <stddef.h>
#include <stdint.h>

/* Longest text of any function here, terminating zero included. */
#define ASDIC_DIGITS_SIZE 32

/* Exactly printf's "%.9g" in the C locale; nine digits identify a float. Returns the length.
 * Not finite: an empty text, as in a CSV field without a value. */
size_t asdic_digits_float(char text[ASDIC_DIGITS_SIZE], float value);

/* The shortest of "%.15g", "%.16g", "%.17g" that reads back to VALUE. */
size_t asdic_digits_double(char text[ASDIC_DIGITS_SIZE], double value);

/* Seconds to the millisecond, of Unix time as well. */
size_t asdic_digits_time(char text[ASDIC_DIGITS_SIZE], double time_s);

size_t asdic_digits_natural(char text[ASDIC_DIGITS_SIZE], uint64_t value);

/* Thousands apart: "20,000". */
void asdic_digits_grouped(char text[ASDIC_DIGITS_SIZE], uint64_t value);

/* FORMAT is a printf format of one double; never a decimal comma. */
size_t asdic_digits_print(char text[ASDIC_DIGITS_SIZE], const char *format, double value);

#endif
