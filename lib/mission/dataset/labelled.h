/*
 * One frame of a data set: from a ping with truth to the bytes of its files.
 */
#ifndef ASDIC_MISSION_DATASET_LABELLED_H
#define ASDIC_MISSION_DATASET_LABELLED_H

#include "base/file_name.h"
#include "mission/mission.h"

#include <asdic/dataset.h>

/* The two forms of a picture. */
typedef enum asdic_view_form {
    ASDIC_FORM_POLAR,
    ASDIC_FORM_BEARING,
    ASDIC_FORM_COUNT
} asdic_view_form;
extern const char *const asdic_form_names[ASDIC_FORM_COUNT]; /* folders: "polar", "bearing" */

/* How a sonar's bins lie in a picture. */
typedef struct asdic_frame_map {
    size_t width, height;
    uint32_t *cells; /* of each pixel, beam * bins + bin; UINT32_MAX: none */
} asdic_frame_map;

/* What a frame is drawn from. */
typedef struct asdic_labelled {
    size_t index;
    const char *folder, *scene_hash;
    char *facts;                 /* its line of the manifest, without the objects' pixels */
    const asdic_ping *ping;      /* NULL: a void frame, which has its facts alone */
    const asdic_frame_map *maps; /* by form */
    const float *gain_db;        /* by bin */
    double low_db, high_db, threshold;
    const bool *heard;       /* by asdic_lobes_reach; NULL: side lobes count, too */
    const uint16_t *classes; /* by the number of an object in the truth, from 1 to CLASS_COUNT */
    size_t class_count;
} asdic_labelled;

/* The maps of SONAR's pings of BINS; freed by asdic_frame_maps_finish. ASDIC_ERROR_INPUT: beams that do not follow
 * each other in bearing. */
asdic_status asdic_frame_maps_init(asdic_context *ctx, const asdic_sonar *sonar, size_t bins,
                                   double radius_px, asdic_frame_map maps[ASDIC_FORM_COUNT]);
void asdic_frame_maps_finish(asdic_frame_map maps[ASDIC_FORM_COUNT]);

/* The folders of a set, with what its frames have there; the frames' records come first. */
typedef struct asdic_frame_folder {
    const char *name, *extension; /* NULL: folders alone */
} asdic_frame_folder;
#define ASDIC_FRAME_FOLDERS 12
#define ASDIC_FRAME_MOST_BYTES ((size_t)1 << 28) /* of a file */
extern const asdic_frame_folder asdic_frame_folders[ASDIC_FRAME_FOLDERS];

/* Removes all files of frame INDEX. */
void asdic_frame_remove(const char *folder, size_t index);

/* Writes all files of a frame; frames/NUMBER.txt comes last and says that the frame is whole. */
asdic_status asdic_frame_write(asdic_context *ctx, const asdic_labelled *frame);

/* ASDIC_ERROR_INPUT unless FOLDER has all files of frame INDEX, as large as its record says. */
asdic_status asdic_frame_check(asdic_context *ctx, const char *folder, size_t index);

/* "FOLDER/SUB/NUMBER.EXTENSION" */
asdic_file_name asdic_frame_path(const char *folder, const char *sub, size_t index,
                                 const char *extension);

/* HEARD[(number - 1) * beams + beam] for each object, by the numbers that truth gives them: whether the beam hears
 * some of the object at half power or more, in bearing from the sonar at FRAME's first pose. OWNER has the scene, perhaps
 * with its objects elsewhere. To be freed; NULL: no memory. */
bool *asdic_lobes_reach(const asdic_mission *frame, const asdic_mission *owner);

#endif
