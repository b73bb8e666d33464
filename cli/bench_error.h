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
    size_t cost_pairs;
    uint32_t reference_rays;
} bench_effort;

bench_effort bench_effort_of(const bench_options *options);

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

asdic_status bench_scene_open(cli *c, asdic_device *device, const char *path,
                              const bench_effort *effort, bench_scene *out);
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

/* Measures all ray counts of SAMPLER. */
asdic_status bench_curve_measure(cli *c, asdic_device *device, const bench_scene *scene,
                                 asdic_sampler sampler, const bench_effort *effort,
                                 bench_curve *out);

/* RMS error and time at RAYS rays, interpolated in log-log; NAN outside. */
double bench_curve_rms_db(const bench_curve *curve, double rays);

/* What stating errors costs at the scene's rays, as part of the time without: of blocks of
 * ASDIC_LEARN_BLOCK pings, learning and calibration included, by turns one with and one without, the
 * quickest of each by the processor's clock. */
asdic_status bench_cost_errors(cli *c, asdic_device *device, const bench_scene *scene,
                               const bench_effort *effort, double *out);

/* The scene's range in few bins and in many. */
#define BENCH_FEW_BINS 150
#define BENCH_MANY_BINS 2048

typedef struct bench_bins_cost {
    double few_s, many_s; /* a ping */
} bench_bins_cost;

/* What bins cost: as bench_cost_errors, by the clock on the wall. */
asdic_status bench_cost_bins(cli *c, asdic_device *device, const bench_scene *scene,
                             const bench_effort *effort, bench_bins_cost *out);

/* A finished scene: its curves, the baseline last. */
typedef struct bench_result {
    bench_scene scene;
    bench_curve curves[BENCH_SAMPLERS];
    double stated_cost; /* see bench_cost_errors */
    bench_bins_cost bins_cost;
} bench_result;

void bench_error_print(const bench_result *result, bool first);
void bench_error_json(const bench_result *results, size_t count, const asdic_device_info *device);
int bench_error_csv(const cli *c, const char *path, const bench_result *results, size_t count);
asdic_status bench_error_picture(const cli *c, const char *path, const bench_result *results,
                                 size_t count);

#endif
