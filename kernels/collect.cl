/*
 * collect: weighs the parcels that shade.cl and multipath.cl left by every receiver's pattern and adds
 * them to the accumulator. One work-item per group, which owns the group's cells (DEPOSIT_OWNED).
 */
#include "receive.h"

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

/* The parcels of ASDIC_WIDTH rays to the receivers from FIRST on. */
static uint add_rays(const world *w, __global const dev_parcel *parcels, __global long *cells,
                     natural slots, uint first) {
    const uint all = batch_slots(w->ping);
    uint cut = 0u;
    mask more;
    triple u, across;
    LANES {
        __global const dev_parcel *p = parcels + AT(slots, uint);
        AT(u.x, float) = p->direction[0];
        AT(u.y, float) = p->direction[1];
        AT(u.z, float) = p->direction[2];
        AT(more, int) = p->more != 0u ? -1 : 0;
    }
    weights g = weigh(w, first, u);
    LANES {
        cut += add_parcel(w, parcels + AT(slots, uint), cells, &g, lane, first);
    }
    if (!any_true(more)) {
        return cut;
    }
    LANES {
        __global const dev_parcel *p =
            parcels + DEV_PARCEL_ACROSS * (size_t)(all) + AT(slots, uint);
        bool here = AT(more, int) != 0;
        AT(across.x, float) = here ? p->direction[0] : 1.0f;
        AT(across.y, float) = here ? p->direction[1] : 0.0f;
        AT(across.z, float) = here ? p->direction[2] : 0.0f;
    }
    weights back = weigh(w, first, across);
    LANES {
        if (AT(more, int) != 0) {
            __global const dev_parcel *p = parcels + AT(slots, uint);
            cut += add_parcel(w, p + DEV_PARCEL_ALONG * (size_t)(all), cells, &g, lane, first);
            cut += add_parcel(w, p + DEV_PARCEL_ACROSS * (size_t)(all), cells, &back, lane, first);
        }
    }
    return cut;
}

__kernel void collect(__global const dev_ping *ping, __global const dev_parcel *parcels,
                      __global long *accumulator, __global uint *saturated) {
    uint group = (uint)(get_global_id(0)), cut = 0u;
    if (group >= ping->groups) {
        return;
    }
    world w = {ping, beams_of(ping), 0, 0, 0};
    __global long *cells = accumulator + group * (size_t)(ping->group_cells);
    for (uint k = 0; k < ping->per_group; k += ASDIC_WIDTH) {
        natural slots;
        LANES {
            AT(slots, uint) = slot_of(ping, (k + lane) * ping->groups + group);
        }
        for (uint first = 0; first < ping->beams; first += ASDIC_WIDTH) {
            cut += add_rays(&w, parcels, cells, slots, first);
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
        atomic_add(saturated, cut);
    }
}
