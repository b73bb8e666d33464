#include "pulse.h"

#include "base/share.h"
#include "base/widest.h"

#include <math.h>
#include <string.h>

/* Beams that a thread takes at once. */
#define BEAMS 16

/* The window that a bin receives from: all of REACH - 1 bins on each side, and a part of one more. */
typedef struct window {
    size_t reach;
    double edge, half; /* part of the outermost; half the window, in bins */
} window;

/* The window of LENGTH bins, > 1, in a ping of BINS. */
static window window_of(double length, size_t bins) {
    double side = 0.5 * (length - 1.0), reach = ceil(side);
    if (reach > (double)bins) {
        return (window){bins, 1.0, 0.5 * length};
    }
    return (window){(size_t)reach, side - (reach - 1.0), 0.5 * length};
}

size_t asdic_pulse_scratch(size_t bins) {
    return 4 * bins; /* a row between margins, and a row of errors */
}

/* Bins, of BINS in all, over which what lies in bin N is spread. */
static inline double spread_of(window w, size_t bins, size_t n) {
    double ahead = (double)(bins - n) - 0.5;
    return w.half + (ahead < w.half ? ahead : w.half);
}

/* Moving average of ROW. PADDED has room for bins + 2 reach. Nothing arrives from before the first bin. What
 * lies beyond the last is taken to be like the bins before it: the mean is over the bins that there are.
 * Running sums are not used: they would lose what lies far below the loudest bin. */
WIDEST static void smear_row(double *restrict row, double *restrict padded, size_t bins, window w) {
    memset(padded, 0, w.reach * sizeof *padded);
    memcpy(padded + w.reach, row, bins * sizeof *padded);
    memset(padded + w.reach + bins, 0, w.reach * sizeof *padded);
    for (size_t n = 0; n < bins; n++) {
        row[n] = (padded[n] + padded[n + 2 * w.reach]) * w.edge;
    }
    for (size_t k = 1; k < 2 * w.reach; k++) {
        for (size_t n = 0; n < bins; n++) {
            row[n] += padded[n + k];
        }
    }
    for (size_t n = 0; n < bins; n++) {
        row[n] /= spread_of(w, bins, n);
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
                           size_t bins, double *row) {
    if (asdic_pulse_smears(sonar, sound_speed_mps)) {
        smear_row(row, scratch, bins, window_of(asdic_pulse_bins(sonar, sound_speed_mps), bins));
    }
}

double asdic_pulse_share(const asdic_sonar *sonar, double sound_speed_mps, size_t bins, size_t n) {
    double length = asdic_pulse_bins(sonar, sound_speed_mps);
    return length > 1.0 ? 1.0 / spread_of(window_of(length, bins), bins, n) : 1.0;
}

typedef struct smearing {
    asdic_ping *ping;
    window window;
    double *scratch;
} smearing;

static void smear_beams(void *user, unsigned worker, size_t first, size_t end) {
    const smearing *s = user;
    asdic_ping *ping = s->ping;
    size_t bins = ping->bins;
    double *errors = s->scratch + worker * asdic_pulse_scratch(bins), *padded = errors + bins;
    for (size_t b = first; b < end; b++) {
        size_t at = b * bins;
        /* Errors of neighbouring bins are taken to agree, the least favourable case. */
        weigh(ping->intensity_lin[ASDIC_TOTAL] + at, ping->stderr_db + at, bins, errors);
        smear_row(errors, padded, bins, s->window);
        for (int c = ASDIC_TOTAL + 1; c < ASDIC_NOISE; c++) {
            smear_row(ping->intensity_lin[c] + at, padded, bins, s->window);
        }
        sum_parts(ping, at, errors);
    }
}

void asdic_pulse_smear(const asdic_sonar *sonar, double sound_speed_mps, unsigned threads,
                       double *scratch, asdic_ping *ping) {
    if (asdic_pulse_smears(sonar, sound_speed_mps)) {
        smearing s = {ping, window_of(asdic_pulse_bins(sonar, sound_speed_mps), ping->bins),
                      scratch};
        asdic_share(threads, ping->beams, BEAMS, smear_beams, &s);
    }
}
