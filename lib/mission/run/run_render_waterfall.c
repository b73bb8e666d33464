#include "run_picture.h"

#include "base/context.h"
#include "base/try.h"
#include "out/draw.h"
#include "out/png_file.h"

#include <stdio.h>

/* Beams up to here are named in the overview. */
#define MOST_NAMES 16

static double ping_period_s(const asdic_render *r) {
    double whole_s = r->summary->statistics.last_time_s - r->summary->statistics.first_time_s;
    return r->info.pings > 1 ? whole_s / (double)(r->info.pings - 1) : 0.0;
}

static asdic_status draw(asdic_render *r, size_t beam, const asdic_decimator *levels) {
    char title[256];
    const char *name = r->info.sonar->receivers[beam].name;
    snprintf(title, sizeof title, "%s: beam \u2018%s\u2019", r->info.scene_name, name);
    asdic_picture_options options = asdic_render_picture(r, title, "beam", name);
    asdic_waterfall waterfall = {.pings = r->info.pings,
                                 .bins = r->info.bins,
                                 .bin_length_m = r->run->facts.bin_length_m,
                                 .first_time_s = r->summary->statistics.first_time_s,
                                 .ping_period_s = ping_period_s(r)};
    return asdic_draw_waterfall(r->ctx, asdic_render_path(r, "waterfall_", name).text, &waterfall,
                                levels, &options);
}

typedef struct raw_rows {
    asdic_render *render;
    size_t beam;
    asdic_picture_options options;
} raw_rows;

static asdic_status raw_row(void *user, size_t ping, uint16_t *grey) {
    raw_rows *rows = user;
    asdic_render *r = rows->render;
    asdic_record record;
    TRY(asdic_run_read(r->run, ping, &record));
    asdic_draw_grey(&rows->options, record.level_db[ASDIC_TOTAL] + rows->beam * r->info.bins,
                    r->info.bins, r->run->facts.bin_length_m, grey);
    return ASDIC_OK;
}

/* Every bin of every ping, read as it is written. */
static asdic_status draw_raw(asdic_render *r, size_t beam) {
    const char *name = r->info.sonar->receivers[beam].name;
    raw_rows rows = {.render = r,
                     .beam = beam,
                     .options = asdic_render_picture(r, r->info.scene_name, "beam", name)};
    asdic_png png = {.width = r->info.bins,
                     .height = r->info.pings,
                     .grey_row = raw_row,
                     .user = &rows,
                     .texts = rows.options.texts};
    return asdic_png_write(r->ctx, asdic_render_path(r, "raw_", name).text, &png);
}

/* The overview has a gain and a window of its own unless the options give them. */
asdic_status asdic_render_overview(const asdic_render *whole) {
    const asdic_summary *summary = whole->summary;
    asdic_render own = *whole, *r = &own;
    char title[256];
    const char *names[MOST_NAMES];
    asdic_overview_axes axes = {.names = r->info.beams <= MOST_NAMES ? names : NULL,
                                .first_time_s = r->summary->statistics.first_time_s,
                                .ping_period_s = ping_period_s(r)};
    for (size_t i = 0; axes.names && i < r->info.beams; i++) {
        names[i] = r->info.sonar->receivers[i].name;
    }
    own.options.tvg_db_per_decade = summary->overview_db_per_decade;
    own.options.tvg_db_per_m = summary->overview_db_per_m;
    if (!whole->has_window) {
        asdic_overview_window(&summary->overview, &own.options.db_low, &own.options.db_high);
    }
    asdic_render_describe(&own);
    snprintf(title, sizeof title, "%s: strongest echo of each ping and beam", r->info.scene_name);
    asdic_picture_options options = asdic_render_picture(r, title, "view", "overview");
    return asdic_draw_overview(r->ctx, asdic_render_path(r, "overview", "").text,
                               &summary->overview, &axes, &options);
}

asdic_status asdic_render_waterfalls(asdic_render *r) {
    for (size_t k = 0; k < r->plan.beam_count; k++) {
        TRY(asdic_step(r->ctx, "waterfalls", k, r->plan.beam_count));
        TRY(draw(r, r->plan.beams[k], &r->summary->waterfalls[k]));
    }
    return ASDIC_OK;
}

asdic_status asdic_render_raw(asdic_render *r) {
    for (size_t k = 0; k < r->plan.beam_count; k++) {
        TRY(asdic_step(r->ctx, "raw pictures", k, r->plan.beam_count));
        TRY(draw_raw(r, r->plan.beams[k]));
    }
    return ASDIC_OK;
}
