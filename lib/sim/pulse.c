#include "pulse.h"

#include "base/share.h"
#include "base/widest.h"

#include <math.h>
#include <string.h>

/* Beams that a thread takes at once. */
#define BEAMS 16

/* An end of the blanking so near to a bin's, in bins, is it. */
#define SAME_EDGE 1e-6

/* The window that a bin receives from: all of REACH - 1 bins on each side, and a part of one more. */
typedef struct window {
    size_t reach;
    double edge, length; /* part of the outermost; the window, in bins */
    double deaf;         /* bins, from the first, that the blanking takes */
} window;

static double deaf_bins(const asdic_sonar *sonar) {
    double deaf = sonar->blanking_m / sonar->bin_length_m, whole = round(deaf);
    return fabs(deaf - whole) < SAME_EDGE ? whole : deaf;
}

/* The window in a ping of BINS; of a pulse that is no longer than a bin, that bin. */
static window window_of(const asdic_sonar *sonar, double sound_speed_mps, size_t bins) {
    double length = fmax(asdic_pulse_bins(sonar, sound_speed_mps), 1.0),
           side = 0.5 * (length - 1.0);
    double reach = ceil(side), deaf = deaf_bins(sonar);
    if (reach == 0.0) {
        return (window){0, 0.5, 1.0, deaf};
    }
    if (reach > (double)bins) {
        return (window){bins, 1.0, length, deaf};
    }
    return (window){(size_t)reach, side - (reach - 1.0), length, deaf};
}

/* The part of bin N that lies behind the blanking. */
static double part_heard(window w, size_t n) {
    return fmin(fmax((double)n + 1.0 - w.deaf, 0.0), 1.0);
}

size_t asdic_pulse_margin(const asdic_sonar *sonar, double sound_speed_mps, size_t bins) {
    return window_of(sonar, sound_speed_mps, bins).reach;
}

double asdic_pulse_from_m(const asdic_sonar *sonar, double sound_speed_mps) {
    double deaf = deaf_bins(sonar), from = deaf;
    if (asdic_pulse_smears(sonar, sound_speed_mps)) {
        window w = window_of(sonar, sound_speed_mps, ASDIC_SONAR_MAX_BINS);
        from = fmax(floor(deaf) - (double)w.reach, 0.5 * deaf);
    }
    return from * sonar->bin_length_m;
}

size_t asdic_pulse_scratch(size_t bins) {
    return 4 * bins; /* a row between margins, and a row of errors */
}

/* Moving average of FROM, of COUNT bins, to the first BINS. PADDED has room for COUNT + 2 reach. Nothing is heard before
 * the blanking's end. Running sums are not used: they would lose what lies far below the loudest bin. */
WIDEST static void smear_row(const double *from, size_t count, double *restrict padded, double *row,
                             size_t bins, window w) {
    memset(padded, 0, w.reach * sizeof *padded);
    memcpy(padded + w.reach, from, count * sizeof *padded);
    memset(padded + w.reach + count, 0, w.reach * sizeof *padded);
    for (size_t n = 0; n < bins; n++) {
        row[n] = (padded[n] + padded[n + 2 * w.reach]) * w.edge;
    }
    for (size_t k = 1; k < 2 * w.reach; k++) {
        for (size_t n = 0; n < bins; n++) {
            row[n] += padded[n + k];
        }
    }
    for (size_t n = 0; n < bins; n++) {
        row[n] /= w.length;
    }
    for (size_t n = 0; n < bins && (double)n < w.deaf; n++) {
        row[n] *= part_heard(w, n);
    }
}

/* A beam's total from its parts, and its stated error from the smeared ERRORS of the energy. */
WIDEST static void sum_parts(asdic_ping *ping, size_t first, const double *restrict errors) {
    double *const *part = ping->intensity_lin;
    double *restrict total = part[ASDIC_TOTAL] + first;
    const double *bottom = part[ASDIC_BOTTOM] + first, *surface = part[ASDIC_SURFACE] + first;
    const double *volume = part[ASDIC_VOLUME] + first, *object = part[ASDIC_OBJECT] + first;
    const double *multipath = part[ASDIC_MULTIPATH] + first, *noise = part[ASDIC_NOISE] + first;
    float *restrict stderr_db = ping->stderr_db + first;
    for (size_t n = 0; n < ping->bins; n++) {
        double sum = bottom[n] + surface[n] + volume[n] + object[n] + multipath[n] + noise[n];
        double error = errors[n] / sum;
        total[n] = sum;
        stderr_db[n] = sum > 0.0 ? (float)error : 0.0f;
    }
}

WIDEST static void weigh(const double *restrict total, const float *restrict stderr_db, size_t bins,
                         double *restrict errors) {
    for (size_t n = 0; n < bins; n++) {
        errors[n] = total[n] * (double)stderr_db[n];
    }
}

double asdic_pulse_bins(const asdic_sonar *sonar, double sound_speed_mps) {
    return sound_speed_mps / (2.0 * sonar->bandwidth_hz) / sonar->bin_length_m;
}

bool asdic_pulse_smears(const asdic_sonar *sonar, double sound_speed_mps) {
    return asdic_pulse_bins(sonar, sound_speed_mps) > 1.0;
}

void asdic_pulse_smear_row(const asdic_sonar *sonar, double sound_speed_mps, double *scratch,
                           size_t bins, size_t margin, double *row) {
    window w = window_of(sonar, sound_speed_mps, bins);
    smear_row(row, bins + margin, scratch, row, bins, w);
}

double asdic_pulse_share(const asdic_sonar *sonar, double sound_speed_mps, size_t n) {
    if (!asdic_pulse_smears(sonar, sound_speed_mps)) {
        return 1.0;
    }
    window w = window_of(sonar, sound_speed_mps, n + 1);
    return part_heard(w, n) / w.length;
}

typedef struct smearing {
    const asdic_ping *from;
    asdic_ping *out;
    window window;
    double *scratch;
} smearing;

static void smear_beams(void *user, unsigned worker, size_t first, size_t end) {
    const smearing *s = user;
    const asdic_ping *from = s->from;
    asdic_ping *out = s->out;
    size_t count = from->bins, bins = out->bins;
    double *errors = s->scratch + worker * asdic_pulse_scratch(count), *padded = errors + count;
    for (size_t b = first; b < end; b++) {
        size_t at = b * count, to = b * bins;
        /* Errors of neighbouring bins are taken to agree: the least favourable case. */
        weigh(from->intensity_lin[ASDIC_TOTAL] + at, from->stderr_db + at, count, errors);
        smear_row(errors, count, padded, errors, bins, s->window);
        for (int c = ASDIC_TOTAL + 1; c < ASDIC_NOISE; c++) {
            smear_row(from->intensity_lin[c] + at, count, padded, out->intensity_lin[c] + to, bins,
                      s->window);
        }
        memmove(out->intensity_lin[ASDIC_NOISE] + to, from->intensity_lin[ASDIC_NOISE] + at,
                bins * sizeof(double));
        sum_parts(out, to, errors);
    }
}

void asdic_pulse_smear(const asdic_sonar *sonar, double sound_speed_mps, unsigned threads,
                       double *scratch, const asdic_ping *from, asdic_ping *out) {
    if (from != out || asdic_pulse_smears(sonar, sound_speed_mps)) {
        smearing s = {from, out, window_of(sonar, sound_speed_mps, out->bins), scratch};
        asdic_share(threads, out->beams, BEAMS, smear_beams, &s);
        out->bin_length_m = from->bin_length_m;
        out->rays = from->rays;
        out->saturated = from->saturated;
    }
}
