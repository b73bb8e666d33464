/*
 * Words that users type: numbers in the C locale, the nearest of several names.
 */
#ifndef ASDIC_BASE_WORDS_H
#define ASDIC_BASE_WORDS_H

#include <stdbool.h>
#include <stddef.h>

/* The whole of TEXT as a finite number, as asdic_number_parse (number.h) reads it. */
bool asdic_words_number(const char *text, double *out);

/* The index of the name closest to TEXT; COUNT when none is close. Close means that at most a third
 * of the longer word's letters differ, case ignored. */
size_t asdic_words_nearest(const char *text, const char *const *names, size_t count);

#endif
