/*
 * Objects and points at new poses, between pings.
 */
#include "simulator.h"

#include "base/context.h"
#include "base/try.h"

#include <math.h>
#include <string.h>

dev_part asdic_simulator_part(const asdic_part *part, size_t index) {
    return (dev_part){.kind = part->kind,
                      .material = (dev_uint)part->material,
                      .truth_row = (dev_uint)(DEV_TRUTH_OBJECTS + index),
                      .size_m2 = (float)(4.0 * part->radius_m * part->radius_m)};
}

asdic_sonar_frame asdic_simulator_frame(const asdic_simulator *sim, asdic_vec3 position_m) {
    const asdic_lift_room *room = &sim->setup.lift_room;
    asdic_sonar_frame frame = {asdic_placement_frame(sim->placement, position_m), room->least_m};
    double far = hypot(position_m.x - frame.origin_m.x, position_m.y - frame.origin_m.y);
    bool moves = sim->setup.layer_count > 0 && sim->setup.scene->movable_count > 0;
    while (moves && frame.reach_m < far + room->rays_m) {
        frame.reach_m *= 2.0;
    }
    return frame;
}

asdic_status asdic_simulator_center(asdic_simulator *sim, asdic_vec3 position_m) {
    double reach_m = asdic_simulator_frame(sim, position_m).reach_m;
    if (reach_m != sim->setup.lift_room.reach_m) {
        TRY(asdic_simulator_part_layers(sim, reach_m));
    }
    if (!asdic_placement_center(sim->placement, position_m) || !sim->tracer) {
        return ASDIC_OK;
    }
    TRY(asdic_tracer_move_all(sim->tracer, sim->placement));
    return asdic_sight_center(&sim->sight, position_m);
}

static asdic_status move_object(asdic_simulator *sim, size_t movable, const asdic_pose *pose) {
    size_t part = sim->setup.scene->movables[movable].part;
    asdic_placement_move(sim->placement, movable, pose);
    dev_part moved = asdic_simulator_part(&sim->placement->parts[part], part);
    TRY(asdic_buffer_write(sim->buffers.parts, part * sizeof moved, sizeof moved, &moved));
    if (!sim->tracer) { /* objects that a plan left out are not traced */
        return ASDIC_OK;
    }
    TRY(asdic_tracer_move(sim->tracer, sim->placement, movable));
    return asdic_sight_move(sim, movable, pose);
}

static const asdic_part *movable_part(const asdic_scene *scene, size_t movable) {
    return &scene->parts[scene->movables[movable].part];
}

/* Whether the scene has a part of that name that stays. */
static bool stays(const asdic_scene *scene, const char *name) {
    for (size_t i = 0; i < scene->part_count; i++) {
        if (scene->parts[i].kind == DEV_KIND_OBJECT && strcmp(scene->parts[i].name, name) == 0) {
            return true;
        }
    }
    return false;
}

asdic_status asdic_simulator_move(asdic_simulator *sim, const char *name, const asdic_pose *pose) {
    if (!sim || !name || !pose) {
        return asdic_fail(sim ? sim->ctx : NULL, ASDIC_ERROR_ARGUMENT,
                          "asdic_simulator_move: NULL argument");
    }
    const asdic_scene *scene = sim->setup.scene;
    size_t object = 0, point = 0;
    TRY(asdic_pose_check(sim->ctx, pose));
    while (object < scene->movable_count && strcmp(movable_part(scene, object)->name, name) != 0) {
        object++;
    }
    while (point < scene->point_count && strcmp(scene->points[point].name, name) != 0) {
        point++;
    }
    bool is_object = object < scene->movable_count, is_point = point < scene->point_count;
    if (is_object && is_point) { /* the first added has the lower number */
        is_object = movable_part(scene, object)->number < scene->points[point].number;
    }
    if (is_object) {
        return move_object(sim, object, pose);
    }
    if (is_point) {
        sim->placement->points[point].position_m = pose->position_m;
        return ASDIC_OK;
    }
    return stays(scene, name) ? asdic_fail(sim->ctx, ASDIC_ERROR_ARGUMENT,
                                           "object '%s' was not added as a moving one", name)
                              : asdic_fail(sim->ctx, ASDIC_ERROR_ARGUMENT,
                                           "the scene has no object or point '%s'", name);
}
