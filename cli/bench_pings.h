/*
 * Pings per second, inside: the sea floor and the measurement.
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

/* From the start of a process to its first ping, over a floor of 10,000 triangles: with an empty cache
 * of PoCL's kernels, and with the one that left behind; NAN where no process could be started. Before
 * any device is opened. */
typedef struct bench_start {
    double cold_s, warm_s;
} bench_start;

bench_start bench_start_measure(const cli *c);

typedef struct bench_rate {
    size_t triangles, bins, pings;
    unsigned units;
    double build_s;           /* of the hierarchy */
    double create_s, first_s; /* a process's first simulator, or a later one; its first ping */
    double ping_s, learn_s;   /* medians: a ping; a block's learning */
    double phase_s[ASDIC_PHASE_COUNT]; /* mean, waiting after each */
} bench_rate;

/* The same work on the whole device and on one compute unit of it; of that no pings where the device has
 * no more, or cannot be split. */
typedef struct bench_pair {
    bench_rate whole, one;
} bench_pair;

#endif
