/* `asdic bench loop` of six beams, and of 256, over a million triangles of half a metre; --quick: of 2 m, 62,658. */
#include "bench_pings.h"
#include "kinds.h"

#include <stdlib.h>
#include <unistd.h>

#define SIDE_M 354
#define CELL_M 0.5 /* 2 x 708 x 708 triangles */
#define QUICK_CELL_M 2.0
#define HEAD                                                                                       \
    "version: 1\n"                                                                                 \
    "environment: {sound_speed_mps: 1490}\n"                                                       \
    "bottom: {grid: {file: floor.asc, values: depths}, type: sand}\n"
#define MISSION                                                                                    \
    "mission:\n"                                                                                   \
    "  waypoints: {points_m: [[80, 177, 25], [270, 177, 25]], speed_mps: 2}\n"

#define FILES 3
static const char *const files[FILES] = {"floor.asc", "six.yaml", "fan256.yaml"};

static const char six[] = HEAD MISSION
    "sampling: {rays: 20000, multipath: boundaries}\n"
    "sonar:\n"
    "  {frequency_khz: 100, bandwidth_khz: 10, ping_rate_hz: 10, source_level_db: 200,\n"
    "   bin_length_m: 0.25, transmitter: {length_h_m: 0.02, length_v_m: 0.05},\n"
    "   receivers: [{name: port_3, yaw_deg: -25, pitch_deg: 10}, {name: port_2, yaw_deg: -15,\n"
    "     pitch_deg: 10}, {name: port_1, yaw_deg: -5, pitch_deg: 10}, {name: stbd_1, yaw_deg: 5,\n"
    "     pitch_deg: 10}, {name: stbd_2, yaw_deg: 15, pitch_deg: 10}, {name: stbd_3,\n"
    "     yaw_deg: 25, pitch_deg: 10}]}\n";

static const char fan256[] = HEAD MISSION
    "sampling: {rays: 20000}\n"
    "sonar:\n"
    "  {frequency_khz: 300, bandwidth_khz: 30, ping_rate_hz: 10, source_level_db: 200,\n"
    "   bin_length_m: 0.25, transmitter: {length_h_m: 0.0025, length_v_m: 0.0125},\n"
    "   receivers: {fan: {count: 256, sector_deg: 120, length_h_m: 0.15, length_v_m: 0.0125}}}\n";

static bool write_floor(FILE *file, double cell_m) {
    int cells = (int)(SIDE_M / cell_m);
    fprintf(file, "ncols %d\nnrows %d\nxllcorner 0\nyllcorner 0\ncellsize %g\n", cells + 1,
            cells + 1, cell_m);
    for (int row = 0; row <= cells; row++) {
        for (int column = 0; column <= cells; column++) {
            double x = cell_m * (cells - row), y = cell_m * column;
            fprintf(file, "%.3f ", 38.0 - 0.4 * bench_height_m(x, y));
        }
        fputc('\n', file);
    }
    return !ferror(file);
}

static bool write_file(const char *path, const char *text, double cell_m) {
    FILE *file = fopen(path, "w");
    return file && (text ? fputs(text, file) >= 0 : write_floor(file, cell_m)) && fclose(file) == 0;
}

/* A bench of files in a temporary folder, given to bench_loop as its shipped scenes. */
asdic_status latency(bench *b) {
    const char *parent = getenv("TMPDIR");
    const char *const texts[FILES] = {NULL, six, fan256};
    char folder[256], paths[FILES][320];
    snprintf(folder, sizeof folder, "%.200s/asdic-bench-XXXXXX",
             parent && *parent ? parent : "/tmp");
    bool good = mkdtemp(folder) != NULL;
    for (int i = 0; good && i < FILES; i++) {
        snprintf(paths[i], sizeof paths[i], "%s/%s", folder, files[i]);
        good = write_file(paths[i], texts[i], b->quick ? QUICK_CELL_M : CELL_M);
    }
    const char *const shipped[] = {files[1], files[2], NULL};
    bench_kind kind = *b->kind;
    kind.shipped = shipped;
    b->kind = &kind;
    if (good) {
        setenv("ASDIC_DATA", folder, 1);
    }
    asdic_status status = good ? bench_loop(b) : ASDIC_ERROR_IO;
    for (int i = 0; good && i < FILES; i++) {
        unlink(paths[i]);
    }
    rmdir(folder);
    return status;
}
