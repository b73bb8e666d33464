/*
 * Making, checking and clearing a run folder on the disk.
 */
#ifndef ASDIC_MISSION_RUN_FOLDER_H
#define ASDIC_MISSION_RUN_FOLDER_H

#include <asdic/context.h>

/* Whether FOLDER holds a run, finished or not. */
bool asdic_folder_has_run(const char *folder);

/* ASDIC_ERROR_EXISTS when another process is writing a run to FOLDER just now. */
asdic_status asdic_folder_check_idle(asdic_context *ctx, const char *folder);

/* Creates FOLDER (its parents must exist); one that is there already is fine unless it holds a
 * run, which FORCE removes: the files that a run writes, nothing else. */
asdic_status asdic_folder_prepare(asdic_context *ctx, const char *folder, bool force);

/* Removes a run that holds nothing, and the folder when it is empty then. */
void asdic_folder_remove(asdic_context *ctx, const char *folder);

/* "FOLDER/NAME", freed with free(); NULL when memory is short. */
char *asdic_folder_file(const char *folder, const char *name);

/* "FOLDER/STEMNAME.EXTENSION" with NAME made fit for a file; freed with free(), NULL when memory
 * is short. */
char *asdic_folder_path(const char *folder, const char *stem, const char *name,
                        const char *extension);

#endif
