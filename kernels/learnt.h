/*
 * The learnt table: where rays matter, as pilot pings found.
 *
 * First come the cumulative probabilities of DEV_TABLE_CELLS cells of the elevation's coordinate x. Then, for
 * each of DEV_TABLE_ROWS rows of those cells, come the cumulative probabilities of DEV_AZIMUTH_CELLS cells of
 * the azimuth's coordinate y. Both coordinates run from 0 to 1; y runs over the lobes, in each lobe first
 * over its near crossing, then over its far one (sampler.h).
 */
#ifndef ASDIC_KERNEL_LEARNT_H
#define ASDIC_KERNEL_LEARNT_H

#include "sampler.h"

/* Cell that holds the quantile XI of CELLS, a power of two. */
static uint learnt_cell(__global const float *cumulative, uint cells, float xi) {
    uint cell = 0u;
#pragma unroll
    for (uint step = cells / 2u; step > 0u; step /= 2u) { /* no branches */
        cell += cumulative[cell + step] <= xi ? step : 0u;
    }
    return cell;
}

/* The coordinate that is the quantile XI; *FACTOR is its density. */
static float learnt_quantile(__global const float *cumulative, uint cells, float xi,
                             float *factor) {
    uint cell = learnt_cell(cumulative, cells, xi);
    float low = cumulative[cell], mass = cumulative[cell + 1u] - low;
    *factor = mass * (float)(cells);
    return ((float)(cell) + (xi - low) / mass) / (float)(cells);
}

/* Density at the coordinate AT of CELLS. */
static float learnt_density(__global const float *cumulative, uint cells, float at) {
    uint cell = (uint)(clamp(at * (float)(cells), 0.0f, (float)(cells - 1u)));
    return (cumulative[cell + 1u] - cumulative[cell]) * (float)(cells);
}

/* The azimuths' part of the table at the elevation with coordinate X. */
static __global const float *learnt_row(__global const float *table, float x) {
    uint row = (uint)(clamp(x * DEV_TABLE_ROWS, 0.0f, (float)(DEV_TABLE_ROWS - 1)));
    return table + DEV_TABLE_CELLS + 1u + row * (DEV_AZIMUTH_CELLS + 1u);
}

/* What was learnt of the coordinate Y at the elevation with coordinate X. */
static real azimuth_factor(__global const float *table, real x, real y) {
    real factor = R(1.0);
    for (uint lane = 0; lane < ASDIC_WIDTH; lane++) {
        __global const float *row = learnt_row(table, ((float *)&x)[lane]);
        ((float *)&factor)[lane] = learnt_density(row, DEV_AZIMUTH_CELLS, ((float *)&y)[lane]);
    }
    return factor;
}

/* Density of azimuth PHI over ALL lobes, at the elevation with coordinate X; in *Y the coordinate
 * of PHI in the lobe that gives most. */
static real azimuth_density(__global const dev_ping *ping, __global const float *table,
                            const azimuth_lobes *all, real x, real phi, real *y) {
    real density = R(0.0), most = R(-1.0);
    for (uint j = 0; j < ping->sampling.lobes; j++) {
        azimuth_lobe a = azimuth_lobes_get(ping, all, j);
        real share = (real)(ping->sampling.lobe[j].share),
             begin = (real)(ping->sampling.lobe[j].share_begin);
        real part = share * a.near_share;
        for (uint side = 0; side < 2u; side++) {
            mask far = (natural)(side) != (natural)(0u);
            azimuth_at at = lobe_of(&a, wrap_angle(phi - choose(far, a.far, a.near)), far);
            real here = begin + part * at.below, own = part * at.density;
            *y = choose(own > most, here, *y);
            most = r_max(most, own);
            density +=
                ping->sampling.azimuths_learnt != 0u ? own * azimuth_factor(table, x, here) : own;
            begin += part;
            part = share - part;
            if (!any_true(part > R(0.0))) {
                break;
            }
        }
    }
    return density;
}

/* A direction from the quantiles XI1 of elevations and XI2 of azimuths. */
static ray_sample sample_adaptive(__global const dev_ping *ping, __global const float *table,
                                  real xi1, real xi2, real count) {
    real x = xi1, y = xi2, factor = R(1.0);
    for (uint lane = 0; lane < ASDIC_WIDTH; lane++) {
        ((float *)&x)[lane] =
            learnt_quantile(table, DEV_TABLE_CELLS, ((float *)&xi1)[lane], (float *)&factor + lane);
    }
    x = r_min(r_max(x, R(6e-8)), R(0.99999994));
    for (uint lane = 0; lane < ASDIC_WIDTH && ping->sampling.azimuths_learnt != 0u; lane++) {
        float unused;
        ((float *)&y)[lane] = learnt_quantile(learnt_row(table, ((float *)&x)[lane]),
                                              DEV_AZIMUTH_CELLS, ((float *)&xi2)[lane], &unused);
    }
    __global const dev_lobe *lobes = ping->sampling.lobe;
    elevation e = elevation_of_x(ping, x);
    e.density *= factor;
    ray_sample s;
    real m = e.across;
    azimuth_lobes all = azimuth_lobes_at(ping, e.uz, m);
    azimuth_lobe picked = azimuth_lobes_get(ping, &all, 0);
    real xi = y / (real)(lobes[0].share);
    for (uint j = 1; j < ping->sampling.lobes; j++) {
        mask here = y >= (real)(lobes[j].share_begin);
        azimuth_lobe own = azimuth_lobes_get(ping, &all, j);
        picked.near = choose(here, own.near, picked.near);
        picked.near_limit = choose(here, own.near_limit, picked.near_limit);
        picked.far = choose(here, own.far, picked.far);
        picked.far_limit = choose(here, own.far_limit, picked.far_limit);
        picked.scale = choose(here, own.scale, picked.scale);
        picked.near_share = choose(here, own.near_share, picked.near_share);
        picked.near_core = choose(here, own.near_core, picked.near_core);
        picked.far_core = choose(here, own.far_core, picked.far_core);
        xi = choose(here, (y - (real)(lobes[j].share_begin)) / (real)(lobes[j].share), xi);
    }
    mask far = xi >= picked.near_share;
    xi = choose(far, (xi - picked.near_share) / (R(1.0) - picked.near_share),
                xi / picked.near_share);
    xi = r_min(r_max(xi, R(6e-8)), R(0.99999994));
    real phi = choose(far, picked.far, picked.near) + lobe_sample(&picked, xi, far);
    s.x = m * cos(phi);
    s.y = m * sin(phi);
    s.z = e.uz;
    real density = e.density * azimuth_density(ping, table, &all, x, phi, &xi);
    s.solid_angle = R(1.0) / (count * density);
    /* Steep patterns are wide in azimuth, and see more of the rays of a sector. */
    real rays = r_max((real)(ping->sampling.footprint_rays) * m, (real)(DEV_FOOTPRINT_RAYS));
    s.splat = rays / (count * e.density * m);
    return s;
}

#endif
