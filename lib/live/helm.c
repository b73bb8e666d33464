#include "helm.h"

#include <math.h>

/* Distance kept from surface and bottom, m. */
#define CLEARANCE_M 0.3
/* Below this speed a vehicle does not answer its fins and stays where it is. */
#define STEERAGE_MPS 0.05
#define MOST_NOMOTO_MPS 6.0
/* Steeper dives, beyond about 35 degrees, are outside the models. */
#define STEEPEST 0.57

void asdic_helm_init(asdic_helm *h, const asdic_flight *flight) {
    *h = (asdic_helm){.flight = *flight};
    h->model = flight->vehicle == ASDIC_VEHICLE_REMUS100 ? asdic_flight_model_remus100()
                                                         : asdic_flight_model_nomoto(flight);
}

void asdic_helm_take(asdic_helm *h, const asdic_pose *pose, double speed_mps) {
    h->state = (flight_state){.x_m = pose->position_m.x,
                              .y_m = pose->position_m.y,
                              .z_m = pose->position_m.z,
                              .pitch_rad = pose->pitch_rad,
                              .yaw_rad = pose->yaw_rad,
                              .surge_mps = speed_mps};
    h->wanted_mps = h->flight.speed_mps = speed_mps;
    h->rudder = h->planes = 0.0;
    h->holds_depth = true;
    h->hold_z_m = pose->position_m.z;
    asdic_helm_change_speed(h, 0.0);
}

static bool is_remus(const asdic_helm *h) {
    return h->flight.vehicle == ASDIC_VEHICLE_REMUS100;
}

/* The REMUS 100 model holds between two speeds, and at rest. */
void asdic_helm_change_speed(asdic_helm *h, double by_mps) {
    double most = is_remus(h) ? ASDIC_REMUS100_MAX_MPS : MOST_NOMOTO_MPS;
    double wanted = fmin(fmax(h->wanted_mps + by_mps, 0.0), most);
    if (is_remus(h) && wanted < ASDIC_REMUS100_MIN_MPS) {
        wanted = by_mps > 0.0 ? ASDIC_REMUS100_MIN_MPS : by_mps < 0.0 ? 0.0 : wanted;
    }
    h->wanted_mps = wanted;
}

static double limited(double x) {
    double y = asdic_flight_clamp(x, 1.0);
    return fabs(y) < 1e-9 ? 0.0 : y;
}

void asdic_helm_change_rudder(asdic_helm *h, double by) {
    h->rudder = by == 0.0 ? 0.0 : limited(h->rudder + by);
}

void asdic_helm_change_planes(asdic_helm *h, double by) {
    h->planes = h->holds_depth ? limited(by) : limited(h->planes + by);
    h->holds_depth = false;
}

void asdic_helm_toggle_hold(asdic_helm *h) {
    h->holds_depth = !h->holds_depth;
    h->hold_z_m = h->state.z_m;
    h->planes = 0.0;
}

double asdic_helm_speed_mps(const asdic_helm *h) {
    return is_remus(h) ? h->state.surge_mps : h->flight.speed_mps;
}

/* The midpoint rule, as waypoints are flown. */
static void integrate(asdic_helm *h, double step_s) {
    flight_aim aim = {.by_hand = true,
                      .rudder = h->rudder,
                      .holds_depth = h->holds_depth,
                      .planes = h->planes,
                      .z_m = h->hold_z_m};
    flight_state d = h->model.derivative(&h->flight, &aim, &h->state);
    flight_state middle = asdic_flight_advance(&h->state, &d, 0.5 * step_s);
    d = h->model.derivative(&h->flight, &aim, &middle);
    h->state = asdic_flight_advance(&h->state, &d, step_s);
}

/* Neither out of the water nor into the ground. */
static void keep_clear(asdic_helm *h, const asdic_scene *scene) {
    flight_state *s = &h->state;
    double altitude_m = asdic_scene_altitude_m(scene, (asdic_vec3){s->x_m, s->y_m, 0.0});
    double deepest_m = fmax(altitude_m - CLEARANCE_M, CLEARANCE_M);
    double z_m = fmin(fmax(s->z_m, CLEARANCE_M), deepest_m);
    if (z_m != s->z_m) {
        s->z_m = z_m;
        s->pitch_rad = s->pitch_rate = s->heave_mps = 0.0;
    }
}

asdic_pose asdic_helm_advance(asdic_helm *h, const asdic_scene *scene, double step_s) {
    double dive_rate_mps = h->flight.dive_rate_mps;
    size_t steps = (size_t)ceil(step_s / (h->model.step_s / h->model.substeps));
    double part_s = step_s / (double)steps;
    for (size_t i = 0; i < steps; i++) {
        /* The propeller responds with a first-order lag, as the rudder does. */
        double share = 1.0 - exp(-part_s / h->model.response_s);
        h->flight.speed_mps += share * (h->wanted_mps - h->flight.speed_mps);
        if (h->flight.speed_mps < STEERAGE_MPS) {
            h->state.yaw_rate = h->state.pitch_rate = 0.0;
            continue;
        }
        h->flight.dive_rate_mps = fmin(dive_rate_mps, STEEPEST * h->flight.speed_mps);
        integrate(h, part_s);
        keep_clear(h, scene);
    }
    h->flight.dive_rate_mps = dive_rate_mps;
    return (asdic_pose){.position_m = {h->state.x_m, h->state.y_m, h->state.z_m},
                        .pitch_rad = h->state.pitch_rad,
                        .yaw_rad = h->state.yaw_rad};
}
