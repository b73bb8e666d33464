/*
 * The records of a run, appended ping by ping (run_records.h): pings.npy, and truth.npy where the scene asks
 * for truth.
 */
#ifndef ASDIC_MISSION_RUN_STORE_H
#define ASDIC_MISSION_RUN_STORE_H

#include "mission/mission_settings.h"
#include "out/record.h"
#include "run_records.h"

#include <asdic/context.h>

#define ASDIC_TRUTH_NAME "truth.npy"

typedef struct asdic_store asdic_store;

/* What the records are of. */
typedef struct asdic_store_shape {
    size_t first_ping;
    asdic_record_layout layout;
} asdic_store_shape;

/* What runs with these SETTINGS, whose plan leaves LEFT_OUT out (asdic_plan), store. */
asdic_record_layout asdic_store_layout(const asdic_settings *settings, size_t beams, size_t bins,
                                       unsigned left_out);

asdic_status asdic_store_open(asdic_context *ctx, const char *folder, asdic_store_mode mode,
                              const asdic_store_shape *shape, asdic_store **out);

size_t asdic_store_count(const asdic_store *store);

/* Record INDEX in the place of the one that is there, or behind the last. BYTES, as they are in
 * memory, become what will be read. */
asdic_status asdic_store_write(asdic_store *store, size_t index, void *bytes);
/* ASDIC_ERROR_INPUT, with file and ping, when a record is not as it was written. */
asdic_status asdic_store_read(asdic_store *store, size_t index, void *bytes);

/* Drops the records from COUNT on. */
asdic_status asdic_store_cut(asdic_store *store, size_t count);

/* Completes the headers and gives the files their names; the store stays open for reading. */
asdic_status asdic_store_commit(asdic_store *store);

/* Leaves a file that was not committed as it is, to be resumed. */
void asdic_store_close(asdic_store **store);

#endif
