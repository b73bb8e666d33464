#include "flight_model.h"

#include "base/vec.h"

/* Yaw is commanded that would make what is left of a turn so many times over in a response time. */
#define YAW_GAIN 4.0

static flight_state derivative(const asdic_flight *f, const flight_aim *aim,
                               const flight_state *s) {
    double slow_s = ASDIC_FLIGHT_DAMPING * f->response_s;
    double sink_mps = -f->speed_mps * sin(s->pitch_rad);
    double forward_mps = f->speed_mps * cos(s->pitch_rad);
    double most_yaw = forward_mps / f->turn_radius_m;
    /* With the rudder amidships yaw dies out over T r. What is left of a turn after that shrinks by what is commanded,
     * d/dt (error - T r) = -r_c, so that no gain overshoots; a high one keeps the radius until nearly the end. A
     * small turn passes two first orders, T / gain and T. */
    double coast_rad = f->response_s * s->yaw_rate;
    double left_rad = remainder(aim->yaw_rad - s->yaw_rad, 2.0 * ASDIC_PI) - coast_rad;
    double yaw_command = aim->by_hand
                             ? aim->rudder * most_yaw
                             : asdic_flight_clamp(YAW_GAIN * left_rad / f->response_s, most_yaw);
    double sink_command = aim->by_hand && !aim->holds_depth
                              ? aim->planes * f->dive_rate_mps
                              : asdic_flight_clamp((aim->z_m - s->z_m) / slow_s, f->dive_rate_mps);
    double sink_change = (sink_command - sink_mps) / f->response_s;
    return (flight_state){.x_m = forward_mps * cos(s->yaw_rad) + f->current_mps[0],
                          .y_m = forward_mps * sin(s->yaw_rad) + f->current_mps[1],
                          .z_m = sink_mps,
                          .pitch_rad = -sink_change / forward_mps,
                          .yaw_rad = s->yaw_rate,
                          .yaw_rate = (yaw_command - s->yaw_rate) / f->response_s};
}

flight_model asdic_flight_model_nomoto(const asdic_flight *flight) {
    double step_s = fmin(fmin(0.1, 0.05 * flight->response_s),
                         flight->turn_radius_m / (30.0 * flight->speed_mps));
    return (flight_model){.step_s = step_s,
                          .substeps = 1,
                          .turn_radius_m = flight->turn_radius_m,
                          .response_s = flight->response_s,
                          .lag_s = (1.0 + 1.0 / YAW_GAIN) * flight->response_s,
                          .derivative = derivative};
}
