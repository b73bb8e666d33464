/*
 * What a mission needs: the terms that no ping would miss.
 */
#include "mission.h"

#include "base/context.h"
#include "base/memory_left.h"
#include "base/try.h"

#include <stdio.h>
#include <stdlib.h>

/* --- terms ------------------------------------------------------------------------------------ */

/* Keeps every term of what there is: a vehicle that is steered by hand may come where a term
 * matters. */
static void keep_all(const asdic_mission *mission, asdic_plan *plan) {
    const asdic_scene_info scene = asdic_scene_get_info(mission->scene);
    const bool is_there[ASDIC_TERM_COUNT] = {
        [ASDIC_TERM_BOTTOM] = scene.has_bottom_plane,
        [ASDIC_TERM_SURFACE] = scene.has_surface,
        [ASDIC_TERM_VOLUME] = true,
        [ASDIC_TERM_OBJECTS] = asdic_mission_object_count(mission) > 0,
        [ASDIC_TERM_BORIC_ACID] = true,
        [ASDIC_TERM_RAYS] = true,
        [ASDIC_TERM_MULTIPATH] = mission->settings.sampling.multipath != ASDIC_MULTIPATH_OFF};
    plan->left_out = 0; /* as the rows say: a run's files are read by them */
    for (int t = 0; t < ASDIC_TERM_COUNT; t++) {
        asdic_plan_row *row = &plan->rows[t];
        if (is_there[t] && !row->kept) {
            row->kept = true;
            snprintf(row->reason, sizeof row->reason, "the scene keeps all terms");
        }
        plan->left_out |= row->kept ? 0u : 1u << t;
    }
}

/* Room for the poses of COUNT pings, to be freed. More than the memory that is left is refused
 * here, before the system kills a process for it. */
static asdic_status make_poses(asdic_context *ctx, size_t count, asdic_pose **out) {
    char what[64];
    snprintf(what, sizeof what, "the plan of %zu pings needs", count);
    TRY(asdic_memory_check(ctx, (uint64_t)count * sizeof **out, asdic_memory_left(), what,
                           "use fewer pings"));
    *out = malloc(count * sizeof **out);
    return *out ? ASDIC_OK : asdic_fail_memory(ctx, "the poses of a mission");
}

asdic_status asdic_mission_plan(asdic_context *ctx, const asdic_mission *mission, asdic_plan *out) {
    if (!mission || !out) {
        return asdic_fail(ctx, ASDIC_ERROR_ARGUMENT, "asdic_mission_plan: NULL argument");
    }
    size_t count = asdic_mission_ping_count(mission);
    asdic_pose *poses = NULL;
    TRY(make_poses(ctx, count, &poses));
    for (size_t i = 0; i < count; i++) {
        poses[i] = asdic_mission_pose(mission, i, NULL);
    }
    asdic_status status =
        asdic_plan_make(ctx, asdic_mission_scene(mission), asdic_mission_environment(mission),
                        asdic_mission_sonar(mission),
                        asdic_mission_sampling((asdic_mission *)mission), poses, count, out);
    free(poses);
    if (!status && mission->settings.keeps_all_terms) {
        keep_all(mission, out);
    }
    return status;
}
