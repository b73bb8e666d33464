#include "run_inputs.h"

#include "base/context.h"
#include "base/sha256.h"
#include "scene/scene.h"

#include <stdlib.h>
#include <string.h>

/* Time, position, attitude. */
#define POSE_NUMBERS 7

static double *gather_poses(const asdic_mission *mission, size_t pings) {
    double *numbers = malloc(pings * POSE_NUMBERS * sizeof *numbers);
    for (size_t i = 0; numbers && i < pings; i++) {
        double *to = numbers + i * POSE_NUMBERS;
        asdic_pose pose = asdic_mission_pose(mission, i, &to[0]);
        to[1] = pose.position_m.x;
        to[2] = pose.position_m.y;
        to[3] = pose.position_m.z;
        to[4] = pose.roll_rad;
        to[5] = pose.pitch_rad;
        to[6] = pose.yaw_rad;
    }
    return numbers;
}

asdic_status asdic_inputs_hash(asdic_context *ctx, const asdic_mission *mission, char hex[65]) {
    const asdic_scene *scene = asdic_mission_scene(mission);
    struct {
        asdic_vec3 origin_m;
        char triangles[65], poses[65];
    } parts;
    memset(&parts, 0, sizeof parts); /* padding is hashed too */
    size_t pings = asdic_mission_ping_count(mission);
    double *poses = gather_poses(mission, pings);
    if (!poses) {
        return asdic_fail_memory(ctx, "the poses of all pings");
    }
    asdic_sha256_hex(poses, pings * POSE_NUMBERS * sizeof *poses, parts.poses);
    asdic_sha256_hex(scene->triangles, scene->triangle_count * sizeof *scene->triangles,
                     parts.triangles);
    parts.origin_m = scene->triangle_count ? scene->origin_m : (asdic_vec3){0};
    asdic_sha256_hex(&parts, sizeof parts, hex);
    free(poses);
    return ASDIC_OK;
}
