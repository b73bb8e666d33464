/*
 * Legs of rays through layers of water: where a layer ends, and how a ray goes on beyond.
 *
 * Directions and sound speeds are continuous at a layer's plane; the width of a tube in the plane of the ray is,
 * too, but its slope is not: it loses cos^2 / sin of the elevation, times the change of the bend, times the width
 * (V. Cerveny, "Seismic ray theory", 2001, section 4.4).
 */
#ifndef ASDIC_KERNEL_LEG_H
#define ASDIC_KERNEL_LEG_H

#include "echo.h"

#if ASDIC_LAYERS

/* Rays that meet a layer's plane at less than this sine of their elevation cross it as if at this. */
#define LEG_LEVEL R(3e-5)
/* So many planes a ray crosses in one go, at most. */
#define LEG_MOST 64u

typedef struct layer_stack {
    __global const dev_layer *layer;
    uint count;
} layer_stack;

/* The layer that a ray sets out in from depth Z of the scene frame: on a plane the one that it goes into. */
static uint first_layer(const layer_stack *to, float z, float down) {
    uint layer = 0u;
    while (layer + 1u < to->count &&
           (z > to->layer[layer].bottom_m || (z == to->layer[layer].bottom_m && down > 0.0f))) {
        layer++;
    }
    return layer;
}

/* The planes of the layers that the legs are in, below and above; and how the bend changes there. */
typedef struct leg_planes {
    real below, above;
    real bend, bend_below, bend_above; /* at the scene frame's zero */
    real shift;
} leg_planes;

/* Whether all lanes have the first one's layer, as neighbours mostly do. */
static bool share_layer(natural layer) {
    return !any_true(layer != (natural)(((const uint *)&layer)[0]));
}

static leg_planes planes_of(const layer_stack *to, natural layer) {
    leg_planes p;
    bool shared = share_layer(layer);
    for (uint lane = 0; lane < (shared ? 1u : ASDIC_WIDTH); lane++) {
        uint own = AT(layer, uint);
        dev_layer here = to->layer[own], up = to->layer[own > 0u ? own - 1u : own],
                  down = to->layer[own + 1u < to->count ? own + 1u : own];
        if (shared) {
            leg_planes all = {(real)(here.bottom_m),   (real)(here.top_m),
                              (real)(here.bend_per_m), (real)(down.bend_per_m),
                              (real)(up.bend_per_m),   (real)(here.shift_m)};
            return all;
        }
        AT(p.below, float) = here.bottom_m;
        AT(p.above, float) = here.top_m;
        AT(p.bend, float) = here.bend_per_m;
        AT(p.bend_below, float) = down.bend_per_m;
        AT(p.bend_above, float) = up.bend_per_m;
        AT(p.shift, float) = here.shift_m;
    }
    return p;
}

/* Layers that a tracer need not look at. */
static mask are_empty(const layer_stack *to, natural layer) {
    mask empty = (mask)(0);
    bool shared = share_layer(layer);
    LANES {
        AT(empty, int) = to->layer[AT(layer, uint)].has_triangles != 0u ? 0 : -1;
        if (shared) {
            return (mask)(AT(empty, int));
        }
    }
    return empty;
}

/* ray_to_plane, which is not asked where all rays go away from the plane for good. */
static real to_plane(real height, real down, real bend) {
    real level = (R(1.0) - down) * (R(1.0) + down);
    mask may = (down > R(0.0)) | (bend * level < (real)(-RAY_LEVEL));
    return any_true(may) ? ray_to_plane(height, down, bend) : (real)(INFINITY);
}

/* T at which the rays come to the plane at Z, below or above. */
static real to_below(const ray *r, real z) {
    return to_plane(z - r->from.z, r->u.z, r->bend);
}

static real to_above(const ray *r, real z) {
    return to_plane(r->from.z - z, -r->u.z, -r->bend);
}

/* The legs after those of R, across a plane at T: below where DOWN, else above. */
static ray next_leg(const ray *r, real t, mask down, const leg_planes *p) {
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
    next.fan = R(1.0) / next.pace;
    real bend = choose(down, p->bend_below, p->bend_above);
    next.bend = bend / (R(1.0) + bend * next.from.z);
    /* The bend below less that above, at the plane. */
    real change = choose(down, next.bend - r->bend / at.q, r->bend / at.q - next.bend);
    real sine = r_max(r_abs(next.u.z), LEG_LEVEL);
    real level2 = next.u.x * next.u.x + next.u.y * next.u.y;
    next.slope = at.q * r->slope - change * level2 / sine * next.along;
    return next;
}

static ray choose_ray(mask first, const ray *a, const ray *b) {
    ray r;
    r.from.x = choose(first, a->from.x, b->from.x);
    r.from.y = choose(first, a->from.y, b->from.y);
    r.from.z = choose(first, a->from.z, b->from.z);
    r.u.x = choose(first, a->u.x, b->u.x);
    r.u.y = choose(first, a->u.y, b->u.y);
    r.u.z = choose(first, a->u.z, b->u.z);
    r.bend = choose(first, a->bend, b->bend);
    r.pace = choose(first, a->pace, b->pace);
    r.range = choose(first, a->range, b->range);
    r.arc = choose(first, a->arc, b->arc);
    r.across = choose(first, a->across, b->across);
    r.along = choose(first, a->along, b->along);
    r.slope = choose(first, a->slope, b->slope);
    r.fan = choose(first, a->fan, b->fan);
    return r;
}

#endif

#endif
