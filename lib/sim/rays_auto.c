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
 *
 * Up to eight beams under a transmitter that is much wider, as side-scan sonars have, hear their side lobes one way only:
 * 20 rays a cell for 0.5 dB. Of 40 runs of 1 to 8 such beams, 2 to 130 rays a cell, mirrors or none, 38 state what is
 * expected within a factor of 2.3, the others of 2.5; many beams at `auto` state 0.2 to 0.3 dB. So does a beam that looks
 * past the transmitter's lobe: by the rule of 4, 34 of 80 random scenes of up to eight beams over planes stated more than
 * 2.3 times what was expected, now 14.
 * Out of this: sonars unlike those of data. Of 140 random scenes over planes 64 state what is expected within a factor of
 * 2.3, 108 of 5; more, by up to 21 times, mostly beams pitched 17 to 85 degrees or ranges of 30 altitudes and more; less,
 * down to a fiftieth, more than eight beams of which most look past the transmitter's lobe.
 */
#include <asdic/ping.h>

#include "aim.h"
#include "base/vec.h"
#include "ring.h"

#include <math.h>

#define OVER_PLANES 4.0
#define OVER_MIRRORS 8.0
#define OVER_PLANES_ONE_WAY 20.0 /* mirrors or not */
#define LIT_WIDE 4.0 /* times as wide as the narrowest beam is the transmitter, or more */
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
#define ALIKE 1e-6        /* nearer, in half-power widths, is the same aim, but for rounding */

/* Half-power width of an aperture of LENGTH wavelengths, sinc^2 (sin(x) / x = 1 / sqrt 2 at x = 1.3916), at
 * most a half-space. */
static double width_rad(double length_wl) {
    double sine = 0.4430 / fmax(length_wl, 0.4430);
    return 2.0 * asin(fmin(sine, 1.0));
}

/* A beam that is not joined to the others yet: its half-power widths, and how near the nearest one that is joined lies,
 * in widths of the narrower of both, squared. */
typedef struct lone_beam {
    const asdic_beam *beam;
    asdic_vec3 axis;
    double wide, high, nearest2;
} lone_beam;

/* Sides, not yaw and pitch, tell how far one beam is from another: in a fan that looks down, or is
 * rolled, the narrow one lies along neither. Sines bound the angles, and spare most pairs the
 * arcs. */
static void meet(lone_beam *lone, const lone_beam *joined, const asdic_face *face) {
    asdic_vec3 v = asdic_mat3_apply(face->world_to_face, lone->axis);
    double wide = fmin(lone->wide, joined->wide), high = fmin(lone->high, joined->high);
    double across = v.y / wide, down = v.z / high;
    if (across * across + fmin(down * down, 1.0) < lone->nearest2) {
        across = atan2(v.y, v.x) / wide;
        down = asin(fmin(fmax(v.z, -1.0), 1.0)) / high;
        lone->nearest2 = fmin(lone->nearest2, across * across + fmin(down * down, 1.0));
    }
}

/* What a sonar tells apart: beams, or beams times bins. */
typedef struct cells {
    double count;
    bool one_way; /* up to ASDIC_AIMS_MOST, some of which hear side lobes of one side alone */
} cells;

/*
 * Beams of SONAR that do not overlap, 1 or more: the sum of the steps of the shortest tree that joins all, in half-power
 * widths, and a mean step for the beam that it begins with. So it matters neither in which order beams are listed nor
 * whether some aim alike. Rays of a sector also go between beams that lie apart across it: there a step counts whole,
 * else 1 at most.
 */
static cells beams_apart(const asdic_sonar *sonar, double wavelength_m) {
    const asdic_pose level = {0};
    lone_beam lone[ASDIC_SONAR_MAX_RECEIVERS];
    size_t left = sonar->receiver_count < ASDIC_SONAR_MAX_RECEIVERS ? sonar->receiver_count
                                                                    : ASDIC_SONAR_MAX_RECEIVERS;
    for (size_t k = 0; k < left; k++) {
        const asdic_beam *beam = &sonar->receivers[k];
        asdic_face face = asdic_face_aim(beam, &level, wavelength_m);
        const double *axis = face.world_to_face.m[0];
        lone[k] = (lone_beam){beam,
                              {axis[0], axis[1], axis[2]},
                              width_rad(face.length_h_wl),
                              width_rad(face.length_v_wl),
                              INFINITY};
    }
    double whole = 0.0, bounded = 0.0, steps = 0.0, narrowest = INFINITY;
    for (size_t next = 0; left > 0;) {
        const lone_beam joined = lone[next];
        asdic_face face = asdic_face_aim(joined.beam, &level, wavelength_m);
        narrowest = fmin(narrowest, joined.wide);
        lone[next] = lone[--left];
        next = 0;
        for (size_t k = 0; k < left; k++) {
            meet(&lone[k], &joined, &face);
            next = lone[k].nearest2 < lone[next].nearest2 ? k : next;
        }
        double step = left > 0 ? sqrt(lone[next].nearest2) : 0.0;
        whole += step;
        bounded += fmin(step, 1.0);
        steps += step > ALIKE ? 1.0 : 0.0;
    }
    bool sector = steps >= ASDIC_AIMS_MOST;
    double sum = sector ? whole : bounded;
    double sent = width_rad(sonar->transmitter.length_h_m / wavelength_m);
    return (cells){fmax(sum + sum / fmax(steps, 1.0), 1.0),
                   !sector && (sent >= LIT_WIDE * narrowest ||
                               asdic_receivers_in_the_dark(sonar, wavelength_m) > 0)};
}

/* Cells that SONAR tells apart; 0 of no sonar. */
static cells cells_of(const asdic_sonar *sonar, double sound_speed_mps) {
    if (!sonar || sonar->receiver_count == 0 || !(sonar->frequency_hz > 0.0) ||
        !(sound_speed_mps > 0.0)) {
        return (cells){0.0, false};
    }
    cells c = beams_apart(sonar, sound_speed_mps / sonar->frequency_hz);
    c.count *= (double)asdic_sonar_bin_count(sonar, sound_speed_mps);
    return c;
}

/* Rays for AUTO_DB, without limits. */
static double rays_needed(cells c, asdic_rays_over over) {
    if (over == ASDIC_OVER_MESHES) {
        return fmax(fmin(c.count * OVER_MESHES_OF_FEW, MOST_OF_FEW), c.count * OVER_MESHES);
    }
    if (c.one_way) {
        return c.count * OVER_PLANES_ONE_WAY;
    }
    return c.count * (over == ASDIC_OVER_MIRRORS ? OVER_MIRRORS : OVER_PLANES);
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
    cells c = cells_of(sonar, sound_speed_mps);
    double some = fmax(rays, 1.0), needed = rays_needed(c, over) / some;
    if (over == ASDIC_OVER_MESHES) {
        return fmin(AUTO_DB * sqrt(needed), MOST_DB);
    }
    if (c.one_way) {
        return fmin(AUTO_DB * pow(needed, PLANES_MORE), MOST_DB);
    }
    double lack = c.count * OVER_PLANES / some;
    double error_db = PLANES_DB * pow(lack, lack > 1.0 ? PLANES_FEWER : PLANES_MORE);
    return fmin(over == ASDIC_OVER_MIRRORS ? MIRRORS_TIMES * error_db : error_db, MOST_DB);
}
