/*
 * From the accumulator's blocks to the ping's sums: totals and their spread over groups.
 */
#include "deposit.h"
#include "ping_batch.h"

/* Water that ends in a bin to water that crosses it; ACCUMULATOR is [group][component][bin][beam]. One
 * work-item per group and beam. With DEPOSIT_COLLECT collect.cl has done it. */
__kernel void suffix(__global const dev_ping *pings, __global long *accumulator) {
    __global const dev_ping *ping = row_ping(pings);
    uint id = (uint)(get_global_id(0));
    uint group = id / ping->beams, beam = id - group * ping->beams;
    if (group >= ping->batch.groups) {
        return;
    }
    size_t plane = (size_t)(ping->sums.component_rows) * ping->sums.columns;
    deposit_sum_crossings(row_cells(ping, accumulator) + group * (size_t)(ping->sums.group_cells) +
                              DEV_DEPOSIT_VOLUME * plane + beam,
                          ping->bins, ping->sums.columns);
}

/* Cells that a work-item sums, in vectors: long runs of memory. */
#if ASDIC_WIDTH == 1
#define VECTORS 1
#else
#define VECTORS 4
#endif

/* For every group G of GROUPS. GPUs keep an array in registers only where all its indices are known. */
#if ASDIC_WIDTH == 1
#define EACH_GROUP(g, groups)                                                                      \
    _Pragma("unroll") for (uint g = 0; g < DEV_MAX_GROUPS; g++) if (g < (groups))
#else
#define EACH_GROUP(g, groups) for (uint g = 0; g < (groups); g++)
#endif

#define RUN (VECTORS * ASDIC_WIDTH)
#define NO_POSITION 0xffffffffu

/* Relative standard error of the sum of the groups' TOTALS, each VECTORS from the last. */
static real spread(const real *totals, uint groups) {
    real mean = R(0.0), square = R(0.0);
    EACH_GROUP(g, groups) {
        mean += totals[g * VECTORS];
    }
    mean /= (real)((float)(groups));
    real inverse = R(1.0) / choose(mean > R(0.0), mean, R(1.0));
    EACH_GROUP(g, groups) {
        real d = (totals[g * VECTORS] - mean) * inverse;
        square += d * d;
    }
    real error = sqrt(square / (real)((float)(groups) * (float)(groups - 1u)));
    return choose(mean > R(0.0), error, R(0.0));
}

#if ASDIC_DEPOSIT == DEPOSIT_COLLECT

/* A component's sums over all work-items of collect.cl, in the cells from FIRST on; the next ping overwrites
 * them. */
static void sum_component(__global const dev_ping *ping, __global const long *cells,
                          const real *units, wholes *sums, real *totals) {
    for (uint v = 0; v < VECTORS; v++) {
        sums[v] = (wholes)(0);
    }
    for (uint block = 1; block < ping->sums.blocks; block += 2u) {
        __global const long *from = cells + block * (size_t)(ping->sums.group_cells);
        for (uint v = 0; v < VECTORS; v++) {
            sums[v] += load_wholes(v, from);
        }
    }
}

/* Reads the groups' totals as collect.cl left them in FROM. */
static void load_totals(__global const dev_ping *ping, __global const float *from, real *totals) {
    EACH_GROUP(g, ping->batch.groups) {
        for (uint v = 0; v < VECTORS; v++) {
            totals[g * VECTORS + v] = load_reals(v, from + g * (size_t)(ping->sums.total_cells));
        }
    }
}

#else

/* Sums over groups of a component's cells from FIRST on; clears them. TOTALS takes [group][vector] in
 * units of the bin's TL d^2. */
static void sum_component(__global const dev_ping *ping, __global long *cells, const real *units,
                          wholes *sums, real *totals) {
    for (uint v = 0; v < VECTORS; v++) {
        sums[v] = (wholes)(0);
    }
    EACH_GROUP(g, ping->batch.groups) {
        __global long *from = cells + g * (size_t)(ping->sums.group_cells);
        for (uint v = 0; v < VECTORS; v++) {
            wholes quanta = load_wholes(v, from);
            store_wholes((wholes)(0), v, from);
            sums[v] += quanta;
            totals[g * VECTORS + v] += wholes_to_real(quanta) * units[v];
        }
    }
}

static void load_totals(__global const dev_ping *ping, __global const float *from, real *totals) {
    (void)ping, (void)from, (void)totals; /* sum_component fills them */
}

#endif

/*
 * One work-item per run of cells (bin, column): sums over groups for every component, then the
 * relative standard error of the total. RESULTS holds a plane [beam][bin] of sums per component, left
 * alone where nothing can be present, the number of deposits that had to be cut, and a plane of floats.
 * Clears what atomics added to, for the next ping.
 */
__kernel void reduce(__global const dev_ping *pings, __global long *accumulator,
                     __global const float *water, __global uint *saturated,
                     __global const float *group_totals, __global long *results) {
    __global const dev_ping *ping = row_ping(pings);
    const uint beams = ping->beams, bins = ping->bins, columns = ping->sums.columns;
    const uint first = (uint)(get_global_id(0)) * RUN;
    const size_t plane = (size_t)(bins)*beams;
    if (first / columns >= bins) {
        return;
    }
    __global const float *volume_ratio = row_water(ping, water) + bins;
    accumulator = row_cells(ping, accumulator);
    results += get_group_id(1) * (size_t)(ping->sums.result_words);
    saturated += get_group_id(1);
    real totals[DEV_MAX_GROUPS * VECTORS], ratios[VECTORS], units[VECTORS];
    wholes sums[VECTORS];
    uint position[RUN]; /* of every cell in a plane of the results, or NO_POSITION */
    uint bin = first / columns, beam = first - bin * columns;
    for (uint k = 0; k < RUN; k++) {
        position[k] = bin < bins && beam < beams ? beam * bins + bin : NO_POSITION;
        ((float *)ratios)[k] = bin < bins ? volume_ratio[bin] : 0.0f;
        bool next = ++beam == columns;
        beam = next ? 0u : beam;
        bin += next ? 1u : 0u;
    }
    EACH_GROUP(g, ping->batch.groups) {
        for (uint v = 0; v < VECTORS; v++) {
            totals[g * VECTORS + v] = R(0.0);
        }
    }
    load_totals(ping, group_totals + row_first_total(ping) + first, totals);
    for (uint c = 0; c < ping->sums.components; c++) {
        if ((ping->sums.present & 1u << c) == 0u) {
            continue;
        }
        real unit = (real)(1.0f / ping->sums.scale[c]);
        for (uint v = 0; v < VECTORS; v++) {
            units[v] = c == DEV_DEPOSIT_VOLUME ? unit * ratios[v] : unit;
        }
        sum_component(ping, accumulator + (size_t)(c)*ping->sums.component_rows * columns + first,
                      units, sums, totals);
        for (uint k = 0; k < RUN; k++) {
            if (position[k] != NO_POSITION) {
                results[c * plane + position[k]] = ((long *)sums)[k];
            }
        }
    }
    __global float *spreads = (__global float *)(results + ping->sums.components * plane + 1u);
    for (uint v = 0; v < VECTORS && ping->states_errors != 0u; v++) {
        real error = spread(totals + v, ping->batch.groups);
        for (uint k = 0; k < ASDIC_WIDTH; k++) {
            uint at = position[v * ASDIC_WIDTH + k];
            if (at != NO_POSITION) {
                spreads[at] = ((float *)&error)[k];
            }
        }
    }
    if (first == 0u) {
        results[ping->sums.components * plane] = (long)(*saturated);
        *saturated = 0u;
    }
}
