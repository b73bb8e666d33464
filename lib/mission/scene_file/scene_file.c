/*
 * From the bytes of a scene file to the struct that its tables fill.
 */
#include "scene_file.h"
#include "scene_keys.h"

#include "base/number.h"

#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* --- text ------------------------------------------------------------------------------------- */

/* CODE as UTF-8; returns the number of bytes. Lone surrogates become three bytes that no reader of
 * UTF-8 accepts. */
static size_t put_utf8(uint32_t code, char *out) {
    if (code < 0x80) {
        out[0] = (char)code;
        return 1;
    }
    size_t bytes = code < 0x800 ? 2 : code < 0x10000 ? 3 : 4;
    static const unsigned char lead[] = {0, 0, 0xc0, 0xe0, 0xf0};
    for (size_t i = bytes - 1; i > 0; i--) {
        out[i] = (char)(0x80 | (code & 0x3f));
        code >>= 6;
    }
    out[0] = (char)(lead[bytes] | code);
    return bytes;
}

static size_t utf16_to_utf8(const unsigned char *bytes, size_t size, int big_endian, char *out) {
    size_t length = 0;
    for (size_t i = 0; i + 1 < size; i += 2) {
        uint32_t unit = (uint32_t)bytes[i + !big_endian] << 8 | bytes[i + big_endian];
        if (unit >= 0xd800 && unit < 0xdc00 && i + 3 < size) {
            uint32_t low = (uint32_t)bytes[i + 2 + !big_endian] << 8 | bytes[i + 2 + big_endian];
            if (low >= 0xdc00 && low < 0xe000) {
                unit = 0x10000 + ((unit - 0xd800) << 10) + (low - 0xdc00);
                i += 2;
            }
        }
        length += put_utf8(unit, out + length);
    }
    return length;
}

char *asdic_text_to_utf8(const char *bytes, size_t size, size_t *length) {
    const unsigned char *b = (const unsigned char *)bytes;
    /* Two bytes of UTF-16 make at most three of UTF-8. */
    char *out = malloc(size + size / 2 + 4);
    if (!out) {
        return NULL;
    }
    if (size >= 2 && ((b[0] == 0xff && b[1] == 0xfe) || (b[0] == 0xfe && b[1] == 0xff))) {
        *length = utf16_to_utf8(b + 2, size - 2, b[0] == 0xfe, out);
    } else {
        size_t mark = asdic_utf8_mark(bytes, size);
        *length = size - mark;
        memcpy(out, bytes + mark, *length);
    }
    out[*length] = '\0';
    return out;
}

/* --- settings in place of what the text says -------------------------------------------------- */

static asdic_yaml_node *child_of(const asdic_yaml_node *map, const char *key, size_t length) {
    asdic_yaml_node *child = map->first;
    while (child && (child->key_length != length || memcmp(child->key, key, length) != 0)) {
        child = child->next;
    }
    return child;
}

static asdic_yaml_node *make_child(asdic_yaml_node *map, const char *key, size_t length,
                                   asdic_arena *arena) {
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

/* One step of PATH from NODE; *AT moves behind it, maps that are not there are made in ARENA, if any. NULL after a problem, or
 * without memory. */
static asdic_yaml_node *step(asdic_yaml_node *node, const char *path, const char **at,
                             asdic_yaml_node *blame, asdic_arena *arena, asdic_problems *problems) {
    if (**at == '[') {
        char *end;
        size_t index = strtoul(*at + 1, &end, 10);
        if (end == *at + 1 || *end != ']' || node->kind != ASDIC_YAML_LIST ||
            index >= node->count) {
            asdic_yaml_problem(problems, blame ? blame : node,
                               "cannot set '%s': there is no '%.*s' here", path,
                               (int)(strcspn(*at, "].") + 1), *at);
            return NULL;
        }
        *at = end + 1;
        return item_of(node, index);
    }
    *at += **at == '.';
    size_t length = strcspn(*at, ".[");
    if (length == 0 || node->kind != ASDIC_YAML_MAP) {
        asdic_yaml_problem(problems, blame ? blame : node,
                           length ? "cannot set '%s': '%.*s' is not in a map here"
                                  : "cannot set '%s': a key is missing in it%.*s",
                           path, (int)length, *at);
        return NULL;
    }
    asdic_yaml_node *child = child_of(node, *at, length);
    if (!child && (*at)[length] == '[') { /* a list that is made here would be told to be none */
        asdic_yaml_problem(problems, blame ? blame : node,
                           "cannot set '%s': there is no '%.*s' here", path,
                           (int)(length + strcspn(*at + length, "].") + 1), *at);
        return NULL;
    }
    if (!child && arena) {
        child = make_child(node, *at, length, arena);
        problems->out_of_memory |= !child;
    }
    *at += length;
    return child;
}

asdic_yaml_node *asdic_scene_file_find(asdic_yaml_node *root, const char *path,
                                       asdic_yaml_node *blame, asdic_arena *arena,
                                       asdic_problems *problems) {
    asdic_yaml_node *node = root;
    const char *at = path;
    while (node && (*at || node == root)) {
        node = step(node, path, &at, blame, arena, problems);
    }
    return node;
}

/* "KEY=VALUE", where problems with what is set are said to stand; NULL without memory. */
static const char *place_of(const asdic_setting *setting, asdic_arena *arena) {
    size_t key = strlen(setting->key), value = strlen(setting->value);
    char *place = asdic_arena_alloc(arena, key + value + 2);
    if (place) {
        snprintf(place, key + value + 2, "%s=%s", setting->key, setting->value);
    }
    return place;
}

/* VALUE in NODE, which holds it as a word, where it is a list or map: "[0, 1]", "{preset: steel}". Files may be called
 * "[w" and "{w}". */
static bool set_tree(asdic_yaml_node *node, const char *value, asdic_arena *arena) {
    asdic_problems problems = {0};
    asdic_yaml_node *tree = NULL;
    bool has_memory = asdic_yaml_read(value, strlen(value), arena, &problems, &tree);
    bool is_tree = tree && problems.total == 0 && tree->kind != ASDIC_YAML_SCALAR &&
                   !(tree->first && tree->first->kind == ASDIC_YAML_SCALAR &&
                     tree->first->length == 0 && !tree->first->quoted);
    for (asdic_yaml_node *next = is_tree ? tree->first : NULL; next;) {
        asdic_yaml_node *child = next;
        next = child->next;
        child->next = NULL;
        asdic_yaml_append(node, child);
    }
    node->kind = is_tree ? tree->kind : ASDIC_YAML_SCALAR;
    asdic_yaml_set_file(node, node->file);
    has_memory &= !problems.out_of_memory;
    asdic_problems_finish(&problems);
    return has_memory;
}

void asdic_scene_file_set(asdic_yaml_node *root, const asdic_setting *setting, asdic_arena *arena,
                          asdic_problems *problems) {
    asdic_yaml_node *node = asdic_scene_file_find(root, setting->key, NULL, arena, problems);
    const char *place = node ? place_of(setting, arena) : NULL;
    problems->out_of_memory |= node && !place;
    if (!place) {
        return;
    }
    node->kind = ASDIC_YAML_SCALAR;
    node->file = place;
    node->line = node->column = node->key_line = node->key_column = 1;
    node->first = node->last = NULL;
    node->count = 0;
    node->quoted = false;
    node->length = strlen(setting->value);
    node->text = asdic_arena_string(arena, setting->value, node->length);
    problems->out_of_memory |= !node->text;
    if (setting->value[0] == '[' || setting->value[0] == '{') {
        problems->out_of_memory |= !set_tree(node, setting->value, arena);
    }
}

bool asdic_scene_key_is_in(const char *key, const char *whole) {
    size_t length = strlen(whole);
    return strncmp(key, whole, length) == 0 && strchr(".[", key[length]);
}

asdic_scene_turn asdic_scene_key_turn(const char *key) {
    /* Speeds of a cast of temperatures hang on the salinity; a whole may name a file. */
    static const char *const includes[] = {"sonar", "sonar.file", "environment",
                                           "environment.salinity_ppt",
                                           "environment.sound_speed_profile"};
    for (size_t i = 0; i < sizeof includes / sizeof *includes; i++) {
        if (strcmp(key, includes[i]) == 0) {
            return ASDIC_TURN_INCLUDES;
        }
    }
    return asdic_scene_key_is_in(key, "trial") ? ASDIC_TURN_TRIAL : ASDIC_TURN_REST;
}

/* --- the file --------------------------------------------------------------------------------- */

bool asdic_scene_file_parse(const char *text, size_t size, asdic_arena *arena,
                            asdic_problems *problems, asdic_scene_file *file) {
    asdic_yaml_node *root = NULL;
    return asdic_yaml_read(text, size, arena, problems, &root) &&
           asdic_scene_file_take(root, arena, problems, file);
}

/* Whether ROOT is what a scene's 'sonar: {file: ...}' names: then all that it lacks of a scene is one mistake. */
static bool is_sonar(const asdic_yaml_node *root, asdic_problems *problems) {
    const asdic_table *scene = asdic_scene_table();
    if (root->kind != ASDIC_YAML_MAP || !root->first ||
        !asdic_schema_key(&asdic_sonar_table, root->first->key)) {
        return false;
    }
    for (size_t i = 0; i < scene->key_count; i++) {
        if (asdic_yaml_child(root, scene->keys[i].name)) {
            return false;
        }
    }
    const char *slash = strrchr(problems->name, '/');
    asdic_problems_add(problems, root->line, root->column,
                       "these are keys of a sonar, not a scene; check a scene that names this "
                       "file: 'sonar: {file: %s}'",
                       slash ? slash + 1 : problems->name);
    return true;
}

bool asdic_scene_file_take(asdic_yaml_node *root, asdic_arena *arena, asdic_problems *problems,
                           asdic_scene_file *file) {
    memset(file, 0, sizeof *file);
    if (!root || is_sonar(root, problems)) {
        return true;
    }
    asdic_schema_read(asdic_scene_table(), asdic_scene_table(), root, arena, problems, file);
    asdic_scene_file_check(file, arena, problems);
    return !problems->out_of_memory;
}

char *asdic_mission_schema(void) {
    asdic_text text = {0};
    locale_t before = asdic_c_locale_enter();
    asdic_schema_print(asdic_scene_table(), &text);
    asdic_c_locale_leave(before);
    return asdic_text_take(&text);
}
