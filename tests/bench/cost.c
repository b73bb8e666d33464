/* What a choice costs: blocks of pings by turns, one made so, one the other way. */
#include "bench_error.h"
#include "kinds.h"

#include <math.h>

/* The scene's range in few bins and in many. */
#define FEW_BINS 150
#define MANY_BINS 2048

const bench_column cost_columns[] = {{"scene", "scene", 14, 0, 0.0},
                                     {"stated_error_cost", "errors, %", 10, 1, 100.0},
                                     {"ping_s_of_150_bins", "150 bins, ms", 12, 3, 1e3},
                                     {"ping_s_of_2048_bins", "2048 bins, ms", 13, 3, 1e3},
                                     {"bins_cost", "bins, %", 10, 1, 100.0},
                                     {NULL, NULL, 0, 0, 0.0}};

/* One of the two. */
typedef struct side {
    asdic_sonar sonar;
    bool without_errors;
    asdic_simulator *sim;
    asdic_ping *ping;
    double least_s; /* of a block */
} side;

/* A block of S, learning and calibration included; its seconds by CLOCK_S. */
static asdic_status shoot_block(const bench *b, side *s, const asdic_pose *pose, uint64_t first,
                                double (*clock_s)(void), double *seconds) {
    asdic_pose poses[ASDIC_LEARN_BLOCK];
    asdic_ping *same[ASDIC_LEARN_BLOCK];
    for (size_t k = 0; k < ASDIC_LEARN_BLOCK; k++) {
        poses[k] = *pose;
        same[k] = s->ping;
    }
    TRY(bench_interrupted(b));
    double began = clock_s();
    TRY(asdic_simulator_learn(s->sim, pose, first));
    TRY(asdic_simulator_pings(s->sim, poses, first, ASDIC_LEARN_BLOCK, same));
    *seconds = clock_s() - began;
    return ASDIC_OK;
}

static asdic_status open_side(const bench *b, const bench_scene *scene, side *s) {
    bench_scene changed = *scene;
    asdic_sampling sampling = *asdic_mission_sampling(scene->mission);
    sampling.without_errors = s->without_errors;
    changed.sonar = s->sonar;
    return bench_scene_simulator(b, &changed, &sampling, &s->sim, &s->ping);
}

/* The quickest of PAIRS blocks of both sides, one after the other in turn. */
static asdic_status take_turns(const bench *b, const bench_scene *scene, size_t pairs,
                               double (*clock_s)(void), side *sides) {
    double seconds;
    for (int k = 0; k < 2; k++) {
        sides[k].least_s = INFINITY;
        TRY(open_side(b, scene, &sides[k]));
        /* the first compiles for its sizes */
        TRY(shoot_block(b, &sides[k], &scene->pose, 0, clock_s, &seconds));
    }
    for (size_t i = 0; i < 2 * pairs; i++) {
        side *s = &sides[i % 2];
        uint64_t first = i / 2 * ASDIC_LEARN_BLOCK;
        TRY(shoot_block(b, s, &scene->pose, first, clock_s, &seconds));
        s->least_s = fmin(s->least_s, seconds);
    }
    return ASDIC_OK;
}

static asdic_status by_turns(const bench *b, const bench_scene *scene, double (*clock_s)(void),
                             side *sides) {
    asdic_status status = take_turns(b, scene, b->quick ? 9 : 15, clock_s, sides);
    for (int k = 0; k < 2; k++) {
        asdic_ping_destroy(&sides[k].ping);
        asdic_simulator_destroy(&sides[k].sim);
    }
    return status;
}

static asdic_status measure(bench *b, const bench_scene *scene) {
    const double range_m = (double)scene->bins * scene->sonar.bin_length_m;
    side stated[2] = {{.sonar = scene->sonar}, {.sonar = scene->sonar, .without_errors = true}};
    side bins[2] = {{.sonar = scene->sonar}, {.sonar = scene->sonar}};
    bins[0].sonar.bin_length_m = range_m / (FEW_BINS + 0.5);
    bins[1].sonar.bin_length_m = range_m / (MANY_BINS + 0.5);
    TRY(by_turns(b, scene, bench_processor_s, stated));
    TRY(by_turns(b, scene, bench_now_s, bins));
    const bench_cell cells[] = {BENCH_TEXT(scene->name),
                                BENCH_NUMBER(stated[0].least_s / stated[1].least_s - 1.0),
                                BENCH_NUMBER(bins[0].least_s / ASDIC_LEARN_BLOCK),
                                BENCH_NUMBER(bins[1].least_s / ASDIC_LEARN_BLOCK),
                                BENCH_NUMBER(bins[1].least_s / bins[0].least_s - 1.0)};
    bench_add(b, cells);
    return ASDIC_OK;
}

asdic_status cost(bench *b) {
    bench_effort effort = bench_effort_of(true); /* of the truth, which is not asked for */
    asdic_status status = ASDIC_OK;
    for (size_t i = 0; !status && i < bench_scene_count(b); i++) {
        bench_scene scene;
        status = bench_scene_open(b, i, &effort, &scene);
        if (!status) {
            status = measure(b, &scene);
        }
        bench_scene_finish(&scene);
    }
    return status;
}
