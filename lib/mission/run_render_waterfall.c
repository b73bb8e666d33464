#include "run_render.h"

#include "base/context.h"
#include "out/draw.h"
#include "run_folder.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static asdic_status draw(asdic_render *r, size_t beam, const asdic_decimator *levels) {
    char title[256];
    const char *name = r->info.sonar->receivers[beam].name;
    char *path = asdic_folder_path(r->run->folder, "waterfall_", name, "png");
    if (!path) {
        return asdic_fail_memory(r->ctx, "a file name");
    }
    snprintf(title, sizeof title, "%s: beam \u2018%s\u2019", r->info.scene_name, name);
    asdic_picture_options options = asdic_render_picture(r, title, "beam", name);
    asdic_waterfall waterfall = {.pings = r->info.pings,
                                 .bins = r->info.bins,
                                 .bin_length_m = r->run->facts.bin_length_m,
                                 .first_time_s = r->survey.first_time_s};
    if (r->info.pings > 1) {
        waterfall.ping_period_s =
            (r->survey.last_time_s - r->survey.first_time_s) / (double)(r->info.pings - 1);
    }
    asdic_status status = asdic_draw_waterfall(r->ctx, path, &waterfall, levels, &options);
    free(path);
    return status;
}

/* Every bin of every ping: needs the memory of one beam. */
static asdic_status draw_raw(asdic_render *r, size_t beam) {
    size_t bins = r->info.bins, pings = r->info.pings;
    const char *name = r->info.sonar->receivers[beam].name;
    char *path = asdic_folder_path(r->run->folder, "raw_", name, "png");
    float *levels_db =
        bins <= SIZE_MAX / sizeof(float) / pings ? malloc(pings * bins * sizeof *levels_db) : NULL;
    asdic_status status = path && levels_db ? ASDIC_OK : asdic_fail_memory(r->ctx, "a raw picture");
    for (size_t i = 0; i < pings && status == ASDIC_OK; i++) {
        asdic_record record;
        status = asdic_run_read(r->run, i, &record);
        if (status == ASDIC_OK) {
            memcpy(levels_db + i * bins, record.level_db[ASDIC_TOTAL] + beam * bins,
                   bins * sizeof *levels_db);
        }
    }
    if (status == ASDIC_OK) {
        asdic_picture_options options = asdic_render_picture(r, r->info.scene_name, "beam", name);
        asdic_waterfall waterfall = {.levels_db = levels_db,
                                     .pings = pings,
                                     .bins = bins,
                                     .bin_length_m = r->run->facts.bin_length_m};
        status = asdic_picture_raw(r->ctx, path, &waterfall, &options);
    }
    free(levels_db);
    free(path);
    return status;
}

static asdic_status draw_averaged(asdic_render *r) {
    asdic_decimator levels[ASDIC_RENDER_WATERFALLS] = {0};
    asdic_status status = ASDIC_OK;
    for (size_t k = 0; k < r->beam_count && status == ASDIC_OK; k++) {
        status = asdic_decimator_init(r->ctx, r->info.pings, r->info.bins, ASDIC_WATERFALL_MAX_ROWS,
                                      ASDIC_WATERFALL_MAX_COLUMNS, &levels[k]);
    }
    for (size_t i = 0; i < r->info.pings && status == ASDIC_OK; i++) {
        asdic_record record;
        status = asdic_run_read(r->run, i, &record);
        for (size_t k = 0; k < r->beam_count && status == ASDIC_OK; k++) {
            asdic_decimator_add(&levels[k],
                                record.level_db[ASDIC_TOTAL] + r->beams[k] * r->info.bins);
        }
    }
    for (size_t k = 0; k < r->beam_count && status == ASDIC_OK; k++) {
        asdic_decimator_end(&levels[k]);
        status = draw(r, r->beams[k], &levels[k]);
    }
    for (size_t k = 0; k < r->beam_count; k++) {
        asdic_decimator_finish(&levels[k]);
    }
    return status;
}

asdic_status asdic_render_waterfalls(asdic_render *r) {
    asdic_status status = r->images & 1u << ASDIC_IMAGE_WATERFALL ? draw_averaged(r) : ASDIC_OK;
    for (size_t k = 0; r->options.raw && k < r->beam_count && status == ASDIC_OK; k++) {
        status = draw_raw(r, r->beams[k]);
    }
    return status;
}
