/* `asdic bench fan`: what many beams cost and how exact each is; and the published case to beat. */
#include "bench.h"
#include "json.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define ROWS 9
#define MOST_PINGS 48
#define MOST_SAMPLED 12
#define ERROR_PINGS 8
/* Bins nearer than this are left out of errors, as in bench error. */
#define NEAREST_M 2.0

typedef struct fan_row {
    const char *scene; /* in data/scenes */
    size_t beams;
    double bin_length_m; /* 0: the scene's */
    size_t bins;
    uint32_t rays;                      /* 0: the scene's */
    double ping_s, learn_s, per_ping_s; /* the last with its share of learning */
    double least_s;                     /* of a ping: what others on the machine leave alone */
    double rms_db, most_db;             /* of beams sampled; NAN where there is no quadrature */
} fan_row;

/* Six receivers get rays aimed at each; from nine on all share rays spread over the sector, from
 * sixteen on the map, too. */
static const fan_row rows_wanted[ROWS] = {
    {.scene = "bench_fan", .beams = 6},
    {.scene = "bench_fan", .beams = 9},
    {.scene = "bench_fan", .beams = 64},
    {.scene = "bench_fan", .beams = 256},
    {.scene = "bench_fan", .beams = 512},
    {.scene = "bench_fan", .beams = 1024},
    {.scene = "bench_fan", .beams = 512, .rays = 25000},
    {.scene = "bench_anchor", .beams = 512},
    {.scene = "bench_anchor", .beams = 512, .bin_length_m = 0.1},
};

/* The scene's fan with another number of beams over the same sector. */
static asdic_beam *spread_beams(const asdic_sonar *sonar, size_t beams) {
    asdic_beam *out = calloc(beams, sizeof *out);
    const asdic_beam *first = &sonar->receivers[0];
    const asdic_beam *last = &sonar->receivers[sonar->receiver_count - 1];
    for (size_t b = 0; out && b < beams; b++) {
        double t = beams > 1 ? (double)b / (double)(beams - 1) : 0.5;
        out[b] = *first;
        out[b].yaw_rad = first->yaw_rad + t * (last->yaw_rad - first->yaw_rad);
    }
    return out;
}

/* What sampled beams should hold, by quadrature. */
static asdic_status expect(cli *c, const asdic_mission *mission, const asdic_sonar *sonar,
                           const size_t *sampled, size_t count, asdic_ping *truth) {
    asdic_beam picked[MOST_SAMPLED];
    asdic_sonar few = *sonar;
    asdic_pose pose = asdic_mission_pose(mission, 0, NULL);
    asdic_flat_scene flat = asdic_mission_flat_scene(mission, 0);
    for (size_t k = 0; k < count; k++) {
        picked[k] = sonar->receivers[sampled[k]];
    }
    few.receivers = picked;
    few.receiver_count = count;
    return asdic_expected_compute(cli_context(c), &flat, asdic_mission_environment(mission), &few,
                                  &pose, truth);
}

typedef struct tally {
    double squares, count, most_db;
} tally;

static void compare(const asdic_ping *ping, const asdic_ping *truth, const size_t *sampled,
                    size_t count, tally *t) {
    size_t first = (size_t)ceil(NEAREST_M / ping->bin_length_m);
    for (size_t k = 0; k < count; k++) {
        for (size_t n = first; n < ping->bins; n++) {
            double is = ping->intensity_lin[ASDIC_TOTAL][sampled[k] * ping->bins + n];
            double should = truth->intensity_lin[ASDIC_TOTAL][k * ping->bins + n];
            if (should > 0.0) {
                double off_db = fmax(asdic_level_db(is) - asdic_level_db(should), -100.0);
                t->squares += off_db * off_db;
                t->count += 1.0;
                t->most_db = fmax(t->most_db, fabs(off_db));
            }
        }
    }
}

static asdic_status measure_error(cli *c, const asdic_mission *mission, const asdic_sonar *sonar,
                                  asdic_simulator *sim, asdic_ping *ping, fan_row *row) {
    size_t sampled[MOST_SAMPLED], count = row->beams < MOST_SAMPLED ? row->beams : MOST_SAMPLED;
    tally t = {0};
    asdic_pose pose = asdic_mission_pose(mission, 0, NULL);
    asdic_ping *truth = NULL;
    for (size_t k = 0; k < count; k++) {
        sampled[k] = count > 1 ? k * (row->beams - 1) / (count - 1) : 0;
    }
    asdic_status status = asdic_ping_create(cli_context(c), count, row->bins, &truth);
    if (!status) {
        status = expect(c, mission, sonar, sampled, count, truth);
    }
    for (uint64_t k = 0; !status && k < ERROR_PINGS; k++) {
        status = asdic_simulator_ping(sim, &pose, k, ping);
        if (!status) {
            compare(ping, truth, sampled, count, &t);
        }
    }
    asdic_ping_destroy(&truth);
    row->rms_db = sqrt(t.squares / t.count);
    row->most_db = t.most_db;
    return status;
}

static asdic_status shoot(cli *c, const asdic_mission *mission, asdic_simulator *sim,
                          asdic_ping *ping, size_t pings, fan_row *row) {
    double times[MOST_PINGS], learns[2];
    asdic_pose pose = asdic_mission_pose(mission, 0, NULL);
    asdic_status status = asdic_simulator_ping(sim, &pose, 0, ping);
    for (int k = 0; !status && k < 2; k++) { /* the first compiles for its sizes */
        double began = bench_now_s();
        status = asdic_simulator_learn(sim, &pose, 0);
        learns[k] = bench_now_s() - began;
    }
    for (size_t k = 0; !status && k < pings; k++) {
        double began = bench_now_s();
        status = asdic_context_interrupted(cli_context(c))
                     ? ASDIC_ERROR_INTERRUPTED
                     : asdic_simulator_ping(sim, &pose, k, ping);
        times[k] = bench_now_s() - began;
    }
    if (!status) {
        row->ping_s = bench_median(times, pings); /* sorts */
        row->least_s = times[0];
        row->learn_s = learns[1];
        row->per_ping_s = row->ping_s + row->learn_s / ASDIC_LEARN_BLOCK;
    }
    return status;
}

static asdic_status measure(cli *c, asdic_device *device, const char *path, size_t pings,
                            fan_row *row) {
    asdic_mission *mission = NULL;
    asdic_simulator *sim = NULL;
    asdic_ping *ping = NULL;
    asdic_beam *beams = NULL;
    asdic_status status = asdic_mission_load(cli_context(c), path, &mission);
    if (status) {
        return status;
    }
    asdic_sonar sonar = *asdic_mission_sonar(mission);
    asdic_sampling sampling = *asdic_mission_sampling(mission);
    bool flat = asdic_scene_get_info(asdic_mission_scene(mission)).triangles == 0;
    beams = spread_beams(&sonar, row->beams);
    sonar.receivers = beams;
    sonar.receiver_count = row->beams;
    sonar.bin_length_m = row->bin_length_m > 0.0 ? row->bin_length_m : sonar.bin_length_m;
    sampling.rays = row->rays ? row->rays : sampling.rays;
    row->rays = sampling.rays;
    row->bin_length_m = sonar.bin_length_m;
    row->rms_db = row->most_db = NAN;
    status = beams ? asdic_simulator_create(cli_context(c), device, asdic_mission_scene(mission),
                                            asdic_mission_environment(mission), &sonar, &sampling,
                                            asdic_mission_pose(mission, 0, NULL).position_m.z, &sim)
                   : ASDIC_ERROR_MEMORY;
    if (!status) {
        row->bins = asdic_simulator_bin_count(sim);
        status = asdic_ping_create(cli_context(c), row->beams, row->bins, &ping);
    }
    if (!status) {
        status = shoot(c, mission, sim, ping, pings, row);
    }
    if (!status && flat) {
        status = measure_error(c, mission, &sonar, sim, ping, row);
    }
    asdic_ping_destroy(&ping);
    asdic_simulator_destroy(&sim);
    free(beams);
    asdic_mission_destroy(&mission);
    return status;
}

static void print_row(const fan_row *r, double few_s) {
    printf("%-13s %5zu %6zu %6u  %8.2f %8.1f %10.2f %9.2f", r->scene, r->beams, r->bins, r->rays,
           1e3 * r->ping_s, 1e3 * r->learn_s, 1e3 * r->per_ping_s, 1e3 * r->least_s);
    if (isfinite(r->rms_db)) {
        printf(" %8.2f  %7.3f %7.2f", r->least_s / few_s, r->rms_db, r->most_db);
    }
    printf("\n");
    fflush(stdout);
}

static void print_json(const fan_row *rows, size_t count, const asdic_device_info *device) {
    json j = json_begin(stdout);
    json_open(&j, NULL, '{');
    json_text(&j, "version", asdic_version());
    json_text(&j, "device", device->name);
    json_integer(&j, "compute_units", device->compute_units);
    json_open(&j, "rows", '[');
    for (size_t i = 0; i < count; i++) {
        json_open(&j, NULL, '{');
        json_text(&j, "scene", rows[i].scene);
        json_integer(&j, "beams", rows[i].beams);
        json_integer(&j, "bins", rows[i].bins);
        json_integer(&j, "rays", rows[i].rays);
        json_number(&j, "ping_s", rows[i].ping_s);
        json_number(&j, "learn_s", rows[i].learn_s);
        json_number(&j, "ping_with_learning_s", rows[i].per_ping_s);
        json_number(&j, "least_ping_s", rows[i].least_s);
        json_number(&j, "rms_db", rows[i].rms_db);
        json_number(&j, "max_db", rows[i].most_db);
        json_close(&j);
    }
    json_close(&j);
    json_close(&j);
}

static int write_csv(const cli *c, const char *path, const fan_row *rows, size_t count) {
    FILE *file = bench_begin_file(c, path);
    if (!file) {
        return CLI_FAILED;
    }
    fprintf(
        file,
        "scene,beams,bins,rays,ping_s,learn_s,ping_with_learning_s,least_ping_s,rms_db,max_db\n");
    for (size_t i = 0; i < count; i++) {
        const fan_row *r = &rows[i];
        fprintf(file, "%s,%zu,%zu,%u,%.6g,%.6g,%.6g,%.6g,", r->scene, r->beams, r->bins, r->rays,
                r->ping_s, r->learn_s, r->per_ping_s, r->least_s);
        if (isfinite(r->rms_db)) {
            fprintf(file, "%.6g,%.6g\n", r->rms_db, r->most_db);
        } else {
            fprintf(file, ",\n");
        }
    }
    return bench_end_file(c, file, path);
}

/* Time over beams, of the flat scene. */
static asdic_status draw(const cli *c, const char *path, const fan_row *rows, size_t count) {
    double beams[ROWS], time_ms[ROWS], learning_ms[ROWS];
    size_t n = 0;
    for (; n < count && strcmp(rows[n].scene, rows[0].scene) == 0 && rows[n].rays == rows[0].rays;
         n++) {
        beams[n] = (double)rows[n].beams;
        time_ms[n] = 1e3 * rows[n].ping_s;
        learning_ms[n] = 1e3 * rows[n].per_ping_s;
    }
    asdic_series curves[] = {{.label = "a ping", .x = beams, .y = time_ms, .count = n},
                             {.label = "with its share of learning",
                              .x = beams,
                              .y = learning_ms,
                              .count = n,
                              .style = ASDIC_LINE_DASHED}};
    return bench_scaling_picture(c, path, "20,000 rays shared by many beams", "beams", curves, 2);
}

static asdic_status measure_all(cli *c, asdic_device *device, const bench_options *options,
                                fan_row *rows, size_t *count) {
    size_t pings = options->quick ? 8 : MOST_PINGS;
    asdic_status status = ASDIC_OK;
    for (size_t i = 0; !status && i < ROWS; i++) {
        char name[64], path[4096];
        rows[i] = rows_wanted[i];
        snprintf(name, sizeof name, "scenes/%s.yaml", rows[i].scene);
        bench_find_data(name, path, sizeof path); /* loading it tells what is missing */
        status = measure(c, device, path, pings, &rows[i]);
        if (!status && !options->json) {
            print_row(&rows[i], rows[0].least_s);
        }
        *count += !status;
    }
    return status;
}

int bench_fan(cli *c, const bench_options *options) {
    fan_row rows[ROWS];
    asdic_device **devices = NULL;
    size_t device_count = 0, count = 0;
    if (cli_operand_count(c) > 1) {
        return cli_usage(c, "'bench fan' has its own scenes");
    }
    asdic_status status = cli_open_devices(c, &devices, &device_count);
    if (status) {
        return cli_end(c, status);
    }
    const asdic_device_info *device = asdic_device_get_info(devices[0]);
    if (!options->json) {
        printf("%s, %u units\n%-13s %5s %6s %6s  %8s %8s %10s %9s %8s  %7s %7s\n", device->name,
               device->compute_units, "scene", "beams", "bins", "rays", "ms/ping", "learn ms",
               "in all ms", "least ms", "x first", "RMS dB", "max dB");
    }
    status = measure_all(c, devices[0], options, rows, &count);
    int code = cli_end(c, status);
    if (options->json && !status) {
        print_json(rows, count, device);
    }
    if (options->csv && !status) {
        code = write_csv(c, options->csv, rows, count);
    }
    if (options->picture && code == CLI_OK) {
        code = cli_end(c, draw(c, options->picture, rows, count));
    }
    asdic_devices_close(&devices, device_count);
    return code;
}
