/*
 * A process of a team other than the first: its devices simulate the pings that process 0 orders.
 */
#ifndef ASDIC_MISSION_TEAM_WORKER_H
#define ASDIC_MISSION_TEAM_WORKER_H

#include "run_job.h"

/* Returns when process 0 says that the run is over. */
asdic_status asdic_team_worker_run(asdic_run_job *job);

#endif
