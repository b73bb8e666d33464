/*
 * Several processes that run one mission together. Process 0 writes the run folder, deals blocks of
 * pings to all devices of all processes, its own included, as they ask for more, and takes the
 * results in order; the bytes are those of a run by one process. The library knows no network: a
 * program says how messages travel (the asdic program does so by MPI).
 */
#ifndef ASDIC_TEAM_H
#define ASDIC_TEAM_H

#include <asdic/context.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Messages between two processes arrive in the order in which they were sent. The functions are
 * called by one thread at a time, not always by the same. All processes must be of one kind of
 * machine (byte order, sizes). A failure is a status with a sentence in the context. */
typedef struct asdic_team {
    unsigned rank, size; /* of this process, from 0; of processes */
    /* Sends BYTES, which it copies, to process TO; does not wait for them to arrive. */
    asdic_status (*send)(void *user, unsigned to, const void *data, size_t bytes);
    /* A message that has arrived, from any process: *DATA is valid until the next call. *DATA is
     * NULL when there is none; does not wait. */
    asdic_status (*receive)(void *user, unsigned *from, const void **data, size_t *bytes);
    void *user;
    bool is_over; /* the library's; false at first */
} asdic_team;

/* Every process calls this once when it is done, however that went, before messages cease to
 * travel. In process 0 it sends the others home. The others tell process 0 that they take no part,
 * with the context's sentence, if asdic_mission_run did not begin, and wait to be sent home. */
ASDIC_API asdic_status asdic_team_end(asdic_context *ctx, asdic_team *team);

#ifdef __cplusplus
}
#endif

#endif
