#include "canvas.h"
#include "draw.h"

#include <math.h>

#define PAPER_RGB 0xffffffu
#define INK_RGB 0x202020u
#define NOTE_RGB 0x606060u
#define BOX_WIDTH_PX 1040.0
#define SAMPLE_PX 44.0 /* a legend entry's piece of line */

bool asdic_picture_annotated(void) {
    return true;
}

static void set_style(asdic_canvas *c, const asdic_series *series) {
    double w = 1.5 * series->width;
    const double dashed[] = {5.0 * w, 3.0 * w};
    const double dotted[] = {0.0, 2.5 * w};
    const double dash_dot[] = {6.0 * w, 2.5 * w, 1.2 * w, 2.5 * w};
    cairo_set_line_width(c->cr, w);
    cairo_set_line_join(c->cr, CAIRO_LINE_JOIN_ROUND);
    cairo_set_line_cap(c->cr, CAIRO_LINE_CAP_BUTT);
    asdic_canvas_color(c, series->rgb);
    switch (series->style) {
    case ASDIC_LINE_SOLID:
        cairo_set_dash(c->cr, NULL, 0, 0.0);
        break;
    case ASDIC_LINE_DASHED:
        cairo_set_dash(c->cr, dashed, 2, 0.0);
        break;
    case ASDIC_LINE_DOTTED: /* round caps of dashes without length are dots */
        cairo_set_line_cap(c->cr, CAIRO_LINE_CAP_ROUND);
        cairo_set_dash(c->cr, dotted, 2, 0.0);
        break;
    case ASDIC_LINE_DASH_DOT:
        cairo_set_dash(c->cr, dash_dot, 4, 0.0);
        break;
    }
}

static void reset_style(asdic_canvas *c) {
    cairo_set_dash(c->cr, NULL, 0, 0.0);
    cairo_set_line_cap(c->cr, CAIRO_LINE_CAP_BUTT);
    cairo_set_line_width(c->cr, 1.0);
}

static bool is_drawable(const asdic_plot_axis *axis, double value) {
    return isfinite(value) && !(axis->logarithmic && value <= 0.0);
}

static void draw_series(asdic_canvas *c, asdic_box box, const asdic_plot *plot,
                        const asdic_series *series) {
    bool drawing = false;
    cairo_new_path(c->cr);
    for (size_t i = 0; i < series->count; i++) {
        if (!is_drawable(&plot->x, series->x[i]) || !is_drawable(&plot->y, series->y[i])) {
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
        } else {
            cairo_move_to(c->cr, x, y);
            cairo_line_to(c->cr, x, y); /* a lone point is drawn as a dot */
        }
        drawing = true;
    }
    set_style(c, series);
    cairo_stroke(c->cr);
    reset_style(c);
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

/* Entries side by side, as many rows as they need; with C NULL only measures. Returns rows. */
static unsigned draw_legend(asdic_canvas *c, double x0, double y0, const asdic_plot *plot) {
    double x = x0;
    unsigned rows = 0;
    for (size_t i = 0; i < plot->series_count; i++) {
        const asdic_series *series = &plot->series[i];
        if (!series->label) {
            continue;
        }
        double wide = SAMPLE_PX + 10.0 + asdic_canvas_text_width(series->label, ASDIC_TEXT_PX);
        rows = rows ? rows : 1;
        if (x > x0 && x + wide > x0 + BOX_WIDTH_PX) {
            rows++;
            x = x0;
        }
        if (c) {
            double y = y0 + ((double)rows - 0.5) * 1.5 * ASDIC_TEXT_PX;
            set_style(c, series);
            asdic_canvas_line(c, x, y, x + SAMPLE_PX, y);
            reset_style(c);
            asdic_canvas_color(c, INK_RGB);
            asdic_canvas_text(
                c,
                (asdic_text){
                    .x = x + SAMPLE_PX + 10.0, .y = y, .align_y = 0.5, .size_px = ASDIC_TEXT_PX},
                series->label);
        }
        x += wide + 28.0;
    }
    return rows;
}

typedef struct page {
    double left, title_y, legend_y, first_y, panel_h, pitch, width, height;
} page;

static page lay_out(const asdic_plot *panels, size_t count, const asdic_picture_options *options,
                    bool has_note) {
    page p = {.panel_h = count == 1 ? 560.0 : count == 2 ? 380.0 : 280.0};
    bool titles = false;
    for (size_t i = 0; i < count; i++) {
        p.left = fmax(p.left, asdic_canvas_axis_y_room(&panels[i].y, p.panel_h));
        titles = titles || panels[i].title;
    }
    p.left = ceil(p.left) + ASDIC_MARGIN_PX;
    p.title_y = ASDIC_MARGIN_PX;
    p.legend_y = p.title_y + (options->title ? 1.7 * ASDIC_TITLE_PX : 0.0);
    p.first_y = floor(p.legend_y + draw_legend(NULL, 0.0, 0.0, &panels[0]) * 1.5 * ASDIC_TEXT_PX +
                      (titles ? 2.2 * ASDIC_TEXT_PX : 14.0));
    p.pitch = p.panel_h + floor(4.2 * ASDIC_TEXT_PX + (titles ? 1.8 * ASDIC_TEXT_PX : 0.0));
    p.width = p.left + BOX_WIDTH_PX + 2.0 * ASDIC_MARGIN_PX;
    p.height = p.first_y + (double)(count - 1) * p.pitch + p.panel_h + 3.6 * ASDIC_TEXT_PX +
               ASDIC_MARGIN_PX + (has_note ? 1.6 * ASDIC_NOTE_PX : 0.0);
    return p;
}

asdic_status asdic_draw_plot(asdic_context *ctx, const char *path, const asdic_plot *panels,
                             size_t panel_count, const asdic_picture_options *options) {
    asdic_canvas canvas = {0};
    char note[ASDIC_NOTE_SIZE];
    asdic_draw_note(note, options, NULL);
    page p = lay_out(panels, panel_count, options, note[0] != 0);
    asdic_status status = asdic_canvas_init(ctx, path, p.width, p.height, PAPER_RGB, &canvas);
    if (status != ASDIC_OK) {
        goto done;
    }
    asdic_canvas_color(&canvas, INK_RGB);
    if (options->title) {
        asdic_canvas_text_fit(&canvas,
                              (asdic_text){.x = p.left,
                                           .y = p.title_y,
                                           .align_y = 1.0,
                                           .size_px = ASDIC_TITLE_PX,
                                           .bold = true},
                              options->title, BOX_WIDTH_PX);
    }
    draw_legend(&canvas, p.left, p.legend_y, &panels[0]);
    for (size_t i = 0; i < panel_count; i++) {
        asdic_box box = {p.left, p.first_y + (double)i * p.pitch, BOX_WIDTH_PX, p.panel_h};
        draw_panel(&canvas, box, &panels[i]);
    }
    asdic_canvas_color(&canvas, NOTE_RGB);
    asdic_canvas_text_fit(
        &canvas,
        (asdic_text){.x = p.left, .y = p.height - ASDIC_MARGIN_PX, .size_px = ASDIC_NOTE_PX}, note,
        BOX_WIDTH_PX);
    status = asdic_canvas_save(&canvas, path, options->texts);
done:
    asdic_canvas_finish(&canvas);
    return status;
}
