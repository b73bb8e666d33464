/*
 * Secondary rays: where they start, and how they are stored.
 *
 * Few rays meet a mirror, and few mirror rays meet anything. Each stage therefore moves its rays to the
 * front of their piece of the array, in their order, and switches off the rest of the piece: the tracer and
 * the scattering laws then work on full vectors.
 */
#ifndef ASDIC_KERNEL_MIRROR_RAY_H
#define ASDIC_KERNEL_MIRROR_RAY_H

#include "echo.h"
#include "order.h"
#include "truth.h"

/* Sets of arrivals that a ping leaves. */
#define ARRIVAL_SETS                                                                               \
    ((size_t)(DEV_ARRIVAL_SETS(ASDIC_HAS_MIRRORS, ASDIC_LAYERS && ASDIC_HAS_WATER)))

/* In dev_ray.source of a mirror ray: what its mirror is, whether that is a plane without triangles, and the slot of the
 * sonar's ray. That ray may have been traced on behind the plane, to a triangle that it has not met. */
#define MIRROR_KIND_SHIFT 29u
#define MIRROR_IS_PLANE 0x10000000u
#define MIRROR_SLOT_MASK 0x0fffffffu

/* Slots of a piece, which is one work-item's share. Vectors need neighbours; GPUs need many work-items. */
#if ASDIC_WIDTH == 1
#define PIECE 1u
#else
#define PIECE 64u
#endif

/* STEP slots after SLOT, in a piece that goes to END. A compiler must see that a piece of one slot is no loop: in
 * registers it would keep what the loop's rounds have in common. */
static uint slot_after(uint slot, uint step, uint end) {
    return PIECE == 1u ? end : slot + step;
}

/* Moves the start P of a secondary ray off the surface that it leaves, to SIDE of its normal, by more than
 * the rounding of coordinates, those of triangles in layers included. */
static triple clear_of(const world *w, triple p, triple normal, real side) {
    real farthest = r_max(r_max(r_abs(p.x), r_abs(p.y)), r_abs(p.z) + (real)(w->ping->shift_m));
    real off = R(1e-4) + R(1e-6) * farthest;
    triple clear = {p.x + side * off * normal.x, p.y + side * off * normal.y,
                    p.z + side * off * normal.z};
    return clear;
}

static dev_ray lane_ray(const triple *from, const triple *to, real t_max, uint source, uint lane) {
    dev_ray ray;
    ray.origin[0] = AT(from->x, const float);
    ray.origin[1] = AT(from->y, const float);
    ray.origin[2] = AT(from->z, const float);
    ray.t_max = AT(t_max, float);
    ray.direction[0] = AT(to->x, const float);
    ray.direction[1] = AT(to->y, const float);
    ray.direction[2] = AT(to->z, const float);
    ray.source = source;
    return ray;
}

/* Switches off the rays from AT to END. */
static void end_piece(__global dev_ray *rays, uint at, uint end) {
    dev_ray off = {{0.0f, 0.0f, 0.0f}, 0.0f, {0.0f, 0.0f, 1.0f}, NO_RAY};
    for (; at < end; at++) {
        rays[at] = off;
    }
}

/* Mirror rays, and for each what its mirror did: (share mu, d1, kappa_t / cos i + kappa_s cos i, K). The share
 * includes what bending does to the level on the way there, once (ray_bending). Through layers: (mu, and what
 * mirrored_tube asks for), and LEGS. */
typedef struct mirror_store {
    __global dev_ray *rays;
    __global float4 *mirrors;
    __global float *legs;
} mirror_store;

#if ASDIC_LAYERS

/* The ray that goes on from START in direction TO where R has met a mirror at T1: the tube of rays goes on as in the
 * image of the water, whose gradient across the mirror steps to its negative (leg.h). NORMAL, ALONG: as in reflect. */
static ray mirrored_ray(const ray *r, real t1, triple start, triple to, triple normal, real along) {
    bent_place at = bent_at(r, t1);
    real cosine = choose(along < R(0.0), r_min(along, R(-1e-3)), r_max(along, R(1e-3)));
    ray next = *r;
    next.from = start;
    next.u = to;
    next.pace = r->pace / at.q;
    next.range = ray_range(r, t1);
    next.arc = r->arc + bent_arc(r, &at);
    next.across = bent_across(r, t1);
    next.along = r->along + r->slope * t1;
    next.slope = at.q * r->slope + R(2.0) * r->bend / at.q * normal.z *
                                       ((R(1.0) - along) * (R(1.0) + along)) / cosine * next.along;
    return next;
}

/* Cross-section of the tube of one steradian of a ray by way of a mirror, at T of its last leg. A curved mirror turns
 * neighbours by twice its curvature times the tube's widths a1, b1 there; from there on they part as in water of one
 * speed. MIRROR: (mu, c1, c2, c3), c1 = B a1 p, c2 = B b1 p, c3 = 4 K a1 b1 p^2 with B and K of ray_mirror_gain, p
 * c at the sonar over that at the mirror. BEFORE: b1. For straight rays this is J of ray_mirror_gain. */
static real mirrored_tube(const ray *r, real t, real before, real c1, real c2, real c3) {
    real a = r->along + r->slope * t, b = bent_across(r, t), apart = b - before;
    return r_abs(a * b + apart * (c1 * b + c2 * a) + apart * apart * c3);
}

#endif

/* Appends the mirror rays of the rays R that lie from SLOT on and met M, mirrored by SHARE, to STORE from
 * AT on; returns the next AT. SPLAT is kept through layers, where shade has written over it. */
static uint reflect(const world *w, const meeting *m, const ray *r, real share, real splat,
                    const mirror_store *store, uint slot, uint at) {
    ray_medium water = medium_of(w->ping);
    real reach = (real)(w->ping->reach_m);
    mask mirror = (m->kind != DEV_KIND_NONE) & (share > (real)(DEV_MIN_MIRROR));
    mirror &= m->t <= ray_at_range(r, reach);
    real t1 = choose(mirror, m->t, R(0.0)), d1 = ray_range(r, t1);
    triple u = ray_direction(r, t1);
    real along = dot3(m->surface, u);
    triple to = {u.x - R(2.0) * along * m->surface.x, u.y - R(2.0) * along * m->surface.y,
                 u.z - R(2.0) * along * m->surface.z};
    /* It leaves on the side that the ray came from; where an interpolated normal would turn it into the
     * body, it is dropped. */
    real side = choose(dot3(m->facet, u) > R(0.0), R(-1.0), R(1.0));
    mirror &= side * dot3(m->facet, to) > R(0.0);
    triple start = clear_of(w, ray_point(r, choose(mirror, m->traced, R(0.0))), m->facet, side);
    /* The farthest d2 with d1 + d2 + d3 <= 2 range, whatever the mirror ray meets. */
    real farthest = ray_mirror_reach(R(2.0) * reach - d1, d1, dot3(u, to));
    farthest = r_min(farthest * (real)(RAY_MIRROR_ROOM), reach);
#if ASDIC_LAYERS
    ray next = mirrored_ray(r, t1, start, to, m->surface, along);
    real t_max = farthest, until = d1 + farthest;
    triple from = start, along_it = to;
    (void)water;
#else
    (void)splat;
    ray next = ray_start(start, to, water);
    real t_max = ray_at_range(&next, farthest);
    triple from = ray_lift(start, water), along_it = ray_traced(&next, water);
    /* Its leg's loss, half of it: an echo goes this way once or twice. */
    real minus_k = (real)(-w->ping->absorption_np_per_m);
    real first_leg = share * sqrt(ray_bending(r, t1, d1, R(2.0) * minus_k));
    ray_turn turn = ray_mirror_turn(r, m->facet, along, side);
#endif
    LANES {
        if (AT(mirror, int) == 0) {
            continue;
        }
        smooth_bend bend = {0.0f, 0.0f};
#if ASDIC_HAS_MESH
        if (AT(m->triangle, const uint) != NO_RAY) {
            bend = smooth_bend_of(w->triangles + AT(m->triangle, const uint), lane_of(&u, lane));
        }
#endif
        uint source = slot + lane;
        source |= AT(m->kind, const uint) << MIRROR_KIND_SHIFT;
        source |= AT(m->triangle, const uint) == NO_RAY ? MIRROR_IS_PLANE : 0u;
        store->rays[at] = lane_ray(&from, &along_it, t_max, source, lane);
#if ASDIC_LAYERS
        float pace = AT(next.pace, float), a1 = pace * AT(next.along, float),
              b1 = pace * AT(next.across, float);
        put_first_leg(store->legs, at, &next, until, next.across, lane);
        store->legs[leg_at(at, LEG_SPLAT)] = AT(splat, float);
        store->mirrors[at++] = (float4)(AT(share, float), bend.trace * a1, bend.trace * b1,
                                        4.0f * bend.gauss * a1 * b1);
#else
        store->mirrors[at++] =
            (float4)(AT(first_leg, float), AT(d1, float), bend.trace + AT(turn.trace, float),
                     bend.gauss + AT(turn.gauss, float));
#endif
    }
    return at;
}

#endif
