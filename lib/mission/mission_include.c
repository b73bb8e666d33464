/*
 * A sonar from a file of its own: its keys go into the scene's tree where the scene gives no others.
 */
#include "mission_build.h"

#include "base/context.h"
#include "base/file_read.h"
#include "base/sha256.h"
#include "base/try.h"
#include "mission/scene_file/yaml_tree.h"

#include <stdlib.h>
#include <string.h>

/* As long as a scene file may be. */
#define MAX_SONAR_BYTES ((size_t)4 << 20)

/* The tree of the file PATH; NULL after problems, which name that file. */
static asdic_status read_tree(mission_builder *b, const char *path, asdic_yaml_node *named,
                              asdic_yaml_node **out) {
    char *bytes = NULL;
    size_t size = 0, length = 0;
    asdic_status status = asdic_file_read(b->ctx, path, MAX_SONAR_BYTES, &bytes, &size);
    if (status) {
        return asdic_mission_file_problem(b, named, status);
    }
    const char *scene = b->problems->name;
    char *text = asdic_text_to_utf8(bytes, size, &length);
    free(bytes);
    b->problems->name = path;
    bool has_memory = text && asdic_yaml_read(text, length, b->arena, b->problems, out);
    b->problems->name = scene;
    free(text);
    if (*out) {
        asdic_yaml_set_file(*out, path);
    }
    return has_memory ? ASDIC_OK : asdic_fail_memory(b->ctx, "the sonar's file");
}

static bool is_other(const asdic_yaml_node *node, const void *child) {
    return node != child;
}

void asdic_mission_take_out(asdic_yaml_node *map, const asdic_yaml_node *child) {
    asdic_yaml_filter(map, is_other, child);
}

/* Keys of a file that go with a RULER: where the scene gives that, with none of WORDS, it needs them no more. */
static const struct {
    const char *key, *ruler, *words[2];
} ruled[] = {{"receivers", "array", {NULL}},
             {"array", "receivers", {NULL}},
             {"speckle_shape", "speckle", {"k"}},
             {"side_lobe_db", "shading", {"taylor", "chebyshev"}}};

/* Whether what MAP, the scene's, says leaves KEY of FILE without effect. */
static bool is_overruled(const asdic_yaml_node *map, const char *key, const char *file) {
    for (size_t i = 0; i < sizeof ruled / sizeof *ruled; i++) {
        const asdic_yaml_node *ruler = asdic_yaml_child(map, ruled[i].ruler);
        bool is_ruled = strcmp(key, ruled[i].key) == 0 && ruler && ruler->file != file;
        for (size_t k = 0; k < 2 && is_ruled && ruled[i].words[k]; k++) {
            is_ruled =
                ruler->kind != ASDIC_YAML_SCALAR || strcmp(ruler->text, ruled[i].words[k]) != 0;
        }
        if (is_ruled) {
            return true;
        }
    }
    return false;
}

/* Adds what FROM holds and MAP does not, maps key by key. */
static void add_missing(asdic_yaml_node *map, asdic_yaml_node *from) {
    for (asdic_yaml_node *next = from->first; next;) {
        asdic_yaml_node *node = next, *own = asdic_yaml_child(map, node->key);
        next = node->next;
        node->next = NULL;
        if (own && own->kind == ASDIC_YAML_MAP && node->kind == ASDIC_YAML_MAP) {
            add_missing(own, node);
        } else if (!own && !is_overruled(map, node->key, node->file)) {
            asdic_yaml_append(map, node);
        }
    }
}

/* A run folder keeps the text, and --resume looks at the hash: both are of all that was read. */
asdic_status asdic_mission_keep_tree(mission_builder *b, const asdic_yaml_node *root) {
    asdic_text text = {0};
    asdic_yaml_print(root, &text);
    size_t length = text.length;
    char *whole = asdic_text_take(&text);
    if (!whole) {
        return asdic_fail_memory(b->ctx, "the scene with its files");
    }
    free(b->mission->text);
    b->mission->text = whole;
    asdic_sha256_hex(whole, length, b->mission->hash);
    return ASDIC_OK;
}

static asdic_status include_sonar(mission_builder *b, asdic_yaml_node *root, bool *included) {
    asdic_yaml_node *sonar = asdic_yaml_child(root, "sonar");
    asdic_yaml_node *named = asdic_yaml_child(sonar, "file"), *tree = NULL;
    if (!named || named->kind != ASDIC_YAML_SCALAR || named->length == 0) {
        return ASDIC_OK; /* if something is wrong the table says so */
    }
    const char *path = asdic_mission_resolve(b, named->text);
    if (!path) {
        return asdic_fail_memory(b->ctx, "the name of the sonar's file");
    }
    TRY(read_tree(b, path, named, &tree));
    if (!tree) {
        return ASDIC_OK; /* reported */
    }
    if (tree->kind != ASDIC_YAML_MAP || asdic_yaml_child(tree, "file")) {
        asdic_yaml_problem(b->problems, tree,
                           tree->kind == ASDIC_YAML_MAP
                               ? "a sonar's file cannot name another 'file'"
                               : "a sonar's file must hold keys of a scene's 'sonar'");
        return ASDIC_OK;
    }
    asdic_mission_take_out(sonar, named);
    add_missing(sonar, tree);
    *included = true;
    return ASDIC_OK;
}

asdic_status asdic_mission_include(mission_builder *b, asdic_yaml_node *root, bool *included) {
    TRY(include_sonar(b, root, included));
    return asdic_mission_include_cast(b, root, included);
}
