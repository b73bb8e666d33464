/*
 * The view: a mission seen as it happens. Every step flies one ping period, pings, and composes a
 * frame: fan or waterfall, A-scope with the expected curve, the scene from a chase camera, the
 * plan. Frames are pixels in memory; a window, a video stream or a PNG is the caller's business.
 *
 *     while (!asdic_view_is_over(view)) {
 *         asdic_view_step(view);
 *         frame = asdic_view_get_frame(view);
 *     }
 *
 * Keys are words: "up", "space", "b", "["; asdic_view_key_name lists them. They steer the vehicle
 * through the manoeuvring model of the mission, and change the sea, the bottom, the source level
 * and the rays. Needs cairo: without it asdic_view_create fails with ASDIC_ERROR_UNSUPPORTED.
 */
#ifndef ASDIC_VIEW_H
#define ASDIC_VIEW_H

#include <asdic/mission.h>
#include <asdic/output.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct asdic_view asdic_view;

typedef struct asdic_view_options {
    unsigned width, height; /* of frames, pixels; at least 640 x 360 */
    bool real_time;         /* rays follow the clock; the caller paces steps by the ping rate */
    uint32_t least_rays;    /* the floor to which they may fall; 0: 80 a beam, 2,000 at least */
    const char *folder;     /* recordings go to FOLDER/000, FOLDER/001, ...; NULL: none are made */
    double db_low, db_high; /* window of levels; NAN: from the first ping, rounded to 10 dB */
    asdic_colormap colormap;
} asdic_view_options;

/* 1280 x 720, not in real time, no recordings, inferno. */
ASDIC_API asdic_view_options asdic_view_options_default(void);

/* MISSION must outlive the view, which changes its sampling, sonar, environment and bottom as keys
 * ask (asdic_mission_choose). */
ASDIC_API asdic_status asdic_view_create(asdic_context *ctx, asdic_mission *mission,
                                         asdic_device *device, const asdic_view_options *options,
                                         asdic_view **out);
/* Ends a recording as asdic_view_stop does, without a word about failures. */
ASDIC_API void asdic_view_destroy(asdic_view **view);

/* Flies, pings, composes. While paused it only composes, unless a single step was asked for. */
ASDIC_API asdic_status asdic_view_step(asdic_view *view);

/* False when the key means nothing here. */
ASDIC_API bool asdic_view_press(asdic_view *view, const char *key);

/* The keys one after the other, and what they do; NULL at the end. */
ASDIC_API const char *asdic_view_key_name(size_t index, const char **does);

/* The mission has been flown to its end, and nobody steers; or the user asked to quit; or VIEW is
 * NULL. A vehicle at rest never ends. */
ASDIC_API bool asdic_view_is_over(const asdic_view *view);
ASDIC_API bool asdic_view_is_paused(const asdic_view *view);

/* Ends recording and writes what was recorded, which takes its time: each folder then holds
 * scene.yaml, track.csv and the run, which `asdic run scene.yaml` gives again to the byte. */
ASDIC_API asdic_status asdic_view_stop(asdic_view *view);

/* Pixels 0x00RRGGBB, STRIDE of them from row to row; valid until the next step. */
typedef struct asdic_view_image {
    unsigned width, height;
    size_t stride;
    const uint32_t *rgb;
} asdic_view_image;

/* The last frame, for the caller to copy or show. */
ASDIC_API asdic_view_image asdic_view_get_frame(const asdic_view *view);

/* "asdic - mission - 10 pings/s - 20,000 rays - real time": what the clock does, for a title. */
ASDIC_API const char *asdic_view_title(const asdic_view *view);

/* The last frame as PNG. */
ASDIC_API asdic_status asdic_view_save(const asdic_view *view, const char *path);

/* Pings so far, rays of the last, seconds of the clock on the wall per second simulated, and
 * whether the mission is at its end, which it is not while somebody steers. */
typedef struct asdic_view_clock {
    size_t pings;
    uint32_t rays;
    double time_s;  /* simulated, of the last ping */
    double stretch; /* 1: real time */
    bool is_flown;
} asdic_view_clock;

ASDIC_API asdic_view_clock asdic_view_get_clock(const asdic_view *view);

#ifdef __cplusplus
}
#endif

#endif
