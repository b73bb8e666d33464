/*
 * Grey PNG files for data sets: packed at speed, some hundred a second.
 */
#ifndef ASDIC_OUT_GREY_PNG_H
#define ASDIC_OUT_GREY_PNG_H

#include <stddef.h>

/* WIDTH x HEIGHT greys, row by row from the top, of BITS 8 (VALUES: uint8_t) or 16 (uint16_t). */
typedef struct asdic_grey {
    size_t width, height;
    unsigned bits;
    const void *values;
} asdic_grey;

/* The whole file, freed with free(); NULL when memory is short. */
unsigned char *asdic_grey_png(const asdic_grey *image, size_t *length);

#endif
