/*
 * A track file, written row by row: what a scene's `track` reads.
 */
#ifndef ASDIC_MISSION_TRACK_WRITE_H
#define ASDIC_MISSION_TRACK_WRITE_H

#include <asdic/mission.h>

#include "out/file.h"

/* The header. */
void asdic_track_file_begin(asdic_file *file);

/* Angles are written as whole nanodegrees. */
void asdic_track_file_add(asdic_file *file, double time_s, const asdic_pose *pose);

/* FOLDER/track.csv: pings FIRST to FIRST + COUNT - 1 of MISSION. */
asdic_status asdic_track_file_write(asdic_context *ctx, const asdic_mission *mission, size_t first,
                                    size_t count, const char *path);

/* ANGLE as a whole number of nanodegrees, which a track file holds exactly: a track that is written
 * and read again is the same to the last bit. */
double asdic_track_round(double angle_rad);

#endif
