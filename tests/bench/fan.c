/* What many beams of the same rays cost and how exact each is; and the published case to beat, 512
 * beams of 114 rays each, 60 m of range, over a rough floor of triangles: Project DAVE, 1.7 s a
 * ping with phase on a CUDA card. It has cells of 25 mm; the last row has bins of 0.1 m. */
#include "bench_pings.h"
#include "kinds.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define ROWS 9
#define MOST_PINGS 48
#define MOST_SAMPLED 12
#define ERROR_PINGS 8
/* Bins nearer than this are left out of errors, as in bench error. */
#define NEAREST_M 2.0

const bench_column fan_columns[] = {{"scene", "scene", 13, 0, 0.0},
                                    {"beams", "beams", 5, 0, 0.0},
                                    {"bins", "bins", 6, 0, 0.0},
                                    {"rays", "rays", 6, 0, 0.0},
                                    {"ping_s", "ms/ping", 8, 2, 1e3},
                                    {"learn_s", "learn ms", 8, 1, 1e3},
                                    {"ping_with_learning_s", "in all ms", 10, 2, 1e3},
                                    {"least_ping_s", "least ms", 9, 2, 1e3},
                                    {"times_first", "x first", 8, 2, 0.0},
                                    {"rms_db", "RMS dB", 7, 3, 0.0},
                                    {"max_db", "max dB", 7, 2, 0.0},
                                    {NULL, NULL, 0, 0, 0.0}};

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
static asdic_status expect(bench *b, const asdic_mission *mission, const asdic_sonar *sonar,
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
    return asdic_expected_compute(cli_context(b->c), &flat, asdic_mission_environment(mission),
                                  &few, &pose, truth);
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

static asdic_status measure_error(bench *b, const asdic_mission *mission, const asdic_sonar *sonar,
                                  asdic_simulator *sim, asdic_ping *ping, fan_row *row) {
    size_t sampled[MOST_SAMPLED], count = row->beams < MOST_SAMPLED ? row->beams : MOST_SAMPLED;
    tally t = {0};
    asdic_pose pose = asdic_mission_pose(mission, 0, NULL);
    asdic_ping *truth = NULL;
    for (size_t k = 0; k < count; k++) {
        sampled[k] = count > 1 ? k * (row->beams - 1) / (count - 1) : 0;
    }
    asdic_status status = asdic_ping_create(cli_context(b->c), count, row->bins, &truth);
    if (!status) {
        status = expect(b, mission, sonar, sampled, count, truth);
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

static asdic_status shoot(bench *b, const asdic_mission *mission, asdic_simulator *sim,
                          asdic_ping *ping, size_t pings, fan_row *row) {
    double times[MOST_PINGS], learns[2];
    asdic_pose pose = asdic_mission_pose(mission, 0, NULL);
    asdic_status status = asdic_simulator_ping(sim, &pose, 0, ping);
    for (int k = 0; !status && k < 2; k++) { /* the first compiles for its sizes */
        double began = cli_clock_s();
        status = asdic_simulator_learn(sim, &pose, 0);
        learns[k] = cli_clock_s() - began;
    }
    if (!status) {
        status = bench_warm_up(b, sim, &pose, row->rays, ping);
    }
    for (size_t k = 0; !status && k < pings; k++) {
        double began = cli_clock_s();
        status = bench_interrupted(b) ? ASDIC_ERROR_INTERRUPTED
                                      : asdic_simulator_ping(sim, &pose, k, ping);
        times[k] = cli_clock_s() - began;
    }
    if (!status) {
        row->ping_s = bench_median(times, pings); /* sorts */
        row->least_s = times[0];
        row->learn_s = learns[1];
        row->per_ping_s = row->ping_s + row->learn_s / ASDIC_LEARN_BLOCK;
    }
    return status;
}

static asdic_status measure(bench *b, const char *path, size_t pings, fan_row *row) {
    asdic_mission *mission = NULL;
    asdic_simulator *sim = NULL;
    asdic_ping *ping = NULL;
    asdic_beam *beams = NULL;
    asdic_status status = asdic_mission_load(cli_context(b->c), path, &mission);
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
    status =
        beams ? asdic_simulator_create(cli_context(b->c), b->device, asdic_mission_scene(mission),
                                       asdic_mission_environment(mission), &sonar, &sampling,
                                       asdic_mission_pose(mission, 0, NULL).position_m.z, &sim)
              : ASDIC_ERROR_MEMORY;
    if (!status) {
        row->bins = asdic_simulator_bin_count(sim);
        status = asdic_ping_create(cli_context(b->c), row->beams, row->bins, &ping);
    }
    if (!status) {
        status = shoot(b, mission, sim, ping, pings, row);
    }
    if (!status && flat) {
        status = measure_error(b, mission, &sonar, sim, ping, row);
    }
    asdic_ping_destroy(&ping);
    asdic_simulator_destroy(&sim);
    free(beams);
    asdic_mission_destroy(&mission);
    return status;
}

static void add_row(bench *b, const fan_row *r, double few_s) {
    const bench_cell cells[] = {
        BENCH_TEXT(r->scene),        BENCH_NUMBER(r->beams),   BENCH_NUMBER(r->bins),
        BENCH_NUMBER(r->rays),       BENCH_NUMBER(r->ping_s),  BENCH_NUMBER(r->learn_s),
        BENCH_NUMBER(r->per_ping_s), BENCH_NUMBER(r->least_s), BENCH_NUMBER(r->least_s / few_s),
        BENCH_NUMBER(r->rms_db),     BENCH_NUMBER(r->most_db)};
    bench_add(b, cells);
}

/* Time over beams, of the flat scene. */
static asdic_status draw(const bench *b, const fan_row *rows, size_t count) {
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
    return bench_scaling_picture(b, "20,000 rays shared by many beams", "beams", curves, 2);
}

asdic_status fan(bench *b) {
    fan_row rows[ROWS];
    for (size_t i = 0; i < ROWS; i++) {
        char name[64], path[4096];
        rows[i] = rows_wanted[i];
        snprintf(name, sizeof name, "scenes/%s.yaml", rows[i].scene);
        bench_find_data(name, path, sizeof path); /* loading it tells what is missing */
        TRY(measure(b, path, b->quick ? 8 : MOST_PINGS, &rows[i]));
        add_row(b, &rows[i], rows[0].least_s);
    }
    return b->picture ? draw(b, rows, ROWS) : ASDIC_OK;
}
