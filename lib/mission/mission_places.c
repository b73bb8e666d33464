/*
 * Whether sonar, bottom and objects are where they can meet.
 */
#include "mission_build.h"

#include "../base/context.h"
#include "../base/vec.h"

/* Poses tested against a bottom that is no plane; longer missions are tested at even steps. */
#define MAX_TESTED_PINGS 10000

/* A depth above which no bottom lies. */
#define ABOVE_ALL_M (-1e6)

/* Middle and radius of the box round OBJECT, in the world. */
static asdic_vec3 bounding_sphere(const asdic_mission_object *object, double *radius_m) {
    const asdic_mesh_info *info = &object->mesh;
    const asdic_pose *pose = &object->pose;
    asdic_mat3 turn = asdic_mat3_attitude(pose->roll_rad, pose->pitch_rad, pose->yaw_rad);
    asdic_vec3 middle = asdic_vec3_scale(asdic_vec3_add(info->min_m, info->max_m), 0.5);
    *radius_m = 0.5 * asdic_vec3_length(asdic_vec3_sub(info->max_m, info->min_m));
    return asdic_vec3_add(pose->position_m, asdic_mat3_apply(turn, middle));
}

/* Depth of the highest bottom at the place of POSITION; INFINITY where there is none. */
static double bottom_depth_m(const asdic_scene *scene, asdic_vec3 position_m) {
    position_m.z = ABOVE_ALL_M;
    return ABOVE_ALL_M + asdic_scene_altitude_m(scene, position_m);
}

static void check_depths(mission_builder *b) {
    const asdic_mission *m = b->mission;
    const asdic_yaml_node *mission = b->file->mission.node;
    asdic_yaml_node *node = asdic_yaml_child(mission, m->track ? "track" : "pose");
    size_t step = m->ping_count / MAX_TESTED_PINGS + 1;
    size_t last = m->track ? m->ping_count : 1;
    for (size_t i = 0; i < last; i += step) {
        double time_s;
        asdic_pose pose = asdic_mission_pose(m, i, &time_s);
        double depth_m = bottom_depth_m(m->scene, pose.position_m);
        /* A mesh in float is not exact to the last digit. */
        if (pose.position_m.z > depth_m + 1e-6 * fabs(depth_m)) {
            asdic_yaml_problem(b->problems, node,
                               "ping %zu at %.15g s: the sonar is at z = %.6g m, below the bottom "
                               "at %.6g m; raise it or lower the bottom",
                               i, time_s, pose.position_m.z, depth_m);
            return;
        }
    }
}

/* A bottom wholly above the surface has its values the wrong way up. */
static void check_bottom_depth(mission_builder *b) {
    const file_bottom *bottom = &b->file->bottom;
    asdic_yaml_node *node = bottom->grid.node ? bottom->grid.node : bottom->mesh.node;
    if (!node || b->mission->object_count == 0) {
        return;
    }
    double radius_m;
    const asdic_mission_object *object = &b->mission->objects[0];
    asdic_vec3 middle = bounding_sphere(object, &radius_m);
    bool flat = object->pose.roll_rad == 0.0 && object->pose.pitch_rad == 0.0;
    double half_m = flat ? 0.5 * (object->mesh.max_m.z - object->mesh.min_m.z) : radius_m;
    if (middle.z + half_m < 0.0) {
        asdic_yaml_problem(b->problems, asdic_yaml_child(node, "file"),
                           "the bottom lies above the sea surface, from z = %.6g to %.6g m; give "
                           "'%s' if it is upside down, or 'position_m'",
                           middle.z - half_m, middle.z + half_m,
                           bottom->mesh.node ? (bottom->mesh.z_up ? "z_up: false" : "z_up: true")
                           : bottom->grid.values == FILE_GRID_DEPTHS ? "values: heights"
                                                                     : "values: depths");
    }
}

static void remark(mission_builder *b, size_t object, const char *text) {
    const file_object *objects = b->file->objects.items;
    const asdic_yaml_node *node = objects[object].node;
    asdic_log(b->ctx, ASDIC_LOG_WARNING, "%s:%u:%u: warning: object '%s' %s  [objects[%zu]]",
              b->problems->name, node->line, node->column, objects[object].name, text, object);
}

static void remark_on_objects(mission_builder *b) {
    const asdic_mission *m = b->mission;
    size_t first = m->object_count - b->file->objects.count; /* the bottom may be before them */
    asdic_pose pose = asdic_mission_pose(m, 0, NULL);
    double range_m = asdic_sonar_max_range_m(
        &m->sonar, asdic_environment_sound_speed_mps(&m->environment, pose.position_m.z));
    for (size_t i = first; i < m->object_count; i++) {
        double radius_m;
        asdic_vec3 middle = bounding_sphere(&m->objects[i], &radius_m);
        double away_m = asdic_vec3_length(asdic_vec3_sub(middle, pose.position_m));
        if (middle.z + radius_m < 0.0) {
            remark(b, i - first, "lies above the sea surface; z is positive down");
        } else if (!m->track && away_m - radius_m > range_m) {
            remark(b, i - first, "is beyond the maximum range");
        }
    }
}

void asdic_mission_check_places(mission_builder *b) {
    check_bottom_depth(b);
    if (b->problems->total == 0) {
        check_depths(b);
        remark_on_objects(b);
    }
}
