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

/* How many of COUNT pings from FIRST on are worth simulating at once: one block's, as the simulator's
 * volley says; one where objects move from ping to ping. */
size_t asdic_seat_volley(const asdic_seat *seat, size_t first, size_t count);

/* Simulates COUNT pings of one block from FIRST on, at most so many, learning for their block first when
 * that is another than the last. */
asdic_status asdic_seat_pings(asdic_seat *seat, size_t first, size_t count,
                              asdic_ping *const *results);

void asdic_seat_close(asdic_seat *seat);

#endif
