/*
 * Walks a YAML map and its table together.
 */
#include "schema.h"

#include "base/words.h"
#include "base/text.h"

#include <math.h>
#include <string.h>

/* More than any table has. */
#define MAX_TABLE_KEYS 64

static void read_map(const asdic_schema_reader *r, const asdic_table *table, asdic_yaml_node *node,
                     void *out);

static const asdic_key *find_key(const asdic_table *table, const char *name) {
    for (size_t i = 0; i < table->key_count; i++) {
        if (strcmp(table->keys[i].name, name) == 0) {
            return &table->keys[i];
        }
    }
    return NULL;
}

/* How many tables under TABLE have KEY; PATH becomes the path of the last one. */
static size_t find_homes(const asdic_table *table, const char *key, const char *here,
                         asdic_text *path) {
    size_t homes = 0;
    if (find_key(table, key)) {
        path->length = 0;
        asdic_text_add(path, *here ? here : "the top level");
        homes++;
    }
    for (size_t i = 0; i < table->key_count; i++) {
        const asdic_key *k = &table->keys[i];
        const asdic_table *inside[2] = {k->table, k->map_form};
        for (size_t j = 0; j < 2; j++) {
            asdic_text below = {0};
            asdic_text_format(&below, "%s%s%s%s", here, *here ? "." : "", k->name,
                              k->type == ASDIC_KEY_LIST && j == 0 ? "[]" : "");
            if (inside[j] && below.data) {
                homes += find_homes(inside[j], key, below.data, path);
            }
            asdic_text_finish(&below);
        }
    }
    return homes;
}

/* Proposes a similar key, else the only other map that has this key, else all keys of this map. */
static void report_unknown_key(const asdic_schema_reader *r, const asdic_table *table,
                               asdic_yaml_node *node) {
    const char *names[MAX_TABLE_KEYS] = {0};
    size_t count = 0;
    int shown = asdic_yaml_key_shown(node);
    asdic_text home = {0}, list = {0};
    for (size_t i = 0; i < table->key_count && count < MAX_TABLE_KEYS; i++) {
        names[count] = table->keys[i].name;
        asdic_text_format(&list, "%s%s", count ? ", " : "", names[count]);
        count++;
    }
    size_t nearest = asdic_words_nearest(node->key, names, count);
    if (nearest < count) {
        asdic_yaml_key_problem(r->problems, node, "unknown key '%.*s'; did you mean '%s'?", shown,
                               node->key, names[nearest]);
    } else if (find_homes(r->root, node->key, "", &home) == 1) {
        asdic_yaml_key_problem(r->problems, node, "unknown key '%.*s' here; it belongs in %s",
                               shown, node->key, home.data ? home.data : "another map");
    } else {
        asdic_yaml_key_problem(r->problems, node, "unknown key '%.*s'; the keys here are %s", shown,
                               node->key, list.data ? list.data : "none");
    }
    asdic_text_finish(&list);
    asdic_text_finish(&home);
}

/* "a, b or c" of the keys of TABLE with FLAG, quoted. */
static void list_alternatives(const asdic_table *table, unsigned flag, asdic_text *text) {
    for (size_t i = 0; i < table->key_count; i++) {
        if (table->keys[i].flags & flag) {
            asdic_text_format(text, "%s'%s'", text->length ? ", " : "", table->keys[i].name);
        }
    }
}

/* Of the keys with FLAG at most one may be given, with MUST exactly one. */
static void check_alternatives(const asdic_schema_reader *r, const asdic_table *table,
                               asdic_yaml_node *map, unsigned flag, bool must) {
    asdic_yaml_node *first = NULL;
    size_t flagged = 0;
    asdic_text names = {0};
    list_alternatives(table, flag, &names);
    if (names.failed) {
        r->problems->out_of_memory = true;
        asdic_text_finish(&names);
        return;
    }
    for (size_t i = 0; i < table->key_count; i++) {
        asdic_yaml_node *child = asdic_yaml_child(map, table->keys[i].name);
        if (!(table->keys[i].flags & flag)) {
            continue;
        }
        flagged++;
        if (child && first) {
            bool earlier = child->key_line != first->key_line
                               ? child->key_line < first->key_line
                               : child->key_column < first->key_column;
            asdic_yaml_node *second = earlier ? first : child;
            first = earlier ? child : first;
            asdic_yaml_key_problem(r->problems, second,
                                   "'%s' and '%s' exclude each other; give only one of %s",
                                   first->key, second->key, names.data);
        } else if (child) {
            first = child;
        }
    }
    if (must && flagged > 0 && !first) {
        asdic_yaml_problem(r->problems, map, "none of %s is given; give one of them",
                           names.data ? names.data : "the keys");
    }
    asdic_text_finish(&names);
}

/* NODE as a list of KEY's length; false after a report. */
static bool is_list(const asdic_schema_reader *r, const asdic_key *key, asdic_yaml_node *node) {
    if (node->kind != ASDIC_YAML_LIST) {
        asdic_yaml_problem(r->problems, node, "'%s' must be a list%s", key->name,
                           key->map_form ? " or a map" : "");
        return false;
    }
    if (node->count > key->count || node->count < key->least) {
        asdic_yaml_problem(r->problems, node,
                           "'%s' has %zu entries, which is out of range [%zu, %zu]", key->name,
                           node->count, key->least, key->count);
        return false;
    }
    return true;
}

/* Room for the entries of NODE, SIZE bytes each, in OUT; false when memory is short. */
static bool make_room(const asdic_schema_reader *r, const asdic_yaml_node *node, size_t size,
                      asdic_list *out) {
    void *items = asdic_arena_alloc(r->arena, (node->count + 1) * size);
    r->problems->out_of_memory |= !items;
    *out = (asdic_list){.items = items, .count = items ? node->count : 0};
    return items != NULL;
}

static void read_list(const asdic_schema_reader *r, const asdic_key *key, asdic_yaml_node *node,
                      asdic_list *out) {
    if (is_list(r, key, node) && make_room(r, node, key->table->size, out)) {
        char *items = out->items;
        for (asdic_yaml_node *item = node->first; item; item = item->next) {
            read_map(r, key->table, item, items + item->index * key->table->size);
        }
    }
}

/* A list of lists of WIDTH numbers. */
static void read_points(const asdic_schema_reader *r, const asdic_key *key, size_t width,
                        asdic_yaml_node *node, asdic_list *out) {
    asdic_key point = *key;
    point.type = ASDIC_KEY_NUMBERS;
    point.count = width;
    if (is_list(r, key, node) && make_room(r, node, width * sizeof(double), out)) {
        double *items = out->items;
        for (asdic_yaml_node *item = node->first; item; item = item->next) {
            asdic_schema_read_value(r, &point, item, items + width * item->index);
        }
    }
}

static void report_missing(const asdic_schema_reader *r, const asdic_key *key,
                           asdic_yaml_node *map) {
    if (key->unit) {
        asdic_yaml_problem(r->problems, map, "missing key '%s', in %s (%s)", key->name, key->unit,
                           key->doc);
    } else {
        asdic_yaml_problem(r->problems, map, "missing key '%s' (%s)", key->name, key->doc);
    }
}

static void read_key(const asdic_schema_reader *r, const asdic_key *key, asdic_yaml_node *map,
                     asdic_yaml_node *node, char *out) {
    void *at = out + key->offset;
    if (!node && map && (key->flags & ASDIC_KEY_REQUIRED) &&
        !(key->unless && asdic_yaml_child(map, key->unless)) &&
        !(key->instead && asdic_yaml_child(map, key->instead))) {
        report_missing(r, key, map);
    }
    switch (key->type) {
    case ASDIC_KEY_MAP:
        if (node || !(key->flags & (ASDIC_KEY_OPTIONAL | ASDIC_KEY_REQUIRED))) {
            read_map(r, key->table, node, at);
        }
        return;
    case ASDIC_KEY_LIST:
        if (node && key->map_form && node->kind == ASDIC_YAML_MAP) {
            read_map(r, key->map_form, node, out + key->map_offset);
        } else if (node) {
            read_list(r, key, node, at);
        }
        return;
    case ASDIC_KEY_POINTS:
        if (node) {
            read_points(r, key, 3, node, at);
        }
        return;
    case ASDIC_KEY_CURVE:
        if (node && node->kind != ASDIC_YAML_SCALAR && !node->bad) {
            read_points(r, key, 2, node, at);
        } else if (
            node &&
            !node->bad) { /* nothing read it: only text was given, or another file is meant */
            asdic_yaml_problem(r->problems, node,
                               "'%s' = %.200s is not here to be read; give a list of points",
                               key->name, node->text);
        }
        return;
    case ASDIC_KEY_NODE:
        *(asdic_yaml_node **)at = node;
        return;
    case ASDIC_KEY_NUMBER:
        *(double *)at = NAN; /* absent, unless there is a value or a fallback */
        break;
    default:
        break;
    }
    if (!node) {
        node = asdic_schema_fallback(r, key);
    }
    if (node) {
        asdic_schema_read_value(r, key, node, at);
    }
}

/* A map around VALUE, which stands for the map's key NAME. */
static asdic_yaml_node *wrap(const asdic_schema_reader *r, asdic_yaml_node *value,
                             const char *name) {
    asdic_yaml_node *map = asdic_arena_alloc(r->arena, sizeof *map);
    asdic_yaml_node *child = asdic_arena_alloc(r->arena, sizeof *child);
    if (!map || !child) {
        r->problems->out_of_memory = true;
        return NULL;
    }
    *map = *child = *value;
    map->kind = ASDIC_YAML_MAP;
    map->first = map->last = NULL;
    map->count = 0;
    child->next = NULL;
    child->key = name;
    child->key_length = strlen(name);
    asdic_yaml_append(map, child);
    for (asdic_yaml_node *item = child->first; item; item = item->next) {
        item->parent = child;
    }
    return map;
}

/* The key of TABLE whose value NODE is in place of a map; else the one that it is next to. */
static const char *key_of_scalar(const asdic_table *table, const asdic_yaml_node *node) {
    const char *near = NULL;
    for (size_t k = 0; table->scalar_is_any_word && k < table->key_count; k++) {
        const asdic_key *key = &table->keys[k];
        if (asdic_schema_word(key, node)) {
            return key->name;
        }
        near = !near && asdic_schema_is_near(key, node) ? key->name : near;
    }
    return near ? near : table->scalar_key;
}

/* A scalar or list where a map should be may stand for one of its keys: NODE as such a map, or
 * NULL. */
static asdic_yaml_node *expand(const asdic_schema_reader *r, const asdic_table *table,
                               asdic_yaml_node *node) {
    if (node->kind == ASDIC_YAML_LIST) {
        return table->list_key ? wrap(r, node, table->list_key) : NULL;
    }
    if (table->scalar_key && (node->length > 0 || node->quoted)) {
        return wrap(r, node, key_of_scalar(table, node));
    }
    if (table->scalar_word && strcmp(node->text, table->scalar_word) == 0) {
        asdic_yaml_node yes = *node;
        yes.text = "true";
        yes.length = strlen(yes.text);
        yes.quoted = false;
        return wrap(r, &yes, table->scalar_word);
    }
    return NULL;
}

static void read_map(const asdic_schema_reader *r, const asdic_table *table, asdic_yaml_node *node,
                     void *out) {
    if (node && node->kind != ASDIC_YAML_MAP) {
        bool silent = node->bad && node->kind == ASDIC_YAML_SCALAR; /* reported already */
        asdic_yaml_node *map = silent ? NULL : expand(r, table, node);
        if (!map && !silent) {
            bool empty = node->kind == ASDIC_YAML_SCALAR && node->length == 0 && !node->quoted;
            asdic_yaml_problem(r->problems, node, "%s must be a map, that is 'key: value' lines%s",
                               node->parent && !node->key ? "each entry" : "this",
                               empty ? "; leave the key out for its defaults" : "");
        }
        node = map;
    }
    *(asdic_yaml_node **)out = node;
    for (asdic_yaml_node *child = node ? node->first : NULL; child; child = child->next) {
        if (!find_key(table, child->key)) {
            report_unknown_key(r, table, child);
        }
    }
    for (size_t i = 0; i < table->key_count; i++) {
        const asdic_key *key = &table->keys[i];
        read_key(r, key, node, asdic_yaml_child(node, key->name), out);
    }
    if (node) {
        check_alternatives(r, table, node, ASDIC_KEY_ONE_OF, true);
        check_alternatives(r, table, node, ASDIC_KEY_AT_MOST_ONE, false);
    }
}

void asdic_schema_read(const asdic_table *table, const asdic_table *root, asdic_yaml_node *node,
                       asdic_arena *arena, asdic_problems *problems, void *out) {
    const asdic_schema_reader r = {.root = root, .arena = arena, .problems = problems};
    read_map(&r, table, node, out);
}
