/*
 * How far a ping's groups tell its error. A lattice of N points errs like 1 / N, its N / 16 interleaved
 * subsets err more than sixteen-fold less random samples would: taken at face value they overstate
 * the error of the whole. Two more pings with shifts of their own, once per block, show the true
 * error; its ratio to what the groups suggest corrects the block's pings. A fan's map has one group and
 * a nominal spread of 1: the ratio then is the relative variance.
 *
 * Whether a ratio is fit to be used is measured by true over stated error in the benchmark scenes
 * (tests/kernel/test_honesty.c); so were the constants below chosen.
 */
#include "simulator.h"

#include "base/context.h"
#include "pulse.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Bins on each side that share a ratio: two pings give one degree of freedom per bin. */
#define WINDOW 12
/* The beam's typical ratio counts as much as this many bins: neighbours that see the same water err
 * alike, and tell less than their number. */
#define TYPICAL_WEIGHT 4.0
#define TYPICAL_SAMPLES 128
/* Median of a normal error's square. */
#define MEDIAN_SQUARE 0.455
/* What groups suggest is a mean of this ping's (ASDIC_OWN_PING), of the calibration's in this bin and in
 * its neighbours: a ping that missed a rare bright ray does not know it. */
#define OWN_BIN 0.4
#define NEIGHBOURS (1.0 - ASDIC_OWN_PING - OWN_BIN)
/* Share of the calibration's own error in a bin that is added: spikes err unlike their neighbours. */
#define OWN_ERROR 0.1
/* The mean square of error over stated error is to be one: of n squares of normal errors the mean of
 * the inverse is n / (n - 2). */
#define FEW_SQUARES (30.0 / 28.0)

/* What the calibration's two pings gave, per cell. Kept from block to block: of many beams and bins it is
 * a hundred megabytes, which take longer to get than to fill. */
typedef struct asdic_pair {
    double *energy[2];    /* totals without noise */
    float *suggested;     /* mean of the relative variances that the groups suggest */
    asdic_ping *pings[2]; /* the latest; one only where pings go alone */
} pair;

/* The relative variance of one ping that the two differ by in one cell; negative where there is none. */
static double cell_variance(const pair *p, size_t cell) {
    double sum = p->energy[0][cell] + p->energy[1][cell];
    double d = p->energy[0][cell] - p->energy[1][cell];
    return sum > 0.0 && p->suggested[cell] > 0.0f ? 2.0 * (d / sum) * (d / sum) : -1.0;
}

static int compare(const void *a, const void *b) {
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* What most bins of a beam from cell FIRST on have as ratio: by the median, which bins in deep nulls,
 * far off, do not move. */
static double typical_ratio(const asdic_simulator *sim, size_t first, const pair *p) {
    double ratios[TYPICAL_SAMPLES];
    size_t count = 0, step = (sim->bins + TYPICAL_SAMPLES - 1) / TYPICAL_SAMPLES;
    for (size_t n = 0; n < sim->bins; n += step) {
        double variance = cell_variance(p, first + n);
        if (variance >= 0.0) {
            ratios[count++] = variance / p->suggested[first + n];
        }
    }
    qsort(ratios, count, sizeof *ratios, compare);
    return count ? ratios[count / 2] / MEDIAN_SQUARE : 1.0;
}

static double neighbours_of(const float *values, size_t n, size_t bins) {
    double before = values[n > 0 ? n - 1 : n], after = values[n + 1 < bins ? n + 1 : n];
    return (before + values[n] + after) / 3.0;
}

static void calibrate_beam(asdic_simulator *sim, size_t beam, const pair *p) {
    size_t first = beam * sim->bins, bins = sim->bins;
    double *sums = sim->smear_scratch, *counts = sums + bins + 1; /* before each bin */
    sums[0] = counts[0] = 0.0;
    for (size_t n = 0; n < bins; n++) {
        double variance = cell_variance(p, first + n);
        sums[n + 1] = sums[n] + (variance >= 0.0 ? variance / p->suggested[first + n] : 0.0);
        counts[n + 1] = counts[n] + (variance >= 0.0);
    }
    double typical = typical_ratio(sim, first, p);
    for (size_t n = 0; n < bins; n++) {
        size_t from = n > WINDOW ? n - WINDOW : 0;
        size_t to = n + WINDOW + 1 < bins ? n + WINDOW + 1 : bins;
        double ratio = (sums[to] - sums[from] + TYPICAL_WEIGHT * typical) /
                       (counts[to] - counts[from] + TYPICAL_WEIGHT);
        double block = OWN_BIN * p->suggested[first + n] +
                       NEIGHBOURS * neighbours_of(p->suggested + first, n, bins);
        double own = OWN_ERROR * fmax(cell_variance(p, first + n), 0.0);
        asdic_stated_error *stated = &sim->stated[first + n];
        stated->of_groups = (float)(FEW_SQUARES * ratio);
        stated->of_block = (float)(FEW_SQUARES * (ratio * block + own));
        if (sim->fan.cells) { /* nothing of the ping's own to go by */
            double variance = stated->of_block + ASDIC_OWN_PING * stated->of_groups;
            *stated = (asdic_stated_error){0.0f, (float)sqrt(variance)};
        }
    }
}

/* With no calibration yet, a ping states what its groups suggest. */
static void take_ping(const asdic_simulator *sim, const asdic_ping *ping, uint32_t k, pair *p) {
    for (size_t cell = 0; cell < sim->cells; cell++) {
        double total = ping->intensity_lin[ASDIC_TOTAL][cell];
        double energy = total - ping->intensity_lin[ASDIC_NOISE][cell];
        double spread =
            energy > 0.0 ? log(10.0) / 10.0 * ping->stderr_db[cell] * total / energy : 0.0;
        p->suggested[cell] += (float)(0.5 * spread * spread);
        p->energy[k][cell] = energy;
    }
}

/* Shoots both pings, pulse included: neighbouring bins err against each other, and a pulse takes out
 * more of that than of errors that know nothing of each other. */
static asdic_status shoot_pair(asdic_simulator *sim, const asdic_pose *pose, uint64_t index,
                               pair *p) {
    asdic_water_column water = asdic_water_column_at(&sim->env, &sim->sonar, pose->position_m.z);
    const asdic_ping_shot shots[2] = {{*pose, index, ASDIC_STREAM_CALIBRATION},
                                      {*pose, index, ASDIC_STREAM_CALIBRATION + 1}};
    size_t volley = p->pings[1] ? 2 : 1;
    asdic_status status = ASDIC_OK;
    memset(p->suggested, 0, sim->cells * sizeof *p->suggested);
    for (uint32_t k = 0; !status && k < 2; k++) {
        asdic_ping *ping = p->pings[k % volley];
        if (k % volley == 0) {
            status = asdic_simulator_simulate(sim, shots + k, volley, p->pings);
        }
        if (!status) {
            asdic_pulse_smear(&sim->sonar, water.sound_speed_mps, sim->smear_scratch, ping);
            take_ping(sim, ping, k, p);
        }
    }
    return status;
}

static asdic_status pair_create(asdic_simulator *sim) {
    if (sim->pair) {
        return ASDIC_OK;
    }
    pair *p = sim->pair = calloc(1, sizeof *p);
    if (p) {
        p->energy[0] = malloc(sim->cells * sizeof(double));
        p->energy[1] = malloc(sim->cells * sizeof(double));
        p->suggested = malloc(sim->cells * sizeof(float));
    }
    if (!p || !p->energy[0] || !p->energy[1] || !p->suggested) {
        asdic_pair_destroy(&sim->pair);
        return asdic_fail_memory(sim->ctx, "a calibration");
    }
    asdic_status status = ASDIC_OK;
    for (size_t k = 0; !status && k < 2 && k < sim->volley; k++) {
        status = asdic_ping_create(sim->ctx, sim->sonar.receiver_count, sim->bins, &p->pings[k]);
    }
    if (status) {
        asdic_pair_destroy(&sim->pair);
    }
    return status;
}

void asdic_pair_destroy(asdic_pair **p) {
    if (*p) {
        free((*p)->energy[0]);
        free((*p)->energy[1]);
        free((*p)->suggested);
        asdic_ping_destroy(&(*p)->pings[0]);
        asdic_ping_destroy(&(*p)->pings[1]);
        free(*p);
        *p = NULL;
    }
}

asdic_status asdic_simulator_calibrate(asdic_simulator *sim, const asdic_pose *pose,
                                       uint64_t index) {
    asdic_status status = pair_create(sim);
    if (!status) {
        status = shoot_pair(sim, pose, index, sim->pair);
    }
    for (size_t beam = 0; !status && beam < sim->sonar.receiver_count; beam++) {
        calibrate_beam(sim, beam, sim->pair);
    }
    return status;
}
