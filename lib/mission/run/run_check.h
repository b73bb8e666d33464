/*
 * Whether the files of a run folder are as the run left them. The records of pings.npy have sums of
 * their own (run_store.h), pictures those of PNG; run.json keeps the sums of the others.
 */
#ifndef ASDIC_MISSION_RUN_CHECK_H
#define ASDIC_MISSION_RUN_CHECK_H

#include "run_facts.h"

/* Notes in FACTS what FOLDER holds; names are ARENA's. */
asdic_status asdic_run_check_note(asdic_context *ctx, const char *folder, asdic_arena *arena,
                                  asdic_run_facts *facts);

/* Checks the small files that are read back: ASDIC_ERROR_INPUT with the names of those that are missing or
 * others. */
asdic_status asdic_run_check_small(asdic_context *ctx, const char *folder,
                                   const asdic_run_facts *facts);

/* Checks the file NAME, if FACTS have it. */
asdic_status asdic_run_check_one(asdic_context *ctx, const char *folder,
                                 const asdic_run_facts *facts, const char *name);

/* Checks the other files and the pictures as well. */
asdic_status asdic_run_check_all(asdic_context *ctx, const char *folder,
                                 const asdic_run_facts *facts);

#endif
