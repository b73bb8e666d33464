/*
 * Tables of functions of the grazing angle, as kernels/law_table.h reads them.
 */
#ifndef ASDIC_LAWS_TABULATE_H
#define ASDIC_LAWS_TABULATE_H

#include "scatterer.h"

/* A growing buffer for the device: materials first, then their tables. */
typedef struct asdic_law_words {
    uint32_t *words;
    size_t count, capacity;
} asdic_law_words;

/* A function of a grazing angle, linear. */
typedef double asdic_law_function(const void *of, double sine, double cos2);

/* Appends the table of FUNCTION, whose kinks and peaks lie at the COUNT grazing angles KNOTS_DEG, and
 * sets *AT to where it begins. */
asdic_status asdic_law_table_add(asdic_context *ctx, asdic_law_function *function, const void *of,
                                 const double *knots_deg, size_t count, asdic_law_words *out,
                                 dev_uint *at);

/* Appends the tables of S, strength and reflected share, and notes in its DEVICE where they begin. */
asdic_status asdic_law_tables_add(asdic_context *ctx, asdic_scatterer *s, asdic_law_words *out);

/* The device's view of COUNT scatterers: their dev_material, then the tables of those without a
 * formula. OUT is empty before; its words are the caller's to free, after a failure, too. */
asdic_status asdic_law_tables(asdic_context *ctx, asdic_scatterer *scatterers, size_t count,
                              asdic_law_words *out);

#endif
