#include "canvas.h"
#include "draw.h"

#include <math.h>

#define PAPER_RGB 0xffffffu
#define INK_RGB 0x202020u
#define BOX_WIDTH_PX 1040.0

bool asdic_picture_annotated(void) {
    return true;
}

static bool is_drawable(const asdic_plot_axis *axis, double value) {
    return isfinite(value) && !(axis->logarithmic && value <= 0.0);
}

static bool is_point(const asdic_plot *plot, const asdic_series *series, size_t i) {
    return i < series->count && is_drawable(&plot->x, series->x[i]) &&
           is_drawable(&plot->y, series->y[i]);
}

/* Half the length of the dash that a point without neighbours is drawn as. */
#define LONE_PX 4.0

static void draw_series(asdic_canvas *c, asdic_box box, const asdic_plot *plot,
                        const asdic_series *series) {
    bool drawing = false;
    cairo_new_path(c->cr);
    for (size_t i = 0; i < series->count; i++) {
        if (!is_point(plot, series, i)) {
            drawing = false;
            continue;
        }
        double x = box.x + box.w * asdic_axis_share(&plot->x, series->x[i]);
        double y = box.y + box.h * (1.0 - asdic_axis_share(&plot->y, series->y[i]));
        /* cairo's coordinates are 24-bit: far outside they would wrap round. */
        x = fmin(fmax(x, box.x - box.w), box.x + 2.0 * box.w);
        y = fmin(fmax(y, box.y - box.h), box.y + 2.0 * box.h);
        if (drawing) {
            cairo_line_to(c->cr, x, y);
        } else if (is_point(plot, series, i + 1)) {
            cairo_move_to(c->cr, x, y);
        } else {
            cairo_move_to(c->cr, x - LONE_PX, y);
            cairo_line_to(c->cr, x + LONE_PX, y);
        }
        drawing = true;
    }
    asdic_canvas_set_style(c, series);
    cairo_stroke(c->cr);
    asdic_canvas_set_style(c, NULL);
}

static void draw_panel(asdic_canvas *c, asdic_box box, const asdic_plot *plot) {
    asdic_canvas_axis_x(c, box, &plot->x, true);
    asdic_canvas_axis_y(c, box, &plot->y, false, true);
    cairo_save(c->cr);
    cairo_rectangle(c->cr, box.x, box.y, box.w, box.h);
    cairo_clip(c->cr);
    for (size_t i = 0; i < plot->series_count; i++) {
        draw_series(c, box, plot, &plot->series[i]);
    }
    cairo_restore(c->cr);
    cairo_new_path(c->cr);
    asdic_canvas_color(c, INK_RGB);
    cairo_rectangle(c->cr, box.x - 0.5, box.y - 0.5, box.w + 1.0, box.h + 1.0);
    cairo_stroke(c->cr);
    if (plot->title) {
        asdic_canvas_text_fit(
            c, (asdic_text){.x = box.x, .y = box.y - 10.0, .size_px = ASDIC_TEXT_PX, .bold = true},
            plot->title, box.w);
    }
}

typedef struct page {
    double left, title_y, legend_y, first_y, panel_h, pitch, width, height;
} page;

static page lay_out(const asdic_plot *panels, size_t count, const asdic_picture_options *options,
                    bool has_note) {
    page p = {.panel_h = count == 1 ? 560.0 : count == 2 ? 380.0 : 280.0};
    const asdic_box none = {.w = BOX_WIDTH_PX};
    bool titles = false;
    for (size_t i = 0; i < count; i++) {
        p.left = fmax(p.left, asdic_canvas_axis_y_room(&panels[i].y, p.panel_h));
        titles = titles || panels[i].title;
    }
    p.left = ceil(p.left) + ASDIC_MARGIN_PX;
    p.title_y = ASDIC_MARGIN_PX;
    p.legend_y = p.title_y + (options->title ? 1.7 * ASDIC_TITLE_PX : 0.0);
    p.first_y = floor(p.legend_y +
                      asdic_canvas_legend(NULL, none, panels[0].series, panels[0].series_count) +
                      (titles ? 2.2 * ASDIC_TEXT_PX : 14.0));
    p.pitch = p.panel_h + floor(4.2 * ASDIC_TEXT_PX + (titles ? 1.8 * ASDIC_TEXT_PX : 0.0));
    p.width = p.left + BOX_WIDTH_PX + 2.0 * ASDIC_MARGIN_PX;
    p.height = p.first_y + (double)(count - 1) * p.pitch + p.panel_h + 3.6 * ASDIC_TEXT_PX +
               ASDIC_MARGIN_PX + (has_note ? 1.6 * ASDIC_NOTE_PX : 0.0);
    return p;
}

asdic_status asdic_draw_plot(asdic_context *ctx, const char *path, const asdic_plot *panels,
                             size_t panel_count, const asdic_picture_options *options) {
    asdic_canvas canvas = {.format = options->format};
    char note[ASDIC_NOTE_SIZE];
    asdic_draw_note(note, options, NULL);
    page p = lay_out(panels, panel_count, options, note[0] != 0);
    asdic_status status = asdic_canvas_init(ctx, path, p.width, p.height, PAPER_RGB, &canvas);
    if (status != ASDIC_OK) {
        goto done;
    }
    asdic_canvas_legend(&canvas, (asdic_box){p.left, p.legend_y, BOX_WIDTH_PX, 0.0},
                        panels[0].series, panels[0].series_count);
    for (size_t i = 0; i < panel_count; i++) {
        asdic_box box = {p.left, p.first_y + (double)i * p.pitch, BOX_WIDTH_PX, p.panel_h};
        draw_panel(&canvas, box, &panels[i]);
    }
    asdic_canvas_frame_text(&canvas, p.left, options->title, note);
    status = asdic_canvas_save(&canvas, path, options->texts);
done:
    asdic_canvas_finish(&canvas);
    return status;
}
