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
#include "volley.h"

/* How much of its last bin's water a ray has crossed when it meets something (or the range ends):
 * the part of the bin's integral of d^-2 exp(-2 k d), by two-point Gauss quadrature in 1/d. */
static real crossed_part(__global const dev_ping *ping, __global const float *volume_inverse,
                         real range, natural bin_index) {
    real bin = (real)(ping->bin_m);
    real center = (to_real(bin_index) + R(0.5)) * bin;
    real begin = r_max(center - R(0.5) * bin, (real)(ping->blanking_m));
    begin = r_max(begin, R(1e-6));
    real length = r_max(range - begin, R(0.0));
    real total = length / (begin * r_max(range, begin));
    real y0 = R(1.0) / r_max(range, begin);
    real k2 = (real)(-2.0f * ping->absorption_np_per_m);
    real e1 = exp(k2 * (R(1.0) / (y0 + R(0.21132486540518712) * total) - center));
    real e2 = exp(k2 * (R(1.0) / (y0 + R(0.78867513459481288) * total) - center));
    real inverse = R(0.0);
    LANES {
        AT(inverse, float) = volume_inverse[AT(bin_index, uint)];
    }
    return r_min(R(0.5) * (e1 + e2) * total * inverse, R(1.0));
}

/* Which accumulator component an echo from KIND belongs to. */
static natural component_of(natural kind) {
    natural c = (natural)(DEV_DEPOSIT_BOTTOM);
    c = choose_natural(kind == DEV_KIND_SURFACE, (natural)(DEV_DEPOSIT_SURFACE), c);
    return choose_natural(kind == DEV_KIND_OBJECT, (natural)(DEV_DEPOSIT_OBJECT), c);
}

/* What sample.cl drew and trace.cl found. */
typedef struct ray_store {
    __global const dev_ray *rays;
    __global float *solid_angles;
    __global const float *splats;
    __global const dev_hit *hits;
} ray_store;

/* The echoes and the water of ASDIC_WIDTH rays, on their way to every receiver; returns how many
 * deposits had to be cut. Their mirror rays are appended to MIRRORS from *AT on. */
static uint shade_rays(const world *w, const ray_store *store, __global const float *volume_inverse,
                       const sink *to, const mirror_store *mirrors, uint slot, uint *at) {
    __global const dev_ping *ping = w->ping;
    real ux, uy, uz, weight, splat;
    natural slots = slots_from(slot);
    triple from = {(real)(ping->origin[0]), (real)(ping->origin[1]), (real)(ping->origin[2])};
    LANES {
        AT(ux, float) = store->rays[slot + lane].direction[0];
        AT(uy, float) = store->rays[slot + lane].direction[1];
        AT(uz, float) = store->rays[slot + lane].direction[2];
        AT(weight, float) = store->solid_angles[slot + lane];
        AT(splat, float) = store->splats[slot + lane];
    }
    triple u = {ux, uy, uz};
    meeting m = meet(w, store->hits, slots, from, u, (real)(ping->reach_m));
#if ASDIC_HAS_MESH
    if (ping->face_count != 0u) {
        weight = weigh_faces(w, &m, store->hits, slots, u, weight, splat);
        LANES { /* mirrors go by it, too */
            store->solid_angles[slot + lane] = AT(weight, float);
        }
        splat = r_max(splat, R(0.0));
    }
#endif
    weight *= gain_towards(ping, w->beams, ux, uy, uz);

    /* Echo: its footprint in range follows from the elevation spacing of the samples. */
    real sin_grazing = grazing(&m, u);
    real across = sqrt(r_max((R(1.0) - uz) * (R(1.0) + uz), R(1e-12)));
    real tangent = (-uz * (ux * m.facet.x + uy * m.facet.y)) / across + across * m.facet.z;
    real footprint = splat * m.range * r_abs(tangent) / sin_grazing;
    /* From right below or above it would leak from the spike there into its neighbours. */
    real most = (real)(ping->bin_m) * (R(0.5) - R(0.4) * sin_grazing * sin_grazing);
    most = choose(m.kind == DEV_KIND_OBJECT, R(0.1), most);
    footprint = r_min(footprint, most);
    law_lanes laws = laws_met(w, &m);
    slant met = surface_slant(&m, u);
    real energy = strength(w, &laws, met, m.range) / sin_grazing;
    real share = R(0.0);
    if (ASDIC_HAS_MIRRORS || ping->boundary_mirrors != 0u) {
        share = mirrored(w, &laws, &m, met);
    }
    energy *= scattered(w, &laws, share);
#if ASDIC_HAS_MIRRORS
    *at = reflect(w, &m, store->hits, u, share, mirrors, slot, *at);
#endif
    /* Nothing of a plane is nearer than its perpendicular; the nudge keeps rounding from crossing a
     * bin edge that coincides with it. */
    real nearest = r_min(m.range * sin_grazing * R(1.0000005), m.range);
    split_echo echo = split(ping, m.range, nearest, energy, footprint);

    arrivals a;
    a.count = 0u;
    /* Objects that a plan left out still hide what is behind them. */
    natural component = component_of(m.kind);
    real heard = choose(component < ping->components, weight, R(0.0));
    echo.first *= heard;
    echo.second *= heard;
    component = min(component, (natural)(ping->components - 1u));
    arrivals_add_echo(w, &a, component, &echo);
#if ASDIC_HAS_WATER
    /* Water: full bins before the last, part of the last. */
    real reach = (real)(ping->range_m), end = r_min(m.range, reach);
    natural last = min(to_natural(end / (real)(ping->bin_m)), (natural)(ping->bins - 1u));
    real part = crossed_part(ping, volume_inverse, end, last);
    part = choose(m.range >= reach, R(1.0), part);

    real before = choose(last == 0u, R(0.0), R(1.0) - part);
    natural water = (natural)(DEV_DEPOSIT_VOLUME);
    arrivals_add(w, &a, water, last, weight * part);
    arrivals_add(w, &a, water, max(last, (natural)(1u)) - 1u, weight * before);
#else
    (void)volume_inverse;
#endif
    return receive(w, to, DEV_PARCEL_DIRECT, &a, rays_in(ping, slot), u);
}

/* One work-item per piece (mirror_ray.h). */
__kernel void shade(__global const dev_ping *pings, __global const dev_ray *rays,
                    __global float *solid_angles, __global const float *splats,
                    __global const float *face_density, __global const dev_hit *hits,
                    __global const dev_triangle *triangles, __global const dev_part *parts,
                    __global const dev_material *materials, __global const float *water,
                    __global dev_parcel *parcels, __global long *accumulator,
                    __global uint *saturated, __global dev_ray *bounced, __global float4 *mirrors) {
    __global const dev_ping *ping = row_ping(pings);
    size_t own = row_slots(ping);
    uint first = (uint)(get_global_id(0)) * PIECE, at = first, cut = 0u;
    uint end = min(first + PIECE, batch_slots(ping));
    world w = {ping, beams_of(ping), triangles, parts, materials, face_density};
    ray_store store = {rays + own, solid_angles + own, splats + own, hits + own};
    sink to = {row_cells(ping, accumulator), parcels + PARCEL_SETS * own};
    mirror_store reflected = {bounced + own, mirrors + own};
    for (uint slot = first; slot < end; slot += ASDIC_WIDTH) {
        cut += shade_rays(&w, &store, row_water(ping, water), &to, &reflected, slot, &at);
    }
#if ASDIC_HAS_MIRRORS
    end_piece(reflected.rays, at, end);
#endif
    if (cut != 0u) {
        atomic_add(saturated + get_group_id(1), cut);
    }
}
