/*
 * One ping at a time for somebody else's simulator of vehicles: the sea floor comes from memory,
 * every pose from the caller, levels go back as they are made. Prints the range of the bottom's
 * strongest echo, then how long a ping took from pose to levels.
 *
 *     cc loop.c -o loop $(pkg-config --cflags --libs asdic) -lm
 *     ./loop 200
 */
#define _POSIX_C_SOURCE 199309L /* clock_gettime */
#include <asdic/asdic.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { SIDE = 128 }; /* vertices along a side of the sea floor */

static double now_s(void) {
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* A sea floor about 20 m deep with ripples, 256 m square: z down, as everywhere. */
static asdic_status make_floor(asdic_context *ctx, asdic_mesh **mesh) {
    static double xyz[SIDE * SIDE][3];
    static uint32_t corners[2 * (SIDE - 1) * (SIDE - 1)][3];
    size_t n = 0;
    for (uint32_t i = 0; i < SIDE * SIDE; i++) {
        xyz[i][0] = 2.0 * (i / SIDE) - SIDE;
        xyz[i][1] = 2.0 * (i % SIDE) - SIDE;
        xyz[i][2] = 20 + sin(xyz[i][0] / 9) * cos(xyz[i][1] / 7);
        if (i / SIDE == SIDE - 1 || i % SIDE == SIDE - 1)
            continue;
        uint32_t a = i, b = i + SIDE, c = i + 1, d = i + SIDE + 1;
        const uint32_t two[2][3] = {{a, c, b}, {b, c, d}};
        memcpy(corners[n], two, sizeof two);
        n += 2;
    }
    return asdic_mesh_from_triangles(ctx, xyz[0], SIDE * SIDE, corners[0], n, mesh);
}

static double strongest_m(const asdic_ping *ping) {
    size_t best = 0;
    for (size_t bin = 1; bin < ping->bins; bin++)
        if (ping->intensity_lin[ASDIC_BOTTOM][bin] > ping->intensity_lin[ASDIC_BOTTOM][best])
            best = bin;
    return ((double)best + 0.5) * ping->bin_length_m;
}

static int by_value(const void *a, const void *b) {
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* The caller's loop: a vehicle that swims north at 1.5 m/s, pinged ten times a second. */
static asdic_status swim(asdic_simulator *sim, asdic_ping *ping, double *latency_s, size_t pings) {
    for (size_t i = 0; i < pings; i++) {
        asdic_pose pose = {.position_m = {.x = -60 + 0.15 * (double)i, .z = 12}};
        double start_s = now_s();
        asdic_status status = ASDIC_OK;
        if (asdic_simulator_learn_is_due(sim, &pose, i))
            status = asdic_simulator_learn(sim, &pose, i);
        if (!status)
            status = asdic_simulator_ping(sim, &pose, i, ping);
        if (status)
            return status;
        latency_s[i] = now_s() - start_s;
        if (i % 10 == 0)
            printf("ping %zu: bottom's strongest echo at %.2f m\n", i, strongest_m(ping));
    }
    return ASDIC_OK;
}

int main(int argc, char **argv) {
    size_t pings = argc > 1 ? strtoul(argv[1], NULL, 10) : 200, count = 0;
    asdic_context *ctx = NULL;
    asdic_device **devices = NULL;
    asdic_mesh *mesh = NULL;
    asdic_scene *scene = NULL;
    asdic_simulator *sim = NULL;
    asdic_ping *ping = NULL;
    asdic_environment water = asdic_environment_default();
    asdic_sampling sampling = asdic_sampling_default();
    asdic_beam beams[] = {
        {.name = "ahead", .length_h_m = 0.05, .length_v_m = 0.05},
        {.name = "down", .pitch_rad = 0.5, .length_h_m = 0.05, .length_v_m = 0.05}};
    asdic_sonar sonar = asdic_sonar_default();
    sonar.source_level_db = 200;
    sonar.receivers = beams;
    sonar.receiver_count = 2;
    double *latency_s = (double *)calloc(pings + 1, sizeof *latency_s);

    asdic_status s = latency_s ? asdic_context_create(&ctx) : ASDIC_ERROR_MEMORY;
    if (!s)
        s = asdic_devices_open(ctx, "auto", &devices, &count);
    if (!s)
        s = make_floor(ctx, &mesh);
    if (!s)
        s = asdic_scene_create(ctx, &scene);
    if (!s)
        s = asdic_scene_add_bottom(scene, mesh, (asdic_pose){0}, asdic_material_bottom(2));
    if (!s)
        s = asdic_scene_commit(scene);
    if (!s)
        s = asdic_simulator_create(ctx, devices[0], scene, &water, &sonar, &sampling, 12, &sim);
    if (!s)
        s = asdic_ping_create(ctx, 2, asdic_simulator_bin_count(sim), &ping);
    if (!s)
        s = swim(sim, ping, latency_s, pings);
    if (s)
        fprintf(stderr, "loop: %s\n", asdic_context_error(ctx));
    if (!s && pings) {
        printf("first ping %.1f ms", 1e3 * latency_s[0]);
        qsort(latency_s, pings, sizeof *latency_s, by_value);
        printf(", median %.1f ms, 99th percentile %.1f ms of %zu\n", 1e3 * latency_s[pings / 2],
               1e3 * latency_s[pings * 99 / 100], pings);
    }
    free(latency_s);
    asdic_ping_destroy(&ping);
    asdic_simulator_destroy(&sim);
    asdic_scene_destroy(&scene);
    asdic_mesh_destroy(&mesh);
    asdic_devices_close(&devices, count);
    asdic_context_destroy(&ctx);
    return s;
}
