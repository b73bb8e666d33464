/*
 * Counts what was detected against what was there.
 */
#include "detect_job.h"

#include "base/context.h"
#include "detect/law.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Indices of the rows after the objects'. */
enum { GHOST, FAINT, NONE, OTHERS };

static size_t objects_of(const asdic_detect_job *job) {
    return asdic_namer_count(job->namer);
}

asdic_status asdic_detect_report_create(asdic_detect_job *job) {
    static const char *const names[OTHERS] = {"ghost", "faint", "none"};
    static const asdic_truth truths[OTHERS] = {ASDIC_TRUTH_GHOST, ASDIC_TRUTH_FAINT,
                                               ASDIC_TRUTH_NONE};
    size_t objects = objects_of(job), beams = job->info.beams;
    asdic_detect_report *r = calloc(1, sizeof *r);
    job->report = r;
    if (!r || !(r->classes = calloc(objects + OTHERS, sizeof *r->classes)) ||
        !(r->sights = calloc(objects * beams, sizeof *r->sights))) {
        return asdic_fail_memory(job->ctx, "a report");
    }
    asdic_background law = asdic_background_of(job->info.sonar, job->sound_speed_mps, 1.0, 0.0);
    r->detector = job->detector;
    r->is_coherent = job->info.sampling.coherent;
    r->is_sample = r->is_coherent || job->info.sonar->speckle != ASDIC_SPECKLE_NONE;
    r->looks = law.looks;
    r->class_count = objects + OTHERS;
    r->sight_count = objects * beams;
    for (size_t i = 0; i < r->class_count; i++) {
        bool is_object = i < objects;
        r->classes[i].truth = is_object ? ASDIC_TRUTH_OBJECT : truths[i - objects];
        snprintf(r->classes[i].name, ASDIC_NAME_SIZE, "%s",
                 is_object ? asdic_namer_name(job->namer, i) : names[i - objects]);
        bool is_predicted = is_object || i == objects + NONE;
        r->classes[i].expected = is_predicted ? 0.0 : (double)NAN;
    }
    for (size_t i = 0; i < r->sight_count; i++) {
        memcpy(r->sights[i].object, r->classes[i / beams].name, ASDIC_NAME_SIZE);
        memcpy(r->sights[i].beam, job->info.sonar->receivers[i % beams].name, ASDIC_NAME_SIZE);
        r->sights[i].snr_db = -INFINITY;
    }
    return ASDIC_OK;
}

void asdic_detect_report_destroy(asdic_detect_report **report) {
    if (report && *report) {
        free((*report)->classes);
        free((*report)->sights);
        free(*report);
        *report = NULL;
    }
}

asdic_background asdic_detect_rest(const asdic_detect_job *job, size_t cell) {
    return asdic_background_of(job->info.sonar, job->sound_speed_mps, job->rest_lin[cell],
                               job->noise_lin[cell]);
}

/* The law of a bin's background as the detector takes it. */
static asdic_background null_of(const asdic_detect_job *job, size_t cell) {
    return asdic_background_of(job->info.sonar, job->sound_speed_mps,
                               asdic_scan_get(job->scan).background_lin[cell],
                               job->fixed_lin[cell]);
}

bool asdic_detect_is_unknown(const asdic_detect_job *job) {
    return job->report->by_cfar && job->info.sonar->speckle == ASDIC_SPECKLE_K &&
           isnan(job->detector.cost_ratio);
}

/* The P_FA of a bin's threshold; of one by cost in K clutter as if the background were known. */
static double design_of(const asdic_detect_job *job, size_t cell) {
    if (isnan(job->detector.cost_ratio)) {
        return asdic_detect_is_unknown(job) ? (double)NAN : job->detector.pfa;
    }
    double pfa = job->report->by_cfar ? asdic_scan_cfar_pfa(job->scan, job->intensity_lin, cell)
                                      : (double)NAN;
    asdic_background null = null_of(job, cell);
    double threshold = asdic_scan_get(job->scan).threshold_lin[cell];
    return isnan(pfa) ? asdic_k_table_pd(job->k_table, &null, 0.0, threshold) : pfa;
}

double asdic_detect_bin_pd(const asdic_detect_job *job, size_t cell) {
    double threshold = asdic_scan_get(job->scan).threshold_lin[cell];
    if (!(job->rest_lin[cell] > 0.0)) { /* nothing but the echo */
        return job->object_lin[cell] > 0.0 ? 1.0 : 0.0;
    }
    asdic_background rest = asdic_detect_rest(job, cell);
    return asdic_k_table_pd(job->k_table, &rest, job->object_lin[cell], threshold);
}

/* What is added to an intensity when it errs by ERROR_DB, where that is stated. */
static double shift(double lin, double error_db) {
    return isnan(error_db) ? 0.0 : lin * (pow(10.0, 0.1 * error_db) - 1.0);
}

/* The factor on the background, which the threshold follows, when its laws err by SIGN times what they state. Of a
 * simulated one only the sum is known: what an object hides of it counts as bottom. */
static double background_factor(const asdic_detect_job *job, const asdic_record *record,
                                size_t cell, double sign) {
    const double *db = job->info.uncertainty.db;
    double mean = job->backdrop || job->expected ? asdic_scan_get(job->scan).background_lin[cell]
                                                 : job->rest_lin[cell];
    double bottom = asdic_detect_lin(record->level_db[ASDIC_BOTTOM][cell]);
    double surface = asdic_detect_lin(record->level_db[ASDIC_SURFACE][cell]);
    if (job->expected) {
        bottom = job->expected->intensity_lin[ASDIC_BOTTOM][cell];
        surface = job->expected->intensity_lin[ASDIC_SURFACE][cell];
    } else if (job->backdrop) {
        bottom += fmax(mean - job->rest_lin[cell], 0.0);
    }
    return 1.0 +
           (shift(bottom, sign * db[ASDIC_BOTTOM]) + shift(surface, sign * db[ASDIC_SURFACE])) /
               mean;
}

/* P_D of a bin when background and echo err by SIGN times what the sources of their laws leave open,
 * the echo the other way; the threshold goes with the background. */
static double pd_with_error(const asdic_detect_job *job, const asdic_record *record, size_t cell,
                            double sign) {
    const double *db = job->info.uncertainty.db;
    double threshold = asdic_scan_get(job->scan).threshold_lin[cell];
    double rest_lin =
        job->rest_lin[cell] +
        shift(asdic_detect_lin(record->level_db[ASDIC_BOTTOM][cell]), sign * db[ASDIC_BOTTOM]) +
        shift(asdic_detect_lin(record->level_db[ASDIC_SURFACE][cell]), sign * db[ASDIC_SURFACE]);
    double own_db = asdic_namer_uncertainty_db(job->namer, (size_t)job->label[cell]);
    double echo = isnan(own_db) ? 1.0 : pow(10.0, -0.1 * sign * own_db);
    asdic_background rest =
        asdic_background_of(job->info.sonar, job->sound_speed_mps, rest_lin, job->noise_lin[cell]);
    return asdic_k_table_pd(job->k_table, &rest, echo * job->object_lin[cell],
                            background_factor(job, record, cell, sign) * threshold);
}

static asdic_band band_of(const asdic_detect_job *job, const asdic_record *record, size_t cell) {
    const double *db = job->info.uncertainty.db;
    double own_db = asdic_namer_uncertainty_db(job->namer, (size_t)job->label[cell]);
    bool is_stated = !isnan(db[ASDIC_BOTTOM]) || !isnan(db[ASDIC_SURFACE]) || !isnan(own_db);
    if (!is_stated || !(job->rest_lin[cell] > 0.0)) {
        return (asdic_band){NAN, NAN};
    }
    return (asdic_band){pd_with_error(job, record, cell, 1.0),
                        pd_with_error(job, record, cell, -1.0)};
}

asdic_detect_class *asdic_detect_class_of(const asdic_detect_job *job, size_t cell) {
    asdic_detect_class *others = job->report->classes + objects_of(job);
    switch (job->truth[cell]) {
    case ASDIC_TRUTH_OBJECT:
        return &job->report->classes[job->label[cell]];
    case ASDIC_TRUTH_GHOST:
        return &others[GHOST];
    case ASDIC_TRUTH_FAINT:
        return &others[FAINT];
    case ASDIC_TRUTH_NONE:
        break;
    }
    return &others[NONE];
}

/* Finds the objects that the beam sees in this ping, and the bin where each stands out most from the threshold: re
 * what else is in its bin a weak echo may stand out more, in the object's own shadow. */
static void count_sights(asdic_detect_job *job, const asdic_record *record, size_t beam) {
    size_t bins = job->info.bins;
    const double *threshold_lin = asdic_scan_get(job->scan).threshold_lin;
    for (size_t n = 0; n < bins; n++) {
        size_t cell = beam * bins + n;
        if (job->truth[cell] != ASDIC_TRUTH_OBJECT || isnan(threshold_lin[cell])) {
            continue;
        }
        size_t at = (size_t)job->label[cell] * job->info.beams + beam;
        asdic_detect_sight *s = &job->report->sights[at];
        /* Counted once a ping: one more than pings before. */
        if (job->sight_ping[at] != record->ping + 1) {
            job->sight_ping[at] = record->ping + 1;
            job->sight_hit[at] = false;
            s->pings_seen++;
        }
        if (job->detected[cell] && !job->sight_hit[at]) {
            job->sight_hit[at] = true;
            s->pings_detected++;
        }
        double over = job->object_lin[cell] / threshold_lin[cell];
        if (over > job->sight_most[at]) {
            job->sight_most[at] = over;
            s->snr_db = asdic_level_db(job->object_lin[cell] / job->rest_lin[cell]);
            s->ping = (size_t)record->ping;
            s->range_m = ((double)n + 0.5) * job->info.sonar->bin_length_m;
            s->pd = asdic_detect_bin_pd(job, cell);
            s->model_pd = band_of(job, record, cell);
            s->detected = job->detected[cell];
        }
    }
}

void asdic_detect_count(asdic_detect_job *job, const asdic_record *record) {
    const double *threshold_lin = asdic_scan_get(job->scan).threshold_lin;
    asdic_detect_report *r = job->report;
    r->pings++;
    for (size_t i = 0; i < job->info.beams * job->info.bins; i++) {
        if (isnan(threshold_lin[i])) {
            continue;
        }
        asdic_detect_class *c = asdic_detect_class_of(job, i);
        r->bins++;
        r->detections += job->detected[i];
        c->bins++;
        c->detected += job->detected[i];
        if (c->truth == ASDIC_TRUTH_OBJECT) {
            c->expected += asdic_detect_bin_pd(job, i);
        } else if (c->truth == ASDIC_TRUTH_NONE) {
            double design = design_of(job, i);
            job->design_alarms += design;
            c->expected += r->by_cfar ? design : asdic_detect_bin_pd(job, i);
        }
    }
    for (size_t b = 0; b < job->info.beams; b++) {
        count_sights(job, record, b);
    }
}

void asdic_detect_finish_report(asdic_detect_job *job) {
    asdic_detect_report *r = job->report;
    size_t kept = 0;
    const asdic_detect_class *none = &r->classes[objects_of(job) + NONE];
    /* False alarms come in clumps, since beams and bins share speckle. The sum of N clumps of
     * random sizes has a variance of N times the mean square size, as if there were fewer alarms,
     * each independent. Coherent scatterers stay where they are, and so may alarms in every ping: all pings tell
     * no less than one. */
    double each = job->false_squares > 0.0 ? job->false_bins / job->false_squares : 1.0;
    each /= r->is_coherent ? (double)r->pings : 1.0;
    r->pfa = asdic_estimate_of((uint64_t)llround(each * (double)none->detected),
                               (uint64_t)llround(each * (double)none->bins));
    r->pfa.value = (double)none->detected / (double)none->bins;
    r->design_pfa = job->design_alarms / (double)none->bins;
    for (size_t i = 0; i < r->sight_count; i++) {
        if (r->sights[i].pings_seen > 0) {
            r->sights[kept++] = r->sights[i];
        }
    }
    r->sight_count = kept;
    for (size_t i = 0; i < job->track_capacity; i++) {
        r->tracks += (job->track_seen[i] & 4u) != 0;
        r->tracks_confirmed += (job->track_seen[i] & 1u) != 0;
        r->tracks_of_objects += (job->track_seen[i] & 2u) != 0;
    }
}
