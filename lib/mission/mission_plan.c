#include "mission.h"

#include "base/context.h"

#include <stdlib.h>

asdic_status asdic_mission_plan(asdic_context *ctx, const asdic_mission *mission, asdic_plan *out) {
    if (!mission || !out) {
        return asdic_fail(ctx, ASDIC_ERROR_ARGUMENT, "asdic_mission_plan: NULL argument");
    }
    size_t count = asdic_mission_ping_count(mission);
    asdic_pose *poses = malloc(count * sizeof *poses);
    if (!poses) {
        return asdic_fail_memory(ctx, "the poses of a mission");
    }
    for (size_t i = 0; i < count; i++) {
        poses[i] = asdic_mission_pose(mission, i, NULL);
    }
    asdic_status status =
        asdic_plan_make(ctx, asdic_mission_scene(mission), asdic_mission_environment(mission),
                        asdic_mission_sonar(mission),
                        asdic_mission_sampling((asdic_mission *)mission), poses, count, out);
    free(poses);
    return status;
}
