/*
 * How many rays a ping takes for a stated error of about 0.5 dB r.m.s. in bins above the noise, by the cells
 * that a sonar tells apart: bins times the beams that do not overlap. Measured, in dB:
 *
 *     over planes    4 rays a cell           fans of data/scenes 0.18 to 0.4, single beams below 0.06
 *     over meshes    128 a cell to 400,000   5 beams 0.5, 3 beams 0.8
 *                    32 a cell beyond        512 beams 0.5
 */
#include <asdic/ping.h>

#include "base/vec.h"

#include <math.h>

#define OVER_PLANES 4.0
#define OVER_MESHES 32.0
#define OVER_MESHES_OF_FEW 128.0
#define MOST_OF_FEW 400000.0
#define LEAST_RAYS 20000.0
#define MOST_RAYS 524288.0
#define AUTO_DB 0.5

/* Half-power width of an aperture of LENGTH wavelengths, sinc^2 (sin(x) / x = 1 / sqrt 2 at x = 1.3916), at
 * most a half-space. */
static double width_rad(double length_wl) {
    double sine = 0.4430 / fmax(length_wl, 0.4430);
    return 2.0 * asin(fmin(sine, 1.0));
}

/* From one angle to another by the shorter way. Few aims differ by more than half a turn, and a
 * remainder takes twenty times as long as all else of a pair of beams. */
static double turn_rad(double from_rad, double to_rad) {
    double turn = to_rad - from_rad;
    return fabs(turn) > ASDIC_PI ? remainder(turn, 2.0 * ASDIC_PI) : turn;
}

/* How much of beam A the nearest other beam leaves to it, 0 to 1. */
static double share_of(const asdic_sonar *sonar, size_t a, double wavelength_m) {
    const asdic_beam *own = &sonar->receivers[a];
    double wide = width_rad(own->length_h_m / wavelength_m);
    double high = width_rad(own->length_v_m / wavelength_m), nearest2 = 1.0;
    double level = cos(own->pitch_rad);
    for (size_t b = 0; b < sonar->receiver_count; b++) {
        const asdic_beam *other = &sonar->receivers[b];
        double across = turn_rad(own->yaw_rad, other->yaw_rad) * level / wide;
        double down = turn_rad(own->pitch_rad, other->pitch_rad) / high;
        double off2 = across * across + down * down;
        nearest2 = b != a && off2 < nearest2 ? off2 : nearest2;
    }
    return sqrt(nearest2);
}

/* Rays for AUTO_DB without limits; 0 of no sonar. */
static double rays_needed(const asdic_sonar *sonar, double sound_speed_mps, bool meshes) {
    if (!sonar || !(sonar->frequency_hz > 0.0) || !(sound_speed_mps > 0.0)) {
        return 0.0;
    }
    double beams = 0.0;
    for (size_t r = 0; r < sonar->receiver_count; r++) {
        beams += share_of(sonar, r, sound_speed_mps / sonar->frequency_hz);
    }
    double cells = beams * (double)asdic_sonar_bin_count(sonar, sound_speed_mps);
    return meshes ? fmax(fmin(cells * OVER_MESHES_OF_FEW, MOST_OF_FEW), cells * OVER_MESHES)
                  : cells * OVER_PLANES;
}

uint32_t asdic_rays_auto(const asdic_sonar *sonar, double sound_speed_mps, bool meshes) {
    double rays = rays_needed(sonar, sound_speed_mps, meshes);
    rays = fmin(fmax(rays, LEAST_RAYS), MOST_RAYS);
    double digit =
        pow(10.0, floor(log10(rays)) - 1.0); /* two digits, so that a report reads well */
    return (uint32_t)fmin(ceil(rays / digit) * digit, MOST_RAYS);
}

/* An error of independent samples falls with the root of their number. */
double asdic_rays_error_db(const asdic_sonar *sonar, double sound_speed_mps, bool meshes,
                           uint32_t rays) {
    return AUTO_DB * sqrt(rays_needed(sonar, sound_speed_mps, meshes) / fmax(rays, 1.0));
}
