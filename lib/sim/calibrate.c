/*
 * Calibration: how much the spread of a ping's groups overstates the error of the ping.
 *
 * A lattice of N points errs like 1 / N. Its 16 interleaved subsets of N / 16 points err more than random
 * subsets would, so that their spread, taken at face value, overstates the error of the whole. A few more
 * pings with lattice shifts of their own, once per block of pings, show the true error. Its ratio to what
 * the groups suggest corrects the stated errors of the block. A ping of many receivers has one group and a
 * nominal spread of 1: there the ratio is the relative variance itself.
 *
 * Edges of objects make a lattice err less like 1 / N than water and bottom do, and so does the nearest spot of the
 * bottom or the surface, whose rim cuts through the lattice. So bins that objects rule share a ratio among
 * themselves, over all beams, those of first echoes among themselves, and the others among themselves. Open
 * water, too, may err more than the boundaries whose ratio its bins share: through layers a narrow beam has few
 * rays far away. Its own variance, by the ratio of all bins that water rules, is the least that a bin has of its
 * share.
 *
 * The calibration also shows what a ping may have missed: a ping that holds less energy than the
 * calibration's pings knows less of its error than they do.
 *
 * tests/kernel/test_honesty*.c measure true over stated error in scenes of every kind; the constants below
 * were chosen by them.
 */
#include "simulator.h"

#include "aim.h"
#include "base/context.h"
#include "base/sort.h"
#include "base/try.h"
#include "base/widest.h"
#include "drift.h"
#include "pulse.h"
#include "ring.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Pings of a calibration. The variance of a cell has one degree of freedom less. */
#define PINGS 3
/* The same where a receiver among many has few beside it that are like it. */
#define PINGS_ALONE ASDIC_MOST_CALIBRATION
/* Median of a normal error's mean square with two degrees of freedom. */
#define MEDIAN_SQUARE 0.693
/* Bins on each side that share a ratio. */
#define WINDOW 16
/* A beam's typical ratio counts as much as this many bins. Neighbouring bins see the same water and err
 * alike: together they tell less than as many independent ones. */
#define TYPICAL_WEIGHT 6.0
#define TYPICAL_SAMPLES 128
/* Variances of ASDIC_FIRST_BINS over those of the bins behind, as measured; counts as TYPICAL_WEIGHT bins. */
#define FIRST_RATIO 2.3
/* All bins of a beam that water rules err alike: of one error three pings tell little, and may agree by chance. The
 * spread of G subsets of a lattice suggests G times its variance: so much of that ratio is added to what they tell. */
#define HALF_A_LATTICE 0.5
/* A cell's ratio is cut to this: else a few rare bright rays would rule the window. */
#define MOST_RATIO 20.0
/* The variance that groups suggest is averaged: ASDIC_OWN_PING of it is this ping's, OWN_BIN the
 * calibration's in the same bin, NEIGHBOURS the calibration's in the bins beside it. A ping that missed a
 * rare bright ray cannot tell so from its own groups. */
#define OWN_BIN 0.4
#define NEIGHBOURS (1.0 - ASDIC_OWN_PING - OWN_BIN)
/* This share of a bin's own variance in the calibration is added: spikes err unlike their neighbours. */
#define OWN_ERROR 0.1
/* Where the larger of several estimates is taken, the variance comes out too large by this factor, as
 * measured over scenes of every kind. */
#define LARGER_OF_SEVERAL 1.25
/* A cell of more than this relative variance holds an echo or two of a rare kind, such as mirrors give. The
 * bins within RARE_WINDOW on each side might as well have held it. */
#define RARE 0.7
#define RARE_WINDOW 6
/* The square of the mean of N pings exceeds that of the true mean by its variance, an Nth of a ping's. What is left
 * of it is at least this share: of an echo that one ping alone holds nothing is left. */
#define LEAST_KNOWN 1e-3
/* Receivers, and bins, on each side that share an error where receivers are many. */
#define BEAM_WINDOW 8
#define BIN_WINDOW 1
/* They share it while they are alike: sides of apertures within this factor, and pitch within this part of a
 * beam's width. Of a sonar of unlike beams, as of two heads, a narrow beam errs more than a broad one beside it. */
#define ALIKE_SIDE 1.1
#define ALIKE_PITCH 0.5
/* With fewer alike, itself included, a receiver is alone: more of its own bins share an error. */
#define LEAST_ALIKE 5
#define BIN_WINDOW_ALONE 4
/* A first echo is one bin's, and the same few rays bring it to many receivers: those beside one another tell little
 * more than one of them, whose three pings may agree by chance. Half of its variance is then the mean of all receivers
 * that hear it within this factor as loud, 6 dB. */
#define ALIKE_LEVEL 4.0
/* It counts as at most so many times that of the receivers beside: those that err less are not said to err as the rest.
 * Twelve fans of 64 to 256 beams over sand: 0.25 % of the bins of first echoes beyond five stated errors without, 0.07 %
 * by 8 times, 0.04 % by any; but by any 23 % of such bins of a fan over terrain.ply state more than 2.5 times their
 * error, by 8 times 13 %, without 5 %. */
#define MOST_OF_ALIKE 8.0

/* The receivers from LOW to HIGH share an error with a receiver between them. */
typedef struct alike {
    size_t low, high;
} alike;

/* What a cell's error is like. */
typedef enum error_kind { OF_OBJECTS, OF_FIRST_ECHO, OF_THE_REST } error_kind;

/* Where a receiver first hears the bottom, and the surface. */
typedef struct first_bins {
    size_t of[ASDIC_BOUNDARIES];
} first_bins;

/* What the calibration's pings gave, per cell. The memory is kept from block to block: for many beams and
 * bins it is a hundred megabytes, which take longer to allocate than to fill. */
typedef struct asdic_calibration {
    asdic_arena memory;             /* of all that follows but pings */
    uint32_t count;                 /* pings */
    double *energy[PINGS_ALONE];    /* without noise */
    double *mean;                   /* of the energies before the pulse's length */
    float *suggested;               /* mean of the relative variances that the groups suggest */
    float *rare;                    /* the same, 0 in cells of RARE or less */
    float *objects, *water;         /* of the mean, what came off objects, off water */
    asdic_ping *pings[PINGS_ALONE]; /* the latest; as many as go to the device together */
    double *row;                    /* scratch, 5 (bins or receivers + 1) */
    uint8_t *kind;                  /* error_kind; with few receivers */
    first_bins *first, *sharp;      /* of each receiver; sharp: before the pulse's length */
    first_bins axis;                /* where that meets them which a fan's beams turn about */
    alike *alike;                   /* of each receiver where they are many, else NULL */
} calibration;

/* The relative variance of one ping, from how the calibration's pings differ in a cell; negative: the cell
 * is empty. */
static double cell_variance(const calibration *c, size_t cell) {
    double sum = 0.0, squares = 0.0;
    for (uint32_t k = 0; k < c->count; k++) {
        sum += c->energy[k][cell];
    }
    double mean = sum / c->count;
    for (uint32_t k = 0; k < c->count; k++) {
        double d = c->energy[k][cell] - mean;
        squares += d * d;
    }
    return mean > 0.0 && c->suggested[cell] > 0.0f ? squares / ((c->count - 1) * mean * mean)
                                                   : -1.0;
}

static double cell_ratio(const calibration *c, size_t cell) {
    double variance = cell_variance(c, cell);
    return variance < 0.0 ? -1.0 : fmin(variance / c->suggested[cell], MOST_RATIO);
}

static bool is_among(const first_bins *first, size_t bin) {
    bool is_of = false;
    for (size_t k = 0; k < ASDIC_BOUNDARIES; k++) {
        is_of = is_of || (bin >= first->of[k] && bin - first->of[k] < ASDIC_FIRST_BINS);
    }
    return is_of;
}

/* Or of what lies where all beams of a fan meet: few rays bring that to all of them, too. */
static bool is_of_first_echo(const calibration *c, size_t beam, size_t bin) {
    return is_among(&c->first[beam], bin) || is_among(&c->axis, bin);
}

static bool is_ruled_by_water(const calibration *c, size_t cell) {
    return c->water[cell] > 0.5 * c->mean[cell];
}

static bool is_ruled_by_first_echo(const asdic_simulator *sim, const calibration *c, size_t beam,
                                   size_t bin) {
    return is_of_first_echo(c, beam, bin) && !is_ruled_by_water(c, beam * sim->setup.bins + bin);
}

static void find_kinds(const asdic_simulator *sim, calibration *c) {
    size_t bins = sim->setup.bins;
    for (size_t b = 0; b < sim->setup.sonar.receiver_count; b++) {
        for (size_t n = 0; n < bins; n++) {
            size_t cell = b * bins + n;
            c->kind[cell] = c->objects[cell] > 0.5 * c->mean[cell] ? OF_OBJECTS
                            : is_ruled_by_first_echo(sim, c, b, n) ? OF_FIRST_ECHO
                                                                   : OF_THE_REST;
        }
    }
}

/* The ratio of a cell of KIND; negative: it is of another, or empty. */
static double ratio_among(const calibration *c, error_kind kind, size_t cell) {
    return c->kind[cell] == kind ? cell_ratio(c, cell) : -1.0;
}

/* The typical ratio of the rest of a beam whose bins begin at cell FIRST: from the median, which outliers in deep
 * nulls do not move. */
static double typical_ratio(const asdic_simulator *sim, size_t first, const calibration *c) {
    double ratios[TYPICAL_SAMPLES];
    size_t count = 0, step = (sim->setup.bins + TYPICAL_SAMPLES - 1) / TYPICAL_SAMPLES;
    for (size_t n = 0; n < sim->setup.bins; n += step) {
        double ratio = ratio_among(c, OF_THE_REST, first + n);
        if (ratio >= 0.0) {
            ratios[count++] = ratio;
        }
    }
    asdic_sort_doubles(ratios, count);
    return count ? ratios[count / 2] / MEDIAN_SQUARE : 1.0;
}

typedef struct ratio_sum {
    double sum, count;
} ratio_sum;

static void add_ratio(ratio_sum *to, double ratio) {
    to->sum += fmax(ratio, 0.0);
    to->count += ratio >= 0.0;
}

/* FALLBACK counts as WEIGHT cells, or as all where there are none. */
static double mean_of(ratio_sum ratios, double fallback, double weight) {
    double count = ratios.count + weight;
    return count > 0.0 ? (ratios.sum + weight * fallback) / count : fallback;
}

/* Over all beams; of water, of the cells that it rules. */
typedef struct shared_ratios {
    double objects, first_echo, water;
} shared_ratios;

static shared_ratios share_ratios(const asdic_simulator *sim, const calibration *c) {
    ratio_sum objects = {0}, first = {0}, water = {0}, rest = {0};
    for (size_t cell = 0; cell < sim->setup.cells; cell++) {
        add_ratio(&objects, ratio_among(c, OF_OBJECTS, cell));
        add_ratio(&first, ratio_among(c, OF_FIRST_ECHO, cell));
        add_ratio(&water, is_ruled_by_water(c, cell) ? cell_ratio(c, cell) : -1.0);
    }
    for (size_t cell = 0; cell < sim->setup.cells; cell += sim->setup.bins) {
        add_ratio(&rest, typical_ratio(sim, cell, c));
    }
    double usual = FIRST_RATIO * mean_of(rest, 1.0, 0.0);
    return (shared_ratios){.objects = mean_of(objects, 1.0, 0.0),
                           .first_echo = mean_of(first, usual, TYPICAL_WEIGHT),
                           .water = mean_of(water, 1.0, 0.0) + HALF_A_LATTICE / sim->setup.groups};
}

/* SUMS[n] is the sum of the first n VALUES; within() is then the sum of those within REACH of bin N. */
static void add_up(const double *values, size_t bins, double *sums) {
    sums[0] = 0.0;
    for (size_t n = 0; n < bins; n++) {
        sums[n + 1] = sums[n] + values[n];
    }
}

static double within(const double *sums, size_t bins, size_t n, size_t reach) {
    size_t from = n > reach ? n - reach : 0, to = n + reach + 1 < bins ? n + reach + 1 : bins;
    return sums[to] - sums[from];
}

static double neighbours_of(const float *values, size_t n, size_t bins) {
    double before = values[n > 0 ? n - 1 : n], after = values[n + 1 < bins ? n + 1 : n];
    return (before + values[n] + after) / 3.0;
}

/* Square of the range of bin N's middle, in bins. */
static double range2_of(size_t n) {
    return ((double)n + 0.5) * ((double)n + 0.5);
}

/* The variance that rare echoes of the bins around add to each bin. An echo moved to another bin changes as
 * range^-2. */
static void spread_rare(const asdic_simulator *sim, size_t first, const calibration *c,
                        asdic_stated_error *stated) {
    size_t bins = sim->setup.bins;
    double *values = c->row, *sums = values + bins + 1;
    for (size_t n = 0; n < bins; n++) {
        double at_one = c->mean[first + n] * range2_of(n);
        values[n] = c->rare[first + n] * at_one * at_one;
    }
    add_up(values, bins, sums);
    for (size_t n = 0; n < bins; n++) {
        double mean = c->mean[first + n] * range2_of(n);
        double shared = within(sums, bins, n, RARE_WINDOW) / (2 * RARE_WINDOW + 1);
        stated[n].rare = mean > 0.0 ? (float)fmin(0.5 * shared / (mean * mean), 1e6) : 0.0f;
    }
}

/* The relative variance of the water of a beam whose bins begin at cell FIRST: all of them have the same, of the
 * rays that cross them. From those bins that it rules; 0 without such. */
static double water_variance(const asdic_simulator *sim, size_t first, double ratio,
                             const calibration *c) {
    double sum = 0.0, count = 0.0;
    for (size_t cell = first; cell < first + sim->setup.bins; cell++) {
        bool counts = is_ruled_by_water(c, cell) && c->suggested[cell] > 0.0f;
        sum += counts ? ratio / LARGER_OF_SEVERAL * (double)c->suggested[cell] : 0.0;
        count += counts;
    }
    return count > 0.0 ? sum / count : 0.0;
}

/* The bins of a beam that are of KIND; of the WATER's variance each has its share. */
static void calibrate_bins(asdic_simulator *sim, size_t first, error_kind kind, double typical,
                           double water, const calibration *c) {
    size_t bins = sim->setup.bins;
    double *values = c->row, *sums = values + bins + 1, *counts = sums + bins + 1;
    for (size_t n = 0; n < bins; n++) {
        values[n] = fmax(ratio_among(c, kind, first + n), 0.0);
    }
    add_up(values, bins, sums);
    for (size_t n = 0; n < bins; n++) {
        values[n] = ratio_among(c, kind, first + n) >= 0.0;
    }
    add_up(values, bins, counts);
    for (size_t n = 0; n < bins; n++) {
        if (c->kind[first + n] != kind) {
            continue;
        }
        double ratio = (within(sums, bins, n, WINDOW) + TYPICAL_WEIGHT * typical) /
                       (within(counts, bins, n, WINDOW) + TYPICAL_WEIGHT);
        double block = OWN_BIN * c->suggested[first + n] +
                       NEIGHBOURS * neighbours_of(c->suggested + first, n, bins);
        double own = OWN_ERROR * fmax(cell_variance(c, first + n), 0.0) / LARGER_OF_SEVERAL;
        double share = c->mean[first + n] > 0.0 ? c->water[first + n] / c->mean[first + n] : 0.0;
        ratio /= LARGER_OF_SEVERAL;
        ratio =
            kind == OF_OBJECTS ? fmax(ratio, fmin((double)ASDIC_NO_LATTICE * block, 1.0)) : ratio;
        sim->learnt.stated[first + n] = (asdic_stated_error){
            .of_groups = (float)ratio,
            .of_block = (float)(fmax(ratio * block, share * share * water) + own),
            .mean_lin = (float)c->mean[first + n]};
    }
}

static void calibrate_beam(asdic_simulator *sim, size_t beam, shared_ratios shared,
                           const calibration *c) {
    size_t first = beam * sim->setup.bins;
    double water = water_variance(sim, first, shared.water, c);
    calibrate_bins(sim, first, OF_OBJECTS, shared.objects, water, c);
    calibrate_bins(sim, first, OF_FIRST_ECHO, shared.first_echo, water, c);
    calibrate_bins(sim, first, OF_THE_REST, typical_ratio(sim, first, c), water, c);
    spread_rare(sim, first, c, sim->learnt.stated + first);
}

static bool are_alike(const asdic_beam *a, const asdic_beam *b, double wavelength_m) {
    double h = a->length_h_m / b->length_h_m, v = a->length_v_m / b->length_v_m;
    double width_rad = wavelength_m / fmax(a->length_v_m, b->length_v_m);
    return fmax(h, 1.0 / h) < ALIKE_SIDE && fmax(v, 1.0 / v) < ALIKE_SIDE &&
           fabs(a->pitch_rad - b->pitch_rad) < ALIKE_PITCH * width_rad;
}

static bool is_alone(const alike *a) {
    return a->high - a->low + 1 < LEAST_ALIKE;
}

/* Of many receivers, those that share an error with each; how many pings that takes. */
static uint32_t find_alike(const asdic_sonar *sonar, alike *out) {
    const asdic_beam *beams = sonar->receivers;
    double wavelength_m = ASDIC_NOMINAL_MPS / sonar->frequency_hz;
    uint32_t pings = PINGS;
    for (size_t b = 0; b < sonar->receiver_count; b++) {
        size_t low = b, high = b, last = sonar->receiver_count - 1;
        while (low > 0 && b - low < BEAM_WINDOW &&
               are_alike(&beams[b], &beams[low - 1], wavelength_m)) {
            low--;
        }
        while (high < last && high - b < BEAM_WINDOW &&
               are_alike(&beams[b], &beams[high + 1], wavelength_m)) {
            high++;
        }
        out[b] = (alike){low, high};
        pings = is_alone(&out[b]) ? PINGS_ALONE : pings;
    }
    return pings;
}

/* The mean relative variance of beam B's bins round bin N, of those that hold anything; negative: none does. A first
 * echo's bin has its own alone. */
static double beam_variance(const asdic_simulator *sim, size_t b, size_t n, const calibration *c) {
    size_t bins = sim->setup.bins, reach = is_of_first_echo(c, b, n) ? 0
                                           : is_alone(&c->alike[b])  ? BIN_WINDOW_ALONE
                                                                     : BIN_WINDOW;
    size_t from = n > reach ? n - reach : 0, to = n + reach < bins ? n + reach : bins - 1;
    double variance[2 * BIN_WINDOW_ALONE + 1], known = 0.0, mean = 0.0;
    for (size_t k = from; k <= to; k++) {
        variance[k - from] = cell_variance(c, b * bins + k);
        known += variance[k - from] >= 0.0;
    }
    for (size_t k = from; k <= to; k++) {
        mean += fmax(variance[k - from], 0.0) / known;
    }
    return known > 0.0 ? mean : -1.0;
}

/* A first echo of LEVEL and VARIANCE to those of the COUNT LEVELS that are alike: sums of variances, and how many. */
WIDEST static void add_alike(double level, double variance, const double *restrict levels,
                             size_t count, double *restrict sums, double *restrict counts) {
    for (size_t b = 0; b < count; b++) {
        bool is_alike = level < ALIKE_LEVEL * levels[b] && levels[b] < ALIKE_LEVEL * level;
        sums[b] += is_alike ? variance : 0.0;
        counts[b] += is_alike ? 1.0 : 0.0;
    }
}

/* The VARIANCES of all receivers in bin N: MEANS become those over receivers that hear a first echo as loud, but for
 * their sensitivities; negative: one that hears none. SCRATCH: two rows. */
static void share_first_echoes(const asdic_simulator *sim, size_t n, const double *variances,
                               const calibration *c, double *scratch, double *means) {
    size_t beams = sim->setup.sonar.receiver_count;
    double *levels = scratch, *counts = levels + beams;
    for (size_t b = 0; b < beams; b++) {
        bool is_first = is_ruled_by_first_echo(sim, c, b, n);
        levels[b] = is_first ? c->mean[b * sim->setup.bins + n] /
                                   asdic_beam_axis_lin(&sim->setup.sonar.receivers[b])
                             : 0.0;
        means[b] = counts[b] = 0.0;
    }
    for (size_t b = 0; b < beams; b++) {
        if (levels[b] > 0.0) {
            add_alike(levels[b], variances[b], levels, beams, means, counts);
        }
    }
    for (size_t b = 0; b < beams; b++) {
        means[b] = counts[b] > 0.0 ? means[b] / counts[b] : -1.0;
    }
}

/* The same with many receivers: neighbouring receivers see much the same and share an error. Where all of them heard
 * nothing, it is not known. */
static void calibrate_bin(asdic_simulator *sim, size_t n, const calibration *c) {
    size_t beams = sim->setup.sonar.receiver_count, bins = sim->setup.bins;
    double *values = c->row, *known = values + beams + 1, *sums = known + beams + 1,
           *counts = sums + beams + 1, *means = counts + beams + 1;
    for (size_t b = 0; b < beams; b++) {
        double variance = beam_variance(sim, b, n, c);
        values[b] = fmax(variance, 0.0);
        known[b] = variance >= 0.0;
    }
    share_first_echoes(sim, n, values, c, sums, means); /* and counts */
    add_up(values, beams, sums);
    add_up(known, beams, counts);
    for (size_t b = 0; b < beams; b++) {
        size_t low = c->alike[b].low, high = c->alike[b].high;
        double count = counts[high + 1] - counts[low];
        double mean = count > 0.0 ? (sums[high + 1] - sums[low]) / count : 0.0;
        if (means[b] >= 0.0) {
            mean = 0.5 * (mean + fmin(means[b], MOST_OF_ALIKE * mean));
        }
        double shared = count > 0.0 ? mean / fmax(1.0 - mean / c->count, LEAST_KNOWN) : 1.0;
        double own = OWN_ERROR * fmax(cell_variance(c, b * bins + n), 0.0);
        sim->learnt.stated[b * bins + n] =
            (asdic_stated_error){.of_groups = count > 0.0,
                                 .of_block = (float)(shared + own),
                                 .mean_lin = (float)c->mean[b * bins + n]};
    }
}

/* Takes ping K. Before a calibration a ping states what its groups suggest, so that its stated error is
 * theirs. */
static void take_ping(const asdic_simulator *sim, const asdic_ping *ping, uint32_t k,
                      calibration *c) {
    for (size_t cell = 0; cell < sim->setup.cells; cell++) {
        double total = ping->intensity_lin[ASDIC_TOTAL][cell];
        double energy = total - ping->intensity_lin[ASDIC_NOISE][cell];
        double spread =
            energy > 0.0 ? log(10.0) / 10.0 * ping->stderr_db[cell] * total / energy : 0.0;
        double variance = spread * spread / c->count;
        c->suggested[cell] += (float)variance;
        c->rare[cell] += spread * spread > RARE ? (float)variance : 0.0f;
        c->energy[k][cell] = energy;
    }
}

/* Where each receiver FIRST hears the bottom, and the surface, in any ping. */
static void take_first_bins(const asdic_simulator *sim, const asdic_ping *ping, first_bins *first) {
    for (size_t k = 0; k < ASDIC_BOUNDARIES; k++) {
        const double *energy = ping->intensity_lin[asdic_boundaries[k]];
        for (size_t b = 0; b < sim->setup.sonar.receiver_count; b++) {
            size_t *bin = &first[b].of[k];
            *bin = asdic_first_bin(energy + b * sim->setup.bins, *bin);
        }
    }
}

/* Before the first of them. */
static void forget_first_bins(const asdic_simulator *sim, calibration *c) {
    for (size_t b = 0; b < sim->setup.sonar.receiver_count; b++) {
        for (size_t k = 0; k < ASDIC_BOUNDARIES; k++) {
            c->first[b].of[k] = c->sharp[b].of[k] = sim->setup.bins;
        }
    }
}

/* The beams of a fan meet in the axis that they turn about, straight below and above one that lies level. */
static first_bins find_axis(const asdic_simulator *sim, const asdic_pose *pose) {
    first_bins axis = {{sim->setup.bins, sim->setup.bins}};
    if (!sim->fan.common_axis) {
        return axis;
    }
    double down = fabs((double)asdic_shot_beams(&sim->shots[0])[1].rows[8]);
    double way_m[ASDIC_BOUNDARIES] = {asdic_scene_altitude_m(sim->setup.scene, pose->position_m),
                                      pose->position_m.z}; /* as asdic_boundaries */
    for (size_t k = 0; k < ASDIC_BOUNDARIES; k++) {
        double bin = way_m[k] / (down * sim->setup.sonar.bin_length_m);
        if (bin >= 0.0 && bin < (double)sim->setup.bins) {
            axis.of[k] = (size_t)bin;
        }
    }
    return axis;
}

static void take_mean(const asdic_simulator *sim, const asdic_ping *ping, calibration *c) {
    double *const *part = ping->intensity_lin;
    for (size_t cell = 0; cell < sim->setup.cells; cell++) {
        c->mean[cell] += (part[ASDIC_TOTAL][cell] - part[ASDIC_NOISE][cell]) / c->count;
        c->water[cell] += (float)(part[ASDIC_VOLUME][cell] / c->count);
    }
}

/* With few receivers. */
static void take_objects(const asdic_simulator *sim, const asdic_ping *ping, calibration *c) {
    double *const *part = ping->intensity_lin;
    for (size_t cell = 0; cell < sim->setup.cells; cell++) {
        c->objects[cell] +=
            (float)((part[ASDIC_OBJECT][cell] + part[ASDIC_MULTIPATH][cell]) / c->count);
    }
}

/* Runs the calibration's pings, pulse included: the errors of neighbouring bins are negatively correlated,
 * and a pulse takes out more of such errors than of independent ones. Bins of the blanking that the pulses of pings will
 * carry over its end are learnt, too. */
static asdic_status run_pings(asdic_simulator *sim, const asdic_pose *pose, uint64_t index,
                              calibration *c) {
    asdic_sonar heard = sim->setup.sonar;
    heard.blanking_m = sim->setup.from_m;
    memset(c->suggested, 0, sim->setup.cells * sizeof *c->suggested);
    memset(c->rare, 0, sim->setup.cells * sizeof *c->rare);
    memset(c->mean, 0, sim->setup.cells * sizeof *c->mean);
    memset(c->water, 0, sim->setup.cells * sizeof *c->water);
    if (!sim->fan.many) { /* what take_objects adds up */
        memset(c->objects, 0, sim->setup.cells * sizeof *c->objects);
    }
    forget_first_bins(sim, c);
    for (uint32_t k = 0; k < c->count;) {
        uint32_t left = c->count - k;
        uint32_t together = sim->setup.ping_batch < left ? (uint32_t)sim->setup.ping_batch : left;
        for (uint32_t i = 0; i < together; i++) {
            asdic_shot_aim(sim, &sim->shots[i], pose, index, ASDIC_STREAM_CALIBRATION(k + i),
                           sim->setup.sampling.rays);
        }
        c->axis = find_axis(sim, pose);
        TRY(asdic_simulator_simulate(sim, together, c->pings));
        for (uint32_t i = 0; i < together; i++, k++) {
            take_mean(sim, c->pings[i], c);
            if (!sim->fan.many) {
                take_objects(sim, c->pings[i], c);
            }
            take_first_bins(sim, c->pings[i], c->sharp);
            asdic_pulse_smear(&heard, sim->shots[i].water.sound_speed_mps, sim->setup.threads,
                              sim->host.scratch, c->pings[i], c->pings[i]);
            take_ping(sim, c->pings[i], k, c);
            take_first_bins(sim, c->pings[i], c->first);
        }
    }
    return ASDIC_OK;
}

static asdic_status allocate(const asdic_simulator *sim, calibration *c) {
    const asdic_setup *setup = &sim->setup;
    size_t cells = setup->cells, beams = setup->sonar.receiver_count;
    size_t longest = setup->bins > beams ? setup->bins : beams;
    asdic_arena *a = &c->memory;
    c->count = PINGS;
    if (sim->fan.many) {
        c->alike = asdic_arena_alloc(a, beams * sizeof *c->alike);
        c->count = c->alike ? find_alike(&setup->sonar, c->alike) : PINGS;
    }
    for (uint32_t k = 0; k < c->count; k++) {
        c->energy[k] = asdic_arena_alloc(a, cells * sizeof(double));
    }
    c->mean = asdic_arena_alloc(a, cells * sizeof *c->mean);
    c->suggested = asdic_arena_alloc(a, cells * sizeof *c->suggested);
    c->rare = asdic_arena_alloc(a, cells * sizeof *c->rare);
    c->objects = asdic_arena_alloc(a, cells * sizeof *c->objects);
    c->water = asdic_arena_alloc(a, cells * sizeof *c->water);
    c->row = asdic_arena_alloc(a, 5 * (longest + 1) * sizeof *c->row);
    c->kind = asdic_arena_alloc(a, cells);
    c->first = asdic_arena_alloc(a, beams * sizeof *c->first);
    c->sharp = asdic_arena_alloc(a, beams * sizeof *c->sharp);
    if (a->is_short) {
        return asdic_fail_memory(sim->ctx, "a calibration");
    }
    for (size_t k = 0; k < c->count && k < setup->ping_batch; k++) {
        TRY(asdic_ping_create(sim->ctx, beams, setup->bins, &c->pings[k]));
    }
    return ASDIC_OK;
}

static asdic_status calibration_create(asdic_simulator *sim) {
    if (sim->learnt.calibration) {
        return ASDIC_OK;
    }
    calibration *c = calloc(1, sizeof *c);
    asdic_status status = c ? allocate(sim, c) : asdic_fail_memory(sim->ctx, "a calibration");
    if (status) {
        asdic_calibration_destroy(&c);
    }
    sim->learnt.calibration = c;
    return status;
}

void asdic_calibration_destroy(asdic_calibration **c) {
    if (*c) {
        for (int k = 0; k < PINGS_ALONE; k++) {
            asdic_ping_destroy(&(*c)->pings[k]);
        }
        asdic_arena_finish(&(*c)->memory);
        free(*c);
        *c = NULL;
    }
}

size_t asdic_calibration_first_bin(const asdic_simulator *sim, size_t boundary, size_t beam) {
    const calibration *c = sim->learnt.calibration;
    return c ? c->sharp[beam].of[boundary] : SIZE_MAX;
}

asdic_status asdic_simulator_calibrate(asdic_simulator *sim, const asdic_pose *pose,
                                       uint64_t index) {
    TRY(calibration_create(sim));
    calibration *c = sim->learnt.calibration;
    TRY(run_pings(sim, pose, index, c));
    if (sim->fan.many) {
        for (size_t n = 0; n < sim->setup.bins; n++) {
            calibrate_bin(sim, n, c);
        }
        return asdic_drift_learn(sim);
    }
    find_kinds(sim, c);
    shared_ratios shared = share_ratios(sim, c);
    sim->learnt.object_ratio = (float)shared.objects;
    for (size_t beam = 0; beam < sim->setup.sonar.receiver_count; beam++) {
        calibrate_beam(sim, beam, shared, c);
    }
    return asdic_drift_learn(sim);
}
