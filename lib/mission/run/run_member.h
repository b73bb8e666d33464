/*
 * A process of a team other than the first: its devices simulate what process 0 orders.
 */
#ifndef ASDIC_MISSION_RUN_MEMBER_H
#define ASDIC_MISSION_RUN_MEMBER_H

#include "run_job.h"

/* Until process 0 sends it home. */
asdic_status asdic_member_run(asdic_run_job *job);

#endif
