/*
 * A small vehicle that flies along waypoints and leaves a track.
 *
 * Speed through the water is constant and along the body's axis. Yaw answers the rudder as a first
 * order (Nomoto et al. 1957, "On the steering qualities of ships", Int. Shipbuilding Progress 4):
 * T dr/dt + r = r_c, |r_c| <= speed / turn radius; depth answers the elevator in the same way with
 * the dive rate as its limit. Heading is steered along the line between two waypoints with a
 * lookahead distance (line of sight: Fossen 2011, "Handbook of Marine Craft Hydrodynamics and
 * Motion Control", section 10.3), and the turn into the next line begins early enough to meet it.
 * Each line is flown at the depth of its end.
 */
#ifndef ASDIC_MISSION_FLIGHT_H
#define ASDIC_MISSION_FLIGHT_H

#include "track.h"

typedef struct asdic_flight {
    const double *points_m; /* 3 per waypoint: north, east, down; the flight starts in the first */
    size_t count;           /* at least 2, no two in a row at the same place */
    double speed_mps, turn_radius_m, response_s;
    double dive_rate_mps; /* below the speed */
} asdic_flight;

/* From the first waypoint at 0 s to the line across the last. ASDIC_ERROR_INPUT when a waypoint is
 * not reached in a reasonable time, or the flight is too long. */
asdic_status asdic_flight_fly(asdic_context *ctx, const asdic_flight *flight, asdic_track **out);

#endif
