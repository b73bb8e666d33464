/* What each key does. */
#include "view_state.h"

#include "base/words.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

void asdic_view_say(asdic_view *view, const char *format, ...) {
    /* Room for a character more, to see where the last whole one ends: cairo draws nothing after half a one. */
    char whole[sizeof view->message + 4];
    va_list args;
    va_start(args, format);
    vsnprintf(whole, sizeof whole, format, args);
    va_end(args);
    size_t length = asdic_words_cut(whole, strlen(whole), sizeof view->message - 1);
    snprintf(view->message, sizeof view->message, "%.*s", (int)length, whole);
}

/* The first steering key starts manual steering at the vehicle's pose. */
static asdic_helm *helm_of(asdic_view *view) {
    if (!view->is_manual) {
        view->is_manual = true;
        asdic_pose pose =
            view->steps ? view->ping.pose : asdic_mission_vehicle_pose(view->mission, 0, NULL);
        asdic_helm_take(&view->helm, &pose, asdic_view_mission_speed_mps(view));
        asdic_view_say(view, "steered by hand; a: back to the mission");
    }
    return &view->helm;
}

/* What a key does, BY how much where keys differ in that alone. */
static void change_speed(asdic_view *v, double by_mps) {
    asdic_helm_change_speed(helm_of(v), by_mps);
}

static void turn_rudder(asdic_view *v, double by) {
    asdic_helm_change_rudder(helm_of(v), by);
}

static void turn_planes(asdic_view *v, double by) {
    asdic_helm_change_planes(helm_of(v), by);
}

static void hold(asdic_view *v, double by) {
    (void)by;
    asdic_helm_toggle_hold(helm_of(v));
}

static void by_mission(asdic_view *v, double by) {
    (void)by;
    if (v->is_manual) {
        v->is_manual = false;
        asdic_view_say(v, "flown by the mission again, from ping %zu", v->mission_ping);
    }
}

/* STEPS more pings, none: goes on where it paused. */
static void pause_for(asdic_view *v, double steps) {
    v->is_paused = steps > 0.0 || !v->is_paused;
    v->steps_allowed = (unsigned)steps;
}

static void record(asdic_view *v, double by) {
    (void)by;
    if (!v->options.folder) {
        asdic_view_say(v, "no folder to record to: start with --output DIR");
        return;
    }
    v->wants_recording = !v->wants_recording;
}

static void quit(asdic_view *v, double by) {
    (void)by;
    v->is_quit = true;
}

static void beam(asdic_view *v, double by) {
    size_t beams = asdic_mission_sonar(v->mission)->receiver_count;
    v->beam = (v->beam + (by < 0.0 ? beams - 1 : 1)) % beams;
}

static void fan_or_waterfall(asdic_view *v, double by) {
    (void)by;
    if (v->has_fan) {
        v->shows_fan = !v->shows_fan;
    } else {
        asdic_view_say(v, "no fan: that takes three beams or more in the order of their bearings");
    }
}
static void colours(asdic_view *v, double by) {
    (void)by;
    v->look.colormap = (asdic_colormap)((v->look.colormap + 1) % ASDIC_COLORMAP_COUNT);
}
static void gain(asdic_view *v, double by) {
    (void)by;
    double now = v->look.tvg_db_per_decade;
    v->look.tvg_db_per_decade = now < 15.0 ? 20.0 : now < 25.0 ? 30.0 : now < 35.0 ? 40.0 : 0.0;
}

static void change_window(asdic_view *v, double low, double high) {
    if (v->look.db_high + high - (v->look.db_low + low) >= 10.0) {
        v->look.db_low += low;
        v->look.db_high += high;
    }
}

static void move_window(asdic_view *v, double by_db) {
    change_window(v, by_db, by_db);
}

static void narrow_window(asdic_view *v, double by_db) {
    change_window(v, by_db, 0.0);
}

/* The loop follows before its next ping. */
static void choose(asdic_view *v, const asdic_choices *now) {
    v->is_changed |= memcmp(&v->chosen, now, sizeof *now) != 0;
    v->chosen = *now;
}

static void wind(asdic_view *v, double by_kn) {
    asdic_choices now = v->chosen;
    now.wind_speed_kn = fmin(fmax(now.wind_speed_kn + by_kn, 0.0), 60.0);
    choose(v, &now);
}

static void bottom(asdic_view *v, double type) {
    asdic_choices now = v->chosen;
    if (!now.bottom.law) {
        asdic_view_say(v, "the scene has no bottom");
        return;
    }
    now.bottom = asdic_material_bottom(type);
    choose(v, &now);
}

static void source(asdic_view *v, double by_db) {
    asdic_choices now = v->chosen;
    now.source_level_db = fmin(fmax(now.source_level_db + by_db, -100.0), 260.0);
    choose(v, &now);
}

static void rays(asdic_view *v, double times) {
    asdic_choices now = v->chosen;
    now.rays = (uint32_t)fmin(fmax(times * now.rays, 64.0), 1u << 22);
    choose(v, &now);
    asdic_governor_want(&v->governor, now.rays);
}

static const struct {
    const char *name, *does;
    void (*act)(asdic_view *view, double by);
    double by;
} keys[] = {
    {"up", "faster, by 0.25 m/s", change_speed, 0.25},
    {"down", "slower", change_speed, -0.25},
    {"left", "rudder to port, by a quarter", turn_rudder, -0.25},
    {"right", "rudder to starboard", turn_rudder, 0.25},
    {"x", "rudder amidships", turn_rudder, 0.0},
    {"pageup", "planes to rise, by a quarter", turn_planes, -0.25},
    {"pagedown", "planes to dive", turn_planes, 0.25},
    {"h", "hold the depth, or let it go", hold, 0.0},
    {"a", "let the mission fly again", by_mission, 0.0},
    {"space", "pause, go on", pause_for, 0.0},
    {".", "a single ping", pause_for, 1.0},
    {"r", "record, stop recording", record, 0.0},
    {"b", "next beam", beam, 1.0},
    {"g", "previous beam", beam, -1.0},
    {"v", "fan or waterfall", fan_or_waterfall, 0.0},
    {"c", "next colour map", colours, 0.0},
    {"t", "time-varied gain of the picture: none, 20, 30, 40 log r", gain, 0.0},
    {"[", "window of levels 5 dB down", move_window, -5.0},
    {"]", "window of levels 5 dB up", move_window, 5.0},
    {"-", "narrower window", narrow_window, 5.0},
    {"=", "wider window", narrow_window, -5.0},
    {"o", "5 kn less wind", wind, -5.0},
    {"p", "5 kn more wind", wind, 5.0},
    {"1", "bottom of mud", bottom, 1.0},
    {"2", "bottom of sand", bottom, 2.0},
    {"3", "bottom of gravel", bottom, 3.0},
    {"4", "bottom of rock", bottom, 4.0},
    {"k", "source level 5 dB lower", source, -5.0},
    {"l", "source level 5 dB higher", source, 5.0},
    {"n", "half the rays", rays, 0.5},
    {"m", "twice the rays", rays, 2.0},
    {"q", "quit", quit, 0.0},
};
#define KEYS (sizeof keys / sizeof *keys)

bool asdic_view_press(asdic_view *view, const char *key) {
    for (size_t i = 0; view && key && i < KEYS; i++) {
        if (strcmp(keys[i].name, key) == 0) {
            keys[i].act(view, keys[i].by);
            return true;
        }
    }
    return false;
}

const char *asdic_view_key_name(size_t index, const char **does) {
    if (index >= KEYS) {
        return NULL;
    }
    if (does) {
        *does = keys[index].does;
    }
    return keys[index].name;
}
