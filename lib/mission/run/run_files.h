/*
 * The files that a run's records are written to as they come: bins.csv, and the formats that the
 * scene asks for.
 */
#ifndef ASDIC_MISSION_RUN_FILES_H
#define ASDIC_MISSION_RUN_FILES_H

#include <asdic/mission.h>

#include "mission/mission_settings.h"
#include "out/record.h"
#include "run_facts.h"

typedef struct asdic_files asdic_files;

/* ASDIC_ERROR_UNSUPPORTED when SETTINGS ask for a format that cannot be written here. */
asdic_status asdic_files_check(asdic_context *ctx, const asdic_settings *settings);

/* The files in FOLDER that SETTINGS ask for, of all pings that FACTS plan, the first of them at
 * DEPTH_M. They get their names on commit. */
asdic_status asdic_files_create(asdic_context *ctx, const char *folder,
                                const asdic_settings *settings, const asdic_run_facts *facts,
                                double depth_m, asdic_files **out);

/* The rows of bins.csv to the standard output, and nothing else. */
asdic_status asdic_files_create_stream(asdic_context *ctx, const asdic_settings *settings,
                                       size_t bins, asdic_files **out);

/* The next ping. ASDIC_ERROR_IO as soon as the disk says so. */
asdic_status asdic_files_add(asdic_files *files, const asdic_record *record);

/* Completes bins.csv, and when the run IS_WHOLE the formats, which hold a fixed number of pings. */
asdic_status asdic_files_commit(asdic_files *files, bool is_whole);

/* Removes what was not committed. NULL-safe. */
void asdic_files_destroy(asdic_files **files);

/* ASDIC_ERROR_IO when the pings that OPTIONS ask for do not fit, and force was not asked for. For a
 * run that goes on, a warning. */
asdic_status asdic_run_check_room(asdic_context *ctx, const asdic_mission *mission,
                                  const asdic_run_options *options);

#endif
