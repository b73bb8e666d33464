/*
 * survey: what the pilot rays of a block of pings brought, for learning where rays matter.
 */
#include "echo.h"
#include "order.h"
#include "sampler.h"

/* Writes for every ray, group by group, the sampling coordinate x of its elevation; behind them all the
 * bins of their echoes (0xffffffff: none); behind these their energies, relative to the bin's TL d^2, in
 * PICKED receivers spread over all of them. */
__kernel void survey(__global const dev_ping *ping, __global const dev_ray *rays,
                     __global const float *solid_angles, __global const dev_hit *hits,
                     __global const dev_triangle *triangles, __global const dev_part *parts,
                     __global const dev_material *materials, __global float *xs, uint picked) {
    uint slot = (uint)(get_global_id(0)) * ASDIC_WIDTH;
    if (slot >= batch_slots(ping)) {
        return;
    }
    __global uint *bins = (__global uint *)(xs + batch_slots(ping));
    __global float *energies = xs + 2u * (size_t)(batch_slots(ping));
    world w = {ping, beams_of(ping), triangles, parts, materials};
    real ux, uy, uz, weight;
    LANES {
        AT(ux, float) = rays[slot + lane].direction[0];
        AT(uy, float) = rays[slot + lane].direction[1];
        AT(uz, float) = rays[slot + lane].direction[2];
        AT(weight, float) = solid_angles[slot + lane];
    }
    real density;
    real across = sqrt(ux * ux + uy * uy);
    real x = x_of_elevation(ping, uz, across, &density);
    triple from = {(real)(ping->origin[0]), (real)(ping->origin[1]), (real)(ping->origin[2])};
    triple u = {ux, uy, uz};
    meeting m = meet(&w, hits, slots_from(slot), from, u, (real)(ping->range_m));
    law_lanes laws = laws_met(&w, &m);
    weight *= strength(&w, &laws, surface_slant(&m, u), m.range) / grazing(&m, u);
    weight *= gain_towards(ping, w.beams, ux, uy, uz);
    mask met = (m.kind != DEV_KIND_NONE) & (m.range >= (real)(ping->blanking_m));
    weight = choose(met, weight, R(0.0));
    natural bin = to_natural(r_min(m.range, (real)(ping->range_m)) / (real)(ping->bin_m));
    natural row = (natural)(0u);
    natural ray = rays_in(ping, slot);
    LANES {
        uint at = place_of(ping, AT(ray, uint));
        AT(row, uint) = at;
        xs[at] = AT(x, float);
        bins[at] = AT(weight, float) > 0.0f ? min(AT(bin, uint), ping->bins - 1u) : 0xffffffffu;
    }
    for (uint p = 0; p < picked; p++) {
        uint beam = picked == ping->beams ? p : p * (ping->beams - 1u) / (picked - 1u);
        real energy = weight * gain_towards(ping, w.beams + 1u + beam, ux, uy, uz);
        LANES {
            energies[AT(row, uint) * picked + p] = AT(energy, float);
        }
    }
}
