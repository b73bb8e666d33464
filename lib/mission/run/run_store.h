/*
 * pings.npy: the records of a run, appended ping by ping. While a run goes on the file is called
 * pings.npy.part. Appended records survive the death of the process; an incomplete one is dropped.
 */
#ifndef ASDIC_MISSION_RUN_STORE_H
#define ASDIC_MISSION_RUN_STORE_H

#include <asdic/context.h>

typedef struct asdic_store asdic_store;

typedef enum asdic_store_mode {
    ASDIC_STORE_READ,   /* the finished file */
    ASDIC_STORE_CREATE, /* an empty one */
    ASDIC_STORE_RESUME, /* what an earlier run left, finished or not; else an empty one */
} asdic_store_mode;

asdic_status asdic_store_open(asdic_context *ctx, const char *folder, asdic_store_mode mode,
                              size_t beams, size_t bins, asdic_store **out);

size_t asdic_store_count(const asdic_store *store);
size_t asdic_store_record_bytes(const asdic_store *store);

asdic_status asdic_store_append(asdic_store *store, const void *bytes);
asdic_status asdic_store_read(asdic_store *store, size_t index, void *bytes);

/* Drops the records from COUNT on. */
asdic_status asdic_store_cut(asdic_store *store, size_t count);

/* Completes the header and gives the file its name; the store stays open for reading. */
asdic_status asdic_store_commit(asdic_store *store);

/* Leaves a file that was not committed as it is, to be resumed. */
void asdic_store_close(asdic_store **store);

#endif
