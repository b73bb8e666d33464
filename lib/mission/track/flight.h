/*
 * A small vehicle that flies along waypoints and leaves a track.
 *
 * Guidance is the same for all: heading is steered along the line between two waypoints with a
 * lookahead distance (line of sight: Fossen 2011, "Handbook of Marine Craft Hydrodynamics and
 * Motion Control", section 10.3), the turn into the next line begins early enough to meet it, and
 * a current across the line is met by a crab angle. A line is flown at the depth of its end, or at
 * an altitude above the bottom that is straight below the vehicle then.
 *
 * The vehicle answers by one of two models of manoeuvring (flight_model.h). Both leave out roll,
 * waves, and the time that instruments and filters take. A current is the same everywhere and at
 * all times; then the equations hold for the velocity relative to the water (Fossen 2011, section
 * 8.3), and the water carries the vehicle along.
 */
#ifndef ASDIC_MISSION_FLIGHT_H
#define ASDIC_MISSION_FLIGHT_H

#include "track.h"

typedef enum asdic_vehicle { ASDIC_VEHICLE_NOMOTO, ASDIC_VEHICLE_REMUS100 } asdic_vehicle;

/* Between these speeds, m/s, the coefficients of the REMUS 100 may be used: they were found, and
 * compared with trials, at 1.54 m/s. */
#define ASDIC_REMUS100_MIN_MPS 1.0
#define ASDIC_REMUS100_MAX_MPS 2.5

typedef struct asdic_flight {
    const double *points_m; /* 3 per waypoint: north, east, down; the flight starts in the first */
    size_t count;           /* at least 2, no two in a row at the same place */
    asdic_vehicle vehicle;
    double speed_mps;                 /* through the water */
    double turn_radius_m, response_s; /* of ASDIC_VEHICLE_NOMOTO */
    double dive_rate_mps;             /* the same; below the speed */
    double current_mps[2];            /* towards north and east; well below the speed */
    double altitude_m;                /* above the bottom; NAN: depths are given */
    /* Depth of the bottom; INFINITY where there is none, and the waypoint's depth is flown. */
    double (*bottom_m)(const void *user, double north_m, double east_m);
    const void *user;
} asdic_flight;

/* From the first waypoint at 0 s to the line across the last. ASDIC_ERROR_INPUT when a waypoint is
 * not reached in a reasonable time, or the flight is too long. */
asdic_status asdic_flight_fly(asdic_context *ctx, const asdic_flight *flight, asdic_track **out);

#endif
