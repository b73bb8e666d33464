#include "detect_job.h"

#include "base/context.h"
#include "mission/run/run_folder.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Log-odds are clipped here: e^10 to 1. */
#define LIMIT 10.0

/* Round the vehicle's whole way, as far as the sonar reaches. */
asdic_status asdic_detect_create_map(asdic_detect_job *job) {
    if (isnan(job->options->cell_m)) {
        return ASDIC_OK;
    }
    double reach_m = 0.0;
    asdic_vec3 low = {INFINITY, INFINITY, 0.0}, high = {-INFINITY, -INFINITY, 0.0};
    for (size_t i = 0; i < job->info.pings; i++) {
        asdic_record record;
        asdic_status status = asdic_run_read(job->run, i, &record);
        if (status != ASDIC_OK) {
            return status;
        }
        for (size_t b = 0; b < job->info.beams; b++) {
            asdic_vec3 axis = asdic_beam_axis(&job->info.sonar->receivers[b], &record.pose);
            double half = 0.5 * asdic_beam_width_rad(job->info.sonar, b, job->sound_speed_mps);
            reach_m =
                (double)job->info.bins * job->info.sonar->bin_length_m * hypot(axis.x, axis.y);
            for (int k = -2; k <= 2; k++) {
                double azimuth = atan2(axis.y, axis.x) + 0.5 * k * half;
                double north = record.pose.position_m.x + reach_m * cos(azimuth);
                double east = record.pose.position_m.y + reach_m * sin(azimuth);
                low.x = fmin(low.x, fmin(north, record.pose.position_m.x));
                low.y = fmin(low.y, fmin(east, record.pose.position_m.y));
                high.x = fmax(high.x, fmax(north, record.pose.position_m.x));
                high.y = fmax(high.y, fmax(east, record.pose.position_m.y));
            }
        }
    }
    double cell = job->options->cell_m;
    low.x = cell * floor(low.x / cell) - cell;
    low.y = cell * floor(low.y / cell) - cell;
    high.x += cell;
    high.y += cell;
    return asdic_occupancy_create(job->ctx, low, high, cell, job->detector.prior, LIMIT, &job->map);
}

asdic_status asdic_detect_draw_map(asdic_detect_job *job) {
    char title[256], note[256];
    char *path = asdic_folder_path(job->run->folder, "occupancy", "", "png");
    const char *texts[] = {"Software", "asdic", "scene_sha256", job->info.scene_hash, NULL};
    asdic_series way = {.label = "vehicle, ending at the dot",
                        .x = job->track_east_m,
                        .y = job->track_north_m,
                        .count = job->pings_done,
                        .rgb = 0xd55e00u,
                        .width = 1.6};
    asdic_map map = {.values = job->map->log_odds,
                     .rows = job->map->rows,
                     .columns = job->map->columns,
                     .north_m = job->map->north_m,
                     .east_m = job->map->east_m,
                     .cell_m = job->map->cell_m,
                     .label = "ln of the odds of a target",
                     .lines = &way,
                     .line_count = 1};
    asdic_picture_options options = asdic_picture_options_default();
    if (!path) {
        return asdic_fail_memory(job->ctx, "a file name");
    }
    snprintf(title, sizeof title, "%s: occupancy after %zu ping%s", job->info.scene_name,
             job->pings_done, job->pings_done == 1 ? "" : "s");
    snprintf(note, sizeof note,
             "cells of %g m, clipped at %g; prior %g, targets %g dB above the background; white: "
             "not looked at",
             job->map->cell_m, LIMIT, job->detector.prior, job->detector.snr_db);
    options.db_low = -LIMIT;
    options.db_high = LIMIT;
    options.title = title;
    options.note = note;
    options.texts = texts;
    asdic_status status = asdic_picture_map(job->ctx, path, &map, &options);
    free(path);
    return status;
}
