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
 * for flat mirrors; at a curved one it becomes 1 / J (ray_mirror_gain). sqrt(s_in s_out) is exact for
 * Lambert's law.
 */
#include "mirror_ray.h"
#include "receive.h"
#include "ping_batch.h"

static ray load_rays(__global const dev_ray *rays, natural slots, ray_medium water) {
    triple at;
    LANES {
        __global const float *from = rays[AT(slots, uint)].origin;
        AT(at.x, float) = from[0];
        AT(at.y, float) = from[1];
        AT(at.z, float) = from[2];
    }
    return ray_of_traced(ray_unlift(at, water), load_directions(rays, slots), water);
}

/* What the mirror rays R in SLOTS met. */
static meeting meet_bounced(const world *w, __global const dev_ray *bounced,
                            __global const dev_hit *hits, natural slots, const ray *r) {
    real limit;
    LANES {
        AT(limit, float) = bounced[AT(slots, uint)].t_max;
    }
    meeting m = meet(w, hits, slots, r, limit);
    mask off = limit <= R(0.0);
    m.kind = choose_natural(off, (natural)(DEV_KIND_NONE), m.kind);
    return m;
}

/* Appends the ways back of the mirror rays from SLOT on to RETURNING from AT on; the next AT. */
static uint connect_rays(const world *w, __global const dev_ray *bounced,
                         __global const dev_hit *hits, __global const float4 *mirrors,
                         __global dev_ray *returning, uint slot, uint at) {
    natural slots = slots_from(slot);
    real d1;
    LANES {
        AT(d1, float) = bounced[slot + lane].source == NO_RAY ? 0.0f : mirrors[slot + lane].y;
    }
    ray_medium water = medium_of(w->ping);
    ray r = load_rays(bounced, slots, water);
    meeting m = meet_bounced(w, bounced, hits, slots, &r);
    mask met = m.kind != DEV_KIND_NONE;
    if (!any_true(met)) {
        return at;
    }
    real t2 = choose(met, m.t, R(0.0)), d2 = ray_range(&r, t2);
    real along = dot3(m.facet, ray_direction(&r, t2));
    triple x = clear_of(ray_point(&r, choose(met, m.traced, R(0.0))), m.facet,
                        choose(along > R(0.0), R(-1.0), R(1.0)));
    ray_way home = ray_between(x, sonar_of(w->ping), water, R(1e-6));
    triple from = ray_lift(x, water), along_it = ray_traced(&home.r, water);
    /* Both legs at X must be on one side of it. */
    mask faces = dot3(home.r.u, m.facet) * along < R(0.0);
    /* What comes back across from beyond the range is not received; let rounding pass. */
    mask near = d1 + d2 + ray_range(&home.r, home.t) < (real)(2.0002f * w->ping->range_m);
    real t_max = choose(faces & near, home.t * R(0.9999), R(0.0));
    LANES {
        if (AT(met, int) != 0) {
            returning[at++] = lane_ray(&from, &along_it, t_max, slot + lane, lane);
        }
    }
    return at;
}

/*
 * connect: from every X back to the sonar, to learn whether it is visible. The ray starts off X on
 * the side the mirror ray came from and ends just short of the sonar. One work-item per piece.
 */
__kernel void connect(__global const dev_ping *pings, __global const dev_ray *bounced,
                      __global const dev_hit *hits, __global const dev_triangle *triangles,
                      __global const dev_part *parts, __global const dev_material *materials,
                      __global const float4 *mirrors, __global dev_ray *returning) {
    __global const dev_ping *ping = row_ping(pings);
    size_t own = row_slots(ping);
    bounced += own;
    hits += own;
    mirrors += own;
    returning += own;
    uint first = (uint)(get_global_id(0)) * PIECE, at = first;
    uint end = min(first + PIECE, batch_slots(ping));
    world w = {ping, beams_of(ping), triangles, parts, materials, 0};
    for (uint slot = first; slot < end && bounced[slot].source != NO_RAY; slot += ASDIC_WIDTH) {
        at = connect_rays(&w, bounced, hits, mirrors, returning, slot, at);
    }
    end_piece(returning, at, end);
}

typedef struct bounce_store {
    __global const dev_ray *rays, *bounced, *returning;
    __global const dev_hit *bounced_hits, *returning_hits;
    __global const float *solid_angles;
    __global const float4 *mirrors;
} bounce_store;

/* The echoes of what ASDIC_WIDTH mirror rays met, by their ways back from SLOT on. */
static uint shade_bounces(const world *w, const bounce_store *store, const sink *to, uint slot) {
    __global const dev_ping *ping = w->ping;
    real share, d1, bend, gauss, weight;
    natural slots = slots_from(slot), mirrors, sources, targets;
    arrivals along, direct;
    mask on;
    LANES { /* the first lane is on; lanes that are off compute with its mirror ray */
        uint own = store->returning[slot + lane].source;
        uint mirror = own == NO_RAY ? store->returning[slot].source : own;
        float4 what = store->mirrors[mirror];
        uint source = store->bounced[mirror].source;
#if ASDIC_TRUTH
        uint kind = source >> TRUTH_KIND_SHIFT;
        AT(along.truth_row, uint) = kind == DEV_KIND_SURFACE  ? DEV_TRUTH_BY_SURFACE
                                    : kind == DEV_KIND_BOTTOM ? DEV_TRUTH_BY_BOTTOM
                                                              : 0u;
        source &= TRUTH_SLOT_MASK;
#endif
        AT(on, int) = own == NO_RAY ? 0 : -1;
        AT(mirrors, uint) = mirror;
        AT(sources, uint) = source;
        AT(targets, uint) = own == NO_RAY ? NO_RAY : ray_in(ping, source);
        AT(share, float) = what.x;
        AT(d1, float) = what.y;
        AT(bend, float) = what.z;
        AT(gauss, float) = what.w;
        AT(weight, float) = store->solid_angles[source];
    }
    ray_medium water = medium_of(ping);
    ray r = load_rays(store->bounced, mirrors, water);
    triple u = load_sonar_rays(ping, store->rays, 0, sources).sent;
    ray home = load_rays(store->returning, slots, water);
    triple x = home.u;
    meeting m = meet_bounced(w, store->bounced, store->bounced_hits, mirrors, &r);
    law_lanes laws = laws_met(w, &m);
    mask met = on & (m.kind != DEV_KIND_NONE);
    real t2 = choose(met, m.t, R(0.0)), d2 = ray_range(&r, t2);
    triple v = ray_direction(&r, t2);
    real visible = R(0.0), t3 = R(1.0);
    LANES {
        dev_ray back = store->returning[slot + lane];
        bool clear = back.t_max > 0.0f;
#if ASDIC_HAS_MESH
        clear = clear && store->returning_hits[slot + lane].triangle == 0xffffffffu;
#endif
        AT(visible, float) = clear ? 1.0f : 0.0f;
        AT(t3, float) = back.t_max > 0.0f ? back.t_max / 0.9999f : 1.0f;
    }
    real d3 = ray_range(&home, t3);
    real none = R(0.0), same_range = d1 + d2, cross_range = R(0.5) * (d1 + d2 + d3);
    slant in = surface_slant(&m, v), out = surface_slant(&m, x);
    real s_in =
        strength(w, &laws, in, same_range) * scattered(w, &laws, mirrored(w, &laws, &m, in));
    real s_out =
        strength(w, &laws, out, same_range) * scattered(w, &laws, mirrored(w, &laws, &m, out));
    weight *= share / grazing(&m, v);
    real minus_2k = (real)(-2.0f * ping->absorption_np_per_m);
    real second_leg = sqrt(ray_bending(&r, t2, d2, minus_2k));
    weight *= second_leg;
    real same = weight * share * s_in * ray_mirror_gain(d1, d2, bend, gauss) * second_leg;
    same = choose(met, same, R(0.0));
    /* split() works relative to TL d^2 at the echo's own range; this leg spreads over d3. */
    real ratio = cross_range / r_max(d3, R(1e-3));
    real cross = visible * weight * sqrt(s_in * s_out) * ratio * ratio;
    cross *= sqrt(ray_bending(&home, t3, d3, minus_2k));
    cross = choose(met, cross, R(0.0));
    split_echo same_echo = split(ping, same_range, none, same, none);
    split_echo cross_echo = split(ping, cross_range, none, cross, none);
    triple back = ray_back(&home, t3);
    real ray_out = gain_towards(ping, w->beams, u.x, u.y, u.z);
    real x_out = gain_towards(ping, w->beams, back.x, back.y, back.z);
    /* What returns along the ray: the same-way echo, and the across echo sent towards X. */
    natural component = (natural)(DEV_DEPOSIT_MULTIPATH);
    along.count = direct.count = 0u;
#if ASDIC_TRUTH
    direct.truth_row = along.truth_row;
#endif
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
    return receive(w, to, DEV_ARRIVAL_ALONG, &along, targets, u) +
           receive(w, to, DEV_ARRIVAL_ACROSS, &direct, targets, back);
}

/* bounce: both kinds of echo. One work-item per piece. */
__kernel void LEAST_WAVES(3)
    bounce(__global const dev_ping *pings, __global const dev_ray *rays,
           __global const float *solid_angles, __global const dev_ray *bounced,
           __global const dev_hit *bounced_hits, __global const dev_ray *returning,
           __global const dev_hit *returning_hits, __global const float4 *mirrors,
           __global const dev_triangle *triangles, __global const dev_part *parts,
           __global const dev_material *materials, __global dev_arrival *arrivals,
           __global long *accumulator, __global uint *saturated, __global const dev_truth_row *rows,
           __global long *truth) {
    __global const dev_ping *ping = row_ping(pings);
    size_t own = row_slots(ping);
    returning += own;
    uint first = (uint)(get_global_id(0)) * PIECE, cut = 0u;
    uint end = min(first + PIECE, batch_slots(ping));
    world w = {ping, beams_of(ping), triangles, parts, materials, 0};
    sink to = {row_cells(ping, accumulator), arrivals + ARRIVAL_SETS * own, truth_rows(ping, rows),
               truth + (size_t)(ping->sums.truth_first) * ping->sums.truth_columns};
    bounce_store store = {rays + own,         bounced + own,        returning,
                          bounced_hits + own, returning_hits + own, solid_angles + own,
                          mirrors + own};
    for (uint slot = first; slot < end && returning[slot].source != NO_RAY; slot += ASDIC_WIDTH) {
        cut += shade_bounces(&w, &store, &to, slot);
    }
    if (cut != 0u) {
        atomic_add(saturated + get_group_id(1), cut);
    }
}
