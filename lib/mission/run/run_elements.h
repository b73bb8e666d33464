/*
 * elements.npy: the pressures of coherent pings, complex64 [ping, element, sample] (run_records.h). A ping's
 * pressures are written before its record, so that a ping whose record is there has them.
 */
#ifndef ASDIC_MISSION_RUN_ELEMENTS_H
#define ASDIC_MISSION_RUN_ELEMENTS_H

#include "mission/mission_settings.h"
#include "run_records.h"

#define ASDIC_ELEMENTS_NAME "elements.npy"

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
                                 const asdic_elements_shape *shape, asdic_records **out);

/* Whether FOLDER has the whole file under its name, where it needs one. */
bool asdic_elements_complete(asdic_context *ctx, const char *folder,
                             const asdic_elements_shape *shape);

#endif
