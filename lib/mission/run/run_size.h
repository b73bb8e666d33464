/*
 * Whether a run's files fit on their disk.
 */
#ifndef ASDIC_MISSION_RUN_SIZE_H
#define ASDIC_MISSION_RUN_SIZE_H

#include <asdic/mission.h>

/* ASDIC_ERROR_IO when the pings that OPTIONS ask for, less those that a resumed run has, do not
 * fit, and force was not asked for. */
asdic_status asdic_run_check_room(asdic_context *ctx, const asdic_mission *mission,
                                  const asdic_run_options *options);

#endif
