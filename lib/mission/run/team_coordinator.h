/*
 * The coordinator of a team, in process 0: a thread that sends pings to the devices of the other
 * processes and puts their results into the queue.
 */
#ifndef ASDIC_MISSION_TEAM_COORDINATOR_H
#define ASDIC_MISSION_TEAM_COORDINATOR_H

#include "run_queue.h"

#include <asdic/team.h>

typedef struct asdic_coordinator asdic_coordinator;

/* Starts the thread, which counts as alive in Q until no other process can help. RAYS a ping and
 * RUN_HASH (asdic_job_hash, borrowed) are what the processes must agree in. */
asdic_status asdic_coordinator_start(asdic_queue *q, asdic_team *team, uint32_t rays,
                                     const char *run_hash, asdic_coordinator **out);

/* After the queue was stopped: tells the other processes to stop and waits for their last message.
 * NULL-safe. Calls NAME, which may be NULL, with the devices that took part. */
void asdic_coordinator_finish(asdic_coordinator **coordinator,
                              void (*name)(void *user, const char *device), void *user);

#endif
