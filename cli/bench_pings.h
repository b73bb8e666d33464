/*
 * Pings per second, inside: the rough sea floor and the measurement, which tests/bench/ uses too.
 */
#ifndef ASDIC_CLI_BENCH_PINGS_H
#define ASDIC_CLI_BENCH_PINGS_H

#include "bench.h"

/* The sonar flies this high over a rough floor of 1 km, and hears this far. */
#define BENCH_ALTITUDE_M 100.0
#define BENCH_RANGE_M 500.0

/* Its height above the mean at X north, Y east, m: waves of 250 m and shorter. */
double bench_height_m(double x, double y);

/* A committed scene with a rough, smooth-faced floor of about TRIANGLES triangles, without surface,
 * built with THREADS threads (0: one per processor). */
asdic_status bench_terrain(asdic_context *ctx, size_t triangles, unsigned threads,
                           asdic_scene **out);

/* The floors and numbers of bins that are measured without a scene. */
#define BENCH_FLOORS 4
#define BENCH_BIN_COUNTS 4
extern const size_t bench_floors[BENCH_FLOORS], bench_bin_counts[BENCH_BIN_COUNTS];

/* What is measured: pings of MISSION, or where that is NULL of the paper's six beams over SCENE. */
typedef struct bench_case {
    asdic_mission *mission;
    const asdic_scene *scene;
    size_t bins;
    uint32_t rays; /* 0: those of the mission, or the paper's 20,000 */
    size_t pings;  /* 0: only the first */
} bench_case;

typedef struct bench_rate {
    size_t triangles, beams, bins;
    uint32_t rays;
    unsigned units;
    double build_s;           /* of the hierarchy */
    double create_s, first_s; /* a process's first simulator, or a later one; its first ping */
    double ping_s, learn_s;   /* medians: a ping; a block's learning */
    double phase_s[ASDIC_PHASE_COUNT]; /* mean, waiting after each */
    double least_s[ASDIC_PHASE_COUNT]; /* the least of each: other load hardly shows */
} bench_rate;

/* Pings of RAYS rays at POSE until the simulator goes as fast as it will. */
asdic_status bench_warm_up(const bench *b, asdic_simulator *sim, const asdic_pose *pose,
                           double rays, asdic_ping *ping);

asdic_status bench_pings_measure(const bench *b, asdic_device *device, const bench_case *of,
                                 bench_rate *out);
void bench_pings_add(bench *b, const char *scene, const bench_rate *r);

#endif
