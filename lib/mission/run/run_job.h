/*
 * One run from its beginning to its end: what is to be run, the files that its records go to, and
 * the pictures and facts at the end. The records come from its user: from devices (run.c) or from a
 * recording.
 */
#ifndef ASDIC_MISSION_RUN_JOB_H
#define ASDIC_MISSION_RUN_JOB_H

#include "out/record.h"
#include "run_elements.h"
#include "run_facts.h"
#include "run_files.h"
#include "run_store.h"
#include "run_summary.h"

#include <dirent.h>

typedef struct asdic_run_job {
    asdic_context *ctx;
    asdic_mission *mission;
    asdic_device **devices;
    size_t device_count;
    const asdic_run_options *options;
    asdic_run_facts facts;
    char inputs_hash[65];
    asdic_elements_shape elements_shape; /* 0: no pressures are written */
    asdic_arena arena;                   /* of what was read from an earlier run.json */
    asdic_store *store;                  /* NULL: levels go to the standard output alone */
    asdic_records *elements;             /* run_elements.h; NULL: not asked for */
    asdic_files *files;                  /* bins.csv and the like */
    asdic_summary *summary;              /* NULL: neither pictures nor run.json are written */
    void *bytes;                         /* one record */
    DIR *lock;                           /* of the folder; NULL: none */
    bool *is_there;                      /* by ping of the run: the store had its record, whole */
    size_t to_make;                      /* pings that had none */
    size_t damaged;                      /* records that are not whole; told once */
    size_t kept;      /* pings in the files; as many were taken, in their order */
    bool is_complete; /* the run was complete already */
    uint64_t rays;    /* traced by this call */
    double begin_s;   /* of this call, by the clock */
} asdic_run_job;

/* Checks what is asked for and plans it: fills the facts that are known before the first ping. The
 * mission's sampling follows the plan from here on. */
asdic_status asdic_job_describe(asdic_run_job *job);

/* What processes that work on one run must agree in. */
void asdic_job_hash(const asdic_run_job *job, char hex[65]);

/* Describes the run, makes or reopens its folder, and finds out which pings are there. */
asdic_status asdic_job_begin(asdic_run_job *job);

/* Describes the run and begins to write rows to the standard output, without a folder. */
asdic_status asdic_job_begin_stream(asdic_run_job *job);

/* Takes the next ping's record, which is there, from the store into the files and the summary. */
asdic_status asdic_job_take_again(asdic_run_job *job);

/* Adds the record in BYTES, the next in order, to the store, the files and the summary. */
asdic_status asdic_job_take(asdic_run_job *job, void *bytes);

/* Pings whose records are in the store. */
size_t asdic_job_stored(const asdic_run_job *job);

/* Gives the files their names, draws the pictures and writes run.json. With IS_WHOLE false it
 * leaves a valid folder without pictures, to be resumed. */
asdic_status asdic_job_end(asdic_run_job *job, bool is_whole);

/* Closes everything. Files that are not committed stay for --resume or disappear. */
void asdic_job_finish(asdic_run_job *job);

/* --- a process of a team other than the first: its devices simulate the pings that process 0 orders --- */

/* Returns when process 0 says that the run is over. */
asdic_status asdic_team_worker_run(asdic_run_job *job);

#endif
