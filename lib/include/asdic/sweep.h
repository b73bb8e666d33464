/*
 * A scanned sonar: a head that looks in one direction a ping and turns between pings.
 *
 * Transmitter and receivers turn together about the vehicle's z axis, from port to starboard. On a
 * sector of 360 degrees they go round and round; on a smaller one back and forth. The head's angle
 * is counted from the bow, positive to starboard, and depends on the number of the ping alone.
 */
#ifndef ASDIC_SWEEP_H
#define ASDIC_SWEEP_H

#include <asdic/common.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct asdic_sweep {
    size_t directions; /* 0: nothing turns, and the other fields say nothing */
    double step_rad;   /* between directions */
    bool is_circle;    /* the direction after the last is the first; else the way leads back */
} asdic_sweep;

/* SECTOR_RAD and its steps as a sweep; a step longer than the sector, or below a millionth of it,
 * is none. The step divides the sector. */
ASDIC_API asdic_sweep asdic_sweep_of(double sector_rad, double step_rad);

/* Number of the direction at ping PING, from 0 at the port end; 0 where nothing turns. */
ASDIC_API size_t asdic_sweep_direction(const asdic_sweep *sweep, uint64_t ping);

/* Angle of the head in a direction; 0 where nothing turns. */
ASDIC_API double asdic_sweep_bearing_rad(const asdic_sweep *sweep, size_t direction);

/* The pose of the sonar at ping PING of a vehicle at VEHICLE, and the other way round. */
ASDIC_API asdic_pose asdic_sweep_sonar(const asdic_sweep *sweep, const asdic_pose *vehicle,
                                       uint64_t ping);
ASDIC_API asdic_pose asdic_sweep_vehicle(const asdic_sweep *sweep, const asdic_pose *sonar,
                                         uint64_t ping);

#ifdef __cplusplus
}
#endif

#endif
