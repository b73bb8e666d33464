/*
 * How many false tracks are to be expected: false alarms of the designed probability, as many to a plot as
 * were found, plots anywhere in range and bearing, and what the tracker makes of them.
 */
#include "detect_job.h"

#include "base/context.h"
#include "base/vec.h"

#include <math.h>
#include <stdlib.h>

/* Ranges at which clutter is looked at. */
#define RANGES 24

/* Plots lie on axes; a gate round one reaches so many beam widths to either side, or a little
 * further. */
#define REACH 0.9

static int by_size(const void *a, const void *b) {
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* The bearings over which the beams' plots are spread, rad; NAN: no memory. */
static double spread_rad(const asdic_detect_job *job, const asdic_pose *pose) {
    size_t beams = job->info.beams;
    double *bearing = malloc(beams * sizeof *bearing), sum = 0.0, reach = 0.0;
    if (!bearing) {
        return NAN;
    }
    for (size_t b = 0; b < beams; b++) {
        asdic_vec3 axis = asdic_beam_axis(&job->info.sonar->receivers[b], pose);
        bearing[b] = atan2(axis.y, axis.x);
        reach +=
            REACH / (double)beams * asdic_beam_width_rad(job->info.sonar, b, job->sound_speed_mps);
    }
    qsort(bearing, beams, sizeof *bearing, by_size);
    for (size_t b = 1; b < beams; b++) {
        sum += fmin(bearing[b] - bearing[b - 1], 2.0 * reach);
    }
    free(bearing);
    return fmin(sum + 2.0 * reach, 2.0 * ASDIC_PI);
}

/* Tracks that PLOTS false plots a ping, anywhere in range and bearing, confirm in a ping. */
static double confirmed(const asdic_detect_job *job, const asdic_record *record, double step_s,
                        double plots, double spread) {
    const asdic_sonar *sonar = job->info.sonar;
    size_t bins = job->info.bins, blank = (size_t)(sonar->blanking_m / sonar->bin_length_m);
    size_t heard = bins > blank ? bins - blank : 1;
    double share = 0.0;
    for (size_t k = 0; k < RANGES; k++) {
        size_t bin = bins - heard + (2 * k + 1) * heard / (2 * RANGES);
        asdic_plot_point plot = asdic_detect_plot(job, record, job->info.beams / 2 * bins + bin);
        double plane_m = fmax(hypot(plot.north_m - record->pose.position_m.x,
                                    plot.east_m - record->pose.position_m.y),
                              1e-6);
        double depth_m = plane_m / ((double)bin + 0.5) * (double)heard;
        share += asdic_tracker_false_share(&job->options->tracker, step_s, &plot,
                                           plots / (spread * plane_m * depth_m));
    }
    return plots * share / RANGES;
}

asdic_status asdic_detect_expect_tracks(asdic_detect_job *job) {
    asdic_detect_report *r = job->report;
    const asdic_detect_class *none = &r->classes[r->class_count - 1];
    double pings = (double)r->pings, lasting = pings - (double)job->options->tracker.confirm;
    asdic_record record;
    if (!r->is_sample || lasting <= 0.0) {
        return ASDIC_OK;
    }
    asdic_status status = asdic_run_read(job->run, r->pings - 1, &record);
    double end_s = record.time_s;
    status = status ? status : asdic_run_read(job->run, 0, &record);
    double spread = status ? NAN : spread_rad(job, &record.pose);
    if (!status && isnan(spread)) {
        status = asdic_fail_memory(job->ctx, "bearings");
    }
    if (!status) {
        double per_alarm = job->false_bins > 0.0 ? job->false_plots / job->false_bins : 1.0;
        r->tracks_by_chance =
            lasting * confirmed(job, &record, (end_s - record.time_s) / (pings - 1.0),
                                none->expected / pings * per_alarm, spread);
    }
    return status;
}
