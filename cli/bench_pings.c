/* `asdic bench pings`: pings a second of scenes; else of the paper's case, six beams and 20,000
 * rays with one bounce, over sea floors of many sizes and for many numbers of bins. */
#include "bench_pings.h"

#include <math.h>

#define BEAMS 6
#define RAYS 20000
#define MOST_PINGS 192
/* After a million rays the simulator chooses how to cast them. */
#define WARM_UP_RAYS 1.1e6
#define MOST_WARM_UP_S 2.0
#define QUICK_WARM_UP_S 0.1

const size_t bench_floors[BENCH_FLOORS] = {10000, 100000, 1000000, 4000000};
const size_t bench_bin_counts[BENCH_BIN_COUNTS] = {150, 1000, 2048, 4000};

/* The phases follow, under their names. */
#define FIXED_COLUMNS 11
#define PHASE(name)                                                                                \
    { name "_s", name, 8, 2, 1e3 }
const bench_column bench_pings_columns[] = {{"scene", "scene", 14, 0, 0.0},
                                            {"triangles", "triangles", 9, 0, 0.0},
                                            {"beams", "beams", 5, 0, 0.0},
                                            {"bins", "bins", 5, 0, 0.0},
                                            {"rays", "rays", 6, 0, 0.0},
                                            {"units", "units", 5, 0, 0.0},
                                            {"pings_per_s", "pings/s", 8, 1, 0.0},
                                            {"mission_pings_per_s", "mission", 8, 1, 0.0},
                                            {"create_s", "create ms", 9, 1, 1e3},
                                            {"first_ping_s", "first ms", 8, 2, 1e3},
                                            {"build_s", "build s", 8, 3, 0.0},
                                            PHASE("sample"),
                                            PHASE("trace"),
                                            PHASE("shade"),
                                            PHASE("bounce"),
                                            PHASE("collect"),
                                            PHASE("reduce"),
                                            PHASE("levels"),
                                            {NULL, NULL, 0, 0, 0.0}};

_Static_assert(ASDIC_PHASE_COUNT == 7, "a column for each phase");

/* What a simulator is made of. */
typedef struct rig {
    const asdic_scene *scene;
    asdic_environment env;
    asdic_sonar sonar;
    asdic_sampling sampling;
    asdic_mission *mission; /* NULL: the vehicle flies level over the floor */
    asdic_beam receivers[BEAMS];
} rig;

static void rig_floor(const bench_case *of, rig *r) {
    r->scene = of->scene;
    r->env = asdic_environment_default();
    r->env.sound_speed_mps = 1490.0;
    r->sonar = asdic_sonar_default();
    r->sonar.bin_length_m = BENCH_RANGE_M / (double)of->bins;
    r->sonar.ping_rate_hz = 1490.0 / (2.0 * BENCH_RANGE_M);
    r->sonar.receivers = r->receivers;
    r->sonar.receiver_count = BEAMS;
    r->sampling = asdic_sampling_default();
    r->sampling.rays = of->rays ? of->rays : RAYS;
    r->sampling.multipath = ASDIC_MULTIPATH_BOUNDARIES;
    for (int i = 0; i < BEAMS; i++) {
        r->receivers[i] = r->sonar.transmitter;
        snprintf(r->receivers[i].name, sizeof r->receivers[i].name, "beam%d", i);
        r->receivers[i].yaw_rad = 0.15 * (i - 2.5);
        r->receivers[i].pitch_rad = 0.2;
    }
}

static void rig_mission(asdic_mission *mission, rig *r) {
    r->mission = mission;
    r->scene = asdic_mission_scene(mission);
    r->env = *asdic_mission_environment(mission);
    r->sonar = *asdic_mission_sonar(mission);
    r->sampling = *asdic_mission_sampling(mission);
}

/* Over a floor the vehicle moves on by half a metre from ping to ping. */
static asdic_pose pose_of(const rig *r, size_t ping) {
    return r->mission
               ? asdic_mission_pose(r->mission, ping % asdic_mission_ping_count(r->mission), NULL)
               : (asdic_pose){{-400.0 + 0.5 * (double)ping, 0.0, 100.0}, 0.0, 0.0, 0.0};
}

asdic_status bench_warm_up(const bench *b, asdic_simulator *sim, const asdic_pose *pose,
                           double rays, asdic_ping *ping) {
    double began = cli_clock_s(), most_s = b->quick ? QUICK_WARM_UP_S : MOST_WARM_UP_S;
    for (double cast = 0.0; cast < WARM_UP_RAYS && cli_clock_s() - began < most_s;) {
        TRY(bench_interrupted(b));
        TRY(asdic_simulator_ping(sim, pose, 0, ping));
        cast += rays;
    }
    return asdic_simulator_ping(sim, pose, 0, ping); /* which chooses */
}

static asdic_status shoot(const bench *b, const rig *r, size_t pings, asdic_simulator *sim,
                          asdic_ping *ping, bench_rate *rate) {
    double times[MOST_PINGS], began = cli_clock_s();
    asdic_pose pose = pose_of(r, 0);
    TRY(asdic_simulator_ping(sim, &pose, 0, ping));
    rate->first_s = cli_clock_s() - began;
    for (int k = 0; pings > 0 && k < 2; k++) { /* the first learning compiles for its sizes */
        began = cli_clock_s();
        TRY(asdic_simulator_learn(sim, &pose, 0));
        rate->learn_s = cli_clock_s() - began;
    }
    TRY(pings > 0 ? bench_warm_up(b, sim, &pose, r->sampling.rays, ping) : ASDIC_OK);
    for (size_t k = 0; k < pings; k++) {
        TRY(bench_interrupted(b));
        pose = pose_of(r, k);
        began = cli_clock_s();
        TRY(asdic_simulator_ping(sim, &pose, k, ping));
        times[k] = cli_clock_s() - began;
    }
    for (size_t k = 0; k < pings; k++) {
        double phase_s[ASDIC_PHASE_COUNT] = {0.0};
        pose = pose_of(r, k);
        TRY(asdic_simulator_profile(sim, &pose, k, ping, phase_s));
        for (int p = 0; p < ASDIC_PHASE_COUNT; p++) {
            rate->phase_s[p] += phase_s[p] / (double)pings;
            rate->least_s[p] = k > 0 ? fmin(rate->least_s[p], phase_s[p]) : phase_s[p];
        }
    }
    rate->ping_s = bench_median(times, pings);
    return ASDIC_OK;
}

asdic_status bench_pings_measure(const bench *b, asdic_device *device, const bench_case *of,
                                 bench_rate *out) {
    rig r = {.mission = NULL};
    asdic_simulator *sim = NULL;
    asdic_ping *ping = NULL;
    if (of->mission) {
        rig_mission(of->mission, &r);
    } else {
        rig_floor(of, &r);
    }
    asdic_scene_info info = asdic_scene_get_info(r.scene);
    double began = cli_clock_s();
    TRY(asdic_simulator_create(cli_context(b->c), device, r.scene, &r.env, &r.sonar, &r.sampling,
                               pose_of(&r, 0).position_m.z, &sim));
    *out = (bench_rate){.triangles = info.triangles,
                        .build_s = info.build_s,
                        .beams = r.sonar.receiver_count,
                        .bins = asdic_simulator_bin_count(sim),
                        .rays = r.sampling.rays,
                        .units = asdic_device_get_info(device)->compute_units,
                        .create_s = cli_clock_s() - began};
    asdic_status status = asdic_ping_create(cli_context(b->c), out->beams, out->bins, &ping);
    status = status ? status : shoot(b, &r, of->pings, sim, ping, out);
    asdic_ping_destroy(&ping);
    asdic_simulator_destroy(&sim);
    return status;
}

void bench_pings_add(bench *b, const char *scene, const bench_rate *r) {
    bench_cell cells[FIXED_COLUMNS + ASDIC_PHASE_COUNT] = {
        BENCH_TEXT(scene), BENCH_NUMBER(r->triangles), BENCH_NUMBER(r->beams),
        BENCH_NUMBER(r->bins), BENCH_NUMBER(r->rays), BENCH_NUMBER(r->units),
        BENCH_NUMBER(1.0 / r->ping_s),
        /* learning once a block */
        BENCH_NUMBER(1.0 / (r->ping_s + r->learn_s / ASDIC_LEARN_BLOCK)), BENCH_NUMBER(r->create_s),
        BENCH_NUMBER(r->first_s), BENCH_NUMBER(r->build_s)};
    for (int p = 0; p < ASDIC_PHASE_COUNT; p++) {
        cells[FIXED_COLUMNS + p] = BENCH_NUMBER(r->phase_s[p]);
    }
    bench_add(b, cells);
}

static asdic_status measure_mission(bench *b, const char *name, asdic_mission *mission) {
    const bench_case of = {.mission = mission, .pings = b->quick ? 8 : MOST_PINGS};
    bench_rate rate;
    TRY(bench_pings_measure(b, b->device, &of, &rate));
    bench_pings_add(b, name, &rate);
    return ASDIC_OK;
}

/* Time over triangles, a curve for each number of bins. RATES are of every size all numbers of
 * bins. */
static asdic_status draw(const bench *b, const bench_rate *rates, size_t count) {
    double triangles[BENCH_BIN_COUNTS][BENCH_FLOORS], time_ms[BENCH_BIN_COUNTS][BENCH_FLOORS];
    char labels[BENCH_BIN_COUNTS][32];
    asdic_series curves[BENCH_BIN_COUNTS] = {{0}};
    for (size_t i = 0; i < count; i++) {
        size_t c = i % BENCH_BIN_COUNTS, s = i / BENCH_BIN_COUNTS;
        triangles[c][s] = (double)rates[i].triangles;
        time_ms[c][s] = 1e3 * rates[i].ping_s;
        snprintf(labels[c], sizeof labels[c], "%zu bins", rates[i].bins);
        curves[c] =
            (asdic_series){.label = labels[c], .x = triangles[c], .y = time_ms[c], .count = s + 1};
    }
    return bench_scaling_picture(b, "Six beams, 20,000 rays, one bounce", "triangles", curves,
                                 BENCH_BIN_COUNTS);
}

asdic_status bench_pings(bench *b) {
    bench_rate rates[BENCH_FLOORS * BENCH_BIN_COUNTS];
    size_t count = (BENCH_FLOORS - (b->quick ? 2 : 0)) * BENCH_BIN_COUNTS;
    asdic_status status = ASDIC_OK;
    asdic_scene *scene = NULL;
    if (bench_scene_count(b) > 0) {
        return bench_missions(b, measure_mission);
    }
    for (size_t i = 0; !status && i < count; i++) {
        if (i % BENCH_BIN_COUNTS == 0) {
            asdic_scene_destroy(&scene);
            status =
                bench_terrain(cli_context(b->c), bench_floors[i / BENCH_BIN_COUNTS], 0, &scene);
        }
        bench_case of = {.scene = scene,
                         .bins = bench_bin_counts[i % BENCH_BIN_COUNTS],
                         .pings = b->quick ? 8 : MOST_PINGS};
        status = status ? status : bench_pings_measure(b, b->device, &of, &rates[i]);
        if (!status) {
            bench_pings_add(b, "floor", &rates[i]);
        }
    }
    asdic_scene_destroy(&scene);
    return status || !b->picture ? status : draw(b, rates, count);
}
