/*
 * The queue of pings, as those see it who work on it: threads of this process's devices
 * (run_queue.c), and the one that speaks with other processes (run_crew.c).
 */
#ifndef ASDIC_MISSION_RUN_QUEUE_INSIDE_H
#define ASDIC_MISSION_RUN_QUEUE_INSIDE_H

#include "run_queue.h"

#include <pthread.h>

typedef struct asdic_range {
    size_t next, end;
} asdic_range;

typedef struct asdic_slot {
    asdic_ping *result;
    bool is_ready;
} asdic_slot;

struct asdic_queue_worker;

typedef struct asdic_queue {
    asdic_context *ctx;
    const asdic_queue_work *work;
    pthread_mutex_t lock; /* guards everything below */
    pthread_cond_t changed;
    asdic_slot *slots; /* ping p lives in slots[p % slot_count] */
    size_t slot_count;
    size_t chunk;          /* pings dealt at once, within a learning block */
    size_t fresh;          /* first ping that was not dealt */
    size_t taken;          /* first ping that was not taken */
    size_t remaining;      /* pings not simulated yet */
    asdic_range *returned; /* by devices that failed */
    size_t returned_count, returned_capacity;
    size_t alive; /* threads that may still bring results */
    bool is_stopped;
    asdic_status failure; /* of the last device that failed */
    double ready_s, devices_s;
    struct asdic_queue_worker *workers;
} asdic_queue;

/* With the lock held: the next range of fresh pings; chunks do not cross learning blocks, so that a
 * device seldom learns for few pings. Empty when all were dealt. */
asdic_range asdic_queue_deal(asdic_queue *q);

/* With the lock held: makes room for COUNT more ranges to be returned; false when memory is short.
 */
bool asdic_queue_reserve(asdic_queue *q, size_t count);

/* With the lock held: gives RANGE back for others to work on; room for it was reserved. */
void asdic_queue_return(asdic_queue *q, asdic_range range);

/* With the lock held: the lowest range that was given back, at most MOST pings of it, as far as
 * there is room for results; empty when there is none. */
asdic_range asdic_queue_take_returned(asdic_queue *q, size_t most);

/* With the lock held: PING's result is in its slot. */
void asdic_queue_finish_ping(asdic_queue *q, size_t ping);

#endif
