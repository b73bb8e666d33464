/*
 * shade: turns hits into energies and adds them to the accumulator.
 *
 * One ray's share of an echo (Morency, Stilwell & Hess, section IV, with the ray's solid angle
 * made explicit):
 *
 *     E = SL TL(d) B_T B_R s(Theta) d^2 dOmega / sin(Theta),   TL(d) = d^-4 10^(-2 (d - 1) alpha / 1e4)
 *
 * and of the water before it: E = s_V B_T B_R dOmega integral of d^2 TL(d). Energies are deposited
 * relative to TL(d) d^2 at the centre of their bin, which the host multiplies back in double: this
 * takes the range out of the accumulator's dynamic range.
 */
#include "faces.h"
#include "mirror_ray.h"
#include "receive.h"
#include "ping_batch.h"

/* Which accumulator component an echo from KIND belongs to. */
static natural component_of(natural kind) {
    natural c = (natural)(DEV_DEPOSIT_BOTTOM);
    c = choose_natural(kind == DEV_KIND_SURFACE, (natural)(DEV_DEPOSIT_SURFACE), c);
    return choose_natural(kind == DEV_KIND_OBJECT, (natural)(DEV_DEPOSIT_OBJECT), c);
}

#if ASDIC_TRUTH
/* The objects that were met, by their rows of truth; 0: none. */
static natural truth_rows_met(const world *w, const meeting *m) {
    natural row = (natural)(0u);
#if ASDIC_HAS_MESH
    LANES {
        if (AT(m->kind, const uint) == DEV_KIND_OBJECT) {
            AT(row, uint) = w->parts[w->triangles[AT(m->triangle, const uint)].part].truth_row;
        }
    }
#else
    (void)w, (void)m;
#endif
    return row;
}
#endif

/* What sample.cl drew and trace.cl found. */
typedef struct ray_store {
    __global const dev_ray *rays;
    __global const float *legs;
    __global float *solid_angles;
    __global float *splats;
    __global const dev_hit *hits;
    __global const float *volume_inverse;
} ray_store;

#if ASDIC_LAYERS && ASDIC_HAS_MESH
/* What comes home of what R met, by all rays, over what does by R alone. */
static real home_of_pairs(const world *w, const meeting *m, const ray *r, real range) {
    real home = R(0.0);
    for (uint i = 0; i < w->ping->pair_count; i++) {
        LANES {
            if (AT(m->kind, const uint) == DEV_KIND_OBJECT &&
                w->triangles[AT(m->triangle, const uint)].part == w->ping->pair[i].part) {
                AT(home, float) = w->ping->pair[i].home_lin;
            }
        }
    }
    return choose(home > R(0.0), home / ray_focus(r, m->t, range), R(1.0));
}
#endif

/* Loads the rays in SLOTS once more, through layers, where to keep them takes registers that a GPU lacks. */
static void load_again(sonar_rays *own, __global const dev_ping *ping, const ray_store *store,
                       natural slots) {
#if ASDIC_LAYERS
    *own = load_sonar_rays(ping, store->rays, store->legs, slots);
#else
    (void)own, (void)ping, (void)store, (void)slots;
#endif
}

/* The echoes and the water of ASDIC_WIDTH rays, on their way to every receiver; returns how many
 * deposits had to be cut. Their mirror rays are appended to MIRRORS from *AT on. */
static uint shade_rays(const world *w, const ray_store *store, const sink *to,
                       const mirror_store *mirrors, uint slot, uint *at) {
    __global const dev_ping *ping = w->ping;
    real weight, splat;
    natural slots = slots_from(slot);
    sonar_rays own = load_sonar_rays(ping, store->rays, store->legs, slots);
    ray r = own.r;
    LANES {
        AT(weight, float) = store->solid_angles[slot + lane];
        AT(splat, float) = store->splats[slot + lane];
    }
    meeting m = meet(w, store->hits, slots, &r, ray_at_range(&r, (real)(ping->reach_m)));
#if ASDIC_HAS_MESH
    if (ping->sampling.face_count != 0u) {
        weight = weigh_faces(w, &m, store->hits, slots, &r, weight, splat);
        LANES { /* mirrors go by it, too */
            store->solid_angles[slot + lane] = AT(weight, float);
        }
        splat = r_max(splat, R(0.0));
    }
#endif
    /* The echo's footprint in range follows from the spacing of the samples in elevation. */
    triple arriving = ray_direction(&r, m.t);
    real range = ray_range(&r, m.t);
#if ASDIC_LAYERS
    LANES { /* volume.cl takes the range from there */
        store->splats[slot + lane] = AT(range, float);
    }
#endif
    real sin_grazing = r_max(grazing(&m, arriving), ray_least_grazing(&r));
    real footprint = ray_footprint(&r, m.t, splat, m.facet, sin_grazing);
    footprint = held_footprint(ping, &m, footprint, sin_grazing);
    law_lanes laws = laws_met(w, &m);
    slant met = surface_slant(&m, arriving);
    real energy = strength(w, &laws, met, ray_spread(&r, m.t)) / sin_grazing;
    energy *= ray_bending(&r, m.t, range, (real)(-2.0f * ping->absorption_np_per_m));
#if ASDIC_LAYERS && ASDIC_HAS_MESH
    energy *= home_of_pairs(w, &m, &r, range);
#endif
#if ASDIC_HAS_MIRRORS
    real share = mirrored(w, &laws, &m, met);
#endif
    real nearest = ray_plane_nearest(&r, m.t, range, m.facet, sin_grazing);
    split_echo echo = split(ping, range, nearest, energy, footprint);

    arrivals a;
    a.count = 0u;
#if ASDIC_TRUTH
    a.truth_row = truth_rows_met(w, &m);
#endif
    load_again(&own, ping, store, slots);
    triple sent = own.sent;
    weight *= gain_towards(ping, w->beams, sent.x, sent.y, sent.z);
    /* Objects that a plan left out still hide what is behind them. */
    natural component = component_of(m.kind);
    real heard = choose(component < ping->sums.components, weight, R(0.0));
    echo.first *= heard;
    echo.second *= heard;
    component = min(component, (natural)(ping->sums.components - 1u));
    arrivals_add_echo(w, &a, component, &echo);
#if ASDIC_HAS_WATER && !ASDIC_LAYERS /* else see volume.cl */
    /* Water: full bins before the last, part of the last. */
    water_end end = find_water_end(ping, store->volume_inverse, range);
    real before = choose(end.last == 0u, R(0.0), R(1.0) - end.part);
    natural water = (natural)(DEV_DEPOSIT_VOLUME);
    arrivals_add(w, &a, water, end.last, weight * end.part);
    arrivals_add(w, &a, water, max(end.last, (natural)(1u)) - 1u, weight * before);
#endif
    uint cut = receive(w, to, DEV_ARRIVAL_DIRECT, &a, rays_in(ping, slot), sent);
#if ASDIC_HAS_MIRRORS
    load_again(&own, ping, store, slots);
    *at = reflect(w, &m, &own.r, share, splat, mirrors, slot, *at);
#endif
    return cut;
}

/* The slots from FIRST to END. Copies hold what a compiler need not read again after each store. */
APART static uint shade_piece(const world *w, const ray_store *store, const sink *to,
                              const mirror_store *mirrors, uint first, uint end) {
    const world own_world = *w;
    const ray_store own_store = *store;
    const sink own_sink = *to;
    const mirror_store own_mirrors = *mirrors;
    uint at = first, cut = 0u;
    fetch_met(&own_world, own_store.hits, first, end);
    for (uint slot = first; slot < end; slot = slot_after(slot, ASDIC_WIDTH, end)) {
        cut += shade_rays(&own_world, &own_store, &own_sink, &own_mirrors, slot, &at);
    }
#if ASDIC_HAS_MIRRORS
    end_piece(own_mirrors.rays, at, end);
#endif
    return cut;
}

/* One work-item per piece (mirror_ray.h). */
__kernel void LEAST_WAVES(3)
    shade(__global const dev_ping *pings, __global const dev_ray *rays, __global const float *legs,
          __global float *solid_angles, __global float *splats, __global const float *face_density,
          __global const dev_hit *hits, __global const dev_triangle *triangles,
          __global const dev_part *parts, __global const uint *materials,
          __global const float *water, __global dev_arrival *arrivals, __global long *accumulator,
          __global uint *saturated, __global dev_ray *bounced, __global float4 *mirrors,
          __global float *bounced_legs, __global const dev_truth_row *rows, __global long *truth) {
    __global const dev_ping *ping = row_ping(pings);
    size_t own = row_slots(ping);
    uint first = (uint)(get_global_id(0)) * PIECE;
    uint end = min(first + PIECE, batch_slots(ping));
    world w = {ping, beams_of(ping), triangles, parts, materials, face_density};
    ray_store store = {rays + own,         ASDIC_LAYERS ? legs + DEV_LEG_FLOATS * own : legs,
                       solid_angles + own, splats + own,
                       hits + own,         row_water(ping, water)};
    sink to = {row_cells(ping, accumulator), arrivals + ARRIVAL_SETS * own, truth_rows(ping, rows),
               truth + (size_t)(ping->sums.truth_first) * ping->sums.truth_columns};
    mirror_store reflected = {bounced + own, mirrors + own,
                              ASDIC_LAYERS ? bounced_legs + DEV_LEG_FLOATS * own : bounced_legs};
    uint cut = shade_piece(&w, &store, &to, &reflected, first, end);
    if (cut != 0u) {
        atomic_add(saturated + get_group_id(1), cut);
    }
}
