/*
 * The devices of a team's other processes, as process 0 keeps them busy: one thread that deals, and
 * puts into the queue what comes back.
 */
#ifndef ASDIC_MISSION_RUN_CREW_H
#define ASDIC_MISSION_RUN_CREW_H

#include "run_queue_inside.h"

#include <asdic/team.h>

typedef struct asdic_crew asdic_crew;

/* Starts the thread, which counts as alive in Q until no other process can help. */
asdic_status asdic_crew_start(asdic_queue *q, asdic_team *team, asdic_crew **out);

/* After the queue was stopped: sends the others home and waits for their last words. NULL-safe.
 * Calls NAME with the devices that took part. */
void asdic_crew_finish(asdic_crew **crew, void (*name)(void *user, const char *device), void *user);

#endif
