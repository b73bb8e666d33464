/*
 * A mission from above: terrain, objects, track, and the area that the beams cover. North is up.
 */
#ifndef ASDIC_OUT_DRAW_CHART_H
#define ASDIC_OUT_DRAW_CHART_H

#include "base/relief.h"

#include <asdic/output.h>

#include <math.h>

/* A closed line; dashed where it is not on the bottom. */
typedef struct asdic_chart_area {
    double *north_m, *east_m;
    size_t count;
    uint32_t rgb;
    bool dashed;
    const char *label; /* in the legend, of the first of several with one name; NULL: none */
} asdic_chart_area;

typedef struct asdic_chart {
    const asdic_relief *relief;    /* no columns: none */
    const asdic_outline *outlines; /* at the end of the routes, for those that move */
    size_t outline_count;
    const asdic_route *routes;
    size_t route_count;
    const asdic_chart_area *areas;
    size_t area_count;
    const double *north_m, *east_m; /* the track */
    size_t track_count;
    double first_time_s, last_time_s, last_yaw_rad;
} asdic_chart;

/* Whether a track leads away from where it begins. */
static inline bool asdic_track_moves(const double *north_m, const double *east_m, size_t count) {
    for (size_t i = 1; i < count; i++) {
        if (hypot(north_m[i] - north_m[0], east_m[i] - east_m[0]) > 0.01) {
            return true;
        }
    }
    return false;
}

asdic_status asdic_draw_chart(asdic_context *ctx, const char *path, const asdic_chart *chart,
                              const asdic_picture_options *options);

#endif
