/*
 * One pass over a run's pings for all pictures that show many of them, in memory that does not grow
 * with their number.
 */
#ifndef ASDIC_MISSION_RUN_RENDER_PASS_H
#define ASDIC_MISSION_RUN_RENDER_PASS_H

#include "out/decimate.h"
#include "out/overview.h"
#include "run_render.h"

#define ASDIC_TRACK_POINTS 4096

typedef struct asdic_render_pass {
    asdic_decimator waterfalls[ASDIC_RENDER_WATERFALLS]; /* of render.beams */
    asdic_overview overview;
    double overview_db_per_decade, overview_db_per_m; /* its gain */
    double *north_m,
        *east_m; /* the track: at most ASDIC_TRACK_POINTS + 1 points, the last one there */
    size_t track_count;
    asdic_pose last_pose;
    double bottom_depth_m; /* straight below the first ping; INFINITY: no bottom */
} asdic_render_pass;

/* Reads the pings once for the pictures that RENDER wants. */
asdic_status asdic_render_pass_run(asdic_render *render, asdic_render_pass *out);
void asdic_render_pass_finish(asdic_render_pass *pass);

#endif
