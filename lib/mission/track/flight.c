#include "flight.h"

#include "base/context.h"
#include "base/vec.h"
#include "track.h"

#include <stdlib.h>

/* So near to a waypoint, in depth or at the end, a vehicle has reached it. */
#define MOST_MISS_M 2.0

/* Most points of a track: over five days at the usual steps of 0.1 s. */
#define MAX_POINTS 5000000

static flight_leg find_leg(const asdic_flight *flight, size_t index) {
    const double *a = flight->points_m + 3 * index, *b = a + 3;
    double north = b[0] - a[0], east = b[1] - a[1], length_m = hypot(north, east);
    return (flight_leg){.x_m = a[0],
                        .y_m = a[1],
                        .north = north / length_m,
                        .east = east / length_m,
                        .length_m = length_m,
                        .yaw_rad = atan2(east, north),
                        .z_m = b[2]};
}

/* Where the turn from leg INDEX into the next begins: a circle that touches both lines does so at R tan(half the turn)
 * from the corner, and the lag takes some more. What turns by more than 120 degrees does not come so far back: it begins
 * the nearer the more it turns, at last so that on its way back it is abeam of the corner. */
static double find_lead_m(const asdic_pilot *p, size_t index, const flight_leg *leg) {
    const asdic_flight *flight = p->flight;
    if (index + 2 >= flight->count) {
        return 0.0;
    }
    flight_leg next = find_leg(flight, index + 1);
    double half = 0.5 * fabs(remainder(next.yaw_rad - leg->yaw_rad, 2.0 * ASDIC_PI));
    double radius_m = p->model.turn_radius_m;
    double lag_m = half > 0.0 ? flight->speed_mps * p->model.lag_s : 0.0;
    double most_m = (radius_m + 0.5 * lag_m) * (1.0 + 2.0 * cos(half));
    return fmin(fmin(radius_m * tan(half) + lag_m, most_m),
                0.5 * fmin(leg->length_m, next.length_m));
}

/* Distance flown along LEG, and across it to starboard. */
static double along(const flight_leg *leg, const flight_state *s, double *across_m) {
    double dx = s->x_m - leg->x_m, dy = s->y_m - leg->y_m;
    *across_m = dy * leg->north - dx * leg->east;
    return dx * leg->north + dy * leg->east;
}

double asdic_flight_headway_mps(double speed_mps, const double current_mps[2], double course_rad,
                                double *across_mps) {
    double north = cos(course_rad), east = sin(course_rad);
    double across = current_mps[1] * north - current_mps[0] * east;
    double left2 = (speed_mps + across) * (speed_mps - across);
    if (across_mps) {
        *across_mps = across;
    }
    return sqrt(fmax(left2, 0.0)) + current_mps[0] * north + current_mps[1] * east;
}

/* The heading that makes good the COURSE in the current: its part across is met by a crab angle. */
static double crab(const asdic_flight *f, double course_rad) {
    double across_mps;
    asdic_flight_headway_mps(f->speed_mps, f->current_mps, course_rad, &across_mps);
    return course_rad - asin(asdic_flight_clamp(across_mps / f->speed_mps, 1.0));
}

static double wanted_depth_m(const asdic_flight *f, double leg_z_m, double x_m, double y_m) {
    double bottom_m = isnan(f->altitude_m) ? INFINITY : f->bottom_m(f->user, x_m, y_m);
    return isfinite(bottom_m) ? fmax(bottom_m - f->altitude_m, 0.0) : leg_z_m;
}

static flight_state derivative(const asdic_pilot *p, const asdic_order *order, double z_m,
                               const flight_state *s) {
    double across_m;
    along(&p->leg, s, &across_m);
    double course_rad = p->leg.yaw_rad - atan2(across_m, p->lookahead_m);
    flight_aim aim = {.yaw_rad = order->turns ? order->yaw_rad : crab(p->flight, course_rad),
                      .z_m = z_m};
    return p->model.derivative(p->flight, &aim, s);
}

flight_state asdic_flight_advance(const flight_state *s, const flight_state *d, double step_s) {
    return (flight_state){.x_m = s->x_m + step_s * d->x_m,
                          .y_m = s->y_m + step_s * d->y_m,
                          .z_m = s->z_m + step_s * d->z_m,
                          .pitch_rad = s->pitch_rad + step_s * d->pitch_rad,
                          .yaw_rad = s->yaw_rad + step_s * d->yaw_rad,
                          .surge_mps = s->surge_mps + step_s * d->surge_mps,
                          .sway_mps = s->sway_mps + step_s * d->sway_mps,
                          .heave_mps = s->heave_mps + step_s * d->heave_mps,
                          .pitch_rate = s->pitch_rate + step_s * d->pitch_rate,
                          .yaw_rate = s->yaw_rate + step_s * d->yaw_rate,
                          .rudder_rad = s->rudder_rad + step_s * d->rudder_rad,
                          .plane_rad = s->plane_rad + step_s * d->plane_rad};
}

/* To the line on which the vehicle is. */
static void find_line(asdic_pilot *p) {
    double across_m;
    while (!asdic_pilot_is_done(p) &&
           along(&p->leg, &p->state, &across_m) >= p->leg.length_m - p->leg.lead_m) {
        p->index++;
        if (!asdic_pilot_is_done(p)) {
            p->leg = find_leg(p->flight, p->index);
            p->leg.lead_m = find_lead_m(p, p->index, &p->leg);
        }
    }
}

bool asdic_pilot_is_done(const asdic_pilot *p) {
    return p->index + 1 >= p->flight->count;
}

/* By the midpoint rule, whose error is far below a centimetre at these steps. The depth of the
 * bottom is looked up once. */
void asdic_pilot_advance(asdic_pilot *p, const asdic_order *order, double step_s) {
    static const asdic_order nothing = {0};
    flight_state s = p->state;
    order = order ? order : &nothing;
    double part_s = step_s / p->model.substeps;
    double z_m = order->dives ? order->z_m : wanted_depth_m(p->flight, p->leg.z_m, s.x_m, s.y_m);
    for (unsigned i = 0; i < p->model.substeps; i++) {
        flight_state d = derivative(p, order, z_m, &s);
        flight_state middle = asdic_flight_advance(&s, &d, 0.5 * part_s);
        d = derivative(p, order, z_m, &middle);
        s = asdic_flight_advance(&s, &d, part_s);
    }
    s.z_m = fmax(s.z_m, 0.0); /* a vehicle does not fly */
    p->state = s;
    find_line(p);
}

static bool record(asdic_track *track, const flight_state *s, double time_s) {
    track_point point = {.time_s = time_s,
                         .x_m = s->x_m,
                         .y_m = s->y_m,
                         .z_m = s->z_m,
                         .pitch_rad = s->pitch_rad,
                         .yaw_rad = s->yaw_rad};
    return asdic_track_append(track, &point);
}

/* The waypoints at the beginning and end of a line, and the nearest that the vehicle came to them. */
typedef struct passage {
    const asdic_pilot *pilot;
    size_t index;              /* of the line */
    asdic_flight_miss near[2]; /* point 0: none that counts */
    double z_m[2];             /* to be flown there */
    asdic_flight_miss *most;
    double most_m; /* that it is more than let pass */
} passage;

/* The waypoint at the end of the line. */
static void look_ahead(passage *a) {
    const asdic_flight *f = a->pilot->flight;
    size_t point = a->index + 1 < f->count ? a->index + 1 : 0;
    const double *at_m = f->points_m + 3 * point;
    a->near[1] = (asdic_flight_miss){point, INFINITY, 0.0};
    a->z_m[1] = wanted_depth_m(f, at_m[2], at_m[0], at_m[1]);
}

/* The waypoint at the beginning of the line counts; the next line begins. */
static void end_line(passage *a) {
    const asdic_flight_miss *m = &a->near[0];
    bool is_last = m->point + 1 == a->pilot->flight->count;
    const flight_model *model = &a->pilot->model;
    double wide_m = 2.0 * model->turn_radius_m + a->pilot->flight->speed_mps * model->lag_s;
    double aside_m = m->aside_m - (is_last ? MOST_MISS_M : wide_m);
    double over_m = fmax(aside_m, fabs(m->deeper_m) - MOST_MISS_M);
    if (m->point > 0 && isfinite(over_m) && over_m > a->most_m) {
        *a->most = *m;
        a->most_m = over_m;
    }
    a->near[0] = a->near[1];
    a->z_m[0] = a->z_m[1];
    a->index++;
    look_ahead(a);
}

/* Where the vehicle is now, where that is nearer. */
static void note_passage(passage *a) {
    const flight_state *s = &a->pilot->state;
    while (a->index < a->pilot->index) {
        end_line(a);
    }
    for (size_t i = 0; i < 2; i++) {
        asdic_flight_miss *near = &a->near[i];
        const double *at_m = a->pilot->flight->points_m + 3 * near->point;
        double aside_m = hypot(s->x_m - at_m[0], s->y_m - at_m[1]), deeper_m = s->z_m - a->z_m[i];
        if (near->point > 0 && hypot(aside_m, deeper_m) < hypot(near->aside_m, near->deeper_m)) {
            near->aside_m = aside_m;
            near->deeper_m = deeper_m;
        }
    }
}

/* Longest time a leg may take: flown at a third of the speed over ground, with some full turns. */
static double patience_s(const asdic_pilot *p) {
    const asdic_flight *f = p->flight;
    const flight_leg *leg = &p->leg;
    double headway_mps = asdic_flight_headway_mps(f->speed_mps, f->current_mps, leg->yaw_rad, NULL);
    double turns_s = 4.0 * 2.0 * ASDIC_PI * p->model.turn_radius_m / f->speed_mps;
    return 3.0 * (leg->length_m / headway_mps + turns_s) + 100.0 * p->model.response_s;
}

static flight_state begin(const asdic_flight *f) {
    const double *start_m = f->points_m;
    return (flight_state){.x_m = start_m[0],
                          .y_m = start_m[1],
                          .z_m = wanted_depth_m(f, start_m[2], start_m[0], start_m[1]),
                          .yaw_rad = crab(f, find_leg(f, 0).yaw_rad),
                          .surge_mps = f->speed_mps};
}

void asdic_pilot_begin(asdic_pilot *p, const asdic_flight *flight) {
    *p = (asdic_pilot){.flight = flight,
                       .model = flight->vehicle == ASDIC_VEHICLE_REMUS100
                                    ? asdic_flight_model_remus100()
                                    : asdic_flight_model_nomoto(flight),
                       .state = begin(flight),
                       .leg = find_leg(flight, 0)};
    /* Heading turns at V / lookahead of what the vehicle is across, and lags: critically damped. No tighter than its circle. */
    p->lookahead_m = fmax(2.0 * p->model.turn_radius_m,
                          ASDIC_FLIGHT_DAMPING * flight->speed_mps * p->model.lag_s);
    p->leg.lead_m = find_lead_m(p, 0, &p->leg);
    find_line(p);
}

asdic_status asdic_flight_fly(asdic_context *ctx, const asdic_flight *flight, asdic_track **out,
                              asdic_flight_miss *miss) {
    asdic_status status = ASDIC_OK;
    asdic_pilot p;
    passage passed = {.pilot = &p, .most = miss};
    *miss = (asdic_flight_miss){0};
    asdic_pilot_begin(&p, flight);
    look_ahead(&passed);
    asdic_track *track = calloc(1, sizeof *track);
    size_t steps = 0, leg = flight->count;
    double late_s = 0.0;
    *out = NULL;
    if (!track || !record(track, &p.state, 0.0)) {
        status = asdic_fail_memory(ctx, "a track");
        goto fail;
    }
    while (!asdic_pilot_is_done(&p)) {
        if (p.index != leg) {
            leg = p.index;
            late_s = (double)steps * p.model.step_s + patience_s(&p);
        }
        asdic_pilot_advance(&p, NULL, p.model.step_s);
        note_passage(&passed);
        double time_s = (double)++steps * p.model.step_s;
        if (p.index == leg && (time_s > late_s || steps >= MAX_POINTS)) {
            status = asdic_fail(
                ctx, ASDIC_ERROR_INPUT, "waypoint %zu is not reached in %.6g s%s", leg + 1, time_s,
                time_s > late_s ? "; give a smaller turn radius or nearer waypoints"
                                : ", which is as long as a flight may be; fly faster, give "
                                  "nearer waypoints or a longer 'response_s'");
            goto fail;
        }
        if (!record(track, &p.state, time_s)) {
            status = asdic_fail_memory(ctx, "a track");
            goto fail;
        }
    }
    end_line(&passed);
    *out = track;
    track = NULL;
fail:
    asdic_track_destroy(&track);
    return status;
}
