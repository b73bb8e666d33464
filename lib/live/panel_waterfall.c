/* One beam over time: range to the right, time up, so that the newest ping is on top. */
#include "panel.h"

#include <math.h>
#include <stdio.h>

/* Bins of one row of pixels, the strongest of those that share a pixel. */
static void paint_row(const asdic_view *view, const float *levels_db, size_t y, asdic_raster *out) {
    const asdic_loop_ping *ping = &view->ping;
    for (size_t x = 0; x < out->width; x++) {
        size_t first = x * ping->bins / out->width, end = (x + 1) * ping->bins / out->width;
        float best_db = levels_db[first];
        for (size_t n = first + 1; n < end; n++) {
            best_db = fmaxf(best_db, levels_db[n]); /* NAN gives way */
        }
        double range_m = ((double)first + 0.5) * ping->bin_length_m;
        asdic_raster_set(
            out, x, y, asdic_raster_color(&view->look, (double)best_db, range_m, PANEL_NIGHT_RGB));
    }
}

static void paint(const panel *p, const asdic_view *view, asdic_box box, size_t rows) {
    const view_history *h = &view->history;
    size_t stride = view->ping.beams * view->ping.bins;
    asdic_raster raster;
    if (asdic_raster_init(view->ctx, (size_t)box.w, rows, &raster) != ASDIC_OK) {
        return;
    }
    for (size_t y = 0; y < rows; y++) {
        if (y < h->count) {
            size_t row = (h->next + h->rows - 1 - y) % h->rows;
            paint_row(view, h->levels_db + row * stride + view->beam * view->ping.bins, y, &raster);
        } else {
            for (size_t x = 0; x < raster.width; x++) {
                asdic_raster_set(&raster, x, y, PANEL_NIGHT_RGB);
            }
        }
    }
    asdic_canvas_raster(p->canvas, &raster, box);
    asdic_raster_finish(&raster);
}

static void axes(const panel *p, const asdic_view *view, asdic_box box, size_t rows) {
    asdic_tick ticks[ASDIC_AXIS_MAX_TICKS];
    double rate_hz = asdic_mission_sonar(view->mission)->ping_rate_hz;
    asdic_plot_axis range = {.high = asdic_view_range_m(view)};
    asdic_plot_axis ago = {.high = (double)rows / rate_hz};
    panel_ranges(p, box, &range, false);
    size_t count = asdic_axis_ticks(&ago, (size_t)fmax(2.0, box.h / (50.0 * p->scale)), ticks);
    for (size_t i = 0; i < count; i++) {
        char label[32];
        double y = floor(box.y + box.h * asdic_axis_share(&ago, ticks[i].value)) + 0.5;
        snprintf(label, sizeof label, i ? "\u2212%s s" : "now", ticks[i].label);
        asdic_canvas_color(p->canvas, PANEL_LINE_RGB);
        asdic_canvas_line(p->canvas, box.x - 4.0 * p->scale, y, box.x, y);
        panel_text(p,
                   (asdic_lettering){.x = box.x - 7.0 * p->scale,
                                     .y = y,
                                     .align_x = 1.0,
                                     .align_y = 0.5,
                                     .size_px = PANEL_SMALL_PX},
                   PANEL_DIM_RGB, label);
    }
}

void panel_waterfall(const panel *p, const asdic_view *view) {
    char heading[ASDIC_NAME_SIZE + 96], gain[48];
    panel_gain_words(&view->look, gain);
    snprintf(heading, sizeof heading, "sonar  \u00b7  beam \u2018%s\u2019%s",
             asdic_mission_sonar(view->mission)->receivers[view->beam].name, gain);
    panel_begin(p, heading);
    asdic_box box = {floor(p->box.x + 52.0 * p->scale), floor(p->box.y + 32.0 * p->scale),
                     floor(p->box.w - 122.0 * p->scale), floor(p->box.h - 58.0 * p->scale)};
    /* Two pixels a ping, at this height of the frame. */
    size_t rows = (size_t)fmax(1.0, box.h / fmax(2.0, floor(2.0 * p->scale)));
    rows = rows < view->history.rows ? rows : view->history.rows;
    paint(p, view, box, rows);
    axes(p, view, box, rows);
    panel_color_bar(
        p, (asdic_box){p->box.x + p->box.w - 50.0 * p->scale, box.y, 12.0 * p->scale, box.h},
        &view->look);
}
