/*
 * Who receives what arrives from a direction.
 *
 * Every receiver's pattern weighs every arrival. Where work-items add by atomics, each does so at once for
 * its own rays. Else (DEPOSIT_COLLECT) arrivals are kept in memory: collect.cl adds them group by group, or,
 * where receivers are many, fan.cl bin by bin.
 *
 * A fan's faces may share their vertical axis z and their size (ASDIC_COMMON_AXIS). Then, with x and y
 * across that axis,
 *
 *     B(u) = sinc^2(L_V u.z) sinc^2(L_H (u.y cos yaw - u.x sin yaw))
 *
 * and the first factor, the same for all of them, is applied before arrivals are kept.
 */
#ifndef ASDIC_KERNEL_RECEIVE_H
#define ASDIC_KERNEL_RECEIVE_H

#include "echo.h"
#include "order.h"
#include "truth.h"

#define MAX_ARRIVALS 4

/* Up to four deposits from one direction: quanta, each for a row (component, bin); the dev_arrivals of
 * ASDIC_WIDTH rays. Few on purpose: PoCL keeps the private arrays of a whole work-group on one stack. */
typedef struct arrivals {
    uint count;
    real quanta[MAX_ARRIVALS];
    natural row[MAX_ARRIVALS];
#if ASDIC_TRUTH
    natural truth_row; /* that the energy goes to besides; 0: none */
#endif
} arrivals;

/* Adds a deposit for COMPONENT and BIN, both per lane. */
static void arrivals_add(const world *w, arrivals *a, natural component, natural bin, real energy) {
    real scale = R(0.0);
    LANES {
        AT(scale, float) = w->ping->sums.scale[AT(component, uint)];
    }
    a->quanta[a->count] = energy * scale;
    a->row[a->count++] = component * w->ping->sums.component_rows + bin;
}

/* Adds both halves of an echo. */
static void arrivals_add_echo(const world *w, arrivals *a, natural component,
                              const split_echo *echo) {
    natural last = (natural)(w->ping->bins - 1u);
    arrivals_add(w, a, component, echo->bin, echo->first);
    arrivals_add(w, a, component, min(echo->bin + 1u, last), echo->second);
}

/* Where arrivals go: to the accumulator at once, or to memory, [set][ray, group by group]. */
typedef struct sink {
    __global long *accumulator;
    __global dev_arrival *arrivals;
    __global const dev_truth_row *truth_rows;
    __global long *truth;
} sink;

/* Through layers, water may be taken back as well (volume.cl). */
static real deposited_quanta(real quanta, real limit) {
#if ASDIC_LAYERS
    real whole = whole_quanta(r_abs(quanta), limit);
    return choose(quanta < R(0.0), -whole, whole);
#else
    return whole_quanta(quanta, limit);
#endif
}

/* Where truth goes: ROWS, and CELLS, at which those of the receivers in question begin; NULL: nowhere. */
typedef struct truth_sink {
    __global const dev_truth_row *rows;
    __global long *cells;
} truth_sink;

/* What truth takes of the arrivals of a vector of rays: the first ECHOES deposits of each, all of one component, whose
 * first row is BEFORE. */
typedef struct truth_parts {
    natural echoes, before, row, salt;
    real weight;
} truth_parts;

/* Of arrivals with WORDS, whose first deposits go to ROWS; what comes from the water has no place. */
static truth_parts truth_of(__global const dev_ping *ping, natural words, natural rows) {
    natural component = truth_components(ping, rows), echo = (natural)(MAX_ARRIVALS / 2u);
    truth_parts t;
    t.echoes = choose_natural(component == (natural)(DEV_DEPOSIT_MULTIPATH),
                              (natural)(MAX_ARRIVALS), echo);
    t.echoes = choose_natural(component == (natural)(DEV_DEPOSIT_VOLUME), (natural)(0u), t.echoes);
    t.before = component * (natural)(ping->sums.component_rows);
    t.row = words >> 1u & (natural)((1u << DEV_TRUTH_ROW_BITS) - 1u);
    t.weight = truth_weights(ping, component, words);
    t.salt = truth_salts(words);
    return t;
}

/* For the row of depressions the weight of a deposit of QUANTA times what of it counts, which are WHOLE ones: where these
 * are few, both are then wrong alike, and their ratio is not. */
#define TRUTH_MOMENT(quanta, whole, t)                                                             \
    ((whole) * (t)->weight + dithers(as_natural(quanta) ^ (t)->salt))

/* Adds deposit C of each ray, QUANTA and those as WHOLE ones, which go to ROWS. */
static void add_truth_column(const world *w, truth_sink to, const truth_parts *t, uint c,
                             natural rows, real quanta, real whole) {
    natural bins = rows - t->before, besides = t->row, echoes = t->echoes;
    mask heard = (echoes > (natural)(c)) & (whole > R(0.0));
    if (!any_true(heard)) {
        return;
    }
    real moment = TRUTH_MOMENT(quanta, whole, t);
    LANES {
        if (AT(heard, int) == 0) {
            continue;
        }
        uint bin = AT(bins, uint), row = AT(besides, uint);
        size_t cell = truth_depression_cell(w->ping, bin);
        deposit_add(to.cells + cell, convert_long(AT(moment, float)));
        cell = row != 0u ? truth_cell(w->ping, to.rows, row, bin) : TRUTH_NO_CELL;
        if (cell != TRUTH_NO_CELL) {
            deposit_add(to.cells + cell, convert_long(AT(whole, float)));
        }
    }
}

/* Adds GAIN times every deposit to column COLUMN of its row, counted from cell FIRST, and what T takes to
 * TRUTH; returns how many were cut to the limit. */
static uint add_column(const world *w, const arrivals *a, __global long *cells, truth_sink truth,
                       const truth_parts *t, natural first, natural column, real gain) {
    const real limit = (real)(w->ping->sums.limit);
    uint cut = 0u;
#pragma unroll
    for (uint c = 0; c < MAX_ARRIVALS; c++) {
        if (c >= a->count) {
            break;
        }
        real quanta = gain * a->quanta[c];
        real whole = deposited_quanta(quanta, limit);
        natural at = first + a->row[c] * (natural)(w->ping->sums.columns) + column;
        LANES {
            if (AT(whole, float) != 0.0f) {
                deposit_add(cells + AT(at, uint), convert_long(AT(whole, float)));
            }
            cut += (uint)(fabs(AT(quanta, float)) > w->ping->sums.limit);
        }
        if (ASDIC_TRUTH && truth.cells) {
            add_truth_column(w, truth, t, c, a->row[c], quanta, whole);
        }
    }
    return cut;
}

/* First cells of the groups that RAYS belong to. */
static natural cells_of(const world *w, natural rays) {
    natural first = (natural)(0u);
    if (w->ping->batch.groups > 1u) {
        LANES {
            AT(first, uint) = group_of(w->ping, AT(rays, uint)) * w->ping->sums.group_cells;
        }
    }
    return first;
}

#if ASDIC_DEPOSIT == DEPOSIT_COLLECT

/* Writes the arrivals to SET; collect.cl counts what it cuts. A direct arrival (DEV_ARRIVAL_DIRECT) says
 * whether the ray has arrivals in other sets: it is written first and says no, those that follow change
 * that. */
static uint receive(const world *w, const sink *to, uint set, const arrivals *a, natural rays,
                    triple u) {
    __global dev_arrival *direct = to->arrivals;
    __global dev_arrival *arrivals = to->arrivals + (size_t)(set)*batch_slots(w->ping);
    real gain = R(1.0);
#if ASDIC_TRUTH
    natural words = truth_words(a->truth_row, u.z);
#endif
#if ASDIC_COMMON_AXIS
    __global const float *f = w->ping->fan_rows;
    triple own = {f[0] * u.x + f[1] * u.y + f[2] * u.z, f[3] * u.x + f[4] * u.y + f[5] * u.z,
                  R(0.0)};
    gain = sinc2((real)(w->beams[1].length_v_wl) * (f[6] * u.x + f[7] * u.y + f[8] * u.z));
    u = own;
#endif
    LANES {
        dev_arrival p;
        p.direction[0] = AT(u.x, float);
        p.direction[1] = AT(u.y, float);
        p.direction[2] = AT(u.z, float);
#if ASDIC_TRUTH
        p.more = AT(words, uint);
#else
        p.more = 0u;
#endif
        for (uint c = 0; c < MAX_ARRIVALS; c++) {
            p.row[c] = c < a->count ? AT(a->row[c], const uint) : 0u;
            p.quanta[c] = c < a->count ? AT(gain, float) * AT(a->quanta[c], const float) : 0.0f;
        }
        if (AT(rays, uint) != NO_RAY) {
            uint position = position_of(w->ping, AT(rays, uint));
            arrivals[position] = p;
            if (set != DEV_ARRIVAL_DIRECT && set < DEV_ARRIVAL_WATER(ASDIC_HAS_MIRRORS)) {
                direct[position].more |= 1u;
            }
        }
    }
    return 0u;
}

#else

static uint receive(const world *w, const sink *to, uint set, const arrivals *a, natural rays,
                    triple u) {
    uint cut = 0u;
    natural first = cells_of(w, rays);
    const bool asked = ASDIC_TRUTH && w->ping->sums.truth_rows != 0u;
    truth_parts parts;
#if ASDIC_TRUTH
    parts = truth_of(w->ping, truth_words(a->truth_row, u.z), a->row[0]);
#endif
    for (uint b = 0; b < w->ping->beams; b++) {
        real gain = gain_towards(w->ping, w->beams + 1u + b, u.x, u.y, u.z);
        truth_sink own = {to->truth_rows, asked ? to->truth + b : 0};
        cut += add_column(w, a, to->accumulator, own, &parts, first, (natural)(b), gain);
    }
    return cut;
}

#endif

#endif
