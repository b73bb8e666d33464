/*
 * What the chart of a run shows beside its pings, kept in the run folder so that pictures can be
 * drawn without the meshes: terrain.asc, the bottom's depths as an ESRI ASCII grid (x east, y
 * north); objects.csv, outlines of objects at the first ping (x north, y east); routes.csv, the
 * routes of objects that move. A file without content is not written.
 */
#ifndef ASDIC_MISSION_RUN_CHART_DATA_H
#define ASDIC_MISSION_RUN_CHART_DATA_H

#include "base/relief.h"

#include <asdic/mission.h>

typedef struct asdic_chart_data {
    asdic_relief relief; /* no columns: no mesh or grid for a bottom */
    asdic_outline *outlines;
    size_t outline_count;
    asdic_route *routes;
    size_t route_count;
    asdic_route_point *points; /* of all routes, one after the other */
} asdic_chart_data;

/* Writes the files for the whole mission, whatever part of it is run. */
asdic_status asdic_chart_data_write(asdic_context *ctx, const asdic_mission *mission,
                                    const char *folder);

/* Copies the files of run FROM to run TO. */
asdic_status asdic_chart_data_copy(asdic_context *ctx, const char *from, const char *to);

asdic_status asdic_chart_data_read(asdic_context *ctx, const char *folder, asdic_chart_data *out);
/* Cuts the routes, which are the whole mission's, to the time from FIRST_TIME_S to LAST_TIME_S, and
 * moves the outlines of objects to where these are at its end. A route that leads nowhere is left
 * out. */
void asdic_chart_data_cut(asdic_chart_data *data, double first_time_s, double last_time_s);

void asdic_chart_data_finish(asdic_chart_data *data);

#endif
