/*
 * Speed against error, inside: scenes, references, curves.
 */
#ifndef ASDIC_CLI_BENCH_ERROR_H
#define ASDIC_CLI_BENCH_ERROR_H

#include "bench.h"

#define BENCH_SAMPLERS 3
#define BENCH_MOST_POINTS 8
/* Bins nearer than this are left out: the sonar's near field. */
#define BENCH_NEAREST_M 2.0

/* How much work a measurement takes. */
typedef struct bench_effort {
    size_t blocks;          /* of pings of a point, each learnt: whole ones where rays are few */
    uint64_t point_rays;    /* rays spent on a point with many */
    size_t reference_pings; /* where there is no quadrature */
    uint32_t reference_rays;
} bench_effort;

bench_effort bench_effort_of(bool quick);

/* One scene, noise and speckle off, and the energy its bins should hold. */
typedef struct bench_scene {
    char name[64];
    asdic_mission *mission;
    asdic_sonar sonar;
    asdic_pose pose;
    size_t beams, bins, first_bin, far_bin; /* bins counted, and where their last third begins */
    double *reference_lin;                  /* [beam * bins + bin] */
    double *spread_lin;                     /* its standard error; NULL: quadrature */
    bool exact;                             /* quadrature, else the mean of pings */
    double spread_db;                       /* RMS standard error of the reference */
    double reference_rays;                  /* 0: quadrature */
} bench_scene;

/* Scene INDEX of those asked for, without a reference. It is finished after a failure, too. */
asdic_status bench_scene_load(const bench *b, size_t index, bench_scene *out);
/* The same with its reference. */
asdic_status bench_scene_open(const bench *b, size_t index, const bench_effort *effort,
                              bench_scene *out);
/* A simulator of the scene and a ping that fits it; both destroyed by the caller, also on
 * failure. */
asdic_status bench_scene_simulator(const bench *b, const bench_scene *s,
                                   const asdic_sampling *sampling, asdic_simulator **sim,
                                   asdic_ping **ping);
void bench_scene_finish(bench_scene *scene);

/* Errors of pings with so many rays: of 10 log10(estimate / reference) over bins and pings. */
typedef struct bench_point {
    uint32_t rays;
    size_t pings;
    double rms_db, far_rms_db, most_db; /* far: the last third of the bins */
    double bias_db; /* RMS over bins of what is left of the error in the mean of all pings */
    double honesty, far_honesty; /* RMS of true over stated error */
    double ping_s;               /* median over blocks, with its share of learning */
    double learn_share;          /* of ping_s */
} bench_point;

typedef struct bench_curve {
    asdic_sampler sampler;
    bench_point points[BENCH_MOST_POINTS];
    size_t count;
    double rays_1db, seconds_1db; /* interpolated in log-log; NAN: not bracketed */
} bench_curve;

const char *bench_sampler_name(asdic_sampler sampler);

/* Where the points cross 1 dB for the last time: errors of few rays scatter. */
void bench_find_1db(bench_curve *curve);
/* Measures all ray counts of out->sampler. */
asdic_status bench_curve_measure(const bench *b, const bench_scene *scene,
                                 const bench_effort *effort, bench_curve *out);

#endif
