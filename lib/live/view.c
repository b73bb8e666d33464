#include "view_state.h"

#include "base/clock.h"
#include "base/context.h"
#include "base/decibel.h"
#include "base/grow.h"
#include "base/try.h"
#include "base/vec.h"
#include "loop.h"
#include "mission/mission.h"
#include "out/beam_width.h"
#include "out/raster.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define HISTORY_BYTES ((size_t)64 << 20)
#define HISTORY_ROWS 400
#define LEAST_WIDTH 640
#define LEAST_HEIGHT 360
#define MOST_SIDE 7680
#define LEAST_WINDOW_DB 10.0
/* A fan to look at has many beams. */
#define FAN_BEAMS 12

asdic_view_options asdic_view_options_default(void) {
    return (asdic_view_options){.width = 1280,
                                .height = 720,
                                .db_low = NAN,
                                .db_high = NAN,
                                .colormap = ASDIC_COLORMAP_INFERNO};
}

double asdic_view_range_m(const asdic_view *view) {
    return (double)asdic_loop_bin_count(view->loop) *
           asdic_mission_sonar(view->mission)->bin_length_m;
}

asdic_pose asdic_view_sonar_pose(const asdic_view *view) {
    asdic_sweep sweep = asdic_mission_sweep(view->mission);
    return asdic_sweep_sonar(&sweep, &view->ping.pose, view->ping.ping);
}

asdic_vec3 asdic_view_object_m(const asdic_view *view, const asdic_mission_object *o) {
    return asdic_mission_object_pose_at(view->mission, o, view->ping.time_s).position_m;
}

double asdic_view_wavelength_m(const asdic_view *view) {
    double speed_mps = asdic_environment_sound_speed_mps(asdic_mission_environment(view->mission),
                                                         view->ping.pose.position_m.z);
    return speed_mps / asdic_mission_sonar(view->mission)->frequency_hz;
}

double asdic_view_half_width_rad(const asdic_view *view, double length_m) {
    return 0.5 * asdic_half_power_rad(asdic_view_wavelength_m(view), length_m);
}

double asdic_view_mission_speed_mps(const asdic_view *view) {
    size_t pings = asdic_mission_ping_count(view->mission), i = view->mission_ping;
    if (pings < 2) {
        return 0.0;
    }
    i = i + 1 < pings ? i : pings - 2;
    double t0, t1;
    asdic_vec3 a = asdic_mission_pose(view->mission, i, &t0).position_m;
    asdic_vec3 b = asdic_mission_pose(view->mission, i + 1, &t1).position_m;
    /* Less what the current does, to which a helm adds it again. */
    const double *current_mps = view->mission->flight.current_mps;
    asdic_vec3 way_m = asdic_vec3_sub(b, a);
    return asdic_vec3_length((asdic_vec3){way_m.x / (t1 - t0) - current_mps[0],
                                          way_m.y / (t1 - t0) - current_mps[1],
                                          way_m.z / (t1 - t0)});
}

static asdic_status begin_history(asdic_view *view) {
    const asdic_sonar *sonar = asdic_mission_sonar(view->mission);
    size_t cells = sonar->receiver_count * asdic_loop_bin_count(view->loop);
    size_t rows = HISTORY_BYTES / (cells * sizeof(float));
    rows = rows > HISTORY_ROWS ? HISTORY_ROWS : rows < 2 ? 2 : rows;
    free(view->history.levels_db);
    view->history = (view_history){.rows = rows};
    view->history.levels_db = malloc(rows * cells * sizeof(float));
    if (!view->history.levels_db) {
        return asdic_fail_memory(view->ctx, "the last pings");
    }
    asdic_sweep sweep = asdic_mission_sweep(view->mission);
    asdic_polar_finish(&view->polar);
    return sweep.directions
               ? asdic_polar_init(view->ctx, &sweep, sonar->receivers[view->beam].yaw_rad,
                                  asdic_loop_bin_count(view->loop), &view->polar)
               : ASDIC_OK;
}

/* Clears histories after a change of the number of bins. */
static asdic_status resize(asdic_view *view) {
    asdic_live_expected_finish(&view->expected);
    TRY(begin_history(view));
    return asdic_live_expected_init(view->ctx, asdic_loop_bin_count(view->loop),
                                    view->options.real_time, &view->expected);
}

/* Opens a loop from POSE on with the present choices, and a recording where one is wanted. */
static asdic_status open_loop(asdic_view *view, const asdic_pose *pose, double start_s) {
    size_t bins = asdic_loop_bin_count(view->loop);
    uint64_t next = view->ping.beams > 0 ? view->ping.ping + 1 : 0;
    asdic_choices now = view->chosen;
    now.rays = asdic_governor_rays(&view->governor);
    asdic_loop_destroy(&view->loop);
    view->ping = (asdic_loop_ping){.pose = view->ping.pose}; /* what it pointed to is gone */
    TRY(asdic_mission_choose(view->ctx, view->mission, &now));
    TRY(asdic_loop_create_mission(view->ctx, view->device, view->mission, pose->position_m.z,
                                  start_s, &view->loop));
    if (asdic_loop_bin_count(view->loop) != bins) {
        TRY(resize(view));
    }
    if (!view->wants_recording) { /* a run begins with ping 0; else a scanned head goes on */
        asdic_loop_begin_at(view->loop, next);
    } else {
        TRY(asdic_recording_begin(view->ctx, view->mission, view->device, view->options.folder,
                                  &view->recording));
        asdic_view_say(view, "recording %03u", asdic_recording_number(view->recording));
    }
    return ASDIC_OK;
}

static asdic_status begin_part(asdic_view *view, const asdic_pose *pose, double start_s) {
    asdic_status status = open_loop(view, pose, start_s);
    view->is_changed = false;
    return status;
}

/* Ends the recording after a change of choices. It is written later, so that the clock does not
 * wait. */
static asdic_status put_aside(asdic_view *view) {
    if (!view->recording) {
        return ASDIC_OK;
    }
    asdic_recording **ended = realloc(view->ended, (view->ended_count + 1) * sizeof *view->ended);
    if (!ended) {
        return asdic_fail_memory(view->ctx, "a recording");
    }
    view->ended = ended;
    view->ended[view->ended_count++] = view->recording;
    view->recording = NULL;
    return ASDIC_OK;
}

asdic_status asdic_view_stop(asdic_view *view) {
    if (!view) {
        return ASDIC_ERROR_ARGUMENT;
    }
    asdic_status status = put_aside(view);
    size_t pings = 0, count = view->ended_count;
    asdic_context_hold_interrupt(view->ctx, true); /* recordings are written whole */
    for (size_t i = 0; i < count; i++) {
        size_t here = asdic_recording_pings(view->ended[i]);
        asdic_status ended = asdic_recording_end(&view->ended[i]);
        pings += ended ? 0 : here;
        status = status ? status : ended;
    }
    asdic_context_hold_interrupt(view->ctx, false);
    if (count > 0) {
        asdic_view_say(view, "recorded %zu ping%s to %s", pings, pings == 1 ? "" : "s",
                       view->options.folder);
        view->ended_count = 0;
    }
    return status;
}

/* Shows bins as one where rays are few: their mean in place of each. */
static asdic_status join_bins(asdic_view *view) {
    asdic_loop_ping *p = &view->ping;
    const double *intensity_lin = p->parts->intensity_lin[ASDIC_TOTAL];
    size_t joined = asdic_governor_joined(asdic_governor_rays(&view->governor), p->beams, p->bins);
    size_t groups = (p->bins + joined - 1) / joined;
    view->joined = joined;
    if (joined == 1) {
        return ASDIC_OK;
    }
    double *mean_lin = malloc(groups * sizeof *mean_lin);
    float *mean_db = malloc(groups * sizeof *mean_db);
    float *shown_db = realloc(view->shown_db, p->beams * p->bins * sizeof *shown_db);
    view->shown_db = shown_db ? shown_db : view->shown_db;
    bool has_room = mean_lin && mean_db && shown_db;
    for (size_t b = 0; has_room && b < p->beams; b++) {
        memset(mean_lin, 0, groups * sizeof *mean_lin);
        for (size_t n = 0; n < p->bins; n++) {
            size_t first = n - n % joined, left = p->bins - first;
            mean_lin[n / joined] +=
                intensity_lin[b * p->bins + n] / (double)(left < joined ? left : joined);
        }
        asdic_decibels(mean_lin, groups, mean_db);
        for (size_t n = 0; n < p->bins; n++) {
            shown_db[b * p->bins + n] = mean_db[n / joined];
        }
    }
    free(mean_lin);
    free(mean_db);
    p->level_db = has_room ? shown_db : p->level_db;
    return has_room ? ASDIC_OK : asdic_fail_memory(view->ctx, "levels to show");
}

static asdic_status remember(asdic_view *view) {
    view_history *h = &view->history;
    size_t cells = view->ping.beams * view->ping.bins;
    memcpy(h->levels_db + h->next * cells, view->ping.level_db, cells * sizeof(float));
    h->next = (h->next + 1) % h->rows;
    h->count += h->count < h->rows;
    if (view->polar.columns) {
        asdic_polar_add(&view->polar, view->ping.ping,
                        view->ping.level_db + view->beam * view->ping.bins);
    }
    if (!asdic_grow(&view->trail_m, view->trail_count, &view->trail_capacity,
                    sizeof *view->trail_m)) {
        return asdic_fail_memory(view->ctx, "the way flown");
    }
    view->trail_m[view->trail_count++] = view->ping.pose.position_m;
    return ASDIC_OK;
}

/* The default window is that of the first ping. */
static asdic_status open_window(asdic_view *view) {
    double low, high;
    TRY(asdic_raster_window(view->ctx, view->ping.level_db, view->ping.beams * view->ping.bins,
                            &low, &high));
    const asdic_view_options *o = &view->options;
    /* An end that is given stays, however loud the ping. */
    view->look.db_high = !isnan(o->db_high) ? o->db_high
                         : isnan(o->db_low) ? high
                                            : fmax(high, o->db_low + LEAST_WINDOW_DB);
    view->look.db_low =
        isnan(o->db_low) ? fmin(low, view->look.db_high - LEAST_WINDOW_DB) : o->db_low;
    view->has_window = true;
    return ASDIC_OK;
}

/* The pose at the next ping, and its time. */
static asdic_pose fly(asdic_view *view, double *time_s) {
    double period_s = 1.0 / asdic_mission_sonar(view->mission)->ping_rate_hz;
    size_t last = asdic_mission_ping_count(view->mission) - 1;
    *time_s = view->steps > 0 ? view->time_s + period_s : 0.0;
    if (view->is_manual) {
        return asdic_helm_advance(&view->helm, asdic_mission_scene(view->mission), period_s);
    }
    asdic_pose pose =
        asdic_mission_vehicle_pose(view->mission, view->mission_ping, view->steps ? NULL : time_s);
    view->is_flown = view->mission_ping >= last && last > 0;
    view->mission_ping += view->mission_ping < last;
    return pose;
}

static asdic_status ping(asdic_view *view) {
    double time_s;
    asdic_pose pose = fly(view, &time_s);
    bool switches = view->wants_recording != (view->recording != NULL);
    if (!view->loop || view->is_changed || switches) {
        TRY(view->wants_recording ? put_aside(view) : asdic_view_stop(view));
        TRY(begin_part(view, &pose, time_s));
    }
    TRY(asdic_loop_submit(view->loop, &pose));
    TRY(asdic_loop_collect(view->loop, &view->ping));
    if (view->recording) {
        TRY(asdic_recording_add(view->recording, &view->ping));
    }
    view->time_s = view->ping.time_s;
    view->steps++;
    TRY(join_bins(view));
    return remember(view);
}

static asdic_status step(asdic_view *view) {
    double begin_s = asdic_clock_s();
    double wall_s = view->begun_s > 0.0 ? begin_s - view->begun_s : 0.0;
    bool pings = !view->is_paused || view->steps_allowed > 0 || view->steps == 0;
    bool was_recording = view->recording != NULL;
    asdic_status status = ASDIC_OK;
    view->steps_allowed -= view->steps_allowed > 0;
    if (pings) {
        status = ping(view);
    }
    if (status) {
        return status;
    }
    if (!view->has_window) {
        TRY(open_window(view));
    }
    status = asdic_view_draw(view);
    /* Writing a recording and pauses do not count as time. */
    bool counts = pings && !(was_recording && !view->recording);
    if (counts && asdic_governor_note(&view->governor, asdic_clock_s() - begin_s, wall_s)) {
        view->is_changed = true;
    }
    view->begun_s = counts && !view->is_paused ? begin_s : 0.0;
    return status;
}

asdic_status asdic_view_step(asdic_view *view) {
    if (!view) {
        return asdic_fail(NULL, ASDIC_ERROR_ARGUMENT, "asdic_view_step: no view");
    }
    asdic_status status =
        asdic_context_interrupted(view->ctx) ? ASDIC_ERROR_INTERRUPTED : step(view);
    /* Whatever was broken off, an expected curve perhaps: it is the view that ends. */
    return status == ASDIC_ERROR_INTERRUPTED
               ? asdic_fail(view->ctx, status, "interrupted after %zu ping%s", view->steps,
                            view->steps == 1 ? "" : "s")
               : status;
}

static asdic_status check_options(asdic_context *ctx, const asdic_view_options *o) {
    if (o->width < LEAST_WIDTH || o->height < LEAST_HEIGHT || o->width > MOST_SIDE ||
        o->height > MOST_SIDE) {
        return asdic_fail(ctx, ASDIC_ERROR_ARGUMENT,
                          "a frame of %u x %u pixels; at least %d x %d, at most %d a side",
                          o->width, o->height, LEAST_WIDTH, LEAST_HEIGHT, MOST_SIDE);
    }
    if (isinf(o->db_low) || isinf(o->db_high) || o->db_low >= o->db_high) {
        return asdic_fail(ctx, ASDIC_ERROR_ARGUMENT,
                          "level window %g..%g dB is empty; give low < high", o->db_low,
                          o->db_high);
    }
    if (!asdic_colormap_name(o->colormap)) {
        return asdic_fail(ctx, ASDIC_ERROR_ARGUMENT, "no colour map %d", (int)o->colormap);
    }
    return ASDIC_OK;
}

/* What does not need a ping. */
static asdic_status begin(asdic_view *view) {
    const asdic_sonar *sonar = asdic_mission_sonar(view->mission);
    const asdic_view_options *o = &view->options;
    view->chosen = asdic_mission_get_choices(view->mission);
    if (asdic_settings_rays_are_auto(&view->mission->settings)) {
        double speed_mps = asdic_mission_speed_mps(view->mission);
        uint32_t enough =
            asdic_governor_enough(sonar->receiver_count, asdic_sonar_bin_count(sonar, speed_mps));
        uint32_t usual = asdic_sampling_default().rays;
        view->chosen.rays = enough > usual ? enough : usual;
        view->mission->settings.auto_rays = 0; /* what was chosen is no longer auto */
    }
    asdic_governor_init(&view->governor, 1.0 / sonar->ping_rate_hz, view->chosen.rays,
                        o->least_rays ? o->least_rays : asdic_governor_floor(sonar->receiver_count),
                        o->real_time);
    asdic_helm_init(&view->helm, &view->mission->flight);
    view->look = asdic_picture_options_default();
    view->look.colormap = o->colormap;
    bool scans = asdic_mission_sweep(view->mission).directions > 2;
    view->is_section = !scans && asdic_section_of(sonar, &view->section);
    view->has_fan = scans || view->is_section || asdic_beams_make_fan(sonar);
    view->shows_fan = scans || (view->has_fan && sonar->receiver_count >= FAN_BEAMS);
    view->beam = asdic_beam_ahead(sonar);
    view->layout = asdic_view_lay_out(o->width, o->height);
    view->bearing_rad = calloc(sonar->receiver_count, sizeof *view->bearing_rad);
    if (!view->bearing_rad) {
        return asdic_fail_memory(view->ctx, "bearings");
    }
    asdic_section_bearings(view->is_section ? &view->section : NULL, sonar, view->bearing_rad);
    if (o->folder) {
        view->folder = strdup(o->folder);
        view->options.folder = view->folder;
        if (!view->folder) {
            return asdic_fail_memory(view->ctx, "a name");
        }
    }
    return asdic_view_prepare_pictures(view);
}

asdic_status asdic_view_create(asdic_context *ctx, asdic_mission *mission, asdic_device *device,
                               const asdic_view_options *options, asdic_view **out) {
    if (!ASDIC_PLACE(out) || !mission || !device || !options) {
        return asdic_fail(ctx, ASDIC_ERROR_ARGUMENT, "asdic_view_create: NULL argument");
    }
    TRY(check_options(ctx, options));
    asdic_view *view = calloc(1, sizeof *view);
    if (!view) {
        return asdic_fail_memory(ctx, "a view");
    }
    view->ctx = ctx;
    view->mission = mission;
    view->device = device;
    view->options = *options;
    asdic_status status = begin(view);
    if (status) {
        asdic_view_destroy(&view);
    }
    *out = view;
    return status;
}

void asdic_view_destroy(asdic_view **pointer) {
    if (!pointer || !*pointer) {
        return;
    }
    asdic_view *view = *pointer;
    asdic_view_stop(view);
    free(view->ended);
    asdic_live_expected_finish(&view->expected);
    asdic_camera_destroy(&view->camera);
    free(view->relief.depth_m);
    free(view->relief.is_object);
    asdic_loop_destroy(&view->loop);
    asdic_canvas_finish(&view->canvas);
    free(view->history.levels_db);
    asdic_polar_finish(&view->polar);
    free(view->bearing_rad);
    free(view->shown_db);
    free(view->trail_m);
    free(view->folder);
    free(view);
    *pointer = NULL;
}

bool asdic_view_is_over(const asdic_view *view) {
    return !view || view->is_quit || (view->is_flown && !view->is_manual);
}

bool asdic_view_is_paused(const asdic_view *view) {
    return view && view->is_paused;
}

const char *asdic_view_title(const asdic_view *view) {
    return view ? view->title : NULL;
}

asdic_view_clock asdic_view_get_clock(const asdic_view *view) {
    if (!view) {
        return (asdic_view_clock){0};
    }
    return (asdic_view_clock){.pings = view->steps,
                              .rays = asdic_governor_rays(&view->governor),
                              .time_s = view->time_s,
                              .stretch = asdic_governor_stretch(&view->governor),
                              .is_flown = view->is_flown && !view->is_manual};
}
