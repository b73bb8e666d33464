/*
 * The number of false tracks to expect: from false alarms of the designed probability, as many to a
 * plot as were found, with plots anywhere in range and bearing, by the tracker's rule.
 */
#include "detect_job.h"

#include "base/context.h"
#include "base/try.h"
#include "base/vec.h"

#include <math.h>
#include <stdlib.h>

/* Intervals of range, each longer than the one before by the same factor: most false tracks are
 * near. */
#define RANGES 64

static int by_size(const void *a, const void *b) {
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

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

/* The bearings over which the beams' axes, and hence plots, are spread, rad; gaps of more than
 * two widths are left out. NAN: no memory. */
static double spread_rad(const asdic_detect_job *job, const asdic_pose *pose) {
    size_t beams = job->info.beams;
    double *bearing = malloc(beams * sizeof *bearing), sum = 0.0, width = 0.0;
    if (!bearing) {
        return NAN;
    }
    for (size_t b = 0; b < beams; b++) {
        asdic_vec3 axis = asdic_beam_axis(&job->info.sonar->receivers[b], pose);
        bearing[b] = atan2(axis.y, axis.x);
        width += asdic_beam_width_rad(job->info.sonar, b, job->sound_speed_mps) / (double)beams;
    }
    qsort(bearing, beams, sizeof *bearing, by_size);
    size_t first = widest_gap(bearing, beams); /* wherever that is by the compass */
    for (size_t b = 1; b < beams; b++) {
        sum += fmin(gap_before(bearing, beams, (first + b) % beams), 2.0 * width);
    }
    free(bearing);
    return fmax(sum, 1e-6);
}

/* Tracks that PLOTS false plots a ping, anywhere in range and bearing, confirm in a ping. */
static double confirmed(const asdic_detect_job *job, const asdic_pose *pose, double step_s,
                        double plots, double spread) {
    const asdic_sonar *sonar = job->info.sonar;
    size_t middle = job->info.beams / 2;
    asdic_vec3 axis = asdic_beam_axis(&sonar->receivers[middle], pose);
    double level = fmax(hypot(axis.x, axis.y), 1e-6);
    double end_m = level * (double)job->info.bins * sonar->bin_length_m;
    double from_m = level * fmin(fmax(sonar->blanking_m, sonar->bin_length_m), 0.5 * end_m / level);
    double factor = pow(end_m / from_m, 1.0 / RANGES), per_m = plots / (end_m - from_m);
    double near_m = from_m, sum = 0.0, along, across;
    for (int k = 0; k < RANGES; k++, near_m *= factor) {
        double plane_m = near_m * sqrt(factor), width_m = spread * plane_m;
        asdic_detect_spread(job, middle, plane_m, &along, &across);
        asdic_plot_point plot = {.variance_nn_m2 = along * along,
                                 .variance_ee_m2 = across * across};
        sum += per_m * near_m * (factor - 1.0) *
               asdic_tracker_false_share(&job->options->tracker, step_s, &plot, per_m / width_m,
                                         width_m);
    }
    return sum;
}

asdic_status asdic_detect_expect_tracks(asdic_detect_job *job) {
    asdic_detect_report *r = job->report;
    const asdic_detect_class *none = &r->classes[r->class_count - 1];
    double pings = (double)r->pings, lasting = pings - (double)job->options->tracker.confirm;
    asdic_record record;
    if (!r->is_sample || lasting <= 0.0) {
        return ASDIC_OK;
    }
    TRY(asdic_run_read(job->run, r->pings - 1, &record));
    double end_s = record.time_s;
    TRY(asdic_run_read(job->run, 0, &record));
    double spread = spread_rad(job, &record.pose);
    if (isnan(spread)) {
        return asdic_fail_memory(job->ctx, "bearings");
    }
    double per_alarm = job->false_bins > 0.0 ? job->false_plots / job->false_bins : 1.0;
    r->tracks_by_chance =
        lasting * confirmed(job, &record.pose, (end_s - record.time_s) / (pings - 1.0),
                            none->expected / pings * per_alarm, spread);
    return ASDIC_OK;
}
