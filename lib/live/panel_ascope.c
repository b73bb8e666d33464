/* Level over range of one beam, with the level expected without objects. */
#include "panel.h"

#include <math.h>
#include <stdio.h>

/* Echoes this far above the expected total are marked. */
#define EXCESS_DB 6.0
#define BELOW_DB 20.0 /* parts lie below the window of the total */
#define ABOVE_DB 10.0

typedef struct scope {
    const panel *p;
    asdic_box box;
    asdic_plot_axis range, level;
    double bin_length_m;
    size_t bins;
} scope;

static double x_of(const scope *s, size_t bin) {
    double range_m = ((double)bin + 0.5) * s->bin_length_m;
    return s->box.x + s->box.w * asdic_axis_share(&s->range, range_m);
}

static double y_of(const scope *s, double level_db) {
    return s->box.y + s->box.h * (1.0 - asdic_axis_share(&s->level, level_db));
}

static void grid(const scope *s) {
    const panel *p = s->p;
    asdic_tick ticks[ASDIC_AXIS_MAX_TICKS];
    panel_ranges(p, s->box, &s->range, true);
    size_t count =
        asdic_axis_ticks(&s->level, (size_t)fmax(2.0, s->box.h / (30.0 * p->scale)), ticks);
    for (size_t i = 0; i < count; i++) {
        double y = floor(y_of(s, ticks[i].value)) + 0.5;
        asdic_canvas_color(p->canvas, PANEL_EDGE_RGB);
        asdic_canvas_line(p->canvas, s->box.x, y, s->box.x + s->box.w, y);
        bool is_top = i + 1 == count; /* which also carries the unit */
        panel_text(p,
                   (asdic_lettering){.x = s->box.x - 6.0 * p->scale,
                                     .y = y,
                                     .align_x = 1.0,
                                     .align_y = 0.5,
                                     .size_px = PANEL_SMALL_PX},
                   PANEL_DIM_RGB, is_top ? "dB" : ticks[i].label);
    }
}

static void set_dash(cairo_t *cr, asdic_line_style style, double unit) {
    const double dashed[] = {5.0 * unit, 3.0 * unit}, dotted[] = {1.2 * unit, 3.0 * unit};
    const double dash_dot[] = {6.0 * unit, 2.5 * unit, 1.5 * unit, 2.5 * unit};
    const double *const patterns[] = {NULL, dashed, dotted, dash_dot};
    static const int counts[] = {0, 2, 2, 4};
    cairo_set_dash(cr, patterns[style], counts[style], 0.0);
}

/* A curve's look; WIDTH at a frame height of 720. */
typedef struct curve_look {
    const char *label;
    uint32_t rgb;
    double width;
    asdic_line_style style;
} curve_look;

static void curve(const scope *s, const float *level_db, const curve_look *look) {
    cairo_t *cr = s->p->canvas->cr;
    bool drawing = false;
    cairo_new_path(cr);
    for (size_t n = 0; n < s->bins; n++) {
        if (!isfinite(level_db[n])) {
            drawing = false;
            continue;
        }
        double y =
            fmin(fmax(y_of(s, (double)level_db[n]), s->box.y - 50.0), s->box.y + s->box.h + 50.0);
        bool is_alone = !drawing && !(n + 1 < s->bins && isfinite(level_db[n + 1]));
        double x = x_of(s, n), half = fmax(s->p->scale, 0.5 * s->box.w / (double)s->bins);
        if (is_alone) { /* as wide as its bin */
            cairo_move_to(cr, x - half, y);
            cairo_line_to(cr, x + half, y);
        } else if (drawing) {
            cairo_line_to(cr, x, y);
        } else {
            cairo_move_to(cr, x, y);
        }
        drawing = true;
    }
    asdic_canvas_color(s->p->canvas, look->rgb);
    cairo_set_line_width(cr, look->width * s->p->scale);
    set_dash(cr, look->style, s->p->scale);
    cairo_stroke(cr);
    set_dash(cr, ASDIC_LINE_SOLID, 1.0);
}

/* Red between the expected and the simulated curve, where an echo stands out. */
static void excess(const scope *s, const float *level_db, const float *expected_db) {
    cairo_t *cr = s->p->canvas->cr;
    double half = 0.5 * s->box.w / (double)s->bins;
    cairo_set_source_rgba(cr, 0.95, 0.35, 0.30, 0.45);
    for (size_t n = 0; n < s->bins; n++) {
        if (level_db[n] - expected_db[n] > (float)EXCESS_DB) {
            double top = fmax(y_of(s, (double)level_db[n]), s->box.y);
            double bottom = fmin(y_of(s, (double)expected_db[n]), s->box.y + s->box.h);
            cairo_rectangle(cr, x_of(s, n) - half, top, 2.0 * half, fmax(bottom - top, 0.0));
        }
    }
    cairo_fill(cr);
}

/* From the right, as far as there is room beside the heading, which is HEADING_PX wide. */
static void legend(const scope *s, const curve_look *looks, size_t count, double heading_px) {
    double x = s->box.x + s->box.w, y = s->p->box.y + 15.0 * s->p->scale;
    for (size_t i = count; i-- > 0;) {
        double size = PANEL_SMALL_PX * s->p->scale;
        x -= asdic_canvas_text_width(looks[i].label, size);
        if (x - 30.0 * s->p->scale < s->p->box.x + heading_px) {
            return;
        }
        panel_text(s->p,
                   (asdic_lettering){.x = x, .y = y, .align_y = 0.5, .size_px = PANEL_SMALL_PX},
                   PANEL_DIM_RGB, looks[i].label);
        asdic_canvas_color(s->p->canvas, looks[i].rgb);
        cairo_set_line_width(s->p->canvas->cr, looks[i].width * s->p->scale);
        set_dash(s->p->canvas->cr, looks[i].style, s->p->scale);
        asdic_canvas_line(s->p->canvas, x - 26.0 * s->p->scale, y, x - 5.0 * s->p->scale, y);
        set_dash(s->p->canvas->cr, ASDIC_LINE_SOLID, 1.0);
        x -= 38.0 * s->p->scale;
    }
}

void panel_ascope(const panel *p, const asdic_view *view) {
    static const curve_look simulated = {"ping", 0xe8eef4, 1.3, ASDIC_LINE_SOLID};
    static const curve_look looks[] = {{"ping", 0xe8eef4, 1.3, ASDIC_LINE_SOLID},
                                       {"expected", PANEL_AMBER_RGB, 2.2, ASDIC_LINE_SOLID},
                                       {"bottom", 0xd08c60, 1.2, ASDIC_LINE_DASHED},
                                       {"surface", 0x5aa9e6, 1.4, ASDIC_LINE_DOTTED},
                                       {"volume", 0x7fbf8f, 1.2, ASDIC_LINE_DASH_DOT},
                                       {"noise", 0x7a8794, 1.0, ASDIC_LINE_SOLID}};
    static const asdic_component parts[] = {ASDIC_TOTAL,   ASDIC_TOTAL,  ASDIC_BOTTOM,
                                            ASDIC_SURFACE, ASDIC_VOLUME, ASDIC_NOISE};
    char heading[ASDIC_NAME_SIZE + 64];
    const asdic_loop_ping *ping = &view->ping;
    const float *level_db = ping->level_db + view->beam * ping->bins;
    snprintf(heading, sizeof heading, "A-scope  \u00b7  \u2018%s\u2019",
             asdic_mission_sonar(view->mission)->receivers[view->beam].name);
    panel_begin(p, heading);
    scope s = {
        .p = p,
        .box = {p->box.x + 44.0 * p->scale, p->box.y + 28.0 * p->scale, p->box.w - 58.0 * p->scale,
                p->box.h - 50.0 * p->scale},
        .range = {.high = asdic_view_range_m(view)},
        .level = {.low = view->look.db_low - BELOW_DB, .high = view->look.db_high + ABOVE_DB},
        .bin_length_m = ping->bin_length_m,
        .bins = ping->bins};
    grid(&s);
    cairo_save(p->canvas->cr);
    cairo_rectangle(p->canvas->cr, s.box.x, s.box.y, s.box.w, s.box.h);
    cairo_clip(p->canvas->cr);
    const float *expected_db = asdic_live_expected_db(&view->expected, ASDIC_TOTAL);
    if (expected_db) {
        excess(&s, level_db, expected_db);
        for (size_t i = sizeof looks / sizeof *looks; i-- > 1;) {
            curve(&s, asdic_live_expected_db(&view->expected, parts[i]), &looks[i]);
        }
    }
    curve(&s, level_db, &simulated);
    cairo_restore(p->canvas->cr);
    double heading_px = 1.2 * asdic_canvas_text_width(heading, PANEL_TEXT_PX * p->scale);
    bool has_noise = asdic_mission_sonar(view->mission)->noise_enabled;
    legend(&s, looks, expected_db ? (has_noise ? 6 : 5) : 1, heading_px);
}
