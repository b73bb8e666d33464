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
    double deaf;       /* bins, from the first, that the blanking takes */
} window;

/* The window of SONAR, whose pulse is longer than a bin, in a ping of BINS. */
static window window_of(const asdic_sonar *sonar, double sound_speed_mps, size_t bins) {
    double length = asdic_pulse_bins(sonar, sound_speed_mps), half = 0.5 * length;
    double side = half - 0.5, reach = ceil(side), deaf = sonar->blanking_m / sonar->bin_length_m;
    if (reach > (double)bins) {
        return (window){bins, 1.0, half, deaf};
    }
    return (window){(size_t)reach, side - (reach - 1.0), half, deaf};
}

/* The part of bin N that lies behind the blanking. */
static double part_heard(window w, size_t n) {
    return fmin(fmax((double)n + 1.0 - w.deaf, 0.0), 1.0);
}

size_t asdic_pulse_scratch(size_t bins) {
    return 4 * bins; /* a row between margins, and a row of errors */
}

/* Bins, of BINS in all, that the mean of COMPONENT in bin N is over. What lies beyond the last is taken to be like the
 * bins before it, as reverberation goes on: the mean is over the bins that there are. An object's echo does not go on,
 * and what the pulse carries beyond the last bin is lost. */
static inline double spread_of(window w, asdic_component component, size_t bins, size_t n) {
    double ahead = (double)(bins - n) - 0.5;
    return w.half + (component != ASDIC_OBJECT && ahead < w.half ? ahead : w.half);
}

/* Moving average of ROW. PADDED has room for bins + 2 reach. Nothing arrives from before the first bin, and nothing is
 * heard before the blanking's end. Running sums are not used: they would lose what lies far below the loudest bin. */
WIDEST static void smear_row(double *restrict row, double *restrict padded,
                             asdic_component component, size_t bins, window w) {
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
        row[n] /= spread_of(w, component, bins, n);
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

void asdic_pulse_smear_row(const asdic_sonar *sonar, double sound_speed_mps,
                           asdic_component component, double *scratch, size_t bins, double *row) {
    if (asdic_pulse_smears(sonar, sound_speed_mps)) {
        smear_row(row, scratch, component, bins, window_of(sonar, sound_speed_mps, bins));
    }
}

double asdic_pulse_share(const asdic_sonar *sonar, double sound_speed_mps, size_t bins, size_t n) {
    if (!asdic_pulse_smears(sonar, sound_speed_mps)) {
        return 1.0;
    }
    window w = window_of(sonar, sound_speed_mps, bins);
    return part_heard(w, n) / spread_of(w, ASDIC_OBJECT, bins, n);
}

double asdic_pulse_kept(const asdic_sonar *sonar, double sound_speed_mps, size_t bins, size_t n) {
    window w = window_of(sonar, sound_speed_mps, bins);
    return spread_of(w, ASDIC_TOTAL, bins, n) / spread_of(w, ASDIC_OBJECT, bins, n);
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
        /* Errors of neighbouring bins are taken to agree, and to go on beyond the last: the least favourable case. */
        weigh(ping->intensity_lin[ASDIC_TOTAL] + at, ping->stderr_db + at, bins, errors);
        smear_row(errors, padded, ASDIC_TOTAL, bins, s->window);
        for (int c = ASDIC_TOTAL + 1; c < ASDIC_NOISE; c++) {
            smear_row(ping->intensity_lin[c] + at, padded, (asdic_component)c, bins, s->window);
        }
        sum_parts(ping, at, errors);
    }
}

void asdic_pulse_smear(const asdic_sonar *sonar, double sound_speed_mps, unsigned threads,
                       double *scratch, asdic_ping *ping) {
    if (asdic_pulse_smears(sonar, sound_speed_mps)) {
        smearing s = {ping, window_of(sonar, sound_speed_mps, ping->bins), scratch};
        asdic_share(threads, ping->beams, BEAMS, smear_beams, &s);
    }
}
