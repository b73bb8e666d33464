/*
 * A NumPy file of levels by ping, beam and bin, of any type: what the formats npy* share.
 */
#ifndef ASDIC_OUT_NPY_LEVELS_H
#define ASDIC_OUT_NPY_LEVELS_H

#include "format.h"

/* DTYPE as NumPy writes it: "'<f4'". */
asdic_status asdic_npy_levels_open(asdic_context *ctx, const char *path,
                                   const asdic_format_about *about, const char *dtype, void **out);

/* The next ping's levels as they are, float32. The commit tells what the disk refuses. */
asdic_status asdic_npy_levels_write(void *file, const asdic_record *record);

/* The same, each level made 16 bits by CONVERT; NAN where there is no energy. */
typedef void asdic_npy_convert(const float *levels_db, size_t count, uint16_t *converted);
asdic_status asdic_npy_levels_write_16(void *file, const asdic_record *record,
                                       asdic_npy_convert *convert);

asdic_status asdic_npy_levels_commit(void **file);
void asdic_npy_levels_discard(void **file);

#endif
