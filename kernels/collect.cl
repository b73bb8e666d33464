/*
 * collect: adds the arrivals that shade.cl and multipath.cl left in memory to the accumulator, weighed by
 * every receiver's pattern (DEPOSIT_COLLECT). A work-item takes whole groups, so that no other adds to the
 * same cells.
 */
#include "mirror_ray.h"
#include "receive.h"
#include "ping_batch.h"

#if ASDIC_DEPOSIT == DEPOSIT_COLLECT

/* With this many receivers or fewer, the lanes of a vector are rays and receivers are taken one by one; with
 * more, lanes are receivers and arrivals are taken one by one. */
#define FEW_BEAMS 2u

/* Gains of ASDIC_WIDTH receivers, each towards the directions of ASDIC_WIDTH rays. */
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

/* How many of QUANTA are above the limit of a deposit. */
static uint count_cut(const world *w, real quanta) {
    uint cut = 0u;
    if (any_true(r_abs(quanta) > (real)(w->ping->sums.limit))) {
        LANES {
            cut += (uint)(fabs(AT(quanta, float)) > w->ping->sums.limit);
        }
    }
    return cut;
}

#if ASDIC_TRUTH

/* Where a work-item adds its groups' truth. */
typedef struct truth_sink {
    __global const dev_truth_row *rows;
    __global long *cells;
} truth_sink;

static void add_to_row(const world *w, const truth_sink *to, uint row, uint bin, real quanta) {
    size_t cell = truth_cell(w->ping, to->rows, row, bin);
    if (cell != TRUTH_NO_CELL) {
        wholes whole = to_wholes(whole_quanta(quanta, (real)(w->ping->sums.limit)));
        __global long *at = to->cells + cell;
        store_wholes(load_wholes(0, at) + whole, 0, at);
    }
}

/* Adds ARRIVAL, whose gains are those of LANE, to the truth of the receivers from FIRST on. */
static void add_truth(const world *w, __global const dev_arrival *arrival, truth_sink to,
                      const weights *g, uint lane, uint first) {
    real gain;
    for (uint b = 0; b < ASDIC_WIDTH; b++) {
        ((float *)&gain)[b] = ((const float *)&g->of_beam[b])[lane];
    }
    to.cells += first;
    /* Echoes come first, all of one component; water behind them. */
    uint component = arrival->row[0] / w->ping->sums.component_rows;
    uint before = component * w->ping->sums.component_rows, row = truth_row(arrival->more);
    uint echoes = component == DEV_DEPOSIT_MULTIPATH ? MAX_ARRIVALS : MAX_ARRIVALS / 2u;
    float weight = truth_weight(w->ping, component, arrival->more);
    for (uint c = 0; c < echoes; c++) {
        float arriving = arrival->quanta[c];
        if (!(arriving > 0.0f)) {
            continue;
        }
        uint bin = arrival->row[c] - before;
        add_to_row(w, &to, DEV_TRUTH_DEPRESSION, bin, gain * (arriving * weight));
        if (row != 0u) {
            add_to_row(w, &to, row, bin, gain * arriving);
        }
    }
}

static void add_truths(const world *w, __global const dev_arrival *set, const truth_sink *to,
                       mask on, const weights *g, uint first) {
    if (w->ping->sums.truth_rows != 0u) {
        LANES {
            if (AT(on, int) != 0) {
                add_truth(w, set + lane, *to, g, lane, first);
            }
        }
    }
}

#define ADD_TRUTHS(set, on) add_truths(w, set, truth, on, &g, first)
#else
typedef struct truth_sink {
    int none;
} truth_sink;
#define ADD_TRUTHS(set, on) (void)truth
#endif

/* Adds ARRIVAL, whose gains are those of LANE, to the receivers from FIRST on; returns how many deposits were
 * cut to the limit. The last vector may reach beyond the last receiver: its cells are padding and get 0. */
static uint add_arrival(const world *w, __global const dev_arrival *arrival, __global long *cells,
                        const weights *g, uint lane, uint first) {
    uint cut = 0u;
    real gain, limit = (real)(w->ping->sums.limit);
    for (uint b = 0; b < ASDIC_WIDTH; b++) {
        ((float *)&gain)[b] = ((const float *)&g->of_beam[b])[lane];
    }
    for (uint c = 0; c < MAX_ARRIVALS; c++) {
        float arriving = arrival->quanta[c];
        if (!(fabs(arriving) > 0.0f)) {
            continue;
        }
        real quanta = gain * arriving;
        __global long *at = cells + (size_t)(arrival->row[c]) * w->ping->sums.columns + first;
        store_wholes(load_wholes(0, at) + to_wholes(deposited_quanta(quanta, limit)), 0, at);
        cut += count_cut(w, quanta);
    }
    return cut;
}

#if ASDIC_WIDTH == 8

/* The same for four columns: a vector of eight holds two deposits, four receivers each. */
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
        wholes whole = to_wholes(deposited_quanta(quanta, (real)(w->ping->sums.limit)));
        __global long *at = cells + (size_t)(arrival->row[c]) * 4u;
        vstore4(vload4(0, at) + whole.lo, 0, at);
        at = cells + (size_t)(arrival->row[c + 1u]) * 4u;
        vstore4(vload4(0, at) + whole.hi, 0, at);
        cut += count_cut(w, quanta);
    }
    return cut;
}

#endif

/* Adds the arrivals of ASDIC_WIDTH rays in SET, those of the lanes ON, to the receivers from FIRST on. */
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

/* Adds all arrivals of ASDIC_WIDTH rays, of every set, to the receivers from FIRST on. */
APART static uint add_rays(const world *w, __global const dev_arrival *direct, __global long *cells,
                           const truth_sink *truth, uint first) {
    size_t all = batch_slots(w->ping);
    __global const dev_arrival *along = direct + DEV_ARRIVAL_ALONG * all;
    __global const dev_arrival *across = direct + DEV_ARRIVAL_ACROSS * all;
    mask every = (mask)(-1), more;
    LANES {
        AT(more, int) = (direct[lane].more & 1u) != 0u ? -1 : 0;
    }
    weights g = weigh(w, first, arrival_directions(direct, every));
    uint cut = add_arrivals(w, direct, cells, every, &g, first);
    ADD_TRUTHS(direct, every);
#if ASDIC_LAYERS && ASDIC_HAS_WATER
    __global const dev_arrival *water = direct + DEV_ARRIVAL_WATER(ASDIC_HAS_MIRRORS) * all;
    natural sets;
    LANES {
        AT(sets, uint) = water[lane].more >> DEV_WATER_SHIFT;
    }
    for (uint set = 0; set < DEV_WATER_SETS && any_true(sets > (natural)(set)); set++) {
        cut += add_arrivals(w, water + set * all, cells, sets > (natural)(set), &g, first);
    }
#endif
    if (any_true(more)) {
        cut += add_arrivals(w, along, cells, more, &g, first);
        ADD_TRUTHS(along, more);
        g = weigh(w, first, arrival_directions(across, more));
        cut += add_arrivals(w, across, cells, more, &g, first);
        ADD_TRUTHS(across, more);
    }
    return cut;
}

/* Whether the current group is the work-item's first or last. Before the first, the copy of the sums is of
 * another ping; after the last, the cells are cleared for the next ping. */
typedef struct turn {
    bool first, last;
} turn;

/* A single column, by the names that vectors have. */
typedef long long1;
#define vload1(at, from) ((from)[at])
#define vstore1(value, at, to) ((to)[at] = (value))
#define convert_float1 convert_float

/* Takes the current group's water to TOTALS, in N columns. CELLS are the sums of this group and those before
 * it, SUMS those without it, so that the difference is this group's own; SUMS is brought up to date. Water
 * is deposited in the bin where its ray ends: summed from the far bins to the near ones it becomes the water
 * that crosses each bin. TOTALS is in units of the bin's TL d^2. */
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

/* Takes the current group's totals over all components to TOTALS, in units of the bin's TL d^2, and brings
 * SUMS up to date with CELLS. */
APART static void take_group(__global const dev_ping *ping, turn at_group, __global long *cells,
                             __global long *sums, __global const float *ratio,
                             __global float *totals) {
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

/* A work-item takes one group after the other, with the same cells: they stay in its processor's cache. The
 * cells of a ping in several batches must outlast a batch: then each group has a work-item of its own. */
__kernel void collect(__global const dev_ping *pings, __global const dev_arrival *arrivals,
                      __global long *accumulator, __global uint *saturated,
                      __global const float *water, __global float *totals,
                      __global const dev_truth_row *rows, __global long *truth_cells) {
    __global const dev_ping *ping = row_ping(pings);
    const uint workers = ping->sums.blocks / 2u;
    uint worker = (uint)(get_global_id(0)), cut = 0u;
    if (worker >= workers) {
        return;
    }
    world w = {ping, beams_of(ping), 0, 0, 0, 0};
    __global long *cells =
        row_cells(ping, accumulator) + 2u * worker * (size_t)(ping->sums.group_cells);
    __global long *sums = cells + ping->sums.group_cells;
    __global const float *ratio = row_water(ping, water) + ping->bins;
    arrivals += ARRIVAL_SETS * row_slots(ping);
    totals += row_first_total(ping);
#if ASDIC_TRUTH
    size_t before =
        (size_t)(ping->sums.truth_first) * workers + (size_t)(worker)*ping->sums.truth_cells;
    truth_sink truth = {truth_rows(ping, rows), truth_cells + before * ping->sums.truth_columns};
#else
    truth_sink truth = {0};
    (void)rows, (void)truth_cells;
#endif
    for (uint group = worker; group < ping->batch.groups; group += workers) {
        for (uint k = 0; k < ping->batch.per_group; k += ASDIC_WIDTH) {
            for (uint first = 0; first < ping->beams; first += ASDIC_WIDTH) {
                cut += add_rays(&w, arrivals + group * ping->batch.per_group + k, cells, &truth,
                                first);
            }
        }
        if (ping->batch.last != 0u) {
            turn at_group = {group == worker, group + workers >= ping->batch.groups};
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

#endif
