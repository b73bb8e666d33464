/* Map, north up: the relief of the sea floor, the track, and where the beams look. */
#include "panel.h"

#include "base/vec.h"
#include "mission/run/run_footprint.h"
#include "out/raster_relief.h"
#include "scene/scene.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#define OBJECT_RGB 0xbfa675u

typedef struct map {
    const panel *p;
    const asdic_relief *relief;
    asdic_box box;
    double px_per_m;
    bool has_bottom; /* where the map is, and its depths */
    double low_m, high_m;
} map;

static double map_x(const map *m, double east_m) {
    return m->box.x + (east_m - m->relief->west_m) * m->px_per_m;
}

static double map_y(const map *m, double north_m) {
    return m->box.y + m->box.h - (north_m - m->relief->south_m) * m->px_per_m;
}

static uint32_t blend(const double dark[3], const double bright[3], double share) {
    uint32_t rgb = 0;
    for (int k = 0; k < 3; k++) {
        rgb = rgb << 8 | (uint32_t)(255.0 * (dark[k] + share * (bright[k] - dark[k])));
    }
    return rgb;
}

/* Shoals bright, depths dark, objects sandy. */
static void relief(const map *m, const asdic_view *view) {
    static const double deep[3] = {0.04, 0.13, 0.20}, shoal[3] = {0.33, 0.53, 0.56};
    const asdic_relief *r = m->relief;
    asdic_relief_look look = {.low_m = m->low_m,
                              .high_m = m->high_m,
                              .object_rgb = OBJECT_RGB,
                              .empty_rgb = PANEL_NIGHT_RGB};
    asdic_raster raster;
    for (int i = 0; i < 256; i++) {
        look.bottom_rgb[i] = blend(deep, shoal, i / 255.0);
    }
    if (asdic_raster_relief(view->ctx, r, &look, &raster) != ASDIC_OK) {
        return;
    }
    double side = (double)r->rows * r->cell_m * m->px_per_m;
    asdic_canvas_raster(m->p->canvas, &raster,
                        (asdic_box){m->box.x, m->box.y + m->box.h - side, side, side});
    asdic_raster_finish(&raster);
}

static void grid(const map *m) {
    cairo_t *cr = m->p->canvas->cr;
    double span_m = m->box.w / m->px_per_m, step = asdic_axis_step(span_m, 5);
    cairo_set_line_width(cr, 1.0);
    cairo_set_source_rgba(cr, 0.8, 0.9, 0.95, 0.13);
    for (double e = ceil(m->relief->west_m / step) * step; e < m->relief->west_m + span_m;
         e += step) {
        double x = floor(map_x(m, e)) + 0.5;
        asdic_canvas_line(m->p->canvas, x, m->box.y, x, m->box.y + m->box.h);
    }
    for (double n = ceil(m->relief->south_m / step) * step;
         n < m->relief->south_m + m->box.h / m->px_per_m; n += step) {
        double y = floor(map_y(m, n)) + 0.5;
        asdic_canvas_line(m->p->canvas, m->box.x, y, m->box.x + m->box.w, y);
    }
}

/* Fills the areas of the present path and strokes its outlines. */
static void ink(const map *m, uint32_t rgb, double fill, double edge, bool is_dashed) {
    cairo_t *cr = m->p->canvas->cr;
    double r = (rgb >> 16) / 255.0, g = (rgb >> 8 & 255) / 255.0, b = (rgb & 255) / 255.0;
    const double dash[] = {4.0, 4.0};
    cairo_set_source_rgba(cr, r, g, b, fill);
    cairo_fill_preserve(cr);
    cairo_set_source_rgba(cr, r, g, b, edge);
    cairo_set_line_width(cr, 1.0);
    cairo_set_dash(cr, dash, is_dashed ? 2 : 0, 0.0);
    cairo_stroke(cr);
    cairo_set_dash(cr, NULL, 0, 0.0);
}

/* Adds to the path where the lobes of SWATH meet the bottom, as the plan of a run shows it; whether they do. */
static bool trace(const map *m, const asdic_view *view, const asdic_swath *swath) {
    static const asdic_relief flat; /* none */
    const asdic_scene *scene = asdic_mission_scene(view->mission);
    bool is_flat =
        scene->has_bottom_plane && !swath->layers; /* a bent ray goes from cell to cell */
    asdic_seafloor ground = {.relief = is_flat ? &flat : m->relief,
                             .plane_depth_m =
                                 scene->has_bottom_plane ? scene->bottom_plane_depth_m : INFINITY};
    asdic_pose pose = asdic_view_sonar_pose(view);
    asdic_chart_area area;
    if (asdic_footprint_find(view->ctx, swath, &pose, &ground, &area) != ASDIC_OK) {
        return true;
    }
    for (size_t i = 0; i < area.count; i++) {
        cairo_line_to(m->p->canvas->cr, map_x(m, area.east_m[i]), map_y(m, area.north_m[i]));
    }
    cairo_close_path(m->p->canvas->cr);
    bool meets = !area.dashed;
    asdic_footprint_finish(&area);
    return meets;
}

static void beams(const map *m, const asdic_view *view) {
    const asdic_sonar *sonar = asdic_mission_sonar(view->mission);
    const asdic_environment *environment = asdic_mission_environment(view->mission);
    asdic_layers layers;
    asdic_layers_of(environment, view->ping.pose.position_m.z, &layers);
    asdic_swath swath = {.layers = asdic_environment_bends(environment) ? &layers : NULL,
                         .wavelength_m = asdic_view_wavelength_m(view),
                         .range_m = asdic_view_range_m(view)};
    bool is_apart = sonar->receiver_count <= ASDIC_SWATH_APART, has_bottom = false;
    swath.is_rough = !is_apart; /* every frame anew */
    cairo_new_path(m->p->canvas->cr);
    for (size_t k = 0; k < sonar->receiver_count; k += swath.count) {
        asdic_swath_take(&swath, sonar, k);
        if (is_apart && k != view->beam) {
            bool meets = trace(m, view, &swath);
            ink(m, PANEL_CYAN_RGB, 0.10, 0.45, !meets);
        } else if (!is_apart) { /* what overlaps is one area */
            has_bottom = trace(m, view, &swath) || has_bottom;
        }
    }
    if (!is_apart) {
        bool is_whole = swath.count == sonar->receiver_count; /* else outlines lie upon outlines */
        ink(m, PANEL_CYAN_RGB, is_whole ? 0.10 : 0.30, is_whole ? 0.5 : 0.0, !has_bottom);
    }
    swath.beams = &sonar->receivers[view->beam];
    swath.count = 1;
    swath.is_rough = false;
    bool meets = trace(m, view, &swath);
    ink(m, PANEL_AMBER_RGB, 0.14, 0.7, !meets);
}

static void tracks(const map *m, const asdic_view *view) {
    cairo_t *cr = m->p->canvas->cr;
    size_t pings = asdic_mission_ping_count(view->mission), step = pings / 400 + 1;
    const double dash[] = {4.0, 4.0};
    cairo_new_path(cr);
    for (size_t i = 0; i < pings && pings > 1; i += step) {
        asdic_vec3 at = asdic_mission_pose(view->mission, i, NULL).position_m;
        cairo_line_to(cr, map_x(m, at.y), map_y(m, at.x));
    }
    cairo_set_dash(cr, dash, 2, 0.0);
    cairo_set_source_rgba(cr, 0.85, 0.92, 0.97, 0.45);
    cairo_set_line_width(cr, 1.0);
    cairo_stroke(cr);
    cairo_set_dash(cr, NULL, 0, 0.0);
    for (size_t i = 0; i < view->trail_count; i++) {
        cairo_line_to(cr, map_x(m, view->trail_m[i].y), map_y(m, view->trail_m[i].x));
    }
    cairo_set_source_rgba(cr, 1.0, 0.76, 0.30, 0.95);
    cairo_set_line_width(cr, 1.8 * m->p->scale);
    cairo_stroke(cr);
}

/* What moves is not in the relief, nor are points, which have no triangles. */
static void beside_relief(const map *m, const asdic_view *view) {
    cairo_t *cr = m->p->canvas->cr;
    for (size_t i = 0; i < asdic_mission_object_count(view->mission); i++) {
        const asdic_mission_object *o = asdic_mission_get_object(view->mission, i);
        if (!o->moves && o->mesh.triangles > 0) {
            continue;
        }
        asdic_vec3 at_m = asdic_view_object_m(view, o);
        double radius_m = 0.5 * fmax(o->max_m.x - o->min_m.x, o->max_m.y - o->min_m.y);
        cairo_new_path(cr);
        cairo_arc(cr, map_x(m, at_m.y), map_y(m, at_m.x),
                  fmax(radius_m * m->px_per_m, 3.0 * m->p->scale), 0.0, 2.0 * ASDIC_PI);
        asdic_canvas_color(m->p->canvas, OBJECT_RGB);
        cairo_fill(cr);
    }
}

static void vehicle(const map *m, const asdic_pose *pose) {
    cairo_t *cr = m->p->canvas->cr;
    double size = 8.0 * m->p->scale;
    cairo_save(cr);
    cairo_translate(cr, map_x(m, pose->position_m.y), map_y(m, pose->position_m.x));
    cairo_rotate(cr, pose->yaw_rad);
    cairo_move_to(cr, 0.0, -size);
    cairo_line_to(cr, 0.55 * size, 0.7 * size);
    cairo_line_to(cr, 0.0, 0.35 * size);
    cairo_line_to(cr, -0.55 * size, 0.7 * size);
    cairo_close_path(cr);
    asdic_canvas_color(m->p->canvas, 0xffffffu);
    cairo_fill_preserve(cr);
    asdic_canvas_color(m->p->canvas, 0x10161cu);
    cairo_set_line_width(cr, 1.2);
    cairo_stroke(cr);
    cairo_restore(cr);
}

static void scale_bar(const map *m) {
    const panel *p = m->p;
    char label[64], low[24], high[24];
    double length_m = asdic_axis_step(m->box.w / m->px_per_m, 5);
    double x = m->box.x + 8.0 * p->scale, y = m->box.y + m->box.h - 10.0 * p->scale;
    panel_plate(p, m->box.x, m->box.y + m->box.h - 26.0 * p->scale, m->box.w, 26.0 * p->scale);
    asdic_canvas_color(p->canvas, PANEL_INK_RGB);
    cairo_set_line_width(p->canvas->cr, 2.0);
    asdic_canvas_line(p->canvas, x, y, x + length_m * m->px_per_m, y);
    snprintf(label, sizeof label, "%g m", length_m);
    panel_text(p,
               (asdic_lettering){.x = x + length_m * m->px_per_m + 6.0 * p->scale,
                                 .y = y,
                                 .align_y = 0.5,
                                 .size_px = PANEL_SMALL_PX},
               PANEL_INK_RGB, label);
    double used = x + length_m * m->px_per_m + 6.0 * p->scale +
                  asdic_canvas_text_width(label, PANEL_SMALL_PX * p->scale);
    if (m->has_bottom) {
        bool is_flat = m->high_m - m->low_m < 0.2;
        asdic_axis_label(low, is_flat ? 0.5 * (m->low_m + m->high_m) : m->low_m, 0.1);
        asdic_axis_label(high, m->high_m, 0.1);
        snprintf(label, sizeof label, is_flat ? "floor at %s m" : "floor at %s to %s m", low, high);
        double size_px = PANEL_SMALL_PX * p->scale;
        double room = m->box.x + m->box.w - 16.0 * p->scale - used;
        if (asdic_canvas_text_width(label, size_px) > room) { /* the depths alone */
            memmove(label, label + strlen("floor at "), strlen(label + strlen("floor at ")) + 1);
        }
        if (asdic_canvas_text_width(label, size_px) > room) {
            return;
        }
        panel_text(p,
                   (asdic_lettering){.x = m->box.x + m->box.w - 8.0 * p->scale,
                                     .y = y,
                                     .align_x = 1.0,
                                     .align_y = 0.5,
                                     .size_px = PANEL_SMALL_PX},
                   PANEL_INK_RGB, label);
    }
}

static void north_arrow(const map *m) {
    cairo_t *cr = m->p->canvas->cr;
    double s = m->p->scale, x = m->box.x + m->box.w - 16.0 * s, y = m->box.y + 12.0 * s;
    cairo_save(cr);
    cairo_translate(cr, x, y);
    cairo_scale(cr, s, s);
    cairo_move_to(cr, 0.0, 0.0);
    cairo_line_to(cr, 5.0, 14.0);
    cairo_line_to(cr, 0.0, 10.5);
    cairo_line_to(cr, -5.0, 14.0);
    cairo_close_path(cr);
    cairo_restore(cr);
    asdic_canvas_color(m->p->canvas, PANEL_INK_RGB);
    cairo_fill(cr);
    panel_text(
        m->p,
        (asdic_lettering){
            .x = x, .y = y + 20.0 * s, .align_x = 0.5, .align_y = 1.0, .size_px = PANEL_SMALL_PX},
        PANEL_INK_RGB, "N");
}

void panel_plan(const panel *p, const asdic_view *view) {
    const asdic_relief *r = &view->relief;
    map m = {.p = p, .relief = r, .box = p->box};
    double side_m = (double)r->rows * r->cell_m;
    m.px_per_m = fmax(p->box.w, p->box.h) / side_m;
    m.has_bottom = asdic_relief_span(r, r->west_m, r->west_m + side_m, r->south_m,
                                     r->south_m + side_m, &m.low_m, &m.high_m);
    panel_begin(p, NULL);
    cairo_save(p->canvas->cr);
    cairo_rectangle(p->canvas->cr, p->box.x, p->box.y, p->box.w, p->box.h);
    cairo_clip(p->canvas->cr);
    relief(&m, view);
    grid(&m);
    beams(&m, view);
    tracks(&m, view);
    beside_relief(&m, view);
    vehicle(&m, &view->ping.pose);
    scale_bar(&m);
    north_arrow(&m);
    cairo_restore(p->canvas->cr);
}
