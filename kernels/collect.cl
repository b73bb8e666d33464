/*
 * collect: weighs the parcels that shade.cl and multipath.cl left by every receiver's pattern and adds
 * them to the accumulator. One work-item per group, which owns the group's cells (DEPOSIT_OWNED).
 */
#include "mirror_ray.h"
#include "receive.h"
#include "volley.h"

/* Up to so many receivers are served one after the other, each with the parcels of ASDIC_WIDTH rays;
 * more at once, parcel by parcel. */
#define FEW_BEAMS 2u

/* ASDIC_WIDTH receivers, from FIRST on, towards as many directions. */
typedef struct weights {
    real of_beam[ASDIC_WIDTH];
} weights;

static weights weigh(const world *w, uint first, triple u) {
    weights g;
    for (uint b = 0; b < ASDIC_WIDTH; b++) {
        g.of_beam[b] = R(0.0);
        if (first + b < w->ping->beams) {
            g.of_beam[b] = gain_towards(w->ping, w->beams + 1u + first + b, u.x, u.y, u.z);
        }
    }
    return g;
}

/* Adds PARCEL, which arrives with the gains of LANE, to the receivers from FIRST on; returns how many
 * deposits had to be cut. Cells behind a row's last receiver get 0: the work-item owns them, too. */
static uint add_parcel(const world *w, __global const dev_parcel *parcel, __global long *cells,
                       const weights *g, uint lane, uint first) {
    uint cut = 0u;
    real gain, limit = (real)(w->ping->deposit_limit);
    for (uint b = 0; b < ASDIC_WIDTH; b++) {
        ((float *)&gain)[b] = ((const float *)&g->of_beam[b])[lane];
    }
    for (uint c = 0; c < MAX_ARRIVALS; c++) {
        float arriving = parcel->quanta[c];
        if (!(arriving > 0.0f)) {
            continue;
        }
        real quanta = gain * arriving;
        __global long *at = cells + (size_t)(parcel->row[c]) * w->ping->columns + first;
        store_wholes(load_wholes(0, at) + to_wholes(whole_quanta(quanta, limit)), 0, at);
        if (any_true(quanta > limit)) {
            for (uint b = 0; b < ASDIC_WIDTH; b++) {
                cut += (uint)(((float *)&quanta)[b] > w->ping->deposit_limit);
            }
        }
    }
    return cut;
}

/* The first ASDIC_WIDTH parcels of SET, where ON, to the receivers from FIRST on. */
static uint add_parcels(const world *w, __global const dev_parcel *set, __global long *cells,
                        mask on, const weights *g, uint first) {
    uint cut = 0u;
    if (w->ping->beams <= FEW_BEAMS) {
        arrivals a;
        a.count = MAX_ARRIVALS;
        LANES {
            __global const dev_parcel *p = set + lane;
            bool here = AT(on, int) != 0;
            for (uint c = 0; c < MAX_ARRIVALS; c++) {
                AT(a.row[c], uint) = here ? p->row[c] : 0u;
                AT(a.quanta[c], float) = here ? p->quanta[c] : 0.0f;
            }
        }
        for (uint b = 0; b < ASDIC_WIDTH && first + b < w->ping->beams; b++) {
            natural column = (natural)(first + b);
            cut += add_column(w, &a, cells, (natural)(0u), column, g->of_beam[b]);
        }
        return cut;
    }
    LANES {
        if (AT(on, int) != 0) {
            cut += add_parcel(w, set + lane, cells, g, lane, first);
        }
    }
    return cut;
}

static triple parcel_directions(__global const dev_parcel *set, mask on) {
    triple u;
    LANES {
        __global const dev_parcel *p = set + lane;
        bool here = AT(on, int) != 0;
        AT(u.x, float) = here ? p->direction[0] : 1.0f;
        AT(u.y, float) = here ? p->direction[1] : 0.0f;
        AT(u.z, float) = here ? p->direction[2] : 0.0f;
    }
    return u;
}

/* All parcels of ASDIC_WIDTH rays to the receivers from FIRST on. */
static uint add_rays(const world *w, __global const dev_parcel *direct, __global long *cells,
                     uint first) {
    size_t all = batch_slots(w->ping);
    __global const dev_parcel *along = direct + DEV_PARCEL_ALONG * all;
    __global const dev_parcel *across = direct + DEV_PARCEL_ACROSS * all;
    mask every = (mask)(-1), more;
    LANES {
        AT(more, int) = direct[lane].more != 0u ? -1 : 0;
    }
    weights g = weigh(w, first, parcel_directions(direct, every));
    uint cut = add_parcels(w, direct, cells, every, &g, first);
    if (any_true(more)) {
        cut += add_parcels(w, along, cells, more, &g, first);
        g = weigh(w, first, parcel_directions(across, more));
        cut += add_parcels(w, across, cells, more, &g, first);
    }
    return cut;
}

__kernel void collect(__global const dev_ping *pings, __global const dev_parcel *parcels,
                      __global long *accumulator, __global uint *saturated) {
    __global const dev_ping *ping = row_ping(pings);
    uint group = (uint)(get_global_id(0)), cut = 0u;
    if (group >= ping->groups) {
        return;
    }
    world w = {ping, beams_of(ping), 0, 0, 0};
    __global long *cells = row_cells(ping, accumulator) + group * (size_t)(ping->group_cells);
    parcels += PARCEL_SETS * row_slots(ping);
    for (uint k = 0; k < ping->per_group; k += ASDIC_WIDTH) {
        for (uint first = 0; first < ping->beams; first += ASDIC_WIDTH) {
            cut += add_rays(&w, parcels + group * ping->per_group + k, cells, first);
        }
    }
    if (ping->last_batch != 0u) {
        __global long *water =
            cells + DEV_DEPOSIT_VOLUME * (size_t)(ping->component_rows) * ping->columns;
        for (uint column = 0; column < ping->columns; column++) {
            deposit_sum_crossings(water + column, ping->bins, ping->columns);
        }
    }
    if (cut != 0u) {
        atomic_add(saturated + get_group_id(1), cut);
    }
}
