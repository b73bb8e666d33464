/*
 * The host's work on a ping: from quanta, as the device summed them, to energies of every component,
 * beam and bin, and to the error that the ping states of itself.
 */
#include "simulator.h"

#include "base/try.h"
#include "base/widest.h"
#include "truth.h"

#include <math.h>
#include <string.h>

static const asdic_component component_of[DEV_DEPOSIT_COUNT] = {
    [DEV_DEPOSIT_BOTTOM] = ASDIC_BOTTOM,
    [DEV_DEPOSIT_SURFACE] = ASDIC_SURFACE,
    [DEV_DEPOSIT_VOLUME] = ASDIC_VOLUME,
    [DEV_DEPOSIT_OBJECT] = ASDIC_OBJECT,
    [DEV_DEPOSIT_MULTIPATH] = ASDIC_MULTIPATH};

/* Nothing to COUNT of ENERGY. What is zero is left alone: in many scenes whole components are, and pages that
 * nobody writes to take neither memory nor time. */
WIDEST static uint64_t bits_of(const double *restrict energy, size_t count) {
    uint64_t any = 0;
    for (size_t n = 0; n < count; n++) {
        uint64_t bits;
        memcpy(&bits, &energy[n], sizeof bits);
        any |= bits;
    }
    return any;
}

static void clear(double *energy, size_t count) {
    if (bits_of(energy, count) != 0) {
        memset(energy, 0, count * sizeof *energy);
    }
}

/* A component's energies, added to ECHO; a quantum is worth UNIT times LOSS. */
WIDEST static void convert_whole(const int64_t *restrict quanta, double unit,
                                 const double *restrict loss, size_t bins, double *restrict energy,
                                 double *restrict echo) {
    for (size_t n = 0; n < bins; n++) {
        int64_t q = quanta[n] > 0 ? quanta[n] : 0;
        /* As (double)q; processors have vectors of the halves' conversion more often. */
        double whole = (double)(uint32_t)(q >> 32) * 0x1p32 + (double)(uint32_t)q;
        energy[n] = whole * unit * loss[n];
        echo[n] += energy[n];
    }
}

/* Of a ping that holds far less than the block's others, no more is said than that. */
#define MOST_MISSED 5.0f
/* Relative; twice itself, 8.7 dB, says that a level is not known. More would only stand out in reports: true
 * over stated error is the same with ten. */
#define MOST_ERROR 2.0f

/* The relative error of echoes of ENERGY, from their SPREAD over the ping's groups and what the block's
 * calibration found. */
WIDEST static void estimate_errors(const asdic_stated_error *restrict stated,
                                   const float *restrict spread, const double *restrict energy,
                                   size_t bins, float *restrict error) {
    for (size_t n = 0; n < bins; n++) {
        float own = stated[n].of_groups * spread[n] * spread[n];
        float less = energy[n] > 0.0 ? stated[n].mean_lin / (float)energy[n] : 1.0f;
        float less2 = less * less < MOST_MISSED ? less * less : MOST_MISSED;
        float variance =
            (float)ASDIC_OWN_PING * own + stated[n].of_block * (less > 1.0f ? less2 : 1.0f);
        variance = (variance > own ? variance : own) + stated[n].rare * less2;
        error[n] = sqrtf(variance < MOST_ERROR * MOST_ERROR ? variance : MOST_ERROR * MOST_ERROR);
    }
}

/* Echo and noise to the total, and the echo's relative error to its part of the total, in dB. */
WIDEST static void end_cells(const double *restrict echo, const double *restrict noise,
                             const float *restrict error, double to_db, size_t bins,
                             double *restrict total, float *restrict stderr_db) {
    for (size_t n = 0; n < bins; n++) {
        double sum = echo[n] + noise[n];
        double error_db = to_db * (double)error[n] * (echo[n] / sum);
        total[n] = sum;
        stderr_db[n] = echo[n] > 0.0 ? (float)error_db : 0.0f;
    }
}

/* The cells of a beam are worked on in blocks that stay in the nearest cache. */
#define BLOCK 256

static void end_block(const double *echo, const float *error, size_t at, size_t count,
                      asdic_ping *out) {
    /* dB per relative error */
    const double to_db = 10.0 / log(10.0);
    end_cells(echo, out->intensity_lin[ASDIC_NOISE] + at, error, to_db, count,
              out->intensity_lin[ASDIC_TOTAL] + at, out->stderr_db + at);
}

/* Quanta to energies of one beam; UNIT[component] is a quantum's energy at loss 1. */
static void convert_beam(const asdic_simulator *sim, const asdic_ping_shot *shot,
                         const double *unit, size_t beam, asdic_ping *out) {
    const int64_t *quanta = (const int64_t *)shot->sums;
    const float *spread = (const float *)(quanta + sim->setup.components * sim->setup.cells + 1);
    size_t first = beam * sim->setup.bins;
    for (size_t n = 0; n < sim->setup.bins; n += BLOCK) {
        size_t count = sim->setup.bins - n < BLOCK ? sim->setup.bins - n : BLOCK, at = first + n;
        double echo[BLOCK] = {0.0};
        float error[BLOCK] = {0.0f};
        for (size_t c = 0; c < DEV_DEPOSIT_COUNT; c++) {
            double *energy = out->intensity_lin[component_of[c]] + at;
            const double *loss = c == DEV_DEPOSIT_VOLUME ? shot->volume : shot->loss;
            if (shot->ping->sums.present & 1u << c) {
                convert_whole(quanta + c * sim->setup.cells + at, unit[c], loss + n, count, energy,
                              echo);
            } else {
                clear(energy, count);
            }
        }
        if (!sim->setup.sampling.without_errors) {
            estimate_errors(sim->learnt.stated + at, spread + at, echo, count, error);
        }
        end_block(echo, error, at, count, out);
    }
}

/* Echoes of a fan to energies, added to ECHO. */
WIDEST static void convert_fan_echo(const float *restrict quanta, double unit,
                                    const double *restrict loss, size_t bins,
                                    double *restrict energy, double *restrict echo) {
    for (size_t n = 0; n < bins; n++) {
        double q = quanta[n] > 0.0f ? quanta[n] : 0.0;
        energy[n] = q * unit * loss[n];
        echo[n] += energy[n];
    }
}

/* Beams whose water is summed together: each sum waits for itself. */
#define WATER_BEAMS 4

/* A fan's water still has to be summed from where it ends to what it crosses: cheaper by beams than by
 * azimuths. Of the beams from BEAM on. */
static void convert_fan_water(const asdic_simulator *sim, const asdic_ping_shot *shot, double unit,
                              size_t beam, asdic_ping *out) {
    size_t bins = out->bins, left = out->beams - beam;
    const float *quanta[WATER_BEAMS];
    double crossing[WATER_BEAMS] = {0.0}, *energy[WATER_BEAMS];
    for (size_t k = 0; k < WATER_BEAMS; k++) {
        size_t first = (beam + (k < left ? k : 0)) * bins; /* behind the last the first again */
        quanta[k] = (const float *)shot->sums + first * sim->fan.sums + DEV_DEPOSIT_VOLUME * bins;
        energy[k] = out->intensity_lin[ASDIC_VOLUME] + first;
    }
    for (size_t n = bins; n-- > 0;) {
        for (size_t k = 0; k < WATER_BEAMS; k++) {
            crossing[k] += (double)quanta[k][n];
            energy[k][n] = crossing[k] * unit * shot->volume[n];
        }
    }
}

/* Whether there is anything in COUNT of QUANTA. */
WIDEST static bool holds_any(const float *restrict quanta, size_t count) {
    int any = 0;
    for (size_t n = 0; n < count; n++) {
        any |= quanta[n] > 0.0f;
    }
    return any != 0;
}

WIDEST static void add(const double *restrict energy, size_t bins, double *restrict echo) {
    for (size_t n = 0; n < bins; n++) {
        echo[n] += energy[n];
    }
}

/* convert_beam of a fan. */
static void convert_fan_beam(const asdic_simulator *sim, const asdic_ping_shot *shot,
                             const double *unit, size_t beam, asdic_ping *out) {
    size_t first = beam * sim->setup.bins, bins = sim->setup.bins;
    const float *quanta = (const float *)shot->sums + first * sim->fan.sums;
    if (beam % WATER_BEAMS == 0) {
        convert_fan_water(sim, shot, unit[DEV_DEPOSIT_VOLUME], beam, out);
    }
    for (size_t n = 0; n < bins; n += BLOCK) {
        size_t count = bins - n < BLOCK ? bins - n : BLOCK, at = first + n;
        double echo[BLOCK] = {0.0};
        float error[BLOCK] = {0.0f};
        for (size_t c = 0; c < DEV_DEPOSIT_COUNT; c++) {
            double *energy = out->intensity_lin[component_of[c]] + at;
            if (c == DEV_DEPOSIT_VOLUME) {
                add(energy, count, echo);
            } else if (shot->ping->sums.present & 1u << c &&
                       holds_any(quanta + c * bins + n, count)) {
                convert_fan_echo(quanta + c * bins + n, unit[c], shot->loss + n, count, energy,
                                 echo);
            } else {
                clear(energy, count);
            }
        }
        if (!sim->setup.sampling.without_errors) {
            static const float none[BLOCK];
            estimate_errors(sim->learnt.stated + at, none, echo, count, error);
        }
        end_block(echo, error, at, count, out);
    }
}

asdic_status asdic_simulator_convert(asdic_simulator *sim, const asdic_ping_shot *shot,
                                     double source_lin, asdic_ping *out) {
    double unit[DEV_DEPOSIT_COUNT];
    bool fan = sim->fan.many;
    for (int c = 0; c < DEV_DEPOSIT_COUNT; c++) {
        unit[c] = source_lin / shot->ping->sums.scale[c];
    }
    size_t beams = sim->setup.sonar.receiver_count;
    for (size_t beam = 0; beam < beams; beam++) {
        if (fan && beam % DEV_FAN_TILE == 0) {
            TRY(asdic_beam_fan_wait(&sim->fan, sim->device, beam / DEV_FAN_TILE));
        }
        if (fan) {
            convert_fan_beam(sim, shot, unit, beam, out);
        } else {
            convert_beam(sim, shot, unit, beam, out);
        }
        if (beam % ASDIC_TRUTH_BEAMS == ASDIC_TRUTH_BEAMS - 1 || beam == beams - 1) {
            asdic_truth_tell(sim, shot, beam / ASDIC_TRUTH_BEAMS * ASDIC_TRUTH_BEAMS, out);
        }
    }
    size_t sums = sim->setup.components * sim->setup.cells;
    out->saturated = fan ? 0 : (uint64_t)((const int64_t *)shot->sums)[sums];
    return ASDIC_OK;
}
