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

const bench_column truth_columns[] = {{"scene", "scene", 18, 0, 0.0},
                                      {"beams", "beams", 5, 0, 0.0},
                                      {"ping_s", "processor, ms", 13, 3, 1e3},
                                      {"truth_cost", "truth, %", 10, 1, 100.0},
                                      {"wall_s", "wall, ms", 10, 3, 1e3},
                                      {"truth_wall_cost", "truth, %", 10, 1, 100.0},
                                      {NULL, NULL, 0, 0, 0.0}};

/* One of the two. */
typedef struct side {
    asdic_sonar sonar;
    bool without_errors, truth;
    asdic_simulator *sim;
    asdic_ping *ping;
} side;

#define MOST_PAIRS 15
/* Parts of a block of pings, and pings of a part. */
#define PARTS 8
#define PART (ASDIC_LEARN_BLOCK / PARTS)

/* Seconds of blocks of both sides. */
typedef struct turns {
    double seconds[2][MOST_PAIRS];
    size_t pairs;
} turns;

/* Part NTH of a block of S, learning included in the first; its seconds by CLOCK_S are added. */
static asdic_status shoot_part(const bench *b, side *s, const asdic_pose *pose, uint64_t nth,
                               double (*clock_s)(void), double *seconds) {
    asdic_pose poses[PART];
    asdic_ping *same[PART];
    for (size_t k = 0; k < PART; k++) {
        poses[k] = *pose;
        same[k] = s->ping;
    }
    TRY(bench_interrupted(b));
    double began = clock_s();
    if (nth % PARTS == 0) {
        TRY(asdic_simulator_learn(s->sim, pose, nth * PART));
    }
    TRY(asdic_simulator_pings(s->sim, poses, nth * PART, PART, same));
    *seconds += clock_s() - began;
    return ASDIC_OK;
}

static asdic_status open_side(const bench *b, const bench_scene *scene, side *s) {
    bench_scene changed = *scene;
    asdic_sampling sampling = *asdic_mission_sampling(scene->mission);
    sampling.without_errors = s->without_errors;
    sampling.truth = s->truth;
    changed.sonar = s->sonar;
    TRY(bench_scene_simulator(b, &changed, &sampling, &s->sim, &s->ping));
    return s->truth ? asdic_ping_add_truth(cli_context(b->c), s->ping) : ASDIC_OK;
}

/* T->pairs blocks of both sides, a part of each in turn: so both meet what else the machine does. */
static asdic_status take_turns(const bench *b, const bench_scene *scene, double (*clock_s)(void),
                               side *sides, turns *t) {
    double first = 0.0;
    for (int k = 0; k < 2; k++) {
        TRY(open_side(b, scene, &sides[k]));
        /* the first compiles for its sizes */
        TRY(shoot_part(b, &sides[k], &scene->pose, 0, clock_s, &first));
    }
    for (size_t i = 0; i < 2 * PARTS * t->pairs; i++) {
        TRY(shoot_part(b, &sides[i % 2], &scene->pose, i / 2, clock_s,
                       &t->seconds[i % 2][i / 2 / PARTS]));
    }
    return ASDIC_OK;
}

static asdic_status by_turns(const bench *b, const bench_scene *scene, double (*clock_s)(void),
                             side *sides, turns *t) {
    t->pairs = b->quick ? 9 : MOST_PAIRS;
    asdic_status status = take_turns(b, scene, clock_s, sides, t);
    for (int k = 0; k < 2; k++) {
        asdic_ping_destroy(&sides[k].ping);
        asdic_simulator_destroy(&sides[k].sim);
    }
    return status;
}

/* Seconds of a ping of side NTH in its quickest block. */
static double least_s(const turns *t, int nth) {
    double least = INFINITY;
    for (size_t i = 0; i < t->pairs; i++) {
        least = fmin(least, t->seconds[nth][i]);
    }
    return least / ASDIC_LEARN_BLOCK;
}

/* What the first side takes more than the second, which ran just after: other programs slow both down. */
static double cost_of(const turns *t) {
    double ratios[MOST_PAIRS];
    for (size_t i = 0; i < t->pairs; i++) {
        ratios[i] = t->seconds[0][i] / t->seconds[1][i];
    }
    return bench_median(ratios, t->pairs) - 1.0;
}

static asdic_status measure(bench *b, const bench_scene *scene) {
    const double range_m = (double)scene->bins * scene->sonar.bin_length_m;
    side stated[2] = {{.sonar = scene->sonar}, {.sonar = scene->sonar, .without_errors = true}};
    side bins[2] = {{.sonar = scene->sonar}, {.sonar = scene->sonar}};
    turns of_errors = {0}, of_bins = {0};
    bins[0].sonar.bin_length_m = range_m / (FEW_BINS + 0.5);
    bins[1].sonar.bin_length_m = range_m / (MANY_BINS + 0.5);
    TRY(by_turns(b, scene, cli_processor_s, stated, &of_errors));
    TRY(by_turns(b, scene, cli_clock_s, bins, &of_bins));
    double few_s = least_s(&of_bins, 0), many_s = least_s(&of_bins, 1);
    const bench_cell cells[] = {BENCH_TEXT(scene->name), BENCH_NUMBER(cost_of(&of_errors)),
                                BENCH_NUMBER(few_s), BENCH_NUMBER(many_s),
                                BENCH_NUMBER(many_s / few_s - 1.0)};
    bench_add(b, cells);
    return ASDIC_OK;
}

/* Coherent pings have no truth. */
static asdic_status measure_truth(bench *b, const bench_scene *scene) {
    const asdic_sonar *sonar = asdic_mission_sonar(scene->mission);
    side sides[2] = {{.sonar = *sonar, .truth = true}, {.sonar = *sonar}};
    turns of_processor = {0}, of_wall = {0};
    if (asdic_mission_sampling(scene->mission)->coherent) {
        return ASDIC_OK;
    }
    TRY(by_turns(b, scene, cli_processor_s, sides, &of_processor));
    TRY(by_turns(b, scene, cli_clock_s, sides, &of_wall));
    const bench_cell cells[] = {BENCH_TEXT(scene->name),
                                BENCH_NUMBER(scene->beams),
                                BENCH_NUMBER(least_s(&of_processor, 1)),
                                BENCH_NUMBER(cost_of(&of_processor)),
                                BENCH_NUMBER(least_s(&of_wall, 1)),
                                BENCH_NUMBER(cost_of(&of_wall))};
    bench_add(b, cells);
    return ASDIC_OK;
}

static asdic_status of_scenes(bench *b,
                              asdic_status (*measures)(bench *b, const bench_scene *scene)) {
    asdic_status status = ASDIC_OK;
    for (size_t i = 0; !status && i < bench_scene_count(b); i++) {
        bench_scene scene;
        status = bench_scene_load(b, i, &scene);
        if (!status) {
            status = measures(b, &scene);
        }
        bench_scene_finish(&scene);
    }
    return status;
}

asdic_status cost(bench *b) {
    return of_scenes(b, measure);
}

asdic_status truth(bench *b) {
    return of_scenes(b, measure_truth);
}
