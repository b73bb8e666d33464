/* `asdic bench loop`: how long a pose takes to become levels, and how many pings a second there
 * can be, with the loop of asdic/loop.h. */
#include "bench.h"

#include <math.h>
#include <time.h>

#define MOST_PINGS 320

const bench_column bench_loop_columns[] = {{"scene", "scene", 14, 0, 0.0},
                                           {"triangles", "triangles", 9, 0, 0.0},
                                           {"beams", "beams", 6, 0, 0.0},
                                           {"bins", "bins", 6, 0, 0.0},
                                           {"rays", "rays", 8, 0, 0.0},
                                           {"pings", NULL, 0, 0, 0.0},
                                           {"ping_rate_hz", NULL, 0, 0, 0.0},
                                           {"pings_per_s", "pings/s", 8, 1, 0.0},
                                           {"margin", "margin", 8, 2, 0.0},
                                           {"latency_median_s", "median ms", 9, 2, 1e3},
                                           {"latency_p99_s", "p99 ms", 8, 2, 1e3},
                                           {"latency_worst_s", "worst ms", 8, 2, 1e3},
                                           {"late", "late", 5, 0, 0.0},
                                           {"frames_per_s", "frames/s", 8, 1, 0.0},
                                           {NULL, NULL, 0, 0, 0.0}};

typedef struct figures {
    size_t pings;
    uint32_t rays;
    double rate_hz;                  /* of the scene */
    double pings_per_s;              /* one after the other, learning included */
    double median_s, p99_s, worst_s; /* latency at the scene's rate */
    double frames_per_s;             /* of a view, pings included; NAN: built without cairo */
    size_t late;                     /* pings whose latency exceeds 1 / rate */
} figures;

static void sleep_until(double at_s) {
    double left_s = at_s - cli_clock_s();
    if (left_s > 0.0) {
        double whole_s, part_s = modf(left_s, &whole_s);
        struct timespec pause = {(time_t)whole_s, (long)(1e9 * part_s)};
        nanosleep(&pause, NULL);
    }
}

/* COUNT pings along the mission, one every PERIOD_S (0: at once); their latencies. */
static asdic_status shoot(bench *b, asdic_loop *loop, const asdic_mission *mission, size_t count,
                          double period_s, double *latency_s) {
    double begin_s = cli_clock_s();
    for (size_t k = 0; k < count; k++) {
        asdic_pose pose =
            asdic_mission_vehicle_pose(mission, k % asdic_mission_ping_count(mission), NULL);
        asdic_loop_ping ping;
        sleep_until(begin_s + (double)k * period_s);
        TRY(asdic_loop_submit(loop, &pose));
        TRY(asdic_loop_collect(loop, &ping));
        TRY(bench_interrupted(b));
        latency_s[k] = ping.latency_s;
    }
    return ASDIC_OK;
}

static asdic_status measure(bench *b, asdic_loop *loop, const asdic_mission *mission, figures *f) {
    double latency_s[MOST_PINGS];
    /* A block to warm up: kernels are compiled, the form of the tracer is chosen. */
    TRY(shoot(b, loop, mission, ASDIC_LEARN_BLOCK, 0.0, latency_s));
    double begin_s = cli_clock_s();
    TRY(shoot(b, loop, mission, f->pings, 0.0, latency_s));
    f->pings_per_s = (double)f->pings / (cli_clock_s() - begin_s);
    TRY(shoot(b, loop, mission, f->pings, 1.0 / f->rate_hz, latency_s));
    f->median_s = bench_median(latency_s, f->pings); /* sorts */
    f->p99_s = latency_s[(size_t)ceil(0.99 * (double)f->pings) - 1];
    f->worst_s = latency_s[f->pings - 1];
    for (size_t k = 0; k < f->pings; k++) {
        f->late += latency_s[k] > 1.0 / f->rate_hz;
    }
    return ASDIC_OK;
}

static asdic_status steps(bench *b, asdic_view *view, size_t count) {
    asdic_status status = ASDIC_OK;
    for (size_t k = 0; !status && k < count; k++) {
        status = bench_interrupted(b) ? ASDIC_ERROR_INTERRUPTED : asdic_view_step(view);
    }
    return status;
}

/* A view at the speed that the machine gives; rays as asked for. */
static asdic_status look(bench *b, asdic_mission *mission, figures *f) {
    asdic_view_options options = asdic_view_options_default();
    asdic_view *view = NULL;
    options.real_time = true; /* expected curves in the background, as in a window */
    options.least_rays = f->rays;
    asdic_status status = asdic_view_create(cli_context(b->c), mission, b->device, &options, &view);
    f->frames_per_s = NAN;
    if (status == ASDIC_ERROR_UNSUPPORTED) {
        return ASDIC_OK;
    }
    status = status ? status : steps(b, view, ASDIC_LEARN_BLOCK);
    double begin_s = cli_clock_s();
    status = status ? status : steps(b, view, f->pings / 2);
    f->frames_per_s = (double)(f->pings / 2) / (cli_clock_s() - begin_s);
    asdic_view_destroy(&view);
    return status;
}

static asdic_status measure_scene(bench *b, const char *name, asdic_mission *mission) {
    const asdic_sonar *sonar = asdic_mission_sonar(mission);
    figures f = {.pings = b->quick ? ASDIC_LEARN_BLOCK : MOST_PINGS,
                 .rays = asdic_mission_sampling(mission)->rays,
                 .rate_hz = sonar->ping_rate_hz};
    double start_s, depth_m = asdic_mission_pose(mission, 0, &start_s).position_m.z;
    asdic_loop *loop = NULL;
    TRY(asdic_loop_create_mission(cli_context(b->c), b->device, mission, depth_m, start_s, &loop));
    size_t bins = asdic_loop_bin_count(loop);
    asdic_status status = measure(b, loop, mission, &f);
    asdic_loop_destroy(&loop);
    status = status ? status : look(b, mission, &f);
    if (!status) {
        asdic_scene_info info = asdic_scene_get_info(asdic_mission_scene(mission));
        const bench_cell cells[] = {BENCH_TEXT(name),
                                    BENCH_NUMBER(info.triangles),
                                    BENCH_NUMBER(sonar->receiver_count),
                                    BENCH_NUMBER(bins),
                                    BENCH_NUMBER(f.rays),
                                    BENCH_NUMBER(f.pings),
                                    BENCH_NUMBER(f.rate_hz),
                                    BENCH_NUMBER(f.pings_per_s),
                                    BENCH_NUMBER(f.pings_per_s / f.rate_hz),
                                    BENCH_NUMBER(f.median_s),
                                    BENCH_NUMBER(f.p99_s),
                                    BENCH_NUMBER(f.worst_s),
                                    BENCH_NUMBER(f.late),
                                    BENCH_NUMBER(f.frames_per_s)};
        bench_add(b, cells);
    }
    return status;
}

asdic_status bench_loop(bench *b) {
    return bench_missions(b, measure_scene);
}
