/*
 * advance: takes rays from layer to layer of the water.
 *
 * A tracer knows one hierarchy, in which the triangles of all layers lie one below the other, each lifted by its
 * layer's bend (scene/lifted.c). It follows each ray on one leg, as far as the layer goes. Then this kernel notes
 * what ended on a triangle, a plane or at the range, and sends the rest on into the next layer (leg.h).
 *
 * So are the rays that leave a mirror, and those that go back to the sonar from what they met (multipath.cl).
 *
 * Layers without triangles are crossed at once. The rays that have a leg to go lie at the front of their piece of
 * the array, as mirror rays do (mirror_ray.h), and name the slot that they come from.
 */
#include "leg.h"
#include "mirror_ray.h"
#include "ping_batch.h"

#if ASDIC_LAYERS

/* So far beyond a layer's plane, m, a triangle is still met: hits at grazing angles are rounded. */
#define ADVANCE_ROOM R(4e-3)
/* The least sine of their elevation that this is counted along. */
#define ADVANCE_LEVEL R(1e-3)

/* Where legs lie, and what the tracer found on them. */
typedef struct leg_store {
    __global const dev_ray *starts;
    bool from_sonar; /* else from where STARTS says, and legs have been begun there */
    __global dev_ray *rays;
    __global float *legs;
    __global const dev_hit *leg_hits;
    __global dev_hit *hits;
    layer_stack layers;
} leg_store;

/* The first legs of the rays from SLOT on, which all start at the sonar. */
static ray begin_legs(__global const dev_ping *ping, const leg_store *to, uint slot,
                      natural *layer) {
    __global real *row = (__global real *)leg_rows(to->legs, slot);
    float z = ping->origin[2];
    ray r;
    r.from = sonar_of(ping);
    r.u = load_directions(to->starts, slots_from(slot));
    uint above = first_layer(&to->layers, z, -1.0f), below = first_layer(&to->layers, z, 1.0f);
    *layer = choose_natural(r.u.z > R(0.0), (natural)(below), (natural)(above));
    r.bend = planes_of(&to->layers, *layer).bend;
    r.bend /= R(1.0) + r.bend * (real)(z);
    r.pace = r.slope = r.fan = R(1.0);
    r.range = r.arc = r.across = r.along = R(0.0);
    row[LEG_SENT] = r.u.x;
    row[LEG_SENT + 1] = r.u.y;
    row[LEG_SENT + 2] = r.u.z;
    return r;
}

/* The first legs of rays that have been begun elsewhere. */
static ray go_on(const leg_store *to, uint slot, natural *layer) {
    ray r = load_leg(leg_rows(to->legs, slot));
    LANES {
        AT(*layer, uint) = first_layer(&to->layers, AT(r.from.z, float), AT(r.u.z, float));
    }
    r.bend = planes_of(&to->layers, *layer).bend;
    r.bend /= R(1.0) + r.bend * r.from.z;
    return r;
}

/* The range at which the rays from SLOT on end. */
static real end_of(__global const dev_ping *ping, const leg_store *to, uint slot) {
    return to->from_sonar ? (real)(ping->reach_m) : leg_rows(to->legs, slot)[LEG_UNTIL];
}

static void store_leg(const leg_store *to, const ray *r, natural layer, uint slot) {
    __global real *row = (__global real *)leg_rows(to->legs, slot);
    row[LEG_FROM] = r->from.x;
    row[LEG_FROM + 1] = r->from.y;
    row[LEG_FROM + 2] = r->from.z;
    row[LEG_U] = r->u.x;
    row[LEG_U + 1] = r->u.y;
    row[LEG_U + 2] = r->u.z;
    row[LEG_BEND] = r->bend;
    row[LEG_PACE] = r->pace;
    row[LEG_RANGE] = r->range;
    row[LEG_ARC] = r->arc;
    row[LEG_ACROSS] = r->across;
    row[LEG_ALONG] = r->along;
    row[LEG_SLOPE] = r->slope;
    row[LEG_LAYER] = as_real(layer);
}

/* Takes the rays R that CROSS over the planes of their layers, on and on while those are empty; returns those that
 * met what ends them first: they stay where they were. */
static mask cross_planes(__global const dev_ping *ping, const leg_store *to, real until, ray *r,
                         natural *layer, mask cross) {
    mask ended = (mask)(0);
    real sonar = (real)(ping->origin[2]);
    for (uint i = 0; i < LEG_MOST && any_true(cross); i++) {
        leg_planes p = planes_of(&to->layers, *layer);
        real t_below = to_below(r, p.below), t_above = to_above(r, p.above);
        mask down = t_below <= t_above;
        real t = r_min(t_below, t_above);
        real end = ray_at_range(r, until);
        if (ping->bottom_m < INFINITY) {
            end = r_min(end, to_below(r, sonar + (real)(ping->bottom_m)));
        }
        if (ping->surface_m < INFINITY) {
            end = r_min(end, to_above(r, sonar - (real)(ping->surface_m)));
        }
        mask over = cross & (t < end);
        ended |= cross & (over == 0);
        ray next = next_leg(r, choose(over, t, R(0.0)), down, &p);
        *r = choose_ray(over, &next, r);
        natural next_layer = choose_natural(down, *layer + 1u, *layer - 1u);
        *layer = choose_natural(over, min(next_layer, (natural)(to->layers.count - 1u)), *layer);
        cross = over & are_empty(&to->layers, *layer);
    }
    return ended;
}

/* Brings the legs of the rays R that are ON, from SLOT on, to the tracer, where they lie from AT on, as far as their
 * layers go; returns the next AT. */
static uint trace_legs(const leg_store *to, const ray *r, real until, natural layer, mask on,
                       uint slot, uint at) {
    leg_planes p = planes_of(&to->layers, layer);
    real t = r_min(to_below(r, p.below), to_above(r, p.above));
    t += ADVANCE_ROOM / r_max(r_abs(ray_direction(r, t).z), ADVANCE_LEVEL);
    t = r_min(t, ray_at_range(r, until));
    ray_medium water = {p.bend, R(1.0)};
    triple from = ray_lift(r->from, water), along = ray_traced(r, water);
    from.z += p.shift;
    LANES {
        if (AT(on, int) != 0) {
            to->rays[at++] = lane_ray(&from, &along, t, slot + lane, lane);
        }
    }
    return at;
}

/* Sends the rays from SLOT on that are ON to their next legs, which lie from AT on; returns the next AT. */
APART static uint advance_rays(__global const dev_ping *ping, const leg_store *to, bool first,
                               mask on, uint slot, uint at) {
    ray r;
    natural layer;
    mask cross = on;
    if (first) {
        dev_hit none = {INFINITY, NO_RAY};
        LANES {
            to->hits[slot + lane] = none;
        }
        r = to->from_sonar ? begin_legs(ping, to, slot, &layer) : go_on(to, slot, &layer);
        cross &= are_empty(&to->layers, layer);
    } else {
        __global const real *row = leg_rows(to->legs, slot);
        r = load_leg(row);
        layer = as_natural(row[LEG_LAYER]);
    }
    real until = end_of(ping, to, slot);
    on &= (mask)(cross_planes(ping, to, until, &r, &layer, cross) == 0);
    store_leg(to, &r, layer, slot);
    return any_true(on) ? trace_legs(to, &r, until, layer, on, slot, at) : at;
}

/* Which rays of the piece from BEGIN to END have a leg to go on from, by slot: -1. Notes the triangles that others
 * have met on theirs. */
static void end_legs(const leg_store *to, bool first, uint begin, uint end, int *on) {
    for (uint slot = begin; slot < end; slot++) {
        on[slot - begin] = first && to->starts[slot].t_max > 0.0f ? -1 : 0;
    }
    for (uint at = begin; !first && at < end && to->rays[at].source != NO_RAY; at++) {
        uint slot = to->rays[at].source;
        on[slot - begin] = -1;
#if ASDIC_HAS_MESH
        dev_hit hit = to->leg_hits[at];
        if (hit.triangle != NO_RAY) {
            to->hits[slot] = hit;
            on[slot - begin] = 0;
        }
#endif
    }
}

/* One work-item per piece. LEG 0: rays are as they were drawn, in STARTS, where those that end have a T_MAX of 0.
 * Sets ACTIVE[LEG] where any ray has a leg to go. */
__kernel void advance(__global const dev_ping *pings, __global const dev_layer *layers, uint count,
                      uint leg, uint from_sonar, __global const dev_ray *starts,
                      __global dev_ray *rays, __global float *legs,
                      __global const dev_hit *leg_hits, __global dev_hit *hits,
                      __global uint *active) {
    __global const dev_ping *ping = row_ping(pings);
    size_t own = row_slots(ping);
    leg_store to = {starts + own,   from_sonar != 0u, rays + own,     legs + DEV_LEG_FLOATS * own,
                    leg_hits + own, hits + own,       {layers, count}};
    uint begin = (uint)(get_global_id(0)) * PIECE, at = begin;
    uint end = min(begin + PIECE, batch_slots(ping));
    int on[PIECE];
    end_legs(&to, leg == 0u, begin, end, on);
    for (uint slot = begin; slot < end; slot += ASDIC_WIDTH) {
        mask live;
        LANES {
            AT(live, int) = on[slot - begin + lane];
        }
        if (leg == 0u || any_true(live)) {
            at = advance_rays(ping, &to, leg == 0u, live, slot, at);
        }
    }
    end_piece(to.rays, at, end);
    if (at > begin) {
        active[leg] = 1u;
    }
}

#endif
