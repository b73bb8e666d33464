/*
 * What is made of a run's records beside their tables, as they come: levels.npy, run.nc.
 */
#ifndef ASDIC_MISSION_RUN_FILES_H
#define ASDIC_MISSION_RUN_FILES_H

#include "out/record.h"
#include "run_facts.h"

typedef struct asdic_files asdic_files;

/* Those of levels.npy (float32 [ping, beam, bin], NAN where there is no energy) and run.nc in FOLDER that
 * SETTINGS ask for, of all pings that FACTS plan, the first of them at DEPTH_M; *OUT is NULL where none
 * is asked for. They get their names on commit. */
asdic_status asdic_files_create(asdic_context *ctx, const char *folder,
                                const asdic_mission *settings, const asdic_run_facts *facts,
                                double depth_m, asdic_files **out);

/* The next ping. FILES may be NULL, as below. */
asdic_status asdic_files_add(asdic_files *files, const asdic_record *record);

/* After the last ping; *FILES becomes NULL either way. */
asdic_status asdic_files_commit(asdic_files **files);

/* Removes what was written. */
void asdic_files_discard(asdic_files **files);

/* ASDIC_ERROR_UNSUPPORTED when SETTINGS ask for a file that this build cannot write. */
asdic_status asdic_files_check(asdic_context *ctx, const asdic_mission *settings);

#endif
