/* What a choice costs: blocks of pings by turns, one made so, one the other way. */
#include "bench_error.h"

#include <math.h>

/* One of the two. */
typedef struct side {
    asdic_sonar sonar;
    bool without_errors;
    asdic_simulator *sim;
    asdic_ping *ping;
    double least_s; /* of a block */
} side;

/* A block of S, learning and calibration included; its seconds by CLOCK. */
static asdic_status shoot_block(cli *c, side *s, const asdic_pose *pose, uint64_t first,
                                double (*clock_s)(void), double *seconds) {
    asdic_pose poses[ASDIC_LEARN_BLOCK];
    asdic_ping *same[ASDIC_LEARN_BLOCK];
    for (size_t k = 0; k < ASDIC_LEARN_BLOCK; k++) {
        poses[k] = *pose;
        same[k] = s->ping;
    }
    if (asdic_context_interrupted(cli_context(c))) {
        return ASDIC_ERROR_INTERRUPTED;
    }
    double began = clock_s();
    asdic_status status = asdic_simulator_learn(s->sim, pose, first);
    if (!status) {
        status = asdic_simulator_pings(s->sim, poses, first, ASDIC_LEARN_BLOCK, same);
    }
    *seconds = clock_s() - began;
    return status;
}

static asdic_status open_side(cli *c, asdic_device *device, const bench_scene *scene, side *s) {
    asdic_sampling sampling = *asdic_mission_sampling(scene->mission);
    sampling.without_errors = s->without_errors;
    asdic_status status =
        asdic_simulator_create(cli_context(c), device, asdic_mission_scene(scene->mission),
                               asdic_mission_environment(scene->mission), &s->sonar, &sampling,
                               scene->pose.position_m.z, &s->sim);
    return status ? status
                  : asdic_ping_create(cli_context(c), scene->beams,
                                      asdic_simulator_bin_count(s->sim), &s->ping);
}

/* The quickest of PAIRS blocks of both sides, one after the other in turn. */
static asdic_status by_turns(cli *c, asdic_device *device, const bench_scene *scene, size_t pairs,
                             double (*clock_s)(void), side *sides) {
    asdic_status status = ASDIC_OK;
    double seconds;
    for (int k = 0; !status && k < 2; k++) {
        sides[k].least_s = INFINITY;
        status = open_side(c, device, scene, &sides[k]);
        if (!status) { /* the first compiles for its sizes */
            status = shoot_block(c, &sides[k], &scene->pose, 0, clock_s, &seconds);
        }
    }
    for (size_t i = 0; !status && i < 2 * pairs; i++) {
        side *s = &sides[i % 2];
        uint64_t first = i / 2 * ASDIC_LEARN_BLOCK;
        status = shoot_block(c, s, &scene->pose, first, clock_s, &seconds);
        s->least_s = fmin(s->least_s, seconds);
    }
    for (int k = 0; k < 2; k++) {
        asdic_ping_destroy(&sides[k].ping);
        asdic_simulator_destroy(&sides[k].sim);
    }
    return status;
}

asdic_status bench_cost_errors(cli *c, asdic_device *device, const bench_scene *scene,
                               const bench_effort *effort, double *out) {
    side sides[2] = {{.sonar = scene->sonar}, {.sonar = scene->sonar, .without_errors = true}};
    asdic_status status = by_turns(c, device, scene, effort->cost_pairs, bench_processor_s, sides);
    *out = sides[0].least_s / sides[1].least_s - 1.0;
    return status;
}

asdic_status bench_cost_bins(cli *c, asdic_device *device, const bench_scene *scene,
                             const bench_effort *effort, bench_bins_cost *out) {
    const double range_m = (double)scene->bins * scene->sonar.bin_length_m;
    const size_t counts[2] = {BENCH_FEW_BINS, BENCH_MANY_BINS};
    side sides[2] = {{.sonar = scene->sonar}, {.sonar = scene->sonar}};
    for (int k = 0; k < 2; k++) {
        sides[k].sonar.bin_length_m = range_m / ((double)counts[k] + 0.5);
    }
    asdic_status status = by_turns(c, device, scene, effort->cost_pairs, bench_now_s, sides);
    out->few_s = sides[0].least_s / ASDIC_LEARN_BLOCK;
    out->many_s = sides[1].least_s / ASDIC_LEARN_BLOCK;
    return status;
}
