/*
 * collect: weighs the arrivals that shade.cl and multipath.cl left by every receiver's pattern and adds
 * them to the accumulator. One work-item per group, which owns the group's cells (DEPOSIT_OWNED).
 */
#include "mirror_ray.h"
#include "receive.h"
#include "ping_batch.h"

/* Up to so many receivers are served one after the other, each with the arrivals of ASDIC_WIDTH rays;
 * more at once, arrival by arrival. */
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

/* How many of QUANTA, deposits of an arrival, have to be cut. */
static uint count_cut(const world *w, real quanta) {
    uint cut = 0u;
    if (any_true(quanta > (real)(w->ping->sums.limit))) {
        LANES {
            cut += (uint)(AT(quanta, float) > w->ping->sums.limit);
        }
    }
    return cut;
}

/* Adds ARRIVAL, which arrives with the gains of LANE, to the receivers from FIRST on; returns how many
 * deposits had to be cut. Cells behind a row's last receiver get 0: the work-item owns them, too. */
static uint add_arrival(const world *w, __global const dev_arrival *arrival, __global long *cells,
                        const weights *g, uint lane, uint first) {
    uint cut = 0u;
    real gain, limit = (real)(w->ping->sums.limit);
    for (uint b = 0; b < ASDIC_WIDTH; b++) {
        ((float *)&gain)[b] = ((const float *)&g->of_beam[b])[lane];
    }
    for (uint c = 0; c < MAX_ARRIVALS; c++) {
        float arriving = arrival->quanta[c];
        if (!(arriving > 0.0f)) {
            continue;
        }
        real quanta = gain * arriving;
        __global long *at = cells + (size_t)(arrival->row[c]) * w->ping->sums.columns + first;
        store_wholes(load_wholes(0, at) + to_wholes(whole_quanta(quanta, limit)), 0, at);
        cut += count_cut(w, quanta);
    }
    return cut;
}

#if ASDIC_WIDTH == 8

/* The same of four columns: what arrives goes to them two by two. */
static uint add_arrival_to_four(const world *w, __global const dev_arrival *arrival,
                                __global long *cells, const weights *g, uint lane) {
    uint cut = 0u;
    float4 gain;
    for (uint b = 0; b < 4u; b++) {
        ((float *)&gain)[b] = ((const float *)&g->of_beam[b])[lane];
    }
    for (uint c = 0; c < MAX_ARRIVALS; c += 2u) {
        float2 arriving = vload2(0, arrival->quanta + c);
        real quanta = gain.xyzwxyzw * arriving.xxxxyyyy;
        wholes whole = to_wholes(whole_quanta(quanta, (real)(w->ping->sums.limit)));
        __global long *at = cells + (size_t)(arrival->row[c]) * 4u;
        vstore4(vload4(0, at) + whole.lo, 0, at);
        at = cells + (size_t)(arrival->row[c + 1u]) * 4u;
        vstore4(vload4(0, at) + whole.hi, 0, at);
        cut += count_cut(w, quanta);
    }
    return cut;
}

#endif

/* The first ASDIC_WIDTH arrivals of SET, where ON, to the receivers from FIRST on. */
static uint add_arrivals(const world *w, __global const dev_arrival *set, __global long *cells,
                         mask on, const weights *g, uint first) {
    uint cut = 0u;
    if (w->ping->beams <= FEW_BEAMS) {
        arrivals a;
        a.count = MAX_ARRIVALS;
        LANES {
            __global const dev_arrival *p = set + lane;
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
        if (AT(on, int) == 0) {
            continue;
        }
#if ASDIC_WIDTH == 8
        if (w->ping->sums.columns == 4u) {
            cut += add_arrival_to_four(w, set + lane, cells, g, lane);
            continue;
        }
#endif
        cut += add_arrival(w, set + lane, cells, g, lane, first);
    }
    return cut;
}

static triple arrival_directions(__global const dev_arrival *set, mask on) {
    triple u;
    LANES {
        __global const dev_arrival *p = set + lane;
        bool here = AT(on, int) != 0;
        AT(u.x, float) = here ? p->direction[0] : 1.0f;
        AT(u.y, float) = here ? p->direction[1] : 0.0f;
        AT(u.z, float) = here ? p->direction[2] : 0.0f;
    }
    return u;
}

/* All arrivals of ASDIC_WIDTH rays to the receivers from FIRST on. */
static uint add_rays(const world *w, __global const dev_arrival *direct, __global long *cells,
                     uint first) {
    size_t all = batch_slots(w->ping);
    __global const dev_arrival *along = direct + DEV_ARRIVAL_ALONG * all;
    __global const dev_arrival *across = direct + DEV_ARRIVAL_ACROSS * all;
    mask every = (mask)(-1), more;
    LANES {
        AT(more, int) = direct[lane].more != 0u ? -1 : 0;
    }
    weights g = weigh(w, first, arrival_directions(direct, every));
    uint cut = add_arrivals(w, direct, cells, every, &g, first);
    if (any_true(more)) {
        cut += add_arrivals(w, along, cells, more, &g, first);
        g = weigh(w, first, arrival_directions(across, more));
        cut += add_arrivals(w, across, cells, more, &g, first);
    }
    return cut;
}

/* Which of a work-item's groups it is at: the sums hold nothing of this ping before the first, and the
 * cells are to be empty after the last. */
typedef struct turn {
    bool first, last;
} turn;

/* A single column, by the names that vectors have. */
typedef long long1;
#define vload1(at, from) ((from)[at])
#define vstore1(value, at, to) ((to)[at] = (value))
#define convert_float1 convert_float

/* CELLS run on from group to group, and SUMS are what they were before: takes the water of one group from
 * between, in N columns, and what of it crosses each bin to TOTALS, in units of the bin's TL d^2. */
#define TAKE_WATER(N)                                                                              \
    static void take_water##N(__global const dev_ping *ping, turn at_group, __global long *cells,  \
                              __global long *sums, __global const float *ratio,                    \
                              __global float *totals) {                                            \
        const float unit = 1.0f / ping->sums.scale[DEV_DEPOSIT_VOLUME];                            \
        long##N crossing = (long##N)(0);                                                           \
        for (uint bin = ping->bins; bin-- > 0u;) {                                                 \
            size_t at = (size_t)(bin)*ping->sums.columns;                                          \
            long##N so_far = vload##N(0, cells + at);                                              \
            crossing += so_far - (at_group.first ? (long##N)(0) : vload##N(0, sums + at));         \
            vstore##N(so_far, 0, sums + at);                                                       \
            if (at_group.last) {                                                                   \
                vstore##N((long##N)(0), 0, cells + at);                                            \
            }                                                                                      \
            vstore##N(convert_float##N(crossing) * (unit * ratio[bin]), 0, totals + at);           \
        }                                                                                          \
    }

TAKE_WATER(1)
TAKE_WATER(4)
TAKE_WATER(8)

/* Takes a group's totals, in units of the bin's TL d^2, to TOTALS, and the cells so far to SUMS. */
static void take_group(__global const dev_ping *ping, turn at_group, __global long *cells,
                       __global long *sums, __global const float *ratio, __global float *totals) {
    const size_t plane = (size_t)(ping->sums.component_rows) * ping->sums.columns;
    __global long *water = cells + DEV_DEPOSIT_VOLUME * plane;
    __global long *water_sums = sums + DEV_DEPOSIT_VOLUME * plane;
    uint column = 0u;
    for (; column + 8u <= ping->sums.columns; column += 8u) {
        take_water8(ping, at_group, water + column, water_sums + column, ratio, totals + column);
    }
    for (; column + 4u <= ping->sums.columns; column += 4u) {
        take_water4(ping, at_group, water + column, water_sums + column, ratio, totals + column);
    }
    for (; column < ping->sums.columns; column++) {
        take_water1(ping, at_group, water + column, water_sums + column, ratio, totals + column);
    }
    for (size_t first = 0; first < (size_t)(ping->bins) * ping->sums.columns;
         first += ASDIC_WIDTH) {
        real total = R(0.0);
        for (uint c = 0; c < ping->sums.components; c++) {
            size_t at = c * plane + first;
            if (c == DEV_DEPOSIT_VOLUME) {
                total += load_reals(0, totals + first);
            } else if ((ping->sums.present & 1u << c) != 0u) {
                wholes so_far = load_wholes(0, cells + at);
                wholes before = at_group.first ? (wholes)(0) : load_wholes(0, sums + at);
                store_wholes(so_far, 0, sums + at);
                if (at_group.last) {
                    store_wholes((wholes)(0), 0, cells + at);
                }
                real scale = (real)(1.0f / ping->sums.scale[c]);
                total += wholes_to_real(so_far - before) * scale;
            }
        }
        store_reals(total, 0, totals + first);
    }
}

/* A work-item serves one group after the other, with the same cells while they are in its cache. Those of
 * a ping in several batches outlast a batch: it has a work-item a group. */
__kernel void collect(__global const dev_ping *pings, __global const dev_arrival *arrivals,
                      __global long *accumulator, __global uint *saturated,
                      __global const float *water, __global float *totals) {
    __global const dev_ping *ping = row_ping(pings);
    const uint owners = ping->sums.blocks / 2u;
    uint owner = (uint)(get_global_id(0)), cut = 0u;
    if (owner >= owners) {
        return;
    }
    world w = {ping, beams_of(ping), 0, 0, 0, 0};
    __global long *cells =
        row_cells(ping, accumulator) + 2u * owner * (size_t)(ping->sums.group_cells);
    __global long *sums = cells + ping->sums.group_cells;
    __global const float *ratio = row_water(ping, water) + ping->bins;
    arrivals += ARRIVAL_SETS * row_slots(ping);
    totals += row_first_total(ping);
    for (uint group = owner; group < ping->batch.groups; group += owners) {
        for (uint k = 0; k < ping->batch.per_group; k += ASDIC_WIDTH) {
            for (uint first = 0; first < ping->beams; first += ASDIC_WIDTH) {
                cut += add_rays(&w, arrivals + group * ping->batch.per_group + k, cells, first);
            }
        }
        if (ping->batch.last != 0u) {
            turn at_group = {group == owner, group + owners >= ping->batch.groups};
            take_group(ping, at_group, cells, sums, ratio,
                       totals + group * (size_t)(ping->sums.total_cells));
        }
    }
    if (ping->batch.last != 0u) {
        sums += DEV_DEPOSIT_VOLUME * (size_t)(ping->sums.component_rows) * ping->sums.columns;
        for (uint column = 0; column < ping->sums.columns; column++) {
            deposit_sum_crossings(sums + column, ping->bins, ping->sums.columns);
        }
    }
    if (cut != 0u) {
        atomic_add(saturated + get_group_id(1), cut);
    }
}
