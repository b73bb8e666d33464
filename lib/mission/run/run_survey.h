/*
 * A run's levels as a whole: their window and how good they are.
 */
#ifndef ASDIC_MISSION_RUN_SURVEY_H
#define ASDIC_MISSION_RUN_SURVEY_H

#include <asdic/output.h>
#include <asdic/run.h>

struct asdic_survey_counts;

typedef struct asdic_survey {
    uint64_t rays, saturated;
    double first_time_s, last_time_s;
    /* Known at the end: */
    double low_db, high_db;                   /* window of the levels, rounded outwards to 10 dB */
    double shown_low_db, shown_high_db;       /* the same with the gain */
    double stderr_median_db, stderr_worst_db; /* NAN without a level */
    size_t bins;
    double *gain_db;                    /* by bin, owned; NULL: none */
    struct asdic_survey_counts *counts; /* owned */
} asdic_survey;

asdic_status asdic_survey_begin(asdic_context *ctx, asdic_survey *survey);
/* Before the first record: what pictures add to each of BINS levels for display, as OPTIONS say. */
asdic_status asdic_survey_set_gain(asdic_context *ctx, asdic_survey *survey, size_t bins,
                                   double bin_length_m, const asdic_picture_options *options);
/* A record of CELLS bins of all beams. */
void asdic_survey_add(asdic_survey *survey, const asdic_record *record, size_t cells);
void asdic_survey_end(asdic_survey *survey);
void asdic_survey_finish(asdic_survey *survey);

#endif
