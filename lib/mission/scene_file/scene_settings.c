/*
 * Values put into a scene's tree before it is read: "sonar.receivers[0].pitch_deg" = "10".
 */
#include "scene_settings.h"

#include <stdlib.h>
#include <string.h>

/* The child called KEY of MAP, made when there is none. */
static asdic_yaml_node *child_of(asdic_yaml_node *map, const char *key, size_t length,
                                 asdic_arena *arena) {
    for (asdic_yaml_node *child = map->first; child; child = child->next) {
        if (child->key_length == length && memcmp(child->key, key, length) == 0) {
            return child;
        }
    }
    asdic_yaml_node *child = asdic_arena_alloc(arena, sizeof *child);
    if (child) {
        child->kind = ASDIC_YAML_MAP;
        child->line = child->key_line = map->line;
        child->column = child->key_column = map->column;
        child->key = asdic_arena_string(arena, key, length);
        child->key_length = length;
        asdic_yaml_append(map, child);
    }
    return child && child->key ? child : NULL;
}

static asdic_yaml_node *item_of(asdic_yaml_node *list, size_t index) {
    asdic_yaml_node *item = list->first;
    while (item && index-- > 0) {
        item = item->next;
    }
    return item;
}

/* One step of PATH from NODE; *AT moves behind it. NULL after a problem, or without memory. */
static asdic_yaml_node *step(asdic_yaml_node *node, const char *path, const char **at,
                             asdic_arena *arena, asdic_problems *problems) {
    if (**at == '[') {
        char *end;
        size_t index = strtoul(*at + 1, &end, 10);
        if (end == *at + 1 || *end != ']' || node->kind != ASDIC_YAML_LIST ||
            index >= node->count) {
            asdic_yaml_problem(problems, node, "cannot set '%s': there is no '%.*s' here", path,
                               (int)(strcspn(*at, "].") + 1), *at);
            return NULL;
        }
        *at = end + 1;
        return item_of(node, index);
    }
    *at += **at == '.';
    size_t length = strcspn(*at, ".[");
    if (length == 0 || node->kind != ASDIC_YAML_MAP) {
        asdic_yaml_problem(problems, node,
                           length ? "cannot set '%s': '%.*s' is not in a map here"
                                  : "cannot set '%s': a key is missing in it%.*s",
                           path, (int)length, *at);
        return NULL;
    }
    asdic_yaml_node *child = child_of(node, *at, length, arena);
    problems->out_of_memory |= !child;
    *at += length;
    return child;
}

void asdic_scene_set(asdic_yaml_node *root, const asdic_setting *setting, asdic_arena *arena,
                     asdic_problems *problems) {
    asdic_yaml_node *node = root;
    const char *at = setting->key;
    while (node && (*at || node == root)) {
        node = step(node, setting->key, &at, arena, problems);
    }
    if (!node) {
        return;
    }
    node->kind = ASDIC_YAML_SCALAR;
    node->first = node->last = NULL;
    node->count = 0;
    node->quoted = false;
    node->length = strlen(setting->value);
    node->text = asdic_arena_string(arena, setting->value, node->length);
    problems->out_of_memory |= !node->text;
}
