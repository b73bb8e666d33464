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

typedef enum asdic_run_checked {
    ASDIC_RUN_SMALL,    /* the small files that are read back */
    ASDIC_RUN_ELEMENTS, /* elements.npy */
    ASDIC_RUN_ALL       /* every file, and the pictures */
} asdic_run_checked;

/* Checks those of WHAT that FACTS have: ASDIC_ERROR_INPUT with the names of those that are missing or
 * others. */
asdic_status asdic_run_check(asdic_context *ctx, const char *folder, const asdic_run_facts *facts,
                             asdic_run_checked what);

/* Adds to an error about damage what mends it, for those that only read the run; returns STATUS. */
asdic_status asdic_run_advise(asdic_context *ctx, asdic_status status);

#endif
