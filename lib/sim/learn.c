/*
 * Learning where rays matter: pilot pings at a block's first pose give, for every cell of the
 * sampling coordinate, how much of each bin's echo it brings; the block's pings then draw every
 * bin's rays in that proportion.
 */
#include "simulator.h"

#include <asdic/plan.h>

#include "base/context.h"

#include "../../kernels/sampler.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define PICKED_MOST 8
#define LEAST_PILOT_RAYS 1024u
/* Share of the density that is learnt; the rest stays even, so that no direction is starved and
 * weights stay bounded whatever the pilots missed. */
#define LEARNT_SHARE 0.7
/* The second pilot is drawn by what the first learnt: two of 4,096 rays are worth one of 16,384. */
#define PILOT_ROUNDS 2u
/* Echoes from the gap count from this share of a bin on, and lower the bottom zone to at most this. */
#define GAP_DEMAND 0.01
#define LOWEST 0.2
/* Cells are smoothed by a triangle of this many cells each side. */
#define SMOOTH 3

/* What the pilots brought, as in survey.cl. */
typedef struct survey {
    const float *xs, *energies;
    const uint32_t *bins;
    size_t slots;
    uint32_t picked;
} survey;

uint32_t asdic_simulator_picked(const asdic_simulator *sim) {
    size_t beams = sim->sonar.receiver_count;
    return (uint32_t)(beams < PICKED_MOST ? beams : PICKED_MOST);
}

size_t asdic_simulator_survey_bytes(const asdic_simulator *sim, size_t slots) {
    return slots * (sizeof(float) + sizeof(uint32_t) + asdic_simulator_picked(sim) * sizeof(float));
}

/* Draws, traces and surveys the pilot rays; blocks. */
static asdic_status survey_run(asdic_simulator *sim, survey *s) {
    const dev_ping *ping = sim->ping;
    s->slots = (size_t)ping->groups * ping->per_group;
    s->picked = asdic_simulator_picked(sim);
    s->xs = sim->survey;
    s->bins = (const uint32_t *)(s->xs + s->slots);
    s->energies = s->xs + 2 * s->slots;
    asdic_kernel_arg args[] = {ASDIC_ARG_BUFFER(sim->ping_buffer),
                               ASDIC_ARG_BUFFER(sim->rays),
                               ASDIC_ARG_BUFFER(sim->solid_angles),
                               ASDIC_ARG_BUFFER(sim->hits),
                               ASDIC_ARG_BUFFER(asdic_simulator_triangles(sim)),
                               ASDIC_ARG_BUFFER(sim->parts),
                               ASDIC_ARG_BUFFER(sim->materials),
                               ASDIC_ARG_BUFFER(sim->survey_rows),
                               ASDIC_ARG_VALUE(s->picked)};
    asdic_status status = asdic_simulator_draw(sim, 1);
    if (!status) {
        status = asdic_kernel_run(sim->survey_kernel, args, sizeof args / sizeof *args,
                                  s->slots / sim->layout.width, sim->layout.local);
    }
    return status ? status
                  : asdic_buffer_read(sim->survey_rows, 0,
                                      asdic_simulator_survey_bytes(sim, s->slots), sim->survey);
}

/* Q[cell] = sum over receivers and bins of the share of the bin's echo that the cell brings. */
static asdic_status demand(asdic_simulator *sim, const survey *s, double *q) {
    double *sums = calloc(sim->bins * s->picked, sizeof *sums);
    if (!sums) {
        return asdic_fail_memory(sim->ctx, "pilot sums");
    }
    for (size_t i = 0; i < s->slots; i++) {
        for (uint32_t p = 0; s->bins[i] != UINT32_MAX && p < s->picked; p++) {
            sums[s->bins[i] * s->picked + p] += s->energies[i * s->picked + p];
        }
    }
    for (size_t i = 0; i < s->slots; i++) {
        if (s->bins[i] == UINT32_MAX) {
            continue;
        }
        double *cell = &q[(size_t)fmin(fmax(s->xs[i] * DEV_TABLE_CELLS, 0.0), DEV_TABLE_CELLS - 1)];
        for (uint32_t p = 0; p < s->picked; p++) {
            double sum = sums[s->bins[i] * s->picked + p];
            *cell += sum > 0.0 ? s->energies[i * s->picked + p] / sum : 0.0;
        }
    }
    free(sums);
    return ASDIC_OK;
}

/* Cumulative probabilities from the demand, smoothed, mixed with evenness. */
static void tabulate(const double *q, float *cumulative) {
    double smooth[DEV_TABLE_CELLS], total = 0.0, sum = 0.0;
    for (int i = 0; i < DEV_TABLE_CELLS; i++) {
        smooth[i] = 0.0;
        for (int d = -SMOOTH; d <= SMOOTH; d++) {
            int j = i + d;
            j = j < 0 ? 0 : j >= DEV_TABLE_CELLS ? DEV_TABLE_CELLS - 1 : j;
            smooth[i] += q[j] * (SMOOTH + 1 - abs(d));
        }
        total += smooth[i];
    }
    cumulative[0] = 0.0f;
    for (int i = 0; i < DEV_TABLE_CELLS; i++) {
        double learnt = total > 0.0 ? smooth[i] / total : 1.0 / DEV_TABLE_CELLS;
        sum += LEARNT_SHARE * learnt + (1.0 - LEARNT_SHARE) / DEV_TABLE_CELLS;
        cumulative[i + 1] = (float)sum;
    }
    cumulative[DEV_TABLE_CELLS] = 1.0f;
}

/* Whether elevations round the sine UZ belong to an object that has rays of its own. */
static bool in_cone_band(const dev_ping *ping, double uz) {
    for (unsigned c = 0; c < ping->cones; c++) {
        double drop = ping->cone[c].cap, sine = sqrt(drop * (2.0 - drop));
        double cell = (ping->zone_bottom_m + ping->zone_surface_m) / ping->reach_m /
                      (ping->zone_share[2] * DEV_TABLE_CELLS);
        if (fabs(uz - ping->cone[c].rows[8]) <= sine + cell) {
            return true;
        }
    }
    return false;
}

/* Where the bottom rises before the range ends, its far bins lie above the bottom zone, crowded in the
 * gap. Whether echoes came from there; if so, the zone is lowered to reach them. Q as from demand. */
static bool lower_zone(asdic_simulator *sim, const double *q) {
    const dev_ping *ping = sim->ping;
    double begin = ping->zone_share[0] + ping->zone_share[1], end = begin + ping->zone_share[2];
    double sine = INFINITY;
    for (int i = (int)ceil(begin * DEV_TABLE_CELLS); i + 1 < end * DEV_TABLE_CELLS; i++) {
        double uz = elevation_of_x(ping, (i + 1.0) / DEV_TABLE_CELLS).uz;
        if (q[i] > GAP_DEMAND && !in_cone_band(ping, uz)) {
            sine = uz;
        }
        if (uz <= 0.0) {
            break;
        }
    }
    double lower = sim->zone_altitude * fmax(sine * ping->reach_m / ping->zone_bottom_m, LOWEST);
    if (begin <= 0.0 || lower > 0.9 * sim->zone_altitude) {
        return false;
    }
    sim->zone_altitude = lower;
    return true;
}

/* As many as pay: coarse pings gain little by knowing more than they can use. */
static uint32_t pilot_rays(const asdic_simulator *sim) {
    uint32_t rays = sim->sampling.rays < ASDIC_PILOT_RAYS ? sim->sampling.rays : ASDIC_PILOT_RAYS;
    return rays > LEAST_PILOT_RAYS ? rays : LEAST_PILOT_RAYS;
}

/* One pilot ping, sampled by the table so far, gives the next. */
static asdic_status learn_once(asdic_simulator *sim, const asdic_pose *pose, uint64_t index,
                               uint32_t stream) {
    asdic_simulator_select(sim, 0);
    asdic_simulator_describe(sim, pose, index, stream, pilot_rays(sim));
    survey s = {0};
    double q[DEV_TABLE_CELLS] = {0};
    asdic_status status = survey_run(sim, &s);
    if (!status) {
        status = demand(sim, &s, q);
    }
    if (!status && !(stream == ASDIC_STREAM_PILOT && lower_zone(sim, q))) {
        tabulate(q, sim->table);
        sim->table_uploaded = false;
    }
    return status;
}

void asdic_simulator_forget(asdic_simulator *sim) {
    sim->zone_altitude = ASDIC_ZONE_ALTITUDE;
    for (int i = 0; i <= DEV_TABLE_CELLS; i++) {
        sim->table[i] = (float)i / DEV_TABLE_CELLS;
    }
    sim->table_uploaded = false;
    for (size_t cell = 0; cell < sim->cells; cell++) {
        sim->stated[cell] =
            sim->fan.cells ? (asdic_stated_error){0.0f, 1.0f} : (asdic_stated_error){1.0f, 0.0f};
    }
}

asdic_status asdic_simulator_learn(asdic_simulator *sim, const asdic_pose *pose, uint64_t index) {
    if (!sim || !pose) {
        return asdic_fail(sim ? sim->ctx : NULL, ASDIC_ERROR_ARGUMENT,
                          "asdic_simulator_learn: NULL argument");
    }
    if (sim->sampling.sampler != ASDIC_SAMPLER_ADAPTIVE ||
        sim->sampling.left_out & (1u << ASDIC_TERM_RAYS)) {
        return ASDIC_OK;
    }
    asdic_status status = asdic_pose_check(sim->ctx, pose);
    if (status) {
        return status;
    }
    asdic_simulator_forget(sim);
    for (uint32_t round = 0; !status && round < PILOT_ROUNDS; round++) {
        status = learn_once(sim, pose, index, ASDIC_STREAM_PILOT + round);
    }
    if (!status && !sim->learnt && sim->tracer) {
        asdic_tracer_forget(sim->tracer); /* its forms were chosen for other rays */
        sim->learnt = true;
    }
    return status || sim->sampling.without_errors ? status
                                                  : asdic_simulator_calibrate(sim, pose, index);
}
