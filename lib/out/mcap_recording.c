#include "mcap_recording.h"

#include "base/context.h"
#include "base/try.h"
#include "digits.h"
#include "mcap_file.h"
#include "ros_outputs.h"

#include <math.h>
#include <stdlib.h>

struct asdic_mcap_recording {
    asdic_mcap *mcap;
    asdic_ros *ros;
    asdic_sweep sweep;
    unsigned outputs;
    size_t channels[ASDIC_ROS_OUTPUT_COUNT];
};

static const char *const topics[ASDIC_ROS_OUTPUT_COUNT] = {
    [ASDIC_ROS_TRANSFORMS] = "/tf",
    [ASDIC_ROS_POSE] = "/asdic/pose",
    [ASDIC_ROS_SONAR] = "/asdic/sonar",
    [ASDIC_ROS_PICTURE] = "/asdic/image",
    [ASDIC_ROS_DETECTIONS] = "/asdic/detections",
};

static asdic_status begin(asdic_mcap_recording *r, asdic_context *ctx, const char *path,
                          const asdic_format_about *about) {
    char seed[ASDIC_DIGITS_SIZE];
    const char *const facts[] = {
        "scene", about->scene_name, "scene_sha256", about->scene_hash, "seed", seed, NULL};
    asdic_ros_about all = asdic_ros_about_default();
    all.sonar = about->sonar;
    all.sweep = r->sweep = about->sweep;
    all.sound_speed_mps = about->sound_speed_mps;
    all.bins = about->bins;
    asdic_digits_natural(seed, about->seed);
    TRY(asdic_ros_create(ctx, &all, &r->ros));
    TRY(asdic_mcap_create(ctx, path, "asdic", facts, &r->mcap));
    for (unsigned i = 0; i < ASDIC_ROS_OUTPUT_COUNT; i++) {
        r->outputs &= topics[i] && asdic_ros_has(r->ros, i) ? ~0u : ~(1u << i);
        if (r->outputs & 1u << i) {
            r->channels[i] = asdic_mcap_channel(r->mcap, topics[i], asdic_ros_type_of(i));
        }
    }
    return ASDIC_OK;
}

asdic_status asdic_mcap_recording_open(asdic_context *ctx, const char *path,
                                       const asdic_format_about *about, unsigned outputs,
                                       asdic_mcap_recording **out) {
    asdic_mcap_recording *r = *out = calloc(1, sizeof *r);
    if (!r) {
        return asdic_fail_memory(ctx, "an MCAP file");
    }
    r->outputs = outputs;
    asdic_status status = begin(r, ctx, path, about);
    if (status) {
        asdic_mcap_recording_discard(out);
    }
    return status;
}

asdic_status asdic_mcap_recording_add(asdic_mcap_recording *r, const asdic_record *record,
                                      const bool *detected) {
    const asdic_ros_ping ping = {.time_ns = llrint(1e9 * record->time_s),
                                 .ping = record->ping,
                                 .vehicle =
                                     asdic_sweep_vehicle(&r->sweep, &record->pose, record->ping),
                                 .level_db = record->level_db[ASDIC_TOTAL],
                                 .detected = detected};
    for (unsigned i = 0; i < ASDIC_ROS_OUTPUT_COUNT; i++) {
        const void *bytes;
        size_t size;
        if (r->outputs & 1u << i) {
            TRY(asdic_ros_encode(r->ros, i, &ping, &bytes, &size));
            TRY(asdic_mcap_message(r->mcap, r->channels[i], ping.time_ns, bytes, size));
        }
    }
    return ASDIC_OK;
}

asdic_status asdic_mcap_recording_commit(asdic_mcap_recording **recording) {
    asdic_status status = asdic_mcap_commit(&(*recording)->mcap);
    asdic_mcap_recording_discard(recording);
    return status;
}

void asdic_mcap_recording_discard(asdic_mcap_recording **recording) {
    asdic_mcap_recording *r = *recording;
    if (r) {
        asdic_mcap_discard(&r->mcap);
        asdic_ros_destroy(&r->ros);
        free(r);
        *recording = NULL;
    }
}
