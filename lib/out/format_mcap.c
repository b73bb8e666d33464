/*
 * run.mcap: a run as the messages of ROS 2 that a sonar's driver would send. Detections come
 * later, by a command of their own, into a file of their own.
 */
#include "mcap_recording.h"
#include "ros_outputs.h"

#define OUTPUTS                                                                                    \
    (1u << ASDIC_ROS_TRANSFORMS | 1u << ASDIC_ROS_POSE | 1u << ASDIC_ROS_SONAR |                   \
     1u << ASDIC_ROS_PICTURE)

static asdic_status open_mcap(asdic_context *ctx, const char *path, const asdic_format_about *about,
                              void **out) {
    asdic_mcap_recording *recording = NULL;
    asdic_status status = asdic_mcap_recording_open(ctx, path, about, OUTPUTS, &recording);
    *out = recording;
    return status;
}

static asdic_status write_mcap(void *file, const asdic_record *record) {
    return asdic_mcap_recording_add(file, record, NULL);
}

static void discard_mcap(void **file) {
    asdic_mcap_recording *recording = *file;
    asdic_mcap_recording_discard(&recording);
    *file = NULL;
}

static asdic_status commit_mcap(void **file) {
    asdic_mcap_recording *recording = *file;
    *file = NULL;
    return asdic_mcap_recording_commit(&recording);
}

const char asdic_format_doc_mcap[] =
    "also run.mcap: pose, levels and fan picture of every ping as messages of ROS 2";

const asdic_format asdic_format_mcap = {.file = "run.mcap",
                                        .level_bytes = 2 * sizeof(float), /* with ranges */
                                        .ping_bytes = asdic_ros_ping_bytes,
                                        .open = open_mcap,
                                        .write = write_mcap,
                                        .commit = commit_mcap,
                                        .discard = discard_mcap};
