/*
 * Words that users type: numbers in the C locale, the nearest of several names, as much of one as there is room for.
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

/* How much of TEXT, of LENGTH bytes, MOST have room for, in whole characters of UTF-8. */
size_t asdic_words_cut(const char *text, size_t length, size_t most);

#endif
