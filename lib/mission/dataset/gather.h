/*
 * The folder of a data set: its beginning, and the files about all frames at its end.
 */
#ifndef ASDIC_MISSION_DATASET_GATHER_H
#define ASDIC_MISSION_DATASET_GATHER_H

#include <asdic/dataset.h>

#include "base/text.h"

/* Whether the folder may be written to: holds no set that is to stay. */
asdic_status asdic_dataset_check(asdic_context *ctx, const asdic_dataset_options *options);

/* Sees to it that the folder is there, without a set that is to be replaced, and has its folders. */
asdic_status asdic_dataset_enter(asdic_context *ctx, const asdic_dataset_options *options);

/* Writes TEXT, dataset.json; where a set is resumed, compares it with what is there. */
asdic_status asdic_dataset_begin(asdic_context *ctx, const asdic_dataset_options *options,
                                 const char *text);

/* Once the frames are there: manifest.jsonl, the COCO files, classes.txt. */
asdic_status asdic_dataset_gather(asdic_context *ctx, const asdic_dataset_options *options);

/* SHA-256 of the scene file, as `sha256sum` prints it; where it names files, of that and theirs (inputs.c). */
asdic_status asdic_dataset_hash(asdic_context *ctx, const char *scene, char hex[65]);

/* Adds to OUT the SHA-256 of each file that a value of the scene file names, or one of the COUNT other VALUES that
 * it may get (inputs.c). */
asdic_status asdic_scene_files_hash(asdic_context *ctx, const char *scene,
                                    const char *const *values, size_t count, asdic_text *out);

#endif
