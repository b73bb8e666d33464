/*
 * Numbers in text, the same under every locale: a point is the decimal separator.
 */
#ifndef ASDIC_BASE_NUMBER_H
#define ASDIC_BASE_NUMBER_H

#include <locale.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

/* Reads all LENGTH bytes of TEXT as a decimal number: sign, digits, point, exponent. NULL when it
 * is one, else what is wrong with it, to be put behind the value: "is not a number". Hexadecimal,
 * octal-looking (leading zero), grouped (1_000; 1,5), infinite and not-a-number forms are
 * refused: readers of YAML and CSV disagree about them. */
const char *asdic_number_parse(const char *text, size_t length, double *value);

/* The same for a whole number; "2e4" and "20000.0" are whole. |*VALUE| <= 2^53, above which
 * doubles (and JSON readers) skip integers. */
const char *asdic_integer_parse(const char *text, size_t length, int64_t *value);

/* Between the two calls this thread prints and reads numbers in the C locale; other threads and
 * the program's own setting are untouched. */
locale_t asdic_c_locale_enter(void);
void asdic_c_locale_leave(locale_t before);

/* vsnprintf in the C locale: a sentence has decimal points, as what it quotes has them. */
void asdic_c_print(char *text, size_t size, const char *format, va_list args);

#endif
