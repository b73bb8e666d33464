#include "mission_build.h"

#include "base/context.h"

#include <string.h>

const char *asdic_mission_resolve(const mission_builder *b, const char *name) {
    const char *scene = b->mission->path;
    const char *slash = strrchr(scene, '/');
    size_t folder = *name != '/' && slash ? (size_t)(slash - scene) + 1 : 0;
    size_t length = strlen(name);
    char *path = asdic_arena_alloc(b->arena, folder + length + 1);
    if (path) {
        memcpy(path, scene, folder);
        memcpy(path + folder, name, length + 1);
    }
    return path;
}

bool asdic_mission_is_sound(const mission_builder *b) {
    static const char *const parts[] = {"environment", "surface", "objects"};
    const asdic_scene_file *file = b->file;
    bool sound = asdic_scene_node_good(file->bottom.node) &&
                 asdic_scene_node_good(file->sonar.node) &&
                 asdic_scene_node_good(file->mission.node);
    for (size_t i = 0; sound && i < sizeof parts / sizeof *parts; i++) {
        const asdic_yaml_node *part = asdic_yaml_child(file->node, parts[i]);
        sound = !part || !part->bad;
    }
    return sound;
}

asdic_status asdic_mission_file_problem(mission_builder *b, asdic_yaml_node *node,
                                        asdic_status status) {
    if (status == ASDIC_OK || status == ASDIC_ERROR_MEMORY) {
        return status;
    }
    asdic_yaml_problem(b->problems, node, "%s", asdic_context_error(b->ctx));
    return ASDIC_OK;
}

asdic_status asdic_mission_file_read(mission_builder *b, asdic_yaml_node *node, size_t before,
                                     asdic_status status) {
    if (b->problems->total > before) {
        asdic_yaml_mark_bad(node);
    }
    return asdic_mission_file_problem(b, node, status);
}
