#include "speckle.h"

#include "../../kernels/random.h"

/* A stream of numbers belonging to one bin of one ping. */
typedef struct stream {
    uint32_t seed[2], ping[2], cell, next;
} stream;

/* Uniform in (0, 1), 64 bits, so that rare events have their true probability. */
static double draw(stream *s) {
    random4 r = random_draw(s->cell, s->ping[0], s->ping[1], RANDOM_SPECKLE + (s->next++ << 4),
                            s->seed[0], s->seed[1]);
    return ((double)r.v[0] + ((double)r.v[1] + 0.5) * 0x1p-32) * 0x1p-32;
}

static double exponential(stream *s) {
    return -log(draw(s));
}

static double normal(stream *s) {
    double radius = sqrt(2.0 * exponential(s));
    return radius * cos(2.0 * 3.14159265358979323846 * draw(s));
}

/* Gamma of SHAPE and mean SHAPE: Marsaglia & Tsang, ACM TOMS 26, 363 (2000). */
static double gamma_variate(stream *s, double shape) {
    if (shape < 1.0) {
        double boost = pow(draw(s), 1.0 / shape);
        return gamma_variate(s, shape + 1.0) * boost;
    }
    double d = shape - 1.0 / 3.0, c = 1.0 / sqrt(9.0 * d);
    for (;;) {
        double x = normal(s), v = 1.0 + c * x;
        if (v <= 0.0) {
            continue;
        }
        v = v * v * v;
        if (log(draw(s)) < 0.5 * x * x + d - d * v + d * log(v)) {
            return d * v;
        }
    }
}

double asdic_speckle_factor(asdic_speckle kind, double shape, double cells, uint64_t seed,
                            uint64_t index, uint32_t cell) {
    stream s = {{(uint32_t)seed, (uint32_t)(seed >> 32)},
                {(uint32_t)index, (uint32_t)(index >> 32)},
                cell,
                0};
    double sum = 0.0;
    for (double left = cells; left > 1e-9; left -= 1.0) {
        double texture = kind == ASDIC_SPECKLE_K ? gamma_variate(&s, shape) / shape : 1.0;
        sum += fmin(left, 1.0) * texture * exponential(&s);
    }
    return sum / cells;
}

void asdic_speckle_apply(const asdic_sonar *sonar, double sound_speed_mps, uint64_t seed,
                         uint64_t index, asdic_ping *ping) {
    if (sonar->speckle == ASDIC_SPECKLE_NONE) {
        return;
    }
    double cells = fmax(1.0, sonar->bin_length_m * 2.0 * sonar->bandwidth_hz / sound_speed_mps);
    for (size_t i = 0; i < ping->beams * ping->bins; i++) {
        ping->intensity_lin[ASDIC_TOTAL][i] *= asdic_speckle_factor(
            sonar->speckle, sonar->speckle_shape, cells, seed, index, (uint32_t)i);
    }
}

/* Moving average over LENGTH bins (>= 1, centred), by prefix sums; ends keep their energy inside. */
static void smear_row(double *row, double *prefix, size_t bins, double length) {
    prefix[0] = 0.0;
    for (size_t n = 0; n < bins; n++) {
        prefix[n + 1] = prefix[n] + row[n];
    }
    for (size_t n = 0; n < bins; n++) {
        /* Energy of bin [n, n + 1) spreads evenly; what bin n receives is the average of the
         * prefix integral over a window of LENGTH round it. */
        double lo = (double)n + 0.5 - 0.5 * length, hi = lo + length;
        double edge[2] = {fmin(fmax(lo, 0.0), (double)bins), fmin(fmax(hi, 0.0), (double)bins)};
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
