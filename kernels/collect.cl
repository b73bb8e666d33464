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

/* Of the arrivals of SET, those of the lanes ON. Nothing without TO, or where nobody asks. */
static truth_parts truth_of_set(const world *w, __global const dev_arrival *set, mask on,
                                const truth_sink *to) {
    truth_parts none = {(natural)(0u), (natural)(0u), (natural)(0u), (natural)(0u), R(0.0)};
    natural words, first;
    if (!ASDIC_TRUTH || !to || w->ping->sums.truth_rows == 0u) {
        return none;
    }
    LANES {
        bool here = AT(on, int) != 0;
        AT(words, uint) = here ? set[lane].more : 0u;
        AT(first, uint) = here ? set[lane].row[0] : 0u;
    }
    return truth_of(w->ping, words, first);
}

/* That of one arrival, and where it goes. */
typedef struct truth_part {
    uint echoes, before, row, salt;
    float weight;
    const truth_sink *to;
} truth_part;

static truth_part truth_of_lane(const truth_parts *t, uint lane, const truth_sink *to) {
    truth_part part = {AT(t->echoes, const uint),  AT(t->before, const uint),
                       AT(t->row, const uint),     AT(t->salt, const uint),
                       AT(t->weight, const float), to};
    return part;
}

/* Adds an echo in row AT of the accumulator: WHOLE and its MOMENT. */
static void add_truth(const world *w, const truth_part *t, uint at, wholes whole, wholes moment) {
    uint bin = at - t->before;
    size_t cell = truth_depression_cell(w->ping, bin);
    store_wholes(load_wholes(0, t->to->cells + cell) + moment, 0, t->to->cells + cell);
    cell = t->row != 0u ? truth_cell(w->ping, t->to->rows, t->row, bin) : TRUTH_NO_CELL;
    if (cell != TRUTH_NO_CELL) {
        store_wholes(load_wholes(0, t->to->cells + cell) + whole, 0, t->to->cells + cell);
    }
}

/* Adds ARRIVAL, whose gains are those of LANE, to the receivers from FIRST on; returns how many deposits were
 * cut to the limit. The last vector may reach beyond the last receiver: its cells are padding and get 0. */
static uint add_arrival(const world *w, __global const dev_arrival *arrival, __global long *cells,
                        const truth_part *t, const weights *g, uint lane, uint first) {
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
        real counted = deposited_quanta(quanta, limit);
        wholes whole = to_wholes(counted);
        __global long *at = cells + (size_t)(arrival->row[c]) * w->ping->sums.columns + first;
        store_wholes(load_wholes(0, at) + whole, 0, at);
        cut += count_cut(w, quanta);
        if (ASDIC_TRUTH && c < t->echoes) {
            add_truth(w, t, arrival->row[c], whole, to_wholes(TRUTH_MOMENT(quanta, counted, t)));
        }
    }
    return cut;
}

#if ASDIC_WIDTH == 8

/* Adds the halves of TWO, four receivers' each, to the rows FIRST and SECOND. */
static void add_to_four(__global long *first, __global long *second, wholes two) {
    vstore4(vload4(0, first) + two.lo, 0, first);
    vstore4(vload4(0, second) + two.hi, 0, second);
}

/* add_truth of two deposits. Those that are nothing may be in any row: bin 0 gets nothing by them. */
static void add_truth_to_four(const world *w, const truth_part *t, uint2 at, wholes whole,
                              wholes moment) {
    uint2 bin = select((uint2)(0u), at - t->before, at >= t->before);
    add_to_four(t->to->cells + bin.x * 4u, t->to->cells + bin.y * 4u, moment);
    if (t->row == 0u) {
        return;
    }
    size_t first = truth_cell(w->ping, t->to->rows, t->row, bin.x);
    size_t second = truth_cell(w->ping, t->to->rows, t->row, bin.y);
    if (first != TRUTH_NO_CELL) {
        vstore4(vload4(0, t->to->cells + first) + whole.lo, 0, t->to->cells + first);
    }
    if (second != TRUTH_NO_CELL) {
        vstore4(vload4(0, t->to->cells + second) + whole.hi, 0, t->to->cells + second);
    }
}

/* add_arrival for four columns: a vector of eight holds two deposits, four receivers each. */
static uint add_arrival_to_four(const world *w, __global const dev_arrival *arrival,
                                __global long *cells, const truth_part *t, const weights *g,
                                uint lane) {
    uint cut = 0u;
    const float *gains = (const float *)g->of_beam + lane;
    float4 gain = {gains[0], gains[8], gains[16], gains[24]};
    for (uint c = 0; c < MAX_ARRIVALS; c += 2u) {
        float2 arriving = vload2(0, arrival->quanta + c);
        real quanta = gain.xyzwxyzw * arriving.xxxxyyyy;
        real counted = deposited_quanta(quanta, (real)(w->ping->sums.limit));
        wholes whole = to_wholes(counted);
        add_to_four(cells + (size_t)(arrival->row[c]) * 4u,
                    cells + (size_t)(arrival->row[c + 1u]) * 4u, whole);
        cut += count_cut(w, quanta);
        if (ASDIC_TRUTH && c < t->echoes && (arriving.x > 0.0f || arriving.y > 0.0f)) {
            add_truth_to_four(w, t, vload2(0, arrival->row + c), whole,
                              to_wholes(TRUTH_MOMENT(quanta, counted, t)));
        }
    }
    return cut;
}

#endif

/* Adds the arrivals of ASDIC_WIDTH rays in SET, those of the lanes ON, to the receivers from FIRST on; TRUTH is
 * NULL for the water's. */
static uint add_arrivals(const world *w, __global const dev_arrival *set, __global long *cells,
                         const truth_sink *truth, mask on, const weights *g, uint first) {
    uint cut = 0u;
    truth_parts parts = truth_of_set(w, set, on, truth);
    if (w->ping->beams <= FEW_BEAMS) {
        arrivals a;
        const bool asked = ASDIC_TRUTH && truth && w->ping->sums.truth_rows != 0u;
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
            truth_sink own = {0, 0};
            if (asked) {
                own = (truth_sink){truth->rows, truth->cells + b};
            }
            cut += add_column(w, &a, cells, own, &parts, (natural)(0u), column, g->of_beam[b]);
        }
        return cut;
    }
    LANES {
        if (AT(on, int) == 0) {
            continue;
        }
        truth_part part = truth_of_lane(&parts, lane, truth);
#if ASDIC_WIDTH == 8
        if (w->ping->sums.columns == 4u) {
            cut += add_arrival_to_four(w, set + lane, cells, &part, g, lane);
            continue;
        }
#endif
        cut += add_arrival(w, set + lane, cells, &part, g, lane, first);
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
    truth_sink own = {truth->rows, truth->cells + first};
    uint cut = add_arrivals(w, direct, cells, &own, every, &g, first);
#if ASDIC_LAYERS && ASDIC_HAS_WATER
    __global const dev_arrival *water = direct + DEV_ARRIVAL_WATER(ASDIC_HAS_MIRRORS) * all;
    natural sets;
    LANES {
        AT(sets, uint) = water[lane].more >> DEV_WATER_SHIFT;
    }
    for (uint set = 0; set < DEV_WATER_SETS && any_true(sets > (natural)(set)); set++) {
        cut += add_arrivals(w, water + set * all, cells, 0, sets > (natural)(set), &g, first);
    }
#endif
    if (any_true(more)) {
        cut += add_arrivals(w, along, cells, &own, more, &g, first);
        g = weigh(w, first, arrival_directions(across, more));
        cut += add_arrivals(w, across, cells, &own, more, &g, first);
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
    size_t before =
        (size_t)(ping->sums.truth_first) * workers + (size_t)(worker)*ping->sums.truth_cells;
    truth_sink truth = {truth_rows(ping, rows), truth_cells + before * ping->sums.truth_columns};
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
