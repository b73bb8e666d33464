/*
 * elements.npy: the pressures of coherent pings, complex64 [ping, element, sample] (run_records.h). A ping's
 * pressures are written before its record, so that a ping whose record is there has them.
 */
#ifndef ASDIC_MISSION_RUN_ELEMENTS_H
#define ASDIC_MISSION_RUN_ELEMENTS_H

#include "mission/mission_settings.h"
#include "run_records.h"

#define ASDIC_ELEMENTS_NAME "elements.npy"

typedef struct asdic_elements asdic_elements;

/* Pings, elements, and samples of each; 0 elements: the run does not write them. */
typedef struct asdic_elements_shape {
    size_t pings, elements, samples;
} asdic_elements_shape;

asdic_elements_shape asdic_elements_shape_of(const asdic_settings *settings, size_t pings,
                                             size_t bins, double sound_speed_mps);

/* Of the file in FOLDER, whose run has SETTINGS: the samples hang on the sound speed where its mission begins, which
 * is in no later part of it. */
asdic_status asdic_elements_shape_read(asdic_context *ctx, const char *folder,
                                       const asdic_settings *settings, asdic_elements_shape *out);

/* Bytes of a ping. */
uint64_t asdic_elements_bytes(const asdic_elements_shape *shape);

/* The file in FOLDER. *OUT stays NULL where there are no elements. */
asdic_status asdic_elements_open(asdic_context *ctx, const char *folder, asdic_store_mode mode,
                                 const asdic_elements_shape *shape, asdic_elements **out);

/* Of an open file; of NULL zeros. */
asdic_elements_shape asdic_elements_shape_now(const asdic_elements *elements);

/* Whether the file reaches over ping INDEX; true of NULL. */
bool asdic_elements_has(const asdic_elements *elements, size_t index);

/* Whether FOLDER has the whole file under its name, where it needs one. */
bool asdic_elements_complete(asdic_context *ctx, const char *folder,
                             const asdic_elements_shape *shape);

/* Does nothing of NULL. */
asdic_status asdic_elements_write(asdic_elements *elements, size_t index, const float *pressure);
asdic_status asdic_elements_read(asdic_elements *elements, size_t index, float *pressure);

/* Gives the file its name. */
asdic_status asdic_elements_commit(asdic_elements *elements);

/* Leaves a file that was not committed as it is, to be resumed. NULL-safe. */
void asdic_elements_close(asdic_elements **elements);

#endif
