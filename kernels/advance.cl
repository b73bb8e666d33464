/*
 * advance: takes rays from layer to layer of the water.
 *
 * A tracer knows one hierarchy, in which the triangles of all layers lie one below the other, each lifted by its
 * layer's bend (scene/lifted.c). It follows each ray on one leg, as far as the layer goes. Then this kernel notes
 * what ended on a triangle, a plane or at the range, and sends the rest on into the next layer. Directions and
 * sound speeds are continuous at a layer's plane; the width of a tube in the plane of the ray is, too, but its
 * slope is not: it loses cos^2 / sin of the elevation, times the change of the bend, times the width (V. Cerveny,
 * "Seismic ray theory", 2001, section 4.4).
 */
#include "echo.h"
#include "ping_batch.h"

#if ASDIC_LAYERS

/* Rays that meet a layer's plane at less than this sine of their elevation cross it as if at this. */
#define ADVANCE_LEVEL R(1e-3)
/* So far beyond a layer's plane, m, a triangle is still met: hits at grazing angles are rounded. */
#define ADVANCE_ROOM R(4e-3)

/* Where legs lie, and what the tracer found on them. */
typedef struct leg_store {
    __global dev_ray *rays;
    __global dev_leg *legs;
    __global const dev_hit *leg_hits;
    __global dev_hit *hits;
    __global const dev_layer *layers;
    uint count;
} leg_store;

/* The first leg of SLOT. */
static void begin_leg(__global const dev_ping *ping, const leg_store *to, uint slot) {
    dev_ray ray = to->rays[slot];
    dev_leg leg;
    uint layer = 0u;
    float z = ray.origin[2];
    /* On a plane: the layer that it goes into. */
    while (layer + 1u < to->count &&
           (z > to->layers[layer].bottom_m ||
            (z == to->layers[layer].bottom_m && ray.direction[2] > 0.0f))) {
        layer++;
    }
    for (uint k = 0; k < 3u; k++) {
        leg.from[k] = ray.origin[k];
        leg.u[k] = leg.sent[k] = ray.direction[k];
    }
    leg.bend = to->layers[layer].bend_per_m / (1.0f + to->layers[layer].bend_per_m * z);
    leg.pace = leg.slope = 1.0f;
    leg.range = leg.arc = leg.across = leg.along = 0.0f;
    leg.layer = layer;
    leg.active = ray.t_max > 0.0f ? 1u : 0u;
    to->legs[slot] = leg;
    dev_hit none = {INFINITY, 0xffffffffu};
    to->hits[slot] = none;
    (void)ping;
}

/* What ended the legs from SLOT on: notes triangles; the lanes that go on. */
static mask end_legs(const leg_store *to, uint slot) {
    mask on = (mask)(0);
    LANES {
        if (to->legs[slot + lane].active == 0u) {
            continue;
        }
        AT(on, int) = -1;
#if ASDIC_HAS_MESH
        dev_hit hit = to->leg_hits[slot + lane];
        if (hit.triangle != 0xffffffffu) {
            to->hits[slot + lane] = hit;
            AT(on, int) = 0;
        }
#endif
    }
    return on;
}

/* The planes of the layers that the legs are in, below and above; and how the bend changes there. */
typedef struct leg_planes {
    real below, above;
    real bend, bend_below, bend_above; /* at the scene frame's zero */
    real shift, shift_below, shift_above;
} leg_planes;

static leg_planes planes_of(const leg_store *to, natural layer) {
    leg_planes p;
    LANES {
        uint own = AT(layer, uint);
        dev_layer here = to->layers[own], up = to->layers[own > 0u ? own - 1u : own],
                  down = to->layers[own + 1u < to->count ? own + 1u : own];
        AT(p.below, float) = here.bottom_m;
        AT(p.above, float) = here.top_m;
        AT(p.bend, float) = here.bend_per_m;
        AT(p.bend_below, float) = down.bend_per_m;
        AT(p.bend_above, float) = up.bend_per_m;
        AT(p.shift, float) = here.shift_m;
        AT(p.shift_below, float) = down.shift_m;
        AT(p.shift_above, float) = up.shift_m;
    }
    return p;
}

/* T at which the rays come to the plane at Z, below or above. */
static real to_below(const ray *r, real z) {
    return ray_to_plane(z - r->from.z, r->u.z, r->bend);
}

static real to_above(const ray *r, real z) {
    return ray_to_plane(r->from.z - z, -r->u.z, -r->bend);
}

/* Brings a ray's leg to the tracer, as far as T. */
static void trace_leg(const leg_store *to, const ray *r, real bend, real shift, real t, mask on,
                      uint slot) {
    ray_medium water = {bend, R(1.0)};
    triple from = ray_lift(r->from, water), d = ray_traced(r, water);
    from.z += shift;
    LANES {
        dev_ray ray = to->rays[slot + lane];
        ray.origin[0] = AT(from.x, float);
        ray.origin[1] = AT(from.y, float);
        ray.origin[2] = AT(from.z, float);
        ray.direction[0] = AT(d.x, float);
        ray.direction[1] = AT(d.y, float);
        ray.direction[2] = AT(d.z, float);
        ray.t_max = AT(on, int) != 0 ? AT(t, float) : 0.0f;
        to->rays[slot + lane] = ray;
    }
}

/* The legs R after those of S, across a plane at T: below where DOWN, else above. */
static ray next_leg(const ray *r, real t, mask down, const leg_planes *p, real *zero_bend) {
    bent_place at = bent_at(r, t);
    ray next = *r;
    next.from = ray_point(r, t);
    next.from.z = choose(down, p->below, p->above);
    next.u = ray_direction(r, t);
    next.range = ray_range(r, t);
    next.arc = r->arc + bent_arc(r, &at);
    next.across = bent_across(r, t);
    next.along = r->along + r->slope * t;
    next.pace = r->pace / at.q;
    next.fan = r->fan * at.q;
    *zero_bend = choose(down, p->bend_below, p->bend_above);
    next.bend = *zero_bend / (R(1.0) + *zero_bend * next.from.z);
    /* The bend below less that above, at the plane. */
    real change = choose(down, next.bend - r->bend / at.q, r->bend / at.q - next.bend);
    real sine = r_max(r_abs(next.u.z), ADVANCE_LEVEL);
    real level2 = next.u.x * next.u.x + next.u.y * next.u.y;
    next.slope = at.q * r->slope - change * level2 / sine * next.along;
    return next;
}

static void store_legs(const leg_store *to, const ray *r, natural layer, mask on, mask ended,
                       uint slot) {
    LANES {
        __global dev_leg *leg = to->legs + slot + lane;
        if (AT(on, int) != 0) {
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
        if (AT(ended, int) != 0) {
            leg->active = 0u;
        }
    }
}

/* FIRST: rays are as they were drawn. Sets *ACTIVE where any ray has a leg to go. */
__kernel void advance(__global const dev_ping *pings, __global const dev_layer *layers, uint count,
                      uint first, __global dev_ray *rays, __global dev_leg *legs,
                      __global const dev_hit *leg_hits, __global dev_hit *hits,
                      __global uint *active) {
    __global const dev_ping *ping = row_ping(pings);
    uint slot = (uint)(get_global_id(0)) * ASDIC_WIDTH;
    if (slot >= batch_slots(ping)) {
        return;
    }
    size_t own = row_slots(ping);
    leg_store to = {rays + own, legs + own, leg_hits + own, hits + own, layers, count};
    LANES {
        if (first != 0u) {
            begin_leg(ping, &to, slot + lane);
        }
    }
    natural slots = slots_from(slot), layer;
    ray r = load_sonar_rays(ping, to.rays, to.legs, slots).r;
    LANES {
        AT(layer, uint) = to.legs[slot + lane].layer;
    }
    leg_planes p = planes_of(&to, layer);
    real bend = p.bend, shift = p.shift;
    mask on = (mask)(0);
    if (first == 0u) {
        on = end_legs(&to, slot);
        real t_below = to_below(&r, p.below), t_above = to_above(&r, p.above);
        mask down = t_below <= t_above;
        real t = r_min(t_below, t_above);
        real sonar = (real)(ping->origin[2]);
        real end = r_min(to_below(&r, sonar + (real)(ping->bottom_m)),
                         to_above(&r, sonar - (real)(ping->surface_m)));
        end = r_min(end, ray_at_range(&r, (real)(ping->reach_m)));
        on &= t < end;
        ray next = next_leg(&r, choose(on, t, R(0.0)), down, &p, &bend);
        bend = choose(on, bend, p.bend);
        shift = choose(down, p.shift_below, p.shift_above);
        natural to_layer = choose_natural(down, layer + 1u, layer - 1u);
        layer = choose_natural(on, to_layer, layer);
        layer = min(layer, (natural)(count - 1u));
        store_legs(&to, &next, layer, on, (mask)(on == 0), slot);
        r = next;
        p = planes_of(&to, layer);
    } else {
        LANES {
            AT(on, int) = to.legs[slot + lane].active != 0u ? -1 : 0;
        }
    }
    real t = r_min(to_below(&r, p.below), to_above(&r, p.above));
    t += ADVANCE_ROOM / r_max(r_abs(ray_direction(&r, t).z), ADVANCE_LEVEL);
    t = r_min(t, ray_at_range(&r, (real)(ping->reach_m)));
    trace_leg(&to, &r, bend, shift, t, on, slot);
    if (any_true(on)) {
        *active = 1u;
    }
}

#endif
