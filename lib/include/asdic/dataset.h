/*
 * Labelled frames for learning: scenes drawn at random as the scene's `trial` section says, one
 * ping of each, as levels and pictures, with masks, boxes and polygons of the objects.
 */
#ifndef ASDIC_DATASET_H
#define ASDIC_DATASET_H

#include <asdic/device.h>
#include <asdic/mission.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct asdic_dataset_options {
    const char *folder;
    uint64_t seed;          /* of the draws; frame K is run K of the trial */
    size_t frames;          /* of the whole set */
    size_t first, end;      /* of these, frames first .. end - 1 are made here; SIZE_MAX: all */
    double threshold;       /* share of a bin's energy from which on it shows an object, 0..1 */
    bool side_lobes;        /* label an object also in beams that hear none of it at half power */
    double radius_px;       /* of the polar pictures: the range in pixels, 16..8192 */
    double low_db, high_db; /* what pictures show, with the gain 30 log r + 2 alpha r; NAN: as
                               the first frame fills them */
    bool force;             /* replace a set that is there */
    bool resume;            /* make what is missing of one that is there, or of a larger one */
} asdic_dataset_options;

/* Seed 1, 1,000 frames, all of them, a threshold of 0.5, no side lobes, 512 pixels, a window by the
 * first frame. */
ASDIC_API asdic_dataset_options asdic_dataset_options_default(void);

/* Makes the frames of SCENE on DEVICE. A frame depends on scene, seed, options and its number
 * alone, byte for byte. One that draws the sonar below the bottom is void: the manifest says so,
 * and it has no pictures. Reports progress ("frames") to the context, and logs what is odd about
 * the first frame that is not void. ASDIC_ERROR_INPUT: the scene, a drawing of it that makes no
 * sense, with the run's number, or all frames are void; ASDIC_ERROR_EXISTS: the folder holds a data
 * set and neither RESUME nor FORCE is set, or RESUME is and it is another one's, or has frames
 * beyond FIRST to END; ASDIC_ERROR_INTERRUPTED: RESUME goes on where it ended. Frames that were
 * finished stay. */
ASDIC_API asdic_status asdic_dataset_make(asdic_context *ctx, const char *scene,
                                          asdic_device *device,
                                          const asdic_dataset_options *options);

/* Joins parts of one set, made with other FIRST and END, into OUT_FOLDER: the bytes of a set made
 * at once. ASDIC_ERROR_INPUT: they are of different sets, or frames are missing;
 * ASDIC_ERROR_ARGUMENT: OUT_FOLDER is one of them. Nothing is touched then. */
ASDIC_API asdic_status asdic_dataset_merge(asdic_context *ctx, const char *const *folders,
                                           size_t count, const char *out_folder, bool force);

/* Whether FOLDER holds a data set or a part of one. */
ASDIC_API bool asdic_dataset_is_in(const char *folder);

#ifdef __cplusplus
}
#endif

#endif
