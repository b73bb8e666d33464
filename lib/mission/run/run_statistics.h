/*
 * Statistics of a run's levels: the window that shows them, and their standard errors.
 */
#ifndef ASDIC_MISSION_RUN_STATISTICS_H
#define ASDIC_MISSION_RUN_STATISTICS_H

#include <asdic/output.h>
#include <asdic/run.h>

struct asdic_statistics_counts;

typedef struct asdic_statistics {
    uint64_t rays, saturated;
    double first_time_s, last_time_s;
    double most_db;                  /* the greatest level; -INFINITY without one */
    bool has[ASDIC_COMPONENT_COUNT]; /* a level */
    /* Known at the end: */
    double low_db, high_db;             /* window of the levels, rounded outwards to 10 dB */
    double shown_low_db, shown_high_db; /* the same with the gain */
    asdic_run_errors errors;
    size_t bins;
    double *gain_db;                        /* by bin, owned; NULL: none */
    struct asdic_statistics_counts *counts; /* owned */
} asdic_statistics;

asdic_status asdic_statistics_begin(asdic_context *ctx, asdic_statistics *statistics);
/* Before the first record: what pictures add to each of BINS levels for display, as OPTIONS say. */
asdic_status asdic_statistics_set_gain(asdic_context *ctx, asdic_statistics *statistics,
                                       size_t bins, double bin_length_m,
                                       const asdic_picture_options *options);
/* A record of CELLS bins of all beams. */
void asdic_statistics_add(asdic_statistics *statistics, const asdic_record *record, size_t cells);
void asdic_statistics_end(asdic_statistics *statistics);
void asdic_statistics_finish(asdic_statistics *statistics);

#endif
