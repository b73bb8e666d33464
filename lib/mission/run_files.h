/*
 * What is made of a run's records when they are complete: levels.npy, run.nc.
 */
#ifndef ASDIC_MISSION_RUN_FILES_H
#define ASDIC_MISSION_RUN_FILES_H

#include "run_facts.h"
#include "run_store.h"

/* Those of levels.npy (float32 [ping, beam, bin], NAN where there is no energy) and run.nc that
 * SETTINGS ask for. */
asdic_status asdic_files_write(asdic_context *ctx, asdic_store *store, const char *folder,
                               const asdic_mission *settings, const asdic_run_facts *facts);

/* ASDIC_ERROR_UNSUPPORTED when SETTINGS ask for a file that this build cannot write. */
asdic_status asdic_files_check(asdic_context *ctx, const asdic_mission *settings);

#endif
