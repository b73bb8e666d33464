/*
 * Looks at a map: beams of 10.9 degrees, one look, a background of 1.
 */
#ifndef ASDIC_TESTS_MAP_RIG_H
#define ASDIC_TESTS_MAP_RIG_H

#include "scan_rig.h"
#include "test_context.h"

#include <math.h>

enum { MAP_BINS = 100, MAP_BEAMS = 5 };
static const double MAP_PRIOR = -4.59511985; /* ln(0.01 / 0.99) */

typedef struct map_rig {
    asdic_sonar sonar;
    asdic_beam beams[MAP_BEAMS];
    double intensity[MAP_BEAMS * MAP_BINS], background[MAP_BEAMS * MAP_BINS];
    asdic_occupancy *map;
    asdic_pose pose;
    double depth_m;
} map_rig;

static inline void map_begin(map_rig *r, size_t beams) {
    *r = (map_rig){.sonar = asdic_sonar_default(), .depth_m = INFINITY};
    for (size_t b = 0; b < beams; b++) {
        r->beams[b] = r->sonar.transmitter;
    }
    r->sonar = sonar_of(r->beams, beams);
    r->sonar.bandwidth_hz = 0.5 * SPEED / r->sonar.bin_length_m;
    for (size_t i = 0; i < MAP_BEAMS * MAP_BINS; i++) {
        r->intensity[i] = 0.3;
        r->background[i] = i % MAP_BINS == 0 ? (double)NAN : 1.0;
    }
    asdic_vec3 low = {-1.0, -30.0, 0.0}, high = {60.0, 30.0, 0.0};
    assert_ok(ctx, asdic_occupancy_create(ctx, low, high, 0.25, 0.01, 10.0, &r->map));
}

static inline asdic_look look_of(const map_rig *r) {
    return (asdic_look){.sonar = &r->sonar,
                        .sound_speed_mps = SPEED,
                        .pose = r->pose,
                        .depth_m = r->depth_m,
                        .bins = MAP_BINS,
                        .intensity_lin = r->intensity,
                        .background_lin = r->background,
                        .snr_db = 10.0};
}

static inline void map_look(map_rig *r) {
    const asdic_look look = look_of(r);
    assert_ok(ctx, asdic_occupancy_add(ctx, r->map, &look));
}

/* The pattern in the horizontal of a face LENGTH_M wide, ASIDE_RAD off its axis. */
static inline double face_gain(const asdic_sonar *sonar, double length_m, double aside_rad) {
    double x = acos(-1.0) * length_m * sonar->frequency_hz / SPEED * sin(aside_rad);
    return fabs(x) < 1e-9 ? 1.0 : pow(sin(x) / x, 2);
}

static inline double map_at(const map_rig *r, double north_m, double east_m) {
    size_t row = (size_t)((north_m + 1.0) / 0.25), column = (size_t)((east_m + 30.0) / 0.25);
    return (double)r->map->log_odds[row * r->map->columns + column];
}

#endif
