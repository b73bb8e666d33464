/*
 * sample: draws the rays of one batch of a ping, or of a volley of pings.
 *
 * Slot by slot in the order of order.h. Slots beyond the last ray are switched off (t_max 0, solid
 * angle 0).
 */
#include "sampler.h"
#include "volley.h"

/* Cell of the learnt table that holds the quantile XI; CUMULATIVE has DEV_TABLE_CELLS + 1 entries
 * from 0 to 1. */
static uint table_cell(__global const float *cumulative, float xi) {
    uint cell = 0;
#pragma unroll
    for (uint step = DEV_TABLE_CELLS / 2; step > 0u; step /= 2u) { /* a power of two; no branches */
        cell += cumulative[cell + step] <= xi ? step : 0u;
    }
    return cell;
}

/* Adaptive: x through the learnt quantile function, and what that does to the density. */
static elevation learnt_elevation(__global const dev_ping *ping, __global const float *cumulative,
                                  real xi) {
    real x = xi, factor = R(1.0);
    for (uint lane = 0; lane < ASDIC_WIDTH; lane++) {
        float q = ((float *)&xi)[lane];
        uint cell = table_cell(cumulative, q);
        float low = cumulative[cell], mass = cumulative[cell + 1u] - low;
        ((float *)&x)[lane] = ((float)(cell) + (q - low) / mass) * (1.0f / DEV_TABLE_CELLS);
        ((float *)&factor)[lane] = mass * DEV_TABLE_CELLS;
    }
    x = r_min(r_max(x, R(6e-8)), R(0.99999994));
    elevation e = elevation_of_x(ping, x);
    e.density *= factor;
    return e;
}

/* Background rays per steradian in a direction that a cone drew. */
static real background_rays(__global const dev_ping *ping, __global const float *cumulative,
                            const ray_sample *s) {
    real density, m = sqrt(r_max(s->x * s->x + s->y * s->y, R(1e-12)));
    real x = x_of_elevation(ping, s->z, m, &density);
    for (uint lane = 0; lane < ASDIC_WIDTH; lane++) {
        float at = ((float *)&x)[lane] * DEV_TABLE_CELLS;
        uint cell = (uint)(clamp(at, 0.0f, (float)(DEV_TABLE_CELLS - 1)));
        ((float *)&density)[lane] *= (cumulative[cell + 1u] - cumulative[cell]) * DEV_TABLE_CELLS;
    }
    azimuth_lobes lobes;
    azimuth_lobes_at(ping, ping->lobe, s->z, m, &lobes);
    return (real)((float)(ping->background)) * density *
           azimuth_density(ping, ping->lobe, &lobes, atan2(s->y, s->x));
}

/* Which lanes are rays of CONE. */
static mask drawn_by(__global const dev_cone *cone, natural index) {
    return (index >= cone->first) & (index < cone->first + cone->count);
}

/* Lets cones draw their rays, and weighs every ray by all the ways it could have been drawn. */
static ray_sample add_cones(__global const dev_ping *ping, __global const float *cumulative,
                            natural index, ray_sample s) {
    mask drawn = index >= ping->background;
    for (uint c = 0; c < ping->cones; c++) {
        mask here = drawn_by(ping->cone + c, index);
        if (any_true(here)) {
            natural j = index - ping->cone[c].first;
            real xi1 =
                (to_real(j) + (real)(ping->lattice_offset)) / (real)((float)(ping->cone[c].count));
            natural golden = j * (natural)(2654435769u) + (natural)(ping->lattice_shift);
            ray_sample own =
                sample_cone(ping->cone + c, r_min(xi1, R(1.0)), random_uniform(golden));
            s.x = choose(here, own.x, s.x);
            s.y = choose(here, own.y, s.y);
            s.z = choose(here, own.z, s.z);
            s.splat = choose(here, own.splat, s.splat);
        }
    }
    real rays = R(1.0) / s.solid_angle;
    if (any_true(drawn)) {
        rays = choose(drawn, background_rays(ping, cumulative, &s), rays);
    }
    for (uint c = 0; c < ping->cones; c++) {
        __global const dev_cone *cone = ping->cone + c;
        mask inside = in_cone(cone, s.x, s.y, s.z) | drawn_by(cone, index);
        float own = (float)(cone->count) / (6.28318530718f * cone->cap);
        rays += choose(inside, (real)(own), R(0.0));
    }
    s.solid_angle = R(1.0) / rays;
    return s;
}

static ray_sample draw_adaptive(__global const dev_ping *ping, __global const float *cumulative,
                                natural index) {
    real count = (real)((float)(ping->background));
    real xi1 = (to_real(index) + (real)(ping->lattice_offset)) / count;
    natural golden = index * (natural)(2654435769u) + (natural)(ping->lattice_shift);
    elevation e = learnt_elevation(ping, cumulative, r_min(xi1, R(0.99999994)));
    ray_sample s = sample_adaptive(ping, ping->lobe, e, random_uniform(golden), count);
    return ping->cones == 0u ? s : add_cones(ping, cumulative, index, s);
}

__kernel void sample(__global const dev_ping *pings, __global const float *cumulative,
                     __global dev_ray *rays, __global float *solid_angles, __global float *splats) {
    __global const dev_ping *ping = row_ping(pings);
    uint first = (uint)(get_global_id(0)) * ASDIC_WIDTH;
    if (first >= batch_slots(ping)) {
        return;
    }
    size_t own = row_slots(ping);
    rays += own;
    solid_angles += own;
    splats += own;
    natural index = ping->batch_first * ping->groups + rays_in(ping, first);
    real count = (real)((float)(ping->rays));
    ray_sample s;
    if (ping->sampler == DEV_SAMPLER_ADAPTIVE) {
        s = draw_adaptive(ping, cumulative, index);
    } else {
        random4 random = random_draw(index, ping->ping[0], ping->ping[1], RANDOM_SAMPLE,
                                     ping->seed[0], ping->seed[1]);
        if (ping->sampler == DEV_SAMPLER_BEAM) {
            s = sample_beam(ping->lobe, ping->lobes, random, count);
        } else {
            s = sample_uniform_sphere(random, count);
        }
    }
    for (uint lane = 0; lane < ASDIC_WIDTH; lane++) {
        uint slot = first + lane;
        bool on = ((uint *)&index)[lane] < ping->rays;
        dev_ray ray;
        ray.origin[0] = ping->origin[0];
        ray.origin[1] = ping->origin[1];
        ray.origin[2] = ping->origin[2];
        ray.t_max = on ? ping->reach_m : 0.0f;
        ray.direction[0] = ((float *)&s.x)[lane];
        ray.direction[1] = ((float *)&s.y)[lane];
        ray.direction[2] = ((float *)&s.z)[lane];
        ray.source = slot;
        rays[slot] = ray;
        solid_angles[slot] = on ? ((float *)&s.solid_angle)[lane] : 0.0f;
        splats[slot] = ((float *)&s.splat)[lane];
    }
}
