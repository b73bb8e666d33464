/*
 * The number of false tracks to expect: from false alarms of the designed probability, or of a larger
 * one that is predicted or, over neighbours, was found; as many to a plot as were found, with plots
 * anywhere in range on the beams' axes, by the tracker's rule.
 */
#include "detect_job.h"

#include "base/context.h"
#include "base/sort.h"
#include "base/try.h"
#include "base/vec.h"

#include <math.h>
#include <stdlib.h>

/* Intervals of range, each longer than the one before by the same factor: most false tracks are
 * near. */
#define RANGES 64
/* Beams steeper than this (84 degrees) have all their plots on one spot. */
#define LEAST_COS 0.1
/* Parts of a run by how fast the vehicle turns, of which one ping each is looked at. */
#define SHARES 4
#define ALIKE_RAD 1e-4

/* From the bearing before to bearing B, of sorted ones round the circle. */
static double gap_before(const double *bearing, size_t beams, size_t b) {
    return b > 0 ? bearing[b] - bearing[b - 1] : bearing[0] - bearing[beams - 1] + 2.0 * ASDIC_PI;
}

/* The bearing that the widest gap leads to; between those like it the first. */
static size_t widest_gap(const double *bearing, size_t beams) {
    size_t widest = 0;
    for (size_t b = 1; b < beams; b++) {
        bool is_wider = gap_before(bearing, beams, b) > gap_before(bearing, beams, widest);
        widest = is_wider ? b : widest;
    }
    return widest;
}

/* Where the plots of all beams are that are not too steep. */
typedef struct axes {
    size_t beams;
    double width_rad;     /* of a beam, on average */
    double *bearing_rad;  /* ascending, twice round the circle */
    size_t first;         /* of these, behind the widest gap */
    double *east_m;       /* room for as many beams */
    double near_m, far_m; /* in the plane */
} axes;

/* Where false plots of BEAM lie in the plane; false where that is one spot, which is one track at most. */
static bool find_reach(const asdic_detect_job *job, const asdic_pose *pose, size_t beam,
                       double *near_m, double *far_m) {
    const asdic_sonar *sonar = job->info.sonar;
    asdic_vec3 axis = asdic_beam_axis(&sonar->receivers[beam], pose);
    double level = hypot(axis.x, axis.y), range_m = (double)job->info.bins * sonar->bin_length_m;
    *far_m = level * range_m;
    *near_m = level * fmin(fmax(sonar->blanking_m, sonar->bin_length_m), 0.5 * range_m);
    return level > LEAST_COS;
}

static asdic_status find_axes(const asdic_detect_job *job, const asdic_pose *pose, axes *out) {
    size_t beams = job->info.beams;
    double *bearing = malloc(3 * beams * sizeof *bearing), near_m, far_m, width = 0.0;
    *out = (axes){.bearing_rad = bearing, .near_m = INFINITY};
    if (!bearing) {
        return asdic_fail_memory(job->ctx, "bearings");
    }
    out->east_m = bearing + 2 * beams;
    for (size_t b = 0; b < beams; b++) {
        asdic_vec3 axis = asdic_beam_axis(&job->info.sonar->receivers[b], pose);
        if (find_reach(job, pose, b, &near_m, &far_m)) {
            bearing[out->beams++] = atan2(axis.y, axis.x);
            width += asdic_beam_width_rad(job->info.sonar, b, job->sound_speed_mps);
            out->near_m = fmin(out->near_m, near_m);
            out->far_m = fmax(out->far_m, far_m);
        }
    }
    asdic_sort_doubles(bearing, out->beams);
    out->width_rad = width / fmax((double)out->beams, 1.0);
    for (size_t b = 0; b < out->beams; b++) { /* once more round the circle */
        bearing[out->beams + b] = bearing[b] + 2.0 * ASDIC_PI;
    }
    out->first = widest_gap(bearing, out->beams); /* wherever that is by the compass */
    return ASDIC_OK;
}

/* Plots per metre at PLANE_M, of all beams that have any there; each has PLOTS in all. */
static double plots_per_m(const asdic_detect_job *job, const asdic_pose *pose, double plots,
                          double plane_m) {
    double near_m, far_m, sum = 0.0;
    for (size_t b = 0; b < job->info.beams; b++) {
        bool has_plots = find_reach(job, pose, b, &near_m, &far_m);
        sum += has_plots && plane_m > near_m && plane_m < far_m ? plots / (far_m - near_m) : 0.0;
    }
    return sum;
}

/* Tracks that PLOTS false plots a ping, anywhere in range and in any beam, confirm in a ping, of a vehicle that turns by
 * TURN_RAD from ping to ping. */
static double confirmed(const asdic_detect_job *job, const asdic_pose *pose, const axes *a,
                        double step_s, double turn_rad, double plots) {
    double factor = pow(a->far_m / a->near_m, 1.0 / RANGES);
    double near_m = a->near_m, sum = 0.0, along, across;
    for (int k = 0; k < RANGES && a->beams > 0; k++, near_m *= factor) {
        double plane_m = near_m * sqrt(factor);
        double per_m = plots_per_m(job, pose, plots / (double)job->info.beams, plane_m);
        asdic_detect_spread(job, a->width_rad, plane_m, &along, &across);
        asdic_plot_point plot = {.variance_nn_m2 = along * along,
                                 .variance_ee_m2 = across * across};
        for (size_t b = 0; b < a->beams; b++) {
            a->east_m[b] = plane_m * a->bearing_rad[a->first + b];
        }
        sum += per_m * near_m * (factor - 1.0) *
               asdic_tracker_false_share(&job->options->tracker, step_s, &plot,
                                         per_m / (double)a->beams, a->east_m, a->beams, plane_m,
                                         turn_rad);
    }
    return sum;
}

/* Whether a scanned head turns by more than a beam in the pings by which a track is judged. */
static bool turns_away(const asdic_detect_job *job, const axes *a) {
    double steps = (double)job->options->tracker.of - 1.0;
    return steps * job->run->settings.sweep.step_rad > a->width_rad;
}

/* A ping, and by how much the vehicle turns to the next. */
typedef struct turn {
    double rad;
    size_t ping;
} turn;

static int turns_less(const void *a, const void *b) {
    const turn *x = a, *y = b;
    return x->rad != y->rad ? (x->rad > y->rad) - (x->rad < y->rad)
                            : (x->ping > y->ping) - (x->ping < y->ping);
}

/* The middle pings of each of SHARES equal shares of the run, from the straightest on. */
static asdic_status choose_pings(const asdic_detect_job *job, turn out[SHARES]) {
    size_t count = job->pings_done - 1;
    turn *all = malloc((count + 1) * sizeof *all);
    if (!all) {
        return asdic_fail_memory(job->ctx, "turns");
    }
    for (size_t i = 0; i < count; i++) {
        double by = job->track_yaw_rad[i + 1] - job->track_yaw_rad[i];
        all[i] = (turn){fabs(remainder(by, 2.0 * ASDIC_PI)), i};
    }
    qsort(all, count, sizeof *all, turns_less);
    for (size_t i = 0; i < SHARES; i++) {
        out[i] = all[(2 * i + 1) * count / (2 * SHARES)];
    }
    free(all);
    return ASDIC_OK;
}

/* Whether false tracks are said alike: from an attitude to within rounding the same. */
static bool is_alike(const turn *a, const asdic_pose *at, const turn *b, const asdic_pose *pose) {
    return fabs(a->rad - b->rad) < ALIKE_RAD && fabs(at->pitch_rad - pose->pitch_rad) < ALIKE_RAD &&
           fabs(at->roll_rad - pose->roll_rad) < ALIKE_RAD;
}

/* ... on the mean of the whole run, of STEP_S seconds a ping. */
static asdic_status confirmed_in_run(const asdic_detect_job *job, double step_s, double plots,
                                     double *mean) {
    turn turns[SHARES];
    asdic_record record;
    asdic_pose before = {0};
    double each = 0.0;
    TRY(choose_pings(job, turns));
    *mean = 0.0;
    for (size_t i = 0; i < SHARES; i++) {
        axes a;
        TRY(asdic_run_read(job->run, turns[i].ping, &record));
        if (i == 0 || !is_alike(&turns[i - 1], &before, &turns[i], &record.pose)) {
            TRY(find_axes(job, &record.pose, &a));
            each = confirmed(job, &record.pose, &a, step_s, turns[i].rad, plots);
            free(a.bearing_rad);
        }
        before = record.pose;
        *mean += each / SHARES;
    }
    return ASDIC_OK;
}

asdic_status asdic_detect_expect_tracks(asdic_detect_job *job) {
    asdic_detect_report *r = job->report;
    const asdic_detect_class *none = &r->classes[r->class_count - 1];
    double pings = (double)r->pings, lasting = pings - (double)job->options->tracker.confirm;
    asdic_record record;
    TRY(asdic_run_read(job->run, r->pings - 1, &record));
    double end_s = record.time_s, mean;
    TRY(asdic_run_read(job->run, 0, &record));
    axes a;
    TRY(find_axes(job, &record.pose, &a));
    bool is_away = turns_away(job, &a);
    free(a.bearing_rad);
    if (is_away || asdic_detect_is_unknown(job) ||
        r->is_coherent) { /* whose speckle stays in its place */
        r->tracks_by_chance = NAN;
    } else if (r->is_sample && lasting > 0.0) {
        double per_alarm = job->false_bins > 0.0 ? job->false_plots / job->false_bins : 1.0;
        /* The background may not be what thresholds take it for: where levels step, neighbours are not. */
        double passed = r->by_cfar ? (double)none->detected : none->expected;
        double alarms = fmax(job->design_alarms, passed);
        TRY(confirmed_in_run(job, (end_s - record.time_s) / (pings - 1.0),
                             alarms / pings * per_alarm, &mean));
        r->tracks_by_chance = lasting * mean;
    }
    return ASDIC_OK;
}
