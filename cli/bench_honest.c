/* `asdic bench honest`: whether the error that every bin states holds. */
#include "bench_error.h"
#include "json.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define SEEDS 3
#define PINGS 8
/* Errors beyond so many stated ones should be rare. */
#define FAR 5.0

/* Errors of a seed's pings, over all bins that are counted. */
typedef struct seed_errors {
    double true_db, stated_db;       /* r.m.s. */
    double true_over_stated, beyond; /* r.m.s.; share of bins beyond FAR stated errors */
} seed_errors;

typedef struct honest_row {
    bench_scene scene;
    uint32_t rays;
    seed_errors seeds[SEEDS];
} honest_row;

typedef struct tally {
    double squares, stated, ratios, beyond, count;
} tally;

static void count_ping(const bench_scene *s, const asdic_ping *ping, tally *t) {
    const double to_db = 10.0 / log(10.0);
    for (size_t i = 0; i < s->beams * s->bins; i++) {
        double is = ping->intensity_lin[ASDIC_TOTAL][i], should = s->reference_lin[i];
        if (i % s->bins < s->first_bin || !(is > 0.0) || !(should > 0.0)) {
            continue;
        }
        double off_db = asdic_level_db(is) - asdic_level_db(should);
        double known_db = s->spread_lin ? to_db * s->spread_lin[i] / should : 0.0;
        double stated2 = (double)ping->stderr_db[i] * ping->stderr_db[i];
        double ratio2 = off_db * off_db / fmax(stated2 + known_db * known_db, 1e-12);
        t->squares += off_db * off_db;
        t->stated += stated2;
        t->ratios += ratio2;
        t->beyond += ratio2 > FAR * FAR;
        t->count += 1.0;
    }
}

/* A learnt block's first pings. */
static asdic_status measure_seed(cli *c, asdic_device *device, honest_row *row, size_t seed) {
    bench_scene *s = &row->scene;
    asdic_sampling sampling = *asdic_mission_sampling(s->mission);
    sampling.sampler = ASDIC_SAMPLER_ADAPTIVE;
    sampling.seed += seed;
    row->rays = sampling.rays;
    asdic_simulator *sim = NULL;
    asdic_ping *ping = NULL;
    tally t = {0};
    asdic_status status = asdic_ping_create(cli_context(c), s->beams, s->bins, &ping);
    if (!status) {
        status = asdic_simulator_create(cli_context(c), device, asdic_mission_scene(s->mission),
                                        asdic_mission_environment(s->mission), &s->sonar, &sampling,
                                        s->pose.position_m.z, &sim);
    }
    if (!status) {
        status = asdic_simulator_learn(sim, &s->pose, 0);
    }
    for (uint64_t k = 0; !status && k < PINGS; k++) {
        status = asdic_context_interrupted(cli_context(c))
                     ? ASDIC_ERROR_INTERRUPTED
                     : asdic_simulator_ping(sim, &s->pose, k, ping);
        if (!status) {
            count_ping(s, ping, &t);
        }
    }
    row->seeds[seed] = (seed_errors){sqrt(t.squares / t.count), sqrt(t.stated / t.count),
                                     sqrt(t.ratios / t.count), t.beyond / t.count};
    asdic_simulator_destroy(&sim);
    asdic_ping_destroy(&ping);
    return status;
}

static void print_row(const honest_row *r) {
    double squares = 0.0;
    printf("%-20.20s %5zu %5zu %8u ", r->scene.name, r->scene.beams, r->scene.bins, r->rays);
    for (size_t k = 0; k < SEEDS; k++) {
        printf(" %5.2f", r->seeds[k].true_over_stated);
        squares += r->seeds[k].true_over_stated * r->seeds[k].true_over_stated;
    }
    printf("  %5.2f ", sqrt(squares / SEEDS));
    for (size_t k = 0; k < SEEDS; k++) {
        printf(" %5.2f", 100.0 * r->seeds[k].beyond);
    }
    printf("  %8.4f %9.4f %8.4f\n", r->seeds[0].true_db, r->seeds[0].stated_db, r->scene.spread_db);
    fflush(stdout);
}

static void print_json(const honest_row *rows, size_t count, const asdic_device_info *device) {
    json j = json_begin(stdout);
    json_open(&j, NULL, '{');
    json_text(&j, "version", asdic_version());
    json_text(&j, "device", device->name);
    json_open(&j, "scenes", '[');
    for (size_t i = 0; i < count; i++) {
        json_open(&j, NULL, '{');
        json_text(&j, "scene", rows[i].scene.name);
        json_integer(&j, "beams", rows[i].scene.beams);
        json_integer(&j, "bins", rows[i].scene.bins);
        json_integer(&j, "rays", rows[i].rays);
        json_number(&j, "truth_stderr_db", rows[i].scene.spread_db);
        json_open(&j, "seeds", '[');
        for (size_t k = 0; k < SEEDS; k++) {
            json_open(&j, NULL, '{');
            json_number(&j, "true_db", rows[i].seeds[k].true_db);
            json_number(&j, "stated_db", rows[i].seeds[k].stated_db);
            json_number(&j, "true_over_stated", rows[i].seeds[k].true_over_stated);
            json_number(&j, "beyond", rows[i].seeds[k].beyond);
            json_close(&j);
        }
        json_close(&j);
        json_close(&j);
    }
    json_close(&j);
    json_close(&j);
}

static int write_csv(const cli *c, const char *path, const honest_row *rows, size_t count) {
    FILE *file = bench_begin_file(c, path);
    if (!file) {
        return CLI_FAILED;
    }
    fprintf(file, "scene,beams,bins,rays,seed,true_db,stated_db,true_over_stated,beyond,"
                  "truth_stderr_db\n");
    for (size_t i = 0; i < count; i++) {
        for (size_t k = 0; k < SEEDS; k++) {
            const seed_errors *e = &rows[i].seeds[k];
            fprintf(file, "%s,%zu,%zu,%u,%zu,%.6g,%.6g,%.6g,%.6g,%.6g\n", rows[i].scene.name,
                    rows[i].scene.beams, rows[i].scene.bins, rows[i].rays, k, e->true_db,
                    e->stated_db, e->true_over_stated, e->beyond, rows[i].scene.spread_db);
        }
    }
    return bench_end_file(c, file, path);
}

static asdic_status measure(cli *c, asdic_device *device, const bench_effort *effort,
                            const char *path, honest_row *row) {
    asdic_status status = bench_scene_open(c, device, path, effort, &row->scene);
    for (size_t seed = 0; !status && seed < SEEDS; seed++) {
        status = measure_seed(c, device, row, seed);
    }
    return status;
}

int bench_honest(cli *c, const bench_options *options) {
    size_t wanted = cli_operand_count(c) - 1, count = 0;
    if (wanted == 0) {
        return cli_usage(c, "'bench honest' wants scenes");
    }
    bench_effort effort = bench_effort_of(options);
    asdic_device **devices = NULL;
    size_t device_count = 0;
    honest_row *rows = calloc(wanted, sizeof *rows);
    asdic_status status = rows ? cli_open_devices(c, &devices, &device_count) : ASDIC_ERROR_MEMORY;
    if (!status && !options->json) {
        printf("%-20s %5s %5s %8s  %17s  %5s  %17s  %8s %9s %8s\n", "scene", "beams", "bins",
               "rays", "true/stated", "all", "beyond 5, %", "true dB", "stated dB", "truth dB");
    }
    for (; !status && count < wanted; count++) {
        status = measure(c, devices[0], &effort, cli_operand(c, count + 1), &rows[count]);
        if (!status && !options->json) {
            print_row(&rows[count]);
        }
    }
    int code = cli_end(c, status);
    if (options->json && !status) {
        print_json(rows, count, asdic_device_get_info(devices[0]));
    }
    if (options->csv && !status) {
        code = write_csv(c, options->csv, rows, count);
    }
    for (size_t i = 0; i < count; i++) {
        bench_scene_finish(&rows[i].scene);
    }
    free(rows);
    asdic_devices_close(&devices, device_count);
    return code;
}
