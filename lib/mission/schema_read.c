/*
 * Walks a YAML map and its table together.
 */
#include "schema.h"

#include "../base/words.h"
#include "../base/text.h"

#include <math.h>
#include <string.h>

/* More than any table has. */
#define MAX_TABLE_KEYS 32

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

static bool is_hidden(const asdic_key *key) {
    return (key->flags & ASDIC_KEY_PLANNED) && key->type != ASDIC_KEY_BOOL && !key->words;
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

/* Did-you-mean for a slip, else the one other map that has such a key, else the keys here. */
static void report_unknown_key(const asdic_schema_reader *r, const asdic_table *table,
                               asdic_yaml_node *node) {
    const char *names[MAX_TABLE_KEYS] = {0};
    size_t count = 0;
    asdic_text home = {0}, list = {0};
    for (size_t i = 0; i < table->key_count && count < MAX_TABLE_KEYS; i++) {
        if (!is_hidden(&table->keys[i])) {
            names[count] = table->keys[i].name;
            asdic_text_format(&list, "%s%s", count ? ", " : "", names[count]);
            count++;
        }
    }
    size_t nearest = asdic_words_nearest(node->key, names, count);
    if (nearest < count) {
        asdic_yaml_key_problem(r->problems, node, "unknown key '%.64s'; did you mean '%s'?",
                               node->key, names[nearest]);
    } else if (find_homes(r->root, node->key, "", &home) == 1) {
        asdic_yaml_key_problem(r->problems, node, "unknown key '%.64s' here; it belongs in %s",
                               node->key, home.data ? home.data : "another map");
    } else {
        asdic_yaml_key_problem(r->problems, node, "unknown key '%.64s'; the keys here are %s",
                               node->key, list.data ? list.data : "none");
    }
    asdic_text_finish(&list);
    asdic_text_finish(&home);
}

/* "a, b or c" of the keys of TABLE with FLAG that can be used, quoted. */
static void list_alternatives(const asdic_table *table, unsigned flag, asdic_text *text) {
    for (size_t i = 0; i < table->key_count; i++) {
        if ((table->keys[i].flags & flag) && !is_hidden(&table->keys[i])) {
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

static void read_list(const asdic_schema_reader *r, const asdic_key *key, asdic_yaml_node *node,
                      asdic_list *out) {
    if (node->kind != ASDIC_YAML_LIST) {
        asdic_yaml_problem(r->problems, node, "'%s' must be a list%s", key->name,
                           key->map_form ? " or a map" : "");
        return;
    }
    if (node->count > key->count || node->count < key->min) {
        asdic_yaml_problem(r->problems, node,
                           "'%s' has %zu entries, which is out of range [%g, %zu]", key->name,
                           node->count, key->min, key->count);
        return;
    }
    const size_t size = key->table->size;
    char *items = asdic_arena_alloc(r->arena, (node->count + 1) * size);
    if (!items) {
        r->problems->out_of_memory = true;
        return;
    }
    *out = (asdic_list){.items = items, .count = node->count};
    for (asdic_yaml_node *item = node->first; item; item = item->next, items += size) {
        read_map(r, key->table, item, items);
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
    if (!node && map && (key->flags & ASDIC_KEY_REQUIRED)) {
        report_missing(r, key, map);
    }
    if (node && is_hidden(key)) {
        asdic_yaml_key_problem(r->problems, node,
                               "'%s' is not supported yet in this version; leave it out",
                               key->name);
        return;
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

/* A scalar where a map should be may stand for one of its keys: NODE as such a map, or NULL. */
static asdic_yaml_node *expand_scalar(const asdic_schema_reader *r, const asdic_table *table,
                                      asdic_yaml_node *node) {
    const char *name = NULL;
    const char *value = node->text;
    if (table->scalar_key && (node->length > 0 || node->quoted)) {
        name = table->scalar_key;
    } else if (table->scalar_word && strcmp(node->text, table->scalar_word) == 0) {
        name = table->scalar_word;
        value = "true";
    }
    asdic_yaml_node *map = name ? asdic_arena_alloc(r->arena, sizeof *map) : NULL;
    asdic_yaml_node *child = map ? asdic_arena_alloc(r->arena, sizeof *child) : NULL;
    if (!child) {
        r->problems->out_of_memory |= name != NULL;
        return NULL;
    }
    *map = *node;
    map->kind = ASDIC_YAML_MAP;
    *child = *node;
    child->text = value;
    child->length = strlen(value);
    child->quoted = node->quoted && value == node->text;
    child->next = NULL;
    child->key = name;
    child->key_length = strlen(name);
    asdic_yaml_append(map, child);
    return map;
}

static void read_map(const asdic_schema_reader *r, const asdic_table *table, asdic_yaml_node *node,
                     void *out) {
    if (node && node->kind == ASDIC_YAML_SCALAR) {
        asdic_yaml_node *map = node->bad ? NULL : expand_scalar(r, table, node);
        if (!map && !node->bad) {
            asdic_yaml_problem(r->problems, node, "%s must be a map, that is 'key: value' lines%s",
                               node->parent && !node->key ? "each entry" : "this",
                               node->length == 0 ? "; leave the key out for its defaults" : "");
        }
        node = map;
    } else if (node && node->kind == ASDIC_YAML_LIST) {
        asdic_yaml_problem(r->problems, node, "this must be a map, that is 'key: value' lines");
        node = NULL;
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
