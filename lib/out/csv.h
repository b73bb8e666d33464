/*
 * bins.csv: one row per ping, beam and bin (long), or one per ping and beam (wide).
 */
#ifndef ASDIC_OUT_CSV_H
#define ASDIC_OUT_CSV_H

#include "record.h"

typedef struct asdic_csv asdic_csv;

/* Form NONE: *OUT is NULL, with which the calls below do nothing. */
asdic_status asdic_csv_create(asdic_context *ctx, const char *path, const asdic_sonar *sonar,
                              size_t bins, asdic_csv_form form, asdic_csv **out);

/* The rows of one ping. ASDIC_ERROR_IO as soon as the disk says so. */
asdic_status asdic_csv_add(asdic_csv *csv, const asdic_record *record);

asdic_status asdic_csv_commit(asdic_csv **csv);
void asdic_csv_discard(asdic_csv **csv);

/* TEXT as a CSV field: quoted when it holds a comma, a quote or a line end (RFC 4180). OUT holds
 * 2 * strlen + 3 bytes. Returns its length. */
size_t asdic_csv_field(char *out, const char *text);

#endif
