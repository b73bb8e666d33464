/*
 * One device at work on a mission's pings.
 */
#ifndef ASDIC_MISSION_RUN_DEVICE_H
#define ASDIC_MISSION_RUN_DEVICE_H

#include <asdic/mission.h>

typedef struct asdic_run_device {
    asdic_mission *mission;
    asdic_device *device;
    asdic_simulator *simulator;
    size_t lesson; /* the ping at whose pose the simulator has learnt; SIZE_MAX: at none */
} asdic_run_device;

/* Builds the simulator, which must have BINS bins. OUT is closed in any case. */
asdic_status asdic_run_device_open(asdic_run_device *out, asdic_context *ctx,
                                   asdic_mission *mission, asdic_device *device, size_t bins);

/* How many of COUNT pings from FIRST on are best simulated at once: as many as the simulator takes,
 * of one lesson; one where objects move from ping to ping. */
size_t asdic_run_device_batch(const asdic_run_device *device, size_t first, size_t count);

/* Simulates COUNT pings of one lesson from FIRST on, at most asdic_run_device_batch. Learns first
 * unless the lesson is that of the last call. */
asdic_status asdic_run_device_pings(asdic_run_device *device, size_t first, size_t count,
                                    asdic_ping *const *results);

void asdic_run_device_close(asdic_run_device *device);

#endif
