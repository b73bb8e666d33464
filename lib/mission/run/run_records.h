/*
 * A .npy file of equal records, one a ping. While a run goes on the file is called NAME.part. Written
 * records survive the death of the process; an incomplete one is dropped.
 */
#ifndef ASDIC_MISSION_RUN_RECORDS_H
#define ASDIC_MISSION_RUN_RECORDS_H

#include <asdic/context.h>

#include <stddef.h>

typedef struct asdic_records asdic_records;

/* What the file holds. */
typedef struct asdic_records_shape {
    const char *name;         /* in the run folder */
    const char *dtype, *rest; /* of a record, as asdic_npy_header takes them; copied */
    size_t bytes;             /* of a record */
} asdic_records_shape;

typedef enum asdic_store_mode {
    ASDIC_STORE_READ,   /* the finished file */
    ASDIC_STORE_CREATE, /* an empty one */
    ASDIC_STORE_RESUME, /* what an earlier run of the same shape left; else an empty one */
} asdic_store_mode;

/* ASDIC_ERROR_INPUT when a finished file is not of this shape. */
asdic_status asdic_records_open(asdic_context *ctx, const char *folder, asdic_store_mode mode,
                                const asdic_records_shape *shape, asdic_records **out);

size_t asdic_records_count(const asdic_records *records);

/* The file's path as it is now. */
const char *asdic_records_path(const asdic_records *records);

/* Record INDEX in the place of the one that is there, or behind the last. */
asdic_status asdic_records_write(asdic_records *records, size_t index, const void *record);
asdic_status asdic_records_read(asdic_records *records, size_t index, void *record);

/* Drops the records from COUNT on. */
asdic_status asdic_records_cut(asdic_records *records, size_t count);

/* Completes the header and gives the file its name; it stays open for reading. */
asdic_status asdic_records_commit(asdic_records *records);

/* Leaves a file that was not committed as it is, to be resumed. NULL-safe. */
void asdic_records_close(asdic_records **records);

#endif
