/*
 * One pass over a run's records: the window of its levels and how good they are.
 */
#ifndef ASDIC_MISSION_RUN_SURVEY_H
#define ASDIC_MISSION_RUN_SURVEY_H

#include "run_store.h"

typedef struct asdic_survey {
    uint64_t rays, saturated;
    double first_time_s, last_time_s;
    double low_db, high_db;                   /* window of the levels, rounded outwards to 10 dB */
    double stderr_median_db, stderr_worst_db; /* NAN without a level */
} asdic_survey;

asdic_status asdic_survey_run(asdic_context *ctx, asdic_store *store, size_t beams, size_t bins,
                              asdic_survey *out);

#endif
