/* Views of a mission that flies east at 2 m/s over a bottom at 20 m and pings four times a second. */
#ifndef VIEW_RIG_H
#define VIEW_RIG_H

#include "asserts.h"
#include "test_device.h"

#include "live/view_state.h"

#include <asdic/asdic.h>

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define DEGREE (3.14159265358979323846 / 180.0)
#define THREE "[{name: a, yaw_deg: -10}, {name: b}, {name: c, yaw_deg: 10}]"

static test_device t;

/* As commands open it. */
static inline asdic_view *try_view(const char *receivers, const char *more,
                                   const asdic_view_options *options, asdic_status wanted) {
    char path[] = "/tmp/asdic-view-XXXXXX";
    asdic_mission *mission = NULL;
    asdic_view *view = NULL;
    int fd = mkstemp(path);
    assert_true(fd >= 0);
    assert_true(dprintf(fd,
                        "version: 1\nbottom: {depth_m: 20}\n"
                        "mission: {waypoints: {points_m: [[0, 0, 7], [0, 6, 7]], speed_mps: 2}}\n"
                        "sonar: {frequency_khz: 100, ping_rate_hz: 4, receivers: %s}\n%s\n",
                        receivers, more) > 0);
    close(fd);
    assert_ok(t.ctx, asdic_mission_load(t.ctx, path, &mission));
    unlink(path);
    assert_status(t.ctx, asdic_view_create(t.ctx, mission, t.device, options, &view), wanted);
    assert_true((view != NULL) == (wanted == ASDIC_OK));
    if (!view) {
        asdic_mission_destroy(&mission);
    }
    return view;
}

static inline asdic_view_options small(void) {
    asdic_view_options o = asdic_view_options_default();
    o.width = 640;
    o.height = 360;
    return o;
}

static inline asdic_view *open_view(const char *receivers, const char *more) {
    const asdic_view_options o = small();
    return try_view(receivers, more, &o, ASDIC_OK);
}

static inline void close_view(asdic_view *view) {
    asdic_mission *mission = view->mission;
    asdic_view_destroy(&view);
    asdic_mission_destroy(&mission);
}

static inline void step(asdic_view *view, int times) {
    for (int i = 0; i < times; i++) {
        assert_ok(t.ctx, asdic_view_step(view));
    }
}

/* COUNT beams 2 degrees apart, the middle ahead, behind RECEIVERS. */
static inline void add_beams(char receivers[1024], int count) {
    for (int b = 0; b < count; b++) {
        snprintf(receivers + strlen(receivers), 48, "{name: b%d, yaw_deg: %d}%s", b,
                 2 * b + 1 - count, b + 1 < count ? ", " : "]");
    }
}

#endif
