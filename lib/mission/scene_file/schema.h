/*
 * What a scene file may say, as tables: each key's type, unit, range, default and words. One table
 * describes one map of the file and the C struct that it fills; the same tables check, fill in
 * defaults, and print the JSON Schema.
 */
#ifndef ASDIC_MISSION_SCHEMA_H
#define ASDIC_MISSION_SCHEMA_H

#include "base/text.h"
#include "yaml_tree.h"

typedef enum asdic_key_type {
    ASDIC_KEY_NUMBER,  /* double; with .words also one of these, each standing for a number */
    ASDIC_KEY_NUMBERS, /* double[count] */
    ASDIC_KEY_POINTS,  /* asdic_list of double[3] */
    ASDIC_KEY_CURVE,   /* asdic_list of double[2], the first by range; a file of them is put in its
                        * place before (mission_cast.c) */
    ASDIC_KEY_INTEGER, /* int64_t; with .words as NUMBER */
    ASDIC_KEY_BOOL,    /* bool */
    ASDIC_KEY_WORD,    /* int: the value of one of .words */
    ASDIC_KEY_WORDS,   /* unsigned: bit set of the values of a list of .words */
    ASDIC_KEY_NAME,    /* const char *: letters, digits and _ - . only, fit for file names */
    ASDIC_KEY_PATH,    /* const char *: a file, relative to the scene file */
    ASDIC_KEY_MAP,     /* the struct of .table */
    ASDIC_KEY_LIST,    /* asdic_list of structs of .table */
    ASDIC_KEY_NODE,    /* asdic_yaml_node *: any value, as it stands */
} asdic_key_type;

/* What is in the file that a PATH names, or a CURVE in place of its points; a law's key says which columns it has. */
typedef enum asdic_file_kind {
    ASDIC_FILE_COLUMNS,
    ASDIC_FILE_MESH,
    ASDIC_FILE_GRID,
    ASDIC_FILE_TRACK,
    ASDIC_FILE_VEHICLE_TRACK,
    ASDIC_FILE_CAST,
    ASDIC_FILE_SONAR
} asdic_file_kind;

/* Exactly one / at most one of the keys of a table that carry the flag may be given. */
#define ASDIC_KEY_ONE_OF 1u
#define ASDIC_KEY_AT_MOST_ONE 2u
#define ASDIC_KEY_REQUIRED 4u
/* A map that may be absent, default or not; its struct is then all zeros. */
#define ASDIC_KEY_OPTIONAL 8u

typedef struct asdic_word {
    const char *name; /* NULL ends a list of words */
    double value;
} asdic_word;

typedef struct asdic_list {
    void *items;
    size_t count;
} asdic_list;

struct asdic_table;

typedef struct asdic_key {
    const char *name;
    asdic_key_type type;
    unsigned flags;
    size_t offset; /* of the value in the table's struct */
    const char *unit;
    double min, max;                  /* of numbers, inclusive */
    const struct asdic_key *ordinate; /* CURVE: unit and limits of the second of a pair */
    size_t least;                     /* LIST, POINTS: entries at least ... */
    size_t count;                     /* ... and at most; NUMBERS: how many */
    const asdic_word *words;
    const struct asdic_table *table;
    const struct asdic_table *map_form; /* LIST: what a map in its place means ... */
    size_t map_offset;                  /* ... and where it goes */
    const char *law;      /* the scattering law whose key it is; keys of two do not go together */
    asdic_file_kind file; /* PATH, CURVE */
    bool chooses;         /* of a law: at most one of these is given */
    const char *unless;   /* REQUIRED only where this other key is absent */
    const char *instead;  /* this other key may stand in its place */
    const char *fallback; /* what an absent key means, as YAML; NULL: absent stays NAN, 0, NULL */
    const char *doc;
} asdic_key;

/* Digits that KEY's limits are printed with: 2^53 has 16, of which decimals would show how they are rounded. */
static inline int asdic_key_digits(const asdic_key *key) {
    return key->max >= 1e15 ? 16 : 15;
}

typedef struct asdic_table {
    const char *doc;
    const asdic_key *keys;
    size_t key_count;
    size_t size; /* of the struct; its first member is `asdic_yaml_node *node`, NULL when absent */
    const char *scalar_key;  /* a scalar in place of the map is the value of this key ... */
    bool scalar_is_any_word; /* ... or of the first that has such a word */
    const char *scalar_word; /* this word in place of the map sets the bool key of that name */
    const char *list_key;    /* a list in place of the map is the value of this key */
} asdic_table;

/* Reads NODE (NULL: absent) into the struct OUT of TABLE; reports what is wrong to PROBLEMS.
 * Strings and lists live in ARENA. A misplaced key is looked for in ROOT, to say where it
 * belongs. */
void asdic_schema_read(const asdic_table *table, const asdic_table *root, asdic_yaml_node *node,
                       asdic_arena *arena, asdic_problems *problems, void *out);

/* Takes each name of a file that is read, the value NODE of KEY. */
typedef struct asdic_file_taker {
    void (*take)(void *user, const asdic_key *key, asdic_yaml_node *node);
    void *user;
} asdic_file_taker;

typedef struct asdic_schema_reader {
    const asdic_table *root;
    asdic_arena *arena;
    asdic_problems *problems;
    const asdic_file_taker *files; /* NULL: nobody asks */
    const asdic_table *outer;      /* of the map around the one that is read; NULL: none */
} asdic_schema_reader;

/* The key NAME of TABLE; NULL: it has none. */
const asdic_key *asdic_schema_key(const asdic_table *table, const char *name);

/* The key of PATH, "sonar.receivers[0].pitch_deg", as *OUT: of an entry of a list, as if a map had it alone. False
 * after a problem of BLAME: the tables have no such key. */
bool asdic_schema_find(const asdic_schema_reader *reader, const char *path, asdic_yaml_node *blame,
                       asdic_key *out);

/* Reports what is wrong with NODE as the value of KEY, which asdic_schema_find gave. */
void asdic_schema_read_alone(const asdic_schema_reader *reader, const asdic_key *key,
                             asdic_yaml_node *node);

/* The JSON Schema (draft 7) of ROOT, appended to TEXT. */
void asdic_schema_print(const asdic_table *root, asdic_text *text);

/* One scalar or list of scalars by its key (schema_value.c). */
void asdic_schema_read_value(const asdic_schema_reader *reader, const asdic_key *key,
                             asdic_yaml_node *node, void *out);

/* The word of KEY that NODE is, or NULL. */
const asdic_word *asdic_schema_word(const asdic_key *key, const asdic_yaml_node *node);

/* Whether NODE may be a slip of one of KEY's words. */
bool asdic_schema_is_near(const asdic_key *key, const asdic_yaml_node *node);

/* KEY's fallback as a node that no file holds; NULL when there is none or memory is short. */
asdic_yaml_node *asdic_schema_fallback(const asdic_schema_reader *reader, const asdic_key *key);

#endif
