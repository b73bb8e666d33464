#include "canvas.h"
#include "draw.h"

#include "base/vec.h"

#include <math.h>
#include <stdio.h>

#define RING_RGB 0x8b98a5u
#define OUTER_LABEL_PX 16.0 /* the outermost range of a full circle stands inside */
#define LABEL_ROOM_PX 56.0  /* bearings outside the arc, ranges along the edge */

typedef struct page {
    asdic_sector sector;
    double apex_x, apex_y; /* on the page */
    asdic_box image, bar;
    double width, height;
} page;

static page lay_out(const asdic_fan *fan, const asdic_picture_options *options, const char *note) {
    page p = {.sector = asdic_sector_of(fan, 1000.0)};
    /* At most 1000 pixels wide and 760 high. */
    double shrink = fmin(1000.0 / (double)p.sector.width, 760.0 / (double)p.sector.height);
    p.sector = asdic_sector_of(fan, floor(1000.0 * fmin(shrink, 1.0)));
    p.image = (asdic_box){ASDIC_MARGIN_PX + LABEL_ROOM_PX,
                          ASDIC_MARGIN_PX + LABEL_ROOM_PX + asdic_canvas_title_room(options->title),
                          (double)p.sector.width, (double)p.sector.height};
    p.apex_x = p.image.x + p.sector.apex_x_px;
    p.apex_y = p.image.y + p.sector.apex_y_px;
    p.bar = (asdic_box){p.image.x + p.image.w + LABEL_ROOM_PX + 40.0, p.image.y, ASDIC_BAR_PX,
                        p.image.h};
    p.width = p.bar.x + p.bar.w + asdic_canvas_color_bar_room(options, p.bar.h) + ASDIC_MARGIN_PX;
    p.width = fmax(p.width, 700.0); /* of the texts */
    p.height = p.image.y + p.image.h + LABEL_ROOM_PX + ASDIC_MARGIN_PX +
               asdic_canvas_note_room(note, ASDIC_MARGIN_PX, p.width);
    return p;
}

static void place(const page *p, double radius_px, double bearing_rad, double *x, double *y) {
    *x = p->apex_x + radius_px * sin(bearing_rad);
    *y = p->apex_y - radius_px * cos(bearing_rad);
}

/* cairo measures angles from x towards y: clockwise on the page, as bearings, but from the east. */
static void arc(asdic_canvas *c, const page *p, double radius_px) {
    cairo_new_path(c->cr);
    cairo_arc(c->cr, p->apex_x, p->apex_y, radius_px, p->sector.low_rad - 0.5 * ASDIC_PI,
              p->sector.high_rad - 0.5 * ASDIC_PI);
    cairo_stroke(c->cr);
}

static bool is_full_circle(const page *p) {
    return p->sector.high_rad - p->sector.low_rad > 2.0 * ASDIC_PI - 1e-6;
}

/* LABEL on a plate, astern on the ring of RADIUS_PX: a full circle has no edge to write along. */
static void label_astern(asdic_canvas *c, const page *p, double radius_px, const char *label) {
    double x = p->apex_x, y = p->apex_y + radius_px;
    double wide = asdic_canvas_text_width(label, ASDIC_TEXT_PX) + 8.0, high = 1.2 * ASDIC_TEXT_PX;
    cairo_set_source_rgba(c->cr, 1.0, 1.0, 1.0, 0.8);
    cairo_rectangle(c->cr, x - 0.5 * wide, y - 0.5 * high, wide, high);
    cairo_fill(c->cr);
    asdic_canvas_color(c, ASDIC_INK_RGB);
    asdic_canvas_text(
        c,
        (asdic_lettering){.x = x, .y = y, .align_x = 0.5, .align_y = 0.5, .size_px = ASDIC_TEXT_PX},
        label);
}

/* LABEL beside the starboard edge, where the ring of RADIUS_PX ends. */
static void label_ring(asdic_canvas *c, const page *p, double radius_px, const char *label) {
    double edge = p->sector.high_rad, x, y;
    if (is_full_circle(p)) {
        label_astern(c, p, radius_px, label);
        return;
    }
    double out_x = cos(edge), out_y = sin(edge); /* across the edge, away from the sector */
    place(p, radius_px, edge, &x, &y);
    asdic_canvas_line(c, x, y, x + 7.0 * out_x, y + 7.0 * out_y);
    asdic_canvas_color(c, ASDIC_INK_RGB);
    asdic_canvas_text(c,
                      (asdic_lettering){.x = x + 12.0 * out_x,
                                        .y = y + 12.0 * out_y,
                                        .align_x = out_x > 0.3    ? 0.0
                                                   : out_x < -0.3 ? 1.0
                                                                  : 0.5,
                                        .align_y = 0.5 + 0.5 * out_y,
                                        .size_px = ASDIC_TEXT_PX},
                      label);
}

/* Rings at round ranges and the outermost, labelled along the starboard edge. */
static void draw_rings(asdic_canvas *c, const page *p, double max_range_m) {
    double step = asdic_axis_step(max_range_m, 6);
    double fine = fmin(pow(10.0, floor(log10(max_range_m)) - 3.0), 1.0); /* four digits */
    double outside_m = fine * rint(max_range_m / fine);
    char number[24], label[32];
    /* A ring whose label would touch the outermost's is left out. */
    double apart_px = is_full_circle(p) ? OUTER_LABEL_PX + 1.6 * ASDIC_TEXT_PX
                                        : 3.6 * ASDIC_TEXT_PX * fabs(sin(p->sector.high_rad)) +
                                              1.2 * ASDIC_TEXT_PX * fabs(cos(p->sector.high_rad));
    double apart_m = fmax(0.3 * step, apart_px * max_range_m / p->sector.radius_px);
    for (double range_m = step; range_m < max_range_m - apart_m; range_m += step) {
        double radius = p->sector.radius_px * range_m / max_range_m;
        asdic_canvas_color(c, RING_RGB);
        cairo_set_line_width(c->cr, 1.0);
        arc(c, p, radius);
        asdic_axis_label(number, range_m, step);
        label_ring(c, p, radius, number);
    }
    /* As many as it has: 75 m, 74.5 m, 0.37 m. */
    double digit = 1.0;
    while (digit > 0.5 * fine && fabs(outside_m - digit * rint(outside_m / digit)) > 0.05 * digit) {
        digit *= 0.1;
    }
    asdic_axis_label(number, outside_m, digit);
    snprintf(label, sizeof label, "%s m", number);
    asdic_canvas_color(c, RING_RGB);
    label_ring(c, p, p->sector.radius_px - (is_full_circle(p) ? OUTER_LABEL_PX : 0.0), label);
}

double asdic_fan_shown_deg(bool is_section, double bearing_deg) {
    double deg = remainder(bearing_deg, 360.0);
    if (is_section) {
        return 90.0 - fabs(remainder(bearing_deg - 180.0, 360.0));
    }
    return deg <= -180.0 ? 180.0 : deg;
}

/* Ticks outside the arc, every 5, 10, 15, 30 or 45 degrees. */
static void draw_bearings(asdic_canvas *c, const page *p, bool is_section) {
    static const double steps_deg[] = {1.0, 2.0, 5.0, 10.0, 15.0, 30.0, 45.0};
    double degree = ASDIC_PI / 180.0, step = 45.0;
    for (size_t i = sizeof steps_deg / sizeof *steps_deg; i-- > 0;) {
        /* A label wants 70 pixels of arc. */
        if (steps_deg[i] * degree * p->sector.radius_px >= 70.0) {
            step = steps_deg[i];
        }
    }
    double first = ceil(p->sector.low_rad / degree / step - 1e-6) * step;
    double last = p->sector.high_rad / degree + 1e-6;
    last -= is_full_circle(p) ? 1.0 : 0.0; /* -180 and 180 are the same */
    for (double bearing = first; bearing <= last; bearing += step) {
        double x0, y0, x1, y1, x2, y2, angle = bearing * degree;
        char number[24], label[32];
        place(p, p->sector.radius_px, angle, &x0, &y0);
        place(p, p->sector.radius_px + 8.0, angle, &x1, &y1);
        place(p, p->sector.radius_px + 14.0, angle, &x2, &y2);
        asdic_canvas_color(c, RING_RGB);
        asdic_canvas_line(c, x0, y0, x1, y1);
        asdic_axis_label(number, asdic_fan_shown_deg(is_section, bearing), 1.0);
        snprintf(label, sizeof label, "%s\u00b0", number);
        asdic_canvas_color(c, ASDIC_INK_RGB);
        asdic_canvas_text(c,
                          (asdic_lettering){.x = x2,
                                            .y = y2,
                                            .align_x = 0.5 - 0.5 * sin(angle),
                                            .align_y = 0.5 - 0.5 * cos(angle),
                                            .size_px = ASDIC_TEXT_PX},
                          label);
    }
}

static void draw_outline(asdic_canvas *c, const page *p) {
    double x, y;
    asdic_canvas_color(c, RING_RGB);
    cairo_set_line_width(c->cr, 1.0);
    arc(c, p, p->sector.radius_px);
    if (is_full_circle(p)) {
        return;
    }
    place(p, p->sector.radius_px, p->sector.low_rad, &x, &y);
    asdic_canvas_line(c, p->apex_x, p->apex_y, x, y);
    place(p, p->sector.radius_px, p->sector.high_rad, &x, &y);
    asdic_canvas_line(c, p->apex_x, p->apex_y, x, y);
}

static void decorate(asdic_canvas *c, const page *p, const asdic_fan *fan,
                     const asdic_picture_options *options, const char *note) {
    draw_outline(c, p);
    draw_rings(c, p, (double)fan->bins * fan->bin_length_m);
    draw_bearings(c, p, fan->is_section);
    asdic_canvas_color_bar(c, p->bar, options);
    asdic_canvas_frame_text(c, ASDIC_MARGIN_PX, options->title, note);
}

asdic_status asdic_draw_fan(asdic_context *ctx, const char *path, const asdic_fan *fan,
                            const asdic_picture_options *options) {
    char note[ASDIC_NOTE_SIZE];
    asdic_canvas canvas = {.format = options->format};
    asdic_raster raster = {0};
    asdic_draw_note(note, options, NULL);
    page p = lay_out(fan, options, note);
    asdic_status status = asdic_raster_fan(ctx, fan, &p.sector, options, ASDIC_PAPER_RGB, &raster);
    status =
        status ? status : asdic_canvas_init(ctx, path, p.width, p.height, ASDIC_PAPER_RGB, &canvas);
    if (!status) {
        asdic_canvas_raster(&canvas, &raster, p.image);
        decorate(&canvas, &p, fan, options, note);
        status = asdic_canvas_save(&canvas, path, options->texts);
    }
    asdic_canvas_finish(&canvas);
    asdic_raster_finish(&raster);
    return status;
}
