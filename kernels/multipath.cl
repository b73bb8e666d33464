/*
 * First-order multipath: what a mirror adds to a ping.
 *
 * A ray that meets an object O (or, where boundaries are mirrors, bottom or surface) at d1 goes on in
 * the mirror direction with the share mu = R^2 exp(-4 k^2 s^2 sin^2 Theta) of its energy and meets X
 * at d2. Two echoes come back:
 *
 *   same way, S-O-X-O-S, at range D = d1 + d2:
 *     E = mu^2 B_T B_R(ray) s_X dOmega / sin Theta_X D^-2 exp(-2 k (D - 1))
 *   across, S-O-X-S and S-X-O-S, at range D = (d1 + d2 + d3) / 2, if X is visible from S:
 *     E = mu [B_T(ray) B_R(X) + B_T(X) B_R(ray)] sqrt(s_X(in) s_X(out)) dOmega / sin Theta_X
 *         d3^-2 exp(-2 k (D - 1))
 *
 * The tube's outgoing spreading cancels against its area, so that only the return spreads. D^-2 is
 * for flat mirrors; at a curved one it becomes 1 / J,
 *
 *     J = D^2 + 2 D d1 d2 (kappa_t / cos i + kappa_s cos i) + 4 d1^2 d2^2 K
 *
 * with the curvatures along and across the plane of incidence and their product K, positive where
 * convex (G. A. Deschamps, "Ray techniques in electromagnetics", Proc. IEEE 60(9), 1972). Near the
 * focus of a concave mirror the gain is held to 20 dB. sqrt(s_in s_out) is exact for Lambert's law.
 */
#include "receive.h"

/* Secondary rays start off the surface they leave, on its SIDE, by more than the rounding of their
 * coordinates. */
static triple lift(triple p, triple normal, real side) {
    real off = R(1e-4) + R(1e-6) * r_max(r_max(r_abs(p.x), r_abs(p.y)), r_abs(p.z));
    p.x += side * off * normal.x;
    p.y += side * off * normal.y;
    p.z += side * off * normal.z;
    return p;
}

static triple load_directions(__global const dev_ray *rays, uint slot) {
    triple d;
    LANES {
        AT(d.x, float) = rays[slot + lane].direction[0];
        AT(d.y, float) = rays[slot + lane].direction[1];
        AT(d.z, float) = rays[slot + lane].direction[2];
    }
    return d;
}

static triple load_origins(__global const dev_ray *rays, uint slot) {
    triple d;
    LANES {
        AT(d.x, float) = rays[slot + lane].origin[0];
        AT(d.y, float) = rays[slot + lane].origin[1];
        AT(d.z, float) = rays[slot + lane].origin[2];
    }
    return d;
}

static void store_rays(__global dev_ray *rays, uint slot, triple from, triple to, real t_max) {
    LANES {
        dev_ray ray;
        ray.origin[0] = AT(from.x, float);
        ray.origin[1] = AT(from.y, float);
        ray.origin[2] = AT(from.z, float);
        ray.t_max = AT(t_max, float);
        ray.direction[0] = AT(to.x, float);
        ray.direction[1] = AT(to.y, float);
        ray.direction[2] = AT(to.z, float);
        ray.pad = 0.0f;
        rays[slot + lane] = ray;
    }
}

/*
 * reflect: the mirror ray of every ray that met a mirror; t_max 0 where there is none. MIRRORS
 * takes of each slot the share mu, d1, kappa_t / cos i + kappa_s cos i, and K.
 */
__kernel void reflect(__global const dev_ping *ping, __global const dev_ray *rays,
                      __global const dev_hit *hits, __global const dev_triangle *triangles,
                      __global const dev_part *parts, __global const dev_material *materials,
                      __global dev_ray *bounced, __global float4 *mirrors) {
    uint slot = (uint)(get_global_id(0)) * ASDIC_WIDTH;
    if (slot >= ping->groups * ping->per_group) {
        return;
    }
    world w = {ping, beams_of(ping), triangles, parts, materials};
    triple u = load_directions(rays, slot), from = load_origins(rays, slot);
    real reach = (real)(ping->range_m);
    meeting m = meet(&w, hits, slot, from, u, reach);
    law_lanes laws = laws_met(&w, &m);
    real share = mirrored(&w, &laws, &m, surface_slant(&m, u).sine);
    mask mirror = (m.kind != DEV_KIND_NONE) & (share > (real)(DEV_MIN_MIRROR));

    real along = dot3(m.surface, u);
    triple to = {u.x - R(2.0) * along * m.surface.x, u.y - R(2.0) * along * m.surface.y,
                 u.z - R(2.0) * along * m.surface.z};
    /* It leaves on the facet's near side; what an interpolated normal turns inwards is lost. */
    real side = choose(dot3(m.facet, u) > R(0.0), R(-1.0), R(1.0));
    mirror &= side * dot3(m.facet, to) > R(0.0);
    share = choose(mirror, share, R(0.0));
    real d1 = choose(mirror, m.range, R(0.0));
    triple start = {from.x + d1 * u.x, from.y + d1 * u.y, from.z + d1 * u.z};
    start = lift(start, m.facet, side);
    /* The farthest d2 with d1 + d2 + d3 <= 2 range, whatever the mirror ray meets. */
    real rest = R(2.0) * reach - d1;
    real t_max = (rest * rest - d1 * d1) / (R(2.0) * r_max(rest + d1 * dot3(u, to), R(1e-3)));
    store_rays(bounced, slot, start, to, choose(mirror, r_min(t_max, reach), R(0.0)));
    LANES {
        smooth_bend bend = {0.0f, 0.0f};
#if ASDIC_HAS_MESH
        if (AT(mirror, int) && hits[slot + lane].t_m == AT(m.range, float)) {
            bend = smooth_bend_of(triangles + hits[slot + lane].triangle, lane_of(&u, lane));
        }
#endif
        mirrors[slot + lane] = (float4)(AT(share, float), AT(d1, float), bend.trace, bend.gauss);
    }
}

/* What the mirror ray of a slot met. */
static meeting meet_bounced(const world *w, __global const dev_ray *bounced,
                            __global const dev_hit *hits, uint slot, triple u, triple from) {
    real limit;
    LANES {
        AT(limit, float) = bounced[slot + lane].t_max;
    }
    meeting m = meet(w, hits, slot, from, u, limit);
    mask off = limit <= R(0.0);
    m.kind = choose_natural(off, (natural)(DEV_KIND_NONE), m.kind);
    return m;
}

/*
 * connect: from every X back to the sonar, to learn whether it is visible. The ray starts off X on
 * the side the mirror ray came from and ends just short of the sonar.
 */
__kernel void connect(__global const dev_ping *ping, __global const dev_ray *bounced,
                      __global const dev_hit *hits, __global const dev_triangle *triangles,
                      __global const dev_part *parts, __global const dev_material *materials,
                      __global dev_ray *returning) {
    uint slot = (uint)(get_global_id(0)) * ASDIC_WIDTH;
    if (slot >= ping->groups * ping->per_group) {
        return;
    }
    world w = {ping, beams_of(ping), triangles, parts, materials};
    triple u = load_directions(bounced, slot), from = load_origins(bounced, slot);
    meeting m = meet_bounced(&w, bounced, hits, slot, u, from);
    mask met = m.kind != DEV_KIND_NONE;
    real d2 = choose(met, m.range, R(0.0));
    triple x = {from.x + d2 * u.x, from.y + d2 * u.y, from.z + d2 * u.z};
    real along = dot3(m.facet, u);
    x = lift(x, m.facet, choose(along > R(0.0), R(-1.0), R(1.0)));
    triple to = {(real)(ping->origin[0]) - x.x, (real)(ping->origin[1]) - x.y,
                 (real)(ping->origin[2]) - x.z};
    real d3 = r_max(sqrt(dot3(to, to)), R(1e-6));
    to.x /= d3;
    to.y /= d3;
    to.z /= d3;
    /* Both legs at X must be on one side of it. */
    mask faces = dot3(to, m.facet) * along < R(0.0);
    real t_max = choose(met & faces, d3 * R(0.9999), R(0.0));
    store_rays(returning, slot, x, to, t_max);
}

typedef struct bounce_store {
    __global const dev_ray *rays, *bounced, *returning;
    __global const dev_hit *bounced_hits, *returning_hits;
    __global const float *solid_angles;
    __global const float4 *mirrors;
} bounce_store;

/* D^2 / J: what the curvature of the mirror does to the echo that comes back over it. */
static real return_gain(real d1, real d2, real bend, real gauss) {
    real d = d1 + d2, twice = R(2.0) * d1 * d2;
    real spread = r_abs(R(1.0) + twice * bend / d + twice * twice * gauss / (d * d));
    return R(1.0) / r_max(spread, R(1e-2));
}

static uint shade_bounces(const world *w, const bounce_store *store, __global long *cells,
                          uint slot) {
    __global const dev_ping *ping = w->ping;
    real share, d1, bend, gauss, weight;
    LANES {
        float4 mirror = store->mirrors[slot + lane];
        AT(share, float) = mirror.x;
        AT(d1, float) = mirror.y;
        AT(bend, float) = mirror.z;
        AT(gauss, float) = mirror.w;
        AT(weight, float) = store->solid_angles[slot + lane];
    }
    if (!any_true(share > R(0.0))) {
        return 0u;
    }
    triple u = load_directions(store->rays, slot);
    triple v = load_directions(store->bounced, slot), from = load_origins(store->bounced, slot);
    triple x = load_directions(store->returning, slot);
    meeting m = meet_bounced(w, store->bounced, store->bounced_hits, slot, v, from);
    law_lanes laws = laws_met(w, &m);
    mask met = m.kind != DEV_KIND_NONE;
    real d2 = choose(met, m.range, R(0.0));
    real visible = R(0.0), d3 = R(1.0);
    LANES {
        dev_ray back = store->returning[slot + lane];
        bool clear = back.t_max > 0.0f;
#if ASDIC_HAS_MESH
        clear = clear && store->returning_hits[slot + lane].triangle == 0xffffffffu;
#endif
        AT(visible, float) = clear ? 1.0f : 0.0f;
        AT(d3, float) = back.t_max > 0.0f ? back.t_max / 0.9999f : 1.0f;
    }
    real none = R(0.0), same_range = d1 + d2, cross_range = R(0.5) * (d1 + d2 + d3);
    slant in = surface_slant(&m, v), out = surface_slant(&m, x);
    real s_in = strength(w, &laws, in, same_range) * scattered(w, &laws, &m, in.sine);
    real s_out = strength(w, &laws, out, same_range) * scattered(w, &laws, &m, out.sine);
    weight *= share / grazing(&m, v);
    real same = choose(met, weight * share * s_in * return_gain(d1, d2, bend, gauss), R(0.0));
    /* split() works relative to TL d^2 at the echo's own range; this leg spreads over d3. */
    real ratio = cross_range / r_max(d3, R(1e-3));
    real cross = visible * weight * sqrt(s_in * s_out) * ratio * ratio;
    cross = choose(met, cross, R(0.0));
    split_echo same_echo = split(ping, same_range, none, same, none);
    split_echo cross_echo = split(ping, cross_range, none, cross, none);
    real ray_out = gain_towards(ping, w->beams, u.x, u.y, u.z);
    real x_out = gain_towards(ping, w->beams, -x.x, -x.y, -x.z);
    /* What returns along the ray: the same-way echo, and the across echo sent towards X. */
    natural component = (natural)(DEV_DEPOSIT_MULTIPATH);
    arrivals along, direct;
    along.count = direct.count = 0u;
    along.even = direct.even = met & !met;
    split_echo sent_to_x = cross_echo, sent_to_mirror = cross_echo;
    sent_to_x.first *= x_out;
    sent_to_x.second *= x_out;
    sent_to_mirror.first *= ray_out;
    sent_to_mirror.second *= ray_out;
    same_echo.first *= ray_out;
    same_echo.second *= ray_out;
    arrivals_add_echo(w, &along, component, &same_echo);
    arrivals_add_echo(w, &along, component, &sent_to_x);
    arrivals_add_echo(w, &direct, component, &sent_to_mirror);
    return receive(w, &along, cells, u.x, u.y, u.z) + receive(w, &direct, cells, -x.x, -x.y, -x.z);
}

/* bounce: deposits both kinds of echo; ITEMS as in shade. */
__kernel void bounce(__global const dev_ping *ping, __global const dev_ray *rays,
                     __global const float *solid_angles, __global const dev_ray *bounced,
                     __global const dev_hit *bounced_hits, __global const dev_ray *returning,
                     __global const dev_hit *returning_hits, __global const float4 *mirrors,
                     __global const dev_triangle *triangles, __global const dev_part *parts,
                     __global const dev_material *materials, __global long *accumulator,
                     __global uint *saturated, uint items) {
    uint group = (uint)(get_global_id(0)) / items;
    if (group >= ping->groups) {
        return;
    }
    uint item = (uint)(get_global_id(0)) - group * items;
    world w = {ping, beams_of(ping), triangles, parts, materials};
    bounce_store store = {rays,           bounced,      returning, bounced_hits,
                          returning_hits, solid_angles, mirrors};
    size_t plane = (size_t)(ping->bins) * ping->columns;
    __global long *cells = accumulator + group * (size_t)(ping->components) * plane;
    uint cut = 0u;
    for (uint k = item * ASDIC_WIDTH; k < ping->per_group; k += items * ASDIC_WIDTH) {
        cut += shade_bounces(&w, &store, cells, group * ping->per_group + k);
    }
    if (cut != 0u) {
        atomic_add(saturated, cut);
    }
}
