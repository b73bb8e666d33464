/*
 * volume: the echo of the water that rays cross, where they pass through layers.
 *
 * Water is deposited where its ray ends and summed from far bins to near ones (deposit.h): so every bin on a ray's
 * way gets what water of one sound speed would give it. Tubes that widen in another way give
 *
 *     F(d) = (c / c_s)^2 d^2 / S  exp(-2 K (L - d))
 *
 * times that (ray_bending times c / c_s; S, L: spreading and length of the path up to range d). Each bin takes F
 * at a place that is the ray's own in all of them, from 0 in the bin's nearest to 1. So as not to deposit in every
 * bin, F is rounded to levels that lie a factor e^H apart and begin where the ray says; a deposit of what it loses
 * at a step is what a later sum needs. Rounded to Q = F e^(H x), x evenly from -1/2 to 1/2 over the rays, it is on
 * their mean F sinh(H / 2) / (H / 2); so Q is divided by that. Of many rays a part stands for all.
 */
#include "leg.h"
#include "mirror_ray.h"
#include "ping_batch.h"
#include "random.h"
#include "receive.h"

#if ASDIC_LAYERS && ASDIC_HAS_WATER

/* The levels' distance: less would take more deposits than it saves rays. */
#define VOLUME_STEP R(0.25)
/* Arrivals of a ray, at most: two where it ends, the others of steps. Where F changes more often, levels are farther
 * apart, up to this; where it still does, F is its mean over parts of the way, longer ones farther out: near the sonar
 * the water is all that is heard, and its mean over some metres is not what a bin has. Their length is a share of the
 * range and so many bins. */
#define VOLUME_ROWS ((int)(DEV_WATER_SETS * MAX_ARRIVALS))
#define VOLUME_STEPS (VOLUME_ROWS - 2)
#define VOLUME_HIGH R(1.5)
#define VOLUME_NEAR R(8.0)
/* Between places on the way at which F is looked at, the width of a tube changes by this share, or by more, where
 * F changes by less than VOLUME_EVEN; but they are this share of the range apart at least, less than what a caustic
 * is held over. Any part of a leg is taken at once where F changes by less than VOLUME_FLAT: on a leg F has
 * hardly more than one extremum, since both widths are linear in T. */
#define VOLUME_STRIDE R(0.15)
#define VOLUME_FAR_STRIDE R(0.5)
#define VOLUME_LEAST_STRIDE R(4e-3)
#define VOLUME_ANY_STRIDE R(64.0)
#define VOLUME_EVEN R(0.06)
#define VOLUME_FLAT R(0.01)
/* Legs and strides, at most: a ray that is trapped may cross a plane again and again. */
#define VOLUME_MOST 20000u
/* Water is smoother than a bottom: of more rays than this each second one stands for both, of more than four times
 * as many each fourth, and so on. */
#define VOLUME_RAYS 4096u

/* Rays on their way through layers, without anything that ends them. */
typedef struct wander {
    const layer_stack *to;
    ray r;
    natural layer;
    mask down;         /* the leg ends at the plane below */
    real t, range, f;  /* on the leg, and F there */
    real leave, until; /* where it ends; until which range it is followed: T there */
    real end;          /* that range */
} wander;

static void find_exit(wander *way) {
    leg_planes planes = planes_of(way->to, way->layer);
    real below = to_below(&way->r, planes.below), above = to_above(&way->r, planes.above);
    way->down = below <= above;
    way->leave = r_min(below, above);
    real until = ray_at_range(&way->r, way->end);
    way->until = choose(until >= R(0.0), until, (real)(INFINITY));
}

/* Rays that are followed up to range END. */
static wander set_out(__global const dev_ping *ping, const layer_stack *to, triple sent, real end) {
    wander way;
    way.to = to;
    LANES {
        AT(way.layer, uint) = first_layer(to, ping->origin[2], AT(sent.z, float));
    }
    ray_medium water = {planes_of(to, way.layer).bend, R(1.0)};
    way.r = ray_start(sonar_of(ping), sent, water);
    way.r.pace = R(1.0);
    way.r.slope = way.r.fan = R(1.0);
    way.t = way.range = R(0.0);
    way.f = R(1.0);
    way.end = end;
    find_exit(&way);
    return way;
}

/* Takes the rays that are ON farther, within their legs: by STRIDE of the way on which their tubes would narrow to
 * nothing or have widened from it, and of the range; chooses the next STRIDE. Returns those that went on: others
 * have to try a shorter one. */
static mask stride_on(wander *way, real *stride, real bin_m, real minus_2k, mask on) {
    real width = way->r.along + way->r.slope * way->t;
    mask narrows = width * way->r.slope < R(0.0);
    real by = choose(narrows, r_min(*stride, VOLUME_FAR_STRIDE), *stride) * r_abs(width) /
              r_max(r_abs(way->r.slope), R(1e-6));
    real least = r_max(VOLUME_LEAST_STRIDE * way->range, R(0.05) * bin_m);
    by = r_max(r_min(by, *stride * (way->range + R(4.0) * bin_m)), least);
    real t = r_min(r_min(way->t + by, way->leave), way->until);
    real range = choose(t >= way->until, way->end, ray_range(&way->r, t));
    real f = ray_bending(&way->r, t, r_max(range, R(1e-3)), minus_2k);
    f *= bent_at(&way->r, t).q / way->r.pace; /* a metre of range is c / c_s of the path */
    f = r_max(f, R(1e-12));
    real change = r_abs(f - way->f) / way->f;
    mask flat = change < VOLUME_FLAT, even = (change < VOLUME_EVEN) & (t < way->leave);
    on &= flat | (*stride <= VOLUME_FAR_STRIDE);
    real next = choose(even, r_min(R(2.0) * *stride, VOLUME_FAR_STRIDE), VOLUME_STRIDE);
    *stride = choose(flat, VOLUME_ANY_STRIDE, choose(on, next, VOLUME_STRIDE));
    way->t = choose(on, t, way->t);
    way->range = choose(on, range, way->range);
    way->f = choose(on, f, way->f);
    return on;
}

/* Takes the rays that are ON, and stand at the end of their legs, to the next. */
static void change_legs(wander *way, mask on) {
    mask over = on & (way->t >= way->leave) & (way->range < way->end);
    if (!any_true(over)) {
        return;
    }
    leg_planes planes = planes_of(way->to, way->layer);
    ray next = next_leg(&way->r, choose(over, way->leave, R(0.0)), way->down, &planes);
    way->r = choose_ray(over, &next, &way->r);
    natural layer = choose_natural(way->down, way->layer + 1u, way->layer - 1u);
    way->layer = choose_natural(over, min(layer, (natural)(way->to->count - 1u)), way->layer);
    way->t = choose(over, R(0.0), way->t);
    find_exit(way);
}

/* Arrivals that are kept at a time. A GPU has registers for those of one set, and goes the way again for the next: its
 * private arrays lie in the card's memory. */
#if ASDIC_WIDTH == 1
#define VOLUME_KEPT MAX_ARRIVALS
#define VOLUME_AGAIN 1
#else
#define VOLUME_KEPT VOLUME_ROWS
#define VOLUME_AGAIN 0
#endif

/* F along ASDIC_WIDTH rays, in steps. */
typedef struct steps {
    whole rows;               /* of arrivals so far, from the first that is kept on */
    natural bin[VOLUME_KEPT]; /* the farthest before the step */
    real loss[VOLUME_KEPT];   /* what F loses there */
    natural last;             /* the bin of the last step */
    real end;                 /* F where the ray ends */
} steps;

/* Row AT of LANE, if it is kept, loses LOSS in BIN, AGAIN or for the first time. */
static void lose(steps *s, int at, uint lane, uint bin, float loss, bool again) {
#if ASDIC_WIDTH == 1
#pragma unroll
    for (int k = 0; k < VOLUME_KEPT; k++) { /* no index that the compiler does not know */
        s->bin[k] = at == k ? bin : s->bin[k];
        s->loss[k] = at == k ? (again ? s->loss[k] + loss : loss) : s->loss[k];
    }
#else
    AT(s->bin[at], uint) = bin;
    AT(s->loss[at], float) = again ? AT(s->loss[at], float) + loss : loss;
#endif
}

static void add_step(steps *s, mask on, natural bin, real loss) {
    LANES {
        int at = AT(s->rows, int);
        if (AT(on, int) == 0) {
            continue;
        }
        bool again = at <= VOLUME_ROWS && AT(s->last, uint) == AT(bin, uint);
        at -= again ? 1 : 0;
        AT(s->rows, int) = at + 1;
        if (at < VOLUME_ROWS) {
            AT(s->last, uint) = AT(bin, uint);
            lose(s, at, lane, AT(bin, uint), AT(loss, float), again);
        }
    }
}

/* What rays draw: where in its bins F is taken, and where the levels begin. */
typedef struct volume_draw {
    real place, first;
} volume_draw;

/* Of rays that follow each other, and so leave at neighbouring elevations, evenly spread: multiples of the powers of
 * the root of x^3 = x + 1 (M. Roberts' R2 sequence), from a start that the lattice's shift tells. */
static volume_draw draw_volume(__global const dev_ping *ping, natural rays) {
    natural index = ping->batch.first * ping->batch.groups + rays;
    uint place = ping->sampling.lattice_shift * 747796405u, first = place * 2891336453u + 1u;
    volume_draw d = {random_uniform(place + index * (natural)(3242174889u)),
                     random_uniform(first + index * (natural)(2447445414u))};
    return d;
}

/* How F is rounded: levels a factor e^HEIGHT apart, MIDDLE as above; SPAN > 0: of means over such a
 * share of the range. */
typedef struct volume_grain {
    real height, middle, span;
} volume_grain;

/* MIDDLE: what a level is divided by. */
static volume_grain grain_of(real height, real span) {
    real high = R(0.5) * height;
    volume_grain grain = {height, high / sinh(high), span};
    return grain;
}

/* A rounding under way: the level, and the mean's beginning and sum. */
typedef struct rounding {
    real level, from, sum;
} rounding;

/* The level of F before it is rounded. */
static real level_of(real f, const volume_draw *draw, const volume_grain *grain) {
    return log(r_max(f, R(1e-12))) / grain->height + draw->first;
}

/* What F is taken for on LEVEL. */
static real rounded_to(real level, const volume_draw *draw, const volume_grain *grain) {
    return grain->middle * exp((level + R(0.5) - draw->first) * grain->height);
}

/* Takes the rays that are ON from range BEFORE, where F was F_BEFORE, to where they are now. */
static void round_share(steps *s, rounding *at, const wander *way, const volume_draw *draw,
                        const volume_grain *grain, real before, real f_before, real bin_m,
                        mask on) {
    mask coarse = grain->span > R(0.0);
    real apart = way->range - before, over = way->range - at->from;
    at->sum += choose(on, R(0.5) * (way->f + f_before) * apart, R(0.0));
    mask whole = on & ((coarse == 0) | (over >= grain->span * (at->from + VOLUME_NEAR * bin_m)) |
                       (way->range >= way->end));
    real f = choose(coarse, at->sum / r_max(over, R(1e-6)), way->f);
    real now = level_of(f, draw, grain), level = r_floor(now);
    mask leap = whole & (level != at->level);
    if (any_true(leap)) {
        /* Between the two places F goes by the logarithm. */
        real then = level_of(f_before, draw, grain);
        real edge = R(0.5) * (at->level + level + R(1.0));
        real share = (edge - then) / choose(now == then, R(1.0), now - then);
        real place = choose(coarse, at->from, before + apart * r_min(r_max(share, R(0.0)), R(1.0)));
        real q = rounded_to(level, draw, grain);
        real bin = r_floor(place / bin_m - draw->place);
        add_step(s, leap & (bin >= R(0.0)), to_natural(r_max(bin, R(0.0))), s->end - q);
        s->end = choose(leap, q, s->end);
        at->level = choose(leap, level, at->level);
    }
    at->sum = choose(whole, R(0.0), at->sum);
    at->from = choose(whole, way->range, at->from);
}

/* What ping.cl has of rays: how they left the sonar, their solid angles, the ranges at which they end; a table of the
 * ping's (row_water), and the layers. */
typedef struct water_store {
    __global const float *legs, *solid_angles, *ranges, *volume_inverse;
    layer_stack layers;
} water_store;

/* ASDIC_WIDTH rays whose water is heard, where lanes are ON. Functions load what they need of them, since a GPU lacks
 * registers to keep it meanwhile. */
typedef struct water_rays {
    natural slots;
    mask on;
} water_rays;

/* Their numbers. */
static natural numbers_of(__global const dev_ping *ping, const water_rays *rays) {
    natural numbers;
    LANES {
        AT(numbers, uint) =
            AT(rays->on, const int) != 0 ? ray_in(ping, AT(rays->slots, const uint)) : NO_RAY;
    }
    return numbers;
}

static triple load_sent(const water_store *store, const water_rays *rays) {
    triple sent;
    LANES {
        uint slot = AT(rays->slots, const uint), column = slot % ASDIC_WIDTH;
        __global const float *leg = store->legs + (size_t)(slot - column) * DEV_LEG_FLOATS + column;
        AT(sent.x, float) = leg[LEG_SENT * ASDIC_WIDTH];
        AT(sent.y, float) = leg[(LEG_SENT + 1) * ASDIC_WIDTH];
        AT(sent.z, float) = leg[(LEG_SENT + 2) * ASDIC_WIDTH];
    }
    return sent;
}

static water_end load_end(__global const dev_ping *ping, const water_store *store,
                          const water_rays *rays) {
    real range;
    LANES {
        AT(range, float) = store->ranges[AT(rays->slots, const uint)];
    }
    water_end end = find_water_end(ping, store->volume_inverse, range);
    end.last = choose_natural(rays->on, end.last, (natural)(0u));
    return end;
}

/* Of rays each of which stands for SHARE. */
static real load_weight(const world *w, const water_store *store, const water_rays *rays,
                        uint share) {
    real weight;
    LANES {
        AT(weight, float) = store->solid_angles[AT(rays->slots, const uint)] * (float)(share);
    }
    triple sent = load_sent(store, rays);
    weight *= gain_towards(w->ping, w->beams, sent.x, sent.y, sent.z);
    return choose(rays->on, weight, R(0.0));
}

/* Makes an AMD GPU's compiler load again what it has loaded of RAYS: it would keep that in registers, which are too few.
 * There is a fence, and to the slots comes what is 0, as ROWS are never so many, but a compiler cannot know it. */
#ifdef __AMDGCN__
#define AFRESH(rays, rows)                                                                         \
    do {                                                                                           \
        mem_fence(CLK_GLOBAL_MEM_FENCE);                                                           \
        (rays)->slots += (uint)(rows) >> 31;                                                       \
    } while (0)
#else
#define AFRESH(rays, rows)
#endif

/* F on the way of RAYS, rounded with GRAIN; arrivals from row FIRST on are kept. */
static steps follow_water(__global const dev_ping *ping, const water_store *store,
                          const water_rays *rays, const volume_grain *grain, int first) {
    real minus_2k = (real)(-2.0f * ping->absorption_np_per_m), bin_m = (real)(ping->bin_m);
    volume_draw draw = draw_volume(ping, numbers_of(ping, rays));
    natural last = load_end(ping, store, rays).last;
    real end = (to_real(last) + draw.place) * bin_m, stride = VOLUME_ANY_STRIDE;
    wander way = set_out(ping, &store->layers, load_sent(store, rays), end);
    steps s;
    s.rows = (whole)(2 - first);
    s.last = (natural)(NO_RAY);
    rounding at = {r_floor(level_of(way.f, &draw, grain)), R(0.0), R(0.0)};
    s.end = rounded_to(at.level, &draw, grain);
    mask on = (mask)(-1);
    for (uint i = 0; i < VOLUME_MOST && any_true(on); i++) {
        real before = way.range, f_before = way.f;
        mask moved = stride_on(&way, &stride, bin_m, minus_2k, on);
        round_share(&s, &at, &way, &draw, grain, before, f_before, bin_m, moved);
        change_legs(&way, on);
        on &= way.range < end;
    }
    return s;
}

/* Makes the grain coarser OVER where there were so many ROWS: first levels, then means. */
static void coarsen(volume_grain *grain, natural last, whole rows, mask over) {
    real span =
        (real)(1.1f / (float)(VOLUME_STEPS)) * log(R(1.0) + (to_real(last) + R(1.0)) / VOLUME_NEAR);
    real needed = VOLUME_STEP * (real)(1.2f / (float)(VOLUME_STEPS)) * to_real(rows - 2);
    mask levels = over & (grain->height == VOLUME_STEP) & (needed <= VOLUME_HIGH);
    *grain =
        grain_of(choose(levels, needed, grain->height), choose(over & ~levels, span, grain->span));
}

/* Says that RAY has so many SETS of arrivals; one that another stands for has none. */
static void note_sets(__global const dev_ping *ping, const sink *to, uint ray, uint sets) {
#if ASDIC_DEPOSIT == DEPOSIT_COLLECT
    uint first = DEV_ARRIVAL_WATER(ASDIC_HAS_MIRRORS) * batch_slots(ping);
    to->arrivals[(size_t)(first) + position_of(ping, ray)].more = sets << DEV_WATER_SHIFT;
#else
    (void)ping;
    (void)to;
    (void)ray;
    (void)sets;
#endif
}

/* The arrivals of SET: first two of the water where rays of WEIGHT end, then their STEPS; of ROWS in all. */
static arrivals water_arrivals(const world *w, const steps *s, const water_end *end, real weight,
                               whole rows, uint set) {
    const natural water = (natural)(DEV_DEPOSIT_VOLUME);
    arrivals a;
    a.count = 0u;
#if ASDIC_TRUTH
    a.truth_row = (natural)(0u);
#endif
#pragma unroll
    for (uint c = 0; c < MAX_ARRIVALS; c++) {
        uint k = set * MAX_ARRIVALS + c;
        if (k == 0u) {
            arrivals_add(w, &a, water, end->last, weight * end->part * s->end);
        } else if (k == 1u) {
            real before = choose(end->last == 0u, R(0.0), R(1.0) - end->part);
            arrivals_add(w, &a, water, max(end->last, (natural)(1u)) - 1u,
                         weight * before * s->end);
        } else {
            uint kept = VOLUME_AGAIN ? c : k;
            mask has = (whole)((int)(k)) < rows;
            natural bin = choose_natural(has, s->bin[kept], (natural)(0u));
            arrivals_add(w, &a, water, bin, choose(has, weight * s->loss[kept], R(0.0)));
        }
    }
    return a;
}

/* The lattice of a group's rays of which one stands for the others. */
static uint water_share(__global const dev_ping *ping) {
    uint share = 1u;
    while (share * share * VOLUME_RAYS < ping->batch.rays) {
        share *= 2u;
    }
    return share;
}

/* Brings the water of RAYS, each of which stands for SHARE, to every receiver: with the finest grain that VOLUME_STEPS
 * are enough for. */
APART static uint echo_of_water(const world *w, const water_store *store, const sink *to,
                                water_rays rays, uint share) {
    volume_grain grain = grain_of(VOLUME_STEP, R(0.0));
    uint cut = 0u;
    int row = 0;
    whole rows = (whole)(2);
    real weight;
    water_end end;
    steps s;
    do {
        if (VOLUME_AGAIN || row == 0) {
            s = follow_water(w->ping, store, &rays, &grain, row);
            AFRESH(&rays, s.rows);
            end = load_end(w->ping, store, &rays);
            weight = load_weight(w, store, &rays, share);
            rows = min(s.rows + row, (whole)(VOLUME_ROWS));
        }
        mask over = (s.rows > VOLUME_ROWS) & (grain.span == R(0.0));
        if (any_true(over)) {
            coarsen(&grain, end.last, s.rows, over);
            continue;
        }
        mask here = rows > row;
        uint set = (uint)(row) / MAX_ARRIVALS;
        arrivals a = water_arrivals(w, &s, &end, weight, rows, set);
        natural own = choose_natural(here, numbers_of(w->ping, &rays), (natural)(NO_RAY));
        cut += receive(w, to, DEV_ARRIVAL_WATER(ASDIC_HAS_MIRRORS) + set, &a, own,
                       load_sent(store, &rays));
        row += MAX_ARRIVALS;
    } while (any_true(rows > row));
    LANES {
        if (AT(rays.on, int) != 0) {
            uint sets = ((uint)(AT(rows, int)) + MAX_ARRIVALS - 1u) / MAX_ARRIVALS;
            note_sets(w->ping, to, ray_in(w->ping, AT(rays.slots, uint)), sets);
        }
    }
    return cut;
}

/* One work-item per piece (mirror_ray.h). */
__kernel void LEAST_WAVES(3)
    volume(__global const dev_ping *pings, __global const dev_layer *layers, uint count,
           __global const float *legs, __global const float *solid_angles,
           __global const float *ranges, __global const float *water,
           __global dev_arrival *arrivals, __global long *accumulator, __global uint *saturated,
           __global const dev_truth_row *rows, __global long *truth) {
    __global const dev_ping *ping = row_ping(pings);
    size_t own = row_slots(ping);
    uint first = (uint)(get_global_id(0)) * PIECE, cut = 0u;
    uint end = min(first + PIECE, batch_slots(ping));
    world w = {ping, beams_of(ping), 0, 0, 0, 0};
    water_store store = {legs + DEV_LEG_FLOATS * own,
                         solid_angles + own,
                         ranges + own,
                         row_water(ping, water),
                         {layers, count}};
    sink to = {row_cells(ping, accumulator), arrivals + ARRIVAL_SETS * own, truth_rows(ping, rows),
               truth + (size_t)(ping->sums.truth_first) * ping->sums.truth_columns};
    uint share = water_share(ping), filled = 0u;
    natural slots = (natural)(first);
    for (uint slot = first; slot < end; slot = slot_after(slot, 1u, end)) {
        uint ray = ray_in(ping, slot);
        uint turn =
            ping->batch.first + (ray >> popcount(ping->batch.groups - 1u)) + group_of(ping, ray);
        if ((turn & (share - 1u)) != 0u) {
            note_sets(ping, &to, ray, 0u);
        } else {
            ((uint *)&slots)[filled++] = slot;
        }
        if (filled == ASDIC_WIDTH || (filled > 0u && slot + 1u == end)) {
            water_rays rays;
            rays.slots = slots;
            LANES {
                AT(rays.on, int) = lane < filled ? -1 : 0;
            }
            cut += echo_of_water(&w, &store, &to, rays, share);
            filled = 0u;
        }
    }
    if (cut != 0u) {
        atomic_add(saturated + get_group_id(1), cut);
    }
}

#endif
