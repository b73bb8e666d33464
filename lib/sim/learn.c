/*
 * Learning where rays matter. Pilot pings at the first pose of a block of pings show how much of each bin's
 * energy each cell of elevation and azimuth brings. The block's pings then draw their rays in proportion, up to
 * where the vehicle has turned or climbed (lesson.h).
 */
#include "simulator.h"

#include <asdic/plan.h>

#include "base/context.h"
#include "base/try.h"
#include "scene/scene.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define PICKED_MOST 8
#define LEAST_PILOT_RAYS 1024u
/* This share of the density over elevations is learnt. The rest stays even, so that no direction is starved
 * and weights stay bounded whatever the pilots missed. An azimuth's cell is changed only where it needs more
 * than STARVED times the mean, by SURE standard errors: azimuths have fewer cells, each with more rays. */
#define LEARNT_ELEVATION 0.7
#define STARVED 2.0
#define SURE 1.5
/* The second pilot draws by what the first learnt: two of 4,096 rays are worth one of 16,384. */
#define PILOT_ROUNDS 2u
/* Cells are smoothed by a triangle of this many cells each side. */
#define SMOOTH 3
/* The sampler's bottom zone takes the bottom to be as high as what stands on it, but no nearer to the sonar
 * than this share of the altitude. */
#define LOWEST 0.2

#define IS_POWER_OF_TWO(x) (((x) & ((x)-1)) == 0)
_Static_assert(IS_POWER_OF_TWO(DEV_TABLE_CELLS) && IS_POWER_OF_TWO(DEV_AZIMUTH_CELLS),
               "learnt_cell halves them");
_Static_assert(DEV_TABLE_CELLS % DEV_TABLE_ROWS == 0, "rows have as many cells each");

/* What a pilot ping's rays brought, as in pilot.cl. */
typedef struct pilots {
    const dev_pilot *rays;
    const float *energies;
    size_t slots;
    uint32_t picked;
} pilots;

uint32_t asdic_simulator_picked(const asdic_simulator *sim) {
    size_t beams = sim->setup.sonar.receiver_count;
    return (uint32_t)(beams < PICKED_MOST ? beams : PICKED_MOST);
}

/* Draws and traces the rays of the pilot ping SHOT and weighs what they brought; blocks. */
static asdic_status run_pilots(asdic_simulator *sim, const asdic_ping_shot *shot, pilots *p) {
    const dev_ping *ping = shot->ping;
    p->slots = (size_t)ping->batch.groups * ping->batch.per_group;
    p->picked = asdic_simulator_picked(sim);
    p->rays = sim->host.pilot_rays;
    p->energies = sim->host.pilot_energies;
    asdic_kernel_arg args[] = {ASDIC_ARG_BUFFER(sim->buffers.pings),
                               ASDIC_ARG_BUFFER(sim->buffers.rays),
                               ASDIC_ARG_BUFFER(sim->buffers.legs),
                               ASDIC_ARG_BUFFER(sim->buffers.solid_angles),
                               ASDIC_ARG_BUFFER(sim->buffers.splats),
                               ASDIC_ARG_BUFFER(sim->learnt.faces.density_buffer),
                               ASDIC_ARG_BUFFER(sim->buffers.hits),
                               ASDIC_ARG_BUFFER(asdic_simulator_triangles(sim)),
                               ASDIC_ARG_BUFFER(sim->buffers.parts),
                               ASDIC_ARG_BUFFER(sim->buffers.materials),
                               ASDIC_ARG_BUFFER(sim->buffers.table),
                               ASDIC_ARG_BUFFER(sim->buffers.pilot_rays),
                               ASDIC_ARG_BUFFER(sim->buffers.pilot_energies),
                               ASDIC_ARG_VALUE(p->picked)};
    TRY(asdic_simulator_draw(sim, 1));
    TRY(asdic_kernel_run(sim->kernels.pilot, args, sizeof args / sizeof *args,
                         p->slots / sim->setup.layout.width, sim->setup.layout.local));
    TRY(asdic_buffer_read(sim->buffers.pilot_rays, 0, p->slots * sizeof *p->rays,
                          sim->host.pilot_rays));
    return asdic_buffer_read(sim->buffers.pilot_energies, 0,
                             p->slots * p->picked * DEV_PILOT_ENERGIES * sizeof(float),
                             sim->host.pilot_energies);
}

/* What ray I brings to receiver P. */
static const float *energies_of(const pilots *s, size_t i, uint32_t p) {
    return s->energies + DEV_PILOT_ENERGIES * (i * s->picked + p);
}

/* For one receiver P. TOTALS[bin] is the energy of each bin, relative to its TL d^2. A ray that crosses the
 * water brings VOLUME[bin] per unit of its gain to every bin on its way: CROSSED[bin] is the sum, over the
 * bins up to this one, of the squared shares of their totals that one unit makes. */
static void sum_bins(const pilots *s, uint32_t p, const float *volume, size_t bins, double *totals,
                     double *crossed) {
    memset(totals, 0, bins * sizeof *totals);
    memset(crossed, 0, bins * sizeof *crossed);
    for (size_t i = 0; i < s->slots; i++) {
        const float *energy = energies_of(s, i, p);
        const dev_uint *in = s->rays[i].bins;
        for (int e = 0; e < DEV_PILOT_ECHOES; e++) {
            totals[in[e]] += energy[e];
        }
        crossed[in[0]] += energy[DEV_PILOT_WATER];
    }
    for (size_t n = bins - 1; n-- > 0;) {
        crossed[n] += crossed[n + 1];
    }
    double squares = 0.0;
    for (size_t n = 0; n < bins; n++) {
        totals[n] += volume[n] * crossed[n];
        double share = totals[n] > 0.0 ? volume[n] / totals[n] : 0.0;
        squares += share * share;
        crossed[n] = squares;
    }
}

/* What the rays of a cell of the table need. A ray's need is the root of the summed squares of its shares of
 * the bins: the errors of all bins are least where the density of rays is in proportion to it. SUM is over
 * the cell's rays, SQUARES that of the squared needs. */
typedef struct demand {
    double sum, squares;
} demand;

/* Adds the needs of the pilot rays to Q[x cell][y cell]. */
static asdic_status add_demand(const asdic_simulator *sim, const asdic_ping_shot *shot,
                               const pilots *s, demand *q) {
    double *totals = malloc(2 * sim->setup.bins * sizeof *totals),
           *crossed = totals + sim->setup.bins;
    const float *volume = shot->for_device + sim->setup.bins; /* as row_water in ping_batch.h */
    double *squares = calloc(s->slots, sizeof *squares);
    if (!totals || !squares) {
        free(totals);
        free(squares);
        return asdic_fail_memory(sim->ctx, "pilot sums");
    }
    for (uint32_t p = 0; p < s->picked; p++) {
        sum_bins(s, p, volume, sim->setup.bins, totals, crossed);
        for (size_t i = 0; i < s->slots; i++) {
            const float *energy = energies_of(s, i, p);
            const dev_uint *in = s->rays[i].bins;
            double water = energy[DEV_PILOT_WATER];
            squares[i] += water * water * crossed[in[0]];
            for (int e = 0; e < DEV_PILOT_ECHOES; e++) {
                double echo = totals[in[e]] > 0.0 ? energy[e] / totals[in[e]] : 0.0;
                squares[i] += echo * echo;
            }
        }
    }
    for (size_t i = 0; i < s->slots; i++) {
        size_t x = (size_t)fmin(fmax(s->rays[i].x * DEV_TABLE_CELLS, 0.0), DEV_TABLE_CELLS - 1);
        size_t y = (size_t)fmin(fmax(s->rays[i].y * DEV_AZIMUTH_CELLS, 0.0), DEV_AZIMUTH_CELLS - 1);
        q[x * DEV_AZIMUTH_CELLS + y].sum += sqrt(squares[i]);
        q[x * DEV_AZIMUTH_CELLS + y].squares += squares[i];
    }
    free(totals);
    free(squares);
    return ASDIC_OK;
}

/* CUMULATIVE probabilities of COUNT cells: the share LEARNT in proportion to Q, the rest even. */
static void accumulate(const double *q, int count, double learnt, float *cumulative) {
    double total = 0.0, sum = 0.0;
    for (int i = 0; i < count; i++) {
        total += q[i];
    }
    cumulative[0] = 0.0f;
    for (int i = 0; i < count; i++) {
        sum += total > 0.0 ? learnt * q[i] / total + (1.0 - learnt) / count : 1.0 / count;
        cumulative[i + 1] = (float)sum;
    }
    cumulative[count] = 1.0f;
}

static double smoothed(const double *q, int count, int at, int reach) {
    double sum = 0.0;
    for (int d = -reach; d <= reach; d++) {
        int j = at + d < 0 ? 0 : at + d >= count ? count - 1 : at + d;
        sum += q[j] * (reach + 1 - abs(d));
    }
    return sum;
}

/* Azimuths of one row of the table from their demand OWN. Cells that surely need more than STARVED times the
 * mean get what they need, the others stay even: noise makes a table rough, not better. Returns whether any
 * cell got more. */
static bool tabulate_row(const demand *own, float *cumulative) {
    enum { CELLS = DEV_AZIMUTH_CELLS };
    double mean = 0.0, weights[CELLS];
    bool learnt = false;
    for (int k = 0; k < CELLS; k++) {
        mean += own[k].sum / CELLS;
    }
    for (int k = 0; k < CELLS; k++) {
        double spread = own[k].sum > 0.0 ? sqrt(own[k].squares) / own[k].sum : 1.0;
        double needed = mean > 0.0 ? own[k].sum / mean * (1.0 - SURE * spread) : 0.0;
        weights[k] = needed > STARVED ? needed : 1.0;
        learnt |= needed > STARVED;
    }
    accumulate(weights, CELLS, 1.0, cumulative);
    return learnt;
}

/* Fills the learnt table (kernels/learnt.h) from the demand Q; returns whether azimuths are uneven. */
static bool tabulate(const demand *q, float *table) {
    enum { CELLS = DEV_TABLE_CELLS, ROWS = DEV_TABLE_ROWS, AZIMUTHS = DEV_AZIMUTH_CELLS };
    double elevations[CELLS] = {0.0}, smooth[CELLS];
    demand rows[ROWS + 2][AZIMUTHS] = {0}; /* with a margin */
    for (int i = 0; i < CELLS; i++) {
        for (int k = 0; k < AZIMUTHS; k++) {
            const demand *own = &q[i * AZIMUTHS + k];
            elevations[i] += own->sum;
            for (int near = 0; near < 3; near++) { /* rows share with their neighbours */
                demand *to = &rows[i / (CELLS / ROWS) + near][k];
                double weight = near == 1 ? 1.0 : 0.5;
                to->sum += weight * own->sum;
                to->squares += weight * weight * own->squares;
            }
        }
    }
    for (int i = 0; i < CELLS; i++) {
        smooth[i] = smoothed(elevations, CELLS, i, SMOOTH);
    }
    accumulate(smooth, CELLS, LEARNT_ELEVATION, table);
    bool learnt = false;
    for (int row = 0; row < ROWS; row++) {
        learnt |= tabulate_row(rows[row + 1], table + CELLS + 1 + (size_t)row * (AZIMUTHS + 1));
    }
    return learnt;
}

/* Pilots have no more rays than the pings: coarse pings gain little from a fine table. */
static uint32_t pilot_rays(const asdic_simulator *sim) {
    uint32_t rays =
        sim->setup.sampling.rays < ASDIC_PILOT_RAYS ? sim->setup.sampling.rays : ASDIC_PILOT_RAYS;
    return rays > LEAST_PILOT_RAYS ? rays : LEAST_PILOT_RAYS;
}

static uint32_t picked_beam(const asdic_simulator *sim, uint32_t p) {
    uint32_t beams = (uint32_t)sim->setup.sonar.receiver_count,
             picked = asdic_simulator_picked(sim);
    return picked == beams ? p : p * (beams - 1) / (picked - 1);
}

/* Where picked receivers stand for many, each is widened to the distance of the next one, in this ping. */
static void widen_picked(const asdic_simulator *sim, const asdic_ping_shot *shot) {
    uint32_t picked = asdic_simulator_picked(sim);
    dev_beam *receivers = asdic_shot_beams(shot) + 1;
    for (uint32_t p = 0; picked < sim->setup.sonar.receiver_count && p < picked; p++) {
        dev_beam *beam = &receivers[picked_beam(sim, p)];
        const dev_beam *next = &receivers[picked_beam(sim, p + 1 < picked ? p + 1 : p - 1)];
        double along = 0.0;
        for (int k = 0; k < 3; k++) {
            along += (double)beam->rows[k] * next->rows[k];
        }
        double apart = acos(fmin(fmax(along, -1.0), 1.0));
        beam->length_h_wl = (float)fmin(beam->length_h_wl, 1.0 / fmax(apart, 1e-3));
    }
}

/* Fills Q from what the rays of the pilot ping SHOT bring. */
static asdic_status measure_demand(asdic_simulator *sim, const asdic_ping_shot *shot, demand *q) {
    pilots p;
    TRY(run_pilots(sim, shot, &p));
    return add_demand(sim, shot, &p, q);
}

/* One pilot ping, drawn by the table so far, gives the next table. */
static asdic_status learn_once(asdic_simulator *sim, const asdic_pose *pose, uint64_t index,
                               uint32_t stream) {
    asdic_ping_shot *shot = &sim->shots[0];
    asdic_shot_aim(sim, shot, pose, index, stream, pilot_rays(sim));
    widen_picked(sim, shot);
    if (asdic_shot_tabulate(sim, shot)) {
        shot->tables_np_per_m = -1.0; /* the device has not been told */
    }
    demand *q = calloc((size_t)DEV_TABLE_CELLS * DEV_AZIMUTH_CELLS, sizeof *q);
    asdic_status status =
        q ? measure_demand(sim, shot, q) : asdic_fail_memory(sim->ctx, "a pilot ping");
    if (!status) {
        sim->learnt.azimuths = tabulate(q, sim->learnt.table);
        sim->learnt.table_uploaded = false;
    }
    free(q);
    return status;
}

void asdic_simulator_forget(asdic_simulator *sim) {
    sim->learnt.lesson = asdic_lesson_none();
    sim->learnt.zone_altitude = ASDIC_ZONE_ALTITUDE;
    sim->learnt.faces.count = 0;
    sim->learnt.glints.own.count = sim->learnt.glints.between.count = 0;
    sim->learnt.azimuths = false;
    sim->learnt.object_ratio = 1.0f;
    for (int i = 0; i <= DEV_TABLE_CELLS; i++) {
        sim->learnt.table[i] = (float)i / DEV_TABLE_CELLS;
    }
    for (int i = 0; i < DEV_TABLE_ROWS * (DEV_AZIMUTH_CELLS + 1); i++) {
        sim->learnt.table[DEV_TABLE_CELLS + 1 + i] =
            (float)(i % (DEV_AZIMUTH_CELLS + 1)) / DEV_AZIMUTH_CELLS;
    }
    sim->learnt.table_uploaded = false;
    for (size_t cell = 0; cell < sim->setup.cells; cell++) {
        sim->learnt.stated[cell] = sim->fan.many ? (asdic_stated_error){.of_block = 1.0f}
                                                 : (asdic_stated_error){.of_groups = 1.0f};
    }
}

/* Far out, rays that pass over the bottom meet what stands on it: the zone begins at the top of that. */
static void lower_zone(asdic_simulator *sim, const asdic_pose *pose) {
    double altitude = asdic_scene_altitude_m(sim->setup.scene, pose->position_m);
    double bottom =
        asdic_scene_clearance_m(sim->setup.scene, pose->position_m, sim->setup.ping.reach_m);
    double clearance = fmin(bottom, sim->learnt.faces.clearance_m);
    if (isfinite(altitude) && clearance < altitude) {
        sim->learnt.zone_altitude = ASDIC_ZONE_ALTITUDE * fmax(clearance / altitude, LOWEST);
    }
}

static asdic_status choose_faces(asdic_simulator *sim, const asdic_pose *pose, uint64_t index) {
    asdic_ping_shot *shot = &sim->shots[0];
    sim->learnt.faces.count = 0;
    asdic_shot_aim(sim, shot, pose, index, ASDIC_STREAM_PILOT, pilot_rays(sim));
    asdic_eye eye = {shot->ping, asdic_shot_beams(shot), sim->setup.scatterers, sim->setup.threads};
    TRY(asdic_glints_find(&sim->learnt.glints, sim->placement, pose->position_m, &eye,
                          sim->setup.has_mirrors));
    return asdic_faces_choose(&sim->learnt.faces, sim->placement, pose->position_m, &eye);
}

/* Where rays matter, of the adaptive sampler. */
static asdic_status learn_table(asdic_simulator *sim, const asdic_pose *pose, uint64_t index) {
    TRY(choose_faces(sim, pose, index));
    lower_zone(sim, pose);
    for (uint32_t round = 0; round < PILOT_ROUNDS; round++) {
        TRY(learn_once(sim, pose, index, ASDIC_STREAM_PILOT + round));
    }
    if (!sim->learnt.once && sim->tracer) {
        asdic_tracer_forget(sim->tracer); /* its forms were chosen for other rays */
        sim->learnt.once = true;
    }
    return ASDIC_OK;
}

asdic_status asdic_simulator_learn(asdic_simulator *sim, const asdic_pose *pose, uint64_t index) {
    if (!sim || !pose) {
        return asdic_fail(sim ? sim->ctx : NULL, ASDIC_ERROR_ARGUMENT,
                          "asdic_simulator_learn: NULL argument");
    }
    const asdic_sampling *sampling = &sim->setup.sampling;
    bool adapts = sampling->sampler == ASDIC_SAMPLER_ADAPTIVE,
         calibrates = !sampling->without_errors;
    if (sim->coherent || !(adapts || calibrates) || sampling->left_out & (1u << ASDIC_TERM_RAYS)) {
        return ASDIC_OK;
    }
    TRY(asdic_pose_check(sim->ctx, pose));
    TRY(asdic_simulator_check_depth(sim->ctx, pose->position_m.z));
    TRY(asdic_simulator_center(sim, pose->position_m));
    asdic_simulator_forget(sim);
    asdic_lesson_reach reach = asdic_lesson_reach_of(&sim->setup.sonar);
    sim->learnt.lesson = asdic_lesson_at(sim->setup.scene, &sim->setup.env, &reach, pose);
    if (adapts) {
        TRY(asdic_simulator_settle(sim, learn_table(sim, pose, index)));
    }
    return calibrates ? asdic_simulator_settle(sim, asdic_simulator_calibrate(sim, pose, index))
                      : ASDIC_OK;
}

bool asdic_simulator_learn_is_due(const asdic_simulator *sim, const asdic_pose *pose,
                                  uint64_t index) {
    return sim && pose && asdic_lesson_is_due(&sim->learnt.lesson, pose, index);
}
