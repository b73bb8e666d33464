/*
 * Many receivers: arrivals sorted by range, then weighed for all receivers at once, see kernels/fan.cl.
 */
#ifndef ASDIC_SIM_BEAM_FAN_H
#define ASDIC_SIM_BEAM_FAN_H

#include <asdic/ping.h>

#include "../../kernels/ping_types.h"
#include "ocl/ocl.h"

#include <pthread.h>
#include <stdatomic.h>

/* Rays of a batch. Its size is fixed: sums are floats, added in the order of rays batch by batch, and so the
 * same on every device. */
#define ASDIC_FAN_BATCH ((size_t)1 << 17)

typedef struct asdic_beam_fan {
    bool many;        /* false: few receivers, for which collect.cl adds arrivals */
    bool common_axis; /* faces of one size that differ in yaw about one axis only */
    unsigned blocks;  /* of rays, that are sorted at the same time */
    unsigned width;   /* receivers of a vector */
    size_t sums;      /* of a bin and receiver, as in fan_entry.h */
    size_t row; /* floats of the results of one sum and receiver: bins, and what fills lines up */
    asdic_kernel *count, *place, *scatter, *runs, *project;
    asdic_buffer *counts, *made, *lists, *entries;
    asdic_fetch *fetches; /* a tile's each, on their way to the host, then those of its truth */
    size_t tiles;
    pthread_mutex_t lock;
    atomic_size_t fetched; /* tiles that are there: they come in order */
} asdic_beam_fan;

/* Whether receivers are many. */
bool asdic_beam_fan_is_wanted(const asdic_sonar *sonar);

/* Fills MANY and COMMON_AXIS. */
void asdic_beam_fan_plan(const asdic_sonar *sonar, asdic_beam_fan *fan);

/* Kernels and buffers of SIM's fan; nothing where receivers are few. */
asdic_status asdic_beam_fan_init(asdic_simulator *sim);
void asdic_beam_fan_finish(asdic_beam_fan *fan);

/* Enqueues the sums of one batch's arrivals, added to those of the batches before: rows [beam][sum]
 * of the results, and TRUTH, the cells of a ping's rows (kernels/truth.h). After the last batch they
 * are fetched to these buffers' memory on the host, tile by tile. */
asdic_status asdic_beam_fan_project(asdic_simulator *sim, asdic_buffer *truth);

/* SUM of BEAM by bins, in RESULTS that have come to the host. */
const float *asdic_beam_fan_row(const asdic_beam_fan *fan, const void *results, size_t beam,
                                size_t sum);

/* Blocks until the beams of TILE are there; for several threads at a time. */
asdic_status asdic_beam_fan_wait(asdic_beam_fan *fan, size_t tile);
/* Blocks until nothing is on its way to the host: after a ping that failed. */
void asdic_beam_fan_abandon(asdic_beam_fan *fan);

#endif
