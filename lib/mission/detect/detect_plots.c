/*
 * Detections to plots: along a beam, neighbouring bins are one thing, which is where they are
 * strongest; of plots in several beams that overlap, the strongest stays.
 */
#include "detect_job.h"

#include "base/vec.h"

#include <math.h>

/* Half-widths to standard deviations: a uniform spread. */
#define UNIFORM (1.0 / 3.4641016151377544)

/* Strongest bin, by likelihood, of the run of detections that begins at FIRST; *END is behind it. */
static size_t peak(const asdic_detect_job *job, const double *llr, size_t first, size_t *end) {
    size_t last = (first / job->info.bins + 1) * job->info.bins, best = first, i = first;
    for (; i < last && job->detected[i]; i++) {
        best = llr[i] > llr[best] ? i : best;
    }
    *end = i;
    return best;
}

void asdic_detect_spread(const asdic_detect_job *job, size_t beam, double plane_m, double *along_m,
                         double *across_m) {
    const asdic_sonar *sonar = job->info.sonar;
    *along_m =
        UNIFORM * fmax(sonar->bin_length_m, 0.5 * job->sound_speed_mps / sonar->bandwidth_hz);
    *across_m =
        fmax(UNIFORM * plane_m * asdic_beam_width_rad(sonar, beam, job->sound_speed_mps), *along_m);
}

static asdic_plot_point plot_of(const asdic_detect_job *job, const asdic_record *record,
                                size_t cell) {
    size_t beam = cell / job->info.bins;
    asdic_vec3 at = asdic_detect_position(job, record, beam, cell % job->info.bins);
    double north = at.x - record->pose.position_m.x, east = at.y - record->pose.position_m.y;
    double plane = fmax(hypot(north, east), 1e-9), along, across;
    double c = north / plane, s = east / plane;
    asdic_detect_spread(job, beam, plane, &along, &across);
    return (asdic_plot_point){.north_m = at.x,
                              .east_m = at.y,
                              .variance_nn_m2 = pow(c * along, 2) + pow(s * across, 2),
                              .variance_ee_m2 = pow(s * along, 2) + pow(c * across, 2),
                              .variance_ne_m2 = c * s * (along * along - across * across),
                              .label = job->label[cell]};
}

/* Whether two plots of one ping may be one thing: near each other as their spreads go. */
static bool overlap(const asdic_plot_point *a, const asdic_plot_point *b) {
    double nn = a->variance_nn_m2 + b->variance_nn_m2, ee = a->variance_ee_m2 + b->variance_ee_m2;
    double ne = a->variance_ne_m2 + b->variance_ne_m2;
    double n = a->north_m - b->north_m, e = a->east_m - b->east_m;
    double distance2 = (ee * n * n - 2.0 * ne * n * e + nn * e * e) / (nn * ee - ne * ne);
    return distance2 < 9.0;
}

void asdic_detect_find_plots(asdic_detect_job *job, const asdic_record *record) {
    const double *llr = asdic_scan_get(job->scan).llr;
    size_t cells = job->info.beams * job->info.bins, end = 0;
    job->plot_count = 0;
    for (size_t i = 0; i < cells; i = job->detected[i] ? end : i + 1) {
        if (!job->detected[i]) {
            continue;
        }
        size_t at = peak(job, llr, i, &end);
        asdic_plot_point plot = plot_of(job, record, at);
        bool is_new = true;
        for (size_t k = 0; k < job->plot_count && is_new; k++) {
            is_new = !overlap(&job->plots[k], &plot);
            if (!is_new && llr[at] > llr[job->plot_cell[k]]) {
                job->plots[k] = plot;
                job->plot_cell[k] = at;
            }
            job->plot_bins[k] += is_new ? 0 : end - i;
        }
        if (is_new) {
            job->plot_cell[job->plot_count] = at;
            job->plot_bins[job->plot_count] = end - i;
            job->plots[job->plot_count++] = plot;
        }
    }
    for (size_t k = 0; k < job->plot_count; k++) {
        double bins = (double)job->plot_bins[k];
        bool is_false = job->truth[job->plot_cell[k]] == ASDIC_TRUTH_NONE;
        job->false_plots += is_false ? 1.0 : 0.0;
        job->false_bins += is_false ? bins : 0.0;
        job->false_squares += is_false ? bins * bins : 0.0;
    }
}
