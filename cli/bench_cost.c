/* What stderr_db costs: blocks of pings by turns with and without. */
#include "bench_error.h"

#include <math.h>

static asdic_status shoot_block(cli *c, asdic_simulator *sim, const bench_scene *s, uint64_t first,
                                asdic_ping *ping, double *seconds) {
    asdic_pose poses[ASDIC_LEARN_BLOCK];
    asdic_ping *same[ASDIC_LEARN_BLOCK];
    for (size_t k = 0; k < ASDIC_LEARN_BLOCK; k++) {
        poses[k] = s->pose;
        same[k] = ping;
    }
    if (asdic_context_interrupted(cli_context(c))) {
        return ASDIC_ERROR_INTERRUPTED;
    }
    double began = bench_processor_s();
    asdic_status status = asdic_simulator_learn(sim, &s->pose, first);
    if (!status) {
        status = asdic_simulator_pings(sim, poses, first, ASDIC_LEARN_BLOCK, same);
    }
    *seconds = bench_processor_s() - began;
    return status;
}

static asdic_status open_simulator(cli *c, asdic_device *device, const bench_scene *s,
                                   bool without_errors, asdic_simulator **out) {
    asdic_sampling sampling = *asdic_mission_sampling(s->mission);
    sampling.without_errors = without_errors;
    return asdic_simulator_create(cli_context(c), device, asdic_mission_scene(s->mission),
                                  asdic_mission_environment(s->mission), &s->sonar, &sampling,
                                  s->pose.position_m.z, out);
}

asdic_status bench_cost_measure(cli *c, asdic_device *device, const bench_scene *scene,
                                const bench_effort *effort, double *out) {
    asdic_simulator *sims[2] = {NULL, NULL};
    asdic_ping *ping = NULL;
    double least_s[2] = {INFINITY, INFINITY}, seconds;
    asdic_status status = asdic_ping_create(cli_context(c), scene->beams, scene->bins, &ping);
    for (int k = 0; !status && k < 2; k++) {
        status = open_simulator(c, device, scene, k == 1, &sims[k]);
        if (!status) { /* the first compiles for its sizes */
            status = shoot_block(c, sims[k], scene, 0, ping, &seconds);
        }
    }
    for (size_t i = 0; !status && i < 2 * effort->cost_pairs; i++) {
        size_t which = i % 2;
        uint64_t first = i / 2 * ASDIC_LEARN_BLOCK;
        status = shoot_block(c, sims[which], scene, first, ping, &seconds);
        least_s[which] = fmin(least_s[which], seconds);
    }
    *out = least_s[0] / least_s[1] - 1.0;
    asdic_ping_destroy(&ping);
    asdic_simulator_destroy(&sims[0]);
    asdic_simulator_destroy(&sims[1]);
    return status;
}
