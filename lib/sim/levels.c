/*
 * The host's work on a ping: from quanta, as the device summed them, to energies of every component,
 * beam and bin, and to the error that the ping states of itself.
 */
#include "simulator.h"

#include "base/widest.h"

#include <math.h>
#include <string.h>

static const asdic_component component_of[DEV_DEPOSIT_COUNT] = {
    [DEV_DEPOSIT_BOTTOM] = ASDIC_BOTTOM,
    [DEV_DEPOSIT_SURFACE] = ASDIC_SURFACE,
    [DEV_DEPOSIT_VOLUME] = ASDIC_VOLUME,
    [DEV_DEPOSIT_OBJECT] = ASDIC_OBJECT,
    [DEV_DEPOSIT_MULTIPATH] = ASDIC_MULTIPATH};

/* The current ping's, as RESULTS in reduce.cl or of a fan in fan.cl. */
static const void *results_of(const asdic_simulator *sim) {
    return sim->host_results + sim->nth * asdic_simulator_results_bytes(sim);
}

/* dB per relative error. */
static double error_to_db(void) {
    return 10.0 / log(10.0);
}

/* A component's energies in the bins from FIRST on, added to TOTAL; a quantum is worth UNIT times LOSS. */
static void convert_whole(const int64_t *restrict quanta, double unit, const double *restrict loss,
                          size_t bins, double *restrict energy, double *restrict total) {
    for (size_t n = 0; n < bins; n++) {
        energy[n] = quanta[n] > 0 ? (double)quanta[n] * unit * loss[n] : 0.0;
        total[n] += energy[n];
    }
}

/* Adds noise to TOTAL, an echo so far, and states its error: that of the echo, from its spread over groups
 * and what the block's calibration found. */
static void state_errors(const asdic_simulator *sim, size_t first, const double *restrict noise,
                         double *restrict total, float *restrict stderr_db) {
    const asdic_stated_error *stated = sim->stated + first;
    const float *spread =
        (const float *)((const int64_t *)results_of(sim) + sim->components * sim->cells + 1) +
        first;
    const double to_db = error_to_db();
    for (size_t n = 0; n < sim->bins; n++) {
        double echo = total[n], error = stated[n].of_block;
        total[n] = echo + noise[n];
        if (!sim->sampling.without_errors) {
            double own = stated[n].of_groups * (double)spread[n] * (double)spread[n];
            error = sqrt(fmax(own, ASDIC_OWN_PING * own + error));
        }
        stderr_db[n] = echo > 0.0 && !sim->sampling.without_errors
                           ? (float)(to_db * error * (echo / total[n]))
                           : 0.0f;
    }
}

/* Quanta to energies of one beam; UNIT[component] is a quantum's energy at loss 1. */
static void convert_beam(const asdic_simulator *sim, const double *unit, size_t beam,
                         asdic_ping *out) {
    const asdic_bin_laws *laws = &sim->laws[sim->nth];
    size_t first = beam * sim->bins, bins = sim->bins;
    double *total = out->intensity_lin[ASDIC_TOTAL] + first;
    memset(total, 0, bins * sizeof *total);
    for (size_t c = 0; c < DEV_DEPOSIT_COUNT; c++) {
        double *energy = out->intensity_lin[component_of[c]] + first;
        const double *loss = c == DEV_DEPOSIT_VOLUME ? laws->volume : laws->loss;
        if ((sim->ping->present & 1u << c) == 0) {
            memset(energy, 0, bins * sizeof *energy);
        } else {
            const int64_t *quanta = (const int64_t *)results_of(sim) + c * sim->cells + first;
            convert_whole(quanta, unit[c], loss, bins, energy, total);
        }
    }
    state_errors(sim, first, out->intensity_lin[ASDIC_NOISE] + first, total,
                 out->stderr_db + first);
}

/* A fan has hundreds of thousands of cells: they are worked on in blocks that stay in the nearest cache. */
#define BLOCK 256

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

/* A fan's water still has to be summed from where it ends to what it crosses: cheaper by beams than by
 * azimuths. */
static void convert_fan_water(const float *restrict quanta, double unit,
                              const double *restrict loss, size_t bins, double *restrict energy) {
    double crossing = 0.0;
    for (size_t n = bins; n-- > 0;) {
        crossing += (double)quanta[n];
        energy[n] = crossing * unit * loss[n];
    }
}

WIDEST static void add(const double *restrict energy, size_t bins, double *restrict echo) {
    for (size_t n = 0; n < bins; n++) {
        echo[n] += energy[n];
    }
}

/* Echo and noise to the total, and the echo's relative error to its part of the total, in dB. */
WIDEST static void end_fan(const double *restrict echo, const double *restrict noise,
                           const asdic_stated_error *restrict stated, double to_db, size_t bins,
                           double *restrict total, float *restrict stderr_db) {
    for (size_t n = 0; n < bins; n++) {
        double sum = echo[n] + noise[n];
        double error_db = to_db * (double)stated[n].of_block * (echo[n] / sum);
        total[n] = sum;
        stderr_db[n] = echo[n] > 0.0 ? (float)error_db : 0.0f;
    }
}

/* convert_beam of a fan. */
static void convert_fan_beam(const asdic_simulator *sim, const double *unit, size_t beam,
                             asdic_ping *out) {
    size_t first = beam * sim->bins, bins = sim->bins;
    const asdic_bin_laws *laws = &sim->laws[sim->nth];
    const float *quanta = (const float *)results_of(sim) + first * sim->components;
    const double to_db = sim->sampling.without_errors ? 0.0 : error_to_db();
    double *water = out->intensity_lin[ASDIC_VOLUME] + first;
    convert_fan_water(quanta + DEV_DEPOSIT_VOLUME * bins, unit[DEV_DEPOSIT_VOLUME], laws->volume,
                      bins, water);
    for (size_t n = 0; n < bins; n += BLOCK) {
        size_t count = bins - n < BLOCK ? bins - n : BLOCK;
        double echo[BLOCK] = {0.0};
        for (size_t c = 0; c < DEV_DEPOSIT_COUNT; c++) {
            double *energy = out->intensity_lin[component_of[c]] + first + n;
            if (c == DEV_DEPOSIT_VOLUME) {
                add(energy, count, echo);
            } else if (sim->ping->present & 1u << c) {
                convert_fan_echo(quanta + c * bins + n, unit[c], laws->loss + n, count, energy,
                                 echo);
            } else {
                memset(energy, 0, count * sizeof *energy);
            }
        }
        end_fan(echo, out->intensity_lin[ASDIC_NOISE] + first + n, sim->stated + first + n, to_db,
                count, out->intensity_lin[ASDIC_TOTAL] + first + n, out->stderr_db + first + n);
    }
}

asdic_status asdic_simulator_convert(asdic_simulator *sim, double source_lin, asdic_ping *out) {
    double unit[DEV_DEPOSIT_COUNT];
    bool fan = sim->fan.cells != 0;
    asdic_status status = ASDIC_OK;
    for (int c = 0; c < DEV_DEPOSIT_COUNT; c++) {
        unit[c] = source_lin / sim->ping->deposit_scale[c];
    }
    for (size_t beam = 0; !status && beam < sim->sonar.receiver_count; beam++) {
        if (!fan) {
            convert_beam(sim, unit, beam, out);
            continue;
        }
        if (beam % DEV_FAN_TILE == 0) {
            status = asdic_beam_fan_wait(&sim->fan, sim->device, beam / DEV_FAN_TILE);
        }
        if (!status) {
            convert_fan_beam(sim, unit, beam, out);
        }
    }
    size_t sums = sim->components * sim->cells;
    out->saturated = fan ? ((const uint32_t *)results_of(sim))[sums]
                         : (uint64_t)((const int64_t *)results_of(sim))[sums];
    return status;
}
