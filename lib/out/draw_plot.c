#include "canvas.h"
#include "draw.h"

#include <math.h>
#include <string.h>

#define BOX_WIDTH_PX 1040.0

bool asdic_picture_annotated(void) {
    return true;
}

/* Without X_LABEL a panel below has the same abscissa. */
static void draw_panel(asdic_canvas *c, asdic_box box, const asdic_plot *plot, bool x_label) {
    asdic_plot_axis x = plot->x;
    x.label = x_label ? x.label : NULL;
    asdic_canvas_axis_x(c, box, &x, true);
    asdic_canvas_axis_y(c, box, &plot->y, false, true);
    cairo_save(c->cr);
    cairo_rectangle(c->cr, box.x, box.y, box.w, box.h);
    cairo_clip(c->cr);
    for (size_t i = 0; i < plot->series_count; i++) {
        asdic_canvas_curve(c, box, &plot->x, &plot->y, &plot->series[i]);
    }
    cairo_restore(c->cr);
    asdic_canvas_frame(c, box);
    if (plot->title) {
        asdic_canvas_text_fit(
            c,
            (asdic_lettering){
                .x = box.x, .y = box.y - 10.0, .size_px = ASDIC_TEXT_PX, .bold = true},
            plot->title, box.w);
    }
}

/* Curves that the first panel's legend does not name get one beside the panel's title, which ends
 * above BOX, or above a title that takes most of the row. Returns how much room it takes above that
 * row; draws it on CANVAS unless that is NULL. */
static double draw_own_legend(asdic_canvas *c, asdic_box box, const asdic_plot *plot,
                              const asdic_plot *first) {
    for (size_t i = 0; i < first->series_count; i++) {
        const char *a = first->series[i].label,
                   *b = plot->series_count ? plot->series->label : NULL;
        if (!b || (a && strcmp(a, b) == 0)) {
            return 0.0;
        }
    }
    double room =
        plot->title ? asdic_canvas_text_width(plot->title, ASDIC_TEXT_PX) * 1.2 + 30.0 : 0;
    bool is_beside = room <= 0.5 * box.w;
    room = is_beside ? room : 0.0;
    asdic_box where = {box.x + room, box.y - 1.7 * ASDIC_TEXT_PX, box.w - room, 0};
    double more = asdic_canvas_legend(NULL, where, plot->series, plot->series_count) -
                  (is_beside ? 1.5 * ASDIC_TEXT_PX : 0.0);
    more = fmax(more, 0.0);
    where.y -= more;
    if (c) {
        asdic_canvas_legend(c, where, plot->series, plot->series_count);
    }
    return more;
}

typedef struct page {
    bool common; /* one abscissa for all panels, labelled once */
    double left, title_y, legend_y, first_y, panel_h, pitch, width, height;
} page;

static bool has_common_x(const asdic_plot *panels, size_t count) {
    for (size_t i = 1; i < count; i++) {
        const asdic_plot_axis *a = &panels[0].x, *b = &panels[i].x;
        if (!a->label || !b->label || strcmp(a->label, b->label) != 0 || a->low != b->low ||
            a->high != b->high || a->logarithmic != b->logarithmic) {
            return false;
        }
    }
    return true;
}

static page lay_out(const asdic_plot *panels, size_t count, const asdic_picture_options *options,
                    const char *note) {
    page p = {.common = has_common_x(panels, count),
              .panel_h = count == 1 ? 560.0 : fmax(150.0, floor(860.0 / (double)count - 50.0))};
    const asdic_box none = {.w = BOX_WIDTH_PX};
    bool titles = false;
    for (size_t i = 0; i < count; i++) {
        p.left = fmax(p.left, asdic_canvas_axis_y_room(&panels[i].y, p.panel_h));
        titles = titles || panels[i].title;
    }
    p.left = ceil(p.left) + ASDIC_MARGIN_PX;
    p.title_y = ASDIC_MARGIN_PX;
    p.legend_y = p.title_y + asdic_canvas_title_room(options->title);
    p.first_y = floor(p.legend_y +
                      asdic_canvas_legend(NULL, none, panels[0].series, panels[0].series_count) +
                      (titles ? 2.2 * ASDIC_TEXT_PX : 14.0));
    p.pitch = p.panel_h +
              floor((p.common ? 2.2 : 4.2) * ASDIC_TEXT_PX + (titles ? 1.8 * ASDIC_TEXT_PX : 0.0));
    p.width = p.left + BOX_WIDTH_PX + 2.0 * ASDIC_MARGIN_PX;
    p.height = p.first_y + (double)(count - 1) * p.pitch + p.panel_h + 3.6 * ASDIC_TEXT_PX +
               ASDIC_MARGIN_PX + asdic_canvas_note_room(note, p.left, p.width);
    for (size_t i = 0; i < count; i++) {
        p.height += draw_own_legend(NULL, none, &panels[i], panels);
    }
    return p;
}

asdic_status asdic_draw_plot(asdic_context *ctx, const char *path, const asdic_plot *panels,
                             size_t panel_count, const asdic_picture_options *options) {
    asdic_canvas canvas = {.format = options->format};
    char note[ASDIC_NOTE_SIZE];
    asdic_draw_note(note, options, NULL);
    page p = lay_out(panels, panel_count, options, note);
    asdic_status status = asdic_canvas_init(ctx, path, p.width, p.height, ASDIC_PAPER_RGB, &canvas);
    if (!status) {
        asdic_canvas_legend(&canvas, (asdic_box){p.left, p.legend_y, BOX_WIDTH_PX, 0.0},
                            panels[0].series, panels[0].series_count);
        asdic_box box = {p.left, p.first_y, BOX_WIDTH_PX, p.panel_h};
        for (size_t i = 0; i < panel_count; i++) {
            box.y += draw_own_legend(NULL, box, &panels[i], panels);
            draw_panel(&canvas, box, &panels[i], !p.common || i + 1 == panel_count);
            draw_own_legend(&canvas, box, &panels[i], panels);
            box.y += p.pitch;
        }
        asdic_canvas_frame_text(&canvas, p.left, options->title, note);
        status = asdic_canvas_save(&canvas, path, options->texts);
    }
    asdic_canvas_finish(&canvas);
    return status;
}
