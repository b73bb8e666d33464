#include "panel.h"

#include "out/colormap.h"

#include <math.h>
#include <stdio.h>

void panel_begin(const panel *p, const char *heading) {
    cairo_t *cr = p->canvas->cr;
    asdic_canvas_color(p->canvas, PANEL_BACK_RGB);
    cairo_rectangle(cr, p->box.x, p->box.y, p->box.w, p->box.h);
    cairo_fill(cr);
    asdic_canvas_color(p->canvas, PANEL_EDGE_RGB);
    cairo_set_line_width(cr, 1.0);
    cairo_rectangle(cr, p->box.x - 0.5, p->box.y - 0.5, p->box.w + 1.0, p->box.h + 1.0);
    cairo_stroke(cr);
    if (heading) {
        panel_text(p,
                   (asdic_lettering){.x = p->box.x + 8.0 * p->scale,
                                     .y = p->box.y + 8.0 * p->scale,
                                     .align_y = 1.0,
                                     .size_px = PANEL_TEXT_PX,
                                     .bold = true},
                   PANEL_INK_RGB, heading);
    }
}

void panel_text(const panel *p, asdic_lettering where, uint32_t rgb, const char *text) {
    where.size_px *= p->scale;
    asdic_canvas_color(p->canvas, rgb);
    asdic_canvas_text(p->canvas, where, text);
}

void panel_ranges(const panel *p, asdic_box box, const asdic_plot_axis *range, bool has_lines) {
    asdic_tick ticks[ASDIC_AXIS_MAX_TICKS];
    double bottom = box.y + box.h, gap_px = has_lines ? 6.0 : 7.0;
    size_t count = asdic_axis_ticks(range, (size_t)fmax(2.0, box.w / (80.0 * p->scale)), ticks);
    cairo_set_line_width(p->canvas->cr, 1.0);
    for (size_t i = 0; i < count; i++) {
        char label[32];
        double x = floor(box.x + box.w * asdic_axis_share(range, ticks[i].value)) + 0.5;
        snprintf(label, sizeof label, i + 1 == count ? "%s m" : "%s", ticks[i].label);
        asdic_canvas_color(p->canvas, has_lines ? PANEL_EDGE_RGB : PANEL_LINE_RGB);
        asdic_canvas_line(p->canvas, x, has_lines ? box.y : bottom, x,
                          has_lines ? bottom : bottom + 4.0 * p->scale);
        panel_text(p,
                   (asdic_lettering){.x = x,
                                     .y = bottom + gap_px * p->scale,
                                     .align_x = 0.5,
                                     .align_y = 1.0,
                                     .size_px = PANEL_SMALL_PX},
                   PANEL_DIM_RGB, label);
    }
}

void panel_plate(const panel *p, double x, double y, double w, double h) {
    cairo_t *cr = p->canvas->cr;
    cairo_set_source_rgba(cr, 0.03, 0.05, 0.07, 0.62);
    cairo_rectangle(cr, x, y, w, h);
    cairo_fill(cr);
}

void panel_gain_words(const asdic_picture_options *look, char words[48]) {
    words[0] = 0;
    if (look->tvg_db_per_decade != 0.0) {
        snprintf(words, 48, "  \u00b7  shown + %.0f log r", look->tvg_db_per_decade);
    }
}

void panel_color_bar(const panel *p, asdic_box box, const asdic_picture_options *look) {
    cairo_t *cr = p->canvas->cr;
    asdic_tick ticks[ASDIC_AXIS_MAX_TICKS];
    asdic_plot_axis axis = {.low = look->db_low, .high = look->db_high};
    for (int i = 0; i < 64; i++) {
        asdic_canvas_color(p->canvas, asdic_colormap_rgb(look->colormap, (unsigned)(4 * i + 2)));
        cairo_rectangle(cr, box.x, box.y + box.h * (63 - i) / 64.0, box.w, box.h / 64.0 + 0.7);
        cairo_fill(cr);
    }
    size_t count = asdic_axis_ticks(&axis, (size_t)fmax(2.0, box.h / (34.0 * p->scale)), ticks);
    for (size_t i = 0; i < count; i++) {
        double y = box.y + box.h * (1.0 - asdic_axis_share(&axis, ticks[i].value));
        panel_text(p,
                   (asdic_lettering){.x = box.x + box.w + 5.0 * p->scale,
                                     .y = y,
                                     .align_y = 0.5,
                                     .size_px = PANEL_SMALL_PX},
                   PANEL_DIM_RGB, ticks[i].label);
    }
    panel_text(p,
               (asdic_lettering){.x = box.x + 0.5 * box.w,
                                 .y = box.y - 7.0 * p->scale,
                                 .align_x = 0.5,
                                 .size_px = PANEL_SMALL_PX},
               PANEL_DIM_RGB, "dB");
}

void panel_sonar(const panel *p, const asdic_view *view) {
    if (view->shows_fan) {
        panel_fan(p, view);
    } else {
        panel_waterfall(p, view);
    }
}
