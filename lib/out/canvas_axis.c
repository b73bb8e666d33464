#include "canvas.h"

#include "colormap.h"

#include <math.h>

#define TICK_PX 7.0
#define GAP_PX 5.0
#define GRID_RGB 0xe4e4e4u

/* Lines one pixel wide are crisp on half coordinates. */
static double crisp(double x) {
    return floor(x) + 0.5;
}

/* At most every 90 pixels along, 30 pixels down; at least two intervals. */
static size_t tick_count(double length_px, double apart_px) {
    double count = floor(length_px / apart_px);
    return count < 2.0 ? 2 : (size_t)count;
}

void asdic_canvas_axis_x(asdic_canvas *c, asdic_box box, const asdic_plot_axis *axis, bool grid) {
    asdic_tick ticks[ASDIC_AXIS_MAX_TICKS];
    size_t count = asdic_axis_ticks(axis, tick_count(box.w, 90.0), ticks);
    double bottom = box.y + box.h;
    double room = axis->names ? box.w / (axis->high - axis->low) - GAP_PX : box.w;
    cairo_set_line_width(c->cr, 1.0);
    for (size_t i = 0; i < count; i++) {
        double x = crisp(box.x + box.w * asdic_axis_share(axis, ticks[i].value));
        if (grid) {
            asdic_canvas_color(c, GRID_RGB);
            asdic_canvas_line(c, x, box.y, x, bottom);
        }
        asdic_canvas_color(c, ASDIC_INK_RGB);
        asdic_canvas_line(c, x, bottom, x, bottom + TICK_PX);
        asdic_canvas_text_fit(c,
                              (asdic_lettering){.x = x,
                                                .y = bottom + TICK_PX + GAP_PX,
                                                .align_x = 0.5,
                                                .align_y = 1.0,
                                                .size_px = ASDIC_TEXT_PX},
                              ticks[i].label, room);
    }
    if (axis->label) {
        asdic_canvas_text(
            c,
            (asdic_lettering){.x = box.x + 0.5 * box.w,
                              .y = bottom + TICK_PX + 2.0 * GAP_PX + 1.5 * ASDIC_TEXT_PX,
                              .align_x = 0.5,
                              .align_y = 1.0,
                              .size_px = ASDIC_TEXT_PX},
            axis->label);
    }
}

static double label_width(const asdic_plot_axis *axis, size_t max_count) {
    asdic_tick ticks[ASDIC_AXIS_MAX_TICKS];
    size_t count = asdic_axis_ticks(axis, max_count, ticks);
    double width = 0.0;
    for (size_t i = 0; i < count; i++) {
        width = fmax(width, asdic_canvas_text_width(ticks[i].label, ASDIC_TEXT_PX));
    }
    return width;
}

double asdic_canvas_axis_y_room(const asdic_plot_axis *axis, double height_px) {
    double labels = label_width(axis, tick_count(height_px, 30.0));
    return TICK_PX + GAP_PX + labels + (axis->label ? 3.0 * GAP_PX + ASDIC_TEXT_PX : 0.0);
}

void asdic_canvas_axis_y(asdic_canvas *c, asdic_box box, const asdic_plot_axis *axis, bool down,
                         bool grid) {
    asdic_tick ticks[ASDIC_AXIS_MAX_TICKS];
    size_t max_count = tick_count(box.h, 30.0);
    size_t count = asdic_axis_ticks(axis, max_count, ticks);
    cairo_set_line_width(c->cr, 1.0);
    for (size_t i = 0; i < count; i++) {
        double share = asdic_axis_share(axis, ticks[i].value);
        double y = crisp(box.y + box.h * (down ? share : 1.0 - share));
        if (grid) {
            asdic_canvas_color(c, GRID_RGB);
            asdic_canvas_line(c, box.x, y, box.x + box.w, y);
        }
        asdic_canvas_color(c, ASDIC_INK_RGB);
        asdic_canvas_line(c, box.x, y, box.x - TICK_PX, y);
        asdic_canvas_text(c,
                          (asdic_lettering){.x = box.x - TICK_PX - GAP_PX,
                                            .y = y,
                                            .align_x = 1.0,
                                            .align_y = 0.5,
                                            .size_px = ASDIC_TEXT_PX},
                          ticks[i].label);
    }
    if (axis->label) {
        double labels = label_width(axis, max_count);
        asdic_canvas_text(c,
                          (asdic_lettering){.x = box.x - TICK_PX - 4.0 * GAP_PX - labels,
                                            .y = box.y + 0.5 * box.h,
                                            .align_x = 0.5,
                                            .size_px = ASDIC_TEXT_PX,
                                            .upwards = true},
                          axis->label);
    }
}

asdic_plot_axis asdic_canvas_level_axis(const asdic_picture_options *options) {
    bool gained = options->tvg_db_per_decade != 0.0 || options->tvg_db_per_m != 0.0;
    return (asdic_plot_axis){.label = gained ? "level + gain (dB re 1 \u00b5Pa)"
                                             : "level (dB re 1 \u00b5Pa)",
                             .low = options->db_low,
                             .high = options->db_high};
}

asdic_plot_axis asdic_canvas_time_axis(double pings, double first_s, double period_s) {
    return period_s > 0.0 ? (asdic_plot_axis){.label = "time (s), downwards",
                                              .low = first_s,
                                              .high = first_s + pings * period_s}
                          : (asdic_plot_axis){.label = "ping", .low = -0.5, .high = pings - 0.5};
}

double asdic_canvas_pixels_each(size_t count, double fill_px, double most_px,
                                double least_total_px) {
    double each = fmin(fmax(1.0, floor(fill_px / (double)count)), most_px);
    return fmax(each, ceil(least_total_px / (double)count));
}

double asdic_canvas_color_bar_room(const asdic_picture_options *options, double height_px) {
    asdic_plot_axis axis = asdic_canvas_level_axis(options);
    return asdic_canvas_axis_y_room(&axis, height_px);
}

void asdic_canvas_scale(asdic_canvas *c, asdic_box box, const asdic_plot_axis *axis,
                        asdic_colormap map, bool down) {
    asdic_tick ticks[ASDIC_AXIS_MAX_TICKS];
    size_t max_count = tick_count(box.h, 30.0);
    size_t count = asdic_axis_ticks(axis, max_count, ticks);
    uint8_t pixels[256 * 3];
    asdic_raster scale = {.width = 1, .height = sizeof pixels / 3, .rgb = pixels};
    for (unsigned i = 0; i < scale.height; i++) {
        asdic_raster_set(&scale, 0, i, asdic_colormap_rgb(map, 255 - i));
    }
    asdic_canvas_raster(c, &scale, box);
    asdic_canvas_color(c, ASDIC_INK_RGB);
    cairo_set_line_width(c->cr, 1.0);
    cairo_rectangle(c->cr, crisp(box.x), crisp(box.y), box.w - 1.0, box.h - 1.0);
    cairo_stroke(c->cr);
    double right = box.x + box.w;
    for (size_t i = 0; i < count; i++) {
        double share = asdic_axis_share(axis, ticks[i].value);
        double y = crisp(box.y + (box.h - 1.0) * (down ? share : 1.0 - share));
        asdic_canvas_line(c, right, y, right + TICK_PX, y);
        asdic_canvas_text(
            c,
            (asdic_lettering){
                .x = right + TICK_PX + GAP_PX, .y = y, .align_y = 0.5, .size_px = ASDIC_TEXT_PX},
            ticks[i].label);
    }
    double labels = label_width(axis, max_count);
    if (axis->label) {
        asdic_canvas_text(
            c,
            (asdic_lettering){.x = right + TICK_PX + 2.0 * GAP_PX + labels + ASDIC_TEXT_PX,
                              .y = box.y + 0.5 * box.h,
                              .align_x = 0.5,
                              .size_px = ASDIC_TEXT_PX,
                              .upwards = true},
            axis->label);
    }
}

void asdic_canvas_color_bar(asdic_canvas *c, asdic_box box, const asdic_picture_options *options) {
    asdic_plot_axis axis = asdic_canvas_level_axis(options);
    asdic_canvas_scale(c, box, &axis, options->colormap, false);
}
