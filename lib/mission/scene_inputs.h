/*
 * What a scene is drawn from, whichever of it a draw takes: the scene file, and the files that it names.
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

/* Takes the file at PATH; what it returns ends the visit unless that is ASDIC_OK. */
typedef asdic_status (*asdic_scene_file_visit)(void *user, const char *path);

/* Visits each file that a value of TEXT, that of the file SCENE, names. */
asdic_status asdic_scene_visit_files(asdic_context *ctx, const char *scene, const char *text,
                                     asdic_scene_file_visit visit, void *user);

#endif
