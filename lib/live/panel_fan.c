/* The fan of one ping, or a scanned sonar's last turn: ahead up, starboard right. */
#include "panel.h"

#include "base/vec.h"
#include "out/draw.h"

#include <math.h>
#include <stdio.h>

typedef struct fan_place {
    asdic_sector sector;
    double apex_x, apex_y;
} fan_place;

static fan_place fit(const panel *p, const asdic_fan *fan) {
    /* Room for labels on three sides, for the colour scale on the right, for the heading above. */
    double side = 34.0 * p->scale, top = 46.0 * p->scale, bottom = 20.0 * p->scale;
    double width = p->box.w - 2.0 * side - 56.0 * p->scale, height = p->box.h - top - bottom;
    asdic_sector unit = asdic_sector_of(fan, 1000.0);
    double radius = 1000.0 * fmin(width / (double)unit.width, height / (double)unit.height);
    fan_place at = {.sector = asdic_sector_of(fan, floor(radius))};
    double x = floor(p->box.x + side + 0.5 * (width - (double)at.sector.width));
    double y = floor(p->box.y + top + 0.5 * (height - (double)at.sector.height));
    at.apex_x = x + at.sector.apex_x_px;
    at.apex_y = y + at.sector.apex_y_px;
    return at;
}

static void ray(const panel *p, const fan_place *at, double bearing_rad, double from, double to) {
    double s = sin(bearing_rad), c = cos(bearing_rad);
    asdic_canvas_line(p->canvas, at->apex_x + from * s, at->apex_y - from * c, at->apex_x + to * s,
                      at->apex_y - to * c);
}

static void arc(const panel *p, const fan_place *at, double radius) {
    cairo_t *cr = p->canvas->cr;
    cairo_new_path(cr);
    cairo_arc(cr, at->apex_x, at->apex_y, radius, at->sector.low_rad - 0.5 * ASDIC_PI,
              at->sector.high_rad - 0.5 * ASDIC_PI);
    cairo_stroke(cr);
}

/* Angle of a scanned head at the last ping; 0 of others. */
static double head_rad(const asdic_view *view) {
    const asdic_sweep *sweep = &view->polar.sweep;
    return asdic_sweep_bearing_rad(sweep, asdic_sweep_direction(sweep, view->ping.ping));
}

static void decorate(const panel *p, const asdic_view *view, const fan_place *at, double range_m) {
    cairo_t *cr = p->canvas->cr;
    double step = asdic_axis_step(range_m, 5), radius = at->sector.radius_px, gap = 7.0 * p->scale;
    cairo_set_line_width(cr, 1.0);
    for (double r = step; r <= range_m * (1.0 + 1e-9); r += step) {
        char label[32], number[24];
        double px = radius * r / range_m, edge = at->sector.high_rad;
        cairo_set_source_rgba(cr, 0.75, 0.82, 0.88, 0.28);
        arc(p, at, px);
        asdic_axis_label(number, r, step);
        snprintf(label, sizeof label, "%s m", number);
        panel_text(p,
                   (asdic_lettering){.x = at->apex_x + px * sin(edge) + gap * cos(edge),
                                     .y = at->apex_y - px * cos(edge) + gap * sin(edge),
                                     .align_x = cos(edge) > 0.3 ? 0.0 : 0.5,
                                     .align_y = 0.5 + 0.5 * sin(edge),
                                     .size_px = PANEL_SMALL_PX},
                   PANEL_DIM_RGB, label);
    }
    const double degree = ASDIC_PI / 180.0;
    double low_deg = at->sector.low_rad / degree, high_deg = at->sector.high_rad / degree;
    bool is_round = high_deg - low_deg > 360.0 - 1e-6; /* both ends are the same */
    for (double d = 30.0 * ceil(low_deg / 30.0 + (is_round ? 1e-6 : -1e-6)); d <= high_deg + 1e-6;
         d += 30.0) {
        double angle = d * degree;
        int deg = (int)rint(asdic_fan_shown_deg(view->is_section, d));
        char label[16];
        cairo_set_source_rgba(cr, 0.75, 0.82, 0.88, 0.16);
        ray(p, at, angle, 0.0, radius);
        snprintf(label, sizeof label, "%s%d\u00b0", deg < 0 ? "\u2212" : "", deg < 0 ? -deg : deg);
        panel_text(p,
                   (asdic_lettering){.x = at->apex_x + (radius + gap) * sin(angle),
                                     .y = at->apex_y - (radius + gap) * cos(angle),
                                     .align_x = 0.5 - 0.5 * sin(angle),
                                     .align_y = 0.5 - 0.5 * cos(angle),
                                     .size_px = PANEL_SMALL_PX},
                   PANEL_DIM_RGB, label);
    }
    asdic_canvas_color(p->canvas, PANEL_AMBER_RGB); /* the beam of the A-scope, or the head */
    cairo_set_line_width(cr, 1.5 * p->scale);
    ray(p, at, view->bearing_rad[view->beam] + head_rad(view), radius - 10.0 * p->scale,
        radius + 3.0 * p->scale);
}

void panel_fan(const panel *p, const asdic_view *view) {
    const asdic_loop_ping *ping = &view->ping;
    char heading[128], gain[48], coarse[48] = "";
    panel_gain_words(&view->look, gain);
    bool scans = view->polar.columns > 0;
    if (view->joined > 1) {
        snprintf(coarse, sizeof coarse, "  \u00b7  bins of %.3g m",
                 (double)view->joined * ping->bin_length_m);
    }
    snprintf(heading, sizeof heading, "sonar  \u00b7  %zu %s%s%s%s",
             scans ? view->polar.sweep.directions : ping->beams, scans ? "directions" : "beams",
             !view->is_section            ? ""
             : view->section.is_starboard ? ", starboard on the right"
                                          : ", ahead on the right",
             coarse, gain);
    panel_begin(p, heading);
    asdic_fan fan = {.levels_db = ping->level_db,
                     .bearing_rad = view->bearing_rad,
                     .beams = ping->beams,
                     .bins = ping->bins,
                     .bin_length_m = ping->bin_length_m,
                     .is_section = view->is_section};
    if (scans) {
        fan = asdic_polar_fan(&view->polar, ping->bin_length_m);
    }
    fan_place at = fit(p, &fan);
    asdic_raster raster = {0};
    if (asdic_raster_fan(view->ctx, &fan, &at.sector, &view->look, PANEL_BACK_RGB, &raster) ==
        ASDIC_OK) {
        asdic_canvas_raster(p->canvas, &raster,
                            (asdic_box){at.apex_x - at.sector.apex_x_px,
                                        at.apex_y - at.sector.apex_y_px, (double)raster.width,
                                        (double)raster.height});
    }
    asdic_raster_finish(&raster);
    decorate(p, view, &at, (double)ping->bins * ping->bin_length_m);
    panel_color_bar(p,
                    (asdic_box){p->box.x + p->box.w - 50.0 * p->scale, p->box.y + 34.0 * p->scale,
                                12.0 * p->scale, fmin(0.55 * p->box.h, 200.0 * p->scale)},
                    &view->look);
}
