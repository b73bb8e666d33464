/*
 * advance: takes rays from layer to layer of the water.
 *
 * A tracer knows one hierarchy, in which the triangles of all layers lie one below the other, each lifted by its
 * layer's bend (scene/lifted.c). It follows each ray on one leg, as far as the layer goes. Then this kernel notes
 * what ended on a triangle, a plane or at the range, and sends the rest on into the next layer (leg.h).
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

/* So many planes a ray crosses in one go, at most. */
#define ADVANCE_MOST 64u

/* Where legs lie, and what the tracer found on them. */
typedef struct leg_store {
    __global dev_ray *rays;
    __global dev_leg *legs;
    __global const dev_hit *leg_hits;
    __global dev_hit *hits;
    layer_stack layers;
} leg_store;

/* The first leg of SLOT. */
static void begin_leg(const leg_store *to, uint slot) {
    dev_ray ray = to->rays[slot];
    dev_leg leg;
    float z = ray.origin[2];
    uint layer = first_layer(&to->layers, z, ray.direction[2]);
    for (uint k = 0; k < 3u; k++) {
        leg.from[k] = ray.origin[k];
        leg.u[k] = leg.sent[k] = ray.direction[k];
    }
    leg.bend = to->layers.layer[layer].bend_per_m / (1.0f + to->layers.layer[layer].bend_per_m * z);
    leg.pace = leg.slope = 1.0f;
    leg.range = leg.arc = leg.across = leg.along = 0.0f;
    leg.layer = layer;
    to->legs[slot] = leg;
    dev_hit none = {INFINITY, NO_RAY};
    to->hits[slot] = none;
}

/* Which of the rays from AT on, whose legs are in SLOTS, have no triangle on them; notes those that have. */
static mask end_legs(const leg_store *to, natural slots, mask live, uint at) {
#if ASDIC_HAS_MESH
    LANES {
        dev_hit hit = to->leg_hits[at + lane];
        if (AT(live, int) != 0 && hit.triangle != NO_RAY) {
            to->hits[AT(slots, uint)] = hit;
            AT(live, int) = 0;
        }
    }
#endif
    return live;
}

/* Layers that a tracer need not look at. */
static mask are_empty(const leg_store *to, natural layer) {
    mask empty = (mask)(0);
    LANES {
        AT(empty, int) = to->layers.layer[AT(layer, uint)].has_triangles != 0u ? 0 : -1;
    }
    return empty;
}

/* Takes the rays R that CROSS over the planes of their layers, on and on while those are empty; returns those that
 * met what ends them first: they stay where they were. */
static mask cross_planes(__global const dev_ping *ping, const leg_store *to, ray *r, natural *layer,
                         mask cross) {
    mask ended = (mask)(0);
    real sonar = (real)(ping->origin[2]);
    for (uint i = 0; i < ADVANCE_MOST && any_true(cross); i++) {
        leg_planes p = planes_of(&to->layers, *layer);
        real t_below = to_below(r, p.below), t_above = to_above(r, p.above);
        mask down = t_below <= t_above;
        real t = r_min(t_below, t_above);
        real end = r_min(to_below(r, sonar + (real)(ping->bottom_m)),
                         to_above(r, sonar - (real)(ping->surface_m)));
        end = r_min(end, ray_at_range(r, (real)(ping->reach_m)));
        mask over = cross & (t < end);
        ended |= cross & (over == 0);
        ray next = next_leg(r, choose(over, t, R(0.0)), down, &p);
        *r = choose_ray(over, &next, r);
        natural next_layer = choose_natural(down, *layer + 1u, *layer - 1u);
        *layer = choose_natural(over, min(next_layer, (natural)(to->layers.count - 1u)), *layer);
        cross = over & are_empty(to, *layer);
    }
    return ended;
}

static void store_legs(const leg_store *to, const ray *r, natural layer, natural slots, mask on) {
    LANES {
        if (AT(on, int) == 0) {
            continue;
        }
        __global dev_leg *leg = to->legs + AT(slots, uint);
        leg->from[0] = AT(r->from.x, const float);
        leg->from[1] = AT(r->from.y, const float);
        leg->from[2] = AT(r->from.z, const float);
        leg->u[0] = AT(r->u.x, const float);
        leg->u[1] = AT(r->u.y, const float);
        leg->u[2] = AT(r->u.z, const float);
        leg->bend = AT(r->bend, const float);
        leg->pace = AT(r->pace, const float);
        leg->range = AT(r->range, const float);
        leg->arc = AT(r->arc, const float);
        leg->across = AT(r->across, const float);
        leg->along = AT(r->along, const float);
        leg->slope = AT(r->slope, const float);
        leg->layer = AT(layer, uint);
    }
}

/* Brings the legs of the rays R that are ON to the tracer, from AT on, as far as their layers go; returns the next
 * AT. */
static uint trace_legs(__global const dev_ping *ping, const leg_store *to, const ray *r,
                       natural layer, natural slots, mask on, uint at) {
    leg_planes p = planes_of(&to->layers, layer);
    real t = r_min(to_below(r, p.below), to_above(r, p.above));
    t += ADVANCE_ROOM / r_max(r_abs(ray_direction(r, t).z), LEG_LEVEL);
    t = r_min(t, ray_at_range(r, (real)(ping->reach_m)));
    ray_medium water = {p.bend, R(1.0)};
    triple from = ray_lift(r->from, water), along = ray_traced(r, water);
    from.z += p.shift;
    LANES {
        if (AT(on, int) != 0) {
            to->rays[at++] = lane_ray(&from, &along, t, AT(slots, uint), lane);
        }
    }
    return at;
}

/* Sends the rays from SLOT on to their next legs, which lie from AT on; returns the next AT. */
static uint advance_rays(__global const dev_ping *ping, const leg_store *to, bool first, uint slot,
                         uint at) {
    natural slots, layer;
    mask on = (mask)(0);
    LANES {
        dev_ray ray = to->rays[slot + lane];
        AT(on, int) = ray.source != NO_RAY && ray.t_max > 0.0f ? -1 : 0;
        AT(slots, uint) = ray.source != NO_RAY ? ray.source : to->rays[slot].source;
        AT(layer, uint) = to->legs[AT(slots, uint)].layer;
    }
    ray r = load_sonar_rays(ping, to->rays, to->legs, slots).r;
    on = first ? on : end_legs(to, slots, on, slot);
    mask cross = first ? on & are_empty(to, layer) : on;
    mask ended = cross_planes(ping, to, &r, &layer, cross);
    store_legs(to, &r, layer, slots, cross);
    on &= (mask)(ended == 0);
    return any_true(on) ? trace_legs(ping, to, &r, layer, slots, on, at) : at;
}

/* One work-item per piece. FIRST: rays are as they were drawn. Sets *ACTIVE where any ray has a leg to go. */
__kernel void advance(__global const dev_ping *pings, __global const dev_layer *layers, uint count,
                      uint first, __global dev_ray *rays, __global dev_leg *legs,
                      __global const dev_hit *leg_hits, __global dev_hit *hits,
                      __global uint *active) {
    __global const dev_ping *ping = row_ping(pings);
    size_t own = row_slots(ping);
    leg_store to = {rays + own, legs + own, leg_hits + own, hits + own, {layers, count}};
    uint begin = (uint)(get_global_id(0)) * PIECE, at = begin;
    uint end = min(begin + PIECE, batch_slots(ping));
    for (uint slot = begin; slot < end && first != 0u; slot++) {
        begin_leg(&to, slot);
    }
    for (uint slot = begin; slot < end && to.rays[slot].source != NO_RAY; slot += ASDIC_WIDTH) {
        at = advance_rays(ping, &to, first != 0u, slot, at);
    }
    end_piece(to.rays, at, end);
    if (at > begin) {
        *active = 1u;
    }
}

#endif
