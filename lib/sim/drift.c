/*
 * Over rough terrain and past objects, edges move to other bins as a vehicle goes on, and with them the errors that a
 * few of the rays make there. A cell then states what the cells learnt, on average, from which its echo may have
 * come; of many receivers, whose rays tell nothing of their own error, no less than it learnt itself: what stays
 * where it is errs as before. Over terrain.ply, 96 beams 6 m above it that had gone 4 m ahead erred by 2.3 dB r.m.s.;
 * true over stated error was 3.7 by what the cells had learnt, and would be 1.5 by the mean and 1.4 by the larger of
 * both. Eight beams that had come 4 m nearer to objects in open water: 5.4 before, 1.1 by the mean.
 */
#include "drift.h"

#include "base/context.h"
#include "base/try.h"
#include "base/vec.h"

#include <math.h>
#include <stdlib.h>

/* Cells from which an echo may have come reach over so many times the way: the nearest ones alone have a poor mean
 * (of the 96 beams 1.7 by once the way, 1.5 by twice, 1.4 by three times). */
#define TIMES_WAY 2.0

/* Of cells whose error is known: the sums of its variance, and how many there are. */
typedef struct known_cells {
    double variance, count;
} known_cells;

struct asdic_drift_store {
    known_cells *before;      /* [beam][bin]: of the beams before */
    known_cells *within;      /* of every thread, [bin]: of the bins before */
    asdic_stated_error *rows; /* of every thread, of objects and others */
    asdic_pose *poses;        /* where what moves was */
};

static known_cells sum_of(known_cells a, known_cells b) {
    return (known_cells){a.variance + b.variance, a.count + b.count};
}

static known_cells between(known_cells from, known_cells to) {
    return (known_cells){to.variance - from.variance, to.count - from.count};
}

static asdic_status store_create(asdic_simulator *sim) {
    size_t bins = sim->setup.bins, threads = sim->setup.threads;
    asdic_drift_store *s = calloc(1, sizeof *s);
    bool whole = s && (s->before = calloc(sim->setup.cells + bins, sizeof *s->before)) &&
                 (s->within = malloc(threads * (bins + 1) * sizeof *s->within)) &&
                 (s->rows = malloc(threads * 2 * bins * sizeof *s->rows)) &&
                 (s->poses = malloc((sim->setup.scene->movable_count + 1) * sizeof *s->poses));
    if (!whole) {
        asdic_drift_destroy(&s);
        return asdic_fail_memory(sim->ctx, "the errors that a simulator learnt");
    }
    sim->learnt.drift = s;
    return ASDIC_OK;
}

void asdic_drift_destroy(asdic_drift_store **store) {
    if (*store) {
        free((*store)->before);
        free((*store)->within);
        free((*store)->rows);
        free((*store)->poses);
        free(*store);
        *store = NULL;
    }
}

/* Of a cell in which the calibration's pings heard nothing, nothing is known. */
static bool is_known(const asdic_simulator *sim, const asdic_stated_error *stated) {
    return sim->fan.many ? stated->of_groups > 0.0f : stated->mean_lin > 0.0f;
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
        const asdic_stated_error *stated = &sim->learnt.stated[cell];
        bool known = is_known(sim, stated);
        known_cells own = {known ? (double)stated->of_block : 0.0, known};
        s->before[cell + sim->setup.bins] = sum_of(s->before[cell], own);
    }
    return ASDIC_OK;
}

static double way_between(const asdic_pose *a, const asdic_pose *b) {
    return asdic_vec3_length(asdic_vec3_sub(a->position_m, b->position_m));
}

/* Of what has moved farthest. */
static double farthest_moved_m(const asdic_simulator *sim) {
    double farthest = 0.0;
    for (size_t k = 0; k < sim->setup.scene->movable_count; k++) {
        farthest =
            fmax(farthest, way_between(&sim->placement->poses[k], &sim->learnt.drift->poses[k]));
    }
    return farthest;
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

/* Of few receivers the rays that meet a moved object show its error, and the rest, which stays, errs as it did. */
asdic_drift asdic_drift_since(const asdic_simulator *sim, const asdic_pose *pose) {
    const asdic_sonar *sonar = &sim->setup.sonar;
    const asdic_pose *then = &sim->learnt.lesson.pose;
    if (!sim->learnt.drift || sim->learnt.lesson.is_even) {
        return (asdic_drift){0};
    }
    double moved_m = farthest_moved_m(sim), spacing = spacing_rad(sonar);
    double way_m = way_between(pose, then), objects_m = way_m + (sim->fan.many ? moved_m : 0.0);
    double turn_rad = fabs(remainder(pose->yaw_rad - then->yaw_rad, 2.0 * ASDIC_PI));
    return (asdic_drift){
        .is_any = way_m > 0.0 || moved_m > 0.0 || turn_rad > 0.0 ||
                  pose->roll_rad != then->roll_rad || pose->pitch_rad != then->pitch_rad,
        .bins = cells_of(way_m, sonar->bin_length_m, sim->setup.bins),
        .objects_bins = cells_of(objects_m, sonar->bin_length_m, sim->setup.bins),
        .beams = spacing > 0.0 ? cells_of(turn_rad, spacing, sonar->receiver_count) : 0,
    };
}

/* What a cell states that by itself states OWN, of CELLS around it. */
static asdic_stated_error stated_by(const asdic_simulator *sim, known_cells cells,
                                    asdic_stated_error own) {
    if (!(cells.count > 0.0)) {
        return own;
    }
    float mean = (float)(cells.variance / cells.count);
    bool stays = sim->fan.many && is_known(sim, &own);
    own.of_block = stays ? fmaxf(mean, own.of_block) : mean;
    return own;
}

const asdic_stated_error *asdic_drift_row(const asdic_simulator *sim, asdic_drift drift,
                                          unsigned worker, size_t beam, bool of_objects) {
    const asdic_drift_store *s = sim->learnt.drift;
    size_t bins = sim->setup.bins, beams = sim->setup.sonar.receiver_count;
    const asdic_stated_error *own = sim->learnt.stated + beam * bins;
    size_t reach = of_objects ? drift.objects_bins : drift.bins;
    if (reach == 0 && drift.beams == 0) {
        return own;
    }
    size_t low = beam > drift.beams ? beam - drift.beams : 0;
    size_t high = beam + drift.beams < beams ? beam + drift.beams + 1 : beams;
    known_cells *within = s->within + worker * (bins + 1);
    within[0] = (known_cells){0};
    for (size_t n = 0; n < bins; n++) {
        known_cells here = between(s->before[low * bins + n], s->before[high * bins + n]);
        within[n + 1] = sum_of(within[n], here);
    }
    asdic_stated_error *row = s->rows + (2 * worker + of_objects) * bins;
    for (size_t n = 0; n < bins; n++) {
        size_t from = n > reach ? n - reach : 0;
        size_t to = n + reach < bins ? n + reach + 1 : bins;
        row[n] = stated_by(sim, between(within[from], within[to]), own[n]);
    }
    return row;
}
