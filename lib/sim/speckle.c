#include "speckle.h"

#include "variates.h"

#include "../../kernels/random.h"

#include <math.h>

double asdic_speckle_draw(const asdic_background *law, double fixed_lin, uint64_t seed,
                          uint64_t index, uint32_t cell) {
    asdic_variates v = asdic_variates_begin(RANDOM_SPECKLE, seed, index, cell);
    double speckle = asdic_variates_gamma(&v, (double)law->looks) / (double)law->looks;
    double texture = isfinite(law->shape) ? asdic_variates_gamma(&v, law->shape) / law->shape : 1.0;
    return (law->mean_lin * texture + fixed_lin) * speckle;
}

void asdic_speckle_apply(const asdic_sonar *sonar, double sound_speed_mps, uint64_t seed,
                         uint64_t index, asdic_ping *ping) {
    double *const *part = ping->intensity_lin;
    if (sonar->speckle == ASDIC_SPECKLE_NONE) {
        return;
    }
    asdic_background law = {.looks = asdic_sonar_looks(sonar, sound_speed_mps),
                            .shape = sonar->speckle == ASDIC_SPECKLE_K ? sonar->speckle_shape
                                                                       : (double)INFINITY};
    /* Bins shorter than a resolution cell are parts of one and share what it draws. */
    double cells = fmin(sonar->bin_length_m * 2.0 * sonar->bandwidth_hz / sound_speed_mps, 1.0);
    for (size_t i = 0; i < ping->beams * ping->bins; i++) {
        size_t bin = i % ping->bins, cell = i - bin + (size_t)(((double)bin + 0.5) * cells);
        law.mean_lin = part[ASDIC_BOTTOM][i] + part[ASDIC_SURFACE][i] + part[ASDIC_VOLUME][i];
        double fixed_lin = part[ASDIC_OBJECT][i] + part[ASDIC_MULTIPATH][i] + part[ASDIC_NOISE][i];
        part[ASDIC_TOTAL][i] = asdic_speckle_draw(&law, fixed_lin, seed, index, (uint32_t)cell);
    }
}

/* Moving average over LENGTH bins (>= 1, centred), by prefix sums; ends keep their energy inside. */
static void smear_row(double *row, double *prefix, size_t bins, double length) {
    prefix[0] = 0.0;
    for (size_t n = 0; n < bins; n++) {
        prefix[n + 1] = prefix[n] + row[n];
    }
    if (prefix[bins] == 0.0) {
        return; /* a component that the scene lacks */
    }
    for (size_t n = 0; n < bins; n++) {
        /* Energy of bin [n, n + 1) spreads evenly; what bin n receives is the average of the
         * prefix integral over a window of LENGTH round it. */
        double lo = (double)n + 0.5 - 0.5 * length, hi = lo + length;
        double edge[2] = {lo > 0.0 ? lo : 0.0, hi < (double)bins ? hi : (double)bins};
        double value[2];
        for (int e = 0; e < 2; e++) {
            size_t whole = (size_t)edge[e];
            whole = whole >= bins ? bins - 1 : whole;
            value[e] = prefix[whole] + (edge[e] - (double)whole) * row[whole];
        }
        prefix[bins + 1 + n] = (value[1] - value[0]) / length;
    }
    for (size_t n = 0; n < bins; n++) {
        row[n] = prefix[bins + 1 + n];
    }
}

/* The stated error of one beam's smeared TOTAL: a pulse spreads errors as it spreads energy, and
 * errors of neighbouring bins are taken to agree, the least favourable case. ERRORS holds the
 * energies' standard errors before. */
static void smear_errors(const double *total, double *errors, double *prefix, double length,
                         size_t bins, float *stderr_db) {
    smear_row(errors, prefix, bins, length);
    for (size_t n = 0; n < bins; n++) {
        stderr_db[n] = total[n] > 0.0 ? (float)(errors[n] / total[n]) : 0.0f;
    }
}

void asdic_pulse_smear(const asdic_sonar *sonar, double sound_speed_mps, double *scratch,
                       asdic_ping *ping) {
    double length = sound_speed_mps / (2.0 * sonar->bandwidth_hz) / sonar->bin_length_m;
    if (length <= 1.0) {
        return;
    }
    size_t bins = ping->bins;
    double *prefix = scratch, *errors = scratch + 2 * bins + 1;
    for (size_t b = 0; b < ping->beams; b++) {
        double *total = ping->intensity_lin[ASDIC_TOTAL] + b * bins;
        for (size_t n = 0; n < bins; n++) {
            errors[n] = total[n] * ping->stderr_db[b * bins + n];
        }
        for (int c = ASDIC_TOTAL; c < ASDIC_NOISE; c++) {
            smear_row(ping->intensity_lin[c] + b * bins, prefix, bins, length);
        }
        smear_errors(total, errors, prefix, length, bins, ping->stderr_db + b * bins);
    }
}
