/*
 * The host's work on a ping: from quanta, as the device summed them, to energies of every component,
 * beam and bin, and to the error that the ping states of itself.
 */
#include "simulator.h"

#include "base/clear.h"
#include "base/share.h"
#include "base/try.h"
#include "base/widest.h"
#include "drift.h"
#include "noise_level.h"
#include "ring.h"
#include "truth.h"

#include <math.h>
#include <stdatomic.h>

const asdic_component asdic_component_of[DEV_DEPOSIT_COUNT] = {
    [DEV_DEPOSIT_BOTTOM] = ASDIC_BOTTOM,
    [DEV_DEPOSIT_SURFACE] = ASDIC_SURFACE,
    [DEV_DEPOSIT_VOLUME] = ASDIC_VOLUME,
    [DEV_DEPOSIT_OBJECT] = ASDIC_OBJECT,
    [DEV_DEPOSIT_MULTIPATH] = ASDIC_MULTIPATH};

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

/* A ping that holds less than the block's others may have missed something: the variance, relative to its total, is
 * at most so many times theirs for that. Of many receivers, whose echoes move alike, it is theirs. */
#define MOST_LESS_FEW 5.0
#define MOST_LESS_MANY 1.0
/* What it may have missed is no less than this part of what they heard, however little this ping heard itself: a
 * level has farther to rise, in dB, than the error of its energy says. */
#define LEAST_MISSED 0.25
/* Unless it holds less by more standard errors than this: chance does not miss so much, the scene has changed. */
#define MOST_BY_CHANCE 5.0
/* Relative to the total; 8.7 dB, says that a level is not known. More would only stand out in reports: true
 * over stated error is the same with ten. */
#define MOST_ERROR 2.0

/* The error of echoes of ENERGY, linear, from their SPREAD over the ping's groups and what the block's calibration
 * found. What all rays missed is not in ENERGY: relative to that, in noise, its error would be next to nothing. */
WIDEST static void estimate_errors(const asdic_stated_error *restrict stated,
                                   const float *restrict spread, double most_less,
                                   const double *restrict energy, double noise_lin, size_t bins,
                                   double *restrict error) {
    for (size_t n = 0; n < bins; n++) {
        double of_groups = (double)stated[n].of_groups, of_block = (double)stated[n].of_block;
        double mean = (double)stated[n].mean_lin, missed = mean - energy[n];
        double mean2 = mean * mean, energy2 = energy[n] * energy[n];
        double total = energy[n] + noise_lin, less2 = most_less * total * total;
        double by_chance = MOST_BY_CHANCE * MOST_BY_CHANCE * of_block * mean2;
        double least2 = missed * missed < by_chance ? LEAST_MISSED * LEAST_MISSED * mean2 : 0.0;
        double known2 = mean2 < less2 ? mean2 : less2 > least2 ? less2 : least2;
        double own = of_groups * ((double)(spread[n] * spread[n]) * energy2);
        double variance = ASDIC_OWN_PING * own + of_block * (energy2 > known2 ? energy2 : known2);
        variance = (variance > own ? variance : own) + (double)stated[n].rare * known2;
        error[n] = sqrt(variance);
    }
}

/* Whether what came off objects is more than half of a bin's ECHO. */
static inline bool objects_rule(double object, double multipath, double echo) {
    return object + multipath > 0.5 * echo;
}

/* Bins that objects rule now, wherever they were when the block learnt: what the ping's groups suggest by the RATIO of
 * all bins that objects ruled then is the least error of theirs. */
WIDEST static void restate_objects(float ratio, const float *restrict spread,
                                   const double *restrict object, const double *restrict multipath,
                                   const double *restrict energy, size_t bins,
                                   double *restrict error) {
    for (size_t n = 0; n < bins; n++) {
        bool is_ruled = objects_rule(object[n], multipath[n], energy[n]);
        float random = ASDIC_NO_LATTICE * spread[n] * spread[n];
        float own = ratio > random ? ratio : random < 1.0f ? random : 1.0f;
        double groups = (double)(spread[n] * spread[n]) * (energy[n] * energy[n]);
        double least = is_ruled ? sqrt((double)own * groups) : 0.0;
        error[n] = error[n] > least ? error[n] : least;
    }
}

/* dB per relative error: 10 / ln 10. */
#define TO_DB 4.3429448190325175

/* An ERROR of TOTAL, both linear, in dB. */
static double error_db(double error, double total) {
    double part = total > 0.0 ? error / total : 0.0;
    return TO_DB * (part < MOST_ERROR ? part : MOST_ERROR);
}

/* ECHO and a bin's noise to the total, and the echo's ERROR to that of the total, in dB. */
WIDEST static void end_cells(const double *restrict echo, double noise_lin,
                             const double *restrict error, size_t bins, double *restrict noise,
                             double *restrict total, float *restrict stderr_db) {
    for (size_t n = 0; n < bins; n++) {
        double sum = echo[n] + noise_lin;
        noise[n] = noise_lin;
        total[n] = sum;
        stderr_db[n] = (float)error_db(error[n], sum);
    }
}

const asdic_component asdic_boundaries[ASDIC_BOUNDARIES] = {ASDIC_BOTTOM, ASDIC_SURFACE};

size_t asdic_first_bin(const double *energy, size_t bins) {
    size_t n = 0;
    while (n < bins && !(energy[n] > 0.0)) {
        n++;
    }
    return n;
}

/* The cells of a beam are worked on in blocks that stay in the nearest cache. */
#define BLOCK 256

/* A ping's sums on their way to levels. */
typedef struct conversion {
    asdic_simulator *sim;
    const asdic_ping_shot *shot;
    asdic_ping *out;
    asdic_drift drift;              /* since the simulator learnt */
    double unit[DEV_DEPOSIT_COUNT]; /* a quantum's energy at loss 1, by component */
    atomic_int status;              /* of beams that failed */
} conversion;

static double gain_of(const conversion *c, size_t beam) {
    return asdic_beam_axis_lin(&c->sim->setup.sonar.receivers[beam]);
}

static double noise_of(const conversion *c, size_t beam) {
    const asdic_sonar *sonar = &c->sim->setup.sonar;
    return asdic_noise_lin(&c->sim->setup.env, sonar, &sonar->receivers[beam],
                           c->shot->water.sound_speed_mps);
}

static void end_block(const double *echo, double noise_lin, const double *error, size_t at,
                      size_t count, asdic_ping *out) {
    end_cells(echo, noise_lin, error, count, out->intensity_lin[ASDIC_NOISE] + at,
              out->intensity_lin[ASDIC_TOTAL] + at, out->stderr_db + at);
}

/* First echoes of bottom and surface err as first echoes did when the simulator learnt, wherever they came then: as the
 * vehicle comes nearer to either they move to other bins, with cells of few rays. SPREAD: of the beam's bins, or NULL. */
static void restate_first_echoes(const conversion *k, size_t beam, const float *spread) {
    const asdic_setup *setup = &k->sim->setup;
    size_t bins = setup->bins, at = beam * bins;
    const double *total = k->out->intensity_lin[ASDIC_TOTAL] + at;
    const double *noise = k->out->intensity_lin[ASDIC_NOISE] + at;
    for (size_t b = 0; b < ASDIC_BOUNDARIES; b++) {
        size_t then = asdic_calibration_first_bin(k->sim, b, beam);
        const double *heard = k->out->intensity_lin[asdic_boundaries[b]] + at;
        size_t now = then < bins ? asdic_first_bin(heard, bins) : then;
        size_t end = now == then ? now : now + ASDIC_FIRST_BINS;
        for (; now < end && now < bins && then < bins; now++, then++) {
            double echo = total[now] - noise[now], error = 0.0;
            float own = spread ? spread[now] : 0.0f;
            float *stated = k->out->stderr_db + at + now;
            estimate_errors(&k->sim->learnt.stated[at + then], &own,
                            spread ? MOST_LESS_FEW : MOST_LESS_MANY, &echo, noise[now], 1, &error);
            *stated = fmaxf(*stated, (float)error_db(error, total[now]));
        }
    }
}

/* Bins in a row that the rays of an object may all miss. */
#define MOST_GAP 4

/* Energy of objects that may be missing beside CELL: what N rays brought, whose groups have a SPREAD of the root of 1 / N,
 * none may bring once in exp(N) times. */
static double missed_beside(const asdic_ping *out, size_t cell, double spread) {
    return out->intensity_lin[ASDIC_OBJECT][cell] *
           exp(-0.5 / (spread * spread)); /* spread 0: none */
}

/* Of few receivers: where the bins on both sides heard an object by a few rays, these may all have missed those between.
 * Their groups then agree that there is nothing. */
static void restate_gaps(const conversion *k, size_t beam, const float *spread) {
    asdic_ping *out = k->out;
    size_t at = beam * out->bins, before = SIZE_MAX;
    for (size_t n = 0; n < out->bins; n++) {
        if (!(out->intensity_lin[ASDIC_OBJECT][at + n] > 0.0)) {
            continue;
        }
        if (before != SIZE_MAX && n - before > 1 && n - before <= MOST_GAP + 1) {
            double missed = fmin(missed_beside(out, at + before, (double)spread[before]),
                                 missed_beside(out, at + n, (double)spread[n]));
            for (size_t gap = at + before + 1; gap < at + n; gap++) {
                double error = error_db(missed, out->intensity_lin[ASDIC_TOTAL][gap]);
                out->stderr_db[gap] = fmaxf(out->stderr_db[gap], (float)error);
            }
        }
        before = n;
    }
}

/* Quanta to energies of one beam. */
static void convert_beam(const conversion *k, unsigned worker, size_t beam) {
    const asdic_simulator *sim = k->sim;
    const asdic_ping_shot *shot = k->shot;
    const int64_t *quanta = (const int64_t *)shot->sums;
    const float *spread = (const float *)(quanta + sim->setup.components * sim->setup.cells + 1);
    size_t first = beam * sim->setup.bins;
    double noise_lin = noise_of(k, beam), gain = gain_of(k, beam);
    const asdic_stated_error *stated = asdic_drift_row(sim, &k->drift, worker, beam, false);
    for (size_t n = 0; n < sim->setup.bins; n += BLOCK) {
        size_t count = sim->setup.bins - n < BLOCK ? sim->setup.bins - n : BLOCK, at = first + n;
        double echo[BLOCK] = {0.0};
        double error[BLOCK] = {0.0};
        for (size_t c = 0; c < DEV_DEPOSIT_COUNT; c++) {
            double *energy = k->out->intensity_lin[asdic_component_of[c]] + at;
            const double *loss = c == DEV_DEPOSIT_VOLUME ? shot->volume : shot->loss;
            if (shot->ping->sums.present & 1u << c) {
                convert_whole(quanta + c * sim->setup.cells + at, k->unit[c] * gain, loss + n,
                              count, energy, echo);
            } else {
                asdic_clear(energy, count * sizeof *energy);
            }
        }
        if (!sim->setup.sampling.without_errors) {
            estimate_errors(stated + n, spread + at, MOST_LESS_FEW, echo, noise_lin, count, error);
            if (k->drift.is_any) {
                restate_objects(sim->learnt.object_ratio, spread + at,
                                k->out->intensity_lin[ASDIC_OBJECT] + at,
                                k->out->intensity_lin[ASDIC_MULTIPATH] + at, echo, count, error);
            }
        }
        end_block(echo, noise_lin, error, at, count, k->out);
    }
    if (!sim->setup.sampling.without_errors) {
        restate_first_echoes(k, beam, spread + first);
        if (shot->ping->sums.present & 1u << DEV_DEPOSIT_OBJECT) {
            restate_gaps(k, beam, spread + first);
        }
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
static void convert_fan_water(const conversion *c, size_t beam) {
    size_t bins = c->out->bins, left = c->out->beams - beam;
    const float *quanta[WATER_BEAMS];
    double crossing[WATER_BEAMS] = {0.0}, unit[WATER_BEAMS], *energy[WATER_BEAMS];
    for (size_t k = 0; k < WATER_BEAMS; k++) {
        size_t own = beam + (k < left ? k : 0); /* behind the last the first again */
        quanta[k] = asdic_beam_fan_row(&c->sim->fan, c->shot->sums, own, DEV_DEPOSIT_VOLUME);
        unit[k] = c->unit[DEV_DEPOSIT_VOLUME] * gain_of(c, own);
        energy[k] = c->out->intensity_lin[ASDIC_VOLUME] + own * bins;
    }
    for (size_t n = bins; n-- > 0;) {
        for (size_t k = 0; k < WATER_BEAMS; k++) {
            crossing[k] += (double)quanta[k][n];
            energy[k][n] = crossing[k] * unit[k] * c->shot->volume[n];
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

/* What COUNT cells from AT on state, those that objects rule and the OTHERS. OBJECTS: NULL, if there is no
 * difference. */
static const asdic_stated_error *choose_stated(const conversion *k, size_t at,
                                               const asdic_stated_error *objects,
                                               const asdic_stated_error *others, const double *echo,
                                               size_t count, asdic_stated_error *chosen) {
    const double *object = k->out->intensity_lin[ASDIC_OBJECT] + at;
    const double *multipath = k->out->intensity_lin[ASDIC_MULTIPATH] + at;
    for (size_t i = 0; objects && i < count; i++) {
        chosen[i] = objects_rule(object[i], multipath[i], echo[i]) ? objects[i] : others[i];
    }
    return objects ? chosen : others;
}

/* The LARGEST of the echoes that single rays bring by way of mirrors might as well have gone to another bin: by so much
 * ERROR is more where there are few beside it, less the more there are. MULTIPATH is what they bring together. */
WIDEST static void restate_single(const float *restrict largest, double unit,
                                  const double *restrict loss, const double *restrict multipath,
                                  size_t bins, double *restrict error) {
    for (size_t n = 0; n < bins; n++) {
        double single = (double)largest[n] * unit * loss[n];
        double least = multipath[n] > 0.0 ? single * single / multipath[n] : 0.0;
        error[n] = error[n] > least ? error[n] : least;
    }
}

/* Once the vehicle has gone on, rays that the lesson did not foresee may all miss a bin between two louder ones. In ping
 * 20 of data/scenes/mission_fan.yaml bins 2 to 4 dB below the less loud of both erred by 2.4 stated errors r.m.s., 8 to
 * 12 dB below it by 5.0; in ping 60 by 1.2 and 2.5. What they state grows with the root of the ratio. */
static void restate_dips(asdic_ping *out, size_t beam) {
    const double *total = out->intensity_lin[ASDIC_TOTAL] + beam * out->bins;
    float *stderr_db = out->stderr_db + beam * out->bins;
    for (size_t n = 1; n + 1 < out->bins; n++) {
        double beside = fmin(total[n - 1], total[n + 1]);
        if (total[n] > 0.0 && beside > total[n]) {
            stderr_db[n] =
                (float)fmin((double)stderr_db[n] * sqrt(beside / total[n]), TO_DB * MOST_ERROR);
        }
    }
}

/* convert_beam of a fan. */
static void convert_fan_beam(const conversion *k, unsigned worker, size_t beam) {
    const asdic_simulator *sim = k->sim;
    const asdic_ping_shot *shot = k->shot;
    size_t first = beam * sim->setup.bins, bins = sim->setup.bins;
    double noise_lin = noise_of(k, beam), gain = gain_of(k, beam);
    const asdic_stated_error *others = asdic_drift_row(sim, &k->drift, worker, beam, false);
    bool is_moved = k->drift.objects.bins != k->drift.others.bins ||
                    k->drift.objects.beams != k->drift.others.beams;
    const asdic_stated_error *objects =
        is_moved ? asdic_drift_row(sim, &k->drift, worker, beam, true) : NULL;
    if (beam % WATER_BEAMS == 0) {
        convert_fan_water(k, beam);
    }
    for (size_t n = 0; n < bins; n += BLOCK) {
        size_t count = bins - n < BLOCK ? bins - n : BLOCK, at = first + n;
        double echo[BLOCK] = {0.0};
        double error[BLOCK] = {0.0};
        for (size_t c = 0; c < DEV_DEPOSIT_COUNT; c++) {
            double *energy = k->out->intensity_lin[asdic_component_of[c]] + at;
            const float *quanta = asdic_beam_fan_row(&sim->fan, shot->sums, beam, c) + n;
            if (c == DEV_DEPOSIT_VOLUME) {
                add(energy, count, echo);
            } else if (shot->ping->sums.present & 1u << c && holds_any(quanta, count)) {
                convert_fan_echo(quanta, k->unit[c] * gain, shot->loss + n, count, energy, echo);
            } else {
                asdic_clear(energy, count * sizeof *energy);
            }
        }
        if (!sim->setup.sampling.without_errors) {
            static const float none[BLOCK];
            asdic_stated_error chosen[BLOCK];
            const asdic_stated_error *stated =
                choose_stated(k, at, objects ? objects + n : NULL, others + n, echo, count, chosen);
            estimate_errors(stated, none, MOST_LESS_MANY, echo, noise_lin, count, error);
            if (shot->ping->sums.present & 1u << DEV_DEPOSIT_MULTIPATH) {
                const float *largest =
                    asdic_beam_fan_row(&sim->fan, shot->sums, beam, sim->fan.sums - 1) + n;
                restate_single(largest, k->unit[DEV_DEPOSIT_MULTIPATH] * gain, shot->loss + n,
                               k->out->intensity_lin[ASDIC_MULTIPATH] + at, count, error);
            }
        }
        end_block(echo, noise_lin, error, at, count, k->out);
    }
    if (!sim->setup.sampling.without_errors) {
        if (k->drift.others.bins + k->drift.others.beams > 0) {
            restate_dips(k->out, beam);
        }
        restate_first_echoes(k, beam, NULL);
    }
}

_Static_assert(DEV_FAN_TILE % ASDIC_TRUTH_BEAMS == 0, "threads take parts of tiles");

/* Beams FIRST to END, which are of one tile. */
static asdic_status convert_some(const conversion *c, unsigned worker, size_t first, size_t end) {
    asdic_simulator *sim = c->sim;
    if (sim->fan.many) {
        TRY(asdic_beam_fan_wait(&sim->fan, first / DEV_FAN_TILE));
    }
    for (size_t beam = first; beam < end; beam++) {
        if (sim->fan.many) {
            convert_fan_beam(c, worker, beam);
        } else {
            convert_beam(c, worker, beam);
        }
    }
    asdic_truth_tell(sim, c->shot, worker, first, c->out);
    return ASDIC_OK;
}

static void convert_beams(void *user, unsigned worker, size_t first, size_t end) {
    conversion *c = user;
    asdic_status status = convert_some(c, worker, first, end);
    if (status) {
        atomic_store(&c->status, (int)status);
    }
}

asdic_status asdic_simulator_convert(asdic_simulator *sim, const asdic_ping_shot *shot,
                                     double source_lin, asdic_ping *out) {
    conversion c = {
        .sim = sim, .shot = shot, .out = out, .drift = asdic_drift_since(sim, &shot->pose)};
    for (int k = 0; k < DEV_DEPOSIT_COUNT; k++) {
        c.unit[k] = source_lin / shot->ping->sums.scale[k];
    }
    asdic_share(sim->setup.threads, out->beams, ASDIC_TRUTH_BEAMS, convert_beams, &c);
    size_t sums = sim->setup.components * sim->setup.cells;
    out->saturated = sim->fan.many ? 0 : (uint64_t)((const int64_t *)shot->sums)[sums];
    return (asdic_status)atomic_load(&c.status);
}
