/*
 * Walks a YAML map and its table together.
 */
#include "schema.h"

#include "base/words.h"
#include "base/text.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* More than any table has. */
#define MAX_TABLE_KEYS 64
/* Longer than any key's name. */
#define MOST_KEY_BYTES 96

static void read_map(const asdic_schema_reader *r, const asdic_table *table, asdic_yaml_node *node,
                     void *out);

const asdic_key *asdic_schema_key(const asdic_table *table, const char *name) {
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
    if (asdic_schema_key(table, key)) {
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

/* The key of TABLE that NAME, which is none of them, may be a slip of; NULL: none. */
static const asdic_key *nearest_key(const asdic_table *table, const char *name) {
    const char *names[MAX_TABLE_KEYS] = {0};
    size_t count = 0;
    for (; count < table->key_count && count < MAX_TABLE_KEYS; count++) {
        names[count] = table->keys[count].name;
    }
    size_t nearest = asdic_words_nearest(name, names, count);
    return nearest < count ? &table->keys[nearest] : NULL;
}

/* What to do about a NAME that TABLE does not have: a similar key, else the only other map that has it, else the map
 * around MAP (NULL: none), else all keys of this map. To be finished. */
static asdic_text propose_key(const asdic_schema_reader *r, const asdic_table *table,
                              const asdic_yaml_node *map, const char *name) {
    asdic_text home = {0}, text = {0};
    const asdic_key *nearest = nearest_key(table, name);
    if (nearest) {
        asdic_text_format(&text, "; did you mean '%s'?", nearest->name);
    } else if (find_homes(r->root, name, "", &home) == 1) {
        asdic_text_format(&text, " here; it belongs in %s", home.data ? home.data : "another map");
    } else if (map && r->outer && asdic_schema_key(r->outer, name)) {
        const char *key = map->key ? map->key : map->parent->key; /* an entry's: its list's */
        asdic_text_format(&text, " here; it belongs beside '%s'", key);
    } else {
        for (size_t i = 0; i < table->key_count; i++) {
            asdic_text_format(&text, "%s%s", i ? ", " : "; the keys here are ",
                              table->keys[i].name);
        }
    }
    asdic_text_finish(&home);
    return text;
}

static void report_unknown_key(const asdic_schema_reader *r, const asdic_table *table,
                               asdic_yaml_node *node) {
    asdic_text remedy = propose_key(r, table, node->parent, node->key);
    asdic_yaml_key_problem(r->problems, node, "unknown key '%.*s'%s", asdic_yaml_key_shown(node),
                           node->key, remedy.data ? remedy.data : "");
    asdic_text_finish(&remedy);
}

/* Whether a child of MAP that TABLE does not know is a slip of KEY: then one error is enough. */
static bool has_slip(const asdic_table *table, const asdic_yaml_node *map, const asdic_key *key) {
    for (const asdic_yaml_node *child = map->first; child; child = child->next) {
        if (!asdic_schema_key(table, child->key) && nearest_key(table, child->key) == key) {
            return true;
        }
    }
    return false;
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
        must = must && !has_slip(table, map, &table->keys[i]);
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
        asdic_yaml_problem(r->problems, node, "'%s' must be a list%s%s%s", key->name,
                           key->map_form ? ", or a map with '" : "",
                           key->map_form ? key->map_form->keys[0].name : "",
                           key->map_form ? "'" : "");
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

/* Whether MAP of TABLE needs KEY, which it does not have. */
static bool is_missing(const asdic_table *table, const asdic_key *key, const asdic_yaml_node *map) {
    return map && (key->flags & ASDIC_KEY_REQUIRED) &&
           !(key->unless && asdic_yaml_child(map, key->unless)) &&
           !(key->instead && asdic_yaml_child(map, key->instead)) && !has_slip(table, map, key);
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

/* Whether NODE is meant as the map that may stand in place of KEY's list, not as the list's one entry. */
static bool is_map_form(const asdic_key *key, const asdic_yaml_node *node) {
    bool is_map = node && key->map_form && node->kind == ASDIC_YAML_MAP, is_entry = false;
    for (const asdic_yaml_node *child = is_map ? node->first : NULL; child; child = child->next) {
        is_entry = is_entry || asdic_schema_key(key->table, child->key);
    }
    return is_map && (!is_entry || asdic_yaml_child(node, key->map_form->keys[0].name));
}

/* KEY's value NODE, NULL: absent. */
static void read_key(const asdic_schema_reader *r, const asdic_key *key, asdic_yaml_node *node,
                     char *out) {
    void *at = out + key->offset;
    switch (key->type) {
    case ASDIC_KEY_MAP:
        if (node || !(key->flags & (ASDIC_KEY_OPTIONAL | ASDIC_KEY_REQUIRED))) {
            read_map(r, key->table, node, at);
        }
        return;
    case ASDIC_KEY_LIST:
        if (is_map_form(key, node)) {
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
        } else if (node && r->files && node->length > 0) {
            r->files->take(r->files->user, key, node);
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
            bool is_scalar = node->kind == ASDIC_YAML_SCALAR;
            bool empty = is_scalar && node->length == 0 && !node->quoted;
            const char *word = table->scalar_word;
            bool near = is_scalar && word && asdic_words_nearest(node->text, &word, 1) == 0;
            const asdic_key *top =
                node->key && r->root ? asdic_schema_key(r->root, node->key) : NULL;
            bool is_needed = top && top->flags & ASDIC_KEY_REQUIRED;
            asdic_yaml_problem(r->problems, node,
                               "%s must be a map, that is 'key: value' lines%s%s%s",
                               node->parent && !node->key ? "each entry" : "this",
                               near                  ? "; did you mean '"
                               : empty && word       ? ", or '"
                               : empty && !is_needed ? "; leave the key out for its defaults"
                                                     : "",
                               near || (empty && word) ? word : "",
                               near            ? "'?"
                               : empty && word ? "'"
                                               : "");
        }
        node = map;
    }
    *(asdic_yaml_node **)out = node;
    for (asdic_yaml_node *child = node ? node->first : NULL; child; child = child->next) {
        if (!asdic_schema_key(table, child->key)) {
            report_unknown_key(r, table, child);
        }
    }
    asdic_schema_reader inner = *r;
    inner.outer = table;
    for (size_t i = 0; i < table->key_count; i++) {
        const asdic_key *key = &table->keys[i];
        asdic_yaml_node *value = asdic_yaml_child(node, key->name);
        if (!value && is_missing(table, key, node)) {
            report_missing(r, key, node);
        }
        read_key(&inner, key, value, out);
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

/* --- a value alone ------------------------------------------------------------------------------- */

/* Makes KEY, which is that of a list, the key of its entry INDEX. */
static bool enter_list(asdic_key *key, size_t index) {
    if (key->type == ASDIC_KEY_MAP && key->table->list_key) {
        *key = *asdic_schema_key(key->table, key->table->list_key);
    }
    bool is_short = key->count > 0 && index >= key->count;
    if (key->type == ASDIC_KEY_LIST) {
        key->type = ASDIC_KEY_MAP;
    } else if (key->type == ASDIC_KEY_POINTS || key->type == ASDIC_KEY_CURVE) {
        key->count = key->type == ASDIC_KEY_POINTS ? 3 : 2;
        key->type = ASDIC_KEY_NUMBERS;
    } else if (key->type == ASDIC_KEY_NUMBERS || key->type == ASDIC_KEY_WORDS) {
        bool is_ordinate = key->ordinate && index == 1;
        *key = is_ordinate ? *key->ordinate : *key;
        key->type = key->type == ASDIC_KEY_WORDS ? ASDIC_KEY_WORD : ASDIC_KEY_NUMBER;
        key->count = 0;
    } else {
        is_short = true;
    }
    return !is_short;
}

/* Makes KEY that of its child NAME; false after a problem of BLAME. */
static bool enter_map(const asdic_schema_reader *r, asdic_key *key, const char *name,
                      asdic_yaml_node *blame) {
    const asdic_table *table = key->type == ASDIC_KEY_MAP    ? key->table
                               : key->type == ASDIC_KEY_LIST ? key->map_form
                                                             : NULL;
    const asdic_key *found = table ? asdic_schema_key(table, name) : NULL;
    if (found) {
        *key = *found;
    } else if (table) {
        asdic_text remedy = propose_key(r, table, NULL, name);
        asdic_yaml_problem(r->problems, blame, "unknown key '%.40s'%s", name,
                           remedy.data ? remedy.data : "");
        asdic_text_finish(&remedy);
    } else {
        asdic_yaml_problem(r->problems, blame, "'%s' has no keys, and so no '%.40s'", key->name,
                           name);
    }
    return found;
}

bool asdic_schema_find(const asdic_schema_reader *r, const char *path, asdic_yaml_node *blame,
                       asdic_key *out) {
    *out = (asdic_key){.name = "scene", .type = ASDIC_KEY_MAP, .table = r->root};
    for (const char *at = path; *at || at == path;) {
        if (*at == '[') {
            char *end;
            size_t index = strtoul(at + 1, &end, 10);
            if (end == at + 1 || *end != ']' || !enter_list(out, index)) {
                asdic_yaml_problem(r->problems, blame, "'%s' has no entry '%.*s'", out->name,
                                   (int)strcspn(at, "].") + 1, at);
                return false;
            }
            at = end + 1;
            continue;
        }
        at += *at == '.';
        char name[MOST_KEY_BYTES];
        size_t length = strcspn(at, ".[");
        snprintf(name, sizeof name, "%.*s", (int)length, at);
        if (!enter_map(r, out, name, blame)) {
            return false;
        }
        at += length;
    }
    out->offset = out->map_offset = 0;
    return true;
}

void asdic_schema_read_alone(const asdic_schema_reader *r, const asdic_key *key,
                             asdic_yaml_node *node) {
    size_t size = (key->type == ASDIC_KEY_NUMBERS ? key->count : 2) * sizeof(double);
    const asdic_table *inside[2] = {key->table, key->map_form};
    for (size_t i = 0; i < 2; i++) {
        size = inside[i] && inside[i]->size > size ? inside[i]->size : size;
    }
    char *out = asdic_arena_alloc(r->arena, size);
    r->problems->out_of_memory |= !out;
    if (out) {
        read_key(r, key, node, out);
    }
}
