#include "run_seat.h"

#include "base/context.h"
#include "mission/mission.h"

asdic_status asdic_seat_open(asdic_seat *seat, asdic_context *ctx, asdic_mission *mission,
                             asdic_device *device, size_t bins) {
    *seat = (asdic_seat){.mission = mission, .device = device, .block = SIZE_MAX};
    /* Every part of a mission has as many bins as its first ping. */
    double depth_m = asdic_mission_pose(mission, 0, NULL).position_m.z;
    asdic_status status = asdic_simulator_create(
        ctx, device, asdic_mission_scene(mission), asdic_mission_environment(mission),
        asdic_mission_sonar(mission), asdic_mission_sampling(mission), depth_m, &seat->simulator);
    if (status == ASDIC_OK && asdic_simulator_bin_count(seat->simulator) != bins) {
        status = asdic_fail(ctx, ASDIC_ERROR_ARGUMENT, "the simulator has %zu bins, the run %zu",
                            asdic_simulator_bin_count(seat->simulator), bins);
    }
    return status;
}

/* Learns for BLOCK at its first ping. */
static asdic_status learn(asdic_seat *seat, size_t block) {
    size_t pilot = block * ASDIC_LEARN_BLOCK;
    asdic_pose pose = asdic_mission_pose(seat->mission, pilot, NULL);
    asdic_status status = asdic_mission_place(seat->mission, seat->simulator, pilot);
    if (status == ASDIC_OK) {
        status = asdic_simulator_learn(seat->simulator, &pose, pilot);
    }
    seat->block = status == ASDIC_OK ? block : SIZE_MAX;
    return status;
}

size_t asdic_seat_volley(const asdic_seat *seat, size_t first, size_t count) {
    size_t left = ASDIC_LEARN_BLOCK - first % ASDIC_LEARN_BLOCK;
    size_t most = seat->mission->motion_count ? 1 : asdic_simulator_volley(seat->simulator);
    most = most < left ? most : left;
    return count < most ? count : most;
}

asdic_status asdic_seat_pings(asdic_seat *seat, size_t first, size_t count,
                              asdic_ping *const *results) {
    size_t block = first / ASDIC_LEARN_BLOCK;
    asdic_pose poses[ASDIC_LEARN_BLOCK];
    for (size_t k = 0; k < count; k++) {
        poses[k] = asdic_mission_pose(seat->mission, first + k, NULL);
    }
    asdic_status status = seat->block == block ? ASDIC_OK : learn(seat, block);
    if (status == ASDIC_OK) {
        status = asdic_mission_place(seat->mission, seat->simulator, first);
    }
    return status == ASDIC_OK ? asdic_simulator_pings(seat->simulator, poses, first, count, results)
                              : status;
}

void asdic_seat_close(asdic_seat *seat) {
    asdic_simulator_destroy(&seat->simulator);
}
