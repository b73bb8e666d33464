/*
 * Making, checking and clearing a run folder on the disk.
 */
#ifndef ASDIC_MISSION_RUN_FOLDER_H
#define ASDIC_MISSION_RUN_FOLDER_H

#include "base/arena.h"

#include <asdic/context.h>

#include <dirent.h>

/* Whether FOLDER holds a run, finished or not. */
bool asdic_folder_has_run(const char *folder);

/* ASDIC_ERROR_ARGUMENT when an earlier run, trial or data set is both to be replaced and to go on. */
asdic_status asdic_folder_check_mode(asdic_context *ctx, bool force, bool resume);

/* ASDIC_ERROR_ARGUMENT, in FUNCTION's name, when there are no PARTS, one of them is NULL, or OUT_FOLDER is. */
asdic_status asdic_folder_check_parts(asdic_context *ctx, const char *function,
                                      const char *const *parts, size_t count,
                                      const char *out_folder);

/* Creates FOLDER if need be (its parents must exist) and keeps other processes from writing a run
 * or data set to it until *OUT is closed: ASDIC_ERROR_EXISTS when one does so just now. */
asdic_status asdic_folder_hold(asdic_context *ctx, const char *folder, DIR **out);

/* A folder that holds a run is an error, which names --resume if that CAN_RESUME it, unless FORCE
 * removes the run: the files that it writes, nothing else. So is one that holds no run but a file of
 * such a name, unless FORCE gives it up. */
asdic_status asdic_folder_prepare(asdic_context *ctx, const char *folder, bool force,
                                  bool can_resume);

/* Removes what was detected in FOLDER, open as DIR, before the run gets more pings; a warning says
 * so. */
asdic_status asdic_folder_drop_found(asdic_context *ctx, const char *folder, DIR *dir);

/* No force is meant for the scene's own grid or track: ASDIC_ERROR_EXISTS where a file that TEXT, of the file
 * SCENE, names lies in FOLDER, is not called OWN, and would be replaced by a run there. */
asdic_status asdic_folder_spare(asdic_context *ctx, const char *folder, const char *scene,
                                const char *text, const char *own);

/* The names of the PNG pictures that a run draws and FOLDER has, sorted; *NAMES is ARENA's. */
asdic_status asdic_folder_pictures(asdic_context *ctx, const char *folder, asdic_arena *arena,
                                   const char ***names, size_t *count);

/* Removes a run that holds nothing, and the folder when it is empty then. Says nothing: the last
 * error stays. */
void asdic_folder_remove(const char *folder);

#endif
