/*
 * What is made of a run's records when they are complete: bins.csv, levels.npy.
 */
#ifndef ASDIC_MISSION_RUN_FILES_H
#define ASDIC_MISSION_RUN_FILES_H

#include "out/csv.h"
#include "run_store.h"

/* Adds the records of STORE to CSV. */
asdic_status asdic_files_replay(asdic_context *ctx, asdic_store *store, const asdic_sonar *sonar,
                                size_t bins, asdic_csv *csv);

/* FOLDER/levels.npy: float32 [ping, beam, bin], NAN where there is no energy. */
asdic_status asdic_files_levels(asdic_context *ctx, asdic_store *store, const char *folder,
                                size_t beams, size_t bins);

#endif
