#include "trial_run.h"

#include "trial_hazards.h"

#include "base/context.h"
#include "base/grow.h"
#include "base/try.h"
#include "base/vec.h"
#include "mission/track/flight.h"
#include "sim/variates.h"

#include "../../kernels/random.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* A run ends when its flight has taken this many times as long as without manoeuvres. */
#define PATIENCE 3.0
/* A vehicle that climbs stays this deep; one that is less deep keeps its depth. */
#define SHALLOWEST_M 0.5
/* A turn is done, and may be followed by another, within this of its heading. */
#define TURNED_RAD 0.1

/* Looked for beyond the hull, so that nothing at all is not taken for what touches it. */
#define HAIR_M 1e-9

#define MOST_PINGS 1000000
/* So near its end a run, or a manoeuvre, is over. */
#define INSTANT_S 1e-9
#define FASTEST_MPS 50.0
/* One that is slower than this gets nowhere. */
#define SLOWEST_MPS 0.01

/* What was flown up to a ping. */
typedef struct moment {
    asdic_pilot pilot;
    double time_s, way_m; /* from the beginning */
    bool gave_way;        /* on the way to it */
} moment;

typedef struct run {
    asdic_trial_run *out;
    double time_s, step_s;
    const asdic_trial_job *job;
    const asdic_trial_plan *plan;
    const asdic_mission *mission;
    asdic_context *ctx;
    asdic_hazards *hazards;
    asdic_pilot pilot;
    moment *moments; /* one a ping */
    size_t moment_count, moment_capacity;
    asdic_order order; /* zero: along the waypoints */
    bool gives_way;
    double until_s;
    uint64_t seen; /* a bit a ping, the last one lowest */
    size_t began;  /* ping at which the manoeuvre under way began */
    double side;   /* to which it turned then; 1: starboard */
    size_t met;    /* the part that was hit, as of asdic_nearest */
} run;

/* --- the way ----------------------------------------------------------------------------------- */

static asdic_vec3 position(const asdic_pilot *p) {
    return (asdic_vec3){p->state.x_m, p->state.y_m, p->state.z_m};
}

/* Flies P from *TIME_S, which becomes when it ends, for SECONDS by ORDER; the nearest that it came
 * to anything, at most WITHIN_M. Stops where that is ENOUGH_M or less, and past the last waypoint. Adds to *WAY_M
 * what it flew. */
static asdic_nearest fly(const run *r, asdic_pilot *p, const asdic_order *order, double *time_s,
                         double seconds, double within_m, double enough_m, double *way_m) {
    size_t steps = (size_t)ceil(seconds / p->model.step_s - 1e-9), i = 0;
    double step_s = seconds / (double)steps;
    asdic_nearest nearest = {within_m, ASDIC_NOTHING};
    do {
        asdic_vec3 from_m = position(p);
        double from_s = *time_s + (double)i * step_s;
        asdic_pilot_advance(p, order, step_s);
        asdic_nearest near = asdic_hazards_nearest(r->hazards, from_m, position(p), from_s,
                                                   from_s + step_s, nearest.distance_m);
        nearest = near.distance_m < nearest.distance_m ? near : nearest;
        *way_m += asdic_vec3_length(asdic_vec3_sub(position(p), from_m));
    } while (++i < steps && nearest.distance_m > enough_m && !asdic_pilot_is_done(p));
    *time_s += i < steps ? (double)i * step_s : seconds;
    return nearest;
}

/* Whether a copy of FROM that flies by ORDER for DISTANCE_M from TIME_S comes within the hull's radius of something; if
 * IS_NEAR, of something that is no farther off at TIME_S: what comes may be far beyond as yet. */
static bool would_hit(const run *r, const asdic_pilot *from, double time_s,
                      const asdic_order *order, double distance_m, bool is_near) {
    asdic_pilot p = *from;
    const asdic_way look = {position(&p),
                            asdic_vec3_add(position(&p), (asdic_vec3){1.0, 0.0, 0.0})};
    double hull_m = r->plan->hull_radius_m, begin_s = time_s,
           end_s = time_s + distance_m / SLOWEST_MPS;
    /* The last step may go beyond the distance; no vehicle here does so at more than this. */
    double most_m = distance_m + FASTEST_MPS * p.model.step_s + hull_m;
    if (!asdic_hazards_move(r->hazards) &&
        asdic_hazards_nearest(r->hazards, position(&p), position(&p), time_s, time_s, most_m)
                .distance_m >= most_m) {
        return false;
    }
    for (double flown_m = 0.0; flown_m < distance_m && time_s < end_s;) {
        asdic_nearest near =
            fly(r, &p, order, &time_s, p.model.step_s, hull_m + HAIR_M, hull_m, &flown_m);
        if (near.distance_m <= hull_m &&
            (!is_near || near.part == ASDIC_NOTHING ||
             isfinite(asdic_hazards_ahead(r->hazards, near.part, &look, begin_s, ASDIC_PI,
                                          fmax(distance_m, flown_m) + hull_m + HAIR_M)))) {
            return true;
        }
        if (!order && asdic_pilot_is_done(&p)) {
            return false;
        }
    }
    return false;
}

/* Whether holding on along the waypoints would hit something within the rule's reach; IS_NEAR as above. */
static bool is_something_ahead(const run *r, bool is_near) {
    double bin_m = r->mission->settings.sonar.bin_length_m;
    return would_hit(r, &r->pilot, r->time_s, NULL,
                     r->plan->reach_m + bin_m + r->plan->hull_radius_m, is_near);
}

/* --- the rule ---------------------------------------------------------------------------------- */

/* Climb, or turn to the side that SIDE says (1: starboard). */
static asdic_order manoeuvre(const asdic_trial_plan *plan, const flight_state *s, double side) {
    if (plan->manoeuvre == ASDIC_CLIMB) {
        double z_m = fmax(s->z_m - plan->climb_m, SHALLOWEST_M);
        return (asdic_order){.dives = true, .z_m = fmin(z_m, s->z_m)};
    }
    return (asdic_order){.turns = true, .yaw_rad = s->yaw_rad + side * plan->turn_rad};
}

/* Begins, prolongs or ends the manoeuvre of a ping that FIRES, with something on that SIDE. */
static void apply_rule(run *r, bool fires, double side) {
    const asdic_trial_plan *plan = r->plan;
    const flight_state *s = &r->pilot.state;
    r->seen = r->seen << 1 | fires;
    uint64_t window = plan->of >= 64 ? r->seen : r->seen & (((uint64_t)1 << plan->of) - 1);
    bool is_enough = fires && (unsigned)__builtin_popcountll(window) >= plan->hits;
    if (!is_enough || plan->manoeuvre == ASDIC_HOLD) {
        if (r->gives_way && r->time_s > r->until_s - INSTANT_S) {
            r->gives_way = false;
            r->order = (asdic_order){0};
        }
        return;
    }
    asdic_order next = manoeuvre(plan, s, -side);
    if (!r->gives_way) {
        r->order = next;
        r->side = -side;
    } else if (plan->manoeuvre == ASDIC_CLIMB) {
        r->order.z_m = fmin(r->order.z_m, next.z_m);
    } else if (fabs(remainder(r->order.yaw_rad - s->yaw_rad, 2.0 * ASDIC_PI)) < TURNED_RAD) {
        r->order = next;
    }
    r->gives_way = true;
    r->until_s = r->time_s + plan->hold_s;
}

/* Whether a detection of the ping counts; SIDE becomes that of the likeliest. */
static bool sees(const run *r, const asdic_loop_ping *ping, const asdic_scan_result *found,
                 double *side) {
    const asdic_trial_plan *plan = r->plan;
    const asdic_sonar *sonar = &r->mission->settings.sonar;
    const asdic_pose level = {.yaw_rad = 0.0};
    asdic_pose head = asdic_sweep_sonar(&r->mission->settings.sweep, &level, ping->ping);
    double best = -INFINITY, prior = r->mission->settings.detector.prior;
    for (size_t b = 0; b < ping->beams; b++) {
        asdic_vec3 axis = asdic_beam_axis(&sonar->receivers[b], &head);
        double off_bow_rad = acos(fmin(fmax(axis.x, -1.0), 1.0));
        if (off_bow_rad > plan->sector_rad + 1e-9) {
            continue;
        }
        for (size_t n = 0; n < ping->bins; n++) {
            size_t i = b * ping->bins + n;
            double range_m = ((double)n + 0.5) * ping->bin_length_m;
            if (range_m > plan->reach_m) {
                break;
            }
            if (ping->parts->intensity_lin[ASDIC_TOTAL][i] > found->threshold_lin[i] &&
                found->llr[i] > best &&
                asdic_detect_posterior(found->llr[i], prior) >= plan->posterior) {
                best = found->llr[i];
                *side = axis.y > 1e-6 ? 1.0 : -1.0;
            }
        }
    }
    return best > -INFINITY;
}

/* What a sonar of given probabilities says. */
static bool ideal_sees(const run *r, size_t ping) {
    asdic_variates v =
        asdic_variates_begin(RANDOM_TRIAL, r->job->seed, r->job->run, (uint32_t)ping);
    double u = asdic_variates_uniform(&v);
    bool where_something = u < r->plan->pd, where_nothing = u < r->plan->pfa;
    /* What is ahead is flown to only where it matters. */
    return where_something == where_nothing ? where_nothing
           : is_something_ahead(r, true)    ? where_something
                                            : where_nothing;
}

/* --- a ping ------------------------------------------------------------------------------------ */

static asdic_pose pose_of(const flight_state *s) {
    return (asdic_pose){
        .position_m = {s->x_m, s->y_m, s->z_m}, .pitch_rad = s->pitch_rad, .yaw_rad = s->yaw_rad};
}

static asdic_status keep_moment(run *r) {
    if (!asdic_grow(&r->moments, r->moment_count, &r->moment_capacity, sizeof *r->moments)) {
        return asdic_fail_memory(r->ctx, "a run of a trial");
    }
    r->moments[r->moment_count++] = (moment){r->pilot, r->time_s, r->out->distance_m, r->gives_way};
    if (r->job->track) {
        asdic_pose pose = pose_of(&r->pilot.state);
        track_point point = {.time_s = r->time_s,
                             .x_m = pose.position_m.x,
                             .y_m = pose.position_m.y,
                             .z_m = pose.position_m.z,
                             .pitch_rad = asdic_track_round(pose.pitch_rad),
                             .yaw_rad = asdic_track_round(pose.yaw_rad)};
        if (!asdic_track_append(r->job->track, &point)) {
            return asdic_fail_memory(r->ctx, "a track");
        }
    }
    return ASDIC_OK;
}

/* Lets the other program decide. */
static bool ask(run *r, const asdic_loop_ping *ping, const asdic_scan_result *found, char *why) {
    const asdic_trial_look look = {r->job->worker, r->job->run, &r->mission->settings.sonar, ping,
                                   found};
    asdic_trial_order order = {0};
    why[0] = '\0';
    if (!r->job->rule->decide(r->job->rule->user, &look, &order, why)) {
        return false;
    }
    r->gives_way = order.turns || order.dives;
    r->order = (asdic_order){order.turns, order.dives, order.yaw_rad, order.z_m};
    return true;
}

/* Pings, and decides. */
static asdic_status ping(run *r, asdic_eye *eye, char *why) {
    bool gave_way = r->gives_way;
    double side = -1.0;
    if (r->plan->is_ideal) {
        apply_rule(r, ideal_sees(r, r->out->pings), side);
    } else {
        asdic_loop_ping seen;
        asdic_scan_result found;
        asdic_pose pose = pose_of(&r->pilot.state);
        TRY(asdic_eye_look(eye, &pose, &seen, &found));
        if (!r->job->rule) {
            bool fires = sees(r, &seen, &found, &side);
            apply_rule(r, fires, side);
        } else if (!ask(r, &seen, &found, why)) {
            r->out->outcome = ASDIC_TRIAL_BROKEN;
        }
    }
    if (r->gives_way && !gave_way) {
        r->began = r->out->pings;
        r->out->manoeuvres++;
        r->out->needless += !is_something_ahead(r, false);
    }
    r->out->pings++;
    return ASDIC_OK;
}

/* --- the whole --------------------------------------------------------------------------------- */

static void name_part(const run *r, size_t part, char out[ASDIC_NAME_SIZE]) {
    const asdic_scene *scene = r->mission->scene;
    const char *name = part == ASDIC_NOTHING       ? ""
                       : part >= scene->part_count ? scene->points[part - scene->part_count].name
                                                   : scene->parts[part].name;
    snprintf(out, ASDIC_NAME_SIZE, "%s", *name ? name : "bottom");
}

/* From the vehicle at MOMENT to the nearest surface of what it hit that was in the rule's sector then, and nearer than
 * WITHIN_M; INFINITY: none. The bottom is always below: of it the place where it was hit counts. */
static double range_m(const run *r, const moment *then, double within_m) {
    const asdic_scene *scene = r->mission->scene;
    const flight_state *s = &then->pilot.state;
    asdic_vec3 at_m = position(&then->pilot);
    asdic_vec3 bow = {cos(s->yaw_rad) * cos(s->pitch_rad), sin(s->yaw_rad) * cos(s->pitch_rad),
                      -sin(s->pitch_rad)};
    bool is_bottom = r->met == ASDIC_NOTHING ||
                     (r->met < scene->part_count && scene->parts[r->met].kind != DEV_KIND_OBJECT);
    if (is_bottom) {
        return asdic_vec3_length(asdic_vec3_sub(position(&r->pilot), at_m));
    }
    const asdic_way look = {at_m, asdic_vec3_add(at_m, bow)};
    return asdic_hazards_ahead(r->hazards, r->met, &look, then->time_s, r->plan->sector_rad,
                               within_m);
}

/* When what was hit came into the rule's reach and sector, since the last manoeuvre; or, if it was not there yet, when
 * the manoeuvre under way began. */
static moment first_in_reach(const run *r) {
    double reach_m = r->plan->reach_m, more_m = reach_m + HAIR_M,
           began_s = r->moments[r->began].time_s;
    size_t i = r->began;
    while (i > 0 && !r->moments[i].gave_way && range_m(r, &r->moments[i], more_m) <= reach_m) {
        i--;
    }
    moment at = r->moments[i];
    double step_s = at.pilot.model.step_s;
    while (at.time_s + step_s < began_s + INSTANT_S && range_m(r, &at, more_m) > reach_m) {
        asdic_pilot_advance(&at.pilot, NULL, step_s);
        at.time_s += step_s;
    }
    return at;
}

/* Why it was hit, seen from where the rule could have acted first. */
static void find_cause(run *r) {
    asdic_trial_run *out = r->out;
    if (!r->gives_way) {
        out->cause = ASDIC_TRIAL_NOT_SEEN;
        return;
    }
    double seen_m = range_m(r, &r->moments[r->began], INFINITY);
    out->seen_m = isinf(seen_m) ? NAN : seen_m;
    const moment from = first_in_reach(r);
    asdic_order order = r->order;
    if (!r->job->rule) { /* the same manoeuvre, from there */
        order = manoeuvre(r->plan, &from.pilot.state, r->side);
    }
    double straight_m =
        asdic_vec3_length(asdic_vec3_sub(position(&from.pilot), position(&r->pilot)));
    /* Of one that turned round, farther than straight on. */
    double way_m = fmax(1.5 * straight_m, 1.1 * (out->distance_m - from.way_m));
    out->cause = would_hit(r, &from.pilot, from.time_s, &order, way_m, false)
                     ? ASDIC_TRIAL_COULD_NOT_TURN
                     : ASDIC_TRIAL_SEEN_LATE;
}

/* To the next ping, or to where or when the run ends. */
static void go_on(run *r, double end_s) {
    asdic_trial_run *out = r->out;
    double hull_m = r->plan->hull_radius_m, seconds = fmin(r->step_s, end_s - r->time_s);
    asdic_nearest near = fly(r, &r->pilot, r->gives_way ? &r->order : NULL, &r->time_s, seconds,
                             out->clearance_m + hull_m, hull_m, &out->distance_m);
    out->clearance_m = fmax(near.distance_m - hull_m, 0.0);
    if (near.distance_m <= hull_m) {
        out->outcome = ASDIC_TRIAL_HIT;
        r->met = near.part;
        name_part(r, near.part, out->what);
    }
}

/* Whether the run can begin where it is drawn to begin. */
static bool begins_well(run *r, char *why) {
    asdic_trial_run *out = r->out;
    asdic_vec3 at_m = position(&r->pilot);
    size_t part = ASDIC_NOTHING;
    double hull_m = r->plan->hull_radius_m;
    asdic_nearest near = asdic_hazards_nearest(r->hazards, at_m, at_m, 0.0, 0.0, INFINITY);
    bool is_inside = asdic_hazards_hold(r->hazards, at_m, &part);
    bool is_below = at_m.z > asdic_mission_bottom_m(r->mission->scene, at_m);
    if (!is_inside && !is_below && near.distance_m > hull_m) {
        out->clearance_m = near.distance_m - hull_m;
        return true;
    }
    out->outcome = ASDIC_TRIAL_VOID;
    name_part(r, is_inside ? part : is_below ? ASDIC_NOTHING : near.part, out->what);
    snprintf(why, ASDIC_TRIAL_WHY, "the vehicle begins at %.4g, %.4g, %.4g m, in '%s'", at_m.x,
             at_m.y, at_m.z, out->what);
    return false;
}

static asdic_status fly_all(run *r, asdic_eye *eye, char *why) {
    const asdic_mission *m = r->mission;
    double end_s =
        isnan(r->plan->time_s) ? PATIENCE * asdic_track_end_s(m->track) : r->plan->time_s;
    asdic_trial_run *out = r->out;
    for (;;) {
        r->time_s = (double)out->pings * r->step_s;
        TRY(keep_moment(r));
        TRY(ping(r, eye, why));
        if (out->outcome == ASDIC_TRIAL_BROKEN) {
            return ASDIC_OK;
        }
        go_on(r, end_s);
        if (out->outcome == ASDIC_TRIAL_HIT) {
            find_cause(r);
            return ASDIC_OK;
        }
        if (asdic_pilot_is_done(&r->pilot)) {
            return ASDIC_OK;
        }
        if (r->time_s > end_s - INSTANT_S || out->pings == MOST_PINGS) {
            out->outcome = ASDIC_TRIAL_LATE;
            return ASDIC_OK;
        }
        if (asdic_context_interrupted(r->ctx)) {
            return asdic_fail(r->ctx, ASDIC_ERROR_INTERRUPTED, "interrupted");
        }
    }
}

asdic_status asdic_trial_run_one(asdic_eye *eye, const asdic_trial_job *job, asdic_trial_run *out,
                                 char why[ASDIC_TRIAL_WHY]) {
    const asdic_mission *m = job->mission;
    run r = {.job = job,
             .plan = &m->trial,
             .mission = m,
             .ctx = m->ctx,
             .step_s = 1.0 / m->settings.sonar.ping_rate_hz,
             .out = out};
    *out = (asdic_trial_run){.outcome = ASDIC_TRIAL_CLEAR, .seen_m = NAN, .clearance_m = INFINITY};
    why[0] = '\0';
    if (!m->points_m) {
        return asdic_fail(r.ctx, ASDIC_ERROR_INPUT,
                          "%s: a trial flies along 'mission: {waypoints: ...}'; there are none",
                          m->path);
    }
    TRY(asdic_hazards_create(m, &r.hazards));
    asdic_status status = ASDIC_OK;
    asdic_pilot_begin(&r.pilot, &m->flight);
    if (begins_well(&r, why)) {
        double reach_m = job->rule ? INFINITY : m->trial.reach_m;
        status = m->trial.is_ideal ? ASDIC_OK : asdic_eye_open(eye, m, r.pilot.state.z_m, reach_m);
        status = status ? status : fly_all(&r, eye, why);
        out->time_s = r.time_s;
        asdic_eye_close(eye);
    }
    asdic_hazards_destroy(&r.hazards);
    free(r.moments);
    return status;
}
