/* `asdic bench loop`: how long a pose takes to become levels, and how many pings a second there
 * can be, with the loop of asdic/loop.h. */
#include "bench_loop.h"
#include "json.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#define MOST_PINGS 320

typedef struct loop_figures {
    char scene[ASDIC_NAME_SIZE];
    size_t beams, bins, triangles, pings;
    uint32_t rays;
    double rate_hz;                  /* of the scene */
    double pings_per_s;              /* one after the other, learning included */
    double median_s, p99_s, worst_s; /* latency at the scene's rate */
    double frames_per_s;             /* of a view, pings included; NAN: built without cairo */
    size_t late;                     /* pings whose latency exceeds 1 / rate */
} loop_figures;

static int compare(const void *a, const void *b) {
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static void sleep_until(double at_s) {
    double left_s = at_s - bench_now_s();
    if (left_s > 0.0) {
        struct timespec pause = {(time_t)left_s, (long)(1e9 * (left_s - floor(left_s)))};
        nanosleep(&pause, NULL);
    }
}

/* COUNT pings along the mission, one every PERIOD_S (0: at once); their latencies. */
static asdic_status shoot(cli *c, asdic_loop *loop, const asdic_mission *mission, size_t count,
                          double period_s, double *latency_s) {
    double begin_s = bench_now_s();
    asdic_status status = ASDIC_OK;
    for (size_t k = 0; !status && k < count; k++) {
        asdic_pose pose = asdic_mission_pose(mission, k % asdic_mission_ping_count(mission), NULL);
        asdic_loop_ping ping;
        sleep_until(begin_s + (double)k * period_s);
        status = asdic_loop_submit(loop, &pose);
        if (!status) {
            status = asdic_loop_collect(loop, &ping);
        }
        if (!status) {
            latency_s[k] = ping.latency_s;
        }
        if (asdic_context_interrupted(cli_context(c))) {
            return ASDIC_ERROR_INTERRUPTED;
        }
    }
    return status;
}

static asdic_status measure(cli *c, asdic_loop *loop, const asdic_mission *mission,
                            loop_figures *f) {
    double latency_s[MOST_PINGS];
    /* A block to warm up: kernels are compiled, the form of the tracer is chosen. */
    asdic_status status = shoot(c, loop, mission, ASDIC_LEARN_BLOCK, 0.0, latency_s);
    double begin_s = bench_now_s();
    if (!status) {
        status = shoot(c, loop, mission, f->pings, 0.0, latency_s);
    }
    f->pings_per_s = (double)f->pings / (bench_now_s() - begin_s);
    if (!status) {
        status = shoot(c, loop, mission, f->pings, 1.0 / f->rate_hz, latency_s);
    }
    if (status) {
        return status;
    }
    qsort(latency_s, f->pings, sizeof *latency_s, compare);
    f->median_s = 0.5 * (latency_s[(f->pings - 1) / 2] + latency_s[f->pings / 2]);
    f->p99_s = latency_s[(size_t)ceil(0.99 * (double)f->pings) - 1];
    f->worst_s = latency_s[f->pings - 1];
    for (size_t k = 0; k < f->pings; k++) {
        f->late += latency_s[k] > 1.0 / f->rate_hz;
    }
    return ASDIC_OK;
}

/* A view at the speed that the machine gives; rays as asked for. */
static asdic_status look(cli *c, asdic_device *device, asdic_mission *mission, loop_figures *f) {
    asdic_view_options options = asdic_view_options_default();
    asdic_view *view = NULL;
    double begin_s = 0.0;
    options.real_time = true; /* expected curves in the background, as in a window */
    options.least_rays = f->rays;
    asdic_status status = asdic_view_create(cli_context(c), mission, device, &options, &view);
    f->frames_per_s = NAN;
    if (status == ASDIC_ERROR_UNSUPPORTED) {
        return ASDIC_OK;
    }
    for (size_t k = 0; !status && k < ASDIC_LEARN_BLOCK + f->pings / 2; k++) {
        begin_s = k == ASDIC_LEARN_BLOCK ? bench_now_s() : begin_s;
        status = asdic_context_interrupted(cli_context(c)) ? ASDIC_ERROR_INTERRUPTED
                                                           : asdic_view_step(view);
    }
    f->frames_per_s = (double)(f->pings / 2) / (bench_now_s() - begin_s);
    asdic_view_destroy(&view);
    return status;
}

static void name_scene(const char *path, char *out, size_t size) {
    const char *slash = strrchr(path, '/'), *base = slash ? slash + 1 : path;
    const char *dot = strrchr(base, '.');
    snprintf(out, size, "%.*s", (int)(dot && dot != base ? dot - base : (long)strlen(base)), base);
}

static asdic_status measure_scene(cli *c, asdic_device *device, const char *path, loop_figures *f) {
    asdic_mission *mission = NULL;
    asdic_loop *loop = NULL;
    asdic_status status = asdic_mission_load(cli_context(c), path, &mission);
    if (!status) {
        const asdic_sonar *sonar = asdic_mission_sonar(mission);
        double start_s, depth_m = asdic_mission_pose(mission, 0, &start_s).position_m.z;
        status =
            asdic_loop_create_mission(cli_context(c), device, mission, depth_m, start_s, &loop);
        name_scene(path, f->scene, sizeof f->scene);
        f->beams = sonar->receiver_count;
        f->rate_hz = sonar->ping_rate_hz;
        f->rays = asdic_mission_sampling(mission)->rays;
        f->triangles = asdic_scene_get_info(asdic_mission_scene(mission)).triangles;
    }
    if (!status) {
        f->bins = asdic_loop_bin_count(loop);
        status = measure(c, loop, mission, f);
    }
    asdic_loop_destroy(&loop);
    if (!status) {
        status = look(c, device, mission, f);
    }
    asdic_mission_destroy(&mission);
    return status;
}

static void print_row(const loop_figures *f) {
    printf("%-12s %9zu %6zu %6zu %8u %8.1f %7.2fx %9.2f %8.2f %8.2f %5zu %8.1f\n", f->scene,
           f->triangles, f->beams, f->bins, f->rays, f->pings_per_s, f->pings_per_s / f->rate_hz,
           1e3 * f->median_s, 1e3 * f->p99_s, 1e3 * f->worst_s, f->late, f->frames_per_s);
    fflush(stdout);
}

static void print_json(const loop_figures *figures, size_t count, const char *device) {
    json j = json_begin(stdout);
    json_open(&j, NULL, '{');
    json_text(&j, "version", asdic_version());
    json_text(&j, "device", device);
    json_open(&j, "rows", '[');
    for (size_t i = 0; i < count; i++) {
        const loop_figures *f = &figures[i];
        json_open(&j, NULL, '{');
        json_text(&j, "scene", f->scene);
        json_integer(&j, "triangles", f->triangles);
        json_integer(&j, "beams", f->beams);
        json_integer(&j, "bins", f->bins);
        json_integer(&j, "rays", f->rays);
        json_integer(&j, "pings", f->pings);
        json_number(&j, "ping_rate_hz", f->rate_hz);
        json_number(&j, "pings_per_s", f->pings_per_s);
        json_number(&j, "latency_median_s", f->median_s);
        json_number(&j, "latency_p99_s", f->p99_s);
        json_number(&j, "latency_worst_s", f->worst_s);
        json_integer(&j, "late", f->late);
        json_number(&j, "frames_per_s", f->frames_per_s);
        json_close(&j);
    }
    json_close(&j);
    json_close(&j);
}

static int write_csv(const cli *c, const char *path, const loop_figures *figures, size_t count) {
    FILE *file = bench_begin_file(c, path);
    if (!file) {
        return CLI_FAILED;
    }
    fprintf(file, "scene,triangles,beams,bins,rays,pings,ping_rate_hz,pings_per_s,"
                  "latency_median_s,latency_p99_s,latency_worst_s,late,frames_per_s\n");
    for (size_t i = 0; i < count; i++) {
        const loop_figures *f = &figures[i];
        fprintf(file, "%s,%zu,%zu,%zu,%u,%zu,%.9g,%.6g,%.6g,%.6g,%.6g,%zu,%.6g\n", f->scene,
                f->triangles, f->beams, f->bins, f->rays, f->pings, f->rate_hz, f->pings_per_s,
                f->median_s, f->p99_s, f->worst_s, f->late, f->frames_per_s);
    }
    return bench_end_file(c, file, path);
}

int bench_loop(cli *c, const bench_options *options) {
    asdic_device **devices = NULL;
    size_t device_count = 0, given = cli_operand_count(c) - 1;
    size_t count = given ? given : BENCH_LOOP_SCENES;
    bench_folder folder = {.path = ""};
    loop_figures *figures = NULL;
    int code = CLI_OK;
    if (options->picture) {
        return cli_usage(c, "'bench loop' draws nothing");
    }
    asdic_status status = cli_open_devices(c, &devices, &device_count);
    if (status) {
        return cli_end(c, status);
    }
    figures = calloc(count, sizeof *figures);
    if (!figures || (!given && !bench_folder_make(c, &folder))) {
        code = CLI_FAILED;
        goto done;
    }
    if (!options->json) {
        printf("%s: latency at the scene's ping rate, learning every %d pings included\n",
               asdic_device_get_info(devices[0])->name, ASDIC_LEARN_BLOCK);
        printf("%-12s %9s %6s %6s %8s %8s %8s %9s %8s %8s %5s %8s\n", "scene", "triangles", "beams",
               "bins", "rays", "pings/s", "margin", "median ms", "p99 ms", "worst ms", "late",
               "frames/s");
    }
    for (size_t i = 0; !status && i < count; i++) {
        figures[i].pings = options->quick ? ASDIC_LEARN_BLOCK : MOST_PINGS;
        status = measure_scene(c, devices[0], given ? cli_operand(c, i + 1) : folder.scenes[i],
                               &figures[i]);
        if (!status && !options->json) {
            print_row(&figures[i]);
        }
    }
    code = cli_end(c, status);
    if (!status && options->json) {
        print_json(figures, count, asdic_device_get_info(devices[0])->name);
    }
    if (!status && options->csv) {
        code = write_csv(c, options->csv, figures, count);
    }
done:
    bench_folder_remove(&folder);
    free(figures);
    asdic_devices_close(&devices, device_count);
    return code;
}
