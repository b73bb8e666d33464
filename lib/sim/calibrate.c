/*
 * How honest the groups' spread is. A lattice of N points errs like 1 / N, its N / 16 interleaved
 * subsets err more than sixteen-fold less random samples would: taken at face value they overstate
 * the error of the whole. Two more pings with shifts of their own, once per block, show the true
 * error; the ratio, averaged over neighbouring bins, corrects the block's pings. A fan's map has one
 * group and a nominal spread of 1: the "ratio" then is the relative error.
 */
#include "simulator.h"

#include "base/context.h"

#include <math.h>
#include <stdlib.h>

/* Bins on each side that share a ratio: two pings give one degree of freedom per bin. */
#define WINDOW 8
#define RATIO_LEAST 1e-8
#define RATIO_MOST 16.0

/* Ratio of variances in one cell: from two pings' totals and their stated relative variance. */
static bool cell_ratio(double total_a, double total_b, double stated, double *ratio) {
    double sum = total_a + total_b, d = total_a - total_b;
    if (!(sum > 0.0) || !(stated > 0.0)) {
        return false;
    }
    *ratio = 2.0 * (d / sum) * (d / sum) / stated;
    return true;
}

static void smooth_ratios(asdic_simulator *sim, size_t beam, const asdic_ping *a,
                          const asdic_ping *b, const float *stated) {
    for (size_t bin = 0; bin < sim->bins; bin++) {
        size_t first = bin > WINDOW ? bin - WINDOW : 0;
        size_t last = bin + WINDOW < sim->bins ? bin + WINDOW : sim->bins - 1;
        double sum = 0.0, count = 0.0, own = 0.0;
        for (size_t n = first; n <= last; n++) {
            size_t at = beam * sim->bins + n;
            double ratio;
            double total_a = a->intensity_lin[ASDIC_TOTAL][at] - a->intensity_lin[ASDIC_NOISE][at];
            double total_b = b->intensity_lin[ASDIC_TOTAL][at] - b->intensity_lin[ASDIC_NOISE][at];
            if (cell_ratio(total_a, total_b, stated[at], &ratio)) {
                sum += ratio;
                count += 1.0;
                own = n == bin ? ratio : own;
            }
        }
        /* The mean square of error over stated error is to be one: of n squares of normal errors
         * the mean of the inverse is n / (n - 2). A bin's own ratio counts where it exceeds its
         * neighbours': bins that hold a spike err unlike them. */
        double ratio = fmax(count > 3.0 ? sum / (count - 2.0) : count > 0.0 ? sum : 1.0, own);
        sim->calibration[beam * sim->bins + bin] =
            (float)sqrt(fmin(fmax(ratio, RATIO_LEAST), RATIO_MOST));
    }
}

asdic_status asdic_simulator_calibrate(asdic_simulator *sim, const asdic_pose *pose,
                                       uint64_t index) {
    size_t beams = sim->sonar.receiver_count;
    asdic_ping *pings[2] = {NULL, NULL};
    float *stated = calloc(sim->cells, sizeof *stated);
    asdic_status status = stated ? ASDIC_OK : asdic_fail_memory(sim->ctx, "a calibration");
    for (uint32_t k = 0; !status && k < 2; k++) {
        status = asdic_ping_create(sim->ctx, beams, sim->bins, &pings[k]);
        if (!status) {
            status =
                asdic_simulator_simulate(sim, pose, index, ASDIC_STREAM_CALIBRATION + k, pings[k]);
        }
        for (size_t cell = 0; !status && cell < sim->cells; cell++) {
            double spread = asdic_simulator_spread(sim, cell);
            stated[cell] += (float)(0.5 * spread * spread);
        }
    }
    for (size_t beam = 0; !status && beam < beams; beam++) {
        smooth_ratios(sim, beam, pings[0], pings[1], stated);
    }
    asdic_ping_destroy(&pings[0]);
    asdic_ping_destroy(&pings[1]);
    free(stated);
    return status;
}
