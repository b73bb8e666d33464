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

#include "flight_model.h"
#include "track.h"

/* The line from one waypoint to the next. */
typedef struct flight_leg {
    double x_m, y_m;    /* start */
    double north, east; /* unit vector */
    double length_m, yaw_rad;
    double z_m;    /* to be flown at */
    double lead_m; /* the turn into the next line begins this far before the end */
} flight_leg;

/* A flight under way; a copy of it can be flown on by itself. */
typedef struct asdic_pilot {
    const asdic_flight *flight;
    flight_model model;
    double lookahead_m;
    flight_state state;
    size_t index; /* of the line, that from this waypoint to the next */
    flight_leg leg;
} asdic_pilot;

/* What is to be flown in place of what the waypoints say. */
typedef struct asdic_order {
    bool turns; /* to yaw_rad */
    bool dives; /* to z_m */
    double yaw_rad, z_m;
} asdic_order;

/* Speed over ground along a COURSE that is held in the current, whose part across to starboard, which
 * must be below the speed, goes to *ACROSS (NULL: not wanted). */
double asdic_flight_headway_mps(double speed_mps, const double current_mps[2], double course_rad,
                                double *across_mps);

/* At the first waypoint; FLIGHT is borrowed. */
void asdic_pilot_begin(asdic_pilot *pilot, const asdic_flight *flight);

/* Past the line across the last waypoint. */
bool asdic_pilot_is_done(const asdic_pilot *pilot);

/* STEP_S further, at most the model's; ORDER NULL: along the waypoints. */
void asdic_pilot_advance(asdic_pilot *pilot, const asdic_order *order, double step_s);

/* Where a flight comes nearest to a waypoint: so far aside, and so much deeper than it is to be flown there. */
typedef struct asdic_flight_miss {
    size_t point; /* 0: none; the flight starts there */
    double aside_m, deeper_m;
} asdic_flight_miss;

/* From the first waypoint at 0 s to the line across the last. *MISS is the waypoint that is missed most, of those that
 * are by more than two metres of depth, than a turn is wide aside or, of the last, two metres. ASDIC_ERROR_INPUT when a
 * waypoint is not reached in a reasonable time, or the flight is too long. */
asdic_status asdic_flight_fly(asdic_context *ctx, const asdic_flight *flight, asdic_track **out,
                              asdic_flight_miss *miss);

#endif
