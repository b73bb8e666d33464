/* The vehicle's state and commands, the sonar design under trial, and the keys. */
#include "panel.h"

#include "base/vec.h"

#include <math.h>
#include <stdio.h>

typedef struct writer {
    const panel *p;
    double x, y, w;
} writer;

/* A value that is too long to stand beside its label is smaller. */
static void row(writer *w, const char *label, const char *value, uint32_t rgb) {
    double size_px = PANEL_TEXT_PX * w->p->scale, gap = 8.0 * w->p->scale;
    double room = w->w - gap - asdic_canvas_text_width(label, size_px);
    double share = fmin(room / asdic_canvas_text_width(value, size_px), 1.0);
    panel_text(w->p,
               (asdic_lettering){.x = w->x, .y = w->y, .align_y = 1.0, .size_px = PANEL_TEXT_PX},
               PANEL_DIM_RGB, label);
    panel_text(w->p,
               (asdic_lettering){.x = w->x + w->w,
                                 .y = w->y,
                                 .align_x = 1.0,
                                 .align_y = 1.0,
                                 .size_px = PANEL_TEXT_PX * share},
               rgb, value);
    w->y += 17.5 * w->p->scale;
}

static void write_vehicle(writer *w, const asdic_view *view) {
    const asdic_pose *pose = &view->ping.pose;
    char text[64];
    double heading = fmod(pose->yaw_rad * 180.0 / ASDIC_PI, 360.0);
    heading += heading < 0.0 ? 360.0 : 0.0;
    snprintf(text, sizeof text, "%s", view->is_manual ? "by hand" : "by the mission");
    row(w, "flown", text, view->is_manual ? PANEL_AMBER_RGB : PANEL_INK_RGB);
    snprintf(text, sizeof text, "%.2f m/s",
             view->is_manual ? asdic_helm_speed_mps(&view->helm)
                             : asdic_view_mission_speed_mps(view));
    row(w, "speed", text, PANEL_INK_RGB);
    snprintf(text, sizeof text, "%03.0f\u00b0", floor(heading + 0.5) >= 360.0 ? 0.0 : heading);
    row(w, "heading", text, PANEL_INK_RGB);
    snprintf(text, sizeof text, "%.1f m", pose->position_m.z);
    row(w, "depth", text, PANEL_INK_RGB);
    if (isfinite(view->ping.altitude_m)) {
        snprintf(text, sizeof text, "%.1f m", view->ping.altitude_m);
    } else {
        snprintf(text, sizeof text, "none");
    }
    row(w, "altitude", text, PANEL_INK_RGB);
    if (view->is_manual) {
        snprintf(text, sizeof text, "%+.0f %%", 100.0 * view->helm.rudder);
        row(w, "rudder", view->helm.rudder == 0.0 ? "amidships" : text, PANEL_INK_RGB);
        if (view->helm.holds_depth) {
            snprintf(text, sizeof text, "hold %.1f m", view->helm.hold_z_m);
        } else {
            snprintf(text, sizeof text, "%+.0f %%", 100.0 * view->helm.planes);
        }
        row(w, "planes", text, view->helm.holds_depth ? PANEL_CYAN_RGB : PANEL_INK_RGB);
    } else {
        row(w, "rudder", "\u2013", PANEL_DIM_RGB);
        row(w, "planes", "\u2013", PANEL_DIM_RGB);
    }
    snprintf(text, sizeof text, "%.4g m", view->ping.bin_length_m);
    row(w, "bins", text, PANEL_INK_RGB);
}

static void write_design(writer *w, const asdic_view *view) {
    const asdic_choices *c = &view->chosen;
    char text[64];
    snprintf(text, sizeof text, "%.0f kn wind", c->wind_speed_kn);
    row(w, "sea", text, PANEL_INK_RGB);
    asdic_material_describe(&c->bottom, text, sizeof text);
    row(w, "bottom", text, PANEL_INK_RGB);
    snprintf(text, sizeof text, "%.0f dB", c->source_level_db);
    row(w, "source", text, PANEL_INK_RGB);
    snprintf(text, sizeof text, "%.4g kHz",
             asdic_mission_sonar(view->mission)->bandwidth_hz / 1000.0);
    row(w, "bandwidth", text, PANEL_INK_RGB);
    snprintf(text, sizeof text, "%u", asdic_governor_rays(&view->governor));
    row(w, "rays", text,
        asdic_governor_rays(&view->governor) < c->rays ? PANEL_AMBER_RGB : PANEL_INK_RGB);
    snprintf(text, sizeof text, "%.0f..%.0f dB", view->look.db_low, view->look.db_high);
    row(w, "window", text, PANEL_INK_RGB);
    row(w, "colours", asdic_colormap_name(view->look.colormap), PANEL_INK_RGB);
    if (view->recording) {
        snprintf(text, sizeof text, "\u25cf %03u \u00b7 %zu",
                 asdic_recording_number(view->recording), asdic_recording_pings(view->recording));
        row(w, "recording", text, PANEL_RED_RGB);
    } else {
        row(w, "recording", "off", PANEL_INK_RGB);
    }
}

/* The keys in two columns, in short words. */
static void write_keys(const panel *p, double y, double width) {
    static const char *const keys[][2] = {{"\u2191 \u2193", "speed"},
                                          {"space  .", "pause, step"},
                                          {"\u2190 \u2192  x", "rudder"},
                                          {"b  g  v", "beam, fan"},
                                          {"PgUp PgDn", "planes"},
                                          {"[ ] \u2212 =", "window"},
                                          {"h", "hold depth"},
                                          {"c  t", "colours, gain"},
                                          {"a", "mission flies"},
                                          {"o  p", "wind"},
                                          {"r", "record"},
                                          {"1 2 3 4", "bottom"},
                                          {"k  l", "source"},
                                          {"n  m", "rays"}};
    double line = 15.0 * p->scale, half = 0.5 * width;
    for (size_t i = 0; i < sizeof keys / sizeof *keys; i++) {
        double x = p->box.x + 10.0 * p->scale + (double)(i % 2) * (half + 5.0 * p->scale);
        asdic_lettering at = {
            .x = x, .y = y + line * (double)(i / 2), .align_y = 1.0, .size_px = PANEL_SMALL_PX};
        panel_text(p, at, PANEL_INK_RGB, keys[i][0]);
        at.x = x + 0.46 * half;
        panel_text(p, at, PANEL_DIM_RGB, keys[i][1]);
    }
}

static void write_message(const panel *p, const asdic_view *view, double y) {
    asdic_canvas_color(p->canvas, PANEL_AMBER_RGB);
    asdic_canvas_text_fit(p->canvas,
                          (asdic_lettering){.x = p->box.x + 10.0 * p->scale,
                                            .y = y,
                                            .align_y = 1.0,
                                            .size_px = PANEL_SMALL_PX * p->scale},
                          view->message, p->box.w - 20.0 * p->scale);
}

void panel_status(const panel *p, const asdic_view *view) {
    double gap = 10.0 * p->scale, width = 0.5 * (p->box.w - 4.0 * gap);
    panel_begin(p, NULL);
    writer left = {p, p->box.x + gap, p->box.y + gap, width};
    writer right = {p, p->box.x + 3.0 * gap + width, p->box.y + gap, width};
    write_vehicle(&left, view);
    write_design(&right, view);
    double y = p->box.y + p->box.h - (7.0 * 15.0 + 8.0) * p->scale;
    asdic_canvas_color(p->canvas, PANEL_EDGE_RGB);
    asdic_canvas_line(p->canvas, p->box.x + gap, floor(y - 6.0 * p->scale) + 0.5,
                      p->box.x + p->box.w - gap, floor(y - 6.0 * p->scale) + 0.5);
    write_keys(p, y, p->box.w - 2.0 * gap);
    write_message(p, view, y - 23.0 * p->scale);
}
