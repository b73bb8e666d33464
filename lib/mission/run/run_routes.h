/*
 * Where the objects of a run go while it lasts.
 */
#ifndef ASDIC_MISSION_RUN_ROUTES_H
#define ASDIC_MISSION_RUN_ROUTES_H

#include "run_scenery.h"

/* Cuts SCENERY's routes, which are the whole mission's, to the time from FIRST_TIME_S to LAST_TIME_S,
 * and takes the outlines of objects that move along to where these are at its end. A route that leads
 * nowhere is left out. */
void asdic_routes_cut(asdic_scenery *scenery, double first_time_s, double last_time_s);

#endif
