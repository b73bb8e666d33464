/* The scenes of `asdic bench loop`: six beams, and 256, over a million triangles of half a metre. */
#include "bench_loop.h"
#include "bench_pings.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define CELLS 708 /* a side: 2 x 708 x 708 triangles */
#define CELL_M 0.5
#define HEAD                                                                                       \
    "version: 1\n"                                                                                 \
    "environment: {sound_speed_mps: 1490}\n"                                                       \
    "bottom: {grid: {file: floor.asc, values: depths}, type: sand}\n"
#define MISSION                                                                                    \
    "mission:\n"                                                                                   \
    "  waypoints: {points_m: [[80, 177, 25], [270, 177, 25]], speed_mps: 2}\n"

static const char *const files[] = {"floor.asc", "six.yaml", "fan256.yaml"};

static const char six[] = HEAD MISSION
    "sampling: {rays: 20000, multipath: boundaries}\n"
    "sonar:\n"
    "  {frequency_khz: 100, bandwidth_khz: 10, ping_rate_hz: 10, source_level_db: 200,\n"
    "   bin_length_m: 0.25, transmitter: {length_h_m: 0.02, length_v_m: 0.05},\n"
    "   receivers: [{name: port_3, yaw_deg: -25, pitch_deg: 10}, {name: port_2, yaw_deg: -15,\n"
    "     pitch_deg: 10}, {name: port_1, yaw_deg: -5, pitch_deg: 10}, {name: stbd_1, yaw_deg: 5,\n"
    "     pitch_deg: 10}, {name: stbd_2, yaw_deg: 15, pitch_deg: 10}, {name: stbd_3,\n"
    "     yaw_deg: 25, pitch_deg: 10}]}\n";

static const char fan[] = HEAD MISSION
    "sampling: {rays: 20000}\n"
    "sonar:\n"
    "  {frequency_khz: 300, bandwidth_khz: 30, ping_rate_hz: 10, source_level_db: 200,\n"
    "   bin_length_m: 0.25, transmitter: {length_h_m: 0.0025, length_v_m: 0.0125},\n"
    "   receivers: {fan: {count: 256, sector_deg: 120, length_h_m: 0.15, length_v_m: 0.0125}}}\n";

static bool write_text(const cli *c, const char *path, const char *text) {
    FILE *file = bench_begin_file(c, path);
    if (!file) {
        return false;
    }
    fputs(text, file);
    return bench_end_file(c, file, path) == CLI_OK;
}

static bool write_floor(const cli *c, const char *path) {
    FILE *file = bench_begin_file(c, path);
    if (!file) {
        return false;
    }
    fprintf(file, "ncols %d\nnrows %d\nxllcorner 0\nyllcorner 0\ncellsize %g\n", CELLS + 1,
            CELLS + 1, CELL_M);
    for (int row = 0; row <= CELLS; row++) {
        for (int column = 0; column <= CELLS; column++) {
            double x = CELL_M * (CELLS - row), y = CELL_M * column;
            fprintf(file, "%.3f ", 38.0 - 0.4 * bench_height_m(x, y));
        }
        fputc('\n', file);
    }
    return bench_end_file(c, file, path) == CLI_OK;
}

bool bench_folder_make(cli *c, bench_folder *folder) {
    const char *parent = getenv("TMPDIR");
    char path[320];
    *folder = (bench_folder){.path = ""};
    snprintf(path, sizeof path, "%.200s/asdic-bench-XXXXXX", parent && *parent ? parent : "/tmp");
    if (!mkdtemp(path)) {
        cli_error(c, "cannot make a temporary folder '%s': %s", path, strerror(errno));
        return false;
    }
    snprintf(folder->path, sizeof folder->path, "%.255s", path);
    snprintf(path, sizeof path, "%s/%s", folder->path, files[0]);
    bool good = write_floor(c, path);
    static const char *const texts[BENCH_LOOP_SCENES] = {six, fan};
    for (int i = 0; good && i < BENCH_LOOP_SCENES; i++) {
        snprintf(folder->scenes[i], sizeof folder->scenes[i], "%s/%s", folder->path, files[i + 1]);
        good = write_text(c, folder->scenes[i], texts[i]);
    }
    return good;
}

void bench_folder_remove(bench_folder *folder) {
    char path[320];
    for (size_t i = 0; folder->path[0] && i < sizeof files / sizeof *files; i++) {
        snprintf(path, sizeof path, "%s/%s", folder->path, files[i]);
        unlink(path);
    }
    if (folder->path[0]) {
        rmdir(folder->path);
    }
}
