/*
 * Line styles and legends.
 */
#include "canvas.h"

#define INK_RGB 0x202020u
#define SAMPLE_PX 36.0 /* an entry's piece of line */
#define BESIDE_PX 10.0 /* from there to its name */
#define APART_PX 24.0
#define ROW_PX (1.5 * ASDIC_TEXT_PX)

void asdic_canvas_set_style(asdic_canvas *c, const asdic_series *series) {
    if (!series) {
        cairo_set_dash(c->cr, NULL, 0, 0.0);
        cairo_set_line_cap(c->cr, CAIRO_LINE_CAP_BUTT);
        cairo_set_line_width(c->cr, 1.0);
        return;
    }
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

double asdic_canvas_legend(asdic_canvas *c, asdic_box box, const asdic_series *entries,
                           size_t count) {
    double x = box.x;
    unsigned rows = 0;
    for (size_t i = 0; i < count; i++) {
        const asdic_series *entry = &entries[i];
        if (!entry->label) {
            continue;
        }
        double wide = SAMPLE_PX + BESIDE_PX + asdic_canvas_text_width(entry->label, ASDIC_TEXT_PX);
        rows = rows ? rows : 1;
        if (x > box.x && x + wide > box.x + box.w) {
            rows++;
            x = box.x;
        }
        if (c) {
            double y = box.y + ((double)rows - 0.5) * ROW_PX;
            asdic_canvas_set_style(c, entry);
            asdic_canvas_line(c, x, y, x + SAMPLE_PX, y);
            asdic_canvas_set_style(c, NULL);
            asdic_canvas_color(c, INK_RGB);
            asdic_canvas_text_fit(c,
                                  (asdic_text){.x = x + SAMPLE_PX + BESIDE_PX,
                                               .y = y,
                                               .align_y = 0.5,
                                               .size_px = ASDIC_TEXT_PX},
                                  entry->label, box.w - SAMPLE_PX - BESIDE_PX);
        }
        x += wide + APART_PX;
    }
    return rows * ROW_PX;
}
