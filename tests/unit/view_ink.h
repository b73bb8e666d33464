/* What a view draws, seen on its way to the picture: words, lines, arcs. */
#ifndef VIEW_INK_H
#define VIEW_INK_H

#include "view_rig.h"

#include <cairo.h>

#include <math.h>

/* What was written since word_count was 0, the middle of its ink and its size. This takes the place of cairo's own. */
static struct word {
    char text[160];
    double x, y, width, height;
} words[400];
static size_t word_count;

void cairo_show_text(cairo_t *cr, const char *text) {
    cairo_text_extents_t e;
    if (word_count == sizeof words / sizeof *words) {
        return;
    }
    struct word *w = &words[word_count++];
    cairo_get_current_point(cr, &w->x, &w->y);
    cairo_text_extents(cr, text, &e);
    w->x += e.x_bearing + 0.5 * e.width;
    w->y += e.y_bearing + 0.5 * e.height;
    cairo_user_to_device(cr, &w->x, &w->y);
    w->width = e.width;
    w->height = e.height;
    cairo_user_to_device_distance(cr, &w->width, &w->height);
    snprintf(w->text, sizeof w->text, "%s", text);
}

/* Straight lines, and arcs, since line_count and arc_count were 0. */
static struct line { double x0, y0, x1, y1; } lines[400];
static struct arc { double x, y, radius, rad[2]; } arcs[400];
static size_t line_count, arc_count;

/* The boxes of areas that were filled and then outlined since area_count was 0. */
static struct area { double x0, y0, x1, y1; } areas[400];
static size_t area_count;

void __real_asdic_canvas_line(asdic_canvas *c, double x0, double y0, double x1, double y1);
void __wrap_asdic_canvas_line(asdic_canvas *c, double x0, double y0, double x1, double y1);
void __real_cairo_arc(cairo_t *cr, double x, double y, double radius, double low, double high);
void __wrap_cairo_arc(cairo_t *cr, double x, double y, double radius, double low, double high);

void __wrap_asdic_canvas_line(asdic_canvas *c, double x0, double y0, double x1, double y1) {
    if (line_count < sizeof lines / sizeof *lines) {
        lines[line_count++] = (struct line){x0, y0, x1, y1};
    }
    __real_asdic_canvas_line(c, x0, y0, x1, y1);
}

void __wrap_cairo_arc(cairo_t *cr, double x, double y, double radius, double low, double high) {
    if (arc_count < sizeof arcs / sizeof *arcs) {
        arcs[arc_count++] = (struct arc){x, y, radius, {low, high}};
    }
    __real_cairo_arc(cr, x, y, radius, low, high);
}

void __real_cairo_fill_preserve(cairo_t *cr);
void __wrap_cairo_fill_preserve(cairo_t *cr);

void __wrap_cairo_fill_preserve(cairo_t *cr) {
    if (area_count < sizeof areas / sizeof *areas) {
        struct area *a = &areas[area_count++];
        cairo_path_extents(cr, &a->x0, &a->y0, &a->x1, &a->y1);
    }
    __real_cairo_fill_preserve(cr);
}

static inline void draw(asdic_view *view) {
    word_count = line_count = arc_count = area_count = 0;
    assert_ok(t.ctx, asdic_view_draw(view));
}

static inline bool overlap(const struct word *a, const struct word *b) {
    return fabs(a->x - b->x) < 0.5 * (a->width + b->width) &&
           fabs(a->y - b->y) < 0.5 * (a->height + b->height);
}

static inline bool is_written(const char *word) {
    for (size_t i = 0; i < word_count; i++) {
        if (strcmp(words[i].text, word) == 0) {
            return true;
        }
    }
    return false;
}

#endif
