/* A benchmark scene and the truth about it. */
#include "bench_error.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Pings of references and of sweeps have numbers far apart, hence other lattice shifts. */
#define REFERENCE_INDEX 1000000u

/* "data/scenes/bench_flat.yaml" to "bench_flat". */
static void take_name(const char *path, char *out, size_t size) {
    const char *slash = strrchr(path, '/');
    snprintf(out, size, "%s", slash ? slash + 1 : path);
    char *dot = strrchr(out, '.');
    if (dot && dot != out) {
        *dot = '\0';
    }
}

/* Whether quadrature knows this scene: planes only, nothing that a mirror or a mesh changes. */
static bool is_flat(const asdic_mission *mission) {
    return asdic_mission_object_count(mission) == 0;
}

static asdic_status take_quadrature(cli *c, bench_scene *s) {
    asdic_flat_scene flat = asdic_mission_flat_scene(s->mission, 0);
    asdic_ping *ping = NULL;
    asdic_status status = asdic_ping_create(cli_context(c), s->beams, s->bins, &ping);
    if (!status) {
        status =
            asdic_expected_compute(cli_context(c), &flat, asdic_mission_environment(s->mission),
                                   &s->sonar, &s->pose, ping);
    }
    if (!status) {
        memcpy(s->reference_lin, ping->intensity_lin[ASDIC_TOTAL],
               s->beams * s->bins * sizeof(double));
    }
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

static asdic_status take_mean(cli *c, asdic_device *device, const bench_effort *effort,
                              bench_scene *s) {
    asdic_sampling sampling = *asdic_mission_sampling(s->mission);
    sampling.sampler = ASDIC_SAMPLER_ADAPTIVE;
    sampling.rays = effort->reference_rays;
    size_t cells = s->beams * s->bins;
    asdic_simulator *sim = NULL;
    asdic_ping *ping = NULL;
    double *squares = calloc(cells, sizeof *squares);
    s->spread_lin = calloc(cells, sizeof *s->spread_lin);
    asdic_status status = squares && s->spread_lin ? ASDIC_OK : ASDIC_ERROR_MEMORY;
    if (!status) {
        status = asdic_ping_create(cli_context(c), s->beams, s->bins, &ping);
    }
    if (!status) {
        status = asdic_simulator_create(cli_context(c), device, asdic_mission_scene(s->mission),
                                        asdic_mission_environment(s->mission), &s->sonar, &sampling,
                                        s->pose.position_m.z, &sim);
    }
    for (size_t k = 0; !status && k < effort->reference_pings; k++) {
        uint64_t index = REFERENCE_INDEX + k;
        if (asdic_context_interrupted(cli_context(c))) {
            status = ASDIC_ERROR_INTERRUPTED;
        } else if (k == 0) {
            status = asdic_simulator_learn(sim, &s->pose, index);
        }
        if (!status) {
            status = asdic_simulator_ping(sim, &s->pose, index, ping);
        }
        for (size_t i = 0; !status && i < cells; i++) {
            double e = ping->intensity_lin[ASDIC_TOTAL][i];
            s->reference_lin[i] += e;
            squares[i] += e * e;
        }
    }
    if (!status) {
        s->spread_db = finish_mean(s, squares, effort->reference_pings);
        s->reference_rays = (double)effort->reference_pings * effort->reference_rays;
    }
    free(squares);
    asdic_ping_destroy(&ping);
    asdic_simulator_destroy(&sim);
    return status;
}

asdic_status bench_scene_open(cli *c, asdic_device *device, const char *path,
                              const bench_effort *effort, bench_scene *out) {
    *out = (bench_scene){0};
    take_name(path, out->name, sizeof out->name);
    asdic_status status = asdic_mission_load(cli_context(c), path, &out->mission);
    if (status) {
        return status;
    }
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
    out->reference_lin = calloc(out->beams * out->bins, sizeof *out->reference_lin);
    if (!out->reference_lin) {
        return ASDIC_ERROR_MEMORY;
    }
    out->exact = is_flat(out->mission);
    return out->exact ? take_quadrature(c, out) : take_mean(c, device, effort, out);
}

void bench_scene_finish(bench_scene *scene) {
    asdic_mission_destroy(&scene->mission);
    free(scene->reference_lin);
    free(scene->spread_lin);
    scene->reference_lin = scene->spread_lin = NULL;
}
