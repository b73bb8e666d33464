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

static void faster(asdic_view *v) {
    asdic_helm_change_speed(helm_of(v), 0.25);
}
static void slower(asdic_view *v) {
    asdic_helm_change_speed(helm_of(v), -0.25);
}
static void to_port(asdic_view *v) {
    asdic_helm_change_rudder(helm_of(v), -0.25);
}
static void to_starboard(asdic_view *v) {
    asdic_helm_change_rudder(helm_of(v), 0.25);
}
static void amidships(asdic_view *v) {
    asdic_helm_change_rudder(helm_of(v), 0.0);
}
static void rise(asdic_view *v) {
    asdic_helm_change_planes(helm_of(v), -0.25);
}
static void dive(asdic_view *v) {
    asdic_helm_change_planes(helm_of(v), 0.25);
}
static void hold(asdic_view *v) {
    asdic_helm_toggle_hold(helm_of(v));
}

static void by_mission(asdic_view *v) {
    if (v->is_manual) {
        v->is_manual = false;
        asdic_view_say(v, "flown by the mission again, from ping %zu", v->mission_ping);
    }
}

static void pause_or_go(asdic_view *v) {
    v->is_paused = !v->is_paused;
    v->steps_allowed = 0;
}
static void one_step(asdic_view *v) {
    v->is_paused = true;
    v->steps_allowed = 1;
}

static void record(asdic_view *v) {
    if (!v->options.folder) {
        asdic_view_say(v, "no folder to record to: start with --output DIR");
        return;
    }
    v->wants_recording = !v->wants_recording;
}

static void quit(asdic_view *v) {
    v->is_quit = true;
}

static size_t beams_of(const asdic_view *v) {
    return asdic_mission_sonar(v->mission)->receiver_count;
}

static void next_beam(asdic_view *v) {
    v->beam = (v->beam + 1) % beams_of(v);
}
static void previous_beam(asdic_view *v) {
    v->beam = (v->beam + beams_of(v) - 1) % beams_of(v);
}
static void fan_or_waterfall(asdic_view *v) {
    if (v->has_fan) {
        v->shows_fan = !v->shows_fan;
    } else {
        asdic_view_say(v, "no fan: that takes three beams or more in the order of their bearings");
    }
}
static void colours(asdic_view *v) {
    v->look.colormap = (asdic_colormap)((v->look.colormap + 1) % ASDIC_COLORMAP_COUNT);
}
static void gain(asdic_view *v) {
    double now = v->look.tvg_db_per_decade;
    v->look.tvg_db_per_decade = now < 15.0 ? 20.0 : now < 25.0 ? 30.0 : now < 35.0 ? 40.0 : 0.0;
}

static void move_window(asdic_view *v, double low, double high) {
    if (v->look.db_high + high - (v->look.db_low + low) >= 10.0) {
        v->look.db_low += low;
        v->look.db_high += high;
    }
}
static void window_down(asdic_view *v) {
    move_window(v, -5.0, -5.0);
}
static void window_up(asdic_view *v) {
    move_window(v, 5.0, 5.0);
}
static void window_narrower(asdic_view *v) {
    move_window(v, 5.0, 0.0);
}
static void window_wider(asdic_view *v) {
    move_window(v, -5.0, 0.0);
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
static void calmer(asdic_view *v) {
    wind(v, -5.0);
}
static void windier(asdic_view *v) {
    wind(v, 5.0);
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
static void mud(asdic_view *v) {
    bottom(v, 1.0);
}
static void sand(asdic_view *v) {
    bottom(v, 2.0);
}
static void gravel(asdic_view *v) {
    bottom(v, 3.0);
}
static void rock(asdic_view *v) {
    bottom(v, 4.0);
}

static void source(asdic_view *v, double by_db) {
    asdic_choices now = v->chosen;
    now.source_level_db = fmin(fmax(now.source_level_db + by_db, -100.0), 260.0);
    choose(v, &now);
}
static void softer(asdic_view *v) {
    source(v, -5.0);
}
static void louder(asdic_view *v) {
    source(v, 5.0);
}

static void rays(asdic_view *v, uint32_t wanted) {
    asdic_choices now = v->chosen;
    now.rays = wanted < 64 ? 64 : wanted > 1u << 22 ? 1u << 22 : wanted;
    choose(v, &now);
    asdic_governor_want(&v->governor, now.rays);
}
static void fewer_rays(asdic_view *v) {
    rays(v, v->chosen.rays / 2);
}
static void more_rays(asdic_view *v) {
    rays(v, v->chosen.rays * 2);
}

static const struct {
    const char *name, *does;
    void (*act)(asdic_view *view);
} keys[] = {
    {"up", "faster, by 0.25 m/s", faster},
    {"down", "slower", slower},
    {"left", "rudder to port, by a quarter", to_port},
    {"right", "rudder to starboard", to_starboard},
    {"x", "rudder amidships", amidships},
    {"pageup", "planes to rise, by a quarter", rise},
    {"pagedown", "planes to dive", dive},
    {"h", "hold the depth, or let it go", hold},
    {"a", "let the mission fly again", by_mission},
    {"space", "pause, go on", pause_or_go},
    {".", "a single ping", one_step},
    {"r", "record, stop recording", record},
    {"b", "next beam", next_beam},
    {"g", "previous beam", previous_beam},
    {"v", "fan or waterfall", fan_or_waterfall},
    {"c", "next colour map", colours},
    {"t", "time-varied gain of the picture: none, 20, 30, 40 log r", gain},
    {"[", "window of levels 5 dB down", window_down},
    {"]", "window of levels 5 dB up", window_up},
    {"-", "narrower window", window_narrower},
    {"=", "wider window", window_wider},
    {"o", "5 kn less wind", calmer},
    {"p", "5 kn more wind", windier},
    {"1", "bottom of mud", mud},
    {"2", "bottom of sand", sand},
    {"3", "bottom of gravel", gravel},
    {"4", "bottom of rock", rock},
    {"k", "source level 5 dB lower", softer},
    {"l", "source level 5 dB higher", louder},
    {"n", "half the rays", fewer_rays},
    {"m", "twice the rays", more_rays},
    {"q", "quit", quit},
};
#define KEYS (sizeof keys / sizeof *keys)

bool asdic_view_press(asdic_view *view, const char *key) {
    for (size_t i = 0; view && key && i < KEYS; i++) {
        if (strcmp(keys[i].name, key) == 0) {
            keys[i].act(view);
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
