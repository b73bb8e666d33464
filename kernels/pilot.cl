/*
 * pilot: what each ray of a pilot ping brings, for learning where rays matter (lib/sim/learn.c).
 */
#include "faces.h"
#include "learnt.h"
#include "order.h"

/* The echoes by way of bottom or surface of rays that meet one of them and then the other. */
typedef struct mirrored_echoes {
    triple back;            /* from the sonar to what the mirror shows */
    real across, along;     /* their ranges */
    real crossed, followed; /* their energies, before gains and solid angle */
} mirrored_echoes;

/* Of rays SENT that bottom or, where UP, surface mirrors by SHARE. Which rays matter is known well enough by straight ones
 * between planes. */
static mirrored_echoes mirror_planes(const world *w, mask up, real share, triple sent) {
    __global const dev_ping *ping = w->ping;
    const float far = 4.0f * ping->range_m;
    float bottom = ping->bottom_m < INFINITY ? ping->bottom_m : ping->sampling.zones.bottom_m;
    real below = (real)(min(bottom, far)), above = (real)(min(ping->surface_m, far));
    real level = sqrt(r_max(sent.x * sent.x + sent.y * sent.y, R(1e-12)));
    slant in = {r_max(r_abs(sent.z), R(1e-6)), level * level}, out;
    mirrored_echoes e;
    e.along = r_min((choose(up, above, below) + above + below) / in.sine, (real)(far));
    real home = choose(up, below, above), aside = e.along * level;
    real straight = sqrt(aside * aside + home * home);
    e.across = R(0.5) * (e.along + straight);
    out.sine = home / straight;
    out.cos2 = (R(1.0) - out.sine) * (R(1.0) + out.sine);
    e.back.x = sent.x / level * aside / straight;
    e.back.y = sent.y / level * aside / straight;
    e.back.z = choose(up, out.sine, -out.sine);
    meeting x;
    x.kind = choose_natural(up, (natural)(DEV_KIND_BOTTOM), (natural)(DEV_KIND_SURFACE));
    x.material =
        choose_natural(up, (natural)(ping->bottom_material), (natural)(ping->surface_material));
    x.coherent_m2 = (real)(ASDIC_PLANE_M2);
    law_lanes laws = laws_met(w, &x);
    real s_in = strength(w, &laws, in, e.along), s_out = strength(w, &laws, out, e.along);
    real ratio = e.across / straight, end = (real)(ping->range_m);
    share /= in.sine;
    e.crossed = choose(e.across < end, share * sqrt(s_in * s_out) * ratio * ratio, R(0.0));
    e.followed = choose(e.along < end, share * share * in.sine * s_in, R(0.0));
    return e;
}

/* Writes for every ray, group by group: its position in the learnt table, the bins of its echoes, and its energies in
 * PICKED receivers, which are spread over all of them. ENERGIES is [ray][receiver][DEV_PILOT_ENERGIES]: echoes relative
 * to the bin's TL d^2, the water relative to a bin's. */
__kernel void pilot(__global const dev_ping *ping, __global const dev_ray *rays,
                    __global const float *legs, __global const float *solid_angles,
                    __global const float *splats, __global const float *face_density,
                    __global const dev_hit *hits, __global const dev_triangle *triangles,
                    __global const dev_part *parts, __global const uint *materials,
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
    meeting m = meet(&w, hits, slots, &r, ray_at_range(&r, (real)(ping->range_m)));
#if ASDIC_HAS_MESH
    weight = weigh_faces(&w, &m, hits, slots, &r, weight, splat);
#endif
    law_lanes laws = laws_met(&w, &m);
    triple arriving = ray_direction(&r, m.t);
    real range = ray_range(&r, m.t);
    slant met = surface_slant(&m, arriving);
    real sin_grazing = r_max(grazing(&m, arriving), ray_least_grazing(&r));
    real echo = strength(&w, &laws, met, ray_spread(&r, m.t)) / sin_grazing;
    echo *= ray_bending(&r, m.t, range, (real)(-2.0f * ping->absorption_np_per_m));
    mask heard = (m.kind != DEV_KIND_NONE) & (range >= (real)(ping->blanking_m));
    echo = choose(heard, echo, R(0.0));
    mirrored_echoes by = {sent, range, range, R(0.0), R(0.0)};
    if (ping->boundary_mirrors != 0u) {
        mask up = m.kind == DEV_KIND_SURFACE, plane = up | (m.kind == DEV_KIND_BOTTOM);
        real share = choose(plane, mirrored(&w, &laws, &m, met), R(0.0));
        by = mirror_planes(&w, up, share, sent);
    }
    real density, y = R(0.0);
    real across = sqrt(r_max(sent.x * sent.x + sent.y * sent.y, R(1e-12)));
    real x = x_of_elevation(ping, sent.z, across, &density);
    azimuth_lobes lobes = azimuth_lobes_at(ping, sent.z, across);
    azimuth_density(ping, table, &lobes, x, atan2(sent.y, sent.x), &y);
    real sent_out = weight * gain_towards(ping, w.beams, sent.x, sent.y, sent.z);
    real back_out = R(0.0);
    if (ping->boundary_mirrors != 0u) {
        back_out = weight * gain_towards(ping, w.beams, by.back.x, by.back.y, by.back.z);
    }
    natural row = (natural)(0u);
    natural ray = rays_in(ping, slot);
    LANES {
        uint at = position_of(ping, AT(ray, uint));
        float ranges[DEV_PILOT_ECHOES] = {AT(range, float), AT(by.across, float),
                                          AT(by.along, float)};
        dev_pilot s = {AT(x, float), AT(y, float), {0u}};
        for (uint e = 0; e < DEV_PILOT_ECHOES; e++) {
            s.bins[e] = min((uint)(min(ranges[e], ping->range_m) / ping->bin_m), ping->bins - 1u);
        }
        AT(row, uint) = at;
        pilots[at] = s;
    }
    for (uint p = 0; p < picked; p++) {
        uint beam = picked == ping->beams ? p : p * (ping->beams - 1u) / (picked - 1u);
        __global const dev_beam *receiver = w.beams + 1u + beam;
        real gain = gain_towards(ping, receiver, sent.x, sent.y, sent.z);
        real water = sent_out * gain, direct = water * echo, along = water * by.followed;
        real over = R(0.0);
        if (ping->boundary_mirrors != 0u) {
            real back = gain_towards(ping, receiver, by.back.x, by.back.y, by.back.z);
            over = by.crossed * (sent_out * back + back_out * gain);
        }
        LANES {
            vstore4(
                (float4)(AT(direct, float), AT(over, float), AT(along, float), AT(water, float)), 0,
                energies + DEV_PILOT_ENERGIES * (AT(row, uint) * picked + p));
        }
    }
}
