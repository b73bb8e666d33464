/*
 * A vehicle's track: its poses at given times, and between them.
 */
#ifndef ASDIC_MISSION_TRACK_H
#define ASDIC_MISSION_TRACK_H

#include <asdic/sweep.h>

#include "base/problems.h"
#include "out/file.h"

typedef struct track_point {
    double time_s;
    double x_m, y_m, z_m;
    double roll_rad, pitch_rad, yaw_rad;
} track_point;

typedef struct asdic_track {
    track_point *points; /* at least one; times increase */
    size_t count, capacity;
    size_t sharers; /* references beside the first */
} asdic_track;

/* Reads a CSV file with a header of time_s,x_m,y_m,z_m,roll_deg,pitch_deg,yaw_deg in any order;
 * other columns are passed over. Times must increase, a vehicle's depths be those of a sea. All that
 * is wrong in it goes to PROBLEMS, which keep PATH, and *OUT stays NULL. ASDIC_ERROR_INPUT: it cannot
 * be read. */
asdic_status asdic_track_load(asdic_context *ctx, const char *path, bool of_vehicle,
                              asdic_problems *problems, asdic_track **out);
/* Another reference to TRACK, which is freed when the last one is destroyed. Not thread-safe. */
asdic_track *asdic_track_share(asdic_track *track);
/* Puts POINT behind the last one; false when memory is short. */
bool asdic_track_append(asdic_track *track, const track_point *point);
void asdic_track_destroy(asdic_track **track);

size_t asdic_track_point_count(const asdic_track *track);
double asdic_track_start_s(const asdic_track *track);
double asdic_track_end_s(const asdic_track *track);

/* The longest time between two points, the earlier of them at *FROM_S; 0 of one point alone. */
double asdic_track_gap_s(const asdic_track *track, double *from_s);

/* Position on the straight line between two points, each angle along the shorter way round.
 * Before the start and behind the end: the first and the last pose. */
asdic_pose asdic_track_pose(const asdic_track *track, double time_s);
/* The greatest z_m from the start to TIME_S. */
double asdic_track_deepest_m(const asdic_track *track, double time_s);

/* A track file, row by row, in the form that asdic_track_load reads: its header; a point, its
 * angles as whole nanodegrees. Where SWEEP turns, the head's angle at ping PING stands behind the
 * vehicle's pose, in a column that the reader passes over. */
void asdic_track_file_begin(asdic_file *file, const asdic_sweep *sweep);
void asdic_track_file_add(asdic_file *file, const asdic_sweep *sweep, uint64_t ping, double time_s,
                          const asdic_pose *vehicle);
/* Adds the points of the track file at PATH as they stand there. */
asdic_status asdic_track_file_append(asdic_context *ctx, asdic_file *file, const char *path);

/* ANGLE as a whole number of nanodegrees, which a track file holds exactly: a track that is written
 * and read again is the same to the last bit. */
double asdic_track_round(double angle_rad);

#endif
