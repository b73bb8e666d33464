/*
 * The hash of what a scene is drawn from, whichever of it a draw takes: the scene file, and the files that it names.
 * A mission's own hash (mission.h) is of what one draw took.
 */
#ifndef ASDIC_MISSION_SCENE_INPUTS_H
#define ASDIC_MISSION_SCENE_INPUTS_H

#include <asdic/context.h>

#include "base/text.h"

/* SHA-256 of the scene file, as `sha256sum` prints it; where it names files, of that and theirs. */
asdic_status asdic_scene_inputs_hash(asdic_context *ctx, const char *scene, char hex[65]);

/* Adds to OUT the SHA-256 of each file that a value of the scene file names, or one of the COUNT other VALUES that
 * it may get. */
asdic_status asdic_scene_files_hash(asdic_context *ctx, const char *scene,
                                    const char *const *values, size_t count, asdic_text *out);

#endif
