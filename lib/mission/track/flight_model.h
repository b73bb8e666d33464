/*
 * How a vehicle answers: the time derivative of its state for a wanted heading and depth.
 *
 * nomoto: speed through the water is constant and along the body's axis. Yaw answers the rudder as
 * a first order, the reduced form of sway and yaw (Nomoto et al. 1957, "On the steering qualities
 * of ships", Int. Shipbuilding Progress 4; Fossen 2011, section 7.2): T dr/dt + r = r_c,
 * |r_c| <= speed / turn radius; depth answers the stern planes in the same way with the dive rate
 * as its limit. For any vehicle whose turning circle is known; no sideslip, no loss of speed in turns.
 *
 * remus100: surge, sway, heave, pitch and yaw of the REMUS 100 with its published coefficients
 * (flight_remus.c), rudder and stern planes as its fins allow.
 */
#ifndef ASDIC_MISSION_FLIGHT_MODEL_H
#define ASDIC_MISSION_FLIGHT_MODEL_H

#include <asdic/context.h>

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
    double current_mps[2];            /* towards north and east; lets every line be held */
    double altitude_m;                /* above the bottom; NAN: depths are given */
    /* Depth of the bottom; INFINITY where there is none, and the waypoint's depth is flown. */
    double (*bottom_m)(const void *user, double north_m, double east_m);
    const void *user;
} asdic_flight;

/* Position in the world, m; attitude, rad; velocity relative to the water along the body's axes,
 * m/s; rates, rad/s; deflections, rad. */
typedef struct flight_state {
    double x_m, y_m, z_m;
    double pitch_rad, yaw_rad;
    double surge_mps, sway_mps, heave_mps;
    double pitch_rate, yaw_rate;
    double rudder_rad, plane_rad;
} flight_state;

/* What the vehicle is to do: the heading and depth that guidance wants, or, steered by hand, a
 * share of full rudder to starboard and of the steepest dive, with the depth held when that is
 * asked for. */
typedef struct flight_aim {
    double yaw_rad, z_m;
    bool by_hand, holds_depth;
    double rudder, planes; /* -1..1 */
} flight_aim;

typedef struct flight_model {
    double step_s;     /* of a track's points ... */
    unsigned substeps; /* ... each so many steps of the integration */
    double turn_radius_m, response_s;
    double lag_s; /* by which the course follows a heading that is wanted and turns slowly */
    flight_state (*derivative)(const asdic_flight *flight, const flight_aim *aim,
                               const flight_state *state);
} flight_model;

/* S after STEP_S at the rate D. */
flight_state asdic_flight_advance(const flight_state *s, const flight_state *d, double step_s);

flight_model asdic_flight_model_nomoto(const asdic_flight *flight);
flight_model asdic_flight_model_remus100(void);

/* Critical damping of an integrator behind a first-order lag T asks for a gain of 1 / (4 T). */
#define ASDIC_FLIGHT_DAMPING 4.0

static inline double asdic_flight_clamp(double x, double limit) {
    return x > limit ? limit : x < -limit ? -limit : x;
}

#endif
