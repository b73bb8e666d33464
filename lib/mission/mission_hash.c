/*
 * The hash of what a mission depends on besides its scene file: meshes, grids and tracks may change
 * while the scene file does not.
 */
#include "mission.h"

#include "base/context.h"
#include "base/sha256.h"
#include "scene/scene.h"

#include <stdlib.h>
#include <string.h>

/* Time, position, attitude. */
#define POSE_NUMBERS 7

/* Poses hashed at once, so that memory does not grow with a mission. */
#define CHUNK 1024

/* A chunk of poses after the hash of those before it. */
typedef struct pose_chain {
    char before[72]; /* 65 of them used */
    double numbers[CHUNK * POSE_NUMBERS];
} pose_chain;

static void put_pose(double *to, double time_s, const asdic_pose *pose) {
    const double numbers[POSE_NUMBERS] = {
        time_s,         pose->position_m.x, pose->position_m.y, pose->position_m.z,
        pose->roll_rad, pose->pitch_rad,    pose->yaw_rad};
    memcpy(to, numbers, sizeof numbers);
}

/* Hashes the poses of the vehicle, or of OBJECT when it is not NULL, at all pings into HEX. */
static void hash_poses(const asdic_mission *mission, const size_t *object, pose_chain *chain,
                       char hex[65]) {
    size_t pings = asdic_mission_ping_count(mission), used = 0;
    memset(chain->before, 0, sizeof chain->before);
    for (size_t i = 0; i < pings; i++) {
        double time_s;
        asdic_pose pose = asdic_mission_pose(mission, i, &time_s);
        if (object) {
            pose = asdic_mission_object_pose(mission, *object, i);
        }
        put_pose(chain->numbers + POSE_NUMBERS * used++, time_s, &pose);
        if (used == CHUNK || i + 1 == pings) {
            asdic_sha256_hex(chain, sizeof chain->before + used * POSE_NUMBERS * sizeof(double),
                             hex);
            memcpy(chain->before, hex, 65);
            used = 0;
        }
    }
}

/* Joins the hash NEXT to HEX. */
static void join_hash(char hex[65], const char next[65]) {
    char both[130];
    memcpy(both, hex, 65);
    memcpy(both + 65, next, 65);
    asdic_sha256_hex(both, sizeof both, hex);
}

asdic_status asdic_mission_inputs_hash(asdic_context *ctx, const asdic_mission *mission,
                                       char hex[65]) {
    const asdic_scene *scene = asdic_mission_scene(mission);
    struct {
        asdic_vec3 origin_m;
        char triangles[65], poses[65];
    } parts;
    memset(&parts, 0, sizeof parts); /* padding is hashed too */
    pose_chain *chain = malloc(sizeof *chain);
    if (!chain) {
        return asdic_fail_memory(ctx, "the hash of the poses");
    }
    hash_poses(mission, NULL, chain, parts.poses);
    asdic_sha256_hex(scene->triangles, scene->triangle_count * sizeof *scene->triangles,
                     parts.triangles);
    parts.origin_m = scene->triangle_count ? scene->origin_m : (asdic_vec3){0};
    asdic_sha256_hex(&parts, sizeof parts, hex);
    for (size_t i = 0; i < asdic_mission_object_count(mission); i++) {
        if (asdic_mission_get_object(mission, i)->moves) {
            hash_poses(mission, &i, chain, parts.poses);
            join_hash(hex, parts.poses);
        }
    }
    for (size_t i = 0; i <= scene->material_count; i++) {
        const asdic_material *m =
            i < scene->material_count ? &scene->materials[i] : &scene->surface;
        if (m->row_count) {
            asdic_sha256_hex(m->rows, 2 * m->row_count * sizeof *m->rows, parts.poses);
            join_hash(hex, parts.poses);
        }
    }
    free(chain);
    return ASDIC_OK;
}
