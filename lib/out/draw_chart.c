#include "draw_chart.h"

#include "base/vec.h"
#include "canvas.h"
#include "digits.h"
#include "draw.h"
#include "raster_relief.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#define PAPER_RGB 0xffffffu
#define SEA_RGB 0xeef2f5u /* where there is no terrain to show */
#define INK_RGB 0x202020u
#define OBJECT_RGB 0x101010u
#define TRACK_RGB 0xd55e00u /* Okabe & Ito's vermilion */
#define BAR_PX 24.0
#define MOST_WIDE_PX 1100.0
#define MOST_HIGH_PX 860.0
#define LEAST_PX 320.0
#define MOST_LEGEND 20
#define MOST_NAMES 40

typedef struct page {
    double west_m, east_m, south_m, north_m; /* shown */
    double px_per_m;
    asdic_box box, bar, legend;
    asdic_plot_axis x, y, depth;
    double width, height;
    asdic_series entries[MOST_LEGEND];
    size_t entry_count;
} page;

static void take_in(page *p, double north_m, double east_m) {
    p->west_m = fmin(p->west_m, east_m);
    p->east_m = fmax(p->east_m, east_m);
    p->south_m = fmin(p->south_m, north_m);
    p->north_m = fmax(p->north_m, north_m);
}

/* Track and areas, and the objects among them or just beside. */
static void find_extent(page *p, const asdic_chart *chart) {
    p->west_m = p->south_m = INFINITY;
    p->east_m = p->north_m = -INFINITY;
    for (size_t i = 0; i < chart->track_count; i++) {
        take_in(p, chart->north_m[i], chart->east_m[i]);
    }
    for (size_t i = 0; i < chart->area_count; i++) {
        for (size_t k = 0; k < chart->areas[i].count; k++) {
            take_in(p, chart->areas[i].north_m[k], chart->areas[i].east_m[k]);
        }
    }
    double span_m = fmax(p->east_m - p->west_m, p->north_m - p->south_m);
    double near_m = fmax(0.15 * span_m, 1.0);
    page seen = *p;
    for (size_t i = 0; i < chart->outline_count; i++) {
        const asdic_outline *o = &chart->outlines[i];
        for (size_t k = 0; k < o->count; k++) {
            if (o->east_m[k] > seen.west_m - near_m && o->east_m[k] < seen.east_m + near_m &&
                o->north_m[k] > seen.south_m - near_m && o->north_m[k] < seen.north_m + near_m) {
                take_in(p, o->north_m[k], o->east_m[k]);
            }
        }
    }
}

/* Room at the edges, and neither side much shorter than the other. */
static void widen(page *p) {
    double wide_m = p->east_m - p->west_m, high_m = p->north_m - p->south_m;
    double span_m = fmax(fmax(wide_m, high_m), 1.0);
    double add_x_m = 0.5 * fmax(0.5 * span_m - wide_m, 0.0) + 0.06 * span_m;
    double add_y_m = 0.5 * fmax(0.5 * span_m - high_m, 0.0) + 0.06 * span_m;
    p->west_m -= add_x_m;
    p->east_m += add_x_m;
    p->south_m -= add_y_m;
    p->north_m += add_y_m;
}

static void add_entry(page *p, asdic_series entry) {
    if (p->entry_count < MOST_LEGEND) {
        p->entries[p->entry_count++] = entry;
    }
}

static bool is_moving(const asdic_chart *chart) {
    return asdic_track_moves(chart->north_m, chart->east_m, chart->track_count);
}

static void list_entries(page *p, const asdic_chart *chart) {
    add_entry(p, (asdic_series){.label = is_moving(chart) ? "track" : "vehicle",
                                .rgb = TRACK_RGB,
                                .width = 2.0});
    if (chart->outline_count > 0) {
        add_entry(p, (asdic_series){.label = "objects", .rgb = OBJECT_RGB, .width = 1.2});
    }
    for (size_t i = 0; i < chart->area_count; i++) {
        const asdic_chart_area *area = &chart->areas[i];
        if (area->label) {
            add_entry(p,
                      (asdic_series){.label = area->label,
                                     .rgb = area->rgb,
                                     .width = 1.5,
                                     .style = area->dashed ? ASDIC_LINE_DASHED : ASDIC_LINE_SOLID});
        }
    }
}

static void lay_out(page *p, const asdic_chart *chart, const asdic_picture_options *options) {
    find_extent(p, chart);
    widen(p);
    double wide_m = p->east_m - p->west_m, high_m = p->north_m - p->south_m;
    p->px_per_m = fmin(MOST_WIDE_PX / wide_m, MOST_HIGH_PX / high_m);
    p->x = (asdic_plot_axis){.label = "east (m)", .low = p->west_m, .high = p->east_m};
    p->y = (asdic_plot_axis){.label = "north (m)", .low = p->south_m, .high = p->north_m};
    p->box.w = fmax(floor(wide_m * p->px_per_m), LEAST_PX);
    p->box.h = fmax(floor(high_m * p->px_per_m), LEAST_PX);
    p->box.x = ASDIC_MARGIN_PX + ceil(asdic_canvas_axis_y_room(&p->y, p->box.h));
    bool has_depth = asdic_relief_span(chart->relief, p->west_m, p->east_m, p->south_m, p->north_m,
                                       &p->depth.low, &p->depth.high);
    double beside = 0.0;
    p->depth.label = "depth (m)";
    if (has_depth) {
        p->bar = (asdic_box){.w = BAR_PX, .h = fmin(p->box.h, 600.0)};
        beside = 28.0 + BAR_PX + asdic_canvas_axis_y_room(&p->depth, p->bar.h);
    }
    list_entries(p, chart);
    p->legend =
        (asdic_box){p->box.x, ASDIC_MARGIN_PX + (options->title ? 1.7 * ASDIC_TITLE_PX : 0.0),
                    p->box.w + beside, 0.0};
    p->legend.h = asdic_canvas_legend(NULL, p->legend, p->entries, p->entry_count);
    p->box.y = ceil(p->legend.y + p->legend.h + 12.0);
    p->bar.x = p->box.x + p->box.w + 28.0;
    p->bar.y = p->box.y;
    p->width = p->box.x + p->box.w + beside + 2.0 * ASDIC_MARGIN_PX;
    p->height = p->box.y + p->box.h + 4.0 * ASDIC_TEXT_PX + ASDIC_MARGIN_PX + 3.2 * ASDIC_NOTE_PX;
}

static double px_x(const page *p, double east_m) {
    return p->box.x + (east_m - p->west_m) * p->px_per_m;
}

static double px_y(const page *p, double north_m) {
    return p->box.y + (p->north_m - north_m) * p->px_per_m;
}

static asdic_status draw_relief(asdic_canvas *c, const page *p, const asdic_relief *r,
                                asdic_colormap map) {
    asdic_raster raster = {0};
    asdic_canvas_color(c, SEA_RGB);
    cairo_rectangle(c->cr, p->box.x, p->box.y, p->box.w, p->box.h);
    cairo_fill(c->cr);
    if (p->bar.w == 0.0) {
        return ASDIC_OK;
    }
    asdic_status status =
        asdic_raster_relief(c->ctx, r, p->depth.low, p->depth.high, map, SEA_RGB, &raster);
    if (status == ASDIC_OK) {
        double north_m = r->south_m + (double)r->rows * r->cell_m;
        asdic_canvas_raster(c, &raster,
                            (asdic_box){px_x(p, r->west_m), px_y(p, north_m),
                                        (double)r->columns * r->cell_m * p->px_per_m,
                                        (double)r->rows * r->cell_m * p->px_per_m});
        asdic_raster_finish(&raster);
    }
    return status;
}

static void trace(asdic_canvas *c, const page *p, const double *north_m, const double *east_m,
                  size_t count) {
    cairo_new_path(c->cr);
    for (size_t i = 0; i < count; i++) {
        cairo_line_to(c->cr, px_x(p, east_m[i]), px_y(p, north_m[i]));
    }
}

static void set_paint(asdic_canvas *c, uint32_t rgb, double alpha) {
    cairo_set_source_rgba(c->cr, (rgb >> 16) / 255.0, (rgb >> 8 & 255) / 255.0, (rgb & 255) / 255.0,
                          alpha);
}

/* The path in hand, in RGB over a pale border that keeps it apart from any terrain. */
static void stroke_over(asdic_canvas *c, uint32_t rgb, double width, bool dashed) {
    const double dashes[2] = {8.0, 6.0};
    cairo_set_line_join(c->cr, CAIRO_LINE_JOIN_ROUND);
    set_paint(c, 0xffffff, 0.7);
    cairo_set_line_width(c->cr, width + 1.8);
    cairo_stroke_preserve(c->cr);
    cairo_set_dash(c->cr, dashes, dashed ? 2 : 0, 0.0);
    asdic_canvas_color(c, rgb);
    cairo_set_line_width(c->cr, width);
    cairo_stroke(c->cr);
    asdic_canvas_set_style(c, NULL);
}

static void draw_areas(asdic_canvas *c, const page *p, const asdic_chart *chart) {
    for (size_t i = 0; i < chart->area_count; i++) {
        const asdic_chart_area *area = &chart->areas[i];
        trace(c, p, area->north_m, area->east_m, area->count);
        cairo_close_path(c->cr);
        set_paint(c, area->rgb, area->dashed ? 0.0 : 0.2);
        cairo_fill_preserve(c->cr);
        stroke_over(c, area->rgb, 1.8, area->dashed);
    }
}

static void draw_outline(asdic_canvas *c, const page *p, const asdic_outline *o) {
    double low_m = INFINITY, high_m = -INFINITY, left_m = INFINITY, right_m = -INFINITY;
    for (size_t k = 0; k < o->count; k++) {
        low_m = fmin(low_m, o->north_m[k]);
        high_m = fmax(high_m, o->north_m[k]);
        left_m = fmin(left_m, o->east_m[k]);
        right_m = fmax(right_m, o->east_m[k]);
    }
    if (fmax(high_m - low_m, right_m - left_m) * p->px_per_m < 5.0) { /* too small to see */
        cairo_new_path(c->cr);
        cairo_arc(c->cr, px_x(p, 0.5 * (left_m + right_m)), px_y(p, 0.5 * (low_m + high_m)), 2.5,
                  0.0, 2.0 * ASDIC_PI);
    } else {
        trace(c, p, o->north_m, o->east_m, o->count);
        cairo_close_path(c->cr);
    }
    set_paint(c, 0xffffff, 0.55);
    cairo_fill_preserve(c->cr);
    asdic_canvas_color(c, OBJECT_RGB);
    cairo_set_line_width(c->cr, 1.4);
    cairo_stroke(c->cr);
}

static bool overlap(asdic_box a, asdic_box b) {
    return a.x < b.x + b.w && b.x < a.x + a.w && a.y < b.y + b.h && b.y < a.y + a.h;
}

/* NAME on a pale ground right of (X, Y), left where there is no room; not over what is in TAKEN. */
static void draw_name(asdic_canvas *c, const page *p, double x, double y, const char *name,
                      asdic_box taken[MOST_NAMES], size_t *count) {
    double width = asdic_canvas_text_width(name, ASDIC_NOTE_PX);
    for (int side = 0; side < 2; side++) {
        asdic_box box = {side == 0 ? x + 8.0 : x - 14.0 - width, y - 10.0, width + 6.0, 20.0};
        bool is_free = box.x > p->box.x && box.x + box.w < p->box.x + p->box.w &&
                       box.y > p->box.y && box.y + box.h < p->box.y + p->box.h;
        for (size_t i = 0; i < *count; i++) {
            is_free = is_free && !overlap(box, taken[i]);
        }
        if (is_free && *count < MOST_NAMES) {
            taken[(*count)++] = box;
            set_paint(c, 0xffffff, 0.7);
            cairo_rectangle(c->cr, box.x, box.y, box.w, box.h);
            cairo_fill(c->cr);
            asdic_canvas_color(c, INK_RGB);
            asdic_canvas_text(
                c, (asdic_text){.x = box.x + 3.0, .y = y, .align_y = 0.5, .size_px = ASDIC_NOTE_PX},
                name);
            return;
        }
    }
}

/* Names once each, at the middle of the first outline. */
static void name_objects(asdic_canvas *c, const page *p, const asdic_chart *chart,
                         asdic_box taken[MOST_NAMES], size_t *count) {
    for (size_t i = 0; i < chart->outline_count; i++) {
        const asdic_outline *o = &chart->outlines[i];
        if (i > 0 && strcmp(o->name, o[-1].name) == 0) {
            continue;
        }
        double x = 0.0, y = 0.0;
        for (size_t k = 0; k < o->count; k++) {
            x += px_x(p, o->east_m[k]) / (double)o->count;
            y += px_y(p, o->north_m[k]) / (double)o->count;
        }
        if (x > p->box.x && x < p->box.x + p->box.w && y > p->box.y && y < p->box.y + p->box.h) {
            draw_name(c, p, x, y, o->name, taken, count);
        }
    }
}

static void name_time(char text[48], const char *what, double time_s) {
    char digits[ASDIC_DIGITS_SIZE];
    asdic_digits_print(digits, "%.4g", time_s);
    snprintf(text, 48, "%s %s s", what, digits);
}

/* A ring where it begins, an arrow head where it ends. */
static void draw_track(asdic_canvas *c, const page *p, const asdic_chart *chart,
                       asdic_box taken[MOST_NAMES], size_t *count) {
    char text[48];
    size_t last = chart->track_count - 1;
    double x0 = px_x(p, chart->east_m[0]), y0 = px_y(p, chart->north_m[0]);
    double x1 = px_x(p, chart->east_m[last]), y1 = px_y(p, chart->north_m[last]);
    if (is_moving(chart)) {
        trace(c, p, chart->north_m, chart->east_m, chart->track_count);
        stroke_over(c, TRACK_RGB, 2.5, false);
        cairo_new_path(c->cr);
        cairo_arc(c->cr, x0, y0, 5.0, 0.0, 2.0 * ASDIC_PI);
        set_paint(c, 0xffffff, 1.0);
        cairo_fill_preserve(c->cr);
        stroke_over(c, TRACK_RGB, 2.5, false);
    }
    cairo_save(c->cr);
    cairo_translate(c->cr, x1, y1);
    cairo_rotate(c->cr, chart->last_yaw_rad); /* clockwise from north, as on the page */
    cairo_move_to(c->cr, 0.0, -13.0);
    cairo_line_to(c->cr, 7.5, 8.0);
    cairo_line_to(c->cr, 0.0, 4.0);
    cairo_line_to(c->cr, -7.5, 8.0);
    cairo_close_path(c->cr);
    cairo_restore(c->cr);
    asdic_canvas_color(c, TRACK_RGB);
    cairo_fill_preserve(c->cr);
    stroke_over(c, INK_RGB, 1.0, false);
    if (is_moving(chart)) {
        name_time(text, "start,", chart->first_time_s);
        draw_name(c, p, x0 + 4.0, y0, text, taken, count);
        name_time(text, "end,", chart->last_time_s);
        draw_name(c, p, x1 + 8.0, y1, text, taken, count);
    }
}

/* A round length, bottom left. */
static asdic_box draw_scale(asdic_canvas *c, const page *p) {
    char number[24], label[32];
    double length_m = asdic_axis_step((p->east_m - p->west_m) / 3.0, 2);
    double wide = length_m * p->px_per_m, x = p->box.x + 22.0, y = p->box.y + p->box.h - 20.0;
    asdic_axis_label(number, length_m, length_m);
    snprintf(label, sizeof label, "%s m", number);
    asdic_box ground = {x - 10.0, y - 30.0, wide + 20.0, 40.0};
    set_paint(c, 0xffffff, 0.8);
    cairo_rectangle(c->cr, ground.x, ground.y, ground.w, ground.h);
    cairo_fill(c->cr);
    asdic_canvas_color(c, INK_RGB);
    cairo_set_line_width(c->cr, 2.0);
    asdic_canvas_line(c, x, y, x + wide, y);
    asdic_canvas_line(c, x, y - 6.0, x, y + 6.0);
    asdic_canvas_line(c, x + wide, y - 6.0, x + wide, y + 6.0);
    asdic_canvas_text(
        c,
        (asdic_text){.x = x + 0.5 * wide, .y = y - 8.0, .align_x = 0.5, .size_px = ASDIC_NOTE_PX},
        label);
    return ground;
}

/* Top right. */
static asdic_box draw_north(asdic_canvas *c, const page *p) {
    double x = p->box.x + p->box.w - 32.0, y = p->box.y + 42.0;
    asdic_box ground = {x - 20.0, y - 34.0, 40.0, 76.0};
    set_paint(c, 0xffffff, 0.8);
    cairo_rectangle(c->cr, ground.x, ground.y, ground.w, ground.h);
    cairo_fill(c->cr);
    asdic_canvas_color(c, INK_RGB);
    cairo_new_path(c->cr);
    cairo_move_to(c->cr, x, y - 8.0);
    cairo_line_to(c->cr, x + 9.0, y + 32.0);
    cairo_line_to(c->cr, x, y + 24.0);
    cairo_line_to(c->cr, x - 9.0, y + 32.0);
    cairo_close_path(c->cr);
    cairo_fill(c->cr);
    asdic_canvas_text(
        c,
        (asdic_text){.x = x, .y = y - 14.0, .align_x = 0.5, .size_px = ASDIC_TEXT_PX, .bold = true},
        "N");
    return ground;
}

static asdic_status draw_map(asdic_canvas *c, const page *p, const asdic_chart *chart,
                             asdic_colormap map) {
    asdic_box taken[MOST_NAMES];
    size_t count = 0;
    cairo_save(c->cr);
    cairo_rectangle(c->cr, p->box.x, p->box.y, p->box.w, p->box.h);
    cairo_clip(c->cr);
    asdic_status status = draw_relief(c, p, chart->relief, map);
    for (size_t i = 0; i < chart->outline_count; i++) {
        draw_outline(c, p, &chart->outlines[i]);
    }
    draw_areas(c, p, chart);
    taken[count++] = draw_scale(c, p);
    taken[count++] = draw_north(c, p);
    draw_track(c, p, chart, taken, &count);
    name_objects(c, p, chart, taken, &count);
    cairo_restore(c->cr);
    return status;
}

asdic_status asdic_draw_chart(asdic_context *ctx, const char *path, const asdic_chart *chart,
                              const asdic_picture_options *options) {
    asdic_canvas canvas = {.format = options->format};
    page p = {0};
    lay_out(&p, chart, options);
    asdic_status status = asdic_canvas_init(ctx, path, p.width, p.height, PAPER_RGB, &canvas);
    if (status == ASDIC_OK) {
        status = draw_map(&canvas, &p, chart, options->colormap);
    }
    if (status != ASDIC_OK) {
        goto done;
    }
    asdic_canvas_axis_x(&canvas, p.box, &p.x, false);
    asdic_canvas_axis_y(&canvas, p.box, &p.y, false, false);
    asdic_canvas_color(&canvas, INK_RGB);
    cairo_rectangle(canvas.cr, p.box.x - 0.5, p.box.y - 0.5, p.box.w + 1.0, p.box.h + 1.0);
    cairo_stroke(canvas.cr);
    if (p.bar.w > 0.0) {
        asdic_canvas_scale(&canvas, p.bar, &p.depth, options->colormap, true, INK_RGB);
    }
    asdic_canvas_legend(&canvas, p.legend, p.entries, p.entry_count);
    asdic_canvas_frame_text(&canvas, p.box.x, options->title, options->note);
    asdic_canvas_text_fit(&canvas,
                          (asdic_text){.x = p.box.x,
                                       .y = p.height - ASDIC_MARGIN_PX - 1.6 * ASDIC_NOTE_PX,
                                       .size_px = ASDIC_NOTE_PX},
                          chart->caption, p.width - p.box.x - ASDIC_MARGIN_PX);
    status = asdic_canvas_save(&canvas, path, options->texts);
done:
    asdic_canvas_finish(&canvas);
    return status;
}
