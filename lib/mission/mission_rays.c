/*
 * How many rays a ping of a mission takes, and what error they leave: expected without a device,
 * and found by simulating a few pings.
 */
#include "mission_build.h"

/* The sound speed for which a simulator fixes the number of bins. */
static double speed_mps(const asdic_mission *m) {
    return asdic_environment_sound_speed_mps(&m->settings.environment,
                                             asdic_mission_pose(m, 0, NULL).position_m.z);
}

static bool has_meshes(const asdic_scene_file *file) {
    const file_object *objects = file->objects.items;
    bool found = file->bottom.mesh.node || file->bottom.grid.node;
    for (size_t i = 0; i < file->objects.count; i++) {
        found |= objects[i].mesh.node != NULL;
    }
    return found;
}

void asdic_mission_build_rays(mission_builder *b) {
    asdic_settings *s = &b->mission->settings;
    s->has_meshes = has_meshes(b->file);
    if (b->file->sampling.rays == FILE_RAYS_AUTO) {
        s->auto_rays = asdic_rays_auto(&s->sonar, speed_mps(b->mission), s->has_meshes);
        s->sampling.rays = s->auto_rays;
    }
}

asdic_ray_forecast asdic_mission_ray_forecast(const asdic_mission *mission) {
    if (!mission) {
        return (asdic_ray_forecast){0};
    }
    const asdic_settings *s = &mission->settings;
    uint32_t rays = s->sampling.rays;
    double c_mps = speed_mps(mission);
    double error_db = asdic_rays_error_db(&s->sonar, c_mps, s->has_meshes, rays);
    return (asdic_ray_forecast){.rays = rays,
                                .is_auto = rays == s->auto_rays,
                                .auto_rays = asdic_rays_auto(&s->sonar, c_mps, s->has_meshes),
                                .stderr_db = error_db,
                                .is_rough = error_db > ASDIC_ROUGH_DB};
}
