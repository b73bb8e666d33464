#include "run_render.h"

#include "base/context.h"
#include "out/digits.h"
#include "run_folder.h"

#include <stdio.h>
#include <stdlib.h>

/* Curves that lie below the window of the total (one of several mechanisms) are worth seeing. */
#define ASCOPE_BELOW_DB 20.0
/* A peak shall not touch the frame. */
#define ASCOPE_ABOVE_DB 10.0

/* "NAME: ping 17, t = 1.7 s" and the number for the text chunk. */
static void name_ping(const asdic_render *r, const asdic_record *record, char title[256],
                      char number[ASDIC_DIGITS_SIZE]) {
    char time_s[ASDIC_DIGITS_SIZE];
    asdic_digits_natural(number, record->ping);
    asdic_digits_print(time_s, "%.10g", record->time_s);
    snprintf(title, 256, "%s: ping %s, t = %s s", r->info.scene_name, number, time_s);
}

asdic_status asdic_render_ascope(asdic_render *r, const asdic_record *record) {
    char title[256], number[ASDIC_DIGITS_SIZE];
    char panel_titles[ASDIC_RENDER_PANELS][ASDIC_NAME_SIZE + 16];
    asdic_ascope panels[ASDIC_RENDER_PANELS];
    /* Of many beams the one that looks ahead, see choose_beams. */
    size_t count = r->beam_count <= ASDIC_RENDER_PANELS ? r->beam_count : ASDIC_RENDER_PANELS;
    for (size_t k = 0; k < count; k++) {
        size_t first = r->beams[k] * r->info.bins;
        snprintf(panel_titles[k], sizeof panel_titles[k], "beam \u2018%s\u2019",
                 r->info.sonar->receivers[r->beams[k]].name);
        panels[k] = (asdic_ascope){.title = panel_titles[k],
                                   .bins = r->info.bins,
                                   .bin_length_m = r->run->facts.bin_length_m,
                                   .simulated_db = record->level_db[ASDIC_TOTAL] + first,
                                   .bottom_db = record->level_db[ASDIC_BOTTOM] + first,
                                   .surface_db = record->level_db[ASDIC_SURFACE] + first,
                                   .volume_db = record->level_db[ASDIC_VOLUME] + first,
                                   .object_db = record->level_db[ASDIC_OBJECT] + first,
                                   .noise_db = record->level_db[ASDIC_NOISE] + first};
    }
    name_ping(r, record, title, number);
    asdic_picture_options options = asdic_render_picture(r, title, "ping", number);
    options.db_low -= ASCOPE_BELOW_DB;
    options.db_high += ASCOPE_ABOVE_DB;
    options.tvg_db_per_decade = options.tvg_db_per_m = 0.0;
    char *path = asdic_folder_path(r->run->folder, "ascope_", number, "png");
    asdic_status status = path ? asdic_picture_ascope(r->ctx, path, panels, count, &options)
                               : asdic_fail_memory(r->ctx, "a file name");
    free(path);
    return status;
}

asdic_status asdic_render_fan(asdic_render *r, const asdic_record *record) {
    char title[256], number[ASDIC_DIGITS_SIZE];
    double *bearing_rad = malloc(r->info.beams * sizeof *bearing_rad);
    char *path = NULL;
    asdic_status status = ASDIC_OK;
    name_ping(r, record, title, number);
    path = asdic_folder_path(r->run->folder, "fan_", number, "png");
    if (!path || !bearing_rad) {
        status = asdic_fail_memory(r->ctx, "a fan picture");
        goto done;
    }
    for (size_t i = 0; i < r->info.beams; i++) {
        bearing_rad[i] = r->info.sonar->receivers[i].yaw_rad;
    }
    asdic_fan fan = {.levels_db = record->level_db[ASDIC_TOTAL],
                     .bearing_rad = bearing_rad,
                     .beams = r->info.beams,
                     .bins = r->info.bins,
                     .bin_length_m = r->run->facts.bin_length_m};
    asdic_picture_options options = asdic_render_picture(r, title, "ping", number);
    status = asdic_picture_fan(r->ctx, path, &fan, &options);
done:
    free(path);
    free(bearing_rad);
    return status;
}
