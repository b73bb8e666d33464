/*
 * Who receives what arrives from a direction.
 *
 * A few receivers: every arrival is weighed by every receiver's pattern and added to its cell,
 * columns = beams. Where a work-item owns a group, that is left to it (collect.cl), and arrivals are
 * kept as parcels. A fan of many (ASDIC_FAN): its faces share one vertical axis z and one size, so
 * that with s = u . z, m = sqrt(1 - s^2) and phi the azimuth round z
 *
 *     B(u) = sinc^2(L_V s) sinc^2(L_H m sin(phi - yaw))
 *
 * The first factor is applied at once; of the second an arrival keeps only (phi, m): it is split
 * over two azimuth cells and two levels of m, columns = levels x cells, whatever the number
 * of beams. What bottom, surface and water send from all azimuths goes to the nearest level alone, for
 * half the work: a beam's share of it is proportional to the width of its pattern, hence to 1 / m,
 * which is put right. fan.cl then turns cells into beams with one matrix product.
 */
#ifndef ASDIC_KERNEL_RECEIVE_H
#define ASDIC_KERNEL_RECEIVE_H

#include "echo.h"
#include "order.h"

#define MAX_ARRIVALS 4

/* Up to four parcels of energy from one direction, in quanta, for a row (component, bin) each. Small
 * on purpose: PoCL keeps the private arrays of a whole work-group on one stack. */
typedef struct arrivals {
    uint count;
    mask even; /* spread over azimuth, not from a point */
    real quanta[MAX_ARRIVALS];
    natural row[MAX_ARRIVALS];
} arrivals;

/* Adds a parcel for COMPONENT and BIN, both per lane. */
static void arrivals_add(const world *w, arrivals *a, natural component, natural bin, real energy) {
    real scale = R(0.0);
    LANES {
        AT(scale, float) = w->ping->deposit_scale[AT(component, uint)];
    }
    a->quanta[a->count] = energy * scale;
    a->row[a->count++] = component * w->ping->component_rows + bin;
}

/* Adds both halves of an echo. */
static void arrivals_add_echo(const world *w, arrivals *a, natural component,
                              const split_echo *echo) {
    natural last = (natural)(w->ping->bins - 1u);
    arrivals_add(w, a, component, echo->bin, echo->first);
    arrivals_add(w, a, component, min(echo->bin + 1u, last), echo->second);
}

/* Where arrivals go: the accumulator, or parcels [set][ray, group by group]
 * on their way to it. */
typedef struct sink {
    __global long *accumulator;
    __global dev_parcel *parcels;
} sink;

/* Adds GAIN times every parcel to column COLUMN of its row, behind cell FIRST; returns how many had
 * to be cut. */
static uint add_column(const world *w, const arrivals *a, __global long *cells, natural first,
                       natural column, real gain) {
    uint cut = 0u;
    for (uint c = 0; c < a->count; c++) {
        real quanta = gain * a->quanta[c];
        real whole = whole_quanta(quanta, (real)(w->ping->deposit_limit));
        natural at = first + a->row[c] * (natural)(w->ping->columns) + column;
        LANES {
            if (AT(whole, float) > 0.0f) {
                deposit_add(cells + AT(at, uint), convert_long(AT(whole, float)));
            }
            cut += (uint)(AT(quanta, float) > w->ping->deposit_limit);
        }
    }
    return cut;
}

/* First cells of the groups that RAYS belong to. */
static natural cells_of(const world *w, natural rays) {
    natural first = (natural)(0u);
    if (w->ping->groups > 1u) {
        LANES {
            AT(first, uint) = group_of(w->ping, AT(rays, uint)) * w->ping->group_cells;
        }
    }
    return first;
}

#if ASDIC_FAN

/* Levels of m. Between them patterns are interpolated linearly in 1 / m, to which the azimuth width
 * of a pattern is proportional: exact for what is spread over azimuth. */
FORMULA real fan_level_m(int level) {
    const float m[DEV_FAN_LEVELS] = {1.0f, 0.88f, 0.66f, 0.4f, 0.05f};
    return (real)(m[level]);
}

/* Behind the cells, a byte for every DEV_FAN_CHUNK columns of a row, set where anything was added;
 * then how many entries fan_pack has made. */
static __global uchar *fan_flags(__global const dev_ping *ping, __global long *cells) {
    return (__global uchar *)(cells + (size_t)(ping->components) * ping->bins * ping->columns);
}

/* Adds GAIN times every parcel to column COLUMN of its row, as add_column does, and flags it. */
static uint add_flagged(const world *w, const arrivals *a, __global long *cells, natural column,
                        real gain) {
    __global uchar *flags = fan_flags(w->ping, cells);
    for (uint c = 0; c < a->count; c++) {
        real quanta = gain * a->quanta[c];
        natural at = a->row[c] * (natural)(w->ping->fan_flags) + column / DEV_FAN_CHUNK;
        LANES {
            if (AT(quanta, float) > 0.0f) {
                flags[AT(at, uint)] = 1u;
            }
        }
    }
    return add_column(w, a, cells, (natural)(0u), column, gain);
}

static uint receive(const world *w, const sink *to, uint set, const arrivals *a, natural rays,
                    triple u) {
    __global const dev_ping *ping = w->ping;
    __global const float *f = ping->fan_rows;
    __global long *cells = to->accumulator;
    real x = f[0] * u.x + f[1] * u.y + f[2] * u.z;
    real y = f[3] * u.x + f[4] * u.y + f[5] * u.z;
    real s = f[6] * u.x + f[7] * u.y + f[8] * u.z;
    real m = sqrt(r_max((R(1.0) - s) * (R(1.0) + s), R(1e-12)));
    real vertical = sinc((real)(w->beams[1].length_v_wl) * s);
    real at = (atan2(y, x) - (real)(ping->fan_begin_rad)) * (real)(ping->fan_cells_per_rad);
    at = r_min(r_max(at, R(0.0)), (real)((float)(ping->fan_cells - 1u)));
    natural cell = min(to_natural(at), (natural)(ping->fan_cells - 2u));
    real right = at - to_real(cell);
    natural level = (natural)(0u);
    real hi = fan_level_m(0), lo = fan_level_m(1);
    for (int k = 1; k < DEV_FAN_LEVELS - 1; k++) {
        mask below = m < fan_level_m(k);
        level = choose_natural(below, (natural)((uint)(k)), level);
        hi = choose(below, fan_level_m(k), hi);
        lo = choose(below, fan_level_m(k + 1), lo);
    }
    real lower = (R(1.0) / m - R(1.0) / hi) / (R(1.0) / lo - R(1.0) / hi);
    lower = r_min(r_max(lower, R(0.0)), R(1.0));
    real gain = vertical * vertical;
    /* What is spread: to the nearer level alone. */
    mask low = m * m < lo * hi;
    gain *= choose(a->even, choose(low, lo, hi) / m, R(1.0));
    level = choose_natural(a->even & low, level + (natural)(1u), level);
    lower = choose(a->even, R(0.0), lower);
    natural column = level * (natural)(ping->fan_cells) + cell;
    uint cut = add_flagged(w, a, cells, column, gain * (R(1.0) - lower) * (R(1.0) - right));
    cut += add_flagged(w, a, cells, column + 1u, gain * (R(1.0) - lower) * right);
    if (any_true(lower > R(0.0))) {
        gain *= lower;
        level = min(level + (natural)(1u), (natural)(DEV_FAN_LEVELS - 1));
        column = level * (natural)(ping->fan_cells) + cell;
        cut += add_flagged(w, a, cells, column, gain * (R(1.0) - right));
        cut += add_flagged(w, a, cells, column + 1u, gain * right);
    }
    return cut;
}

#elif ASDIC_DEPOSIT == DEPOSIT_OWNED

/* Keeps arrivals as parcels of SET; collect.cl counts what has to be cut. A direct parcel says that
 * no others follow; those that do change that. */
static uint receive(const world *w, const sink *to, uint set, const arrivals *a, natural rays,
                    triple u) {
    __global dev_parcel *direct = to->parcels;
    __global dev_parcel *parcels = to->parcels + (size_t)(set)*batch_slots(w->ping);
    LANES {
        dev_parcel p;
        p.direction[0] = AT(u.x, float);
        p.direction[1] = AT(u.y, float);
        p.direction[2] = AT(u.z, float);
        p.more = 0u;
        for (uint c = 0; c < MAX_ARRIVALS; c++) {
            p.row[c] = c < a->count ? AT(a->row[c], const uint) : 0u;
            p.quanta[c] = c < a->count ? AT(a->quanta[c], const float) : 0.0f;
        }
        if (AT(rays, uint) != NO_RAY) {
            uint place = place_of(w->ping, AT(rays, uint));
            parcels[place] = p;
            if (set != DEV_PARCEL_DIRECT) {
                direct[place].more = 1u;
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
    for (uint b = 0; b < w->ping->beams; b++) {
        real gain = gain_towards(w->ping, w->beams + 1u + b, u.x, u.y, u.z);
        cut += add_column(w, a, to->accumulator, first, (natural)(b), gain);
    }
    return cut;
}

#endif

#endif
