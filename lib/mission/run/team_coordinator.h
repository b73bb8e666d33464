/*
 * The devices of a team's other processes, as process 0 keeps them busy: one thread that sends them
 * pings to simulate and puts what comes back into the queue.
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
