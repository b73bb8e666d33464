/*
 * Nearest-neighbour tracking with Kalman filters (Bar-Shalom & Li, Estimation and Tracking, 1993):
 * state (north, east, their rates), white-noise acceleration, plots as measured positions.
 */
#include <asdic/scan.h>

#include "base/context.h"
#include "base/grow.h"
#include "base/try.h"
#include "kalman.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

typedef struct track {
    asdic_track_state state;
    asdic_kalman filter;
    uint32_t history; /* bit 0: the last ping hit */
    unsigned missed;  /* pings since the last hit */
} track;

/* A track and a plot in its gate. */
typedef struct pair {
    double distance2;
    size_t track, plot;
} pair;

struct asdic_tracker {
    asdic_context *ctx;
    asdic_tracker_options options;
    track *tracks;
    asdic_track_state *states; /* copies, for asdic_tracker_get */
    pair *pairs;
    bool *taken; /* plots */
    size_t count, capacity, state_capacity, pair_capacity, plot_capacity;
    unsigned next_id;
    double time_s;
};

asdic_tracker_options asdic_tracker_options_default(void) {
    return (asdic_tracker_options){
        .gate = 9.21, .acceleration = 0.01, .speed_mps = 0.5, .confirm = 3, .of = 5, .misses = 5};
}

asdic_status asdic_tracker_create(asdic_context *ctx, const asdic_tracker_options *options,
                                  asdic_tracker **out) {
    if (!ASDIC_PLACE(out) || !options) {
        return asdic_fail_null(ctx, __func__);
    }
    if (!(options->gate > 0.0) || !(options->acceleration >= 0.0) || !(options->speed_mps > 0.0) ||
        options->confirm < 1 || options->confirm > options->of || options->of > 32 ||
        options->misses < 1) {
        return asdic_fail(
            ctx, ASDIC_ERROR_ARGUMENT,
            "a tracker with gate %g, acceleration %g m^2/s^3, speed %g m/s, %u hits of "
            "%u pings (at most 32), %u misses",
            options->gate, options->acceleration, options->speed_mps, options->confirm, options->of,
            options->misses);
    }
    asdic_tracker *t = calloc(1, sizeof *t);
    if (!t) {
        return asdic_fail_memory(ctx, "a tracker");
    }
    t->ctx = ctx;
    t->options = *options;
    t->next_id = 1;
    t->time_s = NAN;
    *out = t;
    return ASDIC_OK;
}

void asdic_tracker_destroy(asdic_tracker **tracker) {
    if (tracker && *tracker) {
        free((*tracker)->tracks);
        free((*tracker)->states);
        free((*tracker)->pairs);
        free((*tracker)->taken);
        free(*tracker);
        *tracker = NULL;
    }
}

static int nearer(const void *a, const void *b) {
    const pair *x = a, *y = b;
    if (x->distance2 != y->distance2) {
        return x->distance2 < y->distance2 ? -1 : 1;
    }
    if (x->track != y->track) { /* no order is left to chance */
        return x->track < y->track ? -1 : 1;
    }
    return x->plot < y->plot ? -1 : x->plot > y->plot;
}

/* One that is nowhere, or known exactly, would leave its track nowhere for good. */
static asdic_status check_plots(asdic_context *ctx, const asdic_plot_point *plots, size_t count) {
    for (size_t i = 0; i < count; i++) {
        const asdic_plot_point *p = &plots[i];
        double product = p->variance_nn_m2 * p->variance_ee_m2;
        bool is_positive = p->variance_nn_m2 > 0.0 && p->variance_ee_m2 > 0.0 &&
                           p->variance_ne_m2 * p->variance_ne_m2 <= product * (1.0 + 1e-9);
        if (!isfinite(p->north_m) || !isfinite(p->east_m) || !isfinite(product) || !is_positive) {
            return asdic_fail(
                ctx, ASDIC_ERROR_ARGUMENT,
                "plot %zu at (%g, %g) m with the covariance (%g, %g, %g) m^2: it must "
                "be finite, its covariance above 0",
                i, p->north_m, p->east_m, p->variance_nn_m2, p->variance_ne_m2, p->variance_ee_m2);
        }
    }
    return ASDIC_OK;
}

static bool find_pairs(asdic_tracker *t, const asdic_plot_point *plots, size_t count,
                       size_t *pairs) {
    *pairs = 0;
    for (size_t i = 0; i < t->count; i++) {
        for (size_t k = 0; k < count; k++) {
            double distance2 = asdic_kalman_distance2(&t->tracks[i].filter, &plots[k]);
            if (distance2 > t->options.gate) {
                continue;
            }
            if (!asdic_grow(&t->pairs, *pairs, &t->pair_capacity, sizeof *t->pairs)) {
                return false;
            }
            t->pairs[(*pairs)++] = (pair){distance2, i, k};
        }
    }
    if (*pairs) {
        qsort(t->pairs, *pairs, sizeof *t->pairs, nearer);
    }
    return true;
}

static void hit(track *tr, const asdic_plot_point *plot) {
    asdic_kalman_update(&tr->filter, plot);
    tr->state.hit = true;
    tr->state.hits++;
    tr->state.label = plot->label;
    tr->history |= 1u;
    tr->missed = 0;
}

static void found(asdic_tracker *t, const asdic_plot_point *plot) {
    track *tr = &t->tracks[t->count++];
    *tr = (track){.state = {.id = t->next_id++, .hit = true, .hits = 1, .label = plot->label},
                  .filter = asdic_kalman_begin(plot, t->options.speed_mps),
                  .history = 1u};
}

/* Confirms; false when the track is to be dropped. A tentative one must be hit OF pings long. */
static bool judge(track *tr, const asdic_tracker_options *o) {
    uint32_t window = o->of == 32 ? 0xffffffffu : (1u << o->of) - 1u;
    unsigned hits = (unsigned)__builtin_popcount(tr->history & window);
    tr->state.age++;
    tr->state.confirmed |= hits >= o->confirm;
    if (!tr->state.confirmed) { /* what can still come is not enough */
        unsigned left = tr->state.age < o->of ? o->of - tr->state.age : 0;
        return hits + left >= o->confirm && tr->missed <= o->misses;
    }
    return tr->missed < o->misses;
}

static void show(asdic_tracker *t) {
    for (size_t i = 0; i < t->count; i++) {
        const asdic_kalman *f = &t->tracks[i].filter;
        asdic_track_state *s = &t->tracks[i].state;
        s->north_m = f->mean[0][0];
        s->north_mps = f->mean[0][1];
        s->east_m = f->mean[1][0];
        s->east_mps = f->mean[1][1];
        s->sd_north_m = sqrt(f->covariance[0][0]);
        s->sd_east_m = sqrt(f->covariance[2][2]);
        t->states[i] = *s;
    }
}

asdic_status asdic_tracker_update(asdic_tracker *t, double time_s, const asdic_plot_point *plots,
                                  size_t count) {
    if (!t || (!plots && count > 0)) {
        return asdic_fail_null(t ? t->ctx : NULL, __func__);
    }
    size_t pairs = 0, kept = 0;
    double step_s = isnan(t->time_s) ? 0.0 : time_s - t->time_s;
    if (!(step_s >= 0.0) || !isfinite(time_s)) {
        return asdic_fail(t->ctx, ASDIC_ERROR_ARGUMENT, "a ping at %g s after one at %g s", time_s,
                          t->time_s);
    }
    TRY(check_plots(t->ctx, plots, count));
    if (!asdic_reserve(&t->tracks, t->count + count, &t->capacity, sizeof *t->tracks) ||
        !asdic_reserve(&t->states, t->count + count, &t->state_capacity, sizeof *t->states) ||
        !asdic_reserve(&t->taken, count, &t->plot_capacity, sizeof *t->taken)) {
        return asdic_fail_memory(t->ctx, "tracks");
    }
    t->time_s = time_s;
    for (size_t i = 0; i < t->count; i++) {
        asdic_kalman_predict(&t->tracks[i].filter, step_s, t->options.acceleration);
    }
    if (!find_pairs(t, plots, count, &pairs)) { /* the ping may come again, after no time */
        return asdic_fail_memory(t->ctx, "tracks");
    }
    for (size_t i = 0; i < t->count; i++) {
        track *tr = &t->tracks[i];
        tr->state.hit = false;
        tr->history <<= 1;
        tr->missed++;
    }
    for (size_t k = 0; k < count; k++) {
        t->taken[k] = false;
    }
    for (size_t i = 0; i < pairs; i++) {
        track *tr = &t->tracks[t->pairs[i].track];
        if (!tr->state.hit && !t->taken[t->pairs[i].plot]) {
            hit(tr, &plots[t->pairs[i].plot]);
            t->taken[t->pairs[i].plot] = true;
        }
    }
    for (size_t k = 0; k < count; k++) {
        if (!t->taken[k]) {
            found(t, &plots[k]);
        }
    }
    for (size_t i = 0; i < t->count; i++) {
        if (judge(&t->tracks[i], &t->options)) {
            t->tracks[kept++] = t->tracks[i];
        }
    }
    t->count = kept;
    show(t);
    return ASDIC_OK;
}

const asdic_track_state *asdic_tracker_get(const asdic_tracker *tracker, size_t *count) {
    if (count) {
        *count = tracker ? tracker->count : 0;
    }
    return tracker ? tracker->states : NULL;
}

/* Ways to go on that are less likely are left out, more of them where there are very many; a
 * confirmed track that lives on by clutter has so many hits at most; rounds until tracks are as
 * dense as they make each other. */
#define LEAST_WEIGHT(of) ((of) > 10 ? 1e-3 : 1e-6)
#define MOST_HITS 1000.0
#define ROUNDS 12
/* Gates that are remembered from round to round: more than a track of five pings can have. */
#define MOST_GATES 64
/* Of more lines than this, evenly chosen ones stand for all tracks: pairs of 512 would take seconds. */
#define MOST_OWN 64

/* What the gate of a track of these variances holds of the lines, and how far aside of it that is on the mean. */
typedef struct gate {
    double along_m2, across_m2, turned_m, covered_m, aside_m;
} gate;

/* The clutter, and the fate of a track that begins with it. */
typedef struct clutter {
    const asdic_tracker_options *options;
    double step_s, plots_per_m, tracks_per_m; /* of each line */
    const double *east_m;                     /* of the lines, ascending, at PLANE_M */
    double plane_m;                           /* from where they meet */
    double turn_m;                            /* by which lines are farther round at each ping */
    size_t lines, gates;
    gate gate[MOST_GATES];
    asdic_plot_point plot;
    double confirmed, hits, pings; /* means: probability, further plots it takes, pings it lives */
} clutter;

/* What the gate of a track on one line holds of another, APART_M to its side: the track's covariance and a plot's, which
 * lies across its own line, together. A line R + r u is inside where (R + r u)' S^-1 (R + r u) is the gate at most. */
static double chord_m(const clutter *c, const asdic_kalman *f, double apart_m) {
    double turn = apart_m / c->plane_m, u = cos(turn), v = sin(turn);
    double along2 = c->plot.variance_nn_m2, across2 = c->plot.variance_ee_m2;
    double nn = f->covariance[0][0] + along2 * u * u + across2 * v * v;
    double ee = f->covariance[2][2] + along2 * v * v + across2 * u * u;
    double ne = (along2 - across2) * u * v, determinant = nn * ee - ne * ne;
    double north = isinf(c->plane_m) ? 0.0 : c->plane_m * (u - 1.0);
    double east = isinf(c->plane_m) ? apart_m : c->plane_m * v;
    double uu = (ee * u * u - 2.0 * ne * u * v + nn * v * v) / determinant;
    double ur = (ee * u * north - ne * (u * east + v * north) + nn * v * east) / determinant;
    double rr = (ee * north * north - 2.0 * ne * north * east + nn * east * east) / determinant;
    return 2.0 * sqrt(fmax(ur * ur - uu * (rr - c->options->gate), 0.0)) / uu;
}

/* What a track's gate holds of all lines, which are TURNED_M farther round than the track; on the mean of tracks on
 * each. Rounds ask for the same gates again. */
static gate covered(clutter *c, const asdic_kalman *f, double turned_m) {
    gate g = {f->covariance[0][0], f->covariance[2][2], turned_m, 0.0, 0.0};
    for (size_t i = 0; i < c->gates; i++) {
        const gate *known = &c->gate[i];
        if (known->along_m2 == g.along_m2 && known->across_m2 == g.across_m2 &&
            known->turned_m == turned_m) {
            return *known;
        }
    }
    double most_m2 = g.along_m2 + g.across_m2 + c->plot.variance_nn_m2 + c->plot.variance_ee_m2;
    double reach_m = 0.5 * M_PI * sqrt(c->options->gate * most_m2); /* along an arc */
    double aside_m2 = 0.0;
    size_t own = c->lines < MOST_OWN ? c->lines : MOST_OWN;
    for (size_t i = 0, first = 0; i < own; i++) {
        double own_m = c->east_m[(2 * i + 1) * c->lines / (2 * own)] - turned_m;
        while (first < c->lines && c->east_m[first] <= own_m - reach_m) {
            first++;
        }
        for (size_t k = first; k < c->lines && c->east_m[k] < own_m + reach_m; k++) {
            double chord = chord_m(c, f, c->east_m[k] - own_m);
            g.covered_m += chord / (double)own;
            aside_m2 += chord / (double)own * (c->east_m[k] - own_m);
        }
    }
    g.aside_m = g.covered_m > 0.0 ? aside_m2 / g.covered_m : 0.0;
    if (c->gates < MOST_GATES) {
        c->gate[c->gates++] = g;
    }
    return g;
}

/* A track that has come so far with probability WEIGHT: the next ping, with and without a plot
 * in its gate. Of tracks that have a plot in their gates, one gets it. */
static void follow(clutter *c, track tr, double weight) {
    const asdic_tracker_options *o = c->options;
    asdic_kalman_predict(&tr.filter, c->step_s, o->acceleration);
    tr.history <<= 1;
    tr.missed++;
    double turned_m = tr.state.age * c->turn_m - (tr.filter.mean[1][0] - c->plot.east_m);
    const gate g = covered(c, &tr.filter, turned_m);
    double rivals = fmax(c->tracks_per_m * g.covered_m, 1e-9);
    double p = -expm1(c->plots_per_m * g.covered_m * expm1(-rivals) / rivals);
    c->pings += weight;
    for (int is_hit = 0; is_hit < 2; is_hit++) {
        track next = tr;
        double then = weight * (is_hit ? p : 1.0 - p);
        if (is_hit) {
            asdic_plot_point plot = c->plot;
            plot.north_m = tr.filter.mean[0][0];
            plot.east_m = tr.filter.mean[1][0] + g.aside_m;
            hit(&next, &plot);
            c->hits += then;
        }
        bool lives = judge(&next, o);
        if (next.state.confirmed) { /* until it is missed so often in a row */
            double further = fmin(pow(1.0 - p, -(double)o->misses) - 1.0, MOST_HITS);
            c->confirmed += then;
            c->hits += then * further;
            c->pings += then * further / p;
        } else if (lives && then > LEAST_WEIGHT(o->of)) {
            follow(c, next, then);
        }
    }
}

double asdic_tracker_false_share(const asdic_tracker_options *options, double step_s,
                                 const asdic_plot_point *plot, double plots_per_m,
                                 const double *east_m, size_t lines, double plane_m,
                                 double turn_rad) {
    clutter c = {.options = options,
                 .step_s = step_s,
                 .plots_per_m = plots_per_m,
                 .east_m = east_m,
                 .lines = lines,
                 .plane_m = plane_m,
                 .turn_m = isinf(plane_m) ? 0.0 : fabs(turn_rad) * plane_m,
                 .plot = *plot};
    for (int i = 0; i < ROUNDS; i++) {
        track tr = {.state = {.hits = 1},
                    .filter = asdic_kalman_begin(plot, options->speed_mps),
                    .history = 1u};
        c.confirmed = c.hits = c.pings = 0.0;
        judge(&tr, options);
        if (tr.state.confirmed) {
            return 1.0;
        }
        follow(&c, tr, 1.0);
        c.tracks_per_m += 0.5 * (plots_per_m / (1.0 + c.hits) * c.pings - c.tracks_per_m);
    }
    return c.confirmed / (1.0 + c.hits);
}
