/*
 * One call of asdic_mission_run: what its beginning, its pings and its end share.
 */
#ifndef ASDIC_MISSION_RUN_JOB_H
#define ASDIC_MISSION_RUN_JOB_H

#include "out/csv.h"
#include "out/record.h"
#include "run_digest.h"
#include "run_facts.h"
#include "run_files.h"
#include "run_store.h"

typedef struct asdic_run_job {
    asdic_context *ctx;
    asdic_mission *mission;
    asdic_device **devices;
    size_t device_count;
    const asdic_run_options *options;
    asdic_run_facts facts;
    char inputs_hash[65];
    asdic_arena arena;    /* of what was read from an earlier run.json */
    asdic_store *store;   /* NULL: levels go to the standard output alone */
    asdic_csv *csv;       /* NULL: no rows are asked for */
    asdic_files *files;   /* NULL: none is asked for */
    asdic_digest *digest; /* NULL: no pictures are asked for, nor run.json */
    void *bytes;          /* one record */
    size_t resumed;       /* pings that were there already */
    size_t kept;          /* pings that are there, those included */
    bool is_complete;     /* they were all, and everything was written */
    uint64_t rays;        /* traced by this call */
    double begin_s;       /* of this call, by the clock */
} asdic_run_job;

/* Checks what is asked for and plans it: fills the facts that are known before the first ping; the
 * mission's sampling follows the plan from here on. */
asdic_status asdic_job_describe(asdic_run_job *job);

/* What processes that work on one run must agree in. */
void asdic_job_hash(const asdic_run_job *job, char hex[65]);

/* The record in BYTES, next in order, into everything but the store. */
asdic_status asdic_job_keep(asdic_run_job *job, const void *bytes);

/* The pings that are not there yet, on the devices, each into the store and everything else. */
asdic_status asdic_job_simulate(asdic_run_job *job);

/* Describes the run, makes or reopens its folder, and writes the rows of pings that are there. */
asdic_status asdic_job_begin(asdic_run_job *job);

/* Gives the files their names, draws, and says in run.json how it went. With IS_WHOLE false the
 * folder is left valid but unfinished: no pictures. */
asdic_status asdic_job_end(asdic_run_job *job, bool is_whole);

/* Closes what is open; files that have no name yet stay for --resume or disappear. */
void asdic_job_finish(asdic_run_job *job);

#endif
