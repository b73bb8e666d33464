/*
 * What may be tried while a mission is flown: changed in the mission, without the scene file.
 */
#include "mission.h"

#include "base/context.h"
#include "base/try.h"
#include "scene/scene.h"

asdic_choices asdic_mission_get_choices(const asdic_mission *mission) {
    if (!mission) {
        return (asdic_choices){0};
    }
    return (asdic_choices){.wind_speed_kn = mission->environment.wind_speed_kn,
                           .bottom = mission->bottom,
                           .source_level_db = mission->sonar.source_level_db,
                           .rays = mission->sampling.rays,
                           .seed = mission->sampling.seed};
}

asdic_status asdic_mission_choose(asdic_context *ctx, asdic_mission *mission,
                                  const asdic_choices *choices) {
    if (!mission || !choices) {
        return asdic_fail(ctx, ASDIC_ERROR_ARGUMENT, "asdic_mission_choose: NULL argument");
    }
    asdic_environment environment = mission->environment;
    asdic_sonar sonar = mission->sonar;
    environment.wind_speed_kn = choices->wind_speed_kn;
    sonar.source_level_db = choices->source_level_db;
    asdic_status status = asdic_environment_check(ctx, &environment);
    if (!status) {
        status = asdic_sonar_check(ctx, &sonar);
    }
    if (status) {
        return status;
    }
    if (choices->bottom.law) {
        TRY(asdic_material_check(ctx, &choices->bottom));
    }
    if (choices->rays < 64 || choices->rays > 1u << 28) {
        return asdic_fail(ctx, ASDIC_ERROR_ARGUMENT,
                          "%u rays per ping: out of range [64, 268435456]", choices->rays);
    }
    mission->environment = environment;
    mission->sonar = sonar;
    mission->sampling.rays = choices->rays;
    mission->sampling.seed = choices->seed;
    mission->bottom = choices->bottom;
    if (!choices->bottom.law) {
        return ASDIC_OK;
    }
    asdic_scene_set_bottom(mission->scene, &choices->bottom);
    for (size_t i = 0; i < mission->object_count; i++) {
        asdic_mission_object *object = &mission->objects[i];
        if (object->name[0] == 0) {
            object->material = choices->bottom;
        }
    }
    return ASDIC_OK;
}
