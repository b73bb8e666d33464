/*
 * The folder of a data set: its beginning, and the files about all frames at its end.
 */
#ifndef ASDIC_MISSION_DATASET_GATHER_H
#define ASDIC_MISSION_DATASET_GATHER_H

#include <asdic/dataset.h>

#include <dirent.h>

/* Whether the folder may be written to: holds no set that is to stay. */
asdic_status asdic_dataset_check(asdic_context *ctx, const asdic_dataset_options *options);

/* Sees to it that the folder is there, without a set that is to be replaced, and has its folders.
 * Other processes are kept from it until *LOCK is closed; it may be set where this fails, too. */
asdic_status asdic_dataset_enter(asdic_context *ctx, const asdic_dataset_options *options,
                                 DIR **lock);

/* Writes TEXT, dataset.json; where a set is resumed, compares it with what is there. */
asdic_status asdic_dataset_begin(asdic_context *ctx, const asdic_dataset_options *options,
                                 const char *text);

/* Once the frames are there: manifest.jsonl, the COCO files, classes.txt. */
asdic_status asdic_dataset_gather(asdic_context *ctx, const asdic_dataset_options *options);

#endif
