#include "flight.h"

#include "../base/context.h"
#include "../base/vec.h"
#include "track_points.h"

#include <stdlib.h>

/* Points of a track: over five days at the usual steps of 0.1 s. */
#define MAX_POINTS 5000000

/* Critical damping of an integrator behind a first-order lag T asks for a gain of 1 / (4 T). */
#define DAMPING 4.0

typedef struct flight_state {
    double x_m, y_m, z_m;
    double yaw_rad, yaw_rate; /* rad, rad/s */
    double sink_mps;          /* positive down */
} flight_state;

/* The line from one waypoint to the next. */
typedef struct flight_leg {
    double x_m, y_m;    /* start */
    double north, east; /* unit vector */
    double length_m, yaw_rad;
    double z_m;    /* to be flown at */
    double lead_m; /* the turn into the next line begins this far before the end */
} flight_leg;

static double clamp(double x, double limit) {
    return fmin(fmax(x, -limit), limit);
}

static double wrap(double angle_rad) {
    return remainder(angle_rad, 2.0 * ASDIC_PI);
}

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

/* Where the turn from leg INDEX into the next begins: a circle that touches both lines does so at
 * R tan(half the turn) from the corner; the response takes some more. */
static double find_lead_m(const asdic_flight *flight, size_t index, const flight_leg *leg) {
    if (index + 2 >= flight->count) {
        return 0.0;
    }
    flight_leg next = find_leg(flight, index + 1);
    double half = 0.5 * fabs(wrap(next.yaw_rad - leg->yaw_rad));
    double arc_m = flight->turn_radius_m * fmin(tan(fmin(half, 1.5)), 2.0);
    double lag_m = half > 0.0 ? flight->speed_mps * flight->response_s : 0.0;
    return fmin(arc_m + lag_m, 0.5 * fmin(leg->length_m, next.length_m));
}

/* Distance flown along LEG, and across it to starboard. */
static double along(const flight_leg *leg, const flight_state *s, double *across_m) {
    double dx = s->x_m - leg->x_m, dy = s->y_m - leg->y_m;
    *across_m = dy * leg->north - dx * leg->east;
    return dx * leg->north + dy * leg->east;
}

static flight_state derivative(const asdic_flight *f, const flight_leg *leg,
                               const flight_state *s) {
    double slow_s = DAMPING * f->response_s, across_m;
    double forward_mps = sqrt(f->speed_mps * f->speed_mps - s->sink_mps * s->sink_mps);
    double most_yaw = forward_mps / f->turn_radius_m;
    /* The line must be approached slower than the heading is turned. */
    double lookahead_m = fmax(2.0 * f->turn_radius_m, 3.0 * f->speed_mps * slow_s);
    along(leg, s, &across_m);
    double aim_rad = leg->yaw_rad - atan2(across_m, lookahead_m);
    double yaw_command = clamp(wrap(aim_rad - s->yaw_rad) / slow_s, most_yaw);
    double sink_command = clamp((leg->z_m - s->z_m) / slow_s, f->dive_rate_mps);
    return (flight_state){.x_m = forward_mps * cos(s->yaw_rad),
                          .y_m = forward_mps * sin(s->yaw_rad),
                          .z_m = s->sink_mps,
                          .yaw_rad = s->yaw_rate,
                          .yaw_rate = (yaw_command - s->yaw_rate) / f->response_s,
                          .sink_mps = (sink_command - s->sink_mps) / f->response_s};
}

static flight_state advance(const flight_state *s, const flight_state *d, double step_s) {
    return (flight_state){s->x_m + step_s * d->x_m,           s->y_m + step_s * d->y_m,
                          s->z_m + step_s * d->z_m,           s->yaw_rad + step_s * d->yaw_rad,
                          s->yaw_rate + step_s * d->yaw_rate, s->sink_mps + step_s * d->sink_mps};
}

/* The midpoint rule: its error is far below the centimetre at the steps taken. */
static flight_state step(const asdic_flight *f, const flight_leg *leg, const flight_state *s,
                         double step_s) {
    flight_state d = derivative(f, leg, s);
    flight_state middle = advance(s, &d, 0.5 * step_s);
    d = derivative(f, leg, &middle);
    return advance(s, &d, step_s);
}

static bool record(asdic_track *track, const asdic_flight *f, const flight_state *s,
                   double time_s) {
    track_point point = {.time_s = time_s,
                         .x_m = s->x_m,
                         .y_m = s->y_m,
                         .z_m = s->z_m,
                         .pitch_rad = -asin(s->sink_mps / f->speed_mps),
                         .yaw_rad = s->yaw_rad};
    return asdic_track_append(track, &point);
}

/* Longest time a leg may take: flown at half the speed, with some full turns. */
static double patience_s(const asdic_flight *f, const flight_leg *leg) {
    double turns_s = 4.0 * 2.0 * ASDIC_PI * f->turn_radius_m / f->speed_mps;
    return 2.0 * leg->length_m / f->speed_mps + turns_s + 100.0 * f->response_s;
}

asdic_status asdic_flight_fly(asdic_context *ctx, const asdic_flight *flight, asdic_track **out) {
    asdic_status status = ASDIC_OK;
    double step_s = fmin(fmin(0.1, 0.05 * flight->response_s),
                         flight->turn_radius_m / (30.0 * flight->speed_mps));
    const double *start_m = flight->points_m;
    flight_state s = {.x_m = start_m[0],
                      .y_m = start_m[1],
                      .z_m = start_m[2],
                      .yaw_rad = find_leg(flight, 0).yaw_rad};
    asdic_track *track = calloc(1, sizeof *track);
    size_t steps = 0;
    *out = NULL;
    if (!track || !record(track, flight, &s, 0.0)) {
        status = asdic_fail_memory(ctx, "a track");
        goto fail;
    }
    for (size_t i = 0; i + 1 < flight->count; i++) {
        flight_leg leg = find_leg(flight, i);
        leg.lead_m = find_lead_m(flight, i, &leg);
        double late_s = (double)steps * step_s + patience_s(flight, &leg), across_m;
        while (along(&leg, &s, &across_m) < leg.length_m - leg.lead_m) {
            s = step(flight, &leg, &s, step_s);
            double time_s = (double)++steps * step_s;
            if (time_s > late_s || steps >= MAX_POINTS) {
                status = asdic_fail(ctx, ASDIC_ERROR_INPUT,
                                    "waypoint %zu is not reached in %.6g s; give a smaller "
                                    "turn radius or nearer waypoints",
                                    i + 1, time_s);
                goto fail;
            }
            if (!record(track, flight, &s, time_s)) {
                status = asdic_fail_memory(ctx, "a track");
                goto fail;
            }
        }
    }
    *out = track;
    track = NULL;
fail:
    asdic_track_destroy(&track);
    return status;
}
