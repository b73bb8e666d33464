/*
 * What a run depends on besides its scene file: meshes, grids and tracks, which may change while
 * the scene file does not.
 */
#ifndef ASDIC_MISSION_RUN_INPUTS_H
#define ASDIC_MISSION_RUN_INPUTS_H

#include <asdic/mission.h>

/* SHA-256 of the triangles and of every ping's poses, of the vehicle and of objects that move, in hexadecimal. */
asdic_status asdic_inputs_hash(asdic_context *ctx, const asdic_mission *mission, char hex[65]);

#endif
