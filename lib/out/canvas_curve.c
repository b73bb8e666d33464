/*
 * A curve within a box.
 */
#include "canvas.h"

#include "base/vec.h"

#include <math.h>

static bool is_drawable(const asdic_plot_axis *axis, double value) {
    return isfinite(value) && !(axis->logarithmic && value <= 0.0);
}

static bool is_point(const asdic_plot_axis *x, const asdic_plot_axis *y, const asdic_series *series,
                     size_t i) {
    return i < series->count && is_drawable(x, series->x[i]) && is_drawable(y, series->y[i]);
}

/* A point without neighbours is drawn as a dot of this radius. */
#define LONE_PX 2.0

/* Apart from the current path. */
static void dot(asdic_canvas *c, double x, double y, uint32_t rgb) {
    cairo_path_t *path = cairo_copy_path(c->cr);
    cairo_new_path(c->cr);
    asdic_canvas_color(c, rgb);
    cairo_arc(c->cr, x, y, LONE_PX, 0.0, 2.0 * ASDIC_PI);
    cairo_fill(c->cr);
    cairo_append_path(c->cr, path);
    cairo_path_destroy(path);
}

/* Where a path crosses itself is searched for in a time that grows faster than its length: a solid
 * line, which does not show it, is stroked in pieces of so many points. */
#define PIECE_POINTS 256

static void stroke(asdic_canvas *c, const asdic_series *series) {
    asdic_canvas_set_style(c, series);
    cairo_stroke(c->cr);
    asdic_canvas_set_style(c, NULL);
}

void asdic_canvas_curve(asdic_canvas *c, asdic_box box, const asdic_plot_axis *x_axis,
                        const asdic_plot_axis *y_axis, const asdic_series *series) {
    bool drawing = false;
    size_t points = 0;
    cairo_new_path(c->cr);
    for (size_t i = 0; i < series->count; i++) {
        if (!is_point(x_axis, y_axis, series, i)) {
            drawing = false;
            continue;
        }
        double x = box.x + box.w * asdic_axis_share(x_axis, series->x[i]);
        double y = box.y + box.h * (1.0 - asdic_axis_share(y_axis, series->y[i]));
        /* cairo's coordinates are 24-bit: far outside they would wrap round. */
        x = fmin(fmax(x, box.x - box.w), box.x + 2.0 * box.w);
        y = fmin(fmax(y, box.y - box.h), box.y + 2.0 * box.h);
        if (drawing) {
            cairo_line_to(c->cr, x, y);
            if (++points % PIECE_POINTS == 0 && series->style == ASDIC_LINE_SOLID) {
                stroke(c, series);
                cairo_move_to(c->cr, x, y);
            }
        } else if (is_point(x_axis, y_axis, series, i + 1)) {
            cairo_move_to(c->cr, x, y);
        } else {
            dot(c, x, y, series->rgb);
        }
        drawing = true;
    }
    stroke(c, series);
}
