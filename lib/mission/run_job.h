/*
 * One call of asdic_mission_run: what its beginning, its pings and its end share.
 */
#ifndef ASDIC_MISSION_RUN_JOB_H
#define ASDIC_MISSION_RUN_JOB_H

#include "out/csv.h"
#include "out/record.h"
#include "run_facts.h"
#include "run_store.h"

typedef struct asdic_run_job {
    asdic_context *ctx;
    asdic_mission *mission;
    asdic_device **devices;
    size_t device_count;
    const asdic_run_options *options;
    asdic_run_facts facts;
    char inputs_hash[65];
    asdic_arena arena; /* of what was read from an earlier run.json */
    asdic_store *store;
    asdic_csv *csv;
    void *bytes;      /* one record */
    size_t resumed;   /* pings that were there already */
    bool is_complete; /* they were all, and everything was written */
    uint64_t rays;    /* traced by this call */
    double begin_s;   /* by the clock, of the simulation */
} asdic_run_job;

/* Checks what is asked for and plans it: fills the facts that are known before the first ping; the
 * mission's sampling follows the plan from here on. */
asdic_status asdic_job_describe(asdic_run_job *job);

/* What processes that work on one run must agree in. */
void asdic_job_hash(const asdic_run_job *job, char hex[65]);

/* What RESULT's levels are kept with. */
asdic_record_head asdic_job_head(const asdic_mission *mission, size_t ping,
                                 const asdic_ping *result);

/* Describes the run, makes or reopens its folder, and writes the rows of pings that are there. */
asdic_status asdic_job_begin(asdic_run_job *job);

/* Gives the files their names, draws, and says in run.json how it went. With IS_WHOLE false the
 * folder is left valid but unfinished: no pictures. */
asdic_status asdic_job_end(asdic_run_job *job, bool is_whole);

/* Closes what is open; files that have no name yet stay for --resume or disappear. */
void asdic_job_finish(asdic_run_job *job);

#endif
