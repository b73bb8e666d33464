#include "draw_chart.h"

#include "base/try.h"
#include "base/vec.h"
#include "digits.h"
#include "draw_chart_page.h"
#include "colormap.h"
#include "raster_relief.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#define SEA_RGB 0xeef2f5u /* where there is no terrain to show */
#define MOST_TAKEN 512
#define SMALL_PX 40.0      /* objects up to this size are not covered by names */
#define MOST_ASIDE_PX 24.0 /* names of larger objects stand on them */

typedef asdic_chart_page page;

static bool is_moving(const asdic_chart *chart) {
    return asdic_track_moves(chart->north_m, chart->east_m, chart->track_count);
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
    asdic_relief_look look = {.low_m = p->depth.low, .high_m = p->depth.high, .empty_rgb = SEA_RGB};
    for (unsigned i = 0; i < 256; i++) {
        look.bottom_rgb[i] = asdic_colormap_rgb(map, i);
    }
    TRY(asdic_raster_relief(c->ctx, r, &look, &raster));
    double north_m = r->south_m + (double)r->rows * r->cell_m;
    asdic_canvas_raster(c, &raster,
                        (asdic_box){asdic_chart_x(p, r->west_m), asdic_chart_y(p, north_m),
                                    (double)r->columns * r->cell_m * p->px_per_m,
                                    (double)r->rows * r->cell_m * p->px_per_m});
    asdic_raster_finish(&raster);
    return ASDIC_OK;
}

static void trace(asdic_canvas *c, const page *p, const double *north_m, const double *east_m,
                  size_t count) {
    cairo_new_path(c->cr);
    for (size_t i = 0; i < count; i++) {
        cairo_line_to(c->cr, asdic_chart_x(p, east_m[i]), asdic_chart_y(p, north_m[i]));
    }
}

static void set_paint(asdic_canvas *c, uint32_t rgb, double alpha) {
    cairo_set_source_rgba(c->cr, (rgb >> 16) / 255.0, (rgb >> 8 & 255) / 255.0, (rgb & 255) / 255.0,
                          alpha);
}

/* Strokes the current path in RGB, over a pale border that sets it off from any terrain. */
static void stroke_over(asdic_canvas *c, uint32_t rgb, double width, bool dashed) {
    const double dashes[2] = {8.0, 6.0};
    cairo_set_line_join(c->cr, CAIRO_LINE_JOIN_ROUND);
    set_paint(c, ASDIC_PAPER_RGB, 0.7);
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
        cairo_arc(c->cr, asdic_chart_x(p, 0.5 * (left_m + right_m)),
                  asdic_chart_y(p, 0.5 * (low_m + high_m)), 2.5, 0.0, 2.0 * ASDIC_PI);
    } else {
        trace(c, p, o->north_m, o->east_m, o->count);
        cairo_close_path(c->cr);
    }
    set_paint(c, ASDIC_PAPER_RGB, 0.55);
    cairo_fill_preserve(c->cr);
    asdic_canvas_color(c, ASDIC_CHART_OBJECT_RGB);
    cairo_set_line_width(c->cr, 1.4);
    cairo_stroke(c->cr);
}

/* The path of an object: a small ring at its beginning, the object at its end. */
static void draw_route(asdic_canvas *c, const page *p, const asdic_route *route) {
    cairo_new_path(c->cr);
    for (size_t i = 0; i < route->count; i++) {
        cairo_line_to(c->cr, asdic_chart_x(p, route->points[i].east_m),
                      asdic_chart_y(p, route->points[i].north_m));
    }
    stroke_over(c, ASDIC_CHART_OBJECT_RGB, 1.4, true);
    cairo_new_path(c->cr);
    cairo_arc(c->cr, asdic_chart_x(p, route->points[0].east_m),
              asdic_chart_y(p, route->points[0].north_m), 3.5, 0.0, 2.0 * ASDIC_PI);
    set_paint(c, ASDIC_PAPER_RGB, 1.0);
    cairo_fill_preserve(c->cr);
    stroke_over(c, ASDIC_CHART_OBJECT_RGB, 1.4, false);
}

/* What names shall not cover. */
typedef struct labels {
    asdic_canvas *c;
    const page *p;
    asdic_box taken[MOST_TAKEN];
    size_t count;
} labels;

static bool overlap(asdic_box a, asdic_box b) {
    return a.x < b.x + b.w && b.x < a.x + a.w && a.y < b.y + b.h && b.y < a.y + a.h;
}

static bool is_free(const labels *l, asdic_box box) {
    const asdic_box *map = &l->p->box;
    bool out = box.x > map->x && box.x + box.w < map->x + map->w && box.y > map->y &&
               box.y + box.h < map->y + map->h && l->count < MOST_TAKEN;
    for (size_t i = 0; i < l->count; i++) {
        out = out && !overlap(box, l->taken[i]);
    }
    return out;
}

/* Where a name of WIDTH goes that stands GAP_PX beside (X, Y) on SIDE of eight. */
static asdic_box place_of(double x, double y, double gap_px, double width, size_t side) {
    static const struct {
        double x, y;
    } sides[8] = {{1, 0}, {-1, 0}, {0, -1}, {0, 1}, {1, -1}, {1, 1}, {-1, -1}, {-1, 1}};
    const double high = 20.0;
    return (asdic_box){x + sides[side].x * (gap_px + 0.5 * width) - 0.5 * width,
                       y + sides[side].y * (gap_px + 0.5 * high) - 0.5 * high, width, high};
}

/* NAME on a pale background beside (X, Y), GAP_PX away or, where there is no room, farther off with
 * a line that leads there. */
static void draw_name(labels *l, double x, double y, double gap_px, const char *name) {
    asdic_canvas *c = l->c;
    double width = asdic_canvas_text_width(name, ASDIC_NOTE_PX) + 6.0;
    for (size_t i = 0; i < 40; i++) {
        double away_px = 18.0 * (double)(i / 8);
        asdic_box box = place_of(x, y, gap_px + away_px, width, i % 8);
        if (!is_free(l, box)) {
            continue;
        }
        asdic_lettering place = {
            .x = box.x + 3.0, .y = box.y + 10.0, .align_y = 0.5, .size_px = ASDIC_NOTE_PX};
        l->taken[l->count++] = box;
        if (i >= 8) {
            cairo_move_to(c->cr, x, y);
            cairo_line_to(c->cr, fmin(fmax(x, box.x), box.x + box.w),
                          fmin(fmax(y, box.y), box.y + box.h));
            stroke_over(c, ASDIC_INK_RGB, 1.0, false);
        }
        set_paint(c, ASDIC_PAPER_RGB, 0.8);
        cairo_rectangle(c->cr, box.x, box.y, box.w, box.h);
        cairo_fill(c->cr);
        asdic_canvas_color(c, ASDIC_INK_RGB);
        asdic_canvas_text(c, place, name);
        return;
    }
}

/* No name covers the small objects, which it would hide. */
static void keep_clear(labels *l, const asdic_chart *chart) {
    const page *p = l->p;
    for (size_t i = 0; i < chart->outline_count && l->count < MOST_TAKEN / 2; i++) {
        const asdic_outline *o = &chart->outlines[i];
        double left = INFINITY, right = -INFINITY, top = INFINITY, bottom = -INFINITY;
        for (size_t k = 0; k < o->count; k++) {
            double x = asdic_chart_x(p, o->east_m[k]), y = asdic_chart_y(p, o->north_m[k]);
            left = fmin(left, x);
            right = fmax(right, x);
            top = fmin(top, y);
            bottom = fmax(bottom, y);
        }
        if (right - left < SMALL_PX && bottom - top < SMALL_PX) {
            l->taken[l->count++] =
                (asdic_box){left - 3.0, top - 3.0, right - left + 6.0, bottom - top + 6.0};
        }
    }
}

static double half_width_m(const asdic_outline *o) {
    double west_m = INFINITY, east_m = -INFINITY;
    for (size_t k = 0; k < o->count; k++) {
        west_m = fmin(west_m, o->east_m[k]);
        east_m = fmax(east_m, o->east_m[k]);
    }
    return 0.5 * (east_m - west_m);
}

/* How far from the middle of an outline its name stands: beside it where it is small or cannot hold
 * the name, else on it, clear of its sides. */
static double gap_of(const page *p, const asdic_outline *o) {
    double half_px = half_width_m(o) * p->px_per_m;
    double wide_px = asdic_canvas_text_width(o->name, ASDIC_NOTE_PX) + 10.0;
    bool is_beside = half_px <= MOST_ASIDE_PX || half_px < 0.5 * wide_px;
    return is_beside ? 8.0 + half_px : fmin(8.0 + MOST_ASIDE_PX, half_px - wide_px);
}

/* Writes each name once, at the middle of its first outline on the map. */
static void name_objects(labels *l, const asdic_chart *chart) {
    const page *p = l->p;
    const char *named = "";
    for (size_t i = 0; i < chart->outline_count; i++) {
        const asdic_outline *o = &chart->outlines[i];
        if (strcmp(o->name, named) == 0) {
            continue;
        }
        double x = 0.0, y = 0.0;
        for (size_t k = 0; k < o->count; k++) {
            x += asdic_chart_x(p, o->east_m[k]) / (double)o->count;
            y += asdic_chart_y(p, o->north_m[k]) / (double)o->count;
        }
        if (x > p->box.x && x < p->box.x + p->box.w && y > p->box.y && y < p->box.y + p->box.h) {
            draw_name(l, x, y, gap_of(p, o), o->name);
            named = o->name;
        }
    }
}

static void name_time(char text[48], const char *what, double time_s) {
    char digits[ASDIC_DIGITS_SIZE];
    asdic_digits_time(digits, time_s);
    snprintf(text, 48, "%s %s s", what, digits);
}

/* A ring at the beginning, an arrow head at the end. */
static void draw_track(labels *l, const asdic_chart *chart) {
    asdic_canvas *c = l->c;
    const page *p = l->p;
    char text[48];
    size_t last = chart->track_count - 1;
    double x0 = asdic_chart_x(p, chart->east_m[0]), y0 = asdic_chart_y(p, chart->north_m[0]);
    double x1 = asdic_chart_x(p, chart->east_m[last]), y1 = asdic_chart_y(p, chart->north_m[last]);
    if (is_moving(chart)) {
        trace(c, p, chart->north_m, chart->east_m, chart->track_count);
        stroke_over(c, ASDIC_CHART_TRACK_RGB, 2.5, false);
        cairo_new_path(c->cr);
        cairo_arc(c->cr, x0, y0, 5.0, 0.0, 2.0 * ASDIC_PI);
        set_paint(c, ASDIC_PAPER_RGB, 1.0);
        cairo_fill_preserve(c->cr);
        stroke_over(c, ASDIC_CHART_TRACK_RGB, 2.5, false);
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
    asdic_canvas_color(c, ASDIC_CHART_TRACK_RGB);
    cairo_fill_preserve(c->cr);
    stroke_over(c, ASDIC_INK_RGB, 1.0, false);
    l->taken[l->count++] = (asdic_box){x1 - 10.0, y1 - 10.0, 20.0, 20.0};
    if (is_moving(chart)) {
        l->taken[l->count++] = (asdic_box){x0 - 8.0, y0 - 8.0, 16.0, 16.0};
        name_time(text, "start,", chart->first_time_s);
        draw_name(l, x0, y0, 12.0, text);
        name_time(text, "end,", chart->last_time_s);
        draw_name(l, x1, y1, 16.0, text);
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
    set_paint(c, ASDIC_PAPER_RGB, 0.8);
    cairo_rectangle(c->cr, ground.x, ground.y, ground.w, ground.h);
    cairo_fill(c->cr);
    asdic_canvas_color(c, ASDIC_INK_RGB);
    cairo_set_line_width(c->cr, 2.0);
    asdic_canvas_line(c, x, y, x + wide, y);
    asdic_canvas_line(c, x, y - 6.0, x, y + 6.0);
    asdic_canvas_line(c, x + wide, y - 6.0, x + wide, y + 6.0);
    asdic_canvas_text(
        c,
        (asdic_lettering){
            .x = x + 0.5 * wide, .y = y - 8.0, .align_x = 0.5, .size_px = ASDIC_NOTE_PX},
        label);
    return ground;
}

/* Top right. */
static asdic_box draw_north(asdic_canvas *c, const page *p) {
    double x = p->box.x + p->box.w - 32.0, y = p->box.y + 42.0;
    asdic_box ground = {x - 20.0, y - 34.0, 40.0, 76.0};
    set_paint(c, ASDIC_PAPER_RGB, 0.8);
    cairo_rectangle(c->cr, ground.x, ground.y, ground.w, ground.h);
    cairo_fill(c->cr);
    asdic_canvas_color(c, ASDIC_INK_RGB);
    cairo_new_path(c->cr);
    cairo_move_to(c->cr, x, y - 8.0);
    cairo_line_to(c->cr, x + 9.0, y + 32.0);
    cairo_line_to(c->cr, x, y + 24.0);
    cairo_line_to(c->cr, x - 9.0, y + 32.0);
    cairo_close_path(c->cr);
    cairo_fill(c->cr);
    asdic_canvas_text(
        c,
        (asdic_lettering){
            .x = x, .y = y - 14.0, .align_x = 0.5, .size_px = ASDIC_TEXT_PX, .bold = true},
        "N");
    return ground;
}

static asdic_status draw_map(asdic_canvas *c, const page *p, const asdic_chart *chart,
                             asdic_colormap map) {
    labels l = {.c = c, .p = p};
    cairo_save(c->cr);
    cairo_rectangle(c->cr, p->box.x, p->box.y, p->box.w, p->box.h);
    cairo_clip(c->cr);
    asdic_status status = draw_relief(c, p, chart->relief, map);
    for (size_t i = 0; i < chart->route_count; i++) {
        draw_route(c, p, &chart->routes[i]);
    }
    for (size_t i = 0; i < chart->outline_count; i++) {
        draw_outline(c, p, &chart->outlines[i]);
    }
    draw_areas(c, p, chart);
    l.taken[l.count++] = draw_scale(c, p);
    l.taken[l.count++] = draw_north(c, p);
    for (size_t i = 0; i < chart->route_count && l.count < MOST_TAKEN / 4; i++) {
        const asdic_route_point *end = &chart->routes[i].points[chart->routes[i].count - 1];
        l.taken[l.count++] = (asdic_box){asdic_chart_x(p, end->east_m) - 5.0,
                                         asdic_chart_y(p, end->north_m) - 5.0, 10.0, 10.0};
    }
    keep_clear(&l, chart);
    draw_track(&l, chart);
    name_objects(&l, chart);
    cairo_restore(c->cr);
    return status;
}

asdic_status asdic_draw_chart(asdic_context *ctx, const char *path, const asdic_chart *chart,
                              const asdic_picture_options *options) {
    asdic_canvas canvas = {.format = options->format};
    page p;
    asdic_chart_page_init(&p, chart, options);
    asdic_status status = asdic_canvas_init(ctx, path, p.width, p.height, ASDIC_PAPER_RGB, &canvas);
    status = status ? status : draw_map(&canvas, &p, chart, options->colormap);
    if (!status) {
        asdic_canvas_axis_x(&canvas, p.box, &p.x, false);
        asdic_canvas_axis_y(&canvas, p.box, &p.y, false, false);
        asdic_canvas_frame(&canvas, p.box);
        if (p.bar.w > 0.0) {
            asdic_canvas_scale(&canvas, p.bar, &p.depth, options->colormap, true);
        }
        asdic_canvas_legend(&canvas, p.legend, p.entries, p.entry_count);
        asdic_canvas_frame_text(&canvas, p.box.x, options->title, options->note);
        status = asdic_canvas_save(&canvas, path, options->texts);
    }
    asdic_canvas_finish(&canvas);
    return status;
}
