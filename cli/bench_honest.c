/* `asdic bench honest`: whether the error that every bin states holds. */
#include "bench_error.h"

#include <math.h>

#define SEEDS 3
#define PINGS 8
/* Errors beyond so many stated ones should be rare. */
#define FAR 5.0

const bench_column bench_honest_columns[] = {{"scene", "scene", 20, 0, 0.0},
                                             {"beams", "beams", 5, 0, 0.0},
                                             {"bins", "bins", 5, 0, 0.0},
                                             {"rays", "rays", 8, 0, 0.0},
                                             {"seed", "seed", 5, 0, 0.0},
                                             {"true_over_stated", "true/stated", 11, 2, 0.0},
                                             {"true_over_stated_all", "all", 6, 2, 0.0},
                                             {"true_over_stated_objects", "objects", 7, 2, 0.0},
                                             {"beyond", "beyond 5, %", 11, 2, 100.0},
                                             {"true_db", "true dB", 9, 4, 0.0},
                                             {"stated_db", "stated dB", 9, 4, 0.0},
                                             {"truth_stderr_db", "truth dB", 9, 4, 0.0},
                                             {NULL, NULL, 0, 0, 0.0}};

/* Sums over the bins that are counted of a seed's pings; of these, over the bins that objects rule. */
typedef struct tally {
    double squares, stated, ratios, beyond, count;
    double object_ratios, object_count;
} tally;

/* Whether more than half of what cell I of PING holds came off an object. */
static bool is_objects(const asdic_ping *ping, size_t i) {
    return ping->intensity_lin[ASDIC_OBJECT][i] + ping->intensity_lin[ASDIC_MULTIPATH][i] >
           0.5 * ping->intensity_lin[ASDIC_TOTAL][i];
}

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
        if (is_objects(ping, i)) {
            t->object_ratios += ratio2;
            t->object_count += 1.0;
        }
    }
}

static asdic_status shoot(bench *b, const bench_scene *s, asdic_simulator *sim, asdic_ping *ping,
                          tally *t) {
    TRY(asdic_simulator_learn(sim, &s->pose, 0));
    for (uint64_t k = 0; k < PINGS; k++) {
        TRY(bench_interrupted(b));
        TRY(asdic_simulator_ping(sim, &s->pose, k, ping));
        count_ping(s, ping, t);
    }
    return ASDIC_OK;
}

static asdic_status measure_seed(bench *b, const bench_scene *s, uint64_t seed, tally *t) {
    asdic_sampling sampling = *asdic_mission_sampling(s->mission);
    asdic_simulator *sim = NULL;
    asdic_ping *ping = NULL;
    sampling.sampler = ASDIC_SAMPLER_ADAPTIVE;
    sampling.seed += seed;
    asdic_status status = bench_scene_simulator(b, s, &sampling, &sim, &ping);
    status = status ? status : shoot(b, s, sim, ping, t);
    asdic_simulator_destroy(&sim);
    asdic_ping_destroy(&ping);
    return status;
}

static void add_rows(bench *b, const bench_scene *s, const tally *tallies) {
    double squares = 0.0, object_squares = 0.0, objects = 0.0;
    for (size_t k = 0; k < SEEDS; k++) {
        squares += tallies[k].ratios / tallies[k].count;
        object_squares += tallies[k].object_ratios;
        objects += tallies[k].object_count;
    }
    for (size_t k = 0; k < SEEDS; k++) {
        const tally *t = &tallies[k];
        const bench_cell cells[] = {BENCH_TEXT(s->name),
                                    BENCH_NUMBER(s->beams),
                                    BENCH_NUMBER(s->bins),
                                    BENCH_NUMBER(asdic_mission_sampling(s->mission)->rays),
                                    BENCH_NUMBER(k),
                                    BENCH_NUMBER(sqrt(t->ratios / t->count)),
                                    BENCH_NUMBER(sqrt(squares / SEEDS)),
                                    BENCH_NUMBER(sqrt(object_squares / objects)),
                                    BENCH_NUMBER(t->beyond / t->count),
                                    BENCH_NUMBER(sqrt(t->squares / t->count)),
                                    BENCH_NUMBER(sqrt(t->stated / t->count)),
                                    BENCH_NUMBER(s->spread_db)};
        bench_add(b, cells);
    }
}

asdic_status bench_honest(bench *b) {
    bench_effort effort = bench_effort_of(b->quick);
    asdic_status status = ASDIC_OK;
    for (size_t i = 0; !status && i < bench_scene_count(b); i++) {
        tally tallies[SEEDS] = {{0}};
        bench_scene scene;
        status = bench_scene_open(b, i, &effort, &scene);
        for (size_t seed = 0; !status && seed < SEEDS; seed++) {
            status = measure_seed(b, &scene, seed, &tallies[seed]);
        }
        if (!status) {
            add_rows(b, &scene, tallies);
        }
        bench_scene_finish(&scene);
    }
    return status;
}
