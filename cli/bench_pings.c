/* `asdic bench pings`: the paper's case, six beams and 20,000 rays with one bounce, over sea floors
 * of many sizes and for many numbers of bins. */
#include "bench_pings.h"
#include "json.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define BEAMS 6
#define RAYS 20000
#define MOST_PINGS 192
#define SIZES 4
#define BIN_COUNTS 4

static const size_t sizes[SIZES] = {10000, 100000, 1000000, 4000000};
static const size_t bin_counts[BIN_COUNTS] = {150, 1000, 2048, 4000};

static asdic_sonar make_sonar(size_t bins, asdic_beam *receivers) {
    asdic_sonar sonar = asdic_sonar_default();
    sonar.bin_length_m = BENCH_RANGE_M / (double)bins;
    sonar.ping_rate_hz = 1490.0 / (2.0 * BENCH_RANGE_M);
    for (int b = 0; b < BEAMS; b++) {
        receivers[b] = sonar.transmitter;
        snprintf(receivers[b].name, sizeof receivers[b].name, "beam%d", b);
        receivers[b].yaw_rad = 0.15 * (b - 2.5);
        receivers[b].pitch_rad = 0.2;
    }
    sonar.receivers = receivers;
    sonar.receiver_count = BEAMS;
    return sonar;
}

/* The vehicle moves on by half a metre from ping to ping. */
static asdic_pose pose_of(size_t ping) {
    return (asdic_pose){{-400.0 + 0.5 * (double)ping, 0.0, 100.0}, 0.0, 0.0, 0.0};
}

static asdic_status shoot(cli *c, asdic_simulator *sim, asdic_ping *ping, bench_rate *rate) {
    double times[MOST_PINGS], learns[2], began = bench_now_s();
    asdic_pose pose = pose_of(0);
    asdic_status status = asdic_simulator_ping(sim, &pose, 0, ping);
    rate->first_s = bench_now_s() - began;
    if (rate->pings == 0) {
        return status;
    }
    for (int k = 0; !status && k < 2; k++) { /* the first learning compiles for its sizes */
        began = bench_now_s();
        status = asdic_simulator_learn(sim, &pose, 0);
        learns[k] = bench_now_s() - began;
    }
    for (size_t k = 0; !status && k < rate->pings; k++) {
        if (asdic_context_interrupted(cli_context(c))) {
            return ASDIC_ERROR_INTERRUPTED;
        }
        pose = pose_of(k);
        began = bench_now_s();
        status = asdic_simulator_ping(sim, &pose, k, ping);
        times[k] = bench_now_s() - began;
    }
    for (size_t k = 0; !status && k < rate->pings; k++) {
        pose = pose_of(k);
        status = asdic_simulator_profile(sim, &pose, k, ping, rate->phase_s);
    }
    for (int p = 0; p < ASDIC_PHASE_COUNT; p++) {
        rate->phase_s[p] /= (double)rate->pings;
    }
    if (!status) {
        rate->learn_s = learns[1];
        rate->ping_s = bench_median(times, rate->pings);
    }
    return status;
}

static asdic_status measure(cli *c, asdic_device *device, const asdic_scene *scene, size_t bins,
                            bench_rate *rate) {
    asdic_beam receivers[BEAMS];
    asdic_sonar sonar = make_sonar(bins, receivers);
    asdic_environment env = asdic_environment_default();
    asdic_sampling sampling = asdic_sampling_default();
    sampling.rays = RAYS;
    sampling.multipath = ASDIC_MULTIPATH_BOUNDARIES;
    env.sound_speed_mps = 1490.0;
    asdic_simulator *sim = NULL;
    asdic_ping *ping = NULL;
    double began = bench_now_s();
    asdic_status status = asdic_simulator_create(cli_context(c), device, scene, &env, &sonar,
                                                 &sampling, pose_of(0).position_m.z, &sim);
    rate->create_s = bench_now_s() - began;
    if (!status) {
        rate->units = asdic_device_get_info(device)->compute_units;
        rate->bins = asdic_simulator_bin_count(sim);
        rate->triangles = asdic_scene_get_info(scene).triangles;
        rate->build_s = asdic_scene_get_info(scene).build_s;
        status = asdic_ping_create(cli_context(c), BEAMS, rate->bins, &ping);
    }
    if (!status) {
        status = shoot(c, sim, ping, rate);
    }
    asdic_ping_destroy(&ping);
    asdic_simulator_destroy(&sim);
    return status;
}

/* Pings per second of a mission: with learning once a block. */
static double mission_rate(const bench_rate *r) {
    return 1.0 / (r->ping_s + r->learn_s / ASDIC_LEARN_BLOCK);
}

static const char *thread_limit(void) {
    const char *limit = getenv("POCL_MAX_PTHREAD_COUNT");
    return limit && limit[0] ? limit : "none";
}

static void print_head(const asdic_device_info *device) {
    printf("%s, %u units, POCL_MAX_PTHREAD_COUNT %s: %d beams, %d rays, one bounce\n", device->name,
           device->compute_units, thread_limit(), BEAMS, RAYS);
    printf("%9s %5s %5s %8s %8s %9s %8s %8s  ", "triangles", "bins", "units", "pings/s", "mission",
           "create ms", "first ms", "build s");
    for (int p = 0; p < ASDIC_PHASE_COUNT; p++) {
        printf(" %7s", asdic_phase_name((asdic_phase)p));
    }
    printf("  ms\n");
}

static void print_rate(const bench_rate *r) {
    printf("%9zu %5zu %5u %8.1f %8.1f %9.1f %8.2f %8.3f  ", r->triangles, r->bins, r->units,
           1.0 / r->ping_s, mission_rate(r), 1e3 * r->create_s, 1e3 * r->first_s, r->build_s);
    for (int p = 0; p < ASDIC_PHASE_COUNT; p++) {
        printf(" %7.2f", 1e3 * r->phase_s[p]);
    }
    printf("\n");
}

static void print_pair(const bench_pair *pair) {
    if (pair->one.pings > 0) {
        print_rate(&pair->one);
    }
    print_rate(&pair->whole);
    fflush(stdout);
}

static void print_start(const bench_start *start) {
    printf("The first rows' 'create' and 'first' have kernels to compile, or to fetch from PoCL's "
           "cache.\n"
           "start of a process to its first ping: %.2f s with kernels to compile, %.2f s again\n",
           start->cold_s, start->warm_s);
}

/* How the time of a ping grows with triangles and bins, and falls with compute units. */
static void print_growth(const bench_pair *pairs, size_t count) {
    const bench_rate *least = &pairs[0].whole, *most = &pairs[count - 1].whole;
    const bench_rate *bins = &pairs[BIN_COUNTS - 1].whole;
    double gains[SIZES * BIN_COUNTS];
    for (size_t i = 0; i < count; i++) {
        gains[i] = pairs[i].one.ping_s / pairs[i].whole.ping_s;
    }
    if (count > BIN_COUNTS) {
        printf("%.0f times the triangles: %.2f times the time; %.0f times the bins: %.2f times\n",
               (double)most->triangles / (double)least->triangles,
               pairs[count - BIN_COUNTS].whole.ping_s / least->ping_s,
               (double)bins->bins / (double)least->bins, bins->ping_s / least->ping_s);
    }
    if (pairs[0].one.pings > 0) {
        printf("%u units are %.2f times as fast as one (median of the rows)\n", least->units,
               bench_median(gains, count));
    }
}

static void print_json_rate(json *j, const bench_rate *r) {
    json_open(j, NULL, '{');
    json_integer(j, "triangles", r->triangles);
    json_integer(j, "bins", r->bins);
    json_integer(j, "units", r->units);
    json_number(j, "pings_per_s", 1.0 / r->ping_s);
    json_number(j, "mission_pings_per_s", mission_rate(r));
    json_number(j, "create_s", r->create_s);
    json_number(j, "first_ping_s", r->first_s);
    json_number(j, "build_s", r->build_s);
    json_open(j, "phase_s", '{');
    for (int p = 0; p < ASDIC_PHASE_COUNT; p++) {
        json_number(j, asdic_phase_name((asdic_phase)p), r->phase_s[p]);
    }
    json_close(j);
    json_close(j);
}

static void print_json(const bench_pair *pairs, size_t count, const bench_start *start,
                       const asdic_device_info *device) {
    json j = json_begin(stdout);
    json_open(&j, NULL, '{');
    json_text(&j, "version", asdic_version());
    json_text(&j, "device", device->name);
    json_integer(&j, "compute_units", device->compute_units);
    json_text(&j, "pocl_max_pthread_count", thread_limit());
    json_integer(&j, "rays", RAYS);
    json_integer(&j, "beams", BEAMS);
    json_number(&j, "cold_start_s", start->cold_s);
    json_number(&j, "warm_start_s", start->warm_s);
    json_open(&j, "rows", '[');
    for (size_t i = 0; i < count; i++) {
        if (pairs[i].one.pings > 0) {
            print_json_rate(&j, &pairs[i].one);
        }
        print_json_rate(&j, &pairs[i].whole);
    }
    json_close(&j);
    json_close(&j);
}

static void print_csv_rate(FILE *file, const bench_rate *r) {
    fprintf(file, "\n%zu,%zu,%u,%.6g,%.6g,%.6g,%.6g,%.6g", r->triangles, r->bins, r->units,
            1.0 / r->ping_s, mission_rate(r), r->create_s, r->first_s, r->build_s);
    for (int p = 0; p < ASDIC_PHASE_COUNT; p++) {
        fprintf(file, ",%.6g", r->phase_s[p]);
    }
}

static int write_csv(const cli *c, const char *path, const bench_pair *pairs, size_t count) {
    FILE *file = bench_begin_file(c, path);
    if (!file) {
        return CLI_FAILED;
    }
    fprintf(file,
            "triangles,bins,units,pings_per_s,mission_pings_per_s,create_s,first_ping_s,build_s");
    for (int p = 0; p < ASDIC_PHASE_COUNT; p++) {
        fprintf(file, ",%s_s", asdic_phase_name((asdic_phase)p));
    }
    for (size_t i = 0; i < count; i++) {
        if (pairs[i].one.pings > 0) {
            print_csv_rate(file, &pairs[i].one);
        }
        print_csv_rate(file, &pairs[i].whole);
    }
    fprintf(file, "\n");
    return bench_end_file(c, file, path);
}

/* Time over triangles, a curve for each number of bins. */
static asdic_status draw(const cli *c, const char *path, const bench_pair *pairs, size_t count) {
    double triangles[BIN_COUNTS][SIZES], time_ms[BIN_COUNTS][SIZES];
    char labels[BIN_COUNTS][32];
    asdic_series curves[BIN_COUNTS] = {{0}};
    for (size_t i = 0; i < count; i++) { /* sizes, and for each all numbers of bins */
        const bench_rate *r = &pairs[i].whole;
        size_t b = i % BIN_COUNTS, s = i / BIN_COUNTS;
        triangles[b][s] = (double)r->triangles;
        time_ms[b][s] = 1e3 * r->ping_s;
        snprintf(labels[b], sizeof labels[b], "%zu bins", r->bins);
        curves[b] =
            (asdic_series){.label = labels[b], .x = triangles[b], .y = time_ms[b], .count = s + 1};
    }
    return bench_scaling_picture(c, path, "Six beams, 20,000 rays, one bounce", "triangles", curves,
                                 BIN_COUNTS);
}

/* UNIT: NULL, or one of the device's. */
static asdic_status measure_all(cli *c, asdic_device *device, asdic_device *unit,
                                const bench_options *options, bench_pair *pairs, size_t *count) {
    asdic_status status = ASDIC_OK;
    for (size_t s = 0; !status && s < SIZES - (options->quick ? 2 : 0); s++) {
        asdic_scene *scene = NULL;
        status = bench_terrain(cli_context(c), sizes[s], 0, &scene);
        for (size_t b = 0; !status && b < BIN_COUNTS; b++) {
            bench_pair *pair = &pairs[*count];
            size_t pings = options->quick ? 8 : MOST_PINGS;
            *pair = (bench_pair){.whole = {.pings = pings}, .one = {.pings = unit ? pings : 0}};
            status = measure(c, device, scene, bin_counts[b], &pair->whole);
            if (!status && unit) {
                status = measure(c, unit, scene, bin_counts[b], &pair->one);
            }
            if (!status && !options->json) {
                print_pair(pair);
            }
            *count += !status;
        }
        asdic_scene_destroy(&scene);
    }
    return status;
}

/* One ping and no more, for bench_start_measure. */
static asdic_status first_ping(cli *c, asdic_device *device) {
    asdic_scene *scene = NULL;
    bench_rate rate = {.pings = 0};
    asdic_status status = bench_terrain(cli_context(c), sizes[0], 0, &scene);
    status = status ? status : measure(c, device, scene, bin_counts[1], &rate);
    asdic_scene_destroy(&scene);
    return status;
}

int bench_pings(cli *c, const bench_options *options) {
    bench_pair pairs[SIZES * BIN_COUNTS];
    asdic_device **devices = NULL, **units = NULL;
    size_t device_count = 0, count = 0;
    if (cli_operand_count(c) > 1) {
        return cli_usage(c, "'bench pings' makes its own scenes");
    }
    bench_limit_threads(options, 0);
    bench_start start = {NAN, NAN};
    if (!options->first) {
        start = bench_start_measure(c);
    }
    asdic_status status = cli_open_devices(c, &devices, &device_count);
    if (status) {
        return cli_end(c, status);
    }
    if (options->first) {
        status = first_ping(c, devices[0]);
        asdic_devices_close(&devices, device_count);
        return cli_end(c, status);
    }
    const asdic_device_info *device = asdic_device_get_info(devices[0]);
    if (!options->json) {
        print_head(device);
    }
    if (device->compute_units > 1) { /* a device that cannot be split is measured whole alone */
        asdic_device_split(devices[0], device->compute_units, &units);
    }
    status = measure_all(c, devices[0], units ? units[0] : NULL, options, pairs, &count);
    if (!options->json && !status) {
        print_growth(pairs, count);
        print_start(&start);
    }
    int code = cli_end(c, status);
    if (options->json && !status) {
        print_json(pairs, count, &start, device);
    }
    if (options->csv && !status) {
        code = write_csv(c, options->csv, pairs, count);
    }
    if (options->picture && code == CLI_OK) {
        code = cli_end(c, draw(c, options->picture, pairs, count));
    }
    asdic_devices_close(&units, device->compute_units);
    asdic_devices_close(&devices, device_count);
    return code;
}
