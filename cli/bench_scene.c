/* A benchmark scene and the truth about it. */
#include "bench_error.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Pings of references and of sweeps have numbers far apart, hence other lattice shifts. */
#define REFERENCE_INDEX 1000000u

/* Whether quadrature knows this scene: planes only, nothing that a mirror or a mesh changes. */
static bool is_flat(const asdic_mission *mission) {
    return asdic_mission_object_count(mission) == 0 &&
           asdic_mission_sampling((asdic_mission *)mission)->multipath !=
               ASDIC_MULTIPATH_BOUNDARIES;
}

asdic_status bench_scene_simulator(const bench *b, const bench_scene *s,
                                   const asdic_sampling *sampling, asdic_simulator **sim,
                                   asdic_ping **ping) {
    TRY(asdic_simulator_create(cli_context(b->c), b->device, asdic_mission_scene(s->mission),
                               asdic_mission_environment(s->mission), &s->sonar, sampling,
                               s->pose.position_m.z, sim));
    return asdic_ping_create(cli_context(b->c), s->beams, asdic_simulator_bin_count(*sim), ping);
}

static asdic_status take_quadrature(const bench *b, bench_scene *s) {
    asdic_flat_scene flat = asdic_mission_flat_scene(s->mission, 0);
    asdic_ping *ping = NULL;
    TRY(asdic_ping_create(cli_context(b->c), s->beams, s->bins, &ping));
    asdic_status status = asdic_expected_compute(
        cli_context(b->c), &flat, asdic_mission_environment(s->mission), &s->sonar, &s->pose, ping);
    memcpy(s->reference_lin, ping->intensity_lin[ASDIC_TOTAL], s->beams * s->bins * sizeof(double));
    asdic_ping_destroy(&ping);
    return status;
}

/* Mean and spread of the mean, from sums over COUNT pings; the spread as dB, RMS over what is
 * counted. */
static double finish_mean(bench_scene *s, const double *squares, size_t count) {
    double sum = 0.0, n = (double)count;
    size_t counted = 0;
    for (size_t i = 0; i < s->beams * s->bins; i++) {
        double mean = s->reference_lin[i] / n;
        double variance = fmax(squares[i] / n - mean * mean, 0.0) / (n - 1.0);
        s->reference_lin[i] = mean;
        s->spread_lin[i] = sqrt(variance);
        if (i % s->bins >= s->first_bin && mean > 0.0) {
            sum += variance / (mean * mean);
            counted++;
        }
    }
    return 10.0 / log(10.0) * sqrt(sum / (double)(counted ? counted : 1));
}

/* Sums of energies, and of their squares, over the pings of the reference. */
static asdic_status add_pings(const bench *b, const bench_effort *effort, bench_scene *s,
                              double *squares, asdic_simulator *sim, asdic_ping *ping) {
    TRY(asdic_simulator_learn(sim, &s->pose, REFERENCE_INDEX));
    for (size_t k = 0; k < effort->reference_pings; k++) {
        TRY(bench_interrupted(b));
        TRY(asdic_simulator_ping(sim, &s->pose, REFERENCE_INDEX + k, ping));
        for (size_t i = 0; i < s->beams * s->bins; i++) {
            double e = ping->intensity_lin[ASDIC_TOTAL][i];
            s->reference_lin[i] += e;
            squares[i] += e * e;
        }
    }
    return ASDIC_OK;
}

static asdic_status take_mean(const bench *b, const bench_effort *effort, bench_scene *s) {
    asdic_sampling sampling = *asdic_mission_sampling(s->mission);
    size_t cells = s->beams * s->bins;
    asdic_simulator *sim = NULL;
    asdic_ping *ping = NULL;
    sampling.sampler = ASDIC_SAMPLER_ADAPTIVE;
    sampling.rays = effort->reference_rays;
    double *squares = calloc(cells, sizeof *squares);
    s->spread_lin = calloc(cells, sizeof *s->spread_lin);
    asdic_status status = squares && s->spread_lin
                              ? bench_scene_simulator(b, s, &sampling, &sim, &ping)
                              : ASDIC_ERROR_MEMORY;
    status = status ? status : add_pings(b, effort, s, squares, sim, ping);
    if (!status) {
        s->spread_db = finish_mean(s, squares, effort->reference_pings);
        s->reference_rays = (double)effort->reference_pings * effort->reference_rays;
    }
    free(squares);
    asdic_ping_destroy(&ping);
    asdic_simulator_destroy(&sim);
    return status;
}

asdic_status bench_scene_load(const bench *b, size_t index, bench_scene *out) {
    char buffer[4096];
    const char *path = bench_scene_path(b, index, buffer, sizeof buffer);
    *out = (bench_scene){0};
    bench_name(path, out->name, sizeof out->name);
    TRY(asdic_mission_load(cli_context(b->c), path, &out->mission));
    /* Coherent pings state no error, and are no means. */
    asdic_mission_sampling(out->mission)->coherent = false;
    out->pose = asdic_mission_pose(out->mission, 0, NULL);
    out->sonar = *asdic_mission_sonar(out->mission);
    out->sonar.noise_enabled = false;
    out->sonar.speckle = ASDIC_SPECKLE_NONE;
    const asdic_environment *env = asdic_mission_environment(out->mission);
    double c_mps = asdic_environment_sound_speed_mps(env, out->pose.position_m.z);
    out->beams = out->sonar.receiver_count;
    out->bins = asdic_sonar_bin_count(&out->sonar, c_mps);
    double nearest_m = fmax(BENCH_NEAREST_M, out->sonar.blanking_m);
    out->first_bin = (size_t)ceil(nearest_m / out->sonar.bin_length_m - 1e-9);
    out->first_bin = out->first_bin < out->bins ? out->first_bin : 0;
    out->far_bin = out->bins - (out->bins - out->first_bin) / 3;
    return ASDIC_OK;
}

asdic_status bench_scene_open(const bench *b, size_t index, const bench_effort *effort,
                              bench_scene *out) {
    TRY(bench_scene_load(b, index, out));
    out->reference_lin = calloc(out->beams * out->bins, sizeof *out->reference_lin);
    if (!out->reference_lin) {
        return ASDIC_ERROR_MEMORY;
    }
    out->exact = is_flat(out->mission);
    return out->exact ? take_quadrature(b, out) : take_mean(b, effort, out);
}

void bench_scene_finish(bench_scene *scene) {
    asdic_mission_destroy(&scene->mission);
    free(scene->reference_lin);
    free(scene->spread_lin);
    scene->reference_lin = scene->spread_lin = NULL;
}
