/*
 * Surge, sway, heave, pitch and yaw of the REMUS 100, a torpedo-shaped vehicle of 1.3 m and 30 kg.
 *
 * Equations (4.49) and coefficients (appendix, as adjusted by trials) of T. Prestero 2001,
 * "Verification of a Six-Degree of Freedom Simulation Model for the REMUS Autonomous Underwater
 * Vehicle", MIT/WHOI. Reduced: no roll; the centre of gravity lies below the centre of buoyancy but
 * not before or behind it and counts in the restoring moment only; weight equals buoyancy, as a
 * vehicle is trimmed; thrust is what keeps the wanted speed on a straight course, so that a turn
 * costs speed. Newton metres and newtons; u, v, w, q, r as there, relative to the water.
 *
 * One coefficient differs: the table prints Y_vv = -1310 kg/m. The body is round, its formula is
 * that of Z_ww = -131, and the planform that the same tables give makes 131; that is used. It
 * matters in turns: full rudder gives a circle of 4.41 m, and would give one of 6.04 m with what is
 * printed, since a body that resists sideways motion ten times as much drifts by 3.4 degrees
 * instead of 9.2.
 *
 * Valid near 1.5 m/s (1 to 2.5 m/s are accepted) and for small angles of attack. The autopilot's
 * gains are not REMUS's: they are chosen for a quick answer without much overshoot over these
 * speeds. Full rudder gives its circle at any speed and takes off 38 % of it.
 */
#include "flight_model.h"

#include "base/vec.h"

/* Body. kg, N, m, kg m^2 */
#define MASS 30.48
#define WEIGHT 299.0
#define GRAVITY_BELOW_M 0.0196
#define INERTIA 3.45 /* about the vertical and the transverse axis */

/* Added mass: kg, kg m, kg m^2. */
#define X_UDOT (-0.93)
#define Y_VDOT (-35.5)
#define Y_RDOT 1.93
#define Z_WDOT (-35.5)
#define Z_QDOT (-1.93)
#define M_WDOT (-1.93)
#define M_QDOT (-4.88)
#define N_VDOT 1.93
#define N_RDOT (-4.88)

/* Forces: kg/m, kg, kg m. */
#define X_UU (-1.62)
#define X_WQ (-35.5)
#define X_QQ (-1.93)
#define X_VR 35.5
#define X_RR (-1.93)
#define Y_VV (-131.0)
#define Y_RR 0.632
#define Y_UV (-28.6)
#define Y_UR 5.22
#define Z_WW (-131.0)
#define Z_QQ (-0.632)
#define Z_UW (-28.6)
#define Z_UQ (-5.22)

/* Moments: kg, kg m, kg m^2. */
#define M_WW 3.18
#define M_QQ (-188.0)
#define M_UW 24.0
#define M_UQ (-2.0)
#define N_VV (-3.18)
#define N_RR (-94.0)
#define N_UV (-24.0)
#define N_UR (-2.0)

/* Fins: kg/(m rad), kg/rad; they turn by 13.6 degrees at most. The time that they take is
 * assumed. */
#define Y_UUD 9.64
#define Z_UUD (-9.64)
#define M_UUD (-6.15)
#define N_UUD (-6.15)
#define MAX_FIN_RAD (13.6 * ASDIC_PI / 180.0)
#define FIN_S 0.1

/* Autopilot: rudder per heading error and per yaw rate, s; pitch per depth error, rad/m; planes per
 * pitch error and per pitch rate, s. */
#define HEADING_GAIN 1.5
#define YAW_RATE_GAIN 2.5
#define DEPTH_GAIN 0.2
#define PITCH_GAIN 1.5
#define PITCH_RATE_GAIN 1.5
#define MAX_PITCH_RAD 0.5

#define TURN_RADIUS_M 4.41

/* At 1.54 m/s; 1.19 at 1 and 1.48 at 2.5. In a wide turn sway and yaw balance at v = -0.429 r, r = 0.742 u rudder; the
 * course lags by what the autopilot needs of error for that rudder and the rate, and by the drift. */
#define LAG_S 1.36

typedef struct pair {
    double force, moment;
} pair;

/* Accelerations from [a b; c d] x = given. */
static pair solve(double a, double b, double c, double d, pair given) {
    double det = a * d - b * c;
    return (pair){(d * given.force - b * given.moment) / det,
                  (a * given.moment - c * given.force) / det};
}

static double surge_change(const asdic_flight *f, const flight_state *s) {
    double u = s->surge_mps, v = s->sway_mps, w = s->heave_mps;
    double q = s->pitch_rate, r = s->yaw_rate;
    double thrust = -X_UU * f->speed_mps * f->speed_mps;
    return (X_UU * u * fabs(u) + thrust + (X_VR + MASS) * v * r + X_RR * r * r +
            (X_WQ - MASS) * w * q + X_QQ * q * q) /
           (MASS - X_UDOT);
}

static pair sway_yaw_change(const flight_state *s) {
    double u = s->surge_mps, v = s->sway_mps, r = s->yaw_rate, d = s->rudder_rad;
    pair sum = {Y_VV * v * fabs(v) + Y_RR * r * fabs(r) + (Y_UR - MASS) * u * r + Y_UV * u * v +
                    Y_UUD * u * u * d,
                N_VV * v * fabs(v) + N_RR * r * fabs(r) + N_UR * u * r + N_UV * u * v +
                    N_UUD * u * u * d};
    return solve(MASS - Y_VDOT, -Y_RDOT, -N_VDOT, INERTIA - N_RDOT, sum);
}

static pair heave_pitch_change(const flight_state *s) {
    double u = s->surge_mps, w = s->heave_mps, q = s->pitch_rate, d = s->plane_rad;
    pair sum = {Z_WW * w * fabs(w) + Z_QQ * q * fabs(q) + (Z_UQ + MASS) * u * q + Z_UW * u * w +
                    Z_UUD * u * u * d,
                M_WW * w * fabs(w) + M_QQ * q * fabs(q) + M_UQ * u * q + M_UW * u * w +
                    M_UUD * u * u * d - GRAVITY_BELOW_M * WEIGHT * sin(s->pitch_rad)};
    return solve(MASS - Z_WDOT, -Z_QDOT, -M_WDOT, INERTIA - M_QDOT, sum);
}

/* Positive fins turn to port and down. */
static void steer(const flight_aim *aim, const flight_state *s, double *rudder, double *plane) {
    double error_rad = remainder(aim->yaw_rad - s->yaw_rad, 2.0 * ASDIC_PI);
    double dive_rad = aim->by_hand && !aim->holds_depth
                          ? aim->planes * MAX_PITCH_RAD
                          : asdic_flight_clamp(DEPTH_GAIN * (aim->z_m - s->z_m), MAX_PITCH_RAD);
    double pitch_rad = -dive_rad;
    /* Steered by hand: a share of full rudder and of the circle that it gives. The rate is damped,
     * since the vehicle alone does not swim straight. */
    double wanted_rate = aim->rudder * s->surge_mps / TURN_RADIUS_M;
    double fin_rad = aim->by_hand
                         ? YAW_RATE_GAIN * (s->yaw_rate - wanted_rate) - aim->rudder * MAX_FIN_RAD
                         : YAW_RATE_GAIN * s->yaw_rate - HEADING_GAIN * error_rad;
    *rudder = asdic_flight_clamp(fin_rad, MAX_FIN_RAD);
    *plane = asdic_flight_clamp(
        PITCH_GAIN * (s->pitch_rad - pitch_rad) + PITCH_RATE_GAIN * s->pitch_rate, MAX_FIN_RAD);
}

static flight_state derivative(const asdic_flight *f, const flight_aim *aim,
                               const flight_state *s) {
    double rudder, plane;
    double u = s->surge_mps, v = s->sway_mps, w = s->heave_mps;
    double cos_yaw = cos(s->yaw_rad), sin_yaw = sin(s->yaw_rad);
    double cos_pitch = cos(s->pitch_rad), sin_pitch = sin(s->pitch_rad);
    double ahead_mps = u * cos_pitch + w * sin_pitch; /* in the horizontal plane */
    pair side = sway_yaw_change(s), down = heave_pitch_change(s);
    steer(aim, s, &rudder, &plane);
    return (flight_state){.x_m = ahead_mps * cos_yaw - v * sin_yaw + f->current_mps[0],
                          .y_m = ahead_mps * sin_yaw + v * cos_yaw + f->current_mps[1],
                          .z_m = w * cos_pitch - u * sin_pitch,
                          .pitch_rad = s->pitch_rate,
                          .yaw_rad = s->yaw_rate / cos_pitch,
                          .surge_mps = surge_change(f, s),
                          .sway_mps = side.force,
                          .heave_mps = down.force,
                          .pitch_rate = down.moment,
                          .yaw_rate = side.moment,
                          .rudder_rad = (rudder - s->rudder_rad) / FIN_S,
                          .plane_rad = (plane - s->plane_rad) / FIN_S};
}

flight_model asdic_flight_model_remus100(void) {
    return (flight_model){.step_s = 0.1,
                          .substeps = 5,
                          .turn_radius_m = TURN_RADIUS_M,
                          .response_s = 1.0,
                          .lag_s = LAG_S,
                          .derivative = derivative};
}
