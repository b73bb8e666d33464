/*
 * One device at work on a mission's pings.
 */
#ifndef ASDIC_MISSION_RUN_SEAT_H
#define ASDIC_MISSION_RUN_SEAT_H

#include <asdic/mission.h>

typedef struct asdic_seat {
    asdic_mission *mission;
    asdic_device *device;
    asdic_simulator *simulator;
    size_t block; /* the simulator has learnt for this block of pings; SIZE_MAX: for none */
} asdic_seat;

/* Builds the simulator, which must have BINS bins. SEAT is closed in any case. */
asdic_status asdic_seat_open(asdic_seat *seat, asdic_context *ctx, asdic_mission *mission,
                             asdic_device *device, size_t bins);

/* Simulates PING, learning for its block first when that is another than the last. */
asdic_status asdic_seat_ping(asdic_seat *seat, size_t ping, asdic_ping *result);

void asdic_seat_close(asdic_seat *seat);

#endif
