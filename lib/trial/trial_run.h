/*
 * One run of a trial.
 */
#ifndef ASDIC_TRIAL_TRIAL_RUN_H
#define ASDIC_TRIAL_TRIAL_RUN_H

#include "trial_eye.h"

#include <asdic/trial.h>

typedef struct asdic_trial_job {
    const asdic_mission *mission; /* of the run */
    uint64_t seed, run;
    size_t worker;
    const asdic_trial_rule *rule; /* NULL: the mission's */
    asdic_track *track;           /* gets the pose at each ping; NULL: nobody asks */
} asdic_trial_job;

/* Flies it. What the draw or the rule did wrong is an outcome, with WHY; a status is only for what
 * ends a trial. */
asdic_status asdic_trial_run_one(asdic_eye *eye, const asdic_trial_job *job, asdic_trial_run *out,
                                 char why[ASDIC_TRIAL_WHY]);

/* Whether all runs of OPTIONS can be drawn, so that a bad one does not end the trial after others were flown. */
asdic_status asdic_trial_check_draws(asdic_context *ctx, const asdic_trial_options *options);

/* The mission of RUN as VARIANT changes it; DONOR, of another run, gives away what is the same. */
asdic_status asdic_trial_load(asdic_context *ctx, const asdic_trial_options *options, uint64_t run,
                              size_t variant, asdic_mission *donor, asdic_mission **out);

#endif
