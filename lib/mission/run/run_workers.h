/*
 * A run's pings on all its devices: a thread for each device, results handed over in the order of
 * the pings.
 */
#ifndef ASDIC_MISSION_RUN_WORKERS_H
#define ASDIC_MISSION_RUN_WORKERS_H

#include "run_elements.h"

#include <asdic/mission.h>

typedef struct asdic_work {
    asdic_mission *mission;
    asdic_device **devices;
    size_t device_count;
    size_t first, end; /* pings first .. end - 1 */
    size_t bins;
    asdic_elements_shape elements; /* 0: no pressures are wanted */
    /* Called in the caller's thread, ping by ping, while devices go on; a failure stops the run. */
    asdic_status (*take)(void *user, size_t ping, const asdic_ping *result);
    /* Called at the end with the name of every device of another process that took part; may be
     * NULL. */
    void (*name)(void *user, const char *device);
    void *user;
    asdic_team *team;     /* NULL: this process alone */
    const char *run_hash; /* asdic_job_hash, for a team */
} asdic_work;

typedef struct asdic_work_result {
    double ready_s;   /* asdic_clock_s when the first device was ready; known before any taking */
    double devices_s; /* time that this process's devices worked on pings, summed */
} asdic_work_result;

/* ASDIC_OK when all pings were taken, ASDIC_ERROR_INTERRUPTED when the context asked to stop. A
 * device that fails is dropped with a warning and its pings go to the others; without others its
 * failure is returned. RESULT is filled in any case. */
asdic_status asdic_workers_run(asdic_context *ctx, const asdic_work *work,
                               asdic_work_result *result);

/* Whether DEVICES are COUNT devices, at least one, and none of them NULL. */
bool asdic_devices_are_there(asdic_device *const *devices, size_t count);

#endif
