/* A frame: the layout, the title bar, the pictures that the panels need, the panels. */
#include "panel.h"

#include "base/context.h"
#include "base/try.h"
#include "base/vec.h"
#include "base/words.h"
#include "loop.h"
#include "out/digits.h"
#include "out/png_file.h"
#include "scene/chart.h"
#include "sim/ring.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define RELIEF_CELLS 180
#define WIDEST_RAD 1.45 /* half of a cone: at a right angle its tangent ends */

static void name_of(const asdic_view *view, char out[64]) {
    char *name = asdic_scene_name(asdic_mission_path(view->mission));
    int length = name ? (int)asdic_words_cut(name, strlen(name), 63) : 0;
    snprintf(out, 64, "%.*s", length, name ? name : "");
    free(name);
}

void asdic_view_write_title(asdic_view *view) {
    char name[64], rays[ASDIC_DIGITS_SIZE], wanted[ASDIC_DIGITS_SIZE], budget[64],
        clock[48] = "as fast as it goes";
    const asdic_governor *g = &view->governor;
    double stretch = asdic_governor_stretch(g);
    name_of(view, name);
    asdic_digits_grouped(rays, g->rays);
    asdic_digits_grouped(wanted, g->wanted);
    snprintf(budget, sizeof budget, g->rays < g->wanted ? "%s of %s rays" : "%s rays", rays,
             wanted);
    if (view->options.real_time) {
        snprintf(clock, sizeof clock, stretch > 1.0 ? "time stretched %.2f\u00d7" : "real time",
                 stretch);
    }
    snprintf(view->title, sizeof view->title,
             "asdic  \u00b7  %s  \u00b7  %g pings/s  \u00b7  %s  \u00b7  %s", name,
             asdic_mission_sonar(view->mission)->ping_rate_hz, budget, clock);
}

static asdic_box inset(double x, double y, double w, double h) {
    return (asdic_box){floor(x), floor(y), floor(w), floor(h)};
}

view_layout asdic_view_lay_out(unsigned width, unsigned height) {
    double w = width, h = height, s = fmin(w / 1280.0, h / 720.0);
    double gap = 10.0 * s, top = 38.0 * s;
    double column = 0.5 * (w - 3.0 * gap), rows = h - top - 2.0 * gap;
    double upper = 0.585 * rows, right_upper = 0.555 * rows;
    double right = 2.0 * gap + column, lower = rows - right_upper;
    double plan = fmin(1.02 * lower, 0.48 * column); /* the status needs the rest */
    return (view_layout){
        .scale = s,
        .title = inset(gap, 0.0, w - 2.0 * gap, top),
        .sonar = inset(gap, top, column, upper),
        .ascope = inset(gap, top + upper + gap, column, rows - upper),
        .chase = inset(right, top, column, right_upper),
        .plan = inset(right, top + right_upper + gap, plan, lower),
        .status = inset(right + plan + gap, top + right_upper + gap, column - plan - gap, lower),
    };
}

asdic_status asdic_view_prepare_pictures(asdic_view *view) {
    const view_layout *l = &view->layout;
    TRY(asdic_canvas_init(view->ctx, "frame", view->options.width, view->options.height,
                          PANEL_NIGHT_RGB, &view->canvas));
    TRY(asdic_camera_create(view->ctx, view->device, (unsigned)l->chase.w, (unsigned)l->chase.h,
                            &view->camera));
    asdic_relief *r = &view->relief;
    *r = (asdic_relief){.columns = RELIEF_CELLS, .rows = RELIEF_CELLS};
    r->depth_m = malloc(r->rows * r->columns * sizeof *r->depth_m);
    r->is_object = malloc(r->rows * r->columns * sizeof *r->is_object);
    return r->depth_m && r->is_object ? ASDIC_OK : asdic_fail_memory(view->ctx, "a map");
}

/* A map round the vehicle; it is drawn again when the vehicle comes near an edge. */
static void follow_map(asdic_view *view) {
    asdic_relief *r = &view->relief;
    asdic_vec3 at = view->ping.pose.position_m;
    double side_m = 2.5 * asdic_view_range_m(view), half = 0.5 * side_m;
    bool inside = fabs(at.x - (r->south_m + half)) < 0.28 * side_m &&
                  fabs(at.y - (r->west_m + half)) < 0.28 * side_m;
    if (r->cell_m > 0.0 && inside) {
        return;
    }
    r->cell_m = side_m / RELIEF_CELLS;
    /* Ahead there is more to be seen than behind. */
    r->south_m = at.x + 0.18 * side_m * cos(view->ping.pose.yaw_rad) - half;
    r->west_m = at.y + 0.18 * side_m * sin(view->ping.pose.yaw_rad) - half;
    asdic_chart_relief(asdic_mission_scene(view->mission), r);
}

/* About the first of AIM's axes, to both sides along the others. */
static dev_cone_view cone_of(const asdic_view *view, asdic_mat3 aim, double half_h_rad,
                             double half_v_rad) {
    asdic_pose pose = asdic_view_sonar_pose(view);
    asdic_mat3 turn = asdic_mat3_multiply(asdic_mat3_of(&pose), aim);
    const double over[3] = {1.0, 1.0 / tan(fmin(half_h_rad, WIDEST_RAD)),
                            1.0 / tan(fmin(half_v_rad, WIDEST_RAD))};
    dev_cone_view cone = {.strength = 1.0f};
    for (int row = 0; row < 3; row++) {
        for (int column = 0; column < 3; column++) {
            cone.rows[3 * row + column] = (float)(turn.m[column][row] * over[row]);
        }
    }
    return cone;
}

static void tint(dev_cone_view *cone, uint32_t rgb, float strength) {
    for (int k = 0; k < 3; k++) {
        float c = (float)(rgb >> (16 - 8 * k) & 255) / 255.0f;
        cone->rgb[k] = c * c; /* the picture is made in linear light */
    }
    cone->strength = strength;
}

/* Towards BEARING on a section's page, and along the page. */
static asdic_mat3 aim_in(const asdic_section *s, double bearing_rad) {
    double c = cos(bearing_rad), d = sin(bearing_rad);
    asdic_vec3 ahead = asdic_vec3_sub(asdic_vec3_scale(s->right, d), asdic_vec3_scale(s->down, c));
    asdic_vec3 along = asdic_vec3_add(asdic_vec3_scale(s->right, c), asdic_vec3_scale(s->down, d));
    asdic_vec3 out = asdic_vec3_cross(ahead, along);
    return (asdic_mat3){
        {{ahead.x, along.x, out.x}, {ahead.y, along.y, out.y}, {ahead.z, along.z, out.z}}};
}

/* Half-widths of BEAM along the page of the fan and across it: to the sides and up and down, but of a section as its face
 * is turned. */
static void half_widths(const asdic_view *view, const asdic_beam *beam, double *along_rad,
                        double *across_rad) {
    asdic_mat3 mount = asdic_face_mount(beam);
    asdic_vec3 side = {mount.m[0][1], mount.m[1][1], mount.m[2][1]};
    asdic_vec3 out = asdic_vec3_cross(view->section.right, view->section.down);
    bool is_turned = view->is_section && fabs(asdic_vec3_dot(side, out)) > sqrt(0.5);
    *along_rad = asdic_view_half_width_rad(view, is_turned ? beam->length_v_m : beam->length_h_m);
    *across_rad = asdic_view_half_width_rad(view, is_turned ? beam->length_h_m : beam->length_v_m);
}

/* All beams from LOW to HIGH as a wedge, which is of several cones where one is not wide enough. */
static void see_fan(const asdic_view *view, double low_rad, double high_rad, asdic_shot *shot) {
    const asdic_sonar *sonar = asdic_mission_sonar(view->mission);
    asdic_beam middle = sonar->receivers[sonar->receiver_count / 2];
    double along, across;
    half_widths(view, &middle, &along, &across);
    double whole = fmin(high_rad - low_rad, 2.0 * ASDIC_PI);
    unsigned parts = (unsigned)ceil(0.5 * whole / WIDEST_RAD);
    for (unsigned i = 0; i < parts; i++) {
        dev_cone_view *cone = &shot->cone[shot->cones++];
        double bearing_rad = low_rad + ((double)i + 0.5) * whole / parts;
        middle.yaw_rad = bearing_rad;
        asdic_mat3 aim =
            view->is_section ? aim_in(&view->section, bearing_rad) : asdic_face_mount(&middle);
        *cone = cone_of(view, aim, 0.5 * whole / parts, across);
        tint(cone, PANEL_CYAN_RGB, 0.5f);
    }
}

/* Few beams one by one, many as one wedge; the chosen one in amber. */
static void see_beams(const asdic_view *view, asdic_shot *shot) {
    const asdic_sonar *sonar = asdic_mission_sonar(view->mission);
    size_t n = sonar->receiver_count;
    double low = INFINITY, high = -INFINITY;
    for (size_t b = 0; b < n; b++) {
        const asdic_beam *beam = &sonar->receivers[b];
        double half_h = asdic_view_half_width_rad(view, beam->length_h_m);
        double half_v = asdic_view_half_width_rad(view, beam->length_v_m);
        double along, across;
        half_widths(view, beam, &along, &across);
        low = fmin(low, view->bearing_rad[b] - along);
        high = fmax(high, view->bearing_rad[b] + along);
        if (n < DEV_CAMERA_CONES || b == view->beam) {
            dev_cone_view *cone = &shot->cone[shot->cones++];
            *cone = cone_of(view, asdic_face_mount(beam), half_h, half_v);
            tint(cone, b == view->beam ? PANEL_AMBER_RGB : PANEL_CYAN_RGB,
                 b == view->beam ? 1.0f : 0.55f);
        }
    }
    if (n >= DEV_CAMERA_CONES) {
        see_fan(view, low, high, shot);
    }
}

/* Behind and above the vehicle, turning after it. */
static asdic_status shoot(asdic_view *view) {
    const asdic_pose *pose = &view->ping.pose;
    double range_m = asdic_view_range_m(view), away_m = fmin(3.0 + 0.11 * range_m, 40.0);
    double lag = remainder(pose->yaw_rad - view->camera_yaw_rad, 2.0 * ASDIC_PI);
    view->camera_yaw_rad += view->steps <= 1 ? lag : 0.18 * lag;
    double yaw = view->camera_yaw_rad, rise_m = 0.36 * away_m;
    asdic_vec3 eye = {pose->position_m.x - away_m * cos(yaw),
                      pose->position_m.y - away_m * sin(yaw), pose->position_m.z - rise_m};
    asdic_vec3 top = {eye.x, eye.y, 0.0};
    double floor_z = asdic_scene_altitude_m(asdic_mission_scene(view->mission), top);
    eye.z = fmin(eye.z, floor_z - 0.12 * away_m);
    if (asdic_scene_get_info(asdic_mission_scene(view->mission)).has_surface) {
        eye.z = fmax(eye.z, 0.4);
    }
    asdic_shot shot = {
        .eye_m = eye, .yaw_rad = yaw, .vehicle = pose, .range_m = range_m, .time_s = view->time_s};
    /* At a point ahead of the vehicle and a little below. */
    double drop = pose->position_m.z - eye.z + 0.10 * away_m;
    shot.pitch_rad = -atan2(drop, 2.4 * away_m);
    see_beams(view, &shot);
    return asdic_camera_shoot(view->camera, asdic_loop_simulator(view->loop), &shot);
}

static void draw_title(const asdic_view *view) {
    char text[96];
    panel p = {(asdic_canvas *)&view->canvas, view->layout.title, view->layout.scale};
    double y = p.box.y + 0.5 * p.box.h;
    panel_text(
        &p, (asdic_lettering){.x = p.box.x, .y = y, .align_y = 0.5, .size_px = 14.5, .bold = true},
        PANEL_INK_RGB, view->title);
    snprintf(text, sizeof text, "%sping %zu  \u00b7  t = %.1f s",
             view->is_paused ? "PAUSED  \u00b7  " : "", view->steps - 1, view->time_s);
    panel_text(&p,
               (asdic_lettering){
                   .x = p.box.x + p.box.w, .y = y, .align_x = 1.0, .align_y = 0.5, .size_px = 14.5},
               view->is_paused ? PANEL_AMBER_RGB : PANEL_INK_RGB, text);
}

asdic_status asdic_view_draw(asdic_view *view) {
    static void (*const draw[])(const panel *, const asdic_view *) = {
        panel_sonar, panel_ascope, panel_chase, panel_plan, panel_status};
    const view_layout *l = &view->layout;
    const asdic_box boxes[] = {l->sonar, l->ascope, l->chase, l->plan, l->status};
    follow_map(view);
    TRY(shoot(view));
    TRY(asdic_live_expected_follow(&view->expected, view->mission, &view->ping, view->beam));
    asdic_view_write_title(view);
    asdic_canvas_color(&view->canvas, PANEL_NIGHT_RGB);
    cairo_paint(view->canvas.cr);
    draw_title(view);
    for (size_t i = 0; i < sizeof boxes / sizeof *boxes; i++) {
        panel p = {&view->canvas, boxes[i], l->scale};
        draw[i](&p, view);
    }
    cairo_surface_flush(view->canvas.surface);
    return cairo_status(view->canvas.cr) == CAIRO_STATUS_SUCCESS
               ? ASDIC_OK
               : asdic_fail_memory(view->ctx, "a frame");
}

asdic_view_image asdic_view_get_frame(const asdic_view *view) {
    if (!view) {
        return (asdic_view_image){0};
    }
    cairo_surface_t *surface = view->canvas.surface;
    return (asdic_view_image){
        .width = view->options.width,
        .height = view->options.height,
        .stride = (size_t)cairo_image_surface_get_stride(surface) / sizeof(uint32_t),
        .rgb = (const uint32_t *)(const void *)cairo_image_surface_get_data(surface)};
}

asdic_status asdic_view_save(const asdic_view *view, const char *path) {
    if (!view || !path) {
        return asdic_fail(view ? view->ctx : NULL, ASDIC_ERROR_ARGUMENT,
                          "asdic_view_save: NULL argument");
    }
    return asdic_canvas_save((asdic_canvas *)&view->canvas, path, NULL);
}
