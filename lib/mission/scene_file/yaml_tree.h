/*
 * A YAML 1.1 (or JSON) text as a tree of nodes with line and column. Limits: one document, at most
 * 32 levels and 500,000 values, no anchors, aliases, tags or doubled keys.
 */
#ifndef ASDIC_MISSION_YAML_TREE_H
#define ASDIC_MISSION_YAML_TREE_H

#include "base/arena.h"
#include "base/problems.h"
#include "base/text.h"

#include <stdbool.h>
#include <stddef.h>

typedef enum asdic_yaml_kind { ASDIC_YAML_SCALAR, ASDIC_YAML_LIST, ASDIC_YAML_MAP } asdic_yaml_kind;

typedef struct asdic_yaml_node asdic_yaml_node;

struct asdic_yaml_node {
    asdic_yaml_kind kind;
    const char *file;      /* that it stands in; NULL: the one whose problems are collected */
    unsigned line, column; /* from 1; column in characters */
    const char *text;      /* SCALAR: LENGTH bytes and a zero byte */
    size_t length;
    bool quoted; /* SCALAR: written in quotes or as a block, hence text and nothing else */
    bool bad;    /* something in it was reported: what depends on it is not judged */
    asdic_yaml_node *parent, *first, *last, *next;
    size_t index, count; /* place in a list; number of children */
    const char *key;     /* in a map */
    size_t key_length;
    unsigned key_line, key_column;
};

/* Parses SIZE bytes of UTF-8 into *ROOT, which lives in ARENA; reports to PROBLEMS. *ROOT is NULL
 * when there is no tree to go on with. Returns false when memory is short. */
bool asdic_yaml_read(const char *text, size_t size, asdic_arena *arena, asdic_problems *problems,
                     asdic_yaml_node **root);

/* The child of MAP called KEY; NULL when there is none or MAP is NULL or no map. */
asdic_yaml_node *asdic_yaml_child(const asdic_yaml_node *map, const char *key);

/* As much of NODE's key as a message shows, for "%.*s". */
int asdic_yaml_key_shown(const asdic_yaml_node *node);

/* Appends a child, sets parent and index. */
void asdic_yaml_append(asdic_yaml_node *parent, asdic_yaml_node *child);

/* Sets where NODE and all below it stand. */
void asdic_yaml_set_file(asdic_yaml_node *node, const char *file);

/* Leaves the children that stay, in their order. */
void asdic_yaml_filter(asdic_yaml_node *parent,
                       bool (*stays)(const asdic_yaml_node *child, const void *user),
                       const void *user);

/* Marks NODE and all above it as bad; NULL: nothing. */
void asdic_yaml_mark_bad(asdic_yaml_node *node);

/* One problem at NODE's value, or at its key: "...  [path.of.the.node]". Marks NODE and all above
 * it as bad. NODE NULL: about the file as a whole. */
void asdic_yaml_problem(asdic_problems *problems, asdic_yaml_node *node, const char *format, ...)
    __attribute__((format(printf, 3, 4)));
/* The same at the key, naming the path of the map that holds it. */
void asdic_yaml_key_problem(asdic_problems *problems, asdic_yaml_node *node, const char *format,
                            ...) __attribute__((format(printf, 3, 4)));

/* What ROOT holds, appended to TEXT: the same values as it was read from, without comments. */
void asdic_yaml_print(const asdic_yaml_node *root, asdic_text *text);

/* NODE on one line, scalars by SCALAR; as JSON keys have quotes. */
void asdic_yaml_print_flow(const asdic_yaml_node *node, bool is_json,
                           void (*scalar)(const asdic_yaml_node *node, asdic_text *text),
                           asdic_text *text);

#endif
