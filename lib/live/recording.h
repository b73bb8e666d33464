/*
 * A recording of one part of a view: a scene file, a track, and a run folder. A run of that scene
 * gives the same bytes.
 */
#ifndef ASDIC_LIVE_RECORDING_H
#define ASDIC_LIVE_RECORDING_H

#include <asdic/loop.h>

typedef struct asdic_recording asdic_recording;

/* Begins PARENT/NNN, the first number that is free; PARENT is made when needed. The loop's pings must
 * begin with the recording. */
asdic_status asdic_recording_begin(asdic_context *ctx, const asdic_mission *mission,
                                   asdic_device *device, const char *parent, asdic_recording **out);

asdic_status asdic_recording_add(asdic_recording *recording, const asdic_loop_ping *ping);

/* Writes the run folder; *RECORDING becomes NULL. A recording without pings is removed. */
asdic_status asdic_recording_end(asdic_recording **recording);

unsigned asdic_recording_number(const asdic_recording *recording);
size_t asdic_recording_pings(const asdic_recording *recording);

#endif
