#include "run_device.h"

#include "base/context.h"
#include "base/try.h"
#include "mission/mission.h"

asdic_status asdic_run_device_open(asdic_run_device *out, asdic_context *ctx,
                                   asdic_mission *mission, asdic_device *device, size_t bins) {
    *out = (asdic_run_device){.mission = mission, .device = device, .lesson = SIZE_MAX};
    /* Every part of a mission has as many bins as its first ping. */
    double depth_m = asdic_mission_pose(mission, 0, NULL).position_m.z;
    TRY(asdic_simulator_create(ctx, device, asdic_mission_scene(mission),
                               asdic_mission_environment(mission), asdic_mission_sonar(mission),
                               asdic_mission_sampling(mission), depth_m, &out->simulator));
    size_t found = asdic_simulator_bin_count(out->simulator);
    return found == bins ? ASDIC_OK
                         : asdic_fail(ctx, ASDIC_ERROR_ARGUMENT,
                                      "the simulator has %zu bins, the run %zu", found, bins);
}

/* Learns at the ping LESSON. */
static asdic_status learn(asdic_run_device *d, size_t lesson) {
    asdic_pose pose = asdic_mission_pose(d->mission, lesson, NULL);
    d->lesson = SIZE_MAX;
    TRY(asdic_mission_place(d->mission, d->simulator, lesson));
    TRY(asdic_simulator_learn(d->simulator, &pose, lesson));
    d->lesson = lesson;
    return ASDIC_OK;
}

size_t asdic_run_device_batch(const asdic_run_device *d, size_t first, size_t count) {
    size_t most = d->mission->motion_count ? 1 : asdic_simulator_ping_batch(d->simulator);
    size_t together;
    asdic_mission_lesson(d->mission, first, count < most ? count : most, &together);
    return together;
}

asdic_status asdic_run_device_pings(asdic_run_device *d, size_t first, size_t count,
                                    asdic_ping *const *results) {
    size_t together, lesson = asdic_mission_lesson(d->mission, first, 1, &together);
    asdic_pose poses[ASDIC_LEARN_BLOCK];
    for (size_t k = 0; k < count; k++) {
        poses[k] = asdic_mission_pose(d->mission, first + k, NULL);
    }
    if (d->lesson != lesson) {
        TRY(learn(d, lesson));
    }
    TRY(asdic_mission_place(d->mission, d->simulator, first));
    return asdic_simulator_pings(d->simulator, poses, first, count, results);
}

void asdic_run_device_close(asdic_run_device *d) {
    asdic_simulator_destroy(&d->simulator);
}
