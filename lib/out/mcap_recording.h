/*
 * Pings as messages of ROS 2 in an MCAP file.
 */
#ifndef ASDIC_OUT_MCAP_RECORDING_H
#define ASDIC_OUT_MCAP_RECORDING_H

#include "format.h"

#include <asdic/ros.h>

typedef struct asdic_mcap_recording asdic_mcap_recording;

/* OUTPUTS: 1u << asdic_ros_output; those that the sonar does not have are left out. */
asdic_status asdic_mcap_recording_open(asdic_context *ctx, const char *path,
                                       const asdic_format_about *about, unsigned outputs,
                                       asdic_mcap_recording **out);

/* The next ping; DETECTED as in asdic_ros_ping. */
asdic_status asdic_mcap_recording_add(asdic_mcap_recording *recording, const asdic_record *record,
                                      const bool *detected);

asdic_status asdic_mcap_recording_commit(asdic_mcap_recording **recording);
void asdic_mcap_recording_discard(asdic_mcap_recording **recording);

#endif
