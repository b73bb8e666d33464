/*
 * How honest the groups' spread is. A lattice of N points errs like 1 / N, its N / 16 interleaved
 * subsets err more than sixteen-fold less random samples would: taken at face value they overstate
 * the error of the whole. Two more pings with shifts of their own, once per block, show the true
 * error; the ratio, averaged over neighbouring bins, corrects the block's pings. A fan's map has one
 * group and a nominal spread of 1: the "ratio" then is the relative error.
 */
#include "simulator.h"

#include "base/context.h"
#include "speckle.h"

#include <math.h>
#include <stdlib.h>

/* Bins on each side that share a ratio: two pings give one degree of freedom per bin. */
#define WINDOW 8
#define RATIO_LEAST 1e-8
#define RATIO_MOST 16.0

/* What the calibration's two pings gave, per cell. */
typedef struct pair {
    double *energy[2]; /* totals without noise */
    float *stated;     /* mean of the relative variances that the groups suggest */
} pair;

/* Ratio of true to stated variance in one cell; negative where there is none. */
static double cell_ratio(const pair *p, size_t cell) {
    double sum = p->energy[0][cell] + p->energy[1][cell];
    double d = p->energy[0][cell] - p->energy[1][cell], stated = p->stated[cell];
    return sum > 0.0 && stated > 0.0 ? 2.0 * (d / sum) * (d / sum) / stated : -1.0;
}

static void smooth_ratios(asdic_simulator *sim, size_t beam, const pair *p) {
    double *ratios = sim->smear_scratch;
    for (size_t bin = 0; bin < sim->bins; bin++) {
        ratios[bin] = cell_ratio(p, beam * sim->bins + bin);
    }
    for (size_t bin = 0; bin < sim->bins; bin++) {
        size_t first = bin > WINDOW ? bin - WINDOW : 0;
        size_t last = bin + WINDOW < sim->bins ? bin + WINDOW : sim->bins - 1;
        double sum = 0.0, count = 0.0;
        for (size_t n = first; n <= last; n++) {
            sum += ratios[n] >= 0.0 ? ratios[n] : 0.0;
            count += ratios[n] >= 0.0 ? 1.0 : 0.0;
        }
        /* The mean square of error over stated error is to be one: of n squares of normal errors
         * the mean of the inverse is n / (n - 2). A bin's own ratio counts where it exceeds its
         * neighbours': bins that hold a spike err unlike them. */
        double ratio = count > 3.0 ? sum / (count - 2.0) : count > 0.0 ? sum : 1.0;
        ratio = fmax(ratio, ratios[bin]);
        sim->calibration[beam * sim->bins + bin] =
            (float)sqrt(fmin(fmax(ratio, RATIO_LEAST), RATIO_MOST));
    }
}

/* With no calibration yet, a ping states what its groups suggest. */
static void take_ping(const asdic_simulator *sim, const asdic_ping *ping, uint32_t k, pair *p) {
    for (size_t cell = 0; cell < sim->cells; cell++) {
        double total = ping->intensity_lin[ASDIC_TOTAL][cell];
        double energy = total - ping->intensity_lin[ASDIC_NOISE][cell];
        double spread =
            energy > 0.0 ? log(10.0) / 10.0 * ping->stderr_db[cell] * total / energy : 0.0;
        p->stated[cell] += (float)(0.5 * spread * spread);
        p->energy[k][cell] = energy;
    }
}

/* Shoots both pings, pulse included: neighbouring bins err against each other, and a pulse takes out
 * more of that than of errors that know nothing of each other. */
static asdic_status shoot_pair(asdic_simulator *sim, const asdic_pose *pose, uint64_t index,
                               pair *p) {
    asdic_ping *ping = NULL;
    asdic_water_column water = asdic_water_column_at(&sim->env, &sim->sonar, pose->position_m.z);
    asdic_status status = asdic_ping_create(sim->ctx, sim->sonar.receiver_count, sim->bins, &ping);
    for (uint32_t k = 0; !status && k < 2; k++) {
        status = asdic_simulator_simulate(sim, pose, index, ASDIC_STREAM_CALIBRATION + k, ping);
        if (!status) {
            asdic_pulse_smear(&sim->sonar, water.sound_speed_mps, sim->smear_scratch, ping);
            take_ping(sim, ping, k, p);
        }
    }
    asdic_ping_destroy(&ping);
    return status;
}

asdic_status asdic_simulator_calibrate(asdic_simulator *sim, const asdic_pose *pose,
                                       uint64_t index) {
    pair p = {{calloc(sim->cells, sizeof(double)), calloc(sim->cells, sizeof(double))},
              calloc(sim->cells, sizeof(float))};
    asdic_status status = p.energy[0] && p.energy[1] && p.stated
                              ? shoot_pair(sim, pose, index, &p)
                              : asdic_fail_memory(sim->ctx, "a calibration");
    for (size_t beam = 0; !status && beam < sim->sonar.receiver_count; beam++) {
        smooth_ratios(sim, beam, &p);
    }
    free(p.energy[0]);
    free(p.energy[1]);
    free(p.stated);
    return status;
}
