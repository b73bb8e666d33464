/* The scene seen from behind the vehicle, and its track so far. */
#include "panel.h"

#include "base/vec.h"

#include <math.h>
#include <string.h>

/* The pixels of the camera, one to one. */
static void blit(const panel *p, const asdic_view *view, size_t width, size_t height) {
    cairo_surface_t *surface = p->canvas->surface;
    cairo_surface_flush(surface);
    uint8_t *data = cairo_image_surface_get_data(surface);
    size_t stride = (size_t)cairo_image_surface_get_stride(surface);
    const uint32_t *rgb = asdic_camera_rgb(view->camera);
    for (size_t y = 0; y < height; y++) {
        memcpy(data + ((size_t)p->box.y + y) * stride + 4 * (size_t)p->box.x, rgb + y * width,
               width * sizeof *rgb);
    }
    cairo_surface_mark_dirty(surface);
}

/* Whether something hides a point of the picture. */
static bool is_hidden(const asdic_view *view, size_t width, size_t height, double x, double y,
                      double far_m) {
    if (x < 0.0 || y < 0.0 || x >= (double)width || y >= (double)height) {
        return false;
    }
    double seen_m = (double)asdic_camera_far_m(view->camera)[(size_t)y * width + (size_t)x];
    return far_m > seen_m + 0.3 + 0.02 * far_m;
}

static void trail(const panel *p, const asdic_view *view, size_t width, size_t height) {
    cairo_t *cr = p->canvas->cr;
    size_t first = view->trail_count > 600 ? view->trail_count - 600 : 0;
    double x0 = 0.0, y0 = 0.0;
    bool has_last = false;
    cairo_set_line_width(cr, 2.0 * p->scale);
    for (size_t i = first; i < view->trail_count; i++) {
        double x, y, far_m;
        bool seen = asdic_camera_project(view->camera, view->trail_m[i], &x, &y, &far_m) &&
                    !is_hidden(view, width, height, x, y, far_m);
        if (seen && has_last) {
            double age = (double)(view->trail_count - i) / 600.0;
            cairo_set_source_rgba(cr, 1.0, 0.78, 0.30, 0.75 * (1.0 - age));
            asdic_canvas_line(p->canvas, p->box.x + x0, p->box.y + y0, p->box.x + x, p->box.y + y);
        }
        x0 = x;
        y0 = y;
        has_last = seen;
    }
}

/* Whether a label there would overlap one that is drawn; if not, records it. */
static bool is_taken(double spots[][2], size_t *count, double x, double y, double scale) {
    for (size_t k = 0; k < *count; k++) {
        if (fabs(spots[k][0] - x) < 70.0 * scale && fabs(spots[k][1] - y) < 12.0 * scale) {
            return true;
        }
    }
    spots[*count][0] = x;
    spots[(*count)++][1] = y;
    return false;
}

static void names(const panel *p, const asdic_view *view, size_t width, size_t height) {
    double spots[64][2];
    size_t spot_count = 0;
    for (size_t i = 0; i < asdic_mission_object_count(view->mission) && i < 64; i++) {
        const asdic_mission_object *o = asdic_mission_get_object(view->mission, i);
        asdic_vec3 top_m = {0.5 * (o->min_m.x + o->max_m.x), 0.5 * (o->min_m.y + o->max_m.y),
                            o->min_m.z};
        top_m =
            asdic_vec3_add(top_m, asdic_vec3_sub(asdic_view_object_m(view, o), o->pose.position_m));
        double x, y, far_m, range_m = asdic_view_range_m(view);
        if (!o->name[0] || !asdic_camera_project(view->camera, top_m, &x, &y, &far_m) ||
            far_m > 0.8 * range_m || is_hidden(view, width, height, x, y, far_m) || x < 0 ||
            x > (double)width || y < 20.0 || y > (double)height ||
            is_taken(spots, &spot_count, x, y, p->scale)) {
            continue;
        }
        panel_text(p,
                   (asdic_lettering){.x = p->box.x + x,
                                     .y = p->box.y + y - 6.0 * p->scale,
                                     .align_x = 0.5,
                                     .size_px = PANEL_SMALL_PX},
                   0xb8c7d4u, o->name);
    }
}

void panel_chase(const panel *p, const asdic_view *view) {
    size_t width = (size_t)p->box.w, height = (size_t)p->box.h;
    panel_begin(p, NULL);
    blit(p, view, width, height);
    cairo_save(p->canvas->cr);
    cairo_rectangle(p->canvas->cr, p->box.x, p->box.y, p->box.w, p->box.h);
    cairo_clip(p->canvas->cr);
    trail(p, view, width, height);
    names(p, view, width, height);
    cairo_restore(p->canvas->cr);
}
