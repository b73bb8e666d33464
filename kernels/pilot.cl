/*
 * pilot: what each ray of a pilot ping brings, for learning where rays matter (lib/sim/learn.c).
 */
#include "faces.h"
#include "learnt.h"
#include "order.h"

/* Writes for every ray, group by group: its position in the learnt table, the last bin that it crosses, and
 * its energies in PICKED receivers, which are spread over all of them. ENERGIES is
 * [ray][receiver][echo, water]: the echo relative to the bin's TL d^2, the water relative to a bin's. */
__kernel void pilot(__global const dev_ping *ping, __global const dev_ray *rays,
                    __global const float *legs, __global const float *solid_angles,
                    __global const float *splats, __global const float *face_density,
                    __global const dev_hit *hits, __global const dev_triangle *triangles,
                    __global const dev_part *parts, __global const dev_material *materials,
                    __global const float *table, __global dev_pilot *pilots,
                    __global float *energies, uint picked) {
    uint slot = (uint)(get_global_id(0)) * ASDIC_WIDTH;
    if (slot >= batch_slots(ping)) {
        return;
    }
    world w = {ping, beams_of(ping), triangles, parts, materials, face_density};
    real weight, splat;
    natural slots = slots_from(slot);
    sonar_rays own = load_sonar_rays(ping, rays, legs, slots);
    ray r = own.r;
    triple sent = own.sent;
    LANES {
        AT(weight, float) = solid_angles[slot + lane];
        AT(splat, float) = splats[slot + lane];
    }
    real density, y = R(0.0);
    real across = sqrt(r_max(sent.x * sent.x + sent.y * sent.y, R(1e-12)));
    real x = x_of_elevation(ping, sent.z, across, &density);
    azimuth_lobes lobes = azimuth_lobes_at(ping, sent.z, across);
    azimuth_density(ping, table, &lobes, x, atan2(sent.y, sent.x), &y);
    meeting m = meet(&w, hits, slots, &r, ray_at_range(&r, (real)(ping->range_m)));
#if ASDIC_HAS_MESH
    weight = weigh_faces(&w, &m, hits, slots, &r, weight, splat);
#endif
    law_lanes laws = laws_met(&w, &m);
    triple arriving = ray_direction(&r, m.t);
    real range = ray_range(&r, m.t);
    real echo = strength(&w, &laws, surface_slant(&m, arriving), ray_spread(&r, m.t)) /
                grazing(&m, arriving);
    echo *= ray_bending(&r, m.t, range, (real)(-2.0f * ping->absorption_np_per_m));
    mask met = (m.kind != DEV_KIND_NONE) & (range >= (real)(ping->blanking_m));
    echo = choose(met, echo, R(0.0));
    weight *= gain_towards(ping, w.beams, sent.x, sent.y, sent.z);
    natural last = to_natural(r_min(range, (real)(ping->range_m)) / (real)(ping->bin_m));
    natural row = (natural)(0u);
    natural ray = rays_in(ping, slot);
    LANES {
        uint at = position_of(ping, AT(ray, uint));
        dev_pilot s = {AT(x, float), AT(y, float), min(AT(last, uint), ping->bins - 1u)};
        AT(row, uint) = at;
        pilots[at] = s;
    }
    for (uint p = 0; p < picked; p++) {
        uint beam = picked == ping->beams ? p : p * (ping->beams - 1u) / (picked - 1u);
        real water = weight * gain_towards(ping, w.beams + 1u + beam, sent.x, sent.y, sent.z);
        real energy = water * echo;
        LANES {
            vstore2((float2)(AT(energy, float), AT(water, float)), 0,
                    energies + 2u * (AT(row, uint) * picked + p));
        }
    }
}
