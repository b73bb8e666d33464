/*
 * A view inside: what it shows, and who flies.
 */
#ifndef ASDIC_LIVE_VIEW_STATE_H
#define ASDIC_LIVE_VIEW_STATE_H

#include <asdic/mission.h>
#include <asdic/view.h>

#include "base/relief.h"
#include "camera.h"
#include "governor.h"
#include "helm.h"
#include "live_expected.h"
#include "mission/run/run_section.h"
#include "out/canvas.h"
#include "out/polar.h"
#include "recording.h"

/* Where the parts of a frame are, in pixels. */
typedef struct view_layout {
    double scale;
    asdic_box title, sonar, ascope, chase, plan, status;
} view_layout;

/* Levels of the last pings, all beams. */
typedef struct view_history {
    float *levels_db; /* [row][beam][bin], a ring */
    size_t rows, count, next;
} view_history;

struct asdic_view {
    asdic_context *ctx;
    asdic_mission *mission;
    asdic_device *device;
    asdic_view_options options;
    view_layout layout;
    asdic_canvas canvas;
    asdic_camera *camera;
    asdic_relief relief; /* what the plan shows; cell size 0: not made yet */

    asdic_loop *loop;
    asdic_loop_ping ping; /* the last; beams 0: none yet */
    float *shown_db;      /* where bins are joined: its levels then */
    size_t joined;        /* bins of it that are shown as one */
    size_t steps;         /* pings since the view began */
    double time_s;        /* simulated, of the last ping */

    asdic_helm helm;
    bool is_manual;      /* keys steer; otherwise the mission flies */
    size_t mission_ping; /* the mission's next */
    asdic_governor governor;
    asdic_choices chosen; /* wanted; the loop has them unless is_changed */
    bool is_changed;
    asdic_recording *recording; /* NULL: off */
    asdic_recording **ended;    /* written when recording stops, because that takes time */
    size_t ended_count;
    bool wants_recording;

    asdic_picture_options look; /* of fan, waterfall; the window of the A-scope */
    bool has_window;
    bool shows_fan, has_fan;
    bool is_section; /* the fan */
    asdic_section section;
    size_t beam;
    double *bearing_rad; /* of the fan's beams, on its page */
    asdic_live_expected expected;
    view_history history;
    asdic_polar polar; /* of a scanned sonar: the last turn, of the beam chosen at each ping */
    asdic_vec3 *trail_m;
    size_t trail_count, trail_capacity;
    double camera_yaw_rad;
    bool is_paused, is_quit;
    bool is_flown;          /* the mission, to its end */
    unsigned steps_allowed; /* while paused */
    double begun_s;         /* when the last step began; 0: it was the first or paused */
    char *folder;           /* options.folder */
    char title[256];
    char message[160]; /* the last thing that happened */
};

double asdic_view_range_m(const asdic_view *view);

/* The last ping's: the vehicle's, with a scanned head turned. */
asdic_pose asdic_view_sonar_pose(const asdic_view *view);

/* Where object O is at the last ping. */
asdic_vec3 asdic_view_object_m(const asdic_view *view, const asdic_mission_object *o);

double asdic_view_wavelength_m(const asdic_view *view);

/* Half-power half-width of an aperture of LENGTH_M, rad. */
double asdic_view_half_width_rad(const asdic_view *view, double length_m);

/* Composes a frame of everything that is known. */
asdic_status asdic_view_draw(asdic_view *view);

/* What the mission flies at now through the water, m/s. */
double asdic_view_mission_speed_mps(const asdic_view *view);

view_layout asdic_view_lay_out(unsigned width, unsigned height);
asdic_status asdic_view_prepare_pictures(asdic_view *view);
void asdic_view_write_title(asdic_view *view);

/* A short remark for the status panel. */
void asdic_view_say(asdic_view *view, const char *format, ...)
    __attribute__((format(printf, 2, 3)));

#endif
