/*
 * A track inside.
 */
#ifndef ASDIC_MISSION_TRACK_POINTS_H
#define ASDIC_MISSION_TRACK_POINTS_H

#include "track.h"

typedef struct track_point {
    double time_s;
    double x_m, y_m, z_m;
    double roll_rad, pitch_rad, yaw_rad;
} track_point;

struct asdic_track {
    track_point *points; /* at least one; times increase */
    size_t count, capacity;
    size_t sharers; /* holders besides the first */
};

/* False when memory is short. */
bool asdic_track_append(asdic_track *track, const track_point *point);

#endif
