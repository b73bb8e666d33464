#include "scene_laws.h"

#include "scene_keys.h"

#include "laws/scatterer.h"

#include <math.h>
#include <pthread.h>
#include <stdio.h>
#include <string.h>

#define WORDS_MOST 32
#define KEYS_MOST (ASDIC_FILE_LAW_KEYS + 16)

/* The law of what names none. */
static const asdic_law *default_law(unsigned use) {
    return asdic_law_find(use & ASDIC_LAW_SURFACE  ? "course"
                          : use & ASDIC_LAW_BOTTOM ? "searay"
                                                   : "rough-facet");
}

static bool serves(const asdic_law *law, unsigned use) {
    return (law->uses & use) == use;
}

/* --- tables ------------------------------------------------------------------------------------ */

/* A table with the keys of laws behind its own. Nothing changes after the first use. */
typedef struct joined_table {
    asdic_table table;
    asdic_key keys[KEYS_MOST];
} joined_table;

static struct {
    joined_table scene, surface, bottom, object, material;
    asdic_word words[ASDIC_FILE_LAW_KEYS][WORDS_MOST], surface_words[WORDS_MOST];
    char names[ASDIC_FILE_LAW_KEYS][512], fallbacks[ASDIC_FILE_LAW_KEYS][32];
    pthread_once_t once;
} made = {.once = PTHREAD_ONCE_INIT};

static void add_key(joined_table *joined, asdic_key key) {
    if (joined->table.key_count < KEYS_MOST) {
        joined->keys[joined->table.key_count++] = key;
    }
}

static void copy_table(joined_table *joined, const asdic_table *own) {
    joined->table = *own;
    joined->table.keys = joined->keys;
    joined->table.key_count = 0;
    for (size_t i = 0; i < own->key_count; i++) {
        add_key(joined, own->keys[i]);
    }
}

/* "a|b|c" cut into the words of SLOT, which stand for MIN and the numbers from there on. */
static const asdic_word *make_words(size_t slot, const char *list, double min) {
    asdic_word *words = made.words[slot];
    char *at = made.names[slot];
    snprintf(at, sizeof made.names[slot], "%s", list);
    for (size_t i = 0; at && i + 1 < WORDS_MOST; i++) {
        char *bar = strchr(at, '|');
        words[i] = (asdic_word){.name = at, .value = min + (double)i};
        if (bar) {
            *bar++ = '\0';
        }
        at = bar;
    }
    return words;
}

static asdic_key make_key(const asdic_law *law, const asdic_model_key *from, size_t slot,
                          size_t offset, bool is_default) {
    asdic_key key = {.name = from->name,
                     .type = from->columns                   ? ASDIC_KEY_PATH
                             : from->words && !from->numeric ? ASDIC_KEY_WORD
                                                             : ASDIC_KEY_NUMBER,
                     .offset = offset + slot * sizeof(file_law_value),
                     .unit = from->unit,
                     .min = from->min,
                     .max = from->max,
                     .law = law->name,
                     .chooses = from->chooses,
                     .doc = from->doc};
    if (from->words) {
        key.words = make_words(slot, from->words, from->min);
    }
    if (!isnan(from->fallback) && !from->columns && (is_default || !from->chooses)) {
        char *text = made.fallbacks[slot];
        snprintf(text, sizeof made.fallbacks[slot], "%.15g", from->fallback);
        for (const asdic_word *word = key.words; word && word->name; word++) {
            if (word->value == from->fallback) {
                snprintf(text, sizeof made.fallbacks[slot], "%s", word->name);
            }
        }
        key.fallback = text;
    }
    return key;
}

/* OFFSET of the table's file_law. */
static void add_laws(joined_table *joined, unsigned use, size_t offset, unsigned flags) {
    size_t slot = 0;
    for (size_t l = 0; l < asdic_law_count(); l++) {
        const asdic_law *law = asdic_law_get(l);
        for (size_t k = 0; k < law->model.key_count; k++) {
            const asdic_model_key *from = &law->model.keys[k];
            if (!from->doc || slot == ASDIC_FILE_LAW_KEYS) {
                continue;
            }
            if (serves(law, use)) {
                bool is_default = !(use & ASDIC_LAW_BRIEF) && law == default_law(use);
                asdic_key key = make_key(law, from, slot, offset, is_default);
                key.flags = flags;
                add_key(joined, key);
            }
            slot++;
        }
    }
}

static void point(joined_table *in, const asdic_table *own, const joined_table *joined) {
    for (size_t i = 0; i < in->table.key_count; i++) {
        in->keys[i].table = in->keys[i].table == own ? &joined->table : in->keys[i].table;
    }
}

static void add_surface_law(joined_table *surface) {
    size_t count = 0;
    for (size_t l = 0; l < asdic_law_count(); l++) {
        const char *word = asdic_law_get(l)->surface_word;
        if (word && count + 1 < WORDS_MOST) {
            made.surface_words[count++] = (asdic_word){.name = word, .value = (double)l};
        }
    }
    add_key(surface, (asdic_key){.name = "law",
                                 .type = ASDIC_KEY_WORD,
                                 .offset = offsetof(file_surface, law_index),
                                 .words = made.surface_words,
                                 .fallback = "course",
                                 .doc = "the law by which it scatters"});
}

static void make_tables(void) {
    copy_table(&made.scene, &asdic_file_table);
    copy_table(&made.surface, &asdic_surface_table);
    copy_table(&made.bottom, &asdic_bottom_table);
    copy_table(&made.object, &asdic_object_table);
    copy_table(&made.material, &asdic_material_table);
    add_surface_law(&made.surface);
    add_laws(&made.surface, ASDIC_LAW_SURFACE, offsetof(file_surface, law), 0);
    add_laws(&made.bottom, ASDIC_LAW_BOTTOM, offsetof(file_bottom, law), 0);
    add_laws(&made.object, ASDIC_LAW_OBJECT | ASDIC_LAW_BRIEF, offsetof(file_object, law),
             ASDIC_KEY_AT_MOST_ONE);
    add_laws(&made.material, ASDIC_LAW_OBJECT, offsetof(file_material, law), 0);
    point(&made.scene, &asdic_surface_table, &made.surface);
    point(&made.scene, &asdic_bottom_table, &made.bottom);
    point(&made.scene, &asdic_object_table, &made.object);
    point(&made.object, &asdic_material_table, &made.material);
}

const asdic_table *asdic_scene_table(void) {
    pthread_once(&made.once, make_tables);
    return &made.scene.table;
}

/* --- what a file gives ------------------------------------------------------------------------- */

/* The first key of LAW in MAP. */
static asdic_yaml_node *given(const asdic_law *law, const asdic_yaml_node *map) {
    for (size_t k = 0; k < law->model.key_count; k++) {
        const asdic_model_key *key = &law->model.keys[k];
        asdic_yaml_node *node = key->doc ? asdic_yaml_child(map, key->name) : NULL;
        if (node) {
            return node;
        }
    }
    return NULL;
}

/* The law of MAP: that whose name or keys it gives, another than the default before that. BY is the
 * key that says so, NULL: none. */
static const asdic_law *chosen(unsigned use, const asdic_yaml_node *map, asdic_yaml_node **by) {
    asdic_yaml_node *name = use & ASDIC_LAW_SURFACE ? asdic_yaml_child(map, "law") : NULL;
    const asdic_law *fallback = default_law(use);
    for (size_t l = 0; l < asdic_law_count(); l++) {
        const asdic_law *law = asdic_law_get(l);
        bool named =
            name && name->text && law->surface_word && strcmp(law->surface_word, name->text) == 0;
        *by = named ? name : name || law == fallback || !serves(law, use) ? NULL : given(law, map);
        if (*by) {
            return law;
        }
    }
    *by = given(fallback, map);
    return fallback;
}

asdic_yaml_node *asdic_scene_laws_given(unsigned use, const asdic_yaml_node *map) {
    asdic_yaml_node *by = NULL;
    chosen(use, map, &by);
    return by;
}

/* Of the keys of LAW that choose it at most one is given. */
static void check_choice(const asdic_law *law, const asdic_yaml_node *map,
                         asdic_problems *problems) {
    asdic_yaml_node *first = NULL;
    char names[256] = "";
    for (size_t k = 0; k < law->model.key_count; k++) {
        const asdic_model_key *key = &law->model.keys[k];
        if (key->doc && key->chooses) {
            size_t used = strlen(names);
            snprintf(names + used, sizeof names - used, "%s'%s'", used ? ", " : "", key->name);
        }
    }
    for (asdic_yaml_node *node = map->first; node; node = node->next) {
        size_t k = asdic_law_key(law, node->key);
        if (k == law->model.key_count || !law->model.keys[k].doc || !law->model.keys[k].chooses) {
            continue;
        }
        if (first && strcmp(first->key, node->key) != 0) { /* of the same twice the reader told */
            asdic_yaml_key_problem(problems, node,
                                   "'%s' and '%s' exclude each other; give only one of %s",
                                   first->key, node->key, names);
        }
        first = first ? first : node;
    }
}

void asdic_scene_laws_check(unsigned use, const asdic_yaml_node *map, asdic_problems *problems) {
    asdic_yaml_node *by = NULL;
    const asdic_law *law = map && map->kind == ASDIC_YAML_MAP ? chosen(use, map, &by) : NULL;
    if (!by) {
        return;
    }
    for (size_t l = 0; l < asdic_law_count(); l++) {
        const asdic_law *other = asdic_law_get(l);
        for (size_t k = 0; other != law && k < other->model.key_count; k++) {
            const asdic_model_key *key = &other->model.keys[k];
            asdic_yaml_node *node =
                key->doc && serves(other, use) ? asdic_yaml_child(map, key->name) : NULL;
            if (node) {
                asdic_yaml_key_problem(problems, node,
                                       "'%s' has no effect beside '%s'; give only one of them",
                                       key->name, by->key);
            }
        }
    }
    check_choice(law, map, problems);
}

asdic_material asdic_scene_laws_material(unsigned use, const asdic_yaml_node *map,
                                         const file_law *values, asdic_material_file *file) {
    asdic_yaml_node *by;
    size_t slot = 0;
    asdic_material material = asdic_material_of(chosen(use, map, &by));
    *file = (asdic_material_file){0};
    for (size_t l = 0; l < asdic_law_count(); l++) {
        const asdic_law *law = asdic_law_get(l);
        for (size_t k = 0; k < law->model.key_count; k++) {
            const asdic_model_key *key = &law->model.keys[k];
            if (!key->doc) {
                continue;
            }
            const file_law_value *value = &values->value[slot++];
            asdic_yaml_node *node = asdic_yaml_child(map, key->name);
            if (law != material.law || !node) {
                continue;
            }
            if (key->columns) {
                *file = (asdic_material_file){value->path, key->columns, node};
            } else {
                material.value[k] = key->words && !key->numeric ? value->word : value->number;
            }
        }
    }
    return material;
}
