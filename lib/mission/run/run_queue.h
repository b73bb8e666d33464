/*
 * The pings of a run that several threads share: which pings are dealt, which came back from a
 * device that failed, and the results that wait to be taken in order. The threads of this process's
 * devices (run_workers.c) and the one that serves other processes (team_coordinator.c) use it.
 */
#ifndef ASDIC_MISSION_RUN_QUEUE_H
#define ASDIC_MISSION_RUN_QUEUE_H

#include "run_elements.h"

#include <asdic/mission.h>

#include <pthread.h>

typedef struct asdic_range {
    size_t next, end;
} asdic_range;

typedef struct asdic_slot {
    asdic_ping *result;
    bool is_ready;
} asdic_slot;

typedef struct asdic_queue {
    asdic_context *ctx;
    size_t end;           /* pings before this one */
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
    double ready_s;       /* asdic_clock_s when the first device was ready; 0 before */
    double devices_s;     /* time that this process's devices worked on pings, summed */
} asdic_queue;

/* The size of a run. */
typedef struct asdic_queue_size {
    size_t first, end; /* pings first .. end - 1 */
    size_t devices;    /* that will work on them, of this process and of others */
    size_t own;        /* of this process alone */
    size_t beams, bins;
    double bin_length_m;
    asdic_elements_shape elements; /* of coherent pings whose pressures are wanted */
    bool truth;                    /* that pings have */
} asdic_queue_size;

/* Q is finished in any case. */
asdic_status asdic_queue_init(asdic_queue *q, asdic_context *ctx, const asdic_queue_size *size);
void asdic_queue_finish(asdic_queue *q);

/* The rest is called with the lock held. */

/* The next range of fresh pings; empty when all were dealt. Ranges do not cross learning blocks, so
 * that a device seldom learns for few pings. */
asdic_range asdic_queue_deal(asdic_queue *q);

/* Makes room for COUNT more ranges to be returned; false when memory is short. */
bool asdic_queue_reserve(asdic_queue *q, size_t count);

/* Gives RANGE back for others to work on; room for it was reserved. */
void asdic_queue_return(asdic_queue *q, asdic_range range);

/* The lowest range that was given back, at most MOST pings of it, as far as there is room for
 * results; empty when there is none. */
asdic_range asdic_queue_take_returned(asdic_queue *q, size_t most);

/* The first ping for whose result there is no room yet. */
size_t asdic_queue_room(const asdic_queue *q);

/* A device is ready to work. */
void asdic_queue_note_ready(asdic_queue *q);

/* PING's result is in its slot. */
void asdic_queue_finish_ping(asdic_queue *q, size_t ping);

#endif
