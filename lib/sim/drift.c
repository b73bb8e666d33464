/*
 * Over rough terrain and past objects, edges move to other bins as a vehicle goes on, and with them the errors that a
 * few of the rays make there. A cell then states what the cells learnt, on average, from which its echo may have
 * come; of many receivers, whose rays tell nothing of their own error, no less than it learnt itself: what stays
 * where it is errs as before. What a ping may have missed is no more than each of those bins heard: nothing, where
 * echoes may have gone to other beams. Over terrain.ply, 96 beams 6 m above it that had gone 4 m ahead erred by 2.3 dB
 * r.m.s.; true over stated error was 3.7 by what the cells had learnt, and would be 1.5 by the mean and 1.4 by the
 * larger of both. Eight beams that had come 4 m nearer to objects in open water: 5.4 before, 1.1 by the mean.
 */
#include "drift.h"

#include "base/context.h"
#include "base/try.h"
#include "base/vec.h"
#include "base/widest.h"

#include <math.h>
#include <string.h>

/* Cells from which an echo may have come reach over so many times the way: the nearest ones alone have a poor mean
 * (of the 96 beams 1.7 by once the way, 1.5 by twice, 1.4 by three times). */
#define TIMES_WAY 2.0

/* Of cells whose error is known: the sums of its variance, and how many there are. */
typedef struct known_cells {
    double variance, count;
} known_cells;

/* Of a row of bins, between margins of REACH bins: the sums over the bins before each, and the means around it. */
typedef struct window_sums {
    double *variance, *count; /* 3 bins + 1 */
    float *mean;              /* bins; negative: nothing is known */
    size_t *least;            /* bins: those that may hold the least of a window */
    asdic_stated_error *rows; /* bins, twice: of objects, and of others */
} window_sums;

struct asdic_drift_store {
    asdic_arena memory;
    known_cells *before; /* [beam][bin]: of the beams before */
    window_sums *sums;   /* of every thread */
    asdic_pose *poses;   /* where what moves was */
};

static void sums_create(asdic_arena *a, window_sums *sums, size_t bins) {
    sums->variance = asdic_arena_alloc(a, (3 * bins + 1) * sizeof *sums->variance);
    sums->count = asdic_arena_alloc(a, (3 * bins + 1) * sizeof *sums->count);
    sums->mean = asdic_arena_alloc(a, bins * sizeof *sums->mean);
    sums->least = asdic_arena_alloc(a, bins * sizeof *sums->least);
    sums->rows = asdic_arena_alloc(a, 2 * bins * sizeof *sums->rows);
}

static asdic_status store_create(asdic_simulator *sim) {
    size_t bins = sim->setup.bins, movables = sim->setup.scene->movable_count;
    asdic_arena memory = {0};
    asdic_drift_store *s = asdic_arena_alloc(&memory, sizeof *s);
    window_sums *sums = asdic_arena_alloc(&memory, sim->setup.threads * sizeof *sums);
    for (size_t k = 0; sums && k < sim->setup.threads; k++) {
        sums_create(&memory, &sums[k], bins);
    }
    known_cells *before = asdic_arena_alloc(&memory, (sim->setup.cells + bins) * sizeof *before);
    asdic_pose *poses = asdic_arena_alloc(&memory, (movables + 1) * sizeof *poses);
    if (memory.is_short) {
        asdic_arena_finish(&memory);
        return asdic_fail_memory(sim->ctx, "the errors that a simulator learnt");
    }
    *s = (asdic_drift_store){memory, before, sums, poses};
    sim->learnt.drift = s;
    return ASDIC_OK;
}

void asdic_drift_destroy(asdic_drift_store **store) {
    if (*store) {
        asdic_arena memory = (*store)->memory; /* the store lies in it */
        asdic_arena_finish(&memory);
        *store = NULL;
    }
}

/* Of a cell in which the calibration's pings heard nothing, nothing is known. */
static bool is_known(const asdic_simulator *sim, const asdic_stated_error *stated) {
    return sim->fan.many ? stated->of_groups > 0.0f : stated->mean_lin > 0.0f;
}

static known_cells known_of(const asdic_simulator *sim, size_t cell) {
    const asdic_stated_error *stated = &sim->learnt.stated[cell];
    bool known = is_known(sim, stated);
    return (known_cells){known ? (double)stated->of_block : 0.0, known};
}

asdic_status asdic_drift_learn(asdic_simulator *sim) {
    if (sim->learnt.lesson.is_even) {
        return ASDIC_OK;
    }
    if (!sim->learnt.drift) {
        TRY(store_create(sim));
    }
    asdic_drift_store *s = sim->learnt.drift;
    for (size_t k = 0; k < sim->setup.scene->movable_count; k++) {
        s->poses[k] = sim->placement->poses[k];
    }
    for (size_t cell = 0; cell < sim->setup.cells; cell++) {
        known_cells own = known_of(sim, cell), *before = &s->before[cell];
        before[sim->setup.bins] =
            (known_cells){before->variance + own.variance, before->count + own.count};
    }
    return ASDIC_OK;
}

static double way_between(const asdic_pose *a, const asdic_pose *b) {
    return asdic_vec3_length(asdic_vec3_sub(a->position_m, b->position_m));
}

/* Of POINT, seen from the vehicle. */
static double bearing_rad(const asdic_pose *pose, const asdic_pose *point) {
    return atan2(point->position_m.y - pose->position_m.y,
                 point->position_m.x - pose->position_m.x) -
           pose->yaw_rad;
}

typedef struct moved {
    double way_m, turn_rad;
} moved;

/* How far what moves has gone at most, and turned round the vehicle. */
static moved most_moved(const asdic_simulator *sim, const asdic_pose *pose) {
    moved most = {0};
    for (size_t k = 0; k < sim->setup.scene->movable_count; k++) {
        const asdic_pose *then = &sim->learnt.drift->poses[k], *now = &sim->placement->poses[k];
        double turn = bearing_rad(pose, now) - bearing_rad(&sim->learnt.lesson.pose, then);
        most.way_m = fmax(most.way_m, way_between(now, then));
        most.turn_rad = fmax(most.turn_rad, fabs(remainder(turn, 2.0 * ASDIC_PI)));
    }
    return most;
}

/* Between receivers, on average. */
static double spacing_rad(const asdic_sonar *sonar) {
    double least = INFINITY, most = -INFINITY;
    for (size_t b = 0; b < sonar->receiver_count; b++) {
        least = fmin(least, sonar->receivers[b].yaw_rad);
        most = fmax(most, sonar->receivers[b].yaw_rad);
    }
    return (most - least) / fmax((double)sonar->receiver_count - 1.0, 1.0);
}

static size_t cells_of(double way, double cell, size_t most) {
    double cells = round(TIMES_WAY * way / cell);
    return cells < (double)most ? (size_t)cells : most;
}

static asdic_drift_reach reach_of(const asdic_simulator *sim, moved way) {
    const asdic_sonar *sonar = &sim->setup.sonar;
    double spacing = spacing_rad(sonar);
    return (asdic_drift_reach){
        .bins = cells_of(way.way_m, sonar->bin_length_m, sim->setup.bins),
        .beams = spacing > 0.0 ? cells_of(way.turn_rad, spacing, sonar->receiver_count) : 0};
}

/* Of few receivers the rays that meet a moved object show its error, and the rest, which stays, errs as it did; what the
 * vehicle's own way takes to other bins they show as well, so that objects alone may be gone. */
asdic_drift asdic_drift_since(const asdic_simulator *sim, const asdic_pose *pose) {
    const asdic_pose *then = &sim->learnt.lesson.pose;
    if (!sim->learnt.drift || sim->learnt.lesson.is_even) {
        return (asdic_drift){0};
    }
    moved objects = most_moved(sim, pose),
          vehicle = {.way_m = way_between(pose, then),
                     .turn_rad = fabs(remainder(pose->yaw_rad - then->yaw_rad, 2.0 * ASDIC_PI))};
    moved both = {vehicle.way_m + objects.way_m, fmax(vehicle.turn_rad, objects.turn_rad)};
    moved own = sim->fan.many ? vehicle : (moved){0};
    moved gone = {.way_m = own.way_m + objects.way_m,
                  .turn_rad =
                      objects.way_m > 0.0 ? fmax(own.turn_rad, objects.turn_rad) : own.turn_rad};
    return (asdic_drift){
        .is_any = both.way_m > 0.0 || both.turn_rad > 0.0 || pose->roll_rad != then->roll_rad ||
                  pose->pitch_rad != then->pitch_rad,
        .others = reach_of(sim, vehicle),
        .objects = reach_of(sim, sim->fan.many && objects.way_m > 0.0 ? both : vehicle),
        .heard = reach_of(sim, gone)};
}

/* Sums over the bins before each of BEAM's, between margins; of the receivers within REACH of it. */
static void sum_bins(const asdic_simulator *sim, size_t beam, asdic_drift_reach reach,
                     window_sums *sums) {
    const known_cells *before = sim->learnt.drift->before;
    size_t bins = sim->setup.bins, receivers = sim->setup.sonar.receiver_count;
    size_t low = beam > reach.beams ? beam - reach.beams : 0;
    size_t high = beam + reach.beams < receivers ? beam + reach.beams + 1 : receivers;
    known_cells sum = {0};
    for (size_t n = 0; n <= bins + 2 * reach.bins; n++) {
        sums->variance[n] = sum.variance;
        sums->count[n] = sum.count;
        if (n >= reach.bins && n < reach.bins + bins) {
            known_cells from = before[low * bins + n - reach.bins],
                        to = before[high * bins + n - reach.bins];
            sum.variance += to.variance - from.variance;
            sum.count += to.count - from.count;
        }
    }
}

/* Means over WINDOW bins. */
WIDEST static void find_means(const double *restrict variance, const double *restrict count,
                              size_t window, size_t bins, float *restrict mean) {
    for (size_t n = 0; n < bins; n++) {
        double known = count[n + window] - count[n];
        double sum = variance[n + window] - variance[n];
        mean[n] = known > 0.0 ? (float)(sum / known) : -1.0f;
    }
}

/* What bins of OWN heard, the least within REACH of each, to ROW: an echo that has left a bin is not missed there. Bins of
 * data/scenes/mission_fan.yaml that are said not to be known: 0.04 %, by what each heard 1.2 %. AHEAD has room for the
 * bins that are less than all before them. */
static void find_least(const asdic_stated_error *own, size_t reach, size_t bins, size_t *ahead,
                       asdic_stated_error *row) {
    size_t first = 0, end = 0;
    for (size_t n = 0, next = 0; n < bins; n++) {
        for (; next < bins && next <= n + reach; next++) {
            while (end > first && own[ahead[end - 1]].mean_lin >= own[next].mean_lin) {
                end--;
            }
            ahead[end++] = next;
        }
        first += ahead[first] + reach < n;
        row[n].mean_lin = own[ahead[first]].mean_lin;
    }
}

/* ROW is OWN, but for the error of the block. */
static void restate_block(const asdic_simulator *sim, const asdic_stated_error *own,
                          const float *mean, asdic_stated_error *row) {
    for (size_t n = 0; n < sim->setup.bins; n++) {
        bool stays = sim->fan.many && is_known(sim, &own[n]);
        float least = stays || mean[n] < 0.0f ? own[n].of_block : 0.0f;
        row[n] = own[n];
        row[n].of_block = least > mean[n] ? least : mean[n];
    }
}

const asdic_stated_error *asdic_drift_row(const asdic_simulator *sim, const asdic_drift *drift,
                                          unsigned worker, size_t beam, bool of_objects) {
    const asdic_drift_reach reach = of_objects ? drift->objects : drift->others;
    const asdic_drift_reach heard = drift->heard;
    size_t bins = sim->setup.bins;
    const asdic_stated_error *own = sim->learnt.stated + beam * bins;
    if (reach.bins + reach.beams + heard.bins + heard.beams == 0) {
        return own;
    }
    window_sums *sums = &sim->learnt.drift->sums[worker];
    asdic_stated_error *row = sums->rows + of_objects * bins;
    if (reach.bins + reach.beams > 0) {
        sum_bins(sim, beam, reach, sums);
        find_means(sums->variance, sums->count, 2 * reach.bins + 1, bins, sums->mean);
        restate_block(sim, own, sums->mean, row);
    } else {
        memcpy(row, own, bins * sizeof *row);
    }
    for (size_t n = 0; heard.beams > 0 && n < bins; n++) {
        row[n].mean_lin = 0.0f;
    }
    if (heard.beams == 0 && heard.bins > 0) {
        find_least(own, heard.bins, bins, sums->least, row);
    }
    return row;
}
