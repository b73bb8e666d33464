/*
 * Whether a run's files fit on their disk.
 */
#ifndef ASDIC_MISSION_RUN_SIZE_H
#define ASDIC_MISSION_RUN_SIZE_H

#include <asdic/mission.h>

/* ASDIC_ERROR_IO when the pings that OPTIONS ask for do not fit, and force was not asked for. For a
 * run that goes on, a warning. */
asdic_status asdic_run_check_room(asdic_context *ctx, const asdic_mission *mission,
                                  const asdic_run_options *options);

#endif
