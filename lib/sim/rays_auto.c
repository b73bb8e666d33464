/*
 * How many rays a ping takes for a stated error of about 0.5 dB r.m.s. in bins above the noise, by the cells
 * that a sonar tells apart: bins times the beams that do not overlap, and what is between those that share rays.
 * Measured, in dB:
 *
 *     over planes    4 rays a cell           fans of data/scenes 0.18 to 0.4, single beams below 0.06
 *     that mirror    8                       fans of data/sonars in 1.2 to 8 m of calm water 0.11 to 0.55
 *     over meshes    128 a cell to 400,000   5 beams 0.5, 3 beams 0.8
 *                    32 a cell beyond        512 beams 0.5
 *
 * Fewer or more rays err over meshes as independent samples do. Over planes rays lie in rows, and the error falls faster:
 * steeply until every bin has some. Of 70 runs of the sonars of data, 1,000 to 2,000,000 rays, bins as they are and a
 * quarter as long, 65 state what is expected within a factor of 2.3, the others of 4.6.
 */
#include <asdic/ping.h>

#include "aim.h"
#include "base/vec.h"
#include "ring.h"

#include <math.h>

#define OVER_PLANES 4.0
#define OVER_MIRRORS 8.0
#define OVER_MESHES 32.0
#define OVER_MESHES_OF_FEW 128.0
#define MOST_OF_FEW 400000.0
#define LEAST_RAYS 20000.0
#define MOST_RAYS 524288.0
#define AUTO_DB 0.5
/* Over planes, of rays in number as for AUTO_DB; how it falls with fewer and with more. */
#define PLANES_DB 0.3
#define PLANES_FEWER 1.5
#define PLANES_MORE 0.75
#define MIRRORS_TIMES 1.3 /* more, where these mirror */
#define MOST_DB 6.5       /* bins that few rays meet, or none */

/* Half-power width of an aperture of LENGTH wavelengths, sinc^2 (sin(x) / x = 1 / sqrt 2 at x = 1.3916), at
 * most a half-space. */
static double width_rad(double length_wl) {
    double sine = 0.4430 / fmax(length_wl, 0.4430);
    return 2.0 * asin(fmin(sine, 1.0));
}

/* A beam, and how near the nearest other one is, in half-power widths, squared; 1: it is alone. Rays of a sector also go
 * between beams that lie apart across it: there it may be more. */
typedef struct own_beam {
    asdic_face face;
    double wide, high, nearest2;
} own_beam;

/* Sides, not yaw and pitch, tell how far one beam is from another: in a fan that looks down, or is
 * rolled, the narrow one lies along neither. Sines bound the angles, and spare most pairs the
 * arcs. */
static void meet(own_beam *own, asdic_vec3 axis) {
    asdic_vec3 v = asdic_mat3_apply(own->face.world_to_face, axis);
    double across = v.y / own->wide, down = v.z / own->high;
    if (across * across + fmin(down * down, 1.0) < own->nearest2) {
        across = atan2(v.y, v.x) / own->wide;
        down = asin(fmin(fmax(v.z, -1.0), 1.0)) / own->high;
        own->nearest2 = fmin(own->nearest2, across * across + fmin(down * down, 1.0));
    }
}

/* Beams of a block are compared with all together, so that those are aimed once a block. */
#define BLOCK 64

/* What the nearest other beam leaves of each beam, 0 to 1, summed over COUNT beams from FIRST. */
static double apart_in_block(const asdic_sonar *sonar, double wavelength_m, size_t first,
                             size_t count) {
    const asdic_pose level = {0};
    const double alone2 = sonar->receiver_count > ASDIC_AIMS_MOST ? INFINITY : 1.0;
    own_beam own[BLOCK];
    for (size_t k = 0; k < count; k++) {
        asdic_face face = asdic_face_aim(&sonar->receivers[first + k], &level, wavelength_m);
        own[k] = (own_beam){face, width_rad(face.length_h_wl), width_rad(face.length_v_wl), alone2};
    }
    for (size_t b = 0; b < sonar->receiver_count; b++) {
        asdic_face other = asdic_face_aim(&sonar->receivers[b], &level, wavelength_m);
        const double *axis = other.world_to_face.m[0];
        for (size_t k = 0; k < count; k++) {
            if (first + k != b) {
                meet(&own[k], (asdic_vec3){axis[0], axis[1], axis[2]});
            }
        }
    }
    double apart = 0.0;
    for (size_t k = 0; k < count; k++) {
        apart += sqrt(own[k].nearest2);
    }
    return apart;
}

/* Cells that SONAR tells apart; 0 of no sonar. */
static double cells_of(const asdic_sonar *sonar, double sound_speed_mps) {
    if (!sonar || !(sonar->frequency_hz > 0.0) || !(sound_speed_mps > 0.0)) {
        return 0.0;
    }
    double beams = 0.0;
    for (size_t first = 0; first < sonar->receiver_count; first += BLOCK) {
        size_t left = sonar->receiver_count - first;
        beams += apart_in_block(sonar, sound_speed_mps / sonar->frequency_hz, first,
                                left < BLOCK ? left : BLOCK);
    }
    return beams * (double)asdic_sonar_bin_count(sonar, sound_speed_mps);
}

/* Rays for AUTO_DB, without limits. */
static double rays_needed(double cells, asdic_rays_over over) {
    switch (over) {
    case ASDIC_OVER_MESHES:
        return fmax(fmin(cells * OVER_MESHES_OF_FEW, MOST_OF_FEW), cells * OVER_MESHES);
    case ASDIC_OVER_MIRRORS:
        return cells * OVER_MIRRORS;
    default:
        return cells * OVER_PLANES;
    }
}

uint32_t asdic_rays_auto(const asdic_sonar *sonar, double sound_speed_mps, asdic_rays_over over) {
    double rays = rays_needed(cells_of(sonar, sound_speed_mps), over);
    rays = fmin(fmax(rays, LEAST_RAYS), MOST_RAYS);
    double digit =
        pow(10.0, floor(log10(rays)) - 1.0); /* two digits, so that a report reads well */
    return (uint32_t)fmin(ceil(rays / digit) * digit, MOST_RAYS);
}

double asdic_rays_error_db(const asdic_sonar *sonar, double sound_speed_mps, asdic_rays_over over,
                           uint32_t rays) {
    double cells = cells_of(sonar, sound_speed_mps), some = fmax(rays, 1.0);
    if (over == ASDIC_OVER_MESHES) {
        return fmin(AUTO_DB * sqrt(rays_needed(cells, over) / some), MOST_DB);
    }
    double lack = cells * OVER_PLANES / some;
    double error_db = PLANES_DB * pow(lack, lack > 1.0 ? PLANES_FEWER : PLANES_MORE);
    return fmin(over == ASDIC_OVER_MIRRORS ? MIRRORS_TIMES * error_db : error_db, MOST_DB);
}
