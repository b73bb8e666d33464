/*
 * MCAP files of ROS 2's messages: https://mcap.dev/spec, version 0. Messages lie in chunks, each
 * with its CRC-32 and an index; the summary at the end says what there is and where, so that a
 * reader finds a time or a topic without reading the rest. Nothing is compressed. Memory holds one
 * chunk, and of every chunk before it where it lies: some 100 bytes for 4 MiB.
 */
#ifndef ASDIC_OUT_MCAP_FILE_H
#define ASDIC_OUT_MCAP_FILE_H

#include "ros_cdr.h"

#include <asdic/context.h>

typedef struct asdic_mcap asdic_mcap;

/* Channels, at most. */
#define ASDIC_MCAP_CHANNELS 8

/* FACTS: key, value, ..., NULL, kept under NAME. */
asdic_status asdic_mcap_create(asdic_context *ctx, const char *path, const char *name,
                               const char *const *facts, asdic_mcap **out);

/* The channel of a TOPIC, whose messages are of TYPE; all before the first message. */
size_t asdic_mcap_channel(asdic_mcap *mcap, const char *topic, const asdic_ros_type *type);

/* A message, at a time after the channel's last. ASDIC_ERROR_IO as soon as the disk says so. */
asdic_status asdic_mcap_message(asdic_mcap *mcap, size_t channel, int64_t time_ns,
                                const void *bytes, size_t size);

/* Completes the file; *MCAP becomes NULL either way. */
asdic_status asdic_mcap_commit(asdic_mcap **mcap);

/* Removes what was written; nothing of NULL. */
void asdic_mcap_discard(asdic_mcap **mcap);

#endif
