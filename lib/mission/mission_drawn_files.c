/*
 * Files that a trial's draws name: each is opened once before anything is made, and none is kept.
 */
#include "mission_build.h"

#include "base/context.h"
#include "laws/scatterer.h"
#include "mission/scene_file/scene_draw.h"

#include <stdlib.h>
#include <string.h>

static void put(asdic_yaml_node *map, const char *key, asdic_yaml_node *value) {
    value->key = key;
    value->key_length = strlen(key);
    value->next = NULL;
    asdic_yaml_append(map, value);
}

/* As a scene takes it that has KEY in its map SECTION. */
static asdic_status include(mission_builder *b, const asdic_yaml_node *node, const char *section,
                            const char *key) {
    bool included = false;
    asdic_yaml_node value = *node, map = {.kind = ASDIC_YAML_MAP}, root = map;
    put(&map, key, &value);
    put(&root, section, &map);
    return asdic_mission_include(b, &root, &included);
}

static asdic_status read_columns(mission_builder *b, const char *law, const char *path) {
    asdic_material material = asdic_material_of(asdic_law_find(law));
    asdic_status status = asdic_material_read_table(b->ctx, &material, path, b->problems);
    free((double *)material.rows);
    return status;
}

static asdic_status read_track(mission_builder *b, bool of_vehicle, const char *path) {
    asdic_track *track = NULL;
    asdic_status status = asdic_track_load(b->ctx, path, of_vehicle, b->problems, &track);
    asdic_track_destroy(&track);
    return status;
}

/* The scale may be drawn as well: at the least of all no vertex is too far that is not so at each other. */
static asdic_status read_file(mission_builder *b, const asdic_key *key, const asdic_yaml_node *node,
                              const char *path) {
    asdic_mesh *mesh = NULL;
    asdic_status status = ASDIC_OK;
    switch (key->file) {
    case ASDIC_FILE_COLUMNS:
        return read_columns(b, key->law, path);
    case ASDIC_FILE_TRACK:
    case ASDIC_FILE_VEHICLE_TRACK:
        return read_track(b, key->file == ASDIC_FILE_VEHICLE_TRACK, path);
    case ASDIC_FILE_CAST:
        return include(b, node, "environment", "sound_speed_profile");
    case ASDIC_FILE_SONAR:
        return include(b, node, "sonar", "file");
    case ASDIC_FILE_MESH:
        status = asdic_mesh_load(b->ctx, path, 1e-6, true, &mesh);
        break;
    case ASDIC_FILE_GRID:
        status = asdic_mesh_load_grid(b->ctx, path, true, &mesh);
        break;
    }
    asdic_mesh_destroy(&mesh);
    return status;
}

typedef struct opening {
    mission_builder *b;
    asdic_status status;
} opening;

static asdic_status open_new(mission_builder *b, const asdic_key *key, asdic_yaml_node *node,
                             const char *path) {
    if (asdic_context_interrupted(b->ctx)) {
        return asdic_fail(b->ctx, ASDIC_ERROR_INTERRUPTED,
                          "interrupted while the files of draws were opened");
    }
    size_t before = b->problems->total;
    return asdic_mission_file_read(b, node, before, read_file(b, key, node, path));
}

static void open_file(void *user, const asdic_key *key, asdic_yaml_node *node) {
    opening *o = user;
    asdic_text *opened = o->b->opened, line = {0};
    const char *path = asdic_mission_resolve(o->b, node->text);
    asdic_text_format(&line, "\n%d %s\n", (int)key->file, path ? path : "");
    if (!path || line.failed) {
        o->status = asdic_fail_memory(o->b->ctx, "the names of files");
    } else if (!o->status && !(opened->data && strstr(opened->data, line.data))) {
        asdic_text_add(opened, line.data);
        o->status = open_new(o->b, key, node, path);
    }
    asdic_text_finish(&line);
}

asdic_status asdic_mission_open_drawn(mission_builder *b, const file_trial *trial) {
    opening o = {.b = b};
    const asdic_file_taker files = {open_file, &o};
    size_t before = b->problems->total;
    asdic_scene_draw_name_files(trial, b->arena, &files);
    if (b->problems->total > before) {
        asdic_yaml_mark_bad(trial->node);
    }
    return o.status;
}
