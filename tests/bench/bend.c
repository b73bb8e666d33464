/* What bent rays cost: pings in water of one speed, in one layer and in eight, one after the other in turn. */
#include "bench_pings.h"
#include "kinds.h"

#include <math.h>

#define TRIANGLES 1000000
#define QUICK_TRIANGLES 100000
#define RAYS 20000
#define BEAMS 6
#define BINS 1000
#define MOST_ROUNDS 96
#define LAYERS 8

#define PHASE(name)                                                                                \
    { name "_s", name, 8, 2, 1e3 }
const bench_column bend_columns[] = {{"triangles", "triangles", 9, 0, 0.0},
                                     {"water", "water", 10, 0, 0.0},
                                     {"ping_s", "ms/ping", 8, 2, 1e3},
                                     {"straight", "straight", 8, 2, 0.0},
                                     {"processor_s", "processor", 9, 2, 1e3},
                                     {"processor_straight", "straight", 8, 2, 0.0},
                                     PHASE("sample"),
                                     PHASE("trace"),
                                     PHASE("shade"),
                                     PHASE("reduce"),
                                     {NULL, NULL, 0, 0, 0.0}};

/* 30 m/s less from FROM_M to TO_M, in so many layers of different gradients. The sonar lies at 100 m, the floor
 * between 175 and 225 m. */
static const struct {
    const char *name;
    size_t layers;
    double from_m, to_m;
} waters[] = {{"straight", 0, 0.0, 0.0},
              {"one layer", 1, 0.0, 400.0},
              {"above", LAYERS, 20.0, 160.0}, /* layers without triangles */
              {"across", LAYERS, 100.0, 240.0},
              {"among", LAYERS, 175.0, 225.0}}; /* all layers within the height of the floor */
enum { WATERS = sizeof waters / sizeof *waters };

typedef struct side {
    asdic_beam receivers[BEAMS];
    asdic_simulator *sim;
    asdic_ping *ping;
    double times_s[MOST_ROUNDS], processor_s[MOST_ROUNDS], phase_s[ASDIC_PHASE_COUNT];
} side;

static asdic_environment water_of(size_t w) {
    asdic_environment env = asdic_environment_default();
    env.sound_speed_mps = 1490.0;
    if (waters[w].layers == 1) {
        env.sound_speed_mps = 1505.0;
        env.sound_speed_gradient_per_s = -30.0 / (waters[w].to_m - waters[w].from_m);
    } else if (waters[w].layers > 1) {
        asdic_sound_profile *p = &env.sound_speed_profile;
        env.sound_speed_mps = NAN;
        p->points = waters[w].layers + 1;
        for (size_t i = 0; i < p->points; i++) {
            double x = (double)i / (double)waters[w].layers;
            p->depth_m[i] = waters[w].from_m + x * (waters[w].to_m - waters[w].from_m);
            p->sound_speed_mps[i] = 1490.0 + 15.0 * cos(CLI_PI * x);
        }
    }
    return env;
}

static asdic_pose pose_of(size_t ping) {
    return (asdic_pose){{-400.0 + 0.5 * (double)ping, 0.0, BENCH_ALTITUDE_M}, 0.0, 0.0, 0.0};
}

static asdic_status open_side(const bench *b, const asdic_scene *scene, size_t w, side *s) {
    asdic_environment env = water_of(w);
    asdic_sonar sonar = asdic_sonar_default();
    asdic_sampling sampling = asdic_sampling_default();
    sonar.bin_length_m = BENCH_RANGE_M / BINS;
    sonar.ping_rate_hz = 1490.0 / (2.0 * BENCH_RANGE_M);
    sonar.receivers = s->receivers;
    sonar.receiver_count = BEAMS;
    sampling.rays = RAYS;
    sampling.multipath = ASDIC_MULTIPATH_OFF;
    for (int i = 0; i < BEAMS; i++) {
        s->receivers[i] = sonar.transmitter;
        s->receivers[i].yaw_rad = 0.15 * (i - 2.5);
        s->receivers[i].pitch_rad = 0.2;
    }
    TRY(asdic_simulator_create(cli_context(b->c), b->device, scene, &env, &sonar, &sampling,
                               BENCH_ALTITUDE_M, &s->sim));
    TRY(asdic_ping_create(cli_context(b->c), BEAMS, asdic_simulator_bin_count(s->sim), &s->ping));
    asdic_pose pose = pose_of(0);
    TRY(asdic_simulator_ping(s->sim, &pose, 0, s->ping)); /* compiles */
    TRY(asdic_simulator_learn(s->sim, &pose, 0));
    return bench_warm_up(b, s->sim, &pose, RAYS, s->ping);
}

static asdic_status take_turns(const bench *b, side *sides, size_t rounds) {
    for (size_t k = 0; k < rounds; k++) {
        asdic_pose pose = pose_of(k);
        TRY(bench_interrupted(b));
        for (size_t w = 0; w < WATERS; w++) {
            double began = cli_clock_s(), busy = cli_processor_s();
            TRY(asdic_simulator_ping(sides[w].sim, &pose, k, sides[w].ping));
            sides[w].times_s[k] = cli_clock_s() - began;
            sides[w].processor_s[k] = cli_processor_s() - busy;
        }
    }
    for (size_t k = 0; k < rounds; k++) {
        asdic_pose pose = pose_of(k);
        for (size_t w = 0; w < WATERS; w++) {
            TRY(asdic_simulator_profile(sides[w].sim, &pose, k, sides[w].ping, sides[w].phase_s));
        }
    }
    return ASDIC_OK;
}

static asdic_status measure(bench *b, const asdic_scene *scene, side *sides) {
    size_t rounds = b->quick ? 8 : MOST_ROUNDS;
    double straight_s = 0.0, busy_s = 0.0;
    for (size_t w = 0; w < WATERS; w++) {
        TRY(open_side(b, scene, w, &sides[w]));
    }
    TRY(take_turns(b, sides, rounds));
    for (size_t w = 0; w < WATERS; w++) {
        double ping_s = bench_median(sides[w].times_s, rounds), n = (double)rounds;
        const double *phase_s = sides[w].phase_s;
        double processor_s = bench_median(sides[w].processor_s, rounds);
        straight_s = w == 0 ? ping_s : straight_s;
        busy_s = w == 0 ? processor_s : busy_s;
        const bench_cell cells[] = {BENCH_NUMBER(asdic_scene_get_info(scene).triangles),
                                    BENCH_TEXT(waters[w].name),
                                    BENCH_NUMBER(ping_s),
                                    BENCH_NUMBER(ping_s / straight_s),
                                    BENCH_NUMBER(processor_s),
                                    BENCH_NUMBER(processor_s / busy_s),
                                    BENCH_NUMBER(phase_s[ASDIC_PHASE_SAMPLE] / n),
                                    BENCH_NUMBER(phase_s[ASDIC_PHASE_TRACE] / n),
                                    BENCH_NUMBER(phase_s[ASDIC_PHASE_SHADE] / n),
                                    BENCH_NUMBER(phase_s[ASDIC_PHASE_REDUCE] / n)};
        bench_add(b, cells);
    }
    return ASDIC_OK;
}

asdic_status bend(bench *b) {
    asdic_scene *scene = NULL;
    side sides[WATERS] = {0};
    asdic_status status =
        bench_terrain(cli_context(b->c), b->quick ? QUICK_TRIANGLES : TRIANGLES, 0, &scene);
    status = status ? status : measure(b, scene, sides);
    for (size_t w = 0; w < WATERS; w++) {
        asdic_ping_destroy(&sides[w].ping);
        asdic_simulator_destroy(&sides[w].sim);
    }
    asdic_scene_destroy(&scene);
    return status;
}
