/*
 * NumPy's file format, version 1.0: a header with type and shape, then the numbers.
 */
#ifndef ASDIC_OUT_NPY_H
#define ASDIC_OUT_NPY_H

#include <stddef.h>

/* Writes a header for COUNT items of DTYPE ("'<f4'" or a list of fields), each of SHAPE_REST
 * ("3, 150, " or "") further dimensions. Its length is a multiple of 64 and does not depend on
 * COUNT, so that it can be written again when COUNT is known. Returns the length, 0 when CAPACITY
 * is too small. */
#define ASDIC_NPY_HEADER_SIZE 2048
size_t asdic_npy_header(char header[ASDIC_NPY_HEADER_SIZE], const char *dtype, size_t count,
                        const char *shape_rest);

#endif
