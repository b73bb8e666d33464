/*
 * What light meets where sound bends: the scene as it stands, made when somebody first looks.
 */
#include "simulator.h"

#include "base/try.h"

asdic_status asdic_sight_move(asdic_simulator *sim, size_t movable, const asdic_pose *pose) {
    asdic_sight *sight = &sim->sight;
    if (!sight->tracer) {
        return ASDIC_OK;
    }
    asdic_placement_move(sight->placement, movable, pose);
    return asdic_tracer_move(sight->tracer, sight->placement, movable);
}

asdic_status asdic_sight_center(asdic_sight *sight, asdic_vec3 position_m) {
    return sight->tracer && asdic_placement_center(sight->placement, position_m)
               ? asdic_tracer_move_all(sight->tracer, sight->placement)
               : ASDIC_OK;
}

void asdic_sight_finish(asdic_sight *sight) {
    asdic_tracer_destroy(&sight->tracer);
    asdic_placement_destroy(&sight->placement);
}

static asdic_status create(asdic_simulator *sim) {
    const asdic_scene *scene = sim->setup.scene;
    TRY(asdic_placement_create(scene, &sim->sight.placement));
    sim->sight.placement->step_m = sim->placement->step_m; /* one frame for light and sound */
    TRY(asdic_tracer_create(sim->device, scene, &sim->sight.tracer));
    asdic_placement_center(sim->sight.placement, sim->placement->origin_m);
    for (size_t i = 0; i < scene->movable_count; i++) {
        TRY(asdic_sight_move(sim, i, &sim->placement->poses[i]));
    }
    return ASDIC_OK;
}

asdic_status asdic_simulator_look(asdic_simulator *sim, asdic_tracer **out) {
    asdic_status status = ASDIC_OK;
    bool bends = sim->lifted && sim->tracer;
    if (bends && !sim->sight.tracer) {
        status = create(sim);
    }
    if (status) {
        asdic_sight_finish(&sim->sight);
    }
    *out = bends ? sim->sight.tracer : sim->tracer;
    return status;
}
